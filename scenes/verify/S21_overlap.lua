-- SPDX-License-Identifier: MIT
-- S21: bodies that overlap at the start. Answer: the scene is refused before the first step, with both bodies and the depth.
local verify = require "rbsim.verify"
local kind = param("kind", "pair", "what overlaps", {choices = {"pair", "pyramid", "coincident", "plane"}})
local radius = 0.1

verify.case { title = "Overlap at the start", duration = 1, time_step = {0.01, 1e-4, 1}, frame_rate = {1, 10, 60}, quick = "all" }
verify.sphere { name = "one", radius = radius, position = {0, 0, 0.25} }
if kind == "pair" then
	verify.sphere { name = "two", radius = radius, position = {radius, 0, 0.25} }
	expect_refused(65, "'two'.*'one'.*0%.1 m")
elseif kind == "coincident" then
	verify.sphere { name = "two", radius = radius, position = {0, 0, 0.25} }
	expect_refused(65, "'two'.*'one'.*0%.2 m")
elseif kind == "plane" then
	verify.plane { name = "floor", point = {0, 0, 0.2} }
	expect_refused(65, "'floor'.*'one'.*0%.05 m")
else
	-- a quarter of the diameter deep, layer above layer
	local step = 2 * radius * 0.75
	for i = 0, 2 do
		for j = 0, 2 - i do
			verify.sphere { name = "p" .. i .. j, radius = radius, position = {2 + step * (j + i / 2), 0, step * i * math.sqrt(3) / 2} }
		end
	end
	expect_refused(65, "'p01'.*'p00'.*0%.05 m")
end
