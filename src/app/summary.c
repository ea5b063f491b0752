/* SPDX-License-Identifier: MIT */
/*
 * The same result twice: for people, where what did not happen is left out, and as JSON, where
 * every key is always there, with null for what is not known, so that scripts need no cases.
 */
#include "app/summary.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "app/film_summary.h"
#include "app/json.h"
#include "base/visible.h"
#include "model/descriptor.h"

/* A rate; NAN without any time. */
static double per_second(uint64_t count, double seconds)
{
	return seconds > 0 ? (double)count / seconds : (double)NAN;
}

void rb_summary_print_expects(FILE *file, const struct rb_run_result *result, bool failed_only,
                              bool color)
{
	for (int i = 0; i < result->expect_count; i++) {
		const struct rb_expect_result *const e = &result->expects[i];
		if (failed_only && e->ok)
			continue;
		const char *paint = e->ok ? "\033[32m" : "\033[31m";
		fprintf(file, "    %s%-4s%s ", color ? paint : "", e->ok ? "ok" : "FAIL",
		        color ? "\033[0m" : "");
		rb_print(file, "%s", e->text);
		if (e->has_numbers)
			rb_print(file, ": measured %.6g, bound %.6g", e->measured, e->bound);
		if (!e->ok && *e->message && !e->has_numbers)
			rb_print(file, ": %s", e->message);
		if (!e->ok && e->always && !isnan(e->failed_s))
			rb_print(file, " (first at %g s)", e->failed_s);
		putc('\n', file);
	}
}

/* Prints what the run has cost. */
static void print_work(FILE *file, const struct rb_run_result *result)
{
	const struct rb_world_work *const work = &result->work;
	const uint64_t tried = work->body_steps + work->discarded_body_steps;

	rb_print(file, "  work          %" PRIu64 " body steps, %.3g per second", work->body_steps,
	         per_second(work->body_steps, result->wall_s));
	if (work->discarded_body_steps > 0)
		rb_print(file, "; %.3g %% of the work thrown away",
		         100 * (double)work->discarded_body_steps / (double)tried);
	rb_print(file, "\n  rollbacks     %" PRIu64, result->totals.rollbacks);
	if (isfinite(result->totals.smallest_step) && result->totals.smallest_step > 0)
		rb_print(file, ", smallest step %.3g s", result->totals.smallest_step);
	rb_print(file, "\n  impacts       %" PRIu64, result->totals.collisions);
	if (work->plastic_ends > 0)
		rb_print(file, "; %" PRIu64 " %s of impacts ended without restitution",
		         work->plastic_ends,
		         rb_text_plural(work->plastic_ends, "cluster", "clusters"));
	if (work->crowded_impacts > 0)
		rb_print(file,
		         "; %" PRIu64 " in groups of more than %d contacts at once, of %.3g J",
		         work->crowded_impacts, RB_IMPACT_CONTACTS, work->crowded_energy_j);
	if (work->rows > 0)
		rb_print(file,
		         "\n  contacts      %" PRIu64
		         " points stepped, each swept %.3g times; %" PRIu64
		         " factorizations, residual %.3g m at most, positions closed %" PRIu64
		         " times",
		         work->rows, (double)work->row_sweeps / (double)work->rows, work->factors,
		         work->residual_m, work->closings);
	if (work->slip_m > 0)
		rb_print(file, ", friction held with %.3g m of slip left at most", work->slip_m);
	putc('\n', file);
}

/* Prints how many frames there are, and how many of them are recorded. */
static void print_frames(FILE *file, const struct rb_run_result *result)
{
	rb_print(file, "  frames        %" PRIu64 " of %" PRIu64, result->frames,
	         result->frame_count);
	if (result->recorder_failed && result->recorded_known)
		rb_print(file, " simulated, %" PRIu64 " of them in the recording",
		         result->recorded_frames);
	else if (result->recorder_failed)
		rb_print(file, " simulated; the recording may hold fewer, see rbsim info");
	putc('\n', file);
}

/* Prints energy and momentum, and by how much they changed at most. */
static void print_changes(FILE *file, const struct rb_run_result *result)
{
	const double first = result->first.kinetic_energy + result->first.potential_energy;
	const double last = result->last.kinetic_energy + result->last.potential_energy;
	char text[3][64];

	rb_print(file, "  energy        %s at the start, %s at the end, %s\n",
	         rb_text_measure("", first, 6, "J", text[0]),
	         rb_text_measure("", last, 6, "J", text[1]),
	         isfinite(result->energy_drift_j)
	                 ? rb_text_measure("changed by up to ", result->energy_drift_j, 3, "J",
	                                   text[2])
	                 : "change not finite");
	rb_print(file, "  momentum      %s, angular momentum %s\n",
	         rb_text_measure("changed by up to ", result->momentum_drift, 3, "kg m/s", text[0]),
	         rb_text_measure("by up to ", result->angular_momentum_drift, 3, "kg m^2/s",
	                         text[1]));
	if (result->first.mass > 0)
		rb_print(file, "  centre of mass %s\n",
		         rb_text_measure("off its straight way by up to ", result->center_drift_m,
		                         3, "m", text[0]));
}

/* Prints which method was used for how much of the run. */
static void print_method(FILE *file, const struct rb_run_result *result,
                         const struct rb_loaded *loaded, const struct rb_run_info *info)
{
	const double stepped = result->totals.stepped;

	rb_print(file, "  method        %s", info->method);
	const bool changes = rb_model_method_row(loaded->model)->changes;
	if (changes && stepped > 0)
		rb_print(file, ": located %.6g s, stepped %.6g s (too dense to locate)",
		         fmax(0, result->time_s - stepped), stepped);
	else if (changes)
		fputs(": located", file);
	rb_print(file, ", rollback %s, time step %g s\n", info->rollback,
	         loaded->model->time_step_s);
}

void rb_summary_print(FILE *file, const struct rb_run_result *result,
                      const struct rb_loaded *loaded, const struct rb_run_info *info, bool color)
{
	const char *title = loaded->scene.world.title;
	char size[32], tolerance[96];

	rb_print(file, "%s%s%s\n", loaded->scene.file, title && *title ? ": " : "",
	         title ? title : "");
	print_frames(file, result);
	rb_print(file, "  time          %.6g s simulated in %.3g s: %.3g x real time, %d %s\n",
	         result->time_s, result->wall_s, result->time_s / result->wall_s, info->threads,
	         rb_text_plural((uint64_t)info->threads, "thread", "threads"));
	print_method(file, result, loaded, info);
	print_work(file, result);
	rb_print(file, "  overlap       %.3g m at most (tolerance %s%s)\n",
	         result->max_penetration_m,
	         rb_text_tolerance(loaded->model->tolerance_m, loaded->model->stepped_tolerance_m,
	                           3, tolerance),
	         loaded->model->rollback == RB_ROLLBACK_NONE ? ", not promised" : "");
	if (result->gravitation_error > 0)
		rb_print(file,
		         "  gravitation   by a tree: accelerations wrong by %.2g of themselves at "
		         "most, energy by %.2g\n",
		         result->gravitation_error, result->gravitation_energy_error);
	print_changes(file, result);
	rb_balance_print(file, &result->balance, &result->last.ledger);
	rb_measured_print(file, &result->measured);
	if (result->expect_count > 0) {
		rb_print(file, "  expectations  %d of %d hold\n",
		         result->expect_count - result->expect_failures, result->expect_count);
		rb_summary_print_expects(file, result, false, color);
	} else if (loaded->scene.expect_count > 0) {
		rb_print(file, "  expectations  %d, not evaluated: the run did not finish\n",
		         loaded->scene.expect_count);
	}
	rb_print(file, "  memory        %s at most\n", rb_text_bytes(result->memory_bytes, size));
	if (loaded->output && result->recording_bytes > 0)
		rb_print(file, "  recording     %s, %s\n", loaded->output,
		         rb_text_bytes(result->recording_bytes, size));
	else if (loaded->output)
		rb_print(file, "  recording     none\n");
}

/* The recording's own words. */
static const char *status_word(enum rb_status status)
{
	switch (status) {
	case RB_OK:
		return "complete";
	case RB_ERR_INTERRUPT:
	case RB_ERR_TERMINATE:
		return "interrupted";
	default:
		return "failed";
	}
}

static void json_vector(struct rb_json *json, const char *name, rb_vec3 v)
{
	rb_json_vector(json, name, (const double[]){v.x, v.y, v.z}, 3);
}

static void json_numbers(struct rb_json *json, const char *name,
                         const struct rb_frame_numbers *numbers)
{
	rb_json_open(json, name, '{');
	rb_json_number(json, "kinetic_energy", numbers->kinetic_energy);
	rb_json_number(json, "potential_energy", numbers->potential_energy);
	json_vector(json, "momentum", numbers->momentum);
	json_vector(json, "angular_momentum", numbers->angular_momentum);
	rb_json_close(json, '}');
}

static void json_expects(struct rb_json *json, const struct rb_run_result *result)
{
	rb_json_open(json, "expectations", '[');
	for (int i = 0; i < result->expect_count; i++) {
		const struct rb_expect_result *const e = &result->expects[i];
		rb_json_open(json, NULL, '{');
		rb_json_text(json, "text", e->text);
		rb_json_count(json, "line", (uint64_t)e->line);
		rb_json_bool(json, "always", e->always);
		rb_json_bool(json, "ok", e->ok);
		rb_json_number(json, "measured", e->has_numbers ? e->measured : (double)NAN);
		rb_json_number(json, "bound", e->has_numbers ? e->bound : (double)NAN);
		rb_json_text(json, "message", e->message);
		rb_json_close(json, '}');
	}
	rb_json_close(json, ']');
}

/* What checkpoints have cost the run. */
static void json_checkpoints(struct rb_json *json, const struct rb_checkpoints_tally *tally)
{
	rb_json_open(json, "checkpoints", '{');
	rb_json_count(json, "written", tally->written);
	rb_json_count(json, "checkpoint_bytes", tally->bytes);
	rb_json_number(json, "stall_time", (double)tally->stall_ns * 1e-9);
	rb_json_number(json, "stall_processor_time", (double)tally->stall_cpu_ns * 1e-9);
	rb_json_number(json, "longest_stall", (double)tally->stall_most_ns * 1e-9);
	rb_json_close(json, '}');
}

void rb_summary_print_json(FILE *file, const struct rb_run_result *result,
                           const struct rb_loaded *loaded, const struct rb_run_info *info,
                           const struct rb_films *films, int exit_code)
{
	struct rb_json json = {.file = file};
	char hash[17];

	snprintf(hash, sizeof hash, "%016" PRIx64, result->state_hash);
	rb_json_open(&json, NULL, '{');
	rb_json_text(&json, "scene", loaded->scene.file);
	rb_json_text(&json, "title", loaded->scene.world.title);
	rb_json_text(&json, "status", status_word(result->status));
	rb_json_text(&json, "reason", result->status ? result->error.text : "");
	rb_json_count(&json, "exit_status", (uint64_t)exit_code);
	rb_json_text(&json, "error",
	             result->status          ? result->error.text
	             : result->film_status   ? result->film_error.text
	             : result->expect_status ? result->expect_error.text
	                                     : NULL);
	rb_json_text(&json, "recording", loaded->output);
	rb_json_count(&json, "recording_bytes", result->recording_bytes);
	if (result->recorder_failed)
		rb_json_number(&json, "recorded_frames",
		               result->recorded_known ? (double)result->recorded_frames
		                                      : (double)NAN);
	rb_json_count(&json, "frames", result->frames);
	rb_json_count(&json, "frame_count", result->frame_count);
	rb_json_count(&json, "memory_bytes", result->memory_bytes);
	rb_json_number(&json, "time", result->time_s);
	rb_json_number(&json, "duration", loaded->model->duration_s);
	rb_json_number(&json, "wall_time", result->wall_s);
	rb_json_number(&json, "real_time_factor", result->time_s / result->wall_s);
	rb_json_count(&json, "threads", (uint64_t)info->threads);
	rb_json_count(&json, "seed", loaded->scene.world.seed);
	rb_json_text(&json, "method", info->method);
	rb_json_number(&json, "stepped", result->totals.stepped);
	rb_json_text(&json, "rollback", info->rollback);
	rb_json_number(&json, "time_step", loaded->model->time_step_s);
	rb_json_number(&json, "tolerance", loaded->model->tolerance_m);
	rb_json_number(&json, "stepped_tolerance", loaded->model->stepped_tolerance_m);
	rb_json_count(&json, "bodies", (uint64_t)loaded->model->body_count);
	rb_json_count(&json, "statics", (uint64_t)loaded->model->static_count);
	rb_json_count(&json, "body_steps", result->work.body_steps);
	rb_json_count(&json, "discarded_body_steps", result->work.discarded_body_steps);
	rb_json_number(&json, "body_steps_per_second",
	               per_second(result->work.body_steps, result->wall_s));
	rb_json_count(&json, "pair_tests", result->work.pair_tests);
	rb_json_count(&json, "plastic_ends", result->work.plastic_ends);
	rb_json_count(&json, "crowded_impacts", result->work.crowded_impacts);
	rb_json_number(&json, "crowded_energy", result->work.crowded_energy_j);
	rb_json_count(&json, "contact_rows", result->work.rows);
	rb_json_count(&json, "row_sweeps", result->work.row_sweeps);
	rb_json_count(&json, "factorizations", result->work.factors);
	rb_json_count(&json, "closings", result->work.closings);
	rb_json_number(&json, "residual", result->work.residual_m);
	rb_json_number(&json, "held_slip", result->work.slip_m);
	rb_json_count(&json, "substeps", result->totals.substeps);
	rb_json_count(&json, "rollbacks", result->totals.rollbacks);
	rb_json_count(&json, "collisions", result->totals.collisions);
	rb_json_number(&json, "smallest_step", result->totals.smallest_step);
	rb_json_number(&json, "max_penetration", result->max_penetration_m);
	rb_json_number(&json, "gravitation_error", result->gravitation_error);
	rb_json_number(&json, "gravitation_energy_error", result->gravitation_energy_error);
	rb_json_number(&json, "kinetic_energy_max", result->kinetic_max_j);
	rb_json_number(&json, "energy_drift", result->energy_drift_j);
	rb_json_number(&json, "momentum_drift", result->momentum_drift);
	rb_json_number(&json, "angular_momentum_drift", result->angular_momentum_drift);
	rb_json_number(&json, "center_of_mass_drift",
	               result->first.mass > 0 ? result->center_drift_m : (double)NAN);
	rb_balance_print_json(&json, &result->balance, &result->last.ledger);
	json_numbers(&json, "first", &result->first);
	json_numbers(&json, "last", &result->last);
	rb_json_text(&json, "state_hash", hash);
	json_expects(&json, result);
	rb_measured_print_json(&json, &result->measured);
	rb_films_print_json(&json, films);
	json_checkpoints(&json, &result->checkpoints);
	rb_json_close(&json, '}');
	putc('\n', file);
}
