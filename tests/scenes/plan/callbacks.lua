-- Callbacks bring what they could need: columns of pushes, rotation, events for on_collision.
world { method = "classic", duration = 0.5 }
local hard = material { friction = 0, restitution = 1 }
local left = sphere { radius = 0.25, position = {-0.5, 0, 0}, velocity = {1, 0, 0}, material = hard }
sphere { radius = 0.25, position = {0.5, 0, 0}, material = hard }
on_step(function(t, dt) left:apply_force({0, 0, 1}) end)
on_collision(function(c) state.last = c.time end)
