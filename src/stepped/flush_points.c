/* SPDX-License-Identifier: MIT */
#include "stepped/flush_points.h"

#include <float.h>

#include "geom/patch.h"
#include "model/parts.h"

/* As in geom/boxes: a normal that equals a face's, to rounding, has no component across. */
static const double parallel = 16 * DBL_EPSILON;
/* Largest distance of a point from the line along which a straight side touches, in radii. */
static const double beside_share = 1e-3;

static bool are_parallel(rb_vec3 m, rb_vec3 n)
{
	return rb_vec3_dot(m, n) > 0 && rb_vec3_max_abs(rb_vec3_cross(m, n)) <= parallel;
}

int rb_flush_face_along(const rb_placed *part, rb_vec3 normal)
{
	if (part->core->radius > 0)
		return -1;
	if (part->core->kind == RB_CORE_HALF_SPACE)
		return are_parallel(rb_placed_axis(part), normal) ? 0 : -1;
	for (int face = 0; face < rb_core_face_count(part->core); face++)
		if (are_parallel(rb_placed_face_normal(part, face), normal))
			return face;
	return -1;
}

bool rb_flush_is_border(const rb_placed *part, rb_vec3 normal)
{
	return !(part->core->radius > 0) && part->core->kind != RB_CORE_HALF_SPACE &&
	       rb_flush_face_along(part, normal) < 0;
}

/* Whether the plane of a face has a point, to the tolerance. */
static bool is_in_plane(const rb_placed *part, int face, rb_vec3 point, double tolerance)
{
	const rb_vec3 local = rb_placed_local(part, point);

	return part->core->kind == RB_CORE_HALF_SPACE
	               ? fabs(local.z) <= tolerance
	               : fabs(rb_core_over_face(part->core, face, local)) <= tolerance;
}

bool rb_flush_goes_on(const rb_placed *part, rb_vec3 normal, rb_vec3 point, double tolerance)
{
	const int face = rb_flush_face_along(part, normal);
	const rb_vec3 local = rb_placed_local(part, point);

	if (face < 0 || !is_in_plane(part, face, point, tolerance))
		return false;
	if (part->core->kind == RB_CORE_HALF_SPACE)
		return true;
	if (part->core->kind == RB_CORE_CYLINDER)
		return hypot(local.x, local.y) <= part->core->round + tolerance;
	const struct rb_polytope *const polytope = part->core->polytope;
	const rb_polytope_face *const f = &polytope->faces[face];
	for (int i = 0; i < f->count; i++) {
		const rb_vec3 from = polytope->vertices[polytope->loop[f->first + i]];
		const rb_vec3 to =
			polytope->vertices[polytope->loop[f->first + (i + 1) % f->count]];
		const rb_vec3 out = rb_vec3_unit(rb_vec3_cross(rb_vec3_sub(to, from), f->normal),
		                                 (rb_vec3){0, 0, 0});

		if (!(rb_vec3_dot(out, rb_vec3_sub(local, from)) <= tolerance))
			return false;
	}
	return true;
}

rb_placed rb_flush_plane(const rb_placed *part, int face, const rb_core *half_space)
{
	const rb_vec3 z = rb_placed_face_normal(part, face);
	const rb_vec3 x = rb_vec3_unit(
		rb_vec3_cross(fabs(z.x) < 0.5 ? (rb_vec3){1, 0, 0} : (rb_vec3){0, 1, 0}, z),
		(rb_vec3){0, 0, 0});
	const rb_vec3 y = rb_vec3_cross(z, x);
	const rb_vec3 on =
		part->core->kind == RB_CORE_CYLINDER
			? rb_vec3_add_scaled(part->at, part->core->half_height, z)
			: rb_placed_point(
				  part,
				  part->core->polytope->vertices
					  [part->core->polytope->loop
	                                           [part->core->polytope->faces[face].first]]);

	return (rb_placed){half_space, on, {{{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}}}};
}

bool rb_flush_is_corner(const rb_placed *part, uint32_t feature, rb_vec3 at, rb_vec3 direction)
{
	const uint32_t kind = feature >> 24;

	if (kind == RB_PART_MANTLE)
		return (feature & 0xffffff) != 0;
	if (kind != RB_PART_EDGE && kind != RB_PART_FACE && kind != RB_PART_DIAGONAL &&
	    kind != RB_PART_SEVERAL)
		return true;
	return part->core->kind == RB_CORE_POLYTOPE &&
	       rb_placed_corner_at(part, at, direction) >= 0;
}

int rb_flush_hidden_by(const struct rb_flush_point *point, int count, int k, double tolerance)
{
	int found = -1;

	for (int p = 0; p < count; p++) {
		const rb_vec3 normal = point[p].outward;
		const int face = rb_flush_face_along(point[k].part, normal);

		if (point[p].part == point[k].part || face < 0 ||
		    are_parallel(normal, point[k].outward) ||
		    rb_flush_face_along(point[p].part, normal) < 0 ||
		    !is_in_plane(point[k].part, face, point[p].at, tolerance))
			continue;
		if (found < 0 || rb_vec3_dot(normal, point[k].outward) >
		                         rb_vec3_dot(point[found].outward, point[k].outward))
			found = p;
	}
	return found;
}

void rb_flush_rectangle_set(struct rb_flush_rectangle *rectangle, const double size[2], rb_vec3 at,
                            rb_quat turn)
{
	const double x = 0.5 * size[0], y = 0.5 * size[1];
	static const int loop[8] = {0, 1, 2, 3, 3, 2, 1, 0};

	*rectangle = (struct rb_flush_rectangle){
		.vertices = {{-x, -y, 0}, {x, -y, 0}, {x, y, 0}, {-x, y, 0}},
		.faces = {{{0, 0, 1}, 0, 4}, {{0, 0, -1}, 4, 4}},
		.polytope = {.vertex_count = 4, .face_count = 2, .loop_count = 8}};
	for (int k = 0; k < 8; k++)
		rectangle->loop[k] = loop[k];
	rectangle->polytope.vertices = rectangle->vertices;
	rectangle->polytope.faces = rectangle->faces;
	rectangle->polytope.loop = rectangle->loop;
	rectangle->core = (rb_core){
		.kind = RB_CORE_POLYTOPE, .reach = hypot(x, y), .polytope = &rectangle->polytope};
	rectangle->placed = (rb_placed){&rectangle->core, at, rb_quat_to_mat3(turn)};
}

bool rb_flush_terrain_is_real(const struct rb_model *model, int terrain, int j,
                              const rb_manifold_point *at, rb_vec3 normal, const rb_placed *other)
{
	const bool is_round = other->core->radius > 0 ||
	                      (rb_part)(at->key >> 32) >> 24 == RB_PART_MANTLE;
	const bool is_sphere = other->core->kind == RB_CORE_POLYTOPE &&
	                       other->core->polytope->vertex_count == 1;
	/* a wide band includes corners beside the line of a straight side */
	if (is_round && !is_sphere) {
		const rb_vec3 across = rb_vec3_cross(rb_placed_axis(other), normal);
		const double round = other->core->radius + other->core->round;
		if (fabs(rb_vec3_dot(across, rb_vec3_sub(at->on_b, other->at))) >
		    beside_share * round)
			return false;
	}
	const rb_quat turn = model->orientation[terrain];
	const rb_vec3 point = rb_quat_rotate_back(turn,
	                                          rb_vec3_sub(at->on_b, model->position[terrain]));
	const rb_vec3 axis = is_sphere ? (rb_vec3){0, 0, 0}
	                               : rb_quat_rotate_back(turn, rb_placed_axis(other));
	const struct rb_terrain *const facets = rb_model_parts(model, terrain)->terrain;

	/*
	 * of a straight part over a plane only corners are lowest, unless rounding has dropped one
	 */
	if (other->core->kind == RB_CORE_POLYTOPE &&
	    (rb_part)(at->key >> 32) >> 24 != RB_PART_VERTEX &&
	    rb_terrain_goes_on(facets, j, point) &&
	    rb_placed_corner_at(other, at->on_b, normal) < 0)
		return false;
	return rb_terrain_touch_is_real(facets, j, point,
	                                rb_quat_rotate_back(turn, rb_vec3_neg(normal)),
	                                is_round ? &axis : NULL);
}
