-- Four bars and four pins make a nearly straight line out of a circle: Hoecken's linkage.
-- Watch: the crank turns evenly; the coupler's end draws a long straight stroke, and returns in a quick arc.
-- Expected end: the end of the coupler is where the closed form has it.
-- Half of a turn is spent on the line, at nearly one speed: that is why it carries walkers' feet and conveyors.
-- Try: --param coupler=2.2, --param turns=2
-- Takes: less than a second.
local long = param("coupler", 2.5, "length of coupler and rocker, cranks", {min = 2.01, max = 6})
local turns = param("turns", 2.0, "turns of the crank", {min = 0.1, max = 10})
local r, omega, g = 0.2, math.pi, 9.81
local pivot = vec3(2 * r, 0, 0)

world { method = "stepped", time_step = 5e-4, title = "Four bars, one straight line", duration = turns * 2 * math.pi / omega, frame_rate = 60,
	gravity = {0, 0, -g} }
material { name = "steel", density = 7800, friction = 0, texture = "none", shininess = 60 }

-- Where crank pin, rocker pin and the coupler's end are, in the plane of y = 0: two circles meet in the rocker pin.
local function places(t)
	local a = r * vec3(math.cos(omega * t), 0, math.sin(omega * t))
	local d = pivot - a
	local half = d:length() / 2
	local across = vec3(-d.z, 0, d.x):unit()
	local b = a + d / 2 + math.sqrt((long * r) ^ 2 - half ^ 2) * across
	return a, b, 2 * b - a
end
-- A bar between two points that move as functions of time, in the plane at y.
local function bar(name, y, color, from, to)
	local p, q = from(0), to(0)
	local d, step = q - p, 1e-5
	local function rate(f) return (f(step) - f(-step)) / (2 * step) end
	local slope = (rate(to) - rate(from)) / d:length()
	local along = d:unit()
	return box { name = name, size = {d:length() + 0.04, 0.02, 0.04}, material = "steel", color = color, position = (p + q) / 2 + vec3(0, y, 0),
		orientation = {axis = {0, 1, 0}, angle = -math.atan(d.z, d.x)}, velocity = (rate(from) + rate(to)) / 2,
		angular_velocity = {0, along.z * slope.x - along.x * slope.z, 0}, collides_with = {} }
end
local function at(n) return function(t) return (select(n, places(t))) end end
local crank = bar("crank", 0, {0.8, 0.35, 0.2}, function() return vec3(0, 0, 0) end, at(1))
local coupler = bar("coupler", -0.03, {0.9, 0.7, 0.2}, at(1), at(3))
local rocker = bar("rocker", 0, {0.3, 0.5, 0.7}, function() return pivot end, at(2))
local pen = sphere { name = "pen", radius = 0.03, mass = 0.05, position = at(3)(0) + vec3(0, -0.03, 0), color = {0.9, 0.1, 0.1}, texture = "none",
	velocity = (at(3)(1e-5) - at(3)(-1e-5)) / 2e-5, collides_with = {} }
local y = vec3(0, 1, 0)
joint { name = "axle", kind = "hinge", a = crank, at = {0, 0, 0}, axis = y, motor = {angle = function(t) return omega * t end, torque = 1e4} }
joint { name = "crank pin", kind = "hinge", a = crank, b = coupler, at = at(1)(0), axis = y }
joint { name = "rocker pin", kind = "hinge", a = coupler, b = rocker, at = at(2)(0), axis = y }
joint { name = "ground pin", kind = "hinge", a = rocker, at = pivot, axis = y }
joint { name = "nail", kind = "fixed", a = coupler, b = pen, at = at(3)(0) }
record { fields = {"+", "joints"} }
camera { name = "front", position = {0.3, -2.6, 0.5}, look_at = {0.25, 0, 0.42}, trails = {pen}, overlay = {"title", "time"} }

-- What joints may be open by in steps is the tolerance: three in a row, the coupler twice as long as its pins are apart.
expect_always("the end of the coupler is where the closed form has it, m", function()
	return (pen.position - at(3)(time()) - vec3(0, -0.03, 0)):length(), 1e-6
end)
