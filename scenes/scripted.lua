-- A juggler in Lua: a callback watches a ball and throws it up again whenever it comes down to the hand.
-- Watch: the ball is thrown by an impulse in on_step; a second ball is held up by a steady force.
-- Expected end: as many throws as fit into the run, and the floating ball where it was.
-- on_step comes every time_step, with every method; what callbacks must remember they keep in the table `state`.
-- Try: --param throw=3
-- Takes: less than a second.
local throw = param("throw", 5.0, "speed of each throw, m/s", {min = 1, max = 20})
local hand = param("hand", 1.0, "height of the hand, m", {min = 0.5, max = 5})
local g, radius, dt, duration = 9.81, 0.1, 1 / 480, 10

world { title = "Juggling by script", duration = duration, frame_rate = 60, time_step = dt, gravity = {0, 0, -g} }
plane { normal = {0, 0, 1}, texture = "checker" }
local ball = sphere { name = "ball", radius = radius, mass = 0.5, position = {0, 0, hand}, velocity = {0, 0, throw} }
local floating = sphere { name = "floating", radius = radius, mass = 0.5, position = {1, 0, 1} }
camera { name = "main", position = {0.5, -5, 2}, look_at = {0.5, 0, 1.5}, size = {1280, 720} }

-- From where it was thrown the ball rises by throw^2/(2g): height and speed in any frame tell that.
state.throws, state.from, state.off = 0, hand, 0
on_step(function(t)
	floating:apply_force({0, 0, floating.mass * g})
	if ball.position.z <= hand and ball.velocity.z < 0 then
		ball:apply_impulse({0, 0, ball.mass * (throw - ball.velocity.z)})
		state.throws, state.from = state.throws + 1, ball.position.z
	end
end)
on_frame(function(t)
	local apex = ball.position.z + ball.velocity.z ^ 2 / (2 * g)
	state.off = math.max(state.off, math.abs(apex - state.from - throw ^ 2 / (2 * g)))
end)

-- The hand looks once a time_step: a ball comes down a little below it, and starts from there.
local function throws()
	local count, step, height = 0, 0, hand
	while true do
		local flight = (throw + math.sqrt(throw ^ 2 + 2 * g * (height - hand))) / g
		local steps = math.ceil(flight / dt)
		step = step + steps
		if step * dt >= duration then return count end
		count, height = count + 1, height + throw * steps * dt - g * (steps * dt) ^ 2 / 2
	end
end
expect("as many throws as fit", function() return math.abs(state.throws - throws()), 0 end)
expect("each rises by v^2/(2g), m", function() return state.off, 1e-9 end)
expect("the other one floats", function() return math.abs(floating.position.z - 1), 1e-9 end)
