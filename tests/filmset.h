/* SPDX-License-Identifier: MIT */
/* A ball in front of a camera: what tests of films share. */
#ifndef RB_TESTS_FILMSET_H
#define RB_TESTS_FILMSET_H

#include "support.h"
#include "worlds.h"

#include "film/film.h"
#include "flow/frame.h"

enum { W = 64, H = 48 };

static const double rate = 10; /* frames per second */

/* A ball that goes to the right, seen from the front, and a camera's film of it. */
struct set {
	struct lab lab;
	struct rb_camera_def camera;
	struct rb_frame frame;
	struct rb_film *film;
	struct rb_sink sink;
	char folder[256], png[300], video[300];
};

static inline void open_set(struct set *set)
{
	*set = (struct set){0};
	lab_open(&set->lab, 2, rate);
	set->lab.scene.world.title = rb_scene_text(&set->lab.scene, "A ball");
	set->lab.scene.world.gravity = (rb_vec3){0};
	lab_sphere(&set->lab, 0.5, 1, (rb_vec3){-2, 0, 0}, (rb_vec3){2, 0, 0});
	if (rb_model_create(&set->lab.model, &set->lab.scene, NULL, &set->lab.error) != RB_OK)
		fail_msg("model: %s", set->lab.error.text);
	set->camera = rb_camera_def_default();
	set->camera.name = "main";
	set->camera.size_px[0] = W;
	set->camera.size_px[1] = H;
	set->camera.position.value = (rb_vec3){0, -8, 0};
	set->camera.look_at.value = (rb_vec3){0, 0, 0};
	set->camera.overlay = 0;
	set->camera.shadows = false;
	assert_int_equal(rb_frame_init(&set->frame, set->lab.model, RB_FIELD_DEFAULT, NULL), RB_OK);
	support_folder(set->folder);
	snprintf(set->png, sizeof set->png, "%s/pictures/%%03d.png", set->folder);
	snprintf(set->video, sizeof set->video, "%s/film.mp4", set->folder);
	set->camera.png = set->png;
}

static inline void close_set(struct set *set)
{
	rb_film_destroy(set->film);
	rb_frame_release(&set->frame);
	lab_close(&set->lab);
}

#endif
