world { duration = 1, gravity = {0, 0} }
sphere { radius = 1, position = {1, 2, 3, 4}, velocity = {1}, orientation = {1, 0, 0} }
sphere { radius = 1, position = {9, 9, 9, w = 1}, color = {1, 1}, inertia = {1, 1} }
plane { size = {1, 2, 3} }
camera { size = {640}, frustum = {-1, 1, -1, 1, 1} }
sphere { radius = 1, position = {9, 0, "x"}, velocity = {0, {}, 1} }
-- expect: :1: world: 'gravity' must be a vector {x, y, z} (got {0, 0})
-- expect: :2: sphere: 'position' must be a vector {x, y, z} (got {1, 2, 3, 4})
-- expect: :2: sphere: 'orientation' must be {w, x, y, z} or {axis = {x, y, z}, angle = radians} (got {1, 0, 0})
-- expect: :2: sphere: 'velocity' must be a vector {x, y, z} (got {1})
-- expect: :3: sphere: 'inertia' must be {Ix, Iy, Iz} or three rows of three numbers (got {1, 1})
-- expect: :3: sphere: 'position' must be a vector {x, y, z} (got a list with the key 'w')
-- expect: :3: sphere: 'color' must be a color {r, g, b} or '#rrggbb', like '#ff0000' for red (got {1, 1})
-- expect: :4: plane: 'size' must be a list of 2 numbers (got {1, 2, 3})
-- expect: :5: camera: 'frustum' must be a list of 6 numbers (got a table)
-- expect: :5: camera: 'size' must be a list of 2 numbers (got {640})
-- expect: :6: sphere: 'position' must be a vector {x, y, z} (got {9, 0, 'x'})
-- expect: :6: sphere: 'velocity' must be a vector {x, y, z} (got a table)
