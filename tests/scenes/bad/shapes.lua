world { duration = 1 }
box { name = "slab", size = {1, 2, -3} }
box { size = {1, 2} }
box { siez = {1, 2, 3} }
capsule { radius = 1 }
cylinder { radius = 0, length = 1 / 0 }
hull { points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}} }
hull { points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}} }
hull { points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, "1"}} }
hull { points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0 / 0}} }
hull { points = 3 }
body { shapes = {} }
body { name = "u", shapes = {{ shape = "box", size = {1, 1, 1}, radius = 2 }, { shape = "cone" }, {}, 3} }
body { shapes = {{ shape = "hull", points = {{0, 0, 0}} }, { shape = "sphere" }} }
body { name = "none" }
-- expect: :2: box 'slab': 'size' must be positive (got {1, 2, -3})
-- expect: :3: box: 'size' must be a list of 3 numbers (got {1, 2})
-- expect: :4: box: unknown key 'siez' (did you mean 'size'?)
-- expect: :5: capsule: 'length' is missing
-- expect: :6: cylinder: 'radius' must be positive (got 0)
-- expect: :6: cylinder: 'length' must be finite (got inf)
-- expect: :7: hull: 'points': 4 points that lie in a plane, to the rounding of their coordinates (wanted a body with a volume)
-- expect: :8: hull: 'points': 3 points have no hull (wanted at least 4)
-- expect: :9: hull: 'points' must be a list of points {x, y, z} (got {1, 1, '1'} at 4)
-- expect: :10: hull: 'points': point 4 is not finite
-- expect: :11: hull: 'points' must be a list of points {{x, y, z}, ...} (got 3)
-- expect: :12: body: 'shapes' must be a list of 1 to 65536 tables {{shape = 'box', size = {...}}, ...} (got {})
-- expect: :13: body 'u': shapes[1]: 'radius' of a box: it has none
-- expect: :13: body 'u': shapes[2]: 'shape' must be one of sphere, box, capsule, cylinder, hull (got 'cone')
-- expect: :13: body 'u': shapes[3]: 'shape' is missing
-- expect: :13: body 'u': shapes[4]: must be a table of keys (got 3)
-- expect: :14: body: shapes[1]: 'points': 1 point has no hull (wanted at least 4)
-- expect: :14: body: shapes[2]: 'radius' is missing
-- expect: :15: body 'none': 'shapes' is missing
