-- A box of three unequal edges is thrown up, spinning about its middle axis and a little beside.
-- Watch: every 6.45 s it turns over, end for end, though nothing touches it (the tennis racket, Dzhanibekov's nut).
-- Expected end: back in the hand, after a whole period of that: the spin stands in the box as at the start.
-- The period is that of Jacobi's elliptic functions for its moments, 2.5, 5 and 6.5 kg m^2, and the default wobble.
-- Try: --param wobble=0.1
-- Takes: less than a second.
local wobble = param("wobble", 0.01, "spin about the other two axes, rad/s", {min = 1e-6, max = 1})
local period, g = 12.9012460037936, 9.81
local inertia, spin = {2.5, 5, 6.5}, vec3(wobble, 5, wobble)

world { title = "Tennis racket", duration = period, gravity = {0, 0, -g} }
plane { normal = {0, 0, 1}, point = {0, 0, -2}, texture = "checker" }
-- it flies through floor and hand: it collides with nothing
local box = box { name = "racket", size = {3, 2, 1}, mass = 6, velocity = {0, 0, g * period / 2}, angular_velocity = spin,
	collides_with = {} }
camera { name = "main", mount = box, level = true, offset = {0, -12, 4}, look_at = box, size = {720, 720} }

-- The spin along the axes of the box.
local function inside()
	local origin, w = box.point({0, 0, 0}), box.angular_velocity
	return vec3(w:dot(box.point({1, 0, 0}) - origin), w:dot(box.point({0, 1, 0}) - origin), w:dot(box.point({0, 0, 1}) - origin))
end

local momentum = vec3(inertia[1] * spin.x, inertia[2] * spin.y, inertia[3] * spin.z)
expect_always("energy of the spin is kept", function()
	local energy = box.kinetic_energy - box.mass * box.velocity:dot(box.velocity) / 2
	return math.abs(2 * energy / momentum:dot(spin) - 1), 1e-12
end)
expect_always("angular momentum is kept", function() return (box.angular_momentum - momentum):length() / momentum:length(), 1e-12 end)

local flips, side = 0, 1
expect_always("its spin about the middle axis is no more than its momentum allows", function()
	local along = inside().y / spin.y
	if side * along < -0.9 then
		side, flips = -side, flips + 1
	end
	return math.abs(along), momentum:length() / (inertia[2] * spin.y) + 1e-12
end)
if wobble == 0.01 then
	expect("it has turned over, and back", function() return flips == 2 end)
	expect("after a period the spin is as it was", function() return (inside() - spin):length() / spin:length(), 1e-9 end)
end
