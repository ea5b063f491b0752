-- SPDX-License-Identifier: MIT
-- Around a random scene: the calls that place things, turned, mirrored or disturbed as parameters say, and what is
-- looked at in every frame, printed for run.py in the coordinates of the scene as it was written.
local watch = {}
local turn = param("turn", 0, "rotation: none, a quarter about x, oblique, (x, y, z) to (z, x, y)", {choices = {0, 1, 2, 3}})
local mirror = param("mirror", false, "x is -x")
local disturb = param("disturb", 0.0, "share of its speeds by which each body is faster")
local places = param("places", false, "print positions")

local oblique = {{-10, -20, 20}, {28, -4, 10}, {-4, 22, 20}}
local quaternions = {{math.sqrt(0.5), math.sqrt(0.5), 0, 0},
	{3 / math.sqrt(30), 1 / math.sqrt(30), 2 / math.sqrt(30), 4 / math.sqrt(30)}, {0.5, 0.5, 0.5, 0.5}}

local function across(v)
	v = vec3(v)
	return mirror and vec3(-v.x, v.y, v.z) or v
end

local function vector(v)
	v = across(v)
	if turn == 1 then return vec3(v.x, -v.z, v.y) end
	if turn == 3 then return vec3(v.z, v.x, v.y) end
	if turn == 0 then return v end
	local r = oblique
	return vec3((r[1][1] * v.x + r[1][2] * v.y + r[1][3] * v.z) / 30, (r[2][1] * v.x + r[2][2] * v.y + r[2][3] * v.z) / 30,
		(r[3][1] * v.x + r[3][2] * v.y + r[3][3] * v.z) / 30)
end

local function back(v)
	v = vec3(v)
	if turn == 1 then v = vec3(v.x, v.z, -v.y)
	elseif turn == 3 then v = vec3(v.y, v.z, v.x)
	elseif turn == 2 then
		local r = oblique
		v = vec3((r[1][1] * v.x + r[2][1] * v.y + r[3][1] * v.z) / 30, (r[1][2] * v.x + r[2][2] * v.y + r[3][2] * v.z) / 30,
			(r[1][3] * v.x + r[2][3] * v.y + r[3][3] * v.z) / 30)
	end
	return across(v)
end

-- Spins, torques: a mirror turns them the other way.
local function spin(w)
	return mirror and -1 * vector(w) or vector(w)
end

local function quaternion(q)
	if q.axis then
		local axis, half = vec3(q.axis):unit(), q.angle / 2
		local s = math.sin(half)
		q = {math.cos(half), s * axis.x, s * axis.y, s * axis.z}
	end
	return mirror and {q[1], q[2], -q[3], -q[4]} or q
end

local function orientation(q)
	if turn == 0 and not mirror then return q end
	local b = quaternion(q)
	if turn == 0 then return b end
	local a = quaternions[turn]
	return {a[1] * b[1] - a[2] * b[2] - a[3] * b[3] - a[4] * b[4], a[1] * b[2] + a[2] * b[1] + a[3] * b[4] - a[4] * b[3],
		a[1] * b[3] - a[2] * b[4] + a[3] * b[1] + a[4] * b[2], a[1] * b[4] + a[2] * b[3] - a[3] * b[2] + a[4] * b[1]}
end

local function copied(keys, how)
	local all = {}
	for key, value in pairs(keys) do
		if how[key] then all[key] = how[key](value) else all[key] = value end
	end
	return all
end

local function each(how)
	return function(list)
		local all = {}
		for i, x in ipairs(list) do all[i] = how(x) end
		return all
	end
end

local part = {position = across, orientation = quaternion, points = each(across)}

local function force(f)
	f = copied(f, {point = across, vector = f.frame == "body" and across or vector,
		torque = f.frame == "body" and function(w) return mirror and -1 * across(w) or w end or spin})
	return f
end

local function motion(f)
	return function(t)
		local p, q, v, w = f(t)
		return vector(p), q and orientation(q), v and vector(v), w and spin(w)
	end
end

local placed = {position = vector, point = vector, normal = vector, axis = vector, orientation = orientation,
	velocity = vector, angular_velocity = spin, center_of_mass = across, points = each(across), motion = motion,
	forces = each(force), shapes = each(function(s) return copied(s, part) end)}

local gravity, moving, walls = 0, {}, {}

local function size_of(keys)
	local size = keys.radius or 0
	for _, s in ipairs(keys.shapes or {}) do size = math.max(size, size_of(s) + vec3(s.position or {0, 0, 0}):length()) end
	for _, p in ipairs(keys.points or {}) do size = math.max(size, vec3(p):length()) end
	if keys.size then size = vec3(keys.size):length() / 2 end
	return size + (keys.length or 0) / 2
end

-- Faster by a share that differs from body to body, in a direction that does as well.
local function disturbed(keys)
	local n, v = #moving + 1, vec3(keys.velocity or {0, 0, 0})
	local way = vec3(math.cos(2.4 * n), math.sin(2.4 * n), math.cos(1.7 * n))
	keys.velocity = v + disturb * (v:length() + math.sqrt(gravity * size_of(keys))) * way
end

local function wrapped(call)
	return function(keys)
		if type(keys) ~= "table" then return call(keys) end
		local free = not keys.static and not keys.motion and call ~= plane
		local all = copied(keys, {})
		if free and disturb ~= 0 then disturbed(all) end
		if call ~= plane and turn + (mirror and 1 or 0) > 0 and not keys.orientation then all.orientation = {1, 0, 0, 0} end
		if call == plane and keys.motion and select(2, keys.motion(0)) then all.normal, all.axis = nil, nil end
		all = copied(all, placed)
		local handle = call(all)
		if free then moving[#moving + 1] = {handle = handle, size = size_of(keys), alone = keys.group or keys.collides_with} end
		if call == plane and not keys.motion and not keys.size and not keys.group and not keys.collides_with then
			walls[#walls + 1] = {point = vec3(keys.point or {0, 0, 0}), normal = vec3(keys.normal or {0, 0, 1}):unit()}
		end
		return handle
	end
end

for _, name in ipairs {"sphere", "box", "capsule", "cylinder", "hull", "body", "plane"} do
	watch[name] = wrapped(_ENV[name])
end

function watch.world(keys)
	gravity = vec3(keys.gravity or {0, 0, 0}):length()
	world(copied(keys, {gravity = vector, gravity_force = vector}))
end

function watch.spring(keys)
	return spring(copied(keys, {at_a = across, at_b = across}))
end

function watch.field(f)
	return field(function(t, x, v) return vector(f(t, back(x), back(v))) end)
end

-- How far the middle of a body is behind a wall, over its size; NaN where it is nowhere.
local function lost()
	local worst = 0
	for _, m in ipairs(moving) do
		local p = back(m.handle.position)
		if p ~= p then return 0 / 0 end
		for _, w in ipairs(m.alone and {} or walls) do
			worst = math.max(worst, w.normal:dot(w.point - p) / m.size)
		end
	end
	return worst
end

function watch.look()
	record { ledger = true }
	expect_always("looked at", function()
		local kinetic = 0
		for _, m in ipairs(moving) do kinetic = kinetic + m.handle.kinetic_energy end
		print(string.format("@ %.17g %.17g %.17g %.17g %.17g", time(), energy(), kinetic, max_penetration(), lost()))
		if places then
			for i, m in ipairs(moving) do
				local p = back(m.handle.position)
				print(string.format("%s %.17g %.17g %.17g", i == 1 and "#" or ",", p.x, p.y, p.z))
			end
		end
		return true
	end)
end

return watch
