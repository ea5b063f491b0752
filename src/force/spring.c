/* SPDX-License-Identifier: MIT */
/*
 * A spring and damper in parallel (Kelvin-Voigt) between two points: tension T = k (l - l0) + c
 * dl/dt along the line between them. The direction is undefined at length zero, where no force is
 * exerted; a rest length above zero with coincident ends is rejected at the start. Energy k (l -
 * l0)^2 / 2 and dissipation c (dl/dt)^2 enter the energies and the ledger.
 */
#include "force/spring.h"

#include <math.h>
#include <stdio.h>

#include "base/error.h"
#include "math/quat.h"

#define AT(member) offsetof(struct rb_spring_def, member)

static const struct rb_row keys[] = {
	{"a", RB_ROW_BODY, 0, 0, AT(a), NULL, "required", "", "the body at one end, or its name"},
	{"b", RB_ROW_BODY, 0, 0, AT(b), NULL, "required", "",
         "the body at the other end, or its name"},
	{"stiffness", RB_ROW_NUMBER, RB_RANGE_NOT_NEGATIVE, 0, AT(stiffness), NULL, "required",
         "N/m", "force per metre of extension; a shortened spring pushes"},
	{"damping", RB_ROW_NUMBER, RB_RANGE_NOT_NEGATIVE, 0, AT(damping), NULL, "0", "N s/m",
         "force per speed of extension, against it"},
	{"rest_length", RB_ROW_NUMBER, RB_RANGE_NOT_NEGATIVE, 0, AT(rest_length_m), NULL,
         "its length at the start", "m", "length without a force"},
	{"at_a", RB_ROW_VECTOR, 0, 0, AT(at_a), NULL, "the centre of mass", "m",
         "where it is fixed to a, in object coordinates"},
	{"at_b", RB_ROW_VECTOR, 0, 0, AT(at_b), NULL, "the centre of mass", "m",
         "where it is fixed to b, in object coordinates"},
	{"visible", RB_ROW_BOOLEAN, 0, 0, AT(visible), NULL, "true", "",
         "drawn by cameras, as a coil, if one of its bodies is visible"},
	{"radius", RB_ROW_NUMBER, RB_RANGE_POSITIVE, 0, AT(radius_m), NULL,
         "from the sizes of its bodies", "m", "of the coil"},
	{"color", RB_ROW_COLOR, 0, 0, AT(color), NULL, "dark grey", "", "of the coil"},
};

static const struct rb_spring_def defaults = {
	.a = -1,
	.b = -1,
	.at_a = {(double)NAN, 0, 0},
	.at_b = {(double)NAN, 0, 0},
	.rest_length_m = (double)NAN,
	.visible = true,
	.radius_m = (double)NAN,
	.color = {(double)NAN, 0, 0},
};

static void ends(const void *row, int id[2])
{
	const struct rb_spring_def *spring = row;

	id[0] = spring->a;
	id[1] = spring->b;
}

/* One end at the start, world axes, m. */
static rb_vec3 start_of(const struct rb_body_def *body, rb_vec3 at)
{
	const rb_vec3 local = isnan(at.x) ? body->center_of_mass : at;

	return rb_vec3_add(body->position, rb_quat_rotate(rb_quat_unit(body->orientation), local));
}

static rb_vec3 span_at_start(const struct rb_scene *scene, const struct rb_spring_def *spring)
{
	return rb_vec3_sub(start_of(&scene->bodies[spring->b], spring->at_b),
	                   start_of(&scene->bodies[spring->a], spring->at_a));
}

static bool fault(const struct rb_scene *scene, const void *row, char text[RB_ELEMENT_FAULT_SIZE])
{
	const struct rb_spring_def *spring = row;
	const double rest = spring->rest_length_m;

	if (!(spring->stiffness >= 0 && isfinite(spring->stiffness)) ||
	    !(spring->damping >= 0 && isfinite(spring->damping)) ||
	    !(isnan(rest) || (rest >= 0 && isfinite(rest)))) {
		snprintf(text, RB_ELEMENT_FAULT_SIZE,
		         "'stiffness', 'damping' and 'rest_length' must be finite and 0 or more "
		         "(got %g, "
		         "%g and %g)",
		         spring->stiffness, spring->damping, rest);
		return true;
	}
	if (!(rest > 0) || rb_vec3_max_abs(span_at_start(scene, spring)) > 0)
		return false;
	snprintf(text, RB_ELEMENT_FAULT_SIZE,
	         "its ends are at one point at the start, so that its 'rest_length' %g m has no "
	         "direction (wanted 0, or ends apart)",
	         rest);
	return true;
}

static void seal(const struct rb_scene *scene, void *row)
{
	struct rb_spring_def *spring = row;

	if (isnan(spring->rest_length_m))
		spring->rest_length_m = rb_vec3_length(span_at_start(scene, spring));
}

/* True if the spring is attached off the body's centre of mass. */
static bool turns(const struct rb_scene *scene, const void *row, int id)
{
	const struct rb_spring_def *spring = row;
	const rb_vec3 at = spring->a == id ? spring->at_a : spring->at_b;

	return !isnan(at.x) &&
	       rb_vec3_max_abs(rb_vec3_sub(at, scene->bodies[id].center_of_mass)) > 0;
}

/* State of a spring at one moment. */
struct stretch {
	rb_vec3 arm_a, arm_b; /* m, from centres of mass */
	rb_vec3 along;        /* unit, from a to b */
	double length;        /* m; 0: it has no direction */
	double rate;          /* m/s, of the length */
};

/*
 * Length, direction and rate from the poses of the query; the difference of positions is formed by
 * rb_pose_between, which keeps digits far from the origin.
 */
static struct stretch stretch_at(const struct rb_element_query *query,
                                 const struct rb_spring_def *spring)
{
	RB_ASSERT_COSTLY(spring->rest_length_m >= 0); /* sealed */

	const struct rb_model *model = query->model;
	const int i = model->index_of[spring->a], j = model->index_of[spring->b];
	const struct rb_pose a = query->pose(query, i), b = query->pose(query, j);
	struct stretch s = {.arm_a = rb_element_arm(model, i, a.orientation, spring->at_a),
	                    .arm_b = rb_element_arm(model, j, b.orientation, spring->at_b)};
	const rb_vec3 d = rb_vec3_add(rb_pose_between(&a, &b), rb_vec3_sub(s.arm_b, s.arm_a));

	s.length = rb_vec3_length(d);
	if (!(s.length > 0))
		return s;
	s.along = rb_vec3_scale(1 / s.length, d);
	const rb_vec3 speed_a = rb_vec3_add(a.velocity, rb_vec3_cross(a.spin, s.arm_a));
	const rb_vec3 speed_b = rb_vec3_add(b.velocity, rb_vec3_cross(b.spin, s.arm_b));
	s.rate = rb_vec3_dot(rb_vec3_sub(speed_b, speed_a), s.along);
	return s;
}

static bool act(const struct rb_element_query *query, const void *row, int index,
                const struct rb_pose *pose, struct rb_wrench *out)
{
	const struct rb_spring_def *spring = row;
	const struct stretch s = stretch_at(query, spring);
	const bool is_a = query->model->index_of[spring->a] == index;

	(void)pose;
	RB_ASSERT_COSTLY(is_a || query->model->index_of[spring->b] == index);
	if (!(s.length > 0))
		return false;
	const double tension = spring->stiffness * (s.length - spring->rest_length_m) +
	                       spring->damping * s.rate;
	const rb_vec3 on_a = rb_vec3_scale(tension, s.along);

	out->force = is_a ? on_a : rb_vec3_neg(on_a);
	out->torque = rb_vec3_cross(is_a ? s.arm_a : s.arm_b, out->force);
	return true;
}

static double energy(const struct rb_element_query *query, const void *row)
{
	const struct rb_spring_def *spring = row;
	const double stretch = stretch_at(query, spring).length - spring->rest_length_m;

	return 0.5 * spring->stiffness * stretch * stretch;
}

static double dissipation(const struct rb_element_query *query, const void *row)
{
	const struct rb_spring_def *spring = row;
	const double rate = stretch_at(query, spring).rate;

	return spring->damping * rate * rate;
}

const struct rb_element_kind rb_force_spring = {
	.name = "spring",
	.plural = "springs",
	.feature = RB_FEATURE_SPRINGS,
	.row_size = sizeof(struct rb_spring_def),
	.line_at = AT(line),
	.defaults = &defaults,
	.keys = {"spring", keys, sizeof keys / sizeof keys[0], NULL},
	.ends = ends,
	.fault = fault,
	.seal = seal,
	.turns = turns,
	.act = act,
	.energy = energy,
	.dissipation = dissipation,
};

struct rb_spring_def rb_spring_def_default(void)
{
	return defaults;
}

enum rb_status rb_scene_add_spring(struct rb_scene *scene, const struct rb_spring_def *def,
                                   struct rb_error *err)
{
	return rb_scene_add_element(scene, &rb_force_spring, def, err);
}
