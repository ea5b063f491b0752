/* SPDX-License-Identifier: MIT */
/*
 * Which features a scene uses: one bit each, one row each. Stages and columns of an absent feature
 * do not exist. Pure functions of a scene and its table of materials.
 */
#ifndef RB_MODEL_FEATURES_H
#define RB_MODEL_FEATURES_H

#include <rbsim/model.h>

/* What the predicates look at, gathered in one pass over the scene. */
struct rb_feature_facts {
	const struct rb_scene *scene;
	bool moves;        /* forces and impacts move some body */
	bool can_touch;    /* some pair of bodies could touch */
	bool friction;     /* ... of which the materials have friction */
	bool restitution;  /* ... restitution */
	bool spins;        /* an angular velocity to begin with */
	bool off_center;   /* a centre of mass off the object's origin */
	bool angular;      /* a moving body that is no sphere: contacts pass beside its centre */
	bool unequal;      /* a moving body with unequal principal moments */
	bool forces;       /* a list of forces that is not empty */
	bool torque;       /* one of them, or a force element, acts off the centre of mass */
	bool driven;       /* a body with `motion` */
	bool driven_turns; /* ... that returns an orientation */
	bool filters;
	bool attracted; /* a free body by another one's gravitation */
	bool joints;
	bool joints_turn; /* ... of which one holds a body off its centre of mass, or turns it */
};

struct rb_feature_row {
	rb_features bit;
	const char *name;
	bool (*present)(const struct rb_feature_facts *facts);
	const char *help;   /* what it is, when it runs */
	const char *absent; /* why it is left out */
};

/* In the order of the bits. */
const struct rb_feature_row *rb_feature_rows(int *count);

/* `pair` is the dense table [material_count][material_count]. */
struct rb_feature_facts rb_feature_facts_of(const struct rb_scene *scene,
                                            const struct rb_pair_material *pair);
rb_features rb_features_of(const struct rb_scene *scene, const struct rb_pair_material *pair);

#endif
