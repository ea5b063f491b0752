/* SPDX-License-Identifier: MIT */
/* src/located/located_invariants.c */
#include "located/located_invariants.h"

#include "invariants.h"

static struct lab lab;

static int setup(void **state)
{
	(void)state;
	lab_open_pile(&lab, RB_METHOD_LOCATED);
	return 0;
}

static int teardown(void **state)
{
	(void)state;
	lab_close(&lab);
	return 0;
}

static struct rb_cluster *first_cluster(struct rb_located *l)
{
	for (int k = 0; k < l->cluster_count; k++)
		if (l->cluster[k].used)
			return &l->cluster[k];
	fail_msg("nothing rests");
	return NULL;
}

static void an_arc_of_the_future_is_found(void **state)
{
	struct rb_arc *const arc = &lab.world->located->arc[3];
	const struct rb_arc kept = *arc;

	(void)state;
	arc->anchor_s = 100;
	lab_assert_wrong(&lab, "the arc of body 3");
	*arc = kept;
	arc->velocity.y = (double)NAN;
	lab_assert_wrong(&lab, "the arc of body 3");
	*arc = kept;
}

static void a_body_in_two_clusters_or_none_is_found(void **state)
{
	struct rb_located *const l = lab.world->located;
	struct rb_cluster *const c = first_cluster(l);
	const int member = c->member[0];

	(void)state;
	l->cluster_of[member] = -1;
	lab_assert_wrong(&lab, "is in clusters");
	l->cluster_of[member] = (int)(c - l->cluster);
	l->cluster_of[3] = l->cluster_of[member];
	lab_assert_wrong(&lab, "bodies are in clusters");
	l->cluster_of[3] = -1;
	l->place[1] = 0;
	lab_assert_wrong(&lab, "left in the set");
	l->place[1] = -1;
	c->held[0].b = 3;
	lab_assert_wrong(&lab, "which are not its");
}

static void a_slip_without_direction_is_found(void **state)
{
	struct rb_cluster *const c = first_cluster(lab.world->located);

	(void)state;
	assert_true(c->held_count > 0);
	c->held[0].slipping = true;
	c->held[0].friction = 0.5;
	c->held[0].slip = (rb_vec3){0.5, 0, 0};
	lab_assert_wrong(&lab, "the slip of bodies");
}

static void an_event_of_the_past_is_found(void **state)
{
	struct rb_located *const l = lab.world->located;

	(void)state;
	const double kept = rb_queue_time(l->queue, 3);
	rb_queue_set(l->queue, 3, 0.01);
	lab_assert_wrong(&lab, "past");
	rb_queue_set(l->queue, 3, kept);
	rb_queue_set(l->queue, l->n + l->cluster_count, 100);
	lab_assert_wrong(&lab, "has an event and no bodies");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(an_arc_of_the_future_is_found, setup, teardown),
		cmocka_unit_test_setup_teardown(a_body_in_two_clusters_or_none_is_found, setup,
	                                        teardown),
		cmocka_unit_test_setup_teardown(a_slip_without_direction_is_found, setup, teardown),
		cmocka_unit_test_setup_teardown(an_event_of_the_past_is_found, setup, teardown),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
