-- three spheres that attract each other, fall together and stay: one clock, impacts, contacts
world { duration = 3, frame_rate = 4, gravitation = {G = 1} }
local m = material { name = "m", restitution = 0.5, friction = 0 }
sphere { radius = 0.5, mass = 1, position = {-2, 0, 0}, material = m }
sphere { radius = 0.5, mass = 2, position = {2, 0.25, 0}, material = m }
sphere { radius = 0.25, mass = 0.5, position = {0, 3, 1}, gravitational_mass = 0, material = m }
