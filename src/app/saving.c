/* SPDX-License-Identifier: MIT */
/*
 * Decides when a checkpoint is taken: by the clock, by command, or when a signal ends the run. Only
 * at frames that the recording has (record every), since a run continues its recording after a
 * whole row. The simulator only packs; the checkpoint's thread writes, after it has waited until
 * the recorder has the frame on disk, so a checkpoint never is ahead of its recording.
 */
#include "app/saving.h"

#include <math.h>
#include <string.h>

#include "app/resume.h"
#include "base/clock.h"
#include "base/error.h"
#include "base/log.h"
#include "base/memory.h"
#include "method/save.h"

/* Lost at most, when a process is killed. */
static const double default_every_s = 60;
/*
 * What a signal leaves to the frame under way: batch systems kill half a minute after they have
 * said so, others sooner, and the files must be closed, too.
 */
static const double patience_s = 12;
/* And to the disk, which then has what the system holds of the recording to write. */
static const double disk_patience_s = 13;

struct rb_saving {
	struct rb_saving_options options;
	struct rb_checkpoints *checkpoints;
	struct rb_checkpoint_about about;
	uint64_t every_ns, next_ns; /* 0: only when asked */
	uint64_t asked_ns;          /* when a signal was seen first, 0: not yet */
	uint64_t record_every;
	bool wanted; /* a command asks */
	bool broken; /* it does not work, and that was told */
	struct rb_error why;
	struct rb_error
		/* what was wrong with the last one; a full disk is told once, not each minute */
		told;
};

/* rb_checkpoints_options.recorded, in the thread that writes. */
static bool recorded(void *user, uint64_t frame)
{
	const struct rb_saving *const saving = user;

	return saving->options.module->recorder_wait(saving->options.recorder, frame);
}

enum rb_status rb_saving_start(struct rb_saving **made, const struct rb_saving_options *options,
                               struct rb_error *err)
{
	struct rb_saving *const saving = rb_memory_take(1, sizeof *saving);
	const double every_s = isnan(options->every_s) ? default_every_s : options->every_s;

	RB_ASSERT(options->module && options->recorder && options->loaded);
	*made = NULL;
	if (!saving)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot prepare checkpoints: out of memory");
	saving->options = *options;
	saving->about.run = rb_resume_run_hash(options->loaded);
	memcpy(saving->about.started, options->info->started, sizeof saving->about.started);
	saving->every_ns = (uint64_t)(1e9 * fmin(every_s, 1e9));
	saving->next_ns = rb_clock_now_ns() + saving->every_ns;
	saving->record_every = options->loaded->scene.record.every > 1
	                               ? (uint64_t)options->loaded->scene.record.every
	                               : 1;
	const struct rb_checkpoints_options own = {
		.recording = options->loaded->output,
		.how = options->loaded->how,
		.recorded = recorded,
		.user = saving,
		.size_guess = rb_world_pack_guess(options->parts.world),
		.ready_ns = saving->every_ns > 0 ? saving->next_ns - saving->every_ns / 2 : 0};
	const enum rb_status status = rb_checkpoints_start(&saving->checkpoints, &own, err);
	if (status) {
		rb_memory_free(saving);
		return status;
	}
	*made = saving;
	return RB_OK;
}

struct rb_checkpoints_tally rb_saving_stop(struct rb_saving *saving)
{
	if (!saving)
		return (struct rb_checkpoints_tally){0};
	(void)!rb_checkpoints_wait(saving->checkpoints, NULL);
	const struct rb_checkpoints_tally tally = rb_checkpoints_tally(saving->checkpoints);
	rb_checkpoints_stop(saving->checkpoints);
	rb_memory_free(saving);
	return tally;
}

bool rb_saving_can(const struct rb_saving *saving, uint64_t frame)
{
	return saving && !saving->broken && frame % saving->record_every == 0;
}

bool rb_saving_waits(struct rb_saving *saving)
{
	const uint64_t now = rb_clock_now_ns();

	if (!saving || saving->broken)
		return false;
	if (saving->asked_ns == 0) {
		saving->asked_ns = now;
		rb_checkpoints_hurry(saving->checkpoints, now + (uint64_t)(1e9 * disk_patience_s));
	}
	return now - saving->asked_ns < (uint64_t)(1e9 * patience_s);
}

/* Takes a checkpoint of this frame; errors are those of packing, writing is not waited for. */
static enum rb_status take(struct rb_saving *saving, uint64_t frame, struct rb_error *err)
{
	RB_ASSERT(frame % saving->record_every == 0);
	saving->about.frame = frame;
	saving->about.row_count = frame / saving->record_every + 1;
	saving->wanted = false;
	saving->next_ns = rb_clock_now_ns() + saving->every_ns;
	saving->options.module->recorder_ask(saving->options.recorder, frame);
	return rb_checkpoints_take(saving->checkpoints, &saving->about, &saving->options.parts,
	                           err);
}

/* No checkpoints from here on; said once. */
static void give_up(struct rb_saving *saving, const struct rb_error *err)
{
	saving->broken = true;
	saving->why = *err;
	rb_log(RB_LOG_WARNING, "this run has no checkpoints from here on: %s", err->text);
}

/*
 * Reports how the last one went; the same failure only once, so that a full disk is not told each
 * minute.
 */
static void tell_last(struct rb_saving *saving)
{
	struct rb_error err;

	if (rb_checkpoints_wait(saving->checkpoints, &err) == RB_OK) {
		saving->told = (struct rb_error){0};
		return;
	}
	if (strcmp(err.text, saving->told.text) != 0)
		rb_log(RB_LOG_WARNING, "%s", err.text);
	saving->told = err;
}

void rb_saving_frame(struct rb_saving *saving, uint64_t frame)
{
	struct rb_error err;

	if (!rb_saving_can(saving, frame))
		return;
	const bool due = saving->wanted ||
	                 (saving->every_ns > 0 && rb_clock_now_ns() >= saving->next_ns);
	if (!due || rb_checkpoints_busy(saving->checkpoints))
		return;
	tell_last(saving);
	if (take(saving, frame, &err) != RB_OK)
		give_up(saving, &err);
}

enum rb_status rb_saving_ask(struct rb_saving *saving, struct rb_error *err)
{
	if (!saving)
		return RB_FAIL(err, RB_ERR_USAGE,
		               "this run has no checkpoints: it is not recorded");
	if (saving->broken)
		return RB_FAIL(err, RB_ERR_USAGE, "this run has no checkpoints: %s",
		               saving->why.text);
	saving->wanted = true;
	return RB_OK;
}

enum rb_status rb_saving_last(struct rb_saving *saving, const struct rb_world *world,
                              uint64_t *frame, struct rb_error *err)
{
	const uint64_t now = rb_world_frame(world);
	enum rb_status status = RB_ERR_INPUT;

	if (!saving)
		return RB_FAIL(err, RB_ERR_USAGE, "it is not recorded");
	(void)rb_saving_waits(saving); /* its time begins, where no frame was under way */
	if (saving->broken)
		(void)RB_FAIL(err, status, "%s", saving->why.text);
	else if (rb_world_stopped(world) || !rb_saving_can(saving, now))
		(void)RB_FAIL(err, status, "the frame took too long");
	else
		status = take(saving, now, err);
	if (!status)
		status = rb_checkpoints_wait(saving->checkpoints, err);
	if (!status) {
		*frame = now;
		return RB_OK;
	}
	/* an earlier one will do */
	tell_last(saving);
	const struct rb_checkpoints_tally tally = rb_checkpoints_tally(saving->checkpoints);
	*frame = tally.written > 0 ? tally.frame : saving->options.resumed_frame;
	return tally.written > 0 || saving->options.resumed ? RB_OK : status;
}
