/* SPDX-License-Identifier: MIT */
/*
 * The socket of a run: listens, takes lines, answers with lines. One thread of its own for all
 * clients; a client that is slow, hung or hostile costs the run nothing.
 *
 * Protocol (rbsim-control(7)): the server greets with "rbsim 1 TITLE"; each line from a client is
 * one of control/session; each answer is any number of lines that begin with a space, then one that
 * is "ok" or "error TEXT". Lines from clients are at most RB_COMMAND_LINE_SIZE bytes of printable
 * UTF-8; a longer one ends the connection. The last line before the server goes is "bye".
 */
#ifndef RB_CONTROL_SERVER_H
#define RB_CONTROL_SERVER_H

#include "control/session.h"

struct rb_server;

enum { RB_SERVER_CLIENTS_MAX = 128 };

/*
 * Binds and listens, mode 0600. A stale socket is replaced; RB_ERR_CREATE where another run answers
 * there, or the path is no socket. The path and the session are borrowed. The thread blocks all
 * signals.
 */
RB_CHECKED enum rb_status rb_server_create(struct rb_server **server, const char *path,
                                           struct rb_session *session, struct rb_error *err);
/* Says goodbye to all clients, takes the socket away (only if it is still ours). NULL is fine. */
void rb_server_destroy(struct rb_server *server);
/*
 * Takes the socket's name away and nothing else, where the process is about to end at once. From
 * any thread.
 */
void rb_server_forget(const struct rb_server *server);

#endif
