/* SPDX-License-Identifier: MIT */
/*
 * Arithmetic of packs (stepped/packs), for the source that includes it: SINGLE selects 32 or 64
 * bits.
 */
#ifndef RB_STEPPED_PACK_KERNEL_H
#define RB_STEPPED_PACK_KERNEL_H

#include <float.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#if defined(__SSE2__)
#include <emmintrin.h>
#endif

#include "base/error.h"
#include "stepped/packs.h"
#include "stepped/wide.h"

#if SINGLE
typedef float real;
typedef int32_t choice;
enum { WIDTH = 8 };
#define REAL_MAX FLT_MAX
#else
typedef double real;
typedef int64_t choice;
enum { WIDTH = 4 };
#define REAL_MAX DBL_MAX
#endif

/*
 * Vectors of GCC and Clang with one number of each row, split in halves where registers are no
 * wider, with the same bits. They are passed by address, since passing by value depends on the
 * registers.
 */
typedef real lanes __attribute__((vector_size(32), aligned(8)));
typedef choice mask __attribute__((vector_size(32), aligned(8)));
typedef int64_t words __attribute__((vector_size(32), aligned(8)));
#define ALWAYS static inline __attribute__((always_inline))

struct lanes3 {
	lanes x, y, z;
};

/* Constants and state of rows. Lanes without a row have inverses, friction and impulses of zero. */
struct pack {
	int a[WIDTH], b[WIDTH];
	bool writes_a[WIDTH],
		writes_b[WIDTH]; /* static bodies may be shared between threads: not written to */
	struct lanes3 normal;
	lanes arm_a, arm_b; /* m, along the normal; not central: their x, `turn` has the rest */
	lanes inverse_mass_n, inverse_mass_t, inverse_n;
	/*
	 * kg; where friction is held, negative: N s, the least normal impulse, whose cone contains
	 * it
	 */
	lanes inverse_t;
	lanes target_velocity, friction;
	lanes normal_impulse;
	struct lanes3 friction_impulse;
	struct lanes3
		last_change; /* N s: extrapolation of the impulse, then its total last change */
	lanes count;         /* of sweeps in one direction */
};

/* Further constants of rows that are not central. */
struct turn {
	lanes arm_a[2], arm_b[2]; /* m: y and z */
	struct lanes3 skew;       /* 1/kg: slip per unit of normal impulse */
};

/*
 * Inverse inertia tensors, 1/(kg m^2), xx xy xz yy yz zz; apart, since bodies with scalar inertia,
 * such as cubes, need none: rows are read twice in each sweep, and those of heaps are not in the
 * cache.
 */
struct tensors {
	lanes of_a[6], of_b[6];
};

/* Rotational data of a pack that is not central; `tensors` is NULL if all inertias are scalar. */
struct turns {
	const struct turn *turn;
	const struct tensors *tensors;
};

/* Bodies, one of each row. */
struct bodies {
	struct lanes3 linear, angular;
	lanes inverse_mass, inverse_inertia;
};

/* ---- arithmetic ---- */

#define CHOOSE(where, yes, no) ((lanes)(((where) & (mask)(yes)) | (~(where) & (mask)(no))))
#define DOT(p, q) ((p).x * (q).x + (p).y * (q).y + (p).z * (q).z)
#if defined(__clang__)
#define SHUFFLE(p, q, ...) __builtin_shufflevector(p, q, __VA_ARGS__)
#else
#define SHUFFLE(p, q, ...) __builtin_shuffle(p, q, (mask){__VA_ARGS__})
#endif

#if SINGLE
/* A body in memory: linear, angular, inverse mass, inverse inertia. */
typedef float whole_body __attribute__((vector_size(32), aligned(32), may_alias));

ALWAYS void pairs(lanes *p, lanes *q)
{
	const lanes low = SHUFFLE(*p, *q, 0, 8, 1, 9, 4, 12, 5, 13);

	*q = SHUFFLE(*p, *q, 2, 10, 3, 11, 6, 14, 7, 15);
	*p = low;
}

ALWAYS void quads(lanes *p, lanes *q)
{
	const lanes low = SHUFFLE(*p, *q, 0, 1, 8, 9, 4, 5, 12, 13);

	*q = SHUFFLE(*p, *q, 2, 3, 10, 11, 6, 7, 14, 15);
	*p = low;
}

ALWAYS void ends(lanes *p, lanes *q)
{
	const lanes low = SHUFFLE(*p, *q, 0, 1, 2, 3, 8, 9, 10, 11);

	*q = SHUFFLE(*p, *q, 4, 5, 6, 7, 12, 13, 14, 15);
	*p = low;
}

/* Transposes rows and columns: from bodies in memory, and back. */
ALWAYS void transpose(struct bodies *bodies)
{
	lanes *const x = &bodies->linear.x, *const y = &bodies->linear.y;
	lanes *const z = &bodies->linear.z, *const u = &bodies->angular.x;
	lanes *const v = &bodies->angular.y, *const w = &bodies->angular.z;
	lanes *const m = &bodies->inverse_mass, *const i = &bodies->inverse_inertia;
	lanes swap;

	pairs(x, y);
	pairs(z, u);
	pairs(v, w);
	pairs(m, i);
	quads(x, z);
	quads(y, u);
	quads(v, m);
	quads(w, i);
	ends(x, v);
	ends(z, m);
	ends(y, w);
	ends(u, i);
	/* rows are now x z y u, v m w i */
	swap = *y;
	*y = *z;
	*z = swap;
	swap = *w;
	*w = *m;
	*m = swap;
}

typedef float (*body_rows)[8];

#define ROW(k) ((lanes) * (const whole_body *)body[which[k]])

ALWAYS void gather(struct bodies *bodies, body_rows body, const int *which)
{
	bodies->linear = (struct lanes3){ROW(0), ROW(1), ROW(2)};
	bodies->angular = (struct lanes3){ROW(3), ROW(4), ROW(5)};
	bodies->inverse_mass = ROW(6);
	bodies->inverse_inertia = ROW(7);
	transpose(bodies);
}

ALWAYS void scatter_one(body_rows body, int i, bool writes, const lanes *row)
{
	if (writes)
		*(whole_body *)body[i] = (whole_body)*row;
}

/* `bodies` is transposed, and invalid afterwards. */
ALWAYS void scatter(struct bodies *bodies, body_rows body, const int *which, const bool *writes)
{
	transpose(bodies);
	scatter_one(body, which[0], writes[0], &bodies->linear.x);
	scatter_one(body, which[1], writes[1], &bodies->linear.y);
	scatter_one(body, which[2], writes[2], &bodies->linear.z);
	scatter_one(body, which[3], writes[3], &bodies->angular.x);
	scatter_one(body, which[4], writes[4], &bodies->angular.y);
	scatter_one(body, which[5], writes[5], &bodies->angular.z);
	scatter_one(body, which[6], writes[6], &bodies->inverse_mass);
	scatter_one(body, which[7], writes[7], &bodies->inverse_inertia);
}

static body_rows rows_of(const struct rb_wide *wide, const struct rb_packs *packs)
{
	(void)wide;
	return packs->body;
}
#else
/* Halves of a body as in memory; loaded and stored whole, and transposed in registers. */
typedef double half_body
	__attribute__((vector_size(WIDTH * sizeof(double)), aligned(8), may_alias));

_Static_assert(offsetof(struct rb_solver_body, angular) == 3 * sizeof(double) &&
                       offsetof(struct rb_solver_body, inverse_mass) == 6 * sizeof(double) &&
                       sizeof(struct rb_solver_body) == 2 * sizeof(half_body),
               "a body is two halves of four numbers");

/* Rows become columns, and the other way round. */
ALWAYS void transpose(lanes *p, lanes *q, lanes *r, lanes *s)
{
	const lanes a = SHUFFLE(*p, *q, 0, 4, 2, 6), b = SHUFFLE(*p, *q, 1, 5, 3, 7);
	const lanes c = SHUFFLE(*r, *s, 0, 4, 2, 6), d = SHUFFLE(*r, *s, 1, 5, 3, 7);

	*p = SHUFFLE(a, c, 0, 1, 4, 5);
	*q = SHUFFLE(b, d, 0, 1, 4, 5);
	*r = SHUFFLE(a, c, 2, 3, 6, 7);
	*s = SHUFFLE(b, d, 2, 3, 6, 7);
}

typedef struct rb_solver_body *body_rows;

ALWAYS void gather(struct bodies *bodies, body_rows body, const int *which)
{
	const half_body *const p = (const half_body *)&body[which[0]];
	const half_body *const q = (const half_body *)&body[which[1]];
	const half_body *const r = (const half_body *)&body[which[2]];
	const half_body *const s = (const half_body *)&body[which[3]];

	bodies->linear = (struct lanes3){p[0], q[0], r[0]};
	bodies->angular.x = s[0];
	transpose(&bodies->linear.x, &bodies->linear.y, &bodies->linear.z, &bodies->angular.x);
	bodies->angular.y = p[1];
	bodies->angular.z = q[1];
	bodies->inverse_mass = r[1];
	bodies->inverse_inertia = s[1];
	transpose(&bodies->angular.y, &bodies->angular.z, &bodies->inverse_mass,
	          &bodies->inverse_inertia);
}

ALWAYS void scatter_one(struct rb_solver_body *body, const lanes *first, const lanes *second)
{
	half_body *const half = (half_body *)body;

	half[0] = *first;
	half[1] = *second;
}

/* `bodies` is transposed, and invalid afterwards. */
ALWAYS void scatter(struct bodies *bodies, body_rows body, const int *which, const bool *writes)
{
	transpose(&bodies->linear.x, &bodies->linear.y, &bodies->linear.z, &bodies->angular.x);
	transpose(&bodies->angular.y, &bodies->angular.z, &bodies->inverse_mass,
	          &bodies->inverse_inertia);
	if (writes[0])
		scatter_one(&body[which[0]], &bodies->linear.x, &bodies->angular.y);
	if (writes[1])
		scatter_one(&body[which[1]], &bodies->linear.y, &bodies->angular.z);
	if (writes[2])
		scatter_one(&body[which[2]], &bodies->linear.z, &bodies->inverse_mass);
	if (writes[3])
		scatter_one(&body[which[3]], &bodies->angular.x, &bodies->inverse_inertia);
}

static body_rows rows_of(const struct rb_wide *wide, const struct rb_packs *packs)
{
	(void)packs;
	return wide->dense->bodies.body;
}
#endif

/* Whether any lane is set. */
ALWAYS bool any(const mask *lane)
{
	const words m = (words)*lane;

#if defined(__SSE2__)
	return _mm_movemask_epi8((__m128i){m[0], m[1]} | (__m128i){m[2], m[3]}) != 0;
#else
	return (m[0] | m[1] | m[2] | m[3]) != 0;
#endif
}

ALWAYS void square_root(lanes *r, const lanes *x)
{
#if defined(__SSE2__) && SINGLE
	const lanes p = *x;
	const __m128 low = _mm_sqrt_ps((__m128){p[0], p[1], p[2], p[3]});
	const __m128 high = _mm_sqrt_ps((__m128){p[4], p[5], p[6], p[7]});

	*r = (lanes){low[0], low[1], low[2], low[3], high[0], high[1], high[2], high[3]};
#elif defined(__SSE2__)
	const __m128d low = _mm_sqrt_pd((__m128d){(*x)[0], (*x)[1]});
	const __m128d high = _mm_sqrt_pd((__m128d){(*x)[2], (*x)[3]});

	*r = (lanes){low[0], low[1], high[0], high[1]};
#else
	for (int i = 0; i < WIDTH; i++)
		(*r)[i] = (real)sqrt((double)(*x)[i]);
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

/* Changes spins by an impulse at the contact points, for central rows. */
ALWAYS void turn_central(const struct pack *pack, struct bodies *a, struct bodies *b,
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

/* Change of spin by a torque, with the inertia tensors if there are any. */
ALWAYS void turn_by(struct lanes3 *w, const struct bodies *bodies, const lanes *tensor,
                    const struct lanes3 *torque)
{
	if (tensor)
		apply(w, tensor, torque);
	else
		*w = (struct lanes3){bodies->inverse_inertia * torque->x,
		                     bodies->inverse_inertia * torque->y,
		                     bodies->inverse_inertia * torque->z};
}

/* Arms of rows that are not central. */
ALWAYS void arms_of(const struct pack *pack, const struct turn *turn, struct lanes3 *a,
                    struct lanes3 *b)
{
	*a = (struct lanes3){pack->arm_a, turn->arm_a[0], turn->arm_a[1]};
	*b = (struct lanes3){pack->arm_b, turn->arm_b[0], turn->arm_b[1]};
}

ALWAYS void turn_any(const struct pack *pack, const struct turns *turns, struct bodies *a,
                     struct bodies *b, const struct lanes3 *impulse)
{
	const struct tensors *const tensors = turns->tensors;
	struct lanes3 arm_a, arm_b, torque, w;

	arms_of(pack, turns->turn, &arm_a, &arm_b);
	cross(&torque, &arm_a, impulse);
	turn_by(&w, a, tensors ? tensors->of_a : NULL, &torque);
	a->angular.x -= w.x;
	a->angular.y -= w.y;
	a->angular.z -= w.z;
	cross(&torque, &arm_b, impulse);
	turn_by(&w, b, tensors ? tensors->of_b : NULL, &torque);
	b->angular.x += w.x;
	b->angular.y += w.y;
	b->angular.z += w.z;
}

/*
 * Applies a normal and a tangential impulse. `turns` has no `turn` for central rows, here as below.
 */
ALWAYS void apply_impulse(const struct pack *pack, const struct turns *turns, struct bodies *a,
                          struct bodies *b, const lanes *along, const struct lanes3 *across)
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
		turn_any(pack, turns, a, b, &impulse);
	else
		turn_central(pack, a, b, across);
}

/* ---- a pack ---- */

/* Velocity of b relative to a: along the normal, and across it. */
ALWAYS void relative_velocity(const struct pack *pack, const struct turn *turn,
                              const struct bodies *a, const struct bodies *b, lanes *along,
                              struct lanes3 *across)
{
	const struct lanes3 n = pack->normal;
	struct lanes3 u;

	if (turn) {
		struct lanes3 arm_a, arm_b, velocity_a;

		arms_of(pack, turn, &arm_a, &arm_b);
		cross(&u, &b->angular, &arm_b);
		cross(&velocity_a, &a->angular, &arm_a);
		u = (struct lanes3){u.x - velocity_a.x, u.y - velocity_a.y, u.z - velocity_a.z};
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
 * Solves each row on its own, as in stepped/gauss_seidel. `largest` becomes at least the squares of
 * the rows' velocity changes.
 */
ALWAYS void solve_pack(body_rows body, struct pack *pack, const struct turns *turns, lanes *largest)
{
	const struct turn *const turn = turns->turn;
	const lanes none = {0}, one = none + 1;
	struct bodies a, b;
	lanes along, delta, ratio, change;
	struct lanes3 slip, d;

	gather(&a, body, pack->a);
	gather(&b, body, pack->b);
	relative_velocity(pack, turn, &a, &b, &along, &slip);
	along = pack->normal_impulse + (pack->target_velocity - along) * pack->inverse_n;
	const mask held = pack->inverse_t < none;
	const lanes normal_min = CHOOSE(held, -pack->inverse_t, none);
	const lanes inverse_t = CHOOSE(held, none, pack->inverse_t);
	along = CHOOSE(along > normal_min, along, normal_min);
	const mask acts = (along > none) | (pack->normal_impulse != none);
	if (!any(&acts))
		return;
	delta = along - pack->normal_impulse;
	if (turn) {
		slip.x += delta * turn->skew.x;
		slip.y += delta * turn->skew.y;
		slip.z += delta * turn->skew.z;
	}
	struct lanes3 friction_impulse = {pack->friction_impulse.x - inverse_t * slip.x,
	                                  pack->friction_impulse.y - inverse_t * slip.y,
	                                  pack->friction_impulse.z - inverse_t * slip.z};
	const lanes square = DOT(friction_impulse, friction_impulse), max = pack->friction * along;
	const mask slides = square > max * max;
	if (any(&slides)) {
		square_root(&ratio, &square);
		ratio = max / ratio;
		ratio = CHOOSE(slides, ratio, one);
		friction_impulse = (struct lanes3){ratio * friction_impulse.x,
		                                   ratio * friction_impulse.y,
		                                   ratio * friction_impulse.z};
	}
	d = (struct lanes3){friction_impulse.x - pack->friction_impulse.x,
	                    friction_impulse.y - pack->friction_impulse.y,
	                    friction_impulse.z - pack->friction_impulse.z};
	/* only its sign matters: whether the row continues in the direction of its extrapolation */
	const lanes progress = delta * DOT(pack->last_change, pack->normal) +
	                       DOT(pack->last_change, d);
	pack->count = CHOOSE(progress < none, (real)0.5 * pack->count,
	                     pack->count + CHOOSE(acts, one, none));
	pack->last_change.x += d.x + delta * pack->normal.x;
	pack->last_change.y += d.y + delta * pack->normal.y;
	pack->last_change.z += d.z + delta * pack->normal.z;
	pack->normal_impulse = along;
	pack->friction_impulse = friction_impulse;
	apply_impulse(pack, turns, &a, &b, &delta, &d);
	scatter(&a, body, pack->a, pack->writes_a);
	scatter(&b, body, pack->b, pack->writes_b);
	delta *= pack->inverse_mass_n;
	change = DOT(d, d) * (real)(RB_SLIP_SHARE * RB_SLIP_SHARE) * pack->inverse_mass_t *
	         pack->inverse_mass_t;
	delta *= delta;
	change = CHOOSE(change > delta, change, delta);
	*largest = CHOOSE(change > *largest, change, *largest);
}

/* Extrapolates the impulses; the next sweep projects back onto the cones. */
ALWAYS void extrapolate_pack(body_rows body, struct pack *pack, const struct turns *turns,
                             real momentum_max)
{
	const lanes none = {0}, max = none + momentum_max;
	const struct lanes3 n = pack->normal;
	const lanes gathered = pack->count / (pack->count + 3);
	const lanes share = CHOOSE(gathered > max, max, gathered);
	const struct lanes3 last_change = {share * pack->last_change.x, share * pack->last_change.y,
	                                   share * pack->last_change.z};
	const lanes along = DOT(last_change, n);
	const struct lanes3 across = {last_change.x - along * n.x, last_change.y - along * n.y,
	                              last_change.z - along * n.z};
	const mask moves = (last_change.x != 0) | (last_change.y != 0) | (last_change.z != 0);
	struct bodies a, b;

	pack->last_change = last_change;
	if (!any(&moves))
		return;
	pack->normal_impulse += along;
	pack->friction_impulse = (struct lanes3){pack->friction_impulse.x + across.x,
	                                         pack->friction_impulse.y + across.y,
	                                         pack->friction_impulse.z + across.z};
	gather(&a, body, pack->a);
	gather(&b, body, pack->b);
	apply_impulse(pack, turns, &a, &b, &along, &across);
	scatter(&a, body, pack->a, pack->writes_a);
	scatter(&b, body, pack->b, pack->writes_b);
}

/* ---- from rows, and back ---- */

static void fill_lane(const struct rb_wide *wide, const struct rb_packs *packs, struct pack *pack,
                      int i, const struct rb_constraint *row)
{
	const struct rb_solver_body *body = wide->dense->bodies.body;
	const double mass = 1 / packs->per_mass;

	pack->a[i] = row->a;
	pack->b[i] = row->b;
	pack->writes_a[i] = body[row->a].inverse_mass != 0;
	pack->writes_b[i] = body[row->b].inverse_mass != 0;
	pack->normal.x[i] = (real)row->normal.x;
	pack->normal.y[i] = (real)row->normal.y;
	pack->normal.z[i] = (real)row->normal.z;
	pack->arm_a[i] = (real)(packs->per_length * row->arm_a.x);
	pack->arm_b[i] = (real)(packs->per_length * row->arm_b.x);
	pack->inverse_mass_n[i] = (real)(mass * row->inverse_mass_n);
	pack->inverse_mass_t[i] = (real)(mass * row->inverse_mass_t);
	pack->inverse_n[i] = (real)(1 / (mass * row->inverse_mass_n));
	pack->target_velocity[i] = (real)(packs->per_speed * row->target.n);
	/* finite, so that times a zero impulse it is zero */
	pack->friction[i] = (real)fmin(row->friction, (double)REAL_MAX);
}

static void fill_tensor(const struct rb_wide *wide, const struct rb_packs *packs, int body,
                        lanes *tensor, int i)
{
	const struct rb_solver_bodies *const bodies = &wide->dense->bodies;
	const double inverse = bodies->body[body].inverse_inertia;
	const double inertia = 1 / (packs->per_mass * packs->per_length * packs->per_length);
	const rb_mat3 own = isnan(inverse) ? bodies->tensor[body]
	                                   : rb_mat3_diagonal(inverse, inverse, inverse);

	tensor[0][i] = (real)(inertia * own.m[0][0]);
	tensor[1][i] = (real)(inertia * own.m[0][1]);
	tensor[2][i] = (real)(inertia * own.m[0][2]);
	tensor[3][i] = (real)(inertia * own.m[1][1]);
	tensor[4][i] = (real)(inertia * own.m[1][2]);
	tensor[5][i] = (real)(inertia * own.m[2][2]);
}

/* Velocity at the point due to rotation, per unit of normal impulse. */
ALWAYS rb_vec3 skew_of(const struct rb_row_system *dense, int body, rb_vec3 arm, rb_vec3 normal)
{
	if (dense->bodies.body[body].inverse_inertia == 0)
		return (rb_vec3){0, 0, 0};
	return rb_vec3_cross(rb_solver_turn(&dense->bodies, body, rb_vec3_cross(arm, normal)), arm);
}

ALWAYS void store_vector(struct lanes3 *to, int i, double unit, rb_vec3 v)
{
	to->x[i] = (real)(unit * v.x);
	to->y[i] = (real)(unit * v.y);
	to->z[i] = (real)(unit * v.z);
}

/* After fill_lane. */
static void fill_turn(const struct rb_wide *wide, const struct rb_packs *packs, struct pack *pack,
                      struct turn *turn, int i, const struct rb_constraint *row)
{
	const rb_vec3 arm_a = rb_constraint_arm_a(row), arm_b = rb_constraint_arm_b(row);

	pack->arm_a[i] = (real)(packs->per_length * arm_a.x);
	turn->arm_a[0][i] = (real)(packs->per_length * arm_a.y);
	turn->arm_a[1][i] = (real)(packs->per_length * arm_a.z);
	pack->arm_b[i] = (real)(packs->per_length * arm_b.x);
	turn->arm_b[0][i] = (real)(packs->per_length * arm_b.y);
	turn->arm_b[1][i] = (real)(packs->per_length * arm_b.z);
	const rb_vec3 skew = rb_vec3_reject(
		rb_vec3_add(skew_of(wide->dense, row->a, arm_a, row->normal),
	                    skew_of(wide->dense, row->b, arm_b, row->normal)),
		row->normal);
	store_vector(&turn->skew, i, 1 / packs->per_mass, skew);
}

static void load_lane(const struct rb_packs *packs, struct pack *pack, int i,
                      const struct rb_constraint *row, bool holds)
{
	const bool has_friction = row->friction > 0;
	const double unit = packs->per_mass * packs->per_speed;

	pack->normal_impulse[i] = (real)(unit * row->impulse.n);
	store_vector(&pack->friction_impulse, i, unit, row->impulse.t);
	pack->last_change.x[i] = pack->last_change.y[i] = pack->last_change.z[i] = 0;
	pack->count[i] = 0;
	pack->inverse_t[i] = (real)(!has_friction ? 0
	                            : holds ? -unit * rb_vec3_length(row->impulse.t) / row->friction
	                                    : packs->per_mass / row->inverse_mass_t);
}

#if SINGLE
/*
 * Projects friction to the tangent plane and the cone in 64 bits, and updates velocities
 * accordingly.
 */
static void store_lane(const struct rb_wide *wide, const struct rb_packs *packs,
                       const struct pack *pack, int i, struct rb_constraint *row)
{
	const double unit = 1 / (packs->per_mass * packs->per_speed);
	const rb_along_across before = row->impulse;
	const rb_vec3 across = {unit * (double)pack->friction_impulse.x[i],
	                        unit * (double)pack->friction_impulse.y[i],
	                        unit * (double)pack->friction_impulse.z[i]};

	row->impulse.n = unit * (double)pack->normal_impulse[i];
	if (row->impulse.n == 0 && before.n == 0)
		return; /* there is no friction then, either */
	row->impulse.t = rb_constraint_within(rb_vec3_reject(across, row->normal),
	                                      row->friction * row->impulse.n);
	rb_constraint_apply(&wide->dense->bodies, row,
	                    rb_vec3_add_scaled(rb_vec3_sub(row->impulse.t, before.t),
	                                       row->impulse.n - before.n, row->normal));
}
#else
static void store_lane(const struct rb_wide *wide, const struct rb_packs *packs,
                       const struct pack *pack, int i, struct rb_constraint *row)
{
	(void)wide;
	(void)packs;
	row->impulse.n = pack->normal_impulse[i];
	row->impulse.t = (rb_vec3){pack->friction_impulse.x[i], pack->friction_impulse.y[i],
	                           pack->friction_impulse.z[i]};
}
#endif

/* Prefetches a row of the next pack: rows of a colour are not contiguous. */
ALWAYS void prefetch(const struct rb_constraint *row)
{
	const char *const bytes = (const char *)row;

	__builtin_prefetch(bytes);
	__builtin_prefetch(bytes + 64);
	__builtin_prefetch(bytes + 128);
	__builtin_prefetch(bytes + sizeof *row - 1);
}

static void transfer(const struct rb_wide *wide, const struct rb_packs *packs,
                     enum rb_pack_task task, int k, int at, int count)
{
	struct pack *const pack = &((struct pack *)packs->pack)[k];
	struct turn *const turn = packs->turn ? &((struct turn *)packs->turn)[k] : NULL;
	struct tensors *const tensors = packs->tensors ? &((struct tensors *)packs->tensors)[k]
	                                               : NULL;

	const bool fills = !packs->filled, clears = fills && count < WIDTH;

	RB_ASSERT_COSTLY(!fills || task != RB_PACK_STORE);
	if (clears && turn)
		*turn = (struct turn){.arm_a = {{0}}};
	if (clears && tensors)
		*tensors = (struct tensors){.of_a = {{0}}};
	if (clears) {
		*pack = (struct pack){.count = {0}};
		for (int i = 0; i < WIDTH; i++)
			pack->a[i] = pack->b[i] = wide->fixed;
	}
	for (int i = 0; i < count; i++) {
		struct rb_constraint *row = &wide->dense->row[wide->order[at + i]];

		if (at + i + WIDTH < wide->dense->row_count)
			prefetch(&wide->dense->row[wide->order[at + i + WIDTH]]);
		if (task == RB_PACK_STORE) {
			store_lane(wide, packs, pack, i, row);
			continue;
		}
		if (fills)
			fill_lane(wide, packs, pack, i, row);
		if (fills && tensors) {
			fill_tensor(wide, packs, row->a, tensors->of_a, i);
			fill_tensor(wide, packs, row->b, tensors->of_b, i);
		}
		if (fills && turn)
			fill_turn(wide, packs, pack, turn, i, row);
		load_lane(packs, pack, i, row, task == RB_PACK_LOAD_HELD);
	}
}

/* Whether rows are central, and whether inertias are scalar. */
enum kind { CENTRAL, SCALAR_INERTIAS, TENSORS };

ALWAYS double run_kind(const struct rb_wide *wide, const struct rb_packs *packs, enum kind kind,
                       double momentum, int first, int end)
{
	const body_rows body = rows_of(wide, packs);
	struct pack *const pack = packs->pack;
	const struct turn *const turn = packs->turn;
	const struct tensors *const tensors = packs->tensors;
	lanes largest = {0};
	real max = 0;

	for (int k = first; k < end; k++) {
		const struct turns turns = {kind != CENTRAL ? &turn[k] : NULL,
		                            kind == TENSORS ? &tensors[k] : NULL};

		if (momentum > 0)
			extrapolate_pack(body, &pack[k], &turns, (real)momentum);
		else
			solve_pack(body, &pack[k], &turns, &largest);
	}
	for (int i = 0; i < WIDTH; i++)
		max = largest[i] > max ? largest[i] : max;
	return (double)max;
}

/* Each kind has its own specialized code. */
ALWAYS double run_packs(const struct rb_wide *wide, const struct rb_packs *packs, double momentum,
                        int first, int end)
{
	if (!packs->turn)
		return run_kind(wide, packs, CENTRAL, momentum, first, end);
	return packs->tensors ? run_kind(wide, packs, TENSORS, momentum, first, end)
	                      : run_kind(wide, packs, SCALAR_INERTIAS, momentum, first, end);
}

#if defined(__x86_64__)
/* The same operations in wider registers. */
__attribute__((target("avx2"))) static double run_avx2(const struct rb_wide *wide,
                                                       const struct rb_packs *packs,
                                                       double momentum, int first, int end)
{
	return run_packs(wide, packs, momentum, first, end);
}
#endif

static double run(const struct rb_wide *wide, const struct rb_packs *packs, double momentum,
                  int first, int end)
{
#if defined(__x86_64__)
	if (__builtin_cpu_supports("avx2"))
		return run_avx2(wide, packs, momentum, first, end);
#endif
	return run_packs(wide, packs, momentum, first, end);
}

#define KERNEL                                                                                     \
	{                                                                                          \
		WIDTH, sizeof(struct pack), sizeof(struct turn), sizeof(struct tensors), transfer, \
			run                                                                        \
	}

#endif
