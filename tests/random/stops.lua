-- SPDX-License-Identifier: MIT
-- A chain of one to four bodies whose joints have limits, motors that drive them into these, friction and springs.
local seed = param("seed", 1, "draws the scene", {min = 0})
local random = math.random
math.randomseed(seed * 7919 + 17)

-- Four digits, so that the last bit of a C library's functions is in no scene.
local function between(a, b) return tonumber(string.format("%.4g", a + (b - a) * random())) + 0.0 end
local function may(p) return random() < p end
local function one_of(list) return list[random(#list)] end
local function direction()
	local v
	repeat v = vec3(between(-1, 1), between(-1, 1), between(-1, 1)) until v:length() <= 1 and v:length() > 0.1
	return v:unit()
end

world { duration = 2, frame_rate = 20, gravity = {0, 0, may(0.3) and 0 or -9.81}, method = "located", time_step = 1 / 240 }

local function drive(keys, turns, size)
	if may(0.85) then
		keys.limits = {-size * between(0.05, 0.8), size * between(0.05, 0.8)}
		keys.restitution = one_of {0.0, 0.0, 0.5, between(0, 1)}
	end
	if may(0.7) then
		local most = between(0.5, 20) * (turns and 1 or 3)
		if may(0.6) then
			keys.motor = {speed = between(-5, 5)}
		else
			local a, w = between(0.1, 0.9) * size, between(1, 6)
			local function follow(t) return a * (1 - math.cos(w * t)), a * w * math.sin(w * t) end
			keys.motor = {[turns and "angle" or "way"] = follow}
		end
		keys.motor[turns and "torque" or "force"] = most * one_of {1, 10}
	end
	if may(0.5) then keys.friction = between(0.1, 3) end
	if may(0.3) then
		keys.stiffness = between(1, 50)
		if may(0.7) then keys.damping = between(0, 2) end
	end
end

local count = random(1, 4)
local planar = may(0.5)
local place, before = vec3(0, 0, 0), nil
for _ = 1, count do
	local u = planar and vec3(1, 0, 0) or direction()
	local length = between(0.3, 0.8)
	local keys = {position = place + u * (length * 0.5), mass = between(0.5, 4), collides_with = {}}
	local body
	if planar then
		keys.size = {length, 0.1, 0.15}
		body = box(keys)
	else
		keys.radius = 0.12
		body = sphere(keys)
	end
	local kind = one_of {"hinge", "hinge", "slider", "cylindrical"}
	local turns = kind == "hinge"
	local axis = planar and (turns and vec3(0, 1, 0) or vec3(1, 0, 0)) or direction()
	local joint_keys = {kind = kind, a = body, b = before, at = place, axis = axis}
	drive(joint_keys, turns, turns and 1 or 0.3)
	joint(joint_keys)
	before = body
	place = place + u * length
end
record { ledger = true }
