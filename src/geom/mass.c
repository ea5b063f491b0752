/* SPDX-License-Identifier: MIT */
/*
 * Sums over the tetrahedra that a point within the hull spans with triangles of the faces.
 * Mirtich's reduction to line integrals (J. Graphics Tools 1 (1996) 31) is not used: its terms
 * have both signs and cancel where the body is far from the origin or thin, whereas here every term
 * is positive. Moments are taken about the centroid in a second pass rather than shifted by
 * Steiner's theorem, for the same reason.
 */
#include "geom/mass.h"

#include <float.h>

#include "base/error.h"
#include "math/quat.h"
#include "math/top.h"

/* Relative error granted to a tensor that was computed elsewhere and written down in a scene. */
static const double rounding = 1e-12;

/* ---- polyhedra ---- */

/*
 * Of a body of density 1 about a point: volume, first and second moments (xx, yy, zz, xy, xz, yz).
 */
struct moments {
	double volume;
	rb_vec3 first;
	double second[6];
};

/*
 * Adds the tetrahedron (0, a, b, c). Over a simplex the mean of x_i x_j is (sum over corners of the
 * products + product of the sums) / 20, from the means of products of barycentric coordinates, 1/10
 * and 1/20 (Zienkiewicz and Taylor, The Finite Element Method, volume coordinates).
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

/* Half of the smallest extent along the principal axes, m. */
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

void rb_solid_measure(struct rb_solid *solid)
{
	RB_ASSERT(solid->vertex_count >= 4 && solid->face_count >= 4);
	const rb_vec3 within = mean_of(solid->vertices, solid->vertex_count);
	const struct moments first = moments_about(solid, within);

	solid->reach = 0;
	solid->volume = solid->weight = first.volume;
	solid->centroid = rb_vec3_add_scaled(within, 1 / first.volume, first.first);
	/*
	 * second pass about the centroid: no parallel axis theorem, no difference of large numbers
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

/* ---- tensors ---- */

/* Largest |entry|. */
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
	/* Quadratic convergence: after some five sweeps the off-diagonal entries are zero. */
	for (int sweep = 0; sweep < 12; sweep++) {
		rotate_away(a, 0, 1);
		rotate_away(a, 0, 2);
		rotate_away(a, 1, 2);
	}
	/* sorted; of the three x, y, z the median without branches */
	const double x = a[0][0], y = a[1][1], z = a[2][2];
	moments[0] = scale * fmin(x, fmin(y, z));
	moments[2] = scale * fmax(x, fmax(y, z));
	moments[1] = scale * fmax(fmin(x, y), fmin(fmax(x, y), z));
	RB_ASSERT(!(moments[0] > moments[1]) && !(moments[1] > moments[2]));
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
	RB_ASSERT(count > 0);

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
