world { duration = 1, gravity = {0, 0} }
sphere { radius = 1, position = {1, 2, 3, 4}, velocity = {1}, orientation = {1, 0, 0} }
sphere { radius = 1, position = {9, 9, 9, w = 1}, color = {1, 1}, inertia = {1, 1} }
plane { size = {1, 2, 3} }
camera { size = {640}, frustum = {-1, 1, -1, 1, 1} }
