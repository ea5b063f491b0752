/* SPDX-License-Identifier: MIT */
/*
 * Force elements: springs, drag and all other forces that a scene states by a call of their own.
 *
 * A kind of element is one constant row (struct rb_element_kind) and one file in force/. Its keys
 * make the call of the scene language, the table of rbsim-scene(5) and the columns of the
 * recording; its functions are what every method, the energies and the ledger ask. All kinds stand
 * in one table, force/kinds; the sums of forces are taken in its order.
 *
 * An element has either two ends, each on a body, or acts on every free body. Elements of a scene
 * are rows of the kind's own type; the model has copies of them, completed and sealed.
 */
#ifndef RB_MODEL_ELEMENT_H
#define RB_MODEL_ELEMENT_H

#include <rbsim/model.h>

#include "math/pose.h"
#include "model/scene_keys.h"

/* The moment at which an element is asked for its force, and where bodies are then. */
struct rb_element_query {
	const struct rb_model *model;
	double time_s;
	struct rb_pose (*pose)(const struct rb_element_query *query, int index);
	const void *user;
};

/* A force and its torque about the body's centre of mass. */
struct rb_wrench {
	rb_vec3 force, torque; /* N, N m */
};

enum { RB_ELEMENT_ROW_MAX = 256, RB_ELEMENT_FAULT_SIZE = 240 };

struct rb_element_kind {
	const char *name;   /* the call: "spring"; its rows in a recording are in /rbsim/NAMEs */
	const char *plural; /* for messages and `rbsim check`: "springs" */
	rb_features feature;
	size_t row_size, line_at; /* of a row; where in it the line of the call is, an int */
	const void *defaults;     /* a row */
	struct rb_row_table keys;
	const char
		*wants_one; /* keys of which one must be given: "'linear', 'quadratic' or both" */

	/* The two bodies (ids) that it is between. NULL: it acts on every free body. */
	void (*ends)(const void *row, int id[2]);
	/* What is wrong with numbers of a row, true and the text, or false. May be NULL. */
	bool (*fault)(const struct rb_scene *scene, const void *row,
	              char text[RB_ELEMENT_FAULT_SIZE]);
	/* Completes the model's copy of a row. May be NULL. */
	void (*seal)(const struct rb_scene *scene, void *row);
	/* Whether a row does anything at all. NULL: it does. */
	bool (*matters)(const void *row);
	/* Whether it can turn that free body: a torque, or a force off its centre. NULL: never. */
	bool (*turns)(const struct rb_scene *scene, const void *row, int id);

	/* The force on one body, at its pose; false: none. */
	bool (*act)(const struct rb_element_query *query, const void *row, int index,
	            const struct rb_pose *pose, struct rb_wrench *out);
	/*
	 * J, of elements that give back what they take. NULL: it has none, and the work of its
	 * forces is entered in the ledger.
	 */
	double (*energy)(const struct rb_element_query *query, const void *row);
	/* W, >= 0: what the damper of one with ends takes. NULL: nothing. */
	double (*dissipation)(const struct rb_element_query *query, const void *row);
	/*
	 * N s/m: of one without ends, what its force is of the velocity, which it is against; NAN:
	 * it is more than that. NULL: as NAN.
	 */
	double (*damps)(const void *row);
	/* The ledger enters one without ends under drag, else under applied forces. */
	bool is_drag;
};

/* All kinds (force/kinds): a place in the table is a place in scene->elements. */
extern const struct rb_element_kind *const rb_element_kinds[];
extern const int rb_element_kind_count;

/* The place of a kind that is in the table. */
int rb_element_place(const struct rb_element_kind *kind);

/* ---- of a scene ---- */

/* Appends a copy of the row. Fails on memory only. */
RB_CHECKED enum rb_status rb_scene_add_element(struct rb_scene *scene,
                                               const struct rb_element_kind *kind, const void *row,
                                               struct rb_error *err);
static inline int rb_scene_element_count(const struct rb_scene *scene,
                                         const struct rb_element_kind *kind)
{
	return scene->elements[rb_element_place(kind)].count;
}
static inline void *rb_scene_element(const struct rb_scene *scene,
                                     const struct rb_element_kind *kind, int k)
{
	return (char *)scene->elements[rb_element_place(kind)].rows + (size_t)k * kind->row_size;
}

void rb_scene_count_elements(const struct rb_scene *scene, int counts[RB_ELEMENT_KINDS_MAX]);

/* What is wrong with the bodies at its ends, NULL: nothing. */
const char *rb_element_ends_fault(const struct rb_scene *scene, const struct rb_element_kind *kind,
                                  const void *row);

/* ---- of a model ---- */

/* Elements of one kind that a model has, sealed. */
struct rb_elements {
	const struct rb_element_kind *kind;
	int count;
	void *rows;      /* owned, [count] of kind->row_size */
	int (*end)[2];   /* owned, [count]: indices of bodies; NULL: kind->ends is */
	int *first, *of; /* owned: those at body i are of[first[i] .. first[i + 1]); NULL too */
};

static inline const void *rb_elements_row(const struct rb_elements *elements, int k)
{
	return (const char *)elements->rows + (size_t)k * elements->kind->row_size;
}

/* Those of one kind, NULL where the model has none. */
const struct rb_elements *rb_model_elements(const struct rb_model *model,
                                            const struct rb_element_kind *kind);

/* How many of them are between bodies. */
int rb_elements_between(const struct rb_model *model);

/* model->elements, from the scene's; bodies must be numbered. Fails on memory only. */
RB_CHECKED enum rb_status rb_elements_create(struct rb_model *model, struct rb_error *err);
void rb_elements_destroy(struct rb_model *model);

/* J, of all elements of the model. */
double rb_elements_energy(const struct rb_element_query *query);

/* From the centre of mass to a point in object coordinates (x NAN: 0), world axes. */
rb_vec3 rb_element_arm(const struct rb_model *model, int index, rb_quat orientation, rb_vec3 point);

#endif
