/* SPDX-License-Identifier: MIT */
/*
 * Equations of a cluster in its modes: accelerations at each contact are linear in the forces. A
 * sticking contact has three unknowns (relative acceleration zero), a slipping one its normal force
 * with friction along the slip, a creeping one a second, across the slip. One dense solve gives the
 * forces; those that redundant systems leave open are chosen by least squares. Forces are refined
 * by the residual accelerations, so that bodies at rest stay at rest to rounding.
 */
#include "located/modes.h"

#include "base/error.h"
#include "constraint/simultaneous_forces.h"

#include <float.h>
#include <string.h>

#include "located/external_force.h"
#include "located/joint_problem.h"
#include "located/open_forces.h"
#include "located/event_set.h"

/* Rounds for creeping slips and for refinement; deviation of a straight slip, in noises. */
enum { TURNS = 6, REFINEMENTS = 4, STRAIGHT_NOISES = 8 };
/* Share of a slip's speed across its direction at which it has turned. */
static const double turned_share = 1e-9;
/* Share of friction that may remain across a creeping slip: friction is too large by its square. */
static const double balanced_share = 1e-7;

bool rb_modes_move(const struct rb_modes *w)
{
	for (int k = 0; k < w->c->member_count; k++)
		if (rb_vec3_max_abs(w->pose[k].velocity) > 0 ||
		    rb_vec3_max_abs(w->pose[k].spin) > 0)
			return true;
	return false;
}

int rb_modes_unknowns(const struct rb_held *held)
{
	if (!held->slipping)
		return 3;
	return held->creeps ? 2 : 1;
}

/* Unit vector across normal and slip. */
static inline rb_vec3 across_slip(const struct rb_modes *w, int contact)
{
	return rb_vec3_cross(w->contact_point[contact].normal, w->contact[contact].slip);
}

/* Component of a relative acceleration that the k-th unknown of a contact makes zero. */
static inline double component_of(const struct rb_modes *w, int contact, int k, rb_vec3 a)
{
	if (!w->c->held[contact].slipping)
		return k == 0 ? a.x : k == 1 ? a.y : a.z;
	return rb_vec3_dot(a, k == 0 ? w->contact_point[contact].normal : across_slip(w, contact));
}

/*
 * Force per unit of the k-th unknown of a contact: an axis; the normal with its friction; for a
 * creeping slip also the direction across it.
 */
static inline rb_vec3 unit_of(const struct rb_modes *w, int contact, int k)
{
	const struct rb_held *held = &w->c->held[contact];
	const struct rb_contact_point *m = &w->contact_point[contact];

	if (!held->slipping)
		return (rb_vec3){k == 0, k == 1, k == 2};
	if (k == 1)
		return across_slip(w, contact);
	return rb_vec3_add_scaled(m->normal, -w->contact[contact].friction,
	                          w->contact[contact].slip);
}

/* Acceleration at the arm `at` of a member by a force at `arm`. */
static rb_vec3 response(const struct rb_modes *w, int body, rb_vec3 arm, rb_vec3 at, rb_vec3 f)
{
	return rb_mechanics_point_response(w->l, body, &w->pose[rb_modes_place(w, body)], arm, at,
	                                   f);
}

/* Relative acceleration at contact i by a force `f` on b of contact j. */
static rb_vec3 coupling(const struct rb_modes *w, int i, int j, rb_vec3 f)
{
	const struct rb_contact_point *x = &w->contact_point[i], *y = &w->contact_point[j];
	rb_vec3 sum = {0, 0, 0};

	if (rb_modes_place(w, y->b) >= 0) {
		if (x->b == y->b)
			sum = rb_vec3_add(sum, response(w, y->b, y->arm_b, x->arm_b, f));
		if (x->a == y->b)
			sum = rb_vec3_sub(sum, response(w, y->b, y->arm_b, x->arm_a, f));
	}
	if (rb_modes_place(w, y->a) >= 0) {
		if (x->b == y->a)
			sum = rb_vec3_sub(sum, response(w, y->a, y->arm_a, x->arm_b, f));
		if (x->a == y->a)
			sum = rb_vec3_add(sum, response(w, y->a, y->arm_a, x->arm_a, f));
	}
	return sum;
}

/* True if two contacts have a body in common. */
static inline bool share_a_body(const struct rb_contact_point *x, const struct rb_contact_point *y)
{
	return x->a == y->a || x->a == y->b || x->b == y->a || x->b == y->b;
}

/* Acceleration of a body's point, by linear and angular acceleration only. */
static rb_vec3 point_acceleration(const struct rb_modes *w, int body, rb_vec3 arm, double t)
{
	const int place = rb_modes_place(w, body);

	if (place >= 0)
		return rb_vec3_add(w->linear[place], rb_vec3_cross(w->angular[place], arm));
	return rb_vec3_add(rb_arc_acceleration(w->l, body, t),
	                   rb_vec3_cross(rb_mechanics_turning(w->l, body, t), arm));
}

static rb_vec3 relative_acceleration(const struct rb_modes *w, int i, double t)
{
	const struct rb_contact_point *m = &w->contact_point[i];

	return rb_vec3_add(rb_vec3_sub(point_acceleration(w, m->b, m->arm_b, t),
	                               point_acceleration(w, m->a, m->arm_a, t)),
	                   w->contact[i].bias);
}

static double axis(rb_vec3 v, int k)
{
	return k == 0 ? v.x : k == 1 ? v.y : v.z;
}

/* Initial value of an unknown: the contact's last known force. */
static inline double guess_of(const struct rb_modes *w, int contact, int k)
{
	const struct rb_held *held = &w->c->held[contact];

	if (!held->slipping)
		return axis(held->force, k);
	return k == 0 ? rb_vec3_dot(held->force, w->contact_point[contact].normal) : 0;
}

/* Fills a contact's rows of the matrix and, with the guessed forces, the right side. */
static void fill_row(struct rb_modes *w, int i, int row, double t)
{
	const struct rb_cluster *c = w->c;
	const struct rb_contact_point *m = &w->contact_point[i];
	const int n = w->dense.n, rows = rb_modes_unknowns(&c->held[i]);
	rb_vec3 free = relative_acceleration(w, i, t);
	int column = 0;

	for (int r = 0; r < rows; r++)
		memset(w->dense.matrix + (row + r) * n, 0, (size_t)n * sizeof(double));
	for (int j = 0; j < c->held_count; j++) {
		const int unknowns = rb_modes_unknowns(&c->held[j]);

		for (int k = 0; k < unknowns && share_a_body(m, &w->contact_point[j]); k++) {
			const rb_vec3 a = coupling(w, i, j, unit_of(w, j, k));

			free = rb_vec3_add_scaled(free, guess_of(w, j, k), a);
			for (int r = 0; r < rows; r++)
				w->dense.matrix[(row + r) * n + column + k] = component_of(w, i, r,
				                                                           a);
		}
		column += unknowns;
	}
	for (int r = 0; r < rows; r++)
		w->dense.right[row + r] = -component_of(w, i, r, free);
}

/* The k-th unknown of a contact as a row of the coupled system. */
static struct rb_coupled_row contact_row(const struct rb_modes *w, int contact, int k)
{
	const struct rb_contact_point *m = &w->contact_point[contact];
	const rb_vec3 unit = unit_of(w, contact, k);
	rb_vec3 direction = {k == 0, k == 1, k == 2};

	if (w->c->held[contact].slipping)
		direction = k == 0 ? m->normal : across_slip(w, contact);
	const struct rb_coupled_wrench measured = {direction, rb_vec3_cross(direction, m->arm_a),
	                                           rb_vec3_cross(m->arm_b, direction)};
	const struct rb_coupled_wrench exerted = {unit, rb_vec3_cross(unit, m->arm_a),
	                                          rb_vec3_cross(m->arm_b, unit)};

	return rb_coupled_row(rb_modes_place(w, m->a), rb_modes_place(w, m->b), &measured,
	                      &exerted);
}

/* Forces from unknowns. */
static void set_forces(struct rb_modes *w, const double *unknown)
{
	int row = w->joints.count;

	for (int k = 0; k < row; k++)
		w->multiplier[k] = unknown[k];
	if (row > 0 && unknown != w->unknown)
		memcpy(w->unknown, unknown, (size_t)w->dense.n * sizeof *unknown);
	for (int i = 0; i < w->c->held_count; i++) {
		w->force[i] = (rb_vec3){0, 0, 0};
		for (int k = 0; k < rb_modes_unknowns(&w->c->held[i]); k++, row++)
			w->force[i] = rb_vec3_add_scaled(w->force[i], unknown[row],
			                                 unit_of(w, i, k));
	}
}

/*
 * Fills all rows, joints first, the matrix, and the right side with the guessed forces. False: the
 * solution is known already, and set.
 */
static bool fill_coupled(struct rb_modes *w, double t)
{
	struct rb_coupled *const system = &w->coupled;
	const int joints = w->joints.count;
	double *const right = w->dense.right;
	int row = joints;

	system->count = w->dense.n;
	/* pivots measure how dependent rows are */
	system->is_symmetric = w->c->held_count == 0 && !w->singular.projects;
	system->keeps_pivots = !w->singular.projects;
	for (int k = 0; k < joints; k++)
		system->row[k] = rb_joint_rows_coupled(&w->joints.row[k]);
	for (int i = 0; i < w->c->held_count; i++) {
		/* directions of creeping slips change from solution to solution */
		system->keeps_pivots = system->keeps_pivots && !w->c->held[i].creeps;
		for (int k = 0; k < rb_modes_unknowns(&w->c->held[i]); k++, row++)
			system->row[row] = contact_row(w, i, k);
	}
	if (rb_coupled_find(system, &w->dense, t, w->unknown)) {
		set_forces(w, w->unknown);
		return false;
	}
	row = joints;
	for (int k = 0; k < joints; k++)
		right[k] = -(rb_coupled_rate(&system->row[k], w->linear, w->angular) +
		             w->joints.row[k].bias);
	for (int i = 0; i < w->c->held_count; i++) {
		const rb_vec3 free = relative_acceleration(w, i, t);

		for (int k = 0; k < rb_modes_unknowns(&w->c->held[i]); k++, row++)
			right[row] = -component_of(w, i, k, free);
	}
	rb_coupled_turn(system);
	for (int k = 0; k < system->count; k++)
		rb_coupled_respond(system, &system->row[k]);
	rb_coupled_sort(system);
	rb_coupled_fill(system, &w->dense, t);
	row = joints;
	for (int i = 0; i < w->c->held_count; i++)
		for (int k = 0; k < rb_modes_unknowns(&w->c->held[i]); k++, row++) {
			const double guess = guess_of(w, i, k);

			for (int r = 0; r < system->count && guess != 0; r++)
				if (row >= w->dense.first[r] && row <= w->dense.last[r])
					right[r] -= guess * w->dense.matrix[r * w->dense.n + row];
		}
	return true;
}

bool rb_modes_are_lawful(const struct rb_modes *w)
{
	for (int i = 0; i < w->c->held_count; i++) {
		const rb_vec3 n = w->contact_point[i].normal;
		const double normal_force = rb_vec3_dot(w->force[i], n);

		if (normal_force < 0 ||
		    (!w->c->held[i].slipping && rb_vec3_length(rb_vec3_reject(w->force[i], n)) >
		                                        w->contact[i].friction * normal_force))
			return false;
	}
	return true;
}

/* The contacts with their unknowns, without the creeping ones; NULL: out of memory. */
static struct rb_open_contact *open_contacts(const struct rb_modes *w, int *count)
{
	struct rb_open_contact *const to = rb_arena_take(w->l->arena, (size_t)w->c->held_count + 1,
	                                                 sizeof *to);
	int row = w->joints.count;

	*count = 0;
	for (int i = 0; to && i < w->c->held_count; i++) {
		const struct rb_held *held = &w->c->held[i];
		const struct rb_contact_point *m = &w->contact_point[i];

		if (!held->slipping || !held->creeps)
			to[(*count)++] = (struct rb_open_contact){
				.row = row,
				.slips = held->slipping,
				.friction = w->contact[i].friction,
				.normal = m->normal,
				.unit = held->slipping ? unit_of(w, i, 0) : m->normal,
				.a = rb_modes_place(w, m->a),
				.b = rb_modes_place(w, m->b),
				.arm_a = m->arm_a,
				.arm_b = m->arm_b};
		row += rb_modes_unknowns(held);
	}
	return to;
}

/* Sets the nearest forces that satisfy the law, if there are any; false: out of memory. */
static bool enforce_law(struct rb_modes *w, struct rb_open_forces *open, bool moves,
                        double *unknown)
{
	const bool good = rb_open_forces_keep_law(open, moves, unknown);

	if (good)
		set_forces(w, unknown);
	return good;
}

/*
 * The least open forces; if these violate a law, the nearest that do not, with the same
 * accelerations if possible: they change steadily, and do not depend on how the scene is turned.
 */
static bool choose_least(struct rb_modes *w, struct rb_open_forces *open, double *unknown)
{
	const bool good = rb_open_forces_close(open, 0, unknown);

	if (good)
		set_forces(w, unknown);
	for (int moves = 0; moves < 2 && good && !rb_modes_are_lawful(w); moves++)
		if (!enforce_law(w, open, moves, unknown))
			return false;
	return good;
}

/* Open forces whose contact forces are nearest to the resolved ones, from which they change. */
static bool choose_nearest(struct rb_modes *w, struct rb_open_forces *open, double *unknown)
{
	const struct rb_cluster *c = w->c;
	int row = w->joints.count;
	const bool good = rb_open_forces_close(open, (size_t)row, unknown);

	for (int i = 0; i < c->held_count; i++)
		for (int k = 0; k < rb_modes_unknowns(&c->held[i]); k++, row++)
			unknown[row] += guess_of(w, i, k);
	if (good)
		set_forces(w, unknown);
	return good && (rb_modes_are_lawful(w) || enforce_law(w, open, false, unknown));
}

/*
 * Chooses open forces: the smallest within the law, which have the bodies' symmetry; if none are
 * found, those whose contact forces are nearest to those when the cluster was resolved: at that
 * moment they are the same.
 */
static bool choose_forces(struct rb_modes *w)
{
	const struct rb_cluster *c = w->c;
	const size_t n = (size_t)w->dense.n;
	const rb_arena_mark here = rb_arena_here(w->l->arena);
	double *const least = rb_arena_take(w->l->arena, 2 * n, sizeof *least);
	double *const change = least ? least + n : NULL;
	struct rb_open_forces open = {
		.arena = w->l->arena, .dense = &w->dense, .bodies = c->member_count};
	int row = w->joints.count;
	bool good = true;

	if (!least)
		return false;
	memcpy(change, w->dense.right, n * sizeof *change);
	memcpy(least, change, (size_t)row * sizeof *change);
	for (int i = 0; i < c->held_count; i++)
		for (int k = 0; k < rb_modes_unknowns(&c->held[i]); k++, row++)
			least[row] = guess_of(w, i, k) + change[row];
	if (!w->dense.open) {
		set_forces(w, least);
	} else {
		open.contact = open_contacts(w, &open.contacts);
		good = open.contact && choose_least(w, &open, least) &&
		       (rb_modes_are_lawful(w) || choose_nearest(w, &open, change));
	}
	rb_arena_back(w->l->arena, here);
	return good;
}

/* Solves the modes' equations into w->force; false: too many unknowns. */
static bool solve_modes(struct rb_modes *w, double t)
{
	const struct rb_cluster *c = w->c;
	int n = w->joints.count, row = 0;

	for (int k = 0; k < c->held_count; k++)
		n += rb_modes_unknowns(&c->held[k]);
	if (n > w->direct_max)
		return false;
	w->dense.n = n;
	w->dense.first = NULL;
	if (w->joints.count > 0 && !fill_coupled(w, t))
		return true;
	for (int i = 0; i < c->held_count && w->joints.count == 0;
	     row += rb_modes_unknowns(&c->held[i]), i++)
		fill_row(w, i, row, t);
	if (w->joints.count > 0)
		rb_coupled_solve(&w->coupled, &w->dense);
	else
		rb_dense_solve(&w->dense);
	return choose_forces(w);
}

/* True if the contact's slip has a common direction with others of its pair. */
static inline bool is_joined(const struct rb_held *held)
{
	return rb_vec3_max_abs(held->common) > 0;
}

/* End of the run of contacts of one pair. */
static int pair_end(const struct rb_cluster *c, int first)
{
	int end = first + 1;

	while (end < c->held_count && c->held[end].a == c->held[first].a &&
	       c->held[end].b == c->held[first].b)
		end++;
	return end;
}

bool rb_modes_join_slips(struct rb_modes *w)
{
	struct rb_held *const held = w->c->held;
	bool any = false;

	for (int first = 0, end; first < w->c->held_count; first = end) {
		rb_vec3 sum = {0, 0, 0};
		bool creep = true;

		end = pair_end(w->c, first);
		for (int k = first; k < end; k++) {
			creep = creep && held[k].creeps;
			sum = rb_vec3_add(sum, held[k].slip);
		}
		const bool joins = creep && end > first + 1;
		for (int k = first; k < end; k++)
			held[k].common = joins ? rb_vec3_unit(sum, held[k].slip)
			                       : (rb_vec3){0, 0, 0};
		any = any || joins;
	}
	return any;
}

void rb_modes_part_slips(struct rb_modes *w)
{
	for (int k = 0; k < w->c->held_count; k++) {
		struct rb_held *const held = &w->c->held[k];

		held->creeps = held->creeps && !(is_joined(held) && held->straight);
		held->common = (rb_vec3){0, 0, 0};
	}
}

/*
 * Turns creeping slips such that no friction remains across them, joined ones together; true: one
 * turned.
 */
static bool turn_creeping(struct rb_modes *w)
{
	const struct rb_held *const held = w->c->held;
	bool turned = false;

	for (int first = 0, end; first < w->c->held_count; first = end) {
		double limit = 0, off = 0, max = 0;

		end = is_joined(&held[first]) ? pair_end(w->c, first) : first + 1;
		for (int k = first; k < end; k++) {
			const double across = rb_vec3_dot(w->force[k], across_slip(w, k));

			limit += w->contact[k].friction *
			         rb_vec3_dot(w->force[k], w->contact_point[k].normal);
			off += across;
			max = fmax(max, fabs(across));
		}
		if (!held[first].creeps || !(limit > 0) || max <= balanced_share * limit)
			continue;
		for (int k = first; k < end; k++)
			w->contact[k].slip = rb_vec3_unit(
				rb_vec3_add_scaled(rb_vec3_scale(limit, w->contact[k].slip), -off,
			                           across_slip(w, k)),
				w->contact[k].slip);
		turned = true;
	}
	return turned;
}

bool rb_modes_solve(struct rb_modes *w, double t)
{
	w->balanced = true;
	for (int round = 0; round < TURNS; round++) {
		if (!solve_modes(w, t))
			return false;
		w->balanced = !turn_creeping(w);
		if (w->balanced)
			break;
	}
	return true;
}

/* Adds a contact's force and torque to those on a member. */
static void press(const struct rb_modes *w, int body, rb_vec3 arm, rb_vec3 force, rb_vec3 *sum)
{
	const int place = rb_modes_place(w, body);

	if (place < 0)
		return;
	sum[2 * place] = rb_vec3_add(sum[2 * place], force);
	sum[2 * place + 1] = rb_vec3_add(sum[2 * place + 1], rb_vec3_cross(arm, force));
}

/* Adds force and torque of a multiplier of a joint's row. */
static void press_joint(const struct rb_joint_row *row, double multiplier, rb_vec3 *sum)
{
	const struct rb_coupled_wrench *wrench = &row->wrench;

	if (row->a >= 0) {
		rb_vec3 *const on = &sum[2 * row->a];

		on[0] = rb_vec3_add_scaled(on[0], -multiplier, wrench->linear);
		on[1] = rb_vec3_add_scaled(on[1], multiplier, wrench->angular_a);
	}
	if (row->b >= 0) {
		rb_vec3 *const on = &sum[2 * row->b];

		on[0] = rb_vec3_add_scaled(on[0], multiplier, wrench->linear);
		on[1] = rb_vec3_add_scaled(on[1], multiplier, wrench->angular_b);
	}
}

bool rb_modes_press(struct rb_modes *w, const rb_vec3 *force, const double *multiplier)
{
	struct rb_located *l = w->l;
	const struct rb_cluster *c = w->c;
	const rb_arena_mark here = rb_arena_here(l->arena);
	/*
	 * balancing forces are summed before they are rotated to the body's axes: each rotation
	 * would round
	 */
	rb_vec3 *const sum = rb_arena_take(l->arena, 2 * (size_t)c->member_count, sizeof *sum);

	if (!sum)
		return false;
	memset(sum, 0, 2 * (size_t)c->member_count * sizeof *sum);
	for (int k = 0; k < c->held_count; k++) {
		press(w, c->held[k].a, w->contact_point[k].arm_a, rb_vec3_neg(force[k]), sum);
		press(w, c->held[k].b, w->contact_point[k].arm_b, force[k], sum);
	}
	for (int k = 0; k < w->joints.count; k++)
		press_joint(&w->joints.row[k], multiplier[k], sum);
	for (int k = 0; k < c->member_count; k++) {
		const int i = c->member[k];

		w->linear[k] = rb_vec3_add_scaled(w->linear[k], l->model->inverse_mass[i],
		                                  sum[2 * k]);
		if (l->top)
			w->angular[k] = rb_vec3_add(w->angular[k],
			                            rb_inverse_inertia_apply(l, i,
			                                                     w->pose[k].orientation,
			                                                     sum[2 * k + 1]));
	}
	rb_arena_back(l->arena, here);
	return true;
}

bool rb_modes_is_slow(const struct rb_modes *w, int contact, double t)
{
	RB_ASSERT_COSTLY(contact >= 0);
	return rb_event_set_is_slow(
		w->l, &w->contact_point[contact],
		rb_vec3_dot(relative_acceleration(w, contact, t), w->contact[contact].slip),
		w->force[contact]);
}

bool rb_modes_turns_aside(const struct rb_modes *w, int contact)
{
	const struct rb_held *const held = &w->c->held[contact];
	const struct rb_contact_point *m = &w->contact_point[contact];
	const bool single = rb_event_set_is_single(w->l, held->a, held->b);
	const rb_vec3 slip = rb_vec3_reject(m->velocity, m->normal);
	const rb_vec3 direction = w->contact[contact].slip;
	const rb_vec3 off = rb_vec3_add_scaled(slip, -rb_vec3_dot(slip, direction), direction);
	const double least = single ? 0 : turned_share * rb_vec3_length(slip);

	return held->straight && held->friction > 0 && !held->creeps &&
	       (single || !w->slow[contact]) &&
	       rb_vec3_length(off) > fmax(least, STRAIGHT_NOISES * rb_contact_point_noise(w->l, m));
}

double rb_modes_residual(struct rb_modes *w, double t)
{
	const struct rb_cluster *c = w->c;
	double max = 0;
	int row = 0;

	for (; row < w->joints.count; row++) {
		w->dense.right[row] = -(
			rb_coupled_rate(&w->coupled.row[row], w->linear, w->angular) +
			w->joints.row[row].bias);
		max = fmax(max, fabs(w->dense.right[row]));
	}
	for (int i = 0; i < c->held_count; i++) {
		const rb_vec3 residual = relative_acceleration(w, i, t);

		for (int k = 0; k < rb_modes_unknowns(&c->held[i]); k++, row++) {
			w->dense.right[row] = -component_of(w, i, k, residual);
			max = fmax(max, fabs(w->dense.right[row]));
		}
	}
	return max;
}

bool rb_modes_refine(struct rb_modes *w, double t)
{
	const struct rb_cluster *c = w->c;
	double before = HUGE_VAL;

	for (int round = 0; round < REFINEMENTS; round++) {
		const double residual = rb_modes_residual(w, t);
		int row = w->joints.count;

		w->residual = residual;
		/* redundant contacts may contradict each other; then a residual remains */
		if (!(residual > 4 * DBL_EPSILON * w->max) || !(residual < 0.5 * before))
			return true;
		before = residual;
		if (row > 0)
			rb_coupled_again(&w->coupled, &w->dense);
		else
			rb_dense_again(&w->dense);
		for (int k = 0; k < w->dense.n && row > 0; k++)
			w->unknown[k] += w->dense.right[k];
		for (int k = 0; k < row; k++) {
			w->joint_change[k] = w->dense.right[k];
			w->multiplier[k] += w->joint_change[k];
		}
		for (int i = 0; i < c->held_count; i++) {
			w->change[i] = (rb_vec3){0, 0, 0};
			for (int k = 0; k < rb_modes_unknowns(&c->held[i]); k++, row++)
				w->change[i] = rb_vec3_add_scaled(w->change[i], w->dense.right[row],
				                                  unit_of(w, i, k));
			w->force[i] = rb_vec3_add(w->force[i], w->change[i]);
		}
		if (!rb_modes_press(w, w->change, w->joint_change))
			return false;
	}
	return true;
}

/* The member's place, or a copy of a fixed body's accelerations. */
static int body_of(const struct rb_modes *w, struct rb_simultaneous *problem, int body, double t)
{
	const int place = rb_modes_place(w, body);

	if (place >= 0)
		return place;
	problem->body[problem->body_count] = rb_mechanics_fixed(w->l, body, t);
	return problem->body_count++;
}

bool rb_modes_solve_any(struct rb_modes *w, double t, struct rb_solver_body **found)
{
	struct rb_located *l = w->l;
	const struct rb_cluster *c = w->c;
	const rb_arena_mark here = rb_arena_here(l->arena);
	struct rb_simultaneous problem = {.arena = l->arena,
	                                  .contact_count = c->held_count,
	                                  .body_count = c->member_count,
	                                  .interrupt = &l->world->interrupt,
	                                  .probes = found != NULL};

	problem.body = rb_arena_take(
		l->arena, (size_t)(c->member_count + 2 * c->held_count + 2 * w->joints.count),
		sizeof *problem.body);
	problem.joint_row = rb_arena_take(l->arena, (size_t)w->joints.count + 1,
	                                  sizeof *problem.joint_row);
	problem.contact = rb_arena_take(l->arena, (size_t)c->held_count, sizeof *problem.contact);
	rb_mat3 *const root = rb_arena_take(l->arena, (size_t)c->member_count, sizeof *root);
	if (!problem.body || !problem.contact || !root || !problem.joint_row)
		return false;
	problem.root = root;
	for (int k = 0; k < c->member_count; k++) {
		problem.body[k] = rb_mechanics_body(l, c->member[k], w->linear[k], w->angular[k]);
		root[k] = rb_mechanics_root(l, c->member[k], &w->pose[k]);
	}
	for (int k = 0; k < c->held_count; k++) {
		problem.contact[k] = w->contact[k];
		problem.contact[k].mode = c->held[k].slipping ? RB_SOLVER_SLIDE : RB_SOLVER_STICK;
		problem.contact[k].a = body_of(w, &problem, c->held[k].a, t);
		problem.contact[k].b = body_of(w, &problem, c->held[k].b, t);
		problem.contact[k].impulse = c->held[k].force;
	}
	problem.joint_count = rb_joint_rows_pose_problem(&w->joints, true, problem.joint_row,
	                                                 problem.body, &problem.body_count);
	if (found) /* for forces other than the known ones */
		rb_joint_rows_guess(&w->joints, true, w->multiplier, problem.joint_row);
	const int rows = problem.contact_count + problem.joint_count;
	problem.products_max = rb_modes_move(w) ? rb_located_products(l, rows) : 0;
	rb_simultaneous_forces(&problem);
	rb_joint_rows_read_problem(&w->joints, true, problem.joint_row, w->multiplier);
	if (rb_modes_move(w))
		rb_located_count(l, problem.products, rows);
	for (int k = 0; k < c->held_count; k++)
		w->force[k] = problem.contact[k].impulse;
	if (found)
		*found = problem.body;
	else
		rb_arena_back(l->arena, here);
	return true;
}

int *rb_modes_take_places(struct rb_located *l, const struct rb_cluster *c)
{
	int *const kept = rb_arena_take(l->arena, (size_t)c->member_count, sizeof *kept);

	for (int k = 0; kept && k < c->member_count; k++) {
		kept[k] = l->place[c->member[k]];
		l->place[c->member[k]] = k;
	}
	return kept;
}

void rb_modes_give_back_places(struct rb_located *l, const struct rb_cluster *c, const int *kept)
{
	for (int k = 0; k < c->member_count; k++)
		l->place[c->member[k]] = kept[k];
}

/*
 * Takes the arrays of the elimination and of the members' joints; places are not the members' yet.
 */
static bool reserve_joints(struct rb_modes *w, size_t unknowns)
{
	struct rb_arena *const arena = w->l->arena;

	w->joints = (struct rb_joint_rows){
		.l = w->l, .body = w->c->member, .pose = w->pose, .body_count = w->c->member_count};
	if (w->l->model->joints) {
		const int *const kept = rb_modes_take_places(w->l, w->c);

		if (!kept)
			return false;
		const bool good = rb_joint_rows_collect(&w->joints);
		rb_modes_give_back_places(w->l, w->c, kept);
		if (!good)
			return false;
	}
	const size_t rows = (size_t)w->joints.count;
	if (rows > 0) {
		const size_t drives = RB_JOINT_PARTS_HELD * (size_t)w->joints.joint_count;
		const size_t all = unknowns + rows, max = RB_MODES_DENSE;
		unknowns = all > max + drives ? 0 : all > max ? max : all;
		w->coupled = (struct rb_coupled){.l = w->l,
		                                 .body = w->c->member,
		                                 .pose = w->pose,
		                                 .body_count = w->c->member_count,
		                                 .kept = &w->kept};
		w->kept = (struct rb_coupled_kept){.block = &w->l->factors,
		                                   .capacity = &w->l->factors_capacity};
		w->multiplier = rb_arena_take(arena, 2 * rows, sizeof *w->multiplier);
		w->unknown = rb_arena_take(arena, unknowns + 1, sizeof *w->unknown);
		if (!w->multiplier || !w->unknown ||
		    !rb_coupled_reserve(&w->coupled, (int)unknowns))
			return false;
		w->joint_change = w->multiplier + rows;
	}
	w->direct_max = (int)unknowns;
	return rb_coupled_reserve_dense(arena, &w->dense, (int)unknowns);
}

bool rb_modes_reserve(struct rb_modes *w)
{
	struct rb_cluster *c = w->c;
	struct rb_arena *arena = w->l->arena;
	size_t unknowns = 0;

	for (int k = 0; k < c->held_count; k++)
		unknowns += (size_t)rb_modes_unknowns(&c->held[k]);
	if (unknowns > RB_MODES_DENSE)
		unknowns = 0;
	w->pose = rb_arena_take(arena, (size_t)c->member_count, sizeof *w->pose);
	w->base = rb_arena_take(arena, (size_t)c->member_count, sizeof *w->base);
	w->linear = rb_arena_take(arena, (size_t)c->member_count, sizeof *w->linear);
	w->angular = rb_arena_take(arena, (size_t)c->member_count, sizeof *w->angular);
	w->contact_point = rb_arena_take(arena, (size_t)c->held_count + 1,
	                                 sizeof *w->contact_point);
	w->contact = rb_arena_take(arena, (size_t)c->held_count + 1, sizeof *w->contact);
	w->force = rb_arena_take(arena, (size_t)c->held_count + 1, sizeof *w->force);
	w->change = rb_arena_take(arena, (size_t)c->held_count + 1, sizeof *w->change);
	w->slow = rb_arena_take(arena, (size_t)c->held_count + 1, sizeof *w->slow);
	if (w->l->account_s) {
		w->parts = rb_arena_take(arena, (size_t)c->member_count, sizeof *w->parts);
		w->node_entries = rb_arena_take(arena, (size_t)RB_GAUSS_NODES * RB_ENTRIES,
		                                sizeof *w->node_entries);
		if (!w->parts || !w->node_entries)
			return false;
	}
	return reserve_joints(w, unknowns) && w->pose && w->base && w->linear && w->angular &&
	       w->contact_point && w->contact && w->force && w->change && w->slow;
}
