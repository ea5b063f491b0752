/* SPDX-License-Identifier: MIT */
/* Recordings of <rbsim.h>: a reader, and the frame that was asked for last. */
#include <string.h>

#include "base/memory.h"
#include "embed/handle.h"
#include "sink/module.h"

struct rbsim_recording {
	const struct rb_hdf5_module *module;
	struct rb_reader *reader; /* owned */
	struct rbsim_frame shown;
};

static const struct rb_reading *reading_of(const struct rbsim_recording *recording)
{
	return recording->module->reader_reading(recording->reader);
}

enum rbsim_status rbsim_recording_open(struct rbsim_recording **recording, const char *path,
                                       struct rbsim_error *error)
{
	struct rb_error err;

	if (recording)
		*recording = NULL;
	if (!recording || !path)
		return rb_handle_refuse(error, __func__, "'recording' and 'path' must not be NULL");
	struct rbsim_recording *const made = rb_memory_take(1, sizeof *made);
	enum rb_status status = made ? rb_module_hdf5(&made->module, &err)
	                             : RB_FAIL(&err, RB_ERR_MEMORY,
	                                       "cannot open '%s': out of memory", path);
	if (!status)
		status = made->module->reader_open(&made->reader, path, &err);
	if (status)
		rb_memory_free(made);
	else
		*recording = made;
	return rb_handle_pass(error, status, &err);
}

void rbsim_recording_close(struct rbsim_recording *recording)
{
	if (!recording)
		return;
	recording->module->reader_close(recording->reader);
	rb_memory_free(recording);
}

uint64_t rbsim_recording_frame_count(const struct rbsim_recording *recording)
{
	return recording ? reading_of(recording)->frame_count : 0;
}

enum rbsim_status rbsim_recording_refresh(struct rbsim_recording *recording,
                                          struct rbsim_error *error)
{
	struct rb_error err;

	if (!recording)
		return rb_handle_refuse(error, __func__, "'recording' must not be NULL");
	return rb_handle_pass(error, recording->module->reader_refresh(recording->reader, &err),
	                      &err);
}

const char *rbsim_recording_status(const struct rbsim_recording *recording)
{
	return recording ? reading_of(recording)->status : "";
}

enum rbsim_status rbsim_recording_frame(struct rbsim_recording *recording, uint64_t row,
                                        const struct rbsim_frame **frame, struct rbsim_error *error)
{
	struct rb_frame read;
	struct rb_error err;

	if (frame)
		*frame = NULL;
	if (!recording || !frame)
		return rb_handle_refuse(error, __func__,
		                        "'recording' and 'frame' must not be NULL");
	const enum rb_status status = recording->module->reader_frame(recording->reader, row, &read,
	                                                              &err);
	if (!status) {
		rb_handle_show(&recording->shown, &read);
		*frame = &recording->shown;
	}
	return rb_handle_pass(error, status, &err);
}

const char *rbsim_recording_name(const struct rbsim_recording *recording, int body)
{
	const struct rb_reading *const reading = recording ? reading_of(recording) : NULL;

	return reading && body >= 0 && body < reading->body_count
	               ? reading->names[reading->id[body]]
	               : "";
}

int rbsim_recording_find(const struct rbsim_recording *recording, const char *name)
{
	const int count = recording && name && *name ? reading_of(recording)->body_count : 0;

	for (int body = 0; body < count; body++)
		if (strcmp(rbsim_recording_name(recording, body), name) == 0)
			return body;
	return -1;
}
