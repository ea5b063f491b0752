local e = param("e", 0.8, "restitution", {min = 0, max = 1})
world { title = "t", duration = 1, frame_rate = 60, gravity = {0, 0, -9.81}, seed = 3, method = "auto" }
local m = material { name = "m", density = 1100, friction = 0.6, restitution = e, color = "#ff8000" }
contact_pair(m, "m", { friction = 0.1 })
plane { normal = {0, 0, 1}, material = m, texture = "checker", size = {4, 4}, axis = {1, 0, 0} }
local b = sphere { name = "b", radius = 0.1, position = vec3(0, 0, 2), material = "m", group = "g", collides_with = {"h"},
  orientation = {axis = {0, 0, 1}, angle = deg(90)}, inertia = {1, 1, 1}, mass = 2, forces = {{vector = {1, 0, 0}, start = 1}} }
camera { name = "c", position = function(t) return {t, 0, 3} end, look_at = b, lights = {{position = {1, 1, 1}}}, overlay = {"time"} }
record { every = 2, fields = {"position"}, precision = "single" }
on_step(function(t, dt) b:apply_force({1, 0, 0}) end)
on_collision(function(c) state.n = c.time end)
expect("x", function() return b.position.z, 1 end)
expect_always("y", function() return true end)
expect_refused(65, "unknown key '%w+'")
