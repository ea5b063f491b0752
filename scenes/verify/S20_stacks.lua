-- SPDX-License-Identifier: MIT
-- S20: what is built well stands: a tower of a hundred boxes, a pyramid of twenty rows, an arch of wedges, a house of
-- cards, a row of dominoes. Answer: nothing moves.
local verify = require "rbsim.verify"
local stack = require "rbsim.stack"
local part = param("part", "tower", "what stands there", {choices = {"tower", "pyramid", "arch", "cards", "dominoes"}})

verify.case { title = "Things that stand", duration = 60, gravity = {0, 0, -9.81}, time_step = {1 / 60, 1 / 240, 1},
	frame_rate = {1, 10, 0.3}, quick = "base", length = 4, processor_seconds = 120 }
local mu = ({tower = 0.5, pyramid = 0.5, arch = 0.6, cards = 0.7, dominoes = 0.5})[part]
local stuff = material { name = "stuff", friction = mu, restitution = 0 }
verify.plane { material = stuff }
local blocks = part == "tower" and stack.tower { count = 100, size = {0.5, 0.5, 0.25} }
	or part == "pyramid" and stack.pyramid { rows = 20, size = {0.5, 0.5, 0.25} }
	or part == "arch" and stack.arch { stones = 17, radius = 1, thickness = 0.3, width = 0.5 }
	or part == "cards" and stack.cards { levels = 3, length = 0.4, width = 0.25, thickness = 0.004 }
	or stack.dominoes { count = 15, size = {0.0078125, 0.0234375, 0.046875}, spacing = 0.015625 }
local bodies = stack.bodies(blocks, {material = stuff, density = 700}, "block", verify)

-- Of a union of points the origin is that of the points: what moves is measured at the centre of mass by velocity's
-- integral, the origin's place, and in addition what it has turned.
local height = 0
local start = {}
for i, body in ipairs(bodies) do
	start[i] = {at = verify.position(body), turned = verify.axes(body)}
	height = math.max(height, blocks[i].points and 1.3 or verify.position(body).z)
end
expect_always("displacement over height", function()
	local far = 0
	for i, body in ipairs(bodies) do
		far = verify.larger(far, (verify.position(body) - start[i].at):length())
		far = verify.larger(far, height * (verify.axes(body) - start[i].turned):length())
	end
	return far / height, 1e-6 + verify.rounding
end)
expect("overlap, m", function() return max_penetration(), 1e-6 * height end)
