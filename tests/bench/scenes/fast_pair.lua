-- A thousand slow balls that meet nobody, and a fast pair that rattles between two plates in a channel of its own.
-- Watch: only the pair ever needs smaller steps; who pays for them is what --rollback decides.
-- What it is for: body-steps and time with --rollback selective and global.
local count = param("balls", 1000, "slow balls", {min = 1, max = 100000})
local speed = param("speed", 5, "of the pair, m/s", {min = 0.1, max = 10})
local radius, spacing = 0.05, 0.3

world { title = "One fast pair among " .. count, duration = 5, frame_rate = 60, seed = 2 }
local hard = material { name = "hard", friction = 0, restitution = 1 }
local side = math.ceil(count ^ (1 / 3))
for k = 0, count - 1 do
	local function drift() return 0.01 * (2 * math.random() - 1) end
	sphere { radius = radius, material = hard, velocity = {drift(), drift(), drift()},
		position = {spacing * (k % side), spacing * (k // side % side), spacing * (k // (side * side))} }
end
for _, x in ipairs { -0.5, 0.5 } do
	plane { normal = {1, 0, 0}, point = {x, -1, 0}, size = {0.4, 0.4}, material = hard }
end
local left = sphere { name = "left", radius = radius, material = hard, position = {-0.2, -1, 0}, velocity = {speed, 0, 0} }
local right = sphere { name = "right", radius = radius, material = hard, position = {0.2, -1, 0}, velocity = {-speed, 0, 0} }

expect("the pair goes on rattling", function()
	return left.velocity:length() >= 0.999999 * speed and right.velocity:length() >= 0.999999 * speed
end)
