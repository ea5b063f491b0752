-- A flat net of ropes, all of them exactly taut, that hangs by corners: those between two fixed bodies in a line lock, and the rows
-- below them fall as chains do. One such chain falls beside it.
local n, corners = param("n", 5, ""), param("corners", 2, "1, 2 or 4: fixed ones")
local diagonal, bound = param("diagonal", 0, "1: triangles"), param("bound", 4e-4, "m: of 12 mm, by steps of 2 ms")
world { duration = 0.05, frame_rate = 20, gravity = {0, 0, -9.81} }
local a = 0.1
local function knot(x, y, fixed)
	return sphere { radius = 0.04, mass = 0.1, position = {x, y, 2}, static = fixed or nil, collides_with = {} }
end
local net, chain = {}, {}
for i = 1, n do
	net[i], chain[i] = {}, knot(a * i, -1, i == 1)
	for j = 1, n do
		local at_end = j == 1 or j == n and corners > 1
		net[i][j] = knot(a * i, a * j, at_end and (i == 1 or i == n and corners > 2))
	end
end
local function tie(p, q)
	if p and q then joint { kind = "rope", a = p, b = q } end
end
for i = 1, n do
	tie(chain[i], chain[i + 1])
	for j = 1, n do
		tie(net[i][j], net[i][j + 1])
		tie(net[i][j], net[i + 1] and net[i + 1][j])
		if diagonal > 0 then tie(net[i][j], net[i + 1] and net[i + 1][j + 1]) end
	end
end
if corners == 2 and diagonal == 0 then
	for i = 1, n do
		expect("row " .. i .. " moves as the chain", function()
			local worst = 0
			for j = 1, n do
				local off = net[i][j].position - chain[i].position - vec3(0, a * j + 1, 0)
				worst = math.max(worst, math.sqrt(off:dot(off)))
			end
			return worst, bound
		end)
	end
end
