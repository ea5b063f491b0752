/* SPDX-License-Identifier: MIT */
/* What both kinds of handle of <rbsim.h> share: how errors and frames look from outside. */
#ifndef RB_EMBED_HANDLE_H
#define RB_EMBED_HANDLE_H

#include <rbsim.h>
#include <rbsim/frame.h>

#include "base/error.h"

/* Passes on a status with its error; `from` need not be filled after RB_OK. */
enum rbsim_status rb_handle_pass(struct rbsim_error *to, enum rb_status status,
                                 const struct rb_error *from);

/* Refuses a call: RBSIM_USAGE with "FUNCTION: WHAT". */
enum rbsim_status rb_handle_refuse(struct rbsim_error *to, const char *function, const char *what);

/* The same columns and numbers; borrows from `frame`. */
void rb_handle_show(struct rbsim_frame *shown, const struct rb_frame *frame);

#endif
