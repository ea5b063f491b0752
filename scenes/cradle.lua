-- Newton's cradle without strings: a row of touching balls, some of which come flying.
-- Watch: as many leave at the other end as came in, at the speed they came with.
-- Expected end: the row at rest, the last `moving` balls at v0.
-- The balls touch exactly, so all contacts are met at the same moment; the impact is passed on in rounds.
-- Try: --param moving=2, --param e=0.9
-- Takes: less than a second.
local count = param("balls", 5, "in the row", {min = 2, max = 50})
local moving = param("moving", 1, "balls that come flying", {min = 1, max = 10})
local e = param("e", 1.0, "restitution", {min = 0, max = 1})
local radius, v0 = 0.5, 2

world { title = "Newton's cradle", duration = 2, frame_rate = 60 }
local steel = material { name = "steel", density = 7800, friction = 0, restitution = e }
local balls = {}
for k = 1, count do
	local flying = k <= moving
	balls[k] = sphere { name = "ball " .. k, radius = radius, material = steel,
		position = {(k - moving - 1) * 2 * radius - (flying and 1 or 0), 0, 0},
		velocity = {flying and v0 or 0, 0, 0} }
end
camera { name = "side", position = {2, -8, 1}, look_at = {2, 0, 0}, size = {1280, 720} }

expect("momentum is kept", function()
	return math.abs(momentum().x / (moving * balls[1].mass * v0) - 1), 1e-13
end)
if e == 1 then
	expect("energy is kept", function()
		return math.abs(energy() / (moving * balls[1].mass * v0 ^ 2 / 2) - 1), 1e-13
	end)
	-- exact but for rounding: equal masses exchange their velocities
	expect("as many leave as came", function()
		local worst = 0
		for k, ball in ipairs(balls) do
			local v = k > count - moving and v0 or 0
			worst = math.max(worst, math.abs(ball.velocity.x - v))
		end
		return worst, 1e-12
	end)
end
