/* SPDX-License-Identifier: MIT */
/*
 * A quantity of a recording by name, at all of its frames: the time, an observable, a probe of the
 * scene, a part of a body (BODY.z, BODY.speed, BODY.rz) or of a joint (JOINT.angle). Main thread;
 * owns nothing.
 */
#ifndef RB_APP_RECORDED_QUANTITY_H
#define RB_APP_RECORDED_QUANTITY_H

#include "sink/module.h"

/* All borrowed. */
struct rb_quantity_source {
	const struct rb_hdf5_module *module;
	struct rb_reader *reader;
	const char *file; /* for messages */
};

/*
 * `values` has room for all frames of the recording; `*units` is borrowed from the reader, "" of a
 * pure number. RB_ERR_USAGE: there is no such quantity; RB_ERR_INPUT: it was not recorded.
 */
RB_CHECKED enum rb_status rb_quantity_read(const struct rb_quantity_source *source,
                                           const char *name, double *values, const char **units,
                                           struct rb_error *err);

#endif
