/* SPDX-License-Identifier: MIT */
/* The one object that rbsim-hdf5.so exports (sink/module.h). */
#include "sink/h5module.h"

#include "sink/h5collect.h"
#include "sink/reader.h"
#include "sink/h5estimate.h"
#include "sink/recorder.h"

#include <stdio.h>

#include <hdf5.h>

static void libraries(char *out, size_t size)
{
	unsigned major = 0, minor = 0, release = 0;

	H5get_libversion(&major, &minor, &release);
	snprintf(out, size, "HDF5 %u.%u.%u", major, minor, release);
}

const struct rb_hdf5_module rb_hdf5_module = {
	.version = RB_HDF5_MODULE_VERSION,
	.recorder_create = rb_recorder_create,
	.recorder_destroy = rb_recorder_destroy,
	.recorder_ask = rb_recorder_ask,
	.recorder_wait = rb_recorder_wait,
	.recorder_estimate = rb_h5_estimate,
	.reader_open = rb_reader_open,
	.reader_close = rb_reader_close,
	.reader_reading = rb_reader_reading,
	.reader_refresh = rb_reader_refresh,
	.reader_frame = rb_reader_frame,
	.reader_observable = rb_reader_observable,
	.reader_units = rb_reader_units,
	.collect = rb_h5_collect,
	.column = rb_h5_column,
	.libraries = libraries,
};
