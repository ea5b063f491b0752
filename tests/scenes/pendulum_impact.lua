-- A ball on an arm of no mass, hinged, hits the floor, with friction. The tip moves along one direction only, so both components of
-- its velocity fall and rise together, and with d_n and d_t the components of that direction Stronge's law gives
-- w' = e w sqrt((d_n - mu d_t) / (d_n + mu d_t)), or no rebound where friction holds the arm.
local e, mu, slope = param("e", 0.5, ""), param("mu", 0.3, ""), param("slope", 0.7, "rad: of the arm at the impact")
local turn, bound = param("turn", 0.0, "rad: of all about the vertical"), param("bound", 1e-12, "of the speed")
local late = 1.0371e-3
world { duration = 2.2 * late, frame_rate = 1 / (2.2 * late), gravity = {0, 0, 0} }
local m = material { name = "m", density = 1000, restitution = e, friction = mu }
plane { material = m }
local long, r, speed = 1, 0.1, 1.5
local out, axis = vec3(math.cos(turn), math.sin(turn), 0), vec3(-math.sin(turn), math.cos(turn), 0)
local pivot = vec3(0, 0, long * math.sin(slope))
-- from the pivot to the centre of the ball, at the impact and a while before
local low = long * math.cos(slope) * out - vec3(0, 0, long * math.sin(slope) - r)
local angle = -speed * late
local before = math.cos(angle) * low + math.sin(angle) * axis:cross(low)
local ball = sphere { radius = r, material = m, position = pivot + before, velocity = speed * axis:cross(before), angular_velocity = speed * axis }
joint { kind = "hinge", a = ball, at = pivot, axis = axis }
local along, across = math.cos(slope), mu * math.sin(slope)
local back = along > across and e * math.sqrt((along - across) / (along + across)) or 0
expect("it has hit the floor once", function() return math.abs(collisions() - 1), 0 end)
expect("it rebounds by Stronge's law", function() return math.abs(ball.angular_velocity:dot(axis) + back * speed) / speed, bound end)
