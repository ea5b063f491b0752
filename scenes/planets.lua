-- The Sun, Jupiter and Saturn for sixty years, in SI units: metres, kilograms, seconds.
-- Watch: the Sun goes round, too: by a little more than its own radius, in Jupiter's twelve years.
-- Expected end: each planet is on its ellipse but for what the other one pulls, and the centre of mass has not moved.
-- What is called gravitation = {} here holds for a heap of gravel as well: sizes do not matter, and there is no time step to choose.
-- Try: --param moon=true (a test body at Jupiter's side, 1e6 km away, goes round it every 16.7 days)
-- Takes: less than a second.
local moon = param("moon", false, "a moon, too")
local AU, day, year, G = 1.495978707e11, 86400, 365.25 * 86400, 6.67430e-11
world { title = "Two planets", duration = 60 * year, frame_rate = 24 / year, gravitation = {} }
local gas = material { name = "gas", friction = 0 }
local function planet(name, radius, mass, x, v)
	return sphere { name = name, radius = radius, mass = mass, position = AU * vec3(x), velocity = AU / day * vec3(v), material = gas }
end
local sun = planet("Sun", 6.957e8, 1.98847e30, {0, 0, 0}, {0, 0, 0})
local jupiter = planet("Jupiter", 6.9911e7, 1.89813e27, {-3.5023653, -3.8169847, -1.5507963}, {0.00565429, -0.00412490, -0.00190589})
local saturn = planet("Saturn", 5.8232e7, 5.68319e26, {9.0755314, -3.0458353, -1.6483708}, {0.00168318, 0.00483525, 0.00192462})
local callisto
if moon then
	local r = 1e9
	callisto = sphere { name = "moon", radius = 2.4e6, mass = 1e23, gravitational_mass = 0, material = gas,
		position = jupiter.position + vec3(0, 0, r), velocity = jupiter.velocity + vec3(math.sqrt(G * jupiter.mass / r), 0, 0) }
end
camera { name = "above", trails = {jupiter, saturn}, overlay = {"title", "time", "scale"}, units = {length = "AU", time = "yr"}, speed = 2 * year, background = {0, 0, 0} }

local bodies = {sun, jupiter, saturn}
local function centre()
	local sum, mass = vec3(0, 0, 0), 0
	for _, b in ipairs(bodies) do sum, mass = sum + b.mass * b.position, mass + b.mass end
	return sum / mass
end
-- axis of the ellipse on which the planet would be from now on without the other one, m
local function axis(b)
	local d, v = b.position - sun.position, b.velocity - sun.velocity
	return 1 / (2 / d:length() - v:dot(v) / (G * (sun.mass + b.mass)))
end
local from, drift, total, near, axes, bound = nil, 0, 0, 0, 0, 0
on_frame(function(t)
	from = from or {centre = centre(), momentum = momentum() / (sun.mass + jupiter.mass + saturn.mass), energy = energy(),
		axis = {axis(jupiter), axis(saturn)}}
	local c = centre() - (from.centre + t * from.momentum)
	drift = math.max(drift, c:length() / AU)
	total = math.max(total, math.abs(energy() / from.energy - 1))
	axes = math.max(axes, math.abs(axis(jupiter) / from.axis[1] - 1), math.abs(axis(saturn) / from.axis[2] - 1))
	if moon then bound = math.max(bound, (callisto.position - jupiter.position):length()) end
end)
if not moon then
	expect("energy, share", function() return total, 1e-13 end)
	expect("centre of mass goes straight on, AU", function() return drift, 1e-13 end)
end
-- by the mass of the other one, 1e-3 of the Sun's, times what is between them
expect("axes of the ellipses, share", function() return axes, 0.02 end)
expect("the moon stays, m", function() return bound, 1.2e9 end)
