/* SPDX-License-Identifier: MIT */
/*
 * One run of a scene in a process of its own, so that a run that hangs or crashes is a result and
 * not the end.
 *
 * Main thread, which must be the only one of the process when a trial starts. The caller owns
 * struct rb_trial from rb_trial_start to rb_trial_end, and waits on `fd` in between.
 */
#ifndef RB_APP_TRIAL_H
#define RB_APP_TRIAL_H

#include <sys/types.h>

#include "app/balance.h"
#include "app/common.h"

enum { RB_TRIAL_TEXT_SIZE = 200 };

struct rb_trial_expect {
	bool ok, has_numbers;
	double measured, bound;
	char text[RB_TRIAL_TEXT_SIZE], message[RB_TRIAL_TEXT_SIZE];
};

/* What became of it. */
struct rb_trial_result {
	int exit_code; /* that `rbsim run` would give */
	bool refused;  /* as the scene expects */
	double wall_s;
	uint64_t state_hash, collisions, frames;
	double stepped_s; /* simulated by steps */
	struct rb_balance balance;
	char reason[RB_ERROR_TEXT_SIZE]; /* why it ended early, "" else */
	struct rb_trial_expect *expects; /* owned */
	int expect_count;
};

struct rb_trial {
	pid_t process;
	int fd; /* readable when there is something to read, or the end; -1: not started */
	uint64_t start_ns, deadline_ns;
	unsigned char *bytes; /* owned: what has come so far */
	size_t byte_count, byte_capacity;
};

/* `params` are K=V; of `options` the ways to run count, not the outputs. */
struct rb_trial_job {
	const char *path;
	const char *const *params;
	int param_count;
	double limit_s; /* of processor time; of wall time 16 times that. Then it is killed */
	const struct rb_options *options;
};

RB_CHECKED enum rb_status rb_trial_start(struct rb_trial *trial, const struct rb_trial_job *job,
                                         struct rb_error *err);
/* Takes what is there without waiting; `*ended`: nothing more will come. */
RB_CHECKED enum rb_status rb_trial_read(struct rb_trial *trial, bool *ended, struct rb_error *err);
/* Has it had its time? If not, its deadline is when to ask again. */
bool rb_trial_is_over(struct rb_trial *trial, const struct rb_trial_job *job);
/*
 * Ends it, by force where it has not ended by itself; RB_ERR_MEMORY is all that can go wrong with
 * the result.
 */
RB_CHECKED enum rb_status rb_trial_end(struct rb_trial *trial, const struct rb_trial_job *job,
                                       struct rb_trial_result *result, struct rb_error *err);
void rb_trial_result_release(struct rb_trial_result *result);

#endif
