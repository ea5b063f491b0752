world { duration = 1 }
sphere { radius = 1, mass = 1, density = 1 }
plane { normal = {0, 0, 1}, orientation = {1, 0, 0, 0} }
plane { point = {0, 0, 1}, position = {0, 0, 0} }
plane { axis = {1, 0, 0} }
plane { size = {1, 1}, axis = {0, 0, 2} }
plane { normal = {0, 0, 0} }
plane { velocity = {1, 0, 0}, angular_velocity = {0, 0, 1}, forces = {{vector = {1, 0, 0}}} }
plane { static = false }
sphere { radius = 1, forces = {{vector = {1, 0, 0}, direction = {1, 0, 0}}, {magnitude = 1}, {vector = {1, 0, 0}, duration = 0}, 5} }
sphere { radius = 1, forces = {{direction = {0, 0, 0}, magnitude = 1}, {vector = {1, 0, 0}, frame = "bdy"}} }
-- expect: :2: sphere: 'mass' and 'density' exclude each other
-- expect: :3: plane: 'normal' and 'orientation' exclude each other
-- expect: :4: plane: 'point' and 'position' exclude each other
-- expect: :5: plane: 'axis' goes with 'size': an infinite plane has no sides
-- expect: :6: plane: 'axis' must not be along the normal (got {0, 0, 2})
-- expect: :7: plane: 'normal' must be a vector with a length (got {0, 0, 0})
-- expect: :8: plane: 'velocity' of a static body: it never moves
-- expect: :8: plane: 'angular_velocity' of a static body: it never moves
-- expect: :8: plane: 'forces' of a static body: it never moves
-- expect: :9: plane: 'static' = false: an infinite plane has no mass, so that nothing can push it ('motion' says how it moves)
-- expect: :10: sphere: forces[1]: 'vector' excludes 'direction' and 'magnitude'
-- expect: :10: sphere: forces[2]: needs 'vector', or 'direction' and 'magnitude', or 'torque'
-- expect: :10: sphere: forces[3]: 'duration' must be positive (got 0)
-- expect: :10: sphere: forces[4]: must be a table of keys (got 5)
-- expect: :11: sphere: forces[1]: 'direction' must be a vector with a length (got {0, 0, 0})
-- expect: :11: sphere: forces[2]: 'frame' must be one of world, body (got 'bdy') (did you mean 'body'?)
