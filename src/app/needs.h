/* SPDX-License-Identifier: MIT */
/*
 * What a run will take: time and memory from trials (app/estimate), memory and disk space of what
 * records it. Main thread, the only one of the process.
 */
#ifndef RB_APP_NEEDS_H
#define RB_APP_NEEDS_H

#include "app/estimate.h"
#include "flow/run_info.h"

struct rb_needs {
	struct rb_estimate run; /* its memory with recorder and reel of frames */
	uint64_t disk_bytes;    /* 0: nothing is recorded */
	uint64_t steps;         /* of the longest kind, rollbacks apart */
};

RB_CHECKED enum rb_status rb_needs_take(struct rb_needs *needs, const struct rb_loaded *loaded,
                                        const struct rb_run_info *info, struct rb_error *err);

#endif
