/* SPDX-License-Identifier: MIT */
/*
 * Meshes in unit size, shared by all bodies of a kind and scaled in the shader, with texture
 * coordinates. Round ones are polygons of the same area as the circle, so that shading and shadows
 * have the right size at any number of sides.
 */
#include "film/mesh.h"

#include <math.h>

#include "base/error.h"
#include "base/memory.h"
#include "math/vec3.h"

void rb_mesh_release(struct rb_mesh *mesh)
{
	rb_memory_free(mesh->vertices);
	rb_memory_free(mesh->indices);
	*mesh = (struct rb_mesh){0};
}

/* Room for so many more. */
static enum rb_status reserve(struct rb_mesh *mesh, size_t vertices, size_t indices,
                              struct rb_error *err)
{
	if (!rb_memory_reserve(&mesh->vertices, &mesh->vertex_room, mesh->vertex_count + vertices,
	                       sizeof *mesh->vertices) ||
	    !rb_memory_reserve(&mesh->indices, &mesh->index_room, mesh->index_count + indices,
	                       sizeof *mesh->indices))
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot draw a body: out of memory");
	return RB_OK;
}

/* Index of the next vertex. */
static uint32_t next_vertex(const struct rb_mesh *mesh)
{
	return (uint32_t)mesh->vertex_count;
}

/* Appends a vertex; `shift` is how far it moves with a capsule's half length. */
static void corner(struct rb_mesh *mesh, rb_vec3 unit, double shift, rb_vec3 normal)
{
	mesh->vertices[mesh->vertex_count++] = (struct rb_mesh_vertex){
		.unit = {(float)unit.x, (float)unit.y, (float)unit.z, (float)shift},
		.normal = {(float)normal.x, (float)normal.y, (float)normal.z}};
}

/* Texture coordinates of the last corner, and the axes whose cell counts they are multiplied by. */
static void wear(struct rb_mesh *mesh, int axis_u, int axis_v, double u, double v)
{
	RB_ASSERT_COSTLY(mesh->vertex_count > 0);

	struct rb_mesh_vertex *last = &mesh->vertices[mesh->vertex_count - 1];

	last->axis[0] = (float)axis_u;
	last->axis[1] = (float)axis_v;
	last->tex[0] = (float)u;
	last->tex[1] = (float)v;
}

static void triangle(struct rb_mesh *mesh, uint32_t a, uint32_t b, uint32_t c)
{
	uint32_t *to = &mesh->indices[mesh->index_count];

	to[0] = a;
	to[1] = b;
	to[2] = c;
	mesh->index_count += 3;
}

/* ---- flat faces ---- */

/* Index of the largest component. */
static int main_axis(rb_vec3 a)
{
	const double x = fabs(a.x), y = fabs(a.y), z = fabs(a.z);

	return x >= y && x >= z ? 0 : y >= z ? 1 : 2;
}

/* A face as a fan. Pictures are upright on sides; on upper and lower faces their top is along y. */
static void add_face(struct rb_mesh *mesh, const struct rb_solid *solid, int face,
                     const struct rb_part_size *size, bool is_box)
{
	const int *loop = solid->loops + solid->face_first[face];
	const int count = solid->face_first[face + 1] - solid->face_first[face];
	const rb_vec3 n = rb_part_normal(solid, face);
	const rb_vec3 up = fabs(n.z) < 0.9 ? (rb_vec3){0, 0, 1} : (rb_vec3){0, 1, 0};
	const rb_vec3 v = rb_vec3_unit(rb_vec3_reject(up, n), up);
	const rb_vec3 u = rb_vec3_cross(v, n);
	const uint32_t first = next_vertex(mesh);

	for (int k = 0; k < count; k++) {
		rb_vec3 at = solid->vertices[loop[k]];
		if (!is_box)
			at = rb_vec3_scale(1 / size->reach, rb_vec3_sub(at, size->middle));
		corner(mesh, at, 0, n);
		wear(mesh, is_box ? main_axis(u) : 0, is_box ? main_axis(v) : 0,
		     0.5 * rb_vec3_dot(u, at), 0.5 * rb_vec3_dot(v, at));
	}
	RB_ASSERT_COSTLY(mesh->vertex_count <= mesh->vertex_room);
	for (int k = 1; k + 1 < count; k++)
		triangle(mesh, first, first + (uint32_t)k, first + (uint32_t)k + 1);
}

enum rb_status rb_mesh_add_faces(struct rb_mesh *mesh, const struct rb_scene *scene,
                                 const struct rb_shape *shape, struct rb_mesh_range *range,
                                 struct rb_error *err)
{
	const struct rb_solid *solid = rb_part_faces(scene, shape);
	const struct rb_part_size size = rb_part_size(scene, shape);
	const size_t corners = (size_t)solid->face_first[solid->face_count];

	range->first = mesh->index_count;
	const enum rb_status status = reserve(mesh, corners, 3 * corners, err);
	if (status != RB_OK)
		return status;
	for (int f = 0; f < solid->face_count; f++)
		add_face(mesh, solid, f, &size, rb_shape_type(shape)->form == RB_FORM_BOX);
	range->count = (int)(mesh->index_count - range->first);
	return RB_OK;
}

/* ---- round ones ---- */

struct turn {
	int sides;
	double swell; /* of a polygon that has the area of its circle */
};

/* Unit vector at u turns of longitude and a latitude in radians. */
static rb_vec3 direction(double u, double latitude)
{
	const double angle = 2 * acos(-1) * u;

	return (rb_vec3){cos(latitude) * cos(angle), cos(latitude) * sin(angle), sin(latitude)};
}

/* Corner of the polygon with the circle's area. */
static rb_vec3 swollen(const struct turn *turn, rb_vec3 n)
{
	return (rb_vec3){turn->swell * n.x, turn->swell * n.y, n.z};
}

/* Triangles between two rows of corners, the upper first. */
static void add_band(struct rb_mesh *mesh, uint32_t upper, uint32_t lower, int sides)
{
	for (uint32_t i = 0; i < (uint32_t)sides; i++) {
		triangle(mesh, upper + i, lower + i, lower + i + 1);
		triangle(mesh, upper + i, lower + i + 1, upper + i + 1);
	}
}

/* Two half spheres of latitude rows; the middle band is the straight part. */
static void add_capsule(struct rb_mesh *mesh, const struct turn *turn)
{
	const int steps = turn->sides / 4, rows = 2 * (steps + 1);
	const double quarter = acos(0);
	uint32_t before = 0;

	for (int j = 0; j < rows; j++) {
		const bool upper = j <= steps;
		const double latitude = upper ? quarter * (1 - (double)j / steps)
		                              : -quarter * (j - steps - 1) / steps;
		const bool pole = j == 0 || j == rows - 1;
		const uint32_t row = next_vertex(mesh);
		for (int i = 0; i <= turn->sides; i++) {
			const double u = (i + (pole ? 0.5 : 0)) / turn->sides - 0.5;
			const rb_vec3 n = direction(u, latitude);
			corner(mesh, swollen(turn, n), upper ? 1 : -1, n);
			wear(mesh, 0, 1, u, latitude);
		}
		if (j > 0)
			add_band(mesh, before, row, turn->sides);
		before = row;
	}
}

/* Flat end as a fan. */
static void add_cap(struct rb_mesh *mesh, const struct turn *turn, double z)
{
	const rb_vec3 n = {0, 0, z};
	const uint32_t first = next_vertex(mesh);

	for (int i = 0; i < turn->sides; i++) {
		const rb_vec3 at = direction(z * i / turn->sides, 0);
		corner(mesh, rb_vec3_add(swollen(turn, at), n), 0, n);
		wear(mesh, 2, 2, 0.5 * z * at.x, 0.5 * at.y);
	}
	for (uint32_t i = 1; i + 1 < (uint32_t)turn->sides; i++)
		triangle(mesh, first, first + i, first + i + 1);
}

/* Mantle and two ends. */
static void add_cylinder(struct rb_mesh *mesh, const struct turn *turn)
{
	const uint32_t first = next_vertex(mesh);

	for (int j = 1; j >= -1; j -= 2)
		for (int i = 0; i <= turn->sides; i++) {
			const double u = (double)i / turn->sides - 0.5;
			const rb_vec3 n = direction(u, 0);
			corner(mesh, rb_vec3_add(swollen(turn, n), (rb_vec3){0, 0, j}), 0, n);
			wear(mesh, 0, 1, u, 0.5 * j);
		}
	add_band(mesh, first, first + (uint32_t)turn->sides + 1, turn->sides);
	add_cap(mesh, turn, 1);
	add_cap(mesh, turn, -1);
}

enum rb_status rb_mesh_add_round(struct rb_mesh *mesh, enum rb_shape_form form, int sides,
                                 struct rb_mesh_range *range, struct rb_error *err)
{
	RB_ASSERT(sides >= 3);
	const double angle = 2 * acos(-1) / sides;
	const struct turn turn = {sides, sqrt(angle / sin(angle))};
	const size_t rows = form == RB_FORM_CAPSULE ? (size_t)sides / 2 + 2 : 4;
	const size_t corners = rows * ((size_t)sides + 1);

	range->first = mesh->index_count;
	const enum rb_status status = reserve(mesh, corners, 6 * corners, err);
	if (status != RB_OK)
		return status;
	if (form == RB_FORM_CAPSULE)
		add_capsule(mesh, &turn);
	else
		add_cylinder(mesh, &turn);
	range->count = (int)(mesh->index_count - range->first);
	return RB_OK;
}

/* ---- sizes ---- */

/* Cells of a pattern around a circle, across an end and a hull, and at most along a body. */
enum { AROUND = 8, ACROSS_CAP = 4, ACROSS_HULL = 8, ALONG_MAX = 16 };

/* Nearest even number of cells, so that a checkerboard closes. */
static double even(double count)
{
	return fmin(fmax(2 * rint(0.5 * count), 2), ALONG_MAX);
}

/* Cells along each axis, about squares. */
static void count_box(float count[4], const struct rb_shape *shape)
{
	const double *s = shape->size;
	const double most = fmax(s[0], fmax(s[1], s[2])), least = fmin(s[0], fmin(s[1], s[2]));
	const double cell = fmin(fmax(0.5 * least, most / 8), most / 4);

	for (int k = 0; k < 3; k++)
		count[k] = (float)even(s[k] / cell);
}

/* Cells of patterns. */
static void count_squares(float count[4], const struct rb_shape *shape)
{
	const double pi = acos(-1), cell = 2 * pi / AROUND; /* in radii */
	const double length = shape->radius > 0 ? shape->size[2] / shape->radius : 0;

	count[0] = AROUND;
	if (rb_shape_type(shape)->form == RB_FORM_BOX) {
		count_box(count, shape);
	} else if (rb_shape_type(shape)->form == RB_FORM_CYLINDER) {
		count[1] = (float)even(length / cell);
		count[2] = ACROSS_CAP;
	} else if (rb_shape_type(shape)->form == RB_FORM_CAPSULE) {
		const double arc = pi + length, squares = even(arc / cell);
		count[1] = (float)(squares / arc);
		count[3] = (float)(0.5 * length * squares / arc);
	} else {
		count[0] = ACROSS_HULL;
	}
}

/* Repeats of pictures. */
static void count_pictures(float count[4], const struct rb_shape *shape)
{
	count[0] = count[1] = count[2] = 1;
	if (rb_shape_type(shape)->form == RB_FORM_CAPSULE) {
		const double arc = acos(-1) * shape->radius + shape->size[2];
		count[1] = (float)(shape->radius / arc);
		count[3] = (float)(0.5 * shape->size[2] / arc);
	}
}

struct rb_mesh_fit rb_mesh_fit(const struct rb_shape *shape, const struct rb_part_size *size,
                               double least, bool picture)
{
	struct rb_mesh_fit fit = {.shift = 0};
	rb_vec3 scale = size->high;

	if (rb_shape_type(shape)->form == RB_FORM_POLYHEDRON)
		scale = (rb_vec3){size->reach, size->reach, size->reach};
	if (rb_shape_type(shape)->form == RB_FORM_CAPSULE) {
		fit.shift = (float)(0.5 * shape->size[2]);
		scale.z = shape->radius;
	}
	fit.scale[0] = (float)fmax(scale.x, least);
	fit.scale[1] = (float)fmax(scale.y, least);
	fit.scale[2] = (float)fmax(scale.z, least);
	if (picture)
		count_pictures(fit.count, shape);
	else
		count_squares(fit.count, shape);
	return fit;
}
