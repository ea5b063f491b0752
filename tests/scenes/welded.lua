-- Boxes thrown at the floor, corner first, and beside each the same of two halves that a fixed joint holds, and with a ball of next
-- to no mass on a joint of each kind: all impacts are the same.
local e, mu = param("e", 0.5, ""), param("mu", 0.3, "")
local kinds = {"fixed", "hinge", "ball", "slider", "cylindrical", "rod"}
local bound = param("bound", 1e-7, "m/s and rad/s, of about ten")
world { duration = 0.003, frame_rate = 1000, gravity = {0, 0, 0}, seed = param("throw", 1, "") }
local m = material { name = "m", density = 1000, restitution = e, friction = mu }
plane { material = m }
local alone, held = {}, {}
local function uniform(a, b) return a + (b - a) * math.random() end
for i = 1, 8 do
	local size = {uniform(0.2, 0.6), uniform(0.1, 0.3), uniform(0.1, 0.3)}
	local axis = vec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)):unit()
	local angle = uniform(0.3, 2.8)
	local function turned(v)
		return math.cos(angle) * v + math.sin(angle) * axis:cross(v) + (1 - math.cos(angle)) * axis:dot(v) * axis
	end
	local low = 0
	for k = 0, 7 do
		local corner = turned(vec3((k % 2 - 0.5) * size[1], (k // 2 % 2 - 0.5) * size[2], (k // 4 - 0.5) * size[3]))
		low = math.min(low, corner.z)
	end
	local v, w = vec3(uniform(-2, 2), uniform(-2, 2), -3), vec3(uniform(-3, 3), uniform(-3, 3), uniform(-3, 3))
	local turn = {axis = axis, angle = angle}
	local function at(y) return vec3(3 * i, y, 0.001 - low) end
	local function add(name, y)
		return box { name = name, size = size, material = m, position = at(y), orientation = turn, velocity = v, angular_velocity = w }
	end
	alone[i] = add("alone " .. i, 0)
	local half, off = {size[1] / 2, size[2], size[3]}, turned(vec3(size[1] / 4, 0, 0))
	local part = {}
	for side = -1, 1, 2 do
		part[#part + 1] = box { name = "half " .. i .. side, size = half, material = m, position = at(3) + side * off, orientation = turn,
			velocity = v + w:cross(side * off), angular_velocity = w }
	end
	joint { kind = "fixed", a = part[1], b = part[2], at = at(3) }
	held[#held + 1] = { i, part[1], part[2] }
	for k, kind in ipairs(kinds) do
		local body = add(kind .. " " .. i, 3 + 3 * k)
		local arm = turned(vec3(0, 0, 0.6 * size[3] + 0.1))
		local bob = sphere { name = "bob " .. kind .. i, radius = 0.01, mass = 1e-9, material = m, position = at(3 + 3 * k) + arm,
			velocity = v + w:cross(arm), angular_velocity = w, group = "bobs", collides_with = {} }
		local keys = { kind = kind, a = body, b = bob }
		if kind ~= "rod" then keys.at = at(3 + 3 * k) + arm end
		if kind ~= "ball" and kind ~= "fixed" and kind ~= "rod" then keys.axis = turned(vec3(0.3, 1, 0.2):unit()) end
		joint(keys)
		held[#held + 1] = { i, body }
	end
end
expect("each has hit the floor", function() return 8 * (1 + #kinds + 1), collisions() end)
expect("held ones move on as those alone", function()
	local worst = 0
	for _, h in ipairs(held) do
		local want, body = alone[h[1]], h[2]
		local v = h[3] and 0.5 * (body.velocity + h[3].velocity) or body.velocity
		worst = math.max(worst, (v - want.velocity):length(), (body.angular_velocity - want.angular_velocity):length())
	end
	return worst, bound
end)
