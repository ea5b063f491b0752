/* SPDX-License-Identifier: MIT */
/*
 * Joints sealed: the author's points and axes, in world coordinates at the start, become points and
 * frames of the bodies. A joint that does not close at the start to 1e-9 of its size is a mistake:
 * nothing is moved silently. Lists of joints at a body are in compressed form, as those of force
 * elements (model/element).
 */
#include "model/joints.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "math/quat.h"
#include "model/shape.h"

/* Of the joint's size, or of a unit vector: the most by which a joint may be open at the start. */
static const double closed_within = 1e-9;
/* And by what coordinates round: the range of touching (step/gap). */
enum { COORDINATE_ULP = 8 };

const char *rb_joint_label(const struct rb_scene *scene, int k, char out[96])
{
	const struct rb_joint_def *def = &scene->joints[k];

	RB_ASSERT(k >= 0 && k < scene->joint_count);
	if (def->name)
		snprintf(out, 96, "%s '%.63s'", rb_joint_kind_name(def->kind), def->name);
	else
		snprintf(out, 96, "%s #%d", rb_joint_kind_name(def->kind), k);
	return out;
}

const char *rb_joint_source(const struct rb_scene *scene, int k, char out[96])
{
	RB_ASSERT(k >= 0 && k < scene->joint_count);
	out[0] = '\0';
	if (scene->joints[k].line > 0)
		rb_error_place(scene->file, scene->joints[k].line, out, 96);
	return out;
}

/* ---- points ---- */

static rb_quat turn_of(const struct rb_scene *scene, int id)
{
	return id < 0 ? rb_quat_identity : rb_quat_unit(scene->bodies[id].orientation);
}

/* The centre of mass as the model has it, object coordinates: of what is not free, the origin. */
static rb_vec3 center_of(const struct rb_scene *scene, int id)
{
	if (id < 0 || !rb_body_is_free(&scene->bodies[id]))
		return (rb_vec3){0, 0, 0};
	return scene->bodies[id].center_of_mass;
}

static rb_vec3 to_world(const struct rb_scene *scene, int id, rb_vec3 at)
{
	if (id < 0)
		return at;
	return rb_vec3_add(scene->bodies[id].position, rb_quat_rotate(turn_of(scene, id), at));
}

/* From the centre of mass, object axes. */
static rb_vec3 to_body(const struct rb_scene *scene, int id, rb_vec3 point)
{
	if (id < 0)
		return point;
	return rb_vec3_sub(rb_quat_rotate_back(turn_of(scene, id),
	                                       rb_vec3_sub(point, scene->bodies[id].position)),
	                   center_of(scene, id));
}

static bool is_given(rb_vec3 v)
{
	return !isnan(v.x);
}

void rb_joint_points(const struct rb_scene *scene, const struct rb_joint_def *def, rb_vec3 *p_a,
                     rb_vec3 *p_b)
{
	const bool line = rb_joint_is_line(def->kind);
	const bool has_a = is_given(def->at_a), has_b = is_given(def->at_b);

	*p_a = has_a ? to_world(scene, def->a, def->at_a) : def->at;
	*p_b = has_b ? to_world(scene, def->b, def->at_b) : def->at;
	if (!has_a && !is_given(def->at))
		*p_a = line || !has_b ? to_world(scene, def->a, center_of(scene, def->a)) : *p_b;
	if (!has_b && !is_given(def->at))
		*p_b = line ? to_world(scene, def->b, center_of(scene, def->b)) : *p_a;
}

double rb_joint_size(const struct rb_scene *scene, const struct rb_joint_def *def)
{
	const int id[2] = {def->a, def->b};
	rb_vec3 point[2];
	double size = 0;

	rb_joint_points(scene, def, &point[0], &point[1]);
	for (int e = 0; e < 2; e++) {
		if (id[e] < 0)
			continue;
		const struct rb_body_def *body = &scene->bodies[id[e]];

		size = fmax(size, rb_vec3_length(to_body(scene, id[e], point[e])));
		if (rb_body_is_free(body))
			size = fmax(size, rb_shape_reach(scene->solids, &body->shape));
	}
	return rb_joint_is_line(def->kind)
	               ? fmax(size, rb_vec3_length(rb_vec3_sub(point[1], point[0])))
	               : size;
}

/* A point of it is off the centre of mass of a free body, or it carries torques. */
bool rb_joint_turns(const struct rb_scene *scene, const struct rb_joint_def *def)
{
	const int id[2] = {def->a, def->b};
	rb_vec3 point[2];

	if (!rb_joint_is_line(def->kind))
		return true;
	rb_joint_points(scene, def, &point[0], &point[1]);
	for (int e = 0; e < 2; e++) {
		const rb_vec3 at = e == 0 ? def->at_a : def->at_b;

		if (id[e] < 0 || !rb_body_is_free(&scene->bodies[id[e]]))
			continue;
		if (is_given(def->at) ||
		    (is_given(at) && rb_vec3_max_abs(rb_vec3_sub(at, center_of(scene, id[e]))) > 0))
			return true;
	}
	return false;
}

/* ---- mistakes ---- */

static bool ends_fault(const struct rb_scene *scene, const struct rb_joint_def *def,
                       char text[RB_JOINT_FAULT_SIZE])
{
	const char *what = NULL;

	if (def->a < 0 || def->a >= scene->body_count)
		what = "'a' must be a body";
	else if (def->b >= scene->body_count)
		what = "'b' must be a body, or be left out for the world";
	else if (def->a == def->b)
		what = "both ends are on the same body";
	else if (!rb_body_is_free(&scene->bodies[def->a]) &&
	         (def->b < 0 || !rb_body_is_free(&scene->bodies[def->b])))
		what = "nothing can move either end: one must be on a body that is neither static "
		       "nor driven";
	if (what)
		snprintf(text, RB_JOINT_FAULT_SIZE, "%s", what);
	return what != NULL;
}

/* Vectors that are given and not finite, numbers out of their range. */
static bool numbers_fault(const struct rb_joint_def *def, char text[RB_JOINT_FAULT_SIZE])
{
	const struct {
		const char *key;
		rb_vec3 value;
	} vector[] = {{"at", def->at},
	              {"at_a", def->at_a},
	              {"at_b", def->at_b},
	              {"axis", def->axis},
	              {"axis_b", def->axis_b}};
	const struct {
		const char *key;
		double value;
	} number[] = {{"friction", def->friction},
	              {"stiffness", def->stiffness},
	              {"damping", def->damping},
	              {"motor's torque", def->motor_max}};

	for (size_t k = 0; k < sizeof vector / sizeof vector[0]; k++) {
		if (!is_given(vector[k].value))
			continue;
		if (rb_vec3_finite(vector[k].value) &&
		    (k < 3 || rb_vec3_max_abs(vector[k].value) > 0))
			continue;
		snprintf(text, RB_JOINT_FAULT_SIZE, "'%s' must be finite%s", vector[k].key,
		         k < 3 ? "" : " and not zero");
		return true;
	}
	for (size_t k = 0; k < sizeof number / sizeof number[0]; k++) {
		if (number[k].value >= 0 && isfinite(number[k].value))
			continue;
		snprintf(text, RB_JOINT_FAULT_SIZE, "'%s' must be finite and 0 or more (got %g)",
		         number[k].key, number[k].value);
		return true;
	}
	if (!(def->restitution >= 0 && def->restitution <= 1)) {
		snprintf(text, RB_JOINT_FAULT_SIZE, "'restitution' must be in [0, 1] (got %g)",
		         def->restitution);
		return true;
	}
	return false;
}

/* What is of a free coordinate, which some kinds do not have. */
static bool free_fault(const struct rb_joint_def *def, char text[RB_JOINT_FAULT_SIZE])
{
	const char *key = NULL;

	if (rb_joint_is_free(def->kind))
		return false;
	if (!isnan(def->limits[0]) || !isnan(def->limits[1]))
		key = "limits";
	else if (rb_joint_has_motor(def))
		key = "motor";
	else if (def->friction > 0)
		key = "friction";
	else if (def->stiffness > 0 || def->damping > 0)
		key = def->stiffness > 0 ? "stiffness" : "damping";
	if (key)
		snprintf(text, RB_JOINT_FAULT_SIZE,
		         "'%s' is of the angle or the way that a joint leaves free; kind '%s' has "
		         "neither",
		         key, rb_joint_kind_name(def->kind));
	return key != NULL;
}

double rb_joint_allowed(double size, rb_vec3 p_a, rb_vec3 p_b)
{
	return closed_within * size +
	       COORDINATE_ULP * DBL_EPSILON * fmax(rb_vec3_max_abs(p_a), rb_vec3_max_abs(p_b));
}

/* Points that do not meet, a length that is not that of the start. */
static bool gap_fault(const struct rb_scene *scene, const struct rb_joint_def *def,
                      char text[RB_JOINT_FAULT_SIZE])
{
	const double size = rb_joint_size(scene, def);
	rb_vec3 p_a, p_b;

	rb_joint_points(scene, def, &p_a, &p_b);
	const double distance = rb_vec3_length(rb_vec3_sub(p_b, p_a));
	const double allowed = rb_joint_allowed(size, p_a, p_b);
	char a[64], b[64];

	rb_scene_body_label(scene, def->a, a);
	if (def->b < 0)
		snprintf(b, sizeof b, "the world");
	else
		rb_scene_body_label(scene, def->b, b);
	if (!rb_joint_is_line(def->kind)) {
		if (distance <= allowed)
			return false;
		snprintf(text, RB_JOINT_FAULT_SIZE,
		         "does not close at the start: the points of %s and %s are %.6g m apart "
		         "(wanted at most 1e-9 of its size, %.6g m)",
		         a, b, distance, size);
		return true;
	}
	if (!isnan(def->length_m) && !(def->length_m > 0 && isfinite(def->length_m))) {
		snprintf(text, RB_JOINT_FAULT_SIZE, "'length' must be positive (got %g)",
		         def->length_m);
		return true;
	}
	const double length = isnan(def->length_m) ? distance : def->length_m;

	if (!(length > 0)) {
		snprintf(text, RB_JOINT_FAULT_SIZE,
		         "the points of %s and %s are at one place: it has no length (kind 'ball' "
		         "holds them together)",
		         a, b);
		return true;
	}
	const double over = rb_joint_type(def->kind)->linkage.one_sided ? distance - length
	                                                                : fabs(distance - length);

	if (over <= allowed)
		return false;
	snprintf(text, RB_JOINT_FAULT_SIZE,
	         "does not close at the start: 'length' is %.6g m, and the points of %s and %s are "
	         "%.6g m apart",
	         length, a, b, distance);
	return true;
}

static bool axes_fault(const struct rb_joint_def *def, char text[RB_JOINT_FAULT_SIZE])
{
	const rb_vec3 none = {0, 0, 1};

	if (rb_joint_type(def->kind)->has_axis && !is_given(def->axis)) {
		snprintf(text, RB_JOINT_FAULT_SIZE, "'axis' must be given for kind '%s'",
		         rb_joint_kind_name(def->kind));
		return true;
	}
	if (!rb_joint_type(def->kind)->has_axis_b)
		return false;
	if (!is_given(def->axis_b)) {
		snprintf(text, RB_JOINT_FAULT_SIZE,
		         "'axis_b' must be given for kind '%s': the axis of b, across 'axis'",
		         rb_joint_kind_name(def->kind));
		return true;
	}
	const double along = rb_vec3_dot(rb_vec3_unit(def->axis, none),
	                                 rb_vec3_unit(def->axis_b, none));

	if (fabs(along) <= closed_within)
		return false;
	snprintf(text, RB_JOINT_FAULT_SIZE,
	         "does not close at the start: 'axis' and 'axis_b' must be at right angles (the "
	         "cosine of their angle is %.6g)",
	         along);
	return true;
}

bool rb_joint_fault(const struct rb_scene *scene, const struct rb_joint_def *def,
                    char text[RB_JOINT_FAULT_SIZE])
{
	RB_ASSERT(def->kind >= 0 && def->kind < RB_JOINT_KIND_COUNT);
	return ends_fault(scene, def, text) || numbers_fault(def, text) || axes_fault(def, text) ||
	       free_fault(def, text) || gap_fault(scene, def, text);
}

bool rb_scene_joined(const struct rb_scene *scene, int a, int b)
{
	for (int k = 0; k < scene->joint_count; k++) {
		const struct rb_joint_def *def = &scene->joints[k];

		if (!def->collides &&
		    ((def->a == a && def->b == b) || (def->a == b && def->b == a)))
			return true;
	}
	return false;
}

/* ---- of a model ---- */

/* Axes of the joint in the world at the start, z along `axis`. */
static rb_quat axes_along(rb_vec3 axis)
{
	const rb_vec3 none = {(double)NAN, 0, 0};

	return is_given(axis) ? rb_plane_orientation(axis, none) : rb_quat_identity;
}

static rb_quat to_object(const struct rb_scene *scene, int id, rb_quat axes)
{
	const rb_quat q = turn_of(scene, id);

	return rb_quat_unit(rb_quat_multiply((rb_quat){q.w, -q.x, -q.y, -q.z}, axes));
}

static void fill_link(const struct rb_scene *scene, const struct rb_joint_def *def,
                      struct rb_linkage *link)
{
	const rb_quat axes = axes_along(def->axis);
	rb_vec3 p_a, p_b;

	rb_joint_points(scene, def, &p_a, &p_b);
	link->type = &rb_joint_type(def->kind)->linkage;
	link->at_a = to_body(scene, def->a, p_a);
	link->at_b = to_body(scene, def->b, p_b);
	if (is_given(def->at_a) && def->a >= 0)
		link->at_a = rb_vec3_sub(def->at_a, center_of(scene, def->a));
	if (is_given(def->at_b) && def->b >= 0)
		link->at_b = rb_vec3_sub(def->at_b, center_of(scene, def->b));
	/* nothing given: exactly at the centres of mass, so that nothing is turned */
	if (rb_joint_is_line(def->kind) && !is_given(def->at)) {
		link->at_a = is_given(def->at_a) ? link->at_a : (rb_vec3){0, 0, 0};
		if (def->b >= 0 && !is_given(def->at_b))
			link->at_b = (rb_vec3){0, 0, 0};
	}
	link->frame_a = to_object(scene, def->a, axes);
	link->frame_b = to_object(scene, def->b,
	                          rb_joint_type(def->kind)->has_axis_b ? axes_along(def->axis_b)
	                                                               : axes);
	link->length = 0;
	if (rb_joint_is_line(def->kind))
		link->length = isnan(def->length_m) ? rb_vec3_length(rb_vec3_sub(p_b, p_a))
		                                    : def->length_m;
}

static struct rb_joint sealed(const struct rb_model *model, int k)
{
	const struct rb_joint_def *def = &model->scene->joints[k];
	struct rb_joint joint = {
		.a = model->index_of[def->a],
		.b = def->b < 0 ? -1 : model->index_of[def->b],
		.def = k,
		.low = isnan(def->limits[0]) ? -(double)INFINITY : def->limits[0],
		.high = isnan(def->limits[1]) ? (double)INFINITY : def->limits[1],
		.restitution = def->restitution,
		.friction = def->friction,
		.has_motor = rb_joint_has_motor(def),
		.motor_speed = def->motor_speed,
		.motor_function = def->motor_function,
		.motor_max = def->motor_max,
		.stiffness = def->stiffness,
		.damping = def->damping,
		.rest = def->rest,
		.collides = def->collides,
		.size = rb_joint_size(model->scene, def),
	};

	fill_link(model->scene, def, &joint.link);
	if (joint.link.type->one_sided) {
		joint.low = 0;
		joint.high = joint.link.length;
	}
	return joint;
}

/* Fills first, of by a counting sort over body indices (see model/element). */
static void list_ends(struct rb_joints *joints, int bodies)
{
	int *const next = joints->first + 1;

	for (int k = 0; k < joints->count; k++) {
		next[joints->joint[k].a + 1]++;
		if (joints->joint[k].b >= 0)
			next[joints->joint[k].b + 1]++;
	}
	for (int i = 0; i < bodies; i++)
		next[i + 1] += next[i];
	for (int k = 0; k < joints->count; k++) {
		joints->of[next[joints->joint[k].a]++] = k;
		if (joints->joint[k].b >= 0)
			joints->of[next[joints->joint[k].b]++] = k;
	}
	RB_ASSERT(joints->first[0] == 0);
}

/*
 * Refuses a point so far from a body's centre of mass that a force there turns the body and hardly
 * moves it: m r^2 / I is the ratio of the two accelerations of that point, and beyond 2^48 the
 * smaller is within 16 ulp of the larger. Written so that what is not finite is refused.
 */
static enum rb_status check_arms(const struct rb_model *model, int k, struct rb_error *err)
{
	static const double ratio_max = 1 / (16 * DBL_EPSILON);
	const struct rb_joint *const joint = &model->joints->joint[k];
	const int end[2] = {joint->a, joint->b};
	const rb_vec3 arm[2] = {joint->link.at_a, joint->link.at_b};
	char label[96], body[64];

	for (int e = 0; e < 2; e++) {
		const int i = end[e];

		if (i < 0 || i >= model->body_count || !(model->inverse_mass[i] > 0))
			continue;
		const double length = rb_vec3_length(arm[e]);
		const rb_mat3 *const inverse = model->inverse_inertia
		                                       ? rb_model_inverse_inertia(model, i)
		                                       : NULL;
		/* the trace bounds the largest principal one */
		const double turns = inverse ? inverse->m[0][0] + inverse->m[1][1] +
		                                       inverse->m[2][2]
		                             : 0;

		if (length * length * model->mass[i] * turns <= ratio_max)
			continue;
		rb_scene_body_label(model->scene, model->id_of[i], body);
		return RB_FAIL(err, RB_ERR_SCENE,
		               "%s:%d: joint: %s: its point is %g m from the centre of mass of %s, "
		               "too far for so little inertia to be solved (m r^2 / I is %.3g, "
		               "expected at most %.3g)",
		               model->scene->file, model->scene->joints[k].line,
		               rb_joint_label(model->scene, k, label), length, body,
		               length * length * model->mass[i] * turns, ratio_max);
	}
	return RB_OK;
}

enum rb_status rb_joints_create(struct rb_model *model, struct rb_error *err)
{
	const size_t count = (size_t)model->scene->joint_count;
	const int bodies = model->body_count + model->static_count;

	if (count == 0)
		return RB_OK;
	struct rb_joints *const joints = rb_memory_take(1, sizeof *joints);

	model->joints = joints;
	if (joints) {
		joints->count = (int)count;
		joints->joint = rb_memory_take(count, sizeof *joints->joint);
		joints->first = rb_memory_take((size_t)bodies + 2, sizeof *joints->first);
		joints->of = rb_memory_take(2 * count, sizeof *joints->of);
	}
	if (!joints || !joints->joint || !joints->first || !joints->of)
		return RB_FAIL(err, RB_ERR_MEMORY, "out of memory for %zu joints", count);
	for (int k = 0; k < joints->count; k++) {
		joints->joint[k] = sealed(model, k);
		const enum rb_status status = check_arms(model, k, err);
		if (status)
			return status;
	}
	list_ends(joints, bodies);
	return RB_OK;
}

void rb_joints_destroy(struct rb_model *model)
{
	if (!model->joints)
		return;
	rb_memory_free(model->joints->joint);
	rb_memory_free(model->joints->first);
	rb_memory_free(model->joints->of);
	rb_memory_free(model->joints);
}

bool rb_joints_between(const struct rb_joints *joints, int a, int b)
{
	for (int e = joints->first[a]; e < joints->first[a + 1]; e++) {
		const struct rb_joint *joint = &joints->joint[joints->of[e]];

		if (!joint->collides && (joint->a == b || joint->b == b))
			return true;
	}
	return false;
}
