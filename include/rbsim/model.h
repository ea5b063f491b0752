/* SPDX-License-Identifier: MIT */
/*
 * The sealed constants of a run, made once from a scene and then read only by every thread.
 *
 * Bodies have two numbers: the *id*, their place in the scene, and the *index*: moving bodies first
 * (0 .. body_count-1, in the order of the scene), then statics (body_count ..
 * body_count+static_count-1). Columns are by index. A column that an absent feature would use is
 * NULL.
 */
#ifndef RBSIM_MODEL_H
#define RBSIM_MODEL_H

#include <rbsim/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

/* One bit per feature, one row each in model/features. */
typedef unsigned rb_features;
enum {
	RB_FEATURE_GRAVITY = 1u << 0,
	RB_FEATURE_GRAVITY_FORCE = 1u << 1,
	RB_FEATURE_FORCES = 1u << 2,     /* `forces` of a body */
	RB_FEATURE_ROTATION = 1u << 3,   /* some body turns or can come to turn */
	RB_FEATURE_GYROSCOPIC = 1u << 4, /* a body with unequal principal moments that can turn */
	RB_FEATURE_OFF_CENTER = 1u << 5, /* a centre of mass off the object's origin */
	RB_FEATURE_CONTACT = 1u << 6,    /* two bodies that could touch */
	RB_FEATURE_FRICTION = 1u << 7,
	RB_FEATURE_RESTITUTION = 1u << 8,
	RB_FEATURE_FILTERS = 1u << 9,
	RB_FEATURE_HOOK_STEP = 1u << 10,
	RB_FEATURE_HOOK_COLLISION = 1u << 11,
	RB_FEATURE_EVENTS = 1u << 12, /* impacts are kept for frames or hooks */
	RB_FEATURE_PUSHES =
		1u << 13, /* callbacks that can push: step, collision, transition or frame */
	RB_FEATURE_SPRINGS = 1u << 14,
	RB_FEATURE_DRAG = 1u << 15,
	RB_FEATURE_FIELD = 1u << 16,
	RB_FEATURE_DRIVEN = 1u << 17, /* a body with `motion` */
	RB_FEATURE_HOOK_TRANSITION = 1u << 18,
	RB_FEATURE_ELEMENTS = 1u << 19,    /* force elements that are neither springs nor drag */
	RB_FEATURE_GRAVITATION = 1u << 20, /* bodies attract each other */
	RB_FEATURE_JOINTS = 1u << 21,

	/* forces that vary with where bodies are and how they move */
	RB_FEATURES_VARIED = RB_FEATURE_SPRINGS | RB_FEATURE_DRAG | RB_FEATURE_FIELD |
	                     RB_FEATURE_ELEMENTS | RB_FEATURE_GRAVITATION,
};

/* Entry of the dense materials table. */
struct rb_pair_material {
	double friction, restitution; /* coefficients, dimensionless */
};

struct rb_parts_table;
struct rb_elements;
struct rb_joints;
struct rb_top_body;

struct rb_model {
	const struct rb_scene *scene; /* borrowed: must outlive the model */
	rb_features features;

	int body_count, static_count; /* moving (driven ones too), never moving */
	int *id_of;                   /* [body_count + static_count] */
	int *index_of;                /* [scene->body_count] */

	/* columns by index */
	struct rb_shape *shape;
	double *reach;                /* m, see rb_model_reach; NULL: only spheres and planes */
	struct rb_parts_table *parts; /* owned, model/parts; NULL: only spheres and planes */
	int *material;
	double *mass, *inverse_mass; /* statics and driven bodies: INFINITY, 0 */
	unsigned char *driven; /* [body_count]: 1 where `motion` drives it; NULL without any */
	/*
	 * object axes, about the centre of mass; NULL without rotation: those of body i are at
	 * inertia_of[i], where bodies alike share them; rb_model_inertia
	 */
	rb_mat3 *inertia, *inverse_inertia;
	struct rb_top_body *top; /* likewise, of each tensor (math/top); rb_model_top */
	int *inertia_of, inertia_count;
	/* where the tensor is a multiple of 1, else NAN; NULL without rotation */
	double *inverse_inertia_scalar;
	rb_vec3 *center_of_mass;        /* object coordinates; NULL: all at the origin */
	uint64_t *group_bit, *collides; /* NULL without filters */
	rb_vec3 *position;              /* initial: of the object's origin; for good: statics */
	rb_quat *orientation;

	/*
	 * m^3/s^2, [body_count + static_count]: G times what it attracts others by; NULL without
	 * gravitation. Bodies that attract are counted in all, and those that do not yield.
	 */
	double *attraction;
	int attractor_count, center_count; /* bodies that attract; of them static and driven ones */
	/* every free body attracts by its mass: forces are opposite */
	bool attracts_by_mass;
	double softening2_m2; /* square of the softening */

	struct rb_elements *elements; /* owned, model/element: by kind, those that the scene has */
	int element_list_count;

	struct rb_joints *joints; /* owned, model/joints; NULL: none */

	int material_count;                      /* of the scene */
	struct rb_pair_material *pair_materials; /* [material_count][material_count] */

	double duration_s, frame_rate, time_step_s; /* s, 1/s, s */
	double tolerance_m;                         /* m, largest overlap of a frame */
	double stepped_tolerance_m;                 /* m, the same of frames that were stepped */
	double size_min_m;       /* smallest radius or half-edge of a moving body */
	double size_mean_m;      /* geometric mean of these over moving bodies */
	double coordinate_max_m; /* largest |coordinate| or size at the start */
	enum rb_rollback_kind rollback;
	enum rb_method_kind method; /* as asked for */
	uint64_t frame_count;       /* frame 0 included */
	bool keeps_ledger;          /* as asked for, or because it costs next to nothing here */
	size_t bytes;               /* that the columns take */
};

/*
 * Checks what can only be known from the whole scene (mass, overlaps at the start, tolerance,
 * duration), derives the constants and seals them. Mistakes are of the scene: RB_ERR_SCENE, each
 * added to `mistakes` (may be NULL) as one line, the first one in `err` too.
 */
struct rb_mistakes;
RB_CHECKED enum rb_status rb_model_create(struct rb_model **model, const struct rb_scene *scene,
                                          struct rb_mistakes *mistakes, struct rb_error *err);
void rb_model_destroy(struct rb_model *model); /* NULL is fine */

/* m: no point of a body is farther from its object's origin; 0 for planes and rectangles. */
static inline double rb_model_reach(const struct rb_model *model, int index)
{
	return model->reach ? model->reach[index] : model->shape[index].radius;
}

/* kg m^2, and its inverse, of a scene in which something can rotate. */
static inline const rb_mat3 *rb_model_inertia(const struct rb_model *model, int index)
{
	return &model->inertia[model->inertia_of[index]];
}

static inline const rb_mat3 *rb_model_inverse_inertia(const struct rb_model *model, int index)
{
	return &model->inverse_inertia[model->inertia_of[index]];
}

/* Principal axes and moments of a free body; of others they mean nothing. */
const struct rb_top_body *rb_model_top(const struct rb_model *model, int index);

/* Time of frame k: k / frame_rate, the last one at the duration. */
double rb_model_frame_time(const struct rb_model *model, uint64_t k);
/* The method's name for summary and recording. */
const char *rb_model_method(const struct rb_model *model);
const char *rb_method_name(enum rb_method_kind kind);
const char *rb_rollback_name(enum rb_rollback_kind kind);

/*
 * Every mistake of a scene that can be found in one pass. `file:line: call 'name': what` each;
 * bounded: after 50 it only counts.
 */
enum { RB_MISTAKES_MAX = 50 };
struct rb_mistakes {
	int count;                   /* all of them */
	char *line[RB_MISTAKES_MAX]; /* owned */
};
void rb_mistakes_add(struct rb_mistakes *mistakes, const char *format, ...) RB_PRINTF(2, 3);
void rb_mistakes_release(struct rb_mistakes *mistakes);

#ifdef __cplusplus
}
#endif
#endif
