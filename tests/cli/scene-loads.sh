#!/bin/sh
# SPDX-License-Identifier: MIT
# What acts on bodies, and what it does: acceleration, angular_acceleration, force, torque and point_acceleration of handles
# against closed forms, by every method; recorded; asking changes no bit, also across a checkpoint.
. tests/cli/functions

# Accelerations of motions with closed forms. By steps contacts are solved to a residual below the tolerance, 1e-6 of a radius:
# over h^2 that is 1e-9 g here.
cat >closed.lua <<'END'
local bound = param("bound", 1e-12, "share of g, of radians/s^2")
local turning = param("turning", 1e-9, "the same of what turns")
world { duration = 0.5, frame_rate = 20, time_step = 1/1280, gravity = {0, 0, -9.81}, tolerance = 1e-10 }
local g, tilt = 9.81, math.rad(20)
local m = material { name = "m", friction = 0.6 }
local slick = material { name = "slick", friction = 0.1 }
contact_pair(m, slick, {friction = 0.1})
local floor = plane { normal = {0, 0, 1}, material = m, collides_with = {"flat"} }
local slope = plane { normal = {math.sin(tilt), 0, math.cos(tilt)}, material = m, collides_with = {"tilted"} }
local up, down = vec3(math.sin(tilt), 0, math.cos(tilt)), vec3(math.cos(tilt), 0, -math.sin(tilt))
local rest = sphere { radius = 0.1, mass = 2, position = {0, 0, 0.1}, material = m, group = "flat" }
local over = sphere { radius = 0.1, mass = 3, position = {0, 0, 0.3}, material = m, group = "flat", collides_with = {"flat"} }
local fall = sphere { radius = 0.1, mass = 2, position = {0, 5, 20}, material = m, collides_with = {} }
local rolls = sphere { radius = 0.1, mass = 2, position = 0.1 * up + vec3(0, 4, 0), material = m, group = "tilted" }
local slides = sphere { radius = 0.1, mass = 2, position = 0.1 * up + vec3(0, 7, 0), material = slick, group = "tilted" }
-- spun up at 3 rad/s^2 for 2 s would be 6 rad/s; here it has them, and turns on
local spun = sphere { radius = 0.025, mass = 19, position = {5, 0, 10}, angular_velocity = {0, 0, 6}, collides_with = {},
	forces = {{torque = {0, 0, 3 * 0.4 * 19 * 0.025^2}}} }
local table = cylinder { radius = 1, length = 0.1, position = {9, 9, 9}, collides_with = {},
	motion = function(t) return {9, 9 + t * t, 9}, {axis = {0, 0, 1}, angle = t * t}, {0, 2 * t, 0}, {0, 0, 2 * t} end }
local hung = sphere { radius = 0.1, mass = 2, position = {20, 0, 5}, collides_with = {} }
local hook = sphere { radius = 0.1, static = true, position = {20, 0, 6}, collides_with = {} }
spring { a = hook, b = hung, stiffness = 100, rest_length = 1 - 2 * 9.81 / 100 }
drag { linear = 0 }
local worst, what, turned = 0, "nothing", 0
local function near(name, found, wanted, scale)
	local off = (found - wanted):length() / scale
	if off > worst then worst, what = off, name end
end
local function turns(name, found, wanted, scale)
	local off = (found - wanted):length() / scale
	if off > turned then turned = off end
end
local none = vec3(0, 0, 0)
local function look(t)
	near("rest", rest.acceleration, none, g)
	near("rest: force", rest.force, none, 5 * g)
	near("over", over.acceleration, none, g)
	near("over: point", over:point_acceleration({0.05, 0, 0}), none, g)
	near("floor", floor.force, vec3(0, 0, -5 * g), 5 * g)
	near("fall", fall.acceleration, vec3(0, 0, -g), g)
	near("fall: force", fall.force, vec3(0, 0, -2 * g), 2 * g)
	near("rolls", rolls.acceleration, 5/7 * g * math.sin(tilt) * down, g)
	near("rolls: turning", rolls.angular_acceleration, vec3(0, 5/7 * g * math.sin(tilt) / 0.1, 0), g / 0.1)
	near("rolls: torque", rolls.torque, vec3(0, 2/7 * 2 * g * math.sin(tilt) * 0.1, 0), 2 * g * 0.1)
	-- at the very beginning it neither slides nor rolls yet
	if t > 0 then
		near("slides", slides.acceleration, g * (math.sin(tilt) - 0.1 * math.cos(tilt)) * down, g)
		near("slides: turning", slides.angular_acceleration, vec3(0, 2.5 * 0.1 * g * math.cos(tilt) / 0.1, 0), g / 0.1)
		near("slope", slope.force, (4/7 * g * math.sin(tilt) + 0.2 * g * math.cos(tilt)) * down - 4 * g * math.cos(tilt) * up, 4 * g)
	end
	near("spun", spun.angular_acceleration, vec3(0, 0, 3), 3)
	near("table", table.acceleration, vec3(0, 2, 0), 2)
	near("table: turning", table.angular_acceleration, vec3(0, 0, 2), 2)
	turns("table: its rim", table:point_acceleration({1, 0, 0}),
		vec3(-math.sin(t * t) * 2 - 4 * t * t * math.cos(t * t), 2 + math.cos(t * t) * 2 - 4 * t * t * math.sin(t * t), 0), 2)
	local stretched = hung.position.z - 5 -- steps sway by their length
	near("hung", hung.acceleration, vec3(0, 0, -50 * stretched), g)
	near("hook", hook.force, vec3(0, 0, 100 * stretched - 2 * g), 2 * g)
end
on_frame(function(t) look(t) end)
on_step(function(t, h) look(t) end)
expect_always("closed forms", function()
	if worst > bound then error(what .. " off by " .. worst) end
	return worst, bound
end)
expect_always("what turns", function() return turned, turning end)
END
for method in located auto; do
	exits 0 closed.lua --no-record --method $method
done
exits 0 closed.lua --no-record --method stepped -p bound=1e-7

# the worked example itself: from rest, 3 rad/s^2 for 2 s
cat >spun.lua <<'END'
world { duration = 2 }
local b = sphere { radius = 0.025, mass = 19, forces = {{torque = {0, 0, 3 * 0.4 * 19 * 0.025^2}}} }
expect("(-0.075, -0.9, 0)", function()
	local angle = 6 -- so far it has turned
	local p = {0.025 * math.sin(angle), 0.025 * math.cos(angle), 0}
	return (b:point_acceleration(p) - vec3(-0.075, -0.9, 0)):length() + (b:point_velocity(p) - vec3(-0.15, 0, 0)):length(), 1e-9
end)
END
exits 0 spun.lua --no-record
exits 0 spun.lua --no-record --method located

# forces of callbacks count as those of the step that has ended: pushed against friction it stays
cat >pushed.lua <<'END'
world { duration = 0.2, frame_rate = 20, gravity = {0, 0, -10} }
local m = material { friction = 0.5 }
plane { normal = {0, 0, 1}, material = m }
local b = box { size = {0.2, 0.2, 0.2}, mass = 2, position = {0, 0, 0.1}, material = m }
local free = sphere { radius = 0.1, mass = 2, position = {5, 0, 50} }
on_step(function()
	b:apply_force({4, 0, 0}, {0, 0, 0})
	free:apply_force({4, 0, 20})
	free:apply_torque({0, 0, 0.008})
end)
on_frame(function(t)
	if t == 0 then return end
	assert(b.acceleration:length() < 1e-7, tostring(b.acceleration))
	assert((free.acceleration - vec3(2, 0, 0)):length() < 1e-12, tostring(free.acceleration))
	assert((free.angular_acceleration - vec3(0, 0, 1)):length() < 1e-12, tostring(free.angular_acceleration))
	assert((free.torque - vec3(0, 0, 0.008)):length() < 1e-14)
end)
END
for method in located stepped; do
	exits 0 pushed.lua --no-record --method $method
done

# a scene with everything; who only looks, and who does not, has the same bits, also recorded
cat >mixed.lua <<'END'
local looks = param("looks", true, "at what acts")
local feels = param("feels", false, "and lets it push")
local where = param("where", "frames and steps and events", "that it looks")
world { duration = 1, frame_rate = param("rate", 30, "1/s"), gravity = {0, 0, -9.81}, seed = 3 }
local m = material { friction = 0.5, restitution = 0.4 }
local drum = box { size = {2, 2, 0.2}, position = {0, 0, -0.1}, material = m,
	motion = function(t) return {0.05 * math.sin(9 * t), 0, -0.1} end }
local all = {drum}
for i = 1, 4 do
	all[#all + 1] = sphere { radius = 0.1, position = {0.22 * i - 0.5, 0, 0.11 + 0.13 * i}, material = m }
	all[#all + 1] = box { size = {0.2, 0.2, 0.1}, position = {0.25 * i - 0.5, 0.5, 0.051 + 0.11 * i}, material = m }
end
spring { a = all[2], b = all[4], stiffness = 200, damping = 1, at_a = {0.1, 0, 0} }
drag { linear = 0.1 }
field(function(t, x, v) return {0.1 * math.sin(t), 0, -0.1 * x[1]} end)
local function look()
	local sum = 0
	if not looks then return end
	for _, b in ipairs(all) do sum = sum + b.force.z + b.torque.x + b.acceleration.y + b.angular_acceleration.z end
	if feels then all[3]:apply_force({0.01 * math.sin(sum), 0.001 * all[3].force.z, 0}) end
end
on_step(look)
on_frame(look)
on_collision(look)
record { fields = {"+", "acceleration", "angular_acceleration", "force", "torque", "contacts", "events"} }
END
for method in auto located stepped; do
	exits 0 mixed.lua --no-record --method $method --json -p looks=false
	hash=$(value state_hash)
	exits 0 mixed.lua --no-record --method $method --json
	[ "$hash" = "$(value state_hash)" ] || fail "$method: who looks changes what happens"
	exits 0 mixed.lua --force --method $method --json -o $method.h5
	[ "$hash" = "$(value state_hash)" ] || fail "$method: who records what acts changes what happens"
	exits 0 replay $method.h5
done

# who lets it push, and is interrupted, goes on with the same bits
for method in located stepped; do
	exits 0 mixed.lua -q --method $method -p feels=true --force -o whole.h5
	exits 0 mixed.lua --no-record --method $method -p feels=true --json
	hash=$(value state_hash)
	exits 0 info whole.h5 --json
	[ "$hash" = "$(value state_hash)" ] || fail "$method: recording changes what is felt"
	printf 'at 0.4 checkpoint\nat 0.5 quit\n' >commands
	rm -f broken.h5*
	exits 130 mixed.lua -q --method $method -p feels=true -o broken.h5 --commands commands
	exits 0 mixed.lua -q --method $method -p feels=true -o broken.h5 --resume
	exits 0 diff whole.h5 broken.h5
done

# moments at which nobody can know
printf 'world { duration = 1 }\nlocal b = sphere { radius = 1 }\nlocal a = b.force\n' >early.lua
exits 65 early.lua
says err "early.lua:3: .*'force': only in callbacks and at the end of a run"
printf 'world { duration = 1 }\nlocal b = sphere { radius = 1 }\non_step(function() b.force = {1, 0, 0} end)\n' >set.lua
exits 65 set.lua --no-record
says err 'apply_force'

# recorded, told by info, plotted
exits 0 info stepped.h5
says out 'columns .* acceleration angular_acceleration force torque'
command -v gnuplot >/dev/null && {
	exits 0 plot stepped.h5 '#1.acceleration' '#1.fz' '#1.torque' '#1.spin' -o p.svg
	exits 64 plot stepped.h5 '#1.power' -o p.svg
}
python3 -c 'import h5py, numpy' 2>/dev/null && python=python3 || python=/usr/bin/python3
"$python" -c 'import h5py, numpy' 2>/dev/null || exit 0
exits 0 mixed.lua --method located -p looks=false -p rate=3000 --duration 0.3 -o fine.h5
"$python" - <<'END' || fail 'what is recorded is not what acts'
import h5py, numpy as np
units = {'acceleration': 'm/s^2', 'angular_acceleration': 'rad/s^2', 'force': 'N', 'torque': 'N m'}
for method in ('located', 'stepped', 'auto'):
    with h5py.File(method + '.h5') as f:
        b = f['/particles/bodies']
        for name, unit in units.items():
            assert b[name + '/value'].attrs['units'] in (unit, unit.encode()), name
            assert b[name + '/value'].shape == b['velocity/value'].shape, name
            assert np.isfinite(b[name + '/value']).all(), name
        free = np.isfinite(b['mass'][:]) & (b['mass'][:] > 0)
        force, a = b['force/value'][:], b['acceleration/value'][:]
        off = np.abs(force[:, free] - b['mass'][:][None, free, None] * a[:, free]).max()
        assert off < 1e-12 * np.abs(force).max(), (method, off)
# between events accelerations are the derivatives of velocities
with h5py.File('fine.h5') as f:
    b, events = f['/particles/bodies'], f['/rbsim/events/time'][:]
    t = b['velocity/time'][:]
    quiet = np.ones(len(t) - 1, bool)
    for k in np.searchsorted(t, events):
        quiet[max(0, k - 2):k + 1] = False
    assert quiet.sum() > 100, quiet.sum()
    for v, a in (('velocity', 'acceleration'), ('angular_velocity', 'angular_acceleration')):
        v, a = b[v + '/value'][:], b[a + '/value'][:]
        rate = np.diff(v, axis=0) / np.diff(t)[:, None, None]
        off = np.linalg.norm(rate - (a[1:] + a[:-1]) / 2, axis=2) / (1 + np.linalg.norm(rate, axis=2))
        assert np.quantile(off[quiet], 0.9) < 1e-6 and off[quiet].max() < 0.001, off[quiet].max()
END
