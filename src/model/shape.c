/* SPDX-License-Identifier: MIT */
/*
 * Dispatch over shape types with a fallback to the solid: types in closed form (sphere, box,
 * capsule, cylinder) have functions in their row, polyhedra and unions the numbers of their solid.
 * Solids hold their inertia for unit mass.
 */
#include "model/shape.h"

#include <math.h>
#include <stdio.h>

#include "base/error.h"
#include "base/memory.h"
#include "math/quat.h"

const char *rb_shape_name(enum rb_shape_kind kind)
{
	return kind >= 0 && kind < RB_SHAPE_KIND_COUNT ? rb_shape_types[kind]->name : "unknown";
}

/* The shape's solid; NULL where its type has none. */
static const struct rb_solid *solid_of(const struct rb_solid *solids, const struct rb_shape *shape)
{
	RB_ASSERT_COSTLY(!rb_shape_reads(shape, RB_SHAPE_READS_SOLID) || shape->solid >= 0);

	return rb_shape_reads(shape, RB_SHAPE_READS_SOLID) ? &solids[shape->solid] : NULL;
}

double rb_shape_volume(const struct rb_solid *solids, const struct rb_shape *shape)
{
	const struct rb_solid *const solid = solid_of(solids, shape);

	if (rb_shape_type(shape)->volume)
		return rb_shape_type(shape)->volume(shape);
	return solid ? solid->weight : 0;
}

rb_vec3 rb_shape_centroid(const struct rb_solid *solids, const struct rb_shape *shape)
{
	const struct rb_solid *const solid = solid_of(solids, shape);

	return solid ? solid->centroid : (rb_vec3){0, 0, 0};
}

static rb_mat3 scaled(double s, const rb_mat3 *a)
{
	rb_mat3 b;

	for (int i = 0; i < 9; i++)
		b.m[i / 3][i % 3] = s * a->m[i / 3][i % 3];
	return b;
}

rb_mat3 rb_shape_inertia(const struct rb_solid *solids, const struct rb_shape *shape, double mass)
{
	const struct rb_solid *const solid = solid_of(solids, shape);

	if (rb_shape_type(shape)->inertia)
		return rb_shape_type(shape)->inertia(shape, mass);
	return solid ? scaled(mass, &solid->inertia) : rb_mat3_diagonal(0, 0, 0);
}

double rb_shape_reach(const struct rb_solid *solids, const struct rb_shape *shape)
{
	const struct rb_solid *const solid = solid_of(solids, shape);

	if (rb_shape_type(shape)->reach)
		return rb_shape_type(shape)->reach(shape);
	return solid ? solid->reach : 0;
}

double rb_shape_half_width(const struct rb_solid *solids, const struct rb_shape *shape)
{
	const struct rb_solid *const solid = solid_of(solids, shape);

	if (rb_shape_type(shape)->half_width)
		return rb_shape_type(shape)->half_width(shape);
	return solid ? solid->half_width : (double)INFINITY;
}

/* ---- cores ---- */

/* Polytope core from the faces of a hull. */
static enum rb_status core_of_solid(rb_core *core, const struct rb_solid *solid,
                                    struct rb_error *err)
{
	struct rb_polytope *polytope = NULL;
	int *counts = rb_memory_take((size_t)solid->face_count, sizeof *counts);

	if (!counts)
		return RB_FAIL(err, RB_ERR_MEMORY, "out of memory for a hull of %d faces",
		               solid->face_count);
	for (int k = 0; k < solid->face_count; k++)
		counts[k] = solid->face_first[k + 1] - solid->face_first[k];
	const rb_polytope_def def = {.vertex_count = solid->vertex_count,
	                             .face_count = solid->face_count,
	                             .vertices = solid->vertices,
	                             .counts = counts,
	                             .loop = solid->loops};
	const enum rb_status status = rb_polytope_create(&polytope, &def, err);
	rb_memory_free(counts);
	if (status == RB_OK)
		*core = rb_core_of_polytope(polytope, 0);
	return status;
}

enum rb_status rb_shape_core(const struct rb_solid *solids, const struct rb_shape *shape,
                             rb_core *core, struct rb_error *err)
{
	RB_ASSERT(rb_shape_type(shape)->form != RB_FORM_UNION);
	if (rb_shape_type(shape)->core)
		return rb_shape_type(shape)->core(shape, core, err);
	RB_ASSERT(rb_shape_reads(shape, RB_SHAPE_READS_SOLID));
	return core_of_solid(core, &solids[shape->solid], err);
}

/* ---- unions ---- */

/* The part's centroid in the union's axes, m. */
static rb_vec3 part_centroid(const struct rb_solid *solids, const struct rb_solid_part *part)
{
	return rb_vec3_add(part->position, rb_quat_rotate(part->orientation,
	                                                  rb_shape_centroid(solids, &part->shape)));
}

/*
 * Adds the part's tensor in the union's axes about the union's centroid (parallel axis theorem);
 * the upper half is mirrored, so that the sum stays exactly symmetric.
 */
static void add_part(rb_mat3 *sum, const struct rb_solid *solids, const struct rb_solid_part *part,
                     double mass, rb_vec3 arm)
{
	const rb_mat3 own = rb_shape_inertia(solids, &part->shape, mass);
	const rb_mat3 turn = rb_quat_to_mat3(part->orientation), back = rb_mat3_transposed(&turn);
	const rb_mat3 half = rb_mat3_multiply(&turn, &own), about = rb_mat3_multiply(&half, &back);
	const double d[3] = {arm.x, arm.y, arm.z};

	for (int i = 0; i < 3; i++)
		for (int j = i; j < 3; j++) {
			const int k = (i + 1) % 3, l = (i + 2) % 3;
			const double far = i == j ? d[k] * d[k] + d[l] * d[l] : -d[i] * d[j];

			sum->m[i][j] += 0.5 * (about.m[i][j] + about.m[j][i]) + mass * far;
			sum->m[j][i] = sum->m[i][j];
		}
}

void rb_shape_measure_union(struct rb_solid *solid, const struct rb_solid *solids)
{
	RB_ASSERT(solid->part_count > 0);

	/* about the first part: a union far from its origin loses nothing */
	const rb_vec3 base = solid->parts[0].position;
	rb_vec3 sum = {0, 0, 0};

	solid->volume = solid->weight = solid->reach = 0;
	solid->inertia = rb_mat3_diagonal(0, 0, 0);
	solid->half_width = HUGE_VAL;
	for (int k = 0; k < solid->part_count; k++) {
		const struct rb_solid_part *part = &solid->parts[k];
		const double volume = rb_shape_volume(solids, &part->shape);

		solid->volume += volume;
		solid->weight += part->share * volume;
		sum = rb_vec3_add_scaled(sum, part->share * volume,
		                         rb_vec3_sub(part_centroid(solids, part), base));
		solid->reach = fmax(solid->reach, rb_vec3_length(part->position) +
		                                          rb_shape_reach(solids, &part->shape));
		solid->half_width = fmin(solid->half_width,
		                         rb_shape_half_width(solids, &part->shape));
	}
	solid->centroid = rb_vec3_add_scaled(base, 1 / solid->weight, sum);
	for (int k = 0; k < solid->part_count; k++) {
		const struct rb_solid_part *part = &solid->parts[k];
		const double mass = part->share * rb_shape_volume(solids, &part->shape) /
		                    solid->weight;

		add_part(&solid->inertia, solids, part, mass,
		         rb_vec3_sub(part_centroid(solids, part), solid->centroid));
	}
}

void rb_shape_text(const struct rb_solid *solids, const struct rb_shape *shape, char out[160])
{
	const struct rb_shape_type *const type = rb_shape_type(shape);
	int used = snprintf(out, 160, "%s", type->name);

	if (type->reads & RB_SHAPE_READS_RADIUS)
		used += snprintf(out + used, 160 - (size_t)used, " %.17g", shape->radius);
	for (int k = 0; k < 3; k++)
		if (type->reads & (unsigned)RB_SHAPE_READS_SIZE_X << k)
			used += snprintf(out + used, 160 - (size_t)used, " %.17g", shape->size[k]);
	if (type->reads == RB_SHAPE_READS_SOLID) {
		const struct rb_solid *const solid = &solids[shape->solid];

		snprintf(out + used, 160 - (size_t)used, " %d",
		         solid->part_count > 0 ? solid->part_count : solid->vertex_count);
	}
}
