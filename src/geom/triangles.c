/* SPDX-License-Identifier: MIT */
/*
 * Boxes are halved at the median of their middles along the longest side: a tree whose depth is
 * that of its number of leaves, whatever the triangles. Neighbours are found by sorting edges.
 */
#include "geom/triangles.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "base/sort.h"
#include "math/vec3.h"

/*
 * Sine by which a direction must lean over a neighbour to count as one of its own: above rounding
 * of directions, so that of two neighbours in a plane never both say that it is the other's.
 */
static const double LEAN = 1e-10;

/*
 * Sine up to which a straight side lies on a facet, along which it may touch anywhere: steps leave
 * it tilted by their tolerance, and the best direction then is across an edge of the facet.
 */
static const double SLIGHT = 1e-3;
/* Share of its size by which a point may be inside of a facet and still be on its border. */
static const double BORDER = 1e-9;

/* ulp by which a vertex may be off the plane of a facet and still lie in it: as what touches. */
static const double PLANE_ULPS = 16;

/* ---- tree ---- */

static double component(rb_vec3 v, int axis)
{
	return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

static rb_aabb box_of(const struct rb_terrain *terrain, int facet)
{
	const int *const corner = terrain->corners[facet];
	rb_aabb box = {terrain->vertices[corner[0]], terrain->vertices[corner[0]]};

	for (int k = 1; k < 3; k++) {
		const rb_vec3 v = terrain->vertices[corner[k]];
		box.low = (rb_vec3){fmin(box.low.x, v.x), fmin(box.low.y, v.y),
		                    fmin(box.low.z, v.z)};
		box.high = (rb_vec3){fmax(box.high.x, v.x), fmax(box.high.y, v.y),
		                     fmax(box.high.z, v.z)};
	}
	return box;
}

static rb_aabb joined(rb_aabb a, rb_aabb b)
{
	return (rb_aabb){
		{fmin(a.low.x, b.low.x), fmin(a.low.y, b.low.y), fmin(a.low.z, b.low.z)},
		{fmax(a.high.x, b.high.x), fmax(a.high.y, b.high.y), fmax(a.high.z, b.high.z)}};
}

/* A key in the order of finite numbers. */
static uint64_t ordered(double x)
{
	uint64_t bits;

	memcpy(&bits, &x, sizeof bits);
	return bits >> 63 ? ~bits : bits | UINT64_C(1) << 63;
}

struct builder {
	struct rb_terrain *terrain;
	struct rb_sort_item *item, *scratch;
	int used; /* nodes */
};

/* Fills a node with the facets from `first` on, and makes what is below it. */
static void build(struct builder *b, int node, int first, int count, int depth)
{
	const struct rb_terrain *const terrain = b->terrain;
	rb_aabb box = box_of(terrain, (int)b->item[first].value);

	RB_ASSERT(count > 0 && depth < RB_TERRAIN_DEPTH_MAX - 1);
	for (int k = 1; k < count; k++)
		box = joined(box, box_of(terrain, (int)b->item[first + k].value));
	if (count == 1) {
		terrain->node[node] = (struct rb_terrain_node){box, ~(int)b->item[first].value};
		return;
	}
	const rb_vec3 side = rb_vec3_sub(box.high, box.low);
	const int axis = side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
	for (int k = first; k < first + count; k++) {
		const rb_aabb own = box_of(terrain, (int)b->item[k].value);
		b->item[k].key = ordered(0.5 * component(own.low, axis) +
		                         0.5 * component(own.high, axis));
	}
	rb_sort_by_key(b->item + first, b->scratch + first, (size_t)count);
	const int child = b->used, half = count / 2;
	b->used += 2;
	terrain->node[node] = (struct rb_terrain_node){box, child};
	build(b, child, first, half, depth + 1);
	build(b, child + 1, first + half, count - half, depth + 1);
}

/* m: from a point to a box, 0 inside. */
static double box_distance(const rb_aabb *box, rb_vec3 at)
{
	return rb_vec3_length((rb_vec3){fmax(0, fmax(box->low.x - at.x, at.x - box->high.x)),
	                                fmax(0, fmax(box->low.y - at.y, at.y - box->high.y)),
	                                fmax(0, fmax(box->low.z - at.z, at.z - box->high.z))});
}

void rb_terrain_walk_begin(struct rb_terrain_walk *walk, const struct rb_terrain *terrain,
                           rb_vec3 at, double within)
{
	walk->terrain = terrain;
	walk->at = at;
	walk->within = within;
	walk->rounding = 16 * DBL_EPSILON *
	                 fmax(rb_vec3_max_abs(at),
	                      fmax(rb_vec3_max_abs(terrain->node[0].box.low),
	                           rb_vec3_max_abs(terrain->node[0].box.high)));
	walk->depth = 1;
	walk->stack[0] = 0;
}

int rb_terrain_walk_next(struct rb_terrain_walk *walk)
{
	const struct rb_terrain_node *const nodes = walk->terrain->node;

	while (walk->depth > 0) {
		const struct rb_terrain_node *const node = &nodes[walk->stack[--walk->depth]];

		/* written so that NaN visits */
		if (box_distance(&node->box, walk->at) > walk->within + walk->rounding)
			continue;
		if (node->first < 0)
			return ~node->first;
		const double left = box_distance(&nodes[node->first].box, walk->at);
		const double right = box_distance(&nodes[node->first + 1].box, walk->at);
		const int near = node->first + (right < left);
		walk->stack[walk->depth++] = near == node->first ? near + 1 : node->first;
		walk->stack[walk->depth++] = near;
	}
	return -1;
}

/* ---- neighbours ---- */

/* Key of the edge of two vertices, whichever comes first. */
static uint64_t edge_key(int v, int w)
{
	return (uint64_t)(v < w ? v : w) << 32 | (uint64_t)(v < w ? w : v);
}

/* The corner across each edge where exactly two facets meet. */
static void find_across(struct rb_terrain *terrain, struct rb_sort_item *item,
                        struct rb_sort_item *scratch)
{
	const size_t count = 3 * (size_t)terrain->facet_count;

	for (size_t k = 0; k < count; k++) {
		const int *const corner = terrain->corners[k / 3];

		item[k] = (struct rb_sort_item){edge_key(corner[k % 3], corner[(k + 1) % 3]), k};
		terrain->across[k / 3][k % 3] = -1;
	}
	rb_sort_by_key(item, scratch, count);
	for (size_t k = 0, end; k < count; k = end) {
		for (end = k + 1; end < count && item[end].key == item[k].key; end++)
			;
		if (end - k != 2)
			continue;
		for (int side = 0; side < 2; side++) {
			const uint64_t own = item[k + (size_t)side].value,
				       other = item[k + 1 - (size_t)side].value;
			terrain->across[own / 3][own % 3] =
				terrain->corners[other / 3][(other % 3 + 2) % 3];
		}
	}
}

/* Vertices that an edge joins to each, each as often as facets have that edge. */
static void find_spokes(struct rb_terrain *terrain)
{
	for (int pass = 0; pass < 2; pass++) {
		for (int k = 0; k < 3 * terrain->facet_count; k++) {
			const int *const corner = terrain->corners[k / 3];
			const int v = corner[k % 3], w = corner[(k + 1) % 3];

			if (pass == 0) {
				terrain->spoke_first[v + 1]++;
				terrain->spoke_first[w + 1]++;
			} else {
				terrain->spokes[terrain->spoke_first[v]++] = w;
				terrain->spokes[terrain->spoke_first[w]++] = v;
			}
		}
		if (pass == 0)
			for (int v = 0; v < terrain->vertex_count; v++)
				terrain->spoke_first[v + 1] += terrain->spoke_first[v];
	}
	/* each has become the next one's first */
	memmove(terrain->spoke_first + 1, terrain->spoke_first,
	        (size_t)terrain->vertex_count * sizeof *terrain->spoke_first);
	terrain->spoke_first[0] = 0;
}

enum rb_status rb_terrain_create(struct rb_terrain **terrain, const rb_vec3 *vertices,
                                 int vertex_count, const int (*corners)[3], int facet_count,
                                 struct rb_error *err)
{
	const size_t facets = (size_t)facet_count;
	struct rb_terrain *const t = rb_memory_take(1, sizeof *t);
	struct rb_sort_item *const items = rb_memory_take(6 * facets, sizeof *items);

	RB_ASSERT(facet_count > 0 && vertex_count > 0);
	*terrain = NULL;
	if (t) {
		*t = (struct rb_terrain){.facet_count = facet_count,
		                         .vertex_count = vertex_count,
		                         .vertices = vertices,
		                         .corners = corners};
		t->node = rb_memory_take(2 * facets - 1, sizeof *t->node);
		t->across = rb_memory_take(facets, sizeof *t->across);
		t->spoke_first = rb_memory_take((size_t)vertex_count + 1, sizeof *t->spoke_first);
		t->spokes = rb_memory_take(6 * facets, sizeof *t->spokes);
	}
	if (!t || !items || !t->node || !t->across || !t->spoke_first || !t->spokes) {
		rb_memory_free(items);
		rb_terrain_destroy(t);
		return RB_FAIL(err, RB_ERR_MEMORY, "out of memory for a terrain of %d triangles",
		               facet_count);
	}
	struct builder builder = {t, items, items + 3 * facets, 1};
	for (size_t k = 0; k < facets; k++)
		items[k].value = k;
	build(&builder, 0, 0, facet_count, 0);
	find_across(t, items, items + 3 * facets);
	find_spokes(t);
	rb_memory_free(items);
	*terrain = t;
	return RB_OK;
}

void rb_terrain_destroy(struct rb_terrain *terrain)
{
	if (!terrain)
		return;
	rb_memory_free(terrain->node);
	rb_memory_free(terrain->across);
	rb_memory_free(terrain->spoke_first);
	rb_memory_free(terrain->spokes);
	rb_memory_free(terrain);
}

/* Across edge k, from corner k to the next, the neighbour falls away from `outward`. */
static bool edge_is_real(const struct rb_terrain *terrain, int facet, int k, rb_vec3 outward)
{
	const int *const corner = terrain->corners[facet];
	const int across = terrain->across[facet][k];

	if (across < 0)
		return true;
	const rb_vec3 from = terrain->vertices[corner[k]];
	const rb_vec3 zero = {0, 0, 0};
	const rb_vec3 edge = rb_vec3_unit(rb_vec3_sub(terrain->vertices[corner[(k + 1) % 3]], from),
	                                  zero);
	const rb_vec3 over = rb_vec3_unit(
		rb_vec3_reject(rb_vec3_sub(terrain->vertices[across], from), edge), zero);

	return rb_vec3_dot(outward, over) <= LEAN;
}

/* All edges at corner k do. */
static bool corner_is_real(const struct rb_terrain *terrain, int facet, int k, rb_vec3 outward)
{
	const int v = terrain->corners[facet][k];

	for (int s = terrain->spoke_first[v]; s < terrain->spoke_first[v + 1]; s++) {
		const rb_vec3 spoke = rb_vec3_sub(terrain->vertices[terrain->spokes[s]],
		                                  terrain->vertices[v]);

		if (rb_vec3_dot(outward, spoke) > LEAN * rb_vec3_length(spoke))
			return false;
	}
	return true;
}

/* Which of the three edges a point is on, to the border; how many. */
static int edges_at(const rb_vec3 v[3], rb_vec3 normal, double size, rb_vec3 point, int on[3])
{
	const rb_vec3 zero = {0, 0, 0};
	int count = 0;

	for (int k = 0; k < 3; k++) {
		const rb_vec3 side = rb_vec3_sub(v[(k + 1) % 3], v[k]);
		const rb_vec3 inward = rb_vec3_unit(rb_vec3_cross(normal, side), zero);

		if (rb_vec3_dot(inward, rb_vec3_sub(point, v[k])) <= BORDER * size)
			on[count++] = k;
	}
	return count;
}

/* A point in the middle of what is outermost: a corner, or an edge. */
static rb_vec3 outermost(const rb_vec3 v[3], double size, rb_vec3 outward)
{
	double height[3], highest = -(double)INFINITY, count = 0;
	rb_vec3 sum = {0, 0, 0};

	/* relative to a corner: far from the origin no digits are lost */
	for (int k = 0; k < 3; k++) {
		height[k] = rb_vec3_dot(outward, rb_vec3_sub(v[k], v[0]));
		highest = fmax(highest, height[k]);
	}
	for (int k = 0; k < 3; k++)
		if (height[k] >= highest - BORDER * size) {
			sum = rb_vec3_add(sum, v[k]);
			count++;
		}
	return rb_vec3_scale(1 / count, sum);
}

/* A facet in its place: corners, the longest side, unit normal. */
struct facet {
	rb_vec3 v[3];
	double size;
	rb_vec3 normal;
};

static struct facet facet_of(const struct rb_terrain *terrain, int facet)
{
	const rb_vec3 zero = {0, 0, 0};
	struct facet f = {.size = 0};

	RB_ASSERT_COSTLY(facet >= 0 && facet < terrain->facet_count);
	for (int k = 0; k < 3; k++)
		f.v[k] = terrain->vertices[terrain->corners[facet][k]];
	for (int k = 0; k < 3; k++)
		f.size = fmax(f.size, rb_vec3_length(rb_vec3_sub(f.v[(k + 1) % 3], f.v[k])));
	f.normal = rb_vec3_unit(
		rb_vec3_cross(rb_vec3_sub(f.v[1], f.v[0]), rb_vec3_sub(f.v[2], f.v[0])), zero);
	return f;
}

/* Of edges k and k + 1 the corner between is k + 1, of 0 and 2 it is 0. */
static int corner_between(const int on[2])
{
	return on[0] == 0 && on[1] == 2 ? 0 : on[1];
}

bool rb_terrain_touch_is_real(const struct rb_terrain *terrain, int facet, rb_vec3 point,
                              rb_vec3 outward, const rb_vec3 *axis)
{
	const struct facet f = facet_of(terrain, facet);
	const rb_vec3 *const v = f.v;
	const double size = f.size;
	const rb_vec3 normal = f.normal;
	int on[3];

	/* along its own normal nothing else is nearer */
	const rb_vec3 tilt = rb_vec3_cross(normal, outward);
	if (rb_vec3_length(tilt) <= LEAN)
		return true;
	const bool is_round = axis && (rb_vec3_max_abs(*axis) == 0 ||
	                               fabs(rb_vec3_dot(tilt, *axis)) > SLIGHT);
	const int count = edges_at(v, normal, size, is_round ? outermost(v, size, outward) : point,
	                           on);
	if (count == 0)
		return true;
	if (count == 1)
		return edge_is_real(terrain, facet, on[0], outward);
	return corner_is_real(terrain, facet, corner_between(on), outward);
}

/* Is a vertex in the plane of a facet, as exactly as both are given? */
static bool lies_in(const struct rb_terrain *terrain, const struct facet *f, int vertex)
{
	const rb_vec3 w = terrain->vertices[vertex];
	const double coordinate = fmax(rb_vec3_max_abs(w), rb_vec3_max_abs(f->v[0]));

	return fabs(rb_vec3_dot(f->normal, rb_vec3_sub(w, f->v[0]))) <=
	       PLANE_ULPS * DBL_EPSILON * fmax(coordinate, f->size);
}

/* All facets at corner k do, and close round it: each edge there is that of two. */
static bool corner_goes_on(const struct rb_terrain *terrain, const struct facet *f, int v)
{
	const int first = terrain->spoke_first[v], end = terrain->spoke_first[v + 1];

	for (int s = first; s < end; s++) {
		int same = 0;

		for (int other = first; other < end; other++)
			same += terrain->spokes[other] == terrain->spokes[s];
		if (same != 2 || !lies_in(terrain, f, terrain->spokes[s]))
			return false;
	}
	return true;
}

bool rb_terrain_goes_on(const struct rb_terrain *terrain, int facet, rb_vec3 point)
{
	const struct facet f = facet_of(terrain, facet);
	int on[3];
	const int count = edges_at(f.v, f.normal, f.size, point, on);

	if (count == 0)
		return false;
	if (count > 1)
		return corner_goes_on(terrain, &f, terrain->corners[facet][corner_between(on)]);
	const int across = terrain->across[facet][on[0]];
	if (across < 0 || !lies_in(terrain, &f, across))
		return false;
	/* and not back over the facet */
	const rb_vec3 from = f.v[on[0]];
	const rb_vec3 inward = rb_vec3_cross(f.normal, rb_vec3_sub(f.v[(on[0] + 1) % 3], from));
	return rb_vec3_dot(inward, rb_vec3_sub(terrain->vertices[across], from)) < 0;
}

/* m: from a point to a segment. */
static double segment_distance(rb_vec3 a, rb_vec3 b, rb_vec3 point)
{
	const rb_vec3 way = rb_vec3_sub(b, a), to = rb_vec3_sub(point, a);
	const double s = fmin(1, fmax(0, rb_vec3_dot(to, way) / rb_vec3_dot(way, way)));

	return rb_vec3_length(rb_vec3_add_scaled(to, -s, way));
}

double rb_terrain_distance(const rb_vec3 *a, const rb_vec3 *b, const rb_vec3 *c, rb_vec3 point)
{
	const rb_vec3 *const corner[4] = {a, b, c, a};
	const rb_vec3 n = rb_vec3_unit(rb_vec3_cross(rb_vec3_sub(*b, *a), rb_vec3_sub(*c, *a)),
	                               (rb_vec3){0, 0, 1});
	double least = (double)INFINITY;
	bool over = true;

	for (int k = 0; k < 3; k++) {
		const rb_vec3 inward = rb_vec3_cross(n, rb_vec3_sub(*corner[k + 1], *corner[k]));
		over = over && rb_vec3_dot(inward, rb_vec3_sub(point, *corner[k])) >= 0;
		least = fmin(least, segment_distance(*corner[k], *corner[k + 1], point));
	}
	return over ? fabs(rb_vec3_dot(n, rb_vec3_sub(point, *a))) : least;
}
