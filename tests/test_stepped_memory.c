/* SPDX-License-Identifier: MIT */
/*
 * src/stepped/stepped, local_rollback: a step for which memory runs out leaves the world at the
 * step before: its contacts, impulses, joints, ledger and counts.
 */
#include "jointed.h"
#include "sanitized.h"
#include "worlds.h"

#include "base/memory.h"
#include "method/method.h"
#include "method/save.h"
#include "stepped/stepped_state.h"
#include "world/joint_state.h"

static const rb_vec3 origin, down = {0, 0, -9.81};

/* All that a step keeps, as bytes. */
static void take_image(struct lab *lab, struct rb_pack *image)
{
	struct rb_world *const world = lab->world;
	struct rb_stepped *const s = world->stepped;
	uint64_t hash = rb_world_hash(world), count = world->events.count;

	rb_pack_restart(image);
	rb_pack_u64(image, &hash);
	rb_pack_u64(image, &count);
	rb_fields_pack(rb_contact_fields(), world->contacts.row, world->contacts.count, NULL,
	               image);
	rb_fields_pack(rb_named_impulse_fields(), s->all.points.last, s->all.points.last_count,
	               NULL, image);
	rb_fields_pack(rb_ledger_fields(), &world->ledger, 1, NULL, image);
	/* without counts of work, which was done */
	struct rb_counts counts = {.collisions = world->frame_counts.collisions,
	                           .substeps = world->frame_counts.substeps,
	                           .body_steps = world->frame_counts.body_steps,
	                           .plastic_ends = world->frame_counts.plastic_ends,
	                           .crowded_impacts = world->frame_counts.crowded_impacts,
	                           .crowded_energy_j = world->frame_counts.crowded_energy_j,
	                           .smallest_step_s = world->frame_counts.smallest_step_s,
	                           .residual_m = world->frame_counts.residual_m,
	                           .slip_m = world->frame_counts.slip_m,
	                           .max_penetration_m = world->frame_counts.max_penetration_m};
	rb_fields_pack(rb_counts_fields(), &counts, 1, NULL, image);
	for (int k = 0; world->model->joints && k < world->model->joints->count; k++)
		rb_fields_pack(rb_joint_memory_fields(), &s->solver.joint[k].kept, 1, NULL, image);
	if (world->joint)
		rb_joint_states_pack(world, image);
	assert_false(image->failed);
}

/* Memory of passes is given back, so that they allocate in every step. */
static void release_arenas(struct lab *lab)
{
	for (int k = 0; k < lab->world->worker_count; k++) {
		rb_arena_release(&lab->world->arena[k]);
		rb_arena_release(&lab->world->kept[k]);
	}
}

/* The frame's k-th allocation fails. If it is needed, nothing but parts of the step is kept. */
static enum rb_status fail_at(struct lab *lab, uint64_t k, struct rb_pack image[2])
{
	const double begin = rb_world_time(lab->world);

	release_arenas(lab);
	take_image(lab, &image[0]);
	rb_memory_fail_at(k);
	const enum rb_status status = rb_world_step_frame(lab->world, &lab->error);
	rb_memory_fail_at(0);
	if (status == RB_OK) {
		/* it was not needed, also by what could go on without */
		assert_false(rb_stepped_lacks_memory(lab->world));
		return status;
	}
	assert_int_equal(status, RB_ERR_MEMORY);
	assert_int_equal(rb_world_validate(lab->world, &lab->error), RB_OK);
	if (rb_world_time(lab->world) > begin)
		return status;
	take_image(lab, &image[1]);
	if (image[0].size != image[1].size ||
	    memcmp(image[0].bytes, image[1].bytes, image[0].size) != 0)
		fail_msg("t = %g: allocation %d has left something", begin, (int)k);
	return status;
}

/*
 * That bodies are at rest is forgotten in a step that fails; the next one finds their forces anew,
 * within the tolerance.
 */
static void assert_same(const struct lab *found, const struct lab *wanted)
{
	for (int k = 0; k < found->model->body_count; k++) {
		const int id = found->model->id_of[k];

		assert_vector(rb_world_position(found->world, id),
		              rb_world_position(wanted->world, id),
		              found->model->stepped_tolerance_m);
	}
	assert_int_equal(found->world->contacts.count, wanted->world->contacts.count);
}

/* A world of the same scene in that state. */
static void make_another(struct lab *another, void (*open)(struct lab *),
                         const struct rb_world_options *options, struct rb_pack *saved)
{
	struct rb_pack loaded = {.loading = true, .bytes = saved->bytes, .size = saved->size};

	open(another);
	lab_seal_with(another, options, NULL);
	assert_int_equal(rb_world_pack(another->world, &loaded, &another->error), RB_OK);
}

/*
 * Every step of a run fails at one allocation after the other, then succeeds as if nothing was;
 * returns the number of failures. All threads fail by the same ways: where these alone are looked
 * at, every sixth allocation will do.
 */
static int fail_everywhere(void (*open)(struct lab *), const struct rb_world_options *options)
{
	struct rb_pack image[2] = {{0}, {0}}, saved = {0};
	struct lab lab;
	int failures = 0;

	open(&lab);
	lab_seal_with(&lab, options, NULL);
	while (rb_world_frame(lab.world) + 1 < rb_world_frame_count(lab.world)) {
		const double begin = rb_world_time(lab.world);
		struct lab undisturbed;

		rb_pack_restart(&saved);
		assert_int_equal(rb_world_pack(lab.world, &saved, &lab.error), RB_OK);
		for (uint64_t k = 1; fail_at(&lab, k, image) != RB_OK; k += tried(1, 1, 6)) {
			failures++;
			if (!(rb_world_time(lab.world) > begin))
				continue;
			/* some parts of the step were kept */
			lab_close(&lab);
			make_another(&lab, open, options, &saved);
		}
		make_another(&undisturbed, open, options, &saved);
		lab_step(&undisturbed);
		assert_same(&lab, &undisturbed);
		lab_close(&undisturbed);
	}
	rb_pack_release(&image[0]);
	rb_pack_release(&image[1]);
	rb_pack_release(&saved);
	lab_close(&lab);
	return failures;
}

static void assert_survives(void (*open)(struct lab *))
{
	const struct rb_world_options bare = {.threads = 1};
	const struct rb_world_options full = {
		.threads = 2, .keep_events = true, .keep_contacts = true};

	for (int k = tried(0, 0, 1); k < 2; k++)
		assert_true(fail_everywhere(open, k ? &full : &bare) > tried(100, 100, 100 / 6));
}

static void open_steps(struct lab *lab, int steps)
{
	lab_open(lab, steps / 60.0, 60);
	lab->scene.world.method = RB_METHOD_STEPPED;
	lab->scene.world.time_step_s = 1.0 / 60;
	lab->scene.world.gravity = down;
	lab_surface(lab, 0.5, 0.5);
	lab_plane(lab, origin, (rb_vec3){0, 0, 1});
}

/* Boxes and balls that bounce, slide and come to rest, one after the other. */
static void lay_drops(struct lab *lab)
{
	for (int k = 0; k < 4; k++) {
		lab_box(lab, (rb_vec3){0.2, 0.3, 0.1}, 1, (rb_vec3){k, 0, 0.05 + 0.02 * k},
		        rb_quat_identity);
		lab_sphere(lab, 0.1, 1, (rb_vec3){k, 0.02, 0.3 + 0.05 * k}, (rb_vec3){0.2, 0, -1});
	}
}

static void open_drops(struct lab *lab)
{
	open_steps(lab, 30);
	lab->scene.world.rollback = RB_ROLLBACK_GLOBAL;
	lay_drops(lab);
}

/* A ball that flies far in a step throws others, whose steps are taken in parts. */
static void open_thrown(struct lab *lab)
{
	open_steps(lab, 12);
	lay_drops(lab);
	lab_sphere(lab, 0.5, 100, (rb_vec3){80, 0, 0.5}, (rb_vec3){300, 0, 0});
	for (int k = 1; k < 5; k++)
		lab_sphere(lab, 0.5, 1, (rb_vec3){95.3 + 6 * k, 0, 0.5}, origin);
}

static void open_thrown_together(struct lab *lab)
{
	open_thrown(lab);
	lab->scene.world.rollback = RB_ROLLBACK_GLOBAL;
}

/* Drives that give way, a rope that becomes taut, a hinge at its limit. */
static void lay_joints(struct lab *lab)
{
	for (int k = 0; k < 3; k++) {
		const double x = 3 + k;
		const int wheel = lab_sphere(lab, 0.2, 1, (rb_vec3){x, 5, 2}, origin);
		const int ball = lab_sphere(lab, 0.1, 1, (rb_vec3){x, 5.5, 2}, origin);
		struct rb_joint_def hinge = jointed_def(RB_JOINT_HINGE, wheel, -1);
		struct rb_joint_def rope = jointed_def(RB_JOINT_ROPE, wheel, ball);

		hinge.at = (rb_vec3){x, 5, 2};
		hinge.axis = (rb_vec3){1, 0, 0};
		hinge.motor_speed = 1 + k;
		hinge.motor_max = 0.5;
		hinge.limits[0] = -0.1;
		hinge.limits[1] = 0.1;
		jointed_add(lab, hinge);
		rope.length_m = 0.51 + 0.02 * k;
		jointed_add(lab, rope);
	}
}

static void open_joints(struct lab *lab)
{
	open_steps(lab, 20);
	lay_drops(lab);
	lay_joints(lab);
}

/* The same where impacts at joints need short steps. */
static void open_thrown_joints(struct lab *lab)
{
	open_thrown(lab);
	lay_joints(lab);
	lab_sphere(lab, 0.1, 5, (rb_vec3){0, 5, 2.1}, (rb_vec3){60, 0, 0});
}

static void open_thrown_joints_together(struct lab *lab)
{
	open_thrown_joints(lab);
	lab->scene.world.rollback = RB_ROLLBACK_GLOBAL;
}

static void steps_of_all_survive(void **state)
{
	(void)state;
	assert_survives(open_drops);
	assert_survives(open_joints);
}

static void steps_in_parts_survive(void **state)
{
	(void)state;
	assert_survives(open_thrown);
	assert_survives(open_thrown_joints);
}

static void steps_in_parts_of_all_survive(void **state)
{
	(void)state;
	assert_survives(open_thrown_together);
	assert_survives(open_thrown_joints_together);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(steps_of_all_survive),
		cmocka_unit_test(steps_in_parts_survive),
		cmocka_unit_test(steps_in_parts_of_all_survive),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
