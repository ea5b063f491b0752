-- Without weight, what an impact without rebound stops stays: a body that strikes a slab flat on, or two balls whose momenta are
-- opposite, each turned at random, at speeds from 1e-6 to 1e6 m/s.
local shape = param("shape", "box", "or sphere, cylinder, hull, balls")
local mu = param("mu", 0.0, "friction", {min = 0})
math.randomseed(param("draw", 1, "which one"))
local function u() return 2 * math.random() - 1 end

world { duration = 1 }
local matter = material { restitution = 0, friction = mu }
local speed, angle = 10 ^ (6 * u()), 3 * u()
local axis = vec3(u(), u(), u())
axis = axis / axis:length()

local function turned(x, y, z)
	local v = vec3(x, y, z)
	return v * math.cos(angle) + axis:cross(v) * math.sin(angle) + axis * (axis:dot(v) * (1 - math.cos(angle)))
end

if shape == "balls" then
	local mass, d = 10 ^ (8 * u()), turned(0, 0, 1)
	sphere { radius = 0.3, mass = 1, position = d, velocity = -2 * mass / (1 + mass) * d, material = matter }
	sphere { radius = 0.5, mass = mass, position = -d, velocity = 2 / (1 + mass) * d, material = matter }
else
	local def = { orientation = { axis = axis, angle = angle }, material = matter, static = true, position = turned(0, 0, -0.5), size = { 6, 6, 1 } }
	box(def)
	def.static, def.size = nil, nil
	def.position, def.velocity = turned(0.3 * u(), 0.3 * u(), 0.5 + 0.2 * speed), turned(0, 0, -speed)
	if shape == "box" then
		def.size = { 1, 1, 1 }
		box(def)
	elseif shape == "sphere" then
		def.radius = 0.5
		sphere(def)
	elseif shape == "cylinder" then
		def.radius, def.length = 0.5, 1
		cylinder(def)
	else
		def.points = { { -0.5, -0.5, -0.5 }, { 0.5, -0.5, -0.5 }, { 0, 0.5, -0.5 }, { 0, 0, 0.5 } }
		hull(def)
	end
end
expect("it is struck once", function() return collisions(), 1 end)
