-- SPDX-License-Identifier: MIT
-- G13: two rubble piles, which have come together from clouds of grains first, meet head on (by steps). Answer: at half of the
-- speed with which they could just part for ever they become one body, at twice that speed they do not; no frame shows an
-- overlap beyond the tolerance, and momentum stays to rounding, also where a tree sums the attraction.
--
-- What a collision leaves depends on what its grains lose: with a restitution of 0.5 and friction of 0.5 one body of 0.999 of the
-- mass remains at twice the escape speed.
local verify = require "rbsim.verify"
local rubble = require "rubble"
local count = param("grains", 12, "of each pile", {choices = {12, 1000}})
local speed = param("speed", 0.5, "in mutual escape speeds", {choices = {0.5, 2.0}})
local angle = param("opening_angle", 0.5, "of the tree, for 2000 grains", {choices = {0.5, 0.0}})
-- mass and radius of each pile are about 1
local radius = (0.6 / count) ^ (1 / 3)
local settled, after = 4, count >= 1000 and 8 or 4

verify.case { title = "Two rubble piles", duration = settled + after, time_step = {5e-3}, frame_rate = {10},
	gravitation = {G = 1, opening_angle = angle}, method = "stepped", quick = "base", processor_seconds = 3600, turns = {0},
	leave_out = {shift = "momentum is measured to rounding", turn = "chaotic", time_step = "chaotic", harmless = "chaotic",
		frame_rate = "the piles are set off at a frame", zero_field = "chaotic"} }
local stone = material { name = "stone", friction = 0, restitution = 0.8 }
-- so far apart that neither feels the other's tide
local piles, all = {}, {}
for side = 1, 2 do
	piles[side] = rubble.cloud { name = side == 1 and "left" or "right", count = count, radius = radius, spacing = 2.1 * radius,
		centre = {side == 1 and -20 or 20, 0, 0}, mass = 1 / count, material = stone }
	for _, g in ipairs(piles[side]) do all[#all + 1] = g end
end

-- Puts both near each other, without what is left of their motion, at `speed` times that of escape from there.
local function set_off()
	local total, apart = {}, 2 * radius
	for side = 1, 2 do
		total[side] = rubble.total(piles[side])
		apart = apart + 1.05 * total[side].radius
	end
	local own = speed * math.sqrt(2 * (total[1].mass + total[2].mass) / apart)
	for side = 1, 2 do
		local sign = side == 1 and -1 or 1
		for _, g in ipairs(piles[side]) do
			g:set_position(g.position - total[side].centre + vec3(sign * apart / 2, 0, 0))
			g:set_velocity(g.velocity - total[side].velocity + vec3(-sign * own / 2, 0, 0))
		end
	end
end
local deepest, first, scale, drift = 0, nil, 0, 0
on_frame(function(t)
	deepest = verify.larger(deepest, max_penetration())
	if not state.gone and t >= settled then
		state.gone = true
		set_off()
	elseif state.gone then
		if not first then first, scale = momentum(), rubble.momentum_scale(all) end
		drift = verify.larger(drift, (momentum() - first):length() / scale)
	end
end)
-- tolerance: 1e-4 of the smallest radius
expect("overlap in any frame, m", function() return deepest, 1e-4 * radius end)
expect("momentum, of the sum of |m v| as they meet", function() return drift, 1e-12 end)
local function largest() return #rubble.clumps(all, 2.4 * radius)[1] / #all end
if speed < 1 then
	expect("not in the one body, share", function() return 1 - largest(), 0.01 end)
elseif count >= 1000 then
	expect("the largest body, share", function() return largest(), 0.99 end)
end
result("largest body", largest)
result("bodies of a hundredth and more", function()
	local n = 0
	for _, clump in ipairs(rubble.clumps(all, 2.4 * radius)) do n = n + (#clump >= #all / 100 and 1 or 0) end
	return n
end)
