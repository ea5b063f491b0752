/* SPDX-License-Identifier: MIT */
/*
 * Threads of ours: no signal ever interrupts one, and debuggers, `top -H` and `ps -L` tell them
 * apart by their names.
 */
#ifndef RB_BASE_THREAD_H
#define RB_BASE_THREAD_H

#include <pthread.h>
#include <signal.h>

/* Starts a thread on which every signal is blocked; 0 or an error number, as pthread_create. */
int rb_thread_start(pthread_t *thread, void *(*work)(void *), void *argument);

/*
 * For the thread to call first: it is "rb-WHAT" from now on, cut at the 15 bytes that the system
 * keeps.
 */
void rb_thread_name(const char *what);

/*
 * The signals that ask this process to end properly: SIGINT, SIGTERM, SIGUSR1, and, unless whoever
 * started it has it ignored, as nohup(1) does, SIGHUP of a terminal that is closed.
 */
sigset_t rb_thread_stops(void);
/* "SIGHUP", of one of these. */
const char *rb_thread_stop_name(int signal);

#endif
