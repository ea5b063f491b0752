#!/bin/sh
# SPDX-License-Identifier: MIT
# Whatever a function of the scene does for 1/250 of the run is seen wherever it falls, and however few frames there are. Located, the
# pieces of bodies that a field accelerates stepped over it, and those of driven bodies and motors where frames were few.
. tests/cli/functions

cat >force.lua <<'END'
local of = param("of", "ball", "what is acted on", {choices = {"ball", "box", "resting", "rough", "lifted", "stack", "slider"}})
local shape = param("shape", "square", "of the pulse", {choices = {"square", "ramp", "gauss", "bump"}})
local at, width = param("at", 5.0, "s: its beginning"), param("width", 0.04, "s")
local bound = param("bound", 1e-6, "share")
local weighs = of ~= "ball" and of ~= "box" and of ~= "slider"
world { duration = 10, frame_rate = param("rate", 60.0, "1/s"), time_step = 0.002, gravity = {0, 0, weighs and -10 or 0} }
local size = of == "lifted" and 30 or of == "rough" and 8 or 1

local shapes = {
	square = {1, function() return 1 end},
	ramp = {1 / 2, function(u) return u end},
	gauss = {math.sqrt(2 * math.pi) / 12, function(u) return math.exp(-72 * (u - 0.5) ^ 2) end},
	-- its integral over -1 to 1 is 0.44399381616807943782
	bump = {0.44399381616807943782 / 2, function(u) return math.exp(-1 / (4 * u * (1 - u))) end},
}
local share, form = shapes[shape][1], shapes[shape][2]
local function force(t)
	local u = (t - at) / width
	return u > 0 and u < 1 and size * form(u) or 0
end

local ice = material { friction = 0, restitution = 0 }
local own = of == "rough" and material { friction = 0.5, restitution = 0 } or ice
local body
if of == "ball" then
	body = sphere { radius = 0.1, mass = 1, position = {0, 0, 0}, material = own }
else
	body = box { size = {0.2, 0.2, 0.2}, mass = 1, position = {0, 0, 0.1}, material = own }
end
if weighs then plane { material = own } end
local got, wanted = function() return body.velocity.x end, size * share * width
if of == "stack" then
	local lid = box { size = {0.2, 0.2, 0.2}, mass = 1, position = {0, 0, 0.3}, material = ice }
	got = function() return lid.velocity.x end
elseif of == "slider" then
	joint { kind = "slider", a = body, at = {0, 0, 0.1}, axis = {1, 0, 0} }
elseif of == "rough" then
	-- a square one: it slides at 8 - 5 = 3 m/s^2, and then comes to rest at 5 m/s^2
	got, wanted = function() return body.position.x end, 1.5 * width ^ 2 * (1 + 3 / 5)
elseif of == "lifted" then
	-- a square one: it falls back from 10 w^2 + (20 w)^2 / 20
	local last = 0
	on_collision(function(c) last = c.approach_speed end)
	got, wanted = function() return last end, math.sqrt(20 * 30 * width ^ 2)
end
field(function(t) return of == "lifted" and {0, 0, force(t)} or {force(t), 0, 0} end)
expect("seen", function() return math.abs(got() / wanted - 1), bound end)
END
for of in ball box resting stack slider; do
	for shape in $(tried square ramp gauss bump); do
		exits 0 force.lua --no-record --method located -p of=$of -p shape=$shape -p at=3.6067
		exits 0 force.lua --no-record --method located -p of=$of -p shape=$shape -p at=8.2 -p width=0.3 -p rate=0.1
	done
done
for of in ball box resting rough lifted stack slider; do
	for at in $(tried 0.71 3.6067 8.2); do
		exits 0 force.lua --no-record --method located -p of=$of -p at=$at -p rate=1.0
	done
	# no reason for `auto` to take steps
	exits 0 force.lua --no-record --json --quiet -p of=$of
	[ "$(value stepped)" = 0 ] || fail "$of: stepped $(value stepped) s"
	# by steps, what lasts for longer than one
	exits 0 force.lua --no-record --method stepped -p of=$of -p bound=0.2
done

# What acts in a small space is a pulse for what flies through.
cat >sheet.lua <<'END'
world { duration = 10, frame_rate = 60, gravity = {0, 0, 0} }
local ball = sphere { radius = 1, mass = 1, position = {param("from", -5.0), 0, 0}, velocity = {1, 0, 0} }
field(function(_, x) return {x.x > 0 and x.x < 0.04 and 1 or 0, 0, 0} end)
expect("seen", function() return math.abs(ball.velocity.x / math.sqrt(1 + 2 * 0.04) - 1), 1e-9 end)
END
for from in $(tried -1.7 -4.02 -8.13); do
	exits 0 sheet.lua --no-record --method located -p from=$from
done

cat >motion.lua <<'END'
local by = param("by", "motion", "what has the pulse", {choices = {"motion", "poses", "motor", "angles"}})
local at, width = param("at", 5.0, "s: its beginning"), param("width", 0.04, "s")
local bound = param("bound", 1e-6, "share")
world { duration = 10, frame_rate = param("rate", 60.0, "1/s"), time_step = 0.002, gravity = {0, 0, 0} }
local ice = material { friction = 0, restitution = 0 }
if by == "motion" or by == "poses" then
	-- it comes out by 0.1 m and goes back; the ball leaves it where it is fastest
	local w = math.pi / width
	box { size = {0.2, 0.2, 0.2}, material = ice, motion = function(t)
		local s = t - at
		if s <= 0 or s >= width then return {0, 0, 0}, nil, by == "motion" and {0, 0, 0} or nil end
		return {0.1 * math.sin(w * s) ^ 2, 0, 0}, nil, by == "motion" and {0.1 * w * math.sin(2 * w * s), 0, 0} or nil
	end }
	local ball = sphere { radius = 0.1, mass = 1, position = {0.25, 0, 0}, material = ice }
	expect("seen", function() return math.abs(ball.velocity.x / (0.1 * w) - 1), bound end)
else
	-- turned by 0.5 rad and back; the ball is struck
	local b = box { size = {0.2, 0.2, 0.2}, position = {0, 0, 0}, mass = 1, material = ice }
	joint { kind = "hinge", a = b, at = {0, 0, 0}, axis = {0, 0, 1}, motor = {torque = 1e5, angle = function(t)
		local s = (t - at - width / 2) * 4 / width
		local angle = 0.5 * math.exp(-s * s)
		return angle, by == "motor" and -8 * s / width * angle or nil
	end} }
	local ball = sphere { radius = 0.02, mass = 0.001, position = {0.13, 0.02, 0}, material = ice }
	expect("seen", function() return ball.velocity:length() > 0.05 / width end)
end
END
for by in motion poses motor angles; do
	for rate in 60.0 1.0 0.1; do
		for at in $(tried 0.71 3.6067 8.2); do
			exits 0 motion.lua --no-record --method located -p by=$by -p rate=$rate -p at=$at
		done
	done
	for rate in 60.0 0.1; do
		exits 0 motion.lua --no-record --method stepped -p by=$by -p rate=$rate -p at=3.6067 -p bound=0.2
	done
done
