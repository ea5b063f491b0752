/* SPDX-License-Identifier: MIT */
/* Bodies that stand still before a camera, and the pixels of their picture: what tests of the painter share. */
#ifndef RB_TESTS_STUDIO_H
#define RB_TESTS_STUDIO_H

#include "support.h"
#include "worlds.h"

#include "base/hash.h"
#include "film/painter.h"
#include "film/view.h"
#include "flow/frame.h"

enum { WIDTH = 160, HEIGHT = 120 };

struct studio {
	struct lab lab;
	struct rb_frame frame;
	struct rb_camera_def camera;
	struct rb_painter *painter;
	struct rb_pixmap picture; /* borrowed from the painter */
	struct rb_error err;
};

static inline void studio_open(struct studio *studio)
{
	*studio = (struct studio){0};
	lab_open(&studio->lab, 1, 10);
	studio->lab.scene.world.gravity = (rb_vec3){0, 0, -9.81};
	studio->camera = rb_camera_def_default();
	studio->camera.size_px[0] = WIDTH;
	studio->camera.size_px[1] = HEIGHT;
	studio->camera.position.value = (rb_vec3){0, -8, 2};
	studio->camera.look_at.value = (rb_vec3){0, 0, 1};
}

static inline void studio_close(struct studio *studio)
{
	rb_painter_destroy(studio->painter);
	rb_frame_release(&studio->frame);
	lab_close(&studio->lab);
}

/* A ball that stands still, in sRGB colours. */
static inline int studio_ball(struct studio *studio, double radius, rb_vec3 position,
                              rb_vec3 colour)
{
	struct rb_body_def def = lab_sphere_def(radius, 1, position, (rb_vec3){0, 0, 0});

	rb_vec3_to(def.color, colour);
	def.angular_velocity = (rb_vec3){1, 0, 0}; /* so that frames have orientations */
	return lab_add(&studio->lab, &def);
}

static inline void studio_seal(struct studio *studio)
{
	struct lab *lab = &studio->lab;
	struct rb_frame *frame = &studio->frame;

	if (rb_model_create(&lab->model, &lab->scene, NULL, &lab->error) != RB_OK)
		fail_msg("model: %s", lab->error.text);
	assert_int_equal(
		rb_frame_init(frame, lab->model, RB_FIELD_DEFAULT | RB_FIELD_CONTACTS, &lab->error),
		RB_OK);
	for (int i = 0; i < lab->model->body_count; i++) {
		rb_vec3_to(frame->position + 3 * i, lab->model->position[i]);
		rb_vec3_to(frame->velocity + 3 * i,
		           lab->scene.bodies[lab->model->id_of[i]].velocity);
		if (frame->orientation)
			rb_quat_to(frame->orientation + 4 * i, lab->model->orientation[i]);
	}
	if (rb_painter_create(&studio->painter, lab->model, &studio->camera, &studio->err) != RB_OK)
		fail_msg("painter: %s", studio->err.text);
}

static inline void studio_draw(struct studio *studio)
{
	if (rb_painter_draw(studio->painter, &studio->frame, NULL, NULL, &studio->picture,
	                    &studio->err) != RB_OK)
		fail_msg("draw: %s", studio->err.text);
	assert_int_equal(studio->picture.width, studio->camera.size_px[0]);
	assert_int_equal(studio->picture.height, studio->camera.size_px[1]);
}

static inline uint64_t studio_hash(struct studio *studio)
{
	studio_draw(studio);
	return rb_hash_bytes(studio->picture.rgba, (size_t)WIDTH * HEIGHT * 4, 0);
}

static const uint8_t *pixel_at(const struct studio *studio, int x, int y)
{
	assert_in_range(x, 0, studio->picture.width - 1);
	assert_in_range(y, 0, studio->picture.height - 1);
	return studio->picture.rgba + 4 * ((size_t)y * (size_t)studio->picture.width + (size_t)x);
}

/* Where a point of the world is in the picture. */
static const uint8_t *pixel_of(const struct studio *studio, rb_vec3 world)
{
	struct rb_view view;
	double at[2];

	assert_int_equal(
		rb_view_make(&view, studio->lab.model, &studio->camera, &studio->frame, NULL, NULL),
		RB_OK);
	rb_view_pixel(&view, rb_view_point(&view, world), at);
	return pixel_at(studio, (int)floor(at[0]), (int)floor(at[1]));
}

static inline int brightness(const uint8_t *p)
{
	return p[0] + p[1] + p[2];
}

static inline bool is_red(const uint8_t *p)
{
	return p[0] > 2 * p[1] && p[0] > 2 * p[2];
}

static inline bool is_green(const uint8_t *p)
{
	return p[1] > 2 * p[0] && p[1] > 2 * p[2];
}

static inline bool is_blue(const uint8_t *p)
{
	return p[2] > 2 * p[0] && p[2] > 2 * p[1];
}

static inline bool is_sky(const uint8_t *p)
{
	return p[2] >= p[1] && p[1] >= p[0] && brightness(p) > 400;
}

static const rb_vec3 red = {0.8, 0.05, 0.05}, green = {0.05, 0.7, 0.05}, blue = {0.05, 0.1, 0.8};

#endif
