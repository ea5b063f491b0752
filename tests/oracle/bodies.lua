-- SPDX-License-Identifier: MIT
-- A body of every shape, none of which states an inertia: tests/oracle/bodies.py knows them all.
world { duration = 0.1, frame_rate = 50 }
record { fields = {"position", "orientation", "velocity", "angular_velocity"} }
sphere { radius = 1, velocity={1,2,3}, angular_velocity={0,1,0} }
box { size = {1,2,3}, position={5,5,5}, velocity={0,2,3}, mass=2 }
capsule { radius=0.3, length=1, position={-5,5,5}, mass=2 }
cylinder { radius=0.3, length=1, position={-5,-5,5}, mass=3 }
hull { points = {{0,0,0},{1,0,0},{0,2,0},{0,0,3}}, position={9,9,9}, mass=4 }
body { position = {20, 0, 0}, density = 700, shapes = {
  { shape = "box", size = {1, 0.5, 0.25}, position = {1, 0, 0}, orientation = {0.8, 0, 0.6, 0}, density = 3000 },
  { shape = "sphere", radius = 0.3, position = {0, 1, 0} },
  { shape = "hull", points = {{0,0,0},{1,0,0},{0,2,0},{0,0,3}}, position = {0, 0, 3} },
  { shape = "capsule", radius = 0.2, length = 1, position = {0, 0, 1} } } }
