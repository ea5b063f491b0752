-- The Sun, Jupiter, Saturn, Uranus, Neptune and Pluto for 250 years, in astronomical units, days and masses of the Sun.
-- Watch: Pluto's path, inclined to all others; it comes inside Neptune's, but never near it: they go round 2 to 3.
-- Expected end: Pluto has gone round once; the energy is what it was to 14 digits, and the middle of all has not moved.
-- Places and speeds of 5 September 1994. A frame in a hundred days is for the film: the method chooses its own steps.
-- Try: --param years=10000 (Pluto's next forty rounds, a few seconds)
-- Takes: less than a second.
local years = param("years", 250.0, "how long", {min = 1})
local G, day, year = 2.95912208286e-4, 1, 365.25
world { title = "Outer Solar System", duration = years * year, frame_rate = 0.01 / day, gravitation = {G = G} }
local plain = material { name = "plain", friction = 0 }
-- at rest as a whole: the Sun gets what the planets' momentum lacks
local data = {
	{"Jupiter", 9.54786104043e-4, {-3.5023653, -3.8169847, -1.5507963}, {0.00565429, -0.00412490, -0.00190589}, "#d8a070"},
	{"Saturn", 2.85583733151e-4, {9.0755314, -3.0458353, -1.6483708}, {0.00168318, 0.00483525, 0.00192462}, "#e0c890"},
	{"Uranus", 4.37273164546e-5, {8.3101420, -16.2901086, -7.2521278}, {0.00354178, 0.00137102, 0.00055029}, "#90d0d8"},
	{"Neptune", 5.17759138449e-5, {11.4707666, -25.7294829, -10.8169456}, {0.00288930, 0.00114527, 0.00039677}, "#6080e0"},
	{"Pluto", 1 / 1.3e8, {-15.5387357, -25.2225594, -3.1902382}, {0.00276725, -0.00170702, -0.00136504}, "#c0a8a0"}}
local mass, place, momentum_of = 1.00000597682, vec3(0, 0, 0), vec3(0, 0, 0)
for _, d in ipairs(data) do momentum_of = momentum_of + d[2] * vec3(d[4]) end
-- drawn a thousand times as large as they are
local sun = sphere { name = "Sun", radius = 0.7, mass = mass, position = {0, 0, 0}, velocity = -1 / mass * momentum_of, material = plain,
	collides_with = {}, texture = "none", color = "#ffd040" }
local bodies, planets = {sun}, {}
for i, d in ipairs(data) do
	planets[i] = sphere { name = d[1], radius = i <= 2 and 0.6 or 0.4, mass = d[2], position = d[3], velocity = d[4], material = plain,
		collides_with = {}, texture = "none", color = d[5] }
	bodies[i + 1] = planets[i]
end
camera { name = "above", position = {30, -75, 40}, look_at = {0, 0, -2}, trails = planets, overlay = "title",
	speed = 25 * year, fps = 24, background = {0, 0, 0}, lights = {{kind = "lamp", position = {0, 0, 0}}, {kind = "ambient", intensity = 0.5}} }

local function middle()
	local sum, all = vec3(0, 0, 0), 0
	for _, b in ipairs(bodies) do sum, all = sum + b.mass * b.position, all + b.mass end
	return sum / all
end
local pluto, neptune = planets[5], planets[4]
local first, from, drift, moved, nearest, turned, last = nil, nil, 0, 0, math.huge, 0, nil
on_frame(function()
	first, from = first or energy(), from or middle()
	drift = math.max(drift, math.abs(energy() / first - 1))
	moved = math.max(moved, (middle() - from):length())
	nearest = math.min(nearest, (pluto.position - neptune.position):length())
	local d = pluto.position - sun.position
	local angle = math.atan(d.y, d.x)
	if last then turned = turned + (angle - last + math.pi) % (2 * math.pi) - math.pi end
	last = angle
end)
expect("energy, share", function() return drift, 1e-13 end)
-- coordinates of 50 AU, each rounded by 4e-15
expect("the middle of all stays, AU", function() return moved, 1e-12 end)
-- their paths come within 2 AU of each other
expect("Neptune and Pluto keep apart, AU", function() return 10 - nearest, 0 end)
-- 248 years a round. With an eccentricity of 0.25 it goes up to (1 + e)^2/(1 - e^2)^1.5 = 1.72 times as fast as in the mean, by
-- 1/cos 17 deg more as seen from above: by 0.8 rounds a round more or less, up to 0.17 (twice 2 e and what the incline adds)
local rounds = years / 248
local uneven = math.min(0.17, 0.8 * math.abs(rounds - math.floor(rounds + 0.5)))
expect("Pluto's rounds", function() return math.abs(turned / (2 * math.pi) - rounds), 0.02 + uneven + 0.002 * rounds end)
