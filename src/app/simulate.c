/* SPDX-License-Identifier: MIT */
#include "app/simulate.h"

#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "app/progress.h"
#include "app/saving.h"
#include "base/clock.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/team.h"
#include "base/thread.h"
#include "flow/frame.h"
#include "flow/pump.h"
#include "math/vec3.h"
#include "sink/module.h"

/* Everything of a run that is under way; simulator's thread. */
struct run {
	struct rb_loaded *loaded;
	const struct rb_options *options;
	const struct rb_run_info *info;
	struct rb_run_result *result;

	struct rb_films *films;              /* NULL: none */
	struct rb_listen *listen;            /* NULL: none */
	struct rb_resume *resume;            /* NULL: from the beginning */
	bool again;                          /* ... over what the recording has */
	struct rb_saving *saving;            /* NULL: it is not recorded */
	enum rb_player_verdict verdict;      /* what commands have made of the run */
	const struct rb_hdf5_module *module; /* NULL: no recording */
	struct rb_recorder *recorder;
	struct rb_sink sink;         /* the recorder's */
	pthread_mutex_t films_lock;  /* of films_whole, */
	pthread_cond_t films_joined; /* ... which the recorder's thread waits for */
	bool films_whole;
	struct rb_ring *ring;
	struct rb_pump *pump;
	struct rb_frame numbers_only; /* the frame when there is no ring */
	struct rb_outcome outcome;    /* shared with the pump: see flow/pump.h */
	struct rb_world *world;
	struct rb_progress *progress;
	uint64_t start_ns;
};

int rb_simulate_threads(const struct rb_options *options)
{
	return options->threads > 0 ? options->threads : rb_team_processors();
}

/*
 * The words as a shell would read them again, to be freed; words of plain characters stay as they
 * are.
 */
static char *command_text(int argc, char *const *argv)
{
	static const char plain[] =
		"abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=./,:@%";
	size_t size = 1;

	for (int i = 0; i < argc; i++)
		size += 4 * strlen(argv[i]) + 3;
	char *const text = rb_memory_take(size, 1);
	char *to = text;
	for (int i = 0; text && i < argc; i++) {
		const bool quoted = !*argv[i] || argv[i][strspn(argv[i], plain)];
		if (i > 0)
			*to++ = ' ';
		if (quoted)
			*to++ = '\'';
		for (const char *from = argv[i]; *from; from++) {
			if (*from == '\'')
				to = stpcpy(to, "'\\'");
			*to++ = *from;
		}
		if (quoted)
			*to++ = '\'';
	}
	return text;
}

enum rb_status rb_simulate_info(struct rb_run_info *info, struct rb_run_texts *texts,
                                const struct rb_loaded *loaded, const struct rb_options *options,
                                struct rb_error *err)
{
	rb_run_info_init(info, texts, loaded->model);
	texts->command = command_text(options->argc, options->argv);
	if (!texts->command)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot keep the command line: out of memory");
	rb_build_text(texts->build, sizeof texts->build);
	info->version = RB_VERSION;
	info->build = texts->build;
	info->command = texts->command;
	info->threads = rb_simulate_threads(options);
	return RB_OK;
}

void rb_run_texts_release(struct rb_run_texts *texts)
{
	rb_memory_free(texts->command);
	*texts = (struct rb_run_texts){0};
}

/* Whether a name is wished for a film, not for a recording. */
static bool is_film_name(const char *name)
{
	static const char *const endings[] = {".mp4", ".webm", ".gif", ".png"};
	const char *const dot = strrchr(name, '.');

	for (size_t i = 0; dot && i < sizeof endings / sizeof *endings; i++)
		if (strcmp(dot, endings[i]) == 0)
			return true;
	return false;
}

enum rb_status rb_simulate_check_output(const struct rb_loaded *loaded,
                                        const struct rb_options *options, struct rb_error *err)
{
	struct stat output, scene;

	if (loaded->output && is_film_name(loaded->output))
		return RB_FAIL(err, RB_ERR_USAGE,
		               "'%s' would be the recording, an HDF5 file: films are named by "
		               "cameras ('video', 'png') or by rbsim render",
		               loaded->output);
	if (!loaded->output || stat(loaded->output, &output) != 0)
		return RB_OK; /* what else is wrong with the name shows when it is created */
	if (stat(options->operand[0], &scene) == 0 && scene.st_dev == output.st_dev &&
	    scene.st_ino == output.st_ino)
		return RB_FAIL(err, RB_ERR_CREATE, "cannot record to '%s': it is the scene",
		               loaded->output);
	if (!options->force && !options->resume && S_ISREG(output.st_mode))
		return RB_FAIL(err, RB_ERR_CREATE,
		               "cannot create '%s': it exists (--force replaces it, --resume goes "
		               "on with it, -o takes another name)",
		               loaded->output);
	return RB_OK;
}

/* Whether an essential sink has failed. */
static bool must_stop(const struct run *run)
{
	return run->pump && rb_pump_must_stop(run->pump);
}

/*
 * rb_world_options.stop, in any thread of the step. Within a frame a signal waits for its end,
 * where it can be kept.
 */
static bool stop_wanted(void *user)
{
	const struct run *const run = user;

	rb_progress_at(run->progress, rb_world_time(run->world));
	return must_stop(run) ||
	       (rb_progress_signal(run->progress) != 0 && !rb_saving_waits(run->saving));
}

/* Whether a signal ends the run after this frame. */
static bool ends_here(const struct run *run)
{
	return rb_progress_signal(run->progress) != 0 &&
	       (rb_saving_can(run->saving, rb_world_frame(run->world)) ||
	        !rb_saving_waits(run->saving));
}

/* RB_FIELD_* that consumers of frames read. */
static unsigned fields_wanted(const struct run *run)
{
	return rb_films_fields(run->films) | rb_listen_fields(run->listen) |
	       (run->recorder ? run->sink.fields : 0);
}

static enum rb_status start_world(struct run *run, struct rb_error *err)
{
	const struct rb_world_hooks hooks = rb_script_hooks(run->loaded->script);
	const struct rb_world_options options = {
		.threads = run->info->threads,
		.keep_events = fields_wanted(run) & RB_FIELD_EVENTS,
		.keep_contacts = fields_wanted(run) & RB_FIELD_CONTACTS,
		.stop = stop_wanted,
		.stop_user = run,
	};

	return rb_world_create(&run->world, run->loaded->model, &options, &hooks, err);
}

/* Makes the recorder, new or on what is there. */
static enum rb_status make_recorder(struct run *run, struct rb_error *err)
{
	const struct rb_resume *const resume = run->resume;
	struct rb_recorder_options options = {.path = run->loaded->output, .how = run->loaded->how};
	if (resume) {
		options.resume = true;
		options.row_count = resume->checkpoint.about.row_count;
		options.frame = resume->checkpoint.about.frame;
	} else if (run->again) {
		options.resume = true;
		options.row_count = 1;
		options.frame = 0;
	}
	const enum rb_status status = rb_module_hdf5(&run->module, err);

	if (status)
		return status;
	return run->module->recorder_create(&run->recorder, &run->sink, run->info, &options, err);
}

/* Feeds films, which have begun again, with what was recorded before. */
static enum rb_status feed_films(struct run *run, struct rb_error *err)
{
	if (!run->films || !run->resume)
		return RB_OK;
	const struct rb_resume_films to = {run->films, run->ring, stop_wanted, run};
	return rb_resume_feed(run->resume, run->loaded, &to, err);
}

/*
 * ---- the recording is complete only after the films: a run that is killed in between makes them
 * again ----
 */

static enum rb_status open_recording(void *self, struct rb_error *err)
{
	const struct run *const run = self;

	return run->sink.open(run->sink.self, err);
}

static enum rb_status record(void *self, const struct rb_frame *frame, struct rb_error *err)
{
	const struct run *const run = self;

	return run->sink.frame(run->sink.self, frame, err);
}

static enum rb_status flush_recording(void *self, struct rb_error *err)
{
	const struct run *const run = self;

	return run->sink.idle(run->sink.self, err);
}

static enum rb_status close_recording(void *self, const struct rb_outcome *outcome,
                                      struct rb_error *err)
{
	struct run *const run = self;

	/*
	 * films may take long: what has come so far is safe meanwhile, and what fails now fails
	 * once more below
	 */
	if (outcome == &run->outcome)
		(void)!flush_recording(self, NULL);
	pthread_mutex_lock(&run->films_lock);
	while (!run->films_whole)
		pthread_cond_wait(&run->films_joined, &run->films_lock);
	pthread_mutex_unlock(&run->films_lock);
	return run->sink.close(run->sink.self, outcome, err);
}

static void keep_for_recording(void *self, int most)
{
	struct run *const run = self;

	run->sink.may_keep(run->sink.self, most);
}

static int kept_for_recording(void *self)
{
	const struct run *const run = self;

	return run->sink.kept(run->sink.self);
}

static enum rb_status start_recording(struct run *run, struct rb_error *err)
{
	struct rb_sink sink = run->sink;

	sink.self = run;
	sink.open = open_recording;
	sink.frame = record;
	sink.idle = flush_recording;
	sink.close = close_recording;
	sink.may_keep = keep_for_recording;
	sink.kept = kept_for_recording;
	return rb_pump_start(&run->pump, run->ring, run->films ? &sink : &run->sink, &run->outcome,
	                     err);
}

/* Ends films and recording, in this order; the status of the latter. */
static enum rb_status join_consumers(struct run *run, struct rb_error *err)
{
	if (run->progress && rb_films_count(run->films) > 0)
		rb_progress_waits(run->progress, "the films");
	run->result->film_status = rb_films_join(run->films, &run->result->film_error);
	if (run->progress && run->pump)
		rb_progress_waits(run->progress, "the recording");
	pthread_mutex_lock(&run->films_lock);
	run->films_whole = true;
	pthread_cond_signal(&run->films_joined);
	pthread_mutex_unlock(&run->films_lock);
	return rb_pump_join(run->pump, err);
}

/*
 * Films before the recording: a film that can't begin leaves no file behind, and what it has missed
 * is read from a recording that nobody writes to.
 */
static enum rb_status start_consumers(struct run *run, struct rb_error *err)
{
	enum rb_status status = rb_ring_create(&run->ring, run->loaded->model, fields_wanted(run),
	                                       0, err);

	if (!status)
		status = rb_films_start(run->films, run->ring, &run->outcome, err);
	if (!status)
		status = feed_films(run, err);
	if (!status && run->recorder)
		status = start_recording(run, err);
	return status;
}

/* Pictures between two frames may be many, and nobody waits for them after a signal. */
static void cut_films(void *films, int signal)
{
	rb_films_cut(films, signal);
}

static RB_FIELDS_DEFINE_PART(run_sum_fields, struct rb_run_result, RB_RUN_SUM_FIELDS);

/* What the summary tells of all frames so far, and which pictures films leave out. */
static void pack_result(void *user, struct rb_pack *pack)
{
	struct run *const run = user;
	struct rb_run_result *const result = run->result;
	const double before_s = result->wall_before_s;

	/* saved: with the time of this process */
	if (!pack->loading)
		result->wall_before_s += (double)(rb_clock_now_ns() - run->start_ns) * 1e-9;
	rb_fields_pack(run_sum_fields(), result, 1, NULL, pack);
	if (!pack->loading)
		result->wall_before_s = before_s;
	rb_fields_pack(rb_frame_numbers_fields(), &result->first, 1, NULL, pack);
	rb_fields_pack(rb_frame_numbers_fields(), &result->last, 1, NULL, pack);
	rb_balance_pack(&result->balance, pack);
	rb_measured_pack(&result->measured, pack);
	rb_films_pack(run->films, pack);
}

static enum rb_status start_saving(struct run *run, struct rb_error *err)
{
	const struct rb_checkpoint_parts parts = {.world = run->world,
	                                          .script = run->loaded->script,
	                                          .pack = pack_result,
	                                          .user = run};
	const struct rb_saving_options options = {
		.loaded = run->loaded,
		.info = run->info,
		.module = run->module,
		.recorder = run->recorder,
		.every_s = run->options->checkpoint_every_s,
		.resumed = run->resume != NULL,
		.resumed_frame = run->resume ? run->resume->checkpoint.about.frame : 0,
		.parts = parts,
	};

	return run->recorder ? rb_saving_start(&run->saving, &options, err) : RB_OK;
}

static enum rb_status restore(struct run *run, struct rb_error *err)
{
	const struct rb_checkpoint_parts parts = {.world = run->world,
	                                          .script = run->loaded->script,
	                                          .pack = pack_result,
	                                          .user = run};

	return rb_checkpoint_restore(&run->resume->checkpoint, &parts, err);
}

/* The thread of signals first: what it blocks, all others inherit. */
static enum rb_status start(struct run *run, struct rb_error *err)
{
	const struct rb_progress_options options = {
		.quiet = run->options->quiet || run->options->json,
		.duration_s = run->loaded->model->duration_s,
		.heed = cut_films,
		.heed_user = run->films,
		.leave = run->listen ? rb_listen_forget : NULL,
		.leave_user = run->listen,
	};
	enum rb_status status = rb_progress_start(&run->progress, &options, err);

	if (!status && run->loaded->output)
		status = make_recorder(run, err);
	if (!status)
		status = start_world(run, err);
	rb_listen_has_films(run->listen, rb_films_count(run->films) > 0);
	if (!status && run->resume)
		status = restore(run, err);
	if (!status)
		run->result->state_hash = rb_world_hash(run->world);
	if (!status && run->resume)
		rb_listen_film(run->listen, rb_films_are_on(run->films));
	if (!status && (run->recorder || run->films))
		status = start_consumers(run, err);
	else if (!status)
		status = rb_frame_init(&run->numbers_only, run->loaded->model, fields_wanted(run),
		                       err);
	if (!status && run->recorder && !run->resume)
		rb_checkpoints_remove(run->loaded->output,
		                      run->loaded->how); /* of the run that was there before */
	if (!status)
		status = start_saving(run, err);
	return status;
}

static void take_numbers(struct rb_run_result *result, const struct rb_frame *frame)
{
	const struct rb_frame_numbers *const n = &frame->numbers;

	if (frame->index == 0)
		result->first = *n;
	const struct rb_frame_numbers *const first = &result->first;
	const double drift = fabs((n->kinetic_energy + n->potential_energy) -
	                          (first->kinetic_energy + first->potential_energy));
	result->last = *n;
	result->kinetic_max_j = rb_larger(result->kinetic_max_j, n->kinetic_energy);
	result->max_penetration_m = fmax(result->max_penetration_m, n->max_penetration);
	result->gravitation_error = fmax(result->gravitation_error, n->gravitation_error);
	result->gravitation_energy_error = fmax(result->gravitation_energy_error,
	                                        n->gravitation_energy_error);
	result->energy_drift_j = rb_larger(result->energy_drift_j, drift);
	result->momentum_drift = rb_larger(result->momentum_drift,
	                                   rb_change_of(n->momentum, first->momentum));
	result->angular_momentum_drift = rb_larger(
		result->angular_momentum_drift,
		rb_change_of(n->angular_momentum, first->angular_momentum));
	if (n->mass > 0) {
		const rb_vec3 way = rb_vec3_scale(frame->time_s / first->mass, first->momentum);

		result->center_drift_m = rb_larger(
			result->center_drift_m,
			rb_change_of(n->center_of_mass, rb_vec3_add(first->center_of_mass, way)));
	}
	rb_balance_take(&result->balance, n);
	result->frames++;
	result->time_s = frame->time_s;
}

/*
 * Hands the frame of this moment to the consumers, then to the script. `*ended`: an essential sink
 * has failed.
 */
static enum rb_status emit(struct run *run, bool *ended, struct rb_error *err)
{
	rb_progress_waits(run->progress, run->ring ? rb_ring_awaited(run->ring) : NULL);
	struct rb_frame *const frame = run->ring ? rb_ring_acquire(run->ring) : &run->numbers_only;

	rb_progress_waits(run->progress, NULL);
	*ended = !frame || must_stop(run);
	if (*ended)
		return RB_OK;
	enum rb_status status = rb_world_fill_frame(run->world, frame, err);
	if (!status)
		status = rb_films_shoot(run->films, frame, err);
	if (!status && frame->probes)
		status = rb_measured_take(&run->result->measured, run->loaded->script, run->world,
		                          frame->probes, err);
	if (status)
		return status;
	take_numbers(run->result, frame);
	if (run->listen)
		rb_listen_frame(run->listen, frame);
	if (run->ring)
		rb_ring_publish(run->ring);
	const uint64_t k = rb_world_frame(run->world);
	status = rb_script_on_frame(run->loaded->script, run->world, rb_world_time(run->world), k,
	                            err);
	/* now, as a signal or a failure may leave the world anywhere within the next frame */
	run->result->state_hash = rb_world_hash(run->world);
	return status;
}

/* Asked while the run is paused. */
static bool waits_no_more(void *user)
{
	const struct run *const run = user;

	rb_progress_paused(run->progress, rb_listen_paused_s(run->listen));
	return must_stop(run) || rb_progress_signal(run->progress) != 0;
}

/* Takes what commands have said of films since the frame before. */
static enum rb_status heed_films(const struct run *run, struct rb_error *err)
{
	const double time_s = rb_world_time(run->world);
	struct rb_player_aim aim;
	enum rb_status status = rb_films_switch(run->films, time_s, rb_listen_filming(run->listen),
	                                        err);

	while (!status && rb_listen_take_aim(run->listen, &aim))
		status = rb_films_steer(run->films, time_s, &aim, err);
	return status;
}

/* A command asks for a checkpoint. */
static void keep_asked(void *user)
{
	const struct run *const run = user;
	struct rb_error err;

	/* what commands have said of films before holds for what is kept */
	if (heed_films(run, &err) != RB_OK || rb_saving_ask(run->saving, &err) != RB_OK)
		rb_log(RB_LOG_WARNING, "%s", err.text);
	rb_saving_frame(run->saving, rb_world_frame(run->world));
}

/* After a frame: whether commands let the run go on. */
static enum rb_status pass(struct run *run, bool *on, struct rb_error *err)
{
	struct rb_player_frame frame = {.numbers = &run->result->last,
	                                .index = rb_world_frame(run->world),
	                                .time_s = rb_world_time(run->world)};

	*on = true;
	if (!run->listen)
		return RB_OK;
	if (run->ring)
		frame.ring_used = rb_ring_used(run->ring, &frame.ring_slots);
	const struct rb_listen_calls calls = {
		.stop = waits_no_more, .keep = keep_asked, .user = run};
	run->verdict = rb_listen_gate(run->listen, &frame, &calls);
	rb_progress_paused(run->progress, rb_listen_paused_s(run->listen));
	*on = run->verdict == RB_PLAYER_GO && !must_stop(run) && !ends_here(run);
	return heed_films(run, err);
}

static enum rb_status run_frames(struct run *run, struct rb_error *err)
{
	const uint64_t frame_count = rb_world_frame_count(run->world);
	bool ended = false, on = false;
	enum rb_status status = run->resume ? RB_OK : emit(run, &ended, err);

	if (!status && !ended)
		status = pass(run, &on, err);
	while (!status && on && rb_world_frame(run->world) + 1 < frame_count) {
		status = rb_world_step_frame(run->world, err);
		if (status || rb_world_stopped(run->world))
			break;
		status = emit(run, &ended, err);
		rb_progress_at(run->progress, rb_world_time(run->world));
		if (!status && !ended)
			rb_saving_frame(run->saving, rb_world_frame(run->world));
		if (ends_here(run))
			break;
		on = false;
		if (!status && !ended)
			status = pass(run, &on, err);
	}
	return status;
}

/* Whether the scene's expectations hold; only of a run that came to its end. */
static enum rb_status expect(struct run *run, struct rb_error *err)
{
	struct rb_run_result *const result = run->result;
	const int count = run->loaded->scene.expect_count;

	if (count == 0)
		return RB_OK;
	result->expects = rb_memory_take((size_t)count, sizeof *result->expects);
	if (!result->expects)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot check %d expectations: out of memory",
		               count);
	result->expect_status = rb_script_expects(run->loaded->script, run->world, result->expects,
	                                          &result->expect_error);
	if (result->expect_status && result->expect_status != RB_ERR_SCENE) {
		*err = result->expect_error;
		return result->expect_status;
	}
	result->expect_count = count;
	for (int i = 0; i < count; i++)
		result->expect_failures += !result->expects[i].ok;
	return RB_OK;
}

/* Expectations, then results. One whose function fails is told, and leaves the run whole. */
static enum rb_status judge(struct run *run, struct rb_error *err)
{
	struct rb_run_result *const result = run->result;
	const enum rb_status status = expect(run, err);

	if (status || result->expect_status)
		return status;
	result->expect_status = rb_measured_end(&result->measured, run->loaded->script, run->world,
	                                        &result->expect_error);
	if (result->expect_status == RB_ERR_SCENE)
		return RB_OK;
	*err = result->expect_error;
	return result->expect_status;
}

static enum rb_status tell_signal(struct rb_run_result *result, int signal, const char *why,
                                  struct rb_error *err)
{
	const double time_s = result->time_s;

	result->signal = signal;
	if (signal == SIGINT)
		return RB_FAIL(err, RB_ERR_INTERRUPT, "interrupted by SIGINT at %g s%s", time_s,
		               why);
	return RB_FAIL(err, RB_ERR_TERMINATE, "terminated by %s at %g s%s",
	               rb_thread_stop_name(signal), time_s, why);
}

/* The run has ended by a signal: what can be gone on from. */
static enum rb_status leave(struct run *run, int signal, struct rb_error *err)
{
	struct rb_error own = {0};
	char why[RB_ERROR_TEXT_SIZE + 32];
	uint64_t kept = 0;
	if (!run->saving)
		return tell_signal(run->result, signal, "", err);
	rb_progress_waits(run->progress, "the checkpoint");
	const enum rb_status status = rb_saving_last(run->saving, run->world, &kept, &own);
	rb_progress_waits(run->progress, NULL);
	if (status == RB_OK) {
		run->result->signal = signal;
		return RB_FAIL(err, RB_ERR_AGAIN,
		               "interrupted by %s at %g s: --resume goes on from frame %llu",
		               rb_thread_stop_name(signal), run->result->time_s,
		               (unsigned long long)kept);
	}
	snprintf(why, sizeof why, ", without a checkpoint: %s", own.text);
	return tell_signal(run->result, signal, why, err);
}

/* From the first frame to the verdict over the run, recorder and its failures apart. */
static enum rb_status simulate(struct run *run, struct rb_error *err)
{
	enum rb_status status = run_frames(run, err);

	if (status)
		return status;
	const int signal = rb_progress_signal(run->progress);
	if (run->verdict == RB_PLAYER_RESTART && !signal) {
		run->result->restart = true;
		return RB_FAIL(err, RB_ERR_INTERRUPT, "restarted by a command at %g s",
		               rb_world_time(run->world));
	}
	if (run->result->frames == rb_world_frame_count(run->world))
		return judge(run, err);
	if (run->verdict == RB_PLAYER_QUIT)
		return RB_FAIL(err, RB_ERR_INTERRUPT, "ended by the command 'quit' at %g s",
		               rb_world_time(run->world));
	if (signal)
		return leave(run, signal, err);
	return RB_OK; /* the recorder has failed: joining it tells how */
}

/*
 * After the recorder has failed: what is in the file. A file of another run may still have that
 * name.
 */
static void count_recorded(struct run *run)
{
	struct rb_reader *reader;

	run->result->recorder_failed = true;
	if (run->module->reader_open(&reader, run->loaded->output, NULL))
		return;
	const struct rb_reading *const reading = run->module->reader_reading(reader);
	if (strcmp(reading->started, run->info->started) == 0) {
		run->result->recorded_known = true;
		run->result->recorded_frames = reading->frame_count;
	}
	run->module->reader_close(reader);
}

/* A recording or a film that is lost weighs more than that the run was interrupted. */
static void take_failure(struct rb_run_result *result, enum rb_status status,
                         const struct rb_error *err)
{
	const bool interrupted = result->status == RB_ERR_INTERRUPT ||
	                         result->status == RB_ERR_TERMINATE ||
	                         result->status == RB_ERR_AGAIN;

	if (!status || (result->status && !interrupted))
		return;
	result->status = status;
	result->error = *err;
}

/* Closes the outputs with what has become of the run; the first failure is the one that is told. */
static void finish(struct run *run)
{
	struct rb_run_result *const result = run->result;
	struct rb_error err = {0};
	struct stat file;

	if (run->world) {
		result->frame_count = rb_world_frame_count(run->world);
		result->totals = rb_world_totals(run->world);
		result->work = rb_world_work(run->world);
	}
	run->outcome = (struct rb_outcome){
		.status = result->status,
		.reason = result->status ? result->error.text : "",
		.state_hash = result->state_hash,
		.results = result->measured.has_results ? result->measured.results : NULL,
	};
	if (run->ring)
		rb_ring_close(run->ring);
	const enum rb_status status = join_consumers(run, &err);
	take_failure(result, status, &err);
	result->checkpoints = rb_saving_stop(run->saving);
	if (run->recorder)
		run->module->recorder_destroy(run->recorder);
	if (status && result->frames > 0)
		count_recorded(run);
	if (run->recorder && !result->status && result->frames == result->frame_count)
		rb_checkpoints_remove(run->loaded->output, run->loaded->how);
	if (run->recorder && stat(run->loaded->output, &file) == 0)
		result->recording_bytes = (uint64_t)file.st_size;
	rb_ring_destroy(run->ring);
	rb_frame_release(&run->numbers_only);
	rb_world_destroy(run->world);
	const int signal = rb_progress_stop(run->progress);
	if (result->restart && signal) { /* it came while the outputs were closed */
		result->restart = false;
		result->status = tell_signal(result, signal, "", &result->error);
	}
}

enum rb_status rb_simulate(struct rb_run_result *result, struct rb_loaded *loaded,
                           const struct rb_options *options, const struct rb_run_info *info,
                           const struct rb_simulate_parts *parts)
{
	struct run run = {.loaded = loaded,
	                  .options = options,
	                  .info = info,
	                  .films = parts->films,
	                  .listen = parts->listen,
	                  .resume = parts->resume,
	                  .again = parts->again,
	                  .result = result,
	                  .start_ns = rb_clock_now_ns(),
	                  .outcome = {.reason = ""}};

	pthread_mutex_init(&run.films_lock, NULL);
	pthread_cond_init(&run.films_joined, NULL);
	*result = (struct rb_run_result){.frame_count = loaded->model->frame_count};
	result->status = rb_measured_init(&result->measured, &loaded->scene, &result->error);
	if (!result->status)
		result->status = start(&run, &result->error);
	if (!result->status)
		result->status = simulate(&run, &result->error);
	finish(&run);
	pthread_cond_destroy(&run.films_joined);
	pthread_mutex_destroy(&run.films_lock);
	result->memory_bytes = rb_process_bytes("VmHWM");
	result->wall_s = result->wall_before_s + (double)(rb_clock_now_ns() - run.start_ns) * 1e-9;
	if (parts->listen)
		result->wall_s -= rb_listen_paused_s(parts->listen);
	return result->status;
}

void rb_run_result_release(struct rb_run_result *result)
{
	rb_memory_free(result->expects);
	rb_measured_release(&result->measured);
	*result = (struct rb_run_result){0};
}
