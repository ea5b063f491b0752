world { duration = 1 }
local function ball(i)
	return sphere { radius = 1, position = {3 * i, 0, 0}, mas = 1 }
end
for i = 1, 100 do ball(i) end
-- expect: :3: sphere: unknown key 'mas' (did you mean 'mass'?)
