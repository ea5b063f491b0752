#!/bin/sh
# SPDX-License-Identifier: MIT
# `particles`: mass, centre of mass and inertia of a body from points, the same to every method as if they were stated.
. tests/cli/functions

# 18 on a sphere, the lowest of twice the mass: in pairs about its axis and its middle, so that the answer is 2.5 cm / 19
cat >lowest.lua <<'END'
world { duration = 0.1 }
local r = 0.025
local list = { {mass = 2, position = {0, 0, -r}}, {mass = 1, position = {0, 0, r}} }
for k = 0, 7 do
	for _, z in ipairs { 0.6 * r, -0.6 * r } do
		list[#list + 1] = {mass = 1, position = {0.8 * r * math.cos(k * math.pi / 4), 0.8 * r * math.sin(k * math.pi / 4), z}}
	end
end
local b = sphere { name = "b", radius = r, position = {1, 2, 3}, particles = list }
expect("18 of them", function() return #list == 18 and b.mass == 19 end)
expect("0.1316 cm below the middle", function() return math.abs(b.center_of_mass.z + r / 19), 1e-17 end)
expect("and not beside it", function() return math.abs(b.center_of_mass.x) + math.abs(b.center_of_mass.y), 1e-17 end)
expect("the sphere stays", function() return b.position.z, 3 end)
END
for method in located stepped classic; do
	exits 0 lowest.lua --no-record --method $method
done

# a half of random points, turned and away: the same bits as with numbers stated, whatever the method
cat >same.lua <<'END'
local stated = param("stated", false, "numbers instead of points")
world { duration = 1, gravity = {0, 0, -9.81}, seed = 7 }
local m = material { friction = 0.6, restitution = 0.3 }
plane { normal = {0, 0, 1}, material = m }
local function points(n, low, high)
	local list = {}
	for i = 1, n do
		local p = {}
		for k = 1, 3 do p[k] = low[k] + math.random() * (high[k] - low[k]) end
		list[i] = {mass = 0.1 + math.random(), position = p}
	end
	return list
end
local function measure(list)
	local m, c = 0, vec3(0, 0, 0)
	for _, p in ipairs(list) do m, c = m + p.mass, c + p.mass * vec3(p.position[1], p.position[2], p.position[3]) end
	c = (1 / m) * c
	local t = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}
	for _, p in ipairs(list) do
		local r = {p.position[1] - c.x, p.position[2] - c.y, p.position[3] - c.z}
		local rr = r[1]^2 + r[2]^2 + r[3]^2
		for i = 1, 3 do for j = 1, 3 do t[i][j] = t[i][j] + p.mass * ((i == j and rr or 0) - r[i] * r[j]) end end
	end
	return m, c, t
end
local bodies = {}
local function make(call, keys, list)
	local mass, c, t = measure(list)
	if stated then keys.mass, keys.center_of_mass, keys.inertia = mass, c, t else keys.particles = list end
	keys.material = m
	local b = call(keys)
	bodies[#bodies + 1] = {b, mass, c, t}
end
local round = param("round", false, "a sphere alone")
local tilt = {axis = {1, 2, 3}, angle = 0.7}
make(sphere, {radius = 0.1, position = {0, 0, 0.3}, angular_velocity = {1, -2, 3}, velocity = {1, 0, 0}},
	points(12, {-0.05, -0.05, -0.05}, {0.05, 0.05, 0.02}))
if not round then
make(box, {size = {0.2, 0.3, 0.2}, position = {1, 0, 0.3}, orientation = tilt}, points(7, {-0.1, -0.1, -0.1}, {0.1, 0.1, 0}))
make(body, {shapes = {{shape = "box", size = {0.3, 0.1, 0.1}}, {shape = "sphere", radius = 0.1, position = {0.1, 0, 0.1}}},
	position = {-1, 0, 0.5}, orientation = tilt}, points(5, {-0.1, -0.05, -0.05}, {0.1, 0.05, 0.05}))
end
expect("as the sums say", function()
	local worst = 0
	for _, b in ipairs(bodies) do
		worst = math.max(worst, math.abs(b[1].mass / b[2] - 1), (b[1].center_of_mass - b[3]):length() / 0.1)
		for i = 1, 3 do for j = 1, 3 do
			worst = math.max(worst, math.abs(b[1].inertia[i][j] - b[4][i][j]) / b[4][1][1])
		end end
	end
	return worst, 1e-14
end)
END
for method in located stepped classic; do
	round=$([ $method = classic ] && echo true || echo false) # it has spheres and planes only
	exits 0 same.lua --no-record --method $method -p round="$round" --json
	hash=$(value state_hash)
	[ -n "$hash" ] || fail "no hash"
	exits 0 same.lua --no-record --method $method -p round="$round" -p stated=true --json
	[ "$hash" = "$(value state_hash)" ] || fail "$method: points and numbers differ"
done

# what is wrong with them is said, at its line
wrong() # PATTERN KEYS
{
	printf 'world { duration = 1 }\nplane { normal = {0, 0, 1} }\nsphere { radius = 1, position = {0, 0, 2},\n%s }\n' "$2" >w.lua
	exits 65 w.lua
	says err "^w.lua:[34]: sphere( #1)?: $1"
}
two='{mass = 1, position = {0, 0, 0.1}}, {mass = 2, position = {0, 0, -0.3}}'
wrong "'particles' lie on one line or at one point" "particles = {$two}"
wrong "'particles' lie on one line or at one point" "particles = {{mass = 1, position = {0.1, 0.2, 0.3}}}"
wrong "'particles' lie on one line or at one point" \
	'particles = {{mass = 1, position = {0.1, 0.2, 0.3}}, {mass = 3, position = {0.2, 0.4, 0.6}}, {mass = 3, position = {0.3, 0.6, 0.9}}}'
off='{mass = 1, position = {0.1, 0, 0}}'
wrong "'particles' and 'mass' exclude each other" "particles = {$two, $off}, mass = 2"
wrong "'particles' and 'density' exclude each other" "particles = {$two, $off}, density = 2"
wrong "'particles' and 'inertia' exclude each other" "particles = {$two, $off}, inertia = {1, 1, 1}"
wrong "'particles' and 'center_of_mass' exclude each other" "particles = {$two, $off}, center_of_mass = {0, 0, 0}"
wrong "particles\[4\]: 'mass' must be positive" "particles = {$two, $off, {mass = 0, position = {0, 1, 0}}}"
wrong "particles\[4\]: 'mass' must be positive" "particles = {$two, $off, {mass = -1, position = {0, 1, 0}}}"
wrong "particles\[4\]: 'mass' is missing" "particles = {$two, $off, {position = {0, 1, 0}}}"
wrong "particles\[4\]: 'position' is missing" "particles = {$two, $off, {mass = 1}}"
wrong "particles\[4\]: unknown key 'pos' \(did you mean 'position'" "particles = {$two, $off, {mass = 1, pos = {0, 1, 0}}}"
wrong "particles\[4\]: must be a table" "particles = {$two, $off, 5}"
wrong "'particles' must be a list" "particles = {}"
wrong "'particles' must be a list" "particles = 3"
wrong "'particles' must be a list" "particles = {mass = 1, position = {0, 0, 0}}"
wrong "'particles' of a driven body" "particles = {$two, $off}, motion = function(t) return {0, 0, 2} end"
wrong "'mass' must be positive and finite" "particles = {{mass = 1e308, position = {1, 0, 0}}, {mass = 1e308, position = {0, 1, 0}}}"

# nothing turns here: one point is a body
printf 'world { duration = 1 }\nsphere { radius = 1, velocity = {1, 0, 0}, particles = {{mass = 2, position = {0, 0, 0}}} }\n' >one.lua
for method in located stepped classic; do
	exits 0 one.lua --no-record --method $method
done
