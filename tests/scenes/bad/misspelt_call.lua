world { duration = 1 }
local r = 1
sphere { radius = r, colour = {1, 1, 1} }
shpere { radius = 1 }
-- expect: :3: sphere: unknown key 'colour' (did you mean 'color'?)
-- expect: :4: attempt to call a nil value (global 'shpere') (did you mean 'sphere'?)
