/* SPDX-License-Identifier: MIT */
/*
 * Redundant contacts: bodies that touch at more points than there are degrees of freedom (a box on
 * four corners) have normal impulses that are determined only up to the null space of the map from
 * impulses to wrenches. Gauss-Seidel leaves a component in the null space that depends on the order
 * of rows; where contacts slide, that would turn a symmetric box.
 *
 * Of all normal impulses p with the same wrenches A p the one of least norm is the projection of p
 * on the row space of A. The row space is spanned here by modified Gram-Schmidt with at most one
 * reorthogonalization ("twice is enough": Giraud, Langou, Rozloznik 2005) on the rows of A, six per
 * dynamic body. It is cheaper than an SVD, and detects dependent rows on the way. Where the
 * projection would make impulses negative, the non-negative ones of least norm are found by an
 * active-set method: inner products of the span are over the active impulses alone, and the slopes
 * at the others show which of them would reduce the norm. The result depends only on the wrenches,
 * not on the order of rows, nor on which corner had no impulse before.
 *
 * Where joints connect bodies, the rows of A are the gap velocities that motions allowed by the
 * joints produce. Forces of the joints are then computed anew (strategies).
 */
#include "stepped/redundant_contacts.h"

#include <float.h>

#include "base/error.h"
#include "base/forest.h"
#include "stepped/wrench_span.h"

/*
 * A friction impulse counts as sliding from this fraction of mu p on, since after scaling to the
 * cone's edge its length is exact only up to rounding.
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
 * Whether a contact has an impulse, or could have one: its gap is closed up to `tolerance`, m/s. An
 * open one has none in any solution.
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

/* With joints, which transmit loads: selects all rows if one slides; returns their number. */
static int select_with_joints(const struct rb_row_system *rows, double tolerance,
                              struct rb_constraint **selected)
{
	int count = 0;
	bool slide = false;

	for (int k = 0; k < rows->row_count; k++) {
		if (!may_bear(rows, &rows->row[k], tolerance))
			continue;
		slide = slide || slides(&rows->row[k]);
		selected[count++] = &rows->row[k];
	}
	return slide && count > 1 ? count : 0;
}

/*
 * Selects, of pairs that have several rows and slide at one of them, the rows that may have an
 * impulse; returns their number.
 */
static int select_sliding_pairs(const struct rb_row_system *rows, double tolerance,
                                struct rb_constraint **selected)
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
				selected[count++] = &rows->row[i];
	}
	return count;
}

/*
 * Cost of a pass in multiplications per n^3 if all rows are connected: rb_wrench_span_loads takes
 * about 1.5 n vectors (six per body, four points per face), each orthogonalized against up to n
 * units by two products of n, twice.
 */
static const double cost_per_cube = 6;

/* ---- determinate pairs ---- */

/*
 * The impulses of a pair are determinate if its points are few and far enough apart: this fraction
 * of their distances is the least distance of a third point from the line of two others, or of two
 * from a common normal. Below it they stay among the redundant ones; affects cost only.
 */
static const double distinct_share = 0x1p-10;

static bool same_normal(const struct rb_constraint *x, const struct rb_constraint *y)
{
	return x->normal.x == y->normal.x && x->normal.y == y->normal.y &&
	       x->normal.z == y->normal.z;
}

static bool is_dynamic(const struct rb_row_system *rows, int body)
{
	return rows->bodies.body[body].inverse_mass != 0;
}

static bool is_determined(const struct rb_row_system *rows, struct rb_constraint *const *selected,
                          int first, int end)
{
	const struct rb_constraint *const row = selected[first];
	const bool use_a = is_dynamic(rows, row->a);
	rb_vec3 direction[2];

	if (end - first > 3)
		return false;
	for (int i = first + 1; i < end; i++) {
		const rb_vec3 d = use_a ? rb_vec3_sub(selected[i]->arm_a, row->arm_a)
		                        : rb_vec3_sub(selected[i]->arm_b, row->arm_b);

		direction[i - first - 1] = rb_vec3_reject(d, row->normal);
		if (!same_normal(selected[i], row) || !(rb_vec3_length(direction[i - first - 1]) >
		                                        distinct_share * rb_vec3_length(d)))
			return false;
	}
	return end - first < 3 ||
	       rb_vec3_length(rb_vec3_cross(direction[0], direction[1])) >
	               distinct_share * rb_vec3_length(direction[0]) * rb_vec3_length(direction[1]);
}

/* Rows of one pair, [first, end); `isolated`: its null space is independent of other pairs. */
struct pair {
	int first, end;
	bool isolated;
};

/*
 * Marks pairs as isolated, one after the other, if one of their bodies has no other pair left:
 * impulses in the null space of that body have no effect on the other one, either. Drops the
 * isolated pairs that are determinate, and sets `isolated` of the remaining rows, by row. Returns
 * their number; -1: no memory.
 */
static int drop_determined(const struct rb_row_system *rows, struct rb_constraint **selected, int n,
                           unsigned char *isolated, struct rb_arena *arena)
{
	struct pair *const pair = rb_arena_take(arena, (size_t)n, sizeof *pair);
	int pair_count = 0, max = 0, remaining = 0;
	bool any = true;

	for (int i = 0; i < n; i++) {
		max = selected[i]->a > max ? selected[i]->a : max;
		max = selected[i]->b > max ? selected[i]->b : max;
	}
	int *const pairs_of = rb_arena_take(arena, (size_t)max + 1, sizeof *pairs_of);
	if (!pair || !pairs_of)
		return -1;
	for (int i = 0; i < n; i++)
		pairs_of[selected[i]->a] = pairs_of[selected[i]->b] = 0;
	for (int i = 0, end; i < n; i = end) {
		end = i + 1;
		while (end < n && rb_wrench_span_continues_pair(selected, end))
			end++;
		pair[pair_count++] = (struct pair){i, end, false};
		pairs_of[selected[i]->a]++;
		pairs_of[selected[i]->b]++;
	}
	while (any) {
		any = false;
		for (int k = 0; k < pair_count; k++) {
			const struct rb_constraint *const row = selected[pair[k].first];

			if (pair[k].isolated ||
			    !((pairs_of[row->a] == 1 && is_dynamic(rows, row->a)) ||
			      (pairs_of[row->b] == 1 && is_dynamic(rows, row->b))))
				continue;
			pair[k].isolated = any = true;
			pairs_of[row->a]--;
			pairs_of[row->b]--;
		}
	}
	for (int k = 0; k < pair_count; k++) {
		const bool dropped = pair[k].isolated &&
		                     is_determined(rows, selected, pair[k].first, pair[k].end);

		for (int i = pair[k].first; i < pair[k].end && !dropped; i++) {
			isolated[remaining] = pair[k].isolated;
			selected[remaining++] = selected[i];
		}
	}
	return remaining;
}

/* ---- impulses ---- */

/*
 * Friction impulse per unit of the normal impulse of a row that slides; zero if it does not. One
 * without an impulse yet will have friction against its slip.
 */
static rb_vec3 sliding_friction(const struct rb_row_system *rows, const struct rb_constraint *row)
{
	rb_vec3 direction = {0, 0, 0};

	if (slides(row))
		direction = rb_vec3_reject(row->impulse.t, row->normal);
	else if (row->impulse.n == 0 && row->friction > 0)
		direction = rb_vec3_neg(
			rb_vec3_reject(rb_constraint_velocity(&rows->bodies, row), row->normal));
	const double length = rb_vec3_length(direction);
	if (!(length > 0))
		return (rb_vec3){0, 0, 0};
	/* again: of a direction that was next to nothing rounding along the normal has grown */
	return rb_vec3_reject(rb_vec3_scale(row->friction / length, direction), row->normal);
}

/*
 * Sets the normal impulse of a row, and its sliding friction in proportion; friction that does not
 * slide stays within the cone. Returns the largest change of velocity, m/s, that this makes at the
 * contact.
 */
static double set_impulse(const struct rb_row_system *rows, struct rb_constraint *row,
                          rb_vec3 friction_per_normal, double normal_impulse)
{
	RB_ASSERT_COSTLY(row->impulse.n >= 0 && normal_impulse >= 0);
	const rb_vec3 friction_impulse =
		rb_vec3_max_abs(friction_per_normal) > 0
			? rb_vec3_scale(normal_impulse, friction_per_normal)
			: rb_constraint_within(row->impulse.t, row->friction * normal_impulse);
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

/*
 * Rows connected by dynamic bodies, as trees of a union-find: rows of different trees are
 * orthogonal.
 */
static void connect(const struct rb_row_system *rows, struct rb_constraint *const *selected,
                    const unsigned char *isolated, int n, int *parent)
{
	for (int i = 0; i < n; i++) {
		const bool same = rb_wrench_span_continues_pair(selected, i);

		parent[i] = same ? rb_forest_root(parent, i - 1) : i;
		for (int k = 0; k < i && !same && !isolated[i]; k++) {
			if (isolated[k] || rb_wrench_span_continues_pair(selected, k) ||
			    !share_a_body(rows, selected[i], selected[k]))
				continue;
			const int other = rb_forest_root(parent, k),
				  own = rb_forest_root(parent, i);

			if (own != other)
				parent[own > other ? own : other] = own < other ? own : other;
		}
	}
}

/* A pass over n rows; arrays are [n], `basis` [n][n]. */
struct pass {
	const struct rb_row_system *rows;
	struct rb_constraint **component; /* connected rows that are being solved */
	/* of all rows: sliding friction per unit of normal impulse */
	const rb_vec3 *friction_per_normal;
	int *index; /* their indices among all rows */
	double *basis, *scratch, *active, *normal_impulse, *goal, *least_norm;
	double *response, *equations; /* [n][n], [n][n + 1] */
	double *velocity_error;       /* m/s: target minus gap velocity */
	unsigned char *blocked;       /* became active without a step of nonzero length */
	struct rb_wrench_span_part *parts;
	bool joined;
	double max; /* multiplications remaining */
	struct rb_arena *arena;
};

/*
 * m/s: gap velocity of the first row per unit of the second one's normal impulse, with its sliding
 * friction.
 */
static double response_of(const struct pass *pass, int i, int k)
{
	const struct rb_constraint *const x = pass->component[i], *const y = pass->component[k];
	const rb_vec3 unit = rb_vec3_add(y->normal, pass->friction_per_normal[pass->index[k]]);
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

/*
 * Solves the `count` equations of `equations`, whose last column is the right-hand side; false:
 * they are singular.
 */
static bool eliminate(double *equations, int count)
{
	const int width = count + 1;

	for (int k = 0; k < count; k++) {
		double *const row = equations + (size_t)k * (size_t)width;
		double size = 0;
		int pivot = k;

		for (int i = 0; i < count; i++)
			size = fmax(size, fabs(row[i]));
		for (int i = k + 1; i < count; i++)
			if (fabs(equations[(size_t)i * (size_t)width + (size_t)k]) >
			    fabs(equations[(size_t)pivot * (size_t)width + (size_t)k]))
				pivot = i;
		if (pivot != k)
			rb_wrench_span_swap(row, equations + (size_t)pivot * (size_t)width, width);
		if (!(fabs(row[k]) > RB_WRENCH_SPAN_OWN_SHARE * size))
			return false;
		for (int i = 0; i < count; i++) {
			double *const other = equations + (size_t)i * (size_t)width;
			const double share = i == k ? 0 : other[k] / row[k];

			for (int c = k; share != 0 && c < width; c++)
				other[c] -= share * row[c];
		}
	}
	return true;
}

/*
 * Coefficients of the span's units for which gap velocities stay as they are now, with sliding
 * friction proportional to the normal impulses; false: friction leaves them indeterminate.
 * Projecting the normal impulses alone would be undone by the friction that follows them, and
 * converge slowly.
 */
static bool coefficients_with_friction(struct pass *pass, const struct rb_wrench_span *span)
{
	const int n = span->n, count = span->count, width = count + 1;

	for (int c = 0; c <= count; c++) {
		const double *const unit = span->unit + (size_t)c * (size_t)n;
		const struct rb_wrench_span_part whole = {0, n};
		const struct rb_wrench_span_part part = c < count ? span->part[c] : whole;
		const double *const load = c < count ? unit : pass->normal_impulse;

		/* gap velocity due to the unit, or to the present impulses plus the error */
		for (int i = 0; i < n; i++) {
			double sum = c < count ? 0 : pass->velocity_error[i];

			for (int k = part.first; k < part.end; k++)
				sum += pass->active[k] * load[k] *
				       pass->response[(size_t)i * (size_t)n + (size_t)k];
			pass->scratch[i] = sum;
		}
		for (int r = 0; r < count; r++)
			pass->equations[(size_t)r * (size_t)width + (size_t)c] = rb_wrench_span_dot(
				span, span->unit + (size_t)r * (size_t)n, pass->scratch,
				span->part[r]);
	}
	return eliminate(pass->equations, count);
}

/*
 * For active rows: the normal impulses of least norm with the same effect; for the others: the
 * slope at which the norm would fall if they became active.
 */
static void project(struct pass *pass, const struct rb_wrench_span *span)
{
	const bool is_coupled = !pass->joined && coefficients_with_friction(pass, span);

	for (int i = 0; i < span->n; i++)
		pass->goal[i] = 0;
	for (int k = 0; k < span->count; k++) {
		const double *const unit = span->unit + (size_t)k * (size_t)span->n;
		const struct rb_wrench_span_part part = span->part[k];
		const double along =
			is_coupled
				? pass->equations[(size_t)(k + 1) * (size_t)(span->count + 1) - 1] /
					  pass->equations[(size_t)k * (size_t)(span->count + 2)]
				: rb_wrench_span_dot(span, pass->normal_impulse, unit, part);

		for (int i = part.first; i < part.end; i++)
			pass->goal[i] += along * unit[i];
	}
}

/* Spans the loads of connected rows; false: no null space, or too costly. */
static bool span_of(struct pass *pass, int n, struct rb_wrench_span *span)
{
	const rb_arena_mark here = rb_arena_here(pass->arena);
	bool fine = true;
	int active_count = 0;

	*span = (struct rb_wrench_span){
		.unit = pass->basis, .part = pass->parts, .active = pass->active, .n = n};
	if (!pass->joined)
		rb_wrench_span_loads(pass->rows, pass->component, span, pass->scratch);
	else
		fine = rb_wrench_span_allowed(pass->rows, pass->component, span, pass->max,
		                              pass->arena);
	rb_arena_back(pass->arena, here);
	for (int i = 0; i < n; i++)
		active_count += pass->active[i] > 0;
	return fine && span->count < active_count;
}

/* Impulses below so many ulp of the largest one are noise. */
enum { NOISE_ULP = 64 };

/*
 * Moves to the goal, or up to the first impulse that becomes zero, which leaves the active set; at
 * the goal, the row whose activation would reduce the norm most enters it. False: none would.
 */
static bool step_to_goal(struct pass *pass, int n)
{
	double share = 1, max = 0;
	int leaving = -1, entering = -1;

	for (int i = 0; i < n; i++)
		max = fmax(max, fabs(pass->goal[i]));
	const double noise = NOISE_ULP * DBL_EPSILON * max;
	for (int i = 0; i < n; i++) {
		const double current = pass->normal_impulse[i], goal = pass->goal[i];

		if (pass->active[i] > 0 && goal < -noise &&
		    (leaving < 0 || current / (current - goal) < share)) {
			share = current / (current - goal);
			leaving = i;
		}
		if (pass->active[i] == 0 && !pass->blocked[i] && goal > noise &&
		    (entering < 0 || goal > pass->goal[entering]))
			entering = i;
	}
	for (int i = 0; i < n; i++)
		pass->blocked[i] = (pass->blocked[i] || i == leaving) && share == 0;
	for (int i = 0; i < n; i++)
		if (pass->active[i] > 0)
			pass->normal_impulse[i] = fmax(
				0, pass->normal_impulse[i] +
					   share * (pass->goal[i] - pass->normal_impulse[i]));
	if (leaving >= 0) {
		pass->normal_impulse[leaving] = 0;
		pass->active[leaving] = 0;
	} else if (entering >= 0) {
		pass->active[entering] = 1;
	}
	return leaving >= 0 || entering >= 0;
}

/* Minimizes the norm over connected rows; returns whether they are redundant. */
static bool minimize_component(struct pass *pass, int n)
{
	const double cost = cost_per_cube * (double)n * (double)n * (double)n;
	struct rb_wrench_span span;
	bool is_redundant = false;

	for (int i = 0; i < n; i++) {
		const struct rb_constraint *const row = pass->component[i];
		const rb_vec3 u = rb_constraint_velocity(&pass->rows->bodies, row);

		pass->active[i] = 1;
		pass->blocked[i] = 0;
		pass->normal_impulse[i] = row->impulse.n;
		pass->velocity_error[i] = row->target.n - rb_vec3_dot(u, row->normal);
		for (int k = 0; k < n && !pass->joined; k++)
			pass->response[(size_t)i * (size_t)n + (size_t)k] = response_of(pass, i, k);
	}
	for (int k = 0; k < 4 * n && pass->max >= cost; k++) {
		const bool spans = span_of(pass, n, &span);

		if (k == 0 && !spans)
			break;
		is_redundant = true;
		pass->max -= cost;
		project(pass, &span);
		if (!step_to_goal(pass, n))
			break;
	}
	for (int i = 0; i < n; i++)
		pass->least_norm[pass->index[i]] = pass->normal_impulse[i];
	return is_redundant;
}

/*
 * Minimizes the norm over all rows, one connected part after the other; with joints all are
 * connected.
 */
static bool minimize_all(struct pass *pass, struct rb_constraint *const *selected,
                         const unsigned char *isolated, int n, int *parent)
{
	bool is_redundant = false;

	if (pass->joined)
		for (int i = 0; i < n; i++)
			parent[i] = 0;
	else
		connect(pass->rows, selected, isolated, n, parent);
	for (int root = 0; root < n; root++) {
		int count = 0;

		for (int i = root; i < n && parent[root] == root; i++) {
			if (rb_forest_root(parent, i) != root)
				continue;
			pass->component[count] = selected[i];
			pass->index[count++] = i;
		}
		is_redundant = (count > 0 && minimize_component(pass, count)) || is_redundant;
	}
	return is_redundant;
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
	struct rb_constraint **const selected = rb_arena_take(arena, all,
	                                                      sizeof(struct rb_constraint *));
	double changed = 0;

	if (!selected)
		return false;
	const int count = joined ? select_with_joints(rows, slack, selected)
	                         : select_sliding_pairs(rows, slack, selected);
	const double cube = (double)count * (double)count * (double)count;
	if (count == 0 || cost_per_cube * cube > max)
		return false;
	unsigned char *const isolated = rb_arena_take(arena, (size_t)count, 1);
	if (!isolated)
		return false;
	const int n = joined ? count : drop_determined(rows, selected, count, isolated, arena);
	const size_t size = (size_t)n;
	if (n <= 0)
		return false;
	struct pass pass = {
		.rows = rows,
		.joined = joined,
		.max = max,
		.arena = arena,
		.component = rb_arena_take(arena, size, sizeof *pass.component),
		.index = rb_arena_take(arena, 2 * size, sizeof *pass.index),
		.blocked = rb_arena_take(arena, size, 1),
		.basis = rb_arena_take(arena, (3 * size + 7) * size, sizeof *pass.basis)};
	rb_vec3 *const friction_per_normal = rb_arena_take(arena, size,
	                                                   sizeof *friction_per_normal);
	pass.parts = rb_arena_take(arena, size, sizeof *pass.parts);
	if (!pass.component || !pass.index || !pass.basis || !pass.parts || !friction_per_normal ||
	    !pass.blocked)
		return false;
	pass.scratch = pass.basis + size * size;
	pass.active = pass.scratch + n;
	pass.normal_impulse = pass.active + n;
	pass.goal = pass.normal_impulse + n;
	pass.least_norm = pass.goal + n;
	pass.response = pass.least_norm + n;
	pass.equations = pass.response + size * size;
	pass.velocity_error = pass.equations + size * (size + 1);
	pass.friction_per_normal = friction_per_normal;
	for (int i = 0; i < n; i++)
		friction_per_normal[i] = sliding_friction(rows, selected[i]);
	if (!minimize_all(&pass, selected, isolated, n, pass.index + n))
		return false;
	for (int i = 0; i < n; i++)
		changed = fmax(changed, set_impulse(rows, selected[i], friction_per_normal[i],
		                                    pass.least_norm[i]));
	for (int i = 0; i < n && !joined; i++) {
		const rb_vec3 u = rb_constraint_velocity(&rows->bodies, selected[i]);
		const double current = rb_vec3_dot(u, selected[i]->normal);

		if (selected[i]->impulse.n > 0 && fabs(current - selected[i]->target.n) <= slack)
			selected[i]->target.n = current;
	}
	return changed > tolerance;
}
