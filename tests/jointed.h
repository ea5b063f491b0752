/* SPDX-License-Identifier: MIT */
/* Worlds with joints whose every part of the state comes to matter. */
#ifndef RB_TESTS_JOINTED_H
#define RB_TESTS_JOINTED_H

#include "worlds.h"

static inline struct rb_joint_def jointed_def(int kind, int a, int b)
{
	struct rb_joint_def def = rb_joint_def_default();

	def.kind = kind;
	def.a = a;
	def.b = b;
	return def;
}

static inline void jointed_add(struct lab *lab, struct rb_joint_def def)
{
	if (rb_scene_add_joint(&lab->scene, &def, NULL, &lab->error) != RB_OK)
		fail_msg("%s", lab->error.text);
}

static inline void jointed_by(struct lab *lab, int kind, int a, int b, rb_vec3 at)
{
	struct rb_joint_def def = jointed_def(kind, a, b);

	if (kind != RB_JOINT_ROD || b < 0)
		def.at = at;
	if (kind == RB_JOINT_ROD && b < 0) {
		def.at.x = (double)NAN;
		def.at_b = at;
	}
	def.axis = (rb_vec3){0.1, 1, 0};
	def.stiffness = kind == RB_JOINT_HINGE ? 0.3 : 0;
	jointed_add(lab, def);
}

/* A chain that swings against a ball. */
static inline void jointed_chain(struct lab *lab)
{
	lab_open_located(lab, 1, 10);
	lab_surface(lab, 0.3, 0.6);
	lab->scene.world.gravity = (rb_vec3){0, 0, -9.81};
	for (int k = 0; k < 3; k++)
		lab_sphere(lab, 0.1, 1 + k, (rb_vec3){0.4 * (k + 1), 0.02 * k, 0},
		           (rb_vec3){0, 0, 0});
	lab_sphere(lab, 0.1, 1, (rb_vec3){0.9, 0, -0.8}, (rb_vec3){0, 0, 0});
	jointed_by(lab, RB_JOINT_ROD, 0, -1, (rb_vec3){0, 0, 0});
	jointed_by(lab, RB_JOINT_HINGE, 1, 0, (rb_vec3){0.6, 0, 0});
	jointed_by(lab, RB_JOINT_BALL, 1, 2, (rb_vec3){1, 0, 0});
}

/* Two wheels that turn often from frame to frame, one driven by a motor that never gets there. */
static inline void jointed_wheels(struct lab *lab)
{
	lab_open_located(lab, 0.5, 10);
	for (int k = 0; k < 2; k++) {
		struct rb_body_def def = lab_sphere_def(0.5, 2, (rb_vec3){3.0 * k, 0, 0},
		                                        (rb_vec3){0, 0, 0});
		struct rb_joint_def joint = rb_joint_def_default();

		def.angular_velocity = (rb_vec3){0, 0, 2000};
		joint.kind = RB_JOINT_HINGE;
		joint.a = lab_add(lab, &def);
		joint.at = def.position;
		joint.axis = (rb_vec3){0, 0, -1};
		joint.motor_speed = k == 0 ? 5000 : (double)NAN;
		joint.motor_max = k == 0 ? 5 : 0;
		jointed_add(lab, joint);
	}
}

/* A wheel whose motor follows a swing, but lags behind and comes back; `user` is not used. */
static inline enum rb_status jointed_follow(void *user, int joint, double time_s, double value[2],
                                            struct rb_error *err)
{
	(void)user, (void)joint, (void)err;
	value[0] = rint(0.8 * sin(3 * time_s) * 0x1p44) * 0x1p-44; /* rounded: near_ulp */
	value[1] = (double)NAN;
	return RB_OK;
}

static inline void jointed_follower(struct lab *lab)
{
	lab_open_located(lab, 1.2, 10);
	struct rb_body_def def = lab_sphere_def(0.5, 2, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 0});
	struct rb_joint_def joint = rb_joint_def_default();

	def.angular_velocity = (rb_vec3){0, 0, 2.4};
	joint.kind = RB_JOINT_HINGE;
	joint.a = lab_add(lab, &def);
	joint.at = def.position;
	joint.axis = (rb_vec3){0, 0, -1};
	joint.motor_function = 0;
	joint.motor_max = 1.36; /* I = 0.2, and I a w^2 = 1.44 */
	jointed_add(lab, joint);
}

#endif
