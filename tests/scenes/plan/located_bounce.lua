-- A smooth ball that bounces and comes to rest, located: gravity is part of its flight.
world { method = "located", duration = 2, gravity = {0, 0, -9.81} }
local rubber = material { friction = 0, restitution = 0.5 }
plane { normal = {0, 0, 1}, material = rubber }
sphere { radius = 0.125, position = {0, 0, 1.125}, velocity = {0.5, 0, 0}, material = rubber }
