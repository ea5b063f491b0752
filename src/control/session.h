/* SPDX-License-Identifier: MIT */
/*
 * What commands do to a run, whatever way they come in: a line goes in, the run's player is told,
 * the answer comes out. The socket's server, standard input and files of commands all end here.
 * Serves also the words of the protocol that are no commands: hello, frame, newer, scene, events,
 * timeline (rbsim-control(7)).
 *
 * Owned by whoever started the run; lines may come from any thread. A run is attached from before
 * its first frame until after its last one, and again after a restart; in between what needs a run
 * is refused in one line.
 */
#ifndef RB_CONTROL_SESSION_H
#define RB_CONTROL_SESSION_H

#include "control/answer.h"
#include "control/command.h"
#include "control/player.h"
#include "flow/run_info.h"

struct rb_session;

enum { RB_SESSION_SETS_MAX = 64, RB_SESSION_PROTOCOL = 1 };

/* "NAME=VALUE" */
struct rb_session_set {
	char text[2 * RB_COMMAND_TEXT_SIZE];
};

/*
 * Keeps a value of a parameter among `sets` of RB_SESSION_SETS_MAX, in place of an earlier one of
 * the same; its text, NULL: there are too many.
 */
const char *rb_session_keep_set(struct rb_session_set *sets, int *count, const char *name,
                                const char *value, struct rb_error *err);

/* The player is borrowed. */
RB_CHECKED enum rb_status rb_session_create(struct rb_session **session, struct rb_player *player,
                                            struct rb_error *err);
void rb_session_destroy(struct rb_session *session); /* NULL is fine */

/*
 * A run begins; `info` with its model and scene, and the recording's name (NULL: none) are borrowed
 * until detached.
 */
RB_CHECKED enum rb_status rb_session_attach(struct rb_session *session,
                                            const struct rb_run_info *info, const char *recording,
                                            struct rb_error *err);
void rb_session_detach(struct rb_session *session);

/*
 * The simulator's thread, while attached: keeps a copy of a frame. Without memory for it the frame
 * is not kept, that is all.
 */
void rb_session_keep(struct rb_session *session, const struct rb_frame *frame);

/*
 * One line, NUL-terminated, to the answer, whose last line this ends. `who` is who gave it, for the
 * log of events. False: the answer is an error.
 */
bool rb_session_execute(struct rb_session *session, const char *line, const char *who,
                        struct rb_answer *answer);
/* Whether a run can serve such a command at all, RB_ERR_USAGE with the reason else. */
RB_CHECKED enum rb_status rb_session_serves(enum rb_command_kind kind, struct rb_error *err);

/* Adds to the log of events. */
void rb_session_tell(struct rb_session *session, const char *format, ...) RB_PRINTF(2, 3);

/*
 * The values set for the next restart, the newest of each parameter; how many. `out` has room for
 * RB_SESSION_SETS_MAX.
 */
int rb_session_sets(struct rb_session *session, struct rb_session_set *out);
/* Title of the run for the greeting, printable. */
void rb_session_title(struct rb_session *session, char out[128]);

#endif
