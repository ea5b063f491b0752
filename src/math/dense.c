/* SPDX-License-Identifier: MIT */
#include "math/dense.h"

#include <float.h>
#include <math.h>

/*
 * Share of a column that has to be left for a pivot while other columns are still to come. What is
 * left by little of a column is what others do nearly as well: as the first of them its unknown
 * would take up what the open ones leave, many times over (four corners that slide and turn on what
 * sticks: 1e6 times).
 */
static const double early = 0x1p-5;

/*
 * Columns that are not yet used: those in order from k on, and the late ones, which the end of
 * `order` lists.
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

/* What stands in columns that are used are shares, which stay where they are. */
static void swap_rows(struct rb_dense *d, int p, int q, const struct left *left)
{
	double *const x = d->matrix + p * d->n, *const y = d->matrix + q * d->n;
	const int last = d->last[p], end = last > d->last[q] ? last : d->last[q];

	for (int c = left->from; c <= end; c++)
		swap(&x[c], &y[c]);
	for (int i = 0; i < left->late_count; i++)
		swap(&x[left->late[i]], &y[left->late[i]]);
	swap(&d->right[p], &d->right[q]);
	d->last[p] = d->last[q];
	d->last[q] = last;
}

/*
 * Where rows end, how large columns are, and down to which row there is anything in a column or one
 * before it: below, the elimination leaves zeros, also where rows are swapped.
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
		int first = 0, last = n - 1;

		while (first < n - 1 && row[first] == 0)
			first++;
		while (last > first && row[last] == 0)
			last--;
		d->down[first] = r;
		d->last[r] = last;
		for (int c = first; c <= last; c++)
			if (fabs(row[c]) > d->size[c])
				d->size[c] = fabs(row[c]);
	}
	for (int c = 1; c < n; c++)
		if (d->down[c] < d->down[c - 1])
			d->down[c] = d->down[c - 1];
}

static void eliminate(struct rb_dense *d, int row, int k, const struct left *left)
{
	const int n = d->n;
	const double *const top = d->matrix + row * n;

	for (int r = row + 1; r <= d->down[k]; r++) {
		double *const at = d->matrix + r * n;

		if (at[k] == 0)
			continue;
		const double share = at[k] / top[k];
		at[k] = share; /* for rb_dense_again */
		for (int c = left->from; c <= d->last[row]; c++)
			at[c] -= share * top[c];
		for (int i = 0; i < left->late_count; i++)
			at[left->late[i]] -= share * top[left->late[i]];
		d->products += d->last[row] + 1 - left->from + left->late_count;
		d->right[r] -= share * d->right[row];
		d->last[r] = d->last[r] > d->last[row] ? d->last[r] : d->last[row];
	}
}

/* What is open is as `found` has it. */
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

static void close_all(struct rb_dense *d)
{
	for (int k = 0; k < d->n; k++)
		d->found[k] = 0;
}

/*
 * Of the rows that are not used yet, from `row` on, the one with most of column k; -1: none has
 * more than `least` of it.
 */
static int best_row(const struct rb_dense *d, int row, int k, double least)
{
	int best = row;

	for (int r = row + 1; r <= d->down[k]; r++)
		if (fabs(d->matrix[r * d->n + k]) > fabs(d->matrix[best * d->n + k]))
			best = r;
	return row < d->n && fabs(d->matrix[best * d->n + k]) > least * d->size[k] ? best : -1;
}

static void use(struct rb_dense *d, int row, int best, int k, const struct left *left)
{
	if (best != row) {
		swap(&d->matrix[row * d->n + k], &d->matrix[best * d->n + k]);
		swap_rows(d, row, best, left);
	}
	d->from[k] = best;
	eliminate(d, row, k, left);
	d->pivot[k] = row;
}

void rb_dense_solve(struct rb_dense *d)
{
	const int n = d->n;
	const double least = fmax(d->least, 16 * n * DBL_EPSILON);
	int row = 0, count = 0;

	d->open = false;
	d->late = 0;
	d->products = (long)n * n;
	survey(d);
	for (int k = 0; k < n; k++) {
		const struct left left = {k + 1, d->order + n - d->late, d->late};
		const int best = best_row(d, row, k, least);

		d->pivot[k] = -1;
		if (best >= 0 && !(fabs(d->matrix[best * n + k]) > early * d->size[k])) {
			d->order[n - ++d->late] = k;
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
		const int best = best_row(d, row, k, least);
		d->open = d->open || best < 0;
		if (best >= 0)
			use(d, row++, best, k, &left);
	}
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

bool rb_dense_is_open(const struct rb_dense *d, int k)
{
	return d->pivot[k] < 0;
}

void rb_dense_opened(struct rb_dense *d, int k)
{
	for (int i = 0; i < d->n; i++)
		d->right[i] = 0;
	close_all(d);
	d->found[k] = 1;
	substitute_back(d);
}
