-- SPDX-License-Identifier: MIT
-- J10: impacts that go through joints. Two bars joined by a hinge, of which one is hit by a ball. Answer: the four equations of
-- momentum and of the hinge. Newton's cradle of ten balls on strings, which touch: as many go as come, with their speed. A
-- chain that falls on a table: what moves only loses energy.
local verify = require "rbsim.verify"
local way = param("way", "bars", "what is hit", {choices = {"bars", "cradle", "chain"}})
local g = way == "bars" and 0 or 9.81

verify.case { title = "Impacts through joints", duration = way == "chain" and 0.6 or 1, time_step = {0.05, 0.01, 0.2}, frame_rate = {20, 1, 7},
	gravity = {0, 0, -g}, method = "located", quick = "base" }
local e = way == "cradle" and 1 or 0.5
local stuff = material { name = "stuff", friction = way == "chain" and 0.3 or 0, restitution = e }
if way == "bars" then
	local L, mass, inertia, ball, a, speed = 1, 2, 0.17, 0.7, 0.4, 3
	local keys = {size = {L, 0.2, 0.2}, mass = mass, inertia = {inertia, inertia, inertia}, material = stuff}
	local one = verify.box(keys)
	keys.position = {L, 0, 0}
	local two = verify.box(keys)
	local hit = verify.sphere { radius = 0.1, mass = ball, position = {L + a, 0, 0.5}, velocity = {0, 0, -speed}, material = stuff }
	verify.joint { kind = "hinge", a = one, b = two, at = {L / 2, 0, 0}, axis = {0, 1, 0} }
	-- With P the ball's impulse and H P the hinge's on the first bar, along z: the hinge's ends move alike.
	local H = (1 / mass - a * L / (2 * inertia)) / (2 * (1 / mass + L * L / (4 * inertia)))
	local yields = (1 - H) / mass + a * (a + L / 2 * H) / inertia
	local P = (1 + e) * speed / (yields + 1 / ball)
	local t = 0.3 / speed
	expect("the ball, m/s", function() return (verify.velocity(hit) - vec3(0, 0, P / ball - speed)):length(), 1e-13 + 64 * verify.rounding end)
	expect("sum of momenta, kg m/s", function()
		return (mass * (verify.velocity(one) + verify.velocity(two)) - vec3(0, 0, -P)):length(), 1e-12 + 64 * verify.rounding
	end)
	local after
	on_frame(function(now) if now > t + 0.01 and not after then after = energy() end end)
	expect("energy, J", function()
		return math.abs(after - (ball * speed ^ 2 / 2 - P * speed * (1 - e) / 2)), 1e-12
	end)
elseif way == "cradle" then
	local r, length, n = 0.05, 1, 10
	local balls = {}
	for k = 1, n do
		local angle = k <= 3 and 0.4 or 0
		local top = vec3(2 * r * k, 0, length)
		balls[k] = verify.sphere { radius = r, mass = 1, material = stuff, position = top + length * vec3(-math.sin(angle), 0, -math.cos(angle)) }
		verify.joint { kind = "rod", a = balls[k], at_b = top }
	end
	-- three at rest behind, three with the speed of the fall in front: at the first moment after the impact
	local hits = 0
	on_collision(function() hits = hits + 1 end)
	local first, lost, middle = nil, 0, 0
	on_frame(function(t)
		first = first or energy()
		lost = verify.larger(lost, math.abs(energy() - first) / g)
		for k = 4, 7 do middle = verify.larger(middle, verify.velocity(balls[k]):length()) end
	end)
	expect("they hit", function() return hits > 0 end)
	expect("energy, of 1 kg by 1 m", function() return lost, 1e-12 + 64 * verify.rounding end)
	expect("the four in the middle, m/s", function() return middle, 1e-7 end)
else
	verify.plane { material = stuff }
	local before
	for k = 1, 8 do
		local link = verify.sphere { radius = 0.05, mass = 0.2, material = stuff, position = {0.03 * k, 0.01 * k * k, 0.2 + 0.15 * k} }
		if before then verify.joint { kind = "rod", a = before, b = link } end
		before = link
	end
	local last, rise, hits = math.huge, 0, 0
	on_collision(function() hits = hits + 1 end)
	on_frame(function()
		local now = energy()
		rise = verify.larger(rise, now - last)
		last = now
	end)
	expect("energy gained between two frames, J", function() return math.max(rise, 0), 1e-11 end)
	expect("it has hit", function() return hits > 0 end)
end
