/* SPDX-License-Identifier: MIT */
/*
 * Time averages of contact forces over a step that was taken in substeps: sums of impulses per
 * contact, divided by the whole step at the end. Contacts are matched by (a, b, key) by merging two
 * sorted lists, O(n) per substep; both buffers are kept and swapped.
 *
 * With impulse P_i = p_i n_i and friction T_i of substep i: the normal is that of sum P_i, and the
 * part of sum T_i along it belongs to the normal force, so that the total impulse is reported
 * exactly although normals of substeps differ. The point is the mean of points weighted by p_i.
 */
#include "stepped/mean_forces.h"

#include <stdlib.h>

#include "base/error.h"
#include "base/memory.h"
#include "math/vec3.h"

void rb_mean_forces_release(struct rb_mean_forces *means)
{
	rb_memory_free(means->row);
	rb_memory_free(means->spare);
	*means = (struct rb_mean_forces){0};
}

/* Order of contacts by bodies and by feature key, for qsort. */
static int by_name(const void *left, const void *right)
{
	const struct rb_contact_name x = rb_contact_name_in(left), y = rb_contact_name_in(right);

	return rb_contact_name_compare(&x, &y);
}

/* Adds one substep of h seconds to the sums of a contact. */
static void add(struct rb_mean_force *mean, const struct rb_contact *contact, double h)
{
	const double normal_impulse = contact->normal_force * h;

	RB_ASSERT_COSTLY(h > 0 && contact->normal_force >= 0);
	mean->contact = *contact;
	mean->normal_impulse = rb_vec3_add_scaled(mean->normal_impulse, normal_impulse,
	                                          contact->normal);
	mean->friction_impulse = rb_vec3_add_scaled(mean->friction_impulse, h,
	                                            contact->tangent_force);
	mean->moment = rb_vec3_add_scaled(mean->moment, normal_impulse, contact->point);
	mean->weight += normal_impulse;
	mean->lasts = true;
}

enum rb_status rb_mean_forces_add(struct rb_mean_forces *means, struct rb_contacts *part, double h,
                                  struct rb_error *err)
{
	const struct rb_mean_force *old = means->row;
	const size_t max = means->count + part->count + 1;
	size_t at = 0, count = 0;

	if (!rb_memory_reserve(&means->spare, &means->spare_capacity, max, sizeof *means->spare))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for %zu contacts", max);
	if (part->count > 1)
		qsort(part->row, part->count, sizeof *part->row, by_name);
	for (size_t k = 0; k <= part->count; k++) {
		const struct rb_contact *contact = k < part->count ? &part->row[k] : NULL;
		struct rb_mean_force mean = {0};

		for (; at < means->count && (!contact || by_name(&old[at].contact, contact) < 0);
		     at++) {
			means->spare[count] = old[at];
			means->spare[count++].lasts = false;
		}
		if (!contact)
			break;
		if (at < means->count && by_name(&old[at].contact, contact) == 0)
			mean = old[at++];
		add(&mean, contact, h);
		means->spare[count++] = mean;
	}
	const struct rb_mean_forces was = *means;
	means->row = was.spare;
	means->count = count;
	means->capacity = was.spare_capacity;
	means->spare = was.row;
	means->spare_capacity = was.capacity;
	return RB_OK;
}

enum rb_status rb_mean_forces_record(const struct rb_mean_forces *means, double h,
                                     struct rb_contacts *to, struct rb_error *err)
{
	const enum rb_status status = rb_contacts_reserve(to, to->count + means->count + 1, err);

	RB_ASSERT(h > 0);
	if (status != RB_OK)
		return status;
	for (size_t k = 0; k < means->count; k++) {
		const struct rb_mean_force *mean = &means->row[k];
		const double normal_impulse = rb_vec3_length(mean->normal_impulse);
		struct rb_contact contact = mean->contact;

		if (normal_impulse > 0) {
			const rb_vec3 normal = rb_vec3_scale(1 / normal_impulse,
			                                     mean->normal_impulse);
			const double more = rb_vec3_dot(mean->friction_impulse, normal);

			contact.normal = normal;
			contact.normal_force = (normal_impulse + more) / h;
			contact.tangent_force = rb_vec3_scale(
				1 / h, rb_vec3_add_scaled(mean->friction_impulse, -more, normal));
			contact.point = rb_vec3_scale(1 / mean->weight, mean->moment);
		} else if (!mean->lasts) {
			continue;
		}
		to->row[to->count++] = contact;
	}
	return RB_OK;
}
