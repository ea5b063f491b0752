world { duration = 1 }
local a = sphere { name = "a", radius = 1 }
local b = sphere { name = "b", radius = 1, position = {3, 0, 0} }
local floor = plane { point = {0, 0, -1} }
local fan = sphere { radius = 1, motion = function(t) return {9, 0, t} end }
spring { a = a, b = a, stiffness = 1 }
spring { a = floor, b = fan, stiffness = 1 }
spring { a = "a", b = "bb", stiffness = 1 }
spring { a = 5, b = b, stiffness = 1 }
spring { a = a }
spring { a = a, b = b, stifness = 1 }
spring { a = a, b = b, stiffness = -1, damping = 1/0, rest_length = "long", at_a = {1, 2}, at_b = 3 }
spring(a, b)
spring { a, b, stiffness = 1 }
drag {}
drag { linear = -1 }
drag { quadratic = 0/0, cubic = 1 }
drag(1)
field()
field { 1, 2, 3 }
on_transition(5)
-- expect: :6: spring: both ends are on the same body
-- expect: :7: spring: nothing can move either end: one must be on a body that is neither static nor driven
-- expect: :8: spring: 'b': no body is named 'bb' so far (did you mean 'b'?)
-- expect: :9: spring: 'a' must be a body or the name of one (got 5)
-- expect: :10: spring: 'b' is missing
-- expect: :10: spring: 'stiffness' is missing
-- expect: :11: spring: unknown key 'stifness' (did you mean 'stiffness'?)
-- expect: :12: spring: 'stiffness' must be 0 or more (got -1)
-- expect: :12: spring: 'damping' must be finite (got inf)
-- expect: :12: spring: 'rest_length' must be a number (got the text 'long')
-- expect: :12: spring: 'at_a' must be a vector {x, y, z} (got {1, 2})
-- expect: :12: spring: 'at_b' must be a vector {x, y, z} (got 3)
-- expect: :13: spring: expected a table of keys, like spring { ... } (got a body)
-- expect: :14: spring: a value without a name (write key = value)
-- expect: :14: spring: 'a' is missing
-- expect: :14: spring: 'b' is missing
-- expect: :15: drag: needs 'linear', 'quadratic' or both
-- expect: :16: drag: 'linear' must be 0 or more (got -1)
-- expect: :17: drag: 'quadratic' must be finite (got nan)
-- expect: :17: drag: unknown key 'cubic'
-- expect: :18: drag: expected a table of keys, like drag { ... } (got 1)
-- expect: :19: field: expected a function of t, x and v (got nothing)
-- expect: :20: field: expected a function of t, x and v (got {1, 2, 3})
-- expect: :21: on_transition: expected a function (got 5)
