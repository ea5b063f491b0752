/* SPDX-License-Identifier: MIT */
#include "stepped/joined_rebound.h"

#include <string.h>

#include "base/error.h"
#include "constraint/contact_row.h"
#include "constraint/coulomb.h"
#include "constraint/simultaneous.h"
#include "world/world.h"

/* Matrix-vector products times the number of rows: as for impacts within a step. */
static const long work_max = 200000;
/*
 * Most rows of joints, several for each contact of the largest island: factors of more cost the
 * most.
 */
enum { HELD_MAX = 4 * RB_IMPACT_CONTACTS };
/* Tolerance of subsequent velocities, relative to the fastest approach. */
static const double fine_share = 1e-9;
/* Residual, relative to the fastest row, above which stopping has failed. */
static const double failed_share = 1e-6;

struct group {
	const struct rb_solver *solver;
	const struct rb_world *world;
	const struct rb_step_points *points;
	struct rb_row_system rows;
	const struct rb_island *island;
	struct rb_arena *arena;
	int *place; /* [bodies of the solver + 1]: index in the problem */
	struct rb_solver_body *before;
	rb_mat3 *root;
	/* rows that take part, contacts first, between bodies of the problem */
	struct rb_constraint *row;
	int *contact, *held; /* their indices among the island's rows */
	double *restitution; /* by row of the island: of limits and ropes */
	int body_count, contact_count, held_count;
	int unit; /* unit of mass 2^unit kg, so that results are the same with all masses doubled */
};

/* H with H^T H the tensor, upper triangular; false: not positive definite. */
static bool take_root(const rb_mat3 *tensor, double scale, rb_mat3 *root)
{
	*root = (rb_mat3){{{0}}};
	for (int k = 0; k < 3; k++)
		for (int x = k; x < 3; x++) {
			double rest = scale * tensor->m[k][x];

			for (int y = 0; y < k; y++)
				rest -= root->m[y][k] * root->m[y][x];
			if (x == k && !(rest > 0))
				return false;
			root->m[k][x] = x == k ? sqrt(rest) : rest / root->m[k][k];
		}
	return true;
}

/* Velocities as the step began, after the impacts within it. */
static struct rb_solver_body body_before(const struct group *g, int i)
{
	const struct rb_state *mark = &g->world->mark;
	struct rb_solver_body body = g->rows.bodies.body[i];

	body.linear = rb_world_row3(mark->velocity, i);
	if (mark->spin)
		body.angular = rb_world_row3(mark->spin, i);
	if (g->solver->kicks) {
		const struct rb_kick *const kick = rb_kick_of(g->solver->kicks, i);

		body.linear = rb_vec3_add(body.linear, kick->linear);
		body.angular = rb_vec3_add(body.angular, kick->angular);
	}
	body.inverse_mass = ldexp(body.inverse_mass, g->unit);
	if (!isnan(body.inverse_inertia))
		body.inverse_inertia = ldexp(body.inverse_inertia, g->unit);
	return body;
}

static bool take_members(struct group *g)
{
	const int *const member = g->solver->member + g->island->first_member;
	double max = 0;

	for (int k = 0; k < g->island->member_count; k++)
		max = fmax(max, 1 / g->rows.bodies.body[member[k]].inverse_mass);
	(void)frexp(max, &g->unit);
	for (int k = 0; k < g->island->member_count; k++) {
		const int i = member[k];

		g->place[i] = g->body_count;
		g->before[g->body_count] = body_before(g, i);
		if (isnan(g->before[g->body_count].inverse_inertia) &&
		    !take_root(&g->solver->tensor[i], ldexp(1, g->unit), &g->root[g->body_count]))
			return false;
		g->body_count++;
	}
	return true;
}

/* Index of a body in the problem; a body that is not dynamic has one for each row. */
static int index_of(struct group *g, int i)
{
	if (g->rows.bodies.body[i].inverse_mass > 0)
		return g->place[i];
	g->before[g->body_count] = g->rows.bodies.body[i];
	return g->body_count++;
}

/* Whether a row of a joint constrains its bodies, now or always. */
static bool holds(const struct rb_constraint *row)
{
	if (row->set == RB_CONSTRAINT_FREE)
		return true;
	if (!(row->low < row->high) || row->softness > 0 || !isfinite(row->target.n))
		return false;
	return rb_constraint_side(row) != 0 || (isinf(row->low) && isinf(row->high));
}

/* A limit or a rope. */
static bool is_stop(const struct rb_constraint *row)
{
	return row->set == RB_CONSTRAINT_INTERVAL && rb_constraint_side(row) != 0;
}

static const struct rb_step_point *point_of(const struct group *g, int row)
{
	return &g->points->row[g->solver->point[g->island->first_row + row]];
}

/* m/s: normal velocity of a row after the step's solution. */
static double velocity_of(const struct group *g, int row)
{
	const struct rb_constraint *of = &g->rows.row[row];

	return rb_vec3_dot(rb_constraint_velocity(&g->rows.bodies, of), of->normal);
}

/* Whether a contact has touched within the step, or touches at its end. */
static bool touches(const struct group *g, int row)
{
	const struct rb_step_point *point = point_of(g, row);

	return point->normal_impulse > 0 || point->gap + g->solver->h_s * velocity_of(g, row) <=
	                                            g->world->model->stepped_tolerance_m;
}

/*
 * Sets the restitution of the joints of one member; joints between two members are visited twice.
 */
static void take_restitution(struct group *g, int i)
{
	const struct rb_joints *joints = g->world->model->joints;

	for (int e = joints->first[i]; e < joints->first[i + 1]; e++) {
		const int number = joints->of[e];
		const struct rb_joint *joint = &joints->joint[number];
		const int at = g->solver->joint[number].first_row - g->island->first_row;
		const int count = rb_step_joint_rows_count(joint);

		if (g->world->joint[number].released)
			continue;
		RB_ASSERT(at >= g->island->contact_count && at + count <= g->island->row_count);
		for (int r = 0; r < count; r++)
			g->restitution[at + r] = joint->restitution;
	}
}

/*
 * Selects the rows that take part; false: one limit or rope alone needs no law. Contacts alone do:
 * an island that hangs on slack ropes has not been resolved within the step.
 */
static bool take_rows(struct group *g)
{
	const struct rb_island *island = g->island;
	int stops = 0;

	for (int k = 0; k < island->contact_count; k++)
		if (touches(g, k))
			g->contact[g->contact_count++] = k;
	for (int k = island->contact_count; k < island->row_count - island->spring_count; k++)
		if (holds(&g->rows.row[k])) {
			g->held[g->held_count++] = k;
			stops += is_stop(&g->rows.row[k]);
		}
	for (int k = 0; k < island->member_count && stops > 0; k++)
		take_restitution(g, g->solver->member[island->first_member + k]);
	return (g->contact_count > 0 || stops > 1) && g->held_count <= HELD_MAX;
}

/* A row between bodies of the problem. */
static struct rb_constraint row_between(struct group *g, const struct rb_constraint *of)
{
	struct rb_constraint row = *of;

	row.a = index_of(g, of->a);
	row.b = index_of(g, of->b);
	if (of->central) {
		row.arm_a = rb_constraint_arm_a(of);
		row.arm_b = rb_constraint_arm_b(of);
		row.central = false;
	}
	if (rb_constraint_side(of) < 0) {
		row.normal = rb_vec3_neg(of->normal);
		row.high = -of->low;
		row.low = 0;
	}
	rb_constraint_clear(&row);
	return row;
}

/*
 * Makes the rows between the bodies as before: rows of joints keep their velocities; contacts,
 * limits and ropes end with the velocities of the step's solution.
 */
static bool make_rows(struct group *g)
{
	const size_t count = (size_t)(g->contact_count + g->held_count);

	g->row = rb_arena_take(g->arena, count, sizeof *g->row);
	if (!g->row)
		return false;
	for (int k = 0; k < g->contact_count; k++) {
		const struct rb_constraint *of = &g->rows.row[g->contact[k]];

		g->row[k] = row_between(g, of);
		g->row[k].target = (rb_along_across){fmin(velocity_of(g, g->contact[k]), 0),
		                                     {0, 0, 0}};
		if (!g->world->state.spin)
			g->row[k].friction = 0;
	}
	for (int k = 0; k < g->held_count; k++) {
		struct rb_constraint *const row = &g->row[g->contact_count + k];

		*row = row_between(g, &g->rows.row[g->held[k]]);
		const struct rb_solver_bodies bodies = {.body = g->before, .root = g->root};
		if (is_stop(row)) {
			const double now = rb_constraint_side(&g->rows.row[g->held[k]]) *
			                   velocity_of(g, g->held[k]);

			row->target = (rb_along_across){fmin(now, 0), {0, 0, 0}};
		} else {
			row->target = rb_constraint_split(row,
			                                  rb_constraint_velocity(&bodies, row));
		}
	}
	return true;
}

/* Copies the bodies as before; NULL: no memory. */
static struct rb_solver_body *take_bodies(const struct group *g)
{
	struct rb_solver_body *const body = rb_arena_take(g->arena, (size_t)g->body_count,
	                                                  sizeof *body);

	if (body)
		memcpy(body, g->before, (size_t)g->body_count * sizeof *body);
	return body;
}

static long products_max(const struct group *g)
{
	return work_max / (g->contact_count + g->held_count);
}

/* Computes L(u); false: it has not converged, or no memory. */
static bool apply_law(const struct group *g, struct rb_simultaneous *law)
{
	double approach = 0;

	*law = (struct rb_simultaneous){.root = g->root,
	                                .body = take_bodies(g),
	                                .body_count = g->body_count,
	                                .contact_count = g->contact_count,
	                                .joint_count = g->held_count,
	                                .arena = g->arena,
	                                .interrupt = g->solver->interrupt,
	                                .products_max = products_max(g)};
	law->contact = rb_arena_take(g->arena, (size_t)g->contact_count, sizeof *law->contact);
	law->joint_row = rb_arena_take(g->arena, (size_t)g->held_count, sizeof *law->joint_row);
	if (!law->body || !law->contact || !law->joint_row)
		return false;
	for (int k = 0; k < g->contact_count; k++) {
		const struct rb_constraint *row = &g->row[k];
		const struct rb_step_point *point = point_of(g, g->contact[k]);

		law->contact[k] = (struct rb_solver_contact){
			.a = row->a,
			.b = row->b,
			.pair = {point->a, point->b},
			.normal = row->normal,
			.arm_a = row->arm_a,
			.arm_b = row->arm_b,
			.friction = row->friction,
			.restitution = point->material->restitution,
			/* slower rebounds are ignored */
			.noise = g->solver->tolerance};
		approach = fmax(approach, point->approach);
	}
	for (int k = 0; k < g->held_count; k++) {
		const struct rb_constraint *const row = &g->row[g->contact_count + k];
		const struct rb_solver_bodies bodies = {.body = g->before, .root = g->root};

		law->joint_row[k] = (struct rb_cone_row){.base = *row};
		if (!is_stop(row))
			continue;
		law->joint_row[k].base.target.n = 0;
		law->joint_row[k].restitution = g->restitution[g->held[k]];
		law->joint_row[k].noise = rb_islands_joint_tolerance(g->solver);
		approach = fmax(approach,
		                -rb_vec3_dot(rb_constraint_velocity(&bodies, row), row->normal));
	}
	law->tolerance = fine_share * approach;
	return rb_simultaneous_impact(law, NULL) && !rb_simultaneous_is_over(law);
}

/* Computes P(u). */
static bool stop_all(const struct group *g, struct rb_cone *cone)
{
	const int count = g->contact_count + g->held_count;
	double scale = 0;

	*cone = (struct rb_cone){.bodies = {.body = take_bodies(g), .root = g->root},
	                         .body_count = g->body_count,
	                         .row_count = count,
	                         .row = rb_arena_take(g->arena, (size_t)count, sizeof *cone->row),
	                         .arena = g->arena,
	                         .max = products_max(g),
	                         .interrupt = g->solver->interrupt};
	if (!cone->bodies.body || !cone->row)
		return false;
	for (int k = 0; k < count; k++) {
		const struct rb_constraint *row = &g->row[k];

		cone->row[k] = (struct rb_cone_row){.base = *row};
		scale = fmax(scale, rb_vec3_length(rb_constraint_velocity(&cone->bodies, row)));
	}
	if (!rb_cone_open(cone))
		return false;
	return rb_cone_resolve(cone, scale) <= failed_share * scale && !rb_cone_is_over(cone);
}

/* Applies the difference of both to the island's rows and bodies. */
static void apply_difference(const struct group *g, const struct rb_simultaneous *law,
                             const struct rb_cone *stopped)
{
	const int *const member = g->solver->member + g->island->first_member;
	const double unit = ldexp(1, g->unit);

	for (int k = 0; k < g->island->member_count; k++) {
		struct rb_solver_body *const body = &g->rows.bodies.body[member[k]];
		const struct rb_solver_body *to = &law->body[k], *from = &stopped->bodies.body[k];

		body->linear = rb_vec3_add(body->linear, rb_vec3_sub(to->linear, from->linear));
		body->angular = rb_vec3_add(body->angular, rb_vec3_sub(to->angular, from->angular));
	}
	for (int k = 0; k < g->island->row_count; k++)
		rb_constraint_clear(&g->rows.row[k]);
	for (int k = 0; k < g->contact_count; k++) {
		struct rb_constraint *const row = &g->rows.row[g->contact[k]];
		const rb_vec3 change = rb_vec3_sub(law->contact[k].impulse,
		                                   rb_constraint_impulse(&stopped->row[k].base));

		row->impulse = rb_constraint_split(row, rb_vec3_scale(unit, change));
	}
	for (int k = 0; k < g->held_count; k++) {
		struct rb_constraint *const row = &g->rows.row[g->held[k]];
		const rb_along_across p = law->joint_row[k].base.impulse;
		const rb_along_across q = stopped->row[g->contact_count + k].base.impulse;
		const double sign = rb_constraint_side(row) < 0 ? -unit : unit;

		row->impulse.n = sign * (p.n - q.n);
		row->impulse.t = rb_vec3_scale(unit, rb_vec3_sub(p.t, q.t));
	}
}

/* Whether joints have acted on a body in the step; `joined`: whether it has any joints. */
static bool is_held(const struct rb_solver *solver, const struct rb_world *world, int i,
                    bool *joined)
{
	const struct rb_joints *joints = world->model->joints;
	bool held = false;

	if (i >= world->model->body_count)
		return false;
	for (int e = joints->first[i]; e < joints->first[i + 1] && !held; e++) {
		const int number = joints->of[e];

		if (world->joint[number].released)
			continue;
		held = !joints->joint[number].link.type->one_sided ||
		       solver->joint[number].impulse[0] != 0;
		*joined = true;
	}
	return held;
}

bool rb_joined_rebound_is_due(const struct rb_solver *solver, const struct rb_world *world,
                              const struct rb_step_points *points,
                              const struct rb_step_point *point, bool single)
{
	bool joined = false;

	if (!world->model->joints || !(point->material->friction > 0) ||
	    !(point->normal_impulse > 0) || !(point->approach > solver->tolerance) ||
	    (point->from > 0 && points->last[point->from - 1].force > 0))
		return false;
	const bool held_a = is_held(solver, world, point->a, &joined);
	const bool held_b = is_held(solver, world, point->b, &joined);

	return held_a || held_b ? single : joined && !point->central;
}

bool rb_joined_rebound(struct rb_solver *solver, const struct rb_world *world,
                       const struct rb_step_points *points, const struct rb_island *island,
                       struct rb_arena *arena)
{
	struct group g = {.solver = solver,
	                  .world = world,
	                  .points = points,
	                  .rows = rb_islands_rows(solver, island),
	                  .island = island,
	                  .arena = arena};
	const size_t bodies = (size_t)island->member_count + 2 * (size_t)island->row_count;
	struct rb_simultaneous law;
	struct rb_cone stopped;

	RB_ASSERT(island->rebounds && island->contact_count <= island->row_count);
	if (island->row_count == island->contact_count + island->spring_count ||
	    island->contact_count > RB_IMPACT_CONTACTS)
		return false;
	g.place = rb_arena_take(arena, (size_t)solver->body_count + 1, sizeof *g.place);
	g.before = rb_arena_take(arena, bodies, sizeof *g.before);
	g.root = rb_arena_take(arena, bodies, sizeof *g.root);
	g.contact = rb_arena_take(arena, (size_t)island->row_count, sizeof *g.contact);
	g.held = rb_arena_take(arena, (size_t)island->row_count, sizeof *g.held);
	g.restitution = rb_arena_take(arena, (size_t)island->row_count, sizeof *g.restitution);
	if (!g.place || !g.before || !g.root || !g.contact || !g.held || !g.restitution)
		return false;
	if (!take_members(&g) || !take_rows(&g) || !make_rows(&g) || !apply_law(&g, &law) ||
	    !stop_all(&g, &stopped))
		return false;
	apply_difference(&g, &law, &stopped);
	return true;
}
