/* SPDX-License-Identifier: MIT */
/*
 * A frame does not say which joints were released, and need not: their points come apart. A slack
 * rope has a shape of its own only in the picture, so a parabola is as good as a catenary: of the
 * same length, and they differ by less than the rope's thickness unless it is very slack.
 */
#include "flow/joint_view.h"

#include <math.h>
#include <string.h>

#include "base/error.h"
#include "force/spring.h"
#include "math/quat.h"
#include "model/center.h"
#include "model/joints.h"
#include "model/shape.h"

/*
 * Parts of the joint's size by which the points of one that holds may differ: between two frames
 * poses are interpolated.
 */
static const double APART = 0.05;
/* Thickness: parts of the smaller body's half width; of the length of a rod or rope, at most. */
static const double PIN_WIDTHS = 0.3, BALL_WIDTHS = 1.1, ROD_WIDTHS = 0.2, ROD_LENGTHS = 0.02;

static const double grey[3] = {0.62, 0.64, 0.67}, brown[3] = {0.62, 0.47, 0.28};

/* The pose of a body, by index, without velocities. */
static struct rb_pose pose_of(const struct rb_model *model, const struct rb_frame *frame, int index)
{
	struct rb_pose pose = {.origin = model->position[index],
	                       .orientation = model->orientation[index]};

	if (index < model->body_count) {
		if (frame->position)
			pose.origin = rb_vec3_from(frame->position + 3 * (size_t)index);
		if (frame->orientation)
			pose.orientation = rb_quat_from(frame->orientation + 4 * (size_t)index);
	}
	pose.position = index < model->body_count
	                        ? rb_model_center(model, index, pose.origin, pose.orientation)
	                        : pose.origin;
	return pose;
}

bool rb_spring_ends(const struct rb_model *model, const struct rb_frame *frame, int number,
                    rb_vec3 end[2])
{
	const struct rb_spring_def *spring = rb_scene_spring(model->scene, number);
	const int id[2] = {spring->a, spring->b};
	const rb_vec3 at[2] = {spring->at_a, spring->at_b};

	for (int k = 0; k < 2; k++) {
		const struct rb_pose pose = pose_of(model, frame, model->index_of[id[k]]);
		end[k] = isnan(at[k].x) ? rb_model_center(model, model->index_of[id[k]],
		                                          pose.origin, pose.orientation)
		                        : rb_vec3_add(pose.origin,
		                                      rb_quat_rotate(pose.orientation, at[k]));
	}
	return spring->visible &&
	       (model->scene->bodies[id[0]].visible || model->scene->bodies[id[1]].visible);
}

double rb_spring_radius(const struct rb_model *model, int number, double size_m)
{
	const struct rb_spring_def *spring = rb_scene_spring(model->scene, number);
	const int id[2] = {spring->a, spring->b};
	double width = 0.2 * size_m;

	for (int k = 0; k < 2; k++) {
		const double reach = rb_model_reach(model, model->index_of[id[k]]);
		if (reach > 0)
			width = fmin(width, 0.4 * reach);
	}
	if (spring->radius_m > 0)
		return spring->radius_m;
	return spring->rest_length_m > 0 ? fmin(width, 0.08 * spring->rest_length_m) : width;
}

rb_vec3 rb_coil_point(int k)
{
	static const double lead = 0.1; /* share of the length of either end */
	const double share = (double)(k - 1) / (RB_COIL_POINTS - 3);
	const double angle = 2 * acos(-1) * RB_COIL_TURNS * share;

	RB_ASSERT(k >= 0 && k < RB_COIL_POINTS);
	if (k == 0 || k == RB_COIL_POINTS - 1)
		return (rb_vec3){0, 0, k == 0 ? 0 : 1};
	return (rb_vec3){cos(angle), sin(angle), lead + (1 - 2 * lead) * share};
}

bool rb_joint_place(const struct rb_model *model, const struct rb_frame *frame, int number,
                    struct rb_joint_place *place)
{
	const rb_vec3 z = {0, 0, 1};

	RB_ASSERT(model->joints && number >= 0 && number < model->joints->count);
	const struct rb_joint *joint = &model->joints->joint[number];
	if (!model->scene->joints[joint->def].visible)
		return false;
	const struct rb_pose a = pose_of(model, frame, joint->a);
	const struct rb_pose b = joint->b >= 0 ? pose_of(model, frame, joint->b)
	                                       : rb_linkage_world();
	place->a = rb_linkage_point_a(&joint->link, &a);
	place->b = rb_linkage_point_b(&joint->link, &b);
	place->axis_a = rb_linkage_axis(&joint->link, &a);
	place->axis_b = rb_quat_rotate(rb_quat_multiply(b.orientation, joint->link.frame_b), z);
	/* else it was released */
	return rb_linkage_gap(&joint->link, &a, &b) <= APART * joint->size;
}

static bool is_thick(const struct rb_shape *shape)
{
	return shape->kind != RB_SHAPE_PLANE && shape->kind != RB_SHAPE_RECTANGLE;
}

/* m: of the smaller of its bodies that move; 0: neither has a width. */
static double half_width(const struct rb_model *model, const struct rb_joint *joint)
{
	const int end[2] = {joint->a, joint->b};
	double width = (double)INFINITY;

	for (int e = 0; e < 2; e++)
		if (end[e] >= 0 && end[e] < model->body_count && is_thick(&model->shape[end[e]]))
			width = fmin(width, rb_shape_half_width(model->scene->solids,
			                                        &model->shape[end[e]]));
	return isfinite(width) ? width : 0;
}

static enum rb_joint_form form_of(const struct rb_model *model, const struct rb_joint *joint)
{
	return rb_joint_type(model->scene->joints[joint->def].kind)->form;
}

double rb_joint_radius(const struct rb_model *model, int number)
{
	RB_ASSERT(model->joints && number >= 0 && number < model->joints->count);
	const struct rb_joint *joint = &model->joints->joint[number];
	const double given = model->scene->joints[joint->def].radius_m;
	const double width = half_width(model, joint);

	if (!isnan(given))
		return given;
	switch (form_of(model, joint)) {
	case RB_JOINT_BAR:
	case RB_JOINT_CORD: {
		const double most = ROD_LENGTHS * joint->link.length;
		const double wanted = width > 0 ? fmin(ROD_WIDTHS * width, most) : most;
		return form_of(model, joint) == RB_JOINT_CORD ? 0.6 * wanted : wanted;
	}
	case RB_JOINT_KNOB:
		return width > 0 ? BALL_WIDTHS * width : ROD_LENGTHS * joint->size;
	default:
		return width > 0 ? PIN_WIDTHS * width : ROD_LENGTHS * joint->size;
	}
}

/* Points of a parabola that sags by `sag` in the middle; its length as a line of pieces. */
static double hang(const struct rb_joint_place *place, rb_vec3 way, double sag,
                   rb_vec3 point[RB_ROPE_PIECES + 1])
{
	double length = 0;

	for (int k = 0; k <= RB_ROPE_PIECES; k++) {
		const double s = (double)k / RB_ROPE_PIECES;

		point[k] = rb_vec3_add_scaled(
			rb_vec3_add_scaled(place->a, s, rb_vec3_sub(place->b, place->a)),
			4 * s * (1 - s) * sag, way);
		length += k > 0 ? rb_vec3_length(rb_vec3_sub(point[k], point[k - 1])) : 0;
	}
	return length;
}

void rb_joint_rope(const struct rb_joint_place *place, double length, rb_vec3 down,
                   rb_vec3 point[RB_ROPE_PIECES + 1])
{
	const rb_vec3 way = rb_vec3_unit(down, (rb_vec3){0, 0, -1});
	double low = 0, high = length;

	if (hang(place, way, 0, point) >= length)
		return;
	/* the length grows with the sag, and one of half the length would be enough already */
	for (int k = 0; k < 40; k++) {
		const double sag = 0.5 * (low + high);

		*(hang(place, way, sag, point) < length ? &low : &high) = sag;
	}
}

void rb_joint_color(const struct rb_scene *scene, int number, double color[3])
{
	RB_ASSERT(number >= 0 && number < scene->joint_count);
	const struct rb_joint_def *def = &scene->joints[number];
	const bool cord = rb_joint_type(def->kind)->form == RB_JOINT_CORD;
	const double *from = !isnan(def->color[0]) ? def->color : cord ? brown : grey;

	memcpy(color, from, 3 * sizeof *color);
}
