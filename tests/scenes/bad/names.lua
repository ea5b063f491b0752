world { duration = 1 }
world { duration = 2 }
record { every = 2 }
record { every = 3 }
material { name = "m" }
material { name = "m" }
sphere { name = "ball", radius = 1 }
plane { name = "ball" }
sphere { name = "", radius = 1 }
camera { name = "main" }
camera { name = "main" }
-- expect: :2: world: called twice (first on line 1)
-- expect: :4: record: called twice (first on line 3)
-- expect: :6: material 'm': name 'm' is taken by the material of line 5
-- expect: :8: plane 'ball': name 'ball' is taken by the body of line 7
-- expect: :9: sphere '': 'name' must not be empty
-- expect: :11: camera 'main': name 'main' is taken by the camera of line 10
