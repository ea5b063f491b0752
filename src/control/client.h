/* SPDX-License-Identifier: MIT */
/*
 * The other end of control/server: one connection, one request at a time. One thread.
 */
#ifndef RB_CONTROL_CLIENT_H
#define RB_CONTROL_CLIENT_H

#include <stddef.h>

#include <rbsim/error.h>

struct rb_client;

/*
 * RB_ERR_INPUT: there is no such socket, or nobody listens; RB_ERR_MISSING: what answers is no
 * rbsim, of another protocol, or turns us away.
 */
RB_CHECKED enum rb_status rb_client_connect(struct rb_client **client, const char *path,
                                            double timeout_s, struct rb_error *err);
void rb_client_close(struct rb_client *client); /* NULL is fine */

/*
 * Sends a line and waits for its answer. `*lines` (NUL-terminated, a '\n' after each, without the
 * leading spaces) belongs to the client until the next request. RB_ERR_USAGE with the server's text
 * when it answered with an error; RB_ERR_MISSING when the connection is gone or the answer does not
 * come: nothing more can be asked then.
 */
RB_CHECKED enum rb_status rb_client_request(struct rb_client *client, const char *line,
                                            double timeout_s, const char **lines, size_t *size,
                                            struct rb_error *err);

#endif
