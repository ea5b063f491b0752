/* SPDX-License-Identifier: MIT */
/*
 * Painter's algorithm with two kinds of things: grids of lines for flat bodies, drawn first, and
 * discs for all others (their bounding spheres), from the farthest to the nearest. No depth buffer,
 * no textures: enough to see what happens where there is no OpenGL, at a cost that does not disturb
 * a run.
 */
#include "control/sketch.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "flow/joint_view.h"
#include "force/spring.h"
#include "math/quat.h"
#include "math/vec3.h"
#include "model/joints.h"

/* Cells of a grid along each side. */
enum { GRID = 8 };
/*
 * Colours in sRGB. Bodies without a colour get one by their material, from the palette of Okabe and
 * Ito (2008), which colour-blind people can tell apart.
 */
static const uint8_t sky[3] = {24, 26, 32}, lines[3] = {110, 110, 104};
static const uint8_t colors[][3] = {{213, 94, 0},    {0, 114, 178},  {0, 158, 115}, {230, 159, 0},
                                    {204, 121, 167}, {86, 180, 233}, {240, 228, 66}};

struct drawing {
	const struct rb_pixmap *picture;
	const struct rb_model *model;
	const struct rb_stand *stand;
	const struct rb_frame *frame;
	bool parallel;
	double scale; /* pixels for a slope of 1; of an orthographic camera, for 1 m */
};

/* A sphere on its way to the picture. */
struct disc {
	double x, y, radius, distance; /* pixels; m along the line of sight */
	int id;
};

/* A point in the camera's axes, m: to the right, up, forward. */
static rb_vec3 seen(const struct drawing *d, rb_vec3 world)
{
	const rb_vec3 away = rb_vec3_sub(world, d->stand->eye);

	return (rb_vec3){rb_vec3_dot(away, d->stand->right), rb_vec3_dot(away, d->stand->up),
	                 -rb_vec3_dot(away, d->stand->back)};
}

/*
 * Divisor of the perspective for a point that lies `z` m along the line of sight; 1 for an
 * orthographic camera.
 */
static double away(const struct drawing *d, double z)
{
	return d->parallel ? 1 : z;
}

/* Sets a pixel if it is in the picture. The comparisons are written so that NAN is not. */
static void dot(const struct drawing *d, double x, double y, const uint8_t rgb[3])
{
	if (!(x >= 0) || !(y >= 0) || x >= d->picture->width || y >= d->picture->height)
		return;
	const size_t at = (size_t)y * (size_t)d->picture->width + (size_t)x;
	memcpy(d->picture->rgba + 4 * at, rgb, 3);
}

/*
 * Narrows the part [s[0], s[1]] of a line to where one of its coordinates, `at` + s `by`, lies from
 * 0 to `most` (Liang and Barsky, 1984).
 */
static void cut(double at, double by, double most, double s[2])
{
	if (by == 0)
		return; /* wholly inside, or no dot of it is */
	s[0] = fmax(s[0], fmin(-at / by, (most - at) / by));
	s[1] = fmin(s[1], fmax(-at / by, (most - at) / by));
}

/*
 * Draws a line between two points of the world. It is clipped before the division: at a plane just
 * before the eye, and to the picture, because a line that passes by the eye is many pictures long.
 */
static void line(const struct drawing *d, rb_vec3 a, rb_vec3 b)
{
	const double nearest = 1e-3 * rb_vec3_length(rb_vec3_sub(d->stand->eye, d->stand->target));
	rb_vec3 p = seen(d, a), q = seen(d, b);

	if (!d->parallel && p.z < nearest && q.z < nearest)
		return;
	if (!d->parallel && p.z < nearest)
		p = rb_vec3_add_scaled(p, (nearest - p.z) / (q.z - p.z), rb_vec3_sub(q, p));
	if (!d->parallel && q.z < nearest)
		q = rb_vec3_add_scaled(q, (nearest - q.z) / (p.z - q.z), rb_vec3_sub(p, q));
	const double by_p = away(d, p.z), by_q = away(d, q.z);
	const double x = 0.5 * d->picture->width + d->scale * p.x / by_p;
	const double y = 0.5 * d->picture->height - d->scale * p.y / by_p;
	const double dx = d->scale * (q.x / by_q - p.x / by_p);
	const double dy = -d->scale * (q.y / by_q - p.y / by_p);
	double part[2] = {0, 1};
	cut(x, dx, d->picture->width, part);
	cut(y, dy, d->picture->height, part);
	if (!(part[0] <= part[1]))
		return;
	const double length = fmax(fabs(dx), fabs(dy)) * (part[1] - part[0]);
	const int steps = (int)ceil(length) + 1;
	for (int i = 0; i <= steps; i++) {
		const double s = part[0] + (part[1] - part[0]) * i / steps;
		dot(d, x + s * dx, y + s * dy, lines);
	}
}

static bool is_flat(const struct rb_shape *shape)
{
	return shape->kind == RB_SHAPE_PLANE || shape->kind == RB_SHAPE_RECTANGLE;
}

/*
 * Draws a grid for body `index`: of a rectangle its own, of an infinite plane a part around what
 * the camera looks at.
 */
static void plane(const struct drawing *d, int index)
{
	const struct rb_shape *const shape = &d->model->shape[index];
	const bool moves = index < d->model->body_count;
	const int id = d->model->id_of[index];
	const rb_quat q = moves && d->frame->orientation
	                          ? rb_quat_from(d->frame->orientation + 4 * index)
	                          : d->model->orientation[index];
	rb_vec3 middle = rb_steer_body(d->model, d->frame, id);
	const rb_vec3 normal = rb_quat_rotate(q, (rb_vec3){0, 0, 1});
	double half[2] = {0.5 * shape->size[0], 0.5 * shape->size[1]};

	RB_ASSERT(index >= 0 && index < d->model->body_count + d->model->static_count);
	if (shape->kind == RB_SHAPE_PLANE) {
		const rb_vec3 away = rb_vec3_sub(d->stand->target, middle);
		middle = rb_vec3_add_scaled(d->stand->target, -rb_vec3_dot(away, normal), normal);
		half[0] = half[1] = rb_vec3_length(rb_vec3_sub(d->stand->eye, d->stand->target));
	}
	const rb_vec3 u = rb_quat_rotate(q, (rb_vec3){half[0], 0, 0});
	const rb_vec3 v = rb_quat_rotate(q, (rb_vec3){0, half[1], 0});
	for (int i = 0; i <= GRID; i++) {
		const double s = 2.0 * i / GRID - 1;
		const rb_vec3 at = rb_vec3_add_scaled(middle, s, u);
		const rb_vec3 across = rb_vec3_add_scaled(middle, s, v);
		line(d, rb_vec3_sub(at, v), rb_vec3_add(at, v));
		line(d, rb_vec3_sub(across, u), rb_vec3_add(across, u));
	}
}

/*
 * Draws a disc, brighter in the middle, so that discs that overlap can be told apart. At least 0.6
 * pixels: nothing vanishes.
 */
static void fill(const struct drawing *d, const struct disc *disc)
{
	const double r = fmax(disc->radius, 0.6);
	const struct rb_scene *const scene = d->model->scene;
	const struct rb_body_def *const body = &scene->bodies[disc->id];
	const struct rb_material_def *const material = body->material >= 0
	                                                       ? &scene->materials[body->material]
	                                                       : NULL;
	const double *given = !isnan(body->color[0])                   ? body->color
	                      : material && !isnan(material->color[0]) ? material->color
	                                                               : NULL;
	const uint8_t *const own =
		colors[(size_t)abs(body->material) % (sizeof colors / sizeof *colors)];
	const int width = d->picture->width, height = d->picture->height;
	const int left = (int)fmax(floor(disc->x - r), 0), top = (int)fmax(floor(disc->y - r), 0);
	const int right = (int)fmin(ceil(disc->x + r), width - 1);
	const int bottom = (int)fmin(ceil(disc->y + r), height - 1);

	for (int y = top; y <= bottom; y++)
		for (int x = left; x <= right; x++) {
			const double dx = (x + 0.5 - disc->x) / r, dy = (y + 0.5 - disc->y) / r;
			const double light = 1 - 0.55 * (dx * dx + dy * dy);
			uint8_t rgb[3];
			if (dx * dx + dy * dy > 1)
				continue;
			for (int i = 0; i < 3; i++)
				rgb[i] = (uint8_t)(light * (given ? 255 * given[i] : own[i]));
			dot(d, x, y, rgb);
		}
}

/* For qsort; ids make the order total. */
static int farther_first(const void *a, const void *b)
{
	const struct disc *const p = a, *const q = b;

	if (p->distance != q->distance)
		return p->distance < q->distance ? 1 : -1;
	return p->id - q->id;
}

/*
 * Finds the discs of all visible bodies before the eye; `discs` has room for all bodies. How many
 * there are. What is neither flat nor round is the sphere around it.
 */
static int find_discs(const struct drawing *d, struct disc *discs)
{
	int count = 0;

	for (int index = 0; index < d->model->body_count + d->model->static_count; index++) {
		const struct rb_shape *const shape = &d->model->shape[index];
		const int id = d->model->id_of[index];
		const rb_vec3 at = seen(d, rb_steer_body(d->model, d->frame, id));
		/* of what is neither flat nor round, the sphere around it */
		const double radius = rb_model_reach(d->model, index);
		if (is_flat(shape) || !d->model->scene->bodies[id].visible ||
		    (!d->parallel && at.z <= radius))
			continue;
		const double by = away(d, at.z);
		discs[count++] = (struct disc){
			.x = 0.5 * d->picture->width + d->scale * at.x / by,
			.y = 0.5 * d->picture->height - d->scale * at.y / by,
			.radius = d->scale * radius / by,
			.distance = at.z,
			.id = id,
		};
	}
	return count;
}

/* Draws joints as lines: ropes as they hang, others from point to point, or a bit of their axis. */
static void joints(const struct drawing *d)
{
	const struct rb_scene *const scene = d->model->scene;
	rb_vec3 point[RB_ROPE_PIECES + 1];
	struct rb_joint_place place;

	for (int k = 0; k < scene->joint_count; k++) {
		const enum rb_joint_form form = rb_joint_type(scene->joints[k].kind)->form;
		const double radius = 3 * rb_joint_radius(d->model, k);

		if (!rb_joint_place(d->model, d->frame, k, &place))
			continue;
		if (form == RB_JOINT_CORD) {
			rb_joint_rope(&place, d->model->joints->joint[k].link.length,
			              scene->world.gravity, point);
			for (int p = 0; p < RB_ROPE_PIECES; p++)
				line(d, point[p], point[p + 1]);
		} else if (form == RB_JOINT_BAR) {
			line(d, place.a, place.b);
		} else if (form != RB_JOINT_UNSEEN && form != RB_JOINT_KNOB) {
			line(d, rb_vec3_add_scaled(place.a, -radius, place.axis_a),
			     rb_vec3_add_scaled(place.b, radius, place.axis_a));
		}
	}
}

/* Springs as lines. */
static void springs(const struct drawing *d)
{
	const int count = rb_scene_element_count(d->model->scene, &rb_force_spring);
	rb_vec3 end[2];

	for (int k = 0; k < count; k++)
		if (rb_spring_ends(d->model, d->frame, k, end))
			line(d, end[0], end[1]);
}

enum rb_status rb_sketch_draw(const struct rb_pixmap *picture, const struct rb_model *model,
                              const struct rb_camera_def *camera, const struct rb_stand *stand,
                              const struct rb_frame *frame, struct rb_error *err)
{
	const double height = camera->has_frustum ? camera->frustum[3] - camera->frustum[2]
	                                          : camera->height;
	const struct drawing d = {
		.picture = picture,
		.model = model,
		.stand = stand,
		.frame = frame,
		.parallel = camera->orthographic,
		.scale = camera->orthographic ? picture->height / height
	                                      : 0.5 * picture->height / tan(0.5 * camera->fov),
	};
	const int total = model->body_count + model->static_count;
	struct disc *const discs = rb_memory_take((size_t)total + 1, sizeof *discs);

	RB_ASSERT(picture->width > 0 && picture->height > 0 && picture->rgba);
	if (!discs)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot draw: out of memory");
	for (int i = 0; i < picture->width * picture->height; i++)
		memcpy(picture->rgba + 4 * (size_t)i,
		       (const uint8_t[4]){sky[0], sky[1], sky[2], 255}, 4);
	for (int i = 0; i < total; i++)
		if (is_flat(&model->shape[i]) && model->scene->bodies[model->id_of[i]].visible)
			plane(&d, i);
	joints(&d);
	springs(&d);
	const int count = find_discs(&d, discs);
	qsort(discs, (size_t)count, sizeof *discs, farther_first);
	for (int i = 0; i < count; i++)
		fill(&d, &discs[i]);
	rb_memory_free(discs);
	return RB_OK;
}
