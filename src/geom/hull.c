/* SPDX-License-Identifier: MIT */
/*
 * Qhull with facets merged within a given thickness (option C-) after the cloud was brought to a
 * unit cube in its principal axes. Merging needs a length; in the cube it is the rounding of the
 * coordinates, whatever the body's size, place and aspect. Qhull's own joggle (QJ) is not used
 * since it perturbs corners, and exact arithmetic (CGAL) because coordinates are rounded anyway:
 * faces that should be planar are so to some ulp only.
 *
 * The result is checked to be a closed surface (each edge once in each direction, Euler's formula)
 * and brought to an order of its own, so that a scene's bits do not depend on Qhull's version.
 */
#include "geom/hull.h"

#include "base/error.h"
#include "base/memory.h"
#include "math/quat.h"
#include "math/top.h"

#include <float.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <libqhull_r/libqhull_r.h>

#include <libqhull_r/poly_r.h>

/*
 * Roundings of the coordinates by which a vertex may be off its face, and below which an extent
 * counts as none; thicknesses tried, each 8 times the last, so up to 2^19 ulp.
 */
enum { COPLANAR_ULP = 16, FLAT_ULP = 64, TRIES = 6 };

/* The points as Qhull sees them: within a cube of edge 1 about the origin. */
struct cloud {
	const rb_vec3 *points;
	int count;
	double *at;   /* owned: [count][3] */
	double noise; /* what the rounding of the given coordinates comes to */
};

struct loop {
	int first, count; /* in hull->loops */
};

/* ---- to a cube ---- */

/* Smallest and largest coordinates of the cloud. */
static void extent(const double *at, int count, double low[3], double high[3])
{
	for (int k = 0; k < 3; k++) {
		low[k] = high[k] = at[k];
		for (int i = 1; i < count; i++) {
			low[k] = fmin(low[k], at[3 * i + k]);
			high[k] = fmax(high[k], at[3 * i + k]);
		}
	}
}

/*
 * Centres the cloud and scales each axis to an extent of 1; false if an extent is within rounding.
 * `noise` is the rounding of the coordinates along each axis and is scaled likewise.
 */
static bool stretch(struct cloud *cloud, double noise[3])
{
	double low[3], high[3];

	extent(cloud->at, cloud->count, low, high);
	for (int k = 0; k < 3; k++) {
		const double middle = 0.5 * low[k] + 0.5 * high[k];
		const double size = 0.5 * high[k] - 0.5 * low[k];

		if (!(2 * size > FLAT_ULP * noise[k]))
			return false;
		for (int i = 0; i < cloud->count; i++)
			cloud->at[3 * i + k] = 0.5 * ((cloud->at[3 * i + k] - middle) / size);
		noise[k] = noise[k] / (2 * size) + DBL_EPSILON;
	}
	return true;
}

/* Rotates the cloud to the principal axes of its second moments. */
static void turn(struct cloud *cloud, double noise[3])
{
	double s[3][3] = {{0}};

	for (int i = 0; i < cloud->count; i++)
		for (int j = 0; j < 3; j++)
			for (int k = 0; k < 3; k++)
				s[j][k] += cloud->at[3 * i + j] * cloud->at[3 * i + k];
	/* an inertia tensor, which has the same principal axes */
	const rb_mat3 tensor = {{{s[1][1] + s[2][2], -s[0][1], -s[0][2]},
	                         {-s[1][0], s[0][0] + s[2][2], -s[1][2]},
	                         {-s[2][0], -s[2][1], s[0][0] + s[1][1]}}};
	const rb_quat axes = rb_top_body_of(&tensor).principal;
	const rb_mat3 r = rb_quat_to_mat3(axes);
	double across[3];

	for (int k = 0; k < 3; k++)
		across[k] = fabs(r.m[0][k]) * noise[0] + fabs(r.m[1][k]) * noise[1] +
		            fabs(r.m[2][k]) * noise[2] + DBL_EPSILON;
	for (int i = 0; i < cloud->count; i++) {
		double *const p = cloud->at + 3 * (size_t)i;

		rb_vec3_to(p, rb_quat_rotate_back(axes, rb_vec3_from(p)));
	}
	memcpy(noise, across, sizeof across);
}

static enum rb_status refuse(struct rb_error *err, size_t count)
{
	return RB_FAIL(err, RB_ERR_SCENE,
	               "%zu points that lie in a plane, to the rounding of their coordinates "
	               "(wanted a body with a volume)",
	               count);
}

/* Copies the points and maps them to the cube; RB_ERR_SCENE where they lie in a plane. */
static enum rb_status to_cube(struct cloud *cloud, struct rb_error *err)
{
	double noise[3] = {0, 0, 0};

	for (int i = 0; i < cloud->count; i++) {
		double p[3];

		rb_vec3_to(p, cloud->points[i]);
		for (int k = 0; k < 3; k++)
			noise[k] = fmax(noise[k], DBL_EPSILON * fabs(p[k]));
		memcpy(cloud->at + 3 * (size_t)i, p, sizeof p);
	}
	if (!stretch(cloud, noise))
		return refuse(err, (size_t)cloud->count);
	/* it may still be thin along a direction oblique to the axes */
	turn(cloud, noise);
	if (!stretch(cloud, noise))
		return refuse(err, (size_t)cloud->count);
	cloud->noise = fmax(noise[0], fmax(noise[1], noise[2]));
	return RB_OK;
}

/* ---- faces ---- */

/*
 * True if the loop runs clockwise seen from outside, by Newell's normal, which three collinear
 * corners do not upset.
 */
static bool is_clockwise(const double *at, const int *loop, int count, const double *outward)
{
	rb_vec3 normal = {0, 0, 0};

	for (int k = 0; k < count; k++) {
		const rb_vec3 p = rb_vec3_from(at + 3 * (size_t)loop[k]);
		const rb_vec3 q = rb_vec3_from(at + 3 * (size_t)loop[(k + 1) % count]);

		normal = rb_vec3_add(normal, rb_vec3_cross(p, q));
	}
	return rb_vec3_dot(normal, rb_vec3_from(outward)) < 0;
}

/* Appends a facet's corners as numbers of points, counter-clockwise. */
static void put_loop(struct rb_hull *hull, const struct cloud *cloud, qhT *qh, facetT *facet,
                     setT *corners)
{
	int *const loop = hull->loops + hull->face_first[hull->face_count];
	vertexT *vertex, **vertexp;
	int count = 0;

	FOREACHvertex_(corners) loop[count++] = qh_pointid(qh, vertex->point);
	if (is_clockwise(cloud->at, loop, count, facet->normal))
		for (int k = 0; k < count / 2; k++) {
			const int other = loop[k];

			loop[k] = loop[count - 1 - k];
			loop[count - 1 - k] = other;
		}
	hull->face_count++;
	hull->face_first[hull->face_count] = hull->face_first[hull->face_count - 1] + count;
}

/* Allocates for the facets that Qhull has found; a face has as many corners as ridges. */
static bool take_faces(struct rb_hull *hull, qhT *qh)
{
	facetT *facet;
	size_t corners = 0, faces = 0;

	FORALLfacets
	{
		const int ridges = facet->simplicial ? 3 : qh_setsize(qh, facet->ridges);

		corners += (size_t)ridges;
		faces++;
	}
	hull->loops = rb_memory_take(corners, sizeof *hull->loops);
	hull->face_first = rb_memory_take(faces + 1, sizeof *hull->face_first);
	return hull->loops && hull->face_first;
}

/*
 * Faces as loops of point numbers. Qhull reports errors by longjmp to errexit: everything modified
 * in between belongs to the hull or to Qhull, not to this frame.
 */
static enum rb_status take_loops(struct rb_hull *hull, const struct cloud *cloud, qhT *qh)
{
	facetT *facet;

	if (!take_faces(hull, qh))
		return RB_ERR_MEMORY;
	qh->NOerrexit = False;
	if (setjmp(qh->errexit)) {
		qh->NOerrexit = True;
		return RB_ERR_SCENE;
	}
	FORALLfacets
	{
		setT *corners = qh_facet3vertex(qh, facet);

		put_loop(hull, cloud, qh, facet, corners);
		qh_settempfree(qh, &corners);
	}
	qh->NOerrexit = True;
	return RB_OK;
}

/*
 * Runs Qhull on the cloud with facets merged within `coplanar`; RB_ERR_SCENE if it gives up. Its
 * messages go to a buffer that nobody reads.
 */
static enum rb_status run(struct rb_hull *hull, const struct cloud *cloud, double coplanar)
{
	char command[64], text[2048] = "";
	enum rb_status status = RB_ERR_MEMORY;
	int kept = 0, whole = 0;
	qhT *qh = rb_memory_take(1, sizeof *qh);
	FILE *said = fmemopen(text, sizeof text, "w");

	if (qh && said) {
		snprintf(command, sizeof command, "qhull Pp C-%.17g", coplanar);
		qh_zero(qh, said);
		const int failed = qh_new_qhull(qh, 3, cloud->count, cloud->at, False, command,
		                                NULL, said);
		status = failed == qh_ERRmem ? RB_ERR_MEMORY
		         : failed            ? RB_ERR_SCENE
		                             : take_loops(hull, cloud, qh);
		qh->NOerrexit = True;
		qh_freeqhull(qh, !qh_ALL);
		qh_memfreeshort(qh, &kept, &whole);
	}
	if (said)
		fclose(said);
	rb_memory_free(qh);
	return status;
}

/* ---- order ---- */

static int compare_edges(const void *a, const void *b)
{
	const int *const p = a, *const q = b;

	return p[0] != q[0] ? (p[0] > q[0]) - (p[0] < q[0]) : (p[1] > q[1]) - (p[1] < q[1]);
}

/*
 * Lists the edges and checks that the surface is closed: every edge once in each direction, and
 * Euler's V - E + F = 2. RB_ERR_SCENE otherwise.
 */
static enum rb_status find_edges(struct rb_hull *hull)
{
	const int count = hull->face_first[hull->face_count];
	int(*edge)[2] = rb_memory_take((size_t)count + 1, sizeof *edge);
	bool closed = count > 0 && count % 2 == 0;
	int kept = 0;

	if (!edge)
		return RB_ERR_MEMORY;
	for (int f = 0; f < hull->face_count; f++) {
		const int first = hull->face_first[f], size = hull->face_first[f + 1] - first;

		closed = closed && size >= 3;
		for (int k = 0; k < size; k++) {
			edge[first + k][0] = hull->loops[first + k];
			edge[first + k][1] = hull->loops[first + (k + 1) % size];
		}
	}
	qsort(edge, (size_t)count, sizeof *edge, compare_edges);
	for (int k = 0; closed && k < count; k++) {
		const int back[2] = {edge[k][1], edge[k][0]};

		closed = (k == 0 || compare_edges(edge[k - 1], edge[k]) != 0) &&
		         bsearch(back, edge, (size_t)count, sizeof *edge, compare_edges);
	}
	for (int k = 0; closed && k < count; k++)
		if (edge[k][0] < edge[k][1])
			memcpy(edge[kept++], edge[k], sizeof edge[0]);
	hull->edges = edge;
	hull->edge_count = kept;
	return closed && hull->vertex_count - kept + hull->face_count == 2 ? RB_OK : RB_ERR_SCENE;
}

/* Renumbers the loops from points to the corners that remain, in the order of the points. */
static enum rb_status keep_corners(struct rb_hull *hull, const struct cloud *cloud)
{
	int *const corner = rb_memory_take((size_t)cloud->count, sizeof *corner);
	const int count = hull->face_first[hull->face_count];

	hull->vertices = rb_memory_take((size_t)count, sizeof *hull->vertices);
	if (!corner || !hull->vertices) {
		rb_memory_free(corner);
		return RB_ERR_MEMORY;
	}
	for (int k = 0; k < count; k++)
		corner[hull->loops[k]] = 1;
	for (int i = 0; i < cloud->count; i++)
		if (corner[i]) {
			corner[i] = hull->vertex_count;
			RB_ASSERT(hull->vertex_count < count);
			hull->vertices[hull->vertex_count++] = cloud->points[i];
		}
	for (int k = 0; k < count; k++)
		hull->loops[k] = corner[hull->loops[k]];
	rb_memory_free(corner);
	return RB_OK;
}

struct ordered {
	const int *loop;
	int count;
};

static int compare_loops(const void *a, const void *b)
{
	const struct ordered *const p = a, *const q = b;

	for (int k = 0; k < p->count && k < q->count; k++)
		if (p->loop[k] != q->loop[k])
			return p->loop[k] < q->loop[k] ? -1 : 1;
	return (p->count > q->count) - (p->count < q->count);
}

/*
 * Rotates each loop to start at its smallest corner and sorts the loops, so that the result does
 * not depend on Qhull's order.
 */
static enum rb_status sort_loops(struct rb_hull *hull)
{
	const int total = hull->face_first[hull->face_count];
	struct ordered *order = rb_memory_take((size_t)hull->face_count, sizeof *order);
	int *turned = rb_memory_take((size_t)total, sizeof *turned);

	if (!order || !turned) {
		rb_memory_free(order);
		rb_memory_free(turned);
		return RB_ERR_MEMORY;
	}
	for (int f = 0; f < hull->face_count; f++) {
		const int first = hull->face_first[f], size = hull->face_first[f + 1] - first;
		const int *const loop = hull->loops + first;
		int least = 0;

		for (int k = 1; k < size; k++)
			least = loop[k] < loop[least] ? k : least;
		for (int k = 0; k < size; k++)
			turned[first + k] = loop[(least + k) % size];
		order[f] = (struct ordered){turned + first, size};
	}
	qsort(order, (size_t)hull->face_count, sizeof *order, compare_loops);
	for (int f = 0, at = 0; f < hull->face_count; f++) {
		hull->face_first[f] = at;
		memcpy(hull->loops + at, order[f].loop, (size_t)order[f].count * sizeof(int));
		at += order[f].count;
	}
	rb_memory_free(order);
	rb_memory_free(turned);
	return RB_OK;
}

/* One try: hull, corners, order, edges. */
static enum rb_status make(struct rb_hull *hull, const struct cloud *cloud, double coplanar)
{
	enum rb_status status = run(hull, cloud, coplanar);

	if (status == RB_OK)
		status = keep_corners(hull, cloud);
	if (status == RB_OK)
		status = sort_loops(hull);
	return status == RB_OK ? find_edges(hull) : status;
}

static enum rb_status check_points(const rb_vec3 *points, size_t count, struct rb_error *err)
{
	if (count < 4)
		return RB_FAIL(err, RB_ERR_SCENE, "%zu %s no hull (wanted at least 4)", count,
		               count == 1 ? "point has" : "points have");
	if (count > RB_HULL_POINTS_MAX)
		return RB_FAIL(err, RB_ERR_SCENE, "%zu points are too many (wanted at most %d)",
		               count, RB_HULL_POINTS_MAX);
	for (size_t i = 0; i < count; i++)
		if (!rb_vec3_finite(points[i]))
			return RB_FAIL(err, RB_ERR_SCENE, "point %zu is not finite", i + 1);
	return RB_OK;
}

enum rb_status rb_hull_make(struct rb_hull *hull, const rb_vec3 *points, size_t count,
                            struct rb_error *err)
{
	struct cloud cloud = {.points = points};
	enum rb_status status = check_points(points, count, err);

	*hull = (struct rb_hull){0};
	if (status != RB_OK)
		return status;
	cloud.count = (int)count;
	cloud.at = rb_memory_take(count, 3 * sizeof *cloud.at);
	if (!cloud.at)
		return RB_FAIL(err, RB_ERR_MEMORY, "out of memory for a hull of %zu points", count);
	status = to_cube(&cloud, err);
	if (status != RB_OK) {
		rb_memory_free(cloud.at);
		return status;
	}
	/* a facet structure that does not close at this thickness mostly does at a larger one */
	double coplanar = COPLANAR_ULP * cloud.noise;
	status = RB_ERR_SCENE;
	for (int k = 0; k < TRIES && status == RB_ERR_SCENE; k++, coplanar *= 8) {
		rb_hull_release(hull);
		status = make(hull, &cloud, coplanar);
	}
	rb_memory_free(cloud.at);
	if (status == RB_OK)
		return RB_OK;
	rb_hull_release(hull);
	if (status == RB_ERR_MEMORY)
		return RB_FAIL(err, status, "out of memory for a hull of %zu points", count);
	return RB_FAIL(err, RB_ERR_SCENE,
	               "no closed hull of %zu points was found (are they nearly in a plane, or "
	               "nearly the same?)",
	               count);
}

void rb_hull_library(char *out, size_t size)
{
	/* "qhull_r 8.0.2 (...)" */
	const char *const space = strchr(qh_version2, ' ');

	snprintf(out, size, "Qhull%s", space ? space : "");
}

void rb_hull_release(struct rb_hull *hull)
{
	rb_memory_free(hull->vertices);
	rb_memory_free(hull->loops);
	rb_memory_free(hull->face_first);
	rb_memory_free(hull->edges);
	*hull = (struct rb_hull){0};
}
