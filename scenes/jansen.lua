-- Theo Jansen's linkage: one crank turns, and eleven bars carry a foot along a path that is flat below.
-- Watch: each foot goes level and steadily while it would stand on the sand, then lifts, swings forward and comes down.
-- Expected end: after each turn of the crank both feet are where the bars' lengths have them.
-- The lengths are Jansen's "holy numbers" of 1990, bred on a computer: with twelve such legs his beasts walk on the wind.
-- Try: --param speed=-3 (backward), --param turns=3
-- Takes: some seconds.
local speed = param("speed", 3.0, "rad/s of the crank", {min = -10, max = 10})
local turns = param("turns", 1.0, "of the crank", {min = 0.1, max = 10})
local g, unit = 9.81, 0.01
local pivot = vec3(-38, 0, -7.8)

world { method = "stepped", time_step = 2e-3, title = "Jansen's linkage", duration = turns * 2 * math.pi / math.abs(speed), frame_rate = 60,
	gravity = {0, 0, -g} }
material { name = "pipe", density = 600, friction = 0, texture = "none", color = {0.93, 0.85, 0.6} }
-- Where circles about p and q meet, the one that is further along a direction; centimetres.
local function meet(p, rp, q, rq, d)
	local line = q - p
	local length = line:length()
	local along = (length ^ 2 + rp ^ 2 - rq ^ 2) / (2 * length)
	local across = vec3(-line.z, 0, line.x) / length * math.sqrt(rp ^ 2 - along ^ 2)
	local middle = p + line * (along / length)
	return (across:dot(d) > 0) and middle + across or middle - across
end
-- The points of a leg on the left for a crank's angle; of one on the right they are mirrored.
local function leg(angle, side)
	local x = vec3(1, 0, 0)
	local up, left = vec3(0, 0, 1), -1 * x
	local pin = 15 * vec3(side * math.cos(angle), 0, math.sin(angle))
	local at = {pin = pin, pivot = pivot}
	at.top = meet(pin, 50, pivot, 41.5, up)
	at.knee = meet(pin, 61.9, pivot, 39.3, -1 * up)
	at.out = meet(at.top, 55.8, pivot, 40.1, left)
	at.shin = meet(at.out, 39.4, at.knee, 36.7, left)
	at.foot = meet(at.shin, 65.7, at.knee, 49, -1 * up)
	for name, p in pairs(at) do at[name] = unit * vec3(side * p.x, 0, p.z) end
	return at
end
-- How a point moves at the start, m/s.
local function rate(name, side)
	local step = 1e-5
	return (leg(speed * step, side)[name] - leg(-speed * step, side)[name]) / (2 * step)
end
-- Velocity and spin, about y, of what holds two points.
local function motion(at, name, other, side, middle)
	local d, v, w = at[other] - at[name], rate(name, side), rate(other, side)
	local slope = (w - v) / d:dot(d)
	local spin = d.z * slope.x - d.x * slope.z
	local r = middle - at[name]
	return v + spin * vec3(r.z, 0, -r.x), vec3(0, spin, 0)
end
local y = vec3(0, 1, 0)
-- A flat prism over a triangle, about its centroid.
local function plate(name, row, at, side, p, q, r, color)
	local middle, points = (at[p] + at[q] + at[r]) / 3, {}
	for _, v in ipairs {at[p], at[q], at[r]} do
		for _, d in ipairs {-0.012, 0.012} do points[#points + 1] = v - middle + d * y end
	end
	local velocity, spin = motion(at, p, q, side, middle)
	return hull { name = name, points = points, material = "pipe", color = color, position = middle + row * y, velocity = velocity,
		angular_velocity = spin, collides_with = {} }
end
local crank = cylinder { name = "crank", radius = 0.18, length = 0.02, material = "pipe", position = {0, 0, 0}, angular_velocity = {0, -speed, 0},
	orientation = {axis = {1, 0, 0}, angle = deg(90)}, color = {0.45, 0.47, 0.52}, collides_with = {} }
joint { name = "axle", kind = "hinge", a = crank, at = {0, 0, 0}, axis = y, motor = {angle = function(t) return speed * t end, torque = 1e4} }
local feet = {}
for side = -1, 1, 2 do
	local at, row = leg(0, -side), -0.03 * (side + 2)
	local mark = side < 0 and "right" or "left"
	local function bar(p, q, color)
		local d, middle = at[q] - at[p], (at[p] + at[q]) / 2
		local velocity, spin = motion(at, p, q, -side, middle)
		return box { name = ("%s %s to %s"):format(mark, p, q), size = {d:length(), 0.015, 0.025}, material = "pipe", position = middle + row * y,
			orientation = {axis = y, angle = -math.atan(d.z, d.x)}, velocity = velocity, angular_velocity = spin, color = color, collides_with = {} }
	end
	local function pin(a, b, p) joint { kind = "hinge", a = a, b = b, at = at[p] + row * y, axis = y, radius = 0.008 } end
	local upper = plate(mark .. " upper", row, at, -side, "pivot", "top", "out", {0.85, 0.45, 0.2})
	local shin = plate(mark .. " shin", row, at, -side, "knee", "shin", "foot", {0.95, 0.9, 0.75})
	local strut, high = bar("pivot", "knee", {0.3, 0.5, 0.7}), bar("pin", "top", {0.3, 0.5, 0.7})
	local low, link = bar("pin", "knee", {0.3, 0.5, 0.7}), bar("out", "shin", {0.3, 0.5, 0.7})
	pin(upper, nil, "pivot")
	pin(strut, nil, "pivot")
	pin(crank, high, "pin")
	pin(crank, low, "pin")
	pin(high, upper, "top")
	pin(low, shin, "knee")
	pin(strut, shin, "knee")
	pin(upper, link, "out")
	pin(link, shin, "shin")
	local pen = sphere { name = mark .. " foot", radius = 0.02, mass = 0.02, material = "pipe", color = {0.85, 0.1, 0.1}, position = at.foot + row * y,
		velocity = rate("foot", -side), collides_with = {} }
	joint { kind = "fixed", a = shin, b = pen, at = at.foot + row * y }
	feet[#feet + 1] = {pen = pen, side = -side, row = row}
end
camera { name = "front", position = {0, -3.1, 0}, look_at = {0, 0, -0.33}, trails = {feet[1].pen, feet[2].pen}, overlay = {"title", "time"} }

-- What joints may be open by is the tolerance, 1e-6 of half a bar's width; eight in a row, and angles of short sides.
expect_always("both feet are where the bars' lengths have them, m", function()
	local worst = 0
	for _, one in ipairs(feet) do
		worst = math.max(worst, (one.pen.position - leg(speed * time(), one.side).foot - one.row * y):length())
	end
	return worst, 1e-6
end)
