-- A ball is thrown flat onto the floor: it slides, friction spins it up, and it rolls.
-- Watch: speed falls in a straight line to 5/7 of the start, then stays.
-- Expected end: v = 5/7 v0, spin v/R, after 2 v0/(7 mu g) of sliding.
-- With spin w0 at the start the end is (5 v0 + 2 R w0)/7.
-- Try: --param spin=-100 (backspin strong enough to come back)
-- Takes: less than a second.
local v0 = param("speed", 5.0, "m/s", {min = 0.1, max = 20})
local w0 = param("spin", 0.0, "about y, rad/s", {min = -400, max = 400})
local mu = param("mu", 0.3, "friction", {min = 0.05, max = 1})
local g, radius = 9.81, 0.1
local duration = math.max(3, math.ceil(2 * math.abs(v0 - radius * w0) / (7 * mu * g)))

world { title = "Slide to roll", duration = duration, frame_rate = 60, gravity = {0, 0, -g} }
local felt = material { name = "felt", friction = mu }
plane { normal = {0, 0, 1}, material = felt, texture = "checker" }
local ball = sphere { name = "ball", radius = radius, position = {0, 0, radius}, velocity = {v0, 0, 0},
	angular_velocity = {0, w0, 0}, material = felt }
camera { name = "side", position = {6, -8, 2}, look_at = ball, size = {1280, 720} }

-- The state at time t: slip s = v0 - R w0 is used up at 7/2 mu g.
local function exact(t)
	local slip = v0 - radius * w0
	local sign = slip > 0 and 1 or -1
	local stop = 2 * math.abs(slip) / (7 * mu * g)
	local s = math.min(t, stop)
	local v = v0 - sign * mu * g * s
	local spin = w0 + sign * 5 / 2 * mu * g * s / radius
	return v0 * s - sign * mu * g * s * s / 2 + math.max(0, t - stop) * v, v, spin
end
reference(function(t)
	local x, v, spin = exact(t)
	return { ball = { position = vec3(x, 0, radius), velocity = vec3(v, 0, 0), angular_velocity = vec3(0, spin, 0) } }
end)
expect("it rolls at (5 v0 + 2 R w0)/7", function()
	return math.abs(ball.velocity.x - (5 * v0 + 2 * radius * w0) / 7), 1e-9
end)
expect("spin is v/R", function() return math.abs(ball.angular_velocity.y - ball.velocity.x / radius), 1e-9 / radius end)
expect("it is where it should be", function() return math.abs(ball.position.x - exact(duration)), 1e-9 end)
expect("it stays on its line", function() return math.abs(ball.position.y), 1e-12 end)
