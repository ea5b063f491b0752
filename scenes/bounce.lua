-- A ball is dropped from 2 m and bounces until it lies still.
-- Watch: each apex is e^2 of the one before; the bounces crowd together and end.
-- Expected end: at rest on the floor after sqrt(2h/g) (1+e)/(1-e), 5.6 s for e = 0.8.
-- Its impacts are located to rounding; bounds are those of the classic method: C*dt, C beside each.
-- Try: rbsim scenes/bounce.lua --param e=0.5, or --method classic --time-step 0.001
local e = param("e", 0.8, "restitution of the ball", {min = 0, max = 0.9})
local g, h, radius, dt = 9.81, 1.9, 0.1, 1 / 960

world    { title = "A bouncing ball", duration = 10, frame_rate = 60, time_step = dt, gravity = {0, 0, -g} }
local rubber = material { name = "rubber", density = 1100, friction = 0.6, restitution = e }

plane    { normal = {0, 0, 1}, material = rubber, texture = "checker" }
local ball = sphere { name = "ball", radius = radius, position = {0, 0, 2}, material = rubber }

camera   { name = "main", position = {1.5, -4, 1.2}, look_at = {0, 0, 0.9}, size = {1280, 720},
           overlay = {"title", "time", "energy"}, trails = {ball}, video = "bounce.mp4" }

-- Apexes and the end of the bouncing, as seen frame by frame.
state.apex, state.bounces, state.last = 0, 0, 0
on_collision(function(c)
	state.bounces = state.bounces + 1
	state.last = c.time
end)
on_frame(function(t)
	if state.bounces == 1 then
		state.apex = math.max(state.apex, ball.position.z - radius)
	end
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

-- In classic steps the fall is g t^2/2 + g t dt/2: impact speed off by g dt/2, so the apex by e^2 (h + v dt) at most.
-- A frame sees it within g/2 (1/120)^2: located, that is all that is left.
expect("first apex is e^2 h", function()
	return math.abs(state.apex - e ^ 2 * h), 2 * e ^ 2 * math.sqrt(2 * g * h) * dt + g / 2 / 120 ^ 2
end)
-- A flight in classic steps is dt shorter and lands g dt slower. The k-th of about K = ln(v/(g dt))/ln(1/e) bounces has
-- lost g dt (1 + e + e^2 + ...), at most g dt/(1-e), hence 2 dt/(1-e) of its time; what is slower than g dt is not
-- reflected any more, which cuts 2 dt/(1-e) at the end. Located, the last impact counted is the one whose rebound would
-- stay within rounding of the radius; on_transition tells of the end itself, to rounding (scenes/verify/S03_zeno.lua).
expect("bounces end at sqrt(2h/g) (1+e)/(1-e)", function()
	local v = math.sqrt(2 * g * h)
	local count = e > 0 and math.log(v / (g * dt)) / math.log(1 / e) or 0
	return math.abs(state.last - v / g * (1 + e) / (1 - e)), 2 * (count + 1) / (1 - e) * dt + dt
end)
expect("the ball stays above the floor", function() return ball.position.z >= radius - 1e-9 end)
expect("the ball lies still", function() return ball.velocity.z ^ 2, 1e-12 end)
