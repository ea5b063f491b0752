/* SPDX-License-Identifier: MIT */
/*
 * One sink and one level in static storage: messages come from every layer, and a handle passed
 * through all of them would serve nothing but them. Text is formatted on the stack before the lock
 * is taken, so that a slow sink delays only others that have something to report. Longer text is
 * cut.
 */
#include "base/log.h"

#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>

/* set before any thread starts, then only read */
static rb_log_sink *log_sink;
static void *log_user;
static enum rb_log_level log_most;

/* one line at a time reaches the sink */
static pthread_mutex_t log_lock = PTHREAD_MUTEX_INITIALIZER;

void rb_log_to(rb_log_sink *sink, void *user, enum rb_log_level most)
{
	log_sink = sink;
	log_user = user;
	log_most = most;
}

void rb_log(enum rb_log_level level, const char *format, ...)
{
	if (!log_sink || level > log_most)
		return;

	char text[1024];
	va_list arguments;
	va_start(arguments, format);
	const int length = vsnprintf(text, sizeof text, format, arguments);
	va_end(arguments);
	if (length < 0)
		return;
	pthread_mutex_lock(&log_lock);
	log_sink(level, text, log_user);
	pthread_mutex_unlock(&log_lock);
}
