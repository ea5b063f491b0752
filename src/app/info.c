/* SPDX-License-Identifier: MIT */
/*
 * How the run went is computed from the observables, which are one dataset each; frames are read
 * only for their times. A quantity that the recording lacks is NAN, and its line is left out.
 */
#include "app/info.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "app/common.h"
#include "app/json.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/visible.h"
#include "math/vec3.h"
#include "sink/module.h"

/* How the run went, from the observables; NAN where they are not in the file. */
struct course {
	double first_s, last_s;
	bool has_energy, has_momentum;
	double energy_first, energy_last, kinetic_max;   /* J */
	double momentum_change, angular_momentum_change; /* largest |x(t) - x(0)| */
	double max_penetration, smallest_step;
	double collisions, rollbacks, substeps, stepped;
};

struct observer {
	const struct rb_hdf5_module *module;
	struct rb_reader *reader;
	uint64_t frame_count;
	double *values; /* room for 3 per frame */
};

/* Reads an observable into observer->values; false where the recording has no such. */
static bool observe(const struct observer *observer, const char *name, int width)
{
	RB_ASSERT(width >= 1 && width <= 3);
	return observer->module->reader_observable(observer->reader, name, width, observer->values,
	                                           NULL) == RB_OK;
}

/* The sum over all frames; NAN: not recorded. */
static double sum_of(const struct observer *observer, const char *name)
{
	double sum = 0;

	if (!observe(observer, name, 1))
		return (double)NAN;
	for (uint64_t k = 0; k < observer->frame_count; k++)
		sum += observer->values[k];
	return sum;
}

/* The largest |x(t) - x(0)| of a vector; NAN: not recorded. */
static double largest_change(const struct observer *observer, const char *name)
{
	double largest = 0;

	if (!observe(observer, name, 3))
		return (double)NAN;
	for (uint64_t k = 0; k < observer->frame_count; k++) {
		const double change = rb_change_of(rb_vec3_from(observer->values + 3 * k),
		                                   rb_vec3_from(observer->values));
		largest = rb_larger(largest, change);
	}
	return largest;
}

/* Energies at both ends, and the largest kinetic one. */
static void observe_energy(const struct observer *observer, struct course *course)
{
	const uint64_t last = observer->frame_count - 1;

	RB_ASSERT(observer->frame_count > 0);
	course->energy_first = course->energy_last = course->kinetic_max = (double)NAN;
	if (!observe(observer, "kinetic_energy", 1))
		return;
	const double kinetic_first = observer->values[0], kinetic_last = observer->values[last];
	for (uint64_t k = 0; k <= last; k++)
		course->kinetic_max = k == 0 ? observer->values[0]
		                             : rb_larger(course->kinetic_max, observer->values[k]);
	if (!observe(observer, "potential_energy", 1))
		return;
	course->has_energy = true;
	course->energy_first = kinetic_first + observer->values[0];
	course->energy_last = kinetic_last + observer->values[last];
}

/* Reads all that is shown of how the run went. */
static enum rb_status observe_all(const struct rb_hdf5_module *module, struct rb_reader *reader,
                                  struct course *course, struct rb_error *err)
{
	const struct rb_reading *const reading = module->reader_reading(reader);
	struct observer observer = {module, reader, reading->frame_count, NULL};
	struct rb_frame frame;
	enum rb_status status;

	*course = (struct course){0};
	if (reading->frame_count == 0)
		return RB_OK;
	status = module->reader_frame(reader, 0, &frame, err);
	if (status)
		return status;
	course->first_s = frame.time_s;
	status = module->reader_frame(reader, reading->frame_count - 1, &frame, err);
	if (status)
		return status;
	course->last_s = frame.time_s;

	observer.values = rb_memory_take(reading->frame_count, 3 * sizeof(double));
	if (!observer.values)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot read %" PRIu64 " frames: out of memory",
		               reading->frame_count);
	observe_energy(&observer, course);
	course->has_momentum = observe(&observer, "momentum", 3);
	course->momentum_change = largest_change(&observer, "momentum");
	course->angular_momentum_change = largest_change(&observer, "angular_momentum");
	course->max_penetration = course->smallest_step = (double)NAN;
	if (observe(&observer, "max_penetration", 1))
		for (uint64_t k = 0; k < observer.frame_count; k++)
			course->max_penetration = fmax(course->max_penetration, observer.values[k]);
	if (observe(&observer, "smallest_step", 1)) {
		double smallest = HUGE_VAL;

		for (uint64_t k = 0; k < observer.frame_count; k++)
			if (observer.values[k] > 0) /* frame 0 had no step */
				smallest = fmin(smallest, observer.values[k]);
		course->smallest_step = isfinite(smallest) ? smallest : 0; /* as a run says */
	}
	course->collisions = sum_of(&observer, "collisions");
	course->rollbacks = sum_of(&observer, "rollbacks");
	course->substeps = sum_of(&observer, "substeps");
	course->stepped = sum_of(&observer, "stepped");
	rb_memory_free(observer.values);
	return RB_OK;
}

static const struct {
	unsigned bit;
	const char *name;
} field_names[] = {
	{RB_FIELD_POSITION, "position"},
	{RB_FIELD_ORIENTATION, "orientation"},
	{RB_FIELD_VELOCITY, "velocity"},
	{RB_FIELD_ANGULAR_VELOCITY, "angular_velocity"},
	{RB_FIELD_CONTACTS, "contacts"},
	{RB_FIELD_EVENTS, "events"},
	{RB_FIELD_ACCELERATION, "acceleration"},
	{RB_FIELD_ANGULAR_ACCELERATION, "angular_acceleration"},
	{RB_FIELD_FORCE, "force"},
	{RB_FIELD_TORQUE, "torque"},
	{RB_FIELD_JOINTS, "joints"},
};
enum { FIELD_COUNT = sizeof field_names / sizeof *field_names };

/* The scene's results by name, and the names and units of its probes. */
/* A recording is written every second, but for frames that take longer: what is told beyond. */
enum { SILENCE_TOLD_S = 10 };

/*
 * Seconds since a recording of a run that has not ended was last written: nothing in it tells
 * whether its process is still there. -1: it has ended.
 */
static long silence_s(const char *path, const struct rb_reading *reading)
{
	struct stat file;

	if (strcmp(reading->status, "running") != 0 || stat(path, &file) != 0)
		return -1;
	const double s = difftime(time(NULL), file.st_mtime);
	return s > 0 ? (long)s : 0;
}

static void json_measures(struct rb_json *json, const struct rb_reading *reading)
{
	rb_json_open(json, "results", '{');
	for (int i = 0; i < reading->result_count; i++) {
		rb_json_open(json, reading->result_names[i], '{');
		rb_json_number(json, "value", reading->results[i]);
		rb_json_text(json, "unit", reading->result_units[i]);
		rb_json_close(json, '}');
	}
	rb_json_close(json, '}');
	rb_json_open(json, "probes", '{');
	for (int i = 0; i < reading->probe_count; i++) {
		rb_json_open(json, reading->probe_names[i], '{');
		rb_json_text(json, "unit", reading->probe_units[i]);
		rb_json_close(json, '}');
	}
	rb_json_close(json, '}');
}

/* The same in lines. */
static void print_measures(const struct rb_reading *reading)
{
	for (int i = 0; i < reading->result_count; i++) {
		const char *const units = reading->result_units[i];

		rb_print(stdout, "  %-11s %s: ", i == 0 ? "results" : "", reading->result_names[i]);
		if (isnan(reading->results[i]))
			rb_print(stdout, "no value\n");
		else
			rb_print(stdout, "%.9g%s%s\n", reading->results[i], *units ? " " : "",
			         units);
	}
	for (int i = 0; i < reading->probe_count; i++)
		rb_print(stdout, "  %-11s %s%s%s%s\n", i == 0 ? "probes" : "",
		         reading->probe_names[i], *reading->probe_units[i] ? " [" : "",
		         reading->probe_units[i], *reading->probe_units[i] ? "]" : "");
}

static void print_json(const char *path, const struct rb_reading *reading,
                       const struct course *course)
{
	struct rb_json json = {.file = stdout};

	rb_json_open(&json, NULL, '{');
	rb_json_text(&json, "file", path);
	rb_json_text(&json, "title", reading->title);
	rb_json_text(&json, "status", reading->status);
	rb_json_text(&json, "reason", reading->reason);
	if (silence_s(path, reading) >= 0)
		rb_json_count(&json, "seconds_since_written", (uint64_t)silence_s(path, reading));
	rb_json_text(&json, "state_hash", reading->state_hash);
	rb_json_count(&json, "frames", reading->frame_count);
	rb_json_count(&json, "bodies", (uint64_t)reading->body_count);
	rb_json_count(&json, "statics", (uint64_t)reading->static_count);
	rb_json_open(&json, "shapes", '{');
	for (int k = 0; k < RB_SHAPE_KIND_COUNT; k++)
		rb_json_count(&json, rb_shape_name((enum rb_shape_kind)k),
		              (uint64_t)reading->shape_counts[k]);
	rb_json_close(&json, '}');
	rb_json_count(&json, "driven_count", (uint64_t)reading->driven_count);
	rb_json_forces(&json, reading->element_counts, reading->field_count);
	rb_json_count(&json, "joint_count", (uint64_t)reading->joint_count);
	rb_json_count(&json, "events", reading->event_count);
	rb_json_open(&json, "fields", '[');
	for (int i = 0; i < FIELD_COUNT; i++)
		if (reading->fields & field_names[i].bit)
			rb_json_text(&json, NULL, field_names[i].name);
	rb_json_close(&json, ']');
	rb_json_number(&json, "first_time", course->first_s);
	rb_json_number(&json, "last_time", course->last_s);
	rb_json_number(&json, "duration", reading->duration_s);
	rb_json_number(&json, "frame_rate", reading->frame_rate);
	rb_json_number(&json, "time_step", reading->time_step_s);
	rb_json_number(&json, "tolerance", reading->tolerance_m);
	rb_json_number(&json, "stepped_tolerance", reading->stepped_tolerance_m);
	rb_json_text(&json, "method", reading->method);
	rb_json_text(&json, "rollback", reading->rollback);
	rb_json_count(&json, "seed", reading->seed);
	rb_json_count(&json, "threads", (uint64_t)reading->threads);
	rb_json_text(&json, "started", reading->started);
	rb_json_text(&json, "ended", reading->ended);
	rb_json_text(&json, "version", reading->version);
	rb_json_text(&json, "build", reading->build);
	rb_json_text(&json, "command", reading->command);
	rb_json_text(&json, "host", reading->host);
	rb_json_open(&json, "parameters", '{');
	for (int i = 0; i < reading->param_count; i++)
		rb_json_text(&json, reading->param_names[i], reading->param_values[i]);
	rb_json_close(&json, '}');
	rb_json_open(&json, "files", '[');
	for (int i = 0; i < reading->file_count; i++)
		rb_json_text(&json, NULL, reading->file_names[i]);
	rb_json_close(&json, ']');
	rb_json_open(&json, "file_sizes", '[');
	for (int i = 0; i < reading->file_count; i++)
		rb_json_count(&json, NULL, reading->file_sizes[i]);
	rb_json_close(&json, ']');
	json_measures(&json, reading);
	rb_json_number(&json, "energy_first", course->energy_first);
	rb_json_number(&json, "energy_last", course->energy_last);
	rb_json_number(&json, "kinetic_energy_max", course->kinetic_max);
	rb_json_number(&json, "momentum_change", course->momentum_change);
	rb_json_number(&json, "angular_momentum_change", course->angular_momentum_change);
	rb_json_number(&json, "max_penetration", course->max_penetration);
	rb_json_number(&json, "smallest_step", course->smallest_step);
	rb_json_number(&json, "collisions", course->collisions);
	rb_json_number(&json, "rollbacks", course->rollbacks);
	rb_json_number(&json, "substeps", course->substeps);
	rb_json_number(&json, "stepped", course->stepped);
	rb_json_count(&json, "exit_status", 0);
	rb_json_close(&json, '}');
	putchar('\n');
}

static void print_changes(const struct course *course)
{
	const double change = course->energy_last - course->energy_first;
	char first[64], last[64], largest[64];

	if (course->has_energy) {
		rb_print(stdout, "  energy      %s at the start, %s at the end",
		         rb_text_measure("", course->energy_first, 6, "J", first),
		         rb_text_measure("", course->energy_last, 6, "J", last));
		if (isfinite(change))
			rb_print(stdout, ": %+.3g J", change);
		rb_print(stdout, ", largest kinetic %s\n",
		         rb_text_measure("", course->kinetic_max, 6, "J", largest));
	}
	if (course->has_momentum)
		rb_print(stdout, "  momentum    %s, angular momentum %s\n",
		         rb_text_measure("changed by up to ", course->momentum_change, 3, "kg m/s",
		                         first),
		         rb_text_measure("by up to ", course->angular_momentum_change, 3,
		                         "kg m^2/s", last));
}

/* As rb_text_plural, of a count in a recording, which may be any number. */
static const char *count_name(double count, const char *one, const char *many)
{
	return count == 1 ? one : many;
}

static void print_text(const char *path, const struct rb_reading *reading,
                       const struct course *course)
{
	char forces[RB_FORCES_TEXT_SIZE], shapes[160], size[32];
	char tolerance[96];

	rb_print(stdout, "%s: %" PRIu64 " %s of %d moving %s", path, reading->frame_count,
	         rb_text_plural(reading->frame_count, "frame", "frames"), reading->body_count,
	         rb_text_plural((uint64_t)reading->body_count, "body", "bodies"));
	if (reading->static_count > 0)
		rb_print(
			stdout, " (and %d that %s)", reading->static_count,
			rb_text_plural((uint64_t)reading->static_count, "is static", "are static"));
	rb_print(stdout, ", %g to %g s of %g s\n", course->first_s, course->last_s,
	         reading->duration_s);
	if (*reading->title)
		rb_print(stdout, "  title       %s\n", reading->title);
	if (*rb_text_shapes(reading->shape_counts, shapes))
		rb_print(stdout, "  shapes      %s\n", shapes);
	if (reading->driven_count > 0)
		rb_print(stdout, "  driven      %d of the moving bodies\n", reading->driven_count);
	rb_text_forces(reading->element_counts, reading->field_count, forces);
	if (*forces)
		rb_print(stdout, "  forces      %s\n", forces);
	if (reading->joint_count > 0) {
		char joints[RB_JOINTS_TEXT_SIZE];
		int kinds[RB_JOINT_KIND_COUNT] = {0};

		for (int k = 0; k < reading->joint_count; k++)
			kinds[reading->joint_kind[k]]++;
		rb_print(stdout, "  joints      %s\n", rb_text_joints(kinds, joints));
	}
	const long silence = silence_s(path, reading);
	rb_print(stdout, "  status      %s%s%s", reading->status, *reading->reason ? ": " : "",
	         reading->reason);
	if (silence >= SILENCE_TOLD_S)
		rb_print(stdout, ", unless its process was killed: last written %ld s ago",
		         silence);
	rb_print(stdout, "\n");
	rb_print(stdout, "  columns    ");
	for (int i = 0; i < FIELD_COUNT; i++)
		if (reading->fields & field_names[i].bit)
			rb_print(stdout, " %s", field_names[i].name);
	rb_print(stdout, "\n  method      %s, rollback %s, time step %g s, tolerance %s\n",
	         reading->method, reading->rollback, reading->time_step_s,
	         rb_text_tolerance(reading->tolerance_m, reading->stepped_tolerance_m, 6,
	                           tolerance));
	rb_print(stdout,
	         "  run         %g frames per second, seed %" PRIu64
	         ", %d %s, rbsim %s on %s, %s to %s\n",
	         reading->frame_rate, reading->seed, reading->threads,
	         rb_text_plural((uint64_t)reading->threads, "thread", "threads"), reading->version,
	         reading->host, reading->started, *reading->ended ? reading->ended : "?");
	rb_print(stdout, "  command     %s\n", reading->command);
	for (int i = 0; i < reading->param_count; i++)
		rb_print(stdout, "  %-11s %s = %s\n", i == 0 ? "parameters" : "",
		         reading->param_names[i], reading->param_values[i]);
	for (int i = 0; i < reading->file_count; i++)
		rb_print(stdout, "  %-11s %s, %s%s\n", i == 0 ? "files" : "",
		         reading->file_names[i], rb_text_bytes(reading->file_sizes[i], size),
		         i == 0 ? " (see --scene)" : "");
	print_measures(reading);
	if (reading->frame_count == 0)
		return;
	print_changes(course);
	if (isfinite(course->max_penetration))
		rb_print(stdout, "  overlap     %.3g m at most\n", course->max_penetration);
	if (isfinite(course->collisions))
		rb_print(stdout, "  work        %.0f %s, %.0f %s, %.0f %s", course->collisions,
		         count_name(course->collisions, "impact", "impacts"), course->rollbacks,
		         count_name(course->rollbacks, "rollback", "rollbacks"), course->substeps,
		         count_name(course->substeps, "substep", "substeps"));
	if (course->smallest_step > 0)
		rb_print(stdout, ", smallest step %.3g s", course->smallest_step);
	if (course->stepped > 0)
		rb_print(stdout, "; %.6g s of it stepped", course->stepped);
	rb_print(stdout, "\n  state       %s\n",
	         *reading->state_hash ? reading->state_hash : "not told");
}

/* Prints the scene's text; to the byte into files and pipes, where it is run again. */
static void print_scene(const struct rb_options *options, const char *text, size_t size)
{
	struct rb_json json = {.file = stdout};

	if (options->json) {
		rb_json_open(&json, NULL, '{');
		rb_json_text(&json, "file", options->operand[0]);
		rb_json_text(&json, "scene", text);
		rb_json_count(&json, "exit_status", 0);
		rb_json_close(&json, '}');
		putchar('\n');
	} else if (isatty(STDOUT_FILENO))
		rb_print_lines(stdout, text, size);
	else
		(void)!fwrite(text, 1, size, stdout);
}

/* Opens the recording and prints what is asked for. */
static enum rb_status look(const struct rb_options *options, struct rb_error *err)
{
	const struct rb_hdf5_module *module;
	struct rb_reader *reader;
	struct course course;
	enum rb_status status = rb_module_hdf5(&module, err);

	if (status)
		return status;
	status = module->reader_open(&reader, options->operand[0], err);
	if (status)
		return status;
	const struct rb_reading *reading = module->reader_reading(reader);
	if (options->scene_text) {
		if (reading->file_count > 0)
			print_scene(options, reading->file_texts[0], reading->file_sizes[0]);
		else
			status = RB_FAIL(err, RB_ERR_INPUT, "'%s' holds no scene",
			                 options->operand[0]);
	} else {
		status = observe_all(module, reader, &course, err);
		if (!status && options->json)
			print_json(options->operand[0], reading, &course);
		else if (!status)
			print_text(options->operand[0], reading, &course);
	}
	module->reader_close(reader);
	return status;
}

int rb_info_main(const struct rb_options *options)
{
	struct rb_error err;

	return rb_app_finish(options, look(options, &err) ? rb_app_refuse(options, &err) : 0);
}
