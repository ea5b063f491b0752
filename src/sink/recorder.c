/* SPDX-License-Identifier: MIT */
/*
 * What makes every flushed frame survive.
 *
 *   open    the partial file is made; all objects and attributes are made; H5Fstart_swmr_write
 *   frame   into the buffers; when they are full or the oldest frame is getting old:
 *             1. room on disk is reserved for all that the buffers can need: where there is none,
 *             the run fails
 *                here, with a file and a library that nothing has happened to
 *             2. rows are appended, `step` last      3. H5Fflush: index, lengths, end-of-file mark
 *           where only the rows of bodies are full, these are all that is appended: they are the
 *           bytes, and flushes cost by their number. No reader counts them before `step` does
 *           after the first flush the file gets its name
 *   close  the same, the texts that change, H5Fclose: a plain file now; then /VTKHDF is added
 *           (add_vtk)
 *
 * A kill can tear a write, between the pages that it touches: the kernel looks for deadly signals
 * there. So nothing that is overwritten in mid-run may lie across a page boundary: headers and
 * indices of what grows, and the texts that change, stand at multiples of ALIGNMENT and are no
 * longer than that (h5frames keeps the indices short). All the rest is made before, without that
 * waste, and the file closed and opened again in between.
 *
 * H5Fflush, never H5Dflush alone: only the former moves the end-of-file mark, beyond which tools
 * cut a file off. After a failure of the library itself (an I/O error, not a full disk) nothing
 * more is asked of it than to note the failure; if that fails too the file is left as it is, open
 * for readers in SWMR mode: H5Fclose with changes that it cannot write may hang or abort.
 */
#include "sink/recorder.h"

#include "base/address_space.h"
#include "base/clock.h"
#include "base/error.h"
#include "base/log.h"
#include "base/memory.h"
#include "sink/h5about.h"
#include "sink/h5compact.h"
#include "sink/h5frames.h"
#include "sink/h5mark.h"
#include "sink/h5output.h"
#include "sink/h5rows.h"
#include "sink/h5scales.h"
#include "sink/h5vtk.h"

#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { SUPERBLOCK_SIZE = 48 }; /* of version 2 and 3 with 8-byte addresses */

struct rb_recorder {
	/* set before the thread starts, then only read */
	const struct rb_run_info *info;
	char *path;
	struct rb_recorder_options options; /* `path` apart */
	uint64_t flush_ns;                  /* a frame older than this is flushed */

	/* the sink's thread */
	struct rb_output output;
	struct rb_h5 h5;
	bool file_open;
	int keep_most; /* frames that the pump leaves to it */
	struct rb_frames frames;
	uint64_t
		oldest_ns; /* when the oldest frame came that no flush has seen; 0: there is none */
	bool failed;       /* no more frames: `why` says why */
	struct rb_error why;
	uint64_t seen; /* frames that came: the next one's number at least */

	/* protected by lock: who waits for frames to be in the file */
	pthread_mutex_t lock;
	pthread_cond_t changed;
	uint64_t asked; /* the file is to hold all frames below */
	uint64_t held;  /* ... and holds all below */
	bool ended;
};

/* Advice for a failure by locks, which are refused on some file systems. */
static const char *lock_advice(int number)
{
	return number == EAGAIN || number == ENOLCK || number == ENOSYS || number == EOPNOTSUPP
	               ? " (try HDF5_USE_FILE_LOCKING=FALSE)"
	               : "";
}

/* Keeps the first failure for the texts at the end; gives `status` back. */
static enum rb_status note_failure(struct rb_recorder *recorder, enum rb_status status,
                                   struct rb_error *err)
{
	RB_ASSERT(status != RB_OK);
	if (!recorder->failed) {
		recorder->failed = true;
		recorder->why = err ? *err : (struct rb_error){.status = status};
	}
	return status;
}

/* The same for a failure of the library. */
static enum rb_status note_h5(struct rb_recorder *recorder, struct rb_error *err)
{
	RB_ASSERT(recorder->h5.status != RB_OK);
	if (err)
		*err = recorder->h5.error;
	return note_failure(recorder, recorder->h5.status, &recorder->h5.error);
}

/* Makes sure of room on the disk behind the end of the file. */
static enum rb_status reserve(struct rb_recorder *recorder, uint64_t need, struct rb_error *err)
{
	haddr_t end = 0;

	H5Fget_eoa(recorder->h5.file, &end);
	const int number = rb_output_reserve(&recorder->output, end, need);
	if (number != 0)
		return RB_FAIL(err, RB_ERR_IO, "cannot write '%s': %s", recorder->path,
		               strerror(number));
	return RB_OK;
}

/* Whether somebody waits for frames that have come and are not in the file. */
static bool is_asked(struct rb_recorder *recorder)
{
	pthread_mutex_lock(&recorder->lock);
	const bool asked = recorder->asked > recorder->held && recorder->asked <= recorder->seen;
	pthread_mutex_unlock(&recorder->lock);
	return asked;
}

/*
 * Wakes those who wait: all that has come is in the file; or, with `ended`, nothing will be any
 * more.
 */
static void tell_held(struct rb_recorder *recorder, bool ended)
{
	pthread_mutex_lock(&recorder->lock);
	if (!recorder->failed)
		recorder->held = recorder->seen;
	recorder->ended = recorder->ended || ended;
	pthread_cond_broadcast(&recorder->changed);
	pthread_mutex_unlock(&recorder->lock);
}

void rb_recorder_ask(struct rb_recorder *recorder, uint64_t frame)
{
	pthread_mutex_lock(&recorder->lock);
	recorder->asked = frame + 1;
	pthread_mutex_unlock(&recorder->lock);
}

bool rb_recorder_wait(struct rb_recorder *recorder, uint64_t frame)
{
	RB_ASSERT(recorder != NULL);
	pthread_mutex_lock(&recorder->lock);
	while (recorder->held <= frame && !recorder->ended)
		pthread_cond_wait(&recorder->changed, &recorder->lock);
	const bool held = recorder->held > frame;
	pthread_mutex_unlock(&recorder->lock);
	return held;
}

/* Flushes the file; after the first time it gets its name. */
static enum rb_status flush(struct rb_recorder *recorder, struct rb_error *err)
{
	haddr_t end = 0;

	/* The library writes its end-of-file mark first and makes the file that long after it. */
	if (H5Fget_eoa(recorder->h5.file, &end) >= 0)
		rb_output_lengthen(&recorder->output, end);
	if (H5Fflush(recorder->h5.file, H5F_SCOPE_LOCAL) < 0)
		rb_h5_fail(&recorder->h5, "flush", "/");
	if (recorder->h5.status)
		return note_h5(recorder, err);
	recorder->oldest_ns = 0;
	struct rb_error error;
	const enum rb_status status = rb_output_publish(&recorder->output, &error);
	if (status) {
		if (err)
			*err = error;
		return note_failure(recorder, status, &error);
	}
	tell_held(recorder, false);
	return RB_OK;
}

/* Writes what is committed by rb_frames_write or a part of that, where there is room for all. */
static enum rb_status append(struct rb_recorder *recorder,
                             void (*write)(struct rb_h5 *h5, struct rb_frames *frames),
                             struct rb_error *err)
{
	struct rb_error error;
	const enum rb_status status = reserve(recorder, rb_frames_need(&recorder->frames), &error);

	if (status) {
		if (err)
			*err = error;
		(void)note_failure(recorder, status, &error); /* before a flush: not all is held */
		rb_frames_write_rest(&recorder->h5, &recorder->frames);
		if (!recorder->h5.status && recorder->frames.written > 0)
			(void)flush(recorder, NULL);
		return status;
	}
	write(&recorder->h5, &recorder->frames);
	return recorder->h5.status ? note_h5(recorder, err) : RB_OK;
}

/* Writes what is committed, so that it can be read from now on. */
static enum rb_status write_out(struct rb_recorder *recorder, struct rb_error *err)
{
	if (recorder->frames.count > 0) {
		const enum rb_status status = append(recorder, rb_frames_write, err);

		if (status)
			return status;
	}
	return recorder->frames.written > 0 ? flush(recorder, err) : RB_OK;
}

/* Records the library's failure as one to create the file. */
static void fail_create(struct rb_h5 *h5)
{
	char reason[160];

	if (h5->status)
		return;
	h5->status = RB_FAIL(&h5->error, RB_ERR_CREATE, "cannot create '%s': %s%s", h5->name,
	                     rb_h5_reason(reason), lock_advice(rb_h5_errno()));
}

/* Makes a complete file of all that does not change. `scales`: told of its datasets. */
static void make_about(struct rb_recorder *recorder, struct rb_scales *scales)
{
	struct rb_h5 *const h5 = &recorder->h5;
	const hid_t access = rb_h5_access_aligned(1);

	*h5 = (struct rb_h5){.file = rb_h5_create(recorder->output.library, access),
	                     .name = recorder->path,
	                     .made = rb_scales_made,
	                     .user = scales};
	rb_h5_done(access);
	if (h5->file < 0) {
		fail_create(h5);
		return;
	}
	recorder->file_open = true;
	h5->status = rb_output_attach(&recorder->output, &h5->error);
	rb_about_write(h5, recorder->info);
	if (h5->status == RB_OK || h5->status == RB_ERR_MEMORY) {
		if (H5Fclose(h5->file) < 0)
			fail_create(h5);
		else
			recorder->file_open = false;
	}
}

/* Makes all that grows or changes, and switches to where others may read. */
static void make_growing(struct rb_recorder *recorder, struct rb_scales *scales)
{
	struct rb_h5 *const h5 = &recorder->h5;

	if (h5->status)
		return;
	const hid_t access = rb_h5_access_aligned(rb_frames_alignment(recorder->info));
	h5->file = H5Fopen(recorder->output.library, H5F_ACC_RDWR, access);
	rb_h5_done(access);
	if (h5->file < 0) {
		fail_create(h5);
		return;
	}
	recorder->file_open = true;
	rb_about_write_changing(h5, recorder->info->scene);
	rb_frames_create(h5, &recorder->frames, recorder->info);
	rb_frames_take_buffers(h5, &recorder->frames, recorder->keep_most);
	if (recorder->frames.time)
		rb_scales_write(scales, h5, recorder->frames.time->path);
	rb_frames_detach(&recorder->frames);
	if (!h5->status && H5Fstart_swmr_write(h5->file) < 0)
		rb_h5_fail(h5, "write", "/");
	rb_frames_attach(h5, &recorder->frames);
	if (!h5->status && H5Fflush(h5->file, H5F_SCOPE_LOCAL) < 0)
		rb_h5_fail(h5, "write", "/");
}

/* Makes the whole file up to its first frame. */
static enum rb_status make_file(struct rb_recorder *recorder, struct rb_error *err)
{
	struct rb_h5 *const h5 = &recorder->h5;

	struct rb_scales *const scales = rb_scales_create(NULL);
	if (!scales)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot create '%s': out of memory",
		               recorder->path);
	make_about(recorder, scales);
	make_growing(recorder, scales);
	h5->made = NULL;
	rb_scales_destroy(scales);
	if (!h5->status) {
		(void)rb_output_lock(&recorder->output); /* nobody else knows of it yet */
		return RB_OK;
	}
	/* nothing can be written in mid-run that could not be made */
	if (h5->status == RB_ERR_IO)
		h5->status = h5->error.status = RB_ERR_CREATE;
	if (err)
		*err = h5->error;
	return h5->status;
}

/*
 * The file is opened to change objects, which no reader may see half made. Should the process be
 * killed meanwhile, the file must not be left marked as open for writing: that mark, and the
 * end-of-file mark beside it, are put back as they were as soon as the library has made its own.
 * (SWMR, so that the mark that the library makes for the moment of its close is one that readers
 * get past.) `shared`: readers, who hold the library's lock, do not mind what is done; the lock of
 * sink/h5output keeps other writers away.
 */
static bool open_again(struct rb_recorder *recorder, bool shared)
{
	struct rb_h5 *const h5 = &recorder->h5;
	unsigned char superblock[SUPERBLOCK_SIZE];

	*h5 = (struct rb_h5){.file = -1, .name = recorder->path};
	if (pread(recorder->output.fd, superblock, sizeof superblock, 0) != SUPERBLOCK_SIZE) {
		rb_h5_fail(h5, "read", "/");
		return false;
	}
	const hid_t access = rb_h5_access_aligned(1);
#if H5_VERSION_GE(1, 12, 1) || (H5_VERSION_GE(1, 10, 7) && !H5_VERSION_GE(1, 12, 0))
	if (shared)
		H5Pset_file_locking(access, false, true);
#else
	(void)shared;
#endif
	h5->file = H5Fopen(recorder->output.library, H5F_ACC_RDWR | H5F_ACC_SWMR_WRITE, access);
	rb_h5_done(access);
	if (h5->file < 0) {
		rb_h5_fail(h5, "open", "/");
		return false;
	}
	if (pwrite(recorder->output.fd, superblock, sizeof superblock, 0) != SUPERBLOCK_SIZE)
		rb_log(RB_LOG_DEBUG, "cannot put back the superblock: %s", strerror(errno));
	return true;
}

/*
 * Removes what an earlier close has added, which is of the frames that were there then. Its room is
 * lost: nothing must take it before the link is gone.
 */
static void drop_vtk(struct rb_recorder *recorder)
{
	struct rb_h5 *const h5 = &recorder->h5;

	if (!open_again(recorder, false))
		return;
	if (H5Lexists(h5->file, "/VTKHDF", H5P_DEFAULT) > 0 &&
	    H5Ldelete(h5->file, "/VTKHDF", H5P_DEFAULT) < 0)
		rb_h5_fail(h5, "remove", "/VTKHDF");
	if (H5Fclose(h5->file) < 0)
		rb_h5_fail(h5, "close", "/");
}

/* Opens a recording that stands there, to be written on where others may read. */
static enum rb_status reopen_file(struct rb_recorder *recorder, struct rb_error *err)
{
	const struct rb_recorder_options *const options = &recorder->options;
	struct rb_h5 *const h5 = &recorder->h5;
	bool was;
	enum rb_status status = rb_output_reopen(&recorder->output, recorder->path,
	                                         recorder->options.how, err);

	if (!status)
		status = rb_mark_clear(recorder->output.fd, recorder->path, &was, err);
	if (status)
		return status;
	drop_vtk(recorder);
	if (!h5->status) {
		const hid_t access = rb_h5_access_aligned(rb_frames_alignment(recorder->info));
		*h5 = (struct rb_h5){.name = recorder->path, .there = true};
		h5->file = H5Fopen(recorder->output.library, H5F_ACC_RDWR | H5F_ACC_SWMR_WRITE,
		                   access);
		rb_h5_done(access);
		if (h5->file < 0)
			rb_h5_fail(h5, "open", "/");
		recorder->file_open = h5->file >= 0;
	}
	rb_frames_create(h5, &recorder->frames, recorder->info);
	rb_frames_take_buffers(h5, &recorder->frames, recorder->keep_most);
	rb_frames_go_on(h5, &recorder->frames, options->row_count, options->frame);
	if (!options->repair) {
		rb_h5_retext(h5, "/rbsim/status", "running");
		rb_h5_retext(h5, "/rbsim/reason", "");
		rb_h5_retext(h5, "/rbsim/ended", "");
	}
	if (!h5->status && H5Fflush(h5->file, H5F_SCOPE_LOCAL) < 0)
		rb_h5_fail(h5, "write", "/");
	if (h5->status && err)
		*err = h5->error;
	recorder->seen = options->frame + 1;
	tell_held(recorder, false);
	return h5->status;
}

/*
 * HDF5 1.10 reads through null pointers where it gets no memory. It takes 2 MiB to make a file, and
 * a thread for checkpoints 8 MiB; the rest is for what grows with the run.
 */
static enum rb_status find_room(const struct rb_recorder *recorder, struct rb_error *err)
{
	enum { ROOM_MIB = 24 };

	if (rb_address_space_has((size_t)ROOM_MIB << 20))
		return RB_OK;
	return RB_FAIL(err, RB_ERR_MEMORY,
	               "cannot record '%s': out of memory: less than %d MiB of address space are "
	               "left (ulimit -v)",
	               recorder->path, ROOM_MIB);
}

/* rb_sink.open. */
static enum rb_status open_file(void *self, struct rb_error *err)
{
	struct rb_recorder *const recorder = self;
	enum rb_status status = find_room(recorder, err);

	RB_ASSERT(!recorder->file_open);
	if (status)
		return status;
	rb_h5_quiet();
	if (recorder->options.resume) {
		status = reopen_file(recorder, err);
	} else {
		status = rb_output_open(&recorder->output, recorder->path, recorder->options.how,
		                        err);
		if (status)
			return status;
		status = make_file(recorder, err);
	}
	if (status) {
		/*
		 * The library's file is left alone where its changes cannot be written: it has no
		 * name any more.
		 */
		if (recorder->file_open &&
		    (recorder->options.resume || recorder->h5.status == RB_ERR_MEMORY)) {
			rb_frames_detach(&recorder->frames);
			H5Fclose(recorder->h5.file);
		}
		rb_frames_forget(&recorder->frames);
		recorder->file_open = false;
		rb_output_release(&recorder->output);
	}
	return status;
}

/* rb_sink.frame. */
static enum rb_status take_frame(void *self, const struct rb_frame *frame, struct rb_error *err)
{
	struct rb_recorder *const recorder = self;
	struct rb_frames *const frames = &recorder->frames;
	struct rb_error error;

	RB_ASSERT(recorder->file_open);
	if (recorder->options.resume && frame->index <= recorder->options.frame)
		return RB_OK; /* it is there; others see it again */
	const enum rb_status status = rb_frames_take(frames, frame, &error);
	if (status) {
		if (err)
			*err = error;
		return note_failure(recorder, status, &error);
	}
	recorder->seen = frame->index + 1;
	const uint64_t now = rb_clock_now_ns();
	if (recorder->oldest_ns == 0)
		recorder->oldest_ns = now;
	if (rb_frames_due(frames) || now - recorder->oldest_ns >= recorder->flush_ns ||
	    (frames->written == 0 && frames->count > 0) || is_asked(recorder))
		return write_out(recorder, err);
	return rb_frames_full(frames) ? append(recorder, rb_frames_write_bodies, err) : RB_OK;
}

/* rb_sink.may_keep. */
static void may_keep(void *self, int most)
{
	struct rb_recorder *const recorder = self;

	RB_ASSERT(!recorder->file_open && most >= 0);
	recorder->keep_most = most;
}

/* rb_sink.kept. */
static int kept(void *self)
{
	const struct rb_recorder *const recorder = self;

	return rb_frames_kept(&recorder->frames);
}

/* rb_sink.idle. */
static enum rb_status flush_idle(void *self, struct rb_error *err)
{
	struct rb_recorder *const recorder = self;

	return recorder->oldest_ns != 0 || is_asked(recorder) ? write_out(recorder, err) : RB_OK;
}

static bool is_interrupted(enum rb_status status)
{
	return status == RB_ERR_AGAIN || status == RB_ERR_INTERRUPT || status == RB_ERR_TERMINATE;
}

/* What the recording says of how the run ended. */
static const char *status_text(enum rb_status status)
{
	/* the run went to its end; what the scene expected is not the recording's matter */
	if (status == RB_OK || status == RB_ERR_EXPECT)
		return "complete";
	return is_interrupted(status) ? "interrupted" : "failed";
}

/* Writes the texts that change; they have their place in the file since it was made. */
static void write_end(struct rb_recorder *recorder, const struct rb_outcome *outcome)
{
	struct rb_h5 *const h5 = &recorder->h5;
	char text[32];

	h5->status = RB_OK; /* of what came before; it is kept in `why` */
	if (recorder->options.repair && !recorder->failed) {
		rb_h5_retext(h5, "/rbsim/reason", outcome->reason);
		rb_h5_retext(h5, "/rbsim/status", status_text(outcome->status));
		return;
	}
	rb_h5_retext(h5, "/rbsim/reason", recorder->failed ? recorder->why.text : outcome->reason);
	if (!recorder->failed) {
		snprintf(text, sizeof text, "%016llx", (unsigned long long)outcome->state_hash);
		rb_h5_retext(h5, "/rbsim/state_hash", text);
	}
	if (outcome->results)
		rb_about_rewrite_results(h5, recorder->info->scene, outcome->results);
	rb_clock_utc(text);
	rb_h5_retext(h5, "/rbsim/ended", text);
	rb_h5_retext(h5, "/rbsim/status",
	             recorder->failed ? "failed" : status_text(outcome->status));
	if (!h5->status && H5Fflush(h5->file, H5F_SCOPE_LOCAL) < 0)
		rb_h5_fail(h5, "write", "/");
}

/* Cuts columns that a failure left longer than `step`. */
static void trim(struct rb_h5 *h5, const struct rb_frames *frames, hsize_t rows)
{
	for (int i = 0; i < frames->column_count && !h5->status; i++) {
		hsize_t size[RB_H5_RANK_MAX];
		const hid_t dataset = H5Dopen2(h5->file, frames->columns[i].path, H5P_DEFAULT);
		const hid_t space = dataset < 0 ? -1 : H5Dget_space(dataset);

		if (space >= 0 && H5Sget_simple_extent_dims(space, size, NULL) > 0 &&
		    size[0] > rows) {
			size[0] = rows;
			if (H5Dset_extent(dataset, size) < 0)
				rb_h5_fail(h5, "cut", frames->columns[i].path);
		}
		rb_h5_done(space);
		rb_h5_done(dataset);
	}
}

/*
 * Adds /VTKHDF. It goes behind the old end; the only old bytes that change are the root's header,
 * in one small write. It is without surfaces where the run is to go on, since all that is added now
 * is thrown away then (drop_vtk), and where it was interrupted: they may take minutes.
 */
static void add_vtk(struct rb_recorder *recorder, bool interrupted)
{
	struct rb_h5 *const h5 = &recorder->h5;
	const struct rb_frames *const frames = &recorder->frames;
	/*
	 * frames that an earlier process has flushed stay, also where this one did not come as far
	 */
	const hsize_t rows = frames->written > frames->there ? frames->written : frames->there;

	if (rows == 0 || recorder->info->model->body_count == 0 ||
	    !(frames->fields & RB_FIELD_POSITION))
		return;
	struct rb_vtk vtk = rb_vtk_of(recorder->info, frames, rows);
	if (!interrupted || recorder->options.repair)
		vtk.fields |= recorder->info->scene->record.fields & RB_FIELD_SURFACES;
	h5->status = rb_vtk_begin(&vtk, &h5->error);
	const off_t end = lseek(recorder->output.fd, 0, SEEK_END);
	const int number = end < 0 ? errno
	                           : rb_output_reserve(&recorder->output, (uint64_t)end,
	                                               rb_vtk_need(&vtk));
	if (!h5->status && number != 0)
		h5->status = RB_FAIL(&h5->error, RB_ERR_IO, "%s", strerror(number));
	if (!h5->status && open_again(recorder, true)) {
		trim(h5, frames, rows);
		rb_vtk_write(h5, &vtk);
		if (h5->status == RB_OK || h5->status == RB_ERR_MEMORY) {
			if (H5Fclose(h5->file) < 0)
				rb_h5_fail(h5, "close", "/");
		}
	}
	rb_vtk_release(&vtk);
	if (h5->status)
		rb_log(RB_LOG_WARNING, "'%s' is complete but for '/VTKHDF': %s%s", recorder->path,
		       h5->error.text, recorder->options.repair ? "" : " (rbsim repair adds it)");
}

/*
 * Writes a small finished file anew without what it needed to grow: what stands at multiples of
 * ALIGNMENT, and the indices. Where that cannot be, the one that is there stays.
 */
static void compact(struct rb_recorder *recorder)
{
	struct stat found;
	struct rb_error error;
	unsigned char *image;
	size_t size;

	if (fstat(recorder->output.fd, &found) != 0 || found.st_size > RB_COMPACT_MOST)
		return;
	const hid_t access = rb_h5_access(1);
	const hid_t file = H5Fopen(recorder->output.library, H5F_ACC_RDONLY, access);
	rb_h5_done(access);
	if (file < 0)
		return;
	const enum rb_status status = rb_compact_image(
		file, recorder->path, recorder->frames.time->path, &image, &size, &error);
	H5Fclose(file);
	if (status) {
		rb_log(RB_LOG_DEBUG, "%s", error.text);
		return;
	}
	const int number = (off_t)size < found.st_size
	                           ? rb_output_replace(&recorder->output, image, size)
	                           : 0;
	if (number != 0)
		rb_log(RB_LOG_DEBUG, "cannot write '%s' anew: %s", recorder->path,
		       strerror(number));
	rb_memory_free(image);
}

/* rb_sink.close. A failure that `frame` has reported is not reported again. */
static enum rb_status close_file(void *self, const struct rb_outcome *outcome, struct rb_error *err)
{
	struct rb_recorder *const recorder = self;
	struct rb_h5 *const h5 = &recorder->h5;

	if (!recorder->file_open) {
		tell_held(recorder, true);
		return RB_OK;
	}
	recorder->file_open = false;
	const bool failed_before = recorder->failed;
	if (!recorder->failed) {
		rb_frames_commit(&recorder->frames);
		(void)write_out(recorder, NULL);
	}
	if (recorder->output.published) {
		write_end(recorder, outcome);
		if (h5->status && !recorder->failed)
			(void)note_failure(recorder, h5->status, &h5->error);
	}
	/* a name that means another file must not be opened again, and the user must know */
	const bool ours = !recorder->output.published || rb_output_is_ours(&recorder->output);
	if (!ours && !recorder->failed) {
		struct rb_error error;

		(void)note_failure(
			recorder,
			RB_FAIL(&error, RB_ERR_IO,
		                "the recording '%s' is lost: the file was replaced or removed "
		                "while the run went on",
		                recorder->path),
			&error);
	}
	/*
	 * Once the library has failed it is only closed when all it knew has reached the file after
	 * all.
	 */
	if (!h5->status) {
		rb_frames_detach(&recorder->frames);
		if (H5Fclose(h5->file) < 0) {
			rb_h5_fail(h5, "close", "/");
			if (!recorder->failed)
				(void)note_failure(recorder, h5->status, &h5->error);
		} else if (recorder->output.published && ours) {
			add_vtk(recorder, is_interrupted(outcome->status));
			if (!recorder->failed && !recorder->options.repair &&
			    (outcome->status == RB_OK || outcome->status == RB_ERR_EXPECT))
				compact(recorder);
		}
	}
	if (h5->status)
		rb_frames_forget(&recorder->frames);
	rb_output_release(&recorder->output);
	tell_held(recorder, true);
	if (!recorder->failed)
		return RB_OK;
	if (err)
		*err = recorder->why;
	/* a failure that `frame` has told is not told again */
	return failed_before ? RB_OK : recorder->why.status;
}

enum rb_status rb_recorder_create(struct rb_recorder **recorder, struct rb_sink *sink,
                                  const struct rb_run_info *info,
                                  const struct rb_recorder_options *options, struct rb_error *err)
{
	*recorder = NULL;
	*sink = (struct rb_sink){0};
	struct rb_recorder *const made = rb_memory_take(1, sizeof *made);
	char *const path = rb_memory_copy_text(options->path);
	if (!made || !path) {
		rb_memory_free(made);
		rb_memory_free(path);
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot record '%s': out of memory",
		               options->path);
	}
	made->info = info;
	made->path = path;
	made->options = *options;
	made->options.path = NULL;
	pthread_mutex_init(&made->lock, NULL);
	pthread_cond_init(&made->changed, NULL);
	made->output.fd = -1;
	/* The next look at the clock may come a quarter of a second later (rb_sink.idle). */
	const double flush_s = options->flush_s > 0 ? options->flush_s : 1;
	made->flush_ns = (uint64_t)(1e9 * (flush_s > 0.5 ? flush_s - 0.3 : 0.4 * flush_s));

	*sink = (struct rb_sink){.name = "recorder",
	                         .lossless = true,
	                         .essential = true,
	                         .fields = info->scene->record.fields,
	                         .self = made,
	                         .open = open_file,
	                         .frame = take_frame,
	                         .idle = flush_idle,
	                         .close = close_file,
	                         .may_keep = may_keep,
	                         .kept = kept};
	*recorder = made;
	return RB_OK;
}

void rb_recorder_destroy(struct rb_recorder *recorder)
{
	if (!recorder)
		return;
	if (recorder->file_open) { /* never closed: nothing is known of how the run ended */
		rb_frames_forget(&recorder->frames);
		rb_output_release(&recorder->output);
	}
	rb_frames_release(&recorder->frames);
	pthread_cond_destroy(&recorder->changed);
	pthread_mutex_destroy(&recorder->lock);
	rb_memory_free(recorder->path);
	rb_memory_free(recorder);
}
