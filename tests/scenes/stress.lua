-- A room of random spheres for tests: materials, sizes, masses, centres of mass, inertia tensors, two finite planes and
-- a time step, all drawn from the parameter `k`. Nothing is expected but what must always hold: the run ends, states
-- stay finite, nobody leaves the room, and no overlap is beyond the tolerance.
local k = param("k", 1, "draws the scene", {min = 0})
local count = param("count", 30, "spheres", {min = 1, max = 200})
local eccentric = param("eccentric", 0.5, "share with a centre of mass off the middle", {min = 0, max = 1})
math.randomseed(k)
local random = math.random
local side = 4
local function between(low, high) return low + (high - low) * random() end
local function box(half) return vec3(between(-half, half), between(-half, half), between(-half, half)) end

world { title = "Stress " .. k, duration = 2, frame_rate = 60, time_step = 10 ^ between(-3.5, -1.5),
	gravity = {between(-0.5, 0.5), between(-0.5, 0.5), random() < 0.8 and -9.81 or 0} }
local materials = {}
for i = 1, 4 do
	materials[i] = material { name = "m" .. i, density = 10 ^ between(2, 4), friction = math.max(0, between(-0.5, 1.5)),
		restitution = math.max(0, between(-0.4, 1)) }
end
local function any() return materials[random(4)] end
for axis = 1, 3 do
	local low, high = {0, 0, 0}, {0, 0, 0}
	low[axis], high[axis] = 1, -1
	plane { normal = low, material = any() }
	plane { point = {side, side, side}, normal = high, material = any() }
end
plane { point = {2, 2, 1}, normal = {between(-0.5, 0.5), between(-0.5, 0.5), 1}, size = {between(1, 2), 1}, material = any() }
plane { point = {1, 1, 0.5}, normal = box(0.5), size = {0.5, 0.7}, material = any() }

local placed, bodies, smallest = {}, {}, math.huge
local function free(p, r)
	for _, q in ipairs(placed) do
		if (q.p - p):length() < q.r + r + 0.01 then
			return false
		end
	end
	return (p - vec3(2, 2, 1)):length() > 1.5 + r and (p - vec3(1, 1, 0.5)):length() > 0.6 + r
end
for _ = 1, 100000 do
	if #placed == count then
		break
	end
	local r = 0.05 + 0.25 * random() ^ 3
	local p = vec3(between(r + 0.01, side - r - 0.01), between(r + 0.01, side - r - 0.01), between(r + 0.01, side - r - 0.01))
	if free(p, r) then
		placed[#placed + 1] = {p = p, r = r}
		local def = { radius = r, position = p, material = any() }
		if random() < 0.1 then
			def.static = true
		else
			def.velocity, def.angular_velocity = box(2.5), box(10)
			smallest = math.min(smallest, r)
			if random() < eccentric then
				def.center_of_mass = r * box(0.25)
			end
			if random() < 0.2 then
				local scale = 400 * r ^ 5
				def.inertia = {scale * between(1, 1.5), scale * between(1, 1.5), scale}
			end
		end
		bodies[#bodies + 1] = sphere(def)
	end
end

expect("no overlap beyond the tolerance", function() return max_penetration(), 1e-4 * smallest end)
expect("nobody has left the room", function()
	for _, b in ipairs(bodies) do
		local p = b.position
		if math.min(p.x, p.y, p.z) < 0 or math.max(p.x, p.y, p.z) > side then
			return false
		end
	end
	return true
end)
