-- A bed of beads lies on a plate that goes up and down, faster than they can fall.
-- Watch: in each period the bed leaves the plate as one piece, flies, and lands on it again.
-- Expected end: it rises off the plate as high as a block without rebound would.
-- A block leaves when the plate's acceleration is -g, at sin(phase) = 1 / Gamma, and then flies; a deep bed does the same.
-- Try: --param gamma=0.9 (it never leaves), --param gamma=3.5 (it lands in the next period), --param e=0.8 (a gas)
-- Takes: 20 s of processor time.
local gamma = param("gamma", 2.0, "largest acceleration of the plate over g", {min = 0, max = 50})
local e = param("e", 0.0, "restitution", {min = 0, max = 1})
local layers = param("layers", 6, "of beads", {min = 1, max = 100})
local across = param("across", 6, "beads along a side", {min = 2, max = 100})
local periods = param("periods", 8, "simulated", {min = 3, max = 1000})
local g, r, f = 9.81, 0.01, 10
local omega = 2 * math.pi * f
local A, side = gamma * g / omega ^ 2, (2.1 * across + 0.2) * r

world { title = "A vibrated bed", duration = periods / f, frame_rate = 120, time_step = 1 / 960, gravity = {0, 0, -g}, method = "stepped", seed = 2 }
local glass = material { name = "glass", density = 2500, friction = 0.3, restitution = e, color = {0.55, 0.70, 0.80} }
local wall = material { name = "wall", friction = 0, restitution = e }
contact_pair(glass, wall, {friction = 0, restitution = e})
local plate = plane { name = "plate", material = glass, color = {0.60, 0.64, 0.68}, motion = function(t)
	return {0, 0, A * math.sin(omega * t)}, nil, {0, 0, A * omega * math.cos(omega * t)}
end }
for k = 0, 3 do
	local out = vec3(math.cos(k * math.pi / 2), math.sin(k * math.pi / 2), 0)
	plane { name = "wall " .. k, material = wall, normal = -1 * out, point = side / 2 * out, visible = false }
	box { name = "edge " .. k, static = true, collides_with = {}, material = wall, color = {0.60, 0.64, 0.68},
		size = {0.3 * r, 0.3 * r, 3 * layers * r},
		position = (side / 2 + 0.15 * r) * vec3(out.x - out.y, out.x + out.y, 0) + vec3(0, 0, 1.5 * layers * r) }
end
local beads = {}
for k = 0, layers * across * across - 1 do
	local x, y, z = k % across, k // across % across, k // (across * across)
	local function off() return 0.08 * r * (math.random() - 0.5) end
	beads[k + 1] = sphere { radius = r, material = glass, texture = "none", velocity = {0, 0, A * omega},
		position = {(x - (across - 1) / 2) * 2.1 * r + off(), (y - (across - 1) / 2) * 2.1 * r + off(), (1 + 2.02 * z) * r} }
end
camera { name = "main", position = {0.05, -0.62, 0.16}, look_at = {0, 0, 0.07}, fov = deg(22), size = {960, 720}, overlay = {"title", "time"},
	video = "vibrated_bed.mp4" }

-- The block: it leaves at the phase asin(1 / Gamma) and flies until it meets the plate again.
local function flight()
	local t0 = math.asin(1 / gamma) / omega
	local z0, v0 = A * math.sin(omega * t0), A * omega * math.cos(omega * t0)
	local highest, t = 0, 0
	repeat
		t = t + 1e-5 / f
		local gap = z0 + v0 * t - g / 2 * t * t - A * math.sin(omega * (t0 + t))
		highest = math.max(highest, gap)
	until gap < 0 and t > 1e-3 / f
	return highest, t
end
-- Height of the lowest bead over the plate, and the same of the bed's centre over where it lies: largest in the later half.
local rise, low, lies, free, frames = 0, 0, math.huge, 0, 0
local function center()
	local sum = 0
	for _, bead in ipairs(beads) do sum = sum + bead.position.z end
	return sum / #beads - plate.position.z
end
on_frame(function(t)
	if t < periods / f / 2 then return end
	local lowest, z = math.huge, center()
	for _, bead in ipairs(beads) do lowest = math.min(lowest, bead.position.z - plate.position.z - r) end
	low, rise, lies = math.max(low, lowest), math.max(rise, z), math.min(lies, z)
	frames, free = frames + 1, free + (lowest > 1e-3 * r and 1 or 0)
end)
probe("height of the centre of mass over the plate", center, {unit = "m"})
result("largest rise of the lowest bead", function() return low end, {unit = "m"})
result("largest rise of the centre of mass", function() return rise - lies end, {unit = "m"})
result("share of the time in flight", function() return free / frames end)
if gamma > 1 then
	result("rise of a block without rebound", function() return (flight()) end, {unit = "m"})
	result("share of the time in flight of a block", function() return select(2, flight()) * f end)
end
if gamma > 1 and gamma < 3 and e == 0 then
	-- In flight the bed loosens: its lowest beads stay behind the block, and its centre of mass is ahead.
	expect("a block rises farther than the lowest beads, m", function() return low, 1.02 * flight() end)
	expect("and less than the centre of mass, m", function() return (flight()), 1.02 * (rise - lies) end)
	expect("the lowest beads leave the plate as the block does, relative", function() return 1 - low / flight(), 0.2 end)
elseif gamma < 1 and e == 0 then
	expect("it does not leave the plate, m", function() return low, 1e-3 * r end)
end
expect("overlap stays within the tolerance", function() return max_penetration(), penetration_tolerance() end)
