/* SPDX-License-Identifier: MIT */
#include "math/dense.h"

#include <float.h>
#include <math.h>

/* What stands before column `from` are shares, which stay where they are. */
static void swap_rows(struct rb_dense *d, int p, int q, int from)
{
	double *const x = d->matrix + p * d->n, *const y = d->matrix + q * d->n;
	const double right = d->right[p];
	const int last = d->last[p], end = last > d->last[q] ? last : d->last[q];

	for (int c = from; c <= end; c++) {
		const double kept = x[c];

		x[c] = y[c];
		y[c] = kept;
	}
	d->right[p] = d->right[q];
	d->right[q] = right;
	d->last[p] = d->last[q];
	d->last[q] = last;
}

/*
 * Where rows end, how large columns are, and down to which row there is anything in a column or one before it: below, the
 * elimination leaves zeros, also where rows are swapped.
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

static void eliminate(struct rb_dense *d, int row, int k)
{
	const int n = d->n;
	const double *const top = d->matrix + row * n;

	for (int r = row + 1; r <= d->down[k]; r++) {
		double *const at = d->matrix + r * n;

		if (at[k] == 0)
			continue;
		const double share = at[k] / top[k];
		at[k] = share; /* for rb_dense_again */
		for (int c = k + 1; c <= d->last[row]; c++)
			at[c] -= share * top[c];
		d->right[r] -= share * d->right[row];
		d->last[r] = d->last[r] > d->last[row] ? d->last[r] : d->last[row];
	}
}

static void substitute_back(struct rb_dense *d)
{
	const int n = d->n;

	for (int k = n - 1; k >= 0; k--) {
		const int p = d->pivot[k];

		d->found[k] = p < 0 ? 0 : d->right[p];
		for (int c = k + 1; p >= 0 && c <= d->last[p]; c++)
			d->found[k] -= d->matrix[p * n + c] * d->found[c];
		if (p >= 0)
			d->found[k] /= d->matrix[p * n + k];
	}
	for (int k = 0; k < n; k++)
		d->right[k] = d->found[k];
}

void rb_dense_solve(struct rb_dense *d)
{
	const int n = d->n;
	double *const matrix = d->matrix;
	int row = 0;

	d->open = false;
	survey(d);
	for (int k = 0; k < n; k++) {
		int best = row;

		for (int r = row + 1; r <= d->down[k]; r++)
			if (fabs(matrix[r * n + k]) > fabs(matrix[best * n + k]))
				best = r;
		d->pivot[k] = -1;
		if (row == n || fabs(matrix[best * n + k]) <= 16 * n * DBL_EPSILON * d->size[k]) {
			d->open = true;
			continue;
		}
		if (best != row)
			swap_rows(d, row, best, k);
		d->from[k] = best;
		eliminate(d, row, k);
		d->pivot[k] = row++;
	}
	substitute_back(d);
}

void rb_dense_again(struct rb_dense *d)
{
	for (int k = 0; k < d->n; k++) {
		const int p = d->pivot[k];

		if (p < 0)
			continue;
		const double right = d->right[d->from[k]];
		d->right[d->from[k]] = d->right[p];
		d->right[p] = right;
		for (int r = p + 1; r <= d->down[k]; r++)
			d->right[r] -= d->matrix[r * d->n + k] * right;
	}
	substitute_back(d);
}
