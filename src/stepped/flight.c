/* SPDX-License-Identifier: MIT */
/*
 * Times of impact within a step. Motion is the parabola x(t) = x + shift + t (v + t a), with a =
 * (v' - v) / h from the forces of the step; a is zero for bodies that rest on contacts, since these
 * will carry the forces. Where forces vary within a step the path is straight, with v'.
 *
 * Two spheres: the distance is a convex function of t on a straight path, so Newton's method from
 * below converges monotonically without overshoot; where forces make it concave, it overshoots once
 * and converges from above. All other contacts keep the normal and arm of their point, and the time
 * is the smaller root of a quadratic, written in the form without cancellation.
 *
 * An approach is an impact only above `least`: what forces add in a step and the residual of the
 * solver are lasting contact.
 */
#include "stepped/flight.h"

#include <float.h>

#include "base/error.h"
#include "stepped/rolling.h"

/*
 * STEPS_MAX: Newton steps to a touch; from afar, near a grazing pass, each at worst halves the
 * distance. GAP_ULP: rounding of a distance, in ulp of the radii. SPEED_ULP: rounding of an
 * approach, in ulp of the speeds that enter it.
 */
enum { STEPS_MAX = 32, GAP_ULP = 4, SPEED_ULP = 64 };
/* Approaches below this many residuals of the previous solution are its error, not impacts. */
static const double residual_share = 16;
/*
 * A gap below this share of the approach in a step counts as closed. SOME_STEPS: an impact without
 * restitution must exceed the speed that forces make in so many steps. BENDS: an impact must exceed
 * this multiple of the approach that rolling makes in one step, which varies from step to step.
 */
static const double closed_share = 1e-3;
enum { SOME_STEPS = 4, BENDS = 2 };
/*
 * Cosine of the angle round a rim, about a microradian, within which a point counts as its lowest
 * one: its position is rounded, by an angle of an ulp of it over the radius.
 */
static const double lowest_share = 1 - 0x1p-40;

static double larger(double a, double b)
{
	return a > b ? a : b;
}

struct rb_flight_motion rb_flight_of(const struct rb_flight *flight, int i, rb_vec3 arm)
{
	const struct rb_world *world = flight->world;
	const struct rb_state *now = &world->state, *mark = &world->mark;
	struct rb_flight_motion motion = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};

	if (i >= world->model->body_count)
		return motion;
	const struct rb_kick *kick = rb_kick_of(&world->stepped->kicks, i);
	const rb_vec3 before = rb_world_row3(mark->velocity, i);
	rb_vec3 more = rb_vec3_sub(rb_world_row3(now->velocity, i), before);

	motion.velocity = rb_vec3_add(before, kick->linear);
	motion.shift = kick->shift;
	if (now->spin) {
		const rb_vec3 spin = rb_world_row3(mark->spin, i);

		motion.velocity = rb_vec3_add(motion.velocity,
		                              rb_vec3_cross(rb_vec3_add(spin, kick->angular), arm));
		motion.shift = rb_vec3_add(motion.shift, rb_vec3_cross(kick->turn, arm));
		more = rb_vec3_add(
			more, rb_vec3_cross(rb_vec3_sub(rb_world_row3(now->spin, i), spin), arm));
	}
	if (!flight->held[i])
		motion.external = rb_vec3_scale(1 / flight->h_s, more);
	return motion;
}

/* Rotates for `t` seconds, which may be negative. */
static void turn_for(const struct rb_flight *flight, int i, double t,
                     struct rb_flight_turning *turning)
{
	const struct rb_stepped *s = flight->world->stepped;
	const rb_vec3 none = {0, 0, 0};

	if (t == 0 || rb_vec3_max_abs(turning->spin) == 0)
		return;
	if (!s->top || s->top[i].kind == RB_TOP_CONSTANT) {
		turning->orientation = rb_quat_turned(turning->orientation,
		                                      rb_vec3_scale(t, turning->spin));
		return;
	}
	/* backwards: the reversed spin retraces the rotation */
	const rb_vec3 spin = t < 0 ? rb_vec3_neg(turning->spin) : turning->spin;
	struct rb_top top = rb_top_start(&s->top[i], turning->orientation, spin, none);

	rb_top_at(&top, fabs(t), &turning->orientation, &turning->spin);
	if (t < 0)
		turning->spin = rb_vec3_neg(turning->spin);
}

struct rb_flight_turning rb_flight_turning(const struct rb_flight *flight, int i, double t)
{
	const struct rb_state *mark = &flight->world->mark;
	const struct rb_kick *kick = rb_kick_of(&flight->world->stepped->kicks, i);
	struct rb_flight_turning turning = {
		.orientation = kick->turns ? kick->orientation
	                                   : rb_quat_from(mark->orientation + 4 * (size_t)i),
		.spin = kick->turns ? kick->spin : rb_world_row3(mark->spin, i)};

	if (rb_stepped_is_dynamic(flight->world, i))
		turn_for(flight, i, t, &turning);
	return turning;
}

/* The angular impulse of forces is that at the beginning, whatever the orientation now. */
rb_vec3 rb_flight_forced_spin(const struct rb_flight *flight, int i, rb_quat orientation)
{
	const struct rb_world *world = flight->world;
	const struct rb_model *model = world->model;
	const rb_vec3 more = rb_vec3_sub(rb_world_row3(world->state.spin, i),
	                                 rb_world_row3(world->mark.spin, i));

	if (rb_vec3_max_abs(more) == 0 || !isnan(model->inverse_inertia_scalar[i]))
		return more;
	const rb_quat from = rb_quat_from(world->mark.orientation + 4 * (size_t)i);
	const rb_vec3 twist = rb_quat_rotate(
		from, rb_mat3_apply(rb_model_inertia(model, i), rb_quat_rotate_back(from, more)));

	return rb_quat_rotate(orientation, rb_mat3_apply(rb_model_inverse_inertia(model, i),
	                                                 rb_quat_rotate_back(orientation, twist)));
}

void rb_flight_kick(const struct rb_flight *flight, int i, double t,
                    const struct rb_flight_turning *at, const struct rb_solver_body *more)
{
	const struct rb_world *world = flight->world;
	struct rb_kicks *const kicks = &world->stepped->kicks;

	if (kicks->place[i] == 0) {
		kicks->place[i] = ++kicks->count;
		kicks->row[kicks->count] = (struct rb_kick){.body = i};
	}
	struct rb_kick *const kick = &kicks->row[kicks->place[i]];

	kick->linear = rb_vec3_add(kick->linear, more->linear);
	kick->shift = rb_vec3_add_scaled(kick->shift, -t, more->linear);
	if (!world->state.spin || rb_vec3_max_abs(more->angular) == 0)
		return;
	struct rb_flight_turning from = {at->orientation, rb_vec3_add(at->spin, more->angular)};
	const rb_vec3 was = kick->angular;

	kick->angular = rb_vec3_sub(from.spin, rb_world_row3(world->mark.spin, i));
	kick->turn = rb_vec3_add_scaled(kick->turn, -t, rb_vec3_sub(kick->angular, was));
	turn_for(flight, i, -t, &from);
	kick->orientation = from.orientation;
	kick->spin = from.spin;
	kick->turns = true;
}

void rb_flight_turn_from(const struct rb_flight *flight, struct rb_state *state, int i)
{
	const struct rb_world *world = flight->world;
	const struct rb_kicks *const kicks = &world->stepped->kicks;
	struct rb_kick *const kick = &kicks->row[kicks->place[i]];
	const rb_vec3 forced = rb_flight_forced_spin(flight, i, kick->orientation);
	const rb_vec3 before = rb_world_row3(world->mark.spin, i);

	kick->angular = rb_vec3_sub(kick->spin, before);
	rb_vec3_to(state->spin + 3 * (size_t)i,
	           rb_vec3_add(rb_vec3_add(before, kick->angular), forced));
	rb_quat_to(state->orientation + 4 * (size_t)i, kick->orientation);
}

bool rb_flight_is_plain(const struct rb_flight *flight, const struct rb_step_point *point)
{
	return point->central && flight->world->model->shape[point->b].kind == RB_SHAPE_SPHERE;
}

/* Motion of b relative to a at the point; for spheres, of the centres. */
static struct rb_flight_motion relative(const struct rb_flight *flight,
                                        const struct rb_step_point *point)
{
	/* arms along the normal: rotation has no part in the approach */
	const rb_vec3 none = {0, 0, 0};
	const struct rb_flight_motion a = rb_flight_of(flight, point->a,
	                                               point->central ? none : point->arm_a);
	const struct rb_flight_motion b = rb_flight_of(flight, point->b,
	                                               point->central ? none : point->arm_b);

	return (struct rb_flight_motion){rb_vec3_sub(b.velocity, a.velocity),
	                                 rb_vec3_sub(b.external, a.external),
	                                 rb_vec3_sub(b.shift, a.shift)};
}

/*
 * The same for positions: forces that vary within a step give their impulse at its beginning, so
 * that paths are straight, and lever arms of impacts are those of the actual motion.
 */
static struct rb_flight_motion path(const struct rb_flight *flight,
                                    const struct rb_step_point *point)
{
	struct rb_flight_motion motion = relative(flight, point);

	if (flight->world->stepped->varied) {
		motion.velocity = rb_flight_velocity(&motion, flight->h_s);
		motion.external = (rb_vec3){0, 0, 0};
	}
	return motion;
}

/* Displacement after t seconds, m. */
static rb_vec3 displacement(const struct rb_flight_motion *motion, double t)
{
	return rb_vec3_add_scaled(motion->shift, t, rb_flight_velocity(motion, t));
}

/* Sum of radii, m: arms along the normal are r_a and -r_b. */
static double radii_of(const struct rb_step_point *point)
{
	return point->arm_a.x - point->arm_b.x;
}

static rb_vec3 center_of(const struct rb_flight *flight, int i)
{
	const struct rb_world *world = flight->world;

	return i < world->model->body_count ? rb_world_row3(world->state.position, i)
	                                    : world->model->position[i];
}

/* Vector from centre to centre at the beginning of the step. */
static rb_vec3 between(const struct rb_flight *flight, const struct rb_step_point *point)
{
	return rb_vec3_sub(center_of(flight, point->b), center_of(flight, point->a));
}

/* Signed distance in m at time t, and the normal there. */
static double gap_of(const struct rb_flight *flight, const struct rb_step_point *point,
                     const struct rb_flight_motion *motion, double t, rb_vec3 *normal)
{
	const rb_vec3 moved = displacement(motion, t);

	*normal = point->normal;
	if (!rb_flight_is_plain(flight, point))
		return point->gap + point->bend + rb_vec3_dot(point->normal, moved);
	const rb_vec3 d = rb_vec3_add(between(flight, point), moved);
	const double distance = rb_vec3_length(d);
	if (distance > 0)
		*normal = rb_vec3_scale(1 / distance, d);
	return distance - radii_of(point);
}

double rb_flight_gap(const struct rb_flight *flight, const struct rb_step_point *point, double t,
                     rb_vec3 *normal)
{
	const struct rb_flight_motion motion = path(flight, point);

	return gap_of(flight, point, &motion, t, normal);
}

double rb_flight_approach(const struct rb_flight *flight, const struct rb_step_point *point,
                          rb_vec3 normal)
{
	return -rb_vec3_dot(relative(flight, point).velocity, normal);
}

bool rb_flight_is_done(const struct rb_flight *flight, const struct rb_step_point *point, double t,
                       double noise)
{
	const struct rb_flight_motion motion = relative(flight, point);

	return -rb_vec3_dot(motion.velocity, point->normal) <= noise ||
	       -rb_vec3_dot(rb_flight_velocity(&motion, t), point->normal) <= noise;
}

/* Residual of the previous solution at the contacts of either body, m/s. */
static double residual_of(const struct rb_flight *flight, const struct rb_step_point *point)
{
	const struct rb_solver *solver = &flight->world->stepped->solver;
	const double left = solver->residual[point->a];

	return point->b < solver->body_count ? larger(left, solver->residual[point->b]) : left;
}

double rb_flight_rounding(const struct rb_flight *flight, int i)
{
	const double size = flight->world->stepped->solver.reach[i];

	return DBL_EPSILON * (rb_vec3_max_abs(center_of(flight, i)) + size) / flight->h_s;
}

/* Part of the approach that the forces of the step make, m/s. */
static double closing_by_forces(const struct rb_flight *flight, const struct rb_step_point *point,
                                rb_vec3 normal)
{
	const struct rb_world *world = flight->world;
	const int ends[2] = {point->a, point->b};
	double closing = 0;

	for (int e = 0; e < 2; e++) {
		if (ends[e] >= world->model->body_count)
			continue;
		const rb_vec3 before = rb_world_row3(world->mark.velocity, ends[e]);
		const rb_vec3 after = rb_world_row3(world->state.velocity, ends[e]);
		const double more = rb_vec3_dot(rb_vec3_sub(after, before), normal);

		closing += e == 0 ? more : -more;
	}
	return closing;
}

double rb_flight_approach_min(const struct rb_flight *flight, const struct rb_step_point *point,
                              rb_vec3 normal)
{
	const struct rb_world *world = flight->world;
	const int ends[2] = {point->a, point->b};
	const double closing = closing_by_forces(flight, point, normal);
	double rounding = 0;

	for (int e = 0; e < 2; e++) {
		if (ends[e] >= world->model->body_count)
			continue;
		const rb_vec3 arm = e == 0 ? point->arm_a : point->arm_b;
		const double speed = rb_vec3_length(rb_flight_of(flight, ends[e], arm).velocity);
		rounding = larger(rounding,
		                  DBL_EPSILON * speed + rb_flight_rounding(flight, ends[e]));
	}
	const double allowance = larger(closing, residual_share * residual_of(flight, point));
	const double least = allowance < flight->tolerance ? allowance : flight->tolerance;
	/* a rolling rim gains as much approach between two steps by its curved path */
	const double rolling = point->rolls && point->from > 0 ? BENDS * fabs(point->bend) : 0;
	return larger(larger(SPEED_ULP * rounding, least), rolling / flight->h_s);
}

/* Jointed bodies are solved in steps that are cut at impacts (stepped/attempt). */
bool rb_flight_splits(const struct rb_flight *flight, const struct rb_step_point *point)
{
	const double h = flight->h_s, approach = point->approach;

	return point->material->restitution == 0 && point->from == 0 &&
	       approach > residual_share * residual_of(flight, point) &&
	       point->gap > closed_share * h * approach &&
	       approach > SOME_STEPS * closing_by_forces(flight, point, point->normal);
}

/*
 * Approach that decides whether the point has an impact, or 0: its rebound, or the approach itself
 * for impacts without restitution that are resolved here.
 */
static double rebound(const struct rb_flight *flight, const struct rb_step_point *point,
                      double approach)
{
	if (point->rolls_to)
		return 0;
	if (point->material->restitution > 0)
		return point->material->restitution * approach;
	return flight->mixed || rb_flight_splits(flight, point) ? approach : 0;
}

bool rb_flight_could_touch(const struct rb_flight *flight, const struct rb_step_point *point)
{
	const struct rb_world *world = flight->world;
	const double h = flight->h_s;

	if (!(rebound(flight, point, point->approach) > 0))
		return false;
	if (point->gap <= h * point->approach)
		return true;
	rb_vec3 u = rb_vec3_neg(rb_world_row3(world->state.velocity, point->a));
	if (point->b < world->model->body_count)
		u = rb_vec3_add(u, rb_world_row3(world->state.velocity, point->b));
	return !point->central || point->gap <= -h * rb_vec3_dot(u, point->normal);
}

struct possible {
	const struct rb_flight *flight;
	struct rb_step_points *points;
	unsigned char *could;
	bool any; /* written by all workers */
};

/* Whether both points are on one rim of the same part. */
static bool share_rim(const struct rb_step_point *x, const struct rb_step_point *y)
{
	bool share = false;

	for (int shift = 0; shift <= 32; shift += 32) {
		const int end = rb_rolling_end((rb_part)(x->key >> shift));

		share = share || (end >= 0 && end == rb_rolling_end((rb_part)(y->key >> shift)));
	}
	return share && x->a == y->a && x->b == y->b && x->parts == y->parts;
}

/*
 * Whether a rim that rolls on another of its points comes to this one: without an impact, though it
 * approaches on straight paths.
 */
static bool rolls_to(const struct rb_step_points *points, size_t k)
{
	const struct rb_step_point *row = points->row, *point = &row[k];
	bool found = false;

	if (point->rolls || point->from > 0 ||
	    (rb_rolling_end((rb_part)point->key) < 0 &&
	     rb_rolling_end((rb_part)(point->key >> 32)) < 0))
		return false;
	for (size_t o = k; o-- > 0 && row[o].pair == point->pair && !found;)
		found = row[o].rolls && row[o].from > 0 && share_rim(point, &row[o]);
	for (size_t o = k + 1; o < points->count && row[o].pair == point->pair && !found; o++)
		found = row[o].rolls && row[o].from > 0 && share_rim(point, &row[o]);
	return found;
}

enum { POINTS_PER_BLOCK = 512 };

static void find_possible_part(void *user, size_t first, size_t end)
{
	struct possible *possible = user;
	bool any = false;

	for (size_t k = first; k < end; k++) {
		possible->points->row[k].rolls_to = rolls_to(possible->points, k);
		possible->could[k] = rb_flight_could_touch(possible->flight,
		                                           &possible->points->row[k]);
		any = any || possible->could[k];
	}
	if (any)
		__atomic_store_n(&possible->any, true, __ATOMIC_RELAXED);
}

bool rb_flight_find_possible(const struct rb_flight *flight, struct rb_step_points *points,
                             unsigned char *could)
{
	struct possible possible = {.flight = flight, .points = points, .could = could};

	rb_team_share(flight->world->team, points->count, POINTS_PER_BLOCK, find_possible_part,
	              &possible);
	return possible.any;
}

/* Time at which two spheres touch, from `now` on; INFINITY: not within the step. */
static double spheres_touch(const struct rb_flight *flight, const struct rb_step_point *point,
                            const struct rb_flight_motion *motion, double now)
{
	const double none = GAP_ULP * DBL_EPSILON * radii_of(point);
	double t = now;

	RB_ASSERT_COSTLY(radii_of(point) > 0);
	for (int step = 0; step < STEPS_MAX; step++) {
		rb_vec3 normal;
		const double gap = gap_of(flight, point, motion, t, &normal);
		const double rate = rb_vec3_dot(
			normal, rb_vec3_add_scaled(motion->velocity, 2 * t, motion->external));

		if (!(rate < 0))
			return (double)INFINITY;
		/* on a curved path a step may overshoot, and the next ones go back */
		if (gap <= none && (step == 0 || gap >= -none))
			return t;
		t = larger(now, t - gap / rate);
		if (!(t <= flight->h_s))
			return (double)INFINITY;
	}
	return t;
}

/*
 * Time at which a fixed plane is met: root of gap + t u + t^2 a = 0 from `now` on; at once if it
 * overlaps.
 */
static double face_touches(const struct rb_flight *flight, const struct rb_step_point *point,
                           const struct rb_flight_motion *motion, double now)
{
	rb_vec3 normal;
	const double c = gap_of(flight, point, motion, 0, &normal);
	const double b = rb_vec3_dot(normal, motion->velocity);
	const double a = rb_vec3_dot(normal, motion->external);
	const double square = b * b - 4 * a * c;

	if (gap_of(flight, point, motion, now, &normal) <= 0)
		return now;
	if (!(square >= 0))
		return (double)INFINITY;
	/* both roots without cancellation */
	const double q = -0.5 * (b + copysign(sqrt(square), b));
	const double x = q / a, y = c / q;
	const double first = x < y ? x : y, second = x < y ? y : x;
	const double t = first >= now ? first : second;
	return t >= now && t <= flight->h_s ? t : (double)INFINITY;
}

double rb_flight_touches(const struct rb_flight *flight, const struct rb_step_point *point,
                         double now)
{
	const struct rb_flight_motion motion = path(flight, point);
	const bool plain = rb_flight_is_plain(flight, point);
	const double t = plain ? spheres_touch(flight, point, &motion, now)
	                       : face_touches(flight, point, &motion, now);
	rb_vec3 normal;

	RB_ASSERT_COSTLY(now >= 0 && flight->h_s > 0);
	if (!(t <= flight->h_s))
		return (double)INFINITY;
	(void)gap_of(flight, point, &motion, t, &normal);
	const double approach = rb_flight_approach(flight, point, normal);
	return rebound(flight, point, approach) > rb_flight_approach_min(flight, point, normal)
	               ? t
	               : (double)INFINITY;
}

/* Vector between the centres of mass at t seconds, from a to b, with all forces. */
static rb_vec3 lever_at(const struct rb_flight *flight, const struct rb_step_point *point, double t)
{
	const struct rb_world *world = flight->world;
	const struct rb_kick *a = rb_kick_of(&world->stepped->kicks, point->a);
	const struct rb_kick *b = rb_kick_of(&world->stepped->kicks, point->b);
	const rb_vec3 u = rb_vec3_sub(rb_world_row3(world->state.velocity, point->b),
	                              rb_world_row3(world->state.velocity, point->a));
	const rb_vec3 kicked = rb_vec3_add(u, rb_vec3_sub(b->linear, a->linear));
	const rb_vec3 shift = rb_vec3_sub(b->shift, a->shift);

	return rb_vec3_add(between(flight, point), rb_vec3_add_scaled(shift, t, kicked));
}

/*
 * Part of an arm at the beginning of the step that keeps its direction along the normal when the
 * body rotates, m: a ball's radius round the core, and that of a cylinder's side, or of a rim at
 * its lowest point.
 */
static rb_vec3 round_of(const struct rb_world *world, int i, uint32_t number, rb_vec3 outward,
                        rb_vec3 arm)
{
	const struct rb_model *const model = world->model;

	if (!model->parts)
		return rb_vec3_scale(model->shape[i].radius, outward);
	const struct rb_body_part *const part = &rb_model_parts(model, i)->part[number];
	const rb_vec3 ball = rb_vec3_scale(part->core.radius, outward);

	if (part->core.kind != RB_CORE_CYLINDER)
		return ball;
	const rb_quat q = rb_quat_from(world->mark.orientation + 4 * (size_t)i);
	const rb_vec3 local = model->center_of_mass
	                              ? rb_vec3_sub(part->at, model->center_of_mass[i])
	                              : part->at;
	const rb_vec3 axis = rb_quat_rotate(
		q, (rb_vec3){part->turn.m[0][2], part->turn.m[1][2], part->turn.m[2][2]});
	const rb_vec3 side = rb_vec3_reject(outward, axis);
	const rb_vec3 here = rb_vec3_reject(
		rb_vec3_sub(rb_vec3_sub(arm, ball), rb_quat_rotate(q, local)), axis);

	if (!(rb_vec3_dot(side, here) > lowest_share * rb_vec3_length(side) * part->core.round))
		return ball;
	return rb_vec3_add(ball, here);
}

/* An arm of the beginning of the step, rotated to t seconds. */
static rb_vec3 turned(const struct rb_flight *flight, int i, double t, rb_vec3 arm, rb_vec3 round)
{
	const struct rb_world *world = flight->world;

	if (!world->state.spin)
		return arm;
	const struct rb_kick *const kick = rb_kick_of(&world->stepped->kicks, i);
	const rb_vec3 spin = rb_vec3_add(rb_world_row3(world->mark.spin, i), kick->angular);
	const rb_quat turn = rb_quat_from_turn(rb_vec3_add_scaled(kick->turn, t, spin));

	return rb_vec3_add(round, rb_quat_rotate(turn, rb_vec3_sub(arm, round)));
}

void rb_flight_move_point(const struct rb_flight *flight, struct rb_step_point *point, double t,
                          const rb_vec3 initial_arm[2], rb_vec3 arm[2])
{
	const struct rb_world *world = flight->world;
	const int of[2] = {point->a, point->b};
	/*
	 * arms are those at the beginning of the step: both bodies get one impulse whatever else
	 * holds them
	 */
	const bool joins = rb_stepped_is_dynamic(world, point->b);
	const rb_vec3 d = joins ? lever_at(flight, point, t) : (rb_vec3){0, 0, 0};
	const double gap = rb_flight_gap(flight, point, t, &point->normal);
	double half = 0;

	if (joins && point->central) {
		point->normal = rb_levers_normal(d, point->normal);
		half = 0.5 * (rb_vec3_dot(d, point->normal) - radii_of(point));
	} else if (joins) {
		rb_vec3 normal;

		arm[0] = turned(flight, point->a, t, initial_arm[0],
		                round_of(world, point->a, point->parts >> 16, point->normal,
		                         initial_arm[0]));
		arm[1] = turned(flight, point->b, t, initial_arm[1],
		                round_of(world, point->b, point->parts & 0xffff,
		                         rb_vec3_neg(point->normal), initial_arm[1]));
		rb_levers_join(world, of, d, point->normal, arm);
		point->arm_a = arm[0];
		point->arm_b = arm[1];
		/* keeps the gap at this moment */
		point->bend += gap - rb_flight_gap(flight, point, t, &normal);
	}
	const rb_vec3 n = point->normal;
	arm[0] = point->central ? rb_vec3_scale(point->arm_a.x + half, n) : point->arm_a;
	arm[1] = point->central ? rb_vec3_scale(point->arm_b.x - half, n) : point->arm_b;
}

rb_vec3 rb_flight_place(const struct rb_flight *flight, const struct rb_step_point *point, double t)
{
	const struct rb_world *world = flight->world;
	const int i = point->a;
	const struct rb_flight_motion motion = rb_flight_of(flight, i, (rb_vec3){0, 0, 0});
	const uint32_t number = i < point->b ? point->parts >> 16 : point->parts & 0xffff;
	const rb_vec3 at = rb_vec3_add_scaled(
		rb_vec3_add(rb_world_row3(world->state.position, i), motion.shift), t,
		rb_flight_velocity(&motion, t));
	rb_vec3 arm = point->arm_a;

	if (point->central)
		arm = rb_vec3_scale(point->arm_a.x, point->normal);
	else if (!rb_stepped_is_dynamic(world, point->b))
		arm = turned(flight, i, t, arm, round_of(world, i, number, point->normal, arm));
	return rb_vec3_add(at, arm);
}

/*
 * For two spheres, rotates the normal back to where the step's impulses act, with the same gap at
 * its end.
 */
static void rotate_normal_back(const struct rb_flight *flight, struct rb_step_point *point)
{
	const struct rb_flight_motion motion = path(flight, point);
	const rb_vec3 d = rb_vec3_add(between(flight, point), motion.shift);
	const rb_vec3 more = rb_vec3_scale(flight->h_s, rb_flight_velocity(&motion, flight->h_s));
	const rb_vec3 was = point->normal;

	point->normal = rb_levers_normal(d, was);
	point->bend += rb_vec3_dot(more, rb_vec3_sub(was, point->normal));
}

void rb_flight_update_point(const struct rb_flight *flight, struct rb_step_point *point,
                            bool touched)
{
	const struct rb_flight_motion motion = path(flight, point);

	RB_ASSERT_COSTLY(flight->h_s > 0);
	if (!rb_flight_is_plain(flight, point)) {
		point->bend += rb_vec3_dot(point->normal, motion.shift);
		point->approach = rb_flight_approach(flight, point, point->normal);
		return;
	}
	if (!touched) {
		/* at the closest approach */
		const rb_vec3 d = rb_vec3_add(between(flight, point), motion.shift);
		const double square = rb_vec3_dot(motion.velocity, motion.velocity);
		const double t = square > 0 ? -rb_vec3_dot(d, motion.velocity) / square : 0;

		(void)gap_of(flight, point, &motion, t > 0 ? fmin(t, flight->h_s) : 0,
		             &point->normal);
	}
	point->bend = rb_vec3_dot(point->normal,
	                          rb_vec3_add(between(flight, point), motion.shift)) -
	              radii_of(point) - point->gap;
	/* along the normal rotated back, separating spheres may approach: no rebound is due */
	point->approach = rb_flight_approach(flight, point, point->normal);
	if (rb_stepped_joins_arms(flight->world, point->b))
		rotate_normal_back(flight, point);
}
