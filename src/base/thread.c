/* SPDX-License-Identifier: MIT */
#include "base/thread.h"

#include <signal.h>
#include <stdbool.h>
#include <string.h>

enum { NAME_SIZE = 16 }; /* of Linux, with the zero byte */

int rb_thread_start(pthread_t *thread, void *(*work)(void *), void *argument)
{
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
	 * What others print unseen, and cut: names of a scene's cameras are among them. All but
	 * letters and digits parts words.
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
