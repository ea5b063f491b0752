-- A ball of half a tonne swings on a rope into a wall of bricks.
-- Watch: the rope, a force that a callback asks for in each step, pulls its ball round; bricks that are hit fly.
-- Expected end: a third of the wall or more is a heap; impacts and friction have only taken energy.
-- A force that holds for a step lags behind by half of it, which feeds the rope's oscillation: its damping takes more.
-- Try: --param rows=10 --param columns=8, --param mass=100 (some of the wall stands), --param lift=0.3
-- Takes: 20 s of processor time, 6 s without its film.
local rows = param("rows", 6, "of bricks, one on the other", {min = 1, max = 40})
local columns = param("columns", 5, "bricks in a row", {min = 1, max = 40})
local mass = param("mass", 500.0, "of the ball, kg", {min = 1, max = 1e5})
local lift = param("lift", 1.0, "angle of the rope at the start, rad", {min = 0, max = 1.5})
local g, rope, radius, stiff = 9.81, 3, 0.3, 2e5
local size = {0.25, 0.5, 0.25}

world { title = "A wrecking ball", duration = 3, frame_rate = 60, gravity = {0, 0, -g} }
local brick = material { name = "brick", density = 1800, friction = 0.6, restitution = 0, color = {0.66, 0.30, 0.22} }
local iron = material { name = "iron", density = 7800, friction = 0.3, restitution = 0.1, color = {0.22, 0.23, 0.26}, shininess = 80 }
plane { name = "ground", material = brick, color = {0.55, 0.52, 0.46}, texture = "none" }

-- A wall in the plane of x = 0: every second row begins half a brick later.
local bricks = {}
for row = 0, rows - 1 do
	for column = 0, columns - 1 do
		local y = (column - (columns - 1) / 2 + (row % 2 - 0.5) / 2) * (size[2] + 0.002)
		local shade = 0.85 + 0.3 * ((3 * row + 5 * column) % 7) / 7
		bricks[#bricks + 1] = box { name = ("brick_%d_%d"):format(row, column), size = size, material = brick, texture = "none",
			position = {size[1] / 2, y, (row + 0.5) * size[3]}, color = {0.66 * shade, 0.30 * shade, 0.22 * shade} }
	end
end
-- The ball hangs so that at its lowest it touches the wall's face, a little above its middle.
local pivot = vec3(-radius, 0, rope + 0.55 * rows * size[3])
local hook = sphere { name = "hook", radius = 0.05, position = pivot, static = true, material = iron, collides_with = {} }
local ball = sphere { name = "ball", radius = radius, mass = mass, material = iron, texture = "none",
	position = pivot + rope * vec3(-math.sin(lift), 0, -math.cos(lift)) }
-- A rope pulls and never pushes; it begins with the tension of the angle at which it is let go.
local length = rope - mass * g * math.cos(lift) / stiff
on_step(function()
	local arm = ball.position - pivot
	local along = arm:unit()
	local tension = stiff * (arm:length() - length) + 5000 * ball.velocity:dot(along)
	if tension > 0 then ball:apply_force(-tension * along) end
end)
camera { name = "main", position = {2.6, -6.4, 2.6}, look_at = {-0.3, 0, 1.4}, fov = deg(42), size = {1280, 720}, trails = {ball},
	overlay = {"title", "time"}, video = "wrecking_ball.mp4" }

local function joules()
	local sum = 0
	for _, one in ipairs(bricks) do sum = sum + one.kinetic_energy + one.mass * g * one.position.z end
	local long = math.max(0, (ball.position - pivot):length() - length)
	return sum + ball.kinetic_energy + mass * g * ball.position.z + stiff / 2 * long * long
end
local start, built = nil, {}
for i, one in ipairs(bricks) do built[i] = vec3(one.position) end
on_frame(function(t) start = start or joules() end)
-- The rope's own share is of the order of its oscillation.
expect_always("energy is only lost, J", function() return joules() - (start or joules()), 0.01 * (start or 1) end)
expect("the ball has hit", function() return collisions() >= 1 end)
if mass >= 500 and lift >= 0.9 and rows <= 8 then
	expect("a third of the wall is gone", function()
		local gone = 0
		for i, one in ipairs(bricks) do
			if (one.position - built[i]):length() > size[3] then gone = gone + 1 end
		end
		return gone >= #bricks / 3
	end)
end
expect("overlap stays within the tolerance", function() return max_penetration(), penetration_tolerance() end)
