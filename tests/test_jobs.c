/* SPDX-License-Identifier: MIT */
/* src/sweep/jobs.c: runs of a sweep; this test stands in for them, started again as `run` */
#include "support.h"

#include <errno.h>
#include <ftw.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include "sweep/jobs.h"

/* ---- in a process of its own: a run that does what the parameter `do` says ---- */

static volatile sig_atomic_t asked;

static void ask(int signal)
{
	asked = signal;
}

static const char *word_of(int count, char **words, const char *start)
{
	for (int i = 0; i < count; i++)
		if (strncmp(words[i], start, strlen(start)) == 0)
			return words[i] + strlen(start);
	return NULL;
}

static int stand_in(int count, char **words)
{
	const char *act = word_of(count, words, "--param=do=");

	for (int i = 0; i < count; i++)
		fprintf(stderr, "[%s]", words[i]);
	fprintf(stderr, "\n");
	if (!act || strcmp(act, "silence") == 0)
		return 3;
	if (strcmp(act, "crash") == 0)
		raise(SIGKILL);
	if (strcmp(act, "wait") == 0) {
		sigset_t none, term;

		sigemptyset(&term);
		sigaddset(&term, SIGTERM);
		sigprocmask(SIG_BLOCK, &term, &none);
		signal(SIGTERM, ask);
		while (!asked)
			sigsuspend(&none);
		printf("{\"status\":\"interrupted\",\"exit_status\":75}\n");
		return 75;
	}
	if (strcmp(act, "fail") == 0) {
		printf("{\"status\":\"failed\",\"error\":\"as told\",\"exit_status\":65}\n");
		return 65;
	}
	if (strcmp(act, "lack") == 0) {
		printf("{\"status\":\"failed\",\"error\":\"no room\",\"exit_status\":74}\n");
		return 74;
	}
	printf("{\"status\":\"complete\",\"exit_status\":0}\n");
	return 0;
}

/* ---- the sweep ---- */

struct sweep {
	char folder[256], told[400];
	struct rb_plan plan;
	struct rb_jobs_order order;
	struct rb_jobs_tally tally;
	struct rb_error err;
};

static void keep_told(void *user, uint64_t index, const struct rb_point *point)
{
	struct sweep *sweep = user;
	const size_t used = strlen(sweep->told);

	snprintf(sweep->told + used, sizeof sweep->told - used, "%d:%d:%s;", (int)index,
	         point->exit_code, point->reason);
}

static void open_sweep(struct sweep *sweep, const char *param, bool films)
{
	static const char *const words[] = {"--duration=3"};
	const struct rb_plan_wish wish = {.version = "1",
	                                  .scene = "s.lua",
	                                  .params = &param,
	                                  .param_count = 1,
	                                  .seeds = 1,
	                                  .base_seed = 4,
	                                  .words = words,
	                                  .word_count = 1,
	                                  .films = films};

	*sweep = (struct sweep){0};
	support_folder(sweep->folder);
	if (rb_plan_init(&sweep->plan, &wish, NULL, 0, &sweep->err) != RB_OK)
		fail_msg("%s", sweep->err.text);
	sweep->order = (struct rb_jobs_order){.folder = sweep->folder,
	                                      .plan = &sweep->plan,
	                                      .jobs = 2,
	                                      .threads = 1,
	                                      .shares = 1,
	                                      .checkpoint_every_s = (double)NAN,
	                                      .point_time_s = (double)NAN,
	                                      .point_disk_bytes = (double)NAN,
	                                      .told = keep_told,
	                                      .user = sweep};
}

static int drop(const char *path, const struct stat *about, int kind, struct FTW *walk)
{
	(void)about, (void)kind, (void)walk;
	return remove(path);
}

static void close_sweep(struct sweep *sweep)
{
	rb_plan_release(&sweep->plan);
	assert_int_equal(nftw(sweep->folder, drop, 8, FTW_DEPTH | FTW_PHYS), 0);
}

static void run(struct sweep *sweep)
{
	sigset_t after;

	*sweep->told = '\0';
	rb_jobs_hold_signals(&sweep->order.mask_before);
	if (rb_jobs_run(&sweep->order, &sweep->tally, &sweep->err) != RB_OK)
		fail_msg("%s", sweep->err.text);
	/* signals are as they were, and no run is left */
	sigprocmask(SIG_BLOCK, NULL, &after);
	assert_int_equal(sigismember(&after, SIGTERM), 0);
	assert_int_equal(sigismember(&after, SIGCHLD), 0);
	assert_int_equal(sweep->tally.running, 0);
	assert_int_equal(sweep->tally.started, sweep->tally.ended);
}

static enum rb_point_state state_of(struct sweep *sweep, uint64_t index)
{
	struct rb_point point;
	struct rb_error err;

	assert_ok(rb_point_look(sweep->folder, &sweep->plan, index, NULL, &point, &err));
	return point.state;
}

/* What a run has written on its standard error, to be freed. */
static char *log_of(struct sweep *sweep, uint64_t index)
{
	char path[RB_FOLDER_PATH_SIZE], *text;
	struct rb_error err;
	size_t size;

	rb_folder_path(&sweep->plan, sweep->folder, index, ".log", path);
	assert_ok(rb_folder_read(path, 100000, &text, &size, &err));
	return text;
}

static void every_point_is_run_once_with_its_values(void **state)
{
	struct sweep sweep;
	char wanted[300];

	(void)state;
	open_sweep(&sweep, "do=a b,\"c\",$HOME;ls,*,e", false);
	sweep.order.checkpoint_every_s = 2.5;
	sweep.order.threads = 3;
	run(&sweep);
	assert_int_equal(sweep.tally.total, 5);
	assert_int_equal(sweep.tally.started, 5);
	assert_int_equal(sweep.tally.done, 5);
	assert_int_equal(sweep.tally.failed + sweep.tally.due + sweep.tally.elsewhere, 0);
	for (uint64_t k = 0; k < 5; k++) {
		char number[RB_AXIS_NUMBER_SIZE], *log = log_of(&sweep, k);

		assert_int_equal(state_of(&sweep, k), RB_POINT_DONE);
		snprintf(wanted, sizeof wanted,
		         "[rbsim][run][--json][--force][--duration=3][--threads=3]"
		         "[--checkpoint-every=2.5][--seed=%llu][--param=do=%s][--][scene/s.lua]\n",
		         (unsigned long long)rb_plan_seed(&sweep.plan, k),
		         rb_plan_value(&sweep.plan, k, 0, number));
		assert_string_equal(log, wanted);
		rb_memory_free(log);
	}
	/* who comes later finds nothing to do */
	run(&sweep);
	assert_int_equal(sweep.tally.started, 0);
	assert_int_equal(sweep.tally.done, 5);
	close_sweep(&sweep);
}

static void films_have_a_folder_of_their_own(void **state)
{
	struct sweep sweep;
	char path[RB_FOLDER_PATH_SIZE];
	struct stat about;

	(void)state;
	open_sweep(&sweep, "do=ok", true);
	sweep.plan.records = true;
	run(&sweep);
	char *log = log_of(&sweep, 0);
	assert_non_null(strstr(log, "[--output=../point-00000.h5][--][../scene/s.lua]\n"));
	rb_memory_free(log);
	assert_int_equal(stat(rb_folder_path(&sweep.plan, sweep.folder, 0, "", path), &about), 0);
	assert_true(S_ISDIR(about.st_mode));
	close_sweep(&sweep);
}

static void failures_are_told_and_tried_again_where_that_may_mend_them(void **state)
{
	struct sweep sweep;

	(void)state;
	open_sweep(&sweep, "do=fail,ok,lack,crash,silence", false);
	sweep.order.jobs = 1;
	run(&sweep);
	assert_int_equal(sweep.tally.done, 1);
	assert_int_equal(sweep.tally.failed, 4);
	assert_string_equal(sweep.told, "0:65:as told;1:0:;2:74:no room;3:137:ended by signal 9;"
	                                "4:3:ended with status 3 and without a result;");
	for (uint64_t k = 0; k < 5; k++)
		assert_int_equal(state_of(&sweep, k), k == 1 ? RB_POINT_DONE : RB_POINT_FAILED);
	assert_int_equal(sweep.tally.lack, 74);
	assert_int_equal(sweep.tally.lacking, 2);
	/* what the scene says it would say again; a crash may not happen again */
	run(&sweep);
	assert_int_equal(sweep.tally.started, 3);
	assert_int_equal(sweep.tally.done, 1);
	assert_int_equal(sweep.tally.failed, 4);
	assert_ptr_equal(strstr(sweep.told, "0:65:as told;"), sweep.told);
	sweep.order.retry = true;
	run(&sweep);
	assert_int_equal(sweep.tally.started, 4);
	close_sweep(&sweep);
}

static void a_share_has_every_nth_point(void **state)
{
	struct sweep sweep;

	(void)state;
	open_sweep(&sweep, "do=1:8:1", false);
	sweep.order.shares = 3;
	for (uint64_t share = 0; share < 3; share++) {
		sweep.order.share = share;
		run(&sweep);
		assert_int_equal(sweep.tally.total, share < 2 ? 3 : 2);
		assert_int_equal(sweep.tally.started, sweep.tally.total);
		for (uint64_t k = 0; k < 8; k++)
			assert_int_equal(state_of(&sweep, k),
			                 k % 3 <= share ? RB_POINT_DONE : RB_POINT_MISSING);
	}
	sweep.order.shares = 100;
	sweep.order.share = 50;
	run(&sweep);
	assert_int_equal(sweep.tally.total, 0);
	close_sweep(&sweep);
}

static void what_another_process_runs_is_left_to_it(void **state)
{
	struct sweep sweep;
	struct rb_error err;
	int lock;

	(void)state;
	open_sweep(&sweep, "do=1:3:1", false);
	assert_ok(rb_point_lock(sweep.folder, &sweep.plan, 1, &lock, &err));
	assert_true(lock >= 0);
	run(&sweep);
	assert_int_equal(sweep.tally.started, 2);
	assert_int_equal(sweep.tally.done, 2);
	assert_int_equal(sweep.tally.elsewhere, 1);
	assert_int_equal(state_of(&sweep, 1), RB_POINT_RUNNING);
	rb_point_unlock(lock);
	run(&sweep);
	assert_int_equal(sweep.tally.started, 1);
	assert_int_equal(sweep.tally.done, 3);
	close_sweep(&sweep);
}

/* It waits for ever, or until it is told. */
static void a_run_that_takes_too_long_is_ended(void **state)
{
	struct sweep sweep;

	(void)state;
	open_sweep(&sweep, "do=wait", false);
	sweep.order.point_time_s = 0.25;
	run(&sweep);
	assert_int_equal(sweep.tally.failed, 1);
	assert_string_equal(sweep.told, "0:124:took longer than 0.25 s;");
	assert_int_equal(state_of(&sweep, 0), RB_POINT_FAILED);
	close_sweep(&sweep);
}

static void call_for_an_end(void *user, const struct rb_jobs_tally *tally)
{
	(void)user;
	if (tally->running == 2 && tally->signal == 0)
		kill(getpid(), SIGTERM);
}

static void a_signal_goes_on_to_the_runs_and_no_other_is_started(void **state)
{
	struct sweep sweep;

	(void)state;
	open_sweep(&sweep, "do=wait,wait,ok,ok", false);
	sweep.order.tick_ms = 10;
	sweep.order.tick = call_for_an_end;
	run(&sweep);
	assert_int_equal(sweep.tally.signal, SIGTERM);
	assert_int_equal(sweep.tally.started, 2);
	assert_int_equal(sweep.tally.done + sweep.tally.failed, 0);
	assert_int_equal(sweep.tally.due, 2);
	/* they go on another time, and the others were never begun */
	assert_int_equal(state_of(&sweep, 0), RB_POINT_BEGUN);
	assert_int_equal(state_of(&sweep, 1), RB_POINT_BEGUN);
	assert_int_equal(state_of(&sweep, 2), RB_POINT_MISSING);
	close_sweep(&sweep);
}

static void any_lack_of_memory_is_told(void **state)
{
	enum rb_status status = RB_ERR_MEMORY;
	struct sweep sweep;
	int failed = 0;

	(void)state;
	open_sweep(&sweep, "do=ok,fail", false);
	rb_jobs_hold_signals(&sweep.order.mask_before);
	for (uint64_t k = 1; status != RB_OK; k++) {
		sigset_t before;

		rb_memory_fail_at(k);
		status = rb_jobs_run(&sweep.order, &sweep.tally, &sweep.err);
		rb_memory_fail_at(0);
		assert_true(status == RB_OK || status == RB_ERR_MEMORY);
		assert_int_equal(waitpid(-1, NULL, WNOHANG), -1);
		assert_int_equal(errno, ECHILD);
		failed += status != RB_OK;
		rb_jobs_hold_signals(&before);
	}
	assert_true(failed > 3);
	sigprocmask(SIG_SETMASK, &sweep.order.mask_before, NULL);
	close_sweep(&sweep);
}

int main(int count, char **words)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_point_is_run_once_with_its_values),
		cmocka_unit_test(films_have_a_folder_of_their_own),
		cmocka_unit_test(failures_are_told_and_tried_again_where_that_may_mend_them),
		cmocka_unit_test(a_share_has_every_nth_point),
		cmocka_unit_test(what_another_process_runs_is_left_to_it),
		cmocka_unit_test(a_run_that_takes_too_long_is_ended),
		cmocka_unit_test(a_signal_goes_on_to_the_runs_and_no_other_is_started),
		cmocka_unit_test(any_lack_of_memory_is_told),
	};

	if (count > 1 && strcmp(words[1], "run") == 0)
		return stand_in(count, words);
	return cmocka_run_group_tests(tests, NULL, NULL);
}
