-- Three solid balls turn and fly freely: what their mass, size, speed and spin come to.
-- Watch: nothing; the numbers are below.
-- Expected end: 0.0285 kg m^2/s, 47.5 kg m^2, 225.0225 J, as at the start.
-- A solid ball has 2/5 m r^2 about any axis through its middle, not the m r^2 of a single particle at its rim.
-- Try: --duration 100
-- Takes: less than a second.
world { title = "Solid spheres", duration = 1, frame_rate = 60 }
local small = sphere { name = "small", radius = 0.025, mass = 19, position = {-4, 0, 0}, angular_velocity = {0, 0, 6} }
local large = sphere { name = "large", radius = 2.5, mass = 19, angular_velocity = {0, 1, 0} }
local fast = sphere { name = "fast", radius = 0.025, mass = 18, position = {4, 0, 0}, velocity = {0, 0, 5}, angular_velocity = {0, 3, 1} }
camera { name = "side", position = {0, -14, 3}, look_at = {0, 0, 1}, size = {1280, 720}, overlay = {"title", "time"} }

local spin_alone = vec3(0, 0, 0.4 * 19 * 0.025 ^ 2 * 6)
expect("angular momentum, 19 kg, 2.5 cm, 6 rad/s: 0.0285 kg m^2/s", function()
	return (small.angular_momentum - spin_alone):length() + math.abs(spin_alone.z - 0.0285), 1e-15
end)
expect("moment of inertia, 19 kg, 2.5 m: 47.5 kg m^2", function() return math.abs(large.inertia[1][1] - 47.5), 1e-13 end)
expect("kinetic energy, 18 kg, 2.5 cm, 5 m/s, (0, 3, 1) rad/s: 225.0225 J", function()
	return math.abs(fast.kinetic_energy - 225.0225), 1e-12
end)
