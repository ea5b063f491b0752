/* SPDX-License-Identifier: MIT */
/* src/base/forest.h: disjoint sets of numbers */
#include "support.h"

#include "base/forest.h"
#include "base/team.h"
#include "math/random.h"

enum { COUNT = 200 };

static void numbers_have_one_root_exactly_if_they_were_joined(void **state)
{
	int parent[COUNT], label[COUNT]; /* labels: by brute force */

	(void)state;
	for (int i = 0; i < COUNT; i++)
		parent[i] = label[i] = i;
	for (uint64_t k = 0; k < 150; k++) {
		const int a = (int)(COUNT * rb_random_unit(1, 1, k));
		const int b = (int)(COUNT * rb_random_unit(1, 2, k));
		const int from = label[b], to = label[a];

		parent[rb_forest_root(parent, b)] = rb_forest_root(parent, a);
		for (int i = 0; i < COUNT; i++)
			label[i] = label[i] == from ? to : label[i];
		for (int i = 0; k % 30 == 0 && i < COUNT; i++)
			for (int j = 0; j < i; j++)
				assert_int_equal(rb_forest_root(parent, i) ==
				                         rb_forest_root(parent, j),
				                 label[i] == label[j]);
	}
}

static void a_root_is_its_own_parent_and_paths_get_shorter(void **state)
{
	int parent[COUNT];

	(void)state;
	for (int i = 0; i < COUNT; i++)
		parent[i] = i > 0 ? i - 1 : 0; /* one long path */
	assert_int_equal(rb_forest_root(parent, COUNT - 1), 0);
	assert_int_equal(parent[0], 0);
	/* halved: every other number on the way points to its grandparent */
	assert_int_equal(parent[COUNT - 1], COUNT - 3);
	int steps = 0;
	for (int i = COUNT - 1; i != 0; i = parent[i])
		steps++;
	assert_true(steps <= COUNT / 2 + 1);
	/* and again, until all are near the root */
	for (int k = 0; k < 10; k++)
		assert_int_equal(rb_forest_root(parent, COUNT - 1), 0);
	assert_int_equal(parent[COUNT - 1], 0);
}

struct pairs {
	int parent[COUNT];
	bool shared;
};

static void join_some(void *user, size_t first, size_t end)
{
	struct pairs *pairs = user;

	for (uint64_t k = first; k < end; k++)
		rb_forest_join(pairs->parent, (int)(COUNT * rb_random_unit(2, 1, k)),
		               (int)(COUNT * rb_random_unit(2, 2, k)), pairs->shared);
}

static void several_threads_join_to_the_same_roots(void **state)
{
	struct pairs alone = {.shared = false}, together = {.shared = true};
	struct rb_error err;
	struct rb_team *team;

	(void)state;
	assert_ok(rb_team_create(&team, 3, &err));
	for (size_t count = 20; count < 200; count += 20) {
		for (int i = 0; i < COUNT; i++)
			alone.parent[i] = together.parent[i] = i;
		join_some(&alone, 0, count);
		rb_team_share(team, count, 3, join_some, &together);
		for (int i = 0; i < COUNT; i++) {
			const int root = rb_forest_root(alone.parent, i);

			assert_int_equal(rb_forest_root_shared(together.parent, i), root);
			assert_true(root <= i); /* the smallest number */
		}
	}
	rb_team_destroy(team);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(numbers_have_one_root_exactly_if_they_were_joined),
		cmocka_unit_test(several_threads_join_to_the_same_roots),
		cmocka_unit_test(a_root_is_its_own_parent_and_paths_get_shorter),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
