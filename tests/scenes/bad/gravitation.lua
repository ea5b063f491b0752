world { duration = 1, gravitation = { g = 1, softening = -1, opening_angle = 2, G = "x" } }
sphere { radius = 1, gravitational_mass = -1 }
plane { gravitational_mass = 3 }
sphere { radius = 1, position = {5, 0, 0}, gravitational_mass = 1e400 }
-- expect: :1: world: gravitation: 'G' must be a number (got the text 'x')
-- expect: :1: world: gravitation: 'softening' must be 0 or more (got -1)
-- expect: :1: world: gravitation: 'opening_angle' must lie in [0, 1] (got 2)
-- expect: :1: world: gravitation: unknown key 'g' (did you mean 'G'?)
-- expect: :2: sphere: 'gravitational_mass' must be 0 or more (got -1)
-- expect: :4: sphere: 'gravitational_mass' must be finite (got inf)
