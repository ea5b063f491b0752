local ball = sphere { radius = 1 }
ball.velocity = {1, 0, 0}
-- expect: :2: a body's 'velocity' can't be assigned: call body:set_velocity(v) in a callback
