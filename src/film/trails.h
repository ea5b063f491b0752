/* SPDX-License-Identifier: MIT */
/*
 * Where bodies have been: the paths of their centres of mass that a camera draws.
 *
 * Belongs to the thread of its camera. Every frame is added, drawn or not, so that a path does not
 * depend on which pictures are taken. When a path has RB_TRAIL_POINTS_MAX points, every second one
 * is dropped and from then on every second frame is kept (and so on): memory is bounded, and the
 * path stays whole.
 */
#ifndef RB_FILM_TRAILS_H
#define RB_FILM_TRAILS_H

#include <rbsim/frame.h>
#include <rbsim/model.h>

enum { RB_TRAIL_POINTS_MAX = 4096 };

struct rb_trails {
	int path_count, point_count; /* the same number of points in each path */
	int index
		/* of the bodies in frames; those that never move have no path */
		[RB_CAMERA_TRAILS_MAX];
	double (*points)[RB_TRAIL_POINTS_MAX][3]; /* [path_count], owned; m */
	double *time_s;                           /* [RB_TRAIL_POINTS_MAX], owned: of each point */
	uint64_t stride, seen;
	const struct rb_model *model; /* borrowed */
};

RB_CHECKED enum rb_status rb_trails_init(struct rb_trails *trails, const struct rb_model *model,
                                         const struct rb_camera_def *camera, struct rb_error *err);
void rb_trails_release(struct rb_trails *trails);
void rb_trails_add(struct rb_trails *trails, const struct rb_frame *frame);

#endif
