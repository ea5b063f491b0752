/* SPDX-License-Identifier: MIT */
/*
 * Compressed rows. Counts are stored two places on, so that filling moves each start to its place.
 */
#include "stepped/points_of.h"

#include <string.h>

void rb_points_of_bodies(const struct rb_world *world, const struct rb_step_points *points,
                         size_t *first, size_t *of, unsigned char *held)
{
	const size_t n = (size_t)world->model->body_count;

	memset(first, 0, (n + 2) * sizeof *first);
	memset(held, 0, n + 1);
	for (size_t k = 0; k < points->count; k++) {
		const struct rb_step_point *p = &points->row[k];

		first[p->a + 2]++;
		if (rb_stepped_is_dynamic(world, p->b))
			first[p->b + 2]++;
		if (p->from == 0)
			continue;
		held[p->a] = 1;
		if (p->b < world->model->body_count)
			held[p->b] = 1;
	}
	for (size_t i = 2; i < n + 2; i++)
		first[i] += first[i - 1];
	for (size_t k = 0; k < points->count; k++) {
		const struct rb_step_point *p = &points->row[k];

		of[first[p->a + 1]++] = k;
		if (rb_stepped_is_dynamic(world, p->b))
			of[first[p->b + 1]++] = k;
	}
}
