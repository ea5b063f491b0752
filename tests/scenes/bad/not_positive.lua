world { duration = 0, frame_rate = -60, time_step = 0, tolerance = 0 }
material { density = 0 }
sphere { radius = 0, mass = 1 }
sphere { radius = -1, density = -5 }
sphere { radius = 1e-320, mass = 0, inertia = {1, 0, 1} }
plane { size = {0, 1} }
sphere { radius = 1, mass = 1e-308 }
-- expect: :1: world: 'duration' must be positive (got 0)
-- expect: :1: world: 'frame_rate' must be positive (got -60)
-- expect: :1: world: 'time_step' must be positive (got 0)
-- expect: :1: world: 'tolerance' must be positive (got 0)
-- expect: :2: material: 'density' must be positive (got 0)
-- expect: :3: sphere: 'radius' must be positive (got 0)
-- expect: :4: sphere: 'radius' must be positive (got -1)
-- expect: :4: sphere: 'density' must be positive (got -5)
-- expect: :5: sphere: 'radius' must be positive, and not below 2.3e-308 (got 9.9998886718268e-321)
-- expect: :5: sphere: 'mass' must be positive (got 0)
-- expect: :5: sphere: 'inertia' must be positive (got {1, 0, 1})
-- expect: :6: plane: 'size' must be positive (got {0, 1})
-- expect: :7: sphere: 'mass' must be positive, and not below 2.3e-308 (got 1e-308)
