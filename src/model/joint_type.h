/* SPDX-License-Identifier: MIT */
/*
 * Kinds of joints: one constant row (struct rb_joint_type) and one file in joint/ each.
 *
 * The row says which conditions hold its bodies (geom/linkage), what its free coordinate is, which
 * keys it needs and what it looks like. The call of the scene language, checks, methods, `check`,
 * recordings, films and messages read it. All rows stand in one table, joint/joint_types, by the
 * kind's number in recordings.
 */
#ifndef RB_MODEL_JOINT_TYPE_H
#define RB_MODEL_JOINT_TYPE_H

#include <rbsim/scene.h>

#include "base/error.h"
#include "geom/linkage.h"

/* How films and consoles draw a joint. */
enum rb_joint_form {
	RB_JOINT_UNSEEN,
	RB_JOINT_KNOB,  /* a ball about its point */
	RB_JOINT_PIN,   /* along its axis */
	RB_JOINT_CROSS, /* along both axes */
	RB_JOINT_RAIL,  /* along its axis, as far as b's point can get; a coil where it is sprung */
	RB_JOINT_BAR,   /* from point to point */
	RB_JOINT_CORD   /* the same; it hangs where it is slack */
};

struct rb_joint_type {
	const char *name; /* the value of `kind`: "ball" */
	const char *noun; /* "ball joint"; the plural has an s */
	struct rb_linkage_type linkage;
	bool has_axis;    /* the key `axis`, which is required */
	bool has_axis_b;  /* `axis_b` too, at right angles to it */
	bool is_centered; /* it needs no point: without one, at a's centre of mass */
	enum rb_joint_form form;
};

/* All kinds (joint/joint_types), by their number. */
extern const struct rb_joint_type *const rb_joint_types[RB_JOINT_KIND_COUNT];

static inline const struct rb_joint_type *rb_joint_type(int kind)
{
	RB_ASSERT_COSTLY(kind >= 0 && kind < RB_JOINT_KIND_COUNT);
	return rb_joint_types[kind];
}

/* The key and field for its coordinate, that for what a motor exerts, and the unit of its rate. */
struct rb_coordinate_words {
	const char *name;      /* "angle"; NULL: it has no coordinate */
	const char *load;      /* "torque"; NULL: it is not free */
	const char *rate_unit; /* "rad/s" */
};
extern const struct rb_coordinate_words rb_coordinate_words[RB_COORDINATE_LENGTH + 1];

static inline const struct rb_coordinate_words *rb_joint_words(int kind)
{
	return &rb_coordinate_words[rb_joint_type(kind)->linkage.coordinate];
}

/* It has an angle or a way: limits, a motor, friction, a spring. */
static inline bool rb_joint_is_free(int kind)
{
	return rb_joint_words(kind)->load != NULL;
}

/* Its points are a length from each other: it has no point that both share. */
static inline bool rb_joint_is_line(int kind)
{
	return rb_joint_type(kind)->linkage.coordinate == RB_COORDINATE_LENGTH;
}

/* A key of joint { } that some kinds lack; all have the others. */
struct rb_joint_key {
	const char *key;
	bool (*has)(int kind);
	bool (*named)(int kind); /* those that its default in the manual names; NULL: none */
	bool needed;             /* kinds that have it cannot do without */
};
extern const struct rb_joint_key rb_joint_keys[];
extern const int rb_joint_key_count;

enum { RB_JOINT_KINDS_SIZE = 24 * RB_JOINT_KIND_COUNT };

/* "hinge, slider and cylindrical", `last` being " and "; returns how many these are. */
int rb_joint_list_kinds(bool (*has)(int kind), const char *last, char out[RB_JOINT_KINDS_SIZE]);

#endif
