/* SPDX-License-Identifier: MIT */
/*
 * How large a scene is, and how exact its frames are: sizes and coordinates, and the tolerances
 * that follow from them and from the method. Pure functions of a scene, on which the checks and the
 * model must agree; masses are not asked for.
 */
#ifndef RB_MODEL_SCALE_H
#define RB_MODEL_SCALE_H

#include <rbsim/model.h>

/* Distance to the next double, of |x|. */
double rb_ulp(double x);

struct rb_piece_scales {
	double size_min_m;       /* smallest radius or half-edge of a moving body, 0: none moves */
	double size_mean_m;      /* geometric mean of these over moving bodies, 0: none moves */
	double coordinate_max_m; /* largest |coordinate| or size */
	/* m, as given, or the default of the method and of the steps that it takes */
	double tolerance_m, stepped_tolerance_m;
};
struct rb_piece_scales rb_scene_sizes(const struct rb_scene *scene);

/* Whether anything but their start gives bodies speed: forces, motors, motions, callbacks. */
bool rb_scene_has_drive(const struct rb_scene *scene);

/* q = duration * frame_rate as a number of intervals: whole when within a few ulp of it. */
double rb_frame_intervals(double duration_s, double frame_rate, bool *whole);

#endif
