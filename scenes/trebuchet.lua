-- A trebuchet: a heavy weight falls, a long arm swings up, and a sling lets its stone go.
-- Watch: the sling trails the arm, then whips over it; it opens when the stone flies up at 45 degrees.
-- Expected end: the stone is far away, and joints and sling have made no energy.
-- The whip is the art: when the stone flies, weight and arm should stand nearly still.
-- Try: --param weight=200, --param open=60
-- Takes: a second.
local weight = param("weight", 400.0, "kg, that falls", {min = 50, max = 5000})
local open = deg(param("open", 45.0, "angle above the horizontal at which the stone is let go, degrees", {min = 5, max = 85}))
local g, long, short, sling, pivot = 9.81, 4, 1, 3.2, 3

world { title = "A trebuchet", duration = 6, frame_rate = 60, gravity = {0, 0, -g} }
material { name = "wood", density = 600, friction = 0, restitution = 0, color = {0.6, 0.42, 0.24}, texture = "none" }
plane { name = "ground", material = "wood", color = {0.5, 0.55, 0.4}, texture = "checker", collides_with = {"stones"} }
-- The arm begins with its long end low, on the left.
local tilt = math.asin((pivot - 0.4) / long)
local along = vec3(-math.cos(tilt), 0, -math.sin(tilt))
local hub = vec3(0, 0, pivot)
local arm = box { name = "arm", size = {long + short, 0.12, 0.16}, material = "wood", position = hub + (long - short) / 2 * along,
	orientation = {axis = {0, 1, 0}, angle = -tilt}, collides_with = {} }
local block = box { name = "weight", size = {0.6, 0.6, 0.6}, mass = weight, material = "wood", color = {0.3, 0.3, 0.32},
	position = hub - short * along - vec3(0, 0, 0.5), collides_with = {} }
local tip = hub + long * along
local stone = sphere { name = "stone", radius = 0.12, mass = 4, material = "wood", group = "stones", color = {0.4, 0.4, 0.4},
	position = {tip.x + sling * 0.98, 0, 0.13} }
joint { name = "axle", kind = "hinge", a = arm, at = hub, axis = {0, 1, 0} }
joint { name = "hook", kind = "hinge", a = arm, b = block, at = hub - short * along, axis = {0, 1, 0} }
local rope = joint { name = "sling", kind = "rope", a = arm, b = stone, at_a = {-(long + short) / 2, 0, 0}, length = sling }
-- What holds the axle, to be seen.
for _, y in ipairs {-0.35, 0.35} do
	for _, x in ipairs {-0.9, 0.9} do
		local d = vec3(x, 0, -pivot)
		box { static = true, size = {d:length(), 0.1, 0.1}, material = "wood", position = hub + d / 2 + vec3(0, y, 0),
			orientation = {axis = {0, 1, 0}, angle = -math.atan(d.z, d.x)}, collides_with = {} }
	end
end
camera { name = "side", position = {3, -13, 4}, look_at = {3, 0, 4}, trails = {stone}, overlay = {"title", "time"} }
camera { name = "far", position = {42, -80, 16}, look_at = {42, 0, 17}, trails = {stone}, overlay = {"title", "time"} }

state.flies = false
on_step(function()
	local v = stone.velocity
	if not state.flies and v.x > 0 and v.z > 0 and math.atan(v.z, v.x) <= open and stone.position.z > pivot then
		rope:release()
		state.flies = true
	end
end)
local first = nil
on_frame(function() first = first or energy() end)
expect_always("energy is never made, J", function() return energy() - (first or energy()), 1e-9 * weight * g * short end)
expect("the stone flies", function() return state.flies end)
