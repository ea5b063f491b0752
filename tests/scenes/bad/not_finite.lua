world { duration = 1 / 0, gravity = {0, 0, 0 / 0} }
sphere { name = "ball", radius = math.huge, position = {0, -1 / 0, 0}, mass = 0 / 0 }
sphere { radius = 1, orientation = {0 / 0, 0, 0, 0}, inertia = {1, 1, 1 / 0} }
sphere { radius = 1, orientation = {axis = {0, 0, 1}, angle = 1 / 0} }
-- expect: :1: world: 'duration' must be finite (got inf)
-- expect: :1: world: 'gravity' must be finite (got {0, 0, nan})
-- expect: :2: sphere 'ball': 'radius' must be finite (got inf)
-- expect: :2: sphere 'ball': 'mass' must be finite (got nan)
-- expect: :2: sphere 'ball': 'position' must be finite (got {0, -inf, 0})
-- expect: :3: sphere: 'inertia' must be finite (got {1, 1, inf})
-- expect: :3: sphere: 'orientation' must be finite (got {nan, 0, 0, 0})
-- expect: :4: sphere: 'orientation': 'axis' and 'angle' must be finite (got {0, 0, 1} and inf)
