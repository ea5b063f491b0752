world { time = 1, fps = 30 }
local s = sphere { radius = 1, angle = 30 }
joint { type = "ball", a = s }
-- expect: :1: world: unknown key 'fps' (did you mean 'frame_rate'?)
-- expect: :1: world: unknown key 'time' (did you mean 'duration'?)
-- expect: :2: sphere: unknown key 'angle' (did you mean 'orientation'?)
-- expect: :3: joint: unknown key 'type' (did you mean 'kind'?)
