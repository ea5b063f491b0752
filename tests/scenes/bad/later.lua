world { duration = 1, gravitation = { G = 1 }, method = "auto" }
sphere { radius = 1 }
-- expect: :1: world: 'gravitation': not in this version
