/* SPDX-License-Identifier: MIT */
/*
 * Sides of faces are sorted by their two vertices; neighbours in that order are the two sides of
 * one edge, which yields edges, flanking faces and the Gauss map arcs in one pass. A half-edge
 * structure is not used: nothing walks around a vertex, all queries go through support functions
 * and edge lists.
 */
#include "geom/polytope.h"

#include "base/error.h"
#include "base/memory.h"

#include <stdlib.h>

/* A side of a face: its vertices in order of number, and the face. */
typedef struct {
	int low, high, face;
} side;

/*
 * Allocates; `loop` is the number of sides of all faces, each edge has two. A segment has one edge.
 */
static enum rb_status take(struct rb_polytope **polytope, int vertices, int faces, int loop,
                           struct rb_error *err)
{
	struct rb_polytope *p = rb_memory_take(1, sizeof *p);
	const int edges = loop > 1 ? loop / 2 : 1;

	*polytope = NULL;
	if (!p)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot keep a convex shape");
	p->vertices = rb_memory_take((size_t)vertices, sizeof *p->vertices);
	p->faces = rb_memory_take((size_t)faces, sizeof *p->faces);
	p->loop = rb_memory_take((size_t)loop, sizeof *p->loop);
	p->edges = rb_memory_take((size_t)edges, sizeof *p->edges);
	p->flanks = rb_memory_take((size_t)edges, sizeof *p->flanks);
	p->arcs = rb_memory_take((size_t)(2 * edges + 1), sizeof *p->arcs);
	if (!p->vertices || !p->faces || !p->loop || !p->edges || !p->flanks || !p->arcs) {
		rb_polytope_destroy(p);
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot keep a convex shape of %d vertices",
		               vertices);
	}
	p->vertex_count = vertices;
	p->face_count = faces;
	p->loop_count = loop;
	*polytope = p;
	return RB_OK;
}

void rb_polytope_destroy(struct rb_polytope *polytope)
{
	if (!polytope)
		return;
	rb_memory_free(polytope->vertices);
	rb_memory_free(polytope->faces);
	rb_memory_free(polytope->loop);
	rb_memory_free(polytope->edges);
	rb_memory_free(polytope->flanks);
	rb_memory_free(polytope->arcs);
	rb_memory_free(polytope);
}

/*
 * Adds the arc of directions between the normals n0 and n1 at an edge, less than half a turn apart.
 */
static void add_arc(struct rb_polytope *p, const int vertex[2], rb_vec3 n0, rb_vec3 n1)
{
	const rb_vec3 d = rb_vec3_unit(rb_vec3_sub(p->vertices[vertex[1]], p->vertices[vertex[0]]),
	                               (rb_vec3){0, 0, 1});
	const double sense = rb_vec3_dot(rb_vec3_cross(n0, n1), d) < 0 ? -1 : 1;

	/*
	 * Bounding planes of the arc, recomputed across `along`: the component of the normals along
	 * the edge is rounding.
	 */
	p->arcs[p->arc_count++] = (rb_polytope_arc){
		.vertex = {vertex[0], vertex[1]},
		.along = d,
		.inner = {rb_vec3_scale(sense, rb_vec3_cross(d, n0)),
	                  rb_vec3_scale(sense, rb_vec3_cross(n1, d))},
	};
}

/* Reach and mean of the vertices. */
static void measure(struct rb_polytope *p)
{
	p->reach = 0;
	p->middle = (rb_vec3){0, 0, 0};
	for (int i = 0; i < p->vertex_count; i++) {
		p->reach = fmax(p->reach, rb_vec3_length(p->vertices[i]));
		p->middle = rb_vec3_add_scaled(p->middle, 1.0 / p->vertex_count, p->vertices[i]);
	}
}

/*
 * Unit normal of a face by Newell's sum over its loop, about its first vertex and in units of its
 * size against overflow; false where the face has no area.
 */
static bool face_normal(struct rb_polytope *p, rb_polytope_face *f)
{
	const int *loop = p->loop + f->first;
	const rb_vec3 origin = p->vertices[loop[0]];
	double size = 0;
	rb_vec3 sum = {0, 0, 0};

	for (int i = 1; i < f->count; i++)
		size = fmax(size, rb_vec3_max_abs(rb_vec3_sub(p->vertices[loop[i]], origin)));
	if (!(size > 0))
		return false;
	for (int i = 1; i + 1 < f->count; i++) {
		const rb_vec3 u = rb_vec3_scale(1 / size,
		                                rb_vec3_sub(p->vertices[loop[i]], origin));
		const rb_vec3 v = rb_vec3_scale(1 / size,
		                                rb_vec3_sub(p->vertices[loop[i + 1]], origin));
		sum = rb_vec3_add(sum, rb_vec3_cross(u, v));
	}
	f->normal = rb_vec3_unit(sum, (rb_vec3){0, 0, 0});
	return rb_vec3_dot(f->normal, f->normal) > 0.5;
}

/*
 * Arcs of an edge of a flat body, which has the two normals +-normal: through the outward direction
 * in its plane, since the arc of half a turn has no unique pole.
 */
static void add_flat_arcs(struct rb_polytope *p, const int vertex[2], rb_vec3 normal)
{
	const rb_vec3 d = rb_vec3_sub(p->vertices[vertex[1]], p->vertices[vertex[0]]);
	const rb_vec3 out = rb_vec3_unit(rb_vec3_cross(d, normal), normal);

	add_arc(p, vertex, normal, out);
	add_arc(p, vertex, out, rb_vec3_neg(normal));
}

/* Order of sides: edge, then face. */
static int by_edge(const void *x, const void *y)
{
	const side *a = x, *b = y;

	if (a->low != b->low)
		return a->low < b->low ? -1 : 1;
	if (a->high != b->high)
		return a->high < b->high ? -1 : 1;
	return a->face < b->face ? -1 : a->face > b->face;
}

/*
 * Joins the sorted sides to edges; RB_ERR_SCENE unless each edge has two sides of different faces.
 */
static enum rb_status pair_sides(struct rb_polytope *p, const side *sides, struct rb_error *err)
{
	for (int i = 0; i < p->loop_count; i += 2) {
		const side *s = sides + i;
		const int vertex[2] = {s->low, s->high};
		const bool last = i + 2 >= p->loop_count;
		if (i + 1 >= p->loop_count || s[1].low != s->low || s[1].high != s->high ||
		    s[1].face == s->face || (!last && s[2].low == s->low && s[2].high == s->high))
			return RB_FAIL(err, RB_ERR_SCENE,
			               "edge %d-%d of a convex shape is not that of two faces",
			               s->low, s->high);
		RB_ASSERT(s->low < s->high && p->arc_count + 2 <= 2 * (p->loop_count / 2) + 1);
		p->flanks[p->edge_count][0] = s->face;
		p->flanks[p->edge_count][1] = s[1].face;
		p->edges[p->edge_count][0] = s->low;
		p->edges[p->edge_count++][1] = s->high;
		const rb_vec3 n0 = p->faces[s->face].normal, n1 = p->faces[s[1].face].normal;
		if (p->face_count > 2) {
			add_arc(p, vertex, n0, n1);
			continue;
		}
		/* a flat: the edge in the sense of its first face */
		const int *loop = p->loop;
		int at = 0;
		while (loop[at] != s->low)
			at++;
		const bool forward = loop[(at + 1) % p->faces[0].count] == s->high;
		const int sense[2] = {forward ? s->low : s->high, forward ? s->high : s->low};
		add_flat_arcs(p, sense, p->faces[0].normal);
	}
	return RB_OK;
}

/* Copies the definition and works out normals, edges and arcs. */
static enum rb_status fill(struct rb_polytope *p, const rb_polytope_def *def, struct rb_error *err)
{
	for (int i = 0; i < p->vertex_count; i++)
		p->vertices[i] = def->vertices[i];
	for (int i = 0; i < p->loop_count; i++) {
		if (def->loop[i] < 0 || def->loop[i] >= p->vertex_count)
			return RB_FAIL(err, RB_ERR_SCENE, "a convex shape has no vertex %d",
			               def->loop[i]);
		p->loop[i] = def->loop[i];
	}
	measure(p);
	for (int f = 0, first = 0; f < p->face_count; first += def->counts[f++]) {
		p->faces[f].first = first;
		p->faces[f].count = def->counts[f];
		if (!face_normal(p, &p->faces[f]))
			return RB_FAIL(err, RB_ERR_SCENE, "face %d of a convex shape has no area",
			               f);
	}
	side *sides = rb_memory_take((size_t)p->loop_count, sizeof *sides);
	if (!sides)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot sort the edges of a convex shape");
	int count = 0;
	for (int f = 0; f < p->face_count; f++) {
		const int *loop = p->loop + p->faces[f].first;
		for (int i = 0; i < p->faces[f].count; i++) {
			const int v = loop[i], w = loop[(i + 1) % p->faces[f].count];
			sides[count++] = (side){v < w ? v : w, v < w ? w : v, f};
		}
	}
	qsort(sides, (size_t)count, sizeof *sides, by_edge);
	const enum rb_status status = pair_sides(p, sides, err);
	rb_memory_free(sides);
	return status;
}

enum rb_status rb_polytope_create(struct rb_polytope **polytope, const rb_polytope_def *def,
                                  struct rb_error *err)
{
	int loop = 0;

	*polytope = NULL;
	if (def->vertex_count < 3 || def->vertex_count > RB_POLYTOPE_VERTICES_MAX ||
	    def->face_count < 2)
		return RB_FAIL(err, RB_ERR_SCENE,
		               "a convex shape of %d vertices and %d faces is none",
		               def->vertex_count, def->face_count);
	for (int f = 0; f < def->face_count; f++) {
		if (def->counts[f] < 3 || def->counts[f] > def->vertex_count)
			return RB_FAIL(err, RB_ERR_SCENE,
			               "face %d of a convex shape has %d vertices", f,
			               def->counts[f]);
		if (loop > 8 * RB_POLYTOPE_VERTICES_MAX)
			return RB_FAIL(err, RB_ERR_SCENE, "a convex shape has too many edges");
		loop += def->counts[f];
	}
	enum rb_status status = take(polytope, def->vertex_count, def->face_count, loop, err);
	if (status != RB_OK)
		return status;
	status = fill(*polytope, def, err);
	if (status != RB_OK) {
		rb_polytope_destroy(*polytope);
		*polytope = NULL;
	}
	return status;
}

enum rb_status rb_polytope_create_box(struct rb_polytope **polytope, rb_vec3 half,
                                      struct rb_error *err)
{
	RB_ASSERT(half.x >= 0 && half.y >= 0 && half.z >= 0);

	/* +x, -x, +y, -y, +z, -z; vertex i has its coordinates negated by the bits of i */
	static const int counts[6] = {4, 4, 4, 4, 4, 4};
	static const int loop[24] = {0, 2, 6, 4, 1, 5, 7, 3, 0, 4, 5, 1,
	                             2, 3, 7, 6, 0, 1, 3, 2, 4, 6, 7, 5};
	rb_vec3 vertices[8];

	for (int i = 0; i < 8; i++)
		vertices[i] = (rb_vec3){i & 1 ? -half.x : half.x, i & 2 ? -half.y : half.y,
		                        i & 4 ? -half.z : half.z};
	const rb_polytope_def def = {8, 6, vertices, counts, loop};
	const enum rb_status status = rb_polytope_create(polytope, &def, err);
	if (status == RB_OK) {
		(*polytope)->box = true;
		(*polytope)->half = half;
	}
	return status;
}

enum rb_status rb_polytope_create_rectangle(struct rb_polytope **polytope, double half_x,
                                            double half_y, struct rb_error *err)
{
	static const int counts[2] = {4, 4};
	static const int loop[8] = {0, 1, 2, 3, 3, 2, 1, 0};
	const rb_vec3 vertices[4] = {{half_x, half_y, 0},
	                             {-half_x, half_y, 0},
	                             {-half_x, -half_y, 0},
	                             {half_x, -half_y, 0}};
	const rb_polytope_def def = {4, 2, vertices, counts, loop};

	return rb_polytope_create(polytope, &def, err);
}

enum rb_status rb_polytope_create_segment(struct rb_polytope **polytope, double half_length,
                                          struct rb_error *err)
{
	const int vertex[2] = {0, 1};
	const enum rb_status status = take(polytope, half_length > 0 ? 2 : 1, 0, 0, err);

	if (status != RB_OK || !(half_length > 0))
		return status;
	struct rb_polytope *p = *polytope;
	p->vertices[0] = (rb_vec3){0, 0, half_length};
	p->vertices[1] = (rb_vec3){0, 0, -half_length};
	p->edge_count = 1;
	p->edges[0][1] = 1;
	measure(p);
	/* Three arcs of 120 degrees around the segment: each must be less than half a turn. */
	const double s = sqrt(0.75);
	const rb_vec3 n[3] = {{1, 0, 0}, {-0.5, s, 0}, {-0.5, -s, 0}};
	for (int i = 0; i < 3; i++)
		add_arc(p, vertex, n[i], n[(i + 1) % 3]);
	return RB_OK;
}

/* Vertices of an edge differ in one bit; it is the number that a search of all would find. */
static int box_edge(int low, int high)
{
	static const signed char of[7][3] = {{0, 1, 2},  {-1, 3, 4},   {5, -1, 6},  {-1, -1, 7},
	                                     {8, 9, -1}, {-1, 10, -1}, {11, -1, -1}};
	const int bit = low ^ high;

	return bit == 1 || bit == 2 || bit == 4 ? of[low][bit >> 1] : -1;
}

int rb_polytope_edge(const struct rb_polytope *p, int v, int w)
{
	RB_ASSERT_COSTLY(v >= 0 && v < p->vertex_count && w >= 0 && w < p->vertex_count);

	const int low = v < w ? v : w, high = v < w ? w : v;
	int from = 0, to = p->edge_count;

	if (p->box)
		return box_edge(low, high);

	/* binary search: pair_sides leaves the edges sorted */
	while (from < to) {
		const int at = (from + to) / 2;
		const int *edge = p->edges[at];
		if (edge[0] < low || (edge[0] == low && edge[1] < high))
			from = at + 1;
		else
			to = at;
	}
	return from < p->edge_count && p->edges[from][0] == low && p->edges[from][1] == high ? from
	                                                                                     : -1;
}

int rb_polytope_support(const struct rb_polytope *polytope, rb_vec3 direction)
{
	RB_ASSERT_COSTLY(polytope->vertex_count > 0);

	/* a zero component takes the positive side, as the first of several vertices does below */
	if (polytope->box)
		return (direction.x < 0) | (direction.y < 0) << 1 | (direction.z < 0) << 2;
	int best = 0;
	double max = rb_vec3_dot(direction, polytope->vertices[0]);
	for (int i = 1; i < polytope->vertex_count; i++) {
		const double height = rb_vec3_dot(direction, polytope->vertices[i]);
		if (height > max) {
			max = height;
			best = i;
		}
	}
	return best;
}
