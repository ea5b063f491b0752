world { duration = 1 }
local m = material { name = "m", texture = "a.png" }
local b = sphere { name = "b", radius = 1, texture = "a.png", angular_velocity = {0, 0, 1} }
plane { name = "floor", point = {0, 0, -2}, texture = "none" }
camera { position = function(t) return body "b".position + {t, math.random(), 1} end,
  look_at = function() return body "floor".point({1, 0, 0}) end, up = function() return {0, energy(), time()} end }
