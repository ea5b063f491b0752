world { duration = 1, method = "stepwise", rollback = "glbal" }
sphere { radius = 1 }
-- expect: :1: world: 'rollback' must be one of selective, global, none (got 'glbal') (did you mean 'global'?)
-- expect: :1: world: 'method' must be one of auto, classic, located, stepped (got 'stepwise')
