-- Two balls on two rods, let go from the horizontal: the simplest machine whose motion nobody can foretell for long.
-- Watch: the trail of the lower ball; start it a hair higher (--param hair=1e-9) and after half a minute it is elsewhere.
-- Expected end: at 5 s both balls are where two other programs have them; the energy is that of the start.
-- Errors of rounding grow about threefold in a second here, so ten digits of the start are gone after twenty.
-- Try: --param seconds=30, --param hair=1e-9
-- Takes: less than a second.
local hair = param("hair", 0.0, "m, by which the lower ball begins higher", {min = 0, max = 0.1})
local seconds = param("seconds", 5.0, "s", {min = 1, max = 1000})
local g, L = 9.81, 1

world { title = "A double pendulum", duration = seconds, frame_rate = 60, gravity = {0, 0, -g} }
local function ball(name, position)
	return sphere { name = name, radius = 0.07, mass = 1, position = position, collides_with = {} }
end
local upper = ball("upper", {L, 0, 0})
local lower = ball("lower", {2 * L, 0, hair})
joint { name = "upper rod", kind = "rod", a = upper, at_b = {0, 0, 0} }
joint { name = "lower rod", kind = "rod", a = upper, b = lower }
camera { name = "side", position = {0, -7, 0}, look_at = {0, 0, -0.3}, trails = {lower}, overlay = {"title", "time"} }

local first = nil
on_frame(function() first = first or energy() end)
-- Of the scale 2 m g L = 19.62 J of the two falls.
expect("the energy is that of the start, J", function() return math.abs(energy() - first), 1e-10 * 19.62 end)
if hair == 0 and seconds == 5 then
	-- Two other programs agree on these digits; errors of rounding have grown by about 3^5 by then.
	expect("the upper ball is where theory has it, m", function()
		return (upper.position - vec3(-0.58686920981627, 0, -0.80968174647180)):length(), 1e-9
	end)
	expect("the lower ball is where theory has it, m", function()
		return (lower.position - vec3(-1.55077846947044, 0, -1.07591273481265)):length(), 1e-9
	end)
end
