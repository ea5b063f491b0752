/* SPDX-License-Identifier: MIT */
/*
 * Islands and rows of the linear complementarity problem. Union-find over points with two dynamic
 * bodies; the smaller index is always the root, so numbering does not depend on the order of
 * points. Bodies, members and rows are laid out by counting sorts into contiguous ranges per
 * island, which the sweeps then read in order.
 *
 * Rows hold scalar effective masses along the normal and the worst one across it. Contacts of one
 * face get arms in one plane (rb_levers_level), so that a rotating face does no work against its
 * own friction.
 */
#include "stepped/islands.h"

#include "base/error.h"
#include "base/forest.h"
#include "base/memory.h"
#include "constraint/effective_mass.h"
#include "force/spring.h"
#include "stepped/face.h"
#include "stepped/pivot.h"
#include "stepped/geometric_stiffness.h"
#include "world/joint_state.h"

/* ---- bodies ---- */

/* Inverse inertia in world axes, R I^-1 R^T. */
static rb_mat3 turned_tensor(const rb_mat3 *inverse, rb_quat orientation)
{
	const rb_mat3 r = rb_quat_to_mat3(orientation), t = rb_mat3_transposed(&r);
	const rb_mat3 half = rb_mat3_multiply(&r, inverse);

	return rb_mat3_multiply(&half, &t);
}

void rb_islands_fill_body(struct rb_solver *solver, const struct rb_world *world, int i)
{
	const struct rb_model *model = world->model;
	const struct rb_state *state = &world->state;
	struct rb_solver_body *body = &solver->dense.bodies.body[i];

	*body = (struct rb_solver_body){.linear = rb_world_row3(state->velocity, i),
	                                .inverse_mass = model->inverse_mass[i]};
	if (state->spin) {
		body->angular = rb_world_row3(state->spin, i);
		body->inverse_inertia = body->inverse_mass > 0 ? model->inverse_inertia_scalar[i]
		                                               : 0;
		if (isnan(body->inverse_inertia))
			solver->tensor[i] = turned_tensor(
				rb_model_inverse_inertia(model, i),
				rb_quat_from(state->orientation + 4 * (size_t)i));
	}
	solver->free[i] = *body;
}

/*
 * A parallel pass over bodies, points or rows; each iteration writes only its own element, or a
 * mark that others write with the same value.
 */
struct pass {
	struct rb_solver *solver;
	struct rb_world *world;
	struct rb_step_points *points;
	int *place; /* [points]: body, then root, then island, then row; -1: none */
};

enum { PER_BLOCK = 512 };

static void run_blocks(struct pass *pass, size_t count, rb_team_part *part)
{
	rb_team_share(pass->world->team, count, PER_BLOCK, part, pass);
}

/* Each body is its own tree at first. */
static void fill_bodies(void *user, size_t first, size_t end)
{
	const struct pass *pass = user;
	const struct rb_solver *solver = pass->solver;

	for (size_t k = first; k < end; k++) {
		const int i = solver->active[k];

		rb_islands_fill_body(pass->solver, pass->world, i);
		solver->parent[i] = i;
		solver->island_of[i] = -1;
	}
}

static bool is_dynamic(const struct rb_solver *solver, int i)
{
	return i < solver->body_count && solver->dense.bodies.body[i].inverse_mass > 0;
}

/* Whether a driven body of this contact moves. */
static bool is_moved(const struct rb_solver *solver, const struct rb_step_point *point)
{
	const int ends[2] = {point->a, point->b};

	RB_ASSERT_COSTLY(point->a >= 0 && point->b >= 0 && point->a != point->b);
	for (int e = 0; e < 2; e++) {
		if (ends[e] >= solver->body_count || is_dynamic(solver, ends[e]))
			continue;
		const struct rb_solver_body *body = &solver->dense.bodies.body[ends[e]];
		if (rb_vec3_max_abs(body->linear) > 0 || rb_vec3_max_abs(body->angular) > 0)
			return true;
	}
	return false;
}

/* ---- joints ---- */

struct rb_joint_query rb_islands_joints(const struct rb_solver *solver,
                                        const struct rb_world *world)
{
	return (struct rb_joint_query){.world = world,
	                               .before = solver->before,
	                               .bodies = &solver->dense.bodies,
	                               .fixed = solver->body_count,
	                               .h_s = solver->h_s,
	                               .whole_s = solver->whole_s,
	                               .lasts_s = solver->h_s,
	                               .share = 1};
}

/* The body to whose island a joint belongs. */
static int owner_of_joint(const struct rb_world *world, int k)
{
	return rb_step_joint_rows_owner(world->model, &world->model->joints->joint[k]);
}

/* Joints of the bodies of the step, each once. */
static void list_joints(struct rb_solver *solver, const struct rb_world *world)
{
	const struct rb_joints *joints = world->model->joints;

	solver->active_joint_count = 0;
	for (int k = 0; solver->joint && k < solver->active_count; k++) {
		const int i = solver->active[k];

		for (int e = joints->first[i]; e < joints->first[i + 1]; e++)
			if (owner_of_joint(world, joints->of[e]) == i &&
			    !world->joint[joints->of[e]].released)
				solver->active_joint[solver->active_joint_count++] = joints->of[e];
	}
}

static int count_joint_rows(const struct rb_solver *solver, const struct rb_world *world)
{
	int count = 0;

	for (int k = 0; k < solver->active_joint_count; k++)
		count += rb_step_joint_rows_count(
			&world->model->joints->joint[solver->active_joint[k]]);
	return count;
}

/* Whether a joint drives its island: its other end moves, or it has a running motor. */
static bool is_driving(const struct rb_solver *solver, const struct rb_world *world,
                       const struct rb_joint *joint)
{
	const int ends[2] = {joint->a, joint->b};
	bool moves = joint->has_motor && world->joint[joint->def].motor_speed != 0;

	for (int e = 0; e < 2 && !moves; e++) {
		if (ends[e] < 0 || ends[e] >= solver->body_count || is_dynamic(solver, ends[e]))
			continue;
		const struct rb_solver_body *body = &solver->dense.bodies.body[ends[e]];

		moves = rb_vec3_max_abs(body->linear) > 0 || rb_vec3_max_abs(body->angular) > 0;
	}
	return moves;
}

static struct rb_island *island_of_joint(struct rb_solver *solver, const struct rb_world *world,
                                         int k)
{
	return &solver->island[solver->island_of[owner_of_joint(world, k)]];
}

/* Counts rows of joints, before those of contacts are placed. */
static void add_joint_rows(struct rb_solver *solver, const struct rb_world *world)
{
	for (int k = 0; k < solver->active_joint_count; k++) {
		const struct rb_joint *joint =
			&world->model->joints->joint[solver->active_joint[k]];
		struct rb_island *island = island_of_joint(solver, world, solver->active_joint[k]);

		island->row_count += rb_step_joint_rows_count(joint);
		island->is_driven = island->is_driven || is_driving(solver, world, joint);
	}
}

/* After the rows of contacts. */
static void place_joint_rows(struct rb_solver *solver, const struct rb_world *world)
{
	for (size_t g = 0; g < solver->island_count; g++)
		solver->island[g].contact_count = solver->island[g].row_count;
	for (int k = 0; k < solver->active_joint_count; k++) {
		const int number = solver->active_joint[k];
		const int rows = rb_step_joint_rows_count(&world->model->joints->joint[number]);
		struct rb_island *island = island_of_joint(solver, world, number);
		const int at = island->first_row + island->row_count;

		solver->joint[number].first_row = rb_islands_has_no_rows(island) ? -1 : at;
		island->row_count += rows;
		for (int r = 0; r < rows && !rb_islands_has_no_rows(island); r++)
			solver->point[at + r] = -1;
	}
}

/* Adds the geometric stiffness of joints to a body's inertia. */
static void stiffen(struct rb_solver *solver, const struct rb_world *world, int i)
{
	struct rb_solver_body *const body = &solver->dense.bodies.body[i];

	solver->after_forces[i] = *body;
	solver->stiff[i] = solver->before &&
	                   rb_geometric_stiffness_add(world, solver->joint, i, solver->h_s, body,
	                                              &solver->tensor[i]);
	if (solver->stiff[i])
		solver->free[i] = *body;
}

static void fill_joints(void *user, size_t first, size_t end)
{
	const struct pass *pass = user;
	struct rb_solver *solver = pass->solver;
	struct rb_joint_query query = rb_islands_joints(solver, pass->world);

	for (size_t k = first; k < end; k++) {
		struct rb_step_joint *of = &solver->joint[solver->active_joint[k]];

		query.lasts_s = rb_islands_impulse_time(
			solver, island_of_joint(solver, pass->world, solver->active_joint[k]));
		if (of->first_row >= 0)
			rb_step_joint_rows_fill(&query, solver->active_joint[k], of,
			                        solver->dense.row + of->first_row);
	}
}

/* ---- springs ---- */

/* Whether a spring has rows in this step; position projection has none. */
static bool has_rows(const struct rb_solver *solver, const struct rb_step_spring *spring)
{
	return spring->joined && solver->before;
}

static int owner_of_spring(const struct rb_solver *solver, const struct rb_step_spring *spring)
{
	return rb_step_spring_owner(spring, &solver->dense.bodies, solver->body_count);
}

static struct rb_island *island_of_spring(const struct rb_solver *solver,
                                          const struct rb_step_spring *spring)
{
	return &solver->island[solver->island_of[owner_of_spring(solver, spring)]];
}

/* m: displacement of the end of an arm by impacts within the step. */
static rb_vec3 shifted(const struct rb_kick *kick, rb_vec3 arm)
{
	return rb_vec3_add(kick->shift, rb_vec3_cross(kick->turn, arm));
}

struct rb_spring_query rb_islands_springs(const struct rb_solver *solver,
                                          const struct rb_step_spring *spring)
{
	struct rb_spring_query query = {
		.bodies = &solver->dense.bodies,
		.fixed = solver->body_count,
		.lasts_s = rb_islands_impulse_time(solver, island_of_spring(solver, spring)),
		.ahead_s = solver->h_s};

	for (int e = 0; solver->kicks && e < 2; e++)
		if (spring->end[e] < solver->body_count)
			query.shift = rb_vec3_add_scaled(
				query.shift, e == 0 ? -1 : 1,
				shifted(rb_kick_of(solver->kicks, spring->end[e]), spring->arm[e]));
	return query;
}

/* Whether a moving body that is not dynamic is attached to a spring. */
static bool is_driven_spring(const struct rb_solver *solver, const struct rb_step_spring *spring)
{
	const int owner = owner_of_spring(solver, spring);
	const int other = spring->end[spring->end[0] == owner];

	if (other >= solver->body_count || is_dynamic(solver, other))
		return false;
	const struct rb_solver_body *body = &solver->dense.bodies.body[other];

	return rb_vec3_max_abs(body->linear) > 0 || rb_vec3_max_abs(body->angular) > 0;
}

static int count_spring_rows(const struct rb_solver *solver)
{
	int count = 0;

	for (int k = 0; k < solver->spring_count; k++)
		if (has_rows(solver, &solver->spring[k]))
			count += rb_step_spring_row_count(&solver->spring[k]);
	return count;
}

static void add_spring_rows(struct rb_solver *solver)
{
	for (int k = 0; k < solver->spring_count; k++) {
		const struct rb_step_spring *spring = &solver->spring[k];

		if (!has_rows(solver, spring))
			continue;
		struct rb_island *island = island_of_spring(solver, spring);

		island->row_count += rb_step_spring_row_count(spring);
		island->is_driven = island->is_driven || is_driven_spring(solver, spring);
		island->has_springs = true;
	}
}

/* After the rows of joints. */
static void place_spring_rows(struct rb_solver *solver)
{
	for (int k = 0; k < solver->spring_count; k++) {
		struct rb_step_spring *spring = &solver->spring[k];

		spring->first_row = -1;
		if (!has_rows(solver, spring))
			continue;
		struct rb_island *island = island_of_spring(solver, spring);
		const int rows = rb_step_spring_row_count(spring);
		const int at = island->first_row + island->row_count;

		island->row_count += rows;
		island->spring_count += rows;
		spring->first_row = rb_islands_has_no_rows(island) ? -1 : at;
		for (int r = 0; r < rows && !rb_islands_has_no_rows(island); r++)
			solver->point[at + r] = -1;
	}
}

/*
 * Largest number of joint rows used for a spring's effective mass: more give only a tighter bound.
 */
enum { SPRING_HELD_MAX = 16 };

/* Adds the bilateral rows of a body's joints; returns their number so far. */
static int add_held_rows(const struct rb_solver *solver, const struct rb_world *world, int i,
                         const struct rb_constraint **held, int count)
{
	const struct rb_joints *joints = world->model->joints;

	for (int e = joints->first[i]; e < joints->first[i + 1]; e++) {
		const int first = solver->joint[joints->of[e]].first_row;
		const int rows = rb_step_joint_rows_count(&joints->joint[joints->of[e]]);

		for (int r = 0; r < rows && first >= 0; r++) {
			const struct rb_constraint *row = &solver->dense.row[first + r];

			if (count < SPRING_HELD_MAX &&
			    (row->set == RB_CONSTRAINT_FREE ||
			     (row->softness == 0 && isinf(row->low) && isinf(row->high))))
				held[count++] = row;
		}
	}
	return count;
}

/*
 * Whether the step resolves a spring, and as many others of its bodies as there are, with the
 * effective mass that joints leave.
 */
static bool resolves(const struct rb_solver *solver, const struct rb_world *world,
                     const struct rb_step_spring *spring, const struct rb_spring_query *query)
{
	const struct rb_elements *springs = rb_model_elements(world->model, &rb_force_spring);
	const struct rb_constraint *held[SPRING_HELD_MAX];
	const double h = solver->h_s, response = h * (h * spring->stiffness + spring->damping);
	int rows = 0, count_max = 1;

	if (spring->resolved || !world->model->joints)
		return spring->resolved;
	for (int e = 0; e < 2; e++) {
		const int i = spring->end[e];

		if (!is_dynamic(solver, i))
			continue;
		rows = add_held_rows(solver, world, i, held, rows);
		if (springs->first[i + 1] - springs->first[i] > count_max)
			count_max = springs->first[i + 1] - springs->first[i];
	}
	return rows > 0 &&
	       response * count_max * rb_step_spring_inverse_mass(query, spring, held, rows) <= 1;
}

static void fill_springs(struct rb_solver *solver, const struct rb_world *world)
{
	for (int k = 0; k < solver->spring_count; k++) {
		struct rb_step_spring *spring = &solver->spring[k];

		if (spring->first_row < 0)
			continue;
		const struct rb_spring_query query = rb_islands_springs(solver, spring);

		spring->time = !resolves(solver, world, spring, &query)   ? RB_SPRING_AT_END
		               : island_of_spring(solver, spring)->halves ? RB_SPRING_AT_MEAN
		                                                          : RB_SPRING_AT_BEGIN;
		if (spring->time == RB_SPRING_AT_BEGIN)
			spring->impulse = rb_vec3_scale(-solver->h_s * spring->tension,
			                                spring->along);
		rb_step_spring_fill(&query, spring, solver->dense.row + spring->first_row);
	}
}

/* ---- islands ---- */

/* The dynamic body of a point, to whose island it belongs. */
static int owner_of(const struct rb_solver *solver, const struct rb_step_point *point)
{
	return is_dynamic(solver, point->a) ? point->a : point->b;
}

/* Joins the bodies of points in the forest; place[k] becomes the dynamic body of point k. */
static void join_points(void *user, size_t first, size_t end)
{
	const struct pass *pass = user;
	const struct rb_solver *solver = pass->solver;
	const bool shared = rb_team_workers(pass->world->team) > 1;

	for (size_t k = first; k < end; k++) {
		const struct rb_step_point *point = &pass->points->row[k];

		if (k > first && rb_face_is_pair(point, point - 1)) {
			pass->place[k] = pass->place[k - 1];
			continue;
		}
		pass->place[k] = owner_of(solver, point);
		RB_ASSERT_COSTLY(is_dynamic(solver, pass->place[k]));
		if (is_dynamic(solver, point->a) && is_dynamic(solver, point->b))
			rb_forest_join(solver->parent, point->a, point->b, shared);
	}
}

/* Union-find over points, joints and springs. */
static void join_all(struct pass *pass)
{
	const struct rb_solver *solver = pass->solver;

	run_blocks(pass, pass->points->count, join_points);
	for (int k = 0; k < solver->active_joint_count; k++) {
		const struct rb_joint *joint =
			&pass->world->model->joints->joint[solver->active_joint[k]];

		if (joint->b >= 0 && is_dynamic(solver, joint->a) && is_dynamic(solver, joint->b))
			rb_forest_join(solver->parent, joint->a, joint->b, false);
	}
	for (int k = 0; k < solver->spring_count; k++) {
		const int *end = solver->spring[k].end;

		if (has_rows(solver, &solver->spring[k]) && is_dynamic(solver, end[0]) &&
		    is_dynamic(solver, end[1]))
			rb_forest_join(solver->parent, end[0], end[1], false);
	}
}

/* Marks roots of bodies with points; place[k] becomes the root of point k. */
static void find_roots(void *user, size_t first, size_t end)
{
	const struct pass *pass = user;
	const struct rb_solver *solver = pass->solver;

	for (size_t k = first; k < end; k++) {
		const int root = rb_forest_root_shared(solver->parent, pass->place[k]);

		pass->place[k] = root;
		if (__atomic_load_n(&solver->island_of[root], __ATOMIC_RELAXED) < 0)
			__atomic_store_n(&solver->island_of[root], 0, __ATOMIC_RELAXED);
	}
}

/*
 * Numbers the islands that have points, joints or springs, in order of their smallest body, and
 * counts their members.
 */
static enum rb_status number_islands(struct pass *pass, struct rb_error *err)
{
	struct rb_solver *solver = pass->solver;
	const struct rb_world *world = pass->world;

	solver->island_count = 0;
	run_blocks(pass, pass->points->count, find_roots);
	for (int k = 0; k < solver->active_joint_count; k++)
		solver->island_of[rb_forest_root(
			solver->parent, owner_of_joint(world, solver->active_joint[k]))] = 0;
	for (int k = 0; k < solver->spring_count; k++)
		if (has_rows(solver, &solver->spring[k]))
			solver->island_of[rb_forest_root(
				solver->parent, owner_of_spring(solver, &solver->spring[k]))] = 0;
	for (int k = 0; k < solver->active_count; k++) {
		const int i = solver->active[k], root = rb_forest_root(solver->parent, i);

		if (solver->island_of[root] < 0)
			continue;
		if (root == i) {
			if (!rb_memory_reserve(&solver->island, &solver->island_capacity,
			                       solver->island_count + 1, sizeof *solver->island))
				return RB_FAIL(err, RB_ERR_MEMORY, "no memory for groups");
			solver->island_of[i] = (int)solver->island_count;
			solver->island[solver->island_count++] = (struct rb_island){0};
		}
		solver->island_of[i] = solver->island_of[root];
		solver->island[solver->island_of[i]].member_count++;
	}
	return RB_OK;
}

/* Counts rows of islands; place[k] becomes the island of point k. */
static void count_rows(void *user, size_t first, size_t end)
{
	const struct pass *pass = user;
	struct rb_solver *solver = pass->solver;
	const bool driven = pass->world->model->driven != NULL;
	bool moved = false;
	int count = 0;

	/* successive points mostly belong to one island */
	for (size_t k = first; k < end; k++) {
		const int g = solver->island_of[pass->place[k]];

		pass->place[k] = g;
		if (driven && !moved &&
		    !(count > 0 &&
		      rb_face_is_pair(&pass->points->row[k], &pass->points->row[k - 1])))
			moved = is_moved(solver, &pass->points->row[k]);
		count++;
		if (k + 1 < end && solver->island_of[pass->place[k + 1]] == g)
			continue;
		__atomic_fetch_add(&solver->island[g].row_count, count, __ATOMIC_RELAXED);
		if (moved)
			__atomic_store_n(&solver->island[g].is_driven, true, __ATOMIC_RELAXED);
		moved = false;
		count = 0;
	}
}

/* Counting sort of members by island. */
static void place_members(struct rb_solver *solver)
{
	int member = 0;

	for (size_t g = 0; g < solver->island_count; g++) {
		solver->island[g].first_member = member;
		member += solver->island[g].member_count;
		solver->island[g].member_count = 0;
	}
	RB_ASSERT(member <= solver->active_count);
	for (int k = 0; k < solver->active_count; k++) {
		const int i = solver->active[k];

		solver->local[i] = -1;
		if (solver->island_of[i] < 0)
			continue;
		struct rb_island *island = &solver->island[solver->island_of[i]];
		solver->member[island->first_member + island->member_count++] = i;
	}
	solver->local[solver->body_count] = -1;
}

/*
 * Counting sorts of members and rows by island. place[k] becomes the row of point k, -1 in islands
 * without rows.
 */
static void lay_out(struct pass *pass)
{
	struct rb_solver *solver = pass->solver;
	int *const place = pass->place;
	int row = 0;

	run_blocks(pass, pass->points->count, count_rows);
	for (size_t g = 0; g < solver->island_count; g++)
		solver->island[g].contact_count = solver->island[g].row_count;
	add_joint_rows(solver, pass->world);
	add_spring_rows(solver);
	place_members(solver);
	rb_islands_rest(solver, pass->points, place, &pass->world->arena[0]);
	if (solver->active_joint_count > 0)
		rb_islands_step_reduced(solver, pass->world, pass->points, place);
	for (size_t g = 0; g < solver->island_count; g++) {
		struct rb_island *island = &solver->island[g];

		island->first_row = row;
		row += rb_islands_has_no_rows(island) ? 0 : island->row_count;
		island->row_count = 0;
	}
	for (int k = 0; solver->before && k < solver->active_count; k++) {
		const int i = solver->active[k], g = solver->island_of[i];

		solver->asleep[i] = g >= 0 && solver->island[g].rests;
	}
	for (size_t k = 0; k < pass->points->count; k++) {
		struct rb_island *island = &solver->island[place[k]];
		const int at = island->first_row + island->row_count++;

		place[k] = rb_islands_has_no_rows(island) ? -1 : at;
	}
	RB_ASSERT(row >= 0);
	place_joint_rows(solver, pass->world);
	place_spring_rows(solver);
	solver->dense.row_count = row;
}

/* A ball that joints stiffen no longer has a scalar inertia. */
static bool is_stiff(const struct rb_solver *solver, const struct rb_step_point *point)
{
	return solver->stiff && (solver->stiff[point->a] ||
	                         (point->b < solver->body_count && solver->stiff[point->b]));
}

/* Sets the arms at which impulses act; where the pair pivots, their means over the step. */
static void set_arms(const struct pass *pass, struct rb_face *face, struct rb_constraint *row,
                     int number)
{
	const struct rb_step_point *const point = &pass->points->row[number];

	row->central = point->central;
	row->normal = point->normal;
	row->arm_a = point->arm_a;
	row->arm_b = point->arm_b;
	if (row->central && is_stiff(pass->solver, point)) {
		row->central = false;
		row->arm_a = rb_vec3_scale(point->arm_a.x, point->normal);
		row->arm_b = rb_vec3_scale(point->arm_b.x, point->normal);
		return;
	}
	if (row->central)
		return;
	rb_face_take(face, pass->points, number, pass->world, pass->solver->h_s);
	rb_levers_level(face->nearest->arm_a, face->nearest->arm_b, row);
	if (face->pivots) {
		row->arm_a = rb_pivot_turn(row->arm_a, row->normal, face->mean);
		row->arm_b = rb_pivot_turn(row->arm_b, row->normal, face->mean);
	}
}

rb_vec3 rb_islands_between(const struct rb_solver *solver, const double *position, int a, int b)
{
	const rb_vec3 d = rb_vec3_sub(rb_vec3_from(position + 3 * (size_t)b),
	                              rb_vec3_from(position + 3 * (size_t)a));

	if (!solver->before || !solver->kicks)
		return d;
	return rb_vec3_add(d, rb_vec3_sub(rb_kick_of(solver->kicks, b)->shift,
	                                  rb_kick_of(solver->kicks, a)->shift));
}

static void fill_row(const struct pass *pass, struct rb_face *face, struct rb_constraint *row,
                     int number)
{
	const struct rb_solver *const solver = pass->solver;
	const struct rb_step_points *const points = pass->points;
	const struct rb_step_point *const point = &points->row[number];

	RB_ASSERT_COSTLY(point->normal_impulse >= 0 && point->material->friction >= 0 &&
	                 solver->h_s > 0);
	row->a = point->a;
	row->b = point->b < solver->body_count ? point->b : solver->body_count;
	row->set = RB_CONSTRAINT_CONE;
	row->couple = false;
	row->friction = point->material->friction;
	row->low = row->high = row->softness = 0;
	row->target = (rb_along_across){-(point->gap + point->bend) / solver->h_s, {0, 0, 0}};
	rb_constraint_clear(row);
	row->impulse.n = point->normal_impulse;
	if (point->normal_impulse > 0) /* an impact or a later pass may have turned the normal */
		row->impulse.t = rb_constraint_within(
			rb_vec3_reject(point->friction_impulse, point->normal),
			row->friction * point->normal_impulse);
	set_arms(pass, face, row, number);
	if (solver->joins_arms && is_dynamic(solver, row->b))
		rb_levers_join_row(
			pass->world,
			rb_islands_between(solver, pass->world->state.position, row->a, row->b),
			row);
	rb_effective_mass_fill(&solver->dense.bodies, row);
}

static void fill_rows(void *user, size_t first, size_t end)
{
	const struct pass *pass = user;
	struct rb_face face = {.last = NULL};

	for (size_t k = first; k < end; k++) {
		struct rb_constraint fixed_row, *row = &fixed_row;

		if (pass->place[k] >= 0) {
			row = &pass->solver->dense.row[pass->place[k]];
			pass->solver->point[pass->place[k]] = (int)k;
			fill_row(pass, &face, row, (int)k);
		} else {
			set_arms(pass, &face, row, (int)k);
		}
		if (!row->central)
			pass->points->row[k].lever = row->arm_a;
	}
}

static enum rb_status prepare(struct rb_solver *solver, struct pass *pass, struct rb_error *err)
{
	const struct rb_step_points *points = pass->points;
	const struct rb_world *world = pass->world;
	int *place = rb_arena_take(&pass->world->arena[0], points->count, sizeof *place);

	list_joints(solver, world);
	const size_t rows = points->count + (size_t)count_joint_rows(solver, world) +
	                    (size_t)count_spring_rows(solver);
	if (!place ||
	    !rb_memory_reserve(&solver->dense.row, &solver->row_capacity, rows,
	                       sizeof *solver->dense.row) ||
	    !rb_memory_reserve(&solver->point, &solver->point_capacity, rows,
	                       sizeof *solver->point))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for %zu contacts", rows);
	pass->place = place;
	join_all(pass);
	const enum rb_status status = number_islands(pass, err);
	if (status != RB_OK)
		return status;
	lay_out(pass);
	if (solver->active_joint_count > 0)
		rb_islands_halve(solver, world);
	run_blocks(pass, points->count, fill_rows);
	if (solver->active_joint_count > 0)
		run_blocks(pass, (size_t)solver->active_joint_count, fill_joints);
	fill_springs(solver, world);
	RB_ASSERT_COSTLY(rb_row_system_is_sound(&solver->dense, solver->body_count + 1));
	return RB_OK;
}

enum rb_status rb_islands_make(struct rb_solver *solver, struct rb_world *world,
                               struct rb_step_points *points, struct rb_error *err)
{
	struct pass pass = {.solver = solver, .world = world, .points = points};
	struct rb_arena *arena = &world->arena[0];
	const rb_arena_mark here = rb_arena_here(arena);

	RB_ASSERT(solver->active_count >= 0 && solver->active_count <= solver->body_count);
	run_blocks(&pass, (size_t)solver->active_count, fill_bodies);
	solver->dense.bodies.body[solver->body_count] = (struct rb_solver_body){.inverse_mass = 0};
	for (int k = 0; solver->joint && k < solver->active_count; k++)
		stiffen(solver, world, solver->active[k]);
	const enum rb_status status = prepare(solver, &pass, err);
	rb_arena_back(arena, here); /* a step may have many attempts */
	return status;
}

double rb_islands_joint_tolerance(const struct rb_solver *solver)
{
	return solver->tolerance * solver->h_s / fmax(solver->h_s, solver->whole_s);
}
