/* SPDX-License-Identifier: MIT */
/*
 * What people write who come from other programs, by experience; the nearest name would be
 * misleading for these, because it is another word altogether.
 */
#include "script/advice.h"

#include <stddef.h>
#include <string.h>

struct advice {
	const char *word, *text;
};

static const char joints[] = "joints are not in this version";
static const char meshes[] =
	"meshes are not in this version; hull { points = ... } is the convex solid of points";
static const char outside[] = "scenes reach no files or programs; record { } says what is written";
static const char of_material[] = "it belongs to a material: material { ... }";
static const char of_spin[] = "a vector in rad/s is 'angular_velocity'";

static const struct advice globals[] = {
	{"joint", joints},
	{"rod", joints},
	{"rope", joints},
	{"hinge", joints},
	{"motor", joints},
	{"mesh", meshes},
	{"terrain", meshes},
	{"os", outside},
	{"io", outside},
	{"debug", "a scene has no 'debug'"},
	{"ball", "sphere { ... }"},
	{"cube", "box { ... }"},
	{"cuboid", "box { ... }"},
	{"ground", "plane { ... }"},
	{"floor", "plane { ... }; rounding down is math.floor"},
	{"gravity", "a key of world: world { gravity = {0, 0, -9.81} }"},
};

static const struct advice keys[] = {
	{"restitution", of_material},
	{"bounciness", "restitution, of a material"},
	{"elasticity", "restitution, of a material"},
	{"friction", of_material},
	{"omega", of_spin},
	{"spin", of_spin},
	{"fixed", "static = true"},
	{"dt", "time_step, of world"},
	{"timestep", "time_step, of world"},
	{"fps", "frame_rate, of world"},
};

/* The text for a word, NULL: none. */
static const char *find(const struct advice *rows, size_t count, const char *word)
{
	for (size_t k = 0; k < count; k++)
		if (strcmp(rows[k].word, word) == 0)
			return rows[k].text;
	return NULL;
}

const char *rb_advice_for_global(const char *name)
{
	return find(globals, sizeof globals / sizeof *globals, name);
}

const char *rb_advice_for_key(const char *key)
{
	return find(keys, sizeof keys / sizeof *keys, key);
}
