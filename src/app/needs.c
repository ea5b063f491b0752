/* SPDX-License-Identifier: MIT */
#include "app/needs.h"

#include "flow/frame.h"
#include "flow/ring.h"
#include "method/method.h"
#include "sink/module.h"

/* The lesser of two counts. */
static uint64_t smaller(uint64_t a, uint64_t b)
{
	return a < b ? a : b;
}

/*
 * Bytes that the recorder takes on top of the code of HDF5: the library's own tables, measured, and
 * rows that wait to be written, which are 2 MiB or a frame, or none where they wait in the ring;
 * with compression chunks of some frames, once more in the library's cache. Never more than the run
 * has (sink/h5frames; compared with real runs by tests/cli/check-estimates.sh).
 */
static uint64_t recorder_bytes(const struct rb_model *model, const struct rb_record_def *record)
{
	enum { COMPRESSED_FRAMES = 16 };
	const uint64_t tables = 400000, mebibyte = 1 << 20;
	const uint64_t frame = rb_frame_bytes(model, record->fields);
	const uint64_t whole_run = model->frame_count * frame;
	const bool as_they_are = record->every <= 1 && !record->single_precision;
	uint64_t waiting = frame > 2 * mebibyte ? frame : 2 * mebibyte, cache = 0;

	if (as_they_are && record->compression == 0 && frame > mebibyte / 16)
		waiting = 0;

	if (record->compression > 0) {
		const uint64_t chunks = smaller(COMPRESSED_FRAMES * frame, 64 * mebibyte);
		const uint64_t pieces = 1 + COMPRESSED_FRAMES * (uint64_t)model->body_count * 24 /
		                                    mebibyte;
		cache = smaller(chunks + chunks / pieces, whole_run);
		waiting = chunks > waiting ? chunks : waiting;
	}
	return tables + smaller(waiting, whole_run) + cache;
}

/* Bytes of the frames in the ring. */
static uint64_t ring_bytes(const struct rb_model *model, unsigned fields)
{
	const uint64_t slots = (uint64_t)rb_ring_slots_for(model, fields);

	return (slots < model->frame_count ? slots : model->frame_count) *
	       rb_frame_bytes(model, fields);
}

static uint64_t step_count(const struct rb_model *model)
{
	const uint64_t intervals = model->frame_count - 1;
	const uint64_t whole_steps = (uint64_t)rb_step_count(1 / model->frame_rate,
	                                                     model->time_step_s);
	const double before_last_s = rb_model_frame_time(model, intervals - 1);

	/* All intervals are alike but the last, which the end of the run may cut short. */
	if (rb_model_frame_time(model, intervals) == (double)intervals / model->frame_rate)
		return intervals * whole_steps;
	return (intervals - 1) * whole_steps +
	       (uint64_t)rb_step_count(model->duration_s - before_last_s, model->time_step_s);
}

enum rb_status rb_needs_take(struct rb_needs *needs, const struct rb_loaded *loaded,
                             const struct rb_run_info *info, struct rb_error *err)
{
	const struct rb_hdf5_module *module;
	enum rb_status status = rb_estimate_run(loaded, info->threads, &needs->run, err);

	needs->disk_bytes = 0;
	needs->steps = step_count(loaded->model);
	if (status || !loaded->output)
		return status;
	const uint64_t before = rb_process_bytes("VmRSS");
	status = rb_module_hdf5(&module, err);
	if (status)
		return status;
	needs->disk_bytes = module->recorder_estimate(info);
	const uint64_t after = rb_process_bytes("VmRSS");
	needs->run.memory_bytes += (after > before ? after - before : 0) +
	                           recorder_bytes(loaded->model, &loaded->scene.record);
	needs->run.memory_bytes += ring_bytes(loaded->model, loaded->scene.record.fields);
	return RB_OK;
}
