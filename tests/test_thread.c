/* SPDX-License-Identifier: MIT */
/* src/base/thread.c: threads that no signal interrupts, with names */
#include "support.h"

#include <pthread.h>
#include <signal.h>

#include "base/thread.h"

struct seen {
	sigset_t mask;
	char name[32];
	const char *what;
};

static void *look(void *argument)
{
	struct seen *const seen = argument;

	pthread_sigmask(SIG_BLOCK, NULL, &seen->mask);
	rb_thread_name(seen->what);
	pthread_getname_np(pthread_self(), seen->name, sizeof seen->name);
	return seen;
}

static void run(struct seen *seen)
{
	pthread_t thread;
	void *result;

	assert_int_equal(rb_thread_start(&thread, look, seen), 0);
	assert_int_equal(pthread_join(thread, &result), 0);
	assert_ptr_equal(result, seen);
}

static void every_signal_is_blocked_there_and_none_more_here(void **state)
{
	struct seen seen = {.what = "x"};
	sigset_t before, after;

	(void)state;
	pthread_sigmask(SIG_BLOCK, NULL, &before);
	run(&seen);
	pthread_sigmask(SIG_BLOCK, NULL, &after);
	for (int s = 1; s <= SIGSYS; s++) {
		/* these two cannot be blocked */
		assert_int_equal(sigismember(&seen.mask, s), s != SIGKILL && s != SIGSTOP);
		assert_int_equal(sigismember(&after, s), sigismember(&before, s));
	}
}

static void a_name_begins_with_rb_is_plain_and_is_cut_at_15_bytes(void **state)
{
	static const char *const names[][2] = {
		{"film 2", "rb-film-2"},
		{"a name that is too long", "rb-a-name-that"},
		{"0123456789abcdef", "rb-0123456789ab"},
		{"\033[2J of a scene", "rb-2J-of-a-scen"},
		{"", "rb"},
	};

	(void)state;
	for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
		struct seen seen = {.what = names[k][0]};

		run(&seen);
		assert_string_equal(seen.name, names[k][1]);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_signal_is_blocked_there_and_none_more_here),
		cmocka_unit_test(a_name_begins_with_rb_is_plain_and_is_cut_at_15_bytes),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
