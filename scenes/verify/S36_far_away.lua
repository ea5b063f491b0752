-- SPDX-License-Identifier: MIT
-- S36: a case at the origin and a copy of it far away, in one scene, at coordinates that both places can hold. Answer: they
-- agree to 4 ulp of the offset times the condition of the case, with the same events.
local verify = require "rbsim.verify"
local part = param("part", "bounce", "S02, S03, or S16 of spheres or boxes", {choices = {"bounce", "zeno", "stack", "boxes"}})
local offset = param("offset", 2.0 ^ 20, "m", {choices = {2.0 ^ 20, 2.0 ^ 14, 2.0 ^ 27}})
local g, radius, h = 9.8125, 0.125, 4.875
local e = ({bounce = 1, zeno = 0.8, stack = 0, boxes = 0})[part]
local fall = math.sqrt(2 * h / g)
local rest = fall * (1 + e) / (1 - e)

-- An oblique rotation would round the inputs of the two copies differently.
verify.case { title = "Far from the origin", duration = ({bounce = 2000 * fall, zeno = rest + 1, stack = 100, boxes = 100})[part],
	gravity = {0, 0, -g}, time_step = {0.01, 1e-3, 0.1}, frame_rate = {1, 10, 0.7}, quick = "base", turns = {0, 1},
	leave_out = {shift = "the offset is the case's own"} }
local stuff = material { name = "stuff", friction = part == "bounce" and 0 or 0.5, restitution = e }

-- The two copies do not see each other: the far floor, infinite, would swallow the near ball.
local copies = {near = vec3(0, 0, 0), far = vec3(offset, -offset / 2, offset)}
local seen, bodies = state, {} -- `state`: it must outlive a checkpoint
for name, place in pairs(copies) do
	local keys = {group = name, collides_with = name, material = stuff}
	local function with(more)
		for key, value in pairs(keys) do more[key] = value end
		return more
	end
	verify.plane(with { name = name .. "_floor", point = place })
	if part == "boxes" then
		bodies[name] = {verify.box(with { name = name, size = {1, 1, 1}, mass = 1, position = place + vec3(0, 0, 0.5) }),
			verify.box(with { name = name .. "_heavy", size = {1, 1, 1}, mass = 1e4, position = place + vec3(0, 0, 1.5) })}
	elseif part == "stack" then
		bodies[name] = {verify.sphere(with { name = name, radius = 0.5, mass = 1, position = place + vec3(0, 0, 0.5) }),
			verify.sphere(with { name = name .. "_heavy", radius = 0.5, mass = 1e4, position = place + vec3(0, 0, 1.5) })}
	else
		bodies[name] = {verify.sphere(with { name = name, radius = radius, position = place + vec3(0, 0, radius + h) })}
	end
	seen[name] = {}
end

on_collision(function(c)
	local list = seen[c.a.name] or seen[c.b.name]
	list[#list + 1] = c.time
end)
on_transition(function(c)
	if c.kind == "rest" then
		local list = seen[c.a.name] or seen[c.b.name]
		if list then list.rest = list.rest or c.time end
	end
end)

local bar = 4 * verify.ulp(offset)
local function apart(k) return (verify.position(bodies.far[k]) - copies.far - verify.position(bodies.near[k])):length() end
expect("the same number of impacts", function() return math.abs(#seen.near - #seen.far), 0 end)
if part == "bounce" then
	-- Impact k is at (2k - 1) fall: a height that is rounded by d moves it by (2k - 1) fall d/(2h).
	expect("times of impact, m of drop height", function()
		local worst = 0
		for k, t in ipairs(seen.near) do
			worst = verify.larger(worst, math.abs((seen.far[k] or 0 / 0) - t) / ((2 * k - 1) * fall / (2 * h)))
		end
		return worst, bar
	end)
	expect("the near one bounces a thousand times", function() return math.abs(#seen.near - 1000), 0 end)
elseif part == "zeno" then
	expect("time of rest, m of drop height", function()
		return math.abs((seen.far.rest or 0 / 0) - (seen.near.rest or 0 / 0)) / (rest / (2 * h)), bar
	end)
	expect("it lies as high, m", function() return apart(1), bar end)
else
	expect_always("they stand alike, m", function() return verify.larger(apart(1), apart(2)), bar end)
	expect_always("the near ones do not sink, m", function()
		local z = bodies.near
		return verify.larger(math.abs(verify.position(z[1]).z - 0.5), math.abs(verify.position(z[2]).z - 1.5)), 1e-9
	end)
end
