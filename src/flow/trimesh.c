/* SPDX-License-Identifier: MIT */
/*
 * Every face has corners of its own, so that it can have a normal and a colour of its own. Bodies
 * of revolution are bands between two circles about local z; those at a pole are triangles.
 */
#include "flow/trimesh.h"

#include <math.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "math/quat.h"
#include "math/vec3.h"
#include "model/colour.h"
#include "model/shape.h"

#define PI 3.14159265358979323846

/* Of round shapes: sides, a multiple of six for the sectors of a beach ball; bands to a quarter. */
enum { SIDES = 24, BANDS = 6, CELLS = 16 };

enum pattern { PLAIN, CHECKER, STRIPES, BEACHBALL };

struct paint {
	enum pattern pattern;
	double colour[3];
};

/* Colours of patterns, as those of films: light parts, dark caps, the other squares of planes. */
static const double LIGHT = 0.86, CAP = 0.45, SQUARE = 0.62 * 0.62;

void rb_trimesh_release(struct rb_trimesh *surface)
{
	rb_memory_free(surface->corners);
	rb_memory_free(surface->indices);
	*surface = (struct rb_trimesh){0};
}

/* Makes room for a face of so many corners, and adds its triangles; they are then set. */
static struct rb_trimesh_corner *add_face(struct rb_trimesh *surface, int corners)
{
	const size_t first = surface->corner_count, triangles = (size_t)corners - 2;

	RB_ASSERT(corners >= 3);
	if (first + (size_t)corners > UINT32_MAX ||
	    !rb_memory_reserve(&surface->corners, &surface->corner_room, first + (size_t)corners,
	                       sizeof *surface->corners) ||
	    !rb_memory_reserve(&surface->indices, &surface->index_room,
	                       surface->index_count + 3 * triangles, sizeof *surface->indices))
		return NULL;
	for (size_t k = 0; k < triangles; k++) {
		surface->indices[surface->index_count++] = (uint32_t)first;
		surface->indices[surface->index_count++] = (uint32_t)(first + k + 1);
		surface->indices[surface->index_count++] = (uint32_t)(first + k + 2);
	}
	surface->corner_count += (size_t)corners;
	return surface->corners + first;
}

static void set_corner(struct rb_trimesh_corner *corner, rb_vec3 at, rb_vec3 normal,
                       const double colour[3])
{
	*corner = (struct rb_trimesh_corner){
		{(float)at.x, (float)at.y, (float)at.z},
		{(float)normal.x, (float)normal.y, (float)normal.z},
		{(float)colour[0], (float)colour[1], (float)colour[2]}};
}

/* The pattern that a texture names; a picture has none. */
static struct paint paint_of(const struct rb_scene *scene, const struct rb_body_def *body)
{
	static const char *const names[] = {
		[CHECKER] = "checker", [STRIPES] = "stripes", [BEACHBALL] = "beachball"};
	const char *const texture = rb_colour_texture(scene, body);
	struct paint paint = {.pattern = PLAIN};

	rb_colour_of(scene, body, paint.colour);
	for (int k = CHECKER; texture && k <= BEACHBALL; k++)
		if (strcmp(texture, names[k]) == 0)
			paint.pattern = (enum pattern)k;
	return paint;
}

/* Colour of a sphere in a direction: the same patterns as in films. */
static void skin(const struct paint *paint, rb_vec3 n, double colour[3])
{
	bool light = false;
	double shade = 1;

	if (paint->pattern == CHECKER) {
		light = n.x * n.y * (n.x * n.x - n.y * n.y) * n.z * (n.z * n.z - 0.36) > 0;
	} else if (paint->pattern == STRIPES) {
		const double turn = 1.75 * n.z + 0.25;
		light = fabs(turn - floor(turn) - 0.5) < 0.25;
	} else if (paint->pattern == BEACHBALL) {
		light = n.y * (3 * n.x * n.x - n.y * n.y) < 0;
		if (fabs(n.z) > 0.955) {
			light = n.z < 0;
			shade = CAP;
		}
	}
	for (int k = 0; k < 3; k++)
		colour[k] = light ? LIGHT : shade * paint->colour[k];
}

/* ---- bodies of revolution ---- */

/* A circle about local z, and the normal on it: outwards and along z. */
struct circle {
	double radius, z, normal_out, normal_z;
};

static rb_vec3 on_circle(const struct circle *circle, int side, bool normal)
{
	const double angle = 2 * PI * (side % SIDES) / SIDES;
	const double out = normal ? circle->normal_out : circle->radius;

	return (rb_vec3){out * cos(angle), out * sin(angle), normal ? circle->normal_z : circle->z};
}

/*
 * The band from circle a up to circle b. `skin`: a sphere's pattern, by the direction of the middle
 * of each face; else plain.
 */
static bool add_band(struct rb_trimesh *surface, const struct circle *a, const struct circle *b,
                     const struct paint *paint, bool sphere)
{
	/* corners in turn: of which circle, and how many sides further */
	static const struct {
		bool upper;
		int side;
	} turn[] = {{false, 0}, {false, 1}, {true, 1}, {true, 0}};

	for (int side = 0; side < SIDES; side++) {
		double colour[3];
		memcpy(colour, paint->colour, sizeof colour);
		if (sphere) {
			const double angle = 2 * PI * (side + 0.5) / SIDES;
			const double out = a->radius + b->radius;
			const rb_vec3 middle = rb_vec3_unit(
				rb_vec3_of(out * cos(angle), out * sin(angle), a->z + b->z),
				rb_vec3_of(0, 0, 1));
			skin(paint, middle, colour);
		}
		/* at a pole two corners are one */
		const bool low = a->radius > 0, high = b->radius > 0;
		struct rb_trimesh_corner *corner = add_face(surface,
		                                            2 + low + high - !(low || high));
		if (!corner)
			return false;
		for (int k = 0; k < 4; k++) {
			const struct circle *const circle = turn[k].upper ? b : a;
			if (!(circle->radius > 0) && turn[k].side == (turn[k].upper ? 0 : 1))
				continue;
			set_corner(corner++, on_circle(circle, side + turn[k].side, false),
			           on_circle(circle, side + turn[k].side, true), colour);
		}
	}
	return true;
}

/* A sphere, or the two halves of one `apart` from each other, with the cylinder between them. */
static bool add_capsule(struct rb_trimesh *surface, double radius, double apart,
                        const struct paint *paint)
{
	bool held = true;

	for (int k = -BANDS; k < BANDS && held; k++) {
		struct circle circle[2];
		for (int i = 0; i < 2; i++) {
			const double latitude = 0.5 * PI * (k + i) / BANDS;
			const bool pole = k + i == -BANDS || k + i == BANDS;
			const double out = pole ? 0 : cos(latitude);

			circle[i] = (struct circle){
				radius * out, radius * sin(latitude) + (k < 0 ? -apart : apart) / 2,
				out, sin(latitude)};
		}
		held = add_band(surface, &circle[0], &circle[1], paint, apart == 0);
	}
	if (!held || apart == 0)
		return held;
	return add_band(surface, &(struct circle){radius, -apart / 2, 1, 0},
	                &(struct circle){radius, apart / 2, 1, 0}, paint, false);
}

static bool add_cylinder(struct rb_trimesh *surface, double radius, double height,
                         const struct paint *paint)
{
	const double z = height / 2;

	return add_band(surface, &(struct circle){0, -z, 0, -1},
	                &(struct circle){radius, -z, 0, -1}, paint, false) &&
	       add_band(surface, &(struct circle){radius, -z, 1, 0},
	                &(struct circle){radius, z, 1, 0}, paint, false) &&
	       add_band(surface, &(struct circle){radius, z, 0, 1}, &(struct circle){0, z, 0, 1},
	                paint, false);
}

/* ---- flat faces ---- */

/* A flat face of so many corners, counter-clockwise. */
static bool add_polygon(struct rb_trimesh *surface, const rb_vec3 *at, int count,
                        const double colour[3])
{
	struct rb_trimesh_corner *const corner = add_face(surface, count);
	rb_vec3 normal = {0};

	if (!corner)
		return false;
	/* Newell's: of faces whose corners are coplanar to rounding only */
	for (int k = 0; k < count; k++)
		normal = rb_vec3_add(normal,
		                     rb_vec3_cross(rb_vec3_sub(at[k], at[0]),
		                                   rb_vec3_sub(at[(k + 1) % count], at[0])));
	normal = rb_vec3_unit(normal, rb_vec3_of(0, 0, 1));
	for (int k = 0; k < count; k++)
		set_corner(&corner[k], at[k], normal, colour);
	return true;
}

static bool add_box(struct rb_trimesh *surface, const double size[3], const struct paint *paint)
{
	bool held = true;

	for (int axis = 0; axis < 3 && held; axis++)
		for (int side = -1; side <= 1; side += 2) {
			static const int along[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
			rb_vec3 at[4];
			for (int k = 0; k < 4; k++) {
				/* in turn as seen from outside; on the other side backwards */
				const int *const step = along[side > 0 ? k : 3 - k];
				double x[3];
				x[axis] = side * size[axis] / 2;
				x[(axis + 1) % 3] = step[0] * size[(axis + 1) % 3] / 2;
				x[(axis + 2) % 3] = step[1] * size[(axis + 2) % 3] / 2;
				at[k] = (rb_vec3){x[0], x[1], x[2]};
			}
			held = held && add_polygon(surface, at, 4, paint->colour);
		}
	return held;
}

static bool add_solid(struct rb_trimesh *surface, const struct rb_solid *solid,
                      const struct paint *paint)
{
	bool held = true;

	for (int face = 0; face < solid->face_count && held; face++) {
		const int first = solid->face_first[face];
		const int count = solid->face_first[face + 1] - first;
		rb_vec3 *const at = rb_memory_take((size_t)count, sizeof *at);

		for (int k = 0; at && k < count; k++)
			at[k] = solid->vertices[solid->loops[first + k]];
		held = at && add_polygon(surface, at, count, paint->colour);
		rb_memory_free(at);
	}
	return held;
}

/* A rectangle about a point, in cells of two colours where it has a pattern. */
static bool add_rectangle(struct rb_trimesh *surface, rb_vec3 middle, const double half[2],
                          const struct paint *paint)
{
	const int cells = paint->pattern == PLAIN ? 1 : CELLS;
	const int rows = paint->pattern == STRIPES ? 1 : cells;

	for (int i = 0; i < cells; i++)
		for (int j = 0; j < rows; j++) {
			const double x0 = middle.x + half[0] * (2.0 * i / cells - 1);
			const double x1 = middle.x + half[0] * (2.0 * (i + 1) / cells - 1);
			const double y0 = middle.y + half[1] * (2.0 * j / rows - 1);
			const double y1 = middle.y + half[1] * (2.0 * (j + 1) / rows - 1);
			const double shade = (i + j) % 2 ? SQUARE : 1;
			const double colour[3] = {shade * paint->colour[0],
			                          shade * paint->colour[1],
			                          shade * paint->colour[2]};
			const rb_vec3 at[4] = {{x0, y0, 0}, {x1, y0, 0}, {x1, y1, 0}, {x0, y1, 0}};
			if (!add_polygon(surface, at, 4, colour))
				return false;
		}
	return true;
}

/* ---- all shapes ---- */

/* Moves the corners from `first` on. */
static void move_corners(struct rb_trimesh *surface, size_t first, rb_vec3 position, rb_quat turn)
{
	for (size_t i = first; i < surface->corner_count; i++) {
		struct rb_trimesh_corner *const corner = &surface->corners[i];
		const rb_vec3 at = {(double)corner->position[0], (double)corner->position[1],
		                    (double)corner->position[2]};
		const rb_vec3 normal = {(double)corner->normal[0], (double)corner->normal[1],
		                        (double)corner->normal[2]};
		const double colour[3] = {(double)corner->colour[0], (double)corner->colour[1],
		                          (double)corner->colour[2]};

		set_corner(corner, rb_vec3_add(position, rb_quat_rotate(turn, at)),
		           rb_quat_rotate(turn, normal), colour);
	}
}

/* All but planes and rectangles. */
static bool add_shape(struct rb_trimesh *surface, const struct rb_solid *solids,
                      const struct rb_shape *shape, const struct paint *paint)
{
	switch (rb_shape_type(shape)->form) {
	case RB_FORM_SURFACE:
		return true;
	case RB_FORM_BALL:
		return add_capsule(surface, shape->radius, 0, paint);
	case RB_FORM_BOX:
		return add_box(surface, shape->size, paint);
	case RB_FORM_CAPSULE:
		return add_capsule(surface, shape->radius, shape->size[2], paint);
	case RB_FORM_CYLINDER:
		return add_cylinder(surface, shape->radius, shape->size[2], paint);
	case RB_FORM_POLYHEDRON:
		return add_solid(surface, &solids[shape->solid], paint);
	case RB_FORM_UNION:
		break;
	}
	const struct rb_solid *const solid = &solids[shape->solid];
	for (int k = 0; k < solid->part_count; k++) {
		const struct rb_solid_part *const part = &solid->parts[k];
		const size_t first = surface->corner_count;

		if (!add_shape(surface, solids, &part->shape, paint)) /* a part is no union */
			return false;
		move_corners(surface, first, part->position, part->orientation);
	}
	return true;
}

enum rb_status rb_trimesh_add(struct rb_trimesh *surface, const struct rb_scene *scene,
                              const struct rb_body_def *body, const struct rb_trimesh_patch *patch,
                              struct rb_error *err)
{
	struct paint paint = paint_of(scene, body);
	bool held;

	if (body->shape.kind == RB_SHAPE_PLANE) {
		/* without a texture of its own checkered, so that motion over it shows */
		if (!rb_colour_texture(scene, body))
			paint.pattern = CHECKER;
		held = add_rectangle(surface, (rb_vec3){patch->x, patch->y, 0},
		                     (const double[2]){patch->half, patch->half}, &paint);
	} else if (body->shape.kind == RB_SHAPE_RECTANGLE) {
		held = add_rectangle(
			surface, (rb_vec3){0},
			(const double[2]){body->shape.size[0] / 2, body->shape.size[1] / 2},
			&paint);
	} else {
		held = add_shape(surface, scene->solids, &body->shape, &paint);
	}
	return held ? RB_OK
	            : RB_FAIL(err, RB_ERR_MEMORY,
	                      "cannot make the surface of a body: out of memory");
}

/* ---- what planes are shown of ---- */

/* m: no point of a body is farther from its origin. */
static double reach_of(const struct rb_model *model, int index)
{
	const struct rb_shape *const shape = &model->shape[index];

	return shape->kind == RB_SHAPE_RECTANGLE ? hypot(shape->size[0], shape->size[1]) / 2
	                                         : rb_model_reach(model, index);
}

struct rb_trimesh_box rb_trimesh_box_empty(void)
{
	const double far = (double)INFINITY;

	return (struct rb_trimesh_box){{far, far, far}, {-far, -far, -far}};
}

void rb_trimesh_box_add(struct rb_trimesh_box *box, const struct rb_model *model, int index,
                        rb_vec3 at)
{
	if (model->shape[index].kind == RB_SHAPE_PLANE)
		return;
	const double radius = reach_of(model, index);
	box->low = (rb_vec3){fmin(box->low.x, at.x - radius), fmin(box->low.y, at.y - radius),
	                     fmin(box->low.z, at.z - radius)};
	box->high = (rb_vec3){fmax(box->high.x, at.x + radius), fmax(box->high.y, at.y + radius),
	                      fmax(box->high.z, at.z + radius)};
}

void rb_trimesh_box_finish(struct rb_trimesh_box *box, const struct rb_model *model)
{
	for (int i = model->body_count; i < model->body_count + model->static_count; i++)
		rb_trimesh_box_add(box, model, i, model->position[i]);
	if (!(box->low.x <= box->high.x))
		*box = (struct rb_trimesh_box){{-1, -1, -1}, {1, 1, 1}};
}

struct rb_trimesh_patch rb_trimesh_box_patch(const struct rb_trimesh_box *box,
                                             const struct rb_model *model, int index)
{
	const rb_vec3 middle = rb_vec3_scale(0.5, rb_vec3_add(box->low, box->high));
	const rb_vec3 local = rb_quat_rotate_back(model->orientation[index],
	                                          rb_vec3_sub(middle, model->position[index]));

	return (struct rb_trimesh_patch){local.x, local.y,
	                                 rb_vec3_length(rb_vec3_sub(box->high, box->low))};
}
