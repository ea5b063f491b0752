-- SPDX-License-Identifier: MIT
-- rbsim.verify: for the cases of `rbsim verify`, scenes with a known answer that must come out the same however they are
-- run. A case is written once, in coordinates of its own; this turns and shifts it, and takes back what is measured.
--
--   local verify = require "rbsim.verify"
--   verify.case { title = "Free fall", duration = 10, gravity = {0, 0, -9.81},
--                 time_step = {0.01, 1e-4, 0.1}, frame_rate = {10, 1, 7} }
--   local ball = verify.sphere { name = "ball", radius = 0.1, velocity = {3, 0, 4} }
--   expect("falls", function() return math.abs(verify.position(ball).z - z), 1e-13 + verify.rounding end)
--
-- case { ... } takes the keys of world { }, of which time_step and frame_rate are lists, the first being the one that
-- all other variations use, and
--   time_unit = 1     what duration, time_step and frame_rate are counted in, s
--   length = 1        the size of the scene, m: shift moves it by {16, -32, 64} times that
--   turns = {0, 1, 2} which rotations
--   leave_out = {turn = "why"}   variations that this case has not, and why (told by the verb)
--   quick = "base"    what --quick runs: "none", "base", "more" (also one rotation, another time step and
--                     the zero field), or "all" bases
--   processor_seconds = 60   what a run may take; by the clock 16 times that, on a busy machine
-- It declares the parameters of the variations, which the verb sets one at a time: time_step, frame_rate, turn (0: none,
-- 1: a quarter turn about x, exact; 2: an oblique rotation), shift (0, 1), harmless (an on_step that does nothing),
-- zero_field (a field that is zero). A parameter with choices that the case itself declares is run for each choice.
--
-- point(p), vector(v), orientation(q)             from the case's coordinates to the world's
-- back(p), back_vector(v)                         from the world's to the case's
-- sphere { }, box { }, capsule { }, cylinder { }, hull { }, body { }, plane { }
--                                                 as the calls of these names, with keys in the case's coordinates
-- joint { }                                       the same; at_a, and at_b of a body, are in object coordinates as ever
-- position(body), velocity(body), spin(body)      in the case's coordinates
-- gravity()                                       in the case's coordinates
-- rounding                                        m: how far turn and shift round coordinates; 0 without them
-- exact                                           neither is there: what must hold to the bit can be asked for
-- ulp(x)                                          distance from |x| to the next larger number
-- axes(body)                                      the body's own x, y and z in the case's coordinates
-- tilt(body)                                      rad: how far its orientation is from the one of the case's axes

local verify = {rounding = 0, exact = true, u = 2 ^ -52}

local turn, shift, origin = 0, 0, nil

-- The rotation of the unit quaternion (3, 1, 2, 4)/sqrt(30): its matrix is whole numbers over 30, no entry is 0.
local oblique = {{-10, -20, 20}, {28, -4, 10}, {-4, 22, 20}}

function verify.ulp(x)
	x = math.abs(x)
	if x == 0 then return 2.0 ^ -1074 end
	local e = math.floor(math.log(x, 2))
	if 2.0 ^ e > x then e = e - 1 elseif 2.0 ^ (e + 1) <= x then e = e + 1 end
	return 2.0 ^ (e - 52)
end

function verify.vector(v)
	v = vec3(v)
	if turn == 0 then return v end
	if turn == 1 then return vec3(v.x, -v.z, v.y) end
	local r = oblique
	return vec3((r[1][1] * v.x + r[1][2] * v.y + r[1][3] * v.z) / 30,
		(r[2][1] * v.x + r[2][2] * v.y + r[2][3] * v.z) / 30,
		(r[3][1] * v.x + r[3][2] * v.y + r[3][3] * v.z) / 30)
end

function verify.back_vector(v)
	v = vec3(v)
	if turn == 0 then return v end
	if turn == 1 then return vec3(v.x, v.z, -v.y) end
	local r = oblique
	return vec3((r[1][1] * v.x + r[2][1] * v.y + r[3][1] * v.z) / 30,
		(r[1][2] * v.x + r[2][2] * v.y + r[3][2] * v.z) / 30,
		(r[1][3] * v.x + r[2][3] * v.y + r[3][3] * v.z) / 30)
end

function verify.point(p)
	local q = verify.vector(p)
	return shift == 0 and q or q + origin
end

function verify.back(p)
	return verify.back_vector(shift == 0 and vec3(p) or vec3(p) - origin)
end

local function times(a, b)
	return {a[1] * b[1] - a[2] * b[2] - a[3] * b[3] - a[4] * b[4],
		a[1] * b[2] + a[2] * b[1] + a[3] * b[4] - a[4] * b[3],
		a[1] * b[3] - a[2] * b[4] + a[3] * b[1] + a[4] * b[2],
		a[1] * b[4] + a[2] * b[3] - a[3] * b[2] + a[4] * b[1]}
end

-- {w, x, y, z} of {axis =, angle =}, or itself.
local function quaternion(q)
	if not q.axis then return q end
	local half, axis = q.angle / 2, vec3(q.axis):unit()
	return {math.cos(half), axis.x * math.sin(half), axis.y * math.sin(half), axis.z * math.sin(half)}
end

function verify.orientation(q)
	if turn == 0 then return q end
	local s = turn == 1 and math.sqrt(0.5) or 1 / math.sqrt(30)
	return times(turn == 1 and {s, s, 0, 0} or {3 * s, s, 2 * s, 4 * s}, quaternion(q))
end

local function choices(name, values, help, why)
	return param(name, values[1], why or help, {choices = why and {values[1]} or values})
end

local function floats(values)
	local list = {}
	for i, x in ipairs(values) do list[i] = x + 0.0 end
	return list
end

function verify.case(o)
	local keys, why, unit, length = {}, o.leave_out or {}, o.time_unit or 1, o.length or 1
	local own = {time_unit = true, length = true, leave_out = true, quick = true, processor_seconds = true,
		turns = true}
	for key, value in pairs(o) do
		if not own[key] then keys[key] = value end
	end
	keys.time_step = unit * choices("time_step", floats(o.time_step), "longest step (variation)", why.time_step)
	keys.frame_rate = choices("frame_rate", floats(o.frame_rate), "frames per second (variation)", why.frame_rate) / unit
	keys.duration = o.duration * unit
	turn = choices("turn", o.turns or {0, 1, 2}, "rotation: none, quarter, oblique (variation)", why.turn)
	shift = choices("shift", {0, 1}, "translation: none or some (variation)", why.shift)
	local harmless = choices("harmless", {false, true}, "an on_step that does nothing (variation)", why.harmless)
	local zero = choices("zero_field", {false, true}, "a field that is zero (variation)", why.zero_field)
	param("quick", o.quick or "base", "what --quick runs", {choices = {o.quick or "base"}})
	param("processor_seconds", (o.processor_seconds or 60) + 0.0, "what a run may take", {min = 0})

	origin = length * vec3(16, -32, 64)
	-- a coordinate below 128 is rounded by half an ulp, three of them as a vector by less than one
	verify.rounding = shift ~= 0 and 2.0 ^ -46 * length or turn == 2 and 2.0 ^ -51 * length or 0
	verify.exact = shift == 0 and turn ~= 2
	verify.turn, verify.shift = turn, shift
	local g = keys.gravity
	verify.gravity = function() return vec3(g or {0, 0, 0}) end
	if g then keys.gravity = verify.vector(g) end
	world(keys)
	if harmless then on_step(function() end) end
	if zero then field(function() return {0, 0, 0} end) end
end

local function copied(keys, how)
	local all = {}
	for key, value in pairs(keys) do all[key] = how[key] and how[key](value) or value end
	return all
end

-- A driven body's pose.
local function motion(f)
	return function(t)
		local p, q, v, w = f(t)
		return verify.point(p), verify.orientation(q or {1, 0, 0, 0}), v and verify.vector(v), w and verify.vector(w)
	end
end

local function forces(list)
	local all = {}
	for i, force in ipairs(list) do
		local how = force.frame == "body" and {} or {vector = verify.vector, direction = verify.vector}
		all[i] = copied(force, how)
	end
	return all
end

local how = {position = verify.point, point = verify.point, velocity = verify.vector,
	angular_velocity = verify.vector, normal = verify.vector, axis = verify.vector,
	orientation = verify.orientation, motion = motion, forces = forces}

function verify.sphere(keys)
	local all = copied(keys, how)
	all.position = all.position or not keys.motion and verify.point {0, 0, 0} or nil
	if turn ~= 0 and (keys.inertia or keys.center_of_mass) and not (keys.orientation or keys.motion) then
		all.orientation = verify.orientation {1, 0, 0, 0}
	end
	return sphere(all)
end

local function solid(make)
	return function(keys)
		local all = copied(keys, how)
		if not keys.motion then all.position = all.position or verify.point {0, 0, 0} end
		if turn ~= 0 and not (keys.orientation or keys.motion) then all.orientation = verify.orientation {1, 0, 0, 0} end
		return make(all)
	end
end

verify.box, verify.capsule, verify.cylinder = solid(box), solid(capsule), solid(cylinder)
verify.hull, verify.body = solid(hull), solid(body)

function verify.plane(keys)
	local all = copied(keys, how)
	if not (keys.motion or keys.position) then
		all.point = all.point or verify.point {0, 0, 0}
		if not keys.orientation then all.normal = all.normal or verify.vector {0, 0, 1} end
	end
	if keys.size and not keys.axis and not keys.orientation then all.axis = verify.vector {1, 0, 0} end
	return plane(all)
end

function verify.joint(keys)
	local all = copied(keys, {at = verify.point, axis = verify.vector, axis_b = verify.vector})
	if not keys.b and keys.at_b then all.at_b = verify.point(keys.at_b) end
	return joint(all)
end

function verify.position(body) return verify.back(body.position) end
function verify.velocity(body) return verify.back_vector(body.velocity) end
function verify.spin(body) return verify.back_vector(body.angular_velocity) end

function verify.axes(body)
	local q = body.orientation
	local w, x, y, z = q[1], q[2], q[3], q[4]
	return verify.back_vector {w * w + x * x - y * y - z * z, 2 * (x * y + w * z), 2 * (x * z - w * y)},
		verify.back_vector {2 * (x * y - w * z), w * w - x * x + y * y - z * z, 2 * (y * z + w * x)},
		verify.back_vector {2 * (x * z + w * y), 2 * (y * z - w * x), w * w - x * x - y * y + z * z}
end

-- From the differences of the axes: an arc cosine would lose half of the digits.
function verify.tilt(body)
	local x, y, z = verify.axes(body)
	x, y, z = x - vec3(1, 0, 0), y - vec3(0, 1, 0), z - vec3(0, 0, 1)
	local part = math.sqrt((x:dot(x) + y:dot(y) + z:dot(z)) / 8)
	return 2 * math.asin(math.min(1, part))
end

-- The larger one, and what is no number in any event: nothing that went wrong is lost in a maximum.
function verify.larger(a, b)
	if a ~= a or b ~= b then return 0 / 0 end
	return a > b and a or b
end

return verify
