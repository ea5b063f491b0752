/* SPDX-License-Identifier: MIT */
/* What frames and callbacks get to know of limits, ropes, motors and friction of joints. */
#include "worlds.h"

#include "world/joint_events.h"

/* Two balls, the first the joint's b: ids in order are against the joint's. */
static void open_pair(struct lab *lab, int kind, bool with_world)
{
	struct rb_joint_def def = rb_joint_def_default();

	lab_open(lab, 1, 60);
	lab->scene.world.method = RB_METHOD_STEPPED;
	const int b = lab_sphere(lab, 0.1, 1, (rb_vec3){1, 0, 0}, (rb_vec3){0, 0, 0});
	def.kind = kind;
	def.a = lab_sphere(lab, 0.1, 1, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 0});
	if (!with_world)
		def.b = b;
	def.axis = (rb_vec3){1, 0, 0};
	if (kind != RB_JOINT_ROPE)
		def.at = (rb_vec3){0, 0, 0};
	assert_int_equal(rb_scene_add_joint(&lab->scene, &def, NULL, &lab->error), RB_OK);
	lab_seal(lab, 1);
}

static struct rb_joint_moment moment_of(const struct lab *lab)
{
	const struct rb_joint *joint = &lab->model->joints->joint[0];

	return (struct rb_joint_moment){
		.time_s = 0.25,
		.a = rb_world_pose(lab->world, &lab->world->state, joint->a),
		.b = joint->b < 0 ? rb_linkage_world()
	                          : rb_world_pose(lab->world, &lab->world->state, joint->b)};
}

static void an_event_is_of_the_pair_in_order(void **state)
{
	struct lab lab;

	(void)state;
	open_pair(&lab, RB_JOINT_ROPE, false);
	const struct rb_joint_moment moment = moment_of(&lab);
	const struct rb_event event = rb_joint_event(lab.model, RB_EVENT_TAUT, &moment, -3, 2);

	/* from a at 0 to b at 1, whose id is the lower one: pulled to a is pushed from it */
	assert_int_equal(event.a, 0);
	assert_int_equal(event.b, 1);
	assert_int_equal(event.joint, 1);
	assert_near(event.normal.x, -1, 0);
	assert_near(event.impulse.x, 3, 0);
	assert_near(event.point.x, 1, 0);
	assert_near(event.approach_speed, 2, 0);
	lab_close(&lab);
	open_pair(&lab, RB_JOINT_SLIDER, true);
	const struct rb_joint_moment alone = moment_of(&lab);
	const struct rb_event limit = rb_joint_event(lab.model, RB_EVENT_LIMIT, &alone, 3, 2);

	assert_int_equal(limit.a, 1);
	assert_int_equal(limit.b, 1);
	assert_near(limit.impulse.x, 3, 0);
	lab_close(&lab);
}

static void what_lasts_is_told_when_it_changes(void **state)
{
	struct rb_joint_state joint = {.noted = {-1, -1, -1}};
	enum rb_event_kind kind;

	(void)state;
	assert_false(rb_joint_event_notes(joint.noted, RB_DRIVE_MOTOR, false, &kind));
	assert_true(rb_joint_event_notes(joint.noted, RB_DRIVE_MOTOR, true, &kind));
	assert_int_equal(kind, RB_EVENT_DRIVES);
	assert_false(rb_joint_event_notes(joint.noted, RB_DRIVE_MOTOR, true, &kind));
	assert_true(rb_joint_event_notes(joint.noted, RB_DRIVE_MOTOR, false, &kind));
	assert_int_equal(kind, RB_EVENT_SLIPS);
	assert_false(rb_joint_event_notes(joint.noted, RB_JOINT_TAUT, false, &kind));
	assert_false(rb_joint_event_notes(joint.noted, RB_JOINT_TAUT, true, &kind));
	assert_true(rb_joint_event_notes(joint.noted, RB_JOINT_TAUT, false, &kind));
	assert_int_equal(kind, RB_EVENT_SLACK);
	assert_int_equal(joint.noted[RB_DRIVE_FRICTION], -1);
}

static void an_event_is_kept_where_somebody_wants_it(void **state)
{
	struct lab lab;

	(void)state;
	open_pair(&lab, RB_JOINT_ROPE, false);
	const struct rb_joint_moment moment = moment_of(&lab);
	const struct rb_event taut = rb_joint_event(lab.model, RB_EVENT_TAUT, &moment, -3, 2);
	const struct rb_event slack = rb_joint_event(lab.model, RB_EVENT_SLACK, &moment, 0, 0);

	lab.world->options.keep_events = false;
	assert_int_equal(rb_world_add_event(lab.world, &taut, &lab.error), RB_OK);
	assert_int_equal(lab.world->events.count, 0);
	assert_int_equal(lab.world->frame_counts.collisions, 1);
	lab.world->options.keep_events = true;
	assert_int_equal(rb_world_add_event(lab.world, &slack, &lab.error), RB_OK);
	assert_int_equal(lab.world->events.count, 1);
	assert_int_equal(lab.world->frame_counts.collisions, 1);
	lab_close(&lab);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(an_event_is_of_the_pair_in_order),
		cmocka_unit_test(what_lasts_is_told_when_it_changes),
		cmocka_unit_test(an_event_is_kept_where_somebody_wants_it),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
