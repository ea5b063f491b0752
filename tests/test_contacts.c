/* SPDX-License-Identifier: MIT */
/* src/world/contacts: the cache of contacts by pair. */
#include "support.h"

#include "world/contacts.h"

enum { BODIES = 12 };

/* Contacts of some pairs, in an order of their own; the gap names the pair. */
static bool touch(int a, int b)
{
	return (a * 5 + b * 3) % 4 != 0;
}

static double gap_of(int a, int b)
{
	return 100 * a + b;
}

static void fill(struct rb_contacts *contacts)
{
	struct rb_error err;

	*contacts = (struct rb_contacts){0};
	assert_int_equal(rb_contacts_reserve(contacts, BODIES * BODIES, &err), RB_OK);
	for (int b = BODIES - 1; b > 0; b--)
		for (int a = 0; a < b; a++)
			if (touch(a, b))
				contacts->row[contacts->count++] = (struct rb_contact){
					.a = a, .b = b, .gap = gap_of(a, b)};
	rb_contacts_sort(contacts);
}

static void a_pair_is_found_if_it_touches_and_no_other(void **state)
{
	struct rb_contacts contacts;

	(void)state;
	fill(&contacts);
	for (int a = 0; a < BODIES; a++)
		for (int b = a + 1; b < BODIES; b++) {
			const struct rb_contact *const found = rb_contacts_find(&contacts, a, b);

			assert_int_equal(found != NULL, touch(a, b));
			assert_true(!found || found->gap == gap_of(a, b));
			assert_null(rb_contacts_find(&contacts, b, a));
		}
	rb_contacts_release(&contacts);
	assert_null(rb_contacts_find(&contacts, 0, 1));
}

static void what_a_body_drops_is_gone_and_nothing_else(void **state)
{
	struct rb_contacts contacts;

	(void)state;
	for (int body = 0; body < BODIES; body++) {
		fill(&contacts);
		rb_contacts_drop(&contacts, body);
		for (int a = 0; a < BODIES; a++)
			for (int b = a + 1; b < BODIES; b++) {
				const bool stays = touch(a, b) && a != body && b != body;
				const struct rb_contact *const found = rb_contacts_find(&contacts,
				                                                        a, b);

				assert_int_equal(found != NULL, stays);
				assert_true(!found || found->gap == gap_of(a, b));
			}
		rb_contacts_release(&contacts);
	}
}

/* But for the point, which it leaves out. */
static void the_hash_has_pairs_normals_gaps_and_forces(void **state)
{
	struct rb_contacts contacts;

	(void)state;
	fill(&contacts);
	const uint64_t hash = rb_contacts_hash(&contacts, 7);
	assert_int_equal(rb_contacts_hash(&contacts, 7), hash);
	assert_true(rb_contacts_hash(&contacts, 8) != hash);
	struct rb_contact *const row = &contacts.row[contacts.count - 1];
	double *const numbers[] = {&row->normal.x,        &row->normal.y,
	                           &row->normal.z,        &row->gap,
	                           &row->normal_force,    &row->tangent_force.x,
	                           &row->tangent_force.y, &row->tangent_force.z};
	for (size_t k = 0; k < sizeof numbers / sizeof numbers[0]; k++) {
		const double kept = *numbers[k];

		*numbers[k] = kept + 1;
		assert_true(rb_contacts_hash(&contacts, 7) != hash);
		*numbers[k] = kept;
	}
	row->a++;
	assert_true(rb_contacts_hash(&contacts, 7) != hash);
	row->a--;
	row->b++;
	assert_true(rb_contacts_hash(&contacts, 7) != hash);
	row->b--;
	assert_int_equal(rb_contacts_hash(&contacts, 7), hash);
	contacts.count--;
	assert_true(rb_contacts_hash(&contacts, 7) != hash);
	rb_contacts_release(&contacts);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_pair_is_found_if_it_touches_and_no_other),
		cmocka_unit_test(what_a_body_drops_is_gone_and_nothing_else),
		cmocka_unit_test(the_hash_has_pairs_normals_gaps_and_forces),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
