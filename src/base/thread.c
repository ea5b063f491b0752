/* SPDX-License-Identifier: MIT */
/*
 * Signals are blocked around pthread_create, not in the new thread, because a signal could arrive
 * between its start and its first statement; a thread inherits the mask of its creator. So only the
 * main thread is ever interrupted, and no system call of a worker ends with EINTR.
 */
#include "base/thread.h"

#include <stdbool.h>
#include <string.h>

#include "base/error.h"

enum { NAME_SIZE = 16 }; /* TASK_COMM_LEN of Linux, with the zero byte */

int rb_thread_start(pthread_t *thread, void *(*work)(void *), void *argument)
{
	RB_ASSERT(thread && work);

	sigset_t all, before;

	sigfillset(&all);
	pthread_sigmask(SIG_SETMASK, &all, &before); /* the thread inherits it */
	const int failed = pthread_create(thread, NULL, work, argument);
	pthread_sigmask(SIG_SETMASK, &before, NULL);
	return failed;
}

static bool is_plain(char c)
{
	return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
}

void rb_thread_name(const char *what)
{
	char name[NAME_SIZE] = "rb-";
	size_t size = strlen(name);

	/*
	 * Debuggers and ps(1) print the name without escapes, and it may stem from a scene (a
	 * camera's name): only ASCII letters and digits pass, runs of other bytes become one '-',
	 * the rest is cut.
	 */
	for (; *what && size + 1 < sizeof name; what++)
		if (is_plain(*what))
			name[size++] = *what;
		else if (name[size - 1] != '-')
			name[size++] = '-';
	while (name[size - 1] == '-')
		size--;
	name[size] = '\0';
	/* a thread without its name works as well */
	(void)pthread_setname_np(pthread_self(), name);
}

sigset_t rb_thread_stops(void)
{
	struct sigaction usual = {.sa_handler = SIG_DFL};
	sigset_t signals;

	sigemptyset(&signals);
	sigaddset(&signals, SIGINT);
	sigaddset(&signals, SIGTERM);
	sigaddset(&signals, SIGUSR1);
	/* a blocked signal waits even if it is ignored, so who waits for it would get it */
	if (sigaction(SIGHUP, NULL, &usual) == 0 && usual.sa_handler != SIG_IGN)
		sigaddset(&signals, SIGHUP);
	return signals;
}

const char *rb_thread_stop_name(int signal)
{
	return signal == SIGINT    ? "SIGINT"
	       : signal == SIGUSR1 ? "SIGUSR1"
	       : signal == SIGHUP  ? "SIGHUP"
	                           : "SIGTERM";
}
