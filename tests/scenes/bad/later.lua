world { duration = 1, gravitation = { G = 1 }, method = "stepped" }
sphere { radius = 1 }
-- expect: :1: world: 'gravitation': not in this version
-- expect: :1: world: 'method' 'stepped': not in this version (this one has auto, classic, located)
