world { duration = 1, dt = 0.1, fps = 25 }
sphere { radius = 1, restitution = 0.5, friction = 1, color = "red" }
camera { fov = 45 }
hinge { axis = {0, 0, 1} }
-- expect: :1: world: unknown key 'dt' (did you mean 'time_step'?)
-- expect: :1: world: unknown key 'fps' (did you mean 'frame_rate'?)
-- expect: :2: sphere: 'color' must be a color {r, g, b} or '#rrggbb', like '#ff0000' for red (got the text 'red')
-- expect: :2: sphere: unknown key 'friction' (it belongs to a material: material { ... })
-- expect: :2: sphere: unknown key 'restitution' (it belongs to a material: material { ... })
-- expect: :3: camera: 'fov' must be between 0 and pi, in radians: deg(45) (got 45)
-- expect: :4: attempt to call a nil value (global 'hinge') (joint { kind = "hinge", a = ..., b = ..., at = ..., axis = ... })
