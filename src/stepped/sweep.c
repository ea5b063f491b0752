/* SPDX-License-Identifier: MIT */
#include "stepped/sweep.h"

/* What a block of rows has come to. */
struct share {
	double change; /* m/s: the largest of a row's velocity */
	double size;   /* J: of all changes of impulses */
};

/* One row on its own. Normal first, then friction within the cone that the new normal impulse allows. */
static inline double solve_row(const struct rb_dense *dense, struct rb_dense_row *row)
{
	const rb_vec3 n = row->normal;
	const rb_vec3 u = rb_dense_velocity(dense, row);
	const double u_n = rb_vec3_dot(u, n);
	/* the sum is clamped, not the change: a later sweep may take back what this one gives too much */
	const double push = fmax(0, row->push + (row->leave - u_n) / row->yield_n);

	if (push == 0 && row->push == 0) {
		row->step = (rb_vec3){0, 0, 0};
		return 0;
	}
	const double more = push - row->push;
	rb_vec3 change = rb_vec3_scale(more, n);
	double moved = fabs(more) * row->yield_n;

	row->push = push;
	if (row->friction > 0) {
		const rb_vec3 slip = rb_vec3_add_scaled(u, -u_n, n);
		rb_vec3 rub = rb_vec3_add_scaled(row->rub, -1 / row->yield_t, slip);
		const double square = rb_vec3_dot(rub, rub), most = row->friction * push;

		if (square > most * most)
			rub = rb_vec3_scale(most / sqrt(square), rub);
		const rb_vec3 d = rb_vec3_sub(rub, row->rub);
		row->rub = rub;
		change = rb_vec3_add(change, d);
		moved = fmax(moved, row->yield_t * sqrt(rb_vec3_dot(d, d)));
	}
	row->step = change;
	rb_dense_push(dense, row, change);
	return moved;
}

static struct share solve_rows(const struct rb_dense *dense, int first, int end)
{
	struct share share = {0, 0};

	for (int k = first; k < end; k++) {
		struct rb_dense_row *row = &dense->row[k];

		share.change = fmax(share.change, solve_row(dense, row));
		share.size += row->yield_n * rb_vec3_dot(row->step, row->step);
	}
	return share;
}

/* Goes on along the direction of each row; the sweep that comes next projects back onto the cone. */
static void follow_rows(const struct rb_dense *dense, int first, int end, double share)
{
	for (int k = first; k < end; k++) {
		struct rb_dense_row *row = &dense->row[k];
		const rb_vec3 extra = rb_vec3_scale(share, row->turn);
		const double normal = rb_vec3_dot(extra, row->normal);

		row->turn = rb_vec3_add(row->step, extra);
		if (extra.x == 0 && extra.y == 0 && extra.z == 0)
			continue;
		row->push += normal;
		row->rub = rb_vec3_add(row->rub, rb_vec3_add_scaled(extra, -normal, row->normal));
		rb_dense_push(dense, row, extra);
	}
}

/* What the workers of one colour share: read only but for each block's own partial sums. */
struct work {
	const struct rb_sweep *sweep;
	int first, end;  /* rows of the colour */
	int first_block; /* its first block among those of all colours */
	bool follows;
	double share;
};

static void run_block(void *user, int block, int worker)
{
	const struct work *work = user;
	const struct rb_dense *dense = work->sweep->dense;
	const int first = work->first + block * RB_SWEEP_BLOCK;
	const int end = first + RB_SWEEP_BLOCK < work->end ? first + RB_SWEEP_BLOCK : work->end;

	(void)worker;
	if (work->follows) {
		follow_rows(dense, first, end, work->share);
		return;
	}
	const struct share share = solve_rows(dense, first, end);
	work->sweep->partial[2 * (work->first_block + block)] = share.change;
	work->sweep->partial[2 * (work->first_block + block) + 1] = share.size;
}

int rb_sweep_blocks(const int *colour, int colour_count)
{
	int blocks = 0;

	for (int c = 0; c < colour_count; c++)
		blocks += (colour[c + 1] - colour[c] + RB_SWEEP_BLOCK - 1) / RB_SWEEP_BLOCK;
	return blocks;
}

static struct share run_colours(const struct rb_sweep *sweep, bool follows, double share)
{
	struct work work = {.sweep = sweep, .follows = follows, .share = share};
	struct share sum = {0, 0};

	for (int c = 0; c < sweep->colour_count; c++) {
		work.first = sweep->colour[c];
		work.end = sweep->colour[c + 1];
		const int blocks = (work.end - work.first + RB_SWEEP_BLOCK - 1) / RB_SWEEP_BLOCK;

		if (blocks > 1 && !(sweep->tail && c == sweep->colour_count - 1))
			rb_team_run(sweep->team, blocks, run_block, &work);
		else
			for (int b = 0; b < blocks; b++)
				run_block(&work, b, 0);
		work.first_block += blocks;
	}
	for (int b = 0; b < work.first_block && !follows; b++) {
		sum.change = fmax(sum.change, sweep->partial[2 * b]);
		sum.size += sweep->partial[2 * b + 1];
	}
	return sum;
}

static struct share sweep_once(const struct rb_sweep *sweep)
{
	return sweep->team ? run_colours(sweep, false, 0)
	                   : solve_rows(sweep->dense, 0, sweep->dense->row_count);
}

static void follow(const struct rb_sweep *sweep, double share)
{
	if (sweep->team)
		(void)run_colours(sweep, true, share);
	else
		follow_rows(sweep->dense, 0, sweep->dense->row_count, share);
}

void rb_sweep_warm(const struct rb_dense *dense)
{
	for (int k = 0; k < dense->row_count; k++)
		if (dense->row[k].push > 0)
			rb_dense_push(dense, &dense->row[k], rb_dense_impulse(&dense->row[k]));
}

struct rb_sweep_result rb_sweep_solve(const struct rb_sweep *sweep)
{
	struct rb_sweep_result result = {0, 0};
	double before = 0;

	for (int k = 0; k < sweep->dense->row_count; k++)
		sweep->dense->row[k].turn = (rb_vec3){0, 0, 0};
	while (result.sweeps < sweep->most) {
		const struct share now = sweep_once(sweep);

		result.sweeps++;
		result.residual = now.change;
		if (now.change <= sweep->enough || result.sweeps == sweep->most)
			break;
		/* where it got worse, begin anew */
		follow(sweep, before > 0 && now.size <= before ? now.size / before : 0);
		before = now.size;
	}
	return result;
}
