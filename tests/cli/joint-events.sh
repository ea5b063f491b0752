#!/bin/sh
# SPDX-License-Identifier: MIT
# Events of joints by steps: a limit that is met, a rope that comes taut and slack, a drive that begins to hold; told to
# callbacks and recorded, also where a step was taken in parts.
. tests/cli/functions

cat >events.lua <<'END'
world { method = "stepped", time_step = 1 / 500, duration = 2, frame_rate = 60, gravity = {0, 0, -9.81} }
local ball = sphere { name = "ball", radius = 0.1, mass = 1, position = {0.6, 0, 2} }
joint { name = "rope", kind = "rope", a = ball, at_b = {0, 0, 2}, length = 1, restitution = 0.5 }
local wheel = cylinder { name = "wheel", radius = 0.2, length = 0.1, mass = 5, position = {5, 0, 2} }
joint { name = "motor", kind = "hinge", a = wheel, at = {5, 0, 2}, axis = {0, 0, 1}, motor = {speed = -3, torque = 0.2} }
local door = box { name = "door", size = {1, 0.1, 1}, mass = 3, position = {10, 0, 1}, angular_velocity = {0, 0, 3}, velocity = {0, 1.5, 0} }
joint { name = "hinges", kind = "hinge", a = door, at = {9.5, 0, 1}, axis = {0, 0, 1}, limits = {-0.7, 0.5}, restitution = 0.5 }
local sled = box { name = "sled", size = {0.2, 0.2, 0.2}, mass = 1, position = {20, 0, 1}, velocity = {2, 0, 0} }
joint { name = "rail", kind = "slider", a = sled, axis = {1, 0, 0}, friction = 3 }
local function tell(c) print(("%.4f %s %s %.4f"):format(c.time, c.kind, c.joint.name, c.approach_speed or 0)) end
on_collision(tell)
on_transition(tell)
record { fields = {"+", "events", "joints"} }
END
exits 0 events.lua -o events.h5 --no-render
grep '^[0-9.]* [a-z]* [a-z]* [0-9.]*$' err >told || fail "no event was told"

# first KIND JOINT TIME SPEED: when the first of them was, and how fast: to a step, and what a step changes of the speed
first()
{
	awk -v kind="$1" -v joint="$2" -v time="$3" -v speed="$4" '$2 == kind && $3 == joint {
		ok = $1 - time < 0.005 && time - $1 < 0.0025 && $4 - speed < 0.03 && speed - $4 < 0.03
		exit
	} END { exit !ok }' told || fail "first $1 of $2 is not at $3 s: $(grep "$2" told | tr '\n' ';')"
}
# a door at 3 rad/s; a ball that falls 0.8 m, of its speed what is along the rope; 0.1 kg m^2 by 0.2 N m; 2 m/s against 3 m/s^2
first limit hinges 0.2333 3
first taut rope 0.4039 3.17
first slack rope 0.4059 0
first drives motor 1.5 0
first drives rail 0.6667 0
awk '$3 == "hinges" { v[++n] = $4 } END { exit !(n >= 2 && v[2] > 1.49 && v[2] < 1.51) }' told || fail "a door of e = 0.5 comes back at half"
[ "$(grep -c motor told)" = 1 ] || fail "a motor that holds its speed is told of once"

# the same in the recording
exits 0 export events.h5 --to csv
[ "$(grep -c ',\(limit\|taut\|slack\|drives\|slips\),' events-events.csv)" = "$(wc -l <told)" ] || fail "$(cat events-events.csv)"
