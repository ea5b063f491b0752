-- A ball on a rigid rod, let go from the horizontal: a pendulum far beyond the small angles of the textbook.
-- Watch: it takes 2.37 s to swing there and back, not the 2.01 s of small swings.
-- Expected end: after two periods the ball is where it began, at rest.
-- The period is 4 K(sin(angle/2)) sqrt(L/g), with the complete elliptic integral K, which is pi over twice a mean of Gauss.
-- Try: --param angle=10 (degrees: the textbook holds), --param angle=179
-- Takes: less than a second.
local angle = deg(param("angle", 90.0, "from hanging, degrees", {min = 1, max = 179.9}))
local g, L = 9.81, 1

-- The arithmetic-geometric mean of 1 and cos(angle/2): K(k) = pi / (2 M(1, sqrt(1 - k^2))).
local a, b = 1, math.cos(angle / 2)
for _ = 1, 8 do a, b = (a + b) / 2, math.sqrt(a * b) end
local period = 2 * math.pi / a * math.sqrt(L / g)

world { title = "A pendulum", duration = 2 * period, frame_rate = 60, gravity = {0, 0, -g} }
local pivot = vec3(0, 0, 1.2)
local ball = sphere { name = "ball", radius = 0.08, mass = 1,
	position = pivot + L * vec3(math.sin(angle), 0, -math.cos(angle)) }
local rod = joint { name = "rod", kind = "rod", a = ball, at_b = pivot }
record { fields = {"+", "joints"} }
camera { name = "side", position = {0, -4, 1}, look_at = {0, 0, 0.9}, trails = {ball}, vectors = {"joint"}, overlay = {"title", "time"} }

local start = vec3(ball.position)
local lowest = math.huge
on_frame(function() lowest = math.min(lowest, ball.position.z) end)
expect("after two periods it is where it began, m", function() return (ball.position - start):length(), 1e-9 end)
expect("the rod keeps its length, m", function() return math.abs((ball.position - pivot):length() - L), 1e-12 end)
expect("it has been down, to what a frame misses of it, m", function() return lowest - (pivot.z - L), 0.5 * 2 * g * L / 60 ^ 2 end)
