/* SPDX-License-Identifier: MIT */
/*
 * LU decomposition with row pivots in place, whose columns are taken in order of index except for
 * those of which little is left (below the share `early` of their first size): these wait for the
 * end. Full pivoting would find the rank as well, but it destroys the band that chains of contacts
 * have and depends on the order of unknowns only by ties. A singular value decomposition was
 * rejected for its cost: the rank is needed only where the system is redundant (a table on four
 * legs), and there the kernel comes from one back substitution for each open column
 * (rb_dense_opened).
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
 * Share of a column that must be left for it to be used as a pivot while others remain. A column of
 * which less is left is nearly a combination of those before it; used first, its unknown would take
 * the components of the open ones many times over (1e6 times for four corners that slide and turn
 * on sticking contacts).
 */
static const double early = 0x1p-5;
/* A pivot of less of its column makes the rounding of what follows more than the margin is for. */
static const double small = 0.25;
/* So many times what entries round to may be left of nothing. */
static const double margin = 16;

/*
 * Columns not used yet: those of index from `from` on, n for none, and the late ones at the end of
 * `order`.
 */
struct left {
	int from; /* n: of those in order none are left */
	const int *late;
	int late_count;
};

static void swap(double *x, double *y)
{
	const double kept = *x;

	*x = *y;
	*y = kept;
}

/* Zeros behind the last column of a row that nothing has written, where it grows to `end`. */
static void widen(const struct rb_dense *d, int r, int end)
{
	for (int c = d->last[r] + 1; d->first && c <= end; c++)
		d->matrix[r * d->n + c] = 0;
}

/*
 * Swaps rows p and q in the columns left. Used columns hold multipliers, which stay where they are:
 * rb_dense_again applies the swaps in the same order.
 */
static void swap_rows(struct rb_dense *d, int p, int q, const struct left *left)
{
	double *const x = d->matrix + p * d->n, *const y = d->matrix + q * d->n;
	const int last = d->last[p], end = last > d->last[q] ? last : d->last[q];

	widen(d, p, end);
	widen(d, q, end);
	for (int c = left->from; c <= end; c++)
		swap(&x[c], &y[c]);
	for (int i = 0; i < left->late_count; i++)
		swap(&x[left->late[i]], &y[left->late[i]]);
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

/* A column that waits for the end is asked for in all rows, also those that do not reach to it. */
static void put_off(struct rb_dense *d, int k)
{
	for (int r = 0; d->first && r < d->n; r++)
		if (k < d->first[r] || k > d->last[r])
			d->matrix[r * d->n + k] = 0;
}

/* at -= share * top, four numbers at a time: to the same bits. */
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

/* Subtracts multiples of the pivot row from the rows below, as far as column k reaches. */
static void eliminate(struct rb_dense *d, int row, int k, const struct left *left)
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
		if (left->from <= d->last[row])
			subtract(at + left->from, top + left->from, share,
			         d->last[row] + 1 - left->from);
		for (int i = 0; i < left->late_count; i++)
			at[left->late[i]] -= share * top[left->late[i]];
		d->products += d->last[row] + 1 - left->from + left->late_count;
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
		/* of the late ones those that have been passed by then, or come after it */
		for (int i = j < ordered ? ordered : j + 1; i < n; i++)
			if (j >= ordered || d->order[i] < k)
				sum -= row[d->order[i]] * d->found[d->order[i]];
		d->found[k] = sum / row[k];
	}
	for (int k = 0; k < n; k++)
		d->right[k] = d->found[k];
}

/* Sets every unknown to zero, hence the open ones of the solution. */
static void close_all(struct rb_dense *d)
{
	for (int k = 0; k < d->n; k++)
		d->found[k] = 0;
}

/*
 * What may be rounding of a column: that of n eliminations of entries of its size, or that of one
 * with a small pivot. n of those were too much: links of 1e-12 of the mass of others, of which such
 * pivots are all that the motion of these is known by, were open.
 */
static double rounding_of(const struct rb_dense *d, int k)
{
	return margin * DBL_EPSILON * fmax(d->n * d->size[k], d->noise[k]);
}

/*
 * The row from `row` on with the largest entry of column k; -1 if none exceeds `least` of the
 * column's first size, or what rounding has left there. A column of NaN has no pivot either and
 * becomes open.
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
 * A pivot of which little is left, and of that much is rounding, is as wrong as a share; so is what
 * is subtracted with it.
 */
static void spread_noise(struct rb_dense *d, int row, int k, const struct left *left)
{
	const double *const top = d->matrix + row * d->n;
	const double share = d->noise[k] / fabs(top[k]);

	if (!(share > 1 / small))
		return;
	for (int c = left->from; c <= d->last[row]; c++)
		d->noise[c] = fmax(d->noise[c], share * fabs(top[c]));
	for (int i = 0; i < left->late_count; i++)
		d->noise[left->late[i]] = fmax(d->noise[left->late[i]],
		                               share * fabs(top[left->late[i]]));
}

/* Rows that may hold the pivot of column k reach to it: redundant ones end before. */
static void reach(struct rb_dense *d, int row, int k)
{
	for (int r = row; d->first && r <= d->down[k]; r++) {
		widen(d, r, k);
		d->last[r] = d->last[r] > k ? d->last[r] : k;
	}
}

/* Makes row `best` the pivot row of column k at position `row` and eliminates below it. */
static void use(struct rb_dense *d, int row, int best, int k, const struct left *left)
{
	RB_ASSERT(best >= row && best < d->n);

	if (best != row) {
		swap(&d->matrix[row * d->n + k], &d->matrix[best * d->n + k]);
		swap_rows(d, row, best, left);
	}
	d->from[k] = best;
	spread_noise(d, row, k, left);
	eliminate(d, row, k, left);
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
		const struct left left = {k + 1, d->order + n - d->late, d->late};

		reach(d, row, k);
		const int best = best_row(d, row, k);

		d->pivot[k] = -1;
		if (best >= 0 && !(fabs(d->matrix[best * n + k]) > early * d->size[k])) {
			d->order[n - ++d->late] = k;
			put_off(d, k);
			continue;
		}
		d->order[count++] = k;
		d->open = d->open || best < 0;
		if (best >= 0)
			use(d, row++, best, k, &left);
	}
	for (int j = count; j < n; j++) {
		const int k = d->order[j];
		const struct left left = {n, d->order + j + 1, n - j - 1};

		d->down[k] = n - 1;
		const int best = best_row(d, row, k);
		d->open = d->open || best < 0;
		if (best >= 0)
			use(d, row++, best, k, &left);
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
