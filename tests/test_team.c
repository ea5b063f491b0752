/* SPDX-License-Identifier: MIT */
/* src/base/team.c */
#include "support.h"

#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <stdatomic.h>
#include <sys/stat.h>

#include "base/memory.h"
#include "base/team.h"

enum { BLOCKS = 500 };

struct tally {
	int times
		[BLOCKS]; /* each block writes its own: no lock, and the thread sanitizer watches */
	int workers;
	bool worker_out_of_range;
	pthread_t caller;
	bool left_the_caller;
};

static void count_block(void *user, int block, int worker)
{
	struct tally *tally = user;

	tally->times[block]++;
	if (worker < 0 || worker >= tally->workers)
		tally->worker_out_of_range = true;
}

static void every_block_is_done_once_by_any_number_of_workers(void **state)
{
	static const int workers[] = {1, 2, 3, 8};
	static const int counts[] = {0, 1, 2, 3, 17, BLOCKS};
	struct rb_error err;

	(void)state;
	for (size_t w = 0; w < sizeof workers / sizeof *workers; w++) {
		struct rb_team *team;
		assert_ok(rb_team_create(&team, workers[w], &err));
		assert_int_equal(rb_team_workers(team), workers[w]);
		for (size_t c = 0; c < sizeof counts / sizeof *counts; c++) {
			struct tally tally = {.workers = workers[w]};
			rb_team_run(team, counts[c], count_block, &tally);
			for (int block = 0; block < BLOCKS; block++)
				assert_int_equal(tally.times[block], block < counts[c] ? 1 : 0);
			assert_false(tally.worker_out_of_range);
		}
		rb_team_destroy(team);
	}
}

static void count_part(void *user, size_t first, size_t end)
{
	struct tally *tally = user;

	/* nothing to do is no part; of parts side by side only a wrong one may write */
	if (first >= end)
		tally->worker_out_of_range = true;
	for (size_t k = first; k < end; k++)
		tally->times[k]++;
}

static void every_number_is_in_one_part(void **state)
{
	static const size_t counts[] = {0, 1, 6, 7, 8, 49, BLOCKS};
	struct rb_error err;

	(void)state;
	for (int workers = 1; workers <= 3; workers++) {
		struct rb_team *team;

		assert_ok(rb_team_create(&team, workers, &err));
		for (size_t c = 0; c < sizeof counts / sizeof *counts; c++) {
			struct tally tally = {.workers = workers};

			rb_team_share(team, counts[c], 7, count_part, &tally);
			for (size_t k = 0; k < BLOCKS; k++)
				assert_int_equal(tally.times[k], k < counts[c] ? 1 : 0);
			assert_false(tally.worker_out_of_range);
		}
		rb_team_destroy(team);
	}
}

/* Thousands of short jobs: who wakes late for one must not disturb the next. */
static void jobs_in_quick_succession_do_not_mix(void **state)
{
	struct rb_team *team;
	struct rb_error err;
	struct tally tally = {.workers = 4};

	(void)state;
	assert_ok(rb_team_create(&team, 4, &err));
	int expected[BLOCKS] = {0};
	for (int job = 0; job < 5000; job++) {
		const int count = job % 7;
		rb_team_run(team, count, count_block, &tally);
		for (int block = 0; block < count; block++)
			expected[block]++;
	}
	assert_memory_equal(tally.times, expected, sizeof expected);
	rb_team_destroy(team);
}

struct chain {
	double value[BLOCKS];
};

static void advance(void *user, int block, int worker)
{
	struct chain *chain = user;

	(void)worker;
	for (int i = 0; i < 100; i++)
		chain->value[block] = chain->value[block] * 0.999 + 1.0 / (block + 1);
}

static void what_one_job_wrote_the_next_one_reads(void **state)
{
	struct chain chains[2] = {0};
	struct rb_error err;

	(void)state;
	for (int c = 0; c < 2; c++) {
		struct rb_team *team;
		assert_ok(rb_team_create(&team, c == 0 ? 1 : 3, &err));
		for (int job = 0; job < 50; job++)
			rb_team_run(team, BLOCKS, advance, &chains[c]);
		rb_team_destroy(team);
	}
	assert_memory_equal(chains[0].value, chains[1].value, sizeof chains[0].value);
}

static void note_thread(void *user, int block, int worker)
{
	struct tally *tally = user;

	(void)block;
	if (worker != 0 || !pthread_equal(pthread_self(), tally->caller))
		tally->left_the_caller = true;
}

static void one_worker_is_the_caller(void **state)
{
	struct rb_team *team;
	struct rb_error err;
	struct tally tally = {.workers = 1, .caller = pthread_self()};

	(void)state;
	assert_ok(rb_team_create(&team, 1, &err));
	rb_team_run(team, 20, note_thread, &tally);
	assert_false(tally.left_the_caller);
	rb_team_destroy(team);
}

struct gate {
	pthread_mutex_t lock;
	pthread_cond_t changed;
	int inside;
	bool signals_blocked;
};

static void wait_for_the_other(void *user, int block, int worker)
{
	struct gate *gate = user;
	sigset_t mask;

	(void)block;
	pthread_sigmask(SIG_SETMASK, NULL, &mask);
	pthread_mutex_lock(&gate->lock);
	if (worker != 0)
		gate->signals_blocked = sigismember(&mask, SIGINT) && sigismember(&mask, SIGTERM);
	gate->inside++;
	pthread_cond_broadcast(&gate->changed);
	while (gate->inside < 2)
		pthread_cond_wait(&gate->changed, &gate->lock);
	pthread_mutex_unlock(&gate->lock);
}

/* Two blocks that wait for each other end only where two threads are at work. */
static void workers_run_at_the_same_time_and_block_signals(void **state)
{
	struct gate gate = {.lock = PTHREAD_MUTEX_INITIALIZER, .changed = PTHREAD_COND_INITIALIZER};
	struct rb_team *team;
	struct rb_error err;
	sigset_t before, after;

	(void)state;
	pthread_sigmask(SIG_SETMASK, NULL, &before);
	assert_ok(rb_team_create(&team, 2, &err));
	pthread_sigmask(SIG_SETMASK, NULL, &after);
	assert_int_equal(sigismember(&after, SIGINT), sigismember(&before, SIGINT));
	alarm(60);
	rb_team_run(team, 2, wait_for_the_other, &gate);
	alarm(0);
	assert_int_equal(gate.inside, 2);
	assert_true(gate.signals_blocked);
	rb_team_destroy(team);
}

struct late {
	atomic_bool other_came;
	bool other_finished;
};

static void leave_the_caller_early(void *user, int block, int worker)
{
	struct late *late = user;

	(void)block;
	if (worker == 0) {
		while (!atomic_load(&late->other_came))
			usleep(100);
	} else {
		atomic_store(&late->other_came, true);
		usleep(50000);
		late->other_finished = true;
	}
}

static void running_waits_for_blocks_that_others_are_still_at(void **state)
{
	struct late late = {0};
	struct rb_team *team;
	struct rb_error err;

	(void)state;
	assert_ok(rb_team_create(&team, 2, &err));
	alarm(60);
	rb_team_run(team, 2, leave_the_caller_early, &late);
	alarm(0);
	assert_true(late.other_finished);
	rb_team_destroy(team);
}

static void a_team_without_memory_says_so_and_leaves_nothing(void **state)
{
	const uint64_t bytes = rb_memory_counts().bytes_now;

	(void)state;
	for (uint64_t k = 1; k <= 2; k++) {
		struct rb_team *team;
		struct rb_error err;
		rb_memory_fail_at(k);
		const enum rb_status status = rb_team_create(&team, 3, &err);
		rb_memory_fail_at(0);
		assert_int_equal(status, RB_ERR_MEMORY);
		assert_null(team);
		assert_int_equal(rb_memory_counts().bytes_now, bytes);
	}
	rb_team_destroy(NULL);
}

static void processors_are_at_least_one_and_no_more_than_affinity_allows(void **state)
{
	cpu_set_t all, one;

	(void)state;
	assert_int_equal(sched_getaffinity(0, sizeof all, &all), 0);
	assert_in_range(rb_team_processors(), 1, CPU_COUNT(&all));
	CPU_ZERO(&one);
	for (size_t cpu = 0; cpu < CPU_SETSIZE && CPU_COUNT(&one) == 0; cpu++)
		if (CPU_ISSET(cpu, &all))
			CPU_SET(cpu, &one);
	assert_int_equal(sched_setaffinity(0, sizeof one, &one), 0);
	const int processors = rb_team_processors();
	sched_setaffinity(0, sizeof all, &all);
	assert_int_equal(processors, 1);
}

/* Each phase adds what the one before has left in all blocks: who begins too soon finds too little. */
enum { PHASES = 12, ROUNDS = 300 };

struct layers {
	int number[PHASES + 1][BLOCKS];
	const int *count;
};

static void add_layer(void *user, int phase, int block, int worker)
{
	struct layers *layers = user;
	int sum = 1;

	(void)worker;
	for (int k = 0; phase > 0 && k < layers->count[phase - 1]; k++)
		sum += layers->number[phase - 1][k];
	layers->number[phase][block] = sum % 1000;
}

static void a_phase_begins_when_the_one_before_has_ended(void **state)
{
	static const int workers[] = {2, 3, 8};
	int count[PHASES];
	struct layers *alone = calloc(1, sizeof *alone), *layers = calloc(1, sizeof *layers);
	struct rb_team *team;
	struct rb_error err;

	(void)state;
	assert_non_null(alone);
	assert_non_null(layers);
	for (int phase = 0; phase < PHASES; phase++)
		count[phase] = 1 + 7 * phase % 11;
	alone->count = layers->count = count;
	assert_ok(rb_team_create(&team, 1, &err));
	rb_team_run_phases(team, count, PHASES, add_layer, alone);
	rb_team_destroy(team);
	for (size_t w = 0; w < sizeof workers / sizeof *workers; w++) {
		assert_ok(rb_team_create(&team, workers[w], &err));
		for (int round = 0; round < ROUNDS; round++) {
			memset(layers->number, 0, sizeof layers->number);
			rb_team_run_phases(team, count, PHASES, add_layer, layers);
			assert_memory_equal(layers->number, alone->number, sizeof alone->number);
		}
		rb_team_destroy(team);
	}
	free(alone);
	free(layers);
}

/* A file below a root of its own, with the folders on its way. */
static void put(const char *root, const char *path, const char *text)
{
	char whole[512];

	snprintf(whole, sizeof whole, "%s%s", root, path);
	for (char *slash = strchr(whole + strlen(root) + 1, '/'); slash;
	     slash = strchr(slash + 1, '/')) {
		*slash = '\0';
		mkdir(whole, 0700);
		*slash = '/';
	}
	FILE *const file = fopen(whole, "w");
	assert_non_null(file);
	fputs(text, file);
	assert_int_equal(fclose(file), 0);
}

static void a_quota_of_version_2_holds_for_all_groups_below(void **state)
{
	char root[256];

	(void)state;
	support_folder(root);
	assert_int_equal(rb_team_quota(root), 0);
	put(root, "/proc/self/cgroup", "0::/users/job\n");
	assert_int_equal(rb_team_quota(root), 0);
	put(root, "/sys/fs/cgroup/users/job/cpu.max", "max 100000\n");
	put(root, "/sys/fs/cgroup/users/cpu.max", "max 100000\n");
	assert_int_equal(rb_team_quota(root), 0);
	put(root, "/sys/fs/cgroup/users/job/cpu.max", "450000 100000\n"); /* rounded up */
	assert_int_equal(rb_team_quota(root), 5);
	put(root, "/sys/fs/cgroup/users/job/cpu.max", "400000 100000\n");
	assert_int_equal(rb_team_quota(root), 4);
	put(root, "/sys/fs/cgroup/users/cpu.max", "700000 100000\n");
	assert_int_equal(rb_team_quota(root), 4);
	put(root, "/sys/fs/cgroup/users/cpu.max", "50000 25000\n");
	assert_int_equal(rb_team_quota(root), 2);
	put(root, "/sys/fs/cgroup/cpu.max", "1 100000\n");
	assert_int_equal(rb_team_quota(root), 1);
	/* what lies above the tree is none of it */
	put(root, "/sys/fs/cgroup/cpu.max", "max 100000\n");
	put(root, "/sys/fs/cpu.max", "100000 100000\n");
	assert_int_equal(rb_team_quota(root), 2);
	put(root, "/sys/fs/cgroup/users/cpu.max", "9000000000000 1000\n");
	put(root, "/sys/fs/cgroup/users/job/cpu.max", "-1 100000\n");
	assert_int_equal(rb_team_quota(root), 1024);
}

static void a_quota_of_version_1_is_that_of_the_controller_of_processors(void **state)
{
	static const char *const with[] = {"cpu", "cpu,cpuacct"};
	static const char *const without[] = {"cpuset", "memory", "cpuacct,cpu2"};
	char root[256], line[128];

	(void)state;
	support_folder(root);
	put(root, "/sys/fs/cgroup/cpu/job/cpu.cfs_quota_us", "250000\n");
	assert_int_equal(rb_team_quota(root), 0);
	for (size_t i = 0; i < 2; i++) {
		snprintf(line, sizeof line, "5:memory:/other\n4:%s:/job\n3:pids:/job\n", with[i]);
		put(root, "/proc/self/cgroup", line);
		put(root, "/sys/fs/cgroup/cpu/job/cpu.cfs_period_us", "100000\n");
		assert_int_equal(rb_team_quota(root), 3);
		put(root, "/sys/fs/cgroup/cpu/job/cpu.cfs_period_us", "no number\n");
		assert_int_equal(rb_team_quota(root), 0);
	}
	put(root, "/sys/fs/cgroup/cpu/job/cpu.cfs_period_us", "100000\n");
	for (size_t i = 0; i < 3; i++) {
		snprintf(line, sizeof line, "4:%s:/job\n", without[i]);
		put(root, "/proc/self/cgroup", line);
		assert_int_equal(rb_team_quota(root), 0);
	}
	/* the least of all lines; what is no line of three parts is passed over */
	put(root, "/proc/self/cgroup",
	    "nothing\n1:cpu\n4:cpu:/job\n0::/new\n2:cpu,cpuacct:/more\n");
	put(root, "/sys/fs/cgroup/new/cpu.max", "200000 100000\n");
	assert_int_equal(rb_team_quota(root), 2);
	put(root, "/sys/fs/cgroup/cpu/more/cpu.cfs_quota_us", "90000\n");
	put(root, "/sys/fs/cgroup/cpu/more/cpu.cfs_period_us", "90000\n");
	assert_int_equal(rb_team_quota(root), 1);
	put(root, "/sys/fs/cgroup/cpu/more/cpu.cfs_quota_us", "990000\n");
	assert_int_equal(rb_team_quota(root), 2);
	put(root, "/sys/fs/cgroup/cpu/more/cpu.cfs_quota_us", "-1\n");
	assert_int_equal(rb_team_quota(root), 2);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_block_is_done_once_by_any_number_of_workers),
		cmocka_unit_test(every_number_is_in_one_part),
		cmocka_unit_test(jobs_in_quick_succession_do_not_mix),
		cmocka_unit_test(what_one_job_wrote_the_next_one_reads),
		cmocka_unit_test(a_phase_begins_when_the_one_before_has_ended),
		cmocka_unit_test(one_worker_is_the_caller),
		cmocka_unit_test(workers_run_at_the_same_time_and_block_signals),
		cmocka_unit_test(running_waits_for_blocks_that_others_are_still_at),
		cmocka_unit_test(a_team_without_memory_says_so_and_leaves_nothing),
		cmocka_unit_test(a_quota_of_version_2_holds_for_all_groups_below),
		cmocka_unit_test(a_quota_of_version_1_is_that_of_the_controller_of_processors),
		cmocka_unit_test(processors_are_at_least_one_and_no_more_than_affinity_allows),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
