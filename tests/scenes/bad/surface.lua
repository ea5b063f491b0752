world { duration = 1 }
local a = material { name = "a", friction = -0.1, restitution = 1.1 }
local b = material { name = "b", restitution = -0.1 }
contact_pair(a, b, { friction = -1, restitution = 2 })
contact_pair(b, "a", { friction = 1 })
contact_pair("a", "c", { friktion = 1 })
contact_pair(a, nil, { friction = 1 })
sphere { radius = 1, material = "bb" }
sphere { radius = 1, material = 5 }
-- expect: :2: material 'a': 'friction' must be 0 or more (got -0.1)
-- expect: :2: material 'a': 'restitution' must lie in [0, 1] (got 1.1)
-- expect: :3: material 'b': 'restitution' must lie in [0, 1] (got -0.1)
-- expect: :4: contact_pair: 'friction' must be 0 or more (got -1)
-- expect: :4: contact_pair: 'restitution' must lie in [0, 1] (got 2)
-- expect: :5: contact_pair: these two materials have an entry already
-- expect: :6: contact_pair: the second: no material is named 'c' so far
-- expect: :6: contact_pair: unknown key 'friktion' (did you mean 'friction'?)
-- expect: :7: contact_pair: the second must be a material or the name of one (got nothing)
-- expect: :8: sphere: 'material': no material is named 'bb' so far (did you mean 'b'?)
-- expect: :9: sphere: 'material' must be a material or the name of one (got 5)
