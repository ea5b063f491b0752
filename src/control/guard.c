/* SPDX-License-Identifier: MIT */
/*
 * A process that is killed by SIGKILL runs no handler, so only another process can reset the
 * terminal after it. The guard is a forked copy that holds the reading end of a pipe: end of file
 * without a byte before it means that the owner died in silence. It must outlive the owner,
 * therefore it ignores the signals that a terminal sends to the whole group, and it keeps nothing
 * open but the terminal and the pipe.
 */
#include "control/guard.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/error.h"

/*
 * The guard's process after fork; does not return. Only async-signal-safe calls, because the owner
 * may have had threads. `heard`: the reading end of the pipe.
 */
static void watch(int heard, const char *reset, size_t size, const struct termios *modes)
{
	RB_ASSERT(heard >= 0);
	/*
	 * meant for the owner, who may need a moment; SIGTTOU: the shell may have the terminal
	 * already
	 */
	static const int ignored[] = {SIGINT,  SIGQUIT, SIGTERM, SIGTTOU,
	                              SIGTTIN, SIGPIPE, SIGUSR1, SIGUSR2};
	sigset_t none;
	char word;
	ssize_t got;

	/*
	 * handlers of the owner's, such as the one of curses for SIGTSTP, would do their work a
	 * second time here
	 */
	for (int number = 1; number < NSIG; number++)
		signal(number, SIG_DFL);
	for (size_t i = 0; i < sizeof ignored / sizeof *ignored; i++)
		signal(ignored[i], SIG_IGN);
	sigemptyset(&none);
	sigprocmask(SIG_SETMASK, &none, NULL);
	/* what the owner has open must end with the owner */
	if (heard > STDERR_FILENO + 1)
		close_range(STDERR_FILENO + 1, (unsigned)heard - 1, 0);
	close_range((unsigned)heard + 1, UINT_MAX, 0);
	do
		got = read(heard, &word, 1);
	while (got < 0 && errno == EINTR);
	if (got == 0) {
		(void)!write(STDOUT_FILENO, reset, size);
		if (modes)
			tcsetattr(STDIN_FILENO, TCSANOW, modes);
	}
	_exit(0);
}

void rb_guard_start(struct rb_guard *guard, const char *reset, size_t size,
                    const struct termios *modes)
{
	sigset_t all, before;
	int ends[2];

	*guard = (struct rb_guard){0};
	if (pipe2(ends, O_CLOEXEC) != 0)
		return;
	/*
	 * no signal may reach the child between fork and the reset of its handlers, which are the
	 * owner's
	 */
	sigfillset(&all);
	sigprocmask(SIG_SETMASK, &all, &before);
	const pid_t process = fork();
	if (process == 0)
		watch(ends[0], reset, size, modes);
	sigprocmask(SIG_SETMASK, &before, NULL);
	close(ends[0]);
	if (process < 0) {
		close(ends[1]);
		return;
	}
	*guard = (struct rb_guard){.process = process, .tell = ends[1]};
}

void rb_guard_dismiss(const struct rb_guard *guard)
{
	if (guard->process > 0)
		(void)!write(guard->tell, "", 1);
}

void rb_guard_stop(struct rb_guard *guard)
{
	if (guard->process <= 0)
		return;
	rb_guard_dismiss(guard);
	close(guard->tell);
	while (waitpid(guard->process, NULL, 0) < 0 && errno == EINTR)
		;
	*guard = (struct rb_guard){0};
}
