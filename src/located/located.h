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
 * An *arc* is the motion of a body from its anchor on: a parabola of the centre of mass, and a
 * turning (math/top); or, while forces without a closed form act on it, a polynomial piece of its
 * cluster's integrator. Anchors change only by events of that body, so nothing depends on when
 * frames or steps look at it. Bodies joined by lasting contacts or springs form a *cluster* with
 * one clock.
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
#include "math/gauss.h"
#include "math/top.h"
#include "world/world.h"

#include <math.h>

/*
 * Centre of mass from the anchor on: x + v s + a s^2 / 2. What a neighbour in the same field of
 * gravity asks for is one line of memory: of many bodies that is most of what is read.
 */
struct rb_arc {
	_Alignas(64) double anchor_s;
	rb_vec3 position, velocity;
	/* of a sphere about its centre that only the world's gravity pulls, else NAN */
	double plain_radius;
	rb_vec3 acceleration;
};

/*
 * Where a body's motion is a polynomial: rows `first` .. of a piece that began at origin_s and
 * holds to until_s. Where its orientation is not felt, that stays as it began: what it is follows
 * from the spin (math/turn).
 */
struct rb_piece_of {
	struct rb_gauss_piece
		piece; /* n = 0: the arc is a parabola; its arrays are the cluster's */
	int first;
	rb_vec3 base; /* m: the position's rows are from here, so that far away costs no digits */
	rb_vec3 rest; /* m: of the anchor, where the arc is a parabola again: struct rb_pose */
	double origin_s, until_s;
	double acceleration_max; /* m/s^2: bound over the piece */
};

/* What a body foresees first; the earliest of its times is in the queue. */
struct rb_next {
	double touch_s;      /* INFINITY: none */
	int partner;         /* of the touch, body index */
	uint32_t generation; /* the partner's when it was foreseen */
	bool again;          /* not yet a touch: look again then */
	int wall;            /* for rb_cells_cross */
	double wall_s;       /* INFINITY: none */
};

/* What a lasting contact does; the order is that of rb_event_kind from REST on. */
enum rb_held_mode { RB_HELD_REST, RB_HELD_SLIDE, RB_HELD_ROLL };

/* A lasting contact: one point of a pair, which may have several. */
struct rb_held {
	int a, b;       /* body indices, a < b */
	uint32_t parts; /* which features of them meet: struct rb_contact_name */
	uint64_t key;
	rb_vec3 half; /* the same: of a rim in a piece, the half that it began with */
	bool slipping, on_rim;
	bool ending;   /* its slip has come to its end at this moment; or its rest, by `force` */
	bool straight; /* its slip keeps its direction to the end, to rounding */
	/* its slip is so slow that forces across it balance: they say which way it goes */
	bool creeps;
	rb_vec3 slip;    /* unit: velocity of b's point relative to a's */
	rb_vec3 common;  /* unit: where all points of a pair creep one way, that way; else 0 */
	double friction; /* while it slips: the law's, or what is left of it where a body jams */
	rb_vec3 force;   /* N, on b, at the cluster's anchor */
	enum rb_held_mode reported; /* what the last transition said */
	bool is_reported;
	/* when the contact is to be announced: after the last of its summed impacts */
	double recorded_s;
	bool merged; /* ... and announced as a merge first */
};

/*
 * W and N of contacts at rest or sliding between parabolas, about the origin: polynomials in the
 * time since then.
 */
struct rb_account_rates {
	double sliding[2];
	rb_vec3 force[2], torque[2][3]; /* by static bodies, by driven ones (that do not move) */
};

struct rb_cluster {
	bool used;
	int next_free;   /* 1 + the next unused cluster, 0: none */
	bool integrated; /* else every member is on a parabola */
	bool at_rest;
	/* velocities have just jumped, or are to: it is to be settled, or struck, at once */
	bool has_jammed;
	bool is_cut; /* its piece ends where a contact changes its mode */
	bool hits; /* ... or where two bodies that touch already come to touch at another point: */
	int hit_a, hit_b;
	double anchor_s;
	int *member; /* [member_count], in the order in which they were found to belong together */
	int member_count;
	size_t member_capacity;
	struct rb_held *held; /* [held_count], by (a, b, parts, key) */
	int held_count;
	size_t held_capacity;

	/* the ledger (located/account): what has acted since, if it is kept */
	double account_s;
	struct rb_account_rates rates; /* on parabolas: of its contacts */
	struct rb_gauss_piece account; /* integrated: RB_ENTRIES values; n = 0: none */
	double *account_block;         /* owned: start, coefficients */

	/* integrated: rows of 13 (6 without rotation) values a member */
	double least; /* of struct rb_dense, at the beginning of the piece */
	struct rb_gauss_piece piece;
	double *block; /* owned: start, coefficients, scale, scratch */
	size_t block_capacity;
	double try_s;
};

struct rb_located {
	struct rb_world *world;
	const struct rb_model *model;
	int n; /* moving bodies, driven ones too */
	struct rb_arc *arc;
	struct rb_top *top;           /* NULL where nothing turns */
	struct rb_top_body *top_body; /* NULL where nothing turns */
	bool *unfelt; /* [n]: how it is turned acts on nothing; NULL where nothing turns */
	struct rb_piece_of
		*piece; /* NULL until a force without a closed form or a driven body needs it */
	struct rb_driven **driven; /* [n], NULL without driven bodies: located/driven */
	uint32_t *generation;
	/* [n]: up to when the ledger has what acts on bodies in flight; NULL: it is not kept */
	double *account_s;
	struct rb_next *next;
	int *cluster_of; /* -1: none */
	struct rb_cluster *cluster;
	int cluster_count, cluster_free; /* 1 + an unused one, 0: none */
	size_t cluster_capacity;
	rb_vec3 *plane_normal; /* [statics]: of planes and rectangles */

	struct rb_queue *queue; /* [n] bodies, [n] clusters, 1 switch of forces */
	struct rb_cells *cells; /* NULL: few bodies, all are candidates */
	int *near;              /* [n] scratch */
	int *set;               /* [n] scratch: bodies that are dealt with together */
	int *place;             /* [n] a body's place in `set`, -1 between uses */
	int set_count;
	int come_a, come_b; /* the pair whose touch is dealt with, -1: none */
	struct rb_merge {
		int a, b;
		double recorded_s;
	} * merge; /* contacts that an accumulation of impacts has just ended in */
	int merge_count;
	size_t merge_capacity;
	double *switch_s; /* [switch_count] moments at which forces begin or end, ascending */
	int switch_count, switch_next;

	double weight;       /* m/s^2: |gravity| */
	double now_s, end_s; /* the event under way; the end of the run */
	double stuck_s;      /* events at one moment are counted */
	uint64_t stuck_count;
	uint64_t events, polled;
	uint64_t crowd;     /* bodies of crowds dealt with, less what time has allowed */
	uint64_t products;  /* arithmetic for what moves, since the step began */
	uint64_t crowd_max; /* more than these are left to steps; UINT64_MAX: whatever it costs */
	struct rb_arena *arena; /* borrowed: the world's first */
	struct rb_error *err;   /* of the advance under way */
	enum rb_status status;  /* of it: set once, then nothing goes on */
	bool started;
	bool starting; /* contacts that are found now have been there before: nothing to tell */
};

/* Values of a body in a piece: x, v and, where bodies turn, q, w. */
enum { RB_PIECE_POSITION = 0, RB_PIECE_VELOCITY = 3, RB_PIECE_ORIENTATION = 6, RB_PIECE_SPIN = 10 };
static inline int rb_located_row(const struct rb_located *l)
{
	return l->top ? 13 : 6;
}

/*
 * So many products count as dealing with a body once. That is a choice, with which some fifty boxes
 * that move together are left to steps; and arithmetic, not a clock: the same on every machine. A
 * row of a contact's in a product of a vector with the matrix, a look at a contact on a piece, and
 * at what pulls a body in flight, a call of a field's function, and a search for points where two
 * convex bodies touch, count as so many. A simulated second allows so many bodies, which take about
 * one.
 */
enum {
	RB_LOCATED_PRODUCTS = 100000,
	RB_LOCATED_ROW = 200,
	RB_LOCATED_INSPECTION = 400,
	RB_LOCATED_FLIGHT = 300,
	RB_LOCATED_FIELD = 1500,
	RB_LOCATED_SEARCH = 3000,
	RB_LOCATED_SERIES = 1000
};
enum { RB_LOCATED_SECOND = 10000 };

/* What is counted, in bodies. */
static inline uint64_t rb_located_crowd(const struct rb_located *l)
{
	return l->crowd + l->products / RB_LOCATED_PRODUCTS;
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

/* Of a vector with the matrix of so many contacts: how many until it is too dense; 0: no limit. */
static inline long rb_located_products(const struct rb_located *l, int contacts)
{
	const uint64_t crowd = rb_located_crowd(l), row = RB_LOCATED_PRODUCTS / RB_LOCATED_ROW;

	if (l->crowd_max == UINT64_MAX)
		return 0;
	const uint64_t left = crowd < l->crowd_max ? l->crowd_max - crowd : 0;

	return 1 + (long)(left * row / (uint64_t)(contacts > 0 ? contacts : 1));
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

static inline bool rb_located_on_piece(const struct rb_located *l, int i)
{
	return l->piece && i < l->n && l->piece[i].piece.n > 0;
}

#endif
