-- Two balls on a spring under a field and drag: forces without a closed form bring the integrator, and nothing else does.
world { method = "located", duration = 0.5 }
local a = sphere { radius = 0.125, position = {0, 0, 0}, group = "ghosts", collides_with = {} }
local b = sphere { radius = 0.125, position = {1, 0, 0}, group = "ghosts", collides_with = {} }
spring { a = a, b = b, stiffness = 10, rest_length = 0.5 }
drag { linear = 0.125 }
field(function(t, x, v) return {0, 0, 1} end)
