-- SPDX-License-Identifier: MIT
-- C04: forces on a sphere in flight, one kind at a time: one that begins and ends, one that turns with the body, drag, a
-- field, a soft spring. Answer: the closed form of each.
local verify = require "rbsim.verify"
local kind = param("kind", "interval", "of force", {choices = {"interval", "body", "drag", "quadratic", "field", "spring"}})
local duration, radius, m = 3, 0.1, 2

verify.case { title = "Forces in flight", duration = duration, time_step = {0.01, 1e-3, 0.1}, frame_rate = {10, 1, 7},
	quick = "more" }
local v0, k, spin = vec3(1, 0.5, -0.25), 5, 4
local keys = {name = "ball", radius = radius, mass = m, velocity = v0}
local exact
if kind == "interval" then
	local f, start, lasts = vec3(0, 3, 1), 0.7, 1.1
	keys.forces = {{vector = f, start = start, duration = lasts}}
	exact = function(t)
		local s = math.max(0, math.min(t - start, lasts))
		local after = math.max(0, t - start - lasts)
		return t * v0 + (s * s / 2 + s * after) / m * f
	end
elseif kind == "body" then
	-- it turns about z with the body: a velocity on a circle
	local f = 3
	keys.forces, keys.angular_velocity, keys.orientation = {{vector = {f, 0, 0}, frame = "body"}}, {0, 0, spin}, {1, 0, 0, 0}
	exact = function(t)
		local a = f / m / spin
		return t * v0 + a * vec3((1 - math.cos(spin * t)) / spin, t - math.sin(spin * t) / spin, 0)
	end
elseif kind == "drag" then
	drag { linear = k }
	exact = function(t) return m / k * (1 - math.exp(-k * t / m)) * v0 end
elseif kind == "quadratic" then
	drag { quadratic = k }
	exact = function(t) return m / k * math.log(1 + k * v0:length() * t / m) * v0:unit() end
elseif kind == "field" then
	-- towards the case's origin in proportion to the distance
	field(function(t, x, v) return -k * verify.vector(verify.back(x)) end)
	exact = function(t)
		local w = math.sqrt(k / m)
		return math.sin(w * t) / w * v0
	end
else
	keys.position, keys.velocity = vec3(1.5, 0, 0), vec3(0, 0, 0)
	exact = function(t) return vec3(1 + 0.5 * math.cos(math.sqrt(k / m) * t), 0, 0) end
end
local ball = verify.sphere(keys)
if kind == "spring" then
	spring { a = verify.sphere { name = "anchor", radius = radius, static = true }, b = ball, stiffness = k, rest_length = 1 }
end

expect_always("place, m", function()
	return (verify.position(ball) - exact(time())):length(), 1e-10 + 8 * verify.rounding
end)
