-- Three balls on a slope: one starts still, one spins backwards, one has a smooth skin.
-- Watch: rolling takes 5/7 of g sin; backspin is used up climbing, then it rolls too; without friction it only slides.
-- Expected end: speeds (5/7) g sin t, the same less the lost spin, and g sin t.
-- Rolling needs mu >= (2/7) tan(angle).
-- Try: --param angle=0.6 (radians), --param mu=0.1
-- Takes: less than a second.
local angle = param("angle", 0.35, "of the slope, rad", {min = 0, max = 1})
local mu = param("mu", 0.4, "friction of the rough balls", {min = 0, max = 2})
local g, radius, duration = 9.81, 0.1, 2

world { title = "Down a slope", duration = duration, frame_rate = 60, gravity = {0, 0, -g} }
local rough = material { name = "rough", friction = mu }
local smooth = material { name = "smooth", friction = 0 }
local normal = vec3(math.sin(angle), 0, math.cos(angle))
local down = vec3(math.cos(angle), 0, -math.sin(angle))
plane { normal = normal, material = rough, texture = "checker" }

local function ball(name, y, skin, spin)
	return sphere { name = name, radius = radius, material = skin, angular_velocity = {0, spin, 0},
		position = radius * normal + vec3(0, y, 0) }
end
local rolling, spinning, sliding = ball("rolling", -0.5, rough, 0), ball("spinning", 0, rough, -60),
	ball("sliding", 0.5, smooth, 0)
camera { name = "side", position = {2, -6, 1}, look_at = rolling, size = {1280, 720} }

local gs, gc = g * math.sin(angle), g * math.cos(angle)
local function along(body) return body.velocity:dot(down) end

-- The exact motion: the slip (speed of the point of contact) of a rough ball is used up, then it rolls.
local function exact(t, grip, y, spin)
	local slip_end = spin < 0 and -radius * spin / (3.5 * grip - gs) or 0
	if 3.5 * grip <= gs then
		slip_end = math.huge
	end
	local s = math.min(t, slip_end)
	local r = t - s
	local v, w = (gs - grip) * s, spin + 2.5 * grip * s / radius
	local path = v * s / 2 + v * r + 5 / 7 * gs * r * r / 2
	v, w = v + 5 / 7 * gs * r, w + 5 / 7 * gs * r / radius
	return { position = radius * normal + vec3(0, y, 0) + path * down, velocity = v * down,
		angular_velocity = vec3(0, w, 0) }
end
reference(function(t)
	return { rolling = exact(t, mu * gc, -0.5, 0), spinning = exact(t, mu * gc, 0, -60), sliding = exact(t, 0, 0.5, 0) }
end)

-- Friction of the spinning ball points uphill until its slip is used up; with little of it that takes longer than the run.
local final = { rolling = exact(duration, mu * gc, -0.5, 0), spinning = exact(duration, mu * gc, 0, -60) }
expect("the still ball rolls", function() return (rolling.velocity - final.rolling.velocity):length(), 1e-9 end)
expect("the spinning ball ends up rolling", function()
	return (spinning.velocity - final.spinning.velocity):length(), 1e-9
end)
expect("the smooth ball slides without turning", function()
	return math.abs(along(sliding) - gs * duration) + sliding.angular_velocity:length(), 1e-9
end)
