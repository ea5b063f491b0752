/* SPDX-License-Identifier: MIT */
/*
 * A ring of pictures between one producer and several consumers: PNG threads, which take turns, and
 * one video thread, which takes every picture in order. A slot is free when all its outputs are
 * made; the producer waits for it, which limits memory. The first failure stops everything.
 */
#include "film/press.h"

#include <pthread.h>
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/outfile.h"
#include "base/thread.h"
#include "film/encoder.h"

/* Slots besides those that threads are working at: the next one for each kind of output. */
enum { SLOTS_SPARE = 2, NAME_SIZE = 4096 };

struct slot {
	struct rb_pixmap pixmap;
	uint64_t picture;
	double time_s;
	int outputs; /* still to be made; 0: the slot is free */
};

struct rb_press {
	/* set before the threads start, then only read */
	struct rb_press_options options;
	int slot_count, kinds; /* kinds of outputs: 1 or 2 */

	/* the thread's that owns the press */
	pthread_t thread[RB_PRESS_THREADS_MAX + 1];
	int thread_count;
	bool closed;

	/* the video thread's while there is one, then the owner's */
	struct rb_encoder *encoder;

	/* protected by lock; a slot's picture belongs to its printers while `outputs` > 0 */
	pthread_mutex_t lock;
	pthread_cond_t changed;
	struct slot slot[RB_PRESS_THREADS_MAX + SLOTS_SPARE + 1];
	uint64_t pushed, png_next, video_next;
	bool ending;
	enum rb_status status; /* the first failure */
	struct rb_error error;
	struct rb_press_tally tally;
};

/* ---- names ---- */

/* The pattern comes from a user: it is parsed here and never given to printf. */
bool rb_press_name(char *out, size_t size, const char *pattern, uint64_t picture)
{
	size_t used = 0;
	int numbers = 0;

	for (const char *p = pattern; *p; p++) {
		char number[32];
		if (used + sizeof number > size)
			return false;
		if (*p != '%' || *++p == '%') {
			out[used++] = *p;
			continue;
		}
		const char fill = *p == '0' ? '0' : ' ';
		p += *p == '0';
		const int width = *p >= '1' && *p <= '9' ? *p++ - '0' : 0;
		if (*p != 'd')
			return false;
		const int length = snprintf(number, sizeof number, "%llu",
		                            (unsigned long long)picture);
		for (int i = length; i < width; i++)
			out[used++] = fill;
		if (used + (size_t)length >= size)
			return false;
		memcpy(out + used, number, (size_t)length);
		used += (size_t)length;
		numbers++;
	}
	out[used] = '\0';
	return numbers == 1;
}

/* File name of a picture. */
static enum rb_status name_of(const struct rb_press_options *options, uint64_t picture,
                              char name[NAME_SIZE], struct rb_error *err)
{
	if (options->still) {
		if (snprintf(name, NAME_SIZE, "%s", options->png) < NAME_SIZE)
			return RB_OK;
	} else if (rb_press_name(name, NAME_SIZE, options->png, picture)) {
		return RB_OK;
	}
	return RB_FAIL(err, RB_ERR_SCENE,
	               "pictures '%.120s': the name must hold one %%d for the number, like "
	               "'frames/%%05d.png'",
	               options->png);
}

/* What the encoder needs. */
static struct rb_encoder_options encoder_options(const struct rb_press_options *options)
{
	return (struct rb_encoder_options){.path = options->video,
	                                   .how = options->how,
	                                   .width = options->width,
	                                   .height = options->height,
	                                   .fps = options->fps,
	                                   .title = options->title,
	                                   .cut = options->cut,
	                                   .patience_s = options->patience_s};
}

enum rb_status rb_press_check(const struct rb_press_options *options, struct rb_error *err)
{
	const struct rb_encoder_options encoder = encoder_options(options);
	char name[NAME_SIZE];
	enum rb_status status = RB_OK;

	if (options->png) {
		status = name_of(options, 0, name, err);
		if (!status)
			status = rb_outfile_probe(name, options->how, err);
	}
	if (!status && options->video)
		status = rb_encoder_check(&encoder, err);
	return status;
}

/* ---- threads ---- */

/* Keeps the first failure. */
static void fail_locked(struct rb_press *press, enum rb_status status, const struct rb_error *error)
{
	if (press->status)
		return;
	press->status = status;
	press->error = *error;
}

/* Counts an output as made and wakes whoever waits for the slot. */
static void output_done_locked(struct rb_press *press, struct slot *slot)
{
	RB_ASSERT(slot->outputs > 0);

	if (--slot->outputs == 0 && !press->status)
		press->tally.pictures++;
	pthread_cond_broadcast(&press->changed);
}

/* Waits for the next picture of a kind of output; NULL: there will be none. */
static struct slot *next_locked(struct rb_press *press, uint64_t *next)
{
	while (*next == press->pushed && !press->ending && !press->status)
		pthread_cond_wait(&press->changed, &press->lock);
	if (*next == press->pushed)
		return NULL;
	RB_ASSERT(*next < press->pushed && press->pushed - *next <= (uint64_t)press->slot_count);
	return &press->slot[(*next)++ % (uint64_t)press->slot_count];
}

/* Writes a slot's picture with texts about it. */
static enum rb_status make_png(const struct rb_press *press, const struct slot *slot, size_t *bytes,
                               struct rb_error *err)
{
	const struct rb_press_options *const options = &press->options;
	struct rb_png_text texts[RB_PRESS_TEXTS_MAX + 3];
	char name[NAME_SIZE], time[48], number[32];
	int count = options->text_count;

	memcpy(texts, options->texts, (size_t)count * sizeof *texts);
	snprintf(time, sizeof time, "%.12g s", slot->time_s);
	texts[count++] = (struct rb_png_text){"Simulated time", time};
	snprintf(number, sizeof number, "%llu", (unsigned long long)slot->picture);
	texts[count++] = (struct rb_png_text){"Picture", number};
	texts[count] = (struct rb_png_text){0};
	const enum rb_status status = name_of(options, slot->picture, name, err);
	if (status)
		return status;
	return rb_png_write(name, options->how, &slot->pixmap, texts, bytes, err);
}

/* Body of a PNG thread; after a failure slots are only released. */
static void *print_png(void *argument)
{
	struct rb_press *const press = argument;
	struct slot *slot;

	rb_thread_name("png");
	pthread_mutex_lock(&press->lock);
	while ((slot = next_locked(press, &press->png_next)) != NULL) {
		const bool wanted = !press->status;
		struct rb_error error;
		enum rb_status status = RB_OK;
		size_t bytes = 0;

		pthread_mutex_unlock(&press->lock);
		const uint64_t begin = rb_clock_now_ns();
		if (wanted)
			status = make_png(press, slot, &bytes, &error);
		const uint64_t end = rb_clock_now_ns();
		pthread_mutex_lock(&press->lock);
		press->tally.png_ns += end - begin;
		press->tally.bytes += bytes;
		if (status)
			fail_locked(press, status, &error);
		output_done_locked(press, slot);
	}
	pthread_mutex_unlock(&press->lock);
	return NULL;
}

/*
 * Body of the video thread. Pictures printed before something else failed still belong to the film.
 */
static void *print_video(void *argument)
{
	struct rb_press *const press = argument;
	struct slot *slot;
	bool broken = false;

	rb_thread_name("video");
	pthread_mutex_lock(&press->lock);
	while ((slot = next_locked(press, &press->video_next)) != NULL) {
		struct rb_error error;
		enum rb_status status = RB_OK;

		pthread_mutex_unlock(&press->lock);
		const uint64_t begin = rb_clock_now_ns();
		if (!broken)
			status = rb_encoder_picture(press->encoder, &slot->pixmap, &error);
		const uint64_t end = rb_clock_now_ns();
		pthread_mutex_lock(&press->lock);
		press->tally.pipe_ns += end - begin;
		if (status) {
			broken = true;
			fail_locked(press, status, &error);
		}
		output_done_locked(press, slot);
	}
	pthread_mutex_unlock(&press->lock);
	return NULL;
}

/* Starts one thread. */
static enum rb_status start_thread(struct rb_press *press, void *(*run)(void *),
                                   struct rb_error *err)
{
	const int failed = rb_thread_start(&press->thread[press->thread_count], run, press);

	if (failed)
		return RB_FAIL(err, RB_ERR_MISSING, "cannot start a thread for pictures: %s",
		               strerror(failed));
	press->thread_count++;
	return RB_OK;
}

/* ---- the owner's side ---- */

/* Slots, folders, encoder, threads. */
static enum rb_status set_up(struct rb_press *press, int png_threads, struct rb_error *err)
{
	const struct rb_press_options *const options = &press->options;
	const struct rb_encoder_options encoder = encoder_options(options);
	char name[NAME_SIZE];
	enum rb_status status = RB_OK;

	if (options->png) {
		status = name_of(options, 0, name, err);
		if (!status)
			status = rb_outfile_folders(name, options->how, err);
	}
	if (!status && options->video) {
		status = rb_outfile_folders(options->video, options->how, err);
		if (!status)
			status = rb_encoder_create(&press->encoder, &encoder, err);
	}
	for (int i = 0; i < png_threads && !status; i++)
		status = start_thread(press, print_png, err);
	if (!status && options->video)
		status = start_thread(press, print_video, err);
	return status;
}

enum rb_status rb_press_create(struct rb_press **press, const struct rb_press_options *options,
                               struct rb_error *err)
{
	struct rb_press *const p = *press = rb_memory_take(1, sizeof *p);
	int png_threads = options->png_threads < 1 ? 1 : options->png_threads;

	if (!p)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot prepare a film: out of memory");
	if (png_threads > RB_PRESS_THREADS_MAX)
		png_threads = RB_PRESS_THREADS_MAX;
	if (!options->png || options->still)
		png_threads = options->png ? 1 : 0;
	p->options = *options;
	p->slot_count = options->still ? 1 : png_threads + (options->video ? 1 : 0) + SLOTS_SPARE;
	p->kinds = (options->png ? 1 : 0) + (options->video ? 1 : 0);
	pthread_mutex_init(&p->lock, NULL);
	pthread_cond_init(&p->changed, NULL);
	const enum rb_status status = set_up(p, png_threads, err);
	if (status) {
		rb_press_destroy(p);
		*press = NULL;
	}
	return status;
}

enum rb_status rb_press_print(struct rb_press *press, const struct rb_pixmap *pixmap,
                              uint64_t picture, double time_s, struct rb_error *err)
{
	const uint64_t begin = rb_clock_now_ns();

	pthread_mutex_lock(&press->lock);
	struct slot *const slot = &press->slot[press->pushed % (uint64_t)press->slot_count];
	while (slot->outputs > 0 && !press->status)
		pthread_cond_wait(&press->changed, &press->lock);
	press->tally.wait_ns += rb_clock_now_ns() - begin;
	const enum rb_status status = press->status;
	if (status && err)
		*err = press->error;
	pthread_mutex_unlock(&press->lock);
	if (status)
		return status;

	/*
	 * A free slot is its filler's alone until it is counted as pushed. It gets its memory when
	 * it is needed: stills and films that are cut need few.
	 */
	if (!slot->pixmap.rgba) {
		const enum rb_status failed = rb_pixmap_init(&slot->pixmap, press->options.width,
		                                             press->options.height, err);
		if (failed)
			return failed;
	}
	RB_ASSERT(pixmap->width == slot->pixmap.width && pixmap->height == slot->pixmap.height);
	memcpy(slot->pixmap.rgba, pixmap->rgba, 4 * (size_t)pixmap->width * (size_t)pixmap->height);
	slot->picture = picture;
	slot->time_s = time_s;
	pthread_mutex_lock(&press->lock);
	slot->outputs = press->kinds;
	press->pushed++;
	if (press->kinds == 0)
		press->tally.pictures++;
	pthread_cond_broadcast(&press->changed);
	pthread_mutex_unlock(&press->lock);
	return RB_OK;
}

/* Tells the threads to end after what was pushed, and waits. */
static void join(struct rb_press *press)
{
	pthread_mutex_lock(&press->lock);
	press->ending = true;
	pthread_cond_broadcast(&press->changed);
	pthread_mutex_unlock(&press->lock);
	for (int i = 0; i < press->thread_count; i++)
		pthread_join(press->thread[i], NULL);
	press->thread_count = 0;
}

enum rb_status rb_press_close(struct rb_press *press, struct rb_error *err)
{
	RB_ASSERT(!press->closed);
	press->closed = true;
	join(press);
	if (press->encoder) {
		struct rb_error error;
		uint64_t bytes = 0;
		const uint64_t begin = rb_clock_now_ns();
		const enum rb_status status = rb_encoder_finish(press->encoder, false, &bytes,
		                                                &error);
		press->tally.pipe_ns += rb_clock_now_ns() - begin;
		press->tally.bytes += bytes;
		if (status)
			fail_locked(press, status, &error); /* nobody else is left */
	}
	if (press->status && err)
		*err = press->error;
	return press->status;
}

void rb_press_destroy(struct rb_press *press)
{
	if (!press)
		return;
	join(press);
	rb_encoder_destroy(press->encoder);
	for (int i = 0; i < press->slot_count; i++)
		rb_pixmap_release(&press->slot[i].pixmap);
	pthread_cond_destroy(&press->changed);
	pthread_mutex_destroy(&press->lock);
	rb_memory_free(press);
}

struct rb_press_tally rb_press_tally(struct rb_press *press)
{
	pthread_mutex_lock(&press->lock);
	const struct rb_press_tally tally = press->tally;
	pthread_mutex_unlock(&press->lock);
	return tally;
}
