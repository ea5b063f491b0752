/* SPDX-License-Identifier: MIT */
#include "located/follow.h"

#include <float.h>

#include "base/error.h"
#include "base/memory.h"

static RB_FIELDS_DECLARE(follow_fields);
static RB_FIELDS_DEFINE(follow_fields, struct rb_follow, RB_FOLLOW_FIELDS);

/* Rounding of a rate, ulp of the values it follows from; of times within which pieces join, ulp. */
enum { RATE_ULP = 64, TIME_ULP = 4 };
/* Share of the speeds by which a rate may change between pieces without a kink. */
static const double kink_share = 1e-9;

bool rb_follow_create(struct rb_located *l)
{
	const struct rb_joints *joints = l->model->joints;
	bool any = false;

	for (int k = 0; joints && k < joints->count; k++)
		any = any || joints->joint[k].has_motor;
	if (!any)
		return true;
	l->follow = rb_memory_take((size_t)joints->count, sizeof *l->follow);
	for (int k = 0; l->follow && k < joints->count; k++)
		l->follow[k] = (struct rb_follow){.back_s = (double)NAN,
		                                  .target = (double)INFINITY};
	return l->follow != NULL;
}

void rb_follow_release(struct rb_located *l)
{
	for (int k = 0; l->follow && k < l->model->joints->count; k++)
		rb_driven_free(l->follow[k].own);
	rb_memory_free(l->follow);
}

void rb_follow_pack(struct rb_located *l, struct rb_pack *pack)
{
	const size_t count = l->follow ? (size_t)l->model->joints->count : 0;

	rb_fields_pack(follow_fields(), l->follow, count, NULL, pack);
	for (size_t k = 0; k < count && !pack->failed; k++) {
		l->follow[k].piece = rb_driven_pack_motor(&l->follow[k].own, pack);
		(void)rb_pack_check(pack,
		                    isnan(l->follow[k].back_s) || l->follow[k].back_length_s > 0,
		                    "a way back without length");
	}
}

/* True if the target is the scene's function, not a constant value. */
static bool has_function(const struct rb_located *l, int joint)
{
	return rb_follow_has(l, joint) && isnan(l->world->joint[joint].motor_angle);
}

bool rb_follow_is_returning(const struct rb_located *l, int joint)
{
	return rb_follow_has(l, joint) && !isnan(l->follow[joint].back_s);
}

bool rb_follow_moves(const struct rb_located *l, int joint)
{
	return has_function(l, joint) || rb_follow_is_returning(l, joint);
}

/* Takes the function's next piece, from `from` on; true if its rate differs from the last one's. */
static bool next_piece(struct rb_located *l, int joint, double from)
{
	struct rb_follow *const f = &l->follow[joint];
	const bool joins = f->piece && from == f->until_s;
	const struct rb_follow_point before = rb_follow_at(l, joint, from, false);
	const struct rb_gauss_piece *piece = rb_driven_motor(l, joint, from, &f->own);

	if (!piece)
		return true;
	f->piece = piece;
	f->origin_s = from;
	f->until_s = from + piece->length_s;
	const struct rb_follow_point now = rb_follow_at(l, joint, from, false);

	return !joins || fabs(now.rate - before.rate) >
	                         fmax(now.noise, kink_share * (now.speed_max + before.speed_max));
}

bool rb_follow_begin(struct rb_located *l, int joint, double t)
{
	struct rb_follow *const f = &l->follow[joint];
	const double near = TIME_ULP * DBL_EPSILON * fabs(t),
		     target = l->world->joint[joint].motor_angle;
	const bool other = isnan(target) ? !isnan(f->target) : !(target == f->target);

	if (!(f->back_s + f->back_length_s > t + near))
		f->back_s = (double)NAN;
	f->target = target;
	if (!has_function(l, joint) || (f->piece && f->origin_s <= t && t < f->until_s - near))
		return other;
	/* from the end of the last piece, to join it smoothly */
	return next_piece(l, joint, f->piece && fabs(t - f->until_s) <= near ? f->until_s : t) ||
	       other;
}

struct rb_follow_point rb_follow_at(const struct rb_located *l, int joint, double t, bool back)
{
	const struct rb_follow *f = &l->follow[joint];
	const bool function = has_function(l, joint);
	struct rb_follow_point now = {.value = function ? 0 : l->world->joint[joint].motor_angle};

	RB_ASSERT_COSTLY(rb_follow_has(l, joint));
	if (function && f->piece) {
		const double s = t - f->origin_s;

		now.value = rb_gauss_value(f->piece, RB_PIECE_POSITION, s);
		now.rate = rb_gauss_value(f->piece, RB_PIECE_VELOCITY, s);
		now.acceleration = rb_gauss_rate(f->piece, RB_PIECE_VELOCITY, s);
		now.speed_max = rb_gauss_rate_bound(f->piece, RB_PIECE_POSITION);
		now.noise = RATE_ULP * DBL_EPSILON *
		            (now.speed_max + fabs(now.value) / f->piece->length_s +
		             t * rb_gauss_rate_bound(f->piece, RB_PIECE_VELOCITY));
	}
	if (back && !isnan(f->back_s)) {
		const double length = f->back_length_s, left = 1 - (t - f->back_s) / length;

		now.value += f->back_off * left * left;
		now.rate -= 2 * f->back_off * left / length;
		now.acceleration += 2 * f->back_off / (length * length);
	}
	return now;
}

double rb_follow_end(const struct rb_located *l, int joint, double soon)
{
	const struct rb_follow *f = l->follow ? &l->follow[joint] : NULL;
	double end = HUGE_VAL;

	if (!f || !rb_follow_has(l, joint))
		return end;
	if (has_function(l, joint) && f->piece && f->until_s > soon)
		end = f->until_s;
	/* written so that NaN is no end */
	if (f->back_s + f->back_length_s > soon)
		end = fmin(end, f->back_s + f->back_length_s);
	return end;
}

void rb_follow_begin_return(struct rb_located *l, int joint, double t, double off, double rate)
{
	struct rb_follow *const f = &l->follow[joint];

	RB_ASSERT(rb_follow_converges(off, rate));
	f->back_s = t;
	f->back_off = off;
	f->back_length_s = -2 * off / rate;
}

void rb_follow_end_return(struct rb_located *l, int joint)
{
	if (l->follow)
		l->follow[joint].back_s = (double)NAN;
}
