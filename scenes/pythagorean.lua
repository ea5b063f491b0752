-- Masses 3, 4 and 5 start at rest at the corners of a triangle with sides 3, 4 and 5, and fall to each other.
-- Watch: close encounters, each of which deals the cards anew; at 60 s two form a pair and throw the third one out.
-- Expected end: the lightest leaves for good; the other two stay a pair.
-- Burrau asked in 1913 what becomes of them; the answer came with computers in 1967, and each digit of it costs as many in between.
-- Try: --param size=0.05 (spheres that meet and bounce: another story)
-- Takes: less than a second.
local size = param("size", 1e-4, "radius, m", {min = 0})
world { title = "Pythagorean three bodies", duration = 80, frame_rate = 25, gravitation = {G = 1} }
local light = material { name = "light", friction = 0, restitution = 1 }
local function star(name, mass, x, y)
	return sphere { name = name, radius = size, mass = mass, position = {x, y, 0}, material = light }
end
local three, four, five = star("three", 3, 1, 3), star("four", 4, -2, -1), star("five", 5, 1, -1)
camera { name = "above", position = {0, 0, 14}, up = {0, 1, 0}, trails = {three, four, five}, overlay = {"title", "time"}, to = 65 }

-- places from an integration with 30 digits
local wanted = {[10] = {vec3(0.77848041013809, 0.14139230029009, 0), 1e-11}, [60] = {vec3(0.743807500118, 1.939947951095, 0), 1e-4}}
on_frame(function(t)
	if wanted[t] then wanted[t][3] = (three.position - wanted[t][1]):length() end
end)
if size == 1e-4 then
	for _, t in ipairs {10, 60} do
		expect("the lightest at " .. t .. " s, m", function() return wanted[t][3], wanted[t][2] end)
	end
	expect("the lightest leaves: its energy about the pair, J/kg", function()
		local d, v = three.position - (4 * four.position + 5 * five.position) / 9, three.velocity - (4 * four.velocity + 5 * five.velocity) / 9
		return -(v:dot(v) / 2 - 12 / d:length()), 0
	end)
	expect("the others stay a pair: their energy, J/kg", function()
		local d, v = five.position - four.position, five.velocity - four.velocity
		return v:dot(v) / 2 - 9 / d:length(), 0
	end)
end
