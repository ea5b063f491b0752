-- One ball that meets nobody: no search, no points, no turning.
world { duration = 0.5, frame_rate = 10, gravity = {0, 0, -8}, method = "stepped" }
sphere { radius = 0.5, position = {0, 0, 4}, velocity = {1, 2, 3} }
