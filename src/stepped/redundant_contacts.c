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
 * would make impulses negative, those of the least norm that are not are found by their active set:
 * the span takes products over what bears alone, and says of the others which of them would help.
 * They depend on nothing but the wrenches, so on no order, nor on which corner had borne nothing.
 *
 * Where joints hold bodies, A is seen through them: its rows are what motions that the joints allow
 * make of the gaps. Forces of the joints are then found anew (strategies).
 */
#include "stepped/redundant_contacts.h"

#include <float.h>

#include "base/error.h"
#include "base/forest.h"
#include "stepped/wrench_span.h"

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

/*
 * Whether a contact bears something, or could: its gap is closed, up to `tolerance`, m/s. One that
 * is open bears nothing in any solution.
 */
static bool may_bear(const struct rb_row_system *rows, const struct rb_constraint *row,
                     double tolerance)
{
	if (row->set != RB_CONSTRAINT_CONE || row->impulse.n > 0)
		return row->set == RB_CONSTRAINT_CONE;
	return rb_vec3_dot(rb_constraint_velocity(&rows->bodies, row), row->normal) -
	               row->target.n <=
	       tolerance;
}

/* Where joints hand loads on: all of them, if one slides; returns their number. */
static int take_joined(const struct rb_row_system *rows, double tolerance,
                       struct rb_constraint **taken)
{
	int count = 0;
	bool slide = false;

	for (int k = 0; k < rows->row_count; k++) {
		if (!may_bear(rows, &rows->row[k], tolerance))
			continue;
		slide = slide || slides(&rows->row[k]);
		taken[count++] = &rows->row[k];
	}
	return slide && count > 1 ? count : 0;
}

/*
 * Rows that may bear something of those pairs that have several rows and slide at one of them;
 * returns their number.
 */
static int take_rows(const struct rb_row_system *rows, double tolerance,
                     struct rb_constraint **taken)
{
	int count = 0;

	for (int k = 0, end; k < rows->row_count; k = end) {
		struct rb_constraint *const row = &rows->row[k];
		bool slide = false;

		for (end = k; end < rows->row_count && rb_wrench_span_is_pair(row, &rows->row[end]);
		     end++)
			slide = slide || slides(&rows->row[end]);
		for (int i = k; i < end && slide && end - k > 1; i++)
			if (may_bear(rows, &rows->row[i], tolerance))
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
		while (end < n && rb_wrench_span_goes_on(taken, end))
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

/* ---- pushes ---- */

/*
 * What slides adds across the normal for each unit along it; zero for what does not. What bears
 * nothing yet is going to do so against its slip.
 */
static rb_vec3 following(const struct rb_row_system *rows, const struct rb_constraint *row)
{
	rb_vec3 way = {0, 0, 0};

	if (slides(row))
		way = rb_vec3_reject(row->impulse.t, row->normal);
	else if (row->impulse.n == 0 && row->friction > 0)
		way = rb_vec3_neg(
			rb_vec3_reject(rb_constraint_velocity(&rows->bodies, row), row->normal));
	const double length = rb_vec3_length(way);
	return length > 0 ? rb_vec3_scale(row->friction / length, way) : (rb_vec3){0, 0, 0};
}

/*
 * Sets the normal impulse of a row, and what follows it across; friction that does not slide stays
 * within the cone. Returns the largest change of velocity in m/s that this makes at the contact.
 */
static double put(const struct rb_row_system *rows, struct rb_constraint *row, rb_vec3 follows,
                  double normal_impulse)
{
	RB_ASSERT_COSTLY(row->impulse.n >= 0 && normal_impulse >= 0);
	const rb_vec3 friction_impulse = rb_vec3_max_abs(follows) > 0
	                                         ? rb_vec3_scale(normal_impulse, follows)
	                                         : rb_constraint_within(row->impulse.t,
	                                                                row->friction *
	                                                                        normal_impulse);
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
		const bool same = rb_wrench_span_goes_on(taken, i);

		parent[i] = same ? rb_forest_root(parent, i - 1) : i;
		for (int k = 0; k < i && !same && !alone[i]; k++) {
			if (alone[k] || rb_wrench_span_goes_on(taken, k) ||
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
	const struct rb_row_system *rows;
	struct rb_constraint **part; /* the connected rows under way */
	const rb_vec3 *follows;      /* of all: what slides adds for each unit along the normal */
	int *place;                  /* theirs among all */
	double *store, *scratch, *on, *normal_impulse, *wanted, *even;
	double *response, *small; /* [n][n], [n][n + 1] */
	double *missing;          /* m/s: of velocities to their targets */
	unsigned char *barred;    /* it was on to no purpose */
	struct rb_wrench_span_part *parts;
	bool joined;
	double max; /* multiplications that are left */
	struct rb_arena *arena;
};

/* m/s: what a unit of the second row, with what follows it, makes of the gap of the first. */
static double response_of(const struct pass *pass, int i, int k)
{
	const struct rb_constraint *const x = pass->part[i], *const y = pass->part[k];
	const rb_vec3 unit = rb_vec3_add(y->normal, pass->follows[pass->place[k]]);
	const int of[2] = {x->a, x->b}, by[2] = {y->a, y->b};
	const rb_vec3 arm_of[2] = {rb_constraint_arm_a(x), rb_constraint_arm_b(x)};
	const rb_vec3 arm_by[2] = {rb_constraint_arm_a(y), rb_constraint_arm_b(y)};
	double sum = 0;

	for (int e = 0; e < 4; e++) {
		const int one = e / 2, other = e % 2;
		const double inverse_mass = pass->rows->bodies.body[of[one]].inverse_mass;

		if (of[one] != by[other] || inverse_mass == 0)
			continue;
		const rb_vec3 turn = rb_solver_turn(&pass->rows->bodies, of[one],
		                                    rb_vec3_cross(arm_by[other], unit));
		const double gap = inverse_mass * rb_vec3_dot(unit, x->normal) +
		                   rb_vec3_dot(turn, rb_vec3_cross(arm_of[one], x->normal));

		sum += one == other ? gap : -gap;
	}
	return sum;
}

/* Solves the `count` equations of `small`, in the last column; false: one depends on the others. */
static bool solve_small(double *small, int count)
{
	const int width = count + 1;

	for (int k = 0; k < count; k++) {
		double *const row = small + (size_t)k * (size_t)width;
		double size = 0;
		int pivot = k;

		for (int i = 0; i < count; i++)
			size = fmax(size, fabs(row[i]));
		for (int i = k + 1; i < count; i++)
			if (fabs(small[(size_t)i * (size_t)width + (size_t)k]) >
			    fabs(small[(size_t)pivot * (size_t)width + (size_t)k]))
				pivot = i;
		if (pivot != k)
			rb_wrench_span_swap(row, small + (size_t)pivot * (size_t)width, width);
		if (!(fabs(row[k]) > RB_WRENCH_SPAN_OWN_SHARE * size))
			return false;
		for (int i = 0; i < count; i++) {
			double *const other = small + (size_t)i * (size_t)width;
			const double share = i == k ? 0 : other[k] / row[k];

			for (int c = k; share != 0 && c < width; c++)
				other[c] -= share * row[c];
		}
	}
	return true;
}

/*
 * Shares of the units of a span for which gaps close as they do now, friction that slides going
 * with the normal impulses; false: friction leaves it open. Solutions for the same wrenches of the
 * normals alone would be undone by what follows them, and come to an end slowly.
 */
static bool shares_of(struct pass *pass, const struct rb_wrench_span *span)
{
	const int n = span->n, count = span->count, width = count + 1;

	for (int c = 0; c <= count; c++) {
		const double *const unit = span->unit + (size_t)c * (size_t)n;
		const struct rb_wrench_span_part whole = {0, n};
		const struct rb_wrench_span_part part = c < count ? span->part[c] : whole;
		const double *const of = c < count ? unit : pass->normal_impulse;

		/* what the unit, or all that there is and is missing, makes of each gap */
		for (int i = 0; i < n; i++) {
			double sum = c < count ? 0 : pass->missing[i];

			for (int k = part.first; k < part.end; k++)
				sum += pass->on[k] * of[k] *
				       pass->response[(size_t)i * (size_t)n + (size_t)k];
			pass->scratch[i] = sum;
		}
		for (int r = 0; r < count; r++)
			pass->small[(size_t)r * (size_t)width + (size_t)c] = rb_wrench_span_dot(
				span, span->unit + (size_t)r * (size_t)n, pass->scratch,
				span->part[r]);
	}
	return solve_small(pass->small, count);
}

/*
 * On what is on: normal impulses of the least norm of those that do the same; on the others: what
 * the least norm would gain by them, as slopes.
 */
static void project(struct pass *pass, const struct rb_wrench_span *span)
{
	const bool follows = !pass->joined && shares_of(pass, span);

	for (int i = 0; i < span->n; i++)
		pass->wanted[i] = 0;
	for (int k = 0; k < span->count; k++) {
		const double *const unit = span->unit + (size_t)k * (size_t)span->n;
		const struct rb_wrench_span_part part = span->part[k];
		const double along =
			follows ? pass->small[(size_t)(k + 1) * (size_t)(span->count + 1) - 1] /
					  pass->small[(size_t)k * (size_t)(span->count + 2)]
				: rb_wrench_span_dot(span, pass->normal_impulse, unit, part);

		for (int i = part.first; i < part.end; i++)
			pass->wanted[i] += along * unit[i];
	}
}

/* Spans the loads of connected rows; false: nothing is open, or it costs too much. */
static bool span_of(struct pass *pass, int n, struct rb_wrench_span *span)
{
	const rb_arena_mark here = rb_arena_here(pass->arena);
	bool fine = true;
	int on = 0;

	*span = (struct rb_wrench_span){
		.unit = pass->store, .part = pass->parts, .on = pass->on, .n = n};
	if (!pass->joined)
		rb_wrench_span_loads(pass->rows, pass->part, span, pass->scratch);
	else
		fine = rb_wrench_span_allowed(pass->rows, pass->part, span, pass->max, pass->arena);
	rb_arena_back(pass->arena, here);
	for (int i = 0; i < n; i++)
		on += pass->on[i] > 0;
	return fine && span->count < on;
}

/* Units in the last place of the largest impulse that say nothing. */
enum { NOISE_ULP = 64 };

/*
 * Goes to what is wanted, or as far as the first impulse that comes to nothing, which is then off;
 * all the way, who would help most of those that are off is on. False: nobody would.
 */
static bool go_on(struct pass *pass, int n)
{
	double share = 1, max = 0;
	int off = -1, on = -1;

	for (int i = 0; i < n; i++)
		max = fmax(max, fabs(pass->wanted[i]));
	const double noise = NOISE_ULP * DBL_EPSILON * max;
	for (int i = 0; i < n; i++) {
		const double is = pass->normal_impulse[i], wanted = pass->wanted[i];

		if (pass->on[i] > 0 && wanted < -noise && (off < 0 || is / (is - wanted) < share)) {
			share = is / (is - wanted);
			off = i;
		}
		if (pass->on[i] == 0 && !pass->barred[i] && wanted > noise &&
		    (on < 0 || wanted > pass->wanted[on]))
			on = i;
	}
	for (int i = 0; i < n; i++)
		pass->barred[i] = (pass->barred[i] || i == off) && share == 0;
	for (int i = 0; i < n; i++)
		if (pass->on[i] > 0)
			pass->normal_impulse[i] = fmax(
				0, pass->normal_impulse[i] +
					   share * (pass->wanted[i] - pass->normal_impulse[i]));
	if (off >= 0) {
		pass->normal_impulse[off] = 0;
		pass->on[off] = 0;
	} else if (on >= 0) {
		pass->on[on] = 1;
	}
	return off >= 0 || on >= 0;
}

/* The least that connected rows may bear; returns whether something was open. */
static bool even_part(struct pass *pass, int n)
{
	const double cost = multiplications * (double)n * (double)n * (double)n;
	struct rb_wrench_span span;
	bool open = false;

	for (int i = 0; i < n; i++) {
		const struct rb_constraint *const row = pass->part[i];
		const rb_vec3 u = rb_constraint_velocity(&pass->rows->bodies, row);

		pass->on[i] = 1;
		pass->barred[i] = 0;
		pass->normal_impulse[i] = row->impulse.n;
		pass->missing[i] = row->target.n - rb_vec3_dot(u, row->normal);
		for (int k = 0; k < n && !pass->joined; k++)
			pass->response[(size_t)i * (size_t)n + (size_t)k] = response_of(pass, i, k);
	}
	for (int k = 0; k < 4 * n && pass->max >= cost; k++) {
		const bool spans = span_of(pass, n, &span);

		if (k == 0 && !spans)
			break;
		open = true;
		pass->max -= cost;
		project(pass, &span);
		if (!go_on(pass, n))
			break;
	}
	for (int i = 0; i < n; i++)
		pass->even[pass->place[i]] = pass->normal_impulse[i];
	return open;
}

/* The same of all rows, one connected part after the other; with joints all are connected. */
static bool even_all(struct pass *pass, struct rb_constraint *const *taken,
                     const unsigned char *alone, int n, int *parent)
{
	bool open = false;

	if (pass->joined)
		for (int i = 0; i < n; i++)
			parent[i] = 0;
	else
		connect(pass->rows, taken, alone, n, parent);
	for (int root = 0; root < n; root++) {
		int count = 0;

		for (int i = root; i < n && parent[root] == root; i++) {
			if (rb_forest_root(parent, i) != root)
				continue;
			pass->part[count] = taken[i];
			pass->place[count++] = i;
		}
		open = (count > 0 && even_part(pass, count)) || open;
	}
	return open;
}

static bool has_joints(const struct rb_row_system *rows)
{
	return rows->row_count > 0 && rows->row[rows->row_count - 1].set != RB_CONSTRAINT_CONE;
}

bool rb_redundant_contacts(const struct rb_row_system *rows, double tolerance, double slack,
                           double max, struct rb_arena *arena)
{
	const size_t all = (size_t)rows->row_count;
	const bool joined = has_joints(rows);
	struct rb_constraint **const taken = rb_arena_take(arena, all,
	                                                   sizeof(struct rb_constraint *));
	double changed = 0;

	if (!taken)
		return false;
	const int count = joined ? take_joined(rows, slack, taken) : take_rows(rows, slack, taken);
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
	struct pass pass = {
		.rows = rows,
		.joined = joined,
		.max = max,
		.arena = arena,
		.part = rb_arena_take(arena, size, sizeof *pass.part),
		.place = rb_arena_take(arena, 2 * size, sizeof *pass.place),
		.barred = rb_arena_take(arena, size, 1),
		.store = rb_arena_take(arena, (3 * size + 7) * size, sizeof *pass.store)};
	rb_vec3 *const follows = rb_arena_take(arena, size, sizeof *follows);
	pass.parts = rb_arena_take(arena, size, sizeof *pass.parts);
	if (!pass.part || !pass.place || !pass.store || !pass.parts || !follows || !pass.barred)
		return false;
	pass.scratch = pass.store + size * size;
	pass.on = pass.scratch + n;
	pass.normal_impulse = pass.on + n;
	pass.wanted = pass.normal_impulse + n;
	pass.even = pass.wanted + n;
	pass.response = pass.even + n;
	pass.small = pass.response + size * size;
	pass.missing = pass.small + size * (size + 1);
	pass.follows = follows;
	for (int i = 0; i < n; i++)
		follows[i] = following(rows, taken[i]);
	if (!even_all(&pass, taken, alone, n, pass.place + n))
		return false;
	for (int i = 0; i < n; i++)
		changed = fmax(changed, put(rows, taken[i], follows[i], pass.even[i]));
	for (int i = 0; i < n && !joined; i++) {
		const rb_vec3 u = rb_constraint_velocity(&rows->bodies, taken[i]);
		const double is = rb_vec3_dot(u, taken[i]->normal);

		if (taken[i]->impulse.n > 0 && fabs(is - taken[i]->target.n) <= slack)
			taken[i]->target.n = is;
	}
	return changed > tolerance;
}
