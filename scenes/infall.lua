-- Two spheres at rest, ten radii apart and alone in the world, fall to each other, bounce and come to rest on each other.
-- Watch: the first bounce takes place at 34.6 s; then it is over within four seconds and infinitely many bounces.
-- Expected end: they touch, at rest, and press on each other with G m m/s^2, for as long as one cares to wait.
-- Programs with fixed steps let such spheres sink into each other; here nothing overlaps by more than rounding.
-- Try: --param aside=0.05 (they miss each other's middle, and end as a pair that turns)
-- Takes: less than a second.
local aside = param("aside", 0.0, "speed across the line between them, m/s")
local e = 0.5
world { title = "Infall", duration = 60, frame_rate = 30, gravitation = {G = 1} }
local rubber = material { name = "rubber", friction = 0.5, restitution = e }
local function ball(name, side)
	return sphere { name = name, radius = 0.5, mass = 0.5, position = {5 * side, 0, 0}, velocity = {0, aside * side, 0}, material = rubber }
end
local left, right = ball("left", -1), ball("right", 1)
camera { name = "side", position = {0, -14, 2}, look_at = {0, 0, 0}, overlay = {"title", "time"}, trails = {left, right}, from = 25, to = 45 }

local touches, gap = {}, 0
on_collision(function(c) touches[#touches + 1] = c.time end)
on_frame(function(t)
	if t > 50 then gap = math.max(gap, math.abs((right.position - left.position):length() - 1)) end
end)
expect("touching in the end, m", function() return gap, 1e-14 end)
expect("what is left is one ball in pieces: momentum, kg m/s", function() return momentum():length(), 1e-14 end)
if aside == 0 then
	-- sqrt(D^3/2) (acos q + q sqrt(1 - q^2)), q^2 = s/D
	local q = math.sqrt(0.1)
	local first = math.sqrt(500) * (math.acos(q) + q * math.sqrt(1 - q * q))
	expect("first touch, s", function() return math.abs(touches[1] - first), 1e-12 end)
	expect("second touch, s", function() return math.abs(touches[2] - 36.5277140893896), 1e-12 end)
	expect("energy that is left, J", function() return math.abs(energy() + 0.25), 1e-14 end)
else
	-- the pair turns as one with the angular momentum of the beginning: about its middle, spheres included
	local inertia = 2 * (0.4 * 0.5 * 0.25 + 0.5 * 0.25)
	expect("it turns as one, rad/s", function()
		return math.abs(left.angular_velocity.z - angular_momentum().z / inertia), 1e-6
	end)
end
