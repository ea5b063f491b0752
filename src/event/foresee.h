/* SPDX-License-Identifier: MIT */
/*
 * What a body meets next. Each body keeps only its earliest; a pair whose partner has since been on a new arc is foreseen
 * anew when its time comes (single-event scheduling, Smallenburg, Eur. Phys. J. E 45:22 (2022)).
 */
#ifndef RB_EVENT_FORESEE_H
#define RB_EVENT_FORESEE_H

#include "event/set.h"

/*
 * Foresees everything of body i from `now` on and puts it into the queue. Returns how many bodies other than `except`
 * (-1: none) it touches without being held by them.
 */
int rb_foresee(struct rb_located *l, int i, double now, int except);

/* The body has come to the wall of its cell: it goes through, and sees who is new there. */
void rb_foresee_wall(struct rb_located *l, int i, double now);

#endif
