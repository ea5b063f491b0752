world { duration = 1, method = "stepped", rollback = "glbal" }
sphere { radius = 1 }
-- expect: :1: world: 'rollback' must be one of selective, global, none (got 'glbal') (did you mean 'global'?)
-- expect: :1: world: 'method' 'stepped': not in this version (this one has auto, classic, located)
