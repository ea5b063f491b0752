/* SPDX-License-Identifier: MIT */
/*
 * Talk that is neither result nor error: levels and one sink function. Thread-safe. The only state
 * is the level and the sink, both set by `app/` before any thread starts.
 */
#ifndef RB_BASE_LOG_H
#define RB_BASE_LOG_H

#include <rbsim/error.h>

enum rb_log_level { RB_LOG_WARNING, RB_LOG_NOTE, RB_LOG_DEBUG };

typedef void rb_log_sink(enum rb_log_level level, const char *text, void *user);

/* Default: nothing is written. */
void rb_log_to(rb_log_sink *sink, void *user, enum rb_log_level most);
void rb_log(enum rb_log_level level, const char *format, ...) RB_PRINTF(2, 3);

#endif
