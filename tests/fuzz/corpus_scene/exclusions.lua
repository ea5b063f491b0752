world { duration = 1 }
sphere { radius = 1, mass = 1, density = 1 }
plane { normal = {0, 0, 1}, orientation = {1, 0, 0, 0} }
plane { point = {0, 0, 1}, position = {0, 0, 0} }
plane { axis = {1, 0, 0} }
plane { size = {1, 1}, axis = {0, 0, 2} }
plane { normal = {0, 0, 0} }
plane { velocity = {1, 0, 0}, angular_velocity = {0, 0, 1}, forces = {{vector = {1, 0, 0}}} }
plane { static = false }
sphere { radius = 1, forces = {{vector = {1, 0, 0}, direction = {1, 0, 0}}, {magnitude = 1}, {vector = {1, 0, 0}, duration = 0}, 5} }
sphere { radius = 1, forces = {{direction = {0, 0, 0}, magnitude = 1}, {vector = {1, 0, 0}, frame = "bdy"}} }
