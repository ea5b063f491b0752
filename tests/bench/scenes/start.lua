-- A ball over a floor and one step: what it takes to start. No camera, no expectation.
world { duration = 1 / 240, frame_rate = 240, time_step = 1 / 240, gravity = {0, 0, -9.81} }
plane { normal = {0, 0, 1} }
sphere { radius = 0.1, position = {0, 0, 1} }
