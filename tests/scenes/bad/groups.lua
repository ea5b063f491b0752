for i = 1, 64 do
	sphere { radius = 0.1, position = {i, 0, 0}, group = "g" .. i, collides_with = {"g1", k = 1} }
end
-- expect: :2: sphere: 'collides_with' must be a list of names of groups (got a list with the key 'k')
-- expect: :2: sphere: 'group': group 'g64' is one too many (wanted at most 63 groups)
-- expect: :2: sphere: 'collides_with' must be a list of names of groups (got a list with the key 'k')
