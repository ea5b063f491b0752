world { duration = 1 }
local ball = sphere { name = "ball", radius = 1 }
local lost = body "bal"
body(3)
camera { look_at = lost }
-- expect: :3: body: no body is named 'bal' so far (did you mean 'ball'?)
-- expect: :4: body: expected the name of a body or a table of keys (got 3)
