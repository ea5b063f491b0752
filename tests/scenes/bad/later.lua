world { duration = 1, gravitation = { G = 1 }, method = "located" }
local b = box { size = {1, 1, 1} }
capsule { radius = 1, length = 2 }
cylinder { radius = 1, length = 2 }
hull { points = {} }
body { shapes = {} }
spring { a = b, b = b }
drag { linear = 1 }
field(function() end)
on_transition(function() end)
sphere { radius = 1, motion = function(t) return {0, 0, t} end }
camera { look_at = b }
-- expect: :1: world: 'gravitation': not in this version
-- expect: :1: world: 'method' 'located': not in this version (this one has auto, classic)
-- expect: :2: box: not in this version
-- expect: :3: capsule: not in this version
-- expect: :4: cylinder: not in this version
-- expect: :5: hull: not in this version
-- expect: :6: body: not in this version
-- expect: :7: spring: not in this version
-- expect: :8: drag: not in this version
-- expect: :9: field: not in this version
-- expect: :10: on_transition: not in this version
-- expect: :11: sphere: 'motion': not in this version
