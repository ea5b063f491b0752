/* SPDX-License-Identifier: MIT */
/*
 * Every playback command, one table row each: what keys, the ':' line, standard input, --commands
 * and the socket all end in. The parser, `help`, completion and the manual page read the same rows.
 *
 * Values; nothing here knows a run, a screen or a socket. Any thread.
 */
#ifndef RB_CONTROL_COMMAND_H
#define RB_CONTROL_COMMAND_H

#include <stdbool.h>
#include <stdio.h>

#include <rbsim/error.h>

enum rb_command_kind {
	RB_COMMAND_PLAY,
	RB_COMMAND_PAUSE,
	RB_COMMAND_TOGGLE,
	RB_COMMAND_STEP,
	RB_COMMAND_BACK,
	RB_COMMAND_SEEK,
	RB_COMMAND_SPEED,
	RB_COMMAND_RESTART,
	RB_COMMAND_STOP,     /* at collision on|off */
	RB_COMMAND_NEXT,     /* collision */
	RB_COMMAND_PREVIOUS, /* collision */
	RB_COMMAND_FOLLOW,
	RB_COMMAND_CAMERA, /* NAME, or move|orbit|zoom|mount with values */
	RB_COMMAND_SNAPSHOT,
	RB_COMMAND_FILM,
	RB_COMMAND_CHECKPOINT,
	RB_COMMAND_BODY,
	RB_COMMAND_SET,
	RB_COMMAND_VIEW, /* pause|play: one's own view, not the run */
	RB_COMMAND_STATUS,
	RB_COMMAND_HELP,
	RB_COMMAND_QUIT,
	RB_COMMAND_KIND_COUNT
};

/* What a command needs, beside a line that is right. */
enum {
	RB_NEEDS_RUN = 1u << 0,    /* a simulation that goes on */
	RB_NEEDS_VIEW = 1u << 1,   /* something that shows frames: a console */
	RB_NEEDS_FRAMES = 1u << 2, /* frames to go back to: kept ones or a recording */
};

struct rb_command_row {
	const char *name;
	const char *arguments; /* as in usage lines: "[N]", "TIME|PERCENT%" */
	unsigned needs;        /* RB_NEEDS_* */
	const char *help;      /* one line */
};
extern const struct rb_command_row rb_commands[RB_COMMAND_KIND_COUNT];

enum rb_camera_action {
	RB_CAMERA_NAMED,
	RB_CAMERA_MOVE,
	RB_CAMERA_ORBIT,
	RB_CAMERA_ZOOM,
	RB_CAMERA_MOUNT,
	RB_CAMERA_ALL
};
enum { RB_COMMAND_TEXT_SIZE = 256, RB_COMMAND_LINE_SIZE = 1024 };

/* A command line that was understood. */
struct rb_command {
	enum rb_command_kind kind;
	double number;   /* step, back: frames >= 1; seek: s or %; speed: > 0; zoom: factor */
	bool is_percent; /* of seek */
	bool is_on;      /* stop, film; view: play */
	double vector
		/*
		 * camera move: m, right, up, forward; orbit: rad (degrees in the line), around,
		 * over
		 */
		[3];
	enum rb_camera_action action;
	bool moves; /* film: moves its camera, as `action` says */
	/* name of a body, camera, file, parameter, command; "" where left out */
	char text[RB_COMMAND_TEXT_SIZE];
	char value[RB_COMMAND_TEXT_SIZE]; /* of set */
};

/*
 * Bytes of the printable UTF-8 character at `at` (a tab counts as one), 0 where there is none.
 * Looks at no byte behind a zero. RFC 3629: no surrogates, no overlong forms.
 */
size_t rb_command_character(const char *at);

/*
 * Words are parted by spaces; one in double quotes may hold spaces. An empty line or one that
 * begins with '#' is RB_OK with *given false. RB_ERR_USAGE in one line: what was found, what was
 * wanted, the nearest name. No byte of the line is trusted.
 */
RB_CHECKED enum rb_status rb_command_parse(struct rb_command *command, bool *given,
                                           const char *line, struct rb_error *err);

/*
 * Continuations of a line that is being typed: of commands, their fixed words, and what `names`
 * offers for bodies, cameras and parameters. Number of candidates put into `out` (at most `most`),
 * each a whole word.
 */
struct rb_command_names {
	const char *(*name)(void *user, enum rb_command_kind kind, int index); /* NULL: no more */
	void *user;
};
int rb_command_complete(const char *line, const struct rb_command_names *names, const char **out,
                        int most);

/* Usage and help of a row, or of all, as text lines. */
void rb_command_print_help(FILE *file, const char *name);
/* All rows as an mdoc list, for the manual page (tools/check-manual). */
void rb_command_print_manual(FILE *file);

#endif
