/* SPDX-License-Identifier: MIT */
/*
 * Arrows of what acts on bodies and how they move, with one scale for all pictures of a film, so
 * that lengths compare. One thread.
 */
#ifndef RB_FILM_ARROWS_H
#define RB_FILM_ARROWS_H

#include "film/bodies.h"

/* Length of an arrow of each kind: m per m/s, N, rad/s, m/s^2 or kg m/s. */
struct rb_arrow_scales {
	double per[RB_VECTORS_COUNT];
};
struct rb_arrow_scales rb_arrow_scales_of(const struct rb_bodies_setup *setup);

/* Takes one arrow: m, world coordinates; sRGB. */
typedef void rb_arrow_put(void *user, rb_vec3 from, rb_vec3 to, const double colour[3]);

/* All that the camera asks for and the frame has, those of a kind one after the other. */
void rb_arrows_each(const struct rb_bodies_setup *setup, const struct rb_arrow_scales *scales,
                    const struct rb_frame *frame, rb_arrow_put *put, void *user);

#endif
