/* SPDX-License-Identifier: MIT */
/*
 * Which spheres are hidden behind nearer ones: for each pixel of the picture the distance behind
 * which nothing is seen any more. Never wrong, though not always right: what it calls hidden has no
 * pixel in the picture.
 *
 * One thread. Spheres are shown to it from the nearest to the farthest.
 */
#ifndef RB_FILM_HIDDEN_H
#define RB_FILM_HIDDEN_H

#include <stdbool.h>

#include "film/view.h"

struct rb_hidden {
	int across, down; /* pixels */
	float *reach;     /* [down][across], owned: m from the eye, INFINITY where all is seen */
};

/* For pictures of that size. Fails on memory only. */
RB_CHECKED enum rb_status rb_hidden_init(struct rb_hidden *hidden, int width, int height,
                                         struct rb_error *err);
void rb_hidden_release(struct rb_hidden *hidden); /* safe on a zeroed one */

void rb_hidden_clear(struct rb_hidden *hidden);
/* Is this sphere (view coordinates) hidden? If not, it hides others from now on. */
bool rb_hidden_add(struct rb_hidden *hidden, const struct rb_view *view, rb_vec3 centre,
                   double radius);

#endif
