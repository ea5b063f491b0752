/* SPDX-License-Identifier: MIT */
/*
 * What joints look like: capsules, by the form that a kind's row names (model/joint_type). A bar is
 * one, a cord a chain of them; a rail on a spring is a coil.
 *
 * Pure functions.
 */
#ifndef RB_FILM_JOINT_SHAPES_H
#define RB_FILM_JOINT_SHAPES_H

#include "film/view.h"
#include "flow/joint_view.h"

enum { RB_COIL_PIECES = 64, RB_JOINT_PIECES_MAX = RB_COIL_PIECES };

struct rb_joint_piece {
	rb_pose pose;          /* of the middle; its segment lies along local z */
	double length, radius; /* m */
};

/* How many pieces it has, whether they are to be seen or not. */
int rb_joint_piece_count(const struct rb_model *model, int joint);

/* All pieces in a frame; false: nothing is to be seen. */
bool rb_joint_pieces(const struct rb_model *model, const struct rb_frame *frame, int joint,
                     struct rb_joint_piece piece[RB_JOINT_PIECES_MAX]);

#endif
