-- Eighteen particles on a sphere of 2.5 cm, 1 kg each but the lowest, which has 2: laid on its side the ball rocks.
-- Watch: the heavy point swings through the bottom and up the other side, as far as it began.
-- Expected end: the centre of mass is 2.5 cm / 19 = 0.1316 cm below the middle; no energy has gone.
-- Small swings take 2 pi sqrt((I + m (R - d)^2) / (m g d)), with d the depth of the centre and I the inertia about it.
-- Try: --param tilt=1e-3 (the period is then that of small swings), --param tilt=3
-- Takes: less than a second.
local tilt = param("tilt", 1.5, "rad: how far it is turned at the start", {min = 0, max = 3.1})
local r, g = 0.025, 9.81

local particles = {{mass = 2, position = {0, 0, -r}}, {mass = 1, position = {0, 0, r}}}
for k = 0, 7 do
	for _, z in ipairs { 0.6 * r, -0.6 * r } do
		local angle = k * math.pi / 4
		particles[#particles + 1] = {mass = 1, position = {0.8 * r * math.cos(angle), 0.8 * r * math.sin(angle), z}}
	end
end
world { title = "The lowest weighs twice as much", duration = 3, frame_rate = 60, gravity = {0, 0, -g} }
local rubber = material { name = "rubber", friction = 0.9, restitution = 0 }
plane { normal = {0, 0, 1}, material = rubber, texture = "checker" }
local ball = sphere { name = "ball", radius = r, position = {0, 0, r}, orientation = {axis = {0, 1, 0}, angle = tilt},
	particles = particles, material = rubber }
camera { name = "side", position = {0, -0.3, 0.08}, look_at = {0, 0, r}, size = {1280, 720}, overlay = {"title", "time"} }

local start
on_frame(function() start = start or energy() end)
expect("centre of mass, m below the middle", function() return math.abs(ball.center_of_mass.z + 0.025 / 19), 1e-17 end)
expect("19 kg", function() return math.abs(ball.mass - 19), 1e-13 end)
expect("it rolls: the point below does not slip, m/s", function()
	local q = ball.orientation
	local below = ball.velocity + ball.angular_velocity:cross(vec3(0, 0, -r) - (ball.point(ball.center_of_mass) - ball.position))
	return below:length(), 1e-9
end)
expect("no energy has gone, J", function() return math.abs(energy() - start), 1e-9 end)
local d = 0.025 / 19
local period = 2 * math.pi * math.sqrt((ball.inertia[2][2] + 19 * (r - d) ^ 2) / (19 * g * d))
if tilt <= 1e-3 then
	expect("a small swing, m", function()
		return math.abs(ball.position.x - r * tilt * (math.cos(2 * math.pi * 3 / period) - 1)), r * tilt * tilt
	end)
end
