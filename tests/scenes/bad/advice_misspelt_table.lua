world { duration = 1 }
local x = maht.pi
-- expect: :2: attempt to index a nil value (global 'maht') (did you mean 'math'?)
