/* SPDX-License-Identifier: MIT */
/*
 * What a consumer of frames is: open, frame, close.
 *
 * Each sink runs on a thread of its own (flow/pump); all three calls come from that thread and in
 * this order. A lossless sink sees every frame and holds the simulator back when it must; another
 * one sees the newest. A sink that fails is closed; the run goes on for the others and ends with
 * the sink's status, or stops if the sink is `essential`.
 */
#ifndef RBSIM_SINK_H
#define RBSIM_SINK_H

#include <stdbool.h>

#include <rbsim/error.h>
#include <rbsim/frame.h>

#ifdef __cplusplus
extern "C" {
#endif

/* How a run ended, handed to every sink when it is closed. */
struct rb_outcome {
	enum rb_status
		/* RB_OK: complete; RB_ERR_INTERRUPT, RB_ERR_TERMINATE: interrupted; else failed */
		status;
	const char *reason;    /* never NULL, "" when complete */
	uint64_t state_hash;   /* of the last frame */
	const double *results; /* [result_count] of the scene; NULL: not known, or none */
};

struct rb_sink {
	const char *name;
	bool lossless;
	bool essential;  /* its failure ends the run */
	unsigned fields; /* RB_FIELD_* it reads; others may be NULL in its frames */
	void *self;

	enum rb_status (*open)(void *self, struct rb_error *err);
	enum rb_status (*frame)(void *self, const struct rb_frame *frame, struct rb_error *err);
	/* Nothing arrived for a while (about a quarter of a second): flush. May be NULL. */
	enum rb_status (*idle)(void *self, struct rb_error *err);
	enum rb_status (*close)(void *self, const struct rb_outcome *outcome, struct rb_error *err);
	/*
	 * Both NULL: a frame is read before `frame` returns. Else may_keep is called before `open`,
	 * and of the frames that came the last `kept` are left as they are, `most` at most, until
	 * it says fewer.
	 */
	void (*may_keep)(void *self, int most);
	int (*kept)(void *self);
};

#ifdef __cplusplus
}
#endif
#endif
