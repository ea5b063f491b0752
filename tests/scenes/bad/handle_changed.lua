local ball = sphere { radius = 1 }
ball:set_velocity {1, 0, 0}
-- expect: :2: set_velocity: only in on_step, on_frame, on_collision and on_transition
