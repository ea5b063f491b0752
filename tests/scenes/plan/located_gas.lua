-- Four smooth balls between two walls, located: impacts in order of time, and no substep. Nothing could turn a ball.
world { method = "located", duration = 2 }
local hard = material { friction = 0, restitution = 1 }
plane { normal = {1, 0, 0}, point = {-1, 0, 0}, material = hard }
plane { normal = {-1, 0, 0}, point = {1, 0, 0}, material = hard }
for k = 0, 3 do
	sphere { radius = 0.125, position = {0.5 * k - 0.75, 0.03125 * k, 0}, velocity = {2 - k, 0, 0}, material = hard }
end
