/* SPDX-License-Identifier: MIT */
/*
 * Curses does the drawing; what is around it is for the cases in which curses alone would leave a
 * broken terminal: crashes (handlers that write a prepared reset string and restore the modes with
 * async-signal-safe calls only), SIGKILL (control/guard), SIGTSTP and SIGWINCH (handled in the
 * loop, not in curses' own handlers, which are not safe), and text on standard error (redirected to
 * a memory file and printed at the end).
 *
 * A polite signal only sets a flag; the loop ends and the caller closes the screen. A second one,
 * or three seconds without an end, gives the terminal back at once.
 */
#include "control/screen.h"

#define NCURSES_WIDECHAR 1
#include <errno.h>
#include <fcntl.h>
#include <langinfo.h>
#include <locale.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/timerfd.h>
#include <termios.h>
#include <unistd.h>
#include <wchar.h>

#include <curses.h>
#include <term.h>

#include "base/clock.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/visible.h"
#include "control/guard.h"
#include "control/keys.h"

/*
 * RESET_SIZE: bytes of the reset string, of five capabilities. WARNING_RED: number of a strong red
 * in the palette of 256. NAME_SIZE: of an entry of terminfo.
 */
enum { RESET_SIZE = 256, WARNING_RED = 160, NAME_SIZE = 80 };

struct rb_screen {
	SCREEN *curses;
	enum rb_palette palette;
	bool blocks;
	int timer; /* of rb_screen_wait */
	int warning_pair;
};

/*
 * What a signal's handler needs: there is one terminal and one process, and a handler is given
 * nothing. Written before the handlers are set, only read by them, but for `asked`.
 */
static struct {
	char reset[RESET_SIZE]; /* what makes the terminal as it was */
	size_t reset_size;
	struct termios modes;
	bool has_modes;
	int errors;      /* where standard error goes meanwhile, -1: where it always does */
	int errors_real; /* where it went */
	volatile sig_atomic_t asked, stops, resized;
	struct rb_guard guard;
} rescue = {.errors = -1, .errors_real = -1};

/*
 * Turns reporting of the mouse off (xterm's modes 1000 clicks, 1002 drags, 1006 coordinates as
 * text).
 */
static const char mouse_off[] = "\033[?1006;1002;1000l";

static const int polite[] = {SIGINT, SIGTERM, SIGHUP};
static const int fatal[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGQUIT, SIGALRM};

/* ---- giving it back ---- */

/*
 * Prints on the real standard error what was said there while the screen was open. Safe in a
 * handler.
 */
static void tell_errors(void)
{
	char bytes[512];
	ssize_t size;

	if (rescue.errors < 0)
		return;
	(void)!dup2(rescue.errors_real, STDERR_FILENO);
	for (off_t at = 0; (size = pread(rescue.errors, bytes, sizeof bytes, at)) > 0; at += size)
		if (write(STDERR_FILENO, bytes, (size_t)size) < 0)
			break;
}

/* Handler of fatal signals: gives the terminal back, then dies of the signal. */
static void give_back(int signal_number)
{
	rb_guard_dismiss(&rescue.guard);
	(void)!write(STDOUT_FILENO, rescue.reset, rescue.reset_size);
	if (rescue.has_modes)
		tcsetattr(STDIN_FILENO, TCSANOW, &rescue.modes);
	tell_errors();
	/*
	 * SA_RESETHAND has made it the default again; an alarm means that an end was asked for and
	 * did not come
	 */
	raise(signal_number == SIGALRM && rescue.asked ? rescue.asked : signal_number);
}

/*
 * Handler of polite signals: the loop ends as if asked to; where it does not within three seconds,
 * the alarm ends the process.
 */
static void ask_for_end(int signal_number)
{
	if (rescue.asked) {
		signal(signal_number, SIG_DFL);
		give_back(signal_number);
	}
	rescue.asked = signal_number;
	alarm(3);
}

/*
 * Handler of SIGTSTP. That of curses does what is not safe in a handler: it may change sizes, and
 * so memory.
 */
static void ask_for_stop(int signal_number)
{
	(void)signal_number;
	rescue.stops = 1;
}

/*
 * Handler of SIGWINCH. Curses does nothing where the size is what it was, though there may have
 * been others in between, and the terminal may have cut or moved what was on it.
 */
static void ask_for_redraw(int signal_number)
{
	(void)signal_number;
	rescue.resized = 1;
}

/*
 * Appends a text to the reset string; NULL or -1 (terminfo: not a string capability) is nothing.
 * One that does not fit is left out as a whole.
 */
static void add_reset(const char *text)
{
	const size_t size = text && text != (const char *)-1 ? strlen(text) : 0;

	if (rescue.reset_size + size > sizeof rescue.reset)
		return;
	memcpy(rescue.reset + rescue.reset_size, text ? text : "", size);
	rescue.reset_size += size;
}

/* Appends a string of terminfo, without the padding ("$<5>") that was for terminals of long ago. */
static void add_capability(const char *name)
{
	char text[RESET_SIZE];
	const char *from = tigetstr(name);
	size_t size = 0;

	if (!from || from == (const char *)-1)
		return;
	while (*from && size < sizeof text - 1) {
		if (from[0] == '$' && from[1] == '<' && strchr(from, '>'))
			from = strchr(from, '>') + 1;
		else
			text[size++] = *from++;
	}
	text[size] = '\0';
	add_reset(text);
}

/* Composes the reset string: attributes, colours, keypad, cursor, main screen. */
static void prepare_rescue(void)
{
	static const char *const names[] = {"sgr0", "op", "rmkx", "cnorm", "rmcup"};

	rescue.reset_size = 0;
	if (tigetstr("kmous") && tigetstr("kmous") != (char *)-1)
		add_reset(mouse_off);
	for (size_t i = 0; i < sizeof names / sizeof *names; i++)
		add_capability(names[i]);
	rescue.asked = 0;
}

/* Sets our handlers, or the default ones. */
static void set_handlers(bool ours)
{
	struct sigaction action = {.sa_flags = (int)SA_RESETHAND};

	sigemptyset(&action.sa_mask);
	for (size_t i = 0; i < sizeof fatal / sizeof *fatal; i++) {
		action.sa_handler = ours ? give_back : SIG_DFL;
		sigaction(fatal[i], &action, NULL);
	}
	action.sa_flags = 0;
	action.sa_handler = ours ? ask_for_stop : SIG_DFL;
	sigaction(SIGTSTP, &action, NULL);
	action.sa_handler = ours ? ask_for_redraw : SIG_DFL;
	sigaction(SIGWINCH, &action, NULL);
	for (size_t i = 0; i < sizeof polite / sizeof *polite; i++) {
		action.sa_handler = ours ? ask_for_end : SIG_DFL;
		sigaction(polite[i], &action, NULL);
	}
}

/*
 * Redirects standard error to memory, if it is a terminal: what others write there would spoil the
 * screen, and be gone with it.
 */
static void hold_errors(void)
{
	if (!isatty(STDERR_FILENO))
		return;
	rescue.errors_real = fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 3);
	rescue.errors = memfd_create("errors", MFD_CLOEXEC);
	if (rescue.errors >= 0)
		(void)!dup2(rescue.errors, STDERR_FILENO);
}

/* Restores standard error and prints what was held. */
static void release_errors(void)
{
	tell_errors();
	if (rescue.errors >= 0)
		close(rescue.errors);
	if (rescue.errors_real >= 0)
		close(rescue.errors_real);
	rescue.errors = rescue.errors_real = -1;
}

/* ---- opening ---- */

/* Whether the present entry of terminfo has direct colours. */
static bool shows_rgb(void)
{
	return tigetflag("RGB") > 0 || tigetnum("RGB") > 0;
}

/*
 * Name of the terminal's entry, or of one with direct colours where the environment says that it
 * has them (COLORTERM) and terminfo knows the entry.
 */
static const char *choose_entry(const char *term, char out[NAME_SIZE])
{
	const char *const hint = getenv("COLORTERM");
	int found;

	if (!hint || (strcmp(hint, "truecolor") != 0 && strcmp(hint, "24bit") != 0) ||
	    strstr(term, "-direct"))
		return term;
	snprintf(out, NAME_SIZE, "%.*s-direct", (int)strcspn(term, "-"), term);
	if (setupterm(out, STDOUT_FILENO, &found) != OK)
		return term;
	const bool good = shows_rgb();
	del_curterm(cur_term);
	return good ? out : term;
}

/* What the terminal can show. 64 pairs: each of 8 colours on each. */
static enum rb_palette choose_palette(void)
{
	if (!has_colors() || COLORS < 8 || COLOR_PAIRS < 64)
		return RB_PALETTE_NONE;
	if (COLORS >= 1 << 24 && shows_rgb())
		return RB_PALETTE_TRUE;
	return COLORS >= 256 ? RB_PALETTE_256 : COLORS >= 16 ? RB_PALETTE_16 : RB_PALETTE_8;
}

/*
 * Turns reports of movements with a button held on or off; curses asks for presses and releases
 * only.
 */
static void report_drags(bool on)
{
	if (!tigetstr("kmous") || tigetstr("kmous") == (char *)-1)
		return;
	putp(on ? "\033[?1002h" : "\033[?1002l");
	fflush(stdout);
}

/*
 * Defines the sequences that terminals send for these keys, whatever terminfo says: inside of tmux
 * or over a serial line the entry is often that of another terminal.
 */
static void add_keys(void)
{
	static const struct {
		const char *text;
		int code;
	} keys[] = {
		{"\033[1~", KEY_HOME},  {"\033[7~", KEY_HOME},    {"\033[H", KEY_HOME},
		{"\033OH", KEY_HOME},   {"\033[4~", KEY_END},     {"\033[8~", KEY_END},
		{"\033[F", KEY_END},    {"\033OF", KEY_END},      {"\033[A", KEY_UP},
		{"\033OA", KEY_UP},     {"\033[B", KEY_DOWN},     {"\033OB", KEY_DOWN},
		{"\033[C", KEY_RIGHT},  {"\033OC", KEY_RIGHT},    {"\033[D", KEY_LEFT},
		{"\033OD", KEY_LEFT},   {"\033[1;2D", KEY_SLEFT}, {"\033[1;2C", KEY_SRIGHT},
		{"\033[5~", KEY_PPAGE}, {"\033[6~", KEY_NPAGE},   {"\033[3~", KEY_DC},
	};

	for (size_t i = 0; i < sizeof keys / sizeof *keys; i++)
		if (key_defined(keys[i].text) == 0)
			define_key(keys[i].text, keys[i].code);
}

/* Sets the modes of curses and finds out what the screen can show. */
static void set_modes(struct rb_screen *screen)
{
	cbreak();
	noecho();
	nonl();
	intrflush(stdscr, FALSE);
	keypad(stdscr, TRUE);
	add_keys();
	nodelay(stdscr, TRUE);
	leaveok(stdscr, TRUE);
	set_escdelay(25);
	mousemask(ALL_MOUSE_EVENTS | REPORT_MOUSE_POSITION, NULL);
	report_drags(true);
	mouseinterval(0);
	curs_set(0);
	if (has_colors()) {
		start_color();
		use_default_colors();
	}
	screen->palette = choose_palette();
	screen->blocks = strcmp(nl_langinfo(CODESET), "UTF-8") == 0;
	if (screen->palette != RB_PALETTE_NONE) {
		const int red = screen->palette == RB_PALETTE_TRUE  ? 0xd70000
		                : screen->palette == RB_PALETTE_256 ? WARNING_RED
		                                                    : 1;
		screen->warning_pair = alloc_pair(red, -1);
	}
}

enum rb_status rb_screen_open(struct rb_screen **screen, struct rb_error *err)
{
	struct rb_screen *const s = *screen = rb_memory_take(1, sizeof *s);
	const char *const term = getenv("TERM");
	char direct[NAME_SIZE];

	if (!s)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot open the screen: out of memory");
	s->timer = timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC);
	setlocale(LC_CTYPE, "");
	rescue.has_modes = tcgetattr(STDIN_FILENO, &rescue.modes) == 0;
	if (s->timer >= 0 && term && *term)
		s->curses = newterm(choose_entry(term, direct), stdout, stdin);
	const bool moves = s->curses && tigetstr("cup") && tigetstr("cup") != (char *)-1;
	if (!moves) {
		rb_screen_close(s);
		*screen = NULL;
		return RB_FAIL(err, RB_ERR_MISSING,
		               "the terminal '%s' is not known or can't be written to anywhere",
		               term ? term : "");
	}
	set_modes(s);
	prepare_rescue();
	rb_guard_start(&rescue.guard, rescue.reset, rescue.reset_size,
	               rescue.has_modes ? &rescue.modes : NULL);
	hold_errors();
	set_handlers(true);
	return RB_OK;
}

void rb_screen_close(struct rb_screen *screen)
{
	if (!screen)
		return;
	if (screen->curses) {
		alarm(0);
		set_handlers(false);
		endwin();
		delscreen(screen->curses);
		rb_guard_stop(&rescue.guard);
		release_errors();
	}
	if (screen->timer >= 0)
		close(screen->timer);
	rb_memory_free(screen);
}

/* ---- writing ---- */

void rb_screen_size(const struct rb_screen *screen, int *width, int *height)
{
	(void)screen;
	*width = COLS;
	*height = LINES;
}

enum rb_palette rb_screen_palette(const struct rb_screen *screen)
{
	return screen->palette;
}

bool rb_screen_blocks(const struct rb_screen *screen)
{
	return screen->blocks;
}

/* Puts a glyph at a cell; places outside of the screen are ignored by curses. */
static void put(int x, int y, uint32_t glyph, attr_t attributes, int pair)
{
	const wchar_t text[2] = {(wchar_t)glyph, L'\0'};
	cchar_t cell;

	setcchar(&cell, text, attributes, 0, &pair);
	mvadd_wch(y, x, &cell);
}

void rb_screen_cell(struct rb_screen *screen, int x, int y, rb_cell cell)
{
	const bool colored = screen->palette != RB_PALETTE_NONE &&
	                     (cell.fore >= 0 || cell.back >= 0);

	put(x, y, cell.glyph, A_NORMAL, colored ? alloc_pair(cell.fore, cell.back) : 0);
}

/* Attributes of curses for a style. */
static attr_t attributes_of(enum rb_style style)
{
	static const attr_t attributes[] = {[RB_STYLE_PLAIN] = A_NORMAL,
	                                    [RB_STYLE_STRONG] = A_BOLD,
	                                    [RB_STYLE_FAINT] = A_DIM,
	                                    [RB_STYLE_BAR] = A_REVERSE,
	                                    [RB_STYLE_WARNING] = A_BOLD};

	RB_ASSERT(style <= RB_STYLE_WARNING);
	return attributes[style];
}

void rb_screen_glyph(struct rb_screen *screen, int x, int y, uint32_t glyph, enum rb_style style)
{
	put(x, y, glyph, attributes_of(style),
	    style == RB_STYLE_WARNING ? screen->warning_pair : 0);
}

void rb_screen_text(struct rb_screen *screen, rb_area area, int row, enum rb_style style,
                    const char *text)
{
	mbstate_t state = {0};
	int x = 0;

	if (row >= area.height)
		return;
	while (*text && x < area.width) {
		wchar_t c = L'?';
		size_t size = rb_visible_size(text) > 0 ? mbrtowc(&c, text, strlen(text), &state)
		                                        : 0;
		if (size == (size_t)-1 || size == (size_t)-2 || size == 0) {
			c = L'?';
			size = 1;
			memset(&state, 0, sizeof state);
		}
		const int width = wcwidth(c);
		text += size;
		/* combining characters would need the cell before them: they are left out */
		if (width == 0)
			continue;
		if (width > 1 && x + width > area.width)
			break;
		rb_screen_glyph(screen, area.x + x, area.y + row, width < 0 ? '?' : (uint32_t)c,
		                style);
		x += width < 1 ? 1 : width;
	}
	for (; x < area.width; x++)
		rb_screen_glyph(screen, area.x + x, area.y + row, ' ', style);
}

void rb_screen_clear(struct rb_screen *screen)
{
	(void)screen;
	erase();
}

void rb_screen_redraw(struct rb_screen *screen)
{
	(void)screen;
	clearok(curscr, TRUE);
}

/*
 * Sends what has changed. Curses ignores SIGTSTP while it sends, and what is ignored is lost; on a
 * slow line that is most of the time. What is blocked besides is kept until curses listens again.
 */
static void send_changes(void)
{
	sigset_t stops, before;

	sigemptyset(&stops);
	sigaddset(&stops, SIGTSTP);
	pthread_sigmask(SIG_BLOCK, &stops, &before);
	refresh();
	pthread_sigmask(SIG_SETMASK, &before, NULL);
}

void rb_screen_flush(struct rb_screen *screen, int x, int y)
{
	(void)screen;
	curs_set(x >= 0);
	leaveok(stdscr, x < 0);
	if (x >= 0)
		move(y, x);
	send_changes();
}

/* ---- stopping ---- */

/* Takes the terminal's size as it is now; all of it is sent anew with the next flush. */
static void take_size(void)
{
	struct winsize size;

	rescue.resized = 0;
	if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_row > 0 && size.ws_col > 0 &&
	    is_term_resized(size.ws_row, size.ws_col))
		resizeterm(size.ws_row, size.ws_col);
	clearok(curscr, TRUE);
}

/*
 * Stops the process as the shell wishes, with the terminal given back; afterwards takes the
 * terminal as it is then.
 */
static void stop(void)
{
	struct sigaction action = {.sa_handler = SIG_DFL};

	rescue.stops = 0;
	report_drags(false);
	endwin();
	sigemptyset(&action.sa_mask);
	sigaction(SIGTSTP, &action, NULL);
	raise(SIGTSTP);
	action.sa_handler = ask_for_stop;
	sigaction(SIGTSTP, &action, NULL);
	take_size();
	send_changes();
	report_drags(true);
}

/* ---- keys ---- */

/* Our number for a key code of curses; 0: none. */
static uint32_t special_key(wint_t code)
{
	static const struct {
		int code;
		uint32_t key;
	} keys[] = {
		{KEY_LEFT, RB_KEY_LEFT},
		{KEY_RIGHT, RB_KEY_RIGHT},
		{KEY_UP, RB_KEY_UP},
		{KEY_DOWN, RB_KEY_DOWN},
		{KEY_HOME, RB_KEY_HOME},
		{KEY_END, RB_KEY_END},
		{KEY_PPAGE, RB_KEY_PAGE_UP},
		{KEY_NPAGE, RB_KEY_PAGE_DOWN},
		{KEY_SLEFT, RB_KEY_SHIFT_LEFT},
		{KEY_SRIGHT, RB_KEY_SHIFT_RIGHT},
		{KEY_ENTER, RB_KEY_ENTER},
		{KEY_BACKSPACE, RB_KEY_BACKSPACE},
		{KEY_DC, RB_KEY_DELETE},
		{KEY_RESIZE, RB_KEY_RESIZE},
		{KEY_MOUSE, RB_KEY_MOUSE},
	};

	for (size_t i = 0; i < sizeof keys / sizeof *keys; i++)
		if (keys[i].code == (int)code)
			return keys[i].key;
	return 0;
}

/* Our number for a character; control characters that are keys of their own become these. */
static uint32_t plain_key(wint_t c)
{
	switch (c) {
	case '\r':
	case '\n':
		return RB_KEY_ENTER;
	case '\t':
		return RB_KEY_TAB;
	case 8:
	case 0x7f:
		return RB_KEY_BACKSPACE;
	case 27:
		return RB_KEY_ESCAPE;
	default:
		return (uint32_t)c;
	}
}

/* Fills in an event of the mouse; key 0 where it is none for us. */
static void take_mouse(struct rb_input_key *key)
{
	MEVENT event;

	key->key = 0;
	if (getmouse(&event) != OK)
		return;
	key->x = event.x;
	key->y = event.y;
	key->wheel = event.bstate & BUTTON4_PRESSED ? -1 : event.bstate & BUTTON5_PRESSED ? 1 : 0;
	key->mouse = event.bstate & REPORT_MOUSE_POSITION                 ? RB_MOUSE_MOVED
	             : event.bstate & BUTTON1_RELEASED                    ? RB_MOUSE_RELEASED
	             : event.bstate & (BUTTON1_PRESSED | BUTTON1_CLICKED) ? RB_MOUSE_PRESSED
	                                                                  : RB_MOUSE_OTHER;
	if (key->wheel != 0 || key->mouse != RB_MOUSE_OTHER)
		key->key = RB_KEY_MOUSE;
}

bool rb_screen_key(struct rb_screen *screen, struct rb_input_key *key)
{
	wint_t code;

	(void)screen;
	*key = (struct rb_input_key){0};
	if (rescue.stops) {
		stop();
		key->key = RB_KEY_RESIZE;
		return true;
	}
	if (rescue.resized) {
		take_size();
		key->key = RB_KEY_RESIZE;
		return true;
	}
	const int kind = get_wch(&code);
	if (kind == ERR)
		return false;
	key->key = kind == KEY_CODE_YES ? special_key(code) : plain_key(code);
	if (key->key == RB_KEY_MOUSE)
		take_mouse(key);
	return true;
}

void rb_screen_wait(struct rb_screen *screen, uint64_t until_ns)
{
	const struct itimerspec at = {.it_value = {.tv_sec = (time_t)(until_ns / 1000000000),
	                                           .tv_nsec = (long)(until_ns % 1000000000)}};
	struct pollfd wait[2] = {{.fd = STDIN_FILENO, .events = POLLIN},
	                         {.fd = screen->timer, .events = POLLIN}};
	uint64_t times;

	if (until_ns <= rb_clock_now_ns() || rescue.asked || rescue.stops || rescue.resized)
		return;
	timerfd_settime(screen->timer, TFD_TIMER_ABSTIME, &at, NULL);
	/* at most a second, should the timer be lost; until_ns is never later by much */
	poll(wait, 2, 1000);
	(void)!read(screen->timer, &times, sizeof times);
	/* the terminal is gone: nobody will type any more */
	if (wait[0].revents & (POLLHUP | POLLERR | POLLNVAL) && !(wait[0].revents & POLLIN))
		rescue.asked = SIGHUP;
}

int rb_screen_signal(const struct rb_screen *screen)
{
	(void)screen;
	return rescue.asked;
}

void rb_screen_library(char *out, size_t size)
{
	snprintf(out, size, "%s", curses_version());
}
