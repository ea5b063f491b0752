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

/*
 * A guess reaches so many lengths of its polynomial, beyond which that grows by more than it falls
 * off; and is of the same motion when it misses the rates at the beginning by less than this share
 * of scale.
 */
static const double guess_reach = 3, guess_misses = 0x1p-10;
/* What a smooth guess misses there, in tolerances. */
static const double guess_smooth = 2048;
/* Of the coefficients of a row, together. */
static const double rounding = DBL_EPSILON / 8;
/* The second visit after a guess that was as near as this may be the last. */
static const double guess_near = 0x1p-20;

static const double node[RB_GAUSS_NODES] = {
	0.01985507175123188416, 0.10166676129318663020, 0.23723379504183550709,
	0.40828267875217509753, 0.59171732124782490247, 0.76276620495816449291,
	0.89833323870681336980, 0.98014492824876811584,
};

/*
 * What these, and the first half of the first two rows of `legendre`, have beyond a double. It
 * would be the same error in every step: energy would drift by it (Hairer, McLachlan,
 * Razakarivony).
 */
static const double node_low[RB_GAUSS_NODES] = {
	-1.1322e-20, -5.8129e-18, 2.5e-18,    -1.2429e-17,
	-4.3082e-17, -2.5e-18,    5.8129e-18, 2.7767e-17,
};
static const double legendre_low[2][RB_GAUSS_NODES / 2] = {
	{2.4319e-19, -5.7537e-18, 9.1343e-18, -3.6238e-18},
	{3.3678e-18, -1.1243e-17, 2.9236e-18, 6.8644e-18},
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

/* The square of the matrix: what rates of rates add to values. */
static const double square[RB_GAUSS_NODES][RB_GAUSS_NODES] = {
	{0.00030407574807789559061, -0.00023137963629454562354, 0.00026696329803531272225,
         -0.00028659435392144243595, 0.00026744838170096890360, -0.00020762005743542337415,
         0.00012180587341443528434, -0.000037587316453917887554},
	{0.0040355140641421860494, 0.0014270411084584506093, -0.00053664497942147429971,
         0.00046518913119369142065, -0.00040823337817640206305, 0.00031006274410689690480,
         -0.00018030992557114903502, 0.000055446411190696017935},
	{0.011088610132798172097, 0.014693350566825109562, 0.0028274050239356857791,
         -0.00078019899383794739893, 0.00054508125592471604598, -0.00038711321905971434122,
         0.00021979793761456936130, -0.000066995949224782491238},
	{0.019579987811889784559, 0.034378015056888750592, 0.026154745560326392100,
         0.0037748114528613013543, -0.00083599746573104498496, 0.00047147300310546691341,
         -0.00025030995345759958207, 0.000074647418642854475649},
	{0.029019036656773888971, 0.054238665275126333039, 0.056073392015629013592,
         0.032428387605758718704, 0.0037748114528613013543, -0.00067484023463732052537,
         0.00028523260468858199415, -0.000079991243849709231533},
	{0.037534907354956481898, 0.073727787016998637833, 0.082044391588427544962,
         0.064827794470770196585, 0.030238129149517769451, 0.0028274050239356857791,
         -0.00038041803457492318520, 0.000086145143108908199852},
	{0.044518975913173843362, 0.088401447755212952184, 0.10400570727604565019,
         0.088458462187340107237, 0.056067499625220437031, 0.020727494745030019681,
         0.0014270411084584506093, -0.00010532472774519489288},
	{0.048566780977416610399, 0.097800247629557643622, 0.11632045983440815607,
         0.10397003049104353700, 0.070151602683931361973, 0.034363538382391632867,
         0.0088653044390645614951, 0.00030407574807789559061},
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
 * node i. Of rows whose rate is a row they are kept for the first guess only.
 */
struct attempt {
	const struct rb_gauss_problem *problem;
	struct rb_gauss_guess guess;
	double time_s, h_s;
	const double *start, *rest;
	double *first, *value, *size, *g[1 + NODES];
	uint64_t *calls;
	bool shows; /* problem->visited is called */
	struct rb_error *err;
};

size_t rb_gauss_scratch_size(int n)
{
	return (size_t)(NODES + 6) * (size_t)n;
}

static int rate_row(const struct rb_gauss_problem *problem, size_t i)
{
	return problem->rate_row ? problem->rate_row[i] : -1;
}

/* Changes of rates count by what they do to values; also to those whose rates' rates they are. */
static void find_sizes(const struct attempt *a)
{
	const struct rb_gauss_problem *p = a->problem;

	memcpy(a->size, p->scale, (size_t)p->n * sizeof(double));
	for (size_t i = 0; i < (size_t)p->n; i++) {
		const int v = rate_row(p, i);

		if (v >= 0)
			a->size[v] = fmin(a->size[v], p->scale[i] / a->h_s);
	}
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
		const int v = rate_row(p, (size_t)i);

		if (v >= 0) {
			row[i] = a->h_s * a->value[v];
			continue;
		}
		const double now = a->h_s * rate[i];
		double off = fabs(now - row[i]) / a->size[i];

		/* against a tiny scale it may overflow all the same */
		if (off > DBL_MAX && isfinite(now))
			off = DBL_MAX;
		if (!(off <= *change)) /* NaN comes through */
			*change = off;
		row[i] = now;
	}
	return RB_OK;
}

/* The first guess of a node from the rates at the beginning and at the nodes before. */
static void value_ahead(const struct attempt *a, int at)
{
	for (int i = 0; i < a->problem->n; i++) {
		double sum = 0;

		for (int j = 0; j <= at; j++)
			sum += ahead[at][j] * a->g[j][i];
		a->value[i] = a->start[i] + (a->rest[i] + sum);
	}
}

/* The small ones first. */
static void value_at(const struct attempt *a, int at)
{
	for (int i = 0; i < a->problem->n; i++) {
		const int v = rate_row(a->problem, (size_t)i);
		const double *const weight = v < 0 ? matrix[at] : square[at];
		const int from = v < 0 ? i : v;
		double sum = 0;

		for (int j = 0; j < NODES; j++)
			sum += weight[j] * a->g[1 + j][from];
		if (v >= 0) {
			const double way = a->h_s * a->start[v];

			sum = node[at] * way +
			      (node_low[at] * way + a->h_s * (node[at] * a->rest[v] + sum));
		}
		a->value[i] = a->start[i] + (a->rest[i] + sum);
	}
}

/* One visit of all nodes, each with the newest rates of the others. `rate` is scratch. */
static enum rb_status sweep(const struct attempt *a, bool first, double *rate, double *change)
{
	const bool shows = a->shows && a->problem->visited;

	*change = 0;
	for (int i = 0; i < NODES; i++) {
		if (first) {
			value_ahead(a, i);
			memset(a->g[1 + i], 0, (size_t)a->problem->n * sizeof(double));
		} else {
			value_at(a, i);
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

static void polynomials(int count, double x, double *weight);

/* Component i of the rates that a guess has where its polynomials are `weight`, x the length. */
static double guessed(const struct attempt *a, const double *weight, size_t i)
{
	const size_t n = (size_t)a->problem->n;
	double sum = 0;

	for (size_t k = NODES; k-- > 0;)
		sum += weight[k] * a->guess.coefficient[k * n + i];
	return a->h_s / a->guess.length_s * sum;
}

/*
 * Rates at all nodes as guessed, with what the guess misses at the beginning; false: it is none.
 * Where motion goes on that is what the polynomial does not have, P_8 above all, which at nodes
 * ahead is much; or else the size of a jump where one force joins those that go on.
 */
static bool guess(const struct attempt *a)
{
	const struct rb_gauss_problem *p = a->problem;
	const struct rb_gauss_guess *from = &a->guess;
	double weight[NODES + 1];

	if (!from->coefficient || !(from->from_s + a->h_s <= guess_reach * from->length_s))
		return false;
	polynomials(NODES + 1, from->from_s / from->length_s, weight);
	const double last = weight[NODES];
	for (size_t i = 0; i < (size_t)p->n; i++) {
		if (rate_row(p, i) >= 0)
			continue;
		a->value[i] = a->g[0][i] - guessed(a, weight, i);
		if (!(fabs(a->value[i]) <= guess_misses * a->size[i]))
			return false;
	}
	for (int j = 0; j < NODES; j++) {
		polynomials(NODES + 1, (from->from_s + node[j] * a->h_s) / from->length_s, weight);
		for (size_t i = 0; i < (size_t)p->n; i++) {
			if (rate_row(p, i) >= 0)
				continue;
			const bool jumps = !(fabs(a->value[i]) <=
			                     guess_smooth * p->tolerance * a->size[i]) ||
			                   !(from->from_s >= from->length_s);
			a->g[1 + j][i] = guessed(a, weight, i) +
			                 (jumps ? 1 : weight[NODES] / last) * a->value[i];
		}
	}
	return true;
}

/*
 * Visits until the changes are below rounding or no longer fall: `*left` is what they then are.
 * `*sweeps` is 0 when something is not finite or they go on without end. A change may grow now and
 * then (a chain q' = w, w' = f(q) that is none of rows shows it in every other visit), so that two
 * visits without halving the smallest change so far are wanted before giving up.
 */
static enum rb_status converge(struct attempt *a, double *rate, int *sweeps, double *left)
{
	double change, before, least;
	int stalled = 0;

	*sweeps = 0;
	*left = 0;
	enum rb_status status = RB_OK;
	const bool near = guess(a);
	if (!near) {
		status = sweep(a, true, rate, &before);
		if (status != RB_OK || !isfinite(before))
			return status;
	}
	least = before = (double)INFINITY;
	a->shows = false;
	for (int count = 1; count <= SWEEPS_MAX; count++) {
		status = sweep(a, false, rate, &change);
		if (status != RB_OK || !isfinite(change))
			return status;
		const double ratio = change / before;
		if (change == 0 ||
		    (count > 1 && (change < 0x1p-2 * DBL_EPSILON ||
		                   (ratio < 0.5 && change * ratio < 0x1p-4 * DBL_EPSILON)))) {
			*sweeps = count;
			return RB_OK;
		}
		stalled = change < 0.5 * least ? 0 : stalled + 1;
		/* as the changes fall, the next one may be small enough */
		a->shows = stalled > 0 || (count > 1 ? change * ratio * ratio < 0x1p10 * DBL_EPSILON
		                                     : near && change < guess_near);
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
 * What the rounding of coefficients makes, relative to scale or value: in a step so long that
 * nearly all of its motion comes from the acceleration little is left of that at its beginning,
 * where an event may cut it. The next one is not to be longer.
 */
static double rounded(const struct rb_gauss_problem *problem, const struct rb_gauss_piece *piece)
{
	const size_t n = (size_t)problem->n;
	double worst = 0;

	for (size_t i = 0; i < n; i++) {
		double sum = 0;

		for (size_t k = 0; k < NODES; k++)
			sum += fabs(piece->coefficient[k * n + i]);
		worst = fmax(worst,
		             rounding * sum / fmax(problem->scale[i], fabs(piece->start[i])));
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
		a->value[i] = a->start[i] + (a->rest[i] + coefficient[i]);
		if (rate_row(p, i) >= 0)
			continue;
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
		if (rate_row(p, i) < 0)
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
		value_at(a, i);
		const enum rb_status status = p->rates(p->user, a->time_s + node[i] * a->h_s,
		                                       a->value, rate, a->err);

		if (status != RB_OK)
			return status;
		p->visited(p->user, i);
	}
	return RB_OK;
}

/*
 * Of x' = v they follow from those of v' = f: the integral of P_k, k > 0, is (P_(k+1) - P_(k-1)) /
 * (2 (2k + 1)) on [0, 1], and what P_8 has of v is nothing at the nodes.
 */
static void integrated(const struct attempt *a, size_t i, size_t v, double *coefficient)
{
	const size_t n = (size_t)a->problem->n;
	const double *const d = coefficient + v;

	coefficient[i] = a->h_s * a->start[v] + a->h_s * (a->rest[v] + (0.5 * d[0] - d[n] / 6));
	for (size_t k = 1; k < NODES; k++) {
		const double below = d[(k - 1) * n] / (double)(2 * (2 * k - 1));
		const double above = k + 1 < NODES ? d[(k + 1) * n] / (double)(2 * (2 * k + 3)) : 0;

		coefficient[k * n + i] = a->h_s * (below - above);
	}
}

static void coefficients(const struct attempt *a, double *coefficient)
{
	const size_t n = (size_t)a->problem->n;

	for (size_t k = 0; k < NODES; k++)
		for (size_t i = 0; i < n; i++) {
			double sum = 0, low = 0;

			/* from the ends to the middle, so that even and odd parts are not mixed */
			for (int j = 0; j < NODES / 2; j++) {
				const double both = k % 2 ? a->g[1 + j][i] - a->g[NODES - j][i]
				                          : a->g[1 + j][i] + a->g[NODES - j][i];

				sum += legendre[k][j] * both;
				low += k < 2 ? legendre_low[k][j] * both : 0;
			}
			coefficient[k * n + i] = sum + low;
		}
	for (size_t i = 0; i < n; i++)
		if (rate_row(a->problem, i) >= 0)
			integrated(a, i, (size_t)rate_row(a->problem, i), coefficient);
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
	double *const rate = problem->scratch, *const none = rate + n;
	struct attempt a = {.problem = problem,
	                    .guess = problem->guess,
	                    .time_s = time_s,
	                    .start = piece->start,
	                    .rest = piece->rest ? piece->rest : none,
	                    .first = rate + 2 * n,
	                    .value = rate + 3 * n,
	                    .size = rate + 4 * n,
	                    .calls = problem->calls,
	                    .err = err};
	double change = 0, left;
	int sweeps;

	for (size_t j = 0; j <= NODES; j++)
		a.g[j] = rate + (5 + j) * n;
	if (!(*try_s > 0) || !isfinite(*try_s))
		return RB_FAIL(err, RB_ERR_PHYSICS, "'step' is %g s, not a positive number",
		               *try_s);
	memset(none, 0, n * sizeof(double));
	memset(a.first, 0, n * sizeof(double));
	for (size_t i = 0; i < n; i++)
		a.value[i] = a.start[i] + a.rest[i];
	a.h_s = 1;
	find_sizes(&a);
	enum rb_status status = rates_at(&a, 0, a.first, rate, &change);
	if (status != RB_OK)
		return status;
	if (!isfinite(change))
		return RB_FAIL(err, RB_ERR_PHYSICS, "'rates' at %g s are not finite", time_s);
	for (a.h_s = *try_s;; a.h_s *= 0.5) {
		for (size_t i = 0; i < n; i++)
			a.g[0][i] = a.h_s * a.first[i];
		find_sizes(&a);
		status = converge(&a, rate, &sweeps, &left);
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
				*try_s = next_length(a.h_s, asked,
				                     fmax(error, rounded(problem, piece)), sweeps,
				                     a.h_s < *try_s);
				return status;
			}
		}
		/* what was too long is the best guess of its half */
		a.guess = (struct rb_gauss_guess){
			.coefficient = sweeps > 0 ? piece->coefficient : NULL, .length_s = a.h_s};
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

static double value_of(const struct rb_gauss_piece *piece, size_t i, const double weight[NODES])
{
	const double sum = sum_of(piece, i, weight);

	return piece->start[i] + (piece->rest ? piece->rest[i] + sum : sum);
}

double rb_gauss_value(const struct rb_gauss_piece *piece, int i, double t)
{
	double weight[NODES];

	integrals(part_of(piece, t), weight);
	return value_of(piece, (size_t)i, weight);
}

void rb_gauss_some(const struct rb_gauss_piece *piece, int first, int count, double t,
                   double *value)
{
	double weight[NODES];

	integrals(part_of(piece, t), weight);
	for (int i = 0; i < count; i++)
		value[i] = value_of(piece, (size_t)(first + i), weight);
}

void rb_gauss_values(const struct rb_gauss_piece *piece, double t, double *value)
{
	rb_gauss_some(piece, 0, piece->n, t, value);
}

/* A sum and what its rounding has left out (Dekker, Numer. Math. 18 (1971) 224). */
struct sum {
	double high, low;
};

static void add(struct sum *s, double x)
{
	const double sum = s->high + x, part = sum - s->high;

	s->low += (s->high - (sum - part)) + (x - part);
	s->high = sum;
}

static void add_product(struct sum *s, double a, double b)
{
	const double product = a * b;

	add(s, product);
	s->low += fma(a, b, -product);
}

double rb_gauss_rest(const struct rb_gauss_piece *piece, int i, int rate_row, double t)
{
	const size_t n = (size_t)piece->n, at = (size_t)i;
	const double *const c = piece->coefficient, h = piece->length_s;
	struct sum s = {piece->start[at], piece->rest ? piece->rest[at] : 0};
	double weight[NODES];

	integrals(part_of(piece, t), weight);
	for (size_t k = 0; k < NODES; k++)
		add_product(&s, weight[k], c[k * n + at]);
	if (rate_row >= 0) {
		const double *const v = c + rate_row;
		const double rest = piece->rest ? piece->rest[rate_row] : 0;
		struct sum lost = {-c[at], 0};

		add_product(&lost, h, piece->start[rate_row]);
		add_product(&lost, h, rest + (0.5 * v[0] - v[n] / 6));
		s.low += weight[0] * (lost.high + lost.low);
	}
	return (s.high - value_of(piece, at, weight)) + s.low;
}

/* P_0 .. P_(count - 1) on [0, 1] */
static void polynomials(int count, double x, double *weight)
{
	const double u = 2 * x - 1;

	weight[0] = 1;
	weight[1] = u;
	for (int k = 1; k + 1 < count; k++)
		weight[k + 1] = ((2 * k + 1) * u * weight[k] - k * weight[k - 1]) / (k + 1);
}

void rb_gauss_basis(double x, double value[NODES], double rate[NODES])
{
	integrals(x, value);
	polynomials(NODES, x, rate);
}

double rb_gauss_rate(const struct rb_gauss_piece *piece, int i, double t)
{
	double weight[NODES];

	polynomials(NODES, part_of(piece, t), weight);
	return sum_of(piece, (size_t)i, weight) / piece->length_s;
}

void rb_gauss_some_rates(const struct rb_gauss_piece *piece, int first, int count, double t,
                         double *rate)
{
	double weight[NODES];

	polynomials(NODES, part_of(piece, t), weight);
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
