world { duration = 1 }
local s = sphere { name = "s", radius = 1 }
plane { point = {0, 0, s.z - 1} }
-- expect: :3: body s has no field 'z' (did you mean 'position.z'?)
