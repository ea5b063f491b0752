-- SPDX-License-Identifier: MIT
-- A random scene: bodies of every shape, sizes, densities, friction and restitution over their ranges, on floors, slopes,
-- in troughs and rooms, some driven, on springs, dragged, kicked. All of it follows from `seed`; switches leave out what is
-- not wanted, and the rest stays as it is. Nothing overlaps at the start, by construction.
--
-- With `emit` = n the scenes of n seeds, from `seed` on, are printed as plain calls instead, a call a line, so that
-- lines can be taken away: see run.py and shrink.py.
local functions = require "functions"
local first_seed = param("seed", 1, "draws the scene", {min = 0})
local emit = param("emit", 0, "print the scenes of that many seeds instead", {min = 0})
local most = param("most", 30, "bodies at most", {min = 2, max = 200})
local decades = param("decades", 6.0, "sizes and densities range over at most so many", {min = 0, max = 12})
local length = param("length", 10.0, "duration, in times that a body takes to move by its size", {min = 0})
local switches = {}
for _, name in ipairs {"convex", "unions", "eccentric", "inertia", "spins", "slopes", "walls", "furniture", "driven", "springs",
	"drag", "forces", "fields", "callbacks", "groups", "touching", "stacks", "open"} do
	switches[name] = param(name, true, "scenes may have: " .. name)
end
local frames = 24

-- Four digits, so that the last bit of a C library's functions is in no scene.
local function short(x) return tonumber(string.format("%.4g", x)) + 0.0 end
local random = math.random
local function between(low, high) return low + (high - low) * random() end
local function decade(low, high) return short(10 ^ between(low, high)) end
local function chance(p) return random() < p end
local function vector(size) return {short(between(-size, size)), short(between(-size, size)), short(between(-size, size))} end

local function direction()
	local v
	repeat v = vec3(between(-1, 1), between(-1, 1), between(-1, 1)) until v:length() <= 1 and v:length() > 0.1
	v = v:unit()
	return {short(v.x), short(v.y), short(v.z)}
end

-- Each part of a scene draws from a sequence of its own, so that a switch does not change the others.
local seed
local function part(number) math.randomseed(1000 * seed + number) end

-- A chance that a switch can take away; it is drawn in any case.
local function may(switch, p)
	local x = random()
	return x < p and switches[switch]
end

local calls
local function call(name, keys) calls[#calls + 1] = {name = name, keys = keys} end
local function made(name, ...) return {made = name, ...} end

-- What is drawn once for a scene.
local function draw_setting()
	part(1)
	local s = {count = random(2, 6)}
	if chance(0.5) then s.count = random(2, 30) end
	s.count = math.min(s.count, most)
	s.gravity = chance(0.1) and 0 or chance(0.55) and 9.81 or decade(-2, 2)
	local spread = {0, between(0, 1.5), between(1.5, 3), between(3, 6)}
	s.sizes = math.min(decades, chance(0.35) and 0 or chance(0.55) and spread[2] or chance(0.5) and spread[3] or spread[4])
	s.densities = math.min(decades, chance(0.4) and 0 or chance(0.5) and between(0, 2) or between(2, 6))
	s.largest = short(between(0.1, 0.5))
	local fall = math.sqrt(s.largest * s.gravity)
	s.speed = chance(0.3) and s.gravity > 0 and 0 or short(math.max(fall, s.gravity == 0 and 1 or 0) * 10 ^ between(-1, 1))
	s.time = math.min(2, s.largest / math.max(s.speed, fall))
	s.duration = short(math.max(0.05, math.min(3, length * s.time)))
	s.frame_rate = short(frames / s.duration)
	s.time_step = short(math.min(s.time * 10 ^ between(-2.5, -0.7), 1 / s.frame_rate))
	s.one_kind = chance(0.35) and random(7)
	s.spin = chance(0.4) and 0 or short(10 ^ between(-1, 1.3))
	return s
end

local function draw_materials(s)
	part(2)
	s.materials = {}
	local same = chance(0.3) and between(0, 1)
	s.density = {}
	for i = 1, random(4) do
		local friction = chance(0.2) and 0 or chance(0.7) and short(between(0, 1)) or short(between(1, 5))
		local restitution = same or chance(0.3) and 0 or chance(0.2) and 1 or between(0, 1)
		s.materials[i], s.density["m" .. i] = "m" .. i, short(1000 * 10 ^ between(-s.densities / 2, s.densities / 2))
		call("material", {name = "m" .. i, friction = friction, restitution = short(restitution), density = s.density["m" .. i]})
	end
	if #s.materials > 1 and chance(0.3) then
		call("contact_pair", {"m1", "m2", {friction = short(between(0, 2)), restitution = short(between(0, 1))}})
	end
end

local function any(s) return s.materials[random(#s.materials)] end

-- Shapes: a table of keys, whose `reach` is the radius about the origin, `low` the half height if it stands on a face.
local shapes = {}
function shapes.sphere(r)
	return {radius = r}, r, r
end
function shapes.box(r)
	local thin = chance(0.15) and -2 or -0.5
	local size = {decade(thin, 0), decade(-0.5, 0), decade(-0.5, 0)}
	local k = r * 2 / vec3(size):length()
	for i = 1, 3 do size[i] = short(size[i] * k) end
	return {size = size}, vec3(size):length() / 2, size[3] / 2
end
function shapes.capsule(r)
	local thick = decade(-1.5, 0) / 2
	local radius, long = short(r * thick), short(2 * r * (1 - thick))
	return {radius = radius, length = long}, radius + long / 2, radius + long / 2
end
function shapes.cylinder(r)
	local angle = between(0.02, 1.55)
	local radius, long = short(r * math.sin(angle)), short(2 * r * math.cos(angle))
	return {radius = radius, length = long}, math.sqrt(radius ^ 2 + long ^ 2 / 4), long / 2
end
function shapes.hull(r)
	local points, reach, kind = {}, 0, random(3)
	if kind == 1 then
		points = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}
		for i = 1, 4 do points[i] = vec3(points[i]) end
	elseif kind == 2 then
		for i = 0, 4 do
			points[2 * i + 1] = vec3(math.cos(i * 2 * math.pi / 5), math.sin(i * 2 * math.pi / 5), 0.5)
			points[2 * i + 2] = vec3(math.cos(i * 2 * math.pi / 5), math.sin(i * 2 * math.pi / 5), -0.5)
		end
	else
		-- an octahedron's corners and some more: never flat
		local axes = {decade(-0.7, 0), decade(-0.7, 0), 1}
		for i, d in ipairs {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}} do
			points[i] = between(0.5, 1) * vec3(d)
		end
		for _ = 1, random(0, 8) do points[#points + 1] = vec3(direction()) end
		for i, p in ipairs(points) do points[i] = vec3(axes[1] * p.x, axes[2] * p.y, axes[3] * p.z) end
	end
	local list = {}
	for _, p in ipairs(points) do reach = math.max(reach, p:length()) end
	for i, p in ipairs(points) do list[i] = {short(p.x * r / reach), short(p.y * r / reach), short(p.z * r / reach)} end
	return {points = list}, r * 1.001, kind == 2 and short(0.5 * r / reach) or nil
end

local simple = {"box", "capsule", "cylinder", "hull"}
function shapes.body(r)
	local kind, list, reach = random(3), {}, 0
	if kind == 1 then
		-- a dumb-bell
		local ball, arm = short(r * between(0.1, 0.5)), short(r / 2)
		list = {{shape = "sphere", radius = ball, position = {-arm, 0, 0}}, {shape = "sphere", radius = ball, position = {arm, 0, 0}}}
		reach = ball + arm
		if chance(0.5) then
			list[3] = {shape = "capsule", radius = short(ball / 2), length = 2 * arm, orientation = {axis = {0, 1, 0}, angle = math.pi / 2}}
		end
	elseif kind == 2 then
		-- an L: two boxes that share an edge of the first
		local a, b = short(0.25 * r), short(0.6 * r)
		list = {{shape = "box", size = {2 * b, 2 * a, 2 * a}}, {shape = "box", size = {2 * a, 2 * a, 2 * b}, position = {b - a, 0, b + a}}}
		reach = vec3(b, a, 2 * b + a):length()
	else
		for i = 1, random(2, 4) do
			local name = chance(0.3) and "sphere" or simple[random(4)]
			local keys, far = shapes[name](short(r * between(0.2, 0.6)))
			keys.shape, keys.position = name, i > 1 and vector(0.4 * r / math.sqrt(3)) or nil
			if chance(0.6) then keys.orientation = {axis = direction(), angle = short(between(0, 3))} end
			if chance(0.3) then keys.density = decade(2, 4) end
			list[i] = keys
			reach = math.max(reach, far + (keys.position and vec3(keys.position):length() or 0))
		end
	end
	return {shapes = list}, reach * 1.001
end
local kinds = {"sphere", "box", "capsule", "cylinder", "hull", "body", "sphere", "box"}

-- A part must not say a material's density twice: nothing but its shape.
local function draw_shape(s)
	local kind = kinds[s.one_kind or random(#kinds)]
	if not switches.convex then kind = "sphere" end
	if not switches.unions and kind == "body" then kind = "box" end
	local keys, reach, low = shapes[kind](short(s.largest * 10 ^ -(s.sizes * random())))
	return {name = kind, keys = keys, reach = reach, low = low, r = reach}
end

-- The ground: a list of walls {point, normal} that bodies are put in front of, and where they are put.
local function draw_ground(s)
	part(3)
	s.walls, s.flat = {}, false
	local size = 4 * s.largest
	local function wall(point, normal, keys)
		s.walls[#s.walls + 1] = {point = vec3(point), normal = vec3(normal):unit()}
		keys = keys or {}
		keys.point, keys.normal, keys.material = point, normal, any(s)
		if not keys.motion then call("plane", keys) end
	end
	local floor, driven, tilt, about = random(), random(), between(0.05, 1.2), between(0, 6)
	local normal = {short(math.sin(tilt) * math.cos(about)), short(math.sin(tilt) * math.sin(about)), short(math.cos(tilt))}
	local closed = may("walls", 0.35)
	s.driven = driven < 0.15 and switches.driven
	if s.driven then
		-- a table that turns above a floor, or a floor that is shaken; what it pushes can go up
		local by, omega = vector(0.3 * s.largest), short(between(0.3, 3) / s.time)
		if chance(0.4) then
			call("plane", {material = any(s), size = {2 * size, 2 * size},
				motion = made("turned", {0, 0, 0}, {0, 0, 1}, short(omega / 3))})
			call("plane", {point = {0, 0, -size}, normal = {0, 0, 1}, material = any(s)})
		else
			call("plane", {normal = {0, 0, 1}, material = any(s), motion = made("shaken", {0, 0, 0}, by, omega, chance(0.7))})
		end
		s.walls[1], s.flat = {point = vec3(0, 0, 0), normal = vec3(0, 0, 1)}, true
	elseif floor < 0.15 and switches.slopes then
		wall({0, 0, 0}, normal)
	elseif floor < 0.25 and switches.slopes then
		wall({0, 0, 0}, {normal[1], normal[2], normal[3]})
		wall({0, 0, 0}, {-normal[1], short(0.3 * normal[2]), normal[3]})
	elseif floor < 0.33 and switches.open and not closed then
		s.free = true
	else
		wall({0, 0, 0}, {0, 0, 1})
		s.flat = true
	end
	if closed and not s.free then
		for axis = 1, 2 do
			local low, high, n = {0, 0, 0}, {0, 0, 0}, {0, 0, 0}
			low[axis], high[axis], n[axis] = -size, size, 1
			wall(low, {n[1], n[2], n[3]})
			wall(high, {-n[1], -n[2], n[3]})
		end
		if chance(0.5) then wall({0, 0, 3 * size}, {0, 0, -1}) end
	end
	s.size = size
	local pull = {0, 0, -s.gravity}
	if may("slopes", 0.12) then pull = vector(s.gravity) end
	s.pull = pull
end

-- Furniture and moving bodies are put where their spheres touch no other one and no wall.
local function is_free(s, p, r, gap)
	for _, w in ipairs(s.walls) do
		if w.normal:dot(p - w.point) < r + gap then return false end
	end
	for _, q in ipairs(s.placed) do
		if (q.p - p):length() < q.r + r + gap then return false end
	end
	return true
end

local function find_place(s, r)
	for try = 1, 400 do
		local wide = s.size * (0.5 + try / 200)
		local p = vec3(vector(1))
		p = vec3(short(p.x * wide), short(p.y * wide), short((s.free and p.z or (p.z + 1) / 2 * (1 + try / 100)) * wide))
		if is_free(s, p, r, 1e-3 * s.largest) then return p end
	end
end

local function draw_furniture(s)
	part(4)
	s.placed = {}
	if not may("furniture", 0.3) then return end
	for _ = 1, random(3) do
		local shape = draw_shape({largest = s.size / 2, sizes = 1})
		local p = find_place(s, chance(0.5) and 0 or shape.reach)
		shape.keys.material, shape.keys.static = any(s), true
		shape.keys.orientation = chance(0.7) and {axis = direction(), angle = short(between(0, 3))} or nil
		shape.keys.position = p and {p.x, p.y, p.z}
		local kind, thin, axis = shape.name, chance(0.25), direction()
		if thin then
			local w = short(shape.reach)
			shape.keys = {point = shape.keys.position, normal = direction(), axis = {axis[1], axis[2], axis[3]}, size = {w, w}, material = any(s)}
			kind = "plane"
		end
		if p then
			call(kind, shape.keys)
			s.placed[#s.placed + 1] = {p = p, r = shape.reach}
		end
	end
end

-- Sets what a moving body has besides its shape and place.
local function dress(s, shape)
	local keys = shape.keys
	keys.name = "b" .. #s.names + 1
	s.names[#s.names + 1] = keys.name
	keys.material = any(s)
	local v, w, calm = vector(s.speed), vector(s.spin / s.time), chance(0.2)
	if s.speed > 0 and not calm and not shape.calm then keys.velocity = v end
	if may("spins", 0.8) and s.spin > 0 and not calm and not shape.calm then
		keys.angular_velocity = w
	end
	local c, eccentric = vector(0.25 * shape.keep), may("eccentric", 0.12)
	if eccentric then keys.center_of_mass = c end
	local a, b, k, stated = between(0.3, 1), between(0.3, 1), between(0.3, 1), may("inertia", 0.07)
	if stated then
		local m = short(shape.r ^ 3 * decade(3, 4))
		local unit = m * shape.r ^ 2 / 5
		keys.mass = m
		keys.inertia = {short(unit * (b * b + k * k)), short(unit * (a * a + k * k)), short(unit * (a * a + b * b))}
	end
	-- what forces are measured by: about its mass
	s.masses[#s.names] = keys.mass or s.density[keys.material] * shape.r ^ 3
	if may("groups", 0.02) then keys.group, keys.collides_with = "loose", {"loose"} end
	call(shape.name, keys)
end

-- A column that stands on the flat floor, each body on the one before.
local function draw_stack(s, count)
	local x, y = short(between(-s.size / 2, s.size / 2)), short(between(-s.size / 2, s.size / 2))
	local column, height, wide = {}, 0, 0
	for _ = 1, count do
		local shape = draw_shape(s)
		if shape.low and (shape.name == "box" or shape.name == "cylinder" or shape.name == "sphere" or shape.name == "hull") then
			height, wide = height + shape.low, math.max(wide, shape.reach)
			shape.keys.position, shape.calm = {x, y, height}, true
			height = height + shape.low
			column[#column + 1] = shape
		end
	end
	if #column == 0 or height > 2.5 * s.size then return end
	local floor = table.remove(s.walls, 1)
	local middle = vec3(x, y, height / 2)
	local r = math.sqrt(wide ^ 2 + (height / 2) ^ 2)
	local ok = is_free(s, middle, r, 1e-3 * s.largest)
	table.insert(s.walls, 1, floor)
	if not ok then return end
	s.placed[#s.placed + 1] = {p = middle, r = r}
	for _, shape in ipairs(column) do
		shape.keep = shape.low
		dress(s, shape)
	end
end

-- A row of spheres that touch, the first of which may come along it.
local function draw_row(s, count)
	local r, along = short(s.largest * between(0.2, 0.6)), chance(0.5) and {1, 0, 0} or direction()
	local p = find_place(s, (2 * count - 1) * r)
	if not p then return end
	along = vec3(along):unit()
	s.placed[#s.placed + 1] = {p = p, r = (2 * count - 1) * r}
	for i = 1, count do
		local q = p + (2 * r * (i - (count + 1) / 2)) * along
		local shape = {name = "sphere", keys = {radius = r, position = {q.x, q.y, q.z}}, reach = r, r = r, keep = r, calm = true}
		if i == 1 then
			local v = math.max(s.speed, 0.1 * s.largest / s.time) * along
			shape.keys.velocity = {short(v.x), short(v.y), short(v.z)}
		end
		dress(s, shape)
	end
end

local function draw_bodies(s)
	part(5)
	s.names, s.masses = {}, {}
	local rest = s.count
	local tall, long = random(2, 5), random(2, 6)
	if may("stacks", 0.2) and s.flat then draw_stack(s, math.min(tall, rest)) end
	if may("touching", 0.08) and #s.names < rest then draw_row(s, math.min(long, rest - #s.names)) end
	while #s.names < rest do
		part(100 + #s.names)
		local shape = draw_shape(s)
		shape.keep = shape.reach
		local p, on_floor = find_place(s, shape.reach), may("touching", 0.1)
		if not p then break end
		shape.keys.position = {p.x, p.y, p.z}
		-- on its face, edge or side on the floor
		if on_floor and s.flat and shape.low and is_free({walls = {}, placed = s.placed}, vec3(p.x, p.y, shape.low), shape.reach, 0) then
			p = vec3(p.x, p.y, shape.low)
			shape.keys.position = {p.x, p.y, shape.low}
		else
			local turned = {axis = direction(), angle = short(between(0, 3))}
			if chance(0.8) and shape.name ~= "sphere" then shape.keys.orientation = turned end
		end
		s.placed[#s.placed + 1] = {p = p, r = shape.reach}
		dress(s, shape)
	end
end

-- Forces are such as move what they act on within the time of the scene, and now and then a thousand times stiffer.
local function draw_forces(s)
	part(6)
	local n = #s.names
	if n == 0 then return end
	local stiff = chance(0.1) and decade(0, 3) or 1
	local sorted = {table.unpack(s.masses)}
	table.sort(sorted)
	local least, middle = sorted[1], sorted[(n + 1) // 2]
	if may("springs", 0.12) and n >= 2 then
		for _ = 1, random(3) do
			local i = random(n - 1)
			local j = random(i + 1, n)
			local mass = math.min(s.masses[i], s.masses[j])
			local keys = {a = s.names[i], b = s.names[j], stiffness = short(stiff * mass * (10 ^ between(-0.5, 1) / s.time) ^ 2)}
			if chance(0.5) then keys.damping = short(stiff * mass * between(0, 2) / s.time) end
			if chance(0.3) then keys.rest_length = short(s.size * between(0, 0.5)) end
			if chance(0.3) then keys.at_a = vector(0.3 * s.largest * 10 ^ -s.sizes) end
			call("spring", keys)
		end
	end
	if may("drag", 0.12) then
		local linear = chance(0.6)
		call("drag", linear and {linear = short(stiff * middle * between(0.1, 3) / s.time)} or
			{quadratic = short(stiff * middle * between(0.1, 3) / s.largest)})
	end
	if may("fields", 0.05) then
		call("field", made("towards", {0, 0, short(s.size / 2)}, short(stiff * least / s.time ^ 2 * between(0.1, 3))))
	end
	local i = random(n)
	if may("callbacks", 0.06) then
		local impulse = vector(s.masses[i] * s.largest / s.time)
		call("on_step", chance(0.5) and made("nothing") or made("kick", s.names[i], short(s.duration * random()), impulse))
	end
	if may("forces", 0.08) then
		local force = {vector = vector(stiff * s.masses[i] * s.largest / s.time ^ 2)}
		if chance(0.5) then force.frame = "body" end
		if chance(0.5) then force.start, force.duration = short(s.duration / 4), short(s.duration / 4) end
		if chance(0.5) then force.point = vector(0.1 * s.largest * 10 ^ -s.sizes) end
		for _, c in ipairs(calls) do
			if c.keys.name == s.names[i] then c.keys.forces = {force} end
		end
	end
end

local function draw()
	calls = {}
	local s = draw_setting()
	draw_materials(s)
	draw_ground(s)
	draw_furniture(s)
	draw_bodies(s)
	draw_forces(s)
	local keys = {title = "Random " .. seed, duration = s.duration, frame_rate = s.frame_rate, time_step = s.time_step}
	if s.gravity > 0 then keys.gravity = s.pull end
	table.insert(calls, 1, {name = "world", keys = keys})
end

local text_of
local function number(x)
	for digits = 4, 17 do
		local text = string.format("%." .. digits .. "g", x)
		if tonumber(text) == x then return text end
	end
end
local function list_of(t)
	local all, names = {}, {}
	for i, v in ipairs(t) do all[i] = text_of(v) end
	for k in pairs(t) do
		if type(k) == "string" and k ~= "made" then names[#names + 1] = k end
	end
	table.sort(names)
	for _, k in ipairs(names) do all[#all + 1] = k .. " = " .. text_of(t[k]) end
	return table.concat(all, ", ")
end
function text_of(v)
	if type(v) == "number" then return number(v) end
	if type(v) == "string" then return string.format("%q", v) end
	if type(v) ~= "table" then return tostring(v) end
	if v.made then return "functions." .. v.made .. "(" .. list_of(v) .. ")" end
	return "{" .. list_of(v) .. "}"
end

local function value_of(v)
	if type(v) ~= "table" then return v end
	local all = {}
	for k, x in pairs(v) do all[k] = value_of(x) end
	if v.made then return functions[v.made](table.unpack(all, 1, #v)) end
	return all
end

if emit > 0 then
	sphere { radius = 1 }
	world { duration = 1e-6, frame_rate = 1e6 }
	for k = 0, emit - 1 do
		seed = first_seed + k
		draw()
		local lines = {}
		for i, c in ipairs(calls) do
			local plain = c.name == "contact_pair" or c.keys.made
			local arguments = text_of(c.keys)
			if c.name == "contact_pair" then arguments = list_of(c.keys) end
			lines[i] = c.name .. (plain and "(" .. arguments .. ")" or " " .. arguments)
		end
		-- in pieces that a line of the log holds
		print("seed " .. seed)
		for _, line in ipairs(lines) do
			for i = 1, #line, 200 do print((i == 1 and "=" or "+") .. line:sub(i, i + 199)) end
		end
	end
	return
end

seed = first_seed
draw()
for _, c in ipairs(calls) do
	if c.name == "contact_pair" then
		contact_pair(table.unpack(c.keys))
	else
		_ENV[c.name](value_of(c.keys))
	end
end
