world { duration = "1", gravity = 9.81, pause_on_collision = 1, title = 5, seed = 1.5 }
sphere { name = "ball", radius = "0.1", visible = "yes", static = 0, mass = {1} }
sphere { name = "list", radius = {1, 2}, group = 7, collides_with = 3, forces = 1 }
sphere(0.1)
sphere "ball"
sphere { 0.1 }
-- expect: :1: world: 'title' must be a text (got 5)
-- expect: :1: world: 'duration' must be a number (got the text '1')
-- expect: :1: world: 'gravity' must be a vector {x, y, z} (got 9.81)
-- expect: :1: world: 'seed' must be a whole number, 0 or more (got 1.5)
-- expect: :1: world: 'pause_on_collision' must be true or false (got 1)
-- expect: :2: sphere 'ball': 'radius' must be a number (got the text '0.1')
-- expect: :2: sphere 'ball': 'mass' must be a number (got {1})
-- expect: :2: sphere 'ball': 'static' must be true or false (got 0)
-- expect: :2: sphere 'ball': 'visible' must be true or false (got the text 'yes')
-- expect: :3: sphere 'list': 'radius' must be a number (got {1, 2})
-- expect: :3: sphere 'list': 'group' must be the name of a group (got 7)
-- expect: :3: sphere 'list': 'collides_with' must be a list of names of groups (got 3)
-- expect: :3: sphere 'list': 'forces' must be a list of tables {{vector = {...}}, ...} (got 1)
-- expect: :4: sphere: expected a table of keys, like sphere { ... } (got 0.1)
-- expect: :5: sphere: expected a table of keys, like sphere { ... } (got the text 'ball')
-- expect: :6: sphere: a value without a name (write key = value)
-- expect: :6: sphere: 'radius' is missing
