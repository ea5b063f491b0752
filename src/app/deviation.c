/* SPDX-License-Identifier: MIT */
/*
 * A path is kept in shared anonymous memory, because runs are made in child processes: the child
 * fills the path, the parent and later children read it. Errors are measured frame by frame in the
 * run itself, against a path or against the function that the scene states, so nothing but maxima
 * and sums is kept.
 *
 * Angles are 2 atan2(|v|, |w|): 2 acos(w) loses half of the digits near 0.
 */
#include "app/deviation.h"

#include <math.h>
#include <sys/mman.h>

#include "app/common.h"
#include "base/error.h"
#include "base/memory.h"
#include "math/quat.h"
#include "script/reference.h"

/* 128 MiB for a path; longer runs keep every other frame, or fewer. */
static const size_t path_bytes_max = (size_t)128 << 20;

const struct rb_quantity_row rb_quantities[RB_QUANTITY_COUNT] = {
	[RB_QUANTITY_POSITION] = {"position", "m", "position"},
	[RB_QUANTITY_VELOCITY] = {"velocity", "m/s", "velocity"},
	[RB_QUANTITY_ORIENTATION] = {"orientation", "rad", "orientation"},
	[RB_QUANTITY_ANGULAR_VELOCITY] = {"angular_velocity", "rad/s", "angular velocity"},
	[RB_QUANTITY_ENERGY] = {"energy", "", "energy, relative to the largest kinetic energy"},
	[RB_QUANTITY_PENETRATION] = {"penetration", "m", "overlap"},
};

/*
 * Doubles of a sample: the energy; for each body position and velocity, with rotation also
 * quaternion and angular velocity.
 */
enum { ENERGY_DOUBLES = 1, FLAT_DOUBLES = 6, TURNING_DOUBLES = 13 };

/* ---- paths ---- */

/* Doubles that a body takes. */
static size_t doubles_of(unsigned fields)
{
	return fields & RB_FIELD_ORIENTATION ? TURNING_DOUBLES : FLAT_DOUBLES;
}

enum rb_status rb_path_create(struct rb_path *path, const struct rb_model *model,
                              struct rb_error *err)
{
	const bool turns = model->features & RB_FEATURE_ROTATION;
	const uint64_t frames = model->frame_count;

	*path = (struct rb_path){
		.body_count = model->body_count,
		.fields = RB_FIELD_POSITION | RB_FIELD_VELOCITY |
	                  (turns ? RB_FIELD_ORIENTATION | RB_FIELD_ANGULAR_VELOCITY : 0u),
	};
	path->sample_doubles = ENERGY_DOUBLES + (size_t)path->body_count * doubles_of(path->fields);
	const uint64_t most = path_bytes_max / (path->sample_doubles * sizeof(double)) + 2;
	path->stride = (frames + most - 1) / most;
	path->sample_count = (frames - 1) / path->stride + 1;
	path->bytes = path->sample_count * path->sample_doubles * sizeof(double);
	void *const room = mmap(NULL, path->bytes, PROT_READ | PROT_WRITE,
	                        MAP_SHARED | MAP_ANONYMOUS, -1, 0);
	if (room == MAP_FAILED)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot keep a path of %zu bytes: out of memory",
		               path->bytes);
	path->samples = room;
	return RB_OK;
}

void rb_path_destroy(struct rb_path *path)
{
	if (path->samples)
		munmap(path->samples, path->bytes);
	*path = (struct rb_path){0};
}

/* Where the sample of a frame is. */
static double *sample(const struct rb_path *path, uint64_t frame)
{
	RB_ASSERT(path->stride > 0 && frame / path->stride < path->sample_count);
	return path->samples + frame / path->stride * path->sample_doubles;
}

/* Keeps a frame. */
static void keep(struct rb_path *path, const struct rb_frame *frame)
{
	double *to = sample(path, frame->index);

	RB_ASSERT(frame->body_count == path->body_count);
	*to++ = frame->numbers.kinetic_energy + frame->numbers.potential_energy;
	for (int i = 0; i < path->body_count; i++) {
		rb_vec3_to(to, rb_vec3_from(frame->position + 3 * i));
		rb_vec3_to(to + 3, rb_vec3_from(frame->velocity + 3 * i));
		if (path->fields & RB_FIELD_ORIENTATION) {
			rb_quat_to(to + 6, rb_quat_from(frame->orientation + 4 * i));
			rb_vec3_to(to + 10, rb_vec3_from(frame->angular_velocity + 3 * i));
		}
		to += doubles_of(path->fields);
	}
}

/* The pose of a body in a kept frame. */
static struct rb_reference_pose pose_of_path(const struct rb_path *path, uint64_t frame, int index)
{
	const double *from = sample(path, frame) + ENERGY_DOUBLES +
	                     (size_t)index * doubles_of(path->fields);
	struct rb_reference_pose pose = {
		.known = path->fields,
		.position = rb_vec3_from(from),
		.velocity = rb_vec3_from(from + 3),
	};

	RB_ASSERT(index >= 0 && index < path->body_count);
	if (path->fields & RB_FIELD_ORIENTATION) {
		pose.orientation = rb_quat_from(from + 6);
		pose.angular_velocity = rb_vec3_from(from + 10);
	}
	return pose;
}

/* ---- comparing ---- */

/* One frame, quantity by quantity: the largest deviation of any body. */
struct moment {
	double largest[RB_QUANTITY_COUNT];
	bool known[RB_QUANTITY_COUNT];
};

/*
 * Takes one distance of one quantity; `magnitude`: how large the quantity itself is, which bounds
 * what rounding can do.
 */
static void compare(struct rb_watch *watch, struct moment *moment, enum rb_quantity quantity,
                    double distance, double magnitude)
{
	struct rb_deviation *const of = &watch->of[quantity];

	of->count++;
	of->max = rb_larger(of->max, distance);
	of->rms += distance * distance; /* the sum, until rb_watch_end */
	of->largest = fmax(of->largest, magnitude);
	moment->largest[quantity] = rb_larger(moment->largest[quantity], distance);
	moment->known[quantity] = true;
}

/* The same for a vector. */
static void compare_vectors(struct rb_watch *watch, struct moment *moment,
                            enum rb_quantity quantity, rb_vec3 is, rb_vec3 should)
{
	compare(watch, moment, quantity, rb_change_of(is, should), rb_vec3_length(should));
}

/* The angle of the turn from one orientation to the other, rad. */
static double angle_between(rb_quat a, rb_quat b)
{
	const rb_quat turn = rb_quat_multiply(a, (rb_quat){b.w, -b.x, -b.y, -b.z});
	const rb_vec3 axis = {turn.x, turn.y, turn.z};

	return 2 * atan2(rb_vec3_length(axis), fabs(turn.w));
}

/* Twice the energy of turning, J. */
static double spin_energy(const rb_mat3 *inertia, rb_quat orientation, rb_vec3 spin)
{
	const rb_vec3 local = rb_quat_rotate_back(orientation, spin);

	return rb_vec3_dot(local, rb_mat3_apply(inertia, local));
}

/*
 * Adds a body's kinetic energy and that of gravity, less what the reference has of them; false
 * where it does not say enough. Written as products of differences and sums, so that equal states
 * give exactly 0.
 */
static bool energy_difference(const struct rb_watch *watch, const struct rb_frame *frame, int i,
                              const struct rb_reference_pose *pose, double *difference)
{
	const struct rb_model *const model = watch->model;
	const bool turns = frame->angular_velocity != NULL;
	const unsigned needed = RB_FIELD_POSITION | RB_FIELD_VELOCITY |
	                        (turns ? RB_FIELD_ANGULAR_VELOCITY : 0u);

	if (!isfinite(model->mass[i]))
		return true; /* driven: its energy is not counted */
	if ((pose->known & needed) != needed || model->center_of_mass)
		return false;
	const rb_vec3 step = rb_vec3_sub(rb_vec3_from(frame->position + 3 * i), pose->position);
	const rb_vec3 v = rb_vec3_from(frame->velocity + 3 * i);
	const rb_vec3 change = rb_vec3_sub(v, pose->velocity);
	const rb_vec3 sum = rb_vec3_add(v, pose->velocity);
	*difference += model->mass[i] * (0.5 * rb_vec3_dot(change, sum) -
	                                 rb_vec3_dot(model->scene->world.gravity, step)) -
	               rb_vec3_dot(model->scene->world.gravity_force, step);
	if (turns) {
		const rb_quat is = rb_quat_from(frame->orientation + 4 * i);
		const rb_quat should = pose->known & RB_FIELD_ORIENTATION ? pose->orientation : is;
		const rb_vec3 spin = rb_vec3_from(frame->angular_velocity + 3 * i);
		*difference += 0.5 * (spin_energy(rb_model_inertia(model, i), is, spin) -
		                      spin_energy(rb_model_inertia(model, i), should,
		                                  pose->angular_velocity));
	}
	return true;
}

/* Compares a body in all quantities that the reference states. */
static void compare_body(struct rb_watch *watch, struct moment *moment,
                         const struct rb_frame *frame, int i, const struct rb_reference_pose *pose)
{
	const bool turns = frame->orientation != NULL;

	if (pose->known & RB_FIELD_POSITION)
		compare_vectors(watch, moment, RB_QUANTITY_POSITION,
		                rb_vec3_from(frame->position + 3 * i), pose->position);
	if (pose->known & RB_FIELD_VELOCITY)
		compare_vectors(watch, moment, RB_QUANTITY_VELOCITY,
		                rb_vec3_from(frame->velocity + 3 * i), pose->velocity);
	if (pose->known & RB_FIELD_ORIENTATION && turns)
		compare(watch, moment, RB_QUANTITY_ORIENTATION,
		        angle_between(rb_quat_from(frame->orientation + 4 * i), pose->orientation),
		        1);
	if (pose->known & RB_FIELD_ANGULAR_VELOCITY && turns)
		compare_vectors(watch, moment, RB_QUANTITY_ANGULAR_VELOCITY,
		                rb_vec3_from(frame->angular_velocity + 3 * i),
		                pose->angular_velocity);
}

/*
 * Compares the energy of all bodies: with a path's, with the reference's, or else with that at the
 * start (`energy_drifts`).
 */
static void compare_energy(struct rb_watch *watch, struct moment *moment,
                           const struct rb_frame *frame, bool stated, double difference)
{
	const double energy = frame->numbers.kinetic_energy + frame->numbers.potential_energy;

	if (!watch->started)
		watch->energy_start = energy;
	if (watch->against) {
		difference = energy - *sample(watch->against, frame->index);
	} else if (!stated) {
		watch->energy_drifts = true;
		difference = energy - watch->energy_start;
	}
	compare(watch, moment, RB_QUANTITY_ENERGY, fabs(difference), 0);
}

/* Keeps the last time up to which the wanted quantity agreed. */
static void agree(struct rb_watch *watch, const struct moment *moment, double time_s)
{
	watch->disagreed = watch->disagreed ||
	                   !(moment->largest[watch->agree_quantity] <= watch->agree);
	if (!watch->disagreed)
		watch->agree_s = time_s;
}

enum rb_status rb_watch_start(struct rb_watch *watch, const struct rb_model *model,
                              struct rb_error *err)
{
	watch->model = model;
	watch->agree_s = (double)NAN;
	watch->poses = rb_memory_take((size_t)model->scene->body_count, sizeof *watch->poses);
	if (!watch->poses)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot compare %d bodies: out of memory",
		               model->scene->body_count);
	return RB_OK;
}

enum rb_status rb_watch_frame(struct rb_watch *watch, struct rb_world *world,
                              const struct rb_frame *frame, struct rb_error *err)
{
	const uint64_t stride = watch->store     ? watch->store->stride
	                        : watch->against ? watch->against->stride
	                                         : 1;
	struct moment moment = {0};
	bool stated = true;
	double difference = 0;

	RB_ASSERT(watch->model && frame->body_count == watch->model->body_count);
	if (frame->index % stride != 0 || frame->time_s > watch->until_s)
		return RB_OK;
	if (watch->store)
		keep(watch->store, frame);
	if (!watch->against && !watch->script)
		return RB_OK;
	if (!watch->against) {
		const enum rb_status status = rb_script_reference(watch->script, world,
		                                                  frame->time_s, watch->poses, err);
		if (status)
			return status;
	}
	for (int i = 0; i < frame->body_count; i++) {
		const struct rb_reference_pose pose =
			watch->against ? pose_of_path(watch->against, frame->index, i)
				       : watch->poses[watch->model->id_of[i]];
		compare_body(watch, &moment, frame, i, &pose);
		if (!watch->against)
			stated = energy_difference(watch, frame, i, &pose, &difference) && stated;
	}
	watch->kinetic_max = fmax(watch->kinetic_max, frame->numbers.kinetic_energy);
	compare_energy(watch, &moment, frame, stated, difference);
	compare(watch, &moment, RB_QUANTITY_PENETRATION, frame->numbers.max_penetration,
	        watch->model->size_min_m);
	agree(watch, &moment, frame->time_s);
	for (int q = 0; q < RB_QUANTITY_COUNT; q++)
		watch->of[q].final = moment.known[q] ? moment.largest[q] : (double)NAN;
	if (!watch->started)
		watch->start = moment.largest[RB_QUANTITY_POSITION];
	watch->started = true;
	return RB_OK;
}

void rb_watch_end(struct rb_watch *watch)
{
	struct rb_deviation *const energy = &watch->of[RB_QUANTITY_ENERGY];

	for (int q = 0; q < RB_QUANTITY_COUNT; q++) {
		struct rb_deviation *const of = &watch->of[q];
		of->rms = of->count > 0 ? sqrt(of->rms / (double)of->count) : (double)NAN;
	}
	/* without any motion there is nothing that the energy could be relative to */
	if (watch->kinetic_max > 0) {
		energy->max /= watch->kinetic_max;
		energy->rms /= watch->kinetic_max;
		energy->final /= watch->kinetic_max;
	}
	energy->largest = 1;
}

void rb_watch_release(struct rb_watch *watch)
{
	rb_memory_free(watch->poses);
	watch->poses = NULL;
}
