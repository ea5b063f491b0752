-- A ball falls and bounces; its own numbers are a result and a probe.
local e = param("e", 0.8, "restitution", {min = 0, max = 1})
world { title = "A falling ball", duration = 3, gravity = {0, 0, -9.81} }
local rubber = material { name = "rubber", density = 1100, friction = 0.6, restitution = e }
plane { normal = {0, 0, 1}, material = rubber }
local ball = sphere { name = "ball", radius = 0.1, position = {0, 0, 2}, material = rubber }
record { fields = {"+", "events"} }
probe("height", function() return ball.position.z - 0.1 end, {unit = "m", description = "of the lowest point"})
result("bounces", collisions)
result("energy kept", function() return ball.kinetic_energy + ball.mass * 9.81 * (ball.position.z - 0.1) end, {unit = "J"})
