-- SPDX-License-Identifier: MIT
-- J14: a leg of Jansen's linkage, whose crank is turned at 3 rad/s. Answer: at every moment its points are where the bars'
-- lengths have them, where circles meet; after a turn they are back.
local verify = require "rbsim.verify"
local speed, unit, y = 3, 0.01, vec3(0, 1, 0)

verify.case { title = "Jansen's linkage", duration = 2 * math.pi / speed, time_step = {0.05, 0.01, 0.2}, frame_rate = {10, 1, 7},
	gravity = {0, 0, -9.81}, method = "located", quick = "none" }
local pivot = vec3(-38, 0, -7.8)
-- Where circles about p and q meet, the one that is further along a direction; centimetres.
local function meet(p, rp, q, rq, d)
	local line = q - p
	local length = line:length()
	local along = (length ^ 2 + rp ^ 2 - rq ^ 2) / (2 * length)
	local across = vec3(-line.z, 0, line.x) / length * math.sqrt(rp ^ 2 - along ^ 2)
	local middle = p + line * (along / length)
	return (across:dot(d) > 0) and middle + across or middle - across
end
local up, left = vec3(0, 0, 1), vec3(-1, 0, 0)
local function leg(angle)
	local at = {pin = 15 * vec3(math.cos(angle), 0, math.sin(angle)), pivot = pivot}
	at.top = meet(at.pin, 50, pivot, 41.5, up)
	at.knee = meet(at.pin, 61.9, pivot, 39.3, -1 * up)
	at.out = meet(at.top, 55.8, pivot, 40.1, left)
	at.shin = meet(at.out, 39.4, at.knee, 36.7, left)
	at.foot = meet(at.shin, 65.7, at.knee, 49, -1 * up)
	for name, p in pairs(at) do at[name] = unit * p end
	return at
end
local at = leg(0)
-- How points move at the start, m/s: central differences of two widths, of which h^2 is taken out.
local function rate(name)
	local h = 1e-3
	local near = (leg(speed * h)[name] - leg(-speed * h)[name]) / (2 * h)
	local far = (leg(2 * speed * h)[name] - leg(-2 * speed * h)[name]) / (4 * h)
	return (4 * near - far) / 3
end
-- Velocity of a middle and spin about y of what holds two points.
local function motion(name, other, middle)
	local d, v, w = at[other] - at[name], rate(name), rate(other)
	local slope = (w - v) / d:dot(d)
	local spin = d.z * slope.x - d.x * slope.z
	local r = middle - at[name]
	return v + spin * vec3(r.z, 0, -r.x), vec3(0, spin, 0)
end
local function link(...)
	local names = {...}
	local middle = vec3(0, 0, 0)
	for _, name in ipairs(names) do middle = middle + at[name] / #names end
	local velocity, spin = motion(names[1], names[2], middle)
	return verify.sphere { radius = 0.01, mass = 0.1 * #names, inertia = {1e-3, 1e-3, 1e-3}, position = middle, velocity = velocity,
		angular_velocity = spin, collides_with = {} }
end
local function pin(a, b, name) verify.joint { kind = "hinge", a = a, b = b, at = at[name], axis = y } end
local crank = verify.sphere { radius = 0.05, mass = 1, inertia = {0.01, 0.01, 0.01}, angular_velocity = {0, -speed, 0}, collides_with = {} }
local base = verify.sphere { radius = 0.01, static = true, collides_with = {} }
verify.joint { kind = "hinge", a = base, b = crank, at = {0, 0, 0}, axis = -1 * y, motor = {angle = function(t) return speed * t, speed end, torque = 1e4} }
local upper, shin = link("pivot", "top", "out"), link("knee", "shin", "foot")
local strut, high, low, bar = link("pivot", "knee"), link("pin", "top"), link("pin", "knee"), link("out", "shin")
pin(upper, nil, "pivot")
pin(strut, nil, "pivot")
pin(crank, high, "pin")
pin(crank, low, "pin")
pin(high, upper, "top")
pin(low, strut, "knee")
pin(strut, shin, "knee")
pin(upper, bar, "out")
pin(bar, shin, "shin")
local function off()
	local now, miss = leg(speed * time()), 0
	for body, names in pairs {[upper] = {"pivot", "top", "out"}, [shin] = {"knee", "shin", "foot"}, [strut] = {"pivot", "knee"},
		[high] = {"pin", "top"}, [low] = {"pin", "knee"}, [bar] = {"out", "shin"}} do
		local middle = vec3(0, 0, 0)
		for _, name in ipairs(names) do middle = middle + now[name] / #names end
		miss = verify.larger(miss, (verify.position(body) - middle):length())
	end
	return miss
end
expect_always("centres of its links, m", function() return off(), 1e-12 + 256 * verify.rounding end)
