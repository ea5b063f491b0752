-- A pendulum hangs over a turntable: the table turns beneath it, and the plane of its swing stays where it is.
-- Watch: the ball goes to and fro along one line of the room, while the marks on the table pass below.
-- Expected end: the ball has never left the plane in which it was let go, and its energy is that of the start.
-- To somebody on the table the swing turns, once in a turn of the table: so Foucault showed in 1851 that the earth does.
-- Try: --param turn=60, --param push=0.2 (an ellipse, which then does precess)
-- Takes: less than a second.
local turn = param("turn", 15.0, "of the table, degrees per second", {min = 0, max = 720})
local push = param("push", 0.0, "m/s across the swing, at the start", {min = 0, max = 2})
local L, g, high = 1.5, 9.81, 1.7

world { title = "Foucault's pendulum", duration = 12, frame_rate = 60, gravity = {0, 0, -g} }
local wood = material { name = "wood", density = 700, friction = 0.5, color = {0.62, 0.44, 0.26} }
local omega = deg(turn)
local function turned(t) return {math.cos(omega * t / 2), 0, 0, math.sin(omega * t / 2)} end
local disc = cylinder { name = "table", radius = 0.9, length = 0.06, material = wood, texture = "checker", collides_with = {},
	motion = function(t) return {0, 0, -0.05}, turned(t), {0, 0, 0}, {0, 0, omega} end }
for k = 1, 12 do
	local a = deg(30 * k)
	sphere { name = "mark " .. k, radius = 0.03, material = wood, color = k % 3 == 0 and {0.85, 0.15, 0.1} or {0.95, 0.9, 0.8}, texture = "none",
		collides_with = {}, motion = function(t)
			local x, y = 0.8 * math.cos(a + omega * t), 0.8 * math.sin(a + omega * t)
			return {x, y, 0}, nil, {-omega * y, omega * x, 0}
		end }
end
local ball = sphere { name = "ball", radius = 0.09, mass = 2, color = {0.8, 0.65, 0.2}, texture = "none",
	position = {L * math.sin(0.4), 0, high - L * math.cos(0.4)}, velocity = {0, push, 0} }
joint { name = "wire", kind = "rod", a = ball, b = disc, at_b = {0, 0, high + 0.05}, radius = 0.006 }
camera { name = "main", position = {1.2, -2.6, 1.9}, look_at = {0, 0, 0.6}, trails = {ball}, overlay = {"title", "time"} }

local first, off = nil, 0
on_frame(function()
	first = first or energy()
	off = math.max(off, math.abs(ball.position.y))
end)
expect("the energy is that of the start, J", function() return math.abs(energy() - first), 1e-9 * ball.mass * g * L end)
if push == 0 then
	expect("the ball has not left its plane, m", function() return off, 1e-9 * L end)
end
