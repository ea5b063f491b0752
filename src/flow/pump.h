/* SPDX-License-Identifier: MIT */
/*
 * The thread loop of one sink: open, every frame, idle when nothing comes, close with the outcome.
 *
 * Owned by whoever started it, who also joins it. The sink's calls all come from the pump's
 * thread, on which every signal is blocked. A sink that fails is closed as failed and detached
 * from the ring, so that the producer never waits for it.
 */
#ifndef RB_FLOW_PUMP_H
#define RB_FLOW_PUMP_H

#include <rbsim/sink.h>

#include "flow/ring.h"

struct rb_pump;

/*
 * Adds a consumer to the ring, starts the thread and waits until the sink is open: an output that
 * can't be created is known before the first step. `outcome` is borrowed: complete before the ring
 * is closed, then only read.
 */
RB_CHECKED enum rb_status rb_pump_start(struct rb_pump **pump, struct rb_ring *ring,
                                        const struct rb_sink *sink,
                                        const struct rb_outcome *outcome, struct rb_error *err);

/* The sink has failed and is essential: the producer should stop. From any thread. */
bool rb_pump_must_stop(const struct rb_pump *pump);

/*
 * After the ring was closed or aborted: waits for the sink to be closed, gives its status and
 * error, and frees the pump. NULL is fine.
 */
RB_CHECKED enum rb_status rb_pump_join(struct rb_pump *pump, struct rb_error *err);

#endif
