-- Newton's cradle as it stands on desks: five balls, each on two strings, and the first let go from aside.
-- Watch: one falls, one leaves; the three in the middle hang still between, to the eye and nearly in truth.
-- Expected end: impacts and rods have made no energy and taken none.
-- Two strings a ball keep it in the plane of the swing; a rod for each is what a string is while it is taut.
-- Try: --param moving=2, --param e=0.8
-- Takes: less than a second.
local moving = param("moving", 1, "balls that are let go", {min = 1, max = 4})
local e = param("e", 1.0, "restitution", {min = 0, max = 1})
local count, radius, height, spread, lift = 5, 0.05, 0.5, 0.3, deg(40)
local g = 9.81

world { title = "Newton's cradle on strings", duration = 3, frame_rate = 60, gravity = {0, 0, -g} }
local steel = material { name = "steel", density = 7800, friction = 0, restitution = e, color = {0.7, 0.71, 0.74}, shininess = 90 }
local balls = {}
for k = 1, count do
	local top = vec3((k - 3) * 2 * radius, 0, height)
	local turn = k <= moving and -lift or 0
	balls[k] = sphere { name = "ball " .. k, radius = radius, material = steel, texture = "none",
		position = top + height * vec3(math.sin(turn), 0, -math.cos(turn)) }
	for side = -1, 1, 2 do
		joint { kind = "rod", a = balls[k], at_b = top + side * spread * vec3(0, 1, 0), radius = 0.003, color = {0.3, 0.3, 0.3} }
	end
end
-- the frame, which nothing touches
local wood = material { name = "wood", color = {0.45, 0.3, 0.18} }
local function part(name, size, at)
	box { name = name, size = size, position = at, static = true, collides_with = {}, material = wood }
end
local long, thick = 2 * count * radius + 0.2, 0.02
part("plate", {long + 0.1, 2 * spread + 0.1, thick}, {0, 0, -0.15})
for side = -1, 1, 2 do
	part("rail " .. side, {long, thick, thick}, {0, side * spread, height + thick / 2})
	for along = -1, 1, 2 do
		part("leg " .. side .. along, {thick, thick, height + 0.15}, {along * (long - thick) / 2, side * spread, (height - 0.15) / 2})
	end
end
camera { name = "main", position = {0.8, -1.7, 0.75}, look_at = {0, 0, 0.18}, overlay = {"title", "time"} }

local first = nil
on_frame(function() first = first or energy() end)
local scale = moving * balls[1].mass * g * height * (1 - math.cos(lift))
expect_always("energy is never made, J", function() return energy() - (first or energy()), 1e-9 * scale end)
if e == 1 then
	expect("energy is kept, J", function() return math.abs(energy() - first), 1e-9 * scale end)
	expect("the balls have clicked", function() return collisions() >= 4 end)
end
expect("all stay in the plane of the swing, m", function()
	local most = 0
	for _, ball in ipairs(balls) do most = math.max(most, math.abs(ball.position.y)) end
	return most, 1e-9
end)
