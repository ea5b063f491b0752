-- SPDX-License-Identifier: MIT
-- For spoil.py: bodies of all shapes that fly, bounce, slide, rest and hang on a spring; one with its centre of mass off
-- its origin; gravity as an acceleration and as a force. Every check has something to look at.
world { duration = 0.6, frame_rate = 60, gravity = {0.3, 0, -9.81}, gravity_force = {0, 0.2, -0.5} }
local stuff = material { name = "stuff", density = 700, friction = 0.4, restitution = 0.6 }
local dull = material { name = "dull", density = 900, friction = 0.5, restitution = 0 }
plane { name = "floor", material = dull }
plane { name = "shelf", point = {3, 0, 0.5}, size = {1, 1}, normal = {0.1, 0, 1}, material = dull }
sphere { name = "ball", radius = 0.1, position = {0, 0, 0.4}, velocity = {0.4, 0.2, 0}, material = stuff,
	angular_velocity = {1, 20, 3} }
sphere { name = "odd", radius = 0.1, position = {0.8, 0, 0.5}, center_of_mass = {0.02, 0.01, 0}, material = stuff,
	velocity = {0.1, 0, -1}, angular_velocity = {3, 1, -2} }
box { name = "slab", size = {0.3, 0.2, 0.1}, position = {-0.8, 0, 0.05}, velocity = {1, 0.5, 0}, material = dull }
box { name = "stacked", size = {0.1, 0.1, 0.1}, position = {1.6, 0.8, 0.05}, material = dull }
box { name = "top", size = {0.1, 0.08, 0.06}, position = {1.6, 0.81, 0.13}, material = dull }
box { name = "tumbler", size = {0.1, 0.2, 0.3}, position = {1.6, 0, 1}, orientation = {axis = {1, 2, 3}, angle = 0.7},
	angular_velocity = {2, 3, 1}, velocity = {0, 0, -3}, material = stuff }
capsule { name = "pin", radius = 0.05, length = 0.2, position = {0, 1.5, 0.6}, orientation = {axis = {1, 0, 0.3}, angle = 1},
	velocity = {0, 0, -2}, material = stuff }
cylinder { name = "tin", radius = 0.08, length = 0.2, position = {0.8, 1.5, 0.7}, orientation = {axis = {0, 1, 0.2}, angle = 0.5},
	velocity = {0, 0, -2}, material = stuff }
hull { name = "stone", points = {{0, 0, 0}, {0.2, 0, 0}, {0, 0.25, 0}, {0, 0, 0.3}, {0.15, 0.15, 0.2}}, position = {-0.8, 1.5, 0.6},
	velocity = {0, 0, -1}, angular_velocity = {1, 1, 0}, material = stuff }
body { name = "club", material = stuff, position = {-1.6, 1.5, 0.8}, velocity = {0, 0, -2}, angular_velocity = {0, 3, 0.5}, shapes = {
	{ shape = "sphere", radius = 0.08, position = {0.2, 0, 0} }, { shape = "cylinder", radius = 0.03, length = 0.4,
	orientation = {axis = {0, 1, 0}, angle = deg(90)} } } }
sphere { name = "left", radius = 0.1, position = {-2, -2, 0.8}, velocity = {2, 0, 1}, material = stuff }
sphere { name = "right", radius = 0.12, position = {-1.4, -1.95, 0.8}, velocity = {-1, 0, 1}, material = stuff }
sphere { name = "shelved", radius = 0.05, position = {2.95, 0, 0.9}, velocity = {0, 0.1, 0}, material = stuff }
local weight = sphere { name = "weight", radius = 0.1, position = {0, -3, 2}, material = stuff, velocity = {0.5, 0, 0} }
local hook = sphere { name = "hook", radius = 0.05, position = {0, -3, 3}, static = true, material = dull }
spring { a = hook, b = weight, stiffness = 200, damping = 0, rest_length = 0.8, at_b = {0, 0, 0.1} }
record { fields = {"position", "orientation", "velocity", "angular_velocity", "contacts", "events"} }
