/* SPDX-License-Identifier: MIT */
/*
 * The console's loop: take what the run says, tick the viewer, take keys, draw, wait until the
 * viewer wants the next tick or a key comes. Keys become lines of the command language
 * (control/orders); what is here of its own is the prompt, the help page and the mouse. Drawing
 * goes through curses, which sends only differences, so all panels are drawn at every turn; only
 * the picture is drawn again just when it has changed.
 */
#include "control/desk.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/error.h"
#include "base/memory.h"
#include "control/charts.h"
#include "control/keys.h"
#include "control/orders.h"
#include "control/panels.h"
#include "control/picture.h"
#include "control/prompt.h"
#include "control/screen.h"

/*
 * HEARD_SIZE: bytes of a line of the run's standard error, longer ones are cut. CANDIDATES:
 * completions that are looked at. WHEEL_PERCENT: of the run, for each notch of the wheel.
 */
enum { HEARD_SIZE = 512, CANDIDATES = 64, WHEEL_PERCENT = 1 };

struct desk {
	struct rb_viewer *viewer;
	struct rb_screen *screen;
	struct rb_layout layout;
	struct rb_picture picture;
	struct rb_prompt prompt;
	bool helps;
	int help_first;
	uint64_t drawn;    /* the viewer's count of what was drawn last */
	bool stale;        /* all is to be drawn anew */
	bool told_failure; /* why there is only a sketch */
	int listen;        /* -1: nothing */
	char heard[HEARD_SIZE];
	size_t heard_size; /* of a line that has only begun */
	enum {
		UP,
		TURNS,
		ELSEWHERE
	} button;           /* held since over the picture: the camera turns with it */
	int drag_x, drag_y; /* where the pointer was last */
};

/* ---- drawing ---- */

/* Puts a picture of area.width by 2 area.height pixels into its cells. */
static void fill_picture(struct desk *desk, const struct rb_pixmap *pixels)
{
	const rb_area area = desk->layout.picture;
	const enum rb_palette palette = rb_screen_palette(desk->screen);
	const bool blocks = rb_screen_blocks(desk->screen);

	RB_ASSERT(pixels->width >= desk->layout.picture.width &&
	          pixels->height >= 2 * desk->layout.picture.height);
	for (int y = 0; y < area.height; y++)
		for (int x = 0; x < area.width; x++) {
			const uint8_t *const above = pixels->rgba +
			                             4 * ((size_t)(2 * y) * (size_t)pixels->width +
			                                  (size_t)x);
			const uint8_t *const below = above + 4 * (size_t)pixels->width;
			rb_screen_cell(desk->screen, area.x + x, area.y + y,
			               rb_mosaic_cell(palette, blocks, above, below, x, y));
		}
}

/* Writes a line in the middle of where the picture would be. */
static void say_in_picture(struct desk *desk, const char *text)
{
	const rb_area area = desk->layout.picture;

	for (int y = 0; y < area.height; y++)
		rb_screen_text(desk->screen, area, y, RB_STYLE_PLAIN,
		               y == area.height / 2 ? text : "");
}

/* Draws the picture if the viewer has another one since, or all is to be drawn anew. */
static void draw_picture(struct desk *desk)
{
	const struct rb_viewer *const viewer = desk->viewer;
	const rb_area area = desk->layout.picture;
	const struct rb_pixmap *pixels;
	struct rb_error err = {0};

	if (!desk->stale && desk->drawn == viewer->picture)
		return;
	desk->drawn = viewer->picture;
	if (!viewer->has_frame)
		say_in_picture(desk, "  waiting for the first frame");
	else if (rb_picture_draw(&desk->picture, viewer, area.width, 2 * area.height, &pixels,
	                         &err))
		say_in_picture(desk, err.text);
	else
		fill_picture(desk, pixels);
	if (desk->picture.failure[0] && !desk->told_failure)
		rb_viewer_say(desk->viewer, "pictures are sketches: %s", desk->picture.failure);
	desk->told_failure = desk->picture.failure[0] != '\0';
}

/* Draws the prompt, or hints where there is none. Column of the cursor, -1: none is wanted. */
static int draw_bottom(struct desk *desk)
{
	/* as many as fit */
	static const char *const keys[] = {"space play",  "q quit",    "? help",   ": command",
	                                   "arrows seek", "[ ] speed", ", . step", "n p collision",
	                                   "/ body",      "f follow",  "v camera", "s picture"};
	const rb_area area = desk->layout.bottom;
	char line[RB_COMMAND_LINE_SIZE + 2];

	if (!desk->prompt.open) {
		size_t used = 0;
		for (size_t i = 0; i < sizeof keys / sizeof *keys; i++)
			if (used + strlen(keys[i]) <= (size_t)area.width)
				used += (size_t)snprintf(line + used, sizeof line - used, "%s  ",
				                         keys[i]);
		rb_screen_text(desk->screen, area, 0, RB_STYLE_FAINT, line);
		return -1;
	}
	/* the part of the line in which the cursor is */
	int before = 0;
	for (size_t i = 0; i < desk->prompt.at; i++)
		before += ((unsigned char)desk->prompt.text[i] & 0xc0) != 0x80;
	size_t from = 0;
	for (int left = before - (area.width - 3); left > 0 && desk->prompt.text[from]; left--) {
		do
			from++;
		while (((unsigned char)desk->prompt.text[from] & 0xc0) == 0x80);
		before--;
	}
	snprintf(line, sizeof line, "%c%s", desk->prompt.lead, desk->prompt.text + from);
	rb_screen_text(desk->screen, area, 0, RB_STYLE_PLAIN, line);
	return before + 1;
}

/* Draws the whole screen. */
static void draw(struct desk *desk)
{
	struct rb_screen *const screen = desk->screen;
	int width, height;

	rb_screen_size(screen, &width, &height);
	if (desk->stale) {
		desk->layout = rb_layout_of(width, height);
		rb_screen_clear(screen);
	}
	const struct rb_layout *const l = &desk->layout;
	if (!l->fits) {
		rb_screen_text(screen, (rb_area){0, 0, width, 1}, 0, RB_STYLE_PLAIN, "needs 40x12");
		rb_screen_flush(screen, -1, 0);
		desk->stale = false;
		return;
	}
	rb_panel_transport(screen, l->transport, desk->viewer);
	if (desk->helps) {
		const rb_area area = {0, l->picture.y, width, l->picture.height};
		rb_panel_help(screen, area, &desk->help_first);
	} else {
		draw_picture(desk);
		rb_panel_numbers(screen, l->numbers, desk->viewer);
		rb_panel_charts(screen, l->charts, desk->viewer);
		rb_panel_body(screen, l->body, desk->viewer);
	}
	rb_panel_timeline(screen, l->timeline, desk->viewer);
	rb_panel_log(screen, l->log, desk->viewer);
	const int cursor = draw_bottom(desk);
	rb_screen_flush(screen, cursor, height - 1);
	desk->stale = false;
}

/* ---- keys ---- */

static void order(struct desk *desk, const char *format, ...) RB_PRINTF(2, 3);

/* Executes a line of the command language, composed as by printf. */
static void order(struct desk *desk, const char *format, ...)
{
	char line[RB_COMMAND_LINE_SIZE];
	va_list arguments;

	va_start(arguments, format);
	vsnprintf(line, sizeof line, format, arguments);
	va_end(arguments);
	(void)rb_order(desk->viewer, line, rb_clock_now_ns());
	if (desk->viewer->wants_help) {
		desk->viewer->wants_help = false;
		desk->helps = desk->stale = true;
		desk->help_first = 0;
	}
}

/*
 * Seeks by a share of the run in percent, but by a frame at least: a key that does nothing seems
 * broken.
 */
static void seek_by(struct desk *desk, double percent)
{
	const struct rb_source *const source = desk->viewer->options.source;
	const struct rb_source_status *const status = rb_source_status(source);
	const double now_s = desk->viewer->frame.time_s;
	const uint64_t row = desk->viewer->row;
	const uint64_t before = row > 0 ? row - 1 : 0;
	const double frame_s = percent > 0 ? rb_source_time(source, row + 1) - now_s
	                                   : now_s - rb_source_time(source, before);
	const double step_s = copysign(
		fmax(fabs(0.01 * percent) * status->duration_s, fmax(frame_s, 0)), percent);

	order(desk, "seek %.17g", fmin(fmax(now_s + step_s, 0), fmax(status->end_s, now_s)));
}

/* Goes to the last frame; of what still grows, stays with the newest one. */
static void seek_end(struct desk *desk)
{
	struct rb_viewer *const viewer = desk->viewer;
	const struct rb_source_status *const status = rb_source_status(viewer->options.source);

	order(desk, "seek %.17g", status->end_s);
	viewer->live = status->grows;
	viewer->playing |= status->grows;
}

/*
 * Takes the camera after the present one; after the last one the first, or the default where there
 * is none.
 */
static void next_camera(struct desk *desk)
{
	const struct rb_scene *const scene = desk->viewer->options.model->scene;
	const int next = desk->viewer->camera_index + 1;

	rb_viewer_take_camera(desk->viewer, next < scene->camera_count ? next : 0);
	rb_viewer_say(desk->viewer, "camera %s",
	              desk->viewer->camera_name[0] ? desk->viewer->camera_name : "without a name");
}

/* Follows the body that is inspected, asks for one where there is none, or ends following. */
static void follow(struct desk *desk)
{
	struct rb_viewer *const viewer = desk->viewer;
	char label[64];

	if (viewer->followed >= 0)
		order(desk, "follow");
	else if (viewer->inspected < 0)
		rb_prompt_open(&desk->prompt, ':', "follow ");
	else
		order(desk, "follow \"%s\"",
		      rb_scene_body_label(viewer->options.model->scene, viewer->inspected, label));
}

/* Does what a key stands for. */
static void run_key(struct desk *desk, const struct rb_key_row *row)
{
	struct rb_viewer *const viewer = desk->viewer;

	switch (row->action) {
	case RB_KEY_RUNS:
		order(desk, "%s", row->line);
		break;
	case RB_KEY_TYPES:
		rb_prompt_open(&desk->prompt, ':', row->line);
		break;
	case RB_KEY_SEEKS:
		seek_by(desk, strtod(row->line, NULL));
		break;
	case RB_KEY_SCALES:
		order(desk, "speed %.9g", viewer->speed * strtod(row->line, NULL));
		break;
	case RB_KEY_ENDS:
		seek_end(desk);
		break;
	case RB_KEY_FOLLOWS:
		follow(desk);
		break;
	case RB_KEY_CAMERA:
		next_camera(desk);
		break;
	case RB_KEY_TOGGLES_STOP:
		order(desk, "stop at collision %s", viewer->stops ? "off" : "on");
		break;
	case RB_KEY_TOGGLES_VIEW:
		order(desk, "view %s", viewer->playing ? "pause" : "play");
		break;
	case RB_KEY_SEARCHES:
		rb_prompt_open(&desk->prompt, '/', "");
		break;
	case RB_KEY_HELPS:
		order(desk, "help");
		break;
	case RB_KEY_REDRAWS:
	default:
		rb_screen_redraw(desk->screen);
		desk->stale = true;
		break;
	}
}

/* Inspects the first body whose name holds the text of the prompt. */
static void search(struct desk *desk)
{
	const int id = rb_order_find_body(desk->viewer, desk->prompt.text, true);
	char label[64];

	if (id < 0)
		rb_viewer_say(desk->viewer, "no body has '%.80s' in its name", desk->prompt.text);
	else
		order(desk, "body \"%s\"",
		      rb_scene_body_label(desk->viewer->options.model->scene, id, label));
}

/* Completes the prompt's last word; several candidates are logged. */
static void complete(struct desk *desk)
{
	const struct rb_command_names names = {rb_order_name, desk->viewer};
	const char *candidates[CANDIDATES];
	char line[RB_VIEWER_LOG_SIZE] = "";
	size_t size = 0;

	if (desk->prompt.lead != ':')
		return;
	const int count = rb_prompt_complete(&desk->prompt, &names, candidates, CANDIDATES);
	for (int i = 0; count > 1 && i < count && size < sizeof line; i++)
		size += (size_t)snprintf(line + size, sizeof line - size, "%s  ", candidates[i]);
	if (count > 1)
		rb_viewer_say(desk->viewer, "%s", line);
}

/* A key for the open prompt; executes the line when it is finished. */
static void type(struct desk *desk, uint32_t key)
{
	RB_ASSERT(desk->prompt.open);
	if (key == RB_KEY_TAB) {
		complete(desk);
		return;
	}
	if (rb_prompt_key(&desk->prompt, key) != RB_PROMPT_DONE)
		return;
	if (desk->prompt.lead == '/')
		search(desk);
	else
		order(desk, "%s", desk->prompt.text);
}

/* Scrolls the help page. False: the key is none for that. */
static bool scroll_help(struct desk *desk, uint32_t key)
{
	const int page = desk->layout.picture.height;

	switch (key) {
	case RB_KEY_UP:
		desk->help_first--;
		break;
	case RB_KEY_DOWN:
		desk->help_first++;
		break;
	case RB_KEY_PAGE_UP:
		desk->help_first -= page;
		break;
	case RB_KEY_PAGE_DOWN:
	case ' ':
		desk->help_first += page;
		break;
	default:
		return false;
	}
	return true;
}

/*
 * A key while the help is shown: scrolls or closes it. True: the key has been used; what closes the
 * help by its nature does nothing else, any other key is also executed.
 */
static bool leave_help(struct desk *desk, uint32_t key)
{
	desk->stale = true;
	if (scroll_help(desk, key))
		return true;
	desk->helps = false;
	return key == RB_KEY_ESCAPE || key == RB_KEY_ENTER || key == '?' || key == 'q';
}

/*
 * Turns the camera with the pointer, half round over the width of the picture. A cell is twice as
 * high as wide.
 */
static void drag(struct desk *desk, const struct rb_input_key *key)
{
	const double degrees = 180.0 / fmax(desk->layout.picture.width, 1);
	const int right = key->x - desk->drag_x, down = key->y - desk->drag_y;

	if (right != 0 || down != 0)
		order(desk, "camera orbit %.17g %.17g", -degrees * right, 2 * degrees * down);
}

/*
 * Takes an event of the mouse: wheel zooms over the picture and seeks elsewhere, a press on the
 * time line seeks, dragging the picture turns the camera.
 */
static void click(struct desk *desk, const struct rb_input_key *key)
{
	const rb_area line = desk->layout.timeline, picture = desk->layout.picture;
	const bool in_picture = !desk->helps && key->x >= picture.x && key->y >= picture.y &&
	                        key->x < picture.x + picture.width &&
	                        key->y < picture.y + picture.height;

	if (key->wheel != 0 && in_picture)
		run_key(desk, rb_key_find(key->wheel < 0 ? '+' : '-'));
	else if (key->wheel != 0)
		seek_by(desk, key->wheel * WHEEL_PERCENT);
	else if (key->mouse == RB_MOUSE_PRESSED && key->y == line.y)
		order(desk, "seek %.17g%%", 100 * rb_chart_timeline_at(line.width, key->x));
	else if (key->mouse != RB_MOUSE_PRESSED && desk->button == TURNS)
		drag(desk, key);
	if (key->wheel != 0)
		return;
	/*
	 * of what comes at once curses drops the press: the first place that is told counts for it
	 */
	if (key->mouse == RB_MOUSE_RELEASED)
		desk->button = UP;
	else if (key->mouse == RB_MOUSE_PRESSED || desk->button == UP)
		desk->button = in_picture ? TURNS : ELSEWHERE;
	desk->drag_x = key->x;
	desk->drag_y = key->y;
}

/* Gives a key to whatever is open: prompt, help, or the table of keys. */
static void take_key(struct desk *desk, const struct rb_input_key *key)
{
	if (key->key == RB_KEY_RESIZE) {
		desk->stale = true;
	} else if (key->key == RB_KEY_MOUSE) {
		click(desk, key);
	} else if (desk->prompt.open) {
		type(desk, key->key);
	} else if (!desk->helps || !leave_help(desk, key->key)) {
		if (rb_key_find(key->key))
			run_key(desk, rb_key_find(key->key));
	}
}

/* ---- the loop ---- */

/*
 * Logs the lines of the run's standard error; what redraws itself there, such as a progress bar,
 * comes line by line, and tabs are spaces. Closed: it is not listened to any more.
 */
static void hear(struct desk *desk)
{
	char bytes[256];
	ssize_t size;

	if (desk->listen < 0)
		return;
	while ((size = read(desk->listen, bytes, sizeof bytes)) > 0)
		for (ssize_t i = 0; i < size; i++) {
			const bool ends = bytes[i] == '\n' || bytes[i] == '\r';
			if (!ends && desk->heard_size < sizeof desk->heard - 1)
				desk->heard[desk->heard_size++] = bytes[i] == '\t' ? ' ' : bytes[i];
			if (!ends || desk->heard_size == 0)
				continue;
			desk->heard[desk->heard_size] = '\0';
			rb_viewer_say(desk->viewer, "%s", desk->heard);
			desk->heard_size = 0;
		}
	if (size == 0)
		desk->listen = -1;
}

/* Until somebody wishes an end, or a signal does. */
static void loop(struct desk *desk)
{
	struct rb_viewer *const viewer = desk->viewer;
	struct rb_input_key key;

	while (viewer->wish == RB_VIEWER_GOES_ON && !rb_screen_signal(desk->screen)) {
		hear(desk);
		rb_viewer_tick(viewer, rb_clock_now_ns());
		while (viewer->wish == RB_VIEWER_GOES_ON && rb_screen_key(desk->screen, &key))
			take_key(desk, &key);
		draw(desk);
		const uint64_t now_ns = rb_clock_now_ns();
		rb_viewer_shown(viewer, now_ns);
		if (viewer->wish == RB_VIEWER_GOES_ON)
			rb_screen_wait(desk->screen, rb_viewer_next(viewer, now_ns));
	}
}

enum rb_status rb_desk_run(struct rb_viewer *viewer, int listen, int *signal, struct rb_error *err)
{
	struct desk *const desk = rb_memory_take(1, sizeof *desk);

	*signal = 0;
	if (!desk)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot open a console: out of memory");
	desk->viewer = viewer;
	desk->listen = listen;
	desk->stale = true;
	const enum rb_status status = rb_screen_open(&desk->screen, err);
	if (!status) {
		loop(desk);
		*signal = rb_screen_signal(desk->screen);
	}
	rb_picture_release(&desk->picture);
	rb_screen_close(desk->screen);
	rb_memory_free(desk);
	return status;
}
