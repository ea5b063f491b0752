/* SPDX-License-Identifier: MIT */
#include "constraint/contact_name.h"

#include "base/error.h"
#include "geom/patch.h"
#include "math/vec3.h"

/*
 * Bits of a part's index that give the place on a rim, above the bit that says which rim
 * (geom/patch).
 */
enum { PLACE_BITS = 15 };

int rb_contact_name_compare(const struct rb_contact_name *x, const struct rb_contact_name *y)
{
	if (x->a != y->a)
		return x->a < y->a ? -1 : 1;
	if (x->b != y->b)
		return x->b < y->b ? -1 : 1;
	if (x->parts != y->parts)
		return x->parts < y->parts ? -1 : 1;
	if (x->key != y->key)
		return x->key < y->key ? -1 : 1;
	if (x->half.x != y->half.x)
		return x->half.x < y->half.x ? -1 : 1;
	return (x->half.y > y->half.y) - (x->half.y < y->half.y);
}

bool rb_contact_name_is(const struct rb_contact_name *x, const struct rb_contact_name *y)
{
	return x->a == y->a && x->b == y->b && x->parts == y->parts && x->key == y->key &&
	       !(rb_vec3_dot(x->half, y->half) < 0);
}

struct rb_contact_name rb_contact_name_swapped(const struct rb_contact_name *name)
{
	struct rb_contact_name swapped = *name;

	/* a mark belongs to one body's face */
	RB_ASSERT_COSTLY(name->key >> RB_CONTACT_KEY_MARK == 0);
	swapped.a = name->b;
	swapped.b = name->a;
	swapped.parts = name->parts << 16 | name->parts >> 16;
	swapped.key = name->key << 32 | name->key >> 32;
	return swapped;
}

static bool is_rim(rb_part part)
{
	return (rb_part_kind)(part >> 24 & 15) == RB_PART_RIM;
}

static int place_of(rb_part part)
{
	return (int)(part >> 1 & PLACE_BITS);
}

static rb_part all_round(rb_part part)
{
	return (part & ~((rb_part)PLACE_BITS << 1)) | (rb_part)RB_CONTACT_ALL_ROUND << 1;
}

uint64_t rb_contact_key_all_round(uint64_t key)
{
	rb_part part[2] = {(rb_part)(key >> 32), (rb_part)key};

	for (int k = 0; k < 2; k++) {
		if (!is_rim(part[k]))
			continue;
		part[k] = all_round(part[k]);
		return (uint64_t)part[0] << 32 | part[1];
	}
	return 0;
}

/*
 * Does the key have a place on a rim? The lowest point of a tilted rim has none, whichever half it
 * is counted from.
 */
static bool has_place(uint64_t key)
{
	const rb_part part[2] = {(rb_part)(key >> 32), (rb_part)key};

	return (is_rim(part[0]) && place_of(part[0]) != 0) ||
	       (is_rim(part[1]) && place_of(part[1]) != 0);
}

struct rb_contact_name rb_contact_name_shared(const struct rb_contact_name *name)
{
	struct rb_contact_name shared = *name;

	shared.key &= ((uint64_t)1 << RB_CONTACT_KEY_MARK) - 1;
	shared.half = (rb_vec3){0, 0, 0};
	if (rb_vec3_max_abs(name->half) > 0 && has_place(shared.key))
		shared.key = rb_contact_key_all_round(shared.key);
	return shared;
}
