/* SPDX-License-Identifier: MIT */
#include "event/driven.h"

#include "base/memory.h"

#include <float.h>

/* Of the body's size, per piece: what the function gives to rounding, and what differencing leaves of it. */
static const double tolerance_given = 1e-13, tolerance_differenced = 1e-9;

struct rb_driven {
	struct rb_gauss_piece piece;
	double *block; /* owned */
	double try_s;
};

/* One body's function under the integrator. */
struct drive {
	struct rb_located *l;
	int i;
	double step_s; /* of differences */
};

static bool ask(const struct drive *d, double t, struct rb_driven_pose *pose)
{
	struct rb_located *l = d->l;
	const struct rb_world_hooks *hooks = &l->world->hooks;

	*pose = (struct rb_driven_pose){.orientation = l->model->orientation[d->i]};
	if (l->status == RB_OK && hooks->motion)
		l->status = hooks->motion(hooks->user, l->model->id_of[d->i], t, pose, l->err);
	return l->status == RB_OK;
}

/* Angular velocity that takes q to p within dt, for small turns. */
static rb_vec3 turn_between(rb_quat q, rb_quat p, double dt)
{
	const rb_quat back = {q.w, -q.x, -q.y, -q.z};
	rb_quat d = rb_quat_multiply(p, back);
	double length, angle;

	if (d.w < 0)
		d = (rb_quat){-d.w, -d.x, -d.y, -d.z};
	length = sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
	angle = 2 * atan2(length, d.w);
	return length > 0 ? rb_vec3_scale(angle / (length * dt), (rb_vec3){d.x, d.y, d.z})
	                  : (rb_vec3){0, 0, 0};
}

/* Central differences at h and 2 h, extrapolated once (fourth order). */
static bool difference(const struct drive *d, double t, struct rb_driven_pose *pose)
{
	struct rb_driven_pose side[4];
	const double h = d->step_s;
	static const double at[4] = {-2, -1, 1, 2};

	if (pose->has_velocity && (pose->has_angular_velocity || !d->l->top))
		return true;
	for (int k = 0; k < 4; k++)
		if (!ask(d, t + at[k] * h, &side[k]))
			return false;
	const rb_vec3 near = rb_vec3_scale(1 / (2 * h),
	                                   rb_vec3_sub(side[2].position, side[1].position));
	const rb_vec3 far = rb_vec3_scale(1 / (4 * h),
	                                  rb_vec3_sub(side[3].position, side[0].position));
	const rb_vec3 turn_near = turn_between(side[1].orientation, side[2].orientation, 2 * h);
	const rb_vec3 turn_far = turn_between(side[0].orientation, side[3].orientation, 4 * h);

	if (!pose->has_velocity)
		pose->velocity = rb_vec3_sub(rb_vec3_scale(4.0 / 3, near),
		                             rb_vec3_scale(1.0 / 3, far));
	if (!pose->has_angular_velocity)
		pose->angular_velocity = rb_vec3_sub(rb_vec3_scale(4.0 / 3, turn_near),
		                                     rb_vec3_scale(1.0 / 3, turn_far));
	return true;
}

/*
 * The velocity rows are integrals of differences of the velocity, so that every row is a polynomial of the same kind;
 * the position's is that of the velocity.
 */
static enum rb_status rates(void *user, double t, const double *value, double *rate,
                            struct rb_error *err)
{
	const struct drive *d = user;
	static const double at[4] = {-2, -1, 1, 2},
			    weight[4] = {1.0 / 12, -8.0 / 12, 8.0 / 12, -1.0 / 12};
	const double h = d->step_s;
	rb_vec3 pull = {0, 0, 0}, turning = {0, 0, 0};
	struct rb_driven_pose now, near;

	(void)err;
	if (!ask(d, t, &now) || !difference(d, t, &now))
		return d->l->status;
	for (int k = 0; k < 4; k++) { /* fourth order */
		if (!ask(d, t + at[k] * h, &near) || !difference(d, t + at[k] * h, &near))
			return d->l->status;
		pull = rb_vec3_add_scaled(pull, weight[k] / h, near.velocity);
		turning = rb_vec3_add_scaled(turning, weight[k] / h, near.angular_velocity);
	}
	rb_vec3_to(rate + RB_ROW_POSITION, now.velocity);
	rb_vec3_to(rate + RB_ROW_VELOCITY, pull);
	if (!d->l->top)
		return RB_OK;
	const rb_quat half = {0, 0.5 * now.angular_velocity.x, 0.5 * now.angular_velocity.y,
	                      0.5 * now.angular_velocity.z};
	rb_quat_to(rate + RB_ROW_ORIENTATION,
	           rb_quat_multiply(half, rb_quat_from(value + RB_ROW_ORIENTATION)));
	rb_vec3_to(rate + RB_ROW_SPIN, turning);
	return RB_OK;
}

static struct rb_driven *driven_of(struct rb_located *l, int i, int n)
{
	if (!l->piece)
		l->piece = rb_memory_take((size_t)l->n, sizeof *l->piece);
	if (!l->driven)
		l->driven = rb_memory_take((size_t)l->n, sizeof *l->driven);
	if (!l->piece || !l->driven)
		return NULL;
	if (!l->driven[i]) {
		struct rb_driven *made = rb_memory_take(1, sizeof *made);

		if (!made)
			return NULL;
		l->driven[i] = made;
		made->block = rb_memory_take((size_t)n * (2 + RB_GAUSS_NODES) + rb_gauss_room(n),
		                             sizeof *made->block);
		if (!made->block)
			return NULL;
		made->piece = (struct rb_gauss_piece){
			.n = n, .start = made->block, .coefficient = made->block + n};
	}
	return l->driven[i];
}

void rb_driven_piece(struct rb_located *l, int i, double t)
{
	const int n = rb_located_row(l);
	struct rb_driven *own = driven_of(l, i, n);
	struct rb_driven_pose pose;
	uint64_t calls = 0;

	if (!own) {
		l->status = RB_FAIL(l->err, RB_ERR_MEMORY, "no memory for a driven body");
		return;
	}
	/* differences over a millionth of the shorter of frame and run lose the least */
	struct drive drive = {
		.l = l, .i = i, .step_s = 1e-3 * fmin(1 / l->model->frame_rate, l->end_s)};
	if (!ask(&drive, t, &pose) || !difference(&drive, t, &pose))
		return;
	double *const scale = own->block + (size_t)n * (1 + RB_GAUSS_NODES);
	const double speed = rb_vec3_length(pose.velocity);
	const double size = fmax(l->model->size_min_m, rb_vec3_max_abs(pose.position));

	rb_vec3_to(own->piece.start + RB_ROW_POSITION, pose.position);
	rb_vec3_to(own->piece.start + RB_ROW_VELOCITY, pose.velocity);
	if (l->top) {
		rb_quat_to(own->piece.start + RB_ROW_ORIENTATION, pose.orientation);
		rb_vec3_to(own->piece.start + RB_ROW_SPIN, pose.angular_velocity);
	}
	if (!(own->try_s > 0))
		own->try_s = 1 / l->model->frame_rate;
	for (int k = 0; k < n; k++)
		scale[k] = k < RB_ROW_VELOCITY      ? size
		           : k < RB_ROW_ORIENTATION ? fmax(speed, size / own->try_s)
		           : k < RB_ROW_SPIN
		                   ? 1
		                   : fmax(rb_vec3_length(pose.angular_velocity), 1 / own->try_s);
	const bool given = pose.has_velocity && (pose.has_angular_velocity || !l->top);
	const struct rb_gauss_problem problem = {.n = n,
	                                         .rates = rates,
	                                         .user = &drive,
	                                         .scratch = scale + n,
	                                         .calls = &calls,
	                                         .scale = scale,
	                                         .tolerance = given ? tolerance_given
	                                                            : tolerance_differenced};
	const enum rb_status status = rb_gauss_step(&problem, t, &own->try_s, 2 * DBL_EPSILON * t,
	                                            &own->piece, l->err);
	if (status != RB_OK) {
		l->status = status;
		return;
	}
	double square = 0;
	for (int m = 0; m < 3; m++) {
		const double most = rb_gauss_rate_bound(&own->piece, RB_ROW_VELOCITY + m);
		square += most * most;
	}
	l->piece[i] = (struct rb_piece_of){.piece = own->piece,
	                                   .first = 0,
	                                   .origin_s = t,
	                                   .until_s = t + own->piece.length_s,
	                                   .acceleration_most = sqrt(square)};
}

void rb_driven_release(struct rb_located *l)
{
	for (int i = 0; l->driven && i < l->n; i++)
		if (l->driven[i]) {
			rb_memory_free(l->driven[i]->block);
			rb_memory_free(l->driven[i]);
		}
	rb_memory_free(l->driven);
}
