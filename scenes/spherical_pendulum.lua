-- A ball on a rod that may swing to all sides: between two heights it draws a rosette that never closes.
-- Watch: the trail goes from the inner to the outer circle and back; its outermost points move on, a petal at a time.
-- Expected end: energy and angular momentum about the vertical are those of the start; the heights keep to two bounds.
-- Both bounds follow from energy and angular momentum alone: they are roots of one cubic.
-- Try: --param push=3.13 (nearly a circle), --param push=0.3
-- Takes: some seconds.
local push = param("push", 1.2, "m/s, level, at the start", {min = 0.05, max = 10})
local angle = deg(param("angle", 60.0, "from hanging, degrees", {min = 5, max = 175}))
local L, g = 1, 9.81

world { title = "A spherical pendulum", duration = 12, frame_rate = 60, gravity = {0, 0, -g} }
local ball = sphere { name = "ball", radius = 0.06, mass = 1, color = {0.85, 0.25, 0.15}, texture = "none",
	position = {L * math.sin(angle), 0, -L * math.cos(angle)}, velocity = {0, push, 0} }
joint { name = "rod", kind = "rod", a = ball, at_b = {0, 0, 0}, radius = 0.012 }
camera { name = "main", position = {1.0, -2.4, 1.5}, look_at = {0, 0, -0.45}, trails = {ball}, overlay = {"title", "time"} }

-- With u = z/L: (du/dt)^2 = 2 (1 - u^2) (e - g u/L) - (l)^2 has the start's height for a root, and a second one.
local u0, e = -math.cos(angle), push ^ 2 / 2 / L ^ 2 - g * math.cos(angle) / L
local l2 = (push * math.sin(angle) / L) ^ 2
local function cubic(u) return 2 * (1 - u * u) * (e - g * u / L) - l2 end
-- It begins at one bound: divided by (u - u0) the cubic is a parabola, whose root in (-1, 1) is the other one.
local b = u0 - e * L / g
local c = u0 * b - 1
local other = (-b - math.sqrt(b * b - 4 * c)) / 2
local low, high = math.min(u0, other), math.max(u0, other)
assert(math.abs(cubic(other)) < 1e-9 * (l2 + g / L), "the other bound is a root")
local first, moment, worst = nil, nil, 0
local function about() return ball.position.x * ball.velocity.y - ball.position.y * ball.velocity.x end
on_frame(function()
	first, moment = first or energy(), moment or about()
	worst = math.max(worst, ball.position.z / L - high, low - ball.position.z / L)
end)
expect("the energy is that of the start, J", function() return math.abs(energy() - first), 1e-11 * g * L end)
expect("the angular momentum about the vertical, too, m^2/s", function() return math.abs(about() - moment), 1e-11 * push * L end)
expect("the heights keep to their bounds, rod lengths", function() return worst, 1e-9 end)
