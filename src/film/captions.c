/* SPDX-License-Identifier: MIT */
/*
 * A label stands above its body, centred, within the picture; one that would cover an earlier label
 * of the list goes above that, so labels of bodies that meet are stacked, and a line leads from it
 * to its body.
 */
#include "film/captions.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "math/quat.h"
#include "math/vec3.h"
#include "model/center.h"
#include "model/shape.h"

struct rb_captions {
	const struct rb_model *model;
	const struct rb_camera_def *camera;
	struct rb_overlay *usual;                        /* borrowed */
	struct rb_overlay *of_size[RB_CAMERA_TEXTS_MAX]; /* owned; NULL: the usual one */
	char name[RB_CAMERA_LABELS_MAX][64];             /* of bodies, for labels without text */
};

/* px, where a label is. */
struct box {
	int left, top, width, height;
};

/* Letters of the usual size take this share of the height of a picture. */
static const double usual_share = 1.0 / 24;

bool rb_captions_wanted(const struct rb_camera_def *camera)
{
	return camera->label_count > 0 || camera->text_count > 0;
}

enum rb_status rb_captions_create(struct rb_captions **captions, const struct rb_model *model,
                                  const struct rb_camera_def *camera, struct rb_overlay *overlay,
                                  struct rb_error *err)
{
	struct rb_captions *const c = *captions = rb_memory_take(1, sizeof *c);
	enum rb_status status = RB_OK;

	RB_ASSERT(overlay);
	if (!c)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot prepare texts: out of memory");
	c->model = model;
	c->camera = camera;
	c->usual = overlay;
	for (int i = 0; i < camera->label_count; i++)
		rb_scene_body_label(model->scene, camera->labels[i].body, c->name[i]);
	for (int i = 0; i < camera->text_count && !status; i++) {
		/* a picture in which the usual letters have the wanted size */
		const double height = camera->texts[i].size / usual_share * camera->size_px[1];
		if (isfinite(height))
			status = rb_overlay_create(&c->of_size[i], (int)ceil(2 * height),
			                           (int)lrint(height), err);
	}
	if (status) {
		rb_captions_destroy(c);
		*captions = NULL;
	}
	return status;
}

void rb_captions_destroy(struct rb_captions *captions)
{
	if (!captions)
		return;
	for (int i = 0; i < RB_CAMERA_TEXTS_MAX; i++)
		rb_overlay_destroy(captions->of_size[i]);
	rb_memory_free(captions);
}

/* ---- labels ---- */

/* The uppermost pixel row of the box around a part, but not above that of the ball around it. */
static double part_top(const struct rb_captions *captions, const struct rb_view *view,
                       const struct rb_solid_part *part, rb_pose body)
{
	const struct rb_part_size size = rb_part_size(captions->model->scene, &part->shape);
	const rb_pose pose = rb_view_part(body, part);
	const rb_vec3 middle = rb_view_point(
		view, rb_vec3_add(pose.position, rb_quat_rotate(pose.orientation, size.middle)));
	double top = (double)INFINITY, pixel[2];

	for (int k = 0; k < 8; k++) {
		const rb_vec3 corner = {k & 1 ? size.low.x : size.high.x,
		                        k & 2 ? size.low.y : size.high.y,
		                        k & 4 ? size.low.z : size.high.z};
		const rb_vec3 at = rb_view_point(
			view, rb_vec3_add(pose.position, rb_quat_rotate(pose.orientation, corner)));
		if (!view->parallel && !(at.z < 0))
			continue;
		rb_view_pixel(view, at, pixel);
		top = fmin(top, pixel[1]);
	}
	if (!view->parallel && !(middle.z < 0))
		return top;
	rb_view_pixel(view, middle, pixel);
	return fmax(top, pixel[1] - size.reach / rb_view_pixel_at(view, -middle.z));
}

/* The uppermost pixel row of a body; of what has no volume INFINITY. */
static double body_top(const struct rb_captions *captions, const struct rb_view *view, int index,
                       rb_pose pose)
{
	const struct rb_shape *const shape = &captions->model->shape[index];
	struct rb_solid_part own;
	double top = (double)INFINITY;
	int count;

	const struct rb_solid_part *const part = rb_parts_of(captions->model->scene, shape, &own,
	                                                     &count);
	for (int k = 0; k < count; k++)
		if (rb_shape_type(&part[k].shape)->form != RB_FORM_SURFACE)
			top = fmin(top, part_top(captions, view, &part[k], pose));
	return top;
}

/* Pixel above the middle of a body, at its top; false: its middle is not in the picture. */
static bool find_top(const struct rb_captions *captions, const struct rb_frame *frame,
                     const struct rb_view *view, int id, double pixel[2])
{
	const struct rb_model *const model = captions->model;
	const int index = model->index_of[id];
	const rb_pose pose = rb_view_pose(model, frame, id);
	const rb_vec3 world = index < model->body_count
	                              ? rb_model_center(model, index, pose.position,
	                                                pose.orientation)
	                              : pose.position;
	const rb_vec3 at = rb_view_point(view, world);
	if (!view->parallel && !(at.z < 0))
		return false;
	rb_view_pixel(view, at, pixel);
	const bool seen = pixel[0] >= 0 && pixel[0] < view->width && pixel[1] >= 0 &&
	                  pixel[1] < view->height;
	const double top = body_top(captions, view, index, pose);
	if (isfinite(top))
		pixel[1] = fmax(fmin(top, pixel[1]), pixel[1] - 0.5 * view->height);
	return seen;
}

static bool is_over(const struct box *a, const struct box *b)
{
	return a->left < b->left + b->width && b->left < a->left + a->width &&
	       a->top < b->top + b->height && b->top < a->top + a->height;
}

/* Moves a box up until it covers none of the others. */
static void stack(struct box *box, const struct box *placed, int count)
{
	for (int i = 0; i < count; i++)
		if (is_over(box, &placed[i])) {
			box->top = placed[i].top - box->height;
			i = -1;
		}
}

/* Where a label goes, with a line to its body if other labels have moved it away. */
static struct box place_label(const struct rb_captions *captions, const double top[2],
                              const char *text, const struct box *placed, int count,
                              struct rb_pixmap *picture)
{
	const struct rb_overlay_size size = rb_overlay_size_of(captions->usual, text);
	const double margin = 0.25 * size.height;
	const double right = picture->width - size.width - margin;
	struct box box = {.width = size.width, .height = size.height};

	box.left = (int)lrint(fmax(fmin(top[0] - 0.5 * size.width, right), margin));
	box.top = (int)lrint(fmax(top[1] - size.height, 0));
	const int usual = box.top;
	stack(&box, placed, count);
	if (box.top < usual)
		rb_overlay_stroke(captions->usual, picture, (int)lrint(top[0]),
		                  box.top + box.height, (int)lrint(top[1] - margin));
	return box;
}

static void write_labels(struct rb_captions *captions, const struct rb_frame *frame,
                         const struct rb_view *view, struct rb_pixmap *picture)
{
	struct box placed[RB_CAMERA_LABELS_MAX];
	const char *text[RB_CAMERA_LABELS_MAX];
	int count = 0;
	double pixel[2];

	for (int i = 0; i < captions->camera->label_count; i++) {
		const struct rb_label_def *const label = &captions->camera->labels[i];

		if (!find_top(captions, frame, view, label->body, pixel))
			continue;
		text[count] = label->text ? label->text : captions->name[i];
		placed[count] = place_label(captions, pixel, text[count], placed, count, picture);
		count++;
	}
	for (int i = 0; i < count; i++)
		rb_overlay_put(captions->usual, picture, placed[i].left, placed[i].top,
		               picture->width - placed[i].left, text[i]);
}

/* ---- texts ---- */

/* The next line of a text, which moves on; false: there is none. */
static bool next_line(const char **text, char line[RB_CAMERA_TEXT_SIZE])
{
	const size_t size = strcspn(*text, "\n");

	if (!**text)
		return false;
	snprintf(line, RB_CAMERA_TEXT_SIZE, "%.*s", (int)size, *text);
	*text += size + ((*text)[size] == '\n');
	return true;
}

/* Lines at the upper left corner, from `line` on; returns the next free one. */
static int write_list(struct rb_overlay *overlay, struct rb_pixmap *picture, const char *text,
                      int line)
{
	char one[RB_CAMERA_TEXT_SIZE];

	while (next_line(&text, one))
		rb_overlay_write(overlay, picture, RB_OVERLAY_TOP_LEFT, line++, one);
	return line;
}

/* Lines in a box of which the share `at` lies at this share of the picture, but for a margin. */
static void write_at(struct rb_overlay *overlay, struct rb_pixmap *picture, const char *text,
                     const double at[2])
{
	char one[RB_CAMERA_TEXT_SIZE];
	struct rb_overlay_size box = {0, 0}, size = {0, 0};

	for (const char *rest = text; next_line(&rest, one); box.height += size.height) {
		size = rb_overlay_size_of(overlay, one);
		box.width = size.width > box.width ? size.width : box.width;
	}
	const int margin = size.height / 2;
	int y = margin + (int)lrint((1 - at[1]) * (picture->height - box.height - 2 * margin));
	while (next_line(&text, one)) {
		size = rb_overlay_size_of(overlay, one);
		const double room = picture->width - size.width - 2 * margin;
		const int x = margin + (int)lrint(fmax(at[0] * room, 0));
		rb_overlay_put(overlay, picture, x, y, picture->width - x, one);
		y += size.height;
	}
}

void rb_captions_draw(struct rb_captions *captions, const struct rb_frame *frame,
                      const struct rb_frame_shot *shot, const struct rb_view *view,
                      struct rb_pixmap *picture, int line)
{
	write_labels(captions, frame, view, picture);
	for (int i = 0; i < captions->camera->text_count; i++) {
		const struct rb_caption_def *const text = &captions->camera->texts[i];
		struct rb_overlay *const overlay = captions->of_size[i] ? captions->of_size[i]
		                                                        : captions->usual;
		const char *const words = text->text ? text->text : shot ? shot->text[i] : "";

		if (isnan(text->at[0]))
			line = write_list(overlay, picture, words, line);
		else
			write_at(overlay, picture, words, text->at);
	}
}
