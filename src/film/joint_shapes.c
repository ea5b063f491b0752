/* SPDX-License-Identifier: MIT */
#include "film/joint_shapes.h"

#include <math.h>

#include "base/error.h"
#include "math/quat.h"
#include "model/joints.h"

/* Lengths of pins, of the arms of a cross and of rails without limits: radii of the pin. */
static const double PIN_RADII = 9, ARM_RADII = 8, RAIL_RADII = 40;
/* Of coils, in radii: length at rest, unless limits ask for more; half the width; the wire. */
static const double COIL_RADII = 20, COIL_WIDTH = 2.5, COIL_WIRE = 0.4;
/* Of the way to a limit, what a coil has at least. */
static const double COIL_ROOM = 1.2;
enum { COIL_TURNS = 8 };
/* A ball is a capsule whose segment is so short, of its radius. */
static const double BALL_LENGTH = 1e-3;

static const struct rb_joint *joint_of(const struct rb_model *model, int joint)
{
	RB_ASSERT(model->joints && joint >= 0 && joint < model->joints->count);
	return &model->joints->joint[joint];
}

/* Of the way: hinges are sprung by what is not seen. */
static bool is_spring(const struct rb_joint *joint)
{
	return joint->stiffness > 0;
}

static enum rb_joint_form form_of(const struct rb_model *model, int joint)
{
	return rb_joint_type(model->scene->joints[joint].kind)->form;
}

int rb_joint_piece_count(const struct rb_model *model, int joint)
{
	switch (form_of(model, joint)) {
	case RB_JOINT_UNSEEN:
		return 0;
	case RB_JOINT_CORD:
		return RB_ROPE_PIECES;
	case RB_JOINT_RAIL:
		return is_spring(joint_of(model, joint)) ? RB_COIL_PIECES : 1;
	case RB_JOINT_CROSS:
		return 2;
	default:
		return 1;
	}
}

/* The smallest rotation from z to a unit vector; half a turn, if it comes to that, about x. */
static rb_quat turn_from_z(rb_vec3 to)
{
	if (to.z <= -1 + 1e-12)
		return (rb_quat){0, 1, 0, 0};
	return rb_quat_unit((rb_quat){1 + to.z, -to.y, to.x, 0});
}

/* A capsule whose segment goes from one point to the other. */
static struct rb_joint_piece between(rb_vec3 from, rb_vec3 to, double radius)
{
	const rb_vec3 z = {0, 0, 1}, d = rb_vec3_sub(to, from);

	return (struct rb_joint_piece){.pose = {rb_vec3_scale(0.5, rb_vec3_add(from, to)),
	                                        turn_from_z(rb_vec3_unit(d, z))},
	                               .length = fmax(rb_vec3_length(d), BALL_LENGTH * radius),
	                               .radius = radius};
}

/* A capsule about a point along an axis. */
static struct rb_joint_piece about(rb_vec3 at, rb_vec3 axis, double length, double radius)
{
	return between(rb_vec3_add_scaled(at, -0.5 * length, axis),
	               rb_vec3_add_scaled(at, 0.5 * length, axis), radius);
}

/* The rail of a slider: as far as b's point can get, or so long that it is seen to be one. */
static struct rb_joint_piece rail(const struct rb_joint *joint, const struct rb_joint_place *place,
                                  double radius)
{
	const double low = isfinite(joint->low) ? joint->low : -0.5 * RAIL_RADII * radius;
	const double high = isfinite(joint->high) ? joint->high : 0.5 * RAIL_RADII * radius;

	return between(rb_vec3_add_scaled(place->a, low, place->axis_a),
	               rb_vec3_add_scaled(place->a, high, place->axis_a), 0.5 * radius);
}

/*
 * A helix between b's point and one that is fixed to a, as far from it at rest as the coil is long
 * then, on the side of a's centre of mass; where b is the world, the other way round.
 */
static void coil(const struct rb_joint *joint, const struct rb_joint_place *place, double radius,
                 struct rb_joint_piece piece[RB_COIL_PIECES])
{
	const rb_vec3 z = {0, 0, 1};
	const double low = isfinite(joint->low) ? -joint->low : 0;
	const double high = isfinite(joint->high) ? joint->high : 0;
	const double length = fmax(COIL_RADII * radius, COIL_ROOM * fmax(low, high));
	const bool world = joint->b < 0;
	const bool below = rb_vec3_dot(rb_quat_rotate(joint->link.frame_a, z), joint->link.at_a) >
	                   0;
	const double rest = joint->rest + (below && !world ? -length : length);
	const rb_vec3 to = world ? place->a : place->b;
	const rb_vec3 from = rb_vec3_add_scaled(world ? place->b : place->a, world ? -rest : rest,
	                                        place->axis_a);
	const rb_quat turn = turn_from_z(rb_vec3_unit(rb_vec3_sub(to, from), place->axis_a));
	rb_vec3 last = from;

	for (int k = 0; k <= RB_COIL_PIECES; k++) {
		const double share = (double)k / RB_COIL_PIECES;
		const double angle = 2 * acos(-1) * COIL_TURNS * share;
		const double width = COIL_WIDTH * radius;
		const rb_vec3 across = {width * cos(angle), width * sin(angle), 0};
		const rb_vec3 middle = rb_vec3_add_scaled(from, share, rb_vec3_sub(to, from));
		const rb_vec3 point = rb_vec3_add(middle, rb_quat_rotate(turn, across));

		if (k > 0)
			piece[k - 1] = between(last, point, COIL_WIRE * radius);
		last = point;
	}
}

bool rb_joint_pieces(const struct rb_model *model, const struct rb_frame *frame, int number,
                     struct rb_joint_piece piece[RB_JOINT_PIECES_MAX])
{
	const struct rb_joint *joint = joint_of(model, number);
	const double radius = rb_joint_radius(model, number);
	struct rb_joint_place place;

	if (!rb_joint_place(model, frame, number, &place))
		return false;
	switch (form_of(model, number)) {
	case RB_JOINT_UNSEEN:
		return false;
	case RB_JOINT_BAR:
		piece[0] = between(place.a, place.b, radius);
		break;
	case RB_JOINT_CORD: {
		rb_vec3 point[RB_ROPE_PIECES + 1];

		rb_joint_rope(&place, joint->link.length, model->scene->world.gravity, point);
		for (int k = 0; k < RB_ROPE_PIECES; k++)
			piece[k] = between(point[k], point[k + 1], radius);
		break;
	}
	case RB_JOINT_KNOB:
		piece[0] = about(place.a, place.axis_a, 0, radius);
		break;
	case RB_JOINT_CROSS:
		piece[0] = about(place.a, place.axis_a, ARM_RADII * radius, radius);
		piece[1] = about(place.a, place.axis_b, ARM_RADII * radius, radius);
		break;
	case RB_JOINT_RAIL:
		if (is_spring(joint))
			coil(joint, &place, radius, piece);
		else
			piece[0] = rail(joint, &place, radius);
		break;
	default:
		piece[0] = about(place.a, place.axis_a, PIN_RADII * radius, radius);
	}
	return true;
}
