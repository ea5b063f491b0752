-- SPDX-License-Identifier: MIT
-- shots: fast spheres, each at a thin target of its own, in random directions; what the verify cases of tunnelling share.
--
--   local shots = require "shots"
--   shots.fire { count = 500, speed = 1e4, restitution = 0.5, thick = 1e-3, material = steel,
--                target = function(centre, normal) ... end }
--
--   fire { … }   throws `count` spheres of 1 mm from 40 m away at targets on a grid of 256 m, each of which target(centre,
--                normal) makes, half a metre wide and `thick` (0) along its normal; and expects that every one is reflected
--                once, at its time. Directions that graze are thrown again: hitting within the target is then sure, and the
--                time of impact is not worse than its coordinates by more than a factor of ten.

local check = require "rbsim.check"
local verify = require "rbsim.verify"
local shots = {}

local function direction()
	while true do
		local d = vec3(2 * math.random() - 1, 2 * math.random() - 1, 2 * math.random() - 1)
		if d:length() <= 1 and d:length() > 0.1 then return d:unit() end
	end
end

local function expect_reflections(shot, o)
	expect("none goes through", function()
		local through = 0
		for _, s in ipairs(shot) do
			local before = -s.d:dot(s.normal)
			local after = (verify.position(s.body) - s.centre):dot(s.normal)
			if before * after <= 0 or s.hits ~= 1 then through = through + 1 end
		end
		return through, 0
	end)
	-- A coordinate of up to 4e3 m is rounded by 5e-13 m, ten times that along the way of the flattest.
	expect("every impact is in time, s", function()
		local late = 0
		for _, s in ipairs(shot) do late = verify.larger(late, s.late or 0 / 0) end
		return late, 1e-13 + 10 * verify.rounding / o.speed
	end)
	expect("every one is reflected, relative", function()
		local worst = 0
		for _, s in ipairs(shot) do
			local v = s.d - (1 + o.restitution) * s.d:dot(s.normal) * s.normal
			worst = verify.larger(worst, (verify.velocity(s.body) / o.speed - v):length())
		end
		return worst, 1e-12
	end)
end

function shots.fire(o)
	check.options("shots.fire", o, {count = "number", target = "function", speed = "number", restitution = "number"},
		{thick = "number", material = "any"})
	local radius, away, side = 1e-3, 40, 256
	local across, shot, place = math.ceil(math.sqrt(o.count)), {}, {}
	for i = 1, o.count do
		local centre = vec3(((i - 1) % across - across / 2) * side, ((i - 1) // across - across / 2) * side, 0)
		local normal, d = direction(), direction()
		while math.abs(d:dot(normal)) < 0.1 do d = direction() end
		o.target(centre, normal)
		shot[i] = {d = d, normal = normal, centre = centre,
			time = (away - (radius + (o.thick or 0) / 2) / math.abs(d:dot(normal))) / o.speed,
			body = verify.sphere { name = "s" .. i, radius = radius, position = centre - away * d, velocity = o.speed * d,
				material = o.material } }
		place["s" .. i] = i
	end
	on_collision(function(c)
		local s = shot[place[c.a.name] or place[c.b.name]]
		s.hits = (s.hits or 0) + 1
		s.late = math.abs(c.time - s.time)
	end)
	expect_reflections(shot, o)
end

return shots
