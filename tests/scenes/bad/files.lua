world { duration = 1 }
sphere { radius = 1, texture = "none.png" }
sphere { radius = 1, texture = "../secret.png" }
sphere { radius = 1, texture = "cheker" }
require "nothing"
-- expect: :2: sphere: 'texture': there is no file 'none.png' in the scene's folder
-- expect: :3: sphere: 'texture' must be a path within the scene's folder (--trust lifts this) (got the text '../secret.png')
-- expect: :4: sphere: 'texture' must be one of checker, stripes, beachball, none, or a PNG file beside the scene (got 'cheker') (did you mean 'checker'?)
-- expect: :5: require 'nothing': there is no such file in the scene's folder
