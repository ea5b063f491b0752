-- A ball rolls along a table, over its edge, and falls to the floor.
-- Watch: it tips round the edge, leaves it, and lands beyond the table with the spin it rolled with.
-- Expected end: on the floor, rolling on at 5/7 of slip and speed combined, beyond where a point would land.
-- A finite plane has a rim that collides; below walking pace the ball rolls round it before it leaves.
-- Try: --param speed=0.3
-- Takes: less than a second.
local speed = param("speed", 1.5, "m/s", {min = 0.05, max = 10})
local g, radius, height = 9.81, 0.1, 1

world { title = "Over the edge", duration = math.max(2, math.ceil(1 / speed) + 2), frame_rate = 60, gravity = {0, 0, -g} }
local wood = material { name = "wood", density = 700, friction = 0.5, restitution = 0 }
plane { name = "table", normal = {0, 0, 1}, point = {0, 0, height}, size = {2, 1}, material = wood }
plane { name = "floor", normal = {0, 0, 1}, material = wood, texture = "checker" }
local ball = sphere { name = "ball", radius = radius, material = wood, position = {0, 0, height + radius},
	velocity = {speed, 0, 0}, angular_velocity = {0, speed / radius, 0} }
camera { name = "side", position = {1.5, -4, 1.2}, look_at = ball, size = {1280, 720} }

on_collision(function(c)
	if not state.landed and (c.a.name == "floor" or c.b.name == "floor") then
		state.landed = c.time
	end
end)

-- Faster than sqrt(g R) it leaves the edge at once and flies sqrt(2 h/g).
if speed >= math.sqrt(g * radius) then
	expect("it lands after its flight", function()
		if not state.landed then return false end
		return math.abs(state.landed - 1 / speed - math.sqrt(2 * height / g)), 1e-9
	end)
	expect("it rolls on at the speed it came with", function() return math.abs(ball.velocity.x - speed), 1e-9 end)
end
expect("it lies on the floor", function() return math.abs(ball.position.z - radius), 1e-9 end)
expect("energy is not gained", function() return energy() <= ball.mass * (0.7 * speed ^ 2 + g * (height + radius)) * (1 + 1e-9) end)
