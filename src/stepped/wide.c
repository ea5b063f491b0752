/* SPDX-License-Identifier: MIT */
#include "stepped/wide.h"

#include <stddef.h>
#include <stdint.h>
#include <string.h>
#if defined(__SSE2__)
#include <emmintrin.h>
#endif

enum { WIDTH = 4 };
/* Packs that are one piece of work: as long as what the threads take to part and meet, or more. */
enum { BLOCK_CENTRAL_PACKS = 32, BLOCK_PACKS = 12 };

/*
 * Share of its last way that a row is led on by, at most, to begin with: more swings where rows
 * slide. Pressed: to the end.
 */
static const double lead_first = 0.98, lead_pressed = 0.995;

/*
 * Sweeps after which rows are led on by less, unless the largest change has fallen to this share
 * meanwhile. Where it stays the same so many times in succession, impulses creep on for no end.
 */
enum { SWEEPS_WATCHED = 24, SAME_MAX = 4 };
static const double fall_share = 0.9, lead_growth = 1.5, same_share = 0.01;

/* Sweeps by which it is known how fast the largest change falls, and what there is to be left. */
enum { SWEEPS_COMPARED = 8 };

/*
 * Four numbers, one of each row: vectors of GCC and Clang, in halves where registers are no wider,
 * to the same bits. They are passed by address, since how they are passed by value depends on the
 * registers.
 */
typedef double lanes __attribute__((vector_size(WIDTH * sizeof(double)), aligned(8)));
typedef int64_t mask __attribute__((vector_size(WIDTH * sizeof(int64_t)), aligned(8)));
#define ALWAYS static inline __attribute__((always_inline))

struct lanes3 {
	lanes x, y, z;
};

/*
 * What rows are, and what they have come to. Lanes without a row have inverses, friction and
 * impulses of zero.
 */
struct rb_wide_pack {
	int a[WIDTH], b[WIDTH];
	bool writes_a[WIDTH],
		writes_b[WIDTH]; /* what does not yield may be shared: not written to */
	struct lanes3 normal;
	lanes arm_a, arm_b; /* m, along the normal */
	lanes inverse_mass_n, inverse_mass_t, inverse_n, inverse_t;
	lanes target_velocity, friction;
	lanes normal_impulse;
	struct lanes3 friction_impulse;
	lanes least;         /* N s, normal: 0, or what holds the friction */
	struct lanes3 extra; /* N s: what the impulse was led on by, then all of its last way */
	lanes count;         /* of sweeps that went one way */
};

/* What else rows have that are not central. */
struct rb_wide_turn {
	struct lanes3 arm_a, arm_b; /* m */
	struct lanes3 skew;         /* 1/kg: slip that an impulse along the normal makes */
};

/*
 * Inverse tensors, 1/(kg m^2), xx xy xz yy yz zz; apart, since bodies with one moment of inertia,
 * as cubes are, need none: rows are read twice in each sweep, and heaps of them come from afar.
 */
struct rb_wide_tensors {
	lanes of_a[6], of_b[6];
};

/* Of a pack that is not central; `tensors` is NULL where all inertias are multiples of one. */
struct turns {
	const struct rb_wide_turn *turn;
	const struct rb_wide_tensors *tensors;
};

/* Four bodies. */
struct four {
	struct lanes3 linear, angular;
	lanes inverse_mass, inverse_inertia;
};

/* ---- arithmetic ---- */

#define CHOOSE(where, yes, no) ((lanes)(((where) & (mask)(yes)) | (~(where) & (mask)(no))))
#define DOT(p, q) ((p).x * (q).x + (p).y * (q).y + (p).z * (q).z)
#if defined(__clang__)
#define SHUFFLE(p, q, i, j, k, l) __builtin_shufflevector(p, q, i, j, k, l)
#else
#define SHUFFLE(p, q, i, j, k, l) __builtin_shuffle(p, q, (mask){i, j, k, l})
#endif

/* Halves of a body as they stand in it; loaded and stored whole, and turned round in registers. */
typedef double half_body
	__attribute__((vector_size(WIDTH * sizeof(double)), aligned(8), may_alias));

_Static_assert(offsetof(struct rb_solver_body, angular) == 3 * sizeof(double) &&
                       offsetof(struct rb_solver_body, inverse_mass) == 6 * sizeof(double) &&
                       sizeof(struct rb_solver_body) == 2 * sizeof(half_body),
               "a body is two halves of four numbers");

/* Rows of four become columns, and the other way round. */
ALWAYS void transpose(lanes *p, lanes *q, lanes *r, lanes *s)
{
	const lanes a = SHUFFLE(*p, *q, 0, 4, 2, 6), b = SHUFFLE(*p, *q, 1, 5, 3, 7);
	const lanes c = SHUFFLE(*r, *s, 0, 4, 2, 6), d = SHUFFLE(*r, *s, 1, 5, 3, 7);

	*p = SHUFFLE(a, c, 0, 1, 4, 5);
	*q = SHUFFLE(b, d, 0, 1, 4, 5);
	*r = SHUFFLE(a, c, 2, 3, 6, 7);
	*s = SHUFFLE(b, d, 2, 3, 6, 7);
}

ALWAYS void take(struct four *four, const struct rb_solver_body *body, const int *which)
{
	const half_body *const p = (const half_body *)&body[which[0]];
	const half_body *const q = (const half_body *)&body[which[1]];
	const half_body *const r = (const half_body *)&body[which[2]];
	const half_body *const s = (const half_body *)&body[which[3]];

	four->linear = (struct lanes3){p[0], q[0], r[0]};
	four->angular.x = s[0];
	transpose(&four->linear.x, &four->linear.y, &four->linear.z, &four->angular.x);
	four->angular.y = p[1];
	four->angular.z = q[1];
	four->inverse_mass = r[1];
	four->inverse_inertia = s[1];
	transpose(&four->angular.y, &four->angular.z, &four->inverse_mass, &four->inverse_inertia);
}

ALWAYS void give_one(struct rb_solver_body *body, const lanes *first, const lanes *second)
{
	half_body *const half = (half_body *)body;

	half[0] = *first;
	half[1] = *second;
}

/* `four` is turned round, and of no use afterwards. */
ALWAYS void give(struct four *four, struct rb_solver_body *body, const int *which,
                 const bool *writes)
{
	transpose(&four->linear.x, &four->linear.y, &four->linear.z, &four->angular.x);
	transpose(&four->angular.y, &four->angular.z, &four->inverse_mass, &four->inverse_inertia);
	if (writes[0])
		give_one(&body[which[0]], &four->linear.x, &four->angular.y);
	if (writes[1])
		give_one(&body[which[1]], &four->linear.y, &four->angular.z);
	if (writes[2])
		give_one(&body[which[2]], &four->linear.z, &four->inverse_mass);
	if (writes[3])
		give_one(&body[which[3]], &four->angular.x, &four->inverse_inertia);
}

/* Whether a lane is set. */
ALWAYS bool any(const mask *m)
{
#if defined(__SSE2__)
	return _mm_movemask_epi8((__m128i){(*m)[0], (*m)[1]} | (__m128i){(*m)[2], (*m)[3]}) != 0;
#else
	return ((*m)[0] | (*m)[1] | (*m)[2] | (*m)[3]) != 0;
#endif
}

ALWAYS void root(lanes *r, const lanes *x)
{
#if defined(__SSE2__)
	const __m128d low = _mm_sqrt_pd((__m128d){(*x)[0], (*x)[1]});
	const __m128d high = _mm_sqrt_pd((__m128d){(*x)[2], (*x)[3]});

	*r = (lanes){low[0], low[1], high[0], high[1]};
#else
	for (int i = 0; i < WIDTH; i++)
		(*r)[i] = sqrt((*x)[i]);
#endif
}

ALWAYS void cross(struct lanes3 *r, const struct lanes3 *p, const struct lanes3 *q)
{
	r->x = p->y * q->z - p->z * q->y;
	r->y = p->z * q->x - p->x * q->z;
	r->z = p->x * q->y - p->y * q->x;
}

ALWAYS void apply(struct lanes3 *r, const lanes *tensor, const struct lanes3 *p)
{
	r->x = tensor[0] * p->x + tensor[1] * p->y + tensor[2] * p->z;
	r->y = tensor[1] * p->x + tensor[3] * p->y + tensor[4] * p->z;
	r->z = tensor[2] * p->x + tensor[4] * p->y + tensor[5] * p->z;
}

/* What an impulse at their points turns bodies by. */
ALWAYS void turn_central(const struct rb_wide_pack *pack, struct four *a, struct four *b,
                         const struct lanes3 *across)
{
	const lanes turn_a = a->inverse_inertia * pack->arm_a;
	const lanes turn_b = b->inverse_inertia * pack->arm_b;
	struct lanes3 torque;

	cross(&torque, &pack->normal, across);
	a->angular.x -= turn_a * torque.x;
	a->angular.y -= turn_a * torque.y;
	a->angular.z -= turn_a * torque.z;
	b->angular.x += turn_b * torque.x;
	b->angular.y += turn_b * torque.y;
	b->angular.z += turn_b * torque.z;
}

/* What a torque turns four bodies by: by their tensors, if there are any. */
ALWAYS void turn_by(struct lanes3 *w, const struct four *four, const lanes *tensor,
                    const struct lanes3 *torque)
{
	if (tensor)
		apply(w, tensor, torque);
	else
		*w = (struct lanes3){four->inverse_inertia * torque->x,
		                     four->inverse_inertia * torque->y,
		                     four->inverse_inertia * torque->z};
}

ALWAYS void turn_any(const struct turns *turns, struct four *a, struct four *b,
                     const struct lanes3 *impulse)
{
	const struct rb_wide_tensors *const tensors = turns->tensors;
	struct lanes3 torque, w;

	cross(&torque, &turns->turn->arm_a, impulse);
	turn_by(&w, a, tensors ? tensors->of_a : NULL, &torque);
	a->angular.x -= w.x;
	a->angular.y -= w.y;
	a->angular.z -= w.z;
	cross(&torque, &turns->turn->arm_b, impulse);
	turn_by(&w, b, tensors ? tensors->of_b : NULL, &torque);
	b->angular.x += w.x;
	b->angular.y += w.y;
	b->angular.z += w.z;
}

/*
 * Adds an impulse along the normal and one across it. `turns` has no `turn` where rows are central,
 * here as below.
 */
ALWAYS void apply_impulse(const struct rb_wide_pack *pack, const struct turns *turns,
                          struct four *a, struct four *b, const lanes *along,
                          const struct lanes3 *across)
{
	const struct lanes3 impulse = {across->x + *along * pack->normal.x,
	                               across->y + *along * pack->normal.y,
	                               across->z + *along * pack->normal.z};

	a->linear.x -= a->inverse_mass * impulse.x;
	a->linear.y -= a->inverse_mass * impulse.y;
	a->linear.z -= a->inverse_mass * impulse.z;
	b->linear.x += b->inverse_mass * impulse.x;
	b->linear.y += b->inverse_mass * impulse.y;
	b->linear.z += b->inverse_mass * impulse.z;
	if (turns->turn)
		turn_any(turns, a, b, &impulse);
	else
		turn_central(pack, a, b, across);
}

/* ---- a pack ---- */

/* Velocity of b relative to a: along the normal, and across it. */
ALWAYS void inspect(const struct rb_wide_pack *pack, const struct rb_wide_turn *turn,
                    const struct four *a, const struct four *b, lanes *along, struct lanes3 *across)
{
	const struct lanes3 n = pack->normal;
	struct lanes3 u;

	if (turn) {
		struct lanes3 of_a;

		cross(&u, &b->angular, &turn->arm_b);
		cross(&of_a, &a->angular, &turn->arm_a);
		u = (struct lanes3){u.x - of_a.x, u.y - of_a.y, u.z - of_a.z};
	} else {
		const struct lanes3 w = {pack->arm_b * b->angular.x - pack->arm_a * a->angular.x,
		                         pack->arm_b * b->angular.y - pack->arm_a * a->angular.y,
		                         pack->arm_b * b->angular.z - pack->arm_a * a->angular.z};

		cross(&u, &w, &n);
	}
	u.x += b->linear.x - a->linear.x;
	u.y += b->linear.y - a->linear.y;
	u.z += b->linear.z - a->linear.z;
	*along = DOT(u, n);
	*across = (struct lanes3){u.x - *along * n.x, u.y - *along * n.y, u.z - *along * n.z};
}

/*
 * Each row on its own, as in stepped/gauss_seidel. `largest` becomes at least the squares of what
 * the rows' velocities changed by.
 */
ALWAYS void solve_pack(struct rb_solver_body *body, struct rb_wide_pack *pack,
                       const struct turns *turns, lanes *largest)
{
	const struct rb_wide_turn *const turn = turns->turn;
	const lanes none = {0, 0, 0, 0}, one = {1, 1, 1, 1};
	struct four a, b;
	lanes along, more, ratio, change;
	struct lanes3 slip, d;

	take(&a, body, pack->a);
	take(&b, body, pack->b);
	inspect(pack, turn, &a, &b, &along, &slip);
	along = pack->normal_impulse + (pack->target_velocity - along) * pack->inverse_n;
	along = CHOOSE(along > pack->least, along, pack->least);
	const mask acts = (along > none) | (pack->normal_impulse != none);
	if (!any(&acts))
		return;
	more = along - pack->normal_impulse;
	if (turn) {
		slip.x += more * turn->skew.x;
		slip.y += more * turn->skew.y;
		slip.z += more * turn->skew.z;
	}
	struct lanes3 friction_impulse = {pack->friction_impulse.x - pack->inverse_t * slip.x,
	                                  pack->friction_impulse.y - pack->inverse_t * slip.y,
	                                  pack->friction_impulse.z - pack->inverse_t * slip.z};
	const lanes square = DOT(friction_impulse, friction_impulse), max = pack->friction * along;
	const mask slides = square > max * max;
	if (any(&slides)) {
		root(&ratio, &square);
		ratio = max / ratio;
		ratio = CHOOSE(slides, ratio, one);
		friction_impulse = (struct lanes3){ratio * friction_impulse.x,
		                                   ratio * friction_impulse.y,
		                                   ratio * friction_impulse.z};
	}
	d = (struct lanes3){friction_impulse.x - pack->friction_impulse.x,
	                    friction_impulse.y - pack->friction_impulse.y,
	                    friction_impulse.z - pack->friction_impulse.z};
	/* its sign only: whether the row goes on as it was led */
	const lanes goes = more * DOT(pack->extra, pack->normal) + DOT(pack->extra, d);
	pack->count = CHOOSE(goes < none, 0.5 * pack->count, pack->count + CHOOSE(acts, one, none));
	pack->extra.x += d.x + more * pack->normal.x;
	pack->extra.y += d.y + more * pack->normal.y;
	pack->extra.z += d.z + more * pack->normal.z;
	pack->normal_impulse = along;
	pack->friction_impulse = friction_impulse;
	apply_impulse(pack, turns, &a, &b, &more, &d);
	give(&a, body, pack->a, pack->writes_a);
	give(&b, body, pack->b, pack->writes_b);
	more *= pack->inverse_mass_n;
	change = DOT(d, d) * (RB_SLIP_SHARE * RB_SLIP_SHARE) * pack->inverse_mass_t *
	         pack->inverse_mass_t;
	more *= more;
	change = CHOOSE(change > more, change, more);
	*largest = CHOOSE(change > *largest, change, *largest);
}

/* Leads the impulses on; the sweep that comes next projects back onto the cone. */
ALWAYS void lead_pack(struct rb_solver_body *body, struct rb_wide_pack *pack,
                      const struct turns *turns, double lead_max)
{
	const lanes max = {lead_max, lead_max, lead_max, lead_max};
	const struct lanes3 n = pack->normal;
	const lanes gathered = pack->count / (pack->count + 3);
	const lanes share = CHOOSE(gathered > max, max, gathered);
	const struct lanes3 extra = {share * pack->extra.x, share * pack->extra.y,
	                             share * pack->extra.z};
	const lanes along = DOT(extra, n);
	const struct lanes3 across = {extra.x - along * n.x, extra.y - along * n.y,
	                              extra.z - along * n.z};
	const mask moves = (extra.x != 0) | (extra.y != 0) | (extra.z != 0);
	struct four a, b;

	pack->extra = extra;
	if (!any(&moves))
		return;
	pack->normal_impulse += along;
	pack->friction_impulse = (struct lanes3){pack->friction_impulse.x + across.x,
	                                         pack->friction_impulse.y + across.y,
	                                         pack->friction_impulse.z + across.z};
	take(&a, body, pack->a);
	take(&b, body, pack->b);
	apply_impulse(pack, turns, &a, &b, &along, &across);
	give(&a, body, pack->a, pack->writes_a);
	give(&b, body, pack->b, pack->writes_b);
}

/* ---- packs, by blocks ---- */

/* Rows of this colour share bodies: each has a pack of its own, and all are one block. */
static bool is_tail(const struct rb_wide *wide, int colour)
{
	return wide->tail && colour == wide->colour_count - 1;
}

static int width_of(const struct rb_wide *wide, int colour)
{
	return is_tail(wide, colour) ? 1 : WIDTH;
}

/* What is done to every pack. */
enum task { SWEEP, FILL, LOAD, LOAD_HELD, STORE };

struct work {
	const struct rb_wide *wide;
	enum task task;
	double lead; /* of sweeps: first, leads on by this share at most; 0: solves only */
};

static void fill_lane(const struct rb_wide *wide, struct rb_wide_pack *pack, int i,
                      const struct rb_constraint *row)
{
	const struct rb_solver_body *body = wide->dense->bodies.body;

	pack->a[i] = row->a;
	pack->b[i] = row->b;
	pack->writes_a[i] = body[row->a].inverse_mass != 0;
	pack->writes_b[i] = body[row->b].inverse_mass != 0;
	pack->normal.x[i] = row->normal.x;
	pack->normal.y[i] = row->normal.y;
	pack->normal.z[i] = row->normal.z;
	pack->arm_a[i] = wide->turn ? 0 : row->arm_a.x;
	pack->arm_b[i] = wide->turn ? 0 : row->arm_b.x;
	pack->inverse_mass_n[i] = row->inverse_mass_n;
	pack->inverse_mass_t[i] = row->inverse_mass_t;
	pack->inverse_n[i] = 1 / row->inverse_mass_n;
	pack->target_velocity[i] = row->target.n;
	pack->friction[i] = row->friction;
}

static void fill_tensor(const struct rb_row_system *dense, int body, lanes *tensor, int i)
{
	const double inverse = dense->bodies.body[body].inverse_inertia;
	const rb_mat3 own = isnan(inverse) ? dense->bodies.tensor[body]
	                                   : rb_mat3_diagonal(inverse, inverse, inverse);

	tensor[0][i] = own.m[0][0];
	tensor[1][i] = own.m[0][1];
	tensor[2][i] = own.m[0][2];
	tensor[3][i] = own.m[1][1];
	tensor[4][i] = own.m[1][2];
	tensor[5][i] = own.m[2][2];
}

/* Velocity at the point by turning that a unit impulse along the normal makes. */
static rb_vec3 skew_of(const struct rb_row_system *dense, int body, rb_vec3 arm, rb_vec3 normal)
{
	if (dense->bodies.body[body].inverse_inertia == 0)
		return (rb_vec3){0, 0, 0};
	return rb_vec3_cross(rb_solver_turn(&dense->bodies, body, rb_vec3_cross(arm, normal)), arm);
}

static void fill_turn(const struct rb_wide *wide, struct rb_wide_turn *turn, int i,
                      const struct rb_constraint *row)
{
	const rb_vec3 arm_a = rb_constraint_arm_a(row), arm_b = rb_constraint_arm_b(row);

	turn->arm_a.x[i] = arm_a.x;
	turn->arm_a.y[i] = arm_a.y;
	turn->arm_a.z[i] = arm_a.z;
	turn->arm_b.x[i] = arm_b.x;
	turn->arm_b.y[i] = arm_b.y;
	turn->arm_b.z[i] = arm_b.z;
	const rb_vec3 skew = rb_vec3_reject(
		rb_vec3_add(skew_of(wide->dense, row->a, arm_a, row->normal),
	                    skew_of(wide->dense, row->b, arm_b, row->normal)),
		row->normal);
	turn->skew.x[i] = skew.x;
	turn->skew.y[i] = skew.y;
	turn->skew.z[i] = skew.z;
}

static void load_lane(struct rb_wide_pack *pack, int i, const struct rb_constraint *row, bool holds)
{
	const bool has_friction = row->friction > 0;

	pack->normal_impulse[i] = row->impulse.n;
	pack->friction_impulse.x[i] = row->impulse.t.x;
	pack->friction_impulse.y[i] = row->impulse.t.y;
	pack->friction_impulse.z[i] = row->impulse.t.z;
	pack->extra.x[i] = pack->extra.y[i] = pack->extra.z[i] = 0;
	pack->count[i] = 0;
	pack->inverse_t[i] = has_friction && !holds ? 1 / row->inverse_mass_t : 0;
	pack->least[i] = has_friction && holds ? rb_vec3_length(row->impulse.t) / row->friction : 0;
}

static void store_lane(const struct rb_wide_pack *pack, int i, struct rb_constraint *row)
{
	row->impulse.n = pack->normal_impulse[i];
	row->impulse.t = (rb_vec3){pack->friction_impulse.x[i], pack->friction_impulse.y[i],
	                           pack->friction_impulse.z[i]};
}

/* The rows of a pack are those of its colour from `at` on, as far as there are. */
static void carry_pack(const struct rb_wide *wide, int k, enum task task, int at, int count)
{
	struct rb_wide_pack *const pack = &wide->pack[k];
	struct rb_wide_turn *const turn = wide->turn ? &wide->turn[k] : NULL;

	struct rb_wide_tensors *const tensors = wide->tensors ? &wide->tensors[k] : NULL;

	if (task == FILL && turn)
		*turn = (struct rb_wide_turn){.arm_a = {.x = {0}}};
	if (task == FILL && tensors)
		*tensors = (struct rb_wide_tensors){.of_a = {{0}}};
	if (task == FILL) {
		*pack = (struct rb_wide_pack){.count = {0}};
		for (int i = 0; i < WIDTH; i++)
			pack->a[i] = pack->b[i] = wide->fixed;
	}
	for (int i = 0; i < count; i++) {
		struct rb_constraint *row = &wide->dense->row[wide->order[at + i]];

		if (task == FILL)
			fill_lane(wide, pack, i, row);
		if (task == FILL && tensors) {
			fill_tensor(wide->dense, row->a, tensors->of_a, i);
			fill_tensor(wide->dense, row->b, tensors->of_b, i);
		}
		if (task == FILL && turn)
			fill_turn(wide, turn, i, row);
		else if (task == STORE)
			store_lane(pack, i, row);
		else
			load_lane(pack, i, row, task == LOAD_HELD);
	}
}

static void carry_packs(const struct rb_wide *wide, enum task task, int colour, int first, int end)
{
	const int width = width_of(wide, colour);

	for (int k = first; k < end; k++) {
		const int at = wide->colour[colour] + width * (k - wide->first[colour]);
		const int left = wide->colour[colour + 1] - at;

		carry_pack(wide, k, task, at, left < width ? left : width);
	}
}

/* Whether rows are central, and inertias multiples of one. */
enum kind { CENTRAL, MULTIPLES, TENSORS };

ALWAYS double larger(double a, double b)
{
	return a > b ? a : b;
}

ALWAYS double run_kind(const struct rb_wide *wide, enum kind kind, double lead, int first, int end)
{
	struct rb_solver_body *body = wide->dense->bodies.body;
	lanes largest = {0, 0, 0, 0};

	for (int k = first; k < end; k++) {
		const struct turns turns = {kind != CENTRAL ? &wide->turn[k] : NULL,
		                            kind == TENSORS ? &wide->tensors[k] : NULL};

		if (lead > 0)
			lead_pack(body, &wide->pack[k], &turns, lead);
		else
			solve_pack(body, &wide->pack[k], &turns, &largest);
	}
	return larger(larger(largest[0], largest[1]), larger(largest[2], largest[3]));
}

/* Each kind has code of its own. */
ALWAYS double run_packs(const struct rb_wide *wide, double lead, int first, int end)
{
	if (!wide->turn)
		return run_kind(wide, CENTRAL, lead, first, end);
	return wide->tensors ? run_kind(wide, TENSORS, lead, first, end)
	                     : run_kind(wide, MULTIPLES, lead, first, end);
}

static double run_plain(const struct rb_wide *wide, double lead, int first, int end)
{
	return run_packs(wide, lead, first, end);
}

#if defined(__x86_64__)
/* The same operations in wider registers. */
__attribute__((target("avx2"))) static double run_avx2(const struct rb_wide *wide, double lead,
                                                       int first, int end)
{
	return run_packs(wide, lead, first, end);
}
#endif

static int block_packs(const struct rb_wide *wide, int colour)
{
	return is_tail(wide, colour) ? wide->first[colour + 1] - wide->first[colour]
	       : wide->central       ? BLOCK_CENTRAL_PACKS
	                             : BLOCK_PACKS;
}

static void run_colour(const struct work *work, int c, int block, double lead)
{
	const struct rb_wide *wide = work->wide;
	const int max = block_packs(wide, c);
	const int first = wide->first[c] + block * max;
	const int end = first + max < wide->first[c + 1] ? first + max : wide->first[c + 1];
	double change;

	if (work->task != SWEEP) {
		carry_packs(wide, work->task, c, first, end);
		return;
	}
#if defined(__x86_64__)
	if (__builtin_cpu_supports("avx2"))
		change = run_avx2(wide, lead, first, end);
	else
#endif
		change = run_plain(wide, lead, first, end);
	if (lead == 0)
		wide->partial[wide->first_block[c] + block] = change;
}

/*
 * A phase is a colour, or several in succession of one block each, for which threads need not wait
 * for each other: those that lead on come first, if any.
 */
static void run_block(void *user, int phase, int block, int worker)
{
	const struct work *work = user;
	const struct rb_wide *wide = work->wide;
	const bool leads = work->lead > 0 && phase < wide->phase_count;
	const int p = work->lead > 0 && !leads ? phase - wide->phase_count : phase;

	(void)worker;
	for (int c = wide->phase[p]; c < wide->phase[p + 1]; c++)
		run_colour(work, c, block, leads ? work->lead : 0);
}

static void run_all(const struct rb_wide *wide, enum task task, double lead)
{
	struct work work = {.wide = wide, .task = task, .lead = lead};
	const int phases = (lead > 0 ? 2 : 1) * wide->phase_count;

	if (wide->team)
		rb_team_run_phases(wide->team, wide->blocks, phases, run_block, &work);
	else
		for (int p = 0; p < phases; p++)
			for (int b = 0; b < wide->blocks[p]; b++)
				run_block(&work, p, b, 0);
}

/*
 * Leads on, if asked to, and solves all rows; returns the largest change of a row's velocity, m/s.
 */
static double sweep_all(const struct rb_wide *wide, double lead)
{
	double max = 0;

	run_all(wide, SWEEP, lead);
	for (int b = 0; b < wide->first_block[wide->colour_count]; b++)
		max = larger(max, wide->partial[b]);
	return sqrt(max);
}

size_t rb_wide_row_bytes(bool central, bool tensors)
{
	return (sizeof(struct rb_wide_pack) + (central ? 0 : sizeof(struct rb_wide_turn)) +
	        (!central && tensors ? sizeof(struct rb_wide_tensors) : 0)) /
	       WIDTH;
}

/* Whether some body of a row has an inertia that is no multiple of one. */
static bool has_tensors(const struct rb_row_system *dense)
{
	const struct rb_solver_body *const body = dense->bodies.body;
	bool any = false;

	for (int k = 0; dense->bodies.tensor && k < dense->row_count && !any; k++)
		any = isnan(body[dense->row[k].a].inverse_inertia) ||
		      isnan(body[dense->row[k].b].inverse_inertia);
	return any;
}

/* Phases, once blocks of colours are known. */
static void part_phases(struct rb_wide *wide)
{
	int count = 0;

	for (int c = 0; c < wide->colour_count; c++) {
		const int blocks = wide->first_block[c + 1] - wide->first_block[c];
		const bool goes_on = count > 0 && blocks == 1 && wide->blocks[count - 1] == 1;

		if (goes_on)
			continue;
		wide->phase[count] = c;
		wide->blocks[count++] = blocks;
	}
	wide->phase[count] = wide->colour_count;
	wide->phase_count = count;
	memcpy(wide->blocks + count, wide->blocks, (size_t)count * sizeof *wide->blocks);
}

bool rb_wide_take(struct rb_wide *wide, struct rb_arena *arena)
{
	const int colours = wide->colour_count;
	int packs = 0, blocks = 0;

	wide->first = rb_arena_take(arena, (size_t)colours + 1, sizeof *wide->first);
	wide->first_block = rb_arena_take(arena, (size_t)colours + 1, sizeof *wide->first_block);
	wide->phase = rb_arena_take(arena, (size_t)colours + 1, sizeof *wide->phase);
	wide->blocks = rb_arena_take(arena, 2 * (size_t)colours, sizeof *wide->blocks);
	if (!wide->first || !wide->first_block || !wide->phase || !wide->blocks)
		return false;
	for (int c = 0; c < colours; c++) {
		const int width = width_of(wide, c);
		const int more = (wide->colour[c + 1] - wide->colour[c] + width - 1) / width;

		wide->first[c] = packs;
		wide->first[c + 1] = packs + more;
		wide->first_block[c] = blocks;
		blocks += more == 0 ? 0 : (more - 1) / block_packs(wide, c) + 1;
		packs += more;
	}
	wide->first[colours] = packs;
	wide->first_block[colours] = blocks;
	part_phases(wide);
	wide->pack = rb_arena_take(arena, (size_t)packs, sizeof *wide->pack);
	wide->partial = rb_arena_take(arena, (size_t)blocks, sizeof *wide->partial);
	const bool tensors = !wide->central && has_tensors(wide->dense);
	wide->turn = NULL;
	wide->tensors = NULL;
	if (!wide->central)
		wide->turn = rb_arena_take(arena, (size_t)packs, sizeof *wide->turn);
	if (tensors)
		wide->tensors = rb_arena_take(arena, (size_t)packs, sizeof *wide->tensors);
	if (!wide->pack || !wide->partial || (!wide->central && !wide->turn) ||
	    (tensors && !wide->tensors))
		return false;
	run_all(wide, FILL, 0);
	return true;
}

/* Least changes of the last SWEEPS_COMPARED sweeps, and of as many before them, m/s. */
struct fall {
	double least, before;
};

/* Within the slack, and not below the tolerance in half of the sweeps left if it falls so. */
static bool creeps(const struct rb_wide *wide, struct fall *fall,
                   const struct rb_sweep_result *result, double tolerance, int max)
{
	fall->least = fmin(fall->least, result->residual);
	if (result->sweeps % SWEEPS_COMPARED != 0)
		return false;
	const double share = fall->least / fall->before; /* 0 to begin with */
	const bool is_near = fall->before < (double)INFINITY &&
	                     result->residual <= wide->slack * tolerance;
	double then = fall->least;

	for (int k = 0; is_near && k < (max - result->sweeps) / (2 * SWEEPS_COMPARED); k++)
		then *= share;
	*fall = (struct fall){(double)INFINITY, fall->least};
	return is_near && then > tolerance;
}

struct rb_sweep_result rb_wide_solve(const struct rb_wide *wide, double tolerance, int max,
                                     enum rb_wide_start start)
{
	struct rb_sweep_result result = {0};
	const bool gathered = start == RB_WIDE_GOES_ON || start == RB_WIDE_PRESSES_ON;
	int same = 0;
	const bool presses = start == RB_WIDE_PRESSES_ON;
	double lead = presses ? lead_pressed : lead_first, least = (double)INFINITY,
	       before = (double)INFINITY;
	struct fall fall = {(double)INFINITY, (double)INFINITY};

	if (!gathered)
		run_all(wide, start == RB_WIDE_HOLDS ? LOAD_HELD : LOAD, 0);
	while (result.sweeps < max) {
		result.residual = sweep_all(wide, result.sweeps > 0 || gathered ? lead : 0);
		result.sweeps++;
		if (result.residual <= tolerance ||
		    rb_interrupt_after(wide->interrupt,
		                       RB_SWEEP_WORK * (uint64_t)wide->dense->row_count) ||
		    creeps(wide, &fall, &result, tolerance, max))
			break;
		least = fmin(least, result.residual);
		if (!presses && result.sweeps % SWEEPS_WATCHED == 0) {
			if (least > fall_share * before)
				lead = fmax(0, 1 - lead_growth * (1 - lead));
			same = fabs(least - before) < same_share * before ? same + 1 : 0;
			if (same == SAME_MAX)
				break;
			before = least;
			least = (double)INFINITY;
		}
	}
	run_all(wide, STORE, 0);
	return result;
}
