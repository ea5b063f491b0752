/* SPDX-License-Identifier: MIT */
#include "event/look.h"

enum rb_status rb_look_contacts(struct rb_located *l, double t)
{
	struct rb_contacts *contacts = &l->world->contacts;
	size_t count = 0;

	for (int k = 0; k < l->cluster_count; k++)
		count += (size_t)l->cluster[k].held_count;
	contacts->count = 0;
	const enum rb_status status = rb_contacts_reserve(contacts, count, l->err);
	if (status != RB_OK)
		return status;
	for (int k = 0; k < l->cluster_count; k++)
		for (int h = 0; h < l->cluster[k].held_count; h++) {
			const struct rb_held *held = &l->cluster[k].held[h];
			const struct rb_meet m = rb_set_meet(l, held, t);
			const double normal = rb_vec3_dot(held->force, m.normal);

			contacts->row[contacts->count++] = (struct rb_contact){
				.a = held->a,
				.b = held->b,
				.point = m.point,
				.normal = m.normal,
				.gap = m.gap,
				.normal_force = normal,
				.tangent_force = rb_vec3_add_scaled(held->force, -normal,
			                                            m.normal)};
		}
	rb_contacts_sort(contacts);
	return RB_OK;
}

/* Below the deepest so far, between i and j? Spheres that are apart, also from planes, are seen without looking closer. */
static void deeper(const struct rb_located *l, double t, int i, int j, double *deepest, int pair[2])
{
	const struct rb_model *model = l->model;

	if (model->shape[i].kind == RB_SHAPE_SPHERE && model->shape[j].kind == RB_SHAPE_SPHERE) {
		const rb_vec3 d = rb_vec3_sub(rb_arc_origin(l, j, t), rb_arc_origin(l, i, t));
		const double sum = model->shape[i].radius + model->shape[j].radius;

		if (rb_vec3_dot(d, d) > sum * sum)
			return;
	}
	if (model->shape[i].kind == RB_SHAPE_SPHERE && model->shape[j].kind == RB_SHAPE_PLANE &&
	    j >= l->n) {
		const rb_vec3 d = rb_vec3_sub(rb_arc_origin(l, i, t), model->position[j]);

		if (rb_vec3_dot(d, l->plane_normal[j - l->n]) > model->shape[i].radius)
			return;
	}
	if (!rb_meet_can(l, i, j))
		return;
	if (rb_meet_has_features(l, i, j) && rb_meet_is_far(l, i, j, t, t))
		return;
	const struct rb_meet m = rb_meet_at(l, i, j, t);
	if (-m.gap > *deepest) {
		*deepest = -m.gap;
		pair[0] = i;
		pair[1] = j;
	}
}

double rb_look_overlap(struct rb_located *l, double t, int *a, int *b)
{
	double deepest = 0;
	int pair[2] = {-1, -1};

	for (int i = 0; i < l->n; i++) {
		const int near = rb_set_near(l, i);

		for (int k = 0; k < near; k++)
			if (l->near[k] > i)
				deeper(l, t, i, l->near[k], &deepest, pair);
		for (int j = l->n; j < l->n + l->model->static_count; j++)
			deeper(l, t, i, j, &deepest, pair);
	}
	*a = pair[0];
	*b = pair[1];
	return deepest;
}
