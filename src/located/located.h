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
 * An *arc* is the motion of a body from its anchor on: a parabola of the centre of mass, or what
 * linear drag makes of it (math/decay), and a turning (math/top); or, while forces without a closed
 * form act on it, a polynomial piece of its cluster's integrator. Anchors change only by events of
 * that body, so nothing depends on when frames or steps look at it. Bodies joined by lasting
 * contacts or springs form a *cluster* with one clock.
 *
 * What happens at an event:
 *
 *     queue: the earliest event of any body                           (queue)
 *        |
 *        +-- wall of a cell, end of a piece ---------------------+
 *        +-- touch whose partner has moved on: predict anew -----+    (predict)
 *        +-- touch                                               |
 *              |  the bodies concerned, and all that they touch  |    (set)
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
 * Constants stand at the top of the file that uses them: error bounds in integrate.c (closed forms
 * of `rbsim verify`), counts of ulp for touching in contact_point.c and pair_contacts.c, rounds of
 * impacts in resolve_impact.c, the crowd from which steps are taken in engine.c (gas and heap of
 * `tests/bench`).
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
 * Centre of mass from the anchor on: x + v s + a s^2 / 2, or with linear drag the same that slows
 * down. What a neighbour in the same field of
 * gravity asks for is one line of memory: of many bodies that is most of what is read.
 */
#define RB_ARC_FIELDS(X)                                                                         \
	X(_Alignas(64) double, anchor_s, , "s", "its beginning", RB_FINITE)                      \
	X(rb_vec3, position, , "m", "at the anchor", RB_FINITE)                                  \
	X(rb_vec3, velocity, , "m/s", "at the anchor", RB_FINITE)                                \
	X(double, plain_radius, , "m",                                                           \
	  "of a sphere about its centre that only the world's gravity pulls, or NAN", RB_NUMBER) \
	X(rb_vec3, acceleration, , "m/s^2", "by constant forces", RB_FINITE)                     \
	X(double, decay, , "1/s", "of velocities by linear drag (math/decay), >= 0", RB_FINITE)
struct rb_arc {
	RB_ARC_FIELDS(RB_FIELD_MEMBER)
};
RB_FIELDS_DECLARE(rb_arc_fields);

/*
 * Where a body's motion is a polynomial: rows `first` .. of a piece that began at origin_s and
 * holds to until_s. Where its orientation is not felt, that stays as it began: what it is follows
 * from the spin (math/turn).
 */
#define RB_PIECE_FIELDS(X)                                                                     \
	X(struct rb_gauss_piece, piece, , "",                                                  \
	  "n = 0: the arc is a parabola; the cluster's arrays", RB_BY_HAND)                    \
	X(int, first, , "", "row of the piece", RB_DERIVED)                                    \
	X(rb_vec3, base, , "m", "the position's rows are from here: far away costs no digits", \
	  RB_FINITE)                                                                           \
	X(rb_vec3, rest, , "m", "of the anchor, where the arc is a parabola: struct rb_pose",  \
	  RB_FINITE)                                                                           \
	X(double, origin_s, , "s", "its beginning", RB_FINITE)                                 \
	X(double, acceleration_max, , "m/s^2", "bound over the piece", RB_FINITE)              \
	X(double, until_s, , "s", "its end", RB_TIME)
struct rb_piece_of {
	RB_PIECE_FIELDS(RB_FIELD_MEMBER)
};
RB_FIELDS_DECLARE(rb_piece_fields);

/* What a body foresees first; the earliest of its times is in the queue. */
#define RB_NEXT_FIELDS(X)                                                                \
	X(double, touch_s, , "s", "INFINITY: none", RB_TIME)                             \
	X(double, wall_s, , "s", "INFINITY: none", RB_TIME)                              \
	X(int, partner, , "", "body index, of the touch; -1: none",                      \
	  RB_NONE_UP_TO(RB_LIMIT_ANY_BODY))                                              \
	X(uint32_t, generation, , "", "the partner's when it was foreseen", RB_ANY_BITS) \
	X(int, wall, , "", "for rb_cells_cross; -1: none", RB_WITHIN(-1, INT_MAX))       \
	X(bool, again, , "", "not yet a touch: look again then", RB_FLAG)
struct rb_next {
	RB_NEXT_FIELDS(RB_FIELD_MEMBER)
};
RB_FIELDS_DECLARE(rb_next_fields);

/* What a lasting contact does; the order is that of rb_event_kind from REST on. */
enum rb_held_mode { RB_HELD_REST, RB_HELD_SLIDE, RB_HELD_ROLL };

/*
 * A lasting contact: one point of a pair, which may have several. Its name is (a, b, parts, key,
 * half): struct rb_contact_name. `half`: of a rim in a piece, the half that it began with.
 */
#define RB_HELD_FIELDS(X)                                                                        \
	X(uint64_t, key, , "", "in its name", RB_ANY_BITS)                                       \
	X(rb_vec3, half, , "1", "in its name", RB_FINITE)                                        \
	X(rb_vec3, slip, , "1", "unit: velocity of b's point relative to a's", RB_FINITE)        \
	X(rb_vec3, common, , "1",                                                                \
	  "unit: where all points of a pair creep one way, that way; else 0", RB_FINITE)         \
	X(rb_vec3, force, , "N", "on b, at the cluster's anchor", RB_FINITE)                     \
	X(double, friction, , "1",                                                               \
	  "while it slips: the law's, or what is left of it where a body jams", RB_FINITE)       \
	X(double, recorded_s, , "s",                                                             \
	  "when it is to be announced: after the last of its summed impacts", RB_TIME)           \
	X(int, a, , "", "body index", RB_UP_TO(RB_LIMIT_BODY))                                   \
	X(int, b, , "", "body index, > a", RB_UP_TO(RB_LIMIT_ANY_BODY))                          \
	X(uint32_t, parts, , "", "which features of them meet", RB_ANY_BITS)                     \
	X(enum rb_held_mode, reported, , "", "what the last transition said",                    \
	  RB_WITHIN(RB_HELD_REST, RB_HELD_ROLL))                                                 \
	X(bool, is_reported, , "", "it has been announced", RB_FLAG)                             \
	X(bool, merged, , "", "it is to be announced as a merge first", RB_FLAG)                 \
	X(bool, slipping, , "", "along `slip`", RB_FLAG)                                         \
	X(bool, on_rim, , "", "of a flat shape", RB_FLAG)                                        \
	X(bool, ending, , "", "its slip ends at this moment; or its rest, by `force`", RB_FLAG)  \
	X(bool, straight, , "", "its slip keeps its direction to the end, to rounding", RB_FLAG) \
	X(bool, creeps, , "", "forces across so slow a slip balance, and say which way", RB_FLAG)
struct rb_held {
	RB_HELD_FIELDS(RB_FIELD_MEMBER)
};
RB_FIELDS_DECLARE(rb_held_fields);

/*
 * W and N of contacts at rest or sliding between parabolas, about the origin: polynomials in the
 * time since then; by static bodies, by driven ones (that do not move).
 */
#define RB_ACCOUNT_RATES_FIELDS(X)                                  \
	X(double, sliding, [2], "W, W/s", "of friction", RB_FINITE) \
	X(rb_vec3, force, [2], "N", "by whom", RB_FINITE)           \
	X(rb_vec3, torque, [2][3], "N m, N m/s, N m/s^2", "by whom", RB_FINITE)
struct rb_account_rates {
	RB_ACCOUNT_RATES_FIELDS(RB_FIELD_MEMBER)
};
RB_FIELDS_DECLARE(rb_account_rates_fields);

#define RB_CLUSTER_FIELDS(X)                                                                     \
	X(double, anchor_s, , "s", "its beginning", RB_FINITE)                                   \
	X(double, account_s, , "s", "until then the ledger has it (located/account)", RB_FINITE) \
	X(double, least, , "1", "of struct rb_dense, at the beginning of the piece", RB_FINITE)  \
	X(double, try_s, , "s", "length of the next piece", RB_TIME)                             \
	X(uint64_t, crept, , "", "pieces that got nowhere, less those that did", RB_ANY_BITS)    \
	X(int, next_free, , "", "1 + the next unused cluster, 0: none",                          \
	  RB_UP_TO(RB_LIMIT_NEXT_FREE))                                                          \
	X(int, hit_a, , "", "of `hits`", RB_UP_TO(RB_LIMIT_BODY))                                \
	X(int, hit_b, , "", "of `hits`", RB_UP_TO(RB_LIMIT_ANY_BODY))                            \
	X(bool, used, , "", "else one of the free ones", RB_FLAG)                                \
	X(bool, integrated, , "", "else every member is on a parabola", RB_FLAG)                 \
	X(bool, at_rest, , "", "nobody in it moves", RB_FLAG)                                    \
	X(bool, has_jumped, , "",                                                                \
	  "velocities have just jumped, or are to: it is to be resolved at once", RB_FLAG)       \
	X(bool, is_cut, , "", "its piece ends where a contact changes its mode", RB_FLAG)        \
	X(bool, hits, , "",                                                                      \
	  "or where two bodies that touch already come to touch at another point", RB_FLAG)      \
	X(int, member_count, , "", "", RB_BY_HAND)                                               \
	X(int, held_count, , "", "", RB_BY_HAND)                                                 \
	X(int *, member, , "", "in the order in which they were found to belong together",       \
	  RB_BY_HAND)                                                                            \
	X(size_t, member_capacity, , "", "", RB_DERIVED)                                         \
	X(struct rb_held *, held, , "", "by (a, b, parts, key)", RB_BY_HAND)                     \
	X(size_t, held_capacity, , "", "", RB_DERIVED)                                           \
	X(struct rb_account_rates, rates, , "", "on parabolas: of its contacts", RB_BY_HAND)     \
	X(struct rb_gauss_piece, account, , "", "integrated: RB_ENTRIES values; n = 0: none",    \
	  RB_BY_HAND)                                                                            \
	X(double *, account_block, , "", "owned: start, coefficients", RB_BY_HAND)               \
	X(struct rb_gauss_piece, piece, , "",                                                    \
	  "integrated: rows of rb_located_row values a member", RB_BY_HAND)                      \
	X(double *, block, , "", "owned: the piece; scale, guess, scratch", RB_BY_HAND)          \
	X(size_t, block_capacity, , "", "", RB_DERIVED)
struct rb_cluster {
	RB_CLUSTER_FIELDS(RB_FIELD_MEMBER)
};
RB_FIELDS_DECLARE(rb_cluster_fields);

/* A contact that an accumulation of impacts has just ended in. */
#define RB_MERGE_FIELDS(X)                                         \
	X(double, recorded_s, , "s", "its last impact", RB_TIME)   \
	X(int, a, , "", "body index", RB_UP_TO(RB_LIMIT_ANY_BODY)) \
	X(int, b, , "", "body index", RB_UP_TO(RB_LIMIT_ANY_BODY))
struct rb_merge {
	RB_MERGE_FIELDS(RB_FIELD_MEMBER)
};
RB_FIELDS_DECLARE(rb_merge_fields);

/*
 * A body's series of bounces with another one (located/bounces), and of impacts with several
 * (located/interleaved).
 */
#define RB_BOUNCES_FIELDS(X)                                                            \
	X(double, at_s, , "s", "the bounce before", RB_TIME)                            \
	X(double, due_s, , "s", "the next one, foreseen", RB_TIME)                      \
	X(double, limit_s, , "s", "when all will be over", RB_TIME)                     \
	X(double, error_s, , "s", "that is known within", RB_TIME)                      \
	X(double, met_s, , "s", "its last impact of those that `met` counts", RB_TIME)  \
	X(double, met, , "1", "impacts of late, with one body and another", RB_FINITE)  \
	X(int, partner, , "", "body index, -1: none", RB_NONE_UP_TO(RB_LIMIT_ANY_BODY)) \
	X(int, met_with, , "", "whom it has met last, -1: nobody", RB_NONE_UP_TO(RB_LIMIT_ANY_BODY))
struct rb_bounces {
	RB_BOUNCES_FIELDS(RB_FIELD_MEMBER)
};
RB_FIELDS_DECLARE(rb_bounces_fields);

/* With whom a body has dealt since time had paid for all (located/crowd): a tree of a forest. */
#define RB_CROWD_FIELDS(X)                                                                         \
	X(int, parent, , "", "body index, of a root its own, else lower", RB_UP_TO(RB_LIMIT_BODY)) \
	X(int, size, , "", "bodies of a root's tree", RB_DERIVED)                                  \
	X(uint64_t, products, , "", "a root's: what it has counted, less what time has allowed",   \
	  RB_ANY_BITS)                                                                             \
	X(double, paid_s, , "s", "until when", RB_FINITE)
struct rb_crowd_of {
	RB_CROWD_FIELDS(RB_FIELD_MEMBER)
};
RB_FIELDS_DECLARE(rb_crowd_fields);

/* Of the located method, beside what it knows of bodies, clusters and cells. */
#define RB_LOCATED_FIELDS(X)                                                                      \
	X(double, now_s, , "s", "the event under way", RB_FINITE)                                 \
	X(double, from_s, , "s", "when locating began", RB_FINITE)                                \
	X(double, pace, , "1/s", "bodies of crowds that a second allows: allowance.h", RB_FINITE) \
	X(double, stuck_s, , "s", "events at one moment are counted", RB_TIME)                    \
	X(uint64_t, stuck_count, , "", "of these", RB_ANY_BITS)                                   \
	X(uint64_t, events, , "", "all", RB_ANY_BITS)                                             \
	X(uint64_t, crowd, , "", "bodies of crowds dealt with, less what time has allowed",       \
	  RB_ANY_BITS)                                                                            \
	X(uint64_t, products, , "", "arithmetic for what moves that makes no whole body yet",     \
	  RB_ANY_BITS)                                                                            \
	X(int, switch_next, , "", "the next of `switch_s`", RB_UP_TO(RB_LIMIT_SWITCH))            \
	X(int, cluster_free, , "", "1 + an unused one, 0: none", RB_UP_TO(RB_LIMIT_NEXT_FREE))    \
	X(bool, started, , "", "there are arcs", RB_FLAG)

struct rb_located {
	struct rb_world *world;
	const struct rb_model *model;
	int n; /* moving bodies, driven ones too */
	RB_LOCATED_FIELDS(RB_FIELD_MEMBER)
	struct rb_arc *arc;
	struct rb_top *top;           /* NULL where nothing turns */
	struct rb_top_body *top_body; /* NULL where nothing turns */
	bool decays;                  /* drag is linear: bodies that fly slow down in closed form */
	bool *unfelt; /* [n]: how it is turned acts on nothing; NULL where nothing turns */
	struct rb_piece_of
		*piece; /* NULL until a force without a closed form or a driven body needs it */
	struct rb_piece_warm_start
		*past;   /* [n]: located/piece_warm_start; NULL until a piece is integrated */
	uint64_t moment; /* of the event under way: they are counted; 0: none */
	struct rb_driven **driven; /* [n], NULL without driven bodies: located/driven */
	struct rb_follow *follow;  /* [joints]: located/follow; NULL without motors */
	uint32_t *generation;
	/* [n]: up to when the ledger has what acts on bodies in flight; NULL: it is not kept */
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
	 * on, RB_DRIVE_KEEPS: the same; NULL without joints
	 */
	signed char *drive_mode, *drive_next;
	bool *eased; /* as many: stops that are taken to be further off (located/joint_stops) */

	struct rb_queue *queue;         /* [n] bodies, [n] clusters, 1 switch of forces */
	struct rb_cells *cells;         /* NULL: few bodies, all are candidates */
	int *near;                      /* [n] scratch */
	struct rb_inspected *inspected; /* [n]: located/inspect */
	int *set;                       /* [n] scratch: bodies that are dealt with together */
	int *place;                     /* [n] a body's place in `set`, -1 between uses */
	int set_count;
	int come_a, come_b; /* the pair whose touch is dealt with, -1: none */
	/*
	 * owned, by pair: contacts that steps have left, from which forces start by name where
	 * nothing is held yet; empty after the advance that has begun with them
	 */
	struct rb_contacts left;
	struct rb_bounces *bounces; /* [n] by the lower index of two */
	struct rb_merge *merge;
	int merge_count;
	size_t merge_capacity;
	double *switch_s; /* [switch_count] moments at which forces begin or end, ascending */
	int switch_count;

	double weight; /* m/s^2: |gravity|, and that of the strongest that attracts */
	struct rb_gravitation gravitation; /* owned; empty without that */
	double end_s;                      /* of the run */
	uint64_t world_max;  /* more than these are left to steps; UINT64_MAX: whatever it costs */
	uint64_t crowd_max;  /* of the event under way: no more than that */
	uint64_t event_from; /* all products when it began */
	struct rb_crowd_of *crowd_of; /* [n] */
	int *joined, joined_count;    /* [n]: bodies in trees of more than one */
	struct rb_arena *arena;       /* borrowed: the world's first */
	struct rb_error *err;         /* of the advance under way */
	enum rb_status status;        /* of it: set once, then nothing goes on */
	bool starting; /* contacts that are found now have been there before: nothing to tell */
};

RB_FIELDS_DECLARE(rb_located_fields);

/* What the last look for overlaps has found of a body, and of others that come after it. */
struct rb_inspected {
	double depth; /* m, the deepest of these overlaps; 0: none */
	int with;     /* whose that is; -1: nobody's */
	uint32_t generation;
	bool rested; /* it stood still on its arc of that generation */
	bool rests;  /* it does so since */
};

/* What of a joint may hold or let go: drives, and stops of the free coordinate, or of a rope. */
enum rb_joint_part { RB_STOP_LOW = RB_JOINT_DRIVES, RB_STOP_HIGH, RB_JOINT_PARTS_HELD };

/*
 * Motor or friction of a joint: at a bound, keeping its speed (or what it follows), or just coming
 * to it. Of stops: open, holding, or just coming to touch.
 */
enum rb_drive_mode {
	RB_DRIVE_LOW = -1,
	RB_STOP_OPEN = RB_DRIVE_LOW,
	RB_DRIVE_HELD,
	RB_DRIVE_HIGH,
	RB_DRIVE_REACHED,
	RB_DRIVE_KEEPS
};

/* Values of a body in a piece: x, v and, where bodies turn, q, w. */
enum { RB_PIECE_POSITION = 0, RB_PIECE_VELOCITY = 3, RB_PIECE_ORIENTATION = 6, RB_PIECE_SPIN = 10 };
static inline int rb_located_row(const struct rb_located *l)
{
	return l->top ? 13 : 6;
}

/*
 * So many products count as dealing with a body once. That is a choice, with which some fifty
 * boxes that move together are left to steps; and arithmetic, not a clock: the same on every
 * machine. A row of a contact's in a product of a vector with the matrix, a look at a contact on a
 * piece, and at what pulls a body in flight, a call of a field's function, a pair that attracts
 * each other, and a search for points where two convex bodies touch, or a look at two that may
 * touch next, count as so many.
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
/* Steps of a body that take about as long as a body that counts. */
enum { RB_LOCATED_BODY_STEPS = 32 };

/* What is counted, in bodies. */
static inline uint64_t rb_located_crowd(const struct rb_located *l)
{
	return l->crowd + l->products / RB_LOCATED_PRODUCTS;
}

/* Bodies of crowds that time has allowed until `t`: whole ones. */
static inline uint64_t rb_located_allowed(const struct rb_located *l, double t)
{
	return (uint64_t)fmin(fmax(l->pace * t, 0), 1e18);
}

/* The same, in products. */
static inline uint64_t rb_located_all_products(const struct rb_located *l)
{
	return l->crowd * RB_LOCATED_PRODUCTS + l->products;
}

/* Too much to locate. */
static inline bool rb_located_is_dense(const struct rb_located *l)
{
	return rb_located_crowd(l) > l->crowd_max;
}

/* Bodies that an elimination of so many unknowns would count for, had its matrix no zeros. */
static inline uint64_t rb_located_cost(double unknowns)
{
	return (uint64_t)fmin(unknowns * unknowns * unknowns / (3.0 * RB_LOCATED_PRODUCTS), 1e15);
}

/* Bodies that may count until it is too much. */
static inline uint64_t rb_located_left(const struct rb_located *l)
{
	const uint64_t crowd = rb_located_crowd(l);

	return crowd < l->crowd_max ? l->crowd_max - crowd : 0;
}

/* Of a vector with the matrix of so many contacts: how many until it is too dense; 0: no limit. */
static inline long rb_located_products(const struct rb_located *l, int contacts)
{
	const uint64_t row = RB_LOCATED_PRODUCTS / RB_LOCATED_ROW;

	if (l->crowd_max == UINT64_MAX)
		return 0;
	return 1 + (long)(rb_located_left(l) * row / (uint64_t)(contacts > 0 ? contacts : 1));
}

/* Bodies that forces at rest count for, about: of contacts, as many products with their matrix. */
static inline uint64_t rb_located_rest_cost(int contacts)
{
	return (uint64_t)contacts * (uint64_t)contacts * RB_LOCATED_ROW / RB_LOCATED_PRODUCTS;
}

/*
 * The same for an impact of so many, and the forces after it: five products for each contact are
 * few, for either.
 */
static inline uint64_t rb_located_impact_cost(int contacts)
{
	return 10 * (uint64_t)contacts * (uint64_t)contacts * RB_LOCATED_ROW / RB_LOCATED_PRODUCTS;
}

static inline void rb_located_count(struct rb_located *l, long products, int contacts)
{
	l->products += (uint64_t)products * (uint64_t)contacts * RB_LOCATED_ROW;
}

/* A body that moves; one that may be static, too. */
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

/* Neither pushed nor turned by contacts: static or driven. */
static inline bool rb_located_fixed(const struct rb_located *l, int i)
{
	return i >= l->n || rb_located_driven(l, i);
}

/* Has the scene gravitation, which joins all that are attracted in one cluster? */
static inline bool rb_located_gravitates(const struct rb_located *l)
{
	return (l->model->features & RB_FEATURE_GRAVITATION) != 0;
}

/* May bodies move otherwise than on parabolas of their centres? */
static inline bool rb_located_varies(const struct rb_located *l)
{
	return l->model->driven || l->model->center_of_mass ||
	       (l->model->features & (RB_FEATURES_VARIED | RB_FEATURE_DRIVEN | RB_FEATURE_JOINTS));
}

static inline bool rb_located_on_piece(const struct rb_located *l, int i)
{
	return l->piece && i < l->n && l->piece[i].piece.n > 0;
}

#endif
