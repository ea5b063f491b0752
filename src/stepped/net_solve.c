/* SPDX-License-Identifier: MIT */
#include "stepped/net_solve.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/error.h"

typedef double pair __attribute__((vector_size(2 * sizeof(double)), aligned(8), may_alias));

/*
 * Most corrections; trial steps from one point; relative norm below which a correction is small
 * enough to be linear.
 */
enum { SOLVES_MAX = 200, TRIES_MAX = 3 };
static const double small = 1e-20;
/* Relative rounding error of lengths, squared, over that: floor of corrections. */
static const double rounding = 64 * DBL_EPSILON * 64 * DBL_EPSILON / 1e-20;
/*
 * Largest ratio of successive corrections: to keep the factors after GMRES; accepted decrease in
 * the line search.
 */
static const double same_share = 0.01, gain_share = 0.25;
/* Largest ratio after a trial step: to accept it; to use it for acceleration. */
static const double try_share = 0.3, far_share = 4;
/*
 * For a new factorization: largest ratio to the norm at the last one, least ratio to the last
 * correction.
 */
static const double anew_share = 1e-4, slow_share = 0.1;
/* Least fraction of a change's squared norm that must be independent of the earlier ones. */
static const double new_share = 1e-8;
/* Apparent gain by rounding, relative to the energy of a net. */
static const double residue = 1e-10;
static const double least_part = 1.0 / 64;
/* Relative residual of GMRES; relative step for numerical derivatives. */
static const double space_share = 0.05, difference = 1e-7;

/* Applies the last correction, with consistent impulses. */
static void finish(struct rb_net_system *s)
{
	struct rb_net *net = s->net;

	rb_net_clear_sums(net);
	for (int k = 0; k < net->spring_count; k++) {
		struct rb_net_spring *spring = &net->spring[k];
		const rb_vec3 u = rb_net_relative_velocity(net, spring, s->x, spring->stiff_arm);
		const rb_vec3 correction = rb_vec3_scale(-s->h * s->h,
		                                         rb_mat3_apply(&spring->stiff, u));

		rb_net_add_impulse(net, spring, spring->impulse, spring->arm_mean);
		rb_net_add_impulse(net, spring, correction, spring->stiff_arm);
		spring->impulse = rb_vec3_add(spring->impulse, correction);
	}
	rb_net_move_means(net, 1, s->x);
	for (int k = 0; k < net->body_count; k++) {
		struct rb_net_body *body = &net->body[k];

		body->end[0] = rb_vec3_add_scaled(rb_vec3_add(body->linear, body->constant),
		                                  1 / body->mass, body->impulse);
		body->mean[0] = rb_vec3_scale(0.5, rb_vec3_add(body->linear, body->end[0]));
		body->end[1] = body->angular;
		if (!body->turns)
			continue;
		rb_mat3 inverse;

		body->to = rb_net_turned(body, s->h);
		const rb_vec3 l = rb_vec3_add(body->spin_momentum, body->turn);
		body->spin_momentum = l;
		if (!isnan(body->scalar))
			body->end[1] = rb_vec3_scale(1 / body->scalar, l);
		else if (rb_mat3_inverse(body->tensor, &inverse))
			body->end[1] = rb_quat_rotate(
				body->to,
				rb_mat3_apply(&inverse, rb_quat_rotate_back(body->to, l)));
	}
}

/* J: energy gained, apart from the work of constant forces and driven ends. */
static double gain_of(const struct rb_net_system *s)
{
	struct rb_net *net = s->net;
	double gain = 0;

	for (int k = 0; k < net->spring_count; k++) {
		struct rb_net_spring *spring = &net->spring[k];

		rb_net_place_ends(net, spring, s->h);
		const double longer = spring->length_to - spring->length;

		spring->damped = spring->damping / s->h * longer * longer;
		gain += 0.5 * spring->stiffness * (spring->length_to - spring->length) *
		        (spring->length_to + spring->length - 2 * spring->rest);
		for (int e = 0; e < 2; e++)
			if (spring->body[e] < 0)
				gain += (e == 0 ? -1 : 1) / s->h *
				        rb_vec3_dot(spring->impulse, spring->displacement[e]);
	}
	for (int k = 0; k < net->body_count; k++) {
		const struct rb_net_body *body = &net->body[k];

		gain += rb_vec3_dot(body->mean[0], body->impulse);
		if (body->turns)
			gain += 0.5 * (rb_vec3_dot(body->end[1], body->spin_momentum) -
			               rb_vec3_dot(body->angular, rb_net_momentum(body, body->from,
			                                                          body->angular)));
	}
	return gain;
}

/*
 * Applies the dampers of the end, and subtracts the energy that they dissipate from the gain;
 * false: the system is not positive definite.
 */
static bool stop(struct rb_net_system *s)
{
	struct rb_net *net = s->net;
	double taken = 0;

	rb_net_add_masses(s, 1, true);
	memset(s->x, 0, s->size * sizeof *s->x);
	rb_net_clear_sums(net);
	for (int k = 0; k < net->spring_count; k++) {
		struct rb_net_spring *spring = &net->spring[k];
		const double damper = 0.5 * s->h * spring->stiffness;
		const rb_vec3 n = rb_vec3_unit(spring->to, (rb_vec3){0, 0, 1});
		rb_vec3 u = {0, 0, 0};

		if (spring->resolved)
			continue;
		spring->stiff = spring->rest > 0 ? rb_net_stiffness(n, damper, 0)
		                                 : rb_mat3_diagonal(damper, damper, damper);
		rb_net_add_spring(s, spring, s->h, &spring->stiff, spring->arm_to);
		/* driven ends */
		for (int e = 0; e < 2; e++)
			if (spring->body[e] < 0)
				u = rb_vec3_add_scaled(u, (e == 0 ? -1 : 1) / s->h,
				                       spring->displacement[e]);
		spring->stopping = rb_vec3_scale(-s->h, rb_mat3_apply(&spring->stiff, u));
		rb_net_add_impulse(net, spring, spring->stopping, spring->arm_to);
	}
	for (int k = 0; k < net->body_count; k++) {
		const struct rb_net_body *body = &net->body[k];

		rb_vec3_to(rb_net_unknown(s->x, body),
		           rb_vec3_add_scaled(body->impulse, body->mass, body->end[0]));
		if (body->turns)
			rb_vec3_to(rb_net_unknown(s->x, body) + 3,
			           rb_vec3_add(body->turn, body->spin_momentum));
	}
	if (!rb_blocks_factor(&s->blocks))
		return false;
	rb_blocks_solve(&s->blocks, s->x, s->scratch);
	rb_net_clear_sums(net);
	for (int k = 0; k < net->spring_count; k++) {
		struct rb_net_spring *spring = &net->spring[k];

		if (spring->resolved)
			continue;
		const rb_vec3 u = rb_net_relative_velocity(net, spring, s->x, spring->arm_to);

		spring->stopping = rb_vec3_add_scaled(spring->stopping, -s->h,
		                                      rb_mat3_apply(&spring->stiff, u));
		rb_net_add_impulse(net, spring, spring->stopping, spring->arm_to);
	}
	for (int k = 0; k < net->body_count; k++) {
		struct rb_net_body *body = &net->body[k];

		body->damped[0] = rb_vec3_add_scaled(body->end[0], 1 / body->mass, body->impulse);
		body->damped[1] = body->end[1];
		taken -= rb_vec3_dot(
			body->impulse,
			rb_vec3_scale(0.5, rb_vec3_add(body->end[0], body->damped[0])));
		if (!body->turns)
			continue;
		const rb_mat3 inertia = rb_net_inertia(body, body->to);
		rb_mat3 inverse;

		if (rb_mat3_inverse(&inertia, &inverse))
			body->damped[1] = rb_vec3_add(body->end[1],
			                              rb_mat3_apply(&inverse, body->turn));
		taken -= rb_vec3_dot(
			body->turn, rb_vec3_scale(0.5, rb_vec3_add(body->end[1], body->damped[1])));
	}
	net->gain -= taken;
	return true;
}

static void begin(struct rb_net *net)
{
	for (int k = 0; k < net->body_count; k++) {
		struct rb_net_body *body = &net->body[k];

		body->mean[0] = rb_vec3_add_scaled(body->linear, 0.5, body->constant);
		body->mean[1] = body->angular;
		body->to = body->from;
		if (body->turns)
			body->spin_momentum = rb_net_momentum(body, body->from, body->angular);
	}
	net->factors = net->solves = 0;
}

/* J: energy of the net, as the scale of corrections. */
static double scale_of(const struct rb_net *net)
{
	double sum = 0;

	for (int k = 0; k < net->body_count; k++) {
		const struct rb_net_body *body = &net->body[k];

		sum += body->mass * (rb_vec3_dot(body->linear, body->linear) +
		                     rb_vec3_dot(body->constant, body->constant));
		if (body->turns)
			sum += rb_vec3_dot(body->angular, body->spin_momentum);
	}
	for (int k = 0; k < net->spring_count; k++) {
		const struct rb_net_spring *spring = &net->spring[k];
		const double x = spring->length - spring->rest;

		sum += spring->stiffness * (x * x + rounding * spring->length * spring->length);
	}
	return sum;
}

/*
 * Numerical derivative of the negative residuals along `direction`, from `rest`, their value at the
 * means.
 */
static void derive(struct rb_net_system *s, const double *rest, double *direction, double *change)
{
	double norm = 0, longest = 0;

	for (int k = 0; k < s->net->body_count; k++) {
		struct rb_net_body *body = &s->net->body[k];
		const rb_vec3 mean = body->mean[0],
			      at = rb_vec3_from(rb_net_unknown(direction, body));

		norm = fmax(norm, rb_vec3_max_abs(at));
		longest = fmax(longest, rb_vec3_max_abs(mean));
		body->kept[0] = mean;
		body->kept[1] = body->mean[1];
		if (body->turns)
			norm = fmax(norm,
			            s->size_m * rb_vec3_max_abs(rb_vec3_from(
							rb_net_unknown(direction, body) + 3)));
	}
	const double step = difference * fmax(longest, s->size_m / s->h) / norm;

	rb_net_move_means(s->net, step, direction);
	rb_net_evaluate(s, change);
	for (size_t i = 0; i < s->size; i++)
		change[i] = (rest[i] - change[i]) / step;
	for (int k = 0; k < s->net->body_count; k++)
		memcpy(s->net->body[k].mean, s->net->body[k].kept, sizeof s->net->body[k].mean);
}

/* Vectors consist of whole blocks. */
static double product(const struct rb_net_system *s, const double *x, const double *y)
{
	const pair *const p = (const pair *)x, *const q = (const pair *)y;
	pair sum[3] = {{0}};

	for (size_t i = 0; i < s->size / 2; i += 3) {
		sum[0] += p[i] * q[i];
		sum[1] += p[i + 1] * q[i + 1];
		sum[2] += p[i + 2] * q[i + 2];
	}
	const pair all = sum[0] + sum[1] + sum[2];

	return all[0] + all[1];
}

static void add_scaled(const struct rb_net_system *s, double *x, double scale, const double *y)
{
	const pair both = {scale, scale}, *const q = (const pair *)y;
	pair *const p = (pair *)x;

	for (size_t i = 0; i < s->size / 2; i += 3) {
		p[i] += both * q[i];
		p[i + 1] += both * q[i + 1];
		p[i + 2] += both * q[i + 2];
	}
}

/* Back substitution in the triangle that Givens rotations have made of the Hessenberg matrix. */
static void solve_triangle(double h[RB_NET_SPACE + 1][RB_NET_SPACE], const double *g, int n,
                           double *y)
{
	for (int i = n; i-- > 0;) {
		y[i] = g[i];
		for (int j = i + 1; j < n; j++)
			y[i] -= h[i][j] * y[j];
		y[i] /= h[i][i];
	}
}

/*
 * The factors belong to a symmetric approximation; the true Jacobian also has the terms of turning
 * directions. Computes the correction by the latter, by GMRES in the norm of the factors: `rest`
 * the right-hand side, the result in x.
 */
static void correct_by_gmres(struct rb_net_system *s, const double *rest, double *x)
{
	const size_t size = s->size;
	double h[RB_NET_SPACE + 1][RB_NET_SPACE], g[RB_NET_SPACE + 1] = {0}, c[RB_NET_SPACE],
								   d[RB_NET_SPACE];
	double y[RB_NET_SPACE];
	int n = 0;

	/* each vector, and its product with the factored system */
	memcpy(s->space, x, size * sizeof *x);
	memcpy(s->space + size, rest, size * sizeof *x);
	g[0] = sqrt(product(s, x, rest));
	const double begin = g[0];
	for (size_t i = 0; i < 2 * size; i++)
		s->space[i] /= begin;
	while (n < RB_NET_SPACE && fabs(g[n]) > space_share * begin) {
		double *const v = s->space + 2 * size * (size_t)(n + 1), *const w = v + size;

		derive(s, rest, s->space + 2 * size * (size_t)n, w);
		memcpy(v, w, size * sizeof *v);
		rb_blocks_solve(&s->blocks, v, s->scratch);
		s->net->solves++;
		for (int i = 0; i <= n; i++) {
			const double *u = s->space + 2 * size * (size_t)i;

			h[i][n] = product(s, u, w);
			add_scaled(s, v, -h[i][n], u);
			add_scaled(s, w, -h[i][n], u + size);
		}
		h[n + 1][n] = sqrt(fmax(0, product(s, v, w)));
		const double length = h[n + 1][n];
		for (size_t i = 0; i < size && length > 0; i++) {
			v[i] /= length;
			w[i] /= length;
		}
		for (int i = 0; i < n; i++) {
			const double t = c[i] * h[i][n] + d[i] * h[i + 1][n];

			h[i + 1][n] = -d[i] * h[i][n] + c[i] * h[i + 1][n];
			h[i][n] = t;
		}
		const double r = sqrt(h[n][n] * h[n][n] + length * length);
		if (!(r > 0))
			break;
		c[n] = h[n][n] / r;
		d[n] = length / r;
		h[n][n] = r;
		g[n + 1] = -d[n] * g[n];
		g[n] *= c[n];
		n++;
		if (!(length > 0))
			break;
	}
	if (n == 0)
		return;
	solve_triangle(h, g, n, y);
	memset(x, 0, size * sizeof *x);
	for (int i = 0; i < n; i++)
		add_scaled(s, x, y[i], s->space + 2 * size * (size_t)i);
}

/* Right-hand side and its correction at the means; returns its norm, J. */
static double correct_at(struct rb_net_system *s, double *rest, double *x)
{
	rb_net_evaluate(s, rest);
	memcpy(x, rest, s->size * sizeof *x);
	rb_blocks_solve(&s->blocks, x, s->scratch);
	s->net->solves++;
	return product(s, x, rest);
}

/* Moves along x by a line search until the next correction is shorter; false: it never is. */
static bool search(struct rb_net_system *s, double norm, double *next)
{
	double part = 1;

	for (;; part *= 0.5) {
		rb_net_move_means(s->net, part, s->x);
		*next = correct_at(s, s->trial_rest, s->trial);
		/* written so that NaN fails */
		if (*next <= (1 - gain_share * part) * norm)
			return true;
		rb_net_move_means(s->net, -part, s->x);
		if (part <= least_part)
			return false;
	}
}

static void swap(double **x, double **y)
{
	double *const z = *x;

	*x = *y;
	*y = z;
}

static double *past_of(const struct rb_net_system *s, int k)
{
	return s->space + 2 * s->size * (size_t)k;
}

static int past_size(const struct rb_net_system *s)
{
	return s->past_count < RB_NET_PAST ? s->past_count : RB_NET_PAST;
}

/*
 * Records a trial step: moving by `step` changes corrections by c and right-hand sides by w. Stores
 * w and step - c, with c orthonormal in the norm of the factors; the oldest is dropped.
 */
static void record_step(struct rb_net_system *s)
{
	const size_t size = s->size;
	const int at = s->past_count % RB_NET_PAST, count = past_size(s);
	double *const w = past_of(s, at), *const rest = w + size, *const c = s->scratch;
	double share[RB_NET_PAST], square = 0;

	for (size_t i = 0; i < size; i++) {
		c[i] = s->x[i] - s->trial[i];
		w[i] = s->rest[i] - s->trial_rest[i];
		rest[i] = s->step[i] - c[i];
	}
	const double whole = product(s, c, w);
	square = whole;
	for (int k = 0; k < count; k++) {
		share[k] = k == at ? 0 : product(s, c, past_of(s, k));
		square -= share[k] * share[k];
	}
	if (!(square > new_share * whole))
		return;
	const double scale = 1 / sqrt(square);

	for (int k = 0; k < count; k++)
		if (k != at) {
			add_scaled(s, w, -share[k], past_of(s, k));
			add_scaled(s, rest, -share[k], past_of(s, k) + size);
		}
	for (size_t i = 0; i < 2 * size; i++)
		w[i] *= scale;
	s->past_count++;
}

/* Step: the correction, improved by the recorded changes. */
static void choose_step(struct rb_net_system *s)
{
	memcpy(s->step, s->x, s->size * sizeof *s->x);
	for (int k = 0; k < past_size(s); k++)
		add_scaled(s, s->step, product(s, s->x, past_of(s, k)), past_of(s, k) + s->size);
}

/* Factors at the means, with the right-hand side given; sets the norm of the correction, J. */
static bool refactor(struct rb_net_system *s, double *norm)
{
	if (!rb_net_factor(s))
		return false;
	memcpy(s->x, s->rest, s->size * sizeof *s->x);
	rb_blocks_solve(&s->blocks, s->x, s->scratch);
	s->net->solves++;
	s->past_count = 0;
	*norm = product(s, s->x, s->rest);
	return true;
}

/* Tries accelerated steps; moves if the next correction is much shorter. */
static bool try_accelerated(struct rb_net_system *s, double norm, double *next)
{
	for (int tries = 0; tries < TRIES_MAX; tries++) {
		choose_step(s);
		rb_net_move_means(s->net, 1, s->step);
		*next = correct_at(s, s->trial_rest, s->trial);
		/* written so that NaN fails */
		const bool near = *next <= far_share * norm;

		if (near)
			record_step(s);
		if (*next <= try_share * norm)
			return true;
		rb_net_move_means(s->net, -1, s->step);
		if (!near)
			break;
	}
	return false;
}

/*
 * Whether a new factorization pays after a trial step: the present factors are of means where
 * corrections were much longer, and converging at this rate to `least` would take more work.
 */
static bool is_stale(const struct rb_net_system *s, double first, double norm, double next,
                     double least)
{
	double work = 0;

	if (!(next < anew_share * first && next > slow_share * norm))
		return false;
	for (double expected = next; expected > least; expected *= next / norm)
		work += 2 * RB_BLOCK * RB_BLOCK * s->blocks.first[s->blocks.count];
	return work > s->blocks.work;
}

/* Newton's method; at its end the last correction is in x. */
static bool iterate(struct rb_net_system *s)
{
	struct rb_net *net = s->net;
	const double least = small * scale_of(net);
	double norm, next, first;

	rb_net_evaluate(s, s->rest);
	if (!refactor(s, &norm))
		return false;
	first = norm;
	while (norm > least && net->solves < SOLVES_MAX) {
		const bool accelerated = try_accelerated(s, norm, &next);

		if (!accelerated) {
			correct_by_gmres(s, s->rest, s->x);
			if (!search(s, norm, &next))
				return false;
			s->past_count = 0;
		}
		swap(&s->x, &s->trial);
		swap(&s->rest, &s->trial_rest);
		if (next > least && (accelerated ? is_stale(s, first, norm, next, least)
		                                 : !(next <= same_share * norm))) {
			if (!refactor(s, &next))
				return false;
			first = next;
		}
		norm = next;
	}
	return norm <= least;
}

bool rb_net_solve(struct rb_net *net, double h, struct rb_arena *arena)
{
	struct rb_net_system s = {.net = net, .h = h};

	RB_ASSERT(h > 0 && net->body_count > 0);
	begin(net);
	for (int k = 0; k < net->spring_count; k++)
		s.size_m = fmax(s.size_m, fmax(net->spring[k].length, net->spring[k].rest));
	if (!rb_net_plan(&s, arena) || !iterate(&s))
		return false;
	finish(&s);
	net->gain = gain_of(&s);
	const double had = scale_of(net);

	/* written so that NaN fails */
	return stop(&s) && net->gain <= residue * had;
}
