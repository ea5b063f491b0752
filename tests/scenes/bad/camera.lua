world { duration = 1 }
local ball = sphere { radius = 1 }
camera { position = 3, look_at = "ball", up = {0, 0, 0} }
camera { position = {0, 0, 5}, look_at = {0, 0, 0} }
camera { position = {0, 0, 5}, look_at = {0, 0, 5} }
camera { offset = {1, 0, 0}, level = true, fov = 4, samples = 0, size = {640, 0.5} }
camera { mount = ball, position = {1, 0, 0}, near = 2, far = 1, from = 3, to = 2 }
camera { frustum = {1, -1, -1, 1, 1, 2}, fov = 1 }
camera { overlay = {"time", "tittle"}, vectors = "contacts", style = "wire", trails = {1}, background = {2, 0, 0} }
camera { png = "frames/pic.png", video = "film.avi" }
camera { png = "/tmp/%d.png", video = "../film.mp4", speed = 0 }
camera { lights = {{}, {position = {1, 1, 1}, intensity = -1}, {direction = {0, 0, 0}}}, postion = {1, 1, 1} }
camera { position = {0, -1, 0}, projection = "orthographic" }
camera { projection = "orthographic", fov = 1 }
camera { height = 2, projection = "perspective" }
camera { projection = "orthographic", frustum = {-1, 1, -1, 1, 1, 2}, height = 2 }
camera { projection = "parallel", height = 0 }
-- expect: :3: camera: 'position' must be a vector {x, y, z}, a body or a function (got 3)
-- expect: :3: camera: 'look_at' must be a vector {x, y, z}, a body or a function (got the text 'ball')
-- expect: :3: camera: 'up' must be a vector with a length (got {0, 0, 0})
-- expect: :4: camera: 'up' must not be along the line of sight
-- expect: :5: camera: 'position' and 'look_at' must not be the same point
-- expect: :6: camera: 'fov' must be between 0 and pi, in radians: deg(45) (got 4)
-- expect: :6: camera: 'size' must lie in [1, 16384] (got {640, 0.5})
-- expect: :6: camera: 'samples' must lie in [1, 64] (got 0)
-- expect: :6: camera: 'offset' goes with 'mount'
-- expect: :6: camera: 'level' goes with 'mount'
-- expect: :7: camera: 'mount' and 'position' exclude each other (use 'offset')
-- expect: :7: camera: 'near' must be less than 'far' (got 2 and 1)
-- expect: :7: camera: 'from' must not be after 'to' (got 3 and 2)
-- expect: :8: camera: 'frustum' excludes 'fov', 'height', 'near' and 'far'
-- expect: :8: camera: 'frustum' must be {left, right, bottom, top, near, far} with left < right, bottom < top and 0 < near < far
-- expect: :9: camera: 'background' must be a color with parts in [0, 1] (got {2, 0, 0})
-- expect: :9: camera: 'overlay' must be one of time, title, energy, scale (got 'tittle') (did you mean 'title'?)
-- expect: :9: camera: 'style' must be one of shaded, wireframe (got 'wire') (did you mean 'wireframe'?)
-- expect: :9: camera: trails[1]: must be a body or the name of one (got 1)
-- expect: :9: camera: 'vectors' must be one of velocity, contact, joint, spring, angular_velocity, acceleration, momentum, force (got 'contacts') (did you mean 'contact'?)
-- expect: :10: camera: 'png' must hold one %d for the number of the picture, like 'frames/%05d.png' (got 'frames/pic.png')
-- expect: :10: camera: 'video' must end in .mp4, .webm or .gif (got 'film.avi')
-- expect: :11: camera: 'png' must be a path within the output folder (--trust lifts this) (got the text '/tmp/%d.png')
-- expect: :11: camera: 'video' must be a path within the output folder (--trust lifts this) (got the text '../film.mp4')
-- expect: :11: camera: 'speed' must be positive (got 0)
-- expect: :12: camera: unknown key 'postion' (did you mean 'position'?)
-- expect: :12: camera: lights[1]: needs a 'kind', or one of 'position' and 'direction'
-- expect: :12: camera: lights[2]: 'intensity' must be 0 or more (got -1)
-- expect: :12: camera: lights[3]: 'direction' must be a vector with a length (got {0, 0, 0})
-- expect: :13: camera: an orthographic projection needs 'height', m
-- expect: :14: camera: an orthographic projection has no 'fov' (use 'height', m)
-- expect: :15: camera: 'height' goes with projection = "orthographic" (a perspective has 'fov')
-- expect: :16: camera: 'frustum' excludes 'fov', 'height', 'near' and 'far'
-- expect: :17: camera: 'projection' must be one of perspective, orthographic (got 'parallel')
-- expect: :17: camera: 'height' must be positive (got 0)
