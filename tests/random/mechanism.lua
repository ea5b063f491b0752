-- SPDX-License-Identifier: MIT
-- A random mechanism: a tree of 2 to 20 bodies with joints of every kind, sometimes closed to loops, with limits, ropes,
-- motors, friction and springs, above a floor that it may fall on. All of it follows from `seed`. Nothing overlaps at the
-- start, and every joint is closed, by construction: see mechanisms.py.
local seed = param("seed", 1, "draws the scene", {min = 0})
local most = param("most", 20, "bodies at most", {min = 2, max = 100})
local way = param("way", "located", "method", {choices = {"located", "stepped", "auto"}})
local switches = {}
for _, name in ipairs {"floor", "loops", "limits", "ropes", "motors", "friction", "springs"} do
	switches[name] = param(name, true, "scenes may have: " .. name)
end
local random = math.random
math.randomseed(seed)

-- Four digits, so that the last bit of a C library's functions is in no scene.
local function between(low, high) return tonumber(string.format("%.4g", low + (high - low) * random())) + 0.0 end
local function may(switch, p)
	local x = random()
	return x < p and (not switch or switches[switch])
end
local function direction()
	local v
	repeat v = vec3(between(-1, 1), between(-1, 1), between(-1, 1)) until v:length() <= 1 and v:length() > 0.1
	return v
end
local function one_of(list) return list[random(#list)] end

local count = math.min(most, may(nil, 0.6) and random(2, 6) or random(2, 20))
local g = may(nil, 0.15) and 0 or 9.81
local duration = 1
world { duration = duration, frame_rate = 20, gravity = {0, 0, -g}, method = way, time_step = 1e-3 }
local e, mu = one_of {0.0, 0.5, between(0, 1)}, one_of {0.0, between(0, 1)}
local stuff = material { name = "stuff", friction = mu, restitution = e }
local planar = may(nil, 0.3)
local floor = may("floor", 0.6)
if floor then plane { material = stuff } end

-- Bodies on a walk; each hangs on one before it.
local bodies, places = {}, {}
local function is_free(p, r)
	if floor and p.z < r + 0.05 then return false end
	for _, other in ipairs(places) do
		if (p - other.place):length() < r + other.radius + 0.05 then return false end
	end
	return true
end
for k = 1, count do
	local r = between(0.08, 0.2)
	local p, parent
	repeat
		parent = k > 1 and (may(nil, 0.7) and k - 1 or random(k - 1)) or nil
		local step = direction():unit() * between(0.5, 0.8)
		if planar then step = vec3(step.x, 0, step.z) end
		p = parent and places[parent].place + step or vec3(0, 0, 1.5)
	until is_free(p, r)
	local size = 2 * r / math.sqrt(3)
	local keys = {material = stuff, position = p, mass = between(0.5, 5),
		velocity = may(nil, 0.3) and direction() * (planar and 0 or 1) or nil}
	local body
	if may(nil, 0.4) then
		keys.size = {size, 0.8 * size, 0.9 * size}
		body = box(keys)
	else
		keys.radius = r
		body = sphere(keys)
	end
	bodies[k], places[k] = body, {place = p, radius = r, parent = parent}
end

local function spice(keys, kind)
	local turns = kind == "hinge"
	if not (turns or kind == "slider" or kind == "cylindrical") then return keys end
	local size = turns and 1 or 0.3
	if may("limits", 0.5) then
		keys.limits = {-size * between(0.05, 2), size * between(0.05, 2)}
		keys.restitution = one_of {0.0, 0.5, between(0, 1)}
	end
	if may("friction", 0.3) then keys.friction = between(0.1, 3) end
	if may("motors", 0.3) then
		keys.motor = {speed = between(-5, 5)}
		keys.motor[turns and "torque" or "force"] = between(0.5, turns and 5 or 20)
	end
	if may("springs", 0.3) then keys.stiffness, keys.damping = between(1, 50), between(0, 2) end
	return keys
end

local function connect(k, other, kinds)
	local kind = one_of(kinds)
	local p, q = places[k].place, other and places[other].place
	local middle = q and (p + q) * 0.5 or p + vec3(0, 0, 0.3)
	local axis = planar and vec3(0, 1, 0) or direction()
	local keys = {kind = kind, a = bodies[k], b = other and bodies[other] or nil}
	if kind == "rod" or kind == "rope" then
		if not other then keys.at_b = middle end
		if kind == "rope" then
			keys.length = (q and (p - q):length() or 0.3) * one_of {1.0, between(1, 1.5)}
			keys.restitution = one_of {0.0, between(0, 1)}
		end
	else
		keys.at = middle
	end
	if kind == "hinge" or kind == "slider" or kind == "cylindrical" or kind == "universal" then keys.axis = axis end
	if kind == "universal" then keys.axis_b = axis:cross(math.abs(axis.x) < 0.5 and vec3(1, 0, 0) or vec3(0, 0, 1)) end
	joint(spice(keys, kind))
end

local kinds = planar and {"hinge", "hinge", "slider"} or
	{"ball", "hinge", "hinge", "slider", "cylindrical", "universal", "rod", "fixed"}
if switches.ropes and not planar then kinds[#kinds + 1] = "rope" end
if may(nil, 0.6) then connect(1, nil, planar and {"hinge"} or {"hinge", "ball", "rod"}) end
for k = 2, count do connect(k, places[k].parent, kinds) end
if may("loops", 0.3) and count > 3 then
	for _ = 1, random(2) do
		local k = random(3, count)
		local other = random(k - 2)
		if other ~= places[k].parent then connect(k, other, {"rod", switches.ropes and "rope" or "rod"}) end
	end
end
record { ledger = true }
