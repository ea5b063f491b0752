world { duration = 1, gravitation = { G = 1 }, method = "stepped" }
local b = box { size = {1, 1, 1} }
capsule { radius = 1, length = 2 }
cylinder { radius = 1, length = 2 }
hull { points = {} }
body { shapes = {} }
camera { look_at = b }
-- expect: :1: world: 'gravitation': not in this version
-- expect: :1: world: 'method' 'stepped': not in this version (this one has auto, classic, located)
-- expect: :2: box: not in this version
-- expect: :3: capsule: not in this version
-- expect: :4: cylinder: not in this version
-- expect: :5: hull: not in this version
-- expect: :6: body: not in this version (body 'NAME' gives the body of that name)
