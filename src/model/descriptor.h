/* SPDX-License-Identifier: MIT */
/*
 * Methods: one constant row (struct rb_method) each, in the folder of its own. All stand in one
 * table, method/method_table, by their kind.
 *
 * A method locates, takes steps, or does both: `auto` locates, and takes steps where that does not
 * get on. Who asks what a scene's method can do reads its row.
 */
#ifndef RB_MODEL_DESCRIPTOR_H
#define RB_MODEL_DESCRIPTOR_H

#include <rbsim/model.h>

struct rb_world;
struct rb_pack;
struct rb_method_part;

/* What takes steps of a world. */
struct rb_stepper {
	double tolerance; /* default: the largest overlap of a frame over the smallest size */
	/* What it needs beside the state; made when it is first used, then nothing. */
	enum rb_status (*prepare)(struct rb_world *world, struct rb_error *err);
	/* Before the first step after locating. NULL: nothing is to be done. */
	enum rb_status (*take_over)(struct rb_world *world, struct rb_error *err);
	/* On failure the state is that of the beginning of the step. */
	enum rb_status (*step)(struct rb_world *world, double start_s, double dt_s,
	                       struct rb_error *err);
	/* What the next step starts from, to bytes and back; made when it is loaded. */
	void (*pack)(struct rb_world *world, struct rb_pack *pack);
	/* RB_ERR_BUG says what does not hold of it between steps. NULL: it keeps nothing. */
	enum rb_status (*validate)(const struct rb_world *world, struct rb_error *err);
	/* Frees what prepare has made, if it has. NULL: it makes nothing. */
	void (*release)(struct rb_world *world);
};

struct rb_method {
	const char *name;                   /* as scenes and --method have it */
	const char *what, *good_for, *mind; /* `rbsim methods` */
	bool locates;                       /* from event to event */
	bool changes;                   /* to its steps and back, where locating does not get on */
	const struct rb_stepper *steps; /* also of those that only locate: forces at the start */
	rb_features lacks;              /* scenes that have one of these are refused */
	bool round_only; /* its contacts are of spheres, with each other, planes and rectangles */
	/* Its parts, for `rbsim check`, and what these are. NULL: stages (classic/stage_list). */
	const struct rb_method_part *(*parts)(int *count);
	const char *parts_title;
};

/* All methods (method/method_table), by kind. */
extern const struct rb_method *const rb_methods[RB_METHOD_KIND_COUNT];

static inline const struct rb_method *rb_model_method_row(const struct rb_model *model)
{
	return rb_methods[model->method];
}

/* Whether `auto` may leave to steps what it does not come to the end of. */
static inline bool rb_model_may_change_method(const struct rb_model *model)
{
	return rb_model_method_row(model)->changes &&
	       !(model->features & rb_methods[RB_METHOD_STEPPED]->lacks);
}

/* The kind of that name; -1: there is none. */
int rb_method_find(const char *name);

#endif
