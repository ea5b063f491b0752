-- SPDX-License-Identifier: MIT
-- One body of any shape, thrown or let go at any tilt, onto any ground; drawn from `k`. A touch that is missed leaves an
-- overlap, which a frame tells.
local k = param("k", 1, "which draw")
local ground = param("ground", "", "only this ground", {choices = {"", "plane", "shaken", "turning", "box", "rectangle", "vee", "body"}})
local only = param("shape", "", "only this shape", {choices = {"", "box", "cylinder", "capsule", "hull", "sphere"}})
world { duration = 1.2, frame_rate = 60, gravity = {0, 0, -9.81}, seed = k, tolerance = 1e-9 }

local function draw(low, high) return low + (high - low) * math.random() end
local function one_of(list) return list[math.random(#list)] end
local function way()
	while true do
		local v = vec3(draw(-1, 1), draw(-1, 1), draw(-1, 1))
		if v:length() > 0.1 and v:length() < 1 then return v:unit() end
	end
end
local function surface(name)
	return material { name = name, friction = one_of {0, 0, 0.1, 0.5, 1, 5}, restitution = one_of {0, 0, 0.3, 0.7, 1} }
end
local soft, hard = surface("soft"), surface("hard")
local size = 10 ^ draw(-2, 0)

local grounds = {
	plane = function() plane { material = hard, normal = one_of {vec3(0, 0, 1), (vec3(0, 0, 1) + 0.3 * way()):unit()} } end,
	shaken = function()
		local by, omega = draw(0, 0.05) * way(), draw(1, 12)
		plane { material = hard, motion = function(t)
			return math.sin(omega * t) * by, nil, omega * math.cos(omega * t) * by
		end }
	end,
	turning = function()
		local omega = draw(-2, 2)
		plane { material = hard, motion = function(t)
			local a = 0.1 * math.sin(omega * t)
			return {0, 0, 0}, {axis = {1, 0, 0}, angle = a}, {0, 0, 0}, {0.1 * omega * math.cos(omega * t), 0, 0}
		end }
	end,
	box = function() box { material = hard, static = true, size = {4 * size, 6 * size, size}, position = {0, 0, -size / 2} } end,
	rectangle = function() plane { material = hard, size = {3 * size, 2 * size} } end,
	vee = function()
		plane { material = hard, normal = {draw(0.2, 0.9), 0, 0.5} }
		plane { material = hard, normal = {-draw(0.2, 0.9), draw(-0.2, 0.2), 0.5} }
	end,
	body = function()
		plane { material = soft }
		box { material = hard, density = 500, size = {2 * size, 3 * size, size}, position = {0, 0, size / 2} }
	end,
}
local names = {"plane", "plane", "shaken", "turning", "box", "rectangle", "vee", "body"}
local drawn = one_of(names)
grounds[ground ~= "" and ground or drawn]()

local height = size * draw(1.5, 4)
local turn = one_of {
	function() return {axis = way(), angle = draw(0, 3)} end,
	function() return {axis = way(), angle = 10 ^ draw(-9, -1)} end,
	function() return {axis = {math.sin(k), math.cos(k), 0}, angle = math.pi / 2 + 10 ^ draw(-9, -1)} end,
	function() return {axis = {1, 0, 0}, angle = one_of {0, math.pi / 2, math.pi / 4}} end,
}()
local def = { material = soft, density = 1000, position = {draw(-0.5, 0.5) * size, draw(-0.5, 0.5) * size, height + size},
	orientation = turn, velocity = draw(0, 1) * way(),
	angular_velocity = one_of {0, 0, draw(0, 20)} * way() }
if math.random() < 0.25 then def.center_of_mass = draw(0, 0.2) * size * way() end
local shapes = {
	box = function() def.size = {draw(0.1, 1) * size, draw(0.1, 1) * size, draw(0.1, 1) * size}; box(def) end,
	cylinder = function() def.radius, def.length = draw(0.05, 0.5) * size, 10 ^ draw(-1.3, 0) * size; cylinder(def) end,
	capsule = function() def.radius, def.length = draw(0.02, 0.4) * size, draw(0.1, 1) * size; capsule(def) end,
	sphere = function() def.radius = draw(0.1, 0.5) * size; sphere(def) end,
	hull = function()
		local points = {}
		for i = 1, math.random(4, 10) do points[i] = 0.5 * size * way() end
		def.points = points
		hull(def)
	end,
}
local kinds = {"box", "cylinder", "cylinder", "capsule", "hull", "hull"}
local kind = one_of(kinds)
shapes[only ~= "" and only or kind]()
