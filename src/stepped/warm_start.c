/* SPDX-License-Identifier: MIT */
/*
 * Warm start of the next step (stepped/contact_points): impulses of the step before, or forces
 * found by another method, matched by contact name.
 */
#include "stepped/contact_points.h"

#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"

/*
 * Marks bodies that have earlier contacts. Marks exist for all bodies of the model: those of other
 * bodies are unused, and harmless.
 */
static void mark_held(struct rb_step_points *points)
{
	for (size_t k = 0; k < points->last_count; k++) {
		points->held[points->last[k].a] = 1;
		if (points->last[k].b < points->body_count)
			points->held[points->last[k].b] = 1;
	}
}

void rb_step_points_index(struct rb_step_points *points, const struct rb_model *model)
{
	int a = 0;

	memset(points->held, 0, (size_t)model->body_count);
	mark_held(points);
	for (size_t k = 0; k < points->last_count; k++)
		for (; a <= points->last[k].a; a++)
			points->first_last[a] = k;
	for (; a <= model->body_count; a++)
		points->first_last[a] = points->last_count;
}

static struct rb_contact_name name_of(const struct rb_named_impulse *impulse)
{
	return (struct rb_contact_name){
		.a = impulse->a, .b = impulse->b, .parts = impulse->parts, .key = impulse->key};
}

static int by_name(const void *left, const void *right)
{
	const struct rb_named_impulse *x = left, *y = right;

	const struct rb_contact_name of_x = name_of(x), of_y = name_of(y);

	return rb_contact_name_compare(&of_x, &of_y);
}

static struct rb_named_impulse convert_contact(const struct rb_world *world,
                                               const struct rb_contact *contact)
{
	const bool swapped = world->model->inverse_mass[contact->a] == 0; /* driven */

	return (struct rb_named_impulse){
		.a = swapped ? contact->b : contact->a,
		.b = swapped ? contact->a : contact->b,
		.parts = contact->parts,
		.key = contact->key,
		.force = contact->normal_force,
		.friction_impulse = swapped ? rb_vec3_neg(contact->tangent_force)
	                                    : contact->tangent_force,
	};
}

/* Mean of the points of one rim, among those of a pair. */
static struct rb_named_impulse mean_of_rim(const struct rb_named_impulse *pair, size_t length,
                                           uint32_t parts, uint64_t rim)
{
	struct rb_named_impulse mean = {.a = pair->a, .b = pair->b, .parts = parts, .key = rim};
	double count = 0;

	for (size_t k = 0; k < length; k++) {
		if (pair[k].parts != parts || rb_contact_key_all_round(pair[k].key) != rim)
			continue;
		count++;
		mean.force += pair[k].force;
		mean.friction_impulse = rb_vec3_add(mean.friction_impulse,
		                                    pair[k].friction_impulse);
	}
	RB_ASSERT_COSTLY(count > 0);
	mean.force /= count;
	mean.friction_impulse = rb_vec3_scale(1 / count, mean.friction_impulse);
	return mean;
}

/*
 * Copies the impulses of a pair, then adds each rim's mean for points whose name is not among them.
 */
static size_t take_pair(const struct rb_named_impulse *pair, size_t length,
                        struct rb_named_impulse *to)
{
	size_t count = 0;

	for (size_t k = 0; k < length; k++)
		if (rb_contact_key_all_round(pair[k].key) != pair[k].key)
			to[count++] = pair[k];
	for (size_t k = 0; k < length; k++) {
		const uint64_t rim = rb_contact_key_all_round(pair[k].key);
		bool is_first = rim != 0;

		for (size_t i = 0; i < k && is_first; i++)
			is_first = pair[i].parts != pair[k].parts ||
			           rb_contact_key_all_round(pair[i].key) != rim;
		if (is_first)
			to[count++] = mean_of_rim(pair, length, pair[k].parts, rim);
	}
	return count;
}

enum rb_status rb_step_points_take_over(struct rb_step_points *points, struct rb_world *world,
                                        struct rb_error *err)
{
	const struct rb_contacts *contacts = &world->contacts;
	struct rb_named_impulse *impulse = rb_arena_take(&world->arena[0], contacts->count + 1,
	                                                 sizeof *impulse);
	size_t count = 0, length;

	points->last_count = 0;
	if (!impulse || !rb_step_points_reserve(points, 2 * contacts->count))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for %zu contacts", contacts->count);
	for (size_t k = 0; k < contacts->count; k++)
		if (contacts->row[k].normal_force > 0)
			impulse[count++] = convert_contact(world, &contacts->row[k]);
	if (count > 1)
		qsort(impulse, count, sizeof *impulse, by_name);
	for (size_t k = 0; k < count; k += length) {
		for (length = 1; k + length < count && impulse[k + length].a == impulse[k].a &&
		                 impulse[k + length].b == impulse[k].b;)
			length++;
		points->last_count += take_pair(impulse + k, length,
		                                points->last + points->last_count);
	}
	rb_step_points_index(points, world->model);
	return RB_OK;
}

void rb_step_points_take_last(struct rb_step_points *points, const struct rb_step_points *from,
                              const int *member, int count)
{
	points->last_count = 0;
	for (int k = 0; k < count; k++) {
		const int a = member[k];
		const size_t end = from->last_count > 0 ? from->first_last[a + 1] : 0;

		for (size_t at = from->last_count > 0 ? from->first_last[a] : 0; at < end; at++)
			points->last[points->last_count++] = from->last[at];
	}
	rb_step_points_index_members(points, member, count);
}

void rb_step_points_index_members(struct rb_step_points *points, const int *member, int count)
{
	size_t at = 0;

	for (int k = 0; k < count; k++)
		points->held[member[k]] = 0;
	mark_held(points);
	for (int k = 0; k < count; k++) {
		points->first_last[member[k]] = at;
		while (at < points->last_count && points->last[at].a == member[k])
			at++;
		points->first_last[member[k] + 1] = at;
	}
}

bool rb_step_points_reserve(struct rb_step_points *points, size_t count)
{
	return count < UINT32_MAX && /* indices are stored as uint32_t */
	       rb_memory_reserve(&points->last, &points->last_capacity, count + 1,
	                         sizeof *points->last);
}

static struct rb_named_impulse impulse_of(const struct rb_step_points *points,
                                          const struct rb_step_point *point, double h,
                                          const unsigned char *asleep)
{
	if (point->from > 0 && asleep[point->a]) {
		struct rb_named_impulse impulse = points->last[point->from - 1];

		impulse.key = point->key; /* the earlier one may be the mean of a rim */
		return impulse;
	}
	return (struct rb_named_impulse){
		.a = point->a,
		.b = point->b,
		.parts = point->parts,
		.key = point->key,
		.force = point->normal_impulse / h,
		.friction_impulse = rb_vec3_scale(1 / h, point->friction_impulse)};
}

struct store_pass {
	const struct rb_step_points *points;
	struct rb_named_impulse *to;
	const unsigned char *asleep;
	double h_s;
};

static void store_chosen(void *user, size_t first, size_t end)
{
	const struct store_pass *store_pass = user;
	const struct rb_step_points *points = store_pass->points;

	for (size_t c = first; c < end; c++)
		store_pass->to[c] = impulse_of(points, &points->row[points->chosen[c]],
		                               store_pass->h_s, store_pass->asleep);
}

/* Stores new impulses, merged with those of sleeping bodies; returns their number. */
static size_t store_with_sleepers(const struct store_pass *store_pass, const unsigned char *sleeps)
{
	const struct rb_step_points *points = store_pass->points;
	struct rb_named_impulse *const to = store_pass->to;
	size_t old = 0, count = 0;

	for (size_t c = 0; c <= points->chosen_count; c++) {
		const struct rb_step_point *point = c < points->chosen_count
		                                            ? &points->row[points->chosen[c]]
		                                            : NULL;

		for (; old < points->last_count && (!point || points->last[old].a < point->a);
		     old++)
			if (sleeps[points->last[old].a])
				to[count++] = points->last[old];
		if (point)
			to[count++] = impulse_of(points, point, store_pass->h_s,
			                         store_pass->asleep);
	}
	return count;
}

enum { IMPULSES_PER_BLOCK = 512 };

struct rb_named_impulse *rb_step_points_space(struct rb_step_points *points,
                                              const struct rb_world *world, bool sleeping)
{
	const size_t max = points->chosen_count + (sleeping ? points->last_count : 0);

	return rb_step_points_reserve(points, max)
	               ? rb_arena_take(&world->arena[0], max, sizeof *points->last)
	               : NULL;
}

void rb_step_points_keep_in(struct rb_step_points *points, const struct rb_world *world, double h,
                            const unsigned char *asleep, const unsigned char *sleeps,
                            struct rb_named_impulse *space)
{
	struct store_pass store_pass = {points, space, asleep, h};
	size_t count = points->chosen_count;

	RB_ASSERT(space && h > 0);
	if (sleeps)
		count = store_with_sleepers(&store_pass, sleeps);
	else
		rb_team_share(world->team, count, IMPULSES_PER_BLOCK, store_chosen, &store_pass);
	if (count > 0)
		memcpy(points->last, space, count * sizeof *space);
	points->last_count = count;
}

enum rb_status rb_step_points_keep(struct rb_step_points *points, const struct rb_world *world,
                                   double h, const unsigned char *asleep,
                                   const unsigned char *sleeps, struct rb_error *err)
{
	struct rb_arena *const arena = &world->arena[0];
	const rb_arena_mark here = rb_arena_here(arena);
	struct rb_named_impulse *const space = rb_step_points_space(points, world, sleeps != NULL);

	if (!space)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for %zu contacts",
		               points->chosen_count);
	rb_step_points_keep_in(points, world, h, asleep, sleeps, space);
	rb_arena_back(arena, here);
	return RB_OK;
}
