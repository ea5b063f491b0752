/* SPDX-License-Identifier: MIT */
/* src/event: what must not change a bit: threads, rollback, what is kept, order of bodies, mirrors; callbacks. */
#include "worlds.h"

static const rb_vec3 up = {0, 0, 1};
static const rb_vec3 origin = {0, 0, 0};
static const rb_vec3 earth = {0, 0, -9.81};

static rb_vec3 at(double x, double y, double z)
{
	return (rb_vec3){x, y, z};
}

/* ---- scenes that are run in variations ---- */

enum { BODIES_MOST = 64, ROW = 9 };

/* A body before it is declared. */
struct ball {
	double radius, mass;
	rb_vec3 position, velocity, spin;
};

struct recipe {
	struct ball ball[BODIES_MOST];
	int count;
	double box; /* half edge of a box of planes; 0: none */
	bool floor; /* a plane at z = 0 */
	rb_vec3 gravity;
	double friction, restitution, duration;
};

struct variation {
	int order[BODIES_MOST]; /* which ball is declared k-th */
	bool planes_first;
	int mirror; /* axis, -1: none */
	int threads;
	double frame_rate;
	enum rb_rollback_kind rollback;
	enum rb_method_kind method;
	bool keep, hooked;
};

static struct variation plain(void)
{
	struct variation v = {
		.mirror = -1, .threads = 1, .frame_rate = 10, .method = RB_METHOD_LOCATED};

	for (int k = 0; k < BODIES_MOST; k++)
		v.order[k] = k;
	return v;
}

/* A fixed number in [0, 1) for each k: golden ratio. */
static double share(int k)
{
	return fmod(0.5 + 0.6180339887498949 * k, 1);
}

static void add_planes(struct lab *lab, const struct recipe *recipe, int mirror)
{
	if (recipe->floor)
		lab_plane(lab, origin, mirrored(up, mirror));
	for (int k = 0; k < 6 && recipe->box > 0; k++) {
		const double sign = k % 2 ? 1 : -1;
		const rb_vec3 n = {k / 2 == 0 ? sign : 0, k / 2 == 1 ? sign : 0,
		                   k / 2 == 2 ? sign : 0};

		lab_plane(lab, mirrored(rb_vec3_scale(-recipe->box, n), mirror),
		          mirrored(n, mirror));
	}
}

static enum rb_status look(void *user, struct rb_world *world, double t, double dt,
                           struct rb_error *err)
{
	(void)t, (void)dt, (void)err;
	*(double *)user += rb_world_position(world, 0).x;
	return RB_OK;
}

/* Runs it; rows of the balls in the recipe's order, mirrored back. Returns the number of impacts. */
static uint64_t cook(const struct recipe *recipe, const struct variation *v,
                     double rows[BODIES_MOST][ROW])
{
	double sum = 0;
	const struct rb_world_hooks hooks = {.user = &sum, .step = look};
	const struct rb_world_options options = {
		.threads = v->threads, .keep_events = v->keep, .keep_contacts = v->keep};
	int id[BODIES_MOST];
	struct lab lab;

	lab_open(&lab, recipe->duration, v->frame_rate);
	lab.scene.world.method = v->method;
	lab.scene.world.rollback = v->rollback;
	lab.scene.world.gravity = mirrored(recipe->gravity, v->mirror);
	lab_surface(&lab, recipe->friction, recipe->restitution);
	if (v->planes_first)
		add_planes(&lab, recipe, v->mirror);
	for (int k = 0; k < recipe->count; k++) {
		const struct ball *ball = &recipe->ball[v->order[k]];
		struct rb_body_def def = lab_sphere_def(ball->radius, ball->mass,
		                                        mirrored(ball->position, v->mirror),
		                                        mirrored(ball->velocity, v->mirror));

		def.angular_velocity = mirrored_spin(ball->spin, v->mirror);
		id[v->order[k]] = lab_add(&lab, &def);
	}
	if (!v->planes_first)
		add_planes(&lab, recipe, v->mirror);
	lab_seal_with(&lab, &options, v->hooked ? &hooks : NULL);
	lab_run(&lab);
	for (int k = 0; k < recipe->count; k++) {
		rb_vec3_to(rows[k], mirrored(rb_world_position(lab.world, id[k]), v->mirror));
		rb_vec3_to(rows[k] + 3, mirrored(rb_world_velocity(lab.world, id[k]), v->mirror));
		rb_vec3_to(rows[k] + 6,
		           mirrored_spin(rb_world_angular_velocity(lab.world, id[k]), v->mirror));
	}
	const uint64_t count = rb_world_totals(lab.world).collisions;
	lab_close(&lab);
	return count;
}

static void assert_same_rows(const struct recipe *recipe, double found[BODIES_MOST][ROW],
                             double wanted[BODIES_MOST][ROW], const char *what)
{
	int bodies = 0, first = -1, column = 0;
	double most = 0;

	for (int k = 0; k < recipe->count; k++) {
		bool same = true;

		for (int c = 0; c < ROW; c++) {
			if (found[k][c] == wanted[k][c])
				continue;
			most = fmax(most, fabs(found[k][c] - wanted[k][c]));
			if (first < 0)
				column = c;
			first = first < 0 ? k : first;
			same = false;
		}
		bodies += !same;
	}
	if (bodies > 0)
		fail_msg("%s: %d of %d bodies differ, by up to %.3g; first ball %d, column %d: "
		         "%.17g, not %.17g",
		         what, bodies, recipe->count, most, first, column, found[first][column],
		         wanted[first][column]);
}

/* ---- the recipes ---- */

static void add_ball(struct recipe *recipe, struct ball ball)
{
	recipe->ball[recipe->count++] = ball;
}

/* 60 of two sizes in a box, on a grid that is shaken. */
static struct recipe gas(double friction, double restitution)
{
	struct recipe r = {
		.box = 0.61, .friction = friction, .restitution = restitution, .duration = 2};

	for (int k = 0; k < 60; k++) {
		const rb_vec3 cell = {-0.45 + 0.3 * (k % 4) + 0.02 * share(k),
		                      -0.45 + 0.3 * (k / 4 % 4) + 0.02 * share(3 * k + 1),
		                      -0.45 + 0.3 * (k / 16) + 0.02 * share(5 * k + 2)};
		const rb_vec3 v = {share(7 * k) - 0.5, share(11 * k + 1) - 0.5,
		                   share(13 * k + 2) - 0.5};

		add_ball(&r, (struct ball){.radius = k % 3 ? 0.08 : 0.1,
		                           .mass = k % 3 ? 1 : 2.5,
		                           .position = cell,
		                           .velocity = rb_vec3_scale(2, v),
		                           .spin = friction > 0 ? rb_vec3_scale(5, v) : origin});
	}
	return r;
}

/* Four that touch fall into the corner of a box. */
static struct recipe corner(double friction, double restitution)
{
	struct recipe r = {.box = 1,
	                   .gravity = {-3, -4, -9.81},
	                   .friction = friction,
	                   .restitution = restitution,
	                   .duration = friction > 0 ? 0.8 : 1};

	for (int k = 0; k < 4; k++)
		add_ball(&r, (struct ball){.radius = 0.125,
		                           .mass = 1 + 0.5 * k,
		                           .position = {-0.5 + (k % 2 ? 0.25 : 0),
		                                        -0.5 + (k / 2 ? 0.25 : 0), -0.25},
		                           .velocity = {0.5, 0.25, -0.125}});
	return r;
}

/* A cue into two that touch. */
static struct recipe three(double friction, double restitution)
{
	struct recipe r = {.friction = friction, .restitution = restitution, .duration = 2};

	add_ball(&r, (struct ball){.radius = 0.5,
	                           .mass = 1,
	                           .position = {-2, 0, 0},
	                           .velocity = {2, 0, 0.25},
	                           .spin = {0, 0, friction > 0 ? 3 : 0}});
	add_ball(&r, (struct ball){.radius = 0.5, .mass = 2, .position = {0.75, 0.5, 0}});
	add_ball(&r, (struct ball){.radius = 0.5, .mass = 1, .position = {0.75, -0.5, 0}});
	return r;
}

/* Four that fall on a floor side by side, one on another, and roll apart. */
static struct recipe heap(double friction, double restitution)
{
	struct recipe r = {.floor = true,
	                   .gravity = earth,
	                   .friction = friction,
	                   .restitution = restitution,
	                   .duration = 1.5};

	for (int k = 0; k < 4; k++)
		add_ball(&r, (struct ball){.radius = 0.1,
		                           .mass = 1,
		                           .position = {0.02 * share(k), 0.02 * share(k + 7),
		                                        0.15 + 0.25 * k},
		                           .velocity = {0.1 * share(k + 3), 0, 0}});
	return r;
}

static const struct {
	const char *name;
	struct recipe (*make)(double friction, double restitution);
	double friction, restitution;
} recipes[] = {
	{"a gas", gas, 0, 1},         {"a rough gas", gas, 0.4, 0.9},
	{"a corner", corner, 0, 0.5}, {"a rough corner", corner, 0.3, 0},
	{"three", three, 0, 1},       {"three, rough", three, 0.3, 0.7},
	{"a heap", heap, 0.4, 0.5},   {"a smooth heap", heap, 0, 0},
};
enum { RECIPES = sizeof recipes / sizeof recipes[0] };

static struct recipe recipe_of(int k)
{
	return recipes[k].make(recipes[k].friction, recipes[k].restitution);
}

/* ---- what must not matter ---- */

static void run_variations(int from, int to)
{
	static double wanted[BODIES_MOST][ROW], found[BODIES_MOST][ROW];

	for (int k = 0; k < RECIPES; k++) {
		const struct recipe r = recipe_of(k);
		struct variation v = plain();
		char what[80];

		const uint64_t count = cook(&r, &v, wanted);
		for (int n = from; n <= to; n++) {
			v = plain();
			if (n < 2)
				v.threads = n + 2;
			v.rollback = n == 2 ? RB_ROLLBACK_GLOBAL : RB_ROLLBACK_SELECTIVE;
			v.keep = n == 3;
			v.frame_rate = n == 4 ? 70 : 10;
			v.hooked = n == 5;
			snprintf(what, sizeof what, "%s, variation %d", recipes[k].name, n);
			assert_int_equal(cook(&r, &v, found), count);
			assert_same_rows(&r, found, wanted, what);
		}
	}
}

static void threads_rollback_frames_and_what_is_kept_do_not_matter(void **slot)
{
	(void)slot;
	run_variations(0, 4);
}

static void a_step_hook_that_only_looks_does_not_matter(void **slot)
{
	(void)slot;
	lab_open_promise("frictionless impacts turn spheres by rounding once there is rotation");
	run_variations(5, 5);
}

/* Heap's algorithm: the next order of the first `count`; false after the last. */
static bool next_order(int *order, int *state, int count)
{
	for (int i = 1; i < count; i++) {
		if (state[i] >= i) {
			state[i] = 0;
			continue;
		}
		const int other = i % 2 ? state[i] : 0, kept = order[i];

		order[i] = order[other];
		order[other] = kept;
		state[i]++;
		return true;
	}
	return false;
}

static void run_orders(int recipe)
{
	static double wanted[BODIES_MOST][ROW], found[BODIES_MOST][ROW];
	const struct recipe r = recipe_of(recipe);
	struct variation v = plain();
	int state[4] = {0};

	cook(&r, &v, wanted);
	do {
		for (int first = 0; first < 2; first++) {
			v.planes_first = first;
			cook(&r, &v, found);
			assert_same_rows(&r, found, wanted, recipes[recipe].name);
		}
	} while (next_order(v.order, state, r.count));
}

static void the_order_of_a_break_does_not_matter(void **slot)
{
	(void)slot;
	run_orders(4);
	run_orders(5);
}

static void the_order_of_a_heap_does_not_matter(void **slot)
{
	(void)slot;
	lab_open_promise("lasting contacts differ by rounding between orders of bodies");
	run_orders(2);
	run_orders(3);
	run_orders(6);
	run_orders(7);
}

static void the_order_of_a_gas_does_not_matter(void **slot)
{
	static double wanted[BODIES_MOST][ROW], found[BODIES_MOST][ROW];

	(void)slot;
	for (int k = 0; k < 2; k++) {
		const struct recipe r = recipe_of(k);
		struct variation v = plain();

		cook(&r, &v, wanted);
		for (int n = 0; n < 3; n++) {
			for (int m = 0; m < r.count; m++) /* 17 and 60 have no common factor */
				v.order[m] = n == 0 ? r.count - 1 - m : (17 * m + 7 * n) % r.count;
			v.planes_first = n == 2;
			cook(&r, &v, found);
			assert_same_rows(&r, found, wanted, recipes[k].name);
		}
	}
}

static void mirror_images_are_the_same_to_the_bit(void **slot)
{
	static double wanted[BODIES_MOST][ROW], found[BODIES_MOST][ROW];

	(void)slot;
	for (int k = 0; k < RECIPES; k++) {
		const struct recipe r = recipe_of(k);
		struct variation v = plain();

		cook(&r, &v, wanted);
		for (v.mirror = 0; v.mirror < 3; v.mirror++) {
			char what[80];

			snprintf(what, sizeof what, "%s, mirrored in %c", recipes[k].name,
			         "xyz"[v.mirror]);
			cook(&r, &v, found);
			assert_same_rows(&r, found, wanted, what);
		}
	}
}

/* ---- callbacks ---- */

static void events_come_in_the_order_of_time_and_pair(void **slot)
{
	const struct rb_world_options options = {.threads = 2, .keep_events = true};
	struct lab lab;
	struct lab_log log;
	const struct rb_world_hooks hooks = lab_log_open(&log);
	int at_once = 0;

	(void)slot;
	lab_open_located(&lab, 3, 30);
	lab.scene.world.gravity = earth;
	lab_surface(&lab, 0.3, 0.6);
	/* pairs of pairs: two that come down at the same moment, far from each other, and others in between */
	for (int k = 0; k < 8; k++)
		lab_sphere(&lab, 0.1, 1, at(7 - k, 0, k % 2 ? 0.6 : 0.35), at(0, 0.1 * k, 0));
	lab_plane(&lab, origin, up);
	lab_seal_with(&lab, &options, &hooks);
	struct rb_event kept[256];
	struct rb_frame frame = {.events = kept, .event_capacity = 256};
	int seen = 0;
	while (rb_world_frame(lab.world) + 1 < rb_world_frame_count(lab.world)) {
		lab_step(&lab);
		assert_int_equal(rb_world_fill_frame(lab.world, &frame, &lab.error), RB_OK);
		/* the frame holds what the hooks have been called with */
		for (int k = 0; k < frame.event_count; k++) {
			assert_true(frame.events[k].time_s == log.row[seen + k].time_s);
			assert_int_equal(frame.events[k].a, log.row[seen + k].a);
			assert_int_equal(frame.events[k].kind, log.row[seen + k].kind);
		}
		seen += frame.event_count;
		assert_int_equal(seen, log.count);
		assert_true(seen == 0 || log.row[seen - 1].time_s <= rb_world_time(lab.world));
	}
	for (int k = 1; k < log.count; k++) {
		const struct rb_event *a = &log.row[k - 1], *b = &log.row[k];

		assert_true(a->a < a->b);
		assert_true(a->time_s <= b->time_s);
		if (a->time_s != b->time_s)
			continue;
		at_once++;
		assert_true(a->a < b->a || (a->a == b->a && a->b <= b->b));
	}
	assert_true(at_once > 8);
	lab_log_close(&log);
	lab_close(&lab);
}

/* What callbacks do, and what they saw. */
struct meddler {
	enum act { SET_VELOCITY, IMPULSE, FORCE, MOVE, SPIN } act;
	double when;
	int calls;
	double seen_z, seen_time;
};

static enum rb_status meddle_step(void *user, struct rb_world *world, double t, double dt,
                                  struct rb_error *err)
{
	struct meddler *m = user;

	(void)err;
	m->calls++;
	if (m->act == FORCE) /* 3 N along x from `when` for one second */
		if (t >= m->when - 0.5 * dt && t < m->when + 1 - 0.5 * dt)
			rb_world_apply_force(world, 0, at(3, 0, 0),
			                     rb_world_center_of_mass(world, 0));
	if (fabs(t - m->when) > 0.25 * dt)
		return RB_OK;
	m->seen_z = rb_world_position(world, 0).z;
	m->seen_time = t;
	if (m->act == SET_VELOCITY)
		rb_world_set_velocity(world, 0, at(1, 2, 3));
	if (m->act == IMPULSE)
		rb_world_apply_impulse(
			world, 0, at(2, 0, 0),
			rb_vec3_add(rb_world_center_of_mass(world, 0), at(0, 0.05, 0)));
	if (m->act == MOVE)
		rb_world_set_position(world, 0, at(5, 5, 5));
	if (m->act == SPIN)
		rb_world_set_angular_velocity(world, 0, at(0, 0, 9));
	return RB_OK;
}

/* A ball of 2 kg thrown up; at 0.5 s on_step does something, and it goes on in closed form. */
static void what_on_step_does_takes_effect_at_once(void **slot)
{
	const rb_vec3 v0 = {0.5, 0, 8};

	(void)slot;
	for (int act = SET_VELOCITY; act <= SPIN; act++) {
		struct meddler m = {.act = (enum act)act, .when = 0.5};
		const struct rb_world_hooks hooks = {.user = &m, .step = meddle_step};
		const struct rb_world_options options = {.threads = 1};
		struct lab lab;

		lab_open_located(&lab, 2, 10);
		lab.scene.world.gravity = earth;
		lab.scene.world.time_step_s = 0.025;
		const int ball = lab_sphere(&lab, 0.1, 2, origin, v0);
		lab_plane(&lab, at(0, 0, -50), up);
		lab_seal_with(&lab, &options, &hooks);
		lab_run(&lab);
		assert_int_equal(m.calls, 80);
		assert_near(m.seen_z, 4 - 0.5 * 9.81 * 0.25, 1e-14);
		rb_vec3 x = {0.25, 0, 4 - 0.5 * 9.81 * 0.25}, v = {0.5, 0, 8 - 9.81 * 0.5},
			w = origin;
		double moved = 0, faster = 0;
		if (act == SET_VELOCITY)
			v = at(1, 2, 3);
		if (act == IMPULSE) {
			v.x += 1;
			w.z = -0.05 * 2 / (0.4 * 2 * 0.01);
		}
		if (act == MOVE)
			x = at(5, 5, 5);
		if (act == SPIN)
			w.z = 9;
		if (act == FORCE) {
			moved = 1.5 * (0.5 + 0.5);
			faster = 1.5;
		}
		const double s = 1.5;
		assert_vector(rb_world_position(lab.world, ball),
		              at(x.x + v.x * s + moved, x.y + v.y * s,
		                 x.z + v.z * s - 0.5 * 9.81 * s * s),
		              2e-14);
		assert_vector(rb_world_velocity(lab.world, ball),
		              at(v.x + faster, v.y, v.z - 9.81 * s), 2e-14);
		assert_vector(rb_world_angular_velocity(lab.world, ball), w, 1e-13);
		lab_close(&lab);
	}
}

static enum rb_status kick_up(void *user, struct rb_world *world, const struct rb_event *event,
                              struct rb_error *err)
{
	struct meddler *m = user;

	(void)err;
	m->calls++;
	m->seen_time = event->time_s;
	m->seen_z = rb_world_position(world, event->a).z;
	if (m->act == SET_VELOCITY) /* thrown back as fast as it came, though e = 0.5 */
		rb_world_set_velocity(world, event->a, at(0, 0, event->approach_speed));
	if (m->act == IMPULSE)
		rb_world_apply_impulse(world, event->a, at(0, 0, 0.5 * event->approach_speed),
		                       rb_world_center_of_mass(world, event->a));
	return RB_OK;
}

/* on_collision sees the ball on the floor at the moment of the impact, and may change what it does to it. */
static void what_on_collision_does_takes_effect_at_once(void **slot)
{
	const double g = 9.81, half = sqrt(2 / g);

	(void)slot;
	for (int act = SET_VELOCITY; act <= IMPULSE; act++) {
		struct meddler m = {.act = (enum act)act};
		const struct rb_world_hooks hooks = {.user = &m, .collision = kick_up};
		const struct rb_world_options options = {.threads = 1};
		struct lab lab;

		lab_open_located(&lab, 20.5 * half, 1);
		lab.scene.world.gravity = earth;
		lab_surface(&lab, 0, 0.5);
		const int ball = lab_sphere(&lab, 0.1, 1, at(0, 0, 1.1), origin);
		lab_plane(&lab, origin, up);
		lab_seal_with(&lab, &options, &hooks);
		lab_run(&lab);
		assert_int_equal(m.calls, 10);
		assert_near(m.seen_time, 19 * half, 1e-12);
		assert_near(m.seen_z, 0.1, 1e-13);
		const double s = 0.5 * half;
		assert_near(rb_world_position(lab.world, ball).z, 0.1 + 1 - 0.5 * g * s * s, 1e-12);
		lab_close(&lab);
	}
}

/* As on_frame does: between two frames the state is changed from outside. */
static void what_is_changed_at_a_frame_takes_effect(void **slot)
{
	struct lab lab;

	(void)slot;
	lab_open_located(&lab, 2, 10);
	lab.scene.hooks |= RB_HOOK_FRAME;
	lab.scene.world.gravity = earth;
	lab_surface(&lab, 0.5, 0);
	const int rests = lab_sphere(&lab, 0.1, 1, at(0, 0, 0.1), origin);
	const int below = lab_sphere(&lab, 0.1, 1, at(5, 0, 0.1), origin);
	const int above = lab_sphere(&lab, 0.1, 1, at(5, 0, 0.3), origin);
	lab_plane(&lab, origin, up);
	lab_seal(&lab, 1);
	while (rb_world_time(lab.world) < 0.95)
		lab_step(&lab);
	rb_world_set_velocity(lab.world, rests, at(0, 0, 3));
	rb_world_set_position(lab.world, below, at(8, 0, 0.1));
	while (rb_world_time(lab.world) < 1.15)
		lab_step(&lab);
	const double s = rb_world_time(lab.world) - 1;
	assert_near(rb_world_position(lab.world, rests).z, 0.1 + 3 * s - 0.5 * 9.81 * s * s, 1e-13);
	/* what it carried falls */
	assert_near(rb_world_position(lab.world, above).z, 0.3 - 0.5 * 9.81 * s * s, 1e-13);
	assert_vector(rb_world_position(lab.world, below), at(8, 0, 0.1), 1e-15);
	lab_run(&lab);
	assert_near(rb_world_position(lab.world, rests).z, 0.1, 1e-14);
	assert_near(rb_world_position(lab.world, above).z, 0.1, 1e-14);
	assert_true(rb_world_totals(lab.world).kinetic_energy == 0);
	lab_close(&lab);
}

static enum rb_status refuse(void *user, struct rb_world *world, const struct rb_event *event,
                             struct rb_error *err)
{
	(void)user, (void)world;
	return RB_FAIL(err, RB_ERR_SCENE, "enough at %g", event->time_s);
}

static void a_callback_that_fails_ends_the_run(void **slot)
{
	const struct rb_world_hooks hooks = {.collision = refuse};
	const struct rb_world_options options = {.threads = 1};
	struct lab lab;
	enum rb_status status = RB_OK;

	(void)slot;
	lab_open_located(&lab, 2, 10);
	lab.scene.world.gravity = earth;
	lab_surface(&lab, 0, 0.5);
	lab_sphere(&lab, 0.1, 1, at(0, 0, 1.1), origin);
	lab_plane(&lab, origin, up);
	lab_seal_with(&lab, &options, &hooks);
	while (status == RB_OK && rb_world_frame(lab.world) + 1 < rb_world_frame_count(lab.world))
		status = rb_world_step_frame(lab.world, &lab.error);
	assert_int_equal(status, RB_ERR_SCENE);
	assert_non_null(strstr(lab.error.text, "enough at 0.45"));
	assert_int_equal(rb_world_frame(lab.world), 4);
	lab_close(&lab);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(threads_rollback_frames_and_what_is_kept_do_not_matter),
		cmocka_unit_test(a_step_hook_that_only_looks_does_not_matter),
		cmocka_unit_test(the_order_of_a_break_does_not_matter),
		cmocka_unit_test(the_order_of_a_heap_does_not_matter),
		cmocka_unit_test(the_order_of_a_gas_does_not_matter),
		cmocka_unit_test(mirror_images_are_the_same_to_the_bit),
		cmocka_unit_test(events_come_in_the_order_of_time_and_pair),
		cmocka_unit_test(what_on_step_does_takes_effect_at_once),
		cmocka_unit_test(what_on_collision_does_takes_effect_at_once),
		cmocka_unit_test(what_is_changed_at_a_frame_takes_effect),
		cmocka_unit_test(a_callback_that_fails_ends_the_run),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
