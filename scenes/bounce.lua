-- A ball is dropped from 2 m and bounces until it lies still.
-- Watch: each apex is e^2 of the one before; the bounces crowd together and end.
-- Expected end: at rest on the floor after sqrt(2h/g) (1+e)/(1-e), 5.6 s for e = 0.8.
-- Its impacts and its end are located: the time step has no part in them, and bounds are those of rounding.
-- Try: rbsim scenes/bounce.lua --param e=0.5, or --method classic to see what steps of 1/960 s make of it
-- Takes: 20 s of processor time, less than a second without its film.
local e = param("e", 0.8, "restitution of the ball", {min = 0, max = 0.9})
local g, h, radius, dt = 9.81, 1.9, 0.1, 1 / 960
local ending = math.sqrt(2 * h / g) * (1 + e) / (1 - e)

world    { title = "A bouncing ball", duration = math.max(10, math.ceil(ending + 1)), frame_rate = 60, time_step = dt, gravity = {0, 0, -g} }
local rubber = material { name = "rubber", density = 1100, friction = 0.6, restitution = e }

plane    { normal = {0, 0, 1}, material = rubber, texture = "checker" }
local ball = sphere { name = "ball", radius = radius, position = {0, 0, 2}, material = rubber }

camera   { name = "main", position = {1.5, -4, 1.2}, look_at = {0, 0, 0.9}, size = {1280, 720},
           overlay = {"title", "time", "energy"}, trails = {ball}, video = "bounce.mp4" }

-- The first apex, from height and speed in any frame of that flight, and the end of the bouncing.
state.bounces, state.apex, state.rest = 0, 0, 0
on_collision(function(c) state.bounces, state.rest = state.bounces + 1, c.time end)
on_transition(function(c)
	if c.kind == "rest" then state.rest = c.time end
end)
on_frame(function()
	if state.bounces == 1 then state.apex = ball.position.z - radius + ball.velocity.z ^ 2 / (2 * g) end
end)

-- The exact motion: a fall, then flights that begin with e, e^2, ... of the first impact's speed, until they end.
reference(function(t)
	local fall = math.sqrt(2 * h / g)
	local function at(height, speed)
		return { ball = { position = vec3(0, 0, radius + height), velocity = vec3(0, 0, speed),
			angular_velocity = vec3(0, 0, 0) } }
	end
	if t < fall then
		return at(h - g * t * t / 2, -g * t)
	end
	local s, u = t - fall, e * g * fall
	while u / g > 1e-17 do
		if s < 2 * u / g then
			return at(u * s - g * s * s / 2, u - g * s)
		end
		s, u = s - 2 * u / g, e * u
	end
	return at(0, 0)
end)

expect("first apex is e^2 h, m", function() return math.abs(state.apex - e ^ 2 * h), 1e-9 end)
expect("bounces end at sqrt(2h/g) (1+e)/(1-e), s", function() return math.abs(state.rest - ending), 1e-9 end)
expect("the ball stays above the floor", function() return ball.position.z >= radius - 1e-9 end)
expect("the ball lies still, m/s", function() return ball.velocity:length(), 1e-12 end)
