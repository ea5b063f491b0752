-- A rough ball on a floor under gravity: friction brings rotation with its columns; nothing bounces.
world { method = "classic", duration = 0.5, gravity = {0, 0, -9.81} }
local felt = material { friction = 0.3, restitution = 0 }
plane { normal = {0, 0, 1}, material = felt }
sphere { radius = 0.125, position = {0, 0, 0.125}, velocity = {2, 0, 0}, material = felt }
