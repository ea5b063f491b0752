/* SPDX-License-Identifier: MIT */
/*
 * LU decomposition with row pivots, in place. Columns are taken in order of index, except for those
 * with a small rest (below the share `early` of their first size), which are postponed to the end.
 * Full pivoting would find the rank as well, but it destroys the band structure of chains of
 * contacts and depends on the order of unknowns only by ties. A singular value decomposition was
 * rejected for its cost: the rank is needed only if the system is redundant (a table on four legs),
 * and then the kernel takes one back substitution for each open column (rb_dense_opened).
 *
 * `down`, `last` and `size` hold the envelope of the matrix, by which rows and columns of zeros are
 * skipped: where the caller knows it, what is outside is neither zeroed nor read. The multipliers
 * stay in the eliminated entries for further right sides.
 */
#include "math/dense.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/error.h"
#include "math/lanes.h"

/*
 * Share of a column that must remain for it to be used as a pivot while there are others. A column
 * with a smaller rest is nearly a combination of previous ones; if it were used first, its unknown
 * would take the components of the open ones many times over (1e6 times for four corners that slide
 * and turn on sticking contacts).
 */
static const double early = 0x1p-5;
/* A pivot below this share of its column makes the following rounding errors exceed the margin. */
static const double small_pivot = 0.25;
/* Rest of a dependent column, in multiples of the rounding of its entries. */
static const double margin = 16;

/*
 * Columns not yet used: those from index `from` on, n for none, and the postponed ones at the end
 * of `order`.
 */
struct remaining {
	int from; /* n: no columns in order remain */
	const int *late;
	int late_count;
};

static void swap(double *x, double *y)
{
	const double kept = *x;

	*x = *y;
	*y = kept;
}

/*
 * Zeroes the entries after the last column of a row that have not been written, when it grows to
 * `end`.
 */
static void widen(const struct rb_dense *d, int r, int end)
{
	for (int c = d->last[r] + 1; d->first && c <= end; c++)
		d->matrix[r * d->n + c] = 0;
}

/*
 * Swaps rows p and q in the remaining columns. Used columns hold multipliers, which stay in place:
 * rb_dense_again applies the swaps in the same order.
 */
static void swap_rows(struct rb_dense *d, int p, int q, const struct remaining *remaining)
{
	double *const x = d->matrix + p * d->n, *const y = d->matrix + q * d->n;
	const int last = d->last[p], end = last > d->last[q] ? last : d->last[q];

	widen(d, p, end);
	widen(d, q, end);
	for (int c = remaining->from; c <= end; c++)
		swap(&x[c], &y[c]);
	for (int i = 0; i < remaining->late_count; i++)
		swap(&x[remaining->late[i]], &y[remaining->late[i]]);
	swap(&d->right[p], &d->right[q]);
	d->last[p] = d->last[q];
	d->last[q] = last;
}

/* Columns of a row that may not be zero. */
static void ends_of(const struct rb_dense *d, int r, int *first, int *last)
{
	const double *const row = d->matrix + r * d->n;

	*first = 0;
	*last = d->n - 1;
	if (d->first) {
		*first = d->first[r];
		*last = d->last[r];
		return;
	}
	while (*first < d->n - 1 && row[*first] == 0)
		++*first;
	while (*last > *first && row[*last] == 0)
		--*last;
}

/*
 * Fills last (end of each row), size (largest entry of each column) and down (last row with an
 * entry in this column or one before it): elimination and row swaps leave zeros below.
 */
static void survey(struct rb_dense *d)
{
	const int n = d->n;

	for (int c = 0; c < n; c++) {
		d->size[c] = 0;
		d->down[c] = -1;
	}
	for (int r = 0; r < n; r++) {
		const double *const row = d->matrix + r * n;
		int first, last;

		ends_of(d, r, &first, &last);
		RB_ASSERT_COSTLY(first >= 0 && last < n);
		RB_ASSERT_COSTLY(!d->first || r == 0 || d->first[r - 1] <= first);
		d->down[first] = r;
		d->last[r] = last;
		d->products += d->first ? last + 1 - first : n;
		for (int c = first; c <= last; c++)
			if (fabs(row[c]) > d->size[c])
				d->size[c] = fabs(row[c]);
	}
	for (int c = 1; c < n; c++)
		if (d->down[c] < d->down[c - 1])
			d->down[c] = d->down[c - 1];
}

/* A postponed column is read in all rows, also those that do not reach it. */
static void postpone(struct rb_dense *d, int k)
{
	for (int r = 0; d->first && r < d->n; r++)
		if (k < d->first[r] || k > d->last[r])
			d->matrix[r * d->n + k] = 0;
}

/* at -= share * top, four numbers at a time, with the same bits. */
static void subtract(double *restrict at, const double *restrict top, double share, int count)
{
	int c = 0;

	for (; c + RB_LANES <= count; c += RB_LANES) {
		rb_lanes x, y;

		memcpy(&x, at + c, sizeof x);
		memcpy(&y, top + c, sizeof y);
		x -= share * y;
		memcpy(at + c, &x, sizeof x);
	}
	for (; c < count; c++)
		at[c] -= share * top[c];
}

/* Subtracts multiples of the pivot row from the rows below, as far down as column k reaches. */
static void eliminate(struct rb_dense *d, int row, int k, const struct remaining *remaining)
{
	RB_ASSERT_COSTLY(d->matrix[row * d->n + k] != 0);

	const int n = d->n;
	const double *const top = d->matrix + row * n;

	for (int r = row + 1; r <= d->down[k]; r++) {
		double *const at = d->matrix + r * n;

		if (at[k] == 0)
			continue;
		const double share = at[k] / top[k];
		at[k] = share; /* for rb_dense_again */
		widen(d, r, d->last[row]);
		if (remaining->from <= d->last[row])
			subtract(at + remaining->from, top + remaining->from, share,
			         d->last[row] + 1 - remaining->from);
		for (int i = 0; i < remaining->late_count; i++)
			at[remaining->late[i]] -= share * top[remaining->late[i]];
		d->products += d->last[row] + 1 - remaining->from + remaining->late_count;
		d->right[r] -= share * d->right[row];
		d->last[r] = d->last[r] > d->last[row] ? d->last[r] : d->last[row];
	}
}

/* Solves the upper triangle into `right`; open unknowns keep their values of `found`. */
static void substitute_back(struct rb_dense *d)
{
	const int n = d->n, ordered = n - d->late;

	for (int j = n - 1; j >= 0; j--) {
		const int k = d->order[j], p = d->pivot[k];

		if (p < 0)
			continue;
		const double *const row = d->matrix + p * n;
		double sum = d->right[p];
		for (int c = k + 1; j < ordered && c <= d->last[p]; c++)
			sum -= row[c] * d->found[c];
		/* postponed columns that precede column k, or come after it in the order */
		for (int i = j < ordered ? ordered : j + 1; i < n; i++)
			if (j >= ordered || d->order[i] < k)
				sum -= row[d->order[i]] * d->found[d->order[i]];
		d->found[k] = sum / row[k];
	}
	for (int k = 0; k < n; k++)
		d->right[k] = d->found[k];
}

/* Sets all unknowns to zero, and thus the open ones of the solution. */
static void close_all(struct rb_dense *d)
{
	for (int k = 0; k < d->n; k++)
		d->found[k] = 0;
}

/*
 * Bound of the rounding of a column: that of n eliminations of entries of its size, or that of one
 * with a small pivot. n of the latter would be too much: links with 1e-12 of the mass of others,
 * whose motion is determined only by such pivots, would be open.
 */
static double rounding_of(const struct rb_dense *d, int k)
{
	return margin * DBL_EPSILON * fmax(d->n * d->size[k], d->noise[k]);
}

/*
 * The row from `row` on with the largest entry of column k; -1 if none exceeds `least` of the
 * column's first size, or its rounding. A column of NaN has no pivot either and becomes open.
 */
static int best_row(const struct rb_dense *d, int row, int k)
{
	int best = row;

	for (int r = row + 1; r <= d->down[k]; r++)
		if (fabs(d->matrix[r * d->n + k]) > fabs(d->matrix[best * d->n + k]))
			best = r;
	return row < d->n && fabs(d->matrix[best * d->n + k]) >
	                               fmax(d->least * d->size[k], rounding_of(d, k))
	               ? best
	               : -1;
}

/*
 * A small pivot that is mostly rounding has a large relative error, and so has everything that is
 * subtracted with it.
 */
static void spread_noise(struct rb_dense *d, int row, int k, const struct remaining *remaining)
{
	const double *const top = d->matrix + row * d->n;
	const double share = d->noise[k] / fabs(top[k]);

	if (!(share > 1 / small_pivot))
		return;
	for (int c = remaining->from; c <= d->last[row]; c++)
		d->noise[c] = fmax(d->noise[c], share * fabs(top[c]));
	for (int i = 0; i < remaining->late_count; i++)
		d->noise[remaining->late[i]] = fmax(d->noise[remaining->late[i]],
		                                    share * fabs(top[remaining->late[i]]));
}

/* Extends rows that may hold the pivot of column k up to it: redundant ones end before. */
static void reach(struct rb_dense *d, int row, int k)
{
	for (int r = row; d->first && r <= d->down[k]; r++) {
		widen(d, r, k);
		d->last[r] = d->last[r] > k ? d->last[r] : k;
	}
}

/* Makes row `best` the pivot row of column k at position `row` and eliminates below it. */
static void use(struct rb_dense *d, int row, int best, int k, const struct remaining *remaining)
{
	RB_ASSERT(best >= row && best < d->n);

	if (best != row) {
		swap(&d->matrix[row * d->n + k], &d->matrix[best * d->n + k]);
		swap_rows(d, row, best, remaining);
	}
	d->from[k] = best;
	spread_noise(d, row, k, remaining);
	eliminate(d, row, k, remaining);
	d->pivot[k] = row;
}

void rb_dense_solve(struct rb_dense *d)
{
	RB_ASSERT(d->n >= 0 && d->matrix && d->right);

	const int n = d->n;
	int row = 0, count = 0;

	d->open = false;
	d->late = 0;
	d->products = 0;
	survey(d);
	memcpy(d->noise, d->size, (size_t)n * sizeof *d->noise);
	for (int k = 0; k < n; k++) {
		const struct remaining remaining = {k + 1, d->order + n - d->late, d->late};

		reach(d, row, k);
		const int best = best_row(d, row, k);

		d->pivot[k] = -1;
		if (best >= 0 && !(fabs(d->matrix[best * n + k]) > early * d->size[k])) {
			d->order[n - ++d->late] = k;
			postpone(d, k);
			continue;
		}
		d->order[count++] = k;
		d->open = d->open || best < 0;
		if (best >= 0)
			use(d, row++, best, k, &remaining);
	}
	for (int j = count; j < n; j++) {
		const int k = d->order[j];
		const struct remaining remaining = {n, d->order + j + 1, n - j - 1};

		d->down[k] = n - 1;
		const int best = best_row(d, row, k);
		d->open = d->open || best < 0;
		if (best >= 0)
			use(d, row++, best, k, &remaining);
	}
	RB_ASSERT(count + d->late == n && row <= n);
	RB_ASSERT(d->open == (row < n));
	close_all(d);
	substitute_back(d);
}

void rb_dense_again(struct rb_dense *d)
{
	for (int j = 0; j < d->n; j++) {
		const int k = d->order[j], p = d->pivot[k];

		if (p < 0)
			continue;
		swap(&d->right[d->from[k]], &d->right[p]);
		for (int r = p + 1; r <= d->down[k]; r++)
			d->right[r] -= d->matrix[r * d->n + k] * d->right[p];
	}
	close_all(d);
	substitute_back(d);
}

void rb_dense_shares(const struct rb_dense *d, double *share)
{
	for (int k = 0; k < d->n; k++)
		share[k] = d->pivot[k] < 0 ? 0
		                           : fabs(d->matrix[d->pivot[k] * d->n + k]) / d->size[k];
}

bool rb_dense_is_open(const struct rb_dense *d, int k)
{
	RB_ASSERT(k >= 0 && k < d->n);

	return d->pivot[k] < 0;
}

void rb_dense_opened(struct rb_dense *d, int k)
{
	RB_ASSERT(rb_dense_is_open(d, k));

	for (int i = 0; i < d->n; i++)
		d->right[i] = 0;
	close_all(d);
	d->found[k] = 1;
	substitute_back(d);
}
