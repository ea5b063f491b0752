world { duration = 1 }
local function still() return {0, 0, 0} end
sphere { radius = 1, motion = 5 }
sphere { radius = 1, motion = still, static = true }
sphere { radius = 1, motion = still, mass = 1, inertia = {1, 1, 1}, center_of_mass = {0, 0, 0.1}, density = 1 }
sphere { radius = 1, motion = still, velocity = {1, 0, 0}, angular_velocity = {0, 0, 1}, forces = {{vector = {1, 0, 0}}} }
plane { static = false, size = {1, 1} }
plane { motion = still, static = true }
sphere { name = "gone", radius = 1, motion = function(t) end }
sphere { radius = 1, motion = function(t) return {1, 2} end }
sphere { radius = 1, motion = function(t) return {0, 0, 1 / 0} end }
sphere { radius = 1, motion = function(t) return {0, 0, 0}, {1, 1, 0, 0} end }
sphere { radius = 1, motion = function(t) return {0, 0, 0}, 1 end }
sphere { radius = 1, motion = function(t) return {0, 0, 0}, nil, "fast" end }
sphere { radius = 1, motion = function(t) return {0, 0, 0}, nil, nil, {0, 0, 1} end }
sphere { radius = 1, motion = function(t) return {0, 0, 0}, {1, 0, 0, 0}, nil, 7 end }
sphere { radius = 1, motion = function(t)
	return t.x
end }
sphere { radius = 1, position = {1, 0, 0}, motion = still }
plane { normal = {1, 0, 0}, motion = function(t) return {0, 0, 0}, {1, 0, 0, 0} end }
sphere { radius = 1, motion = function(t) return {0, 0, 0}, {axis = {0, 0, 0}, angle = 1} end }
-- expect: :3: sphere: 'motion' must be a function (got 5)
-- expect: :4: sphere: 'motion' of a static body: it never moves
-- expect: :5: sphere: 'mass' and 'density' exclude each other
-- expect: :5: sphere: 'mass' of a driven body: nothing pushes it
-- expect: :5: sphere: 'density' of a driven body: nothing pushes it
-- expect: :5: sphere: 'center_of_mass' of a driven body: nothing pushes it
-- expect: :5: sphere: 'inertia' of a driven body: nothing pushes it
-- expect: :6: sphere: 'forces' of a driven body: nothing pushes it
-- expect: :6: sphere: 'velocity' of a driven body: 'motion' says how it moves
-- expect: :6: sphere: 'angular_velocity' of a driven body: 'motion' says how it moves
-- expect: :7: plane: 'static' = false: a plane without thickness has no mass, so that nothing can push it ('motion' says how it moves)
-- expect: :8: plane: 'motion' of a static body: it never moves
-- expect: :9: 'motion' must return a finite position {x, y, z} first (got nothing) (sphere 'gone' at t = 0 s)
-- expect: :10: 'motion' must return a finite position {x, y, z} first (got {1, 2}) (sphere #7 at t = 0 s)
-- expect: :11: 'motion' must return a finite position {x, y, z} first (got {0, 0, inf}) (sphere #8 at t = 0 s)
-- expect: :12: 'motion' must return an orientation of length 1, within 1e-3 (got {1, 1, 0, 0}) (sphere #9 at t = 0 s)
-- expect: :13: 'motion' must return an orientation {w, x, y, z} or {axis = {x, y, z}, angle = radians} (got 1) (sphere #10 at t = 0 s)
-- expect: :14: 'motion' must return a finite velocity {x, y, z} third (got the text 'fast') (sphere #11 at t = 0 s)
-- expect: :15: 'motion' must return an orientation as well where it returns an angular velocity (got {0, 0, 1}) (sphere #12 at t = 0 s)
-- expect: :16: 'motion' must return a finite angular velocity {x, y, z} fourth (got 7) (sphere #13 at t = 0 s)
-- expect: :18: attempt to index a number value (local 't') (sphere #14 at t = 0 s)
-- expect: :20: its position and the one that 'motion' returns differ: leave one out (sphere #15 at t = 0 s)
-- expect: :21: its orientation and the one that 'motion' returns differ: leave one out (plane #16 at t = 0 s)
-- expect: :22: 'motion' must return an orientation whose axis has a length (got a table) (sphere #17 at t = 0 s)
