/* SPDX-License-Identifier: MIT */
/*
 * Lists of elements in compressed form: `of[first[i] .. first[i + 1])` are the elements at body i,
 * in the order of the table, built by a counting sort. Sums of forces then run over a body's
 * elements in one order, whatever the number of threads. A kind that acts on every free body has no
 * lists.
 */
#include "model/element.h"

#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "math/quat.h"

int rb_element_place(const struct rb_element_kind *kind)
{
	int place = 0;

	while (rb_element_kinds[place] != kind) {
		place++;
		RB_ASSERT(place < rb_element_kind_count);
	}
	return place;
}

/* ---- of a scene ---- */

enum rb_status rb_scene_add_element(struct rb_scene *scene, const struct rb_element_kind *kind,
                                    const void *row, struct rb_error *err)
{
	struct rb_element_list *const list = &scene->elements[rb_element_place(kind)];

	RB_ASSERT(list->count >= 0 && kind->row_size <= RB_ELEMENT_ROW_MAX);
	if (!rb_memory_reserve(&list->rows, &list->capacity, (size_t)list->count + 1,
	                       kind->row_size))
		return RB_FAIL(err, RB_ERR_MEMORY, "out of memory for %s", kind->plural);
	list->count++;
	memcpy(rb_scene_element(scene, kind, list->count - 1), row, kind->row_size);
	return RB_OK;
}

void rb_scene_count_elements(const struct rb_scene *scene, int counts[RB_ELEMENT_KINDS_MAX])
{
	for (int place = 0; place < RB_ELEMENT_KINDS_MAX; place++)
		counts[place] = scene->elements[place].count;
}

const char *rb_element_ends_fault(const struct rb_scene *scene, const struct rb_element_kind *kind,
                                  const void *row)
{
	int id[2];

	if (!kind->ends)
		return NULL;
	kind->ends(row, id);
	RB_ASSERT(id[0] >= 0 && id[0] < scene->body_count);
	RB_ASSERT(id[1] >= 0 && id[1] < scene->body_count);
	if (id[0] == id[1])
		return "both ends are on the same body";
	if (!rb_body_is_free(&scene->bodies[id[0]]) && !rb_body_is_free(&scene->bodies[id[1]]))
		return "nothing can move either end: one must be on a body that is neither static "
		       "nor driven";
	return NULL;
}

/* ---- of a model ---- */

const struct rb_elements *rb_model_elements(const struct rb_model *model,
                                            const struct rb_element_kind *kind)
{
	for (int k = 0; k < model->element_list_count; k++)
		if (model->elements[k].kind == kind)
			return &model->elements[k];
	return NULL;
}

int rb_elements_between(const struct rb_model *model)
{
	int count = 0;

	for (int k = 0; k < model->element_list_count; k++)
		count += model->elements[k].end ? model->elements[k].count : 0;
	return count;
}

/* Which elements are at a body: places are counted, summed up and filled, by number. */
/*
 * Fills end, first, of by a counting sort over body indices; false when memory is out. `next[i]`
 * runs from the start of body i's list to its end, which is why first is one element longer.
 */
static bool list_ends(const struct rb_model *model, struct rb_elements *elements)
{
	const size_t count = (size_t)elements->count;
	const size_t bodies = (size_t)(model->body_count + model->static_count);

	elements->end = rb_memory_take(count, sizeof *elements->end);
	elements->first = rb_memory_take(bodies + 2, sizeof *elements->first);
	elements->of = rb_memory_take(2 * count, sizeof *elements->of);
	if (!elements->end || !elements->first || !elements->of)
		return false;
	int *const next = elements->first + 1; /* ends up one place behind */
	for (int k = 0; k < elements->count; k++) {
		int id[2];

		elements->kind->ends(rb_elements_row(elements, k), id);
		for (int e = 0; e < 2; e++) {
			elements->end[k][e] = model->index_of[id[e]];
			RB_ASSERT(elements->end[k][e] >= 0 && (size_t)elements->end[k][e] < bodies);
			next[elements->end[k][e] + 1]++;
		}
	}
	for (size_t i = 0; i < bodies; i++)
		next[i + 1] += next[i];
	for (int k = 0; k < elements->count; k++)
		for (int e = 0; e < 2; e++)
			elements->of[next[elements->end[k][e]]++] = k;
	RB_ASSERT(elements->first[0] == 0 && (size_t)elements->first[bodies] == 2 * count);
	return true;
}

/* Copies and seals the scene's rows of one kind; false when memory is out. */
static bool copy_rows(const struct rb_model *model, struct rb_elements *elements)
{
	const struct rb_element_kind *kind = elements->kind;
	const size_t size = kind->row_size;

	elements->rows = rb_memory_take((size_t)elements->count, size);
	if (!elements->rows)
		return false;
	memcpy(elements->rows, rb_scene_element(model->scene, kind, 0),
	       (size_t)elements->count * size);
	for (int k = 0; k < elements->count && kind->seal; k++)
		kind->seal(model->scene, (char *)elements->rows + (size_t)k * size);
	return !kind->ends || list_ends(model, elements);
}

enum rb_status rb_elements_create(struct rb_model *model, struct rb_error *err)
{
	int lists = 0;

	for (int place = 0; place < rb_element_kind_count; place++)
		lists += model->scene->elements[place].count > 0;
	if (lists == 0)
		return RB_OK;
	model->elements = rb_memory_take((size_t)lists, sizeof *model->elements);
	bool held = model->elements != NULL;
	for (int place = 0; held && place < rb_element_kind_count; place++) {
		if (model->scene->elements[place].count == 0)
			continue;
		struct rb_elements *const elements = &model->elements[model->element_list_count++];

		*elements = (struct rb_elements){.kind = rb_element_kinds[place],
		                                 .count = model->scene->elements[place].count};
		held = copy_rows(model, elements);
	}
	return held ? RB_OK : RB_FAIL(err, RB_ERR_MEMORY, "out of memory for forces of the scene");
}

void rb_elements_destroy(struct rb_model *model)
{
	for (int k = 0; k < model->element_list_count; k++) {
		rb_memory_free(model->elements[k].rows);
		rb_memory_free(model->elements[k].end);
		rb_memory_free(model->elements[k].first);
		rb_memory_free(model->elements[k].of);
	}
	rb_memory_free(model->elements);
}

double rb_elements_energy(const struct rb_element_query *query)
{
	double sum = 0;

	for (int k = 0; k < query->model->element_list_count; k++) {
		const struct rb_elements *elements = &query->model->elements[k];

		for (int m = 0; elements->kind->energy && m < elements->count; m++)
			sum += elements->kind->energy(query, rb_elements_row(elements, m));
	}
	return sum;
}

rb_vec3 rb_element_arm(const struct rb_model *model, int index, rb_quat orientation, rb_vec3 point)
{
	RB_ASSERT_COSTLY(index >= 0 && index < model->body_count + model->static_count);

	if (isnan(point.x))
		return (rb_vec3){0, 0, 0};
	if (index < model->body_count && model->center_of_mass)
		point = rb_vec3_sub(point, model->center_of_mass[index]);
	return rb_quat_rotate(orientation, point);
}
