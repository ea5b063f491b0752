world { duration = 1 }
sphere { name = "ball_1", radius = 1 }
plane { point = {0, 0, ball_1.position.z - 1} }
-- expect: :3: attempt to index a nil value (global 'ball_1') (body "ball_1" gives the body of that name)
