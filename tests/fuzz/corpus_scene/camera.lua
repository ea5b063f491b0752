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
