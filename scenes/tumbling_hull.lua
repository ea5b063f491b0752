-- A crystal, the hull of some points, is thrown; it tumbles over the floor and comes to rest on one of its faces.
-- Watch: in flight it wobbles and keeps energy and angular momentum; at each corner that hits it loses some of both.
-- Expected end: it lies still on a face, all of whose corners are on the floor.
-- A body of points has the mass, centroid and inertia of their hull; on which face it ends is sensitive to everything.
-- Try: --param seed_points=5 (another crystal), --param e=0.6, --param spin=20
-- Takes: 45 s of processor time, less than a second without its film.
local e = param("e", 0.3, "restitution", {min = 0, max = 1})
local spin = param("spin", 8.0, "at the start, rad/s", {min = 0, max = 100})
local seed = param("seed_points", 2, "which crystal", {min = 1, max = 1000})
local g, radius = 9.81, 0.25

world { title = "A tumbling crystal", duration = 4, frame_rate = 120, gravity = {0, 0, -g}, method = "located" }
local quartz = material { name = "quartz", density = 2650, friction = 0.4, restitution = e, color = {0.62, 0.52, 0.78}, shininess = 150 }
plane { name = "floor", material = quartz, color = {0.80, 0.79, 0.75}, texture = "checker" }
math.randomseed(seed)
local points = {}
while #points < 16 do
	local x, y, z = 2 * math.random() - 1, 2 * math.random() - 1, 2 * math.random() - 1
	local p = vec3(x, y, z)
	if p:length() > 0.3 and p:length() <= 1 then
		p = radius * p:unit()
		points[#points + 1] = {1.3 * p.x, p.y, 0.8 * p.z}
	end
end
local crystal = hull { name = "crystal", points = points, material = quartz, position = {-1.2, 0, 0.8}, velocity = {1.6, 0.2, 1.5},
	angular_velocity = spin * vec3(0.3, 1, 0.2):unit() }
camera { name = "main", position = {0.2, -3.6, 1.3}, look_at = {0.1, 0, 0.3}, fov = deg(38), size = {1280, 720}, trails = {crystal},
	overlay = {"title", "time", "energy"}, video = "tumbling_hull.mp4" }

local start, least
expect_always("energy is only lost, relative", function()
	start = start or energy()
	least = math.min(least or start, energy())
	return (energy() - least) / start, 1e-9
end)
expect("it is at rest", function() return crystal.velocity:length() + radius * crystal.angular_velocity:length(), e <= 0.5 and 1e-6 or math.huge end)
-- Heights of all points that lie on the floor; three or more of them make a face. Contacts may be apart by the tolerance, by
-- steps (--method auto) 1e-4 of the least half width, which is less than 0.8 of the radius.
local near = 0.8e-4 * radius
expect("it lies on a face", function()
	local low, on = math.huge, 0
	for _, p in ipairs(points) do low = math.min(low, crystal.point(p).z) end
	for _, p in ipairs(points) do
		if crystal.point(p).z < low + near then on = on + 1 end
	end
	return e > 0.5 or math.abs(low) < near and on >= 3
end)
expect("overlap stays within the tolerance", function() return max_penetration(), near end)
