/* SPDX-License-Identifier: MIT */
/*
 * src/constraint/contact_name, src/method/method: what a method knows of a contact point survives a
 * change of method.
 */
#include "worlds.h"

#include <float.h>

#include "located/crowd.h"
#include "located/engine.h"
#include "located/inspect.h"
#include "located/located.h"
#include "model/descriptor.h"
#include "stepped/stepped_state.h"
#include "world/world.h"

static const rb_vec3 none = {0, 0, 0};
static const double earth = 9.81, step_s = 1.0 / 400, frame_rate = 100;

static struct rb_body_def body_of(enum rb_shape_kind kind, rb_vec3 at, rb_quat turn)
{
	struct rb_body_def def = rb_body_def_default();

	def.call = "body";
	def.shape.kind = kind;
	def.mass = 1;
	def.position = at;
	def.orientation = turn;
	return def;
}

static int add_box(struct lab *lab, rb_vec3 size, rb_vec3 at, rb_quat turn)
{
	struct rb_body_def def = body_of(RB_SHAPE_BOX, at, turn);

	rb_vec3_to(def.shape.size, size);
	return lab_add(lab, &def);
}

static int add_round(struct lab *lab, enum rb_shape_kind kind, rb_vec3 at, rb_quat turn)
{
	struct rb_body_def def = body_of(kind, at, turn);

	def.shape.radius = 0.25;
	def.shape.size[2] = 0.6;
	return lab_add(lab, &def);
}

static int add_solid(struct lab *lab, enum rb_shape_kind kind, int solid, rb_vec3 at, rb_quat turn)
{
	struct rb_body_def def = body_of(kind, at, turn);

	def.shape.solid = solid;
	return lab_add(lab, &def);
}

static rb_quat about(rb_vec3 turn)
{
	return rb_quat_from_turn(turn);
}

static void open_auto(struct lab *lab, double friction, rb_vec3 gravity)
{
	lab_open(lab, 2, frame_rate);
	lab->scene.world.method = RB_METHOD_AUTO;
	lab->scene.world.time_step_s = step_s;
	lab->scene.world.gravity = gravity;
	lab_surface(lab, friction, 0);
}

/* On a floor, under its weight. */
static void open_floor(struct lab *lab)
{
	open_auto(lab, 0.5, (rb_vec3){0, 0, -earth});
	lab_plane(lab, none, (rb_vec3){0, 0, 1});
}

/* A tower of boxes. */
static void pile_up(struct lab *lab, int count)
{
	for (int k = 0; k < count; k++)
		lab_box(lab, (rb_vec3){0.4, 0.4, 0.2}, 1, (rb_vec3){0, 0, 0.1 + 0.2 * k},
		        rb_quat_identity);
}

/* From the frame that has been located, `steps` steps; then locating begins anew. */
static void change_to_steps(struct lab *lab, int steps)
{
	struct rb_world *world = lab->world;
	const struct rb_stepper *stepper = rb_model_method_row(world->model)->steps;

	assert_int_equal(world->dense_left, 0);
	assert_int_equal(stepper->prepare(world, &lab->error), RB_OK);
	assert_int_equal(stepper->take_over(world, &lab->error), RB_OK);
	rb_engine_roll_back(world->located);
	world->dense_left = world->dense_steps = steps;
	world->dense_work = (uint64_t)1 << 40; /* as much as it takes */
}

static void take_step(struct lab *lab)
{
	struct rb_world *world = lab->world;
	const struct rb_stepper *stepper = rb_model_method_row(world->model)->steps;

	assert_int_equal(stepper->step(world, world->state.time_s, step_s, &lab->error), RB_OK);
}

/* ---- names ---- */

static int add_prism(struct lab *lab)
{
	rb_vec3 points[16];
	int solid = -1;

	for (int k = 0; k < 16; k++)
		points[k] = (rb_vec3){0.5 * cos(0.78539816339744831 * k),
		                      0.5 * sin(0.78539816339744831 * k), k < 8 ? -0.2 : 0.2};
	assert_int_equal(rb_scene_add_hull(&lab->scene, points, 16, &solid, &lab->error), RB_OK);
	return solid;
}

enum { BOX, BOXES, CYLINDER, LYING, CAPSULE, HULLS, UNION, ACROSS, CASES };

static void put_up(struct lab *lab, int which)
{
	const rb_quat skew = about((rb_vec3){0, 0, 0.3}),
		      lies = about((rb_vec3){0, 1.5707963267948966, 0});
	const rb_vec3 size = {1, 0.8, 0.4};
	int solid;

	if (which != CYLINDER && which != LYING && which != HULLS && which != UNION)
		add_box(lab, size, (rb_vec3){0, 0, 0.2}, rb_quat_identity);
	switch (which) {
	case BOXES:
		add_box(lab, size, (rb_vec3){0.1, 0.05, 0.6}, skew);
		break;
	case CYLINDER:
		add_round(lab, RB_SHAPE_CYLINDER, (rb_vec3){0, 0, 0.3}, skew);
		break;
	case LYING:
		add_round(lab, RB_SHAPE_CYLINDER, (rb_vec3){0, 0, 0.25}, lies);
		break;
	case CAPSULE:
		add_round(lab, RB_SHAPE_CAPSULE, (rb_vec3){0.3, 0, 0.65}, lies);
		break;
	case HULLS:
		solid = add_prism(lab);
		add_solid(lab, RB_SHAPE_HULL, solid, (rb_vec3){0, 0, 0.2}, rb_quat_identity);
		add_solid(lab, RB_SHAPE_HULL, solid, (rb_vec3){0.1, 0.07, 0.6}, skew);
		break;
	case UNION:
		solid = lab_table_solid(lab);
		add_solid(lab, RB_SHAPE_UNION, solid, (rb_vec3){0, 0, 0.3}, skew);
		break;
	case ACROSS:
		add_round(lab, RB_SHAPE_CYLINDER, (rb_vec3){0.35, 0.02, 0.7}, rb_quat_identity);
		break;
	default:
		break;
	}
	lab_plane(lab, none, (rb_vec3){0, 0, 1});
}

static const struct rb_step_point *point_of(const struct rb_world *world,
                                            const struct rb_contact_name *name)
{
	const struct rb_step_points *points = &world->stepped->all.points;
	const struct rb_step_point *found = NULL;

	for (size_t k = 0; k < points->count; k++) {
		const struct rb_contact_name own = rb_step_point_name(&points->row[k]);

		if (!rb_contact_name_is(&own, name))
			continue;
		assert_null(found);
		found = &points->row[k];
	}
	return found;
}

/*
 * Places are those of one surface or the other, and what steps allow of a gap is below the
 * tolerance.
 */
static void the_same_point_has_the_same_name_in_both_methods(void **state)
{
	(void)state;
	for (int which = 0; which < CASES; which++) {
		struct rb_contact located[64];
		struct lab lab;

		open_auto(&lab, 0.5, (rb_vec3){0, 0, -earth});
		put_up(&lab, which);
		lab_seal(&lab, 1);
		lab_step(&lab);
		struct rb_world *world = lab.world;
		const size_t count = world->contacts.count;
		assert_in_range(count, 2, 64);
		memcpy(located, world->contacts.row, count * sizeof *located);
		change_to_steps(&lab, 1);
		world->stepped->solver.h_s = step_s;
		take_step(&lab);
		for (size_t k = 0; k < count; k++) {
			const struct rb_contact_name name = rb_contact_name_in(&located[k]);
			const struct rb_step_point *point = point_of(world, &name);

			if (!point)
				fail_msg("case %d: parts %x key %llx", which, name.parts,
				         (unsigned long long)name.key);
			assert_true(point->from > 0);
			const rb_vec3 at = rb_vec3_add(
				rb_world_row3(world->state.position, point->a), point->arm_a);
			assert_vector(at, located[k].point, 2 * world->model->tolerance_m);
		}
		lab_close(&lab);
	}
}

/* ---- forces ---- */

/*
 * Largest of what is known of a point in one list and differs in the other, N; HUGE_VAL: other
 * names.
 */
static double difference(const struct rb_contacts *contacts, const struct rb_contact *other,
                         size_t other_count)
{
	double max = contacts->count == other_count ? 0 : HUGE_VAL;

	for (size_t k = 0; k < contacts->count; k++) {
		const struct rb_contact *c = &contacts->row[k];
		const struct rb_contact_name name = rb_contact_name_in(c);
		double least = HUGE_VAL;

		for (size_t i = 0; i < other_count; i++) {
			const struct rb_contact_name of = rb_contact_name_in(&other[i]);

			if (rb_contact_name_is(&name, &of))
				least = fmax(fabs(c->normal_force - other[i].normal_force),
				             rb_vec3_max_abs(rb_vec3_sub(c->tangent_force,
				                                         other[i].tangent_force)));
		}
		max = fmax(max, least);
	}
	return max;
}

static size_t copy(struct rb_contact *to, const struct rb_contacts *contacts)
{
	assert_in_range(contacts->count, 1, 64);
	memcpy(to, contacts->row, contacts->count * sizeof *to);
	return contacts->count;
}

/*
 * A plank against a wall, with a part of it past where friction on the floor alone would hold it.
 */
static void lean(struct lab *lab)
{
	const double length = 2, high = 0.1, turn = 1.2;
	const double off = 0.5 * (length * cos(turn) + high * sin(turn)),
		     lift = 0.5 * (length * sin(turn) + high * cos(turn));

	open_auto(lab, 0.5, (rb_vec3){0, 0, -earth});
	add_box(lab, (rb_vec3){length, 0.5, high}, (rb_vec3){off, 0, lift},
	        about((rb_vec3){0, turn, 0}));
	lab_plane(lab, none, (rb_vec3){0, 0, 1});
	lab_plane(lab, none, (rb_vec3){1, 0, 0});
}

/* On an incline of 0.35 rad (tan 0.365), seen from it. */
static void incline(struct lab *lab, double friction)
{
	open_auto(lab, friction, (rb_vec3){earth * sin(0.35), 0, -earth * cos(0.35)});
	add_box(lab, (rb_vec3){1, 0.8, 0.6}, (rb_vec3){0, 0, 0.3}, about((rb_vec3){0, 0, 0.3}));
	lab_plane(lab, none, (rb_vec3){0, 0, 1});
}

/*
 * One body of 1 kg, whose located forces are constant and solve the equations of a step, too: gaps
 * are straight, velocities change evenly. So what a step does to them is rounding: in each of 16
 * sweeps, or of as many products of an elimination, four points add up forces of no more than the
 * weight, each sum with half an ulp of it. Located forces are found to 1e-13 of the largest
 * acceleration, by four points.
 */
static void the_force_of_every_point_is_continuous_over_a_change_of_method(void **state)
{
	(void)state;
	for (int which = 0; which < 3; which++) {
		struct rb_contact located[64], stepped[64];
		struct lab lab;

		if (which == 0)
			lean(&lab);
		else
			incline(&lab, which == 1 ? 0.5 : 0.2);
		lab_seal(&lab, 1);
		for (int k = 0; k < 10; k++)
			lab_step(&lab);
		struct rb_world *world = lab.world;
		const size_t count = copy(located, &world->contacts);
		double least = HUGE_VAL, most = 0;
		for (size_t k = 0; k < count; k++) {
			least = fmin(least, located[k].normal_force);
			most = fmax(most, located[k].normal_force);
		}
		/* the mean of a pair, or of the body, would not do */
		assert_true(which == 0 || most > 1.1 * least);
		change_to_steps(&lab, 8);
		lab_step(&lab);
		assert_true(difference(&world->contacts, located, count) <=
		            16 * 4 * 0.5 * DBL_EPSILON * earth);
		lab_step(&lab);
		assert_int_equal(world->dense_left, 0);
		copy(stepped, &world->contacts);
		lab_step(&lab);
		assert_true(world->located->started);
		assert_true(difference(&world->contacts, stepped, count) <= 1e-13 * 4 * earth);
		lab_close(&lab);
	}
}

/*
 * Of a rim that has come to lie flat locating counts points from where it landed, steps from the
 * floor's axes: what has no name there has the mean.
 */
static void a_rim_that_steps_count_from_elsewhere_starts_from_its_mean(void **state)
{
	struct lab lab;

	(void)state;
	open_auto(&lab, 0.5, (rb_vec3){0, 0, -earth});
	put_up(&lab, CYLINDER);
	lab_seal(&lab, 1);
	lab_step(&lab);
	struct rb_world *world = lab.world;
	assert_int_equal(world->contacts.count, 4);
	for (size_t k = 0; k < 4; k++) {
		struct rb_contact *c = &world->contacts.row[k];
		struct rb_contact_name name = rb_contact_name_in(c);

		name.half = (rb_vec3){k % 2 == 0 ? 1 : -1, 0, 0};
		c->key = rb_contact_name_shared(&name).key;
		assert_true(c->key == world->contacts.row[0].key);
		c->normal_force = 1 + (double)k;
	}
	change_to_steps(&lab, 1);
	assert_int_equal(world->stepped->all.points.last_count, 1);
	assert_near(world->stepped->all.points.last[0].force, 2.5, 1e-15);
	take_step(&lab);
	assert_int_equal(world->stepped->all.points.count, 4);
	for (size_t k = 0; k < 4; k++)
		assert_int_equal(world->stepped->all.points.row[k].from, 1);
	lab_close(&lab);
}

/* ---- cost ---- */

/*
 * Boxes off each other that stick to each other, on an incline where they stick or slide together.
 */
static void tower(struct lab *lab, double floor_friction)
{
	struct rb_material_def floor = rb_material_def_default();
	int material = -1;

	open_auto(lab, 0.8, (rb_vec3){earth * sin(0.35), 0, -earth * cos(0.35)});
	assert_int_equal(rb_scene_add_material(&lab->scene, &floor, &material, &lab->error), RB_OK);
	const struct rb_contact_pair_def pair = {0, material, floor_friction, 0};
	assert_int_equal(rb_scene_add_contact_pair(&lab->scene, &pair, &lab->error), RB_OK);
	for (int k = 0; k < 3; k++)
		add_box(lab, (rb_vec3){1, 1, 0.2},
		        (rb_vec3){0.03 * (k % 2), 0.02 * k, 0.1 + 0.2 * k},
		        about((rb_vec3){0, 0, 0.1 * k}));
	struct rb_body_def plane = rb_body_def_default();
	plane.call = "plane";
	plane.shape.kind = RB_SHAPE_PLANE;
	plane.orientation = rb_plane_orientation((rb_vec3){0, 0, 1}, (rb_vec3){(double)NAN, 0, 0});
	plane.is_static = true;
	plane.material = material;
	lab_add(lab, &plane);
}

/* What the first step after a change of method costs. */
struct cost {
	uint64_t sweeps, factors;
};

static void add_cost(struct cost *cost, double floor_friction, bool steps_know)
{
	struct lab lab;

	tower(&lab, floor_friction);
	lab_seal(&lab, 1);
	struct rb_world *world = lab.world;
	world->located->world_max = 1 << 20; /* whatever it costs */
	lab_step(&lab);
	if (!steps_know)
		world->contacts.count = 0;
	change_to_steps(&lab, 1);
	world->frame_counts = rb_counts_none;
	take_step(&lab);
	cost->sweeps += world->frame_counts.row_sweeps;
	cost->factors += world->frame_counts.factors;
	lab_close(&lab);
}

static void what_is_known_makes_the_first_step_cheaper(void **state)
{
	(void)state;
	struct cost known = {0, 0}, forgotten = {0, 0};

	/* single towers that slide start from what sticking would need, and may take more */
	for (int k = 1; k <= 16; k++) {
		add_cost(&known, 0.05 * k, true);
		add_cost(&forgotten, 0.05 * k, false);
	}
	assert_true(known.sweeps < forgotten.sweeps);
	assert_true(known.factors < forgotten.factors);
}

/* ---- steps that are located together ---- */

static enum rb_status nothing(void *user, struct rb_world *world, double t, double dt,
                              struct rb_error *err)
{
	(void)world, (void)t, (void)dt, (void)err;
	++*(int *)user;
	return RB_OK;
}

/* Evaluations of one body in a frame of `per_frame` steps that are located. */
static uint64_t evaluations(int per_frame, bool with_callback, int *called)
{
	const struct rb_world_options options = {.threads = 1};
	const struct rb_world_hooks hooks = {.user = called, .step = nothing};
	struct lab lab;

	open_auto(&lab, 0.5, (rb_vec3){0, 0, -earth});
	lab.scene.world.time_step_s = 1 / (frame_rate * per_frame);
	lab_sphere(&lab, 0.1, 1, (rb_vec3){0, 0, 1}, none);
	lab_seal_with(&lab, &options, with_callback ? &hooks : NULL);
	assert_int_equal(rb_world_step_frame(lab.world, &lab.error), RB_OK);
	const uint64_t count = lab.world->frame_counts.body_steps;
	lab_close(&lab);
	return count;
}

static void located_bodies_are_evaluated_once_where_nobody_asks_between_frames(void **state)
{
	int called = 0;

	(void)state;
	assert_int_equal(evaluations(1, false, &called), 1);
	assert_int_equal(evaluations(64, false, &called), 1);
	assert_int_equal(called, 0);
	assert_int_equal(evaluations(64, true, &called), 64);
	assert_int_equal(called, 64);
}

/* ---- attempts that fail at once ---- */

/* A tower that steps have brought to rest; then locating is tried, which may take nothing. */
static void an_attempt_that_fails_at_once_leaves_no_trace(void **state)
{
	struct lab lab;

	(void)state;
	open_floor(&lab);
	pile_up(&lab, 6);
	lab_seal(&lab, 1);
	struct rb_world *const world = lab.world;
	assert_int_equal(rb_world_step_frame(world, &lab.error), RB_OK);
	change_to_steps(&lab, 400);
	while (world->dense_left > 1)
		assert_int_equal(rb_world_step_frame(world, &lab.error), RB_OK);
	world->dense_left = 0;
	world->dense_work = 0;

	const size_t count = world->contacts.count;
	struct rb_contact *const kept = test_calloc(count, sizeof *kept);
	assert_true(count >= 24);
	memcpy(kept, world->contacts.row, count * sizeof *kept);
	const int sleeping = world->stepped->sleep.count;
	const struct rb_ledger ledger = world->ledger;
	assert_int_equal(sleeping, 6);

	world->located->world_max = 0;
	assert_int_equal(
		rb_engine_advance(world->located, world->state.time_s + step_s, &lab.error), RB_OK);
	assert_false(rb_engine_locates(world->located));
	assert_int_equal(world->contacts.count, count);
	assert_memory_equal(world->contacts.row, kept, count * sizeof *kept);
	assert_memory_equal(&world->ledger, &ledger, sizeof ledger);
	/* nor does a whole frame that begins with such an attempt wake anybody */
	assert_int_equal(rb_world_step_frame(world, &lab.error), RB_OK);
	assert_true(world->dense_left > 0);
	assert_int_equal(world->stepped->sleep.count, sleeping);
	test_free(kept);
	lab_close(&lab);
}

/* m: how far a ball beside a tower has fallen in a frame that begins with such an attempt. */
static double fallen_beside(int per_frame, bool with_callback, int *called)
{
	const struct rb_world_options options = {.threads = 1};
	const struct rb_world_hooks hooks = {.user = called, .step = nothing};
	struct lab lab;

	open_floor(&lab);
	lab.scene.world.time_step_s = 1 / (frame_rate * per_frame);
	lab_sphere(&lab, 0.1, 1, (rb_vec3){9, 0, 5}, none);
	pile_up(&lab, 6);
	lab_seal_with(&lab, &options, with_callback ? &hooks : NULL);
	lab.world->located->world_max = 0;
	assert_int_equal(rb_world_step_frame(lab.world, &lab.error), RB_OK);
	assert_false(rb_engine_locates(lab.world->located));
	const double z = lab.world->state.position[2];
	lab_close(&lab);
	return 5 - z;
}

/* Whether the frame has one step or many, and whether each has a callback. */
static void an_attempt_that_fails_at_once_leaves_out_no_step(void **state)
{
	const double all = 0.5 * earth / (frame_rate * frame_rate);
	int called = 0;

	(void)state;
	assert_true(fabs(fallen_beside(1, false, &called) - all) < 1e-12);
	assert_true(fabs(fallen_beside(4, false, &called) - all) < 1e-12);
	assert_true(fabs(fallen_beside(4, true, &called) - all) < 1e-12);
	assert_int_equal(called, 4);
}

/* A tower of 40 whose steps have paid for as many bodies, and for its forces only if it rests. */
static void no_attempt_is_made_that_forces_alone_make_too_dear(void **state)
{
	enum { BOXES_UP = 40, PAID = 60 };
	struct lab lab;

	(void)state;
	open_floor(&lab);
	pile_up(&lab, BOXES_UP);
	lab_seal(&lab, 1);
	struct rb_world *const world = lab.world;
	assert_int_equal(rb_world_step_frame(world, &lab.error), RB_OK);
	assert_true(world->contacts.count >= 4 * BOXES_UP);
	memset(world->state.velocity, 0, 3 * BOXES_UP * sizeof(double));
	memset(world->state.spin, 0, 3 * BOXES_UP * sizeof(double));
	world->dense_work = (uint64_t)8 * PAID * RB_LOCATED_PRODUCTS;
	assert_true(rb_crowd_may_attempt(world->located));
	world->state.velocity[3 * (BOXES_UP - 1)] = 1e-9;
	assert_false(rb_crowd_may_attempt(world->located));
	lab_close(&lab);
}

enum { FLYING = 40 };

/* Located for a frame: a row of boxes on the floor. */
static void open_row(struct lab *lab)
{
	open_floor(lab);
	for (int k = 0; k < FLYING; k++)
		lab_box(lab, (rb_vec3){0.4, 0.4, 0.2}, 1, (rb_vec3){k, 0, 0.1}, rb_quat_identity);
	lab_seal(lab, 1);
	assert_int_equal(rb_world_step_frame(lab->world, &lab->error), RB_OK);
	assert_true(rb_engine_locates(lab->world->located));
}

/* The same: a row of boxes that flies, `joined` into a chain. */
static void open_flight(struct lab *lab, double speed, bool joined)
{
	open_floor(lab);
	for (int k = 0; k < FLYING; k++)
		lab_box(lab, (rb_vec3){0.4, 0.4, 0.2}, 1, (rb_vec3){k, 0, 5}, rb_quat_identity);
	for (int k = 0; k < FLYING; k++)
		lab->scene.bodies[k + 1].velocity.y = speed;
	for (int k = 1; k < FLYING && joined; k++) {
		struct rb_joint_def def = rb_joint_def_default();

		def.kind = RB_JOINT_BALL;
		def.a = k;
		def.b = k + 1;
		def.at = (rb_vec3){k - 0.5, 0, 5};
		assert_int_equal(rb_scene_add_joint(&lab->scene, &def, NULL, &lab->error), RB_OK);
	}
	lab_seal(lab, 1);
	assert_int_equal(rb_world_step_frame(lab->world, &lab->error), RB_OK);
}

/* Bodies that fly fast may count often, until steps have shown what they cost; joints cost, too. */
static void speed_allows_no_more_than_steps_have_cost(void **state)
{
	const double seconds = 2 / frame_rate;

	(void)state;
	for (int joined = 0; joined < 2; joined++) {
		const int all = joined ? 2 * FLYING - 1 : FLYING;
		struct lab lab;

		open_flight(&lab, joined ? 0 : 100, joined);
		const double before = lab.world->located->pace;
		change_to_steps(&lab, 8);
		for (int k = 0; k < 3; k++)
			assert_int_equal(rb_world_step_frame(lab.world, &lab.error), RB_OK);
		assert_true(rb_engine_locates(lab.world->located));
		const double cost = 8.0 * all / RB_LOCATED_BODY_STEPS / seconds;
		const double now = lab.world->located->pace;
		if (joined)
			assert_true(fabs(now - fmin(before, cost)) < 1e-9 * cost);
		else
			assert_true(before > 10 * cost && fabs(now - cost) < 1e-9 * cost);
		assert_int_equal(lab.world->dense_body_steps, 8 * all);
		lab_close(&lab);
	}
}

/* What flies as one passes nothing by that. */
static void a_chain_that_flies_allows_as_much_as_one_that_falls(void **state)
{
	struct lab fast, slow;

	(void)state;
	open_flight(&fast, 100, true);
	open_flight(&slow, 0, true);
	assert_true(fast.world->located->pace == slow.world->located->pace);
	lab_close(&fast);
	lab_close(&slow);
}

/* The fastest allows 128 * 4 / 40, and each one, where 32 stand one. */
static void what_stands_allows_as_little_as_its_steps_cost(void **state)
{
	struct lab falls, stands;

	(void)state;
	open_flight(&falls, 0, false);
	open_row(&stands);
	const double each = falls.world->located->pace / (FLYING + 12.8);
	const double standing = stands.world->located->pace / (FLYING / 32.0 + 12.8);
	assert_true(fabs(standing - each) < 1e-9 * each);
	lab_close(&falls);
	lab_close(&stands);
}

/* Steps cost what their solutions take, of what moves alone: who stands may be known to. */
static void steps_count_the_solutions_of_what_moves(void **state)
{
	(void)state;
	for (int moves = 0; moves < 2; moves++) {
		const uint64_t step = RB_LOCATED_PRODUCTS / RB_LOCATED_BODY_STEPS;
		struct lab lab;

		open_floor(&lab);
		for (int k = 0; k < 3; k++)
			lab_box(&lab, (rb_vec3){0.4, 0.4, 0.2}, 1, (rb_vec3){k, 0, 0.1},
			        rb_quat_identity);
		for (int k = 1; k <= 3; k++)
			lab.scene.bodies[k].velocity.y = 5 * moves;
		lab_seal(&lab, 1);
		assert_int_equal(rb_world_step_frame(lab.world, &lab.error), RB_OK);
		change_to_steps(&lab, 1 << 20);
		lab.world->dense_work = 0;
		assert_int_equal(rb_world_step_frame(lab.world, &lab.error), RB_OK);
		const uint64_t all = lab.world->dense_body_steps;
		if (moves)
			assert_true(lab.world->dense_work > all * (step + 100));
		else
			assert_int_equal(lab.world->dense_work, all * (step / 32));
		lab_close(&lab);
	}
}

/* ---- what is located is so by either ---- */

/* A box that lands on an edge and grips, which takes many products of one small impact. */
static void land(struct lab *lab, enum rb_method_kind method)
{
	open_auto(lab, 1000, (rb_vec3){0, 0, -earth});
	lab->scene.world.method = method;
	lab_surface(lab, 1000, 0.3);
	lab_plane(lab, none, (rb_vec3){0, 0, 1});
	for (int k = 0; k < 3; k++)
		lab_box(lab, (rb_vec3){0.5, 0.5, 0.5}, 250, (rb_vec3){2 * k, 0, 0.25},
		        rb_quat_identity);
	lab->scene.bodies[1].velocity = (rb_vec3){-0.4, -1.5, 0};
	lab->scene.bodies[1].angular_velocity = (rb_vec3){-4.25, 0, 0};
	lab_seal(lab, 1);
	assert_int_equal(rb_world_step_frame(lab->world, &lab->error), RB_OK);
	assert_true(rb_engine_locates(lab->world->located));
}

/* How much is left to count leads to steps, and to no other answer. */
static void what_is_located_does_not_depend_on_what_may_be_counted(void **state)
{
	struct lab by_auto, located;

	(void)state;
	land(&by_auto, RB_METHOD_AUTO);
	land(&located, RB_METHOD_LOCATED);
	assert_memory_equal(by_auto.world->state.velocity, located.world->state.velocity,
	                    9 * sizeof(double));
	assert_memory_equal(by_auto.world->state.spin, located.world->state.spin,
	                    9 * sizeof(double));
	lab_close(&by_auto);
	lab_close(&located);
}

/* ---- frames that are taken back ---- */

/* Nobody pushes where there are no callbacks, nor after a frame has been taken back. */
static void locating_begins_again_after_a_frame_was_taken_back(void **state)
{
	struct lab lab;

	(void)state;
	open_floor(&lab);
	for (int k = 0; k < 2; k++)
		lab_box(&lab, (rb_vec3){1, 1, 1}, 1, (rb_vec3){3 * k, 0, 0.5}, rb_quat_identity);
	lab_seal(&lab, 1);
	struct rb_world *const world = lab.world;
	assert_int_equal(rb_world_step_frame(world, &lab.error), RB_OK);
	assert_true(rb_engine_locates(world->located));
	world->located->arc[1].position.x = 0.9; /* the frame would show an overlap */
	world->located->generation[1]++;
	assert_int_equal(rb_world_step_frame(world, &lab.error), RB_OK);
	assert_int_equal(world->frame_counts.rollbacks, 1);
	assert_true(world->dense_left > 0);
	/* steps do not carry the memory of the clusters that there were */
	assert_int_equal(world->located->cluster_count, 2);
	for (int k = 0; k < 2; k++)
		assert_null(world->located->cluster[k].member);
	assert_null(world->located->warm_start);
	world->dense_left = 0;
	assert_int_equal(rb_world_step_frame(world, &lab.error), RB_OK);
	lab_close(&lab);
}

/* ---- what rests ---- */

/* Two boxes at rest; then one is lifted and put down into the other. */
static void what_has_rested_is_looked_at_again_once_it_moves(void **state)
{
	struct lab lab;
	int a, b;

	(void)state;
	lab_open_located(&lab, 2, frame_rate);
	lab.scene.world.gravity = (rb_vec3){0, 0, -earth};
	lab_surface(&lab, 0.5, 0);
	lab_plane(&lab, none, (rb_vec3){0, 0, 1});
	lab_box(&lab, (rb_vec3){1, 1, 1}, 1, (rb_vec3){0, 0, 0.5}, rb_quat_identity);
	lab_box(&lab, (rb_vec3){1, 1, 1}, 1, (rb_vec3){3, 0, 0.5}, rb_quat_identity);
	lab_seal(&lab, 1);
	struct rb_located *const l = lab.world->located;
	for (int k = 0; k < 3; k++)
		assert_int_equal(rb_world_step_frame(lab.world, &lab.error), RB_OK);
	const double t = lab.world->state.time_s;
	assert_true(rb_inspect_overlap(l, t, &a, &b) <= DBL_EPSILON);
	assert_true(l->inspected[0].rests && l->inspected[1].rests);
	l->arc[1].position.x = 0.9;
	l->generation[1]++;
	assert_true(fabs(rb_inspect_overlap(l, t, &a, &b) - 0.1) < 1e-9);
	assert_int_equal(a + b, 1);
	lab_close(&lab);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_same_point_has_the_same_name_in_both_methods),
		cmocka_unit_test(the_force_of_every_point_is_continuous_over_a_change_of_method),
		cmocka_unit_test(a_rim_that_steps_count_from_elsewhere_starts_from_its_mean),
		cmocka_unit_test(what_is_known_makes_the_first_step_cheaper),
		cmocka_unit_test(
			located_bodies_are_evaluated_once_where_nobody_asks_between_frames),
		cmocka_unit_test(an_attempt_that_fails_at_once_leaves_no_trace),
		cmocka_unit_test(an_attempt_that_fails_at_once_leaves_out_no_step),
		cmocka_unit_test(no_attempt_is_made_that_forces_alone_make_too_dear),
		cmocka_unit_test(speed_allows_no_more_than_steps_have_cost),
		cmocka_unit_test(a_chain_that_flies_allows_as_much_as_one_that_falls),
		cmocka_unit_test(what_stands_allows_as_little_as_its_steps_cost),
		cmocka_unit_test(steps_count_the_solutions_of_what_moves),
		cmocka_unit_test(what_is_located_does_not_depend_on_what_may_be_counted),
		cmocka_unit_test(locating_begins_again_after_a_frame_was_taken_back),
		cmocka_unit_test(what_has_rested_is_looked_at_again_once_it_moves),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
