/* SPDX-License-Identifier: MIT */
/*
 * --resume must continue the same run or none: scene texts, parameters, seed, method and numbers
 * are compared with those that the recording states, and the checkpoint's hash with that of this
 * command line. The comparison says what differs; the hash only that something does.
 *
 * Films have no checkpoints: they begin again, fed with the frames of the recording up to the
 * checkpoint.
 */
#include "app/resume.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/hash.h"
#include "base/log.h"
#include "base/place.h"
#include "base/memory.h"
#include "flow/between.h"
#include "flow/frame.h"
#include "sink/module.h"

/* ---- whose run ---- */

/* Adds a text with the zero at its end: "ab" + "c" is not "a" + "bc". */
static uint64_t hash_text(uint64_t hash, const char *text)
{
	/* with the zero at its end: "ab" + "c" is not "a" + "bc" */
	return rb_hash_bytes(text, strlen(text) + 1, hash);
}

uint64_t rb_resume_run_hash(const struct rb_loaded *loaded)
{
	const struct rb_scene *const scene = &loaded->scene;
	const struct rb_model *const model = loaded->model;
	const double numbers[] = {model->duration_s, model->frame_rate, model->time_step_s,
	                          model->tolerance_m, model->stepped_tolerance_m};
	uint64_t hash = hash_text(0, RB_VERSION);

	for (int i = 0; i < scene->file_count; i++) {
		const struct rb_source_file *const file = &scene->files[i];

		hash = hash_text(hash, file->name);
		hash = rb_hash_bytes(file->text, file->size_bytes, hash);
	}
	for (int i = 0; i < scene->param_count; i++) {
		hash = hash_text(hash, scene->params[i].name);
		hash = hash_text(hash, scene->params[i].value_text);
	}
	hash = hash_text(hash, rb_model_method(model));
	hash = hash_text(hash, rb_rollback_name(model->rollback));
	hash = rb_hash_bytes(&scene->world.seed, sizeof scene->world.seed, hash);
	return rb_hash_bytes(numbers, sizeof numbers, hash);
}

/* Fails with what was and what is. */
static enum rb_status differs(struct rb_error *err, const char *name, const char *what,
                              const char *then, const char *now)
{
	return RB_FAIL(err, RB_ERR_USAGE,
	               "option '--resume': '%s' is of another run: %s was %.60s, is %.60s (--force "
	               "instead begins anew)",
	               name, what, then, now);
}

static enum rb_status compare_texts(const char *name, const char *what, const char *then,
                                    const char *now, struct rb_error *err)
{
	return strcmp(then, now) == 0 ? RB_OK : differs(err, name, what, then, now);
}

static enum rb_status compare_numbers(const char *name, const char *what, double then, double now,
                                      struct rb_error *err)
{
	char texts[2][40];

	if (then == now)
		return RB_OK;
	snprintf(texts[0], sizeof texts[0], "%.17g", then);
	snprintf(texts[1], sizeof texts[1], "%.17g", now);
	return differs(err, name, what, texts[0], texts[1]);
}

/* Compares the texts of the scene's files, to the byte. */
static enum rb_status compare_files(const char *name, const struct rb_scene *scene,
                                    const struct rb_reading *reading, struct rb_error *err)
{
	for (int i = 0; i < scene->file_count && i < reading->file_count; i++) {
		const struct rb_source_file *const file = &scene->files[i];

		if (strcmp(file->name, reading->file_names[i]) != 0 ||
		    file->size_bytes != reading->file_sizes[i] ||
		    memcmp(file->text, reading->file_texts[i], file->size_bytes) != 0)
			return RB_FAIL(err, RB_ERR_USAGE,
			               "option '--resume': '%s' was made before '%s' was changed "
			               "(--force instead begins anew)",
			               name, file->name);
	}
	if (scene->file_count == reading->file_count)
		return RB_OK;
	return RB_FAIL(err, RB_ERR_USAGE,
	               "option '--resume': '%s' was made from %d %s, the scene has %d "
	               "(--force instead begins anew)",
	               name, reading->file_count,
	               rb_text_plural((uint64_t)reading->file_count, "file", "files"),
	               scene->file_count);
}

/* The recorded text of a parameter. */
static const char *recorded_value(const struct rb_reading *reading, const char *param)
{
	for (int i = 0; i < reading->param_count; i++)
		if (strcmp(reading->param_names[i], param) == 0)
			return reading->param_values[i];
	return "not there";
}

static enum rb_status compare_params(const char *name, const struct rb_scene *scene,
                                     const struct rb_reading *reading, struct rb_error *err)
{
	enum rb_status status = RB_OK;
	char what[80];

	for (int i = 0; i < scene->param_count && !status; i++) {
		const struct rb_param_def *const param = &scene->params[i];

		snprintf(what, sizeof what, "parameter '%.60s'", param->name);
		status = compare_texts(name, what, recorded_value(reading, param->name),
		                       param->value_text, err);
	}
	return status;
}

/* Compares all that makes a run, in the order in which people would look for the difference. */
static enum rb_status compare(const char *name, const struct rb_loaded *loaded,
                              const struct rb_reading *reading, struct rb_error *err)
{
	const struct rb_model *const model = loaded->model;
	const struct {
		const char *what;
		double then, now;
	} numbers[] = {{"the duration", reading->duration_s, model->duration_s},
	               {"the frame rate", reading->frame_rate, model->frame_rate},
	               {"the time step", reading->time_step_s, model->time_step_s},
	               {"the tolerance", reading->tolerance_m, model->tolerance_m},
	               {"the tolerance of steps", reading->stepped_tolerance_m,
	                model->stepped_tolerance_m}};
	const uint64_t seed = loaded->scene.world.seed;
	char texts[2][24];
	enum rb_status status = compare_texts(name, "rbsim", reading->version, RB_VERSION, err);

	if (!status)
		status = compare_files(name, &loaded->scene, reading, err);
	if (!status)
		status = compare_params(name, &loaded->scene, reading, err);
	if (!status && seed != reading->seed) {
		snprintf(texts[0], sizeof texts[0], "%llu", (unsigned long long)reading->seed);
		snprintf(texts[1], sizeof texts[1], "%llu", (unsigned long long)seed);
		status = differs(err, name, "the seed", texts[0], texts[1]);
	}
	if (!status)
		status = compare_texts(name, "the method", reading->method, rb_model_method(model),
		                       err);
	if (!status)
		status = compare_texts(name, "rollback", reading->rollback,
		                       rb_rollback_name(model->rollback), err);
	for (size_t i = 0; i < sizeof numbers / sizeof *numbers && !status; i++)
		status = compare_numbers(name, numbers[i].what, numbers[i].then, numbers[i].now,
		                         err);
	return status;
}

/* ---- what is there ---- */

/*
 * Whether the checkpoint can be used. One that is not this recording's is of no use, and says
 * nothing about it.
 */
static enum rb_status judge(struct rb_resume *resume, const struct rb_loaded *loaded,
                            const struct rb_reading *reading, struct rb_error *err)
{
	const struct rb_checkpoint_about *const about = &resume->checkpoint.about;

	if (strcmp(about->started, reading->started) != 0) {
		rb_log(RB_LOG_WARNING,
		       "the checkpoint of '%s' is of another recording: from the beginning",
		       loaded->output);
		rb_checkpoint_release(&resume->checkpoint);
		return RB_OK;
	}
	if (about->run != rb_resume_run_hash(loaded))
		return RB_FAIL(err, RB_ERR_USAGE,
		               "option '--resume': the checkpoint of '%s' is of another run "
		               "(--force instead begins anew)",
		               loaded->output);
	if (about->row_count == 0 || about->row_count > reading->frame_count)
		return RB_FAIL(err, RB_ERR_INPUT,
		               "'%s' holds %llu %s, and its checkpoint comes after %llu: it "
		               "was cut off",
		               loaded->output, (unsigned long long)reading->frame_count,
		               rb_text_plural(reading->frame_count, "frame", "frames"),
		               (unsigned long long)about->row_count);
	resume->kind = RB_RESUME_GO_ON;
	return RB_OK;
}

/*
 * Checks what will be written to: no link, and whether a living process writes it, which has a lock
 * on it (sink/h5output).
 */
static enum rb_status check_file(const struct rb_loaded *loaded, bool *is_written,
                                 struct rb_error *err)
{
	struct rb_place place;
	enum rb_status status = rb_place_open(&place, loaded->output, loaded->how, err);

	if (status)
		return status;
	const int fd = rb_place_reach(&place, place.name, O_RDONLY | O_NONBLOCK);
	if (fd < 0)
		status = RB_FAIL(err, RB_ERR_CREATE, "cannot write to '%s': %s", loaded->output,
		                 errno == ELOOP ? "it is a symbolic link" : strerror(errno));
	*is_written = fd >= 0 && rb_place_is_written(fd);
	if (fd >= 0)
		close(fd);
	rb_place_release(&place);
	return status;
}

/* Decides what of a recording there is to continue. */
static enum rb_status look(struct rb_resume *resume, const struct rb_loaded *loaded,
                           const struct rb_reading *reading, struct rb_error *err)
{
	bool found = false, is_written;
	enum rb_status status = check_file(loaded, &is_written, err);

	if (!status)
		status = compare(loaded->output, loaded, reading, err);
	if (status)
		return status;
	if (strcmp(reading->status, "complete") == 0) {
		resume->kind = RB_RESUME_DONE;
		return RB_OK;
	}
	if (is_written)
		return RB_FAIL(err, RB_ERR_CREATE,
		               "cannot write to '%s': the run that writes it goes on",
		               loaded->output);
	status = rb_checkpoint_read(&resume->checkpoint, &found, loaded->output, loaded->how, err);
	snprintf(resume->started, sizeof resume->started, "%s", reading->started);
	if (!status && found)
		return judge(resume, loaded, reading, err);
	/* a run that is killed early and often loses no frame that could be read */
	if (!status && reading->frame_count > 0)
		resume->kind = RB_RESUME_AGAIN;
	if (!status)
		rb_log(RB_LOG_NOTE, "'%s' has no checkpoint: from the beginning", loaded->output);
	return status;
}

enum rb_status rb_resume_look(struct rb_resume *resume, const struct rb_loaded *loaded,
                              const struct rb_options *options, struct rb_error *err)
{
	const struct rb_hdf5_module *module;
	struct rb_reader *reader;
	struct stat found;

	*resume = (struct rb_resume){0};
	if (!options->resume || !loaded->output)
		return RB_OK;
	if (stat(loaded->output, &found) != 0)
		return RB_OK; /* what else is wrong with the name shows when it is created */
	enum rb_status status = rb_module_hdf5(&module, err);
	if (!status)
		status = module->reader_open(&reader, loaded->output, err);
	if (status)
		return status;
	status = look(resume, loaded, module->reader_reading(reader), err);
	module->reader_close(reader);
	return status;
}

void rb_resume_release(struct rb_resume *resume)
{
	rb_checkpoint_release(&resume->checkpoint);
	*resume = (struct rb_resume){0};
}

/* ---- films ---- */

/* Fills a column of the ring's frame, if it has one. False: the recording lacks it. */
static bool copy_column(double *to, const double *from, int count, int width)
{
	if (!to || count == 0)
		return true;
	if (from)
		memcpy(to, from, (size_t)count * (size_t)width * sizeof *to);
	return from != NULL;
}

/* Fills a list, whose memory is kept for the next frame of the slot. False: no memory. */
static bool copy_list(void **to, int *capacity, const void *from, int count, size_t size)
{
	size_t room = (size_t)*capacity;

	if (count == 0)
		return true;
	if (!rb_memory_reserve(to, &room, (size_t)count, size))
		return false;
	*capacity = (int)room;
	memcpy(*to, from, (size_t)count * size);
	return true;
}

/* Fills events and contacts. False: no memory. */
static bool copy_lists(struct rb_frame *to, const struct rb_frame *from)
{
	void *events = to->events, *contacts = to->contacts;
	const bool held = copy_list(&events, &to->event_capacity, from->events, from->event_count,
	                            sizeof *to->events) &&
	                  copy_list(&contacts, &to->contact_capacity, from->contacts,
	                            from->contact_count, sizeof *to->contacts);

	to->events = events;
	to->contacts = contacts;
	to->has_events = from->has_events;
	to->event_count = held ? from->event_count : 0;
	to->contact_count = held ? from->contact_count : 0;
	return held;
}

/* Fills columns and numbers. False: the recording lacks a column. */
static bool copy_frame(struct rb_frame *to, const struct rb_frame *from)
{
	to->index = from->index;
	to->time_s = from->time_s;
	to->numbers = from->numbers;
	return copy_column(to->position, from->position, to->body_count, 3) &&
	       copy_column(to->orientation, from->orientation, to->body_count, 4) &&
	       copy_column(to->velocity, from->velocity, to->body_count, 3) &&
	       copy_column(to->angular_velocity, from->angular_velocity, to->body_count, 3);
}

/*
 * Refuses films whose contents the recording does not have, and warns where it has them
 * differently.
 */
static enum rb_status check_fields(const struct rb_loaded *loaded, const struct rb_films *films,
                                   const struct rb_reading *reading, struct rb_error *err)
{
	const struct rb_record_def *const record = &loaded->scene.record;
	const unsigned all = rb_films_fields(films);

	if (rb_films_missing(loaded->model, all & (unsigned)RB_FIELD_DEFAULT, reading->fields))
		return RB_FAIL(
			err, RB_ERR_USAGE,
			"option '--resume': '%s' does not hold what its films show, so they can't "
			"be made again up to the checkpoint (--no-render goes on without them)",
			loaded->output);
	rb_films_tell_missing(loaded->model, loaded->output, all, reading->fields);
	if (record->every > 1 || record->single_precision)
		rb_log(RB_LOG_WARNING,
		       "films begin again from the recording, which has %s: up to the checkpoint "
		       "pictures may differ",
		       record->every > 1 ? "not every frame" : "single precision");
	return RB_OK;
}

/* Hands one recorded frame to the films. */
static enum rb_status feed(const struct rb_hdf5_module *module, struct rb_reader *reader,
                           uint64_t row, struct rb_films *films, struct rb_ring *ring,
                           struct rb_error *err)
{
	struct rb_frame frame;
	struct rb_frame *const slot = rb_ring_acquire(ring);

	if (!slot)
		return RB_OK; /* a consumer has failed: who waits for it tells */
	enum rb_status status = module->reader_frame(reader, row, &frame, err);
	if (!status && frame.body_count != slot->body_count)
		status = RB_FAIL(err, RB_ERR_INPUT, "the recording has other bodies");
	if (!status && !copy_frame(slot, &frame))
		status = RB_FAIL(err, RB_ERR_INPUT, "the recording lacks a column of frame %llu",
		                 (unsigned long long)frame.index);
	if (!status && !copy_lists(slot, &frame))
		status = RB_FAIL(err, RB_ERR_MEMORY, "no memory for the events of a frame");
	if (!status)
		status = rb_films_shoot(films, slot, err);
	if (!status)
		rb_ring_publish(ring);
	return status;
}

enum rb_status rb_resume_feed(const struct rb_resume *resume, const struct rb_loaded *loaded,
                              const struct rb_resume_films *to, struct rb_error *err)
{
	const struct rb_hdf5_module *module;
	struct rb_reader *reader;
	enum rb_status status = rb_module_hdf5(&module, err);

	if (!status)
		status = module->reader_open(&reader, loaded->output, err);
	if (status)
		return status;
	status = check_fields(loaded, to->films, module->reader_reading(reader), err);
	for (uint64_t row = 0;
	     !status && row < resume->checkpoint.about.row_count && !to->stop(to->user); row++)
		status = feed(module, reader, row, to->films, to->ring, err);
	module->reader_close(reader);
	return status;
}
