world { duration = 1 }
local ball = sphere { name = "ball", radius = 1 }
camera { name = "front", trails = {ball, "bal", 5} }
camera { trails = ball, labels = ball, plots = "energy" }
camera { labels = {"bal", 5, {ball, 7}, {ball}, {ball, "A", size = 1}, {"A", "text\0"}} }
camera { text = 5 }
camera { text = {"a", {"b", at = {2, 0}}, {"c", sise = 1}, {"d", size = 0}, {at = {0, 0}}, {"e", "f", at = {0, 1}}, 7} }
camera { text = {"one", at = {0, 0, 0}, sise = 0.1} }
camera { text = {at = {0, 0}} }
camera { text = {"1", "2", "3", "4", "5", "6", "7", "8", "9"} }
camera { vectors = {"velocity", "velocty", {"force", scale = -1}, {"contact", bodys = {ball}}, {"joint", bodies = {}}} }
camera { vectors = {"velocity", bodies = {ball, "bal"}, scale = "big"} }
camera { vectors = {{5, bodies = {ball}}, {"force", bodies = ball}, "momentum", {"momentum", scale = 1}} }
camera { vectors = 5 }
camera { plots = {"energi", 5, {"ball.zz", at = {0, -1}}, {"ball.z", size = {0, 1}}} }
camera { plots = {{"ball.z", sizes = {1, 1}}, {at = {0, 0}}} }
-- expect: :3: camera 'front': trails[2]: no body is named 'bal' so far (did you mean 'ball'?)
-- expect: :3: camera 'front': trails[3]: must be a body or the name of one (got 5)
-- expect: :4: camera: 'trails' must be a list of at most 64 bodies (got a body)
-- expect: :4: camera: 'labels' must be a list of at most 64 bodies (got a body)
-- expect: :4: camera: 'plots' must be a list of at most 4 names (got the text 'energy')
-- expect: :5: camera: labels[1]: no body is named 'bal' so far (did you mean 'ball'?)
-- expect: :5: camera: labels[2]: must be a body or the name of one (got 5)
-- expect: :5: camera: labels[3][2]: must be a text (got 7)
-- expect: :5: camera: labels[4][2]: must be a text (got nothing)
-- expect: :5: camera: labels[5]: unknown key 'size'
-- expect: :5: camera: labels[6][1]: no body is named 'A' so far
-- expect: :5: camera: labels[6][2]: must be a text without zero bytes (got the text 'text')
-- expect: :6: camera: 'text' must be a text or a function, or {TEXT, at = {x, y}, size = s} (got 5)
-- expect: :7: camera: text[2]: 'at' must lie in [0, 1] (got {2, 0})
-- expect: :7: camera: text[3]: unknown key 'sise' (did you mean 'size'?)
-- expect: :7: camera: text[4]: 'size' must be above 0 and at most 1 (got 0)
-- expect: :7: camera: text[5][1]: must be a text or a function, or {TEXT, at = {x, y}, size = s} (got nothing)
-- expect: :7: camera: text[6]: a value without a name (write key = value)
-- expect: :7: camera: text[7]: must be a text or a function, or {TEXT, at = {x, y}, size = s} (got 7)
-- expect: :8: camera: text: 'at' must be a list of 2 numbers (got {0, 0, 0})
-- expect: :8: camera: text: unknown key 'sise' (did you mean 'size'?)
-- expect: :9: camera: text[1]: must be a text or a function, or {TEXT, at = {x, y}, size = s} (got nothing)
-- expect: :10: camera: 'text' must be a list of at most 8 texts (got 9)
-- expect: :11: camera: vectors[2]: must be one of velocity, contact, joint, spring, angular_velocity, acceleration, momentum, force (got 'velocty') (did you mean 'velocity'?)
-- expect: :11: camera: vectors[3]: 'scale' must be positive (got -1)
-- expect: :11: camera: vectors[4]: unknown key 'bodys'
-- expect: :11: camera: vectors[5]: 'bodies' must not be empty (without it: all)
-- expect: :12: camera: vectors: 'scale' must be a number (got the text 'big')
-- expect: :12: camera: vectors: bodies[2]: no body is named 'bal' so far (did you mean 'ball'?)
-- expect: :13: camera: vectors[1][1]: must be one of velocity, contact, joint, spring, angular_velocity, acceleration, momentum, force (got 5)
-- expect: :13: camera: vectors[2]: 'bodies' must be a list of at most 64 bodies (got a body)
-- expect: :13: camera: vectors[4][1]: there are such arrows already
-- expect: :14: camera: 'vectors' must be one of velocity, contact, joint, spring, angular_velocity, acceleration, momentum, force (got 5)
-- expect: :15: camera: plots[1]: there is no probe or quantity 'energi' so far (did you mean 'energy'?) (wanted: a probe, energy, momentum, BODY.z, .vz, .speed, JOINT.angle, .force, and more)
-- expect: :15: camera: plots[2]: must be the name of a quantity, or {NAME, at = {x, y}, size = {w, h}} (got 5)
-- expect: :15: camera: plots[3]: 'at' must lie in [0, 1] (got {0, -1})
-- expect: :15: camera: plots[3][1]: there is no probe or quantity 'ball.zz' so far (wanted: a probe, energy, momentum, BODY.z, .vz, .speed, JOINT.angle, .force, and more)
-- expect: :15: camera: plots[4]: 'size' must be above 0 and at most 1 (got {0, 1})
-- expect: :16: camera: plots[1]: unknown key 'sizes' (did you mean 'size'?)
-- expect: :16: camera: plots[2][1]: must be the name of a quantity, or {NAME, at = {x, y}, size = {w, h}} (got nothing)
