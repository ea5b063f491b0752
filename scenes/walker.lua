-- Theo Jansen's beast: twelve of his legs on one shaft walk over flat ground.
-- Watch: three pairs of legs a side, a third of a turn apart: while one stands the others lift, swing and come down. The body glides.
-- Expected end: it has gone by what its feet go back by, 0.22 m for each radian of the shaft, level all the way.
-- jansen.lua shows one pair of legs, and where the lengths are from.
-- Try: --param speed=-3 (the other way), --param mu=0.05 (ice)
-- Takes: half a minute.
local speed = param("speed", 3.0, "rad/s of the shaft", {min = -6, max = 6})
local turns = param("turns", 2.0, "of the shaft, once it has its speed", {min = 0.01, max = 20})
local mu = param("mu", 0.8, "friction of the feet", {min = 0, max = 2})
local g, unit, y, none = 9.81, 0.01, vec3(0, 1, 0), {}
local foot = 0.02 -- m
local start = 1.0 -- s, until the shaft has its speed

world { method = "stepped", time_step = 2e-3, tolerance = 1e-6, title = "Jansen's beast walks", frame_rate = 60, gravity = {0, 0, -g},
	duration = turns * 2 * math.pi / math.abs(speed) + start / 2 }
material { name = "pipe", density = 600, friction = mu, restitution = 0, texture = "none", color = {0.93, 0.85, 0.6} }
plane { name = "sand", material = "pipe", color = {0.8, 0.72, 0.55}, texture = "checker" }
-- Where circles about p and q meet, the one that is further along a direction; centimetres.
local function meet(p, rp, q, rq, d)
	local line = q - p
	local length = line:length()
	local along = (length ^ 2 + rp ^ 2 - rq ^ 2) / (2 * length)
	local across = vec3(-line.z, 0, line.x) / length * math.sqrt(rp ^ 2 - along ^ 2)
	local middle = p + line * (along / length)
	return (across:dot(d) > 0) and middle + across or middle - across
end
-- The points of a leg about the shaft, for the shaft's angle; a leg on the right is one on the left, mirrored.
local function leg(angle, side)
	local up, left, pivot = vec3(0, 0, 1), vec3(-1, 0, 0), vec3(-38, 0, -7.8)
	local at = {pin = 15 * vec3(side * math.cos(angle), 0, math.sin(angle)), pivot = pivot}
	at.top = meet(at.pin, 50, pivot, 41.5, up)
	at.knee = meet(at.pin, 61.9, pivot, 39.3, -1 * up)
	at.out = meet(at.top, 55.8, pivot, 40.1, left)
	at.shin = meet(at.out, 39.4, at.knee, 36.7, left)
	at.foot = meet(at.shin, 65.7, at.knee, 49, -1 * up)
	for name, p in pairs(at) do at[name] = unit * vec3(side * p.x, 0, p.z) end
	return at
end

-- Six rows of legs across the body; the lowest feet begin on the ground.
local rows, low = {}, 0
for i = 0, 5 do
	local phase = i % 3 * 2 * math.pi / 3
	rows[i + 1] = {y = (i < 3 and -0.4 or 0.4) + 0.1 * (i % 3 - 1), phase = phase}
	low = math.min(low, leg(phase, 1).foot.z, leg(phase, -1).foot.z)
end
local hub = vec3(0, 0, foot - low)
local body = box { name = "body", size = {0.8, 0.6, 0.03}, material = "pipe", mass = 6, position = hub + unit * vec3(0, 0, -7.8), collides_with = none }
local shaft = cylinder { name = "shaft", radius = 0.02, length = 1.1, mass = 1, material = "pipe", position = hub, color = {0.45, 0.47, 0.52},
	orientation = {axis = {1, 0, 0}, angle = deg(90)}, collides_with = none }
-- The angle of a shaft that comes to its speed evenly.
local function angle(t)
	return t < start and speed * t ^ 2 / (2 * start) or speed * (t - start / 2)
end
joint { name = "axle", kind = "hinge", a = shaft, b = body, at = hub, axis = y, motor = {angle = angle, torque = 1e4} }
for i, row in ipairs(rows) do
	for side = -1, 1, 2 do
		local at, mark = leg(row.phase, side), ("%d %s"):format(i, side < 0 and "right" or "left")
		for name, p in pairs(at) do at[name] = hub + row.y * y + p end
		-- A flat prism over a triangle.
		local function plate(p, q, r, color)
			local middle, points = (at[p] + at[q] + at[r]) / 3, {}
			for _, v in ipairs {at[p], at[q], at[r]} do
				for _, d in ipairs {-0.012, 0.012} do points[#points + 1] = v - middle + d * y end
			end
			return hull { name = mark .. " " .. q, points = points, material = "pipe", color = color, position = middle, collides_with = none }
		end
		local function bar(p, q)
			local d = at[q] - at[p]
			return box { name = ("%s %s to %s"):format(mark, p, q), size = {d:length(), 0.015, 0.025}, material = "pipe", color = {0.3, 0.5, 0.7},
				position = (at[p] + at[q]) / 2, orientation = {axis = y, angle = -math.atan(d.z, d.x)}, collides_with = none }
		end
		local function pin(a, b, p) joint { kind = "hinge", a = a, b = b, at = at[p], axis = y, radius = 0.008 } end
		local upper, shin = plate("pivot", "top", "out", {0.85, 0.45, 0.2}), plate("knee", "shin", "foot", {0.95, 0.9, 0.75})
		local strut, high, under, link = bar("pivot", "knee"), bar("pin", "top"), bar("pin", "knee"), bar("out", "shin")
		pin(upper, body, "pivot")
		pin(strut, body, "pivot")
		pin(shaft, high, "pin")
		pin(shaft, under, "pin")
		pin(high, upper, "top")
		pin(under, shin, "knee")
		pin(strut, shin, "knee")
		pin(upper, link, "out")
		pin(link, shin, "shin")
		local toe = sphere { name = mark .. " foot", radius = foot, mass = 0.02, material = "pipe", color = {0.85, 0.1, 0.1}, position = at.foot }
		joint { kind = "fixed", a = shin, b = toe, at = at.foot }
	end
end
camera { name = "side", position = {0.4, -3.6, 1.3}, look_at = {-0.9, 0, 0.55}, trails = {body}, overlay = {"title", "time"} }

local height = body.position.z
expect_always("it goes level: height of the body off that of the start, m", function() return math.abs(body.position.z - height), 5e-3 end)
expect_always("it stays upright: sine of its tilt", function()
	local q = body.orientation
	return 2 * math.sqrt(q[2] ^ 2 + q[3] ^ 2), 0.01
end)
if mu >= 0.3 then
	expect("metres for each radian of the shaft, off 0.22", function()
		return math.abs(-body.position.x / angle(time()) - 0.22), 0.05
	end)
end
