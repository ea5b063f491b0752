/* SPDX-License-Identifier: MIT */
/*
 * What a body meets next. Each body keeps only its earliest; a pair whose partner has since been on
 * a new arc is foreseen anew when its time comes (single-event scheduling, Smallenburg, Eur. Phys.
 * J. E 45:22 (2022)).
 */
#ifndef RB_LOCATED_PREDICT_H
#define RB_LOCATED_PREDICT_H

#include "located/event_set.h"

/*
 * Foresees everything of body i from `now` on and puts it into the queue. Returns how many bodies
 * other than `except` (-1: none) it touches without being held by them.
 */
int rb_predict(struct rb_located *l, int i, double now, int except);

/* The body has come to the wall of its cell: it goes through, and sees who is new there. */
void rb_predict_wall(struct rb_located *l, int i, double now);

#endif
