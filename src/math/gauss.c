/* SPDX-License-Identifier: MIT */
/*
 * Gauss-Legendre collocation, 8 nodes on [0, 1].
 *
 * The tables were worked out with 70 digits: nodes as roots of the shifted Legendre polynomial P_8
 * by Newton's method from cos(pi (i - 1/4) / (8 + 1/2)), the rest by exact integration of Lagrange
 * polynomials over them. Nothing here depends on the sign of a component: mirrored problems give
 * mirrored bits.
 */
#include "math/gauss.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "base/error.h"

enum { NODES = RB_GAUSS_NODES, SWEEPS_MAX = 40, SWEEPS_MANY = 14, MISSED_TAILS = 8 };

static const double node[RB_GAUSS_NODES] = {
	0.01985507175123188416, 0.10166676129318663020, 0.23723379504183550709,
	0.40828267875217509753, 0.59171732124782490247, 0.76276620495816449291,
	0.89833323870681336980, 0.98014492824876811584,
};

/* Integrals of the nodes' Lagrange polynomials from 0 to each node (the Runge-Kutta matrix). */
static const double matrix[RB_GAUSS_NODES][RB_GAUSS_NODES] = {
	{0.02530713407259406479, -0.00910594330597007502, 0.00628083114703047398,
         -0.00448301561305475144, 0.00307849136832677989, -0.00191767525463695234,
         0.00097275766405926353, -0.00027750832711691922},
	{0.05475932176755432028, 0.05559525861334361764, -0.01363979623578166925,
         0.00814970885836055054, -0.00521535208914715338, 0.00313975298546366894,
         -0.00156493491094894238, 0.00044280230434223782},
	{0.04858753599891288094, 0.12085952499717316744, 0.07842666146947182183,
         -0.01597510336187843148, 0.00837173272022616379, -0.00464346586210447979,
         0.00222571477528489972, -0.00061880569525051537},
	{0.05186552097058123457, 0.10619349014834840688, 0.17067113427455362128,
         0.09067094584459049574, -0.01602104132102501317, 0.00724120656122226986,
         -0.00319781431036077032, 0.00085923658426485269},
	{0.04975503156092327689, 0.11438833153704800559, 0.14961211637772137381,
         0.19736293301020600465, 0.09067094584459049574, -0.01381781133560997762,
         0.00499702707833882839, -0.00125125282539310499},
	{0.05123307384043864494, 0.10896480245140233555, 0.16149678880104812346,
         0.17297015896895482770, 0.19731699505105942296, 0.07842666146947182183,
         -0.00966900777048593217, 0.00202673214627524863},
	{0.05017146584084589176, 0.11275545213763617765, 0.15371356995347997473,
         0.18655724377832814486, 0.17319218283082044095, 0.17049311917472531292,
         0.05559525861334361764, -0.00414505362236619071},
	{0.05089177647230504880, 0.11021775956262797175, 0.15877099819358059601,
         0.17826340032085421159, 0.18582490730223574292, 0.15057249179191316969,
         0.12029646053265731029, 0.02530713407259406479},
};

/*
 * legendre[k][i]: (2k+1) times weight i times P_k at node i: values at the nodes to Legendre
 * coefficients.
 */
static const double legendre[RB_GAUSS_NODES][RB_GAUSS_NODES] = {
	{0.05061426814518812958, 0.11119051722668723527, 0.15685332293894364367,
         0.18134189168918099148, 0.18134189168918099148, 0.15685332293894364367,
         0.11119051722668723527, 0.05061426814518812958},
	{-0.14581310488161158486, -0.26574527304235230366, -0.24729451442246177791,
         -0.09979315521446929107, 0.09979315521446929107, 0.24729451442246177791,
         0.26574527304235230366, 0.14581310488161158486},
	{0.22352144354258714757, 0.25129958334321499281, -0.06723010203854732554,
         -0.40759092484725481485, -0.40759092484725481485, -0.06723010203854732554,
         0.25129958334321499281, 0.22352144354258714757},
	{-0.27401882283041490456, -0.05375635644396032181, 0.46712075003583032557,
         0.32968848669588295664, -0.32968848669588295664, -0.46712075003583032557,
         0.05375635644396032181, 0.27401882283041490456},
	{0.29030541733775395148, -0.24289619147803757641, -0.46158532259653042903,
         0.41417609673681405396, 0.41417609673681405396, -0.46158532259653042903,
         -0.24289619147803757641, 0.29030541733775395148},
	{-0.26882935877865387365, 0.49329537666193687180, -0.05356581100520440332,
         -0.58160886344932168818, 0.58160886344932168818, 0.05356581100520440332,
         -0.49329537666193687180, 0.26882935877865387365},
	{0.20989219106703229190, -0.55910738314336459944, 0.61660486350253587505,
         -0.26738967142620356751, -0.26738967142620356751, 0.61660486350253587505,
         -0.55910738314336459944, 0.20989219106703229190},
	{-0.11769245644771356063, 0.37789693708459212621, -0.63177455311900480477,
         0.78490655792181316393, -0.78490655792181316393, 0.63177455311900480477,
         -0.37789693708459212621, 0.11769245644771356063},
};

/*
 * ahead[i]: integrals from 0 to node i of the Lagrange polynomials of 0 and the nodes before i: the
 * first guess of a node from what is known when its turn comes.
 */
static const double ahead[RB_GAUSS_NODES][RB_GAUSS_NODES] = {
	{0.01985507175123188416},
	{-0.15862266201762307197, 0.26028942331080970217},
	{0.74792381144791356906, -0.97859043366522332666, 0.46790041725914526469},
	{-2.47147425596198772262, 3.59286692663012581634, -1.33649403485557258165,
         0.62338404293960958547},
	{5.48562656376850024788, -8.06113353674566227254, 3.91379233728593732339,
         -1.41495976376143483994, 0.66839172070048444368},
	{-7.23772086327734416902, 11.02589493245824685125, -5.63371887242853624489,
         3.08739929105894617433, -1.06739676095856574418, 0.58830847810541762542},
	{4.51613151261325416206, -6.94795580405444624101, 4.13815201151519317972,
         -2.29943915282999866651, 1.56500860101529367526, -0.48753199965742820924,
         0.41396807010494546952},
	{-0.79034353151547772212, 1.30017757208901890353, -0.67317403537028056520,
         0.72003890281695974020, -0.22691066374902486247, 0.46539345515292744264,
         -0.02399176417992316996, 0.20895499300456834922},
};

/*
 * What an attempt works on; `g` are rates times the step's length, g[0] at its start, g[1 + i] at
 * node i.
 */
struct attempt {
	const struct rb_gauss_problem *problem;
	double time_s, h_s;
	const double *start;
	double *first, *value, *g[1 + NODES];
	uint64_t *calls;
	bool shows; /* problem->visited is called */
	struct rb_error *err;
};

size_t rb_gauss_room(int n)
{
	return (size_t)(NODES + 4) * (size_t)n;
}

/*
 * Calls the rates at `value` and puts them into `row`; `*change` is the largest change of a row's
 * entry. What a try that is too long has thrown to infinity is asked nothing: its rates might be
 * taken for a mistake in them.
 */
static enum rb_status rates_at(const struct attempt *a, double part, double *row, double *rate,
                               double *change)
{
	const struct rb_gauss_problem *p = a->problem;

	for (int i = 0; i < p->n; i++)
		if (!isfinite(a->value[i])) {
			*change = (double)INFINITY;
			return RB_OK;
		}
	++*a->calls;
	const enum rb_status status = p->rates(p->user, a->time_s + part * a->h_s, a->value, rate,
	                                       a->err);
	if (status != RB_OK)
		return status;
	for (int i = 0; i < p->n; i++) {
		const double now = a->h_s * rate[i];
		double off = fabs(now - row[i]) / p->scale[i];

		/* against a tiny scale it may overflow all the same */
		if (off > DBL_MAX && isfinite(now))
			off = DBL_MAX;
		if (!(off <= *change)) /* NaN comes through */
			*change = off;
		row[i] = now;
	}
	return RB_OK;
}

/* value = start + sum of weight[j] g[from + j] */
static void value_of(const struct attempt *a, const double *weight, int from, int count)
{
	for (int i = 0; i < a->problem->n; i++) {
		double sum = 0;

		for (int j = 0; j < count; j++)
			sum += weight[j] * a->g[from + j][i];
		a->value[i] = a->start[i] + sum;
	}
}

/* One visit of all nodes, each with the newest rates of the others. `rate` is scratch. */
static enum rb_status sweep(const struct attempt *a, bool first, double *rate, double *change)
{
	const bool shows = a->shows && a->problem->visited;

	*change = 0;
	for (int i = 0; i < NODES; i++) {
		if (first) {
			value_of(a, ahead[i], 0, i + 1);
			memset(a->g[1 + i], 0, (size_t)a->problem->n * sizeof(double));
		} else {
			value_of(a, matrix[i], 1, NODES);
		}
		const enum rb_status status = rates_at(a, node[i], a->g[1 + i], rate, change);
		if (status != RB_OK)
			return status;
		if (!isfinite(*change))
			return RB_OK;
		if (shows)
			a->problem->visited(a->problem->user, i);
	}
	return RB_OK;
}

/*
 * Visits until the changes are below rounding or no longer fall: `*left` is what they then are.
 * `*sweeps` is 0 when something is not finite or they go on without end. A change may grow now and
 * then (a chain x' = v, v' = f(x) shows it in every other visit), so that two visits without
 * halving the smallest change so far are wanted before giving up.
 */
static enum rb_status settle(struct attempt *a, double *rate, int *sweeps, double *left)
{
	double change, before, least;
	int stalled = 0;

	*sweeps = 0;
	*left = 0;
	enum rb_status status = sweep(a, true, rate, &before);
	if (status != RB_OK || !isfinite(before))
		return status;
	least = before = (double)INFINITY;
	a->shows = false;
	for (int count = 1; count <= SWEEPS_MAX; count++) {
		status = sweep(a, false, rate, &change);
		if (status != RB_OK || !isfinite(change))
			return status;
		const double ratio = change / before;
		if (change == 0 ||
		    (count > 1 && ratio < 0.5 && change * ratio < 0x1p-4 * DBL_EPSILON)) {
			*sweeps = count;
			return RB_OK;
		}
		stalled = change < 0.5 * least ? 0 : stalled + 1;
		/* as the changes fall, the next one may be small enough */
		a->shows = stalled > 0 ||
		           (count > 1 && change * ratio * ratio < 0x1p10 * DBL_EPSILON);
		least = fmin(least, change);
		before = change;
		if (stalled == 2) {
			*sweeps = count;
			*left = least;
			return RB_OK;
		}
	}
	return RB_OK;
}

/*
 * The largest part of the rates that the polynomial does not hold, integrated, relative to scale.
 * The missing coefficients are estimated from those that are there, in pairs (of functions that are
 * even or odd about the middle every other one is zero): the last pair falls on as the earlier ones
 * did, whichever fell less.
 */
static double tail(const struct rb_gauss_problem *problem, const double *coefficient)
{
	const size_t n = (size_t)problem->n;
	double worst = 0;

	for (size_t i = 0; i < n; i++) {
		double pair[3];

		for (size_t k = 0; k < 3; k++)
			pair[k] = fmax(fabs(coefficient[(2 * k + 2) * n + i]),
			               fabs(coefficient[(2 * k + 3) * n + i]));
		if (!(pair[2] > 0))
			continue;
		const double fall = fmin(fmax(pair[2] / pair[1], pair[1] / pair[0]), 1);
		/* the integral of P_8 is (P_9 - P_7)/34 on [0, 1] */
		const double missing = pair[2] * fall / (1 - fmin(fall, 0.75)) / 34;
		worst = fmax(worst, missing / problem->scale[i]);
	}
	return worst;
}

/*
 * What the polynomial misses between an end and the node next to it, where a jump is seen by no
 * node, integrated, relative to scale; of rates without one it is of the size of the tail.
 */
static double missed_at_ends(struct attempt *a, const double *coefficient, double *rate,
                             enum rb_status *status)
{
	const struct rb_gauss_problem *p = a->problem;
	const size_t n = (size_t)p->n;
	double worst = 0;

	for (size_t i = 0; i < n; i++) {
		a->value[i] = a->start[i] + coefficient[i];
		double odd = 0, even = 0;

		for (size_t k = NODES; k-- > 0;)
			*(k % 2 ? &odd : &even) += coefficient[k * n + i];
		/* at the end, for later */
		a->g[0][i] = even + odd;
		worst = fmax(worst, fabs(even - odd - a->h_s * a->first[i]) / p->scale[i]);
	}
	(*a->calls)++;
	*status = p->rates(p->user, a->time_s + a->h_s, a->value, rate, a->err);
	for (size_t i = 0; i < n && *status == RB_OK; i++)
		worst = fmax(worst, fabs(a->g[0][i] - a->h_s * rate[i]) / p->scale[i]);
	return node[0] * worst;
}

/*
 * Where the last visit of the nodes was not foreseen, once more, and not counted; the values are as
 * accepted.
 */
static enum rb_status show(const struct attempt *a, double *rate)
{
	const struct rb_gauss_problem *p = a->problem;

	for (int i = 0; i < NODES && p->visited && !a->shows; i++) {
		value_of(a, matrix[i], 1, NODES);
		const enum rb_status status = p->rates(p->user, a->time_s + node[i] * a->h_s,
		                                       a->value, rate, a->err);

		if (status != RB_OK)
			return status;
		p->visited(p->user, i);
	}
	return RB_OK;
}

static void coefficients(const struct attempt *a, double *coefficient)
{
	const size_t n = (size_t)a->problem->n;

	for (size_t k = 0; k < NODES; k++)
		for (size_t i = 0; i < n; i++) {
			double sum = 0;

			/* from the ends to the middle, so that even and odd parts are not mixed */
			for (int j = 0; j < NODES / 2; j++)
				sum += legendre[k][j] *
				       (k % 2 ? a->g[1 + j][i] - a->g[NODES - j][i]
				              : a->g[1 + j][i] + a->g[NODES - j][i]);
			coefficient[k * n + i] = sum;
		}
}

void rb_gauss_integrate(struct rb_gauss_piece *piece, double length_s, const double *rate)
{
	const size_t n = (size_t)piece->n;

	piece->length_s = length_s;
	memset(piece->start, 0, n * sizeof(double));
	for (size_t k = 0; k < NODES; k++)
		for (size_t i = 0; i < n; i++) {
			double sum = 0;

			for (size_t j = 0; j < NODES; j++)
				sum += legendre[k][j < NODES / 2 ? j : NODES - 1 - j] *
				       (k % 2 && j >= NODES / 2 ? -rate[j * n + i]
				                                : rate[j * n + i]);
			piece->coefficient[k * n + i] = length_s * sum;
		}
}

/*
 * What to try next; the eighth root by square roots, which round the same everywhere. Rounded down
 * to 8 binary digits, so that the lengths of steps add up without error.
 */
static double next_length(double h_s, double tolerance, double error, int sweeps, bool halved)
{
	const double max = halved || sweeps > SWEEPS_MANY ? 1 : 4;
	double factor = max;
	int exponent;

	if (error > 0)
		factor = fmax(fmin(0.8 * sqrt(sqrt(sqrt(tolerance / error))), max), 0.25);
	const double digits = frexp(h_s * factor, &exponent);
	return ldexp(floor(digits * 0x1p8), exponent - 8);
}

enum rb_status rb_gauss_step(const struct rb_gauss_problem *problem, double time_s, double *try_s,
                             double least_s, struct rb_gauss_piece *piece, struct rb_error *err)
{
	const size_t n = (size_t)problem->n;
	struct attempt a = {.problem = problem,
	                    .time_s = time_s,
	                    .start = piece->start,
	                    .first = problem->scratch,
	                    .value = problem->scratch + n,
	                    .calls = problem->calls,
	                    .err = err};
	double *const rate = problem->scratch + 2 * n;
	double change = 0, left;
	int sweeps;

	for (size_t j = 0; j <= NODES; j++)
		a.g[j] = problem->scratch + (3 + j) * n;
	if (!(*try_s > 0) || !isfinite(*try_s))
		return RB_FAIL(err, RB_ERR_PHYSICS, "'step' is %g s, not a positive number",
		               *try_s);
	memcpy(a.value, a.start, n * sizeof(double));
	memset(a.g[0], 0, n * sizeof(double));
	a.h_s = 1;
	enum rb_status status = rates_at(&a, 0, a.g[0], a.first, &change);
	if (status != RB_OK)
		return status;
	if (!isfinite(change))
		return RB_FAIL(err, RB_ERR_PHYSICS, "'rates' at %g s are not finite", time_s);
	for (a.h_s = *try_s;; a.h_s *= 0.5) {
		for (size_t i = 0; i < n; i++)
			a.g[0][i] = a.h_s * a.first[i];
		status = settle(&a, rate, &sweeps, &left);
		if (status != RB_OK)
			return status;
		if (sweeps > 0) {
			coefficients(&a, piece->coefficient);
			const double error = tail(problem, piece->coefficient);
			const double asked = fmax(
				problem->tolerance,
				problem->noise ? problem->noise(problem->user, piece->coefficient)
					       : 0);
			const bool fits = error <= asked && left <= asked;
			const double missed = fits && problem->jumps
			                              ? missed_at_ends(&a, piece->coefficient, rate,
			                                               &status)
			                              : 0;
			if (status != RB_OK)
				return status;
			if (fits && missed <= MISSED_TAILS * asked) {
				status = show(&a, rate);
				piece->length_s = a.h_s;
				*try_s = next_length(a.h_s, asked, error, sweeps, a.h_s < *try_s);
				return status;
			}
		}
		if (!(0.5 * a.h_s >= least_s) || !(0.5 * a.h_s > 0))
			return RB_FAIL(err, RB_ERR_PHYSICS,
			               "'step' at %g s would have to be shorter than %g s for an "
			               "error of %g",
			               time_s, least_s, problem->tolerance);
	}
}

/*
 * Integrals over [0, x] of P_k on [0, 1], x in [0, 1]: x for k = 0, else -2 x (1 - x) P'_k(2x - 1)
 * / (k (k + 1)), whose factors keep all digits near both ends. The P'_k are Gegenbauer's
 * polynomials for 3/2: n C_n = (2n + 1) u C_(n-1) - (n + 1) C_(n-2).
 */
static void integrals(double x, double weight[NODES])
{
	const double u = 2 * x - 1, ends = -2 * x * (1 - x);
	double older = 0, old = 1;

	weight[0] = x;
	for (int k = 1; k < NODES; k++) {
		weight[k] = ends * old / (k * (k + 1));
		const double next = ((2 * k + 1) * u * old - (k + 1) * older) / k;
		older = old;
		old = next;
	}
}

static double part_of(const struct rb_gauss_piece *piece, double t)
{
	return piece->length_s > 0 ? t / piece->length_s : 0;
}

/* The small coefficients first. */
static double sum_of(const struct rb_gauss_piece *piece, size_t i, const double weight[NODES])
{
	const size_t n = (size_t)piece->n;
	double sum = 0;

	for (size_t k = NODES; k-- > 0;)
		sum += weight[k] * piece->coefficient[k * n + i];
	return sum;
}

double rb_gauss_value(const struct rb_gauss_piece *piece, int i, double t)
{
	double weight[NODES];

	integrals(part_of(piece, t), weight);
	return piece->start[i] + sum_of(piece, (size_t)i, weight);
}

void rb_gauss_some(const struct rb_gauss_piece *piece, int first, int count, double t,
                   double *value)
{
	double weight[NODES];

	integrals(part_of(piece, t), weight);
	for (int i = 0; i < count; i++)
		value[i] = piece->start[first + i] + sum_of(piece, (size_t)(first + i), weight);
}

void rb_gauss_values(const struct rb_gauss_piece *piece, double t, double *value)
{
	double weight[NODES];

	integrals(part_of(piece, t), weight);
	for (size_t i = 0; i < (size_t)piece->n; i++)
		value[i] = piece->start[i] + sum_of(piece, i, weight);
}

/* P_k on [0, 1] */
static void polynomials(double x, double weight[NODES])
{
	const double u = 2 * x - 1;

	weight[0] = 1;
	weight[1] = u;
	for (int k = 1; k + 1 < NODES; k++)
		weight[k + 1] = ((2 * k + 1) * u * weight[k] - k * weight[k - 1]) / (k + 1);
}

void rb_gauss_basis(double x, double value[NODES], double rate[NODES])
{
	integrals(x, value);
	polynomials(x, rate);
}

double rb_gauss_rate(const struct rb_gauss_piece *piece, int i, double t)
{
	double weight[NODES];

	polynomials(part_of(piece, t), weight);
	return sum_of(piece, (size_t)i, weight) / piece->length_s;
}

void rb_gauss_some_rates(const struct rb_gauss_piece *piece, int first, int count, double t,
                         double *rate)
{
	double weight[NODES];

	polynomials(part_of(piece, t), weight);
	for (int i = 0; i < count; i++)
		rate[i] = sum_of(piece, (size_t)(first + i), weight) / piece->length_s;
}

double rb_gauss_rate_bound(const struct rb_gauss_piece *piece, int i)
{
	double sum = 0;

	for (size_t k = NODES; k-- > 0;)
		sum += fabs(piece->coefficient[k * (size_t)piece->n + (size_t)i]);
	return sum * (1 + 16 * DBL_EPSILON) /
	       piece->length_s; /* the sum may have been rounded down */
}
