/* SPDX-License-Identifier: MIT */
/*
 * The located method: events found at their own times, to rounding; and its state.
 *
 * Equations. In flight m a = F, I dw/dt + w x I w = T, in closed form where F is constant and T is
 * zero (parabola, math/top). Lasting contacts add forces f with, for each of them in the mode that
 * it has, relative acceleration
 *
 *     stick, roll   J a + b = 0                 three equations for three forces
 *     slide         n.(J a + b) = 0, f_t = -mu f_n u_t / |u_t|
 *     open          f = 0
 *
 * integrated by Gauss collocation with error control (math/gauss); impacts have the law of
 * constraint/simultaneous.
 *
 * An *arc* is the motion of a body from its anchor on: a parabola of the centre of mass, or its
 * counterpart with linear drag (math/decay), and a rotation (math/top); or, while forces without a
 * closed form act on it, a polynomial piece of its cluster's integrator. Anchors change only at
 * events of that body, so the motion does not depend on when frames or steps evaluate it. Bodies
 * joined by lasting contacts or springs form a *cluster* with one clock.
 *
 * What happens at an event:
 *
 *     queue: the earliest event of any body                           (queue)
 *        |
 *        +-- wall of a cell, end of a piece ---------------------+
 *        +-- touch whose partner is on a new arc: predict anew --+    (predict)
 *        +-- touch                                               |
 *              |  the bodies involved, and all that they touch   |    (event_set)
 *            approach beyond rounding? --yes--> resolve impact   |    (resolve_impact)
 *              |no                                |              |
 *            which contacts last, with what forces? <-+          |    (resolve_contacts)
 *              |                                                 |
 *            constant forces? --yes--> parabola, next transition by formula
 *              |no                                               |
 *            one piece by collocation, cut where a mode ends <---+    (integrate, mode_checks)
 *              |    slip stops, cone left, pull, rim passed, another point touches
 *            new arcs, then the next event of each body               (predict, approach)
 *
 * Too many events or too much arithmetic in a time step: the state goes to steps (method/method).
 *
 * Constants are defined at the top of the file that uses them: error bounds in integrate.c (closed
 * forms of `rbsim verify`), tolerances of contact in ulp in contact_point.c and pair_contacts.c,
 * rounds of impacts in resolve_impact.c, the crowd from which steps are taken in crowd.c (gas and
 * heap of `tests/bench`).
 *
 * Owned by the world; simulator's thread only.
 */
#ifndef RB_LOCATED_LOCATED_H
#define RB_LOCATED_LOCATED_H

#include "located/cells.h"
#include "located/queue.h"
#include "force/gravitation.h"
#include "math/gauss.h"
#include "math/top.h"
#include "model/joints.h"
#include "world/world.h"

#include <math.h>

/*
 * Motion of the centre of mass from the anchor on: x + v s + a s^2 / 2, or its counterpart with
 * linear drag. The first cache line holds all that is read of a neighbour under the same gravity;
 * with many bodies that is most of the memory traffic.
 */
#define RB_ARC_FIELDS(X)                                                                   \
	X(_Alignas(64) double, anchor_s, , "s", "time of the anchor", RB_FINITE)           \
	X(rb_vec3, position, , "m", "at the anchor", RB_FINITE)                            \
	X(rb_vec3, velocity, , "m/s", "at the anchor", RB_FINITE)                          \
	X(double, plain_radius, , "m",                                                     \
	  "radius of a centred sphere under the world's gravity alone, or NAN", RB_NUMBER) \
	X(rb_vec3, acceleration, , "m/s^2", "due to constant forces", RB_FINITE)           \
	X(double, decay, , "1/s", "rate of linear drag (math/decay), >= 0", RB_FINITE)
struct rb_arc {
	RB_ARC_FIELDS(RB_FIELD_MEMBER)
};
RB_FIELDS_DECLARE(rb_arc_fields);

/*
 * A body's share of a polynomial piece: rows from `first` on, valid from origin_s to until_s. If
 * nothing depends on the body's orientation, the piece keeps its initial value, and the orientation
 * follows from the spin (math/turn).
 */
#define RB_PIECE_FIELDS(X)                                                                    \
	X(struct rb_gauss_piece, piece, , "",                                                 \
	  "the cluster's arrays; n = 0: the arc is a parabola", RB_BY_HAND)                   \
	X(int, first, , "", "first row of the piece", RB_DERIVED)                             \
	X(rb_vec3, base, , "m", "origin of the position's rows: no digits are lost far away", \
	  RB_FINITE)                                                                          \
	X(rb_vec3, rest, , "m", "rounding remainder of a parabola's anchor: struct rb_pose",  \
	  RB_FINITE)                                                                          \
	X(double, origin_s, , "s", "beginning of the piece", RB_FINITE)                       \
	X(double, acceleration_max, , "m/s^2", "bound over the piece", RB_FINITE)             \
	X(double, until_s, , "s", "end of the piece", RB_TIME)
struct rb_piece_of {
	RB_PIECE_FIELDS(RB_FIELD_MEMBER)
};
RB_FIELDS_DECLARE(rb_piece_fields);

/* Next predicted events of a body; the earliest time is in the queue. */
#define RB_NEXT_FIELDS(X)                                                             \
	X(double, touch_s, , "s", "INFINITY: none", RB_TIME)                          \
	X(double, wall_s, , "s", "INFINITY: none", RB_TIME)                           \
	X(int, partner, , "", "body index, of the touch; -1: none",                   \
	  RB_NONE_UP_TO(RB_LIMIT_ANY_BODY))                                           \
	X(uint32_t, generation, , "", "the partner's at the prediction", RB_ANY_BITS) \
	X(int, wall, , "", "for rb_cells_cross; -1: none", RB_WITHIN(-1, INT_MAX))    \
	X(bool, unfinished, , "", "touch_s is no touch: the search continues then", RB_FLAG)
struct rb_next {
	RB_NEXT_FIELDS(RB_FIELD_MEMBER)
};
RB_FIELDS_DECLARE(rb_next_fields);

/* Mode of a lasting contact, in the order of rb_event_kind from REST on. */
enum rb_held_mode { RB_HELD_REST, RB_HELD_SLIDE, RB_HELD_ROLL };

/*
 * A lasting contact: one point of a pair, which may have several. Its name is (a, b, parts, key,
 * half): struct rb_contact_name. `half`: for a rim on a piece, the half circle on which the point
 * began.
 */
#define RB_HELD_FIELDS(X)                                                                       \
	X(uint64_t, key, , "", "in its name", RB_ANY_BITS)                                      \
	X(rb_vec3, half, , "1", "in its name", RB_FINITE)                                       \
	X(rb_vec3, slip, , "1", "unit: direction of b's point relative to a's", RB_FINITE)      \
	X(rb_vec3, common, , "1",                                                               \
	  "unit: common direction if all points of the pair creep in it; else 0", RB_FINITE)    \
	X(rb_vec3, force, , "N", "on b, at the cluster's anchor", RB_FINITE)                    \
	X(double, friction, , "1",                                                              \
	  "coefficient while it slips: the law's, or reduced where a body jams", RB_FINITE)     \
	X(double, recorded_s, , "s",                                                            \
	  "time to report it: after the last of its accumulated impacts", RB_TIME)              \
	X(int, a, , "", "body index", RB_UP_TO(RB_LIMIT_BODY))                                  \
	X(int, b, , "", "body index, > a", RB_UP_TO(RB_LIMIT_ANY_BODY))                         \
	X(uint32_t, parts, , "", "which parts of them touch", RB_ANY_BITS)                      \
	X(enum rb_held_mode, reported, , "", "mode of the last reported transition",            \
	  RB_WITHIN(RB_HELD_REST, RB_HELD_ROLL))                                                \
	X(bool, is_reported, , "", "it has been reported", RB_FLAG)                             \
	X(bool, merged, , "", "to be reported as a merge first", RB_FLAG)                       \
	X(bool, slipping, , "", "along `slip`", RB_FLAG)                                        \
	X(bool, on_rim, , "", "on the rim of a flat shape", RB_FLAG)                            \
	X(bool, ending, , "", "its slip ends now, or its rest, due to `force`", RB_FLAG)        \
	X(bool, straight, , "", "slip keeps its direction to the end, to rounding", RB_FLAG)    \
	X(bool, creeps, , "", "a slow slip whose direction follows from the balance of forces", \
	  RB_FLAG)
struct rb_held {
	RB_HELD_FIELDS(RB_FIELD_MEMBER)
};
RB_FIELDS_DECLARE(rb_held_fields);

/*
 * Power and forces of contacts at rest or sliding while bodies are on parabolas, torques about the
 * origin: polynomials in the time since the anchor; index 0: exerted by static bodies, 1: by driven
 * ones (which do not move).
 */
#define RB_ACCOUNT_RATES_FIELDS(X)                                        \
	X(double, sliding, [2], "W, W/s", "power of friction", RB_NUMBER) \
	X(rb_vec3, force, [2], "N", "by exerting body", RB_NUMBER)        \
	X(rb_vec3, torque, [2][3], "N m, N m/s, N m/s^2", "by exerting body", RB_NUMBER)
struct rb_account_rates {
	RB_ACCOUNT_RATES_FIELDS(RB_FIELD_MEMBER)
};
RB_FIELDS_DECLARE(rb_account_rates_fields);

#define RB_CLUSTER_FIELDS(X)                                                                      \
	X(double, anchor_s, , "s", "beginning of its present motion", RB_FINITE)                  \
	X(double, account_s, , "s", "entered into the ledger until then (located/account)",       \
	  RB_FINITE)                                                                              \
	X(double, least, , "1", "of struct rb_dense, at the beginning of the piece", RB_FINITE)   \
	X(double, try_s, , "s", "length of the next piece", RB_TIME)                              \
	X(uint64_t, crept, , "", "count of pieces too short to progress, less others",            \
	  RB_ANY_BITS)                                                                            \
	X(int, next_free, , "", "1 + the next unused cluster, 0: none",                           \
	  RB_UP_TO(RB_LIMIT_NEXT_FREE))                                                           \
	X(int, hit_a, , "", "body index, of `hits`", RB_UP_TO(RB_LIMIT_BODY))                     \
	X(int, hit_b, , "", "body index, of `hits`", RB_UP_TO(RB_LIMIT_ANY_BODY))                 \
	X(bool, used, , "", "else on the list of free ones", RB_FLAG)                             \
	X(bool, integrated, , "", "on a piece; else every member is on a parabola", RB_FLAG)      \
	X(bool, at_rest, , "", "no member moves", RB_FLAG)                                        \
	X(bool, has_jumped, , "", "velocities have just jumped, or must: to be resolved at once", \
	  RB_FLAG)                                                                                \
	X(bool, is_cut, , "", "its piece ends where a contact changes its mode", RB_FLAG)         \
	X(bool, hits, , "", "its piece ends where two bodies in contact touch at another point",  \
	  RB_FLAG)                                                                                \
	X(int, member_count, , "", "", RB_BY_HAND)                                                \
	X(int, held_count, , "", "", RB_BY_HAND)                                                  \
	X(int *, member, , "", "in the order in which the set found them", RB_BY_HAND)            \
	X(size_t, member_capacity, , "", "", RB_DERIVED)                                          \
	X(struct rb_held *, held, , "", "by (a, b, parts, key)", RB_BY_HAND)                      \
	X(size_t, held_capacity, , "", "", RB_DERIVED)                                            \
	X(struct rb_account_rates, rates, , "", "of its contacts while on parabolas", RB_BY_HAND) \
	X(struct rb_gauss_piece, account, , "", "integrated: RB_ENTRIES values; n = 0: none",     \
	  RB_BY_HAND)                                                                             \
	X(double *, account_block, , "", "owned: start, coefficients of `account`", RB_BY_HAND)   \
	X(struct rb_gauss_piece, piece, , "",                                                     \
	  "integrated: rows of rb_located_row values a member", RB_BY_HAND)                       \
	X(double *, block, , "", "owned: the piece, its scales, initial guess, scratch",          \
	  RB_BY_HAND)                                                                             \
	X(size_t, block_capacity, , "", "", RB_DERIVED)                                           \
	X(double *, at_nodes, , "m/s^2",                                                          \
	  "[nodes][members][3], in the block: located/field_samples", RB_DERIVED)                 \
	X(bool, has_nodes, , "", "they have been found", RB_DERIVED)
struct rb_cluster {
	RB_CLUSTER_FIELDS(RB_FIELD_MEMBER)
};
RB_FIELDS_DECLARE(rb_cluster_fields);

/* A contact in which an accumulation of impacts has just ended. */
#define RB_MERGE_FIELDS(X)                                         \
	X(double, recorded_s, , "s", "its last impact", RB_TIME)   \
	X(int, a, , "", "body index", RB_UP_TO(RB_LIMIT_ANY_BODY)) \
	X(int, b, , "", "body index", RB_UP_TO(RB_LIMIT_ANY_BODY))
struct rb_merge {
	RB_MERGE_FIELDS(RB_FIELD_MEMBER)
};
RB_FIELDS_DECLARE(rb_merge_fields);

/*
 * A body's series of bounces on another body (located/bounces), and its impacts with several
 * (located/interleaved).
 */
#define RB_BOUNCES_FIELDS(X)                                                               \
	X(double, at_s, , "s", "last bounce", RB_TIME)                                     \
	X(double, due_s, , "s", "predicted next bounce", RB_TIME)                          \
	X(double, limit_s, , "s", "limit of the series: its accumulation point", RB_TIME)  \
	X(double, error_s, , "s", "error bound of limit_s", RB_TIME)                       \
	X(double, met_s, , "s", "last impact that `met` counts", RB_TIME)                  \
	X(double, met, , "1", "recent impacts with alternating bodies, fading", RB_FINITE) \
	X(int, partner, , "", "body index, -1: none", RB_NONE_UP_TO(RB_LIMIT_ANY_BODY))    \
	X(int, met_with, , "", "body of the last impact, -1: none or several",             \
	  RB_NONE_UP_TO(RB_LIMIT_ANY_BODY))
struct rb_bounces {
	RB_BOUNCES_FIELDS(RB_FIELD_MEMBER)
};
RB_FIELDS_DECLARE(rb_bounces_fields);

/*
 * A body's crowd: the bodies with which it has shared events since time last allowed for all
 * (located/crowd). A tree of a forest.
 */
#define RB_CROWD_FIELDS(X)                                                                    \
	X(int, parent, , "", "body index: a root's own, else lower", RB_UP_TO(RB_LIMIT_BODY)) \
	X(int, size, , "", "of a root: bodies of its tree", RB_DERIVED)                       \
	X(uint64_t, products, , "", "of a root: work counted, less what time has allowed",    \
	  RB_ANY_BITS)                                                                        \
	X(double, paid_s, , "s", "of a root: time until which this was subtracted", RB_FINITE)
struct rb_crowd_of {
	RB_CROWD_FIELDS(RB_FIELD_MEMBER)
};
RB_FIELDS_DECLARE(rb_crowd_fields);

/* Saved state of the located method, beside that of bodies, clusters and cells. */
#define RB_LOCATED_FIELDS(X)                                                                     \
	X(double, now_s, , "s", "time of the event under way", RB_FINITE)                        \
	X(double, from_s, , "s", "time when locating began", RB_FINITE)                          \
	X(double, pace, , "1/s", "work that a second allows, in bodies: allowance.h", RB_FINITE) \
	X(double, stuck_s, , "s", "time whose events stuck_count counts", RB_TIME)               \
	X(uint64_t, stuck_count, , "", "events at one moment", RB_ANY_BITS)                      \
	X(uint64_t, events, , "", "number of all", RB_ANY_BITS)                                  \
	X(uint64_t, crowd, , "", "work counted in bodies, less what time has allowed",           \
	  RB_ANY_BITS)                                                                           \
	X(uint64_t, products, , "", "work in products that is no whole body yet", RB_ANY_BITS)   \
	X(int, switch_next, , "", "index of the next of `switch_s`", RB_UP_TO(RB_LIMIT_SWITCH))  \
	X(int, cluster_free, , "", "1 + an unused one, 0: none", RB_UP_TO(RB_LIMIT_NEXT_FREE))   \
	X(bool, started, , "", "arcs exist", RB_FLAG)

struct rb_located {
	struct rb_world *world;
	const struct rb_model *model;
	int n; /* moving bodies, including driven ones */
	RB_LOCATED_FIELDS(RB_FIELD_MEMBER)
	struct rb_arc *arc;
	struct rb_top *top;           /* [n]; NULL if no body can rotate */
	struct rb_top_body *top_body; /* [n]; NULL if no body can rotate */
	bool decays;                  /* drag is linear: free flight has a closed form */
	bool *orientation_unused;     /* [n]; NULL if no body can rotate */
	struct rb_piece_of *
		piece; /* [n]; NULL until a force without a closed form or a driven body needs it */
	struct rb_piece_warm_start
		*warm_start; /* [n]: located/piece_warm_start; NULL until a piece is integrated */
	uint64_t moment;     /* number of the event under way; 0: none */
	struct rb_driven **driven; /* [n], NULL without driven bodies: located/driven */
	struct rb_follow *follow;  /* [joints]: located/follow; NULL without motors */
	uint32_t *generation;
	/* [n]: time until which the work on bodies in flight is in the ledger; NULL: no ledger */
	double *account_s;
	struct rb_next *next;
	int *cluster_of; /* -1: none */
	struct rb_cluster *cluster;
	int cluster_count;
	size_t cluster_capacity;
	double *factors;         /* scratch of a piece (located/coupled) */
	size_t factors_capacity; /* of it */
	rb_vec3 *plane_normal;   /* [statics]: of planes and rectangles */

	/*
	 * [joints][RB_JOINT_PARTS_HELD]: enum rb_drive_mode, and the one from the end of the piece
	 * on (RB_DRIVE_KEEPS: unchanged); NULL without joints
	 */
	signed char *drive_mode, *drive_next;
	bool *eased; /* same shape: stops whose bound is moved outwards (located/joint_stops) */

	struct rb_queue *queue;         /* [n] bodies, [n] clusters, 1 switch of forces */
	struct rb_cells *cells;         /* NULL: few bodies, so all pairs are candidates */
	int *near;                      /* [n] scratch */
	struct rb_inspected *inspected; /* [n]: located/inspect */
	int *set;                       /* [n] scratch: bodies that one event involves */
	int *place;                     /* [n] index of a body in `set`, -1 between uses */
	int set_count;
	int touch_a, touch_b; /* the pair whose touch is being resolved, -1: none */
	/*
	 * owned, sorted by pair: contacts that steps have left. Their forces are initial guesses,
	 * by name, for points not yet held; emptied at the end of the advance that began with them
	 */
	struct rb_contacts stepped_contacts;
	struct rb_bounces *bounces; /* [n] by the lower index of the pair */
	struct rb_merge *merge;
	int merge_count;
	size_t merge_capacity;
	double *switch_s; /* [switch_count] times at which forces begin or end, ascending */
	int switch_count;

	double weight;                     /* m/s^2: |gravity| plus the strongest attraction */
	struct rb_gravitation gravitation; /* owned; empty without gravitation */
	double end_s;                      /* end of the run */
	uint64_t world_max;  /* limit of the whole world's count; above, steps; UINT64_MAX: none */
	uint64_t crowd_max;  /* the same for the event under way */
	uint64_t event_from; /* all products when that event began */
	struct rb_crowd_of *crowd_of; /* [n] */
	int *joined, joined_count;    /* [n]: bodies in trees of more than one */
	struct rb_arena *arena;       /* borrowed: the world's first */
	struct rb_error *err;         /* of the advance under way */
	enum rb_status status;        /* of that advance: the first error ends it */
	bool starting;                /* initial contacts are being found: these are not reported */
};

RB_FIELDS_DECLARE(rb_located_fields);

/* Result of the last check of overlaps: of a body with bodies of higher index. */
struct rb_inspected {
	double depth; /* m: deepest of these overlaps; 0: none */
	int with;     /* body of that overlap; -1: none */
	uint32_t generation;
	bool rested; /* it was at rest on its arc of that generation */
	bool rests;  /* it still is */
};

/* Parts of a joint that act or not: drives, and stops of the free coordinate or of a rope. */
enum rb_joint_part { RB_STOP_LOW = RB_JOINT_DRIVES, RB_STOP_HIGH, RB_JOINT_PARTS_HELD };

/*
 * State of a drive (motor or friction) of a joint: saturated at a bound, holding its speed (or its
 * target), or just reaching it. Of a stop: open, holding, or just reached.
 */
enum rb_drive_mode {
	RB_DRIVE_LOW = -1,
	RB_STOP_OPEN = RB_DRIVE_LOW,
	RB_DRIVE_HELD,
	RB_DRIVE_HIGH,
	RB_DRIVE_REACHED,
	RB_DRIVE_KEEPS
};

/* Rows of a body in a piece: x, v and, if bodies rotate, q, w. */
enum { RB_PIECE_POSITION = 0, RB_PIECE_VELOCITY = 3, RB_PIECE_ORIENTATION = 6, RB_PIECE_SPIN = 10 };
static inline int rb_located_row(const struct rb_located *l)
{
	return l->top ? 13 : 6;
}

/*
 * Units of work. RB_LOCATED_PRODUCTS products count as one body of an event. This is a choice, with
 * which some fifty boxes that move together are left to steps; and it counts arithmetic, not time,
 * so that every machine decides alike. The other values are products counted for: a row of a
 * contact in a product of a vector with the matrix; an inspection of a contact on a piece, and of
 * the forces on a body in flight; a call of a field's function; a pair that attracts each other; a
 * search for contact points of two convex bodies, or for their next touch; a step of a rotation's
 * series.
 */
enum {
	RB_LOCATED_PRODUCTS = 100000,
	RB_LOCATED_ROW = 200,
	RB_LOCATED_INSPECTION = 400,
	RB_LOCATED_FLIGHT = 300,
	RB_LOCATED_FIELD = 1500,
	RB_LOCATED_ATTRACTION = 8,
	RB_LOCATED_SEARCH = 3000,
	RB_LOCATED_SERIES = 1000
};
/* Steps of one body that take about as long as one counted body. */
enum { RB_LOCATED_BODY_STEPS = 32 };

/* All work counted, in bodies. */
static inline uint64_t rb_located_crowd(const struct rb_located *l)
{
	return l->crowd + l->products / RB_LOCATED_PRODUCTS;
}

/* Work that time has allowed until `t`, in whole bodies. */
static inline uint64_t rb_located_allowed(const struct rb_located *l, double t)
{
	return (uint64_t)fmin(fmax(l->pace * t, 0), 1e18);
}

/* All work counted, in products. */
static inline uint64_t rb_located_all_products(const struct rb_located *l)
{
	return l->crowd * RB_LOCATED_PRODUCTS + l->products;
}

/* True if the count exceeds the limit of the event under way. */
static inline bool rb_located_is_dense(const struct rb_located *l)
{
	return rb_located_crowd(l) > l->crowd_max;
}

/* Cost, in bodies, of a dense elimination with that number of unknowns. */
static inline uint64_t rb_located_cost(double unknowns)
{
	return (uint64_t)fmin(unknowns * unknowns * unknowns / (3.0 * RB_LOCATED_PRODUCTS), 1e15);
}

/* Bodies that may still be counted below the limit. */
static inline uint64_t rb_located_left(const struct rb_located *l)
{
	const uint64_t crowd = rb_located_crowd(l);

	return crowd < l->crowd_max ? l->crowd_max - crowd : 0;
}

/*
 * Number of products of a vector with the matrix of so many contacts that the limit still allows;
 * 0: no limit.
 */
static inline long rb_located_products(const struct rb_located *l, int contacts)
{
	const uint64_t row = RB_LOCATED_PRODUCTS / RB_LOCATED_ROW;

	if (l->crowd_max == UINT64_MAX)
		return 0;
	return 1 + (long)(rb_located_left(l) * row / (uint64_t)(contacts > 0 ? contacts : 1));
}

/*
 * Approximate cost, in bodies, of solving forces at rest: as many products with the matrix as there
 * are contacts.
 */
static inline uint64_t rb_located_rest_cost(int contacts)
{
	return (uint64_t)contacts * (uint64_t)contacts * RB_LOCATED_ROW / RB_LOCATED_PRODUCTS;
}

/*
 * Cost, in bodies, of an impact of so many contacts and of the forces after it: five products per
 * contact for each, which is a low estimate.
 */
static inline uint64_t rb_located_impact_cost(int contacts)
{
	return 10 * (uint64_t)contacts * (uint64_t)contacts * RB_LOCATED_ROW / RB_LOCATED_PRODUCTS;
}

static inline void rb_located_count(struct rb_located *l, long products, int contacts)
{
	l->products += (uint64_t)products * (uint64_t)contacts * RB_LOCATED_ROW;
}

/* True for a moving body; for a moving or static body. */
static inline bool rb_located_moves(const struct rb_located *l, int i)
{
	return i >= 0 && i < l->n;
}
static inline bool rb_located_is_body(const struct rb_located *l, int i)
{
	return i >= 0 && i < l->n + l->model->static_count;
}

static inline bool rb_located_driven(const struct rb_located *l, int i)
{
	return i < l->n && l->model->driven && l->model->driven[i];
}

/* True for a body that contacts cannot move: static or driven. */
static inline bool rb_located_fixed(const struct rb_located *l, int i)
{
	return i >= l->n || rb_located_driven(l, i);
}

/* True if the scene has gravitation, which joins all attracted bodies in one cluster. */
static inline bool rb_located_gravitates(const struct rb_located *l)
{
	return (l->model->features & RB_FEATURE_GRAVITATION) != 0;
}

/* True if bodies may move other than on parabolas of their centres. */
static inline bool rb_located_varies(const struct rb_located *l)
{
	return l->model->driven || l->model->center_of_mass ||
	       (l->model->features & (RB_FEATURES_VARIED | RB_FEATURE_DRIVEN | RB_FEATURE_JOINTS));
}

/*
 * Longest time between two calls of a function of the scene, s: what it does for longer is seen,
 * however long pieces are and however few frames there are.
 */
static inline double rb_located_sampling(const struct rb_located *l)
{
	return l->end_s / 256;
}

static inline bool rb_located_on_piece(const struct rb_located *l, int i)
{
	return l->piece && i < l->n && l->piece[i].piece.n > 0;
}

#endif
