/* SPDX-License-Identifier: MIT */
/*
 * The function of time of a driven body or a motor becomes pieces: polynomials of degree 8 through
 * values or velocities at nodes, the same dense output as that of integrated bodies. The length of
 * a piece follows from its error at test points. Kinks lead to tiny pieces; jumps, and velocities
 * that contradict positions, are refused (step/motion).
 */
#include "located/driven.h"

#include "base/error.h"
#include "base/memory.h"
#include "step/motion.h"

#include <float.h>
#include <limits.h>
#include <string.h>

/*
 * Nodes; test points; successive pieces of the length tried before twice the length is tried; ulp
 * of time below which the rest of the run needs no piece.
 */
enum { NODES = RB_GAUSS_NODES, CHECKS = 3, CALM_PIECES = 8, SLIVER_ULP = 16 };
/* Rows of a motor's piece: those of a body without orientation, of which only x is used. */
enum { MOTOR_ROWS = RB_PIECE_ORIENTATION };
/* Factor by which these may be longer. */
enum { MOTOR_LONGER = 4 };

/* Nodes for velocities: those of Lobatto's quadrature, which include both ends. */
static const double velocity_node[NODES] = {
	0,
	0.064129925745196692331,
	0.20414990928342884893,
	0.39535039104876056562,
	0.60464960895123943438,
	0.79585009071657115107,
	0.93587007425480330767,
	1,
};
/*
 * Nodes for poses if no velocities are given: the zeros of the Jacobi polynomial P_6^(1,2), and the
 * end. Together with pose and velocity at the beginning they determine a polynomial of degree
 * eight. An error of that velocity, taken from the end of the last piece, reappears at the other
 * end times prod (1 - s)/s = 1/4: it decays. The last node replaces that velocity where there is
 * none.
 */
static const double pose_node[NODES] = {
	0.10030907272538186727,
	0.25404710433055934653,
	0.44413303230020510064,
	0.64176988622409823922,
	0.81689666352785747408,
	0.94284424089189797226,
	1,
	0.03,
};
/*
 * Test points between nodes of both kinds, where interpolation is worst; more than this share of a
 * piece is nowhere between two samples.
 */
static const double check_at[CHECKS] = {0.15, 0.55, 0.88}, widest = 0.2;

/* Error of a piece accepted for a smooth function, ulp. */
static const double near_ulp = 16;
/*
 * If halving does not help, an error up to noise_ulp is taken for the function's rounding, and one
 * up to this share of sizes for a kink.
 */
static const double noise_ulp = 1e5, kink_share = 1e-9;
/*
 * Shortest piece, as a share of the longest, that is not due to a kink; shorter ones are, even if
 * they look smooth.
 */
static const double kink_length = 0x1p-24;
/*
 * Share by which integrated velocities may differ from positions: more than a kink leaves in
 * either.
 */
static const double contradiction = 1e-8;
/*
 * Share of a piece below which a remainder of the run is added to it: lengths have 8 binary digits.
 */
static const double sliver = 0x1p-8;

#define DRIVEN_FIELDS(X)                                                                      \
	X(struct rb_gauss_piece, piece, , "", "of its function", RB_BY_HAND)                  \
	X(double *, block, , "", "owned", RB_DERIVED)                                         \
	X(double *, end_rate, , "1/s", "[n] of the piece's values at its end", RB_BY_HAND)    \
	X(double, end_s, , "s", "end of the last piece; NAN: none yet, or it ends in a kink", \
	  RB_NUMBER)                                                                          \
	X(double, try_s, , "s", "length of the next piece", RB_FINITE)                        \
	X(double, near_ulp, , "1", "accepted error, from the function's observed rounding",   \
	  RB_FINITE)                                                                          \
	X(int, calm, , "", "successive pieces as long as tried", RB_WITHIN(0, INT_MAX))

/* State of a driven function, kept from piece to piece. */
struct rb_driven {
	DRIVEN_FIELDS(RB_FIELD_MEMBER)
};
static RB_FIELDS_DECLARE(driven_fields);
static RB_FIELDS_DEFINE(driven_fields, struct rb_driven, DRIVEN_FIELDS);

/* The function of a body or a motor over one piece. */
struct drive {
	struct rb_located *l;
	struct rb_driven *own;
	int i;
	bool motor;  /* i is a joint's number, else a body index */
	bool turns;  /* it has orientations */
	double size; /* to which errors are relative: m; for a hinge's motor 1 rad */
	double origin_s, length_s;
	double first_s, longest_s; /* lengths: tried first; longest */
	bool given[2];             /* by the function: velocities, angular velocities */
	bool fresh;                /* the velocity at the beginning is unknown */
	struct rb_driven_pose begin, moving[NODES], placed[NODES];
};

/* Calls the function at a fraction of the piece; false: it failed. */
static bool call_function(const struct drive *d, double part, struct rb_driven_pose *pose)
{
	struct rb_located *l = d->l;

	const double t = d->origin_s + part * d->length_s;

	if (l->status == RB_OK)
		l->status = d->motor ? rb_motion_ask_motor(l->world, d->i, t, pose, l->err)
		                     : rb_motion_ask(l->world, d->i, t, d->begin.orientation, pose,
		                                     l->err);
	if (d->motor && part > 0 && l->status == RB_OK && pose->has_velocity != d->given[0]) {
		char label[RB_MOTION_LABEL];

		l->status = RB_FAIL(l->err, RB_ERR_SCENE,
		                    "%s at t = %.9g s: it returns a speed always or never",
		                    rb_motion_label(l->world, d->i, true, label), t);
	}
	return l->status == RB_OK;
}

/* Samples velocities or poses at their nodes, as the function gives them. */
static bool sample(struct drive *d)
{
	for (int k = 0; k < NODES && (d->given[0] || (d->turns && d->given[1])); k++)
		if (!call_function(d, velocity_node[k], &d->moving[k]))
			return false;
	for (int k = 0; k < NODES && (!d->given[0] || (d->turns && !d->given[1])); k++)
		if (!call_function(d, pose_node[k], &d->placed[k]))
			return false;
	return true;
}

/* dq/dt = w q / 2, w in world axes. */
static rb_quat turning_of(const struct rb_driven_pose *pose)
{
	const rb_vec3 w = pose->angular_velocity;

	return rb_quat_multiply((rb_quat){0, 0.5 * w.x, 0.5 * w.y, 0.5 * w.z}, pose->orientation);
}

/* ---- polynomials from conditions ---- */

/* Eight linear conditions on the Legendre coefficients of the rates, for up to four columns. */
struct fit {
	double matrix[NODES][NODES], right[NODES][4];
};

static void swap(double *a, double *b)
{
	const double kept = *a;

	*a = *b;
	*b = kept;
}

/*
 * Gaussian elimination with row pivots; writes the solutions to the piece's columns from `first`
 * on.
 */
static void solve(struct fit *f, struct rb_gauss_piece *piece, int first, int count)
{
	for (int k = 0; k < NODES; k++) {
		int best = k;

		for (int r = k + 1; r < NODES; r++)
			if (fabs(f->matrix[r][k]) > fabs(f->matrix[best][k]))
				best = r;
		for (int c = 0; c < NODES; c++)
			swap(&f->matrix[k][c], &f->matrix[best][c]);
		for (int c = 0; c < count; c++)
			swap(&f->right[k][c], &f->right[best][c]);
		for (int r = k + 1; r < NODES; r++) {
			const double share = f->matrix[r][k] / f->matrix[k][k];

			for (int c = k; c < NODES; c++)
				f->matrix[r][c] -= share * f->matrix[k][c];
			for (int c = 0; c < count; c++)
				f->right[r][c] -= share * f->right[k][c];
		}
	}
	for (int k = NODES - 1; k >= 0; k--)
		for (int c = 0; c < count; c++) {
			RB_ASSERT_COSTLY(f->matrix[k][k] != 0);
			double *const column = piece->coefficient + first + c;
			double sum = f->right[k][c];

			for (int m = k + 1; m < NODES; m++)
				sum -= f->matrix[k][m] * column[m * piece->n];
			column[k * piece->n] = sum / f->matrix[k][k];
		}
}

/* Writes values of a pose, or their rates, for the rows that begin with `first`. */
static void values_of(const struct rb_driven_pose *pose, int first, bool rates, double *to)
{
	if (first == RB_PIECE_POSITION)
		rb_vec3_to(to, rates ? pose->velocity : pose->position);
	else if (first == RB_PIECE_ORIENTATION)
		rb_quat_to(to, rates ? turning_of(pose) : pose->orientation);
	else
		rb_vec3_to(to, pose->angular_velocity);
}

/* Fits rates at the velocity nodes. */
static void fit_rates(struct drive *d, int first, int count)
{
	struct fit f;
	double value[NODES];

	for (int k = 0; k < NODES; k++) {
		rb_gauss_basis(velocity_node[k], value, f.matrix[k]);
		values_of(&d->moving[k], first, true, f.right[k]);
		for (int c = 0; c < count; c++)
			f.right[k][c] *= d->length_s;
	}
	solve(&f, &d->own->piece, first, count);
}

/* Fits values at the pose nodes, and the rate with which the last piece ended. */
static void fit_values(struct drive *d, int first, int count)
{
	const double *start = d->own->piece.start + first;
	struct fit f;
	double value[NODES], rate[NODES];

	for (int k = 0; k < NODES; k++) {
		const bool joins = k == NODES - 1 && !d->fresh;

		rb_gauss_basis(joins ? 0 : pose_node[k], value, rate);
		memcpy(f.matrix[k], joins ? rate : value, sizeof value);
		values_of(&d->placed[k], first, false, f.right[k]);
		for (int c = 0; c < count; c++)
			f.right[k][c] = joins ? d->own->end_rate[first + c] * d->length_s
			                      : f.right[k][c] - start[c];
	}
	solve(&f, &d->own->piece, first, count);
}

/*
 * Rows `to` become the derivatives of rows `from`: P_k' = 2 sum (2 j + 1) P_j over j = k - 1, k -
 * 3, ... on [0, 1].
 */
static void derive(struct drive *d, int from, int to)
{
	const struct rb_gauss_piece *piece = &d->own->piece;
	const int n = piece->n;

	for (int m = 0; m < 3; m++) {
		double *const c = piece->coefficient;
		double start = 0;

		for (int k = NODES - 1; k >= 0; k--)
			start += (k % 2 ? -1 : 1) * c[k * n + from + m];
		piece->start[to + m] = start / d->length_s;
		for (int j = 0; j < NODES; j++) {
			double sum = 0;

			for (int k = NODES - 1; k > j; k--)
				sum += (k - j) % 2 ? c[k * n + from + m] : 0;
			c[j * n + to + m] = 2 * (2 * j + 1) * sum / d->length_s;
		}
	}
}

/* Angular velocity of the orientation's polynomial: w = 2 q' q^-1. */
static rb_vec3 spin_of(const struct rb_gauss_piece *piece, double s)
{
	double q[4], r[4], square = 0;

	for (int k = 0; k < 4; k++) {
		q[k] = rb_gauss_value(piece, RB_PIECE_ORIENTATION + k, s);
		r[k] = rb_gauss_rate(piece, RB_PIECE_ORIENTATION + k, s);
		square += q[k] * q[k];
	}
	const rb_quat w = rb_quat_multiply(rb_quat_from(r), (rb_quat){q[0], -q[1], -q[2], -q[3]});
	return rb_vec3_scale(2 / square, (rb_vec3){w.x, w.y, w.z});
}

/* Fills the piece: positions, velocities as their derivatives, and likewise rotation. */
static void fit(struct drive *d)
{
	struct rb_gauss_piece *piece = &d->own->piece;

	piece->length_s = d->length_s;
	rb_vec3_to(piece->start + RB_PIECE_POSITION, d->begin.position);
	if (d->given[0])
		fit_rates(d, RB_PIECE_POSITION, 3);
	else
		fit_values(d, RB_PIECE_POSITION, 3);
	derive(d, RB_PIECE_POSITION, RB_PIECE_VELOCITY);
	if (!d->turns)
		return;
	rb_quat_to(piece->start + RB_PIECE_ORIENTATION, d->begin.orientation);
	if (d->given[1])
		fit_rates(d, RB_PIECE_ORIENTATION, 4);
	else
		fit_values(d, RB_PIECE_ORIENTATION, 4);
	for (int k = 0; k < NODES && !d->given[1]; k++)
		d->moving[k].angular_velocity = spin_of(piece, velocity_node[k] * d->length_s);
	fit_rates(d, RB_PIECE_SPIN, 3);
	derive(d, RB_PIECE_SPIN, RB_PIECE_SPIN);
}

/* ---- error of a piece ---- */

/* Error of a piece. */
struct piece_error {
	double ulp; /* of the change over the piece, and of the rounding of coordinates and time */
	double share; /* of the size of the smallest body, or of a radian */
};

/* Unit of each error, for rows of a piece. */
struct units {
	double ulp, share;
};

/* Raises the error to that of rows first .. first + 2 at a fraction of the piece. */
static void compare(const struct drive *d, double part, int first, rb_vec3 wanted,
                    const struct units *unit, struct piece_error *max)
{
	const double s = part * d->length_s;
	const rb_vec3 found = {rb_gauss_value(&d->own->piece, first, s),
	                       rb_gauss_value(&d->own->piece, first + 1, s),
	                       rb_gauss_value(&d->own->piece, first + 2, s)};
	const double off = rb_vec3_max_abs(rb_vec3_sub(found, wanted));

	max->ulp = fmax(max->ulp, off / (DBL_EPSILON * fmax(unit->ulp, DBL_MIN)));
	max->share = fmax(max->share, off / unit->share);
}

/* The same for the rates of the orientation. */
static void compare_turning(const struct drive *d, double part, const struct rb_driven_pose *pose,
                            const struct units *unit, struct piece_error *max)
{
	const rb_quat wanted = turning_of(pose);
	double rate[4], off = 0;

	for (int k = 0; k < 4; k++)
		rate[k] = rb_gauss_rate(&d->own->piece, RB_PIECE_ORIENTATION + k,
		                        part * d->length_s);
	off = fmax(fmax(fabs(rate[0] - wanted.w), fabs(rate[1] - wanted.x)),
	           fmax(fabs(rate[2] - wanted.y), fabs(rate[3] - wanted.z)));
	off *= d->length_s;
	max->ulp = fmax(max->ulp, off / (DBL_EPSILON * unit->ulp));
	max->share = fmax(max->share, off / unit->share);
}

/*
 * Units of a quantity that changes by `change` over the piece; rounding of time adds that of its
 * rate.
 */
static struct units units_of(const struct drive *d, double change, double value, double share)
{
	return (struct units){change * (1 + 0.125 * d->origin_s / d->length_s) + 0.125 * value,
	                      share};
}

static double change_of(rb_vec3 a, rb_vec3 b)
{
	return rb_vec3_max_abs(rb_vec3_sub(a, b));
}

/* Number of test points: more, at equal distances, where a piece is long for what must be seen. */
static int count_checks(const struct drive *d)
{
	const double sampling_s = rb_located_sampling(d->l);
	const bool sees = !(widest * d->length_s > sampling_s);

	return sees ? CHECKS : CHECKS + (int)ceil(d->length_s / sampling_s);
}

/*
 * Error of the piece at the test points; `difference`: of positions integrated from given
 * velocities. False: the function failed.
 */
static bool inspect(struct drive *d, struct piece_error *max, struct piece_error *difference)
{
	const double size = d->size, length = d->length_s;
	const struct rb_driven_pose *const first = &d->moving[0], *const last =
									  &d->moving[NODES - 1];
	const rb_vec3 end = d->given[0] ? last->position : d->placed[NODES - 2].position;
	const double speed = rb_vec3_max_abs(last->velocity);
	const double spin = d->turns ? rb_vec3_max_abs(last->angular_velocity) : 0;
	const struct units at = units_of(d, change_of(end, d->begin.position), rb_vec3_max_abs(end),
	                                 size);
	const struct units moves = units_of(d, change_of(last->velocity, first->velocity), speed,
	                                    size / length);
	const struct units turned = units_of(d, length * spin, 1, 1);
	const struct units turns = units_of(
		d, change_of(last->angular_velocity, first->angular_velocity), spin, 1 / length);

	const int count = count_checks(d);

	*max = *difference = (struct piece_error){0};
	for (int k = 0; k <= count; k++) {
		const double between = (k - CHECKS + 0.5) / fmax(count - CHECKS, 1);
		const double part = k < CHECKS ? check_at[k] : k < count ? between : 1;
		struct rb_driven_pose pose = *last;

		if (k == count && !d->given[0] && !d->given[1])
			break;
		if (k < count && !call_function(d, part, &pose))
			return false;
		if (d->given[0])
			compare(d, part, RB_PIECE_VELOCITY, pose.velocity, &moves, max);
		if (d->given[0] || k < count)
			compare(d, part, RB_PIECE_POSITION, pose.position, &at,
			        d->given[0] ? difference : max);
		if (!d->turns)
			continue;
		const rb_quat q = pose.orientation;
		if (d->given[1]) {
			compare(d, part, RB_PIECE_SPIN, pose.angular_velocity, &turns, max);
			compare_turning(d, part, &pose, &turned, max);
		}
		if (d->given[1] || k < count)
			compare(d, part, RB_PIECE_ORIENTATION + 1, (rb_vec3){q.x, q.y, q.z},
			        &turned, d->given[1] ? difference : max);
	}
	return true;
}

/* Searches the first `part` of the piece for jumps and contradictions; false: found one. */
static bool is_continuous(struct drive *d, double part)
{
	struct rb_located *l = d->l;
	struct rb_motion motion = {.world = l->world,
	                           .i = d->i,
	                           .motor = d->motor,
	                           .from_s = d->origin_s,
	                           .to_s = d->origin_s + part * d->length_s,
	                           .begin = d->begin,
	                           .coarse = kink_share,
	                           .agreement = noise_ulp * DBL_EPSILON};

	if (call_function(d, part, &motion.end))
		l->status = rb_motion_watch(&motion, l->err);
	return l->status == RB_OK;
}

/* Fails with the reason why no piece approximates the function. */
static bool refuse(struct drive *d)
{
	struct rb_located *l = d->l;
	char label[RB_MOTION_LABEL];

	if (is_continuous(d, d->first_s / d->length_s))
		l->status = RB_FAIL(l->err, RB_ERR_SCENE,
		                    "%s at t = %.9g s: no smooth motion follows it",
		                    rb_motion_label(l->world, d->i, d->motor, label), d->origin_s);
	return false;
}

/* Rounds down to 8 binary digits, so that times of pieces add up exactly. */
static double rounded(double length)
{
	int exponent;
	const double digits = frexp(length, &exponent);

	return ldexp(floor(digits * 0x1p8), exponent - 8);
}

/*
 * Next length: the error grows with the ninth power of the length. The function's rounding and past
 * kinks do not, so twice the length is tried now and then.
 */
static double next_length(const struct drive *d, double error)
{
	const double grow = sqrt(sqrt(sqrt(d->own->near_ulp / fmax(error, DBL_MIN))));
	const double least = d->own->calm >= CALM_PIECES ? 2 : 1;

	return rounded(d->length_s * fmin(fmax(0.9 * grow, least), 4));
}

/* Halves the length until the piece is accurate. */
static bool find_length(struct drive *d)
{
	struct rb_driven *const own = d->own;
	const double least = 4 * DBL_EPSILON * fmax(d->origin_s, d->length_s);
	double before = HUGE_VAL;
	struct piece_error error, difference;

	own->near_ulp = fmax(0.5 * own->near_ulp, near_ulp);
	for (;; d->length_s *= 0.5) {
		if (!sample(d))
			return false;
		fit(d);
		if (!inspect(d, &error, &difference))
			return false;
		const bool helps = error.ulp <= 0.125 * before;
		if (!helps && before <= noise_ulp) {
			own->near_ulp = 4 * before;
			before = HUGE_VAL;
			d->length_s *= 4;
			continue;
		}
		if (error.ulp <= own->near_ulp || !(0.5 * d->length_s > least) ||
		    ((!helps || d->length_s <= kink_length * d->longest_s) &&
		     error.share <= kink_share))
			break;
		before = error.ulp;
	}
	if ((error.ulp > own->near_ulp && !(error.share <= kink_share)) ||
	    (difference.share > contradiction && difference.ulp > noise_ulp))
		return refuse(d);
	/* a piece accepted only because kinks and rounding are allowed may hide a jump */
	if ((d->length_s < d->first_s || own->near_ulp > near_ulp) && !is_continuous(d, 1))
		return false;
	const bool smooth = error.ulp <= own->near_ulp;
	own->calm = smooth && d->length_s == d->first_s ? own->calm + 1 : 0;
	own->try_s = smooth ? next_length(d, error.ulp) : 2 * d->length_s;
	/* a piece after a kink does not continue its rates */
	own->end_s = smooth ? d->origin_s + d->length_s : (double)NAN;
	for (int k = 0; k < own->piece.n; k++)
		own->end_rate[k] = rb_gauss_rate(&own->piece, k, d->length_s);
	return true;
}

/* ---- a piece ---- */

/* State of a function of n values, allocated when first needed; NULL: no memory. */
static struct rb_driven *own_of(struct rb_driven **own, int n)
{
	if (*own)
		return *own;
	struct rb_driven *const made = rb_memory_take(1, sizeof *made);

	if (!made)
		return NULL;
	*own = made;
	made->block = rb_memory_take((size_t)n * (2 + NODES), sizeof *made->block);
	if (!made->block)
		return NULL;
	made->piece = (struct rb_gauss_piece){
		.n = n, .start = made->block, .coefficient = made->block + 2 * n};
	made->end_rate = made->block + n;
	made->end_s = (double)NAN;
	return made;
}

static struct rb_driven *driven_of(struct rb_located *l, int i, int n)
{
	if (!l->piece)
		l->piece = rb_memory_take((size_t)l->n, sizeof *l->piece);
	if (!l->driven)
		l->driven = rb_memory_take((size_t)l->n, sizeof *l->driven);
	return l->piece && l->driven ? own_of(&l->driven[i], n) : NULL;
}

/* Start of a piece, with q or -q, whichever continues the last piece. */
static bool begin(struct drive *d)
{
	const struct rb_gauss_piece *piece = &d->own->piece;
	double q[4];

	d->begin.orientation = d->turns ? d->l->model->orientation[d->i] : (rb_quat){1, 0, 0, 0};
	if (!d->fresh && d->turns) {
		for (int k = 0; k < 4; k++)
			q[k] = rb_gauss_value(piece, RB_PIECE_ORIENTATION + k, piece->length_s);
		d->begin.orientation = rb_quat_from(q);
	}
	if (!call_function(d, 0, &d->begin))
		return false;
	d->given[0] = d->begin.has_velocity;
	d->given[1] = d->begin.has_angular_velocity;
	return true;
}

/* The next piece of a function from `t` on, in d->own; false: failed, see l->status. */
static bool next_piece(struct drive *d, double t)
{
	const struct rb_located *l = d->l;
	const struct rb_driven *own = d->own;

	/*
	 * not so long that events in between could be missed; a motor's target touches nothing, and
	 * its second derivatives are forces, whose rounding falls with the square of the length
	 */
	const double longest = (d->motor ? MOTOR_LONGER : 1) *
	                       fmax(1 / l->model->frame_rate, l->end_s / 256);
	const double length = fmin(own->try_s > 0 ? own->try_s : longest, longest);
	/* a shorter rest of the run gets no piece: it would have no second derivative */
	const double left = l->end_s - t;
	const bool ends = left > SLIVER_ULP * DBL_EPSILON * t;
	d->origin_s = t;
	d->length_s = ends && left <= (1 + sliver) * length ? left : length;
	if (d->motor && ends && left > length && left < 2 * length)
		d->length_s = rounded(0.5 * left); /* rather than a short remainder */
	d->fresh = !(own->end_s == t);
	d->first_s = d->length_s;
	d->longest_s = longest;
	d->size = rb_motion_size(l->world, d->i, d->motor);
	return begin(d) && find_length(d);
}

void rb_driven_piece(struct rb_located *l, int i, double t)
{
	struct rb_driven *own = driven_of(l, i, rb_located_row(l));
	struct drive d = {.l = l, .own = own, .i = i, .turns = l->top != NULL};
	double square = 0;

	RB_ASSERT(rb_located_driven(l, i));
	if (!own) {
		l->status = RB_FAIL(l->err, RB_ERR_MEMORY, "no memory for a driven body");
		return;
	}
	if (!next_piece(&d, t))
		return;
	for (int m = 0; m < 3; m++) {
		const double max = rb_gauss_rate_bound(&own->piece, RB_PIECE_VELOCITY + m);
		square += max * max;
	}
	l->piece[i] = (struct rb_piece_of){.piece = own->piece,
	                                   .first = 0,
	                                   .origin_s = t,
	                                   .until_s = t + own->piece.length_s,
	                                   .acceleration_max = sqrt(square)};
}

const struct rb_gauss_piece *rb_driven_motor(struct rb_located *l, int joint, double t,
                                             struct rb_driven **own)
{
	struct drive d = {.l = l, .own = own_of(own, MOTOR_ROWS), .i = joint, .motor = true};

	if (!d.own) {
		l->status = RB_FAIL(l->err, RB_ERR_MEMORY, "no memory for a motor");
		return NULL;
	}
	return next_piece(&d, t) ? &d.own->piece : NULL;
}

void rb_driven_free(struct rb_driven *own)
{
	if (own)
		rb_memory_free(own->block);
	rb_memory_free(own);
}

void rb_driven_release(struct rb_located *l)
{
	for (int i = 0; l->driven && i < l->n; i++)
		rb_driven_free(l->driven[i]);
	rb_memory_free(l->driven);
}

/* Packs the state. */
static void pack_own(struct rb_driven *own, struct rb_pack *pack)
{
	const size_t n = (size_t)own->piece.n;

	rb_pack_finite(pack, &own->piece.length_s, 1);
	rb_pack_finite(pack, own->piece.start, n);
	rb_pack_finite(pack, own->piece.coefficient, n * NODES);
	rb_pack_finite(pack, own->end_rate, n);
	rb_fields_pack(driven_fields(), own, 1, NULL, pack);
	(void)rb_pack_check(pack, own->piece.length_s > 0, "a piece without length");
}

void rb_driven_pack(struct rb_located *l, int i, struct rb_pack *pack)
{
	bool has = l->driven && l->driven[i];

	RB_ASSERT(rb_located_driven(l, i));
	rb_pack_bool(pack, &has);
	if (!has)
		return;
	struct rb_driven *const own = pack->loading ? driven_of(l, i, rb_located_row(l))
	                                            : l->driven[i];

	if (!own) {
		rb_pack_fail_memory(pack);
		return;
	}
	pack_own(own, pack);
	if (pack->loading && !pack->failed)
		l->piece[i].piece = own->piece;
}

const struct rb_gauss_piece *rb_driven_pack_motor(struct rb_driven **own, struct rb_pack *pack)
{
	bool has = *own != NULL;

	rb_pack_bool(pack, &has);
	if (!has)
		return NULL;
	if (pack->loading && !own_of(own, MOTOR_ROWS)) {
		rb_pack_fail_memory(pack);
		return NULL;
	}
	pack_own(*own, pack);
	return &(*own)->piece;
}
