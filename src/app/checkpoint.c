/* SPDX-License-Identifier: MIT */
/*
 * Two buffers and two files: the simulator packs into memory while the thread is idle; the thread
 * hashes, syncs the recording, writes NAME.partial, syncs, and renames. The checkpoint before is
 * kept under another name, so at every moment one whole checkpoint is on disk. `busy` is the only
 * hand-over: while it is set the pack is the thread's, else the simulator's.
 *
 * The file: a head with magic, order of bytes, format, size and hash, then four sections, each with
 * name, size and hash of its own. A damaged file is refused before anything of it is used.
 */
#include "app/checkpoint.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/place.h"
#include "base/thread.h"
#include "script/keep.h"
#include "method/save.h"

/*
 * FORMAT: to be raised with every change of what a section holds. NAME_SIZE: of a section's name,
 * without a zero.
 */
enum { FORMAT = 6, SECTION_COUNT = 4, NAME_SIZE = 8 };
static const uint32_t order_mark = 0x04030201;
static const char magic[8] = {'r', 'b', 's', 'i', 'm', '-', 'c', 'p'};
static const char section_names[SECTION_COUNT][NAME_SIZE + 1] = {"about", "world", "script", "run"};

/* Beginning of the file, 32 bytes without padding. */
struct head {
	char magic[8];
	uint32_t order, format;
	uint64_t size, hash; /* of what follows */
};

struct section {
	char name[NAME_SIZE];
	uint64_t size, hash;
};
_Static_assert(sizeof(struct head) == 32 && sizeof(struct section) == 24, "no padding on disk");

struct rb_checkpoints {
	/* set before the thread starts, then only read */
	struct rb_checkpoints_options options;
	struct rb_place place; /* the recording's */
	pthread_t thread;

	/* the simulator's while the thread is idle, the thread's while it is busy */
	struct rb_pack pack;
	uint64_t frame;

	/* protected by lock */
	pthread_mutex_t lock;
	pthread_cond_t changed;
	bool busy, stop;
	bool hurried;          /* the recording is to begin its way to the disk */
	uint64_t until_ns;     /* so long it is waited for on its way; 0: as long as it takes */
	enum rb_status status; /* of the last one */
	struct rb_error error;
	struct rb_checkpoints_tally tally;
};

/* What stands beside a recording, "RUN.h5.checkpoint" and the one before. */
static const char last_ending[] = ".checkpoint", before_ending[] = ".checkpoint~";

/* ---- writing: the thread's ---- */

static RB_FIELDS_DEFINE(about_fields, struct rb_checkpoint_about, RB_CHECKPOINT_ABOUT_FIELDS);

/* The first section, both ways. */
static void pack_about(struct rb_pack *pack, struct rb_checkpoint_about *about)
{
	rb_fields_pack(about_fields(), about, 1, NULL, pack);
	about->started[sizeof about->started - 1] = '\0';
}

/* Puts in the hashes of the sections, then of the whole: what the simulator need not wait for. */
static void seal(struct rb_pack *pack)
{
	struct head head = {.order = order_mark, .format = FORMAT};
	struct section section;

	RB_ASSERT(pack->size >= sizeof head);
	for (size_t at = sizeof head; at < pack->size;) {
		unsigned char *const bytes = pack->bytes + at + sizeof section;

		memcpy(&section, pack->bytes + at, sizeof section);
		section.hash = rb_hash_bytes(bytes, section.size, 0);
		memcpy(pack->bytes + at, &section, sizeof section);
		at += sizeof section + section.size;
	}
	memcpy(head.magic, magic, sizeof magic);
	head.size = pack->size - sizeof head;
	head.hash = rb_hash_bytes(pack->bytes + sizeof head, head.size, 0);
	memcpy(pack->bytes, &head, sizeof head);
}

/* Fails with errno. `name` stands beside the recording and is shown as that is. */
static enum rb_status fail(struct rb_error *err, const char *what, const struct rb_place *place,
                           const char *name)
{
	const int number = errno;

	return RB_FAIL(err, RB_ERR_IO, "cannot %s '%.*s%s': %s", what,
	               (int)(place->name - place->path), place->path, name, strerror(number));
}

/* Writes all bytes; false with errno. */
static bool write_all(int fd, const unsigned char *bytes, size_t size)
{
	while (size > 0) {
		const ssize_t done = write(fd, bytes, size);

		if (done < 0 && errno == EINTR)
			continue;
		if (done <= 0)
			return false;
		bytes += done;
		size -= (size_t)done;
	}
	return true;
}

/* False with errno. A file that cannot be synced (a pipe, some network) is as safe as it gets. */
static bool sync_file(int fd)
{
	return fsync(fd) == 0 || errno == EINVAL || errno == EROFS || errno == ENOTSUP;
}

/* Whether a signal's time is over: no more is waited for. */
static bool is_late(struct rb_checkpoints *checkpoints)
{
	pthread_mutex_lock(&checkpoints->lock);
	const uint64_t until_ns = checkpoints->until_ns;
	pthread_mutex_unlock(&checkpoints->lock);
	return until_ns > 0 && rb_clock_now_ns() >= until_ns;
}

/*
 * Has the system write the recording and waits until it has, piece by piece: one sync of all could
 * not be left, and takes as long as the disk does for what the memory holds. False: too late. All
 * else is left to a sync: what cannot be written by pieces, and failures, which the system tells
 * each descriptor once.
 */
static bool send_in_time(struct rb_checkpoints *checkpoints)
{
	static const unsigned ways[] = {SYNC_FILE_RANGE_WRITE, SYNC_FILE_RANGE_WAIT_BEFORE |
	                                                               SYNC_FILE_RANGE_WRITE |
	                                                               SYNC_FILE_RANGE_WAIT_AFTER};
	const off_t piece = (off_t)4 << 20;
	const int fd = rb_place_reach(&checkpoints->place, checkpoints->place.name, O_RDONLY);
	struct stat found = {0};
	bool works = fd >= 0 && fstat(fd, &found) == 0;

	for (size_t way = 0; way < sizeof ways / sizeof *ways; way++)
		for (off_t at = 0; works && at < found.st_size && !is_late(checkpoints);
		     at += piece)
			works = sync_file_range(fd, at, piece, ways[way]) == 0;
	if (fd >= 0)
		close(fd);
	return !is_late(checkpoints);
}

/*
 * Makes sure that the recording is on disk before a checkpoint that refers to it. `*late`: it was
 * not in time; both are there then unless the power fails.
 */
static enum rb_status sync_recording(struct rb_checkpoints *checkpoints, bool *late,
                                     struct rb_error *err)
{
	const struct rb_place *const place = &checkpoints->place;
	const int fd = rb_place_reach(place, place->name, O_RDONLY);
	enum rb_status status = RB_OK;

	if (fd < 0)
		return fail(err, "open", place, place->name);
	*late = !send_in_time(checkpoints);
	if (*late)
		rb_log(RB_LOG_WARNING,
		       "the disk is slow: '%s' is still on its way to it, and safe unless the "
		       "power fails",
		       place->path);
	else if (!sync_file(fd))
		status = fail(err, "sync", place, place->name);
	close(fd);
	return status;
}

/* Writes a new file, `partial`, and syncs it unless it is late; `name` is what it is to be. */
static enum rb_status write_partial(const struct rb_place *place, const struct rb_pack *pack,
                                    bool late, const char *name, char partial[RB_PLACE_NAME_SIZE],
                                    struct rb_error *err)
{
	const int fd = rb_place_create(place, last_ending, partial);
	enum rb_status status = RB_OK;

	if (fd < 0)
		return fail(err, "create", place, name);
	if (!write_all(fd, pack->bytes, pack->size) || !(late || sync_file(fd)))
		status = fail(err, "write", place, name);
	if (close(fd) != 0 && !status)
		status = fail(err, "write", place, name);
	if (status)
		rb_place_remove(place, partial);
	return status;
}

/* Writes the checkpoint and gives it its name; the one before gets the other name. */
static enum rb_status write_file(const struct rb_place *place, const struct rb_pack *pack,
                                 bool late, struct rb_error *err)
{
	char name[RB_PLACE_NAME_SIZE], before[RB_PLACE_NAME_SIZE], partial[RB_PLACE_NAME_SIZE];

	rb_place_beside(place, last_ending, name);
	rb_place_beside(place, before_ending, before);
	enum rb_status status = write_partial(place, pack, late, name, partial, err);
	if (status)
		return status;
	/* between the two renames there is the one before */
	if ((rb_place_rename(place, name, before) != 0 && errno != ENOENT) ||
	    rb_place_rename(place, partial, name) != 0) {
		status = fail(err, "rename", place, name);
		rb_place_remove(place, partial);
		return status;
	}
	if (!late)
		rb_place_sync(place);
	return RB_OK;
}

/* Writes what the simulator has packed; in the thread. */
static enum rb_status write_one(struct rb_checkpoints *checkpoints, struct rb_error *err)
{
	const struct rb_checkpoints_options *const options = &checkpoints->options;

	seal(&checkpoints->pack);
	if (!options->recorded(options->user, checkpoints->frame))
		return RB_FAIL(err, RB_ERR_IO,
		               "there is no checkpoint at frame %llu: the recording has failed",
		               (unsigned long long)checkpoints->frame);
	bool late = false;
	const enum rb_status status = sync_recording(checkpoints, &late, err);
	return status ? status : write_file(&checkpoints->place, &checkpoints->pack, late, err);
}

/*
 * Touches the pages of the pack once: pages that nobody has written to are found one by one, at the
 * first write: here, and not while the run stands still. Called with the lock, which it gives back
 * meanwhile.
 */
static void make_ready(struct rb_checkpoints *checkpoints)
{
	const uint64_t at_ns = checkpoints->options.ready_ns;
	const struct timespec at = {.tv_sec = (time_t)(at_ns / 1000000000),
	                            .tv_nsec = (long)(at_ns % 1000000000)};
	const size_t step = 4096;

	if (at_ns == 0)
		return;
	while (!checkpoints->busy && !checkpoints->stop)
		if (pthread_cond_timedwait(&checkpoints->changed, &checkpoints->lock, &at) != 0)
			break;
	if (checkpoints->busy || checkpoints->stop)
		return;
	checkpoints->busy = true;
	pthread_mutex_unlock(&checkpoints->lock);
	for (size_t i = 0; i < checkpoints->pack.capacity && i < checkpoints->options.size_guess;
	     i += step)
		*(volatile unsigned char *)&checkpoints->pack.bytes[i] = 0;
	pthread_mutex_lock(&checkpoints->lock);
	checkpoints->busy = false;
	pthread_cond_broadcast(&checkpoints->changed);
}

/* Whether there is something better to do than to hurry. */
static bool is_wanted(struct rb_checkpoints *checkpoints)
{
	pthread_mutex_lock(&checkpoints->lock);
	const bool wanted = checkpoints->busy || checkpoints->stop;
	pthread_mutex_unlock(&checkpoints->lock);
	return wanted;
}

/*
 * Has the system write what it holds of the recording, piece by piece, and does not wait until it
 * has: who needs it on disk syncs it, and whoever ends the thread waits for a piece at most.
 */
static void send_out(struct rb_checkpoints *checkpoints)
{
	const off_t piece = (off_t)16 << 20;
	const int fd = rb_place_reach(&checkpoints->place, checkpoints->place.name, O_RDONLY);
	struct stat found;

	if (fd < 0)
		return;
	if (fstat(fd, &found) == 0)
		for (off_t at = 0; at < found.st_size && !is_wanted(checkpoints); at += piece)
			if (sync_file_range(fd, at, piece, SYNC_FILE_RANGE_WRITE) != 0)
				break;
	close(fd);
}

/* The thread. */
static void *work(void *argument)
{
	struct rb_checkpoints *const checkpoints = argument;

	rb_thread_name("checkpoint");
	pthread_mutex_lock(&checkpoints->lock);
	make_ready(checkpoints);
	for (;;) {
		struct rb_error err = {0};

		while (!checkpoints->busy && !checkpoints->stop && !checkpoints->hurried)
			pthread_cond_wait(&checkpoints->changed, &checkpoints->lock);
		const bool hurried = checkpoints->hurried && !checkpoints->busy;
		checkpoints->hurried = false;
		if (!checkpoints->busy && checkpoints->stop)
			break;
		pthread_mutex_unlock(&checkpoints->lock);
		if (hurried) {
			send_out(checkpoints);
			pthread_mutex_lock(&checkpoints->lock);
			continue;
		}
		const enum rb_status status = write_one(checkpoints, &err);
		pthread_mutex_lock(&checkpoints->lock);
		checkpoints->status = status;
		checkpoints->error = err;
		checkpoints->busy = false;
		if (!status) {
			checkpoints->tally.written++;
			checkpoints->tally.bytes = checkpoints->pack.size;
			checkpoints->tally.frame = checkpoints->frame;
		}
		pthread_cond_broadcast(&checkpoints->changed);
	}
	pthread_mutex_unlock(&checkpoints->lock);
	return NULL;
}

/* ---- the simulator's ---- */

/* A condition variable with the monotonic clock. */
static void init_condition(pthread_cond_t *condition)
{
	pthread_condattr_t as_clock;

	pthread_condattr_init(&as_clock);
	pthread_condattr_setclock(&as_clock, CLOCK_MONOTONIC);
	pthread_cond_init(condition, &as_clock);
	pthread_condattr_destroy(&as_clock);
}

enum rb_status rb_checkpoints_start(struct rb_checkpoints **made,
                                    const struct rb_checkpoints_options *options,
                                    struct rb_error *err)
{
	struct rb_checkpoints *const checkpoints = rb_memory_take(1, sizeof *checkpoints);

	*made = NULL;
	if (!checkpoints)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot prepare checkpoints: out of memory");
	checkpoints->options = *options;
	const enum rb_status status = rb_place_open(&checkpoints->place, options->recording,
	                                            options->how, err);
	if (status) {
		rb_memory_free(checkpoints);
		return status;
	}
	/* without it the first one finds its room step by step */
	if (!rb_memory_reserve(&checkpoints->pack.bytes, &checkpoints->pack.capacity,
	                       options->size_guess, 1))
		rb_log(RB_LOG_DEBUG, "no room for checkpoints yet");
	pthread_mutex_init(&checkpoints->lock, NULL);
	init_condition(&checkpoints->changed);
	const int failed = rb_thread_start(&checkpoints->thread, work, checkpoints);
	if (failed) {
		rb_pack_release(&checkpoints->pack);
		rb_place_release(&checkpoints->place);
		rb_memory_free(checkpoints);
		return RB_FAIL(err, RB_ERR_MISSING, "cannot start a thread for checkpoints: %s",
		               strerror(failed));
	}
	*made = checkpoints;
	return RB_OK;
}

void rb_checkpoints_hurry(struct rb_checkpoints *checkpoints, uint64_t until_ns)
{
	pthread_mutex_lock(&checkpoints->lock);
	checkpoints->hurried = true;
	checkpoints->until_ns = until_ns;
	pthread_cond_broadcast(&checkpoints->changed);
	pthread_mutex_unlock(&checkpoints->lock);
}

bool rb_checkpoints_busy(struct rb_checkpoints *checkpoints)
{
	pthread_mutex_lock(&checkpoints->lock);
	const bool busy = checkpoints->busy;
	pthread_mutex_unlock(&checkpoints->lock);
	return busy;
}

/* Begins a section; its size is put in when it ends. */
static size_t begin_section(struct rb_pack *pack, int which)
{
	struct section section = {.size = 0};

	RB_ASSERT(which >= 0 && which < SECTION_COUNT);
	memcpy(section.name, section_names[which], NAME_SIZE);
	rb_pack_bytes(pack, &section, sizeof section);
	return pack->size;
}

/* Puts in the size of the section that began at `begin`. */
static void end_section(struct rb_pack *pack, size_t begin)
{
	const uint64_t size = pack->size - begin;

	RB_ASSERT(pack->failed || (begin >= sizeof(struct section) && begin <= pack->size));
	if (!pack->failed)
		memcpy(pack->bytes + begin - sizeof(struct section) +
		               offsetof(struct section, size),
		       &size, sizeof size);
}

/* Packs a whole checkpoint. */
static enum rb_status pack_all(struct rb_pack *pack, struct rb_checkpoint_about about,
                               const struct rb_checkpoint_parts *parts, struct rb_error *err)
{
	struct head head = {.size = 0};
	enum rb_status status = RB_OK;

	about.state_hash = rb_world_hash(parts->world);
	rb_pack_restart(pack);
	rb_pack_bytes(pack, &head, sizeof head);
	size_t begin = begin_section(pack, 0);
	pack_about(pack, &about);
	end_section(pack, begin);
	begin = begin_section(pack, 1);
	status = rb_world_pack(parts->world, pack, err);
	end_section(pack, begin);
	begin = begin_section(pack, 2);
	if (!status)
		status = rb_script_pack(parts->script, pack, err);
	end_section(pack, begin);
	begin = begin_section(pack, 3);
	if (!status)
		parts->pack(parts->user, pack);
	end_section(pack, begin);
	return status ? status : rb_pack_status(pack, "a checkpoint", err);
}

enum rb_status rb_checkpoints_take(struct rb_checkpoints *checkpoints,
                                   const struct rb_checkpoint_about *about,
                                   const struct rb_checkpoint_parts *parts, struct rb_error *err)
{
	const uint64_t start_ns = rb_clock_now_ns(), cpu_ns = rb_clock_cpu_ns();

	pthread_mutex_lock(&checkpoints->lock);
	while (checkpoints->busy)
		pthread_cond_wait(&checkpoints->changed, &checkpoints->lock);
	pthread_mutex_unlock(&checkpoints->lock);
	checkpoints->frame = about->frame;
	const enum rb_status status = pack_all(&checkpoints->pack, *about, parts, err);
	const uint64_t taken_ns = rb_clock_now_ns() - start_ns;

	pthread_mutex_lock(&checkpoints->lock);
	RB_ASSERT(!checkpoints->busy);
	checkpoints->busy = !status;
	checkpoints->tally.stall_ns += taken_ns;
	checkpoints->tally.stall_cpu_ns += rb_clock_cpu_ns() - cpu_ns;
	if (taken_ns > checkpoints->tally.stall_most_ns)
		checkpoints->tally.stall_most_ns = taken_ns;
	pthread_cond_broadcast(&checkpoints->changed);
	pthread_mutex_unlock(&checkpoints->lock);
	return status;
}

enum rb_status rb_checkpoints_wait(struct rb_checkpoints *checkpoints, struct rb_error *err)
{
	pthread_mutex_lock(&checkpoints->lock);
	while (checkpoints->busy)
		pthread_cond_wait(&checkpoints->changed, &checkpoints->lock);
	const enum rb_status status = checkpoints->status;
	if (status && err)
		*err = checkpoints->error;
	pthread_mutex_unlock(&checkpoints->lock);
	return status;
}

struct rb_checkpoints_tally rb_checkpoints_tally(struct rb_checkpoints *checkpoints)
{
	pthread_mutex_lock(&checkpoints->lock);
	const struct rb_checkpoints_tally tally = checkpoints->tally;
	pthread_mutex_unlock(&checkpoints->lock);
	return tally;
}

void rb_checkpoints_stop(struct rb_checkpoints *checkpoints)
{
	if (!checkpoints)
		return;
	pthread_mutex_lock(&checkpoints->lock);
	checkpoints->stop = true;
	pthread_cond_broadcast(&checkpoints->changed);
	pthread_mutex_unlock(&checkpoints->lock);
	pthread_join(checkpoints->thread, NULL);
	pthread_cond_destroy(&checkpoints->changed);
	pthread_mutex_destroy(&checkpoints->lock);
	rb_pack_release(&checkpoints->pack);
	rb_place_release(&checkpoints->place);
	rb_memory_free(checkpoints);
}

void rb_checkpoints_remove(const char *recording, unsigned how)
{
	char name[RB_PLACE_NAME_SIZE];
	struct rb_place place;

	if (rb_place_open(&place, recording, how, NULL) != RB_OK)
		return;
	rb_place_remove(&place, rb_place_beside(&place, last_ending, name));
	rb_place_remove(&place, rb_place_beside(&place, before_ending, name));
	rb_place_tidy(&place, last_ending);
	rb_place_release(&place);
}

/* ---- reading ---- */

/* Fails: a file is no checkpoint that can be used. */
static enum rb_status refuse(struct rb_error *err, const char *name, const char *why)
{
	return RB_FAIL(err, RB_ERR_INPUT, "'%s' is not a checkpoint to resume from: %s", name, why);
}

/*
 * Takes the section that begins at `*at`, which moves behind it. NULL: it is whole; else what is
 * wrong.
 */
static const char *take_section(const struct rb_checkpoint *checkpoint, int which, size_t *at,
                                struct rb_pack *pack)
{
	const size_t left = checkpoint->size - *at;
	struct section section;

	RB_ASSERT(which >= 0 && which < SECTION_COUNT);
	if (left < sizeof section)
		return "it ends too early";
	memcpy(&section, checkpoint->bytes + *at, sizeof section);
	if (memcmp(section.name, section_names[which], NAME_SIZE) != 0)
		return "it has other parts";
	if (section.size > left - sizeof section)
		return "it ends too early";
	*pack = (struct rb_pack){.loading = true,
	                         .bytes = checkpoint->bytes + *at + sizeof section,
	                         .size = (size_t)section.size};
	if (rb_hash_bytes(pack->bytes, pack->size, 0) != section.hash)
		return "a part of it has changed";
	*at += sizeof section + (size_t)section.size;
	return NULL;
}

/* NULL: the head is right; else what is wrong. */
static const char *check_head(const struct rb_checkpoint *checkpoint)
{
	struct head head;

	if (checkpoint->size < sizeof head)
		return "it is too short";
	memcpy(&head, checkpoint->bytes, sizeof head);
	if (memcmp(head.magic, magic, sizeof magic) != 0)
		return "it does not begin like one";
	if (head.order != order_mark)
		return "it is from a machine with another order of bytes";
	if (head.format != FORMAT)
		return "it is of another version of rbsim";
	if (head.size != checkpoint->size - sizeof head)
		return "it is cut off";
	if (rb_hash_bytes(checkpoint->bytes + sizeof head, (size_t)head.size, 0) != head.hash)
		return "it has changed since it was written";
	return NULL;
}

enum rb_status rb_checkpoint_parse(struct rb_checkpoint *checkpoint, unsigned char *bytes,
                                   size_t size, const char *name, struct rb_error *err)
{
	struct rb_pack about;
	size_t at = sizeof(struct head);

	*checkpoint = (struct rb_checkpoint){.bytes = bytes, .size = size};
	struct rb_pack *const parts[SECTION_COUNT] = {&about, &checkpoint->world,
	                                              &checkpoint->script, &checkpoint->run};
	const char *why = check_head(checkpoint);
	for (int i = 0; !why && i < SECTION_COUNT; i++)
		why = take_section(checkpoint, i, &at, parts[i]);
	if (!why && at != size)
		why = "there is more in it than should be";
	if (!why) {
		pack_about(&about, &checkpoint->about);
		why = about.failed ? "its first part is too short" : NULL;
	}
	return why ? refuse(err, name, why) : RB_OK;
}

/* All bytes of a file, to be freed; NULL where it cannot be read; errno says why. */
static unsigned char *read_all(const struct rb_place *place, const char *name, size_t *size)
{
	const int fd = rb_place_reach(place, name, O_RDONLY | O_NONBLOCK);
	struct stat found;
	unsigned char *bytes = NULL;

	if (fd < 0)
		return NULL;
	errno = EINVAL;
	if (fstat(fd, &found) == 0 && S_ISREG(found.st_mode)) {
		errno = ENOMEM;
		bytes = rb_memory_take((size_t)found.st_size + 1, 1);
	}
	*size = 0;
	while (bytes && *size < (size_t)found.st_size) {
		const ssize_t got = read(fd, bytes + *size, (size_t)found.st_size - *size);
		if (got < 0 && errno == EINTR)
			continue;
		if (got <= 0)
			break;
		*size += (size_t)got;
	}
	const int number = errno;
	close(fd);
	errno = number;
	return bytes;
}

/* Reads one of the two files. `*found`: it is there. */
static enum rb_status read_one(struct rb_checkpoint *checkpoint, bool *found,
                               const struct rb_place *place, const char *name, struct rb_error *err)
{
	size_t size;

	*checkpoint = (struct rb_checkpoint){0};
	unsigned char *const bytes = read_all(place, name, &size);
	*found = bytes || errno != ENOENT;
	if (!*found)
		return RB_OK;
	if (!bytes)
		return RB_FAIL(err, RB_ERR_INPUT, "cannot read '%s': %s", name,
		               errno == ELOOP ? "it is a symbolic link" : strerror(errno));
	return rb_checkpoint_parse(checkpoint, bytes, size, name, err);
}

/* Reads the last checkpoint, or where it is broken or missing the one before. */
static enum rb_status read_both(struct rb_checkpoint *checkpoint, bool *found,
                                const struct rb_place *place, struct rb_error *err)
{
	char name[RB_PLACE_NAME_SIZE], before[RB_PLACE_NAME_SIZE];
	struct rb_error second = {0};
	bool has_second = false;

	rb_place_beside(place, last_ending, name);
	rb_place_beside(place, before_ending, before);
	const enum rb_status status = read_one(checkpoint, found, place, name, err);
	if (!status && *found)
		return RB_OK;
	const bool broken = *found;
	rb_checkpoint_release(checkpoint);
	const enum rb_status other = read_one(checkpoint, &has_second, place, before, &second);
	if (!other && has_second) {
		if (broken) {
			rb_log(RB_LOG_WARNING, "%s: going on from the one before, '%s'",
			       err ? err->text : name, before);
			/* it must not take the place of the good one */
			rb_place_remove(place, name);
		}
		*found = true;
		return RB_OK;
	}
	rb_checkpoint_release(checkpoint);
	*found = broken || has_second;
	if (broken)
		return status;
	if (has_second && err)
		*err = second;
	return other;
}

enum rb_status rb_checkpoint_read(struct rb_checkpoint *checkpoint, bool *found,
                                  const char *recording, unsigned how, struct rb_error *err)
{
	struct rb_place place;

	*checkpoint = (struct rb_checkpoint){0};
	*found = false;
	enum rb_status status = rb_place_open(&place, recording, how, err);
	if (!status)
		status = read_both(checkpoint, found, &place, err);
	rb_place_release(&place);
	return status;
}

void rb_checkpoint_release(struct rb_checkpoint *checkpoint)
{
	rb_memory_free(checkpoint->bytes);
	*checkpoint = (struct rb_checkpoint){0};
}

/* Fails unless all of a part was asked for. */
static enum rb_status at_end(const struct rb_pack *pack, struct rb_error *err)
{
	if (pack->failed)
		return rb_pack_status(pack, "the checkpoint", err);
	return pack->at == pack->size ? RB_OK
	                              : RB_FAIL(err, RB_ERR_INPUT,
	                                        "the checkpoint holds more than this scene has");
}

enum rb_status rb_checkpoint_restore(struct rb_checkpoint *checkpoint,
                                     const struct rb_checkpoint_parts *parts, struct rb_error *err)
{
	enum rb_status status = rb_world_pack(parts->world, &checkpoint->world, err);

	if (!status)
		status = at_end(&checkpoint->world, err);
	if (!status)
		status = rb_script_pack(parts->script, &checkpoint->script, err);
	if (!status)
		status = at_end(&checkpoint->script, err);
	if (status)
		return status;
	parts->pack(parts->user, &checkpoint->run);
	status = at_end(&checkpoint->run, err);
	if (!status && (rb_world_hash(parts->world) != checkpoint->about.state_hash ||
	                rb_world_frame(parts->world) != checkpoint->about.frame))
		status = RB_FAIL(err, RB_ERR_INPUT,
		                 "the checkpoint gives another state than it was made of");
	return status;
}
