# SPDX-License-Identifier: MIT
# A shape of tools/sample: a regular prism, which falls, stands and is part of a union by each method.
most=4

add()
{
	cat >src/shape/prism.c <<'END'
/* SPDX-License-Identifier: MIT */
/* A regular prism about local z: `sides` corners at `radius`, the first along x. size[0] has the number of sides. */
#include <math.h>
#include <stdio.h>

#include "base/memory.h"
#include "shape/shape_types.h"

#define AT(member) offsetof(struct rb_body_def, shape.member)

static const struct rb_row keys[] = {
	{"sides", RB_ROW_NUMBER, RB_RANGE_POSITIVE, 0, AT(size[0]), NULL, "required", "", "3 to 99"},
	{"radius", RB_ROW_NUMBER, RB_RANGE_POSITIVE, 0, AT(radius), NULL, "required", "m", "of its corners"},
	{"length", RB_ROW_NUMBER, RB_RANGE_POSITIVE, 0, AT(size[2]), NULL, "required", "m", "along its axis"},
};

static bool fault(const struct rb_shape *shape, char text[RB_SHAPE_FAULT_SIZE])
{
	const double sides = shape->size[0];

	if (sides == floor(sides) && sides >= 3 && sides <= 99)
		return false;
	snprintf(text, RB_SHAPE_FAULT_SIZE, "'sides' must be a whole number from 3 to 99 (got %g)", sides);
	return true;
}

static enum rb_status make(struct rb_scene *scene, struct rb_shape *shape, struct rb_error *err)
{
	const int sides = (int)shape->size[0];
	rb_vec3 corner[2 * 99];

	for (int k = 0; k < 2 * sides; k++) {
		const double angle = 2 * RB_PI * (k % sides) / sides;

		corner[k] = (rb_vec3){shape->radius * cos(angle), shape->radius * sin(angle),
		                      (k < sides ? -0.5 : 0.5) * shape->size[2]};
	}
	return rb_scene_add_hull(scene, corner, 2 * (size_t)sides, &shape->solid, err);
}

const struct rb_shape_type rb_shape_prism = {
	.name = "prism",
	.plural = "prisms",
	.form = RB_FORM_POLYHEDRON,
	.reads = RB_SHAPE_READS_RADIUS | RB_SHAPE_READS_SIZE_X | RB_SHAPE_READS_SIZE_Z | RB_SHAPE_READS_SOLID,
	.key = keys,
	.key_count = sizeof keys / sizeof keys[0],
	.is_part = true,
	.fault = fault,
	.make = make,
};
END
	edit src/shape/shape_types.h 's|^	TYPE(TERRAIN, terrain)|& TYPE(PRISM, prism)|'
	edit include/rbsim/scene.h 's|^	RB_SHAPE_TERRAIN,|&\n	RB_SHAPE_PRISM,|'
	place shape/prism shape/convex_hull "corners on a circle, twice"
}

try()
{
	cat >fall.lua <<'END'
-- A hexagonal prism falls flat, bounces to e^2 of its height; one stands, one is part of a hammer; a triangular one spins freely.
world { duration = 0.8, frame_rate = 50, time_step = 1e-4, gravity = {0, 0, -9.81},
    method = param("method", "auto", "of the run") }
record { ledger = true }
plane { name = "floor" }
local hard = material { friction = 0.3, restitution = 0.5, density = 1000 }
local wood = material { friction = 0.3, restitution = 0, density = 600 }
local falls = prism { sides = 6, radius = 0.2, length = 0.4, position = {0, 0, 1.2}, material = hard }
local stands = prism { sides = 5, radius = 0.2, length = 0.4, position = {2, 0, 0.2}, material = wood }
local hammer = body { shapes = {{ shape = "prism", sides = 4, radius = 0.1, length = 0.3, position = {0, 0, 0.5} },
    { shape = "cylinder", radius = 0.02, length = 0.4, position = {0, 0, 0.15} }},
    position = {-2, 0, 2}, angular_velocity = {0, 5, 0}, material = hard }
local n, r, length = 6, 0.2, 0.4
local area = n / 2 * r * r * math.sin(2 * math.pi / n)
local bound = param("bound", 1e-12, "relative")
expect("its mass", function() return math.abs(falls.mass / (1000 * area * length) - 1), 1e-14 end)
local axial = falls.mass * r * r / 6 * (2 + math.cos(2 * math.pi / n))
expect("its moment about the axis", function() return math.abs(falls.inertia[3][3] / axial - 1), 1e-13 end)
-- from 1 m: down after t1, up again with e v1
local g = 9.81
local t1 = math.sqrt(2 / g)
local t = 0.8 - t1
expect("it bounces", function() return math.abs(falls.position.z - (0.2 + 0.5 * g * t1 * t - g / 2 * t * t)), bound end)
expect("it stands", function() return math.abs(stands.position.z - 0.2), bound end)
END
	for method in auto located stepped; do
		bound=1e-11
		[ $method != stepped ] || bound=2e-3
		"$rbsim" fall.lua --no-render --method $method --param bound=$bound -o fall.h5 --force --quiet ||
			fail "the sample shape is wrong by $method"
	done
	"$rbsim" info fall.h5 --json | grep -q '"prism":2' || fail "the recording has no prisms"
	"$rbsim" check fall.lua | grep -q '2 prisms' || fail "check says nothing of prisms"
	"$rbsim" --print-tables scene >tables
	grep -q 'table prism' tables && grep -q 'of a capsule, a cylinder, a prism' tables ||
		fail "the tables of keys have no prism"
	"$rbsim" check fall.lua --method classic 2>&1 | grep -q "has no contacts of prisms" || fail "classic steps take prisms"
	echo 'prism { sides = 2.5, radius = 1, length = 1 }' >bad.lua
	"$rbsim" check bad.lua 2>&1 | grep -q "bad.lua:1: prism: 'sides' must be a whole number from 3 to 99 (got 2.5)" ||
		fail "a wrong prism is not refused"
	if [ "$film" = 1 ]; then
		echo 'camera { position = {-1, -5, 3}, look_at = {0, 0, 0.8}, from = 0.79, fov = deg(45), png = "prisms-%d.png" }' >>fall.lua
		"$rbsim" fall.lua --quiet -o fall.h5 --force || fail "a prism cannot be drawn"
	fi
}
