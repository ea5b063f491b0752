/* SPDX-License-Identifier: MIT */
/*
 * Blocks are handed out by one atomic counter for each phase, and a second counter tells when all
 * are done; a phase begins when the counter of the one before has reached its count. Static
 * partitions are not used, because blocks differ in cost (islands), and work stealing, because one
 * counter costs less than a deque for the few hundred blocks of a step. Which worker runs a block
 * is arbitrary, so blocks must not depend on it.
 *
 * Jobs follow each other within microseconds while a sleeping thread needs tens of them to wake, so
 * threads poll first and sleep on a condition variable afterwards. A worker that wakes too late for
 * a job is not waited for: only those that joined (`active`) are.
 */
#include "base/team.h"

#include <limits.h>
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/error.h"
#include "base/memory.h"
#include "base/thread.h"

struct member {
	struct rb_team *team;
	int worker; /* from 1; the caller is 0 */
	pthread_t thread;
};

/*
 * Polls before a thread sleeps, about 0.1 ms of pauses, longer than the sequential part between two
 * jobs of a step; and polls between two calls of sched_yield, for when there are more threads than
 * processors and the one waited for is not running.
 */
enum { SPINS_MOST = 4000, SPINS_POLITE = 2000 };

struct job {
	rb_team_work *work;        /* of one phase; NULL: */
	rb_team_phase_work *phase; /* of several */
	void *user;
	const int *block_count; /* [phase_count] */
	int phase_count;
};

/* Next block to hand out and blocks done; reset to 0 under the lock while no member is active. */
struct counters {
	atomic_int next, done;
	char apart[64 - 2 * sizeof(atomic_int)]; /* in lines of their own */
};

struct rb_team {
	/* set before any thread starts, then only read */
	int worker_count;
	struct member *members; /* owned: worker_count - 1 */

	struct counters counters[RB_TEAM_PHASES];
	atomic_uint_fast64_t posted; /* the job's number, for those who look before they sleep */
	atomic_bool left;            /* the same for the end */

	/* protected by lock */
	pthread_mutex_t lock;
	pthread_cond_t opened, finished;
	struct job job;
	uint64_t job_number;
	bool open; /* the job still may be joined */
	atomic_int
		active; /* members at it; the caller does not wait for those who slept through it */
	bool stop;

	/* owned by the creating thread */
	int started;
};

/* One poll; the pause instruction frees the other hardware thread of the core. */
static void look_again(int *spins)
{
#if defined(__x86_64__)
	__builtin_ia32_pause();
#endif
	++*spins;
}

/*
 * Takes blocks until none is left, phase by phase. The release on `done` and the acquire on reading
 * it make the results of a phase visible to the next one.
 */
static void do_blocks(struct rb_team *team, const struct job *job, int worker)
{
	RB_ASSERT(worker >= 0 && worker < team->worker_count);

	for (int phase = 0; phase < job->phase_count; phase++) {
		struct counters *counters = &team->counters[phase];
		const int count = job->block_count[phase];
		int spins = 0;

		for (;;) {
			const int block = atomic_fetch_add_explicit(&counters->next, 1,
			                                            memory_order_relaxed);
			if (block >= count)
				break;
			if (job->work)
				job->work(job->user, block, worker);
			else
				job->phase(job->user, phase, block, worker);
			atomic_fetch_add_explicit(&counters->done, 1, memory_order_release);
		}
		while (phase + 1 < job->phase_count &&
		       atomic_load_explicit(&counters->done, memory_order_acquire) < count) {
			look_again(&spins);
			/* there may be more threads than processors */
			if (spins % SPINS_POLITE == 0)
				sched_yield();
		}
	}
}

/* Polls for a job later than `seen`, or for the end, before the caller sleeps. */
static void await_job(struct rb_team *team, uint64_t seen)
{
	for (int spins = 0; spins < SPINS_MOST;) {
		if (atomic_load_explicit(&team->posted, memory_order_relaxed) != seen ||
		    atomic_load_explicit(&team->left, memory_order_relaxed))
			return;
		look_again(&spins);
	}
}

/* Body of a worker's thread. */
static void *live(void *argument)
{
	const struct member *me = argument;
	struct rb_team *team = me->team;
	uint64_t seen = 0;

	rb_thread_name("worker");
	pthread_mutex_lock(&team->lock);
	for (;;) {
		while (!team->stop && !(team->open && team->job_number != seen))
			pthread_cond_wait(&team->opened, &team->lock);
		if (team->stop)
			break;
		seen = team->job_number;
		const struct job job = team->job;
		atomic_fetch_add(&team->active, 1);
		pthread_mutex_unlock(&team->lock);
		do_blocks(team, &job, me->worker);
		pthread_mutex_lock(&team->lock);
		if (atomic_fetch_sub(&team->active, 1) == 1)
			pthread_cond_signal(&team->finished);
		pthread_mutex_unlock(&team->lock);
		await_job(team, seen);
		pthread_mutex_lock(&team->lock);
	}
	pthread_mutex_unlock(&team->lock);
	return NULL;
}

enum rb_status rb_team_create(struct rb_team **team, int worker_count, struct rb_error *err)
{
	RB_ASSERT(worker_count >= 1);
	*team = NULL;

	struct rb_team *made = rb_memory_take(1, sizeof *made);
	struct member *members = rb_memory_take((size_t)worker_count - 1, sizeof *members);
	if (!made || !members) {
		rb_memory_free(made);
		rb_memory_free(members);
		return RB_FAIL(err, RB_ERR_MEMORY,
		               "cannot make a team of %d threads: out of memory", worker_count);
	}
	made->worker_count = worker_count;
	made->members = members;
	pthread_mutex_init(&made->lock, NULL);
	pthread_cond_init(&made->opened, NULL);
	pthread_cond_init(&made->finished, NULL);
	for (int i = 0; i < worker_count - 1; i++) {
		members[i] = (struct member){.team = made, .worker = i + 1};
		const int failed = rb_thread_start(&members[i].thread, live, &members[i]);
		if (failed) {
			rb_team_destroy(made);
			return RB_FAIL(err, RB_ERR_MEMORY, "cannot start thread %d of %d: %s",
			               i + 2, worker_count, strerror(failed));
		}
		made->started++;
	}
	*team = made;
	return RB_OK;
}

void rb_team_destroy(struct rb_team *team)
{
	if (!team)
		return;
	atomic_store(&team->left, true);
	pthread_mutex_lock(&team->lock);
	team->stop = true;
	pthread_cond_broadcast(&team->opened);
	pthread_mutex_unlock(&team->lock);
	for (int i = 0; i < team->started; i++)
		pthread_join(team->members[i].thread, NULL);
	pthread_cond_destroy(&team->finished);
	pthread_cond_destroy(&team->opened);
	pthread_mutex_destroy(&team->lock);
	rb_memory_free(team->members);
	rb_memory_free(team);
}

int rb_team_workers(const struct rb_team *team)
{
	return team->worker_count;
}

/* Runs the job in the caller where there is no other thread or just one block; false otherwise. */
static bool run_alone(const struct rb_team *team, const struct job *job)
{
	if (team->worker_count > 1 && (job->phase_count > 1 || job->block_count[0] > 1))
		return false;
	for (int phase = 0; phase < job->phase_count; phase++)
		for (int block = 0; block < job->block_count[phase]; block++)
			if (job->work)
				job->work(job->user, block, 0);
			else
				job->phase(job->user, phase, block, 0);
	return true;
}

/*
 * Publishes the job under the lock, works at it, closes it, and waits for the members that joined.
 */
static void run_job(struct rb_team *team, const struct job *job)
{
	if (run_alone(team, job))
		return;
	pthread_mutex_lock(&team->lock);
	RB_ASSERT(!team->open);                     /* else called from a block */
	RB_ASSERT(atomic_load(&team->active) == 0); /* else counters are reset under a worker */
	team->job = *job;
	team->job_number++;
	team->open = true;
	for (int phase = 0; phase < job->phase_count; phase++) {
		atomic_store_explicit(&team->counters[phase].next, 0, memory_order_relaxed);
		atomic_store_explicit(&team->counters[phase].done, 0, memory_order_relaxed);
	}
	atomic_store_explicit(&team->posted, team->job_number, memory_order_relaxed);
	pthread_cond_broadcast(&team->opened);
	pthread_mutex_unlock(&team->lock);

	do_blocks(team, job, 0);

	/* All blocks are handed out: who has not come yet need not, who is at one is waited for. */
	pthread_mutex_lock(&team->lock);
	team->open = false;
	pthread_mutex_unlock(&team->lock);
	for (int spins = 0; spins < SPINS_MOST && atomic_load(&team->active) > 0;)
		look_again(&spins);
	pthread_mutex_lock(&team->lock);
	while (atomic_load(&team->active) > 0)
		pthread_cond_wait(&team->finished, &team->lock);
	pthread_mutex_unlock(&team->lock);
}

void rb_team_run(struct rb_team *team, int block_count, rb_team_work *work, void *user)
{
	RB_ASSERT(block_count >= 0 && work);

	const struct job job = {
		.work = work, .user = user, .block_count = &block_count, .phase_count = 1};

	run_job(team, &job);
}

struct shared {
	rb_team_part *part;
	void *user;
	size_t count, per_block;
};

static void run_part(void *user, int block, int worker)
{
	const struct shared *shared = user;
	const size_t first = (size_t)block * shared->per_block;
	const size_t left = shared->count - first;

	(void)worker;
	shared->part(shared->user, first,
	             first + (left < shared->per_block ? left : shared->per_block));
}

void rb_team_share(struct rb_team *team, size_t count, size_t per_block, rb_team_part *part,
                   void *user)
{
	struct shared shared = {part, user, count, per_block};

	RB_ASSERT(per_block > 0 && count / per_block < INT_MAX);
	rb_team_run(team, (int)((count + per_block - 1) / per_block), run_part, &shared);
}

void rb_team_run_phases(struct rb_team *team, const int *block_count, int phase_count,
                        rb_team_phase_work *work, void *user)
{
	const struct job job = {.phase = work,
	                        .user = user,
	                        .block_count = block_count,
	                        .phase_count = phase_count};

	RB_ASSERT(phase_count >= 0 && phase_count <= RB_TEAM_PHASES && work);
	for (int phase = 0; phase < phase_count; phase++)
		RB_ASSERT_COSTLY(block_count[phase] >= 0);
	if (phase_count > 0)
		run_job(team, &job);
}

/* Quota over period of one cgroup, rounded up; 0 when it sets none. */
static int quota_in(const char *folder)
{
	char path[4200];
	long long quota = -1, period = -1;

	/*
	 * version 2: "max 100000" or "150000 100000" in one file; version 1: two files, -1 for no
	 * quota
	 */
	snprintf(path, sizeof path, "%s/cpu.max", folder);
	FILE *file = fopen(path, "re");
	if (file) {
		if (fscanf(file, "%lld %lld", &quota, &period) != 2)
			quota = -1;
		fclose(file);
	} else {
		snprintf(path, sizeof path, "%s/cpu.cfs_quota_us", folder);
		file = fopen(path, "re");
		if (file) {
			if (fscanf(file, "%lld", &quota) != 1)
				quota = -1;
			fclose(file);
		}
		snprintf(path, sizeof path, "%s/cpu.cfs_period_us", folder);
		file = fopen(path, "re");
		if (file) {
			if (fscanf(file, "%lld", &period) != 1)
				period = -1;
			fclose(file);
		}
	}
	if (quota <= 0 || period <= 0)
		return 0;
	const long long processors = quota / period + (quota % period != 0);
	return processors < 1024 ? (int)processors : 1024;
}

/* The least quota from our cgroup up to the top of its tree; 0 when there is none. */
static int quota_along(const char *root, const char *tree, const char *group)
{
	char folder[4160];
	int least = 0;

	if (snprintf(folder, sizeof folder, "%s%s%s", root, tree, group) >= (int)sizeof folder)
		return 0;
	const size_t top_length = strlen(root) + strlen(tree);
	for (;;) {
		const int quota = quota_in(folder);
		if (quota > 0 && (least == 0 || quota < least))
			least = quota;
		char *slash = strrchr(folder, '/');
		if (!slash || (size_t)(slash - folder) < top_length)
			return least;
		*slash = '\0';
	}
}

/* Lines of /proc/self/cgroup are number:controllers:path; version 2 is "0::path" (cgroups(7)). */
int rb_team_quota(const char *root)
{
	char line[4096];
	int least = 0;

	snprintf(line, sizeof line, "%s/proc/self/cgroup", root);
	FILE *file = fopen(line, "re");

	while (file && fgets(line, sizeof line, file)) {
		line[strcspn(line, "\n")] = '\0';
		char *controllers = strchr(line, ':');
		char *group = controllers ? strchr(controllers + 1, ':') : NULL;
		if (!group)
			continue;
		*group++ = '\0';
		controllers++;
		int quota = 0;
		if (*controllers == '\0')
			quota = quota_along(root, "/sys/fs/cgroup", group);
		else if (strcmp(controllers, "cpu") == 0 || strncmp(controllers, "cpu,", 4) == 0)
			quota = quota_along(root, "/sys/fs/cgroup/cpu", group);
		if (quota > 0 && (least == 0 || quota < least))
			least = quota;
	}
	if (file)
		fclose(file);
	return least;
}

int rb_team_processors(void)
{
	cpu_set_t allowed;
	long count = 0;

	CPU_ZERO(&allowed);
	if (sched_getaffinity(0, sizeof allowed, &allowed) == 0)
		count = CPU_COUNT(&allowed);
	else
		count = sysconf(_SC_NPROCESSORS_ONLN); /* more processors than a cpu_set_t holds */
	const int quota = rb_team_quota("");
	if (quota > 0 && quota < count)
		count = quota;
	return count < 1 ? 1 : (int)count;
}
