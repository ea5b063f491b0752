world { duration = 1 }
sphere { radius = 1, orientation = {1, 0, 0, 0.1} }
sphere { radius = 1, orientation = {0, 0, 0, 0} }
sphere { radius = 1, orientation = {axis = {0, 0, 0}, angle = 1} }
sphere { radius = 1, orientation = {axis = {0, 0, 1}} }
sphere { radius = 1, orientation = {axis = {0, 0, 1}, angle = 1, angel = 2} }
sphere { radius = 1, orientation = {1.0009, 0, 0, 0} }
-- expect: :2: sphere: 'orientation' must be a quaternion of length 1, within 1e-3 (got length 1.00498756211)
-- expect: :3: sphere: 'orientation' must be a quaternion of length 1, within 1e-3 (got length 0)
-- expect: :4: sphere: 'orientation': 'axis' must have a length (got {0, 0, 0})
-- expect: :5: sphere: 'orientation' must be {w, x, y, z} or {axis = {x, y, z}, angle = radians} (got a table)
-- expect: :6: sphere: 'orientation' must be {w, x, y, z} or {axis = {x, y, z}, angle = radians} (got a table)
