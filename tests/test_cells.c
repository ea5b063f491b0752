/* SPDX-License-Identifier: MIT */
/* src/located/cells.c: nobody comes within touch without having been listed */
#include "support.h"

#include "base/memory.h"
#include "located/cells.h"
#include "located/queue.h"
#include "math/random.h"
#include "math/vec3.h"

enum { MOST = 4096, untouched = -77 };
static double radius[MOST], position[3 * MOST];
static rb_vec3 place[MOST], velocity[MOST], acceleration[MOST];
static double since[MOST];
static int wall[MOST], out[MOST + 1], zero_moves[MOST];
static bool listed[MOST], listed_before[MOST];
static uint64_t draws;

static double unit(void)
{
	return rb_random_unit(7, 0, draws++);
}

static rb_vec3 in_box(double size)
{
	const double x = unit(), y = unit(), z = unit();

	return rb_vec3_of(size * (x - 0.5), size * (y - 0.5), size * (z - 0.5));
}

static struct rb_cells *make(int count)
{
	struct rb_cells *cells;
	struct rb_error err;

	for (int body = 0; body < count; body++)
		rb_vec3_to(&position[3 * body], place[body]);
	assert_ok(rb_cells_create(&cells, count, radius, position, &err));
	assert_int_equal(rb_cells_max(cells), count);
	return cells;
}

/* `mark` tells who is in the list; each only once, and never the body itself. */
static void mark_list(bool *mark, int count, int body, int found)
{
	memset(mark, 0, (size_t)count * sizeof *mark);
	assert_in_range(found, 0, count - 1);
	assert_int_equal(out[count], untouched);
	for (int i = 0; i < found; i++) {
		assert_in_range(out[i], 0, count - 1);
		assert_int_not_equal(out[i], body);
		assert_false(mark[out[i]]);
		mark[out[i]] = true;
	}
}

static void mark_near(const struct rb_cells *cells, bool *mark, int body)
{
	const int count = rb_cells_max(cells);

	out[count] = untouched;
	mark_list(mark, count, body, rb_cells_near(cells, body, out));
}

/* What is near is listed for one of the two bodies. */
static void assert_pairs_once(const struct rb_cells *cells)
{
	const int count = rb_cells_max(cells);

	for (int body = 0; body < count; body++) {
		mark_near(cells, listed_before, body);
		out[count] = untouched;
		mark_list(listed, count, body, rb_cells_near_once(cells, body, out));
		for (int other = 0; other < count; other++) {
			assert_true(listed_before[other] || !listed[other]);
			if (!listed_before[other])
				continue;
			const int found = rb_cells_near_once(cells, other, out);
			int times = listed[other];

			for (int i = 0; i < found; i++)
				times += out[i] == body;
			assert_int_equal(times, 1);
		}
	}
}

static rb_vec3 at_time(int body, double now)
{
	const double dt = now - since[body];

	return rb_vec3_add(place[body],
	                   rb_vec3_add(rb_vec3_scale(dt, velocity[body]),
	                               rb_vec3_scale(dt * dt / 2, acceleration[body])));
}

static double distance(rb_vec3 a, rb_vec3 b)
{
	const rb_vec3 d = rb_vec3_sub(a, b);

	return sqrt(rb_vec3_dot(d, d));
}

/* Everybody within touch of the body at `now` is near it. Returns how many touch. */
static int assert_complete(const struct rb_cells *cells, int body, double now)
{
	const int count = rb_cells_max(cells);
	const rb_vec3 at = at_time(body, now);
	int touching = 0;

	mark_near(cells, listed, body);
	for (int other = 0; other < count; other++) {
		if (other == body ||
		    distance(at, at_time(other, now)) > radius[body] + radius[other])
			continue;
		touching++;
		if (!listed[other])
			fail_msg("%d touches %d at %.17g and is not near it", other, body, now);
	}
	return touching;
}

struct swarm {
	int count;
	double box;     /* m */
	rb_vec3 offset; /* m, of the box's middle */
	double pull;    /* m/s^2 */
	double (*size)(int body);
	int crossings;
	bool flat;    /* to begin with: the torus is then as thin as it gets */
	bool bounded; /* cells know bounds on accelerations only */
};

static double stays(const struct rb_cells *cells, int body)
{
	const rb_vec3 a = acceleration[body];

	return rb_cells_time_inside(cells, body, place[body], velocity[body],
	                            rb_vec3_of(1.5 * fabs(a.x), fabs(a.y), 2 * fabs(a.z)),
	                            &wall[body]);
}

static void schedule(const struct swarm *swarm, const struct rb_cells *cells,
                     struct rb_queue *queue, int body, double now)
{
	const double t = swarm->bounded ? stays(cells, body)
	                                : rb_cells_leaves(cells, body, place[body], velocity[body],
	                                                  acceleration[body], &wall[body]);

	assert_true(t >= 0 && (t < (double)INFINITY) == (wall[body] >= 0));
	rb_queue_set(queue, body, now + t);
}

static void advance(int body, double now)
{
	const rb_vec3 at = at_time(body, now);

	velocity[body] = rb_vec3_add(velocity[body],
	                             rb_vec3_scale(now - since[body], acceleration[body]));
	place[body] = at;
	since[body] = now;
}

/* Anywhere, or back to the box when it is outside; a fifth stands still. */
static void kick(const struct swarm *swarm, int body)
{
	const rb_vec3 from_middle = rb_vec3_sub(place[body], swarm->offset);

	velocity[body] = in_box(2 * swarm->box);
	if (unit() < 0.2)
		velocity[body] = rb_vec3_of(0, 0, 0);
	if (distance(from_middle, rb_vec3_of(0, 0, 0)) > swarm->box)
		velocity[body] = rb_vec3_scale(-1, from_middle);
	acceleration[body] = swarm->pull == 0 ? rb_vec3_of(0, 0, 0) : in_box(swarm->pull);
	if (unit() < 0.3)
		acceleration[body].x = acceleration[body].y = 0;
}

/* Bodies fly through each other; now and then one of them, at a wall or not, gets a new velocity. */
static void fly(const struct swarm *swarm)
{
	const int count = swarm->count;
	int touching = 0;

	for (int body = 0; body < count; body++) {
		radius[body] = swarm->size(body);
		place[body] = rb_vec3_add(swarm->offset, in_box(swarm->box));
		if (swarm->flat)
			place[body].y = swarm->offset.y;
		since[body] = 0;
		zero_moves[body] = 0;
		kick(swarm, body);
	}
	struct rb_cells *cells = make(count);
	struct rb_queue *queue;
	struct rb_error err;
	double now = 0;
	int looks = 0;

	assert_ok(rb_queue_create(&queue, count, &err));
	for (int body = 0; body < count; body++)
		schedule(swarm, cells, queue, body, now);
	for (int i = 0; i < swarm->crossings; i++) {
		const int body = rb_queue_first(queue, &now);

		assert_true(body >= 0);
		zero_moves[body] = now > since[body] ? 0 : zero_moves[body] + 1;
		assert_in_range(zero_moves[body], 0, 8);
		advance(body, now);
		mark_near(cells, listed_before, body);
		assert_complete(cells, body, now);
		if (swarm->bounded && !rb_cells_is_at_wall(cells, body, wall[body], place[body])) {
			schedule(swarm, cells, queue, body, now);
			looks++;
			continue;
		}
		const int found = rb_cells_cross(cells, body, wall[body], out);

		mark_list(listed, count, body, found);
		for (int other = 0; other < count; other++) {
			assert_false(listed[other] && listed_before[other]);
			listed_before[other] |= listed[other];
		}
		touching += assert_complete(cells, body, now);
		for (int other = 0; other < count; other++)
			assert_true(listed_before[other] || !listed[other]);
		if (i % 5 == 0)
			kick(swarm, body);
		schedule(swarm, cells, queue, body, now);
		/* and somebody who is not at a wall */
		const int other = (int)(unit() * count);

		touching += assert_complete(cells, other, now);
		if (i % 3 == 0) {
			advance(other, now);
			kick(swarm, other);
			schedule(swarm, cells, queue, other, now);
		}
	}
	assert_pairs_once(cells);
	/* near is mutual */
	for (int body = 0; body < count; body++) {
		mark_near(cells, listed_before, body);
		for (int other = 0; other < count; other++) {
			if (other == body)
				continue;
			mark_near(cells, listed, other);
			assert_int_equal(listed[body], listed_before[other]);
		}
	}
	/* or nothing was tested */
	assert_true(touching > swarm->crossings / 100);
	/* the distance falls by a share each time: a few looks a crossing */
	assert_true(looks < swarm->crossings * 3 / 4);
	rb_queue_destroy(queue);
	rb_cells_destroy(cells);
}

static double one_size(int body)
{
	(void)body;
	return 0.05;
}

static double within_an_octave(int body)
{
	return 0.04 * (1 + 0.99 * rb_random_unit(8, 0, (uint64_t)body));
}

static double four_decades(int body)
{
	return 0.3 * pow(10, -4 * rb_random_unit(8, 1, (uint64_t)body));
}

static double dust_and_a_rock(int body)
{
	return body == 5 ? 0.4 : 0.01;
}

static void nobody_is_missed(void **state)
{
	const rb_vec3 here = {0};
	const struct swarm swarms[] = {
		{150, 1, here, 0, one_size, 30000, false, false},
		{150, 1, here, 10, one_size, 20000, false, false},
		{150, 1, here, 10, within_an_octave, 20000, false, false},
		{150, 1, {-3, 1e4, -1e6}, 10, four_decades, 100000, false, false},
		{150, 1, here, 0, dust_and_a_rock, 20000, false, false},
		{17, 0.3, here, 10, one_size, 10000, false, false},
		{150, 1, here, 10, one_size, 10000, true, false},
		{150, 1, here, 10, one_size, 20000, false, true},
		{150, 1, here, 0, within_an_octave, 20000, false, true},
		{150, 1, here, 10, four_decades, 50000, false, true},
	};

	(void)state;
	for (size_t i = 0; i < sizeof swarms / sizeof *swarms; i++)
		fly(&swarms[i]);
}

/* Doubles are 1.2e-4 edges apart there. */
static void nobody_is_missed_at_a_million_million_cells(void **state)
{
	const rb_vec3 far = {1e11, -1e11, 0.7e11};
	const struct swarm swarms[] = {
		{100, 1, far, 0, one_size, 10000, false, false},
		{100, 1, far, 10, one_size, 10000, false, false},
	};

	(void)state;
	for (size_t i = 0; i < sizeof swarms / sizeof *swarms; i++)
		fly(&swarms[i]);
}

static rb_vec3 along(int axis, double x)
{
	double v[3] = {0, 0, 0};

	v[axis] = x;
	return rb_vec3_from(v);
}

/* A lattice with room: 5^3 bodies of one size. */
static struct rb_cells *make_lattice(int side, double step)
{
	int body = 0;

	for (int x = 0; x < side; x++) {
		for (int y = 0; y < side; y++) {
			for (int z = 0; z < side; z++, body++) {
				place[body] = rb_vec3_of(x * step, y * step, z * step);
				radius[body] = 0.5;
				since[body] = 0;
				velocity[body] = acceleration[body] = rb_vec3_of(0, 0, 0);
			}
		}
	}
	return make(body);
}

/* Distances from a body's place to its walls, measured by going straight there. */
static void find_walls(const struct rb_cells *cells, int body, double low[3], double high[3])
{
	for (int k = 0; k < 3; k++) {
		int w;

		high[k] = rb_cells_leaves(cells, body, place[body], along(k, 1), along(k, 0), &w);
		assert_int_equal(w, 2 * k + 1);
		low[k] = -rb_cells_leaves(cells, body, place[body], along(k, -1), along(k, 0), &w);
		assert_int_equal(w, 2 * k);
	}
}

/* Both the place and the walls are of size 10, rounded a few times: 1e-14. Roots: x(t) is as far from the wall as its
 * terms are rounded, some ulp of |v| t + |a| t^2 / 2. */
static void a_body_leaves_when_its_path_first_meets_a_wall(void **state)
{
	struct rb_cells *cells = make_lattice(5, 2);
	int turned = 0;

	(void)state;
	for (int i = 0; i < 20000; i++) {
		const int body = (int)(unit() * 125);
		double low[3], high[3];
		int w;

		find_walls(cells, body, low, high);
		const double slow = i % 3 ? 4 : 0.01;
		const rb_vec3 v = in_box(slow), a = i % 2 ? in_box(10) : along(2, -9.81);
		const double t = rb_cells_leaves(cells, body, place[body], v, a, &w);
		const double vs[3] = {v.x, v.y, v.z}, as[3] = {a.x, a.y, a.z};

		assert_true(t > 0 && w >= 0);
		const int k = w / 2;
		const double end = vs[k] * t + as[k] * t * t / 2;

		assert_near(end, w % 2 ? high[k] : low[k],
		            1e-14 + 1e-15 * (fabs(vs[k] * t) + fabs(as[k]) * t * t));
		turned += (vs[k] > 0) != (w % 2);
		for (int s = 1; s < 50; s++) {
			const double part = t * s / 50 * (1 - 1e-12);

			for (int j = 0; j < 3; j++) {
				const double x = vs[j] * part + as[j] * part * part / 2;

				assert_true(x > low[j] - 1e-13 && x < high[j] + 1e-13);
			}
		}
	}
	assert_true(turned > 1000);

	int w = 5;
	const rb_vec3 rest = along(0, 0);

	assert_true(rb_cells_leaves(cells, 3, place[3], rest, rest, &w) == (double)INFINITY);
	assert_int_equal(w, -1);
	rb_cells_destroy(cells);
}

/* At the wall and a little behind it, with any velocity: one step at most, and the way back is not as short. */
static void a_body_at_a_wall_goes_one_way(void **state)
{
	static const double speeds[] = {-1, -1e-17, 0, 1e-17, 1}, pulls[] = {-10, 0, 10};
	static const double behind[] = {-1e-15, 0, 1e-15, 1e-9};
	struct rb_cells *cells = make_lattice(5, 2);
	double low[3], high[3];

	(void)state;
	for (int i = 0; i < 5 * 3 * 4; i++) {
		const double v = speeds[i % 5], a = pulls[i / 5 % 3], past = behind[i / 15];
		int w, moves = 0;

		rb_cells_place(cells, 62, place[62]);
		find_walls(cells, 62, low, high);
		const rb_vec3 at = rb_vec3_add(place[62], along(0, high[0] + past));

		/* the same moment again and again, as after a time step that rounding ate */
		while (rb_cells_leaves(cells, 62, at, along(0, v), along(0, a), &w) < 1e-12) {
			assert_int_equal(w, 1);
			assert_in_range(++moves, 1, 1);
			rb_cells_cross(cells, 62, w, out);
		}
		/* behind the wall and on its way: it must have gone */
		if (past >= 0 && v >= 0 && (v > 0 || a > 0) && (v > 1e-12 || a >= 0))
			assert_int_equal(moves, past > 1e-10 || v > 1e-12 ? 1 : moves);
		if (moves == 1)
			assert_true(rb_cells_leaves(cells, 62, at, along(0, -1), along(0, 0), &w) >
			            1e-3 * (high[0] - low[0]));
	}
	rb_cells_destroy(cells);
}

/* Two that fly side by side round the torus again and again, past others that rest. */
static void companions_stay_near_however_far_they_go(void **state)
{
	struct rb_cells *cells = make_lattice(5, 2);
	const int count = rb_cells_max(cells), pair[2] = {31, 36};

	(void)state;
	for (int i = 0; i < 2; i++) {
		velocity[pair[i]] = rb_vec3_of(1, 0.7, -0.4);
		place[pair[i]] = rb_vec3_of(0, i * 0.9, 0);
		rb_cells_place(cells, pair[i], place[pair[i]]);
	}
	for (int i = 0; i < 20000; i++) {
		double next[2];

		for (int j = 0; j < 2; j++)
			next[j] = since[pair[j]] +
			          rb_cells_leaves(cells, pair[j], place[pair[j]], velocity[pair[j]],
			                          acceleration[pair[j]], &wall[pair[j]]);
		const int body = pair[next[1] < next[0]], other = pair[0] + pair[1] - body;
		const double now = fmin(next[0], next[1]);

		place[body] = at_time(body, now);
		since[body] = now;
		rb_cells_cross(cells, body, wall[body], out);
		mark_near(cells, listed, body);
		assert_true(listed[other]);
		mark_near(cells, listed, other);
		assert_true(listed[body]);
	}
	assert_true(place[pair[0]].x > 5000);
	/* the others are where they were */
	for (int body = 0; body < count; body++) {
		if (body != pair[0] && body != pair[1])
			assert_complete(cells, body, since[pair[0]]);
	}
	rb_cells_destroy(cells);
}

/* All at one place is the most that a cell can be asked to hold. */
static void bodies_can_be_placed_anywhere_even_all_together(void **state)
{
	struct rb_cells *cells;
	enum { COUNT = 300 };

	(void)state;
	for (int sizes = 0; sizes < 2; sizes++) {
		for (int body = 0; body < COUNT; body++) {
			place[body] = in_box(3);
			radius[body] = sizes ? four_decades(body) : 0.05;
			since[body] = 0;
			velocity[body] = acceleration[body] = rb_vec3_of(0, 0, 0);
		}
		cells = make(COUNT);
		assert_true((rb_cells_level_count(cells) > 8) == (sizes == 1));
		const uint64_t taken = rb_memory_counts().taken;

		for (int round = 0; round < 30; round++) {
			const double box = (double[]){3, 0, 1e5, 0.2, 1e-9}[round % 5];

			for (int i = 0; i < COUNT; i++) {
				const int body = (int)(unit() * COUNT);

				place[body] = round % 2 ? rb_vec3_of(7, -8, 9) : in_box(box);
				rb_cells_place(cells, body, place[body]);
				/* those at this place are all near */
				assert_complete(cells, body, 0);
			}
		}
		for (int body = 0; body < COUNT; body++) {
			place[body] = rb_vec3_of(1e4, 0, 0);
			rb_cells_place(cells, body, place[body]);
		}
		for (int body = 0; body < COUNT; body++)
			assert_int_equal(rb_cells_near(cells, body, out), COUNT - 1);
		assert_true(rb_memory_counts().taken == taken);
		rb_cells_destroy(cells);
	}
}

static void endless_bodies_are_near_all_and_never_leave(void **state)
{
	enum { COUNT = 125, SECOND = 77 };
	int w;

	(void)state;
	for (int body = 0; body < COUNT; body++) {
		place[body] = rb_vec3_of(body % 5, body / 5 % 5, body / 25);
		radius[body] = body == 0 || body == SECOND ? (double)INFINITY : 0.1;
	}
	struct rb_cells *cells = make(COUNT);

	assert_int_equal(rb_cells_near(cells, 0, out), COUNT - 1);
	assert_int_equal(rb_cells_wall_count(cells, 0), 0);
	assert_true(rb_cells_leaves(cells, 0, place[0], along(0, 1), along(0, 1), &w) ==
	            (double)INFINITY);
	rb_cells_place(cells, SECOND, rb_vec3_of(1e3, 0, 0));
	mark_near(cells, listed, 1);
	assert_true(listed[0] && listed[SECOND] && !listed[124]);
	assert_pairs_once(cells);
	rb_cells_destroy(cells);
}

static void few_bodies_are_always_near_and_never_leave(void **state)
{
	struct rb_cells *cells = make_lattice(2, 1e6);
	int w = 3;

	(void)state;
	assert_pairs_once(cells);
	mark_near(cells, listed, 4);
	for (int body = 0; body < 8; body++)
		assert_int_equal(listed[body], body != 4);
	assert_true(rb_cells_leaves(cells, 4, place[4], along(0, 1), along(1, 1), &w) ==
	            (double)INFINITY);
	assert_int_equal(w, -1);
	rb_cells_place(cells, 4, along(1, 1e30));
	assert_int_equal(rb_cells_near(cells, 4, out), 7);
	rb_cells_destroy(cells);

	struct rb_error err;

	assert_ok(rb_cells_create(&cells, 0, NULL, NULL, &err));
	assert_int_equal(rb_cells_max(cells), 0);
	rb_cells_destroy(cells);
	rb_cells_destroy(NULL);
}

static double mean_near(const struct rb_cells *cells)
{
	const int count = rb_cells_max(cells);
	double sum = 0;

	for (int body = 0; body < count; body++)
		sum += rb_cells_near(cells, body, out);
	return sum / count;
}

/* In a lattice of n = side^3 bodies a share of about 3 / side has fewer neighbours, at the faces: so much is lost. */
static void candidates_do_not_grow_with_the_number_of_bodies(void **state)
{
	static const double steps[] = {1.02, 1.5, 3, 1e3, 1e9};

	(void)state;
	for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
		for (int side = 8; side <= 16; side *= 2) {
			struct rb_cells *cells = make_lattice(side, steps[i]);

			assert_true(mean_near(cells) < 60);
			rb_cells_destroy(cells);
		}
	}
}

/* Clusters of unit spheres, 1e7 of their sizes apart; in a row, in a plane, in space. */
static void cells_suit_the_clusters_and_not_the_space_between_them(void **state)
{
	(void)state;
	for (int dimensions = 1; dimensions <= 3; dimensions++) {
		struct rb_cells *cells = make_lattice(16, 1.1);

		rb_cells_destroy(cells);
		for (int body = 0; body < MOST; body++) {
			const double apart = 1e7;

			place[body].x += body % 2 ? apart : 0;
			place[body].y += dimensions > 1 && body / 2 % 2 ? apart : 0;
			place[body].z += dimensions > 2 && body / 4 % 2 ? apart : 0;
		}
		cells = make(MOST);
		assert_true(mean_near(cells) < 250);
		rb_cells_destroy(cells);
	}
}

static void every_allocation_may_fail(void **state)
{
	struct rb_cells *cells;
	enum rb_status status = RB_ERR_MEMORY;
	const uint64_t bytes = rb_memory_counts().bytes_now;

	(void)state;
	rb_cells_destroy(make_lattice(5, 2));
	for (int body = 0; body < 40; body++)
		radius[body] = four_decades(body);
	for (uint64_t k = 1; status != RB_OK; k++) {
		struct rb_error err;

		rb_memory_fail_at(k);
		status = rb_cells_create(&cells, 40, radius, position, &err);
		rb_memory_fail_at(0);
		assert_true(status == RB_OK || status == RB_ERR_MEMORY);
		assert_true((cells != NULL) == (status == RB_OK));
		if (status != RB_OK)
			assert_true(rb_memory_counts().bytes_now == bytes);
	}
	rb_cells_destroy(cells);
	assert_true(rb_memory_counts().bytes_now == bytes);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(nobody_is_missed),
		cmocka_unit_test(nobody_is_missed_at_a_million_million_cells),
		cmocka_unit_test(a_body_leaves_when_its_path_first_meets_a_wall),
		cmocka_unit_test(a_body_at_a_wall_goes_one_way),
		cmocka_unit_test(companions_stay_near_however_far_they_go),
		cmocka_unit_test(bodies_can_be_placed_anywhere_even_all_together),
		cmocka_unit_test(endless_bodies_are_near_all_and_never_leave),
		cmocka_unit_test(few_bodies_are_always_near_and_never_leave),
		cmocka_unit_test(candidates_do_not_grow_with_the_number_of_bodies),
		cmocka_unit_test(cells_suit_the_clusters_and_not_the_space_between_them),
		cmocka_unit_test(every_allocation_may_fail),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
