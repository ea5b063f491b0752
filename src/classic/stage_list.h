/* SPDX-License-Identifier: MIT */
/*
 * Features -> the list of stages of a substep. What a scene lacks is not in the list.
 *
 * Built when a world is made, then read only.
 */
#ifndef RB_CLASSIC_STAGE_LIST_H
#define RB_CLASSIC_STAGE_LIST_H

#include <stdio.h>

#include "step/stage.h"

enum { RB_STAGE_LIST_MAX = 16 };

struct rb_stage_list {
	const struct rb_stage *stage[RB_STAGE_LIST_MAX];
	int count;
};

void rb_stage_list_build(struct rb_stage_list *plan, rb_features features);
/* One try of a substep: ends early once pass->worst says that it is lost. */
void rb_stage_list_run(const struct rb_stage_list *plan, struct rb_pass *pass);

/* All stages there are, in the order of a substep; `count` receives their number. */
const struct rb_stage *const *rb_stage_list_all(int *count);
/* Would this stage run in a scene of these features? */
bool rb_stage_list_has(const struct rb_stage *stage, rb_features features);

/* Prints the scene's features: which are there, why others are not. */
void rb_stage_list_print_features(const struct rb_model *model, FILE *to);

/*
 * Prints what runs of the classic method, what is left out and why, and the columns with their
 * bytes.
 */
void rb_stage_list_print(const struct rb_model *model, FILE *to);

#endif
