/* SPDX-License-Identifier: MIT */
/*
 * The camera's frame (right, up, back) with the eye at the origin, in doubles: bodies are
 * transformed to it before anything is rounded to single precision, so that scenes far from the
 * world's origin do not shake. Near and far planes follow from the scene; the depth is reversed.
 */
#include "film/view.h"

#include <math.h>

#include "base/error.h"
#include "flow/joint_view.h"
#include "math/quat.h"

/* Sine below which two directions count as one: their cross product has no digits left. */
static const double DEGENERATE_SINE = 1e-9;
/*
 * Depth of a plane seen at a small angle in a parallel view, as a multiple of all else: depths are
 * evenly spaced there, in single precision, and half of the digits are kept for the bodies.
 */
static const double PLANE_DEPTHS = 4096;

rb_pose rb_view_pose(const struct rb_model *model, const struct rb_frame *frame, int id)
{
	const int index = model->index_of[id];
	rb_pose pose = {model->position[index], model->orientation[index]};

	if (index >= model->body_count)
		return pose;
	if (frame->position)
		pose.position = rb_vec3_from(frame->position + 3 * index);
	if (frame->orientation)
		pose.orientation = rb_quat_from(frame->orientation + 4 * index);
	return pose;
}

rb_pose rb_view_part(rb_pose body, const struct rb_solid_part *part)
{
	return (rb_pose){
		rb_vec3_add(body.position, rb_quat_rotate(body.orientation, part->position)),
		rb_quat_multiply(body.orientation, part->orientation)};
}

/* A vector of the camera: fixed, of a body, or of a function. */
static rb_vec3 vector(const struct rb_camera_vector *from, const struct rb_model *model,
                      const struct rb_frame *frame, const rb_vec3 *shot)
{
	if (from->source == RB_CAMERA_BODY)
		return rb_view_pose(model, frame, from->body).position;
	if (from->source == RB_CAMERA_FUNCTION && shot)
		return *shot;
	return from->value;
}

static const char *file_of(const struct rb_model *model, const struct rb_camera_def *camera)
{
	return camera->file ? camera->file : model->scene->file;
}

static const char *label(const struct rb_camera_def *camera)
{
	return camera->name ? camera->name : "unnamed";
}

/* Distance of a point in object coordinates from the surface, m, negative inside. */
static double distance(const struct rb_scene *scene, const struct rb_shape *shape, rb_vec3 p)
{
	switch (shape->kind) {
	case RB_SHAPE_SPHERE:
		return rb_vec3_length(p) - shape->radius;
	case RB_SHAPE_PLANE:
		return p.z;
	case RB_SHAPE_RECTANGLE:
		return rb_vec3_length((rb_vec3){fmax(0, fabs(p.x) - 0.5 * shape->size[0]),
		                                fmax(0, fabs(p.y) - 0.5 * shape->size[1]), p.z});
	default:
		return rb_parts_distance(scene, shape, p);
	}
}

/* Pins and rails of joints reach beyond its points: at most so many of its radii. */
static const double JOINT_RADII = 20;

/* Brings `near` to the nearest joint that is to be seen. */
static void near_joints(struct rb_view *view, const struct rb_model *model,
                        const struct rb_frame *frame)
{
	struct rb_joint_place place;

	for (int k = 0; k < model->scene->joint_count; k++) {
		if (!rb_joint_place(model, frame, k, &place))
			continue;
		const rb_vec3 way = rb_vec3_sub(place.b, place.a),
			      to = rb_vec3_sub(view->eye, place.a);
		const double square = rb_vec3_dot(way, way);
		const double s = square > 0 ? fmin(1, fmax(0, rb_vec3_dot(to, way) / square)) : 0;
		const rb_vec3 foot = rb_vec3_add_scaled(place.a, s, way);
		const double d = rb_vec3_length(rb_vec3_sub(view->eye, foot)) -
		                 rb_joint_radius(model, k);

		if (d > 0 && (view->near == 0 || d < view->near))
			view->near = d;
	}
}

/*
 * Sets `near` to the distance of the nearest visible surface, 0 without any. An eye inside of a
 * body is an error unless commands have moved it there.
 */
static enum rb_status nearest(struct rb_view *view, const struct rb_model *model,
                              const struct rb_camera_def *camera, const struct rb_frame *frame,
                              bool may_enter, struct rb_error *err)
{
	view->near = 0;
	for (int id = 0; id < model->scene->body_count; id++) {
		if (!model->scene->bodies[id].visible)
			continue;
		const rb_pose pose = rb_view_pose(model, frame, id);
		const rb_vec3 away = rb_vec3_sub(view->eye, pose.position);
		const struct rb_shape *shape = &model->shape[model->index_of[id]];
		double d = rb_vec3_length(away) - rb_model_reach(model, model->index_of[id]);
		if (rb_shape_has_parts(shape->kind) && d > 0 && view->near > 0 && d > view->near)
			continue;
		if (shape->kind != RB_SHAPE_SPHERE)
			d = distance(model->scene, shape,
			             rb_quat_rotate_back(pose.orientation, away));
		if (d < 0 && (shape->kind == RB_SHAPE_PLANE || may_enter))
			continue; /* seen from behind, it is not drawn */
		if (d < 0) {
			char text[64];
			return RB_FAIL(err, RB_ERR_SCENE,
			               "%s:%d: camera '%s': is inside body '%s' at t = %.6g s",
			               file_of(model, camera), camera->line, label(camera),
			               rb_scene_body_label(model->scene, id, text), frame->time_s);
		}
		if (d > 0 && isfinite(d) && (view->near == 0 || d < view->near))
			view->near = d;
	}
	near_joints(view, model, frame);
	return RB_OK;
}

/* Eye and axes; RB_ERR_SCENE where they are degenerate. */
static enum rb_status aim(struct rb_view *view, const struct rb_model *model,
                          const struct rb_camera_def *camera, const struct rb_frame *frame,
                          const struct rb_frame_shot *shot, struct rb_error *err)
{
	const bool steered = shot && shot->steered;
	rb_vec3 target = vector(&camera->look_at, model, frame, shot ? &shot->look_at : NULL);
	rb_vec3 up = vector(&camera->up, model, frame, shot ? &shot->up : NULL);

	if (steered) {
		view->eye = shot->position;
		target = shot->look_at;
		up = shot->up;
	} else if (camera->mount >= 0) {
		const rb_pose pose = rb_view_pose(model, frame, camera->mount);
		const rb_vec3 offset = camera->level
		                               ? camera->offset
		                               : rb_quat_rotate(pose.orientation, camera->offset);
		view->eye = rb_vec3_add(pose.position, offset);
		if (!camera->level && camera->up.source == RB_CAMERA_FIXED)
			up = rb_quat_rotate(pose.orientation, up);
	} else {
		view->eye = vector(&camera->position, model, frame, shot ? &shot->position : NULL);
	}
	/* with a body as `up`, up is towards it */
	if (camera->up.source == RB_CAMERA_BODY && !steered)
		up = rb_vec3_sub(up, view->eye);
	const rb_vec3 zero = {0, 0, 0};
	const rb_vec3 back = rb_vec3_unit(rb_vec3_sub(view->eye, target), zero);
	const rb_vec3 across = rb_vec3_cross(rb_vec3_unit(up, zero), back);
	if (!rb_vec3_finite(view->eye) || !rb_vec3_finite(across))
		return RB_FAIL(err, RB_ERR_SCENE,
		               "%s:%d: camera '%s': its place at t = %.6g s is not finite",
		               file_of(model, camera), camera->line, label(camera), frame->time_s);
	if (!(rb_vec3_length(back) > 0.5))
		return RB_FAIL(err, RB_ERR_SCENE,
		               "%s:%d: camera '%s': 'look_at' is where it stands at t = %.6g s "
		               "(%.6g, %.6g, %.6g)",
		               file_of(model, camera), camera->line, label(camera), frame->time_s,
		               target.x, target.y, target.z);
	if (!(rb_vec3_length(across) > DEGENERATE_SINE))
		return RB_FAIL(err, RB_ERR_SCENE,
		               "%s:%d: camera '%s': 'up' is along its line of sight at t = %.6g s "
		               "(%.6g, %.6g, %.6g)",
		               file_of(model, camera), camera->line, label(camera), frame->time_s,
		               up.x, up.y, up.z);
	view->back = back;
	view->aim_m = rb_vec3_length(rb_vec3_sub(view->eye, target));
	view->right = rb_vec3_unit(across, across);
	view->up = rb_vec3_cross(view->back, view->right);
	return RB_OK;
}

/* Perspective: slopes of the picture's edges, near and far. */
static void open(struct rb_view *view, const struct rb_camera_def *camera, double least)
{
	if (camera->has_frustum) {
		const double *f = camera->frustum;
		view->left_slope = f[0] / f[4];
		view->right_slope = f[1] / f[4];
		view->bottom_slope = f[2] / f[4];
		view->top_slope = f[3] / f[4];
		view->near = f[4];
		view->far = f[5];
		return;
	}
	view->top_slope = tan(0.5 * camera->fov);
	view->right_slope = view->top_slope * view->width / view->height;
	view->bottom_slope = -view->top_slope;
	view->left_slope = -view->right_slope;
	/* In a corner the distance along the axis is smaller than the distance itself. */
	const double corner = sqrt(1 + view->top_slope * view->top_slope +
	                           view->right_slope * view->right_slope);
	view->far = isnan(camera->far) ? (double)INFINITY : camera->far;
	view->near = camera->near;
	if (isnan(view->near)) {
		view->near = least > 0 ? 0.25 * least / corner : 1;
		if (view->near >= view->far)
			view->near = 0.001 * view->far;
	}
	if (view->near >= view->far)
		view->far = (double)INFINITY;
}

/* Range of depths along the line of sight, m. */
struct span {
	double low, high;
};

/* Extends the range. */
static void reach(struct span *span, double low, double high)
{
	span->low = fmin(span->low, low);
	span->high = fmax(span->high, high);
}

/* Range of what is in the picture: bodies first, then as much of the planes as precision allows. */
static struct span depths(const struct rb_view *view, const struct rb_model *model,
                          const struct rb_frame *frame)
{
	const struct rb_view_edges edges = rb_view_edges(view);
	const double upright = view->top_slope - view->bottom_slope;
	struct span bodies = {(double)INFINITY, -(double)INFINITY};

	for (int i = 0; i < model->body_count + model->static_count; i++) {
		const int id = model->id_of[i];
		const rb_pose pose = rb_view_pose(model, frame, id);
		const rb_vec3 centre = rb_view_point(view, pose.position);
		const double radius = rb_model_reach(model, i);
		if (model->scene->bodies[id].visible && isfinite(radius) &&
		    rb_vec3_finite(centre) && !rb_view_misses(&edges, centre, radius))
			reach(&bodies, -centre.z - radius, -centre.z + radius);
	}
	for (int k = 0; k < model->scene->joint_count; k++) {
		struct rb_joint_place place;

		if (!rb_joint_place(model, frame, k, &place))
			continue;
		const double radius = JOINT_RADII * rb_joint_radius(model, k);
		const double a = -rb_view_point(view, place.a).z,
			     b = -rb_view_point(view, place.b).z;
		reach(&bodies, fmin(a, b) - radius, fmax(a, b) + radius);
	}
	if (!(bodies.low <= bodies.high))
		bodies = (struct span){0, 0};
	reach(&bodies, bodies.low - 0.02 * upright, bodies.high + 0.02 * upright);
	struct span all = bodies;
	const double room = PLANE_DEPTHS * (bodies.high - bodies.low + upright);
	for (int i = 0; i < model->body_count + model->static_count; i++) {
		if (model->shape[i].kind != RB_SHAPE_PLANE)
			continue;
		const rb_pose pose = rb_view_pose(model, frame, model->id_of[i]);
		const rb_vec3 up = rb_quat_rotate(pose.orientation, (rb_vec3){0, 0, 1});
		const rb_vec3 normal = rb_view_direction(view, up);
		const double height = rb_vec3_dot(up, rb_vec3_sub(view->eye, pose.position));
		for (int k = 0; k < 4 && normal.z > 0 && !rb_view_along(normal); k++) {
			const double depth = -rb_view_on_plane(view, normal, height, k).z;
			reach(&all, fmax(depth, bodies.low - room),
			      fmin(depth, bodies.high + room));
		}
	}
	reach(&all, all.low - 0.02 * (all.high - all.low), all.high + 0.02 * (all.high - all.low));
	return all;
}

/* Parallel projection: edges in metres, near and far around what is seen. */
static void open_parallel(struct rb_view *view, const struct rb_model *model,
                          const struct rb_camera_def *camera, const struct rb_frame *frame,
                          double enlarged)
{
	const double *f = camera->frustum;

	view->top_slope = (camera->has_frustum ? f[3] : 0.5 * camera->height) / enlarged;
	view->bottom_slope = camera->has_frustum ? f[2] / enlarged : -view->top_slope;
	view->right_slope = camera->has_frustum ? f[1] / enlarged
	                                        : view->top_slope * view->width / view->height;
	view->left_slope = camera->has_frustum ? f[0] / enlarged : -view->right_slope;
	const struct span seen = depths(view, model, frame);
	const double near = camera->has_frustum ? f[4] : camera->near;
	const double far = camera->has_frustum ? f[5] : camera->far;
	view->near = isnan(near) ? seen.low : near;
	view->far = isnan(far) ? seen.high : far;
	if (view->near >= view->far && isnan(near))
		view->near = view->far - (view->top_slope - view->bottom_slope);
	if (view->near >= view->far)
		view->far = view->near + (view->top_slope - view->bottom_slope);
	/* single precision is best about the eye: it is moved to where the bodies are */
	const double middle = 0.5 * (view->near + view->far);
	view->eye = rb_vec3_add_scaled(view->eye, -middle, view->back);
	view->near -= middle;
	view->far -= middle;
}

enum rb_status rb_view_make(struct rb_view *view, const struct rb_model *model,
                            const struct rb_camera_def *camera, const struct rb_frame *frame,
                            const struct rb_frame_shot *shot, struct rb_error *err)
{
	const bool steered = shot && shot->steered;

	*view = (struct rb_view){.parallel = camera->orthographic,
	                         .width = camera->size_px[0],
	                         .height = camera->size_px[1]};
	enum rb_status status = aim(view, model, camera, frame, shot, err);
	if (status == RB_OK && view->parallel) {
		open_parallel(view, model, camera, frame, steered ? shot->enlarged : 1);
		return RB_OK;
	}
	if (status == RB_OK)
		status = nearest(view, model, camera, frame, steered, err);
	if (status == RB_OK)
		open(view, camera, view->near);
	return status;
}

rb_vec3 rb_view_direction(const struct rb_view *view, rb_vec3 world)
{
	return (rb_vec3){rb_vec3_dot(view->right, world), rb_vec3_dot(view->up, world),
	                 rb_vec3_dot(view->back, world)};
}

rb_vec3 rb_view_point(const struct rb_view *view, rb_vec3 world)
{
	return rb_view_direction(view, rb_vec3_sub(world, view->eye));
}

rb_mat3 rb_view_turn(const struct rb_view *view, rb_quat orientation)
{
	const rb_mat3 body = rb_quat_to_mat3(orientation);
	const rb_mat3 axes = {{{view->right.x, view->right.y, view->right.z},
	                       {view->up.x, view->up.y, view->up.z},
	                       {view->back.x, view->back.y, view->back.z}}};

	return rb_mat3_multiply(&axes, &body);
}

rb_quat rb_view_quat(const struct rb_view *view)
{
	const rb_mat3 axes = {{{view->right.x, view->right.y, view->right.z},
	                       {view->up.x, view->up.y, view->up.z},
	                       {view->back.x, view->back.y, view->back.z}}};

	return rb_quat_from_mat3(&axes);
}

struct rb_view_edges rb_view_edges(const struct rb_view *view)
{
	const rb_vec3 zero = {0, 0, 0};

	if (view->parallel)
		return (struct rb_view_edges){
			.normal = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}},
			.offset = {-view->left_slope, view->right_slope, -view->bottom_slope,
		                   view->top_slope},
			.front = (double)INFINITY,
		};
	return (struct rb_view_edges){
		.normal = {
			rb_vec3_unit((rb_vec3){1, 0, view->left_slope}, zero),
			rb_vec3_unit((rb_vec3){-1, 0, -view->right_slope}, zero),
			rb_vec3_unit((rb_vec3){0, 1, view->bottom_slope}, zero),
			rb_vec3_unit((rb_vec3){0, -1, -view->top_slope}, zero),
		}};
}

rb_vec3 rb_view_way(const struct rb_view *view, rb_vec3 point)
{
	return view->parallel ? (rb_vec3){0, 0, -1} : point;
}

double rb_view_distance(const struct rb_view *view, rb_vec3 point)
{
	return view->parallel ? fmax(0, -point.z - view->near) : rb_vec3_length(point);
}

double rb_view_lean(const struct rb_view *view, rb_vec3 centre, double radius)
{
	return view->parallel ? 0 : radius / rb_vec3_length(centre);
}

rb_vec3 rb_view_on_plane(const struct rb_view *view, rb_vec3 normal, double height, int k)
{
	const double more = 2 * rb_view_pixel_size(view);
	const double x = k == 0 || k == 3 ? view->left_slope - more : view->right_slope + more;
	const double y = k < 2 ? view->bottom_slope - more : view->top_slope + more;

	return (rb_vec3){x, y, -(normal.x * x + normal.y * y + height) / normal.z};
}

bool rb_view_along(rb_vec3 normal)
{
	return fabs(normal.z) < DEGENERATE_SINE;
}

bool rb_view_misses(const struct rb_view_edges *edges, rb_vec3 centre, double radius)
{
	if (centre.z - radius > edges->front)
		return true;
	for (int k = 0; k < 4; k++)
		if (rb_vec3_dot(edges->normal[k], centre) + edges->offset[k] < -radius)
			return true;
	return false;
}

void rb_view_pixel(const struct rb_view *view, rb_vec3 point, double pixel[2])
{
	const double by = view->parallel ? 1 : -point.z, x = point.x / by, y = point.y / by;

	pixel[0] = view->width * (x - view->left_slope) / (view->right_slope - view->left_slope);
	pixel[1] = view->height * (view->top_slope - y) / (view->top_slope - view->bottom_slope);
}

double rb_view_pixel_size(const struct rb_view *view)
{
	return (view->top_slope - view->bottom_slope) / view->height;
}

double rb_view_pixel_at(const struct rb_view *view, double distance)
{
	return rb_view_pixel_size(view) * (view->parallel ? 1 : distance);
}

void rb_view_depth(const struct rb_view *view, double *a, double *b)
{
	if (view->parallel) {
		*a = view->far / (view->far - view->near);
		*b = -1 / (view->far - view->near);
		return;
	}
	if (isinf(view->far)) {
		*a = 0;
		*b = view->near;
		return;
	}
	*a = -view->near / (view->far - view->near);
	*b = view->near * (view->far / (view->far - view->near));
}

void rb_view_projection(const struct rb_view *view, bool from_zero, float matrix[16])
{
	const double across = view->right_slope - view->left_slope;
	const double upright = view->top_slope - view->bottom_slope;
	double a, b;

	rb_view_depth(view, &a, &b);
	if (!from_zero) {
		a = 2 * a - 1;
		b = 2 * b;
	}
	for (int k = 0; k < 16; k++)
		matrix[k] = 0;
	matrix[0] = (float)(2 / across);
	matrix[5] = (float)(-2 / upright);
	if (view->parallel) {
		matrix[10] = (float)-b;
		matrix[12] = (float)(-(view->right_slope + view->left_slope) / across);
		matrix[13] = (float)((view->top_slope + view->bottom_slope) / upright);
		matrix[14] = (float)a;
		matrix[15] = 1;
		return;
	}
	matrix[8] = (float)((view->right_slope + view->left_slope) / across);
	matrix[9] = (float)(-(view->top_slope + view->bottom_slope) / upright);
	matrix[10] = (float)-a;
	matrix[11] = -1;
	matrix[14] = (float)b;
}
