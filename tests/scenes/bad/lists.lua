local kind = param("kind", "a", "x", {choices = {"a", "b", q = "c"}})
body { shapes = {{ shape = "sphere", radius = 1 }, z = { shape = "box" }}, position = {0, 0, 9} }
hull { points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, w = {1, 2, 3}} }
local s = sphere { name = "s", radius = 0.1, forces = {{ vector = {0, 0, 1} }, y = 3, x = 2 } }
local t = sphere { name = "t", radius = 0.1, position = {0, 0, 2}, particles = {{ mass = 1, position = {0, 0, 0} }, k = 3} }
box { size = {1, 1, 1}, inertia = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, q = 3} }
joint { kind = "slider", a = s, b = t, axis = {1, 0, 0}, limits = {0, 1, x = 2} }
camera { name = "front", vectors = {"velocity", k = "force"} }
film { rows = {{"front", x = "top"}}, video = "a.mp4" }
-- expect: :1: param 'kind': 'choices' must be a list of numbers, texts or booleans (got a list with the key 'q')
-- expect: :2: body: 'shapes' must be a list of 1 to 65536 tables {{shape = 'box', size = {...}}, ...} (got a list with the key 'z')
-- expect: :3: hull: 'points' must be a list of points {{x, y, z}, ...} (got a list with the key 'w')
-- expect: :4: sphere 's': 'forces' must be a list of tables {{vector = {...}}, ...} (got a list with the key 'x')
-- expect: :5: sphere 't': 'particles' must be a list of tables {{mass = ..., position = {...}}, ...} (got a list with the key 'k')
-- expect: :6: box: 'inertia' must be {Ix, Iy, Iz} or three rows of three numbers (got a list with the key 'q')
-- expect: :7: joint: 'limits' must be {low, high} (got a list with the key 'x')
-- expect: :8: camera 'front': vectors: unknown key 'k'
-- expect: :9: film: rows[1]: must be a list of names of cameras, 16 in all rows at most (got a list with the key 'x')
