-- Two balls on their way, which may not touch: nothing but positions is left to do.
world { method = "classic", duration = 0.5 }
sphere { radius = 0.5, position = {-1, 0, 0}, velocity = {1, 0.25, 0}, group = "ghosts", collides_with = {} }
sphere { radius = 0.5, position = {1, 0, 0}, velocity = {-1, 0, 0.75}, group = "ghosts", collides_with = {} }
