-- SPDX-License-Identifier: MIT
-- rbsim.palette: colours {r, g, b}, sRGB in [0, 1].
--
--   local palette = require "rbsim.palette"
--   sphere { radius = 1, color = palette.red }
--   sphere { radius = 1, color = palette.at(7) }             -- the seventh of eight that are easy to tell apart
--   sphere { radius = 1, color = palette.hsv(0.6, 0.5, 1) }  -- hue, saturation, value in [0, 1]
--   sphere { radius = 1, color = palette.scale(0.3) }        -- from blue (0) through white to red (1)

local check = require "rbsim.check"

local palette = {
	black = {0, 0, 0}, white = {1, 1, 1}, grey = {0.5, 0.5, 0.5},
	red = {0.80, 0.20, 0.18}, orange = {0.92, 0.56, 0.16}, yellow = {0.94, 0.82, 0.28}, green = {0.26, 0.60, 0.32},
	teal = {0.20, 0.62, 0.62}, blue = {0.22, 0.42, 0.74}, purple = {0.52, 0.34, 0.66}, brown = {0.50, 0.34, 0.22},
}

local order = {"blue", "orange", "green", "red", "purple", "teal", "yellow", "brown"}

function palette.at(i)
	check.value("palette.at", "i", i, "count")
	return palette[order[(i - 1) % #order + 1]]
end

function palette.hsv(h, s, v)
	for name, x in pairs {h = h, s = s, v = v} do check.value("palette.hsv", name, x, "number") end
	if s < 0 or s > 1 or v < 0 or v > 1 then error("palette.hsv: 's' and 'v' must lie in [0, 1]", 2) end
	local function channel(n)
		local k = (n + h * 6) % 6
		return v - v * s * math.max(0, math.min(k, 4 - k, 1))
	end
	return {channel(5), channel(3), channel(1)}
end

function palette.scale(x)
	check.value("palette.scale", "x", x, "number")
	x = math.max(0, math.min(1, x))
	local low, high, s = palette.blue, palette.red, math.abs(2 * x - 1)
	local far, color = x < 0.5 and low or high, {}
	for i = 1, 3 do color[i] = 1 + s * (far[i] - 1) end
	return color
end

return palette
