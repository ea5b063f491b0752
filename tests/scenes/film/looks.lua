-- One of each: patterns, a PNG texture, colours, a finite plane, a shadow, an arrow, a trail.
local variant = param("variant", "", "what is wrong on purpose", {choices = {"", "texture", "light", "shadows", "turn"}})
world { title = "Looks", duration = 0.2, frame_rate = 10 }
local turn = variant == "turn" and 0.8 or 0.3
local function at(x, y, z) return {x, y, z} end
plane { texture = "checker" }
plane { point = {0, 2, 1}, normal = {0, -1, 0.2}, size = {4, 1.5}, color = {0.3, 0.5, 0.8}, texture = "stripes" }
local a = sphere { radius = 0.5, position = at(-1.5, 0, 0.5), color = {0.8, 0.2, 0.1}, texture = "beachball",
	orientation = {axis = {1, 1, 0}, angle = turn}, velocity = {0, -1, 0} }
sphere { radius = 0.5, position = at(0, 0, 0.9), color = {0.1, 0.5, 0.2},
	texture = variant == "texture" and "stripes" or "checker", orientation = {axis = {1, 0, 1}, angle = turn} }
sphere { radius = 0.5, position = at(1.5, 0, 0.5), color = {0.9, 0.7, 0.1}, texture = "none" }
camera { name = "front", position = {0.5, -5, 2}, look_at = {0, 0, 0.6}, size = {160, 120}, shadows = variant ~= "shadows",
	vectors = "velocity", trails = {a}, overlay = {"time", "title"},
	lights = variant == "light" and {{direction = {1, 0.5, 0.6}}} or nil }
camera { name = "lamps", position = {-3, -4, 3}, look_at = {0, 0, 0.5}, size = {160, 120}, background = {0.1, 0.1, 0.2},
	lights = {{position = {2, -2, variant == "light" and 1 or 4}, color = {1, 0.8, 0.6}, intensity = 1.5},
		{direction = {-1, -1, 2}, color = {0.4, 0.5, 1}, intensity = 0.4}}, shadows = variant ~= "shadows" }
camera { name = "wire", position = {0.5, -5, 2}, look_at = {0, 0, 0.6}, size = {160, 120}, style = "wireframe" }
