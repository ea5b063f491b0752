/* SPDX-License-Identifier: MIT */
/*
 * What the author of a scene asked for: plain data, no Lua in it and no derived number.
 *
 * Owner: whoever made it (`script/load`, or a test by hand). Single thread until sealed into a
 * model; after that it is read only and may be read by every thread. All arrays and texts live in
 * memory that the scene owns and frees in rb_scene_release. "Not given" is NAN for a number, NULL
 * for a text, -1 for an index.
 */
#ifndef RBSIM_SCENE_H
#define RBSIM_SCENE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <rbsim/error.h>
#include <rbsim/math.h>

#ifdef __cplusplus
extern "C" {
#endif

enum rb_shape_kind {
	RB_SHAPE_SPHERE,
	RB_SHAPE_PLANE,
	RB_SHAPE_RECTANGLE,
	RB_SHAPE_BOX,
	RB_SHAPE_CAPSULE,
	RB_SHAPE_CYLINDER,
	RB_SHAPE_HULL,
	RB_SHAPE_UNION,
	RB_SHAPE_TERRAIN,
	RB_SHAPE_KIND_COUNT
};

/*
 * Whether bodies of that kind touch others by their convex parts, as all do but spheres, planes and
 * rectangles: contacts of these with each other have closed forms.
 */
static inline bool rb_shape_has_parts(enum rb_shape_kind kind)
{
	return kind > RB_SHAPE_RECTANGLE;
}

/*
 * A shape in object coordinates. The centroid is the origin of the object, except of hulls and
 * unions, whose points and parts are where the author put them.
 *   sphere     radius
 *   plane      infinite half-space, solid where local z < 0
 *   rectangle  finite plane in local z = 0, two-sided, without thickness: |x| <= size[0]/2, |y| <=
 *              size[1]/2
 *   box        size: whole lengths of its edges along local x, y, z
 *   capsule    radius about a segment of length size[2] along local z
 *   cylinder   radius, and size[2] its height along local z
 *   hull       the convex hull of points: solids[solid]
 *   terrain    triangles beside each other, static, two-sided, without thickness: solids[solid]
 *   union      several of the above but planes, rectangles, terrains, joined: solids[solid]
 */
struct rb_shape {
	enum rb_shape_kind kind; /* which of the numbers below it reads */
	int solid;               /* in scene.solids, of hulls, unions, terrains */
	double radius;           /* m */
	double size[3];          /* m */
};

/*
 * A part of a union: a shape that is no union itself, and where it is in the union's object
 * coordinates.
 */
struct rb_solid_part {
	struct rb_shape shape;
	rb_vec3 position; /* m */
	rb_quat orientation;
	double share; /* its density relative to that of the body */
};

/*
 * What a hull or a union is made of, in object coordinates, and what follows from it alone. Of a
 * hull: corners in the order of the points that the author gave, faces as loops of corners,
 * counter-clockwise seen from outside, each from its smallest number on, edges as pairs of corners.
 * Of a union: parts. Immutable; several bodies may share one.
 */
struct rb_solid {
	const rb_vec3 *vertices; /* m, [vertex_count] */
	const int *
		/* corners of face k: loops[face_first[k]] to before loops[face_first[k + 1]] */
		loops;
	const int *face_first; /* [face_count + 1] */
	const int (*edges)[2]; /* [edge_count], the smaller corner first, ascending */
	int vertex_count, face_count, edge_count;
	const struct rb_solid_part *parts; /* [part_count]: of a union */
	int part_count;                    /* 0: a hull */

	/* m^3; of a union the sum of its parts: where they overlap it counts twice */
	double volume;
	double weight;    /* m^3: the same, each part times its share */
	rb_vec3 centroid; /* m, of the mass */
	rb_mat3 inertia;  /* m^2: kg m^2 for each kg, about the centroid, object axes */
	double reach;     /* m: no point is farther from the object's origin */
	/* m: half of its smallest extent along a principal axis; of a union, of a part */
	double half_width;
	char sha256[65]; /* of the points that a hull was made of */
};

struct rb_material_def {
	const char *name;    /* NULL: none */
	double density;      /* kg/m^3 */
	double friction;     /* 1 */
	double restitution;  /* 1, in [0, 1] */
	double color[3];     /* sRGB in [0, 1]; color[0] is NAN when not given */
	const char *texture; /* NULL: none */
	double shininess;    /* NAN: not given */
};

/* An entry of the materials table; NAN where the pair leaves a key out. */
struct rb_contact_pair_def {
	int material_a, material_b; /* indices into materials */
	double friction, restitution;
};

enum rb_force_frame { RB_FORCE_WORLD, RB_FORCE_BODY };

struct rb_force_def {
	rb_vec3 vector;             /* N */
	rb_vec3 torque;             /* N m, beside that of the vector at the point */
	rb_vec3 point;              /* m, object coordinates; x is NAN: the centre of mass */
	double start_s, duration_s; /* duration may be INFINITY: to the end */
	enum rb_force_frame frame;
};

/* From its start on, up to but without its end. */
static inline bool rb_force_acts(const struct rb_force_def *force, double time_s)
{
	return time_s >= force->start_s && time_s < force->start_s + force->duration_s;
}

/* Between points of two bodies; pulls when longer than its rest length, damping along its line. */
struct rb_spring_def {
	int a, b;             /* ids */
	rb_vec3 at_a, at_b;   /* m, object coordinates; x is NAN: the centre of mass */
	double stiffness;     /* N/m, >= 0 */
	double damping;       /* N s/m, >= 0 */
	double rest_length_m; /* NAN: as long as it is at the start */
	bool visible;         /* drawn where one of its bodies is */
	double radius_m;      /* of its coil; NAN: from the sizes of its bodies */
	double color[3];      /* color[0] NAN: dark grey */
	int line;
};

/* -(linear + quadratic |v|) v on every moving body, at its centre of mass. */
struct rb_drag_def {
	double linear;    /* N s/m, >= 0 */
	double quadratic; /* N s^2/m^2, >= 0 */
	int line;
};

/*
 * A force from a function of time, position and velocity of the centre of mass, on every moving
 * body.
 */
struct rb_field_def {
	int function; /* the script's number of it */
	bool has_potential;
	int potential; /* ... of that of time, position and body of which it is the gradient, J */
	/* these have a parameter for the body */
	bool asks_body, potential_asks_body;
	int line;
};

/* Joints, in the order of their names: a row in joint/ each (model/joint_type). */
enum rb_joint_kind {
	RB_JOINT_FIXED,
	RB_JOINT_BALL,
	RB_JOINT_HINGE,
	RB_JOINT_SLIDER,
	RB_JOINT_CYLINDRICAL,
	RB_JOINT_UNIVERSAL,
	RB_JOINT_ROD,
	RB_JOINT_ROPE,
	RB_JOINT_KIND_COUNT
};
#define RB_JOINT_KIND_NAMES "fixed, ball, hinge, slider, cylindrical, universal, rod, rope"

/*
 * What holds two bodies together. Its free coordinate is the angle of a hinge, rad, counter-
 * clockwise of b against a about the axis, turns counted; or the way of a slider or cylindrical
 * joint, m, of b's point against a's along the axis. It is 0 at the start. Limits, motor, friction,
 * stiffness and damping are of it; torques, N m, of hinges are forces, N, of the others.
 */
struct rb_joint_def {
	const char *name; /* NULL: none */
	int kind;         /* enum rb_joint_kind */
	int a, b;         /* ids; b -1: the world */
	/*
	 * The point: `at`, m, world coordinates at the start, or `at_a`, `at_b`, m, object
	 * coordinates, those of the world if b is the world. x is NAN: not given.
	 */
	rb_vec3 at, at_a, at_b;
	/* of any length, world axes at the start; x is NAN: not given */
	rb_vec3 axis, axis_b;
	double length_m;  /* of lines; NAN: the distance at the start */
	double limits[2]; /* low, high; each NAN: none */
	double restitution, friction;
	double motor_speed; /* rad/s or m/s; NAN: no motor, or one that follows */
	int motor_function; /* the script's number of its function of time, -1: none */
	double motor_max;   /* N m or N, >= 0: the most that the motor exerts */
	double stiffness, damping;
	double rest;   /* rad or m: where its spring exerts nothing */
	bool collides; /* a and b touch each other */
	bool visible;
	double radius_m; /* of what is drawn; NAN: chosen */
	double color[3]; /* sRGB in [0, 1]; color[0] is NAN: chosen */
	int line;
};

static inline bool rb_joint_has_motor(const struct rb_joint_def *joint)
{
	return joint->motor_speed == joint->motor_speed || joint->motor_function >= 0;
}

struct rb_body_def {
	const char *name;    /* NULL: none */
	const char *call;    /* the scene's word for it: "sphere", "plane" */
	const char *texture; /* NULL: none */
	int line;            /* of the call in the scene's source, 0: unknown */
	int material;        /* place among the scene's */

	struct rb_shape shape;
	double mass, density; /* kg, kg/m^3; NAN: from the material */
	/*
	 * m, object coordinates; default: the origin, which is the centroid but of hulls and
	 * unions: whoever makes one of those puts the centroid of the solid here
	 */
	rb_vec3 center_of_mass;
	/* kg m^2, object axes, about the centre of mass; NULL: that of the shape */
	const rb_mat3 *inertia;
	/* mass, centre and inertia came of so many particles; 0: none were given */
	size_t particle_count;

	rb_vec3 position;         /* m, of the object's origin */
	rb_quat orientation;      /* a unit quaternion */
	rb_vec3 velocity;         /* m/s, of the centre of mass */
	rb_vec3 angular_velocity; /* rad/s, world axes */
	/* kg: what it attracts others by; NAN: its mass, of static and driven bodies 0 */
	double gravitational_mass;
	double color[3];        /* color[0] is NAN: the palette's */
	uint64_t collides_with; /* bit k: groups[k] */
	int group;              /* index into groups, -1: none */

	int force_first, force_count; /* in scene.forces */
	/*
	 * A driven body is not static, and has none of what pushes would need: mass, inertia,
	 * forces. Its pose and velocities here are those at time 0; `orientation` holds for good
	 * where it does not turn.
	 */
	int motion;        /* the script's number of the function that drives it, -1: none */
	bool motion_turns; /* it returns an orientation */
	bool motion_gives_velocity; /* it returned one at time 0; else they are differenced */
	bool motion_gives_angular_velocity;
	bool is_static;
	bool filters; /* collides_with was given */
	bool visible;
};

static inline bool rb_body_is_driven(const struct rb_body_def *body)
{
	return body->motion >= 0;
}

/* Impacts and forces move it. */
static inline bool rb_body_is_free(const struct rb_body_def *body)
{
	return !body->is_static && !rb_body_is_driven(body);
}

/* Where a camera's vector comes from. Functions are kept by the script under `function`. */
enum rb_camera_source { RB_CAMERA_FIXED, RB_CAMERA_BODY, RB_CAMERA_FUNCTION };
struct rb_camera_vector {
	enum rb_camera_source source; /* which of the fields below holds it */
	rb_vec3 value;                /* m, or a direction: of one that is a constant */
	int body;                     /* id of a body, for RB_CAMERA_BODY */
	int function; /* the script's number of a function, for RB_CAMERA_FUNCTION */
};

enum {
	RB_CAMERA_LIGHTS_MAX = 8,
	RB_CAMERA_TRAILS_MAX = 64,
	RB_CAMERA_LABELS_MAX = 64,
	RB_CAMERA_TEXTS_MAX = 8,
	RB_CAMERA_TEXT_SIZE = 160 /* bytes of a text that a function returns, with its zero */
};
enum {
	RB_OVERLAY_TIME = 1u << 0,
	RB_OVERLAY_TITLE = 1u << 1,
	RB_OVERLAY_ENERGY = 1u << 2,
	RB_OVERLAY_SCALE = 1u << 3
};
/* Kinds of arrows, in the order of their names. */
enum {
	RB_ARROWS_VELOCITY,
	RB_ARROWS_CONTACT,
	RB_ARROWS_JOINT,
	RB_ARROWS_SPRING,
	RB_ARROWS_ANGULAR_VELOCITY,
	RB_ARROWS_ACCELERATION,
	RB_ARROWS_MOMENTUM,
	RB_ARROWS_FORCE,
	RB_VECTORS_COUNT
};
enum {
	RB_VECTORS_VELOCITY = 1u << RB_ARROWS_VELOCITY,
	RB_VECTORS_CONTACT = 1u << RB_ARROWS_CONTACT,
	RB_VECTORS_JOINT = 1u << RB_ARROWS_JOINT,
	RB_VECTORS_SPRING = 1u << RB_ARROWS_SPRING,
	RB_VECTORS_ANGULAR_VELOCITY = 1u << RB_ARROWS_ANGULAR_VELOCITY,
	RB_VECTORS_ACCELERATION = 1u << RB_ARROWS_ACCELERATION,
	RB_VECTORS_MOMENTUM = 1u << RB_ARROWS_MOMENTUM,
	RB_VECTORS_FORCE = 1u << RB_ARROWS_FORCE
};

/* How arrows of one kind are drawn; all zeros: as usual. */
struct rb_arrows_def {
	double scale;                     /* m of arrow per SI unit; 0: from the scene */
	int bodies[RB_CAMERA_TRAILS_MAX]; /* ids */
	int body_count;                   /* 0: of all bodies */
};

enum rb_light_kind { RB_LIGHT_LAMP, RB_LIGHT_SUN, RB_LIGHT_SPOT, RB_LIGHT_AMBIENT };

struct rb_light_def {
	enum rb_light_kind kind; /* how light falls off and where it comes from */
	rb_vec3 position;        /* m; of a sun the direction towards it */
	rb_vec3 look_at;         /* m: where the axis of a spot's cone goes */
	double angle;            /* rad: of a spot, from the axis of its cone to its edge */
	double softness;         /* of `angle`, over which a spot's light fades out */
	double color[3], intensity;
};

/* A text that goes with a body. */
struct rb_label_def {
	int body;         /* its id */
	const char *text; /* NULL: its name */
};

/* A text over the picture. */
struct rb_caption_def {
	const char *text; /* NULL: `function` returns it */
	int function;     /* the script's number of a function of time */
	/*
	 * shares of the picture's width and height, from its lower left corner: there the same
	 * shares of the text lie; at[0] NAN: a line at the upper left corner
	 */
	double at[2];
	double size; /* of the letters, as a share of the picture's height; NAN: the usual */
};

/* A diagram of a quantity against time. */
enum rb_plot_of { RB_PLOT_PROBE, RB_PLOT_WORLD, RB_PLOT_BODY, RB_PLOT_JOINT };
enum { RB_CAMERA_PLOTS_MAX = 4 };
struct rb_plot_def {
	const char *name;
	enum rb_plot_of of;
	int subject; /* a probe's or joint's place in the scene, a body's id */
	int part;    /* flow/quantity: of the world, the body or the joint */
	/*
	 * shares of the picture's width and height; the same shares of the diagram lie at `at`;
	 * at[0], size[0] NAN: as usual
	 */
	double at[2], size[2];
};

/* What a camera's texts tell a quantity in. */
struct rb_unit_def {
	const char *name; /* NULL: chosen by the largest value */
	double size;      /* in the scene's units: SI, or whatever it takes for them */
};

/* A film or pictures of the run: what is drawn how, from where, when and to which files. */
struct rb_camera_def {
	const char *name;
	const char *file; /* where its line is; NULL: in the scene's own file */
	int line;
	struct rb_camera_vector position, look_at, up; /* m, m, a direction */
	/* no position is given: it stands where it sees all that moves (flow/framing) */
	bool framed;
	bool aimed; /* look_at is given */
	int mount;  /* id of a body, -1: none */
	rb_vec3 offset;
	bool level; /* the horizon stays horizontal */
	double fov; /* rad, vertical */
	bool orthographic;
	double height; /* m, of an orthographic picture; NAN: as much as `framed` asks for */
	bool has_frustum;
	double frustum[6]; /* left, right, bottom, top, near, far */
	double near, far;  /* m; NAN: chosen from the scene */
	int size_px[2];
	double fps, speed, from_s, to_s; /* fps NAN: the frame rate; to_s INFINITY: the end */
	bool single;                     /* one picture of a film of the following span is made */
	double film_from_s, film_to_s;
	bool speed_varies; /* the speed is that of a function, `speed` is 1 */
	int speed_function;
	/* of such a film that is made: the times of its pictures, borrowed from who makes it */
	const double *picture_s;
	uint64_t picture_count;
	double background[3]; /* background[0] NAN: the sky */
	struct rb_light_def lights[RB_CAMERA_LIGHTS_MAX];
	int light_count; /* -1: the default lights */
	bool shadows;
	int samples;                                   /* of each pixel */
	unsigned overlay, vectors;                     /* RB_OVERLAY_*, RB_VECTORS_* */
	struct rb_unit_def length_unit, time_unit;     /* of its texts */
	int trails[RB_CAMERA_TRAILS_MAX], trail_count; /* ids of bodies */
	struct rb_arrows_def arrows[RB_VECTORS_COUNT];
	struct rb_label_def labels[RB_CAMERA_LABELS_MAX];
	struct rb_caption_def texts[RB_CAMERA_TEXTS_MAX];
	struct rb_plot_def plots[RB_CAMERA_PLOTS_MAX];
	int label_count, text_count, plot_count;
	bool wireframe;
	const char *png, *video; /* output patterns, NULL: none */
};

/* Pictures of several cameras in one. */
enum { RB_FILM_CELLS_MAX = 16 };
struct rb_film_def {
	struct rb_camera_def camera; /* name, size, times and outputs; the rest does not count */
	int row_count, columns[RB_FILM_CELLS_MAX]; /* of each row, from above */
	/* places in the scene's list of cameras, row by row */
	int cells[RB_FILM_CELLS_MAX], cell_count;
};

enum {
	RB_FIELD_POSITION = 1u << 0,
	RB_FIELD_ORIENTATION = 1u << 1,
	RB_FIELD_VELOCITY = 1u << 2,
	RB_FIELD_ANGULAR_VELOCITY = 1u << 3,
	RB_FIELD_CONTACTS = 1u << 4,
	RB_FIELD_EVENTS = 1u << 5,
	RB_FIELD_ACCELERATION = 1u << 6,
	RB_FIELD_ANGULAR_ACCELERATION = 1u << 7,
	RB_FIELD_FORCE = 1u << 8,
	RB_FIELD_TORQUE = 1u << 9,
	RB_FIELD_JOINTS = 1u << 10,
	RB_FIELD_SURFACES = 1u << 11, /* of bodies, for VTK: made of the others at the end */
	RB_FIELD_SURFACES_NEED = RB_FIELD_POSITION | RB_FIELD_ORIENTATION,
	RB_FIELD_LOADS = RB_FIELD_ACCELERATION | RB_FIELD_ANGULAR_ACCELERATION | RB_FIELD_FORCE |
	                 RB_FIELD_TORQUE,
	RB_FIELD_DEFAULT = RB_FIELD_POSITION | RB_FIELD_ORIENTATION | RB_FIELD_VELOCITY |
	                   RB_FIELD_ANGULAR_VELOCITY
};

struct rb_record_def {
	const char *file;  /* NULL: from the scene's name */
	int every;         /* record every n-th frame */
	unsigned fields;   /* RB_FIELD_* */
	bool fields_given; /* these and no others */
	bool single_precision;
	int compression;           /* 0 to 9 */
	bool ledger, ledger_given; /* not given: where there are few bodies */
};

enum rb_rollback_kind { RB_ROLLBACK_SELECTIVE, RB_ROLLBACK_GLOBAL, RB_ROLLBACK_NONE };
/* In the order of their names, by which scenes and --method choose; rows: model/descriptor. */
enum rb_method_kind {
	RB_METHOD_AUTO,
	RB_METHOD_CLASSIC,
	RB_METHOD_LOCATED,
	RB_METHOD_STEPPED,
	RB_METHOD_KIND_COUNT
};
#define RB_METHOD_NAMES "auto, classic, located, stepped"

/*
 * Mutual gravitation: a body with gravitational mass g at distance r accelerates all others by
 * constant g r / (r^2 + softening^2)^(3/2) towards its centre of mass (Plummer, MNRAS 71 (1911)
 * 460).
 */
struct rb_gravitation_def {
	bool given;           /* the scene states it */
	double constant;      /* m^3/(kg s^2), G */
	double softening_m;   /* >= 0 */
	double opening_angle; /* in [0, 1]: of the tree of steps */
};

struct rb_world_def {
	const char *title, *description; /* "" when not given */
	double duration_s;               /* NAN: not given, `steps` tells it */
	int steps;                       /* the duration in time steps; 0: not given */
	double frame_rate;               /* 1/s */
	double time_step_s;              /* NAN: 1/(4 frame_rate) */
	double tolerance_m;              /* NAN: the rule of rbsim-scene(5) */
	double stepped_tolerance_m;      /* of frames by steps; NAN: the same, or the rule */
	rb_vec3 gravity;                 /* m/s^2 */
	rb_vec3 gravity_force;           /* N, on every moving body */
	struct rb_gravitation_def gravitation;
	enum rb_rollback_kind rollback; /* which bodies go back in time together */
	enum rb_method_kind method;     /* how motion is computed */
	uint64_t seed;                  /* of the scene's random numbers */
	bool pause_on_collision;        /* the player waits there */
	int line;                       /* of the call in the scene's source, 0: unknown */
};

/* Seconds, from `steps` where no duration stands; NAN: neither was given. */
double rb_world_duration(const struct rb_world_def *world);
/* s: of the scene, or the default. */
double rb_world_time_step(const struct rb_world_def *world);

enum rb_param_type { RB_PARAM_NUMBER, RB_PARAM_INTEGER, RB_PARAM_BOOLEAN, RB_PARAM_TEXT };

struct rb_param_def {
	const char *name, *help;               /* as on the command line */
	enum rb_param_type type;               /* which of the values below counts */
	const char *default_text, *value_text; /* as a Lua literal without quotes */
	double value;                          /* for numbers, integers and booleans */
	double min, max;                       /* NAN: none */
	const char *choices;                   /* "a, b, c", NULL: any */
};

struct rb_expect_def {
	const char *text; /* what is expected, for messages */
	int line;
	bool always;  /* checked at every frame */
	int function; /* the script's number of it */
};

/* A number of the scene's own: of the end of a run (`result`), or of every frame (`probe`). */
struct rb_measure_def {
	const char *name;  /* unique among the results, or among the probes */
	const char *units; /* "" of a pure number */
	const char *description;
	int line;
	int function; /* the script's number of it */
};
enum { RB_MEASURES_MAX = 256, RB_MEASURE_NAME_MAX = 63, RB_MEASURE_UNITS_MAX = 31 };

/* A file that the scene is made of: the scene itself first, then all that it required. */
struct rb_source_file {
	const char
		*name; /* as required, e.g. "rbsim.lattice"; the scene's base name for the first */
	const char *text;
	size_t size_bytes; /* of `text` */
	char sha256[65];   /* of the text: lower-case digits and a zero */
};

/* Which callbacks a scene has. */
enum {
	RB_HOOK_STEP = 1u << 0,
	RB_HOOK_FRAME = 1u << 1,
	RB_HOOK_COLLISION = 1u << 2,
	RB_HOOK_EXPECT_ALWAYS = 1u << 3,
	RB_HOOK_TRANSITION = 1u << 4
};

/*
 * Force elements of one kind, in the order of the scene: `count` rows of the kind's own type
 * (model/element).
 */
enum { RB_ELEMENT_KINDS_MAX = 16 };
struct rb_element_list {
	void *rows; /* owned: [count] of the kind's type */
	int count;
	size_t capacity; /* rows that it has place for */
};

struct rb_scene {
	const char *file; /* as named on the command line, for messages; "" when made by hand */
	struct rb_world_def world;

	struct rb_material_def *materials; /* [0] is the plain default */
	int material_count;
	struct rb_contact_pair_def *contact_pairs;
	int contact_pair_count;
	struct rb_body_def *bodies; /* in the order of the scene: the index is the body's id */
	int body_count;
	struct rb_solid *solids; /* what hulls and unions are made of */
	int solid_count;
	struct rb_force_def *forces;
	int force_count;
	struct rb_element_list elements[RB_ELEMENT_KINDS_MAX]; /* springs, drag, ...: by kind */
	struct rb_field_def *fields;
	int field_count;
	struct rb_joint_def *joints;
	int joint_count;
	const char **groups; /* names of collision groups, 63 at most */
	int group_count;
	struct rb_camera_def *cameras;
	int camera_count;
	struct rb_film_def *films;
	int film_count;
	struct rb_record_def record;
	struct rb_param_def *params;
	int param_count;
	struct rb_expect_def *expects;
	int expect_count;
	struct rb_measure_def *results, *probes;
	int result_count, probe_count; /* each RB_MEASURES_MAX at most */
	struct rb_source_file *files;
	int file_count;
	unsigned hooks;     /* RB_HOOK_* */
	int expect_refused; /* exit status that the scene expects to be refused with, 0: none */
	const char *expect_refused_pattern;

	struct rb_scene_memory *memory; /* owned */
};

/* A scene with the defaults of rbsim-scene(5) and the default material. Fails on memory only. */
RB_CHECKED enum rb_status rb_scene_init(struct rb_scene *scene, struct rb_error *err);

/* Safe on a zeroed scene and on one already released. */
void rb_scene_release(struct rb_scene *scene);

/* Defaults of each definition, to be changed and then added. */
struct rb_body_def rb_body_def_default(void);
struct rb_material_def rb_material_def_default(void);
struct rb_force_def rb_force_def_default(void);
struct rb_spring_def rb_spring_def_default(void);
struct rb_joint_def rb_joint_def_default(void);
struct rb_camera_def rb_camera_def_default(void);

/*
 * Append a copy; texts are copied too. `*index` (may be NULL) receives its place. Fail on memory
 * only.
 */
RB_CHECKED enum rb_status rb_scene_add_material(struct rb_scene *scene,
                                                const struct rb_material_def *def, int *index,
                                                struct rb_error *err);
RB_CHECKED enum rb_status rb_scene_add_contact_pair(struct rb_scene *scene,
                                                    const struct rb_contact_pair_def *def,
                                                    struct rb_error *err);
RB_CHECKED enum rb_status rb_scene_add_body(struct rb_scene *scene, const struct rb_body_def *def,
                                            int *index, struct rb_error *err);
/*
 * The convex hull of points, measured; points that were given before get the solid of then.
 * RB_ERR_SCENE where they have no hull: fewer than 4, more than RB_HULL_POINTS_MAX, not finite, or
 * all in a plane to the rounding of their coordinates. Corners that are coplanar to that rounding
 * share a face.
 */
enum { RB_HULL_POINTS_MAX = 65536, RB_UNION_PARTS_MAX = 65536 };
RB_CHECKED enum rb_status rb_scene_add_hull(struct rb_scene *scene, const rb_vec3 *points,
                                            size_t count, int *solid, struct rb_error *err);
/* A union of parts whose shapes were checked; RB_ERR_SCENE where one cannot be a part. */
RB_CHECKED enum rb_status rb_scene_add_union(struct rb_scene *scene,
                                             const struct rb_solid_part *parts, size_t count,
                                             int *solid, struct rb_error *err);
/*
 * A terrain of triangles, three numbers of vertices each; those without area are left out.
 * RB_ERR_SCENE: a vertex is not finite, a number is none of a vertex, or there are no triangles, or
 * more than RB_TERRAIN_MAX.
 */
enum { RB_TERRAIN_MAX = 65536 };
struct rb_terrain_def {
	const rb_vec3 *vertices; /* m, [vertex_count] */
	const int (*corners)[3]; /* [count] */
	size_t vertex_count, count;
};
RB_CHECKED enum rb_status rb_scene_add_terrain(struct rb_scene *scene,
                                               const struct rb_terrain_def *def, int *solid,
                                               struct rb_error *err);
/* A copy of a solid that is complete. */
RB_CHECKED enum rb_status rb_scene_add_solid(struct rb_scene *scene, const struct rb_solid *def,
                                             int *solid, struct rb_error *err);
/* To the body added last. */
RB_CHECKED enum rb_status rb_scene_add_force(struct rb_scene *scene, const struct rb_force_def *def,
                                             struct rb_error *err);
RB_CHECKED enum rb_status rb_scene_add_spring(struct rb_scene *scene,
                                              const struct rb_spring_def *def,
                                              struct rb_error *err);
RB_CHECKED enum rb_status rb_scene_add_drag(struct rb_scene *scene, const struct rb_drag_def *def,
                                            struct rb_error *err);
RB_CHECKED enum rb_status rb_scene_add_field(struct rb_scene *scene, const struct rb_field_def *def,
                                             struct rb_error *err);
RB_CHECKED enum rb_status rb_scene_add_joint(struct rb_scene *scene, const struct rb_joint_def *def,
                                             int *index, struct rb_error *err);
/* Index of the group of that name, added when new; RB_ERR_SCENE beyond 63. */
RB_CHECKED enum rb_status rb_scene_group(struct rb_scene *scene, const char *name, int *index,
                                         struct rb_error *err);
RB_CHECKED enum rb_status rb_scene_add_camera(struct rb_scene *scene,
                                              const struct rb_camera_def *def,
                                              struct rb_error *err);
RB_CHECKED enum rb_status rb_scene_add_film(struct rb_scene *scene, const struct rb_film_def *def,
                                            struct rb_error *err);
RB_CHECKED enum rb_status rb_scene_add_param(struct rb_scene *scene, const struct rb_param_def *def,
                                             struct rb_error *err);
RB_CHECKED enum rb_status rb_scene_add_expect(struct rb_scene *scene,
                                              const struct rb_expect_def *def,
                                              struct rb_error *err);
RB_CHECKED enum rb_status rb_scene_add_measure(struct rb_scene *scene, bool probe,
                                               const struct rb_measure_def *def,
                                               struct rb_error *err);
RB_CHECKED enum rb_status rb_scene_add_file(struct rb_scene *scene, const char *name,
                                            const char *text, size_t size_bytes, const char *sha256,
                                            struct rb_error *err);
/* A copy of a text that lives as long as the scene; NULL when memory is out. */
const char *rb_scene_text(struct rb_scene *scene, const char *text);

/* "sphere", "plane", ...: what recordings and messages call a kind of shape. */
const char *rb_shape_name(enum rb_shape_kind kind);

/* "hinge", ...: of enum rb_joint_kind. */
const char *rb_joint_kind_name(int kind);

/* Name of a body for messages: its name, or "#12" by id; written to `out`, which is returned. */
const char *rb_scene_body_label(const struct rb_scene *scene, int id, char out[64]);

/* "scene.lua:12: " to begin messages about a body with, "" if it has no line; written to `out`. */
const char *rb_scene_body_source(const struct rb_scene *scene, int id, char out[96]);

/*
 * How an infinite or finite plane's frame comes from its normal: local z is the normal, local x is
 * `axis` (NAN: the world's x, else y) projected on the plane. Neither needs unit length; both must
 * be finite, `normal` not zero. (scene language, "plane")
 */
rb_quat rb_plane_orientation(rb_vec3 normal, rb_vec3 axis);

#ifdef __cplusplus
}
#endif
#endif
