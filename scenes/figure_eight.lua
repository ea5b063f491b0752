-- Three equal masses chase each other round one figure eight, under nothing but their gravitation.
-- Watch: the trails: all three draw the same curve, a third of a turn apart.
-- Expected end: after ten turns the first is back, 1e-12 from where an integration with 30 digits has it.
-- Moore found the orbit in 1993, Chenciner and Montgomery proved it in 2000. It is stable, but hardly anything in the sky is on one.
-- Try: --param push=0.01 (one begins a little faster: the eight turns and breathes, but does not fall apart)
-- Takes: less than a second.
local push = param("push", 0.0, "change of the third one's speed, share")
local turn = 6.32591398
world { title = "Figure eight", duration = 10 * turn, frame_rate = 30, gravitation = {G = 1} }
local light = material { name = "light", friction = 0 }
local x, v = vec3(0.97000436, -0.24308753, 0), vec3(-0.93240737, -0.86473146, 0)
local function star(name, position, velocity)
	return sphere { name = name, radius = 0.05, mass = 1, position = position, velocity = velocity, material = light }
end
local first = star("first", x, -0.5 * v)
local second = star("second", -1 * x, -0.5 * v)
local third = star("third", {0, 0, 0}, (1 + push) * v)
camera { name = "above", position = {0, 0, 3.4}, up = {0, 1, 0}, trails = {first, second, third}, overlay = {"title", "time"}, to = 3 * turn }

if push == 0 then
	expect("back after ten turns, m", function()
		return (first.position - vec3(0.97000421375646, -0.24308766531606, 0)):length(), 1e-12
	end)
end
local start, drift = nil, 0
on_frame(function()
	start = start or energy()
	drift = math.max(drift, math.abs(energy() / start - 1))
end)
expect("energy, share", function() return drift, 1e-13 end)
expect("they never met", function() return collisions(), 0 end)
