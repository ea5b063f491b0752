/* SPDX-License-Identifier: MIT */
/*
 * A team of worker threads: run f(user, block, worker) over n blocks and wait for all. Work is
 * split by data, never by the number of workers; each block's result must not depend on which
 * worker ran it or when. With one worker everything runs in the caller and no thread exists.
 */
#ifndef RB_BASE_TEAM_H
#define RB_BASE_TEAM_H

#include <stddef.h>

#include <rbsim/error.h>

struct rb_team; /* owned by whoever created it; rb_team_run from that thread only */

typedef void rb_team_work(void *user, int block, int worker);
typedef void rb_team_phase_work(void *user, int phase, int block, int worker);
typedef void rb_team_part(void *user, size_t first, size_t end);

enum { RB_TEAM_PHASES = 128 };

RB_CHECKED enum rb_status rb_team_create(struct rb_team **team, int worker_count,
                                         struct rb_error *err);
void rb_team_destroy(struct rb_team *team); /* NULL is fine */
int rb_team_workers(const struct rb_team *team);
/*
 * Blocks are handed out by an atomic counter; worker is in [0, workers), the caller is one of them.
 */
void rb_team_run(struct rb_team *team, int block_count, rb_team_work *work, void *user);
/* The numbers below `count` in blocks of `per_block`, the last one of what is left. */
void rb_team_share(struct rb_team *team, size_t count, size_t per_block, rb_team_part *part,
                   void *user);
/*
 * Several phases, at most RB_TEAM_PHASES: no block of one begins before all of those before have
 * ended.
 */
void rb_team_run_phases(struct rb_team *team, const int *block_count, int phase_count,
                        rb_team_phase_work *work, void *user);

/* Processors that this process may use (affinity, and a cgroup's quota rounded up), at least 1. */
int rb_team_processors(void);
/*
 * That quota alone, 0: there is none. `root` stands before /proc and /sys, which is "" but for
 * tests.
 */
int rb_team_quota(const char *root);

#endif
