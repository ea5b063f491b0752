/* SPDX-License-Identifier: MIT */
/*
 * Checks that need the whole scene. All mistakes are collected before any is reported, since each
 * run of a large script may take minutes; what depends on a number found wrong is skipped, so that
 * one mistake is not reported twice. Conditions are written so that NaN fails them.
 *
 * Overlaps at the start are searched like contacts: boxes in a grid, then exact gaps. Duplicate
 * names are found by sorting hashes, in n log n.
 */
#include "model/validate.h"

#include <float.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "base/hash.h"
#include "base/memory.h"
#include "base/sort.h"
#include "geom/distance.h"
#include "geom/grid.h"
#include "geom/mass.h"
#include "model/descriptor.h"
#include "model/shape.h"
#include "math/quat.h"
#include "model/element.h"
#include "model/joints.h"
#include "model/parts.h"
#include "model/scale.h"

enum { OVERLAPS_SHOWN = 10, LINE_SIZE = 512 }; /* pairs named each; bytes of a message */

/*
 * Beyond 2^53 frames a double cannot number them; beyond 1e9 steps a frame takes hours, surely a
 * mistake of units.
 */
static const double frames_max = 0x1p53;
static const double steps_per_frame_max = 1e9;
/* m: beyond, sums and squares of coordinates overflow */
static const double coordinate_max = 1e300;

/* State of one check. */
struct check {
	const struct rb_scene *scene;
	struct rb_mistakes *mistakes; /* the caller's or `own` */
	struct rb_mistakes own;
	bool turns;
	struct rb_piece_scales sizes;
	struct rb_parts_table *parts; /* NULL: only spheres and planes */
};

void rb_mistakes_add(struct rb_mistakes *mistakes, const char *format, ...)
{
	char text[LINE_SIZE];
	va_list arguments;

	if (mistakes->count < RB_MISTAKES_MAX) {
		va_start(arguments, format);
		vsnprintf(text, sizeof text, format, arguments);
		va_end(arguments);
		mistakes->line[mistakes->count] = rb_memory_copy_text(text);
	}
	mistakes->count++;
}

void rb_mistakes_release(struct rb_mistakes *mistakes)
{
	for (int i = 0; i < RB_MISTAKES_MAX; i++)
		rb_memory_free(mistakes->line[i]);
	*mistakes = (struct rb_mistakes){0};
}

/* kg/m^3, of the body or its material. */
static double density_of(const struct rb_scene *scene, const struct rb_body_def *body)
{
	return isnan(body->density) ? scene->materials[body->material].density : body->density;
}

double rb_body_mass(const struct rb_scene *scene, const struct rb_body_def *body)
{
	return isnan(body->mass)
	               ? density_of(scene, body) * rb_shape_volume(scene->solids, &body->shape)
	               : body->mass;
}

double rb_body_attracts_by(const struct rb_scene *scene, const struct rb_body_def *body)
{
	if (!scene->world.gravitation.given)
		return 0;
	if (!isnan(body->gravitational_mass))
		return body->gravitational_mass;
	return rb_body_is_free(body) ? rb_body_mass(scene, body) : 0;
}

rb_mat3 rb_body_inertia(const struct rb_scene *scene, const struct rb_body_def *body, double mass)
{
	if (!body->inertia)
		return rb_shape_inertia(scene->solids, &body->shape, mass);
	/*
	 * averages the halves, which may differ by rounding: the tensor must be exactly symmetric
	 */
	rb_mat3 inertia = *body->inertia;
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < i; j++)
			inertia.m[i][j] = inertia.m[j][i] = 0.5 * inertia.m[i][j] +
			                                    0.5 * inertia.m[j][i];
	return inertia;
}

/* `scene.lua:12: ` or nothing */
static void place(const struct rb_scene *scene, int line, char out[256])
{
	out[0] = '\0';
	if (scene->file && scene->file[0] != '\0')
		rb_error_place(scene->file, line, out, 256);
}

/* sphere 'ball', or sphere #3 */
static void title(const struct rb_scene *scene, int id, char out[128])
{
	const struct rb_body_def *body = &scene->bodies[id];

	if (body->name)
		snprintf(out, 128, "%.20s '%.80s'", body->call, body->name);
	else
		snprintf(out, 128, "%.20s #%d", body->call, id);
}

/* A mistake of world, or of what the command line says instead. */
static void world_mistake(struct check *check, const char *format, ...) RB_PRINTF(2, 3);
static void world_mistake(struct check *check, const char *format, ...)
{
	char text[LINE_SIZE], where[256];
	va_list arguments;

	va_start(arguments, format);
	vsnprintf(text, sizeof text, format, arguments);
	va_end(arguments);
	place(check->scene, check->scene->world.line, where);
	rb_mistakes_add(check->mistakes, "%s%s", where, text);
}

/* A mistake at a line of the scene, about no body. */
static void line_mistake(struct check *check, int line, const char *format, ...) RB_PRINTF(3, 4);
static void line_mistake(struct check *check, int line, const char *format, ...)
{
	char text[LINE_SIZE], where[256];
	va_list arguments;

	va_start(arguments, format);
	vsnprintf(text, sizeof text, format, arguments);
	va_end(arguments);
	place(check->scene, line, where);
	rb_mistakes_add(check->mistakes, "%s%s", where, text);
}

static void body_mistake(struct check *check, int id, const char *format, ...) RB_PRINTF(3, 4);
static void body_mistake(struct check *check, int id, const char *format, ...)
{
	char text[LINE_SIZE], where[256], who[128];
	va_list arguments;

	va_start(arguments, format);
	vsnprintf(text, sizeof text, format, arguments);
	va_end(arguments);
	place(check->scene, check->scene->bodies[id].line, where);
	title(check->scene, id, who);
	rb_mistakes_add(check->mistakes, "%s%s: %s", where, who, text);
}

static double largest_of(rb_vec3 a)
{
	return fmax(fabs(a.x), fmax(fabs(a.y), fabs(a.z)));
}

/* Positive and finite; false for NaN. */
static bool positive(double x)
{
	return x > 0 && isfinite(x);
}

/* Duration, frame rate, time step, gravity. */
static void check_world(struct check *check)
{
	const struct rb_world_def *world = &check->scene->world;
	const bool has_rate = positive(world->frame_rate);
	const bool has_step = isnan(world->time_step_s) || positive(world->time_step_s);
	const double duration_s = rb_world_duration(world);

	/* if `steps` gives the duration, mistakes of frame rate and time step are reported below */
	if (isnan(world->duration_s) && world->steps == 0)
		world_mistake(check, "world: 'duration' is missing (wanted seconds, here or by "
		                     "--duration, or 'steps')");
	else if (!positive(duration_s) && (!isnan(world->duration_s) || (has_rate && has_step)))
		world_mistake(check, "world: 'duration' must be positive and finite (got %g s)",
		              duration_s);
	else if (has_rate && has_step && !(duration_s * world->frame_rate < frames_max))
		world_mistake(check,
		              "world: 'duration' %g s times 'frame_rate' %g makes %g frames "
		              "(wanted less than "
		              "2^53)",
		              duration_s, world->frame_rate, duration_s * world->frame_rate);
	if (!has_rate)
		world_mistake(check, "world: 'frame_rate' must be positive and finite (got %g)",
		              world->frame_rate);
	else if (!isfinite(1 / world->frame_rate))
		world_mistake(check, "world: 'frame_rate' %g has no finite interval",
		              world->frame_rate);
	if (!isnan(world->time_step_s) && !positive(world->time_step_s))
		world_mistake(check, "world: 'time_step' must be positive and finite (got %g s)",
		              world->time_step_s);
	else if (!isnan(world->time_step_s) && has_rate &&
	         !(fmin(1 / world->frame_rate, duration_s) / world->time_step_s <=
	           steps_per_frame_max))
		world_mistake(check, "world: 'time_step' %g s cuts a frame into more than %g steps",
		              world->time_step_s, steps_per_frame_max);
	if (!rb_vec3_finite(world->gravity) || !rb_vec3_finite(world->gravity_force))
		world_mistake(check, "world: 'gravity' must be finite");
	const struct rb_gravitation_def *const attraction = &world->gravitation;
	if (attraction->given &&
	    (!positive(attraction->constant) || !(attraction->softening_m >= 0) ||
	     !isfinite(attraction->softening_m) ||
	     !(attraction->opening_angle >= 0 && attraction->opening_angle <= 1)))
		world_mistake(check,
		              "world: 'gravitation' wants 'G' positive, 'softening' 0 or more, "
		              "'opening_angle' in [0, 1] (got %g, %g, %g)",
		              attraction->constant, attraction->softening_m,
		              attraction->opening_angle);
}

/* A tolerance below the rounding of coordinates could never be met. */
static void check_tolerance(struct check *check)
{
	const double given = check->scene->world.tolerance_m;
	const double least = 8 * rb_ulp(check->sizes.coordinate_max_m);

	if (isnan(given))
		return;
	if (!positive(given))
		world_mistake(check, "world: 'tolerance' must be positive and finite (got %g m)",
		              given);
	else if (given < least)
		world_mistake(check,
		              "world: 'tolerance' %g m is below what coordinates resolve (wanted "
		              "at least %g m, "
		              "8 ulp of the largest coordinate or size %g m)",
		              given, least, check->sizes.coordinate_max_m);
}

/*
 * Mass and inertia of a free body must be positive, finite, invertible and those of a rigid body.
 */
static void check_mass(struct check *check, int id)
{
	const struct rb_body_def *body = &check->scene->bodies[id];
	const double mass = rb_body_mass(check->scene, body);

	if (!isnan(body->mass) && !isnan(body->density)) {
		body_mistake(check, id, "'mass' and 'density' exclude each other");
		return;
	}
	if (!positive(mass) || !isfinite(1 / mass)) {
		if (isnan(body->mass))
			body_mistake(check, id,
			             "its mass comes out as %g kg (density %g kg/m^3, volume %g "
			             "m^3; wanted a "
			             "positive mass that a double holds)",
			             mass, density_of(check->scene, body),
			             rb_shape_volume(check->scene->solids, &body->shape));
		else
			body_mistake(check, id,
			             "'mass' must be positive and finite, and so its inverse (got "
			             "%g kg)",
			             mass);
		return;
	}
	/* without rotation particles may lie anywhere */
	if (body->particle_count > 0 && !check->turns)
		return;
	if (body->particle_count > 0 && rb_particles_in_line(body->inertia, body->particle_count)) {
		body_mistake(check, id,
		             "'particles' lie on one line or at one point, so that nothing resists "
		             "turning about it (wanted "
		             "some off the line, or 'mass' and 'inertia' instead)");
		return;
	}
	const char *fault = body->inertia ? rb_inertia_fault(body->inertia) : NULL;
	if (fault) {
		double moments[3];

		rb_inertia_principal(body->inertia, moments);
		body_mistake(check, id, "'inertia' %s (principal moments %g, %g, %g kg m^2)", fault,
		             moments[0], moments[1], moments[2]);
		return;
	}
	if (!check->turns)
		return;
	const rb_mat3 inertia = rb_body_inertia(check->scene, body, mass);
	rb_mat3 inverse;
	bool held = rb_mat3_inverse(&inertia, &inverse);
	for (int i = 0; held && i < 9; i++)
		held = isfinite(inverse.m[i / 3][i % 3]);
	if (!held)
		body_mistake(check, id,
		             "its inertia comes out as %g kg m^2 (wanted one that a double holds, "
		             "and so its "
		             "inverse)",
		             inertia.m[0][0]);
}

/* What it attracts others by. */
static void check_attraction(struct check *check, int id)
{
	const struct rb_scene *scene = check->scene;
	const struct rb_body_def *body = &scene->bodies[id];
	const double own = body->gravitational_mass;

	if (isnan(own))
		return;
	if (!(own >= 0) || !isfinite(own)) {
		body_mistake(check, id,
		             "'gravitational_mass' must be finite and 0 or more (got %g kg)", own);
		return;
	}
	if (rb_shape_is_flat(&body->shape) && own > 0)
		body_mistake(check, id,
		             "'gravitational_mass' of a plane: it has no centre (wanted a body "
		             "with one, such as a static sphere)");
	else if (!isfinite(own * scene->world.gravitation.constant))
		body_mistake(check, id, "'gravitational_mass' %g kg times 'G' %g is not finite",
		             own, scene->world.gravitation.constant);
	else if (!scene->world.gravitation.given)
		body_mistake(check, id,
		             "'gravitational_mass' in a world without gravitation (wanted world { "
		             "gravitation = {} })");
}

/* Numbers of the shape, by its type; false: a mistake was noted. */
static bool check_sizes(struct check *check, int id)
{
	const struct rb_shape *shape = &check->scene->bodies[id].shape;
	const struct rb_shape_type *const type = rb_shape_type(shape);
	char text[RB_SHAPE_FAULT_SIZE];

	if (!type->fault || !type->fault(shape, text))
		return true;
	body_mistake(check, id, "%s", text);
	return false;
}

/* Shape, pose and velocities; false: the shape or pose cannot be used in further checks. */
static bool check_shape(struct check *check, int id)
{
	const struct rb_body_def *body = &check->scene->bodies[id];
	bool good = check_sizes(check, id);

	if (!(rb_vec3_max_abs(body->position) <= coordinate_max) ||
	    !rb_vec3_finite(body->position)) {
		body_mistake(check, id, "'position' must lie within %g m (got %g, %g, %g)",
		             coordinate_max, body->position.x, body->position.y, body->position.z);
		good = false;
	}
	if (good &&
	    !(rb_shape_reach(check->scene->solids, &body->shape) <= coordinate_max &&
	      body->shape.size[0] <= coordinate_max && body->shape.size[1] <= coordinate_max)) {
		body_mistake(check, id, "its size must be at most %g m", coordinate_max);
		good = false;
	}
	if (!(fabs(rb_quat_length(body->orientation) - 1) <= 1e-3)) {
		body_mistake(check, id, "'orientation' must have unit length (got %g)",
		             rb_quat_length(body->orientation));
		good = false;
	}
	if (!rb_vec3_finite(body->velocity) || !rb_vec3_finite(body->angular_velocity))
		body_mistake(check, id, "'velocity' and 'angular_velocity' must be finite");
	else if (!isfinite(4 * rb_vec3_dot(body->velocity, body->velocity)) ||
	         !isfinite(4 * rb_vec3_dot(body->angular_velocity, body->angular_velocity)))
		body_mistake(check, id,
		             "'velocity' %g m/s or 'angular_velocity' %g rad/s is too fast (wanted "
		             "speeds whose squares a double holds)",
		             largest_of(body->velocity), largest_of(body->angular_velocity));
	if (!rb_vec3_finite(body->center_of_mass))
		body_mistake(check, id, "'center_of_mass' must be finite");
	return good;
}

/* Entries of the body's list of forces. */
static void check_forces(struct check *check, int id)
{
	const struct rb_body_def *body = &check->scene->bodies[id];

	for (int i = 0; i < body->force_count; i++) {
		const struct rb_force_def *force = &check->scene->forces[body->force_first + i];

		if (!rb_vec3_finite(force->vector) || !rb_vec3_finite(force->torque) ||
		    !isfinite(force->start_s) || isnan(force->duration_s) ||
		    (!isnan(force->point.x) && !rb_vec3_finite(force->point)))
			body_mistake(check, id,
			             "'forces' entry %d must have a finite vector, torque, point "
			             "and start",
			             i + 1);
	}
}

/* True for the kinds whose contacts every method has. */
static bool has_contacts(const struct rb_shape *shape)
{
	return !rb_shape_has_parts(shape->kind);
}

/* Some methods know contacts of spheres only; false: a mistake was noted. */
static bool check_contacts(struct check *check, int id)
{
	const struct rb_scene *scene = check->scene;
	const struct rb_body_def *body = &scene->bodies[id];

	if (!rb_methods[scene->world.method]->round_only || has_contacts(&body->shape) ||
	    rb_body_collides(body) == 0)
		return true;
	for (int i = 0; i < scene->body_count; i++) {
		if (i == id || !rb_bodies_can_touch(body, &scene->bodies[i]))
			continue;
		body_mistake(
			check, id,
			"the %s method has no contacts of %s (use 'located' or 'auto', or let it "
			"collide with nothing: collides_with = {})",
			rb_methods[scene->world.method]->name, rb_shape_type(&body->shape)->plural);
		return false;
	}
	return true;
}

/* Checks every body; returns true if all shapes and poses can be used. */
static bool check_bodies(struct check *check)
{
	const struct rb_scene *scene = check->scene;
	bool good = true;

	for (int i = 0; i < scene->body_count; i++) {
		const struct rb_body_def *body = &scene->bodies[i];
		const bool shaped = check_shape(check, i);

		good = check_contacts(check, i) && shaped && good;
		check_forces(check, i);
		check_attraction(check, i);
		if (rb_body_is_free(body) && rb_shape_is_flat(&body->shape)) {
			body_mistake(
				check, i,
				"a plane has no mass: it is static, or 'motion' says how it moves");
			good = false;
		} else if (rb_body_is_free(body) && shaped) {
			check_mass(check, i);
		} else if (rb_body_is_driven(body) &&
		           (body->is_static || body->shape.kind == RB_SHAPE_TERRAIN)) {
			body_mistake(check, i, "'motion' of a static body: it never moves");
		}
	}
	return good;
}

/*
 * An impulse is about the mass of the lighter body times their speed: one that is no normal double
 * has lost digits, or is zero, which stops nothing.
 */
static void check_momenta(struct check *check)
{
	const struct rb_scene *const scene = check->scene;
	double fastest = 0, least = HUGE_VAL;
	int lightest = -1;

	for (int i = 0; i < scene->body_count; i++) {
		const struct rb_body_def *const body = &scene->bodies[i];

		if (!rb_body_is_free(body))
			continue;
		const double turn = largest_of(body->angular_velocity) *
		                    rb_shape_reach(scene->solids, &body->shape);
		fastest = fmax(fastest, fmax(largest_of(body->velocity), turn));
		if (rb_body_mass(scene, body) < least) {
			least = rb_body_mass(scene, body);
			lightest = i;
		}
	}
	if (lightest >= 0 && fastest > 0 && least * fastest < DBL_MIN && !rb_scene_has_drive(scene))
		body_mistake(check, lightest,
		             "its mass %g kg times the largest speed of the scene, %g m/s, is too "
		             "small for impulses (wanted a product of at least %g)",
		             least, fastest, DBL_MIN);
}

/* Reports a feature that the chosen method does not have. */
static void lacks(struct check *check, const char *what)
{
	world_mistake(check, "world: method '%s' has no %s: use 'located' or 'auto'",
	              rb_methods[check->scene->world.method]->name, what);
}

/* Rejects features that the method would silently leave out. */
static void check_method(struct check *check)
{
	const struct rb_scene *scene = check->scene;
	const rb_features missing = rb_methods[scene->world.method]->lacks;
	bool driven = false;

	for (int i = 0; i < scene->body_count; i++)
		driven = driven || rb_body_is_driven(&scene->bodies[i]);
	for (int place = 0; place < rb_element_kind_count; place++)
		if (scene->elements[place].count > 0 &&
		    (missing & rb_element_kinds[place]->feature))
			lacks(check, rb_element_kinds[place]->plural);
	if (scene->field_count > 0 && (missing & RB_FEATURE_FIELD))
		lacks(check, "fields");
	if (driven && (missing & RB_FEATURE_DRIVEN))
		lacks(check, "driven bodies ('motion')");
	if (scene->joint_count > 0 && (missing & RB_FEATURE_JOINTS))
		lacks(check, "joints");
}

/* Ends and numbers of one force element. */
static void check_element(struct check *check, const struct rb_element_kind *kind, const void *row)
{
	const char *const ends = rb_element_ends_fault(check->scene, kind, row);
	char text[RB_ELEMENT_FAULT_SIZE];
	int line;

	memcpy(&line, (const char *)row + kind->line_at, sizeof line);
	if (ends)
		line_mistake(check, line, "%s: %s", kind->name, ends);
	else if (kind->fault && kind->fault(check->scene, row, text))
		line_mistake(check, line, "%s: %s", kind->name, text);
}

static void check_elements(struct check *check)
{
	for (int place = 0; place < rb_element_kind_count; place++)
		for (int k = 0; k < check->scene->elements[place].count; k++)
			check_element(check, rb_element_kinds[place],
			              rb_scene_element(check->scene, rb_element_kinds[place], k));
}

static void check_joints(struct check *check)
{
	char text[RB_JOINT_FAULT_SIZE], label[96];

	for (int k = 0; k < check->scene->joint_count; k++)
		if (rb_joint_fault(check->scene, &check->scene->joints[k], text))
			line_mistake(check, check->scene->joints[k].line, "joint: %s: %s",
			             rb_joint_label(check->scene, k, label), text);
}

/* Id of the last earlier body with the name of items[i], among items of the same hash; -1: none. */
static int same_name(const struct rb_scene *scene, const struct rb_sort_item *items, size_t i)
{
	const char *name = scene->bodies[items[i].value].name;

	for (size_t j = i; j-- > 0 && items[j].key == items[i].key;)
		if (strcmp(scene->bodies[items[j].value].name, name) == 0)
			return (int)items[j].value;
	return -1;
}

/* Names of bodies must differ, since callbacks and cameras refer to them. */
static enum rb_status check_names(struct check *check, struct rb_error *err)
{
	const struct rb_scene *scene = check->scene;
	const size_t max = (size_t)scene->body_count;
	struct rb_sort_item *items = rb_memory_take(2 * max, sizeof *items);
	int *taken = rb_memory_take(max, sizeof *taken); /* id of the other + 1, by id */
	size_t count = 0;

	for (int i = 0; items && taken && i < scene->body_count; i++) {
		const char *name = scene->bodies[i].name;

		if (name)
			items[count++] = (struct rb_sort_item){rb_hash_bytes(name, strlen(name), 0),
			                                       (uint64_t)i};
	}
	if (count > 0)
		rb_sort_by_key(items, items + max, count);
	/*
	 * equal names have equal keys and are adjacent, the earlier body first, since the sort is
	 * stable
	 */
	for (size_t i = 1; i < count; i++)
		taken[items[i].value] = same_name(scene, items, i) + 1;
	for (int i = 0; items && taken && i < scene->body_count; i++)
		if (taken[i] > 0)
			body_mistake(check, i, "'name' is taken already (by body #%d, line %d)",
			             taken[i] - 1, scene->bodies[taken[i] - 1].line);
	const bool failed = !items || !taken;
	rb_memory_free(items);
	rb_memory_free(taken);
	return failed ? RB_FAIL(err, RB_ERR_MEMORY, "out of memory for the names of bodies")
	              : RB_OK;
}

/* Gap, m, of a sphere and a sphere, plane or rectangle at the start, in closed form. */
static double gap_of_sphere(const struct rb_body_def *sphere, const struct rb_body_def *other)
{
	const rb_quat turn = rb_quat_unit(other->orientation);
	rb_vec3 normal;

	switch (other->shape.kind) {
	case RB_SHAPE_PLANE:
		return rb_distance_sphere_plane(sphere->position, sphere->shape.radius,
		                                other->position, rb_plane_normal(turn), &normal);
	case RB_SHAPE_RECTANGLE: {
		const rb_rectangle rectangle = rb_rectangle_of(other->position, turn,
		                                               other->shape.size);

		return rb_distance_sphere_rectangle(sphere->position, sphere->shape.radius,
		                                    &rectangle, &normal, NULL);
	}
	default:
		return rb_distance_sphere_sphere(sphere->position, sphere->shape.radius,
		                                 other->position, other->shape.radius, &normal);
	}
}

/* Gap of two bodies at the start, m, by the same functions that the methods use. */
static double gap_at_start(const struct check *check, int a, int b)
{
	const struct rb_body_def *body_a = &check->scene->bodies[a];
	const struct rb_body_def *body_b = &check->scene->bodies[b];
	const bool spheres_a = body_a->shape.kind == RB_SHAPE_SPHERE;
	const bool spheres_b = body_b->shape.kind == RB_SHAPE_SPHERE;

	if (spheres_a && has_contacts(&body_b->shape))
		return gap_of_sphere(body_a, body_b);
	if (spheres_b && has_contacts(&body_a->shape))
		return gap_of_sphere(body_b, body_a);
	return rb_parts_gap_at_start(check->parts, check->scene, a, b);
}

/* Reports a pair that overlaps by more than the tolerance; the first OVERLAPS_SHOWN by name. */
static void check_overlap(struct check *check, int a, int b, int *found)
{
	const struct rb_scene *scene = check->scene;
	const struct rb_body_def *body_a = &scene->bodies[a], *body_b = &scene->bodies[b];

	if (!rb_bodies_can_touch(body_a, body_b) || rb_scene_joined(scene, a, b))
		return;
	const double gap = gap_at_start(check, a, b);
	if (gap >= -check->sizes.tolerance_m)
		return;
	if (++*found <= OVERLAPS_SHOWN) {
		char other[128];

		title(scene, a, other);
		body_mistake(check, b, "overlaps %s by %.6g m at the start (tolerance %.6g m)",
		             other, -gap, check->sizes.tolerance_m);
	}
}

/* Bounding boxes, moving bodies first; id[] is the body of a box. */
struct start_boxes {
	rb_aabb *box;
	int *id, *planes;
	int moving, count, plane_count; /* driven planes are among the planes */
};

static rb_aabb box_at_start(const struct rb_scene *scene, const struct rb_body_def *body)
{
	/* the bounding sphere of a rectangle suffices: this is only the broad phase */
	const double r = body->shape.kind == RB_SHAPE_RECTANGLE
	                         ? 0.5 * (body->shape.size[0] + body->shape.size[1])
	                         : rb_shape_reach(scene->solids, &body->shape);
	const rb_vec3 h = {r, r, r};

	return (rb_aabb){rb_vec3_sub(body->position, h), rb_vec3_add(body->position, h)};
}

static void fill_boxes(const struct rb_scene *scene, struct start_boxes *boxes)
{
	for (int i = 0; i < scene->body_count; i++) {
		if (scene->bodies[i].is_static || scene->bodies[i].shape.kind == RB_SHAPE_PLANE)
			continue;
		boxes->id[boxes->count] = i;
		boxes->box[boxes->count++] = box_at_start(scene, &scene->bodies[i]);
	}
	boxes->moving = boxes->count;
	for (int i = 0; i < scene->body_count; i++) {
		if (scene->bodies[i].shape.kind == RB_SHAPE_PLANE) {
			boxes->planes[boxes->plane_count++] = i;
			continue;
		}
		if (!scene->bodies[i].is_static)
			continue;
		boxes->id[boxes->count] = i;
		boxes->box[boxes->count++] = box_at_start(scene, &scene->bodies[i]);
	}
}

/* Planes against all moving bodies, all others by the grid. */
static enum rb_status check_boxes(struct check *check, const struct start_boxes *boxes,
                                  struct rb_error *err)
{
	RB_ASSERT(boxes->moving <= boxes->count);
	RB_ASSERT(boxes->count + boxes->plane_count <= check->scene->body_count);

	const struct rb_grid_boxes asked = {
		.moving = boxes->box,
		.fixed = boxes->box + boxes->moving,
		.moving_count = boxes->moving,
		.fixed_count = boxes->count - boxes->moving,
	};
	struct rb_grid grid;
	int found = 0;

	for (int p = 0; p < boxes->plane_count; p++)
		for (int i = 0; i < boxes->moving; i++)
			check_overlap(
				check,
				boxes->planes[p] < boxes->id[i] ? boxes->planes[p] : boxes->id[i],
				boxes->planes[p] < boxes->id[i] ? boxes->id[i] : boxes->planes[p],
				&found);
	rb_grid_init(&grid);
	enum rb_status status = rb_grid_find(&grid, &asked, err);
	if (status == RB_OK)
		status = rb_grid_sort(&grid, boxes->count, err);
	for (size_t i = 0; status == RB_OK && i < grid.pair_count; i++) {
		const int a = boxes->id[grid.pairs[i].a], b = boxes->id[grid.pairs[i].b];

		check_overlap(check, a < b ? a : b, a < b ? b : a, &found);
	}
	rb_grid_release(&grid);
	if (found > OVERLAPS_SHOWN)
		line_mistake(check, 0, "%d more pairs of bodies overlap at the start",
		             found - OVERLAPS_SHOWN);
	return status;
}

/* Searches all pairs that may touch for overlaps at the start. */
static enum rb_status check_overlaps(struct check *check, struct rb_error *err)
{
	const size_t count = (size_t)check->scene->body_count;
	struct start_boxes boxes = {
		.box = rb_memory_take(count, sizeof *boxes.box),
		.id = rb_memory_take(count, sizeof *boxes.id),
		.planes = rb_memory_take(count, sizeof *boxes.planes),
	};
	enum rb_status status = rb_parts_table_create(&check->parts, check->scene, err);

	if (status != RB_OK) {
		/* said already */
	} else if (boxes.box && boxes.id && boxes.planes) {
		fill_boxes(check->scene, &boxes);
		status = check_boxes(check, &boxes, err);
	} else {
		status = RB_FAIL(err, RB_ERR_MEMORY, "out of memory for the boxes of %zu bodies",
		                 count);
	}
	rb_parts_table_destroy(check->parts);
	rb_memory_free(boxes.box);
	rb_memory_free(boxes.id);
	rb_memory_free(boxes.planes);
	return status;
}

enum rb_status rb_scene_check(const struct rb_scene *scene, bool turns,
                              struct rb_mistakes *mistakes, struct rb_error *err)
{
	struct check check = {.scene = scene, .turns = turns, .sizes = rb_scene_sizes(scene)};
	enum rb_status status = RB_OK;

	check.mistakes = mistakes ? mistakes : &check.own;
	const int before = check.mistakes->count;
	check_world(&check);
	if (scene->body_count == 0)
		world_mistake(&check, "the scene has no body (wanted at least one, such as sphere "
		                      "{ radius = 1 })");
	const bool good = check_bodies(&check);
	check_method(&check);
	check_elements(&check);
	check_joints(&check);
	status = check_names(&check, err);
	if (good)
		check_tolerance(&check);
	if (good && check.mistakes->count == before)
		check_momenta(&check);
	/* an unusable tolerance would make every overlap wrong */
	if (status == RB_OK && good && check.sizes.tolerance_m >= 0)
		status = check_overlaps(&check, err);
	if (status == RB_OK && check.mistakes->count > before) {
		const char *first = before < RB_MISTAKES_MAX ? check.mistakes->line[before] : NULL;

		status = RB_FAIL(err, RB_ERR_SCENE, "%s", first ? first : "the scene has mistakes");
	}
	rb_mistakes_release(&check.own);
	return status;
}
