/* SPDX-License-Identifier: MIT */
#include "constraint/eccentric.h"

#include <float.h>

/*
 * The tangential velocity is u = speed (c, s). With the parameter t, dp = speed dt, the end of
 * slip, where the direction may rotate ever faster, is at infinity: everything is analytic in t,
 * and the direction has a differential equation of its own. Steps are Taylor series, whose
 * coefficients are products of series; constant directions do not need them.
 */
enum {
	ORDER = 24,
	TERMS = ORDER + 1,
	/*
	 * the speed falls through all its digits at most twice, in steps of about one e-fold;
	 * changes of direction take a few more
	 */
	STEPS = 1024,
	EVENTS =
		/*
		 * compression restarts at most twice: normal acceleration changes its sign twice
		 * per turn
		 */
	64,
	ROUNDS = 128 /* of bisection, and of Newton's method for a direction */
};
/* Limit of the friction coefficient, as good as infinite. */
static const double friction_max = 0x1p100;
/*
 * Slip below this share of the speeds has ended: it is below the rounding even of quantities that
 * depend on its square root.
 */
static const double ended = DBL_EPSILON * DBL_EPSILON;
/* Directions whose rate is below this share of the rates are constant: K is not more accurate. */
static const double constant_direction = 4 * DBL_EPSILON;

/* Two tangential coordinates. */
struct pair {
	double x, y;
};

/*
 * K in units of its largest entry, multiplied by friction: rates of slip and normal velocity per
 * normal impulse.
 */
struct law {
	double nn;         /* normal velocity by normal impulse */
	struct pair n;     /* slip by normal impulse */
	double xx, xy, yy; /* slip by friction at its limit */
	double friction;
	double error; /* of the rates, relative; 0: rounding of a positive K */
	double unit;  /* unit of t, in which rates are about 1 */
};

struct impact {
	struct law law;
	struct pair along;   /* unit: direction of slip */
	double speed;        /* speed of slip */
	double w;            /* normal velocity, positive when separating */
	double p;            /* normal impulse so far */
	struct pair q;       /* friction impulse so far */
	double taken, given; /* work of compression and of restitution so far, >= 0 */
	double share;        /* e^2 */
	bool compressing, over;
};

static double dot(struct pair a, struct pair b)
{
	return a.x * b.x + a.y * b.y;
}

static struct pair unit(struct pair a)
{
	const double length = hypot(a.x, a.y);

	return (struct pair){a.x / length, a.y / length};
}

/* Rate of slip per normal impulse, slipping along d. */
static struct pair slip_rate(const struct law *law, struct pair d)
{
	return (struct pair){law->n.x - (law->xx * d.x + law->xy * d.y),
	                     law->n.y - (law->xy * d.x + law->yy * d.y)};
}

/* Rate of the normal velocity per normal impulse, slipping along d. */
static double normal_rate(const struct law *law, struct pair d)
{
	return law->nn - law->friction * dot(law->n, d);
}

static double restitution_left(const struct impact *c)
{
	return c->share * c->taken - c->given;
}

/* ---- constant directions ---- */

/*
 * Advances with constant rates by a normal impulse of at most `max`: `rate` of the normal velocity,
 * `friction_impulse` of the friction impulse.
 */
static void advance_straight(struct impact *c, double max, double rate,
                             struct pair friction_impulse)
{
	for (int event = 0; event < EVENTS && !c->over && max > 0; event++) {
		const bool compressing = c->compressing;
		double step = max;

		if (compressing && rate > 0 && -c->w / rate <= step) {
			step = -c->w / rate;
			c->compressing = false;
		} else if (!compressing) {
			const double rest = restitution_left(c),
				     square = c->w * c->w + 2 * rate * rest;
			const double end = square >= 0 ? 2 * rest / (c->w + sqrt(square))
			                               : HUGE_VAL;

			if (!(rest > 0) || end <= step) {
				step = rest > 0 ? end : 0;
				c->over = true;
			} else if (rate < 0 && -c->w / rate <= step) {
				step = -c->w / rate;
				c->compressing = true;
			}
		}
		if (isinf(step)) { /* only if K is not positive, by rounding */
			c->over = true;
			break;
		}
		*(compressing ? &c->taken : &c->given) += (compressing ? -1 : 1) * step *
		                                          (c->w + 0.5 * step * rate);
		c->w = c->compressing != compressing ? 0 : c->w + step * rate;
		c->p += step;
		c->q.x += step * friction_impulse.x;
		c->q.y += step * friction_impulse.y;
		max -= step;
	}
}

/* Slip in a constant direction, until it ends. */
static void slip_straight(struct impact *c)
{
	const struct law *const law = &c->law;
	const double deceleration = -dot(slip_rate(law, c->along), c->along);

	advance_straight(c, deceleration > 0 ? c->speed / deceleration : HUGE_VAL,
	                 normal_rate(law, c->along),
	                 (struct pair){-law->friction * c->along.x, -law->friction * c->along.y});
	c->speed = 0;
}

/* Solves (A + g) v = n, with A the rates of slip by friction at its limit. */
static struct pair solve_shifted(const struct law *law, double g, struct pair n)
{
	const double xx = law->xx + g, yy = law->yy + g;
	const double determinant = xx * yy - law->xy * law->xy;

	return (struct pair){(yy * n.x - law->xy * n.y) / determinant,
	                     (xx * n.y - law->xy * n.x) / determinant};
}

/*
 * Continues from zero slip. With v = A^-1 n, friction -v (relative to its limit) prevents slip; if
 * v is longer than 1, slip begins in the one direction d with slip_rate = g d, g > 0: |(A + g)^-1
 * n| = 1. The left side decreases with g, so that Newton's method for its inverse approaches the
 * root from one side (More, Sorensen, SIAM J. Sci. Stat. Comput. 4 (1983) 553).
 */
static void begin_slip(struct impact *c)
{
	const struct law *const law = &c->law;
	const double trace = law->xx + law->yy;
	const double determinant = law->xx * law->yy - law->xy * law->xy;
	/* if the block is singular to rounding, its smaller eigenvalue is unknown */
	const double least = law->error > 0 ? law->error : DBL_EPSILON * DBL_EPSILON;
	double g = determinant > least * trace * trace ? 0 : fmax(DBL_EPSILON, law->error) * trace;
	struct pair v = solve_shifted(law, g, law->n);

	if (hypot(v.x, v.y) <= 1) {
		const struct pair friction_impulse = {-law->friction * v.x, -law->friction * v.y};

		const double rate = law->nn + dot(law->n, friction_impulse);

		/*
		 * a linkage may be held by friction alone: no impulse separates the contact; `g`
		 * leaves a rate of that order
		 */
		if (law->error == 0 || rate > 16 * law->error * law->nn)
			/* positive, because K is */
			advance_straight(c, HUGE_VAL, fmax(rate, DBL_EPSILON * law->nn),
			                 friction_impulse);
		c->over = true;
		return;
	}
	for (int round = 0; round < ROUNDS; round++) {
		const double length = hypot(v.x, v.y);
		const double next = g + length * length * (length - 1) /
		                                dot(v, solve_shifted(law, g, v));

		if (!(next > g))
			break;
		g = next;
		v = solve_shifted(law, g, law->n);
	}
	c->along = unit(v);
	slip_straight(c);
	c->over = true;
}

/* ---- rotating directions ---- */

struct series {
	double x[TERMS], y[TERMS], speed[TERMS]; /* of direction and slip */
	double gain[TERMS], turn[TERMS],
		rate[TERMS]; /* rates of slip; of the direction; of w per impulse */
	double p[TERMS], w[TERMS], qx[TERMS], qy[TERMS], work[TERMS];
	double transverse
		/* of the direction from law.n: where it is zero, the rate has an extremum */
		[TERMS];
};

/* Two series at once: products of series are most of the cost of an impact. */
typedef double two __attribute__((vector_size(16)));

static void expand(const struct impact *c, struct series *t)
{
	const struct law *const law = &c->law;
	/*
	 * the direction, and with its coordinates swapped; the rates that rotate it; those of speed
	 * and w
	 */
	two along[TERMS], swapped[TERMS], bend[TERMS], bend_swapped[TERMS], rates[TERMS];

	t->x[0] = c->along.x;
	t->y[0] = c->along.y;
	t->speed[0] = c->speed;
	t->p[0] = t->qx[0] = t->qy[0] = t->work[0] = 0;
	t->w[0] = c->w;
	for (int k = 0; k < TERMS; k++) {
		const double over = law->unit / (k + 1), x = t->x[k], y = t->y[k];
		const double ax = (k == 0 ? law->n.x : 0) - (law->xx * x + law->xy * y);
		const double ay = (k == 0 ? law->n.y : 0) - (law->xy * x + law->yy * y);
		two gain = {0, 0}, turn = {0, 0}, turned = {0, 0}, driven = {0, 0},
		    friction_impulse = {0, 0};
		double work = 0;

		t->rate[k] = (k == 0 ? law->nn : 0) - law->friction * (law->n.x * x + law->n.y * y);
		t->transverse[k] = law->n.x * y - law->n.y * x;
		along[k] = (two){x, y};
		swapped[k] = (two){y, x};
		bend[k] = (two){ax, ay};
		bend_swapped[k] = (two){ay, ax};
		for (int i = 0; i <= k; i++) {
			gain += bend[i] * along[k - i];
			turn += bend_swapped[i] * along[k - i];
		}
		t->gain[k] = gain[0] + gain[1];
		t->turn[k] = turn[0] - turn[1];
		if (k == ORDER)
			break;
		rates[k] = (two){t->gain[k], t->rate[k]};
		for (int i = 0; i <= k; i++) {
			turned += swapped[i] * t->turn[k - i];
			driven += t->speed[i] * rates[k - i];
			friction_impulse += t->speed[i] * along[k - i];
			work += t->speed[i] * t->w[k - i];
		}
		t->x[k + 1] = -over * turned[0];
		t->y[k + 1] = over * turned[1];
		t->speed[k + 1] = over * driven[0];
		t->p[k + 1] = over * t->speed[k];
		t->w[k + 1] = over * driven[1];
		t->qx[k + 1] = -over * law->friction * friction_impulse[0];
		t->qy[k + 1] = -over * law->friction * friction_impulse[1];
		t->work[k + 1] = over * work;
	}
}

/*
 * Step at which the last terms are still below rounding. Work, a product of two factors that
 * decrease with slip, is the most demanding.
 */
static double step_of(const struct series *t)
{
	const double work = t->speed[0] * fmax(fabs(t->w[0]), t->speed[0]);
	double step = 0x1p100;

	for (int k = ORDER - 1; k <= ORDER; k++) {
		const double size = fmax(
			fmax(fabs(t->x[k]), fabs(t->y[k])),
			fmax(fabs(t->speed[k]) / t->speed[0], fabs(t->work[k]) / work));

		if (size > 0)
			step = fmin(step, pow(DBL_EPSILON / size, 1.0 / k));
	}
	return step;
}

static double value(const double *a, double t)
{
	double sum = a[ORDER];

	for (int k = ORDER - 1; k >= 0; k--)
		sum = sum * t + a[k];
	return sum;
}

static double slope(const double *a, double t)
{
	double sum = ORDER * a[ORDER];

	for (int k = ORDER - 1; k >= 1; k--)
		sum = sum * t + k * a[k];
	return sum;
}

/* Zero of a - level in [low, high], where a is monotone: Newton's method, or bisection. */
static double crossing(const double *a, double level, double low, double high)
{
	const bool rises = value(a, high) > level;
	double t = high, before = high - low;

	for (int round = 0; round < ROUNDS; round++) {
		const double off = value(a, t) - level;

		*((off > 0) == rises ? &high : &low) = t;
		double next = t - off / slope(a, t);
		/* Newton's method converges from the second round on, or is far from the root */
		if (!(next >= low && next <= high && fabs(next - t) <= 0.5 * before))
			next = 0.5 * (low + high);
		before = fabs(next - t);
		if (off == 0 || before <= DBL_EPSILON * fabs(t))
			return next >= low && next <= high && off != 0 ? next : t;
		t = next;
	}
	return t;
}

/* First sign change in (low, high) of a series that is monotone there; `high` if there is none. */
static double first_change(const double *a, double low, double high)
{
	return (value(a, low) > 0) != (value(a, high) > 0) ? crossing(a, 0, low, high) : high;
}

static void advance_to(struct impact *c, const struct series *s, double t)
{
	const double work = value(s->work, t);

	c->along = unit((struct pair){value(s->x, t), value(s->y, t)});
	c->speed = value(s->speed, t);
	c->w = value(s->w, t);
	c->p += value(s->p, t);
	c->q.x += value(s->qx, t);
	c->q.y += value(s->qy, t);
	*(c->compressing ? &c->taken : &c->given) += c->compressing ? -work : work;
}

/*
 * If compression or restitution ends in [low, high], where w is monotone, advances to that moment
 * and returns true.
 */
static bool ends_within(struct impact *c, const struct series *s, double low, double high)
{
	const double after = value(s->w, high);
	const bool changes = c->compressing ? after > 0 : after < 0;
	const double end = changes ? crossing(s->w, 0, low, high) : high;

	if (!c->compressing && value(s->work, end) >= restitution_left(c)) {
		advance_to(c, s, crossing(s->work, restitution_left(c), low, end));
		c->over = true;
		return true;
	}
	if (!changes)
		return false;
	advance_to(c, s, end);
	c->w = 0;
	c->compressing = !c->compressing;
	c->over = !c->compressing && !(restitution_left(c) > 0);
	return true;
}

static void slip_rotating(struct impact *c)
{
	struct series s;

	expand(c, &s);
	const double end = step_of(&s);
	const double middle = first_change(s.transverse, 0, end);
	const double stop[5] = {0, first_change(s.rate, 0, middle), middle,
	                        first_change(s.rate, middle, end), end};
	for (int k = 0; k < 4; k++)
		if (stop[k + 1] > stop[k] && ends_within(c, &s, stop[k], stop[k + 1]))
			return;
	advance_to(c, &s, end);
}

static void run(struct impact *c)
{
	for (int step = 0; step < STEPS && !c->over; step++) {
		const struct pair rate = slip_rate(&c->law, c->along);
		const double turn = rate.y * c->along.x - rate.x * c->along.y;

		if (!(c->speed > ended))
			begin_slip(c);
		else if (fabs(turn) * c->law.unit <= constant_direction || step == STEPS - 2)
			slip_straight(c);
		else
			slip_rotating(c);
	}
}

/* ---- from vectors and back ---- */

static double largest_of(const rb_mat3 *a)
{
	double largest = 0;

	for (int i = 0; i < 9; i++)
		largest = fmax(largest, fabs(a->m[i / 3][i % 3]));
	return largest;
}

/* Exponent of a power of two that scales `size` to about 1 without loss of digits. */
static int binary_size(double size)
{
	int exponent;

	frexp(size, &exponent);
	return exponent;
}

static rb_vec3 scaled(rb_vec3 a, int exponent)
{
	return (rb_vec3){ldexp(a.x, exponent), ldexp(a.y, exponent), ldexp(a.z, exponent)};
}

/*
 * K in units in which its entries are about 1, made symmetric where rounding has left it otherwise.
 */
static rb_mat3 inverse_effective_mass_of(const struct rb_eccentric *contact, int size)
{
	rb_mat3 inverse_effective_mass;

	for (int i = 0; i < 9; i++)
		inverse_effective_mass.m[i / 3][i % 3] =
			0.5 * (ldexp(contact->inverse_effective_mass.m[i / 3][i % 3], -size) +
		               ldexp(contact->inverse_effective_mass.m[i % 3][i / 3], -size));
	return inverse_effective_mass;
}

static struct law law_of(const struct rb_eccentric *contact, rb_vec3 t, rb_vec3 s)
{
	const rb_vec3 kn = rb_mat3_apply(&contact->inverse_effective_mass, contact->normal);
	const rb_vec3 kt = rb_mat3_apply(&contact->inverse_effective_mass, t);
	const rb_vec3 ks = rb_mat3_apply(&contact->inverse_effective_mass, s);
	const double friction = fmin(contact->friction, friction_max);
	struct law law = {.nn = rb_vec3_dot(contact->normal, kn),
	                  .n = {rb_vec3_dot(t, kn), rb_vec3_dot(s, kn)},
	                  .xx = friction * rb_vec3_dot(t, kt),
	                  .xy = friction * rb_vec3_dot(s, kt),
	                  .yy = friction * rb_vec3_dot(s, ks),
	                  .friction = friction,
	                  .error = contact->error};

	law.unit = 1 / (fabs(law.n.x) + fabs(law.n.y) + law.xx + law.yy + law.nn);
	return law;
}

/* Does the impulse increase kinetic energy by more than rounding? The change is J.(u + K J / 2). */
static bool gains_energy(const struct rb_eccentric *contact, rb_vec3 u, rb_vec3 impulse)
{
	const rb_vec3 change = rb_mat3_apply(&contact->inverse_effective_mass, impulse);
	const double before = rb_vec3_dot(impulse, u), more = 0.5 * rb_vec3_dot(impulse, change);

	return !(before + more <= 64 * DBL_EPSILON * (fabs(before) + fabs(more)));
}

/* The impulse without friction. */
static rb_vec3 along_normal(const struct rb_eccentric *contact, const struct law *law,
                            rb_vec3 velocity)
{
	const double approach = -rb_vec3_dot(velocity, contact->normal);

	return rb_vec3_scale((1 + contact->restitution) * (approach / law->nn), contact->normal);
}

static rb_vec3 solve(const struct rb_eccentric *contact, rb_vec3 u)
{
	const rb_vec3 t = rb_vec3_across(contact->normal), s = rb_vec3_cross(contact->normal, t);
	const struct pair slip = {rb_vec3_dot(t, u), rb_vec3_dot(s, u)};
	struct impact c = {.law = law_of(contact, t, s),
	                   .speed = hypot(slip.x, slip.y),
	                   .w = rb_vec3_dot(contact->normal, u),
	                   .share = contact->restitution * contact->restitution,
	                   .compressing = true};

	c.along = c.speed > 0 ? unit(slip) : (struct pair){1, 0};
	if (c.w > 0 || (c.w == 0 && !(c.speed > ended && normal_rate(&c.law, c.along) < 0)))
		return (rb_vec3){0, 0, 0};
	run(&c);
	const rb_vec3 impulse = rb_vec3_add_scaled(
		rb_vec3_add_scaled(rb_vec3_scale(c.p, contact->normal), c.q.x, t), c.q.y, s);
	/* the fallback for a K that no bodies have */
	return gains_energy(contact, u, impulse) ? along_normal(contact, &c.law, u) : impulse;
}

rb_vec3 rb_eccentric_impulse(const struct rb_eccentric *contact, rb_vec3 velocity)
{
	const double largest = largest_of(&contact->inverse_effective_mass),
		     fastest = rb_vec3_max_abs(velocity);
	const rb_vec3 none = {0, 0, 0};

	if (!(largest > 0) || !isfinite(largest) || !(fastest > 0) || !isfinite(fastest))
		return none;
	const int size = binary_size(largest), speed = binary_size(fastest);
	struct rb_eccentric own = *contact;

	own.inverse_effective_mass = inverse_effective_mass_of(contact, size);
	const rb_vec3 impulse = scaled(solve(&own, scaled(velocity, -speed)), speed - size);
	return rb_vec3_finite(impulse) ? impulse : none;
}
