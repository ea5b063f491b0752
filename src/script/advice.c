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

static const char meshes[] = "of an STL or OBJ file, hull { file = ... } is the convex solid, and "
			     "terrain { file = ... } its triangles, which are static";
static const char outside[] = "scenes reach no files or programs; record { } says what is written";
static const char of_material[] = "it belongs to a material: material { ... }";
static const char of_solid[] = "hull { points = ... }, the convex solid of its corners";
static const char of_body[] = "a key of bodies: sphere { forces = {{vector = {x, y, z}}} }; in "
			      "on_step body:apply_force(f)";
static const char to_radians[] = "deg(30) is 30 degrees in radians";
static const char of_spin[] = "a vector in rad/s is 'angular_velocity'";

static const struct advice globals[] = {
	{"constraint", "joint { kind = ..., a = ..., b = ... }"},
	{"rod", "joint { kind = \"rod\", a = ..., b = ... }"},
	{"rope", "joint { kind = \"rope\", a = ..., b = ... }"},
	{"hinge", "joint { kind = \"hinge\", a = ..., b = ..., at = ..., axis = ... }"},
	{"slider", "joint { kind = \"slider\", a = ..., b = ..., axis = ... }"},
	{"motor",
         "a key of joint: joint { kind = \"hinge\", ..., motor = {speed = ..., torque = ...} }"},
	{"mesh", meshes},
	{"heightfield", "terrain { height = function(x, y) ... end, size = ..., cells = ... }"},
	{"os", outside},
	{"io", outside},
	{"debug", "a scene has no 'debug'"},
	{"ball", "sphere { ... }"},
	{"light", "a key of camera: camera { lights = { ... } }"},
	{"lights", "a key of camera: camera { lights = { ... } }"},
	{"wall", "plane { ... }, or box { static = true, ... }"},
	{"rigidbody",
         "a body is its shape: sphere { ... }, box { ... }, body { shapes = { ... } }"},
	{"RigidBody",
         "a body is its shape: sphere { ... }, box { ... }, body { shapes = { ... } }"},
	{"addBody", "a body is its shape: sphere { ... }, box { ... }, body { shapes = { ... } }"},
	{"particle", "sphere { ... }"},
	{"compound", "body { shapes = { ... } }"},
	{"scene", "world { ... }; bodies stand by themselves: sphere { ... }"},
	{"simulation", "world { ... }"},
	{"setGravity", "a key of world: world { gravity = {0, 0, -9.81} }"},
	{"set_gravity", "a key of world: world { gravity = {0, 0, -9.81} }"},
	{"damper", "spring { stiffness = 0, damping = ... }"},
	{"damping", "drag { linear = ... }"},
	{"include", "require 'name'"},
	{"vector", "vec3(x, y, z)"},
	{"vec", "vec3(x, y, z)"},
	{"cube", "box { ... }"},
	{"cuboid", "box { ... }"},
	{"ground", "plane { ... }"},
	{"floor", "plane { ... }; rounding down is math.floor"},
	{"gravity", "a key of world: world { gravity = {0, 0, -9.81} }"},
	{"gravitation", "a key of world: world { gravitation = {} }"},
	{"force", of_body},
	{"torque", of_body},
	{"cone", of_solid},
	{"pyramid", of_solid},
	{"rad", to_radians},
	{"radians", to_radians},
	{"degrees", to_radians},
	{"pi", "math.pi"},
	{"sqrt", "math.sqrt"},
	{"sin", "math.sin"},
	{"cos", "math.cos"},
	{"tan", "math.tan"},
	{"asin", "math.asin"},
	{"acos", "math.acos"},
	{"atan", "math.atan"},
	{"exp", "math.exp"},
	{"log", "math.log"},
	{"abs", "math.abs"},
	{"min", "math.min"},
	{"max", "math.max"},
	{"huge", "math.huge"},
	{"random", "math.random"},
	{"ceil", "math.ceil"},
	{"pow", "x ^ y"},
	{"atan2", "math.atan(y, x)"},
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
	{"body_a", "a, of joint and spring"},
	{"body_b", "b, of joint and spring"},
	{"anchor", "at, of joint: a point in world coordinates"},
	{"pivot", "at, of joint: a point in world coordinates"},
	{"lower", "limits = {low, high}, of joint"},
	{"upper", "limits = {low, high}, of joint"},
	{"max_force", "force, of a motor"},
	{"max_torque", "torque, of a motor"},
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

/* Words for keys, and the keys that may be meant, the likelier one first. */
static const struct {
	const char *word, *key[3];
} synonyms[] = {
	{"r", {"radius"}},
	{"diameter", {"radius"}},
	{"height", {"length", "point"}},
	{"offset", {"point", "position"}},
	{"half", {"size"}},
	{"half_extents", {"size"}},
	{"half_size", {"size"}},
	{"extents", {"size"}},
	{"dimensions", {"size"}},
	{"width", {"size"}},
	{"depth", {"size"}},
	{"x", {"position"}},
	{"at", {"position"}},
	{"origin", {"position"}},
	{"center", {"position"}},
	{"rotation", {"orientation"}},
	{"quaternion", {"orientation"}},
	{"quat", {"orientation"}},
	{"kinematic", {"motion"}},
	{"v", {"velocity"}},
	{"k", {"stiffness"}},
	{"c", {"damping"}},
	{"length", {"rest_length"}},
	{"l0", {"rest_length"}},
	{"mu", {"friction"}},
	{"e", {"restitution"}},
	{"cor", {"restitution"}},
	{"bounce", {"restitution"}},
	{"colour", {"color"}},
	{"layer", {"group"}},
	{"mask", {"collides_with"}},
	{"vertices", {"points"}},
	{"children", {"shapes"}},
	{"parts", {"shapes"}},
	{"g", {"gravity"}},
	{"end_time", {"duration"}},
	{"t_end", {"duration"}},
	{"time", {"duration"}},
	{"dt", {"time_step"}},
	{"timestep", {"time_step"}},
	{"fps", {"frame_rate"}},
	{"type", {"kind", "shape"}},
	{"angle", {"orientation"}},
	{"target", {"look_at"}},
	{"eye", {"position"}},
};

/* Fields of bodies that are parts of others. */
static const struct advice fields[] = {
	{"x", "position.x"},
	{"y", "position.y"},
	{"z", "position.z"},
	{"vx", "velocity.x"},
	{"vy", "velocity.y"},
	{"vz", "velocity.z"},
	{"speed", "velocity:length()"},
	{"energy", "kinetic_energy"},
};

const char *rb_advice_for_field(const char *word)
{
	return find(fields, sizeof fields / sizeof *fields, word);
}

const char *rb_advice_synonym(const char *word, int k)
{
	for (size_t i = 0; k >= 0 && k < 3 && i < sizeof synonyms / sizeof *synonyms; i++)
		if (strcmp(synonyms[i].word, word) == 0)
			return synonyms[i].key[k];
	return NULL;
}

const char *rb_advice_for_key(const char *key)
{
	return find(keys, sizeof keys / sizeof *keys, key);
}
