/* SPDX-License-Identifier: MIT */
/*
 * Redundant contacts: bodies that touch at more points than there are degrees of freedom (a box on
 * four corners) have normal impulses that are determined only up to the null space of the map from
 * impulses to wrenches. Gauss-Seidel leaves the component in the null space at whatever the order
 * of rows has made of it; where contacts slide, that would turn a symmetric box.
 *
 * Of all normal impulses p with the same wrenches A p the one of least norm is the projection of p
 * on the row space of A. It is spanned here by modified Gram-Schmidt with at most one
 * reorthogonalization ("twice is enough": Giraud, Langou, Rozloznik 2005) on the rows of A, six per
 * dynamic body.
 * Cheaper than an SVD, and a row that is dependent is recognized on the way. Where the projection
 * would make an impulse negative, the step towards it is shortened.
 *
 * Where joints hold bodies, A is seen through them: its rows are what motions that the joints allow
 * make of the gaps. Forces of the joints are then found anew (strategies).
 */
#include "stepped/even.h"

#include "base/error.h"
#include "base/forest.h"

/*
 * A friction impulse counts as sliding from this share of mu p on, since after scaling to the
 * cone's edge its length is there only up to rounding.
 */
static const double at_edge = 1 - 1e-9;

/* Whether the friction impulse of a row is at the edge of Coulomb's cone. */
static bool slides(const struct rb_constraint *row)
{
	const double max = at_edge * row->friction * row->impulse.n;

	return row->impulse.n > 0 && row->friction > 0 &&
	       rb_vec3_dot(row->impulse.t, row->impulse.t) >= max * max;
}

/* Rows of one pair of bodies; rows of a pair are adjacent. */
static bool is_pair(const struct rb_constraint *x, const struct rb_constraint *y)
{
	return x->a == y->a && x->b == y->b;
}

static bool is_pushed(const struct rb_constraint *row)
{
	return row->set == RB_CONSTRAINT_CONE && row->impulse.n > 0;
}

/* Where joints hand loads on: all of them, if one slides; returns their number. */
static int take_joined(const struct rb_row_system *rows, struct rb_constraint **taken)
{
	int count = 0;
	bool slide = false;

	for (int k = 0; k < rows->row_count; k++) {
		if (!is_pushed(&rows->row[k]))
			continue;
		slide = slide || slides(&rows->row[k]);
		taken[count++] = &rows->row[k];
	}
	return slide && count > 1 ? count : 0;
}

/*
 * Rows with a normal impulse of those pairs that have several rows and slide at one of them;
 * returns their number.
 */
static int take_rows(const struct rb_row_system *rows, struct rb_constraint **taken)
{
	int count = 0;

	for (int k = 0, end; k < rows->row_count; k = end) {
		struct rb_constraint *const row = &rows->row[k];
		bool slide = false;

		for (end = k; end < rows->row_count && is_pair(row, &rows->row[end]); end++)
			slide = slide || slides(&rows->row[end]);
		for (int i = k; i < end && slide && end - k > 1; i++)
			if (is_pushed(&rows->row[i]))
				taken[count++] = &rows->row[i];
	}
	return count;
}

/*
 * Cost of a pass in multiplications per n^3 if all rows are connected: span_loads takes about 1.5 n
 * vectors (six per body, four points per face), each orthogonalized against up to n units by two
 * products of n, twice.
 */
static const double multiplications = 6;

/*
 * A vector is independent if this share of its length is orthogonal to the span: far above rounding
 * (1e-16 times the number of vectors), far below the ratio of lever arms in any scene.
 */
static const double own_share = 1e-6;

/* What of a vector is not zero: first to end. A load is of the rows of one body only. */
struct part {
	int first, end;
};

/* Orthonormal basis of a subspace of R^n. */
struct span {
	double *unit;      /* [count][n]; beyond its part it is not set */
	struct part *part; /* [count] */
	int n, count;
};

static double dot(const double *x, const double *y, struct part part)
{
	double sum = 0;

	for (int i = part.first; i < part.end; i++)
		sum += x[i] * y[i];
	return sum;
}

/* Takes out of v, of which it may make more than it was, what the span contains. */
static void reject(const struct span *span, double *v, struct part *of)
{
	for (int k = 0; k < span->count; k++) {
		const double *const unit = span->unit + (size_t)k * (size_t)span->n;
		const struct part part = span->part[k];
		const struct part both = {part.first > of->first ? part.first : of->first,
		                          part.end < of->end ? part.end : of->end};
		const double along = dot(v, unit, both);

		/* loads of bodies that share no row */
		if (along == 0)
			continue;
		for (int i = part.first; i < part.end; i++)
			v[i] -= along * unit[i];
		of->first = part.first < of->first ? part.first : of->first;
		of->end = part.end > of->end ? part.end : of->end;
	}
}

/*
 * Adds the direction of v, which is overwritten, unless the span contains it already. What keeps
 * most of its length is orthogonal to rounding after one pass (Daniel, Gragg, Kaufman, Stewart
 * 1976).
 */
static void extend(struct span *span, double *v, struct part part)
{
	const double size = dot(v, v, part);

	RB_ASSERT_COSTLY(span->count < span->n);
	reject(span, v, &part);
	double left = dot(v, v, part);
	if (!(left > 0.5 * size)) {
		reject(span, v, &part);
		left = dot(v, v, part);
	}
	if (!(left > own_share * own_share * size))
		return;
	span->part[span->count] = part;
	double *const unit = span->unit + (size_t)span->count++ * (size_t)span->n;
	const double length = sqrt(left);
	for (int i = part.first; i < part.end; i++)
		unit[i] = v[i] / length;
}

static double component(rb_vec3 v, int k)
{
	return k == 0 ? v.x : k == 1 ? v.y : v.z;
}

/*
 * Row of the matrix A: component `which` (0 to 2 force, 3 to 5 torque) of the wrench on a body per
 * unit of each impulse; v is [n]. Returns where it is not zero.
 */
static struct part load(struct rb_constraint *const *taken, int n, int body, int which, double *v)
{
	struct part part = {n, 0};

	for (int i = 0; i < n; i++) {
		const struct rb_constraint *row = taken[i];
		const bool is_a = row->a == body;
		const rb_vec3 arm = is_a ? row->arm_a : row->arm_b;

		v[i] = 0;
		if (!is_a && row->b != body)
			continue;
		const double size = which < 3
		                            ? component(row->normal, which)
		                            : component(rb_vec3_cross(arm, row->normal), which - 3);
		v[i] = is_a ? -size : size;
		part.first = i < part.first ? i : part.first;
		part.end = i + 1;
	}
	return part;
}

/* Whether a row is of the same bodies as the one before it. */
static bool goes_on(struct rb_constraint *const *taken, int i)
{
	return i > 0 && is_pair(taken[i - 1], taken[i]);
}

/* ---- what is determined ---- */

/*
 * A pair whose points are few enough, and far enough apart, that what they do to a body says how
 * much each of them bears: this share of their distances is the least by which three are beside a
 * line, or two beside a normal. Below it they stay with the rest; decides cost only.
 */
static const double clear_share = 0x1p-10;

static bool same_normal(const struct rb_constraint *x, const struct rb_constraint *y)
{
	return x->normal.x == y->normal.x && x->normal.y == y->normal.y &&
	       x->normal.z == y->normal.z;
}

static bool is_dynamic(const struct rb_row_system *rows, int body)
{
	return rows->bodies.body[body].inverse_mass != 0;
}

static bool is_determined(const struct rb_row_system *rows, struct rb_constraint *const *taken,
                          int first, int end)
{
	const struct rb_constraint *const row = taken[first];
	const bool of_a = is_dynamic(rows, row->a);
	rb_vec3 way[2];

	if (end - first > 3)
		return false;
	for (int i = first + 1; i < end; i++) {
		const rb_vec3 d = of_a ? rb_vec3_sub(taken[i]->arm_a, row->arm_a)
		                       : rb_vec3_sub(taken[i]->arm_b, row->arm_b);

		way[i - first - 1] = rb_vec3_reject(d, row->normal);
		if (!same_normal(taken[i], row) ||
		    !(rb_vec3_length(way[i - first - 1]) > clear_share * rb_vec3_length(d)))
			return false;
	}
	return end - first < 3 ||
	       rb_vec3_length(rb_vec3_cross(way[0], way[1])) >
	               clear_share * rb_vec3_length(way[0]) * rb_vec3_length(way[1]);
}

/* Rows of one pair, first to end; `alone`: what is open of it is open of no other. */
struct touch {
	int first, end;
	bool alone;
};

/*
 * One after the other, pairs are alone of which one body has no other: what leaves that body as it
 * is leaves the other one, too. Those that are determined are left out, of the rest `alone` is set,
 * by row. Returns the number of rows left.
 */
static int without_determined(const struct rb_row_system *rows, struct rb_constraint **taken, int n,
                              unsigned char *alone, struct rb_arena *arena)
{
	struct touch *const touch = rb_arena_take(arena, (size_t)n, sizeof *touch);
	int touches = 0, max = 0, left = 0;
	bool any = true;

	for (int i = 0; i < n; i++) {
		max = taken[i]->a > max ? taken[i]->a : max;
		max = taken[i]->b > max ? taken[i]->b : max;
	}
	int *const pairs = rb_arena_take(arena, (size_t)max + 1, sizeof *pairs);
	if (!touch || !pairs)
		return -1;
	for (int i = 0; i < n; i++)
		pairs[taken[i]->a] = pairs[taken[i]->b] = 0;
	for (int i = 0, end; i < n; i = end) {
		end = i + 1;
		while (end < n && goes_on(taken, end))
			end++;
		touch[touches++] = (struct touch){i, end, false};
		pairs[taken[i]->a]++;
		pairs[taken[i]->b]++;
	}
	while (any) {
		any = false;
		for (int k = 0; k < touches; k++) {
			const struct rb_constraint *const row = taken[touch[k].first];

			if (touch[k].alone || !((pairs[row->a] == 1 && is_dynamic(rows, row->a)) ||
			                        (pairs[row->b] == 1 && is_dynamic(rows, row->b))))
				continue;
			touch[k].alone = any = true;
			pairs[row->a]--;
			pairs[row->b]--;
		}
	}
	for (int k = 0; k < touches; k++) {
		const bool out = touch[k].alone &&
		                 is_determined(rows, taken, touch[k].first, touch[k].end);

		for (int i = touch[k].first; i < touch[k].end && !out; i++) {
			alone[left] = touch[k].alone;
			taken[left++] = taken[i];
		}
	}
	return left;
}

/* Row space of A: six rows for each dynamic body, each body once, until it is all of R^n. */
static void span_loads(const struct rb_row_system *rows, struct rb_constraint *const *taken,
                       struct span *span, double *scratch)
{
	/* of one pair what acts on one body is what acts on the other */
	const bool single = is_pair(taken[0], taken[span->n - 1]);
	const int count = single && rows->bodies.body[taken[0]->a].inverse_mass != 0 ? 1 : 2;

	for (int k = 0; k < span->n; k++) {
		const int ends[2] = {taken[k]->a, taken[k]->b};

		for (int e = goes_on(taken, k) ? count : 0; e < count; e++) {
			bool seen = rows->bodies.body[ends[e]].inverse_mass == 0;

			for (int i = 0; i < k && !seen; i++)
				seen = taken[i]->a == ends[e] || taken[i]->b == ends[e];
			for (int which = 0; which < 6 && !seen; which++) {
				if (span->count == span->n)
					return;
				const struct part part = load(taken, span->n, ends[e], which,
				                              scratch);
				extend(span, scratch, part);
			}
		}
	}
}

/* ---- joints ---- */

/*
 * What bodies that joints connect can do: a row for each of their six motions, of what it makes of
 * the rows of joints, `held` of them, and then of the normals of contacts. Motions that joints
 * allow are what elimination of the former leaves.
 */
struct motions {
	double *row;       /* [count][held + n] */
	int *body;         /* [count / 6], that yield */
	double *pivot_max; /* [held]: the largest of each column to begin with */
	int count, held, n;
};

static bool is_listed(const struct motions *motions, int body)
{
	for (int k = 0; 6 * k < motions->count; k++)
		if (motions->body[k] == body)
			return true;
	return false;
}

/* Directions in which a row of a joint holds: what is soft or at its bound gives way. */
static int held_by(const struct rb_constraint *row)
{
	if (row->set == RB_CONSTRAINT_FREE)
		return 3;
	return row->set == RB_CONSTRAINT_INTERVAL && row->softness == 0 &&
	       row->impulse.n > row->low && row->impulse.n < row->high;
}

static void list_bodies(const struct rb_row_system *rows, struct motions *motions)
{
	for (int k = 0; k < rows->row_count; k++) {
		const int ends[2] = {rows->row[k].a, rows->row[k].b};

		motions->held += held_by(&rows->row[k]);
		for (int e = 0; e < 2; e++) {
			if (rows->bodies.body[ends[e]].inverse_mass == 0 ||
			    is_listed(motions, ends[e]))
				continue;
			motions->body[motions->count / 6] = ends[e];
			motions->count += 6;
		}
	}
}

/* Velocity along a direction of a row by motion `which` of a body, at 1 m/s of its surface. */
static double velocity_by(const struct rb_row_system *rows, const struct rb_constraint *row,
                          rb_vec3 along, int body, int which)
{
	const rb_vec3 unit = {which % 3 == 0, which % 3 == 1, which % 3 == 2};
	const bool is_a = row->a == body;
	const double sign = is_a ? -1 : 1;

	if (!is_a && row->b != body)
		return 0;
	if (which < 3)
		return row->couple ? 0 : sign * rb_vec3_dot(unit, along);
	const rb_vec3 turn = rb_solver_turn(&rows->bodies, body, unit);
	const double per_m = sqrt(rb_vec3_dot(turn, unit) / rows->bodies.body[body].inverse_mass);
	if (row->couple)
		return sign * per_m * row->arm_a.x * rb_vec3_dot(unit, along);
	const rb_vec3 arm = is_a ? rb_constraint_arm_a(row) : rb_constraint_arm_b(row);
	return sign * per_m * rb_vec3_dot(rb_vec3_cross(unit, arm), along);
}

static void fill_motion(const struct rb_row_system *rows, struct rb_constraint *const *taken,
                        struct motions *motions, int number)
{
	static const rb_vec3 axis[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
	const int body = motions->body[number / 6], which = number % 6;
	double *const v = motions->row + (size_t)number * (size_t)(motions->held + motions->n);
	int column = 0;

	for (int k = 0; k < rows->row_count; k++) {
		const struct rb_constraint *row = &rows->row[k];
		const int count = held_by(row);

		for (int c = 0; c < count; c++, column++) {
			v[column] = velocity_by(rows, row, count == 3 ? axis[c] : row->normal, body,
			                        which);
			motions->pivot_max[column] = fmax(motions->pivot_max[column],
			                                  fabs(v[column]));
		}
	}
	for (int i = 0; i < motions->n; i++)
		v[column + i] = velocity_by(rows, taken[i], taken[i]->normal, body, which);
}

static void swap(double *x, double *y, int n)
{
	for (int i = 0; i < n; i++) {
		const double was = x[i];

		x[i] = y[i];
		y[i] = was;
	}
}

/*
 * Eliminates the largest element of what joints hold from the motions after `done`; false: these
 * are free.
 */
static bool eliminate_one(struct motions *motions, int done)
{
	const int width = motions->held + motions->n;
	double *const first = motions->row + (size_t)done * (size_t)width;
	double max = own_share;
	int row = -1, column = 0;

	for (int k = done; k < motions->count; k++)
		for (int c = 0; c < motions->held; c++) {
			const double size = fabs(
				motions->row[(size_t)k * (size_t)width + (size_t)c]);

			if (!(size > max * motions->pivot_max[c]))
				continue;
			max = size / motions->pivot_max[c];
			row = k;
			column = c;
		}
	if (row < 0)
		return false;
	if (row != done)
		swap(first, motions->row + (size_t)row * (size_t)width, width);
	for (int k = done + 1; k < motions->count; k++) {
		double *const v = motions->row + (size_t)k * (size_t)width;
		const double share = v[column] / first[column];

		for (int i = 0; share != 0 && i < width; i++)
			v[i] -= share * first[i];
		v[column] = 0;
	}
	return true;
}

/* Spans what motions that joints allow make of the normals; false: too much work, or no memory. */
static bool span_allowed(const struct rb_row_system *rows, struct rb_constraint *const *taken,
                         struct span *span, double max, struct rb_arena *arena)
{
	struct motions motions = {.n = span->n};
	int done = 0;

	motions.body = rb_arena_take(arena, 2 * (size_t)rows->row_count, sizeof *motions.body);
	if (!motions.body)
		return false;
	list_bodies(rows, &motions);
	const int width = motions.held + motions.n;
	const double size = (double)motions.count * (double)width;
	if (size * fmin((double)motions.count, (double)motions.held) > max)
		return false;
	motions.row = rb_arena_take(arena, (size_t)motions.count * (size_t)width,
	                            sizeof *motions.row);
	motions.pivot_max = rb_arena_take(arena, (size_t)motions.held + 1,
	                                  sizeof *motions.pivot_max);
	if (!motions.row || !motions.pivot_max)
		return false;
	for (int c = 0; c < motions.held; c++)
		motions.pivot_max[c] = 0;
	for (int k = 0; k < motions.count; k++)
		fill_motion(rows, taken, &motions, k);
	while (done < motions.count && eliminate_one(&motions, done))
		done++;
	for (; done < motions.count && span->count < span->n; done++) {
		double *const v = motions.row + (size_t)done * (size_t)width + motions.held;
		const struct part whole = {0, span->n};

		/* of what joints leave no motion to: rounding */
		if (dot(v, v, whole) > own_share * own_share)
			extend(span, v, whole);
	}
	return true;
}

/* ---- pushes ---- */

/*
 * Sets the normal impulse of a row and scales its friction to stay in the cone (sliding friction
 * stays at the edge). Returns the largest change of velocity in m/s that this makes at the contact.
 */
static double put(const struct rb_row_system *rows, struct rb_constraint *row,
                  double normal_impulse)
{
	RB_ASSERT_COSTLY(row->impulse.n > 0 && normal_impulse >= 0);
	const double share = normal_impulse / row->impulse.n, max = row->friction * normal_impulse;
	const double square = rb_vec3_dot(row->impulse.t, row->impulse.t);
	rb_vec3 friction_impulse = row->impulse.t;

	/* an impulse that was next to nothing grows, and with it what is left along the normal */
	if (slides(row))
		friction_impulse = rb_vec3_scale(share,
		                                 rb_vec3_reject(friction_impulse, row->normal));
	else if (square > max * max)
		friction_impulse = rb_vec3_scale(max / sqrt(square), friction_impulse);
	const rb_vec3 change = rb_vec3_add_scaled(rb_vec3_sub(friction_impulse, row->impulse.t),
	                                          normal_impulse - row->impulse.n, row->normal);
	row->impulse.n = normal_impulse;
	row->impulse.t = friction_impulse;
	rb_constraint_apply(&rows->bodies, row, change);
	return row->inverse_mass_n * rb_vec3_length(change);
}

/* Whether two rows act on the same body that moves. */
static bool share_a_body(const struct rb_row_system *rows, const struct rb_constraint *x,
                         const struct rb_constraint *y)
{
	return ((x->a == y->a || x->a == y->b) && rows->bodies.body[x->a].inverse_mass != 0) ||
	       ((x->b == y->a || x->b == y->b) && rows->bodies.body[x->b].inverse_mass != 0);
}

/* Rows that bodies connect, as trees: nothing of one is orthogonalized against another. */
static void connect(const struct rb_row_system *rows, struct rb_constraint *const *taken,
                    const unsigned char *alone, int n, int *parent)
{
	for (int i = 0; i < n; i++) {
		const bool same = goes_on(taken, i);

		parent[i] = same ? rb_forest_root(parent, i - 1) : i;
		for (int k = 0; k < i && !same && !alone[i]; k++) {
			if (alone[k] || goes_on(taken, k) ||
			    !share_a_body(rows, taken[i], taken[k]))
				continue;
			const int other = rb_forest_root(parent, k),
				  own = rb_forest_root(parent, i);

			if (own != other)
				parent[own > other ? own : other] = own < other ? own : other;
		}
	}
}

/* What a pass works on: [n] all of these, `store` [n][n]. */
struct pass {
	struct rb_constraint **part; /* the connected rows under way */
	int *place;                  /* theirs among all */
	double *store, *scratch, *normal_impulse, *even;
	struct part *parts;
};

/* Normal impulses of the least norm of those with the same share in a span. */
static void project(struct pass *pass, const struct span *span)
{
	const int n = span->n;

	for (int i = 0; i < n; i++)
		pass->normal_impulse[i] = pass->part[i]->impulse.n;
	for (int i = 0; i < n && span->count == n; i++)
		pass->even[pass->place[i]] = pass->normal_impulse[i];
	for (int k = 0; k < span->count && span->count < n; k++) {
		const double *const unit = span->unit + (size_t)k * (size_t)n;
		const struct part part = span->part[k];
		const double along = dot(pass->normal_impulse, unit, part);

		for (int i = part.first; i < part.end; i++)
			pass->even[pass->place[i]] += along * unit[i];
	}
}

/* The same of connected rows; returns the rank of their loads. */
static int even_part(const struct rb_row_system *rows, struct pass *pass, int n)
{
	struct span span = {.unit = pass->store, .part = pass->parts, .n = n};

	span_loads(rows, pass->part, &span, pass->scratch);
	project(pass, &span);
	return span.count;
}

/* The same where joints connect bodies; false: nothing is open, or it costs too much. */
static bool even_joined(const struct rb_row_system *rows, struct rb_constraint *const *taken,
                        struct pass *pass, int n, double max, struct rb_arena *arena)
{
	struct span span = {.unit = pass->store, .part = pass->parts, .n = n};

	for (int i = 0; i < n; i++) {
		pass->part[i] = taken[i];
		pass->place[i] = i;
		pass->even[i] = 0;
	}
	if (!span_allowed(rows, taken, &span, max, arena) || span.count == n)
		return false;
	project(pass, &span);
	return true;
}

/* The same of all rows, one connected part after the other. */
static int even_all(const struct rb_row_system *rows, struct rb_constraint *const *taken,
                    const unsigned char *alone, int n, struct pass *pass, int *parent)
{
	int rank = 0;

	connect(rows, taken, alone, n, parent);
	for (int i = 0; i < n; i++)
		pass->even[i] = 0;
	for (int root = 0; root < n; root++) {
		int count = 0;

		for (int i = root; i < n && parent[root] == root; i++) {
			if (rb_forest_root(parent, i) != root)
				continue;
			pass->part[count] = taken[i];
			pass->place[count++] = i;
		}
		rank += count > 0 ? even_part(rows, pass, count) : 0;
	}
	return rank;
}

static bool has_joints(const struct rb_row_system *rows)
{
	return rows->row_count > 0 && rows->row[rows->row_count - 1].set != RB_CONSTRAINT_CONE;
}

bool rb_even(const struct rb_row_system *rows, double tolerance, double max, struct rb_arena *arena)
{
	const size_t all = (size_t)rows->row_count;
	const bool joined = has_joints(rows);
	struct rb_constraint **const taken = rb_arena_take(arena, all,
	                                                   sizeof(struct rb_constraint *));
	double share = 1, changed = 0;

	if (!taken)
		return false;
	const int count = joined ? take_joined(rows, taken) : take_rows(rows, taken);
	const double cube = (double)count * (double)count * (double)count;
	if (count == 0 || multiplications * cube > max)
		return false;
	unsigned char *const alone = rb_arena_take(arena, (size_t)count, 1);
	if (!alone)
		return false;
	const int n = joined ? count : without_determined(rows, taken, count, alone, arena);
	const size_t size = (size_t)n;
	if (n <= 0)
		return false;
	struct pass pass = {.part = rb_arena_take(arena, size, sizeof *pass.part),
	                    .place = rb_arena_take(arena, 2 * size, sizeof *pass.place),
	                    .store = rb_arena_take(arena, (size + 3) * size, sizeof *pass.store)};
	pass.parts = rb_arena_take(arena, size, sizeof *pass.parts);
	if (!pass.part || !pass.place || !pass.store || !pass.parts)
		return false;
	pass.scratch = pass.store + size * size;
	pass.normal_impulse = pass.scratch + n;
	pass.even = pass.normal_impulse + n;
	if (joined ? !even_joined(rows, taken, &pass, n, max, arena)
	           : even_all(rows, taken, alone, n, &pass, pass.place + n) == n)
		return false;
	for (int i = 0; i < n; i++)
		if (pass.even[i] < 0)
			share = fmin(share,
			             taken[i]->impulse.n / (taken[i]->impulse.n - pass.even[i]));
	for (int i = 0; i < n; i++) {
		const double normal_impulse = taken[i]->impulse.n;

		changed = fmax(changed, put(rows, taken[i],
		                            fmax(0, normal_impulse + share * (pass.even[i] -
		                                                              normal_impulse))));
	}
	RB_ASSERT(share >= 0 && share <= 1);
	return changed > tolerance;
}
