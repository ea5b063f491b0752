/* SPDX-License-Identifier: MIT */
/*
 * Predicts the next event of a body. Each body keeps only its earliest; a pair whose partner has
 * since started a new arc is predicted anew when its time comes (single-event scheduling,
 * Smallenburg, Eur. Phys. J. E 45:22 (2022)). Simulator's thread.
 */
#ifndef RB_LOCATED_PREDICT_H
#define RB_LOCATED_PREDICT_H

#include "located/event_set.h"

/*
 * Predicts the next touch and cell wall of body i from `now` on and puts the earlier one into the
 * queue. Returns the number of bodies other than `except` (-1: none) that it touches without a held
 * contact.
 */
int rb_predict(struct rb_located *l, int i, double now, int except);

/*
 * Moves a body that has reached the wall of its cell into the next one, and predicts touches with
 * the bodies that are new there.
 */
void rb_predict_wall(struct rb_located *l, int i, double now);

#endif
