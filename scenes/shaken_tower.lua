-- A tower of four blocks stands on ground that shakes to and fro, three times.
-- Watch: the tower goes with the ground as one piece, although its top moves as far as its foot.
-- Expected end: it stands as it was built, as long as the ground's acceleration stays below g times width over height.
-- Beyond g b/h the inertia of the whole tower turns it about an edge of its foot; beyond mu g it slides before it can tip.
-- Try: --param strength=1.02 (it rocks), --param strength=2 (it falls), --param mu=0.1 (it slides and stands)
-- Takes: less than a second.
local strength = param("strength", 0.95, "largest acceleration of the ground over the bound g b/h", {min = 0, max = 10})
local mu = param("mu", 0.9, "friction between the ground and the tower", {min = 0, max = 2})
local count = param("blocks", 4, "of the tower", {min = 1, max = 20})
local g, b, period = 9.81, 0.2, 1
local h, omega = count * b, 2 * math.pi / period
local bound = g * b / h
local a0 = strength * bound

world { title = "A tower on ground that shakes", duration = 3 * period, frame_rate = 60, gravity = {0, 0, -g},
	method = strength < 1 and "located" or "auto" }
local stone = material { name = "stone", density = 2400, friction = 0.9, restitution = 0 }
local earth = material { name = "earth", friction = 0.9, restitution = 0, color = {0.45, 0.4, 0.35} }
contact_pair(stone, earth, {friction = mu})

-- It accelerates by a0 sin(omega t), so it has its largest speed at the start; the tower goes with it from the beginning.
local v0 = a0 / omega
local ground = plane { name = "ground", material = earth, texture = "checker", motion = function(t)
	return {-v0 / omega * math.sin(omega * t), 0, 0}, nil, {-v0 * math.cos(omega * t), 0, 0}
end }
local tower = {}
for k = 1, count do
	tower[k] = box { name = "block " .. k, size = {b, b, b}, position = {0, 0, (k - 0.5) * b}, velocity = {-v0, 0, 0}, material = stone }
end
camera { name = "side", position = {0.4, -3.2, 0.9}, look_at = {0, 0, 0.45 * h}, size = {1280, 720}, overlay = {"title", "time"} }

-- How far a block is from where the ground has carried it; how far it leans, by the height of its axis.
local function shift(k) return (tower[k].position - ground.position - vec3(0, 0, (k - 0.5) * b)):length() end
local function worst(of)
	local most = 0
	for k = 1, count do most = math.max(most, of(k)) end
	return most
end
state.off, state.fastest, state.slid = 0, 0, 0
on_frame(function(t)
	state.slid = math.max(state.slid, shift(1))
	for k = 1, count do
		local a = tower[k].acceleration
		state.off = math.max(state.off, (a - vec3(a0 * math.sin(omega * t), 0, 0)):length())
		state.fastest = math.max(state.fastest, math.abs(a.x))
	end
end)
if strength < 1 and a0 <= mu * g then
	expect("it goes with the ground, m/s^2", function() return state.off, 1e-9 * g end)
	expect("it stands as it was built, m", function() return worst(shift), 1e-9 end)
elseif strength < 1 then
	expect("it has slid, by more than a millimetre", function() return state.slid > 1e-3 end)
	expect("and is pulled by no more than mu g", function() return state.fastest, (mu + 1e-9) * g end)
	expect("it stands upright", function()
		return worst(function(k) return 1 - (tower[k].point({0, 0, 1}) - tower[k].position).z end), 1e-9
	end)
elseif strength >= 2 then
	expect("it has fallen", function() return tower[count].position.z < 0.6 * h end)
end
