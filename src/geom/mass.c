/* SPDX-License-Identifier: MIT */
#include "geom/mass.h"

#include <float.h>

#include "math/quat.h"
#include "math/top.h"

/* Relative; what a tensor that was computed elsewhere and written down may be off by. */
static const double rounding = 1e-12;

static const double pi = 3.14159265358979323846;

double rb_shape_volume(const struct rb_solid *solids, const struct rb_shape *shape)
{
	const double r = shape->radius, *const s = shape->size;

	switch (shape->kind) {
	case RB_SHAPE_SPHERE:
		return 4.0 / 3.0 * pi * r * r * r;
	case RB_SHAPE_BOX:
		return s[0] * s[1] * s[2];
	case RB_SHAPE_CAPSULE:
		return pi * r * r * (s[2] + 4.0 / 3.0 * r);
	case RB_SHAPE_CYLINDER:
		return pi * r * r * s[2];
	case RB_SHAPE_HULL:
	case RB_SHAPE_UNION:
		return solids[shape->solid].weight;
	default:
		return 0;
	}
}

rb_vec3 rb_shape_centroid(const struct rb_solid *solids, const struct rb_shape *shape)
{
	if (shape->kind == RB_SHAPE_HULL || shape->kind == RB_SHAPE_UNION)
		return solids[shape->solid].centroid;
	return (rb_vec3){0, 0, 0};
}

/*
 * Of the parts of a capsule, a cylinder and two half balls whose centroids are 3/8 r beyond its
 * ends.
 */
static rb_mat3 capsule_inertia(double r, double length, double mass)
{
	const double caps = 4.0 / 3.0 * r / (length + 4.0 / 3.0 * r) * mass, middle = mass - caps;
	const double across = middle * (length * length / 12 + 0.25 * r * r) +
	                      caps * (0.4 * r * r + 0.25 * length * length + 0.375 * length * r);

	return rb_mat3_diagonal(across, across, (0.5 * middle + 0.4 * caps) * r * r);
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
	const double r = shape->radius, *const s = shape->size;

	switch (shape->kind) {
	case RB_SHAPE_SPHERE:
		return rb_mat3_diagonal(0.4 * mass * r * r, 0.4 * mass * r * r, 0.4 * mass * r * r);
	case RB_SHAPE_BOX:
		return rb_mat3_diagonal(mass / 12 * (s[1] * s[1] + s[2] * s[2]),
		                        mass / 12 * (s[0] * s[0] + s[2] * s[2]),
		                        mass / 12 * (s[0] * s[0] + s[1] * s[1]));
	case RB_SHAPE_CAPSULE:
		return capsule_inertia(r, s[2], mass);
	case RB_SHAPE_CYLINDER: {
		const double across = mass * (r * r / 4 + s[2] * s[2] / 12);

		return rb_mat3_diagonal(across, across, 0.5 * mass * r * r);
	}
	case RB_SHAPE_HULL:
	case RB_SHAPE_UNION:
		return scaled(mass, &solids[shape->solid].inertia);
	default:
		return rb_mat3_diagonal(0, 0, 0);
	}
}

double rb_shape_reach(const struct rb_solid *solids, const struct rb_shape *shape)
{
	const double *const s = shape->size;

	switch (shape->kind) {
	case RB_SHAPE_SPHERE:
		return shape->radius;
	case RB_SHAPE_BOX:
		return 0.5 * hypot(hypot(s[0], s[1]), s[2]);
	case RB_SHAPE_CAPSULE:
		return shape->radius + 0.5 * s[2];
	case RB_SHAPE_CYLINDER:
		return hypot(shape->radius, 0.5 * s[2]);
	case RB_SHAPE_HULL:
	case RB_SHAPE_UNION:
		return solids[shape->solid].reach;
	default:
		return 0;
	}
}

double rb_shape_half_width(const struct rb_solid *solids, const struct rb_shape *shape)
{
	const double *const s = shape->size;

	switch (shape->kind) {
	case RB_SHAPE_SPHERE:
	case RB_SHAPE_CAPSULE:
		return shape->radius;
	case RB_SHAPE_BOX:
		return 0.5 * fmin(s[0], fmin(s[1], s[2]));
	case RB_SHAPE_CYLINDER:
		return fmin(shape->radius, 0.5 * s[2]);
	case RB_SHAPE_HULL:
	case RB_SHAPE_UNION:
		return solids[shape->solid].half_width;
	default:
		return (double)INFINITY;
	}
}

/* ---- polyhedra ---- */

/*
 * What a body of density 1 has about a point: volume, first and second moments (xx, yy, zz, xy, xz,
 * yz).
 */
struct moments {
	double volume;
	rb_vec3 first;
	double second[6];
};

/*
 * Adds the tetrahedron from the origin to a, b, c. Over a simplex the mean of x_i x_j is (sum of
 * products of corners + product of sums) / 20: from the mean of products of barycentric
 * coordinates, 1/10 and 1/20 (Zienkiewicz and Taylor, The Finite Element Method, volume
 * coordinates).
 */
static void add_tetrahedron(struct moments *m, rb_vec3 a, rb_vec3 b, rb_vec3 c)
{
	const double volume = rb_vec3_dot(a, rb_vec3_cross(b, c)) / 6, v = volume / 20;
	const rb_vec3 s = rb_vec3_add(a, rb_vec3_add(b, c));

	m->volume += volume;
	m->first = rb_vec3_add_scaled(m->first, volume / 4, s);
	m->second[0] += v * (a.x * a.x + b.x * b.x + c.x * c.x + s.x * s.x);
	m->second[1] += v * (a.y * a.y + b.y * b.y + c.y * c.y + s.y * s.y);
	m->second[2] += v * (a.z * a.z + b.z * b.z + c.z * c.z + s.z * s.z);
	m->second[3] += v * (a.x * a.y + b.x * b.y + c.x * c.y + s.x * s.y);
	m->second[4] += v * (a.x * a.z + b.x * b.z + c.x * c.z + s.x * s.z);
	m->second[5] += v * (a.y * a.z + b.y * b.z + c.y * c.z + s.y * s.z);
}

/* About a point within the hull: then no tetrahedron is negative and nothing cancels. */
static struct moments moments_about(const struct rb_solid *solid, rb_vec3 point)
{
	struct moments m = {0};

	for (int f = 0; f < solid->face_count; f++) {
		const int *loop = solid->loops + solid->face_first[f];
		const int count = solid->face_first[f + 1] - solid->face_first[f];
		const rb_vec3 a = rb_vec3_sub(solid->vertices[loop[0]], point);

		for (int k = 2; k < count; k++)
			add_tetrahedron(&m, a, rb_vec3_sub(solid->vertices[loop[k - 1]], point),
			                rb_vec3_sub(solid->vertices[loop[k]], point));
	}
	return m;
}

static rb_vec3 mean_of(const rb_vec3 *points, int count)
{
	rb_vec3 sum = {0, 0, 0};

	/* from the first point, so that a hull far from the origin loses nothing */
	for (int i = 1; i < count; i++)
		sum = rb_vec3_add(sum, rb_vec3_sub(points[i], points[0]));
	return rb_vec3_add_scaled(points[0], 1.0 / count, sum);
}

static double half_width_of(const struct rb_solid *solid)
{
	const rb_quat principal = rb_top_body_of(&solid->inertia).principal;
	rb_vec3 low = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high = rb_vec3_neg(low);

	for (int i = 0; i < solid->vertex_count; i++) {
		const rb_vec3 p = rb_quat_rotate_back(
			principal, rb_vec3_sub(solid->vertices[i], solid->centroid));

		low = (rb_vec3){fmin(low.x, p.x), fmin(low.y, p.y), fmin(low.z, p.z)};
		high = (rb_vec3){fmax(high.x, p.x), fmax(high.y, p.y), fmax(high.z, p.z)};
	}
	return 0.5 * fmin(high.x - low.x, fmin(high.y - low.y, high.z - low.z));
}

static void measure_hull(struct rb_solid *solid)
{
	const rb_vec3 within = mean_of(solid->vertices, solid->vertex_count);
	const struct moments first = moments_about(solid, within);

	solid->volume = solid->weight = first.volume;
	solid->centroid = rb_vec3_add_scaled(within, 1 / first.volume, first.first);
	/*
	 * again, about where it is wanted: no theorem of parallel axes, no difference of large
	 * numbers
	 */
	const struct moments m = moments_about(solid, solid->centroid);
	const double *const s = m.second, v = m.volume;
	solid->inertia = (rb_mat3){{{(s[1] + s[2]) / v, -s[3] / v, -s[4] / v},
	                            {-s[3] / v, (s[0] + s[2]) / v, -s[5] / v},
	                            {-s[4] / v, -s[5] / v, (s[0] + s[1]) / v}}};
	for (int i = 0; i < solid->vertex_count; i++)
		solid->reach = fmax(solid->reach, rb_vec3_length(solid->vertices[i]));
	solid->half_width = half_width_of(solid);
}

/* ---- unions ---- */

static rb_vec3 part_centroid(const struct rb_solid *solids, const struct rb_solid_part *part)
{
	return rb_vec3_add(part->position, rb_quat_rotate(part->orientation,
	                                                  rb_shape_centroid(solids, &part->shape)));
}

/*
 * The part's tensor in the union's axes, about the union's centroid (the theorem of parallel axes).
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

static void measure_union(struct rb_solid *solid, const struct rb_solid *solids)
{
	const rb_vec3 base = solid->parts[0].position;
	rb_vec3 sum = {0, 0, 0};

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

void rb_solid_measure(struct rb_solid *solid, const struct rb_solid *solids)
{
	solid->volume = solid->weight = solid->reach = 0;
	solid->inertia = rb_mat3_diagonal(0, 0, 0);
	if (solid->part_count > 0)
		measure_union(solid, solids);
	else
		measure_hull(solid);
}

/* ---- tensors ---- */

static double largest_entry(const rb_mat3 *a)
{
	double largest = 0;

	for (int i = 0; i < 9; i++)
		largest = fmax(largest, fabs(a->m[i / 3][i % 3]));
	return largest;
}

/* One Jacobi rotation that makes a[p][q] zero (Golub and Van Loan, Matrix Computations, 8.5). */
static void rotate_away(double a[3][3], int p, int q)
{
	if (a[p][q] == 0)
		return;
	const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
	const double t = copysign(1, theta) / (fabs(theta) + hypot(theta, 1));
	const double c = 1 / sqrt(t * t + 1), s = t * c;
	const int r = 3 - p - q;
	const double rp = a[r][p], rq = a[r][q];

	a[p][p] -= t * a[p][q];
	a[q][q] += t * a[p][q];
	a[p][q] = a[q][p] = 0;
	a[r][p] = a[p][r] = c * rp - s * rq;
	a[r][q] = a[q][r] = s * rp + c * rq;
}

void rb_inertia_principal(const rb_mat3 *inertia, double moments[3])
{
	const double scale = largest_entry(inertia);
	double a[3][3];

	moments[0] = moments[1] = moments[2] = 0;
	if (!(scale > 0) || !isfinite(scale))
		return;
	for (int i = 0; i < 3; i++)
		for (int j = i; j < 3; j++)
			a[i][j] = a[j][i] = inertia->m[i][j] / scale;
	/* Converges quadratically: a handful of sweeps leaves nothing beside the diagonal. */
	for (int sweep = 0; sweep < 12; sweep++) {
		rotate_away(a, 0, 1);
		rotate_away(a, 0, 2);
		rotate_away(a, 1, 2);
	}
	const double x = a[0][0], y = a[1][1], z = a[2][2];
	moments[0] = scale * fmin(x, fmin(y, z));
	moments[2] = scale * fmax(x, fmax(y, z));
	moments[1] = scale * fmax(fmin(x, y), fmin(fmax(x, y), z));
}

bool rb_inertia_is_scalar(const rb_mat3 *inertia)
{
	const double limit = rounding * largest_entry(inertia);

	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			if (fabs(inertia->m[i][j] - (i == j ? inertia->m[0][0] : 0)) > limit)
				return false;
	return true;
}

struct rb_particles rb_particles_measure(const struct rb_particle *particles, size_t count)
{
	struct rb_particles all = {.mass = 0};
	rb_vec3 first = {0, 0, 0};
	double farthest = 0;

	for (size_t i = 0; i < count; i++) {
		const struct rb_particle *const p = &particles[i];

		all.mass += p->mass;
		first = rb_vec3_add_scaled(first, p->mass, p->position);
		farthest = fmax(farthest, rb_vec3_max_abs(p->position));
	}
	all.center = rb_vec3_scale(1 / all.mass, first);
	all.center_error = (double)count * DBL_EPSILON * farthest;
	for (size_t i = 0; i < count; i++) {
		const rb_vec3 r = rb_vec3_sub(particles[i].position, all.center);
		const double x[3] = {r.x, r.y, r.z};

		for (int j = 0; j < 9; j++)
			all.inertia.m[j / 3][j % 3] += particles[i].mass *
			                               ((j / 3 == j % 3 ? rb_vec3_dot(r, r) : 0) -
			                                x[j / 3] * x[j % 3]);
	}
	return all;
}

bool rb_particles_in_line(const rb_mat3 *inertia, size_t count)
{
	double moments[3];

	rb_inertia_principal(inertia, moments);
	/* a few roundings for each term of the sums and each entry of the tensor */
	return moments[0] <= (double)(count + 9) * 4 * DBL_EPSILON * moments[2];
}

const char *rb_inertia_fault(const rb_mat3 *inertia)
{
	const double largest = largest_entry(inertia);
	double moments[3];

	for (int i = 0; i < 9; i++)
		if (!isfinite(inertia->m[i / 3][i % 3]))
			return "has an entry that is not finite";
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < i; j++)
			if (fabs(inertia->m[i][j] - inertia->m[j][i]) > rounding * largest)
				return "is not symmetric";
	rb_inertia_principal(inertia, moments);
	if (!(moments[0] > 0))
		return "is not positive";
	if (moments[2] - moments[1] > moments[0] + rounding * largest)
		return "has a principal moment above the sum of the other two, which no body has";
	return NULL;
}
