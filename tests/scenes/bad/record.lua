world { duration = 1 }
record { file = "/tmp/out.h5", every = 0, fields = {"position", "power"}, precision = "half", compression = 10 }
sphere { radius = 1 }
-- expect: :2: record: 'file' must be a path within the output folder (--trust lifts this) (got the text '/tmp/out.h5')
-- expect: :2: record: 'every' must be 1 or more (got 0)
-- expect: :2: record: 'fields' must be one of position, orientation, velocity, angular_velocity, contacts, events, acceleration, angular_acceleration, force, torque, joints, surfaces (got 'power')
-- expect: :2: record: 'precision' must be one of double, single (got 'half')
-- expect: :2: record: 'compression' must lie in [0, 9] (got 10)
