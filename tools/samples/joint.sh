# SPDX-License-Identifier: MIT
# A kind of joint of tools/sample: two faces on each other, against closed forms by each method.
most=4

add()
{
	cat >src/joint/planar.c <<'END'
/* SPDX-License-Identifier: MIT */
/* A point of b stays in a plane of a, and b turns about the plane's normal, the axis. */
#include "joint/joint_types.h"

/* u_3 . d */
static void fill(const struct rb_linkage *link, const struct rb_linkage_parts *parts, struct rb_linkage_row *row)
{
	(void)link;
	*row = rb_linkage_along(parts, rb_linkage_axis_a(parts, 2));
}

static const struct rb_linkage_condition in_plane = {.count = 1, .fill = fill};

const struct rb_joint_type rb_joint_type_planar = {
	.name = "planar",
	.noun = "planar joint",
	.linkage = {.condition = {&in_plane, &rb_linkage_same_axis}},
	.has_axis = true,
	.is_centered = true,
	.form = RB_JOINT_PIN,
};
END
	edit src/joint/joint_types.h 's|^	TYPE(ROPE, rope)|& \\\n	TYPE(PLANAR, planar)|'
	edit include/rbsim/scene.h 's|^	RB_JOINT_ROPE,|&\n	RB_JOINT_PLANAR,|' '/define RB_JOINT_KIND_NAMES/s|rope"|rope, planar"|'
	place joint/planar joint/fixed "a point of b in a plane of a, about whose normal b turns"
}

try()
{
	cat >slide.lua <<'END'
-- A spinning brick slides down a slope; far from it, in free fall, a ball stays in a plane of a tumbling brick.
world { duration = 1, frame_rate = 50, time_step = 1e-4, gravity = {0, 0, -9.81}, method = param("method", "auto", "of the run") }
record { ledger = true, fields = {"+", "joints"} }
local bound = param("bound", 1e-9, "m")
local angle, g = 0.5, 9.81
local n, down = vec3(math.sin(angle), 0, math.cos(angle)), vec3(math.cos(angle), 0, -math.sin(angle))
local brick = box { name = "brick", size = {0.4, 0.2, 0.1}, mass = 2, velocity = {0, 0.3, 0},
	orientation = {axis = {0, 1, 0}, angle = angle}, angular_velocity = 3 * n }
local slope = joint { name = "slope", kind = "planar", a = brick, axis = n }
local big = box { name = "big", size = {1, 0.8, 0.5}, mass = 5, position = {0, 20, 0}, angular_velocity = {0.5, 0.2, 1} }
local small = sphere { name = "small", radius = 0.1, mass = 1, position = {0.5, 20, 0.4}, velocity = {0.2, 0.3, -0.1},
	angular_velocity = {0.5, 0.2, -7} }
joint { name = "table", kind = "planar", a = big, b = small, at = {0.5, 20, 0.4}, axis = {0, 0, 1} }
local before
on_frame(function() before = before or energy() end)
expect("the brick slides", function()
	return (brick.position - 0.5 * g * math.sin(angle) * down - vec3(0, 0.3, 0)):length(), bound
end)
expect("it spins about the normal", function() return (brick.angular_velocity - 3 * n):length(), bound end)
-- on b, which is the world
expect("the slope holds it", function() return (slope.force + 2 * g * math.cos(angle) * n):length(), 100 * bound end)
expect("the ball stays in the plane", function()
	return math.abs((small.position - big.position):dot(big.point({0, 0, 1}) - big.position) - 0.4), bound
end)
expect("it turns with it but for the normal", function()
	local spin, normal = small.angular_velocity - big.angular_velocity, big.point({0, 0, 1}) - big.position
	return spin:cross(normal):length(), 10 * bound
end)
expect("both fall as one", function()
	return (5 * big.velocity + small.velocity - vec3(0.2, 0.3, -0.1) + 6 * vec3(0, 0, g)):length(), bound
end)
-- by steps of h all fall g t h / 2 too far: 6 g g t h / 2 of about 4.5 J
expect("energy stays", function() return math.abs(energy() / before - 1), 10 * bound end)
END
	for method in auto located stepped; do
		bound=1e-9
		[ $method != stepped ] || bound=1e-3
		"$rbsim" slide.lua --no-render --method $method --param bound=$bound -o slide.h5 --force --quiet ||
			fail "the sample joint is wrong by $method"
	done
	"$rbsim" info slide.h5 | grep -q '2 planar joints' || fail "the recording has no planar joints"
	"$rbsim" check slide.lua | grep -q '2 planar joints' || fail "check says nothing of planar joints"
	"$rbsim" check slide.lua --json | grep -q '"joint_rows":6,' || fail "check counts other rows"
	"$rbsim" check slide.lua | grep -q 'freedoms *12 at the start' || fail "check counts other freedoms"
	"$rbsim" --print-tables scene >tables
	grep -q 'rope, planar: ' tables && grep -q 'slider, cylindrical, universal, planar\.' tables &&
		grep -q 'fixed, slider, planar: the centre' tables || fail "the tables of keys have no planar joint"
	echo 'joint { kind = "planar", a = sphere { radius = 1 }, limits = {0, 1} }' >bad.lua
	"$rbsim" check bad.lua >bad.txt 2>&1 && fail "a wrong joint is taken"
	grep -q "'axis' is missing: a joint of kind 'planar' needs it" bad.txt || fail "a missing axis is not named"
	grep -q "'limits': a joint of kind 'planar' has none (kinds that have it: hinge, slider and cylindrical)" bad.txt ||
		fail "limits are not refused"
	if [ "$film" = 1 ]; then
		echo 'camera { position = {2, -4, 2}, look_at = {1, 0, 0}, fov = deg(40), png = "planar-%d.png" }' >>slide.lua
		"$rbsim" slide.lua --quiet -o slide.h5 --force || fail "a planar joint cannot be drawn"
	fi
}
