/* SPDX-License-Identifier: MIT */
/* Joints that form trees: accelerations are those that rows of joints give. */
#include "jointed.h"

#include <float.h>

#include "base/memory.h"
#include "located/arc.h"
#include "located/articulated.h"

enum { BODIES = 5, WORLD = -1 };

/* What hangs on what: a chain, and a branch that is joined the other way round. */
static const int parent[BODIES] = {WORLD, 0, 1, 1, 3};

struct tree {
	struct lab lab;
	struct rb_located *l;
	double time_s;
	int body[BODIES];
	struct rb_pose pose[BODIES];
	struct rb_joint_rows rows;
};

enum extra { NOTHING, ROPE, RING, BRAKE, ROD };

static void add_joint(struct tree *tree, int kind, int k, enum extra extra)
{
	const struct rb_body_def *const body = tree->lab.scene.bodies;
	const int other = parent[k];
	const bool back = k >= 3; /* the parent is the joint's b */
	struct rb_joint_def def = jointed_def(kind, back ? other : k, back ? k : other);

	if (kind != RB_JOINT_ROD)
		def.at = rb_vec3_add(body[k].position, (rb_vec3){-0.5, 0.1, 0.2});
	else if (other == WORLD)
		def.at_b = (rb_vec3){-1, 0, 1};
	if (extra == BRAKE && k == 2) {
		def.motor_speed = 0;
		def.motor_max = 1e3;
	}
	def.axis = (rb_vec3){0.3, 1, -0.2 * k};
	if (kind == RB_JOINT_UNIVERSAL)
		def.axis_b = (rb_vec3){1, -0.3, 0};
	jointed_add(&tree->lab, def);
}

/* Bodies with that kind of joint, after a while; `held`: the first one hangs on the world. */
static void open(struct tree *tree, int kind, bool held, enum extra extra)
{
	struct lab *const lab = &tree->lab;

	lab_open_located(lab, 0.25, 4);
	lab->scene.world.gravity = (rb_vec3){0, 3, -9.81};
	for (int k = 0; k < BODIES; k++) {
		const struct rb_body_def def = lab_box_def((rb_vec3){0.8, 0.2 + 0.1 * k, 0.4},
		                                           1 + 0.5 * k,
		                                           (rb_vec3){k, k == 3 ? -1 : 0, 0});

		lab_add(lab, &def);
	}
	for (int k = held ? 0 : 1; k < BODIES; k++)
		add_joint(tree, kind, k, extra);
	if (extra == ROPE || extra == RING) {
		struct rb_joint_def def = jointed_def(extra == ROPE ? RB_JOINT_ROPE : RB_JOINT_BALL,
		                                      2, 4);

		if (extra == ROPE)
			def.length_m = 100;
		else
			def.at = (rb_vec3){2, 0.5, 0};
		jointed_add(lab, def);
	}
	lab_seal(lab, 1);
	if (rb_world_step_frame(lab->world, &lab->error) != RB_OK)
		fail_msg("%s", lab->error.text);
	tree->l = lab->world->located;
	tree->time_s = tree->l->now_s;
	for (int k = 0; k < BODIES; k++) {
		tree->body[k] = tree->l->place[k] = k;
		tree->pose[k] = rb_arc_pose(tree->l, k, tree->time_s);
	}
	tree->rows = (struct rb_joint_rows){
		.l = tree->l, .body = tree->body, .pose = tree->pose, .body_count = BODIES};
	assert_true(rb_joint_rows_collect(&tree->rows));
	rb_joint_rows_fill(&tree->rows, tree->time_s);
}

static void finish(struct tree *tree)
{
	for (int k = 0; k < BODIES; k++)
		tree->l->place[k] = -1;
	lab_close(&tree->lab);
}

/* Any accelerations without joints. */
static void let_go(rb_vec3 *linear, rb_vec3 *angular)
{
	for (int k = 0; k < BODIES; k++) {
		linear[k] = (rb_vec3){0.3 * k, 1, -9.81 + k};
		angular[k] = (rb_vec3){1, -0.5 * k, 0.25};
	}
}

static void trees_do_what_rows_do(void **state)
{
	static const int kind[] = {RB_JOINT_FIXED,  RB_JOINT_BALL,        RB_JOINT_HINGE,
	                           RB_JOINT_SLIDER, RB_JOINT_CYLINDRICAL, RB_JOINT_UNIVERSAL};

	(void)state;
	for (size_t n = 0; n < 2 * sizeof kind / sizeof kind[0]; n++) {
		struct tree tree;
		struct rb_joint_tree *articulated;
		rb_vec3 x[2][BODIES], y[2][BODIES], free[2][BODIES], force = {0, 0, 0};
		struct rb_entries rate = {0};
		double off = 0;

		open(&tree, kind[n / 2], n % 2, NOTHING);
		let_go(free[0], free[1]);
		let_go(x[0], x[1]);
		let_go(y[0], y[1]);
		assert_true(rb_articulated_take(&tree.rows, &articulated));
		assert_non_null(articulated);
		rb_joint_tree_accelerate(articulated, tree.time_s, x[0], x[1]);
		assert_true(rb_joint_rows_accelerate(&tree.rows, y[0], y[1]));
		for (int k = 0; k < BODIES; k++) {
			off = fmax(off, rb_vec3_length(rb_vec3_sub(x[0][k], y[0][k])));
			off = fmax(off, rb_vec3_length(rb_vec3_sub(x[1][k], y[1][k])));
			force = rb_vec3_add_scaled(force, 1 + 0.5 * k,
			                           rb_vec3_sub(x[0][k], free[0][k]));
		}
		print_message("kind %d: %.3g m/s^2\n", kind[n / 2], off);
		assert_true(off < 1e-10); /* rows round, trees less */
		/* what comes from outside is all that changes the momentum of all */
		rb_joint_tree_enter(articulated, &rate);
		force = rb_vec3_sub(
			force, rb_vec3_from(rate.row + RB_ENTRY_LINEAR + 3 * RB_MOMENTUM_STATIC));
		assert_true(rb_vec3_length(force) < 1e-11);
		finish(&tree);
	}
}

static void other_rows_are_not_left_out(void **state)
{
	(void)state;
	for (enum extra extra = ROPE; extra <= ROD; extra++) {
		struct tree tree;
		struct rb_joint_tree *articulated;

		open(&tree, extra == ROD ? RB_JOINT_ROD : RB_JOINT_HINGE, true, extra);
		assert_true(rb_articulated_take(&tree.rows, &articulated));
		if (extra == ROPE) /* a slack one has none */
			assert_non_null(articulated);
		else
			assert_null(articulated);
		finish(&tree);
	}
}

static void ask(struct rb_dense *dense)
{
	for (int k = 0; k < dense->n; k++)
		dense->right[k] = 1 + k / 2;
}

/* Each row of a ring stands there twice: factors need pivots, and serve again at the same moment. */
static void factors_of_rows_that_depend_on_each_other_are_kept(void **state)
{
	enum { ROWS_MAX = 64 };
	struct tree tree;
	double unknown[ROWS_MAX], found[ROWS_MAX], *block = NULL;
	size_t capacity = 0;
	struct rb_coupled_kept kept = {.block = &block, .capacity = &capacity};
	struct rb_dense dense = {.n = 0};

	(void)state;
	open(&tree, RB_JOINT_BALL, true, RING);
	struct rb_coupled system = {.l = tree.l,
	                            .pose = tree.pose,
	                            .body = tree.body,
	                            .body_count = BODIES,
	                            .is_symmetric = true,
	                            .keeps_pivots = true,
	                            .kept = &kept};
	const int n = 2 * tree.rows.count;
	const size_t size = (size_t)n * sizeof unknown[0];

	assert_true(n <= ROWS_MAX);
	assert_true(rb_coupled_reserve(&system, n));
	assert_true(rb_coupled_reserve_dense(tree.l->arena, &dense, n));
	dense.n = system.count = n;
	rb_coupled_turn(&system);
	for (int k = 0; k < n; k++) {
		system.row[k] = rb_joint_rows_coupled(&tree.rows.row[k / 2]);
		rb_coupled_respond(&system, &system.row[k]);
	}
	assert_false(rb_coupled_find(&system, &dense, 1, found));
	rb_coupled_sort(&system);
	rb_coupled_fill(&system, &dense, 1);
	assert_false(system.is_factored);
	ask(&dense);
	rb_coupled_solve(&system, &dense);
	assert_true(dense.open);
	memcpy(unknown, dense.right, size);
	assert_true(rb_coupled_accept(&system, &dense, 1, unknown, 1e-15, 1e-16));

	assert_false(rb_coupled_find(&system, &dense, 2, found));
	assert_true(rb_coupled_find(&system, &dense, 1, found));
	assert_memory_equal(found, unknown, size);
	ask(&dense);
	rb_coupled_again(&system, &dense);
	for (int k = 0; k < n; k++)
		assert_near(dense.right[k], unknown[k], 1e-9 * (1 + fabs(unknown[k])));
	/* those that leave more than new ones do are given up */
	assert_true(rb_coupled_accept(&system, &dense, 1, unknown, 4e-15, 1e-16));
	assert_true(rb_coupled_find(&system, &dense, 1, found));
	assert_false(rb_coupled_accept(&system, &dense, 1, unknown, 5e-15, 1e-16));
	assert_false(rb_coupled_find(&system, &dense, 1, found));
	rb_memory_free(block);
	finish(&tree);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(trees_do_what_rows_do),
		cmocka_unit_test(other_rows_are_not_left_out),
		cmocka_unit_test(factors_of_rows_that_depend_on_each_other_are_kept),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
