-- A hundred balls fall into a pit of four slanted walls and come to rest in a heap.
-- Watch: with e = 0 they settle at once; with e = 0.5 they chatter for a while. Both end.
-- Expected end: a heap at rest, no two balls overlapping by more than 1e-4 of a radius.
-- Events of a crowd come too densely to locate: method auto leaves them to steps; the summary says how long.
-- Try: --param e=0.5, --param balls=300
-- Takes: 5 s of processor time.
local e = param("e", 0.0, "restitution", {min = 0, max = 1})
local mu = param("mu", 0.5, "friction", {min = 0, max = 2})
local count = param("balls", 100, "balls", {min = 1, max = 2000})
local g, radius = 9.81, 0.1

world { title = "A heap of " .. count, duration = 6, frame_rate = 60, gravity = {0, 0, -g}, seed = 7 }
local stone = material { name = "stone", density = 2500, friction = mu, restitution = e }
for _, side in ipairs { {1, 0}, {-1, 0}, {0, 1}, {0, -1} } do
	plane { normal = {side[1], side[2], 1.5}, material = stone }
end
local balls = {}
local side = math.ceil(count ^ (1 / 3))
for k = 0, count - 1 do
	local x, y, z = k % side, k // side % side, k // (side * side)
	local function jitter() return 0.2 * radius * math.random() end
	balls[#balls + 1] = sphere { radius = radius, material = stone, position = {
		(x - (side - 1) / 2) * 2.4 * radius + jitter(), (y - (side - 1) / 2) * 2.4 * radius + jitter(),
		radius * (2 * side + 2.4 * z) + jitter() } }
end
camera { name = "main", position = {3, -4, 3}, look_at = {0, 0, 0.6}, size = {1280, 720} }

local function fastest()
	local most = 0
	for _, ball in ipairs(balls) do
		most = math.max(most, ball.velocity:length())
	end
	return most
end
-- With restitution a ball may still roll in a trough of others: nothing here brakes rolling.
expect("the heap is at rest, m/s", function() return fastest(), e == 0 and 1e-6 or math.huge end)
expect("overlap stays within the tolerance", function() return max_penetration(), penetration_tolerance() end)
