/* SPDX-License-Identifier: MIT */
/* How many ways a scene's bodies are free to move at the start, and which joints say it twice. */
#ifndef RB_MODEL_MOBILITY_H
#define RB_MODEL_MOBILITY_H

#include <rbsim/model.h>

struct rb_mobility {
	int rows;      /* that joints take, ropes apart: those only bound */
	int redundant; /* of these, rows that follow from the others at the start */
	/* of all bodies that are neither static nor driven: their own less what joints take */
	int freedoms;
	/* false: too many rows; `redundant` is 0 then and `freedoms` a lower bound */
	bool counted;
};

/*
 * Of a model's joints at its initial poses: 6 for each free body, 3 where nothing turns, less the
 * rank of the rows (geom/linkage). A mechanism in a singular position has a smaller rank than
 * beside it. Fails on memory only.
 */
RB_CHECKED enum rb_status rb_mobility_of(struct rb_mobility *mobility, const struct rb_model *model,
                                         struct rb_error *err);

#endif
