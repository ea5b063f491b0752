/* SPDX-License-Identifier: MIT */
/* src/model/parts.c */
#include "support.h"

#include "base/memory.h"
#include "geom/convex.h"
#include "geom/mass.h"
#include "model/shape.h"
#include "model/parts.h"
#include "solids.h"

struct shop {
	struct rb_scene scene;
	struct rb_parts_table *table;
	struct rb_error err;
};

static void open_shop(struct shop *shop)
{
	*shop = (struct shop){0};
	assert_int_equal(rb_scene_init(&shop->scene, &shop->err), RB_OK);
}

static void close_shop(struct shop *shop)
{
	rb_parts_table_destroy(shop->table);
	rb_scene_release(&shop->scene);
}

static int add(struct shop *shop, struct rb_shape shape)
{
	struct rb_body_def def = rb_body_def_default();
	int id = -1;

	def.call = "body";
	def.shape = shape;
	def.is_static = shape.kind == RB_SHAPE_PLANE || shape.kind == RB_SHAPE_RECTANGLE;
	assert_int_equal(rb_scene_add_body(&shop->scene, &def, &id, &shop->err), RB_OK);
	return id;
}

static int hull(struct shop *shop)
{
	rb_vec3 points[20];
	int solid = -1;

	for (uint64_t k = 0; k < 20; k++)
		points[k] = (rb_vec3){solids_random(1, 3 * k, -1, 1),
		                      solids_random(1, 3 * k + 1, -2, 1),
		                      solids_random(1, 3 * k + 2, 0, 3)};
	assert_int_equal(rb_scene_add_hull(&shop->scene, points, 20, &solid, &shop->err), RB_OK);
	return solid;
}

static const struct rb_shape ball = {.kind = RB_SHAPE_SPHERE, .radius = 0.5};
static const struct rb_shape brick = {.kind = RB_SHAPE_BOX, .size = {1, 2, 3}};
static const struct rb_shape pill = {.kind = RB_SHAPE_CAPSULE, .radius = 0.25, .size = {0, 0, 2}};
static const struct rb_shape tin = {.kind = RB_SHAPE_CYLINDER, .radius = 0.75, .size = {0, 0, 2}};
static const struct rb_shape sheet = {.kind = RB_SHAPE_RECTANGLE, .size = {4, 6}};
static const struct rb_shape ground = {.kind = RB_SHAPE_PLANE};

static int dumbbell(struct shop *shop)
{
	const struct rb_solid_part parts[3] = {
		{.shape = ball, .position = {0, 0, 2}, .orientation = rb_quat_identity, .share = 1},
		{.shape = pill,
	         .position = {0.5, 0, 0},
	         .orientation = rb_quat_from_turn((rb_vec3){0, 1, 0}),
	         .share = 1},
		{.shape = ball,
	         .position = {0, 0, -2},
	         .orientation = rb_quat_identity,
	         .share = 1}};
	int solid = -1;

	assert_int_equal(rb_scene_add_union(&shop->scene, parts, 3, &solid, &shop->err), RB_OK);
	return solid;
}

static void spheres_and_planes_do_without(void **slot)
{
	struct shop shop;

	(void)slot;
	open_shop(&shop);
	add(&shop, ball);
	add(&shop, ground);
	add(&shop, sheet);
	assert_int_equal(rb_parts_table_create(&shop.table, &shop.scene, &shop.err), RB_OK);
	assert_null(shop.table);
	close_shop(&shop);
}

static void every_part_reaches_as_far_as_its_shape(void **slot)
{
	struct shop shop;

	(void)slot;
	open_shop(&shop);
	const struct rb_shape stone = {.kind = RB_SHAPE_HULL, .solid = hull(&shop)};
	const struct rb_shape shapes[5] = {ball, brick, pill, tin, stone};
	for (int k = 0; k < 5; k++)
		add(&shop, shapes[k]);
	assert_int_equal(rb_parts_table_create(&shop.table, &shop.scene, &shop.err), RB_OK);
	for (int k = 0; k < 5; k++) {
		const struct rb_body_parts *parts = rb_parts_of(shop.table, k);

		assert_int_equal(parts->count, 1);
		assert_near(rb_convex_reach(&parts->part[0].core),
		            rb_shape_reach(shop.scene.solids, &shapes[k]), 1e-14);
	}
	close_shop(&shop);
}

static void equal_shapes_share_their_parts(void **slot)
{
	struct shop shop;

	(void)slot;
	open_shop(&shop);
	struct rb_shape other = brick, odd = pill;
	other.size[1] = 2.5;
	odd.solid = 7; /* not read of a capsule */
	const struct rb_shape shapes[7] = {brick, pill, other, brick, odd, other, ball};
	for (int k = 0; k < 7; k++)
		add(&shop, shapes[k]);
	assert_int_equal(rb_parts_table_create(&shop.table, &shop.scene, &shop.err), RB_OK);
	assert_int_equal(shop.table->shape_count, 4);
	assert_ptr_equal(rb_parts_of(shop.table, 0), rb_parts_of(shop.table, 3));
	assert_ptr_equal(rb_parts_of(shop.table, 1), rb_parts_of(shop.table, 4));
	assert_ptr_equal(rb_parts_of(shop.table, 2), rb_parts_of(shop.table, 5));
	assert_true(rb_parts_of(shop.table, 0) != rb_parts_of(shop.table, 2));
	close_shop(&shop);
}

static void parts_stand_where_the_object_puts_them(void **slot)
{
	const rb_quat turn = solids_turn(4);
	const rb_vec3 at = {3, -1, 2};
	struct shop shop;

	(void)slot;
	open_shop(&shop);
	const struct rb_shape bell = {.kind = RB_SHAPE_UNION, .solid = dumbbell(&shop)};
	add(&shop, bell);
	assert_int_equal(rb_parts_table_create(&shop.table, &shop.scene, &shop.err), RB_OK);
	const struct rb_body_parts *parts = rb_parts_of(shop.table, 0);
	assert_int_equal(parts->count, 3);
	const rb_placed pill_there = rb_body_part_place(&parts->part[1], at, turn);
	const rb_vec3 end = rb_placed_point(&pill_there, (rb_vec3){0, 0, 1});
	const rb_vec3 local = rb_vec3_add((rb_vec3){0.5, 0, 0}, (rb_vec3){sin(1.0), 0, cos(1.0)});
	const rb_vec3 wanted = rb_vec3_add(at, rb_quat_rotate(turn, local));
	assert_near(rb_vec3_length(rb_vec3_sub(end, wanted)), 0, 1e-14);
	close_shop(&shop);
}

static void a_plane_has_the_normal_that_spheres_see(void **slot)
{
	struct shop shop;

	(void)slot;
	open_shop(&shop);
	add(&shop, ground);
	add(&shop, brick);
	assert_int_equal(rb_parts_table_create(&shop.table, &shop.scene, &shop.err), RB_OK);
	const rb_quat turn = rb_plane_orientation((rb_vec3){-1, 0, 0},
	                                          (rb_vec3){(double)NAN, 0, 0});
	const struct rb_body_part *part = rb_parts_of(shop.table, 0)->part;
	const rb_placed there = rb_body_part_place(part, (rb_vec3){1, 2, 3}, turn);
	const rb_vec3 n = rb_placed_axis(&there);
	assert_true(n.x == -1 && n.y == 0 && n.z == 0);
	close_shop(&shop);
}

static double gap_between(struct rb_shape a, rb_vec3 at_a, struct rb_shape b, rb_vec3 at_b)
{
	struct shop shop;

	open_shop(&shop);
	const int first = add(&shop, a), second = add(&shop, b);
	shop.scene.bodies[first].position = at_a;
	shop.scene.bodies[second].position = at_b;
	assert_int_equal(rb_parts_table_create(&shop.table, &shop.scene, &shop.err), RB_OK);
	const double gap = rb_parts_gap_at_start(shop.table, &shop.scene, first, second);
	close_shop(&shop);
	return gap;
}

static void gaps_at_the_start_are_those_of_the_shapes(void **slot)
{
	const rb_vec3 origin = {0, 0, 0};

	(void)slot;
	assert_near(gap_between(brick, (rb_vec3){0, 0, 1.75}, ground, origin), 0.25, 1e-15);
	assert_near(gap_between(ground, origin, pill, (rb_vec3){0, 0, 1}), -0.25, 1e-15);
	assert_near(gap_between(brick, origin, brick, (rb_vec3){0.75, 0.5, 0.5}), -0.25, 1e-15);
	assert_near(gap_between(tin, (rb_vec3){1e6, 0, 0}, ball, (rb_vec3){1e6 + 1.5, 0, 0}), 0.25,
	            1e-15);
	assert_near(gap_between(brick, origin, sheet, (rb_vec3){0, 0, -1.5}), 0, 1e-15);
}

static void running_out_of_memory_leaves_nothing_behind(void **slot)
{
	struct shop shop;
	bool made = false;

	(void)slot;
	open_shop(&shop);
	const struct rb_shape bell = {.kind = RB_SHAPE_UNION, .solid = dumbbell(&shop)};
	const struct rb_shape stone = {.kind = RB_SHAPE_HULL, .solid = hull(&shop)};
	add(&shop, bell);
	add(&shop, stone);
	add(&shop, brick);
	const uint64_t before = rb_memory_counts().taken - rb_memory_counts().freed;
	for (uint64_t k = 1; !made; k++) {
		rb_memory_fail_at(k);
		made = rb_parts_table_create(&shop.table, &shop.scene, &shop.err) == RB_OK;
		rb_memory_fail_at(0);
		if (!made) {
			assert_int_equal(rb_memory_counts().taken - rb_memory_counts().freed,
			                 before);
			assert_null(shop.table);
		}
	}
	close_shop(&shop);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(spheres_and_planes_do_without),
		cmocka_unit_test(every_part_reaches_as_far_as_its_shape),
		cmocka_unit_test(equal_shapes_share_their_parts),
		cmocka_unit_test(parts_stand_where_the_object_puts_them),
		cmocka_unit_test(a_plane_has_the_normal_that_spheres_see),
		cmocka_unit_test(gaps_at_the_start_are_those_of_the_shapes),
		cmocka_unit_test(running_out_of_memory_leaves_nothing_behind),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
