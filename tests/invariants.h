/* SPDX-License-Identifier: MIT */
/* A world with a pile that rests, and what rb_world_validate says when one thing in it is wrong. */
#ifndef RB_TESTS_INVARIANTS_H
#define RB_TESTS_INVARIANTS_H

#include "method/method.h"
#include "worlds.h"

/* Three spheres on a floor, side by side and touching, one more in flight above them. */
static inline void lab_open_pile(struct lab *lab, enum rb_method_kind method)
{
	lab_open(lab, 1, 20);
	lab->scene.world.method = method;
	lab->scene.world.gravity = (rb_vec3){0, 0, -10};
	lab->scene.world.time_step_s = 0.01;
	lab_surface(lab, 0.5, 0);
	for (int i = 0; i < 3; i++)
		lab_sphere(lab, 0.5, 1, (rb_vec3){i, 0, 0.5}, (rb_vec3){0, 0, 0});
	lab_sphere(lab, 0.5, 1, (rb_vec3){0, 0, 20}, (rb_vec3){0, 0, 0});
	lab_plane(lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
	lab_seal(lab, 1);
	for (int k = 0; k < 4; k++)
		lab_step(lab);
	if (rb_world_validate(lab->world, &lab->error) != RB_OK)
		fail_msg("%s", lab->error.text);
}

/* It is refused, for that reason. */
static inline void lab_assert_wrong(struct lab *lab, const char *reason)
{
	assert_int_equal(rb_world_validate(lab->world, &lab->error), RB_ERR_BUG);
	if (!strstr(lab->error.text, reason))
		fail_msg("wanted '%s': %s", reason, lab->error.text);
}

#endif
