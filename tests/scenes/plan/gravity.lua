-- One ball in free fall: gravity and positions; nobody to meet, nothing to turn it.
world { method = "classic", duration = 0.5, gravity = {0, 0, -9.81} }
sphere { radius = 0.1, position = {0, 0, 2}, velocity = {1, 0, 3} }
