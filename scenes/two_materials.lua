-- Two pucks of one kind slide over a floor of two materials: felt on the left, ice on the right.
-- Watch: on felt the ball rolls soon; on ice it slides much further before it does.
-- Expected end: both at 5/7 v0 while the one on ice is ahead by the difference of their slides.
-- The table of contact pairs says what ball and floor do together; `rbsim check` prints it.
-- Try: --param ice=0.01
-- Takes: less than a second.
local ice_mu = param("ice", 0.05, "friction of ball on ice", {min = 0.01, max = 1})
local felt_mu = param("felt", 0.4, "friction of ball on felt", {min = 0.01, max = 1})
local g, radius, v0, duration = 9.81, 0.05, 2, 3

world { title = "Two materials", duration = duration, frame_rate = 60, gravity = {0, 0, -g} }
local ball_skin = material { name = "ball", density = 1200, restitution = 0 }
local felt = material { name = "felt", color = {0.1, 0.5, 0.2} }
local ice = material { name = "ice", color = {0.8, 0.9, 1} }
contact_pair(ball_skin, felt, { friction = felt_mu })
contact_pair(ball_skin, ice, { friction = ice_mu, restitution = 0.1 })

plane { name = "felt floor", normal = {0, 0, 1}, point = {5, 1, 0}, size = {20, 2}, material = felt }
plane { name = "ice floor", normal = {0, 0, 1}, point = {5, -1, 0}, size = {20, 2}, material = ice }
local on_felt = sphere { name = "on felt", radius = radius, position = {0, 1, radius}, velocity = {v0, 0, 0},
	material = ball_skin }
local on_ice = sphere { name = "on ice", radius = radius, position = {0, -1, radius}, velocity = {v0, 0, 0},
	material = ball_skin }
camera { name = "main", position = {3, -6, 3}, look_at = {3, 0, 0}, size = {1280, 720} }

local function exact(mu, t)
	local s = math.min(t, 2 * v0 / (7 * mu * g))
	local v = v0 - mu * g * s
	return v0 * s - mu * g * s * s / 2 + (t - s) * v, v
end
for ball, mu in pairs { [on_felt] = felt_mu, [on_ice] = ice_mu } do
	expect(ball.name .. ": speed", function()
		local _, v = exact(mu, duration)
		return math.abs(ball.velocity.x - v), 1e-9
	end)
	expect(ball.name .. ": place", function()
		return math.abs(ball.position.x - exact(mu, duration)), 1e-9
	end)
end
