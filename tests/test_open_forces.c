/* SPDX-License-Identifier: MIT */
/* src/located/open_forces.c: a table on four legs, of mass and inertia 1. */
#include "located/open_forces.h"

#include "base/arena.h"
#include "support.h"

enum { LEGS = 4, MOST = 3 * LEGS };

static const rb_vec3 leg[LEGS] = {
	{0.3, 0.2, -0.1}, {-0.3, 0.2, -0.1}, {-0.3, -0.2, -0.1}, {0.3, -0.2, -0.1}};
static const rb_vec3 up = {0, 0, 1};

struct table {
	struct rb_open_forces open;
	struct rb_open_contact contact[LEGS];
	struct rb_dense dense;
	double number[MOST * MOST + 4 * MOST];
	int place[5 * MOST];
};

/* Force per unit of the k-th unknown of a leg. */
static rb_vec3 unit(const struct rb_open_contact *c, int k)
{
	return c->slips ? c->unit : (rb_vec3){k == 0, k == 1, k == 2};
}

/* A table whose legs stick, or slip along x; without a force yet. */
static void set_up(struct table *t, struct rb_arena *arena, bool slips, double friction)
{
	const int rows = slips ? 1 : 3;
	struct rb_dense *const d = &t->dense;

	*d = (struct rb_dense){.matrix = t->number,
	                       .right = t->number + MOST * MOST,
	                       .size = t->number + MOST * MOST + MOST,
	                       .noise = t->number + MOST * MOST + 2 * MOST,
	                       .found = t->number + MOST * MOST + 3 * MOST,
	                       .last = t->place,
	                       .down = t->place + MOST,
	                       .pivot = t->place + 2 * MOST,
	                       .from = t->place + 3 * MOST,
	                       .order = t->place + 4 * MOST,
	                       .n = rows * LEGS};
	for (int k = 0; k < LEGS; k++)
		t->contact[k] = (struct rb_open_contact){.row = rows * k,
		                                         .slips = slips,
		                                         .friction = friction,
		                                         .normal = up,
		                                         .unit = {-friction, 0, 1},
		                                         .a = -1,
		                                         .b = 0,
		                                         .arm_b = leg[k]};
	for (int j = 0; j < d->n; j++)
		for (int i = 0; i < d->n; i++) {
			const rb_vec3 f = unit(&t->contact[j / rows], j % rows);
			const rb_vec3 turn = rb_vec3_cross(leg[j / rows], f);
			const rb_vec3 a = rb_vec3_add(f, rb_vec3_cross(turn, leg[i / rows]));
			const rb_vec3 asked = slips ? up : unit(&t->contact[0], i % rows);

			d->matrix[i * d->n + j] = rb_vec3_dot(a, asked);
		}
	for (int i = 0; i < d->n; i++)
		d->right[i] = 0;
	rb_dense_solve(d);
	assert_true(d->open);
	t->open = (struct rb_open_forces){
		.arena = arena, .dense = d, .contact = t->contact, .contacts = LEGS, .bodies = 1};
}

/* What the unknowns do to the table: force and torque. */
static void sum_up(const struct table *t, const double *unknown, rb_vec3 sum[2])
{
	const int rows = t->contact[0].slips ? 1 : 3;

	sum[0] = sum[1] = (rb_vec3){0, 0, 0};
	for (int i = 0; i < t->dense.n; i++) {
		const rb_vec3 f = rb_vec3_scale(unknown[i], unit(&t->contact[i / rows], i % rows));

		sum[0] = rb_vec3_add(sum[0], f);
		sum[1] = rb_vec3_add(sum[1], rb_vec3_cross(leg[i / rows], f));
	}
}

static bool is_lawful(const struct table *t, const double *unknown)
{
	for (int k = 0; k < LEGS; k++) {
		const struct rb_open_contact *c = &t->contact[k];
		const double *const f = unknown + c->row;

		if (c->slips ? f[0] < 0 : hypot(f[0], f[1]) > c->friction * f[2])
			return false;
	}
	return true;
}

/* Adds what does nothing, so that some leg is outside its cone. */
static void spoil(struct table *t, double *unknown, int m)
{
	for (int k = 0, way = 0; k < t->dense.n; k++) {
		if (!rb_dense_is_open(&t->dense, k))
			continue;
		rb_dense_opened(&t->dense, k);
		for (int i = 0; i < t->dense.n; i++)
			unknown[i] += 4 * sin(1 + m + 5 * way) * t->dense.right[i];
		way++;
	}
}

static void open_forces_are_brought_into_all_cones(void **slot)
{
	struct rb_arena arena = {0};
	int spoilt = 0;

	(void)slot;
	for (int m = 0; m < 64; m++) {
		struct table t;
		double unknown[MOST];
		rb_vec3 before[2], after[2];

		set_up(&t, &arena, m % 2, 0.5);
		for (int i = 0; i < t.dense.n; i++) /* near the cone of some, below in sum */
			unknown[i] = m % 2 ? 2 + sin(i + m) : (i % 3 == 2 ? 3 : 0.9 * cos(m));
		spoil(&t, unknown, m);
		spoilt += !is_lawful(&t, unknown);
		sum_up(&t, unknown, before);
		assert_true(rb_open_forces_keep_law(&t.open, false, unknown));
		sum_up(&t, unknown, after);
		assert_true(is_lawful(&t, unknown));
		for (int k = 0; k < 2; k++)
			assert_true(rb_vec3_length(rb_vec3_sub(after[k], before[k])) < 1e-12);
	}
	assert_true(spoilt > 32);
	rb_arena_release(&arena);
}

static void what_no_open_forces_can_do_is_left_alone(void **slot)
{
	struct rb_arena arena = {0};
	struct table t;
	double unknown[MOST], kept[MOST];

	(void)slot;
	set_up(&t, &arena, false, 0.5);
	for (int i = 0; i < MOST; i++) /* more friction than all of them together have */
		kept[i] = unknown[i] = i % 3 == 2 ? 1 + i : i % 3 == 0 ? 5 : 0;
	assert_true(rb_open_forces_keep_law(&t.open, false, unknown));
	assert_memory_equal(unknown, kept, sizeof kept);
	rb_arena_release(&arena);
}

/* Legs that slide with friction along different ways: other loads would move the table otherwise. */
static void loads_that_move_the_body_are_not_exchanged(void **slot)
{
	struct rb_arena arena = {0};
	struct table t;
	double unknown[MOST] = {2, 2, 2, 2}, kept[MOST];

	(void)slot;
	set_up(&t, &arena, true, 0.5);
	spoil(&t, unknown, 0);
	assert_false(is_lawful(&t, unknown));
	memcpy(kept, unknown, sizeof kept);
	for (int k = 0; k < LEGS; k++)
		t.contact[k].unit = (rb_vec3){0.5 * cos(k), 0.5 * sin(k), 1};
	assert_true(rb_open_forces_keep_law(&t.open, false, unknown));
	assert_memory_equal(unknown, kept, sizeof kept);
	/* but where there is no other way */
	assert_true(rb_open_forces_keep_law(&t.open, true, unknown));
	assert_true(is_lawful(&t, unknown));
	rb_arena_release(&arena);
}

/*
 * Two rows of the four as those of joints: the nearest to what the others are is that itself, once
 * and again, however large the first two are. All four: the least has none of what does nothing.
 */
static void the_nearest_forces_are_nearest_by_contacts(void **slot)
{
	struct rb_arena arena = {0};
	struct table t;
	double unknown[LEGS] = {50, -30, 0, 0};
	double along = 0;

	(void)slot;
	set_up(&t, &arena, true, 0.5);
	for (int round = 0; round < 2; round++) {
		assert_true(rb_open_forces_close(&t.open, 2, unknown));
		assert_near(unknown[0], 50, 1e-13);
		assert_near(unknown[1], -30, 1e-13);
		assert_near(unknown[2], 0, 1e-15);
		assert_near(unknown[3], 0, 1e-15);
	}
	assert_true(rb_open_forces_close(&t.open, 0, unknown));
	assert_true(fabs(unknown[2]) > 1);
	for (int k = 0; k < LEGS; k++)
		if (rb_dense_is_open(&t.dense, k)) {
			rb_dense_opened(&t.dense, k);
			for (int i = 0; i < LEGS; i++)
				along += unknown[i] * t.dense.right[i];
		}
	assert_near(along, 0, 1e-13);
	rb_arena_release(&arena);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(open_forces_are_brought_into_all_cones),
		cmocka_unit_test(what_no_open_forces_can_do_is_left_alone),
		cmocka_unit_test(loads_that_move_the_body_are_not_exchanged),
		cmocka_unit_test(the_nearest_forces_are_nearest_by_contacts),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
