-- A robot arm of three motors writes an eight into the air, as its joints' angles are told to go.
-- Watch: shoulder and elbow work against each other to keep the pen's path; the base swings from side to side.
-- Expected end: the pen has stayed on its path, to rounding.
-- The angles come from the path by inverse kinematics: a triangle of two arms whose third side is the reach.
-- Try: --param speed=2, --param torque=15 (too weak: it lags behind)
-- Takes: a second.
local speed = param("speed", 1.0, "rounds in four seconds", {min = 0.1, max = 5})
local torque = param("torque", 400.0, "N m, the most of each motor", {min = 0, max = 1e4})
local g, upper, lower, base = 9.81, 0.6, 0.5, 0.4

world { title = "A robot arm", duration = 4, frame_rate = 60, gravity = {0, 0, -g} }
material { name = "paint", density = 1200, friction = 0, texture = "none", shininess = 60 }
local function path(t)
	local a = 2 * math.pi * speed * t / 4
	return vec3(0.62, 0.34 * math.sin(a), 0.62 + 0.2 * math.sin(2 * a))
end
-- Turn of the base, of the upper arm above the horizontal, and of the forearm against the upper arm.
local function angles(t)
	local p = path(t)
	local x, z = math.sqrt(p.x ^ 2 + p.y ^ 2), p.z - base
	local reach2 = x * x + z * z
	local bend = -math.acos((reach2 - upper ^ 2 - lower ^ 2) / (2 * upper * lower))
	return math.atan(p.y, p.x), math.atan(z, x) - math.atan(lower * math.sin(bend), upper + lower * math.cos(bend)), bend
end
local a0, b0, c0 = angles(0)
local function rate(n)
	local function one(t) return (select(n, angles(t))) end
	return (one(1e-4) - one(-1e-4)) / 2e-4
end
local wa, wb, wc = rate(1), rate(2), rate(3)
-- At the start it lies in the plane of y = 0; turning upward is turning about -y.
local shoulder = vec3(0, 0, base)
local function arm(angle) return vec3(math.cos(angle), 0, math.sin(angle)) end
local elbow = shoulder + upper * arm(b0)
local tip = elbow + lower * arm(b0 + c0)
local spin = vec3(0, 0, wa)
local spin1 = spin - vec3(0, wb, 0)
local spin2 = spin1 - vec3(0, wc, 0)
local function moved(omega, arm_) return vec3(omega.y * arm_.z - omega.z * arm_.y, omega.z * arm_.x - omega.x * arm_.z, omega.x * arm_.y - omega.y * arm_.x) end
local ve = moved(spin1, elbow - shoulder)
cylinder { name = "foot", radius = 0.2, length = 0.08, static = true, position = {0, 0, 0.04}, material = "paint", color = {0.25, 0.26, 0.3} }
local turret = cylinder { name = "turret", radius = 0.12, length = 0.3, material = "paint", position = {0, 0, 0.24}, color = {0.85, 0.5, 0.12},
	angular_velocity = spin, collides_with = {} }
local first = capsule { name = "upper arm", radius = 0.055, length = upper, material = "paint", color = {0.9, 0.6, 0.15}, position = (shoulder + elbow) / 2,
	orientation = {axis = {0, 1, 0}, angle = math.pi / 2 - b0}, velocity = ve / 2, angular_velocity = spin1, collides_with = {} }
local second = capsule { name = "forearm", radius = 0.04, length = lower, material = "paint", color = {0.95, 0.7, 0.2}, position = (elbow + tip) / 2,
	orientation = {axis = {0, 1, 0}, angle = math.pi / 2 - b0 - c0}, velocity = ve + moved(spin2, (tip - elbow) / 2), angular_velocity = spin2,
	collides_with = {} }
local pen = sphere { name = "pen", radius = 0.055, mass = 0.1, material = "paint", color = {0.8, 0.1, 0.1}, position = tip,
	velocity = ve + moved(spin2, tip - elbow), angular_velocity = spin2, collides_with = {} }
local function follow(n, start) return {angle = function(t) return (select(n, angles(t))) - start end, torque = torque} end
joint { name = "base", kind = "hinge", a = turret, at = {0, 0, 0.1}, axis = {0, 0, -1}, motor = follow(1, a0) }
joint { name = "shoulder", kind = "hinge", a = turret, b = first, at = shoulder, axis = {0, -1, 0}, motor = follow(2, b0), radius = 0.03 }
joint { name = "elbow", kind = "hinge", a = first, b = second, at = elbow, axis = {0, -1, 0}, motor = follow(3, c0), radius = 0.025 }
joint { name = "nail", kind = "fixed", a = second, b = pen, at = tip }
record { fields = {"+", "joints"} }
camera { name = "main", position = {1.7, -1.1, 1.15}, look_at = {0.25, 0, 0.5}, trails = {pen}, overlay = {"title", "time"} }

if torque >= 400 and speed <= 1 then
	expect_always("the pen is on its path, m", function() return (pen.position - path(time())):length(), 1e-12 end)
end
expect("the pen is near its path, m", function() return (pen.position - path(time())):length(), torque >= 100 and 0.05 or 2 end)
