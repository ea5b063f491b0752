/* SPDX-License-Identifier: MIT */
/*
 * A camera is placed so that the boxes swept by the bodies fit its picture. Bodies that only ever
 * get farther away (a ball that rolls off a plane) would make everything else a dot; they are
 * sorted to the end and taken in, nearest first, as long as a body of typical size keeps
 * pixels_least pixels, or all else at least half of its size. All is done with boxes and their
 * eight corners: one pass over the frames, memory per body only, and a result that does not depend
 * on the order of frames shown twice.
 */
#include "flow/framing.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "force/spring.h"
#include "math/quat.h"
#include "math/vec3.h"
#include "model/center.h"
#include "model/joints.h"
#include "model/shape.h"

/* What a body is within, in object coordinates, m: a ball, and a box of these half lengths. */
struct hull {
	rb_vec3 middle;
	double radius;
	rb_vec3 half;
};

/*
 * Box of where a body has been, with its whole size. `low` above `high`: it has no extent, as
 * planes have none.
 */
struct rb_reach {
	struct hull around;
	rb_vec3 low, high;
	rb_vec3 last;            /* its origin */
	double away_m, before_m; /* from the middle of all, in the last frame and at most before */
	bool leaves, visible;
};

/*
 * A body of typical size must stay this wide in the picture: smaller, it cannot be told from noise.
 */
static const double pixels_least = 2;
/* What one that leaves may make of the distance of the camera, where that is so anyway. */
static const double farther_most = 2;
/* Share of half the picture that is left free at its edges. */
static const double margin = 0.1;

static rb_vec3 least(rb_vec3 a, rb_vec3 b)
{
	return (rb_vec3){fmin(a.x, b.x), fmin(a.y, b.y), fmin(a.z, b.z)};
}

static rb_vec3 max(rb_vec3 a, rb_vec3 b)
{
	return (rb_vec3){fmax(a.x, b.x), fmax(a.y, b.y), fmax(a.z, b.z)};
}

static rb_vec3 alike(double length)
{
	return (rb_vec3){length, length, length};
}

/*
 * Extends a box by one of half lengths `half` m at `at`; true if it became larger. Infinite ones
 * (planes) give a box without finite corners, which rb_framing_aim passes over.
 */
static bool grow(struct rb_reach *reach, rb_vec3 at, rb_vec3 half)
{
	const rb_vec3 low = least(reach->low, rb_vec3_sub(at, half));
	const rb_vec3 high = max(reach->high, rb_vec3_add(at, half));
	const bool more = low.x < reach->low.x || low.y < reach->low.y || low.z < reach->low.z ||
	                  high.x > reach->high.x || high.y > reach->high.y ||
	                  high.z > reach->high.z;

	RB_ASSERT(!(half.x < 0 || half.y < 0 || half.z < 0));
	reach->low = low;
	reach->high = high;
	return more;
}

/*
 * Half lengths of what is turned so: of the box or of the ball, whichever is less. Comparisons are
 * such that infinite and undefined radii stay.
 */
static rb_vec3 turned_half(const struct hull *hull, rb_quat orientation)
{
	const rb_mat3 turn = rb_quat_to_mat3(orientation);
	double half[3];

	for (int k = 0; k < 3; k++) {
		half[k] = fabs(turn.m[k][0]) * hull->half.x + fabs(turn.m[k][1]) * hull->half.y +
		          fabs(turn.m[k][2]) * hull->half.z;
		if (!(half[k] < hull->radius))
			half[k] = hull->radius;
	}
	return rb_vec3_from(half);
}

static struct hull hull_of(const struct rb_scene *scene, const struct rb_shape *shape);

/* The k-th corner of a hull or part of a union. */
static struct hull hull_at(const struct rb_scene *scene, const struct rb_solid *solid, int k)
{
	if (solid->part_count == 0)
		return (struct hull){.middle = solid->vertices[k]};
	const struct rb_solid_part *const part = &solid->parts[k];
	const struct hull own = hull_of(scene, &part->shape);

	return (struct hull){
		rb_vec3_add(part->position, rb_quat_rotate(part->orientation, own.middle)),
		own.radius, turned_half(&own, part->orientation)};
}

/* Around the box that its corners or parts fill. */
static struct hull hull_of(const struct rb_scene *scene, const struct rb_shape *shape)
{
	const double reach = rb_shape_reach(scene->solids, shape);
	const enum rb_shape_form form = rb_shape_type(shape)->form;
	const rb_vec3 end = {(double)INFINITY, (double)INFINITY, (double)INFINITY};
	struct rb_reach box = {.low = end, .high = rb_vec3_neg(end)};
	struct hull around = {{0, 0, 0}, 0, {0, 0, 0}};

	if (form != RB_FORM_POLYHEDRON && form != RB_FORM_UNION)
		return (struct hull){{0, 0, 0}, reach, rb_shape_type(shape)->half(shape)};
	const struct rb_solid *const solid = &scene->solids[shape->solid];
	const int count = solid->part_count > 0 ? solid->part_count : solid->vertex_count;
	for (int k = 0; k < count; k++) {
		const struct hull one = hull_at(scene, solid, k);
		(void)grow(&box, one.middle, one.half);
	}
	around.middle = rb_vec3_scale(0.5, rb_vec3_add(box.low, box.high));
	for (int k = 0; k < count; k++) {
		const struct hull one = hull_at(scene, solid, k);
		around.radius = fmax(around.radius,
		                     rb_vec3_length(rb_vec3_sub(one.middle, around.middle)) +
		                             one.radius);
	}
	around.half = rb_vec3_scale(0.5, rb_vec3_sub(box.high, box.low));
	return around;
}

/*
 * What a body is within, whichever way it is turned; a radius of NaN: it is nowhere, so that it
 * widens no picture. Planes without end reach nowhere, and so do finite ones that are larger than
 * the place where the others begin: they are the ground, beside which nothing else would be seen.
 */
static struct hull around(const struct rb_framing *framing, int i)
{
	const struct rb_shape *const shape = &framing->model->shape[i];
	const double plate_m = 0.5 * hypot(shape->size[0], shape->size[1]);

	if (shape->kind == RB_SHAPE_RECTANGLE) {
		const double radius = plate_m <= framing->plate_most_m ? plate_m : (double)NAN;
		return (struct hull){
			{0, 0, 0},
			radius,
			isnan(radius) ? alike(radius)
				      : (rb_vec3){0.5 * shape->size[0], 0.5 * shape->size[1], 0}};
	}
	if (rb_shape_type(shape)->form == RB_FORM_SURFACE)
		return (struct hull){{0, 0, 0},
		                     rb_model_reach(framing->model, i),
		                     alike(rb_model_reach(framing->model, i))};
	return hull_of(framing->model->scene, shape);
}

/* Extends what a body has reached by where it is now. */
static bool extend(struct rb_reach *reach, rb_vec3 position, rb_quat orientation)
{
	const rb_vec3 middle = rb_quat_rotate(orientation, reach->around.middle);

	return grow(reach, rb_vec3_add(position, middle), turned_half(&reach->around, orientation));
}

/* Half the diagonal of the largest finite plane that is no ground. */
static double plate_most(const struct rb_framing *framing)
{
	const struct rb_model *const model = framing->model;
	const rb_vec3 end = {(double)INFINITY, (double)INFINITY, (double)INFINITY};
	struct rb_reach all = {.low = end, .high = rb_vec3_neg(end)};
	bool plates_only = true;

	for (int i = 0; i < framing->count; i++) {
		if (!model->scene->bodies[model->id_of[i]].visible)
			continue;
		const bool plate = model->shape[i].kind == RB_SHAPE_RECTANGLE;
		plates_only &= plate;
		(void)grow(&all, model->position[i], alike(plate ? 0 : rb_model_reach(model, i)));
	}
	return plates_only ? (double)INFINITY : rb_vec3_length(rb_vec3_sub(all.high, all.low));
}

/* What hangs on the world belongs into the picture with the place where it hangs. */
static void add_joints(struct rb_framing *framing)
{
	const struct rb_scene *scene = framing->model->scene;

	for (int k = 0; k < scene->joint_count; k++) {
		const struct rb_joint_def *def = &scene->joints[k];
		const int index = framing->model->index_of[def->a];
		rb_vec3 a, b;

		if (def->b >= 0 || !def->visible || index >= framing->count)
			continue;
		rb_joint_points(scene, def, &a, &b);
		(void)grow(&framing->reach[index], b, alike(0));
	}
}

/* The same of a spring that holds what moves to what does not. */
static void add_springs(struct rb_framing *framing)
{
	const struct rb_model *model = framing->model;
	const int count = rb_scene_element_count(model->scene, &rb_force_spring);

	for (int k = 0; k < count; k++) {
		const struct rb_spring_def *spring = rb_scene_spring(model->scene, k);
		const bool swapped = model->index_of[spring->a] >= model->body_count;
		const int moves = model->index_of[swapped ? spring->b : spring->a];
		const int fixed = model->index_of[swapped ? spring->a : spring->b];
		const rb_vec3 at = swapped ? spring->at_a : spring->at_b;

		if (moves >= framing->count || fixed < model->body_count)
			continue;
		const rb_quat turn = model->orientation[fixed];
		const rb_vec3 origin = model->position[fixed];
		const rb_vec3 end = isnan(at.x) ? rb_model_center(model, fixed, origin, turn)
		                                : rb_vec3_add(origin, rb_quat_rotate(turn, at));
		(void)grow(&framing->reach[moves], end, alike(0));
	}
}

enum rb_status rb_framing_init(struct rb_framing *framing, const struct rb_model *model,
                               struct rb_error *err)
{
	const bool moves = model->body_count > 0;
	const rb_vec3 end = {(double)INFINITY, (double)INFINITY, (double)INFINITY};
	rb_vec3 low = end, high = rb_vec3_neg(end);

	*framing = (struct rb_framing){.model = model,
	                               .count = moves ? model->body_count : model->static_count};
	framing->reach = rb_memory_take((size_t)framing->count + 1, sizeof *framing->reach);
	if (!framing->reach)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot look for %d bodies: out of memory",
		               framing->count);
	framing->plate_most_m = plate_most(framing);
	for (int i = 0; i < framing->count; i++) {
		struct rb_reach *const reach = &framing->reach[i];
		*reach = (struct rb_reach){
			.low = end,
			.high = rb_vec3_neg(end),
			.last = model->position[i],
			.around = around(framing, i),
			.visible = model->scene->bodies[model->id_of[i]].visible};
		(void)extend(reach, model->position[i], model->orientation[i]);
		if (reach->visible) {
			low = least(low, reach->low);
			high = max(high, reach->high);
		}
	}
	if (low.x <= high.x)
		framing->middle = rb_vec3_scale(0.5, rb_vec3_add(low, high));
	add_joints(framing);
	add_springs(framing);
	return RB_OK;
}

void rb_framing_release(struct rb_framing *framing)
{
	rb_memory_free(framing->reach);
	*framing = (struct rb_framing){0};
}

bool rb_framing_see(struct rb_framing *framing, const struct rb_frame *frame)
{
	const struct rb_model *const model = framing->model;
	bool more = false;

	for (int i = 0; frame->position && i < framing->count && i < frame->body_count; i++) {
		struct rb_reach *const reach = &framing->reach[i];
		const rb_vec3 at = rb_vec3_from(frame->position + 3 * (size_t)i);
		/*
		 * a run that has failed may have published such a state; the rest is still worth
		 * seeing
		 */
		if (!rb_vec3_finite(at))
			continue;
		if (frame->orientation)
			more |= extend(reach, at, rb_quat_from(frame->orientation + 4 * (size_t)i));
		else if (!(model->features & RB_FEATURE_ROTATION))
			more |= extend(reach, at, model->orientation[i]);
		else /* it is not recorded how they are turned */
			more |= grow(
				reach, at,
				alike(rb_vec3_length(reach->around.middle) + reach->around.radius));
		reach->before_m = fmax(reach->before_m, reach->away_m);
		reach->away_m = rb_vec3_length(rb_vec3_sub(at, framing->middle));
		reach->leaves = reach->away_m > reach->before_m;
		reach->last = at;
	}
	return more;
}

/*
 * A camera's axes, and how much of a metre at a metre's distance is in its picture; of an
 * orthographic one, how much of each metre from the middle of the picture to its upper edge.
 */
struct sight {
	bool parallel;
	rb_vec3 right, up, back;
	double across, upright;
	double wide; /* 1, or how much larger all is taken to be where the sight turns */
};

/*
 * How a camera that has no place of its own looks: along the default line of sight, with its own
 * field of view, reduced by the margin. A camera that turns with time sees from all sides:
 * everything is then taken to be twice as wide.
 */
static struct sight sight_of(const struct rb_camera_def *camera)
{
	const bool fixed = camera->look_at.source == RB_CAMERA_FIXED &&
	                   camera->up.source == RB_CAMERA_FIXED;
	const rb_vec3 vertical = camera->up.source == RB_CAMERA_FIXED ? camera->up.value
	                                                              : (rb_vec3){0, 0, 1};
	struct sight sight = {.parallel = camera->orthographic, .wide = fixed ? 1 : 2};

	sight.back = rb_vec3_unit(rb_camera_def_default().position.value, (rb_vec3){0, -1, 0});
	sight.right = rb_vec3_unit(rb_vec3_cross(vertical, sight.back), rb_vec3_across(sight.back));
	sight.up = rb_vec3_cross(sight.back, sight.right);
	if (camera->orthographic) {
		sight.upright = 1;
		sight.across = (double)camera->size_px[0] / camera->size_px[1];
	} else if (camera->has_frustum) {
		const double *const f = camera->frustum;
		/* beside its axis nothing can be placed for it */
		sight.across = (f[0] < 0 && f[1] > 0 ? fmin(-f[0], f[1]) : f[1] - f[0]) / f[4];
		sight.upright = (f[2] < 0 && f[3] > 0 ? fmin(-f[2], f[3]) : f[3] - f[2]) / f[4];
	} else {
		sight.upright = tan(0.5 * camera->fov);
		sight.across = sight.upright * camera->size_px[0] / camera->size_px[1];
	}
	sight.across *= 1 - margin;
	sight.upright *= 1 - margin;
	return sight;
}

/*
 * m: how far from `target` the eye must be, or the edge of an orthographic picture, to see the
 * corners of a box. Exact, since each corner bounds the distance linearly.
 */
static double distance_of(const struct sight *sight, rb_vec3 low, rb_vec3 high, rb_vec3 target)
{
	double distance = 0;

	RB_ASSERT(sight->across > 0 && sight->upright > 0);
	for (int k = 0; k < 8; k++) {
		const rb_vec3 corner = {k & 1 ? high.x : low.x, k & 2 ? high.y : low.y,
		                        k & 4 ? high.z : low.z};
		const rb_vec3 arm = rb_vec3_scale(sight->wide, rb_vec3_sub(corner, target));
		const double sideways = fmax(fabs(rb_vec3_dot(arm, sight->right)) / sight->across,
		                             fabs(rb_vec3_dot(arm, sight->up)) / sight->upright);
		distance = fmax(distance, sight->parallel
		                                  ? sideways
		                                  : rb_vec3_dot(arm, sight->back) + sideways);
	}
	return distance;
}

/*
 * For qsort: bodies that stay before those that leave, then by distance, then by index, so that the
 * order is total and does not depend on qsort.
 */
static int by_distance(const void *left, const void *right)
{
	const struct rb_reach *const x = *(const struct rb_reach *const *)left;
	const struct rb_reach *const y = *(const struct rb_reach *const *)right;

	if (x->leaves != y->leaves)
		return x->leaves ? 1 : -1;
	if (x->away_m != y->away_m)
		return x->away_m < y->away_m ? -1 : 1;
	return x < y ? -1 : x > y;
}

/*
 * Appends a body's name, or #ID where it has none, cut where it does not fit; `place`: how many
 * were written before.
 */
static void name(const struct rb_framing *framing, const struct rb_reach *reach, int place,
                 char *text, size_t size)
{
	const int id = framing->model->id_of[reach - framing->reach];
	const char *const own = framing->model->scene->bodies[id].name;
	const size_t used = strlen(text);

	RB_ASSERT(reach >= framing->reach && reach < framing->reach + framing->count);
	if (used >= size)
		return;
	if (own)
		snprintf(text + used, size - used, "%s'%.60s'", place > 0 ? ", " : "", own);
	else
		snprintf(text + used, size - used, "%s#%d", place > 0 ? ", " : "", id);
}

int rb_framing_aim(const struct rb_framing *framing, struct rb_camera_def *camera, char *text,
                   size_t size)
{
	const struct sight sight = sight_of(camera);
	const struct rb_reach **const order = rb_memory_take((size_t)framing->count + 1,
	                                                     sizeof *order);
	const double typical_m = 2 * framing->model->size_mean_m;
	const rb_vec3 end = {(double)INFINITY, (double)INFINITY, (double)INFINITY};
	const bool looks = camera->look_at.source == RB_CAMERA_FIXED && camera->aimed;
	rb_vec3 low = end, high = rb_vec3_neg(end), target = camera->look_at.value;
	double distance = 0, staying = 0;
	int count = 0, taken = 0, left_out = 0;

	RB_ASSERT(size > 0);
	*text = '\0';
	for (int i = 0; order && i < framing->count; i++)
		if (framing->reach[i].visible && isfinite(framing->reach[i].high.x))
			order[count++] = &framing->reach[i];
	if (count > 0)
		qsort(order, (size_t)count, sizeof *order, by_distance);
	const bool some_stay = count > 0 && !order[0]->leaves;
	for (; taken < count; taken++) {
		const rb_vec3 wider_low = least(low, order[taken]->low);
		const rb_vec3 wider_high = max(high, order[taken]->high);
		const rb_vec3 middle = looks ? target
		                             : rb_vec3_scale(0.5,
		                                             rb_vec3_add(wider_low, wider_high));
		const double wider = distance_of(&sight, wider_low, wider_high, middle);
		const double pixel_m = 2 * wider * sight.upright / camera->size_px[1];
		if (some_stay && order[taken]->leaves && typical_m < pixels_least * pixel_m &&
		    wider > farther_most * staying)
			break;
		low = wider_low;
		high = wider_high;
		target = middle;
		distance = wider;
		if (!order[taken]->leaves)
			staying = wider;
	}
	for (int k = taken; k < count; k++, left_out++)
		if (left_out < 3)
			name(framing, order[k], left_out, text, size);
	if (left_out > 3 && strlen(text) < size)
		snprintf(text + strlen(text), size - strlen(text), " and %d more", left_out - 3);
	rb_memory_free(order);
	RB_ASSERT(taken + left_out == count);
	if (camera->look_at.source == RB_CAMERA_FIXED)
		camera->look_at.value = target;
	if (camera->orthographic && isnan(camera->height))
		camera->height = distance > 0 ? 2 * distance : 2;
	camera->position.source = RB_CAMERA_FIXED;
	camera->position.value = rb_vec3_add_scaled(target, distance > 0 ? distance : 1,
	                                            sight.back);
	return left_out;
}
