#!/bin/sh
# SPDX-License-Identifier: MIT
# Boxes, capsules, cylinders, hulls and unions: checked, flown, recorded with their geometry, drawn around.
. tests/cli/functions

cat >solids.lua <<'END'
world { duration = 1, frame_rate = 10 }
local spin = {1, 2, 3}
box { name = "box", size = {1, 2, 3}, angular_velocity = spin, collides_with = {} }
capsule { name = "capsule", radius = 1, length = 2, position = {10, 0, 0}, angular_velocity = spin, collides_with = {} }
cylinder { name = "cylinder", radius = 1, length = 2, position = {20, 0, 0}, mass = 3, collides_with = {} }
local tent = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {1, 1, 3}, {1, 1, 1}}
hull { name = "hull", points = tent, position = {30, 0, 0}, angular_velocity = spin, collides_with = {} }
hull { name = "again", points = tent, position = {40, 0, 0}, velocity = {1, 0, 0}, collides_with = {} }
body { name = "union", position = {50, 0, 0}, angular_velocity = spin, collides_with = {}, shapes = {
	{ shape = "box", size = {1, 1, 1}, position = {0, 0, 1} },
	{ shape = "sphere", radius = 0.5, density = 2000 },
	{ shape = "hull", points = tent, orientation = {axis = {1, 0, 0}, angle = deg(90)} } } }
hull { name = "rock", points = tent, static = true, position = {0, 0, 9}, collides_with = {} }
box { name = "door", size = {1, 0.1, 2}, motion = function(t) return {0, 9, 0}, {axis = {0, 0, 1}, angle = t} end, collides_with = {} }
sphere { name = "ball", radius = 1, position = {0, 30, 0}, velocity = {1, 0, 0} }
plane { point = {0, 0, -5} }
camera { name = "main", position = {25, -60, 10}, look_at = {25, 0, 0}, size = {160, 90} }
local hull_mass = 1000 * 4
expect("mass of the hull", function() return math.abs(body("hull").mass / hull_mass - 1), 1e-14 end)
expect("inertia of the box", function() return math.abs(body("box").inertia[1][1] / 6500 - 1), 1e-14 end)
expect("mass of the union", function() return math.abs(body("union").mass / (1000 + 2000 * math.pi / 6 + hull_mass) - 1), 1e-14 end)
expect("the hull turns about its centroid", function()
	return (body("hull").point({1, 1, 0.75}) - vec3(31, 1, 0.75)):length(), 1e-12
end)
END
exits 0 check solids.lua
grep -q '^  shapes  *1 sphere, 1 plane, 2 boxes, 1 capsule, 1 cylinder, 3 hulls, 1 union$' out || fail "check does not name the shapes"
exits 0 solids.lua
exits 0 info solids.h5
grep -q '^  shapes  *1 sphere, 1 plane, 2 boxes, 1 capsule, 1 cylinder, 3 hulls, 1 union$' out || fail "info does not name the shapes"
exits 0 info solids.h5 --json
grep -q '"hull": *3' out || fail "info --json does not count hulls"
printf 'body box\nbody capsule\nbody hull\nbody union' >commands
exits 0 solids.lua --no-record --no-render -q --commands commands
[ "$(grep '^ shape' out | tr '\n' ,)" = " shape box 1 2 3, shape capsule 1 2, shape hull 5, shape union 3," ] ||
	fail "answers do not tell the shapes"
exits 0 render solids.h5 --frame 10 -o picture.png

for p in "${RBSIM_PYTHON:-}" /usr/bin/python3 python3; do
	[ -n "$p" ] && "$p" -c 'import h5py' 2>/dev/null || continue
	"$p" - <<'END' || fail "the geometry in the recording is not that of the scene"
import h5py, numpy as np
f = h5py.File("solids.h5", "r")
kinds = f["rbsim/shapes"].attrs["kinds"]
names = [w.split()[1] for w in (kinds.decode() if isinstance(kinds, bytes) else kinds).split(", ")]
shape, solids = f["rbsim/shapes"], f["rbsim/solids"]
kind = [names[k] for k in shape["kind"][:]]
assert kind[:6] == ["box", "capsule", "cylinder", "hull", "hull", "union"], kind
assert list(shape["solid"][:7]) == [-1, -1, -1, 0, 0, 1, 0]
assert list(shape["size"][0]) == [1, 2, 3] and list(shape["size"][2]) == [0, 0, 2]
count = solids["vertex_count"][0]
v, first = solids["vertices"][:count], solids["face_first"][: solids["face_count"][0] + 1]
faces = [solids["loops"][a:b] for a, b in zip(first[:-1], first[1:])]
assert count == 5 and sorted(len(face) for face in faces) == [3, 3, 3, 3, 4]
# outwards: the divergence theorem gives the volume, 4, with its sign
volume = sum(np.dot(v[face[0]], np.cross(v[a], v[b])) / 6 for face in faces for a, b in zip(face[1:-1], face[2:]))
assert abs(volume - 4) < 1e-14 and abs(solids["volume"][0] - 4) < 1e-14
assert np.allclose(solids["centroid"][0], [1, 1, 0.75], atol=1e-15)
parts = solids["parts"]
assert [names[k] for k in parts["kind"][:]] == ["box", "sphere", "hull"] and list(parts["solid"][:]) == [-1, -1, 0]
assert list(parts["share"][:]) == [1, 2, 1] and np.allclose(parts["orientation"][2], [0.5**0.5, 0.5**0.5, 0, 0])
assert np.allclose(f["particles/bodies/center_of_mass"][3], [1, 1, 0.75], atol=1e-15)
END
	break
done

cat >touch.lua <<'END'
world { duration = 1, method = "classic" }
plane {}
box { name = "crate", size = {1, 1, 1}, position = {0, 0, 5} }
capsule { name = "pill", radius = 1, length = 1, position = {5, 0, 5} }
sphere { radius = 0.1, position = {0, 0, 9} }
END
exits 65 touch.lua
grep -q "^touch.lua:3: box 'crate': the classic method has no contacts of boxes (use 'located' or 'auto', or let it collide with nothing: collides_with = {})$" err ||
	fail "the box is not refused by name"
grep -q "^touch.lua:4: capsule 'pill': the classic method has no contacts of capsules" err || fail "the capsule is not refused by name"
[ ! -e touch.h5 ] || fail "a refused scene left a recording"

# overlaps at the start are named with their depth, touching is allowed
cat >deep.lua <<'END'
world { duration = 1 }
plane { name = "floor" }
box { name = "crate", size = {1, 1, 1}, position = {0, 0, 0.5} }
capsule { name = "pill", radius = 0.5, length = 1, position = {5, 0, 0.75} }
box { name = "lid", size = {1, 1, 0.5}, position = {0.25, 0, 1.125} }
END
exits 65 deep.lua
grep -q "^deep.lua:4: capsule 'pill': overlaps plane 'floor' by 0.25 m at the start" err ||
	fail "the capsule in the floor is not named"
grep -q "^deep.lua:5: box 'lid': overlaps box 'crate' by 0.125 m at the start" err ||
	fail "the lid in the crate is not named"
if grep -q "crate': overlaps" err; then fail "a crate that touches the floor is refused"; fi

# a hull of many points in a fraction of a second; one of too many is refused before any work
cat >many.lua <<'END'
world { duration = 0.1 }
local n = param("n", 60000, "points")
local points = {}
for i = 1, n do
	local z = 1 - (2 * i - 1) / n
	local r = math.sqrt(1 - z * z)
	points[i] = {r * math.cos(2.399963 * i), r * math.sin(2.399963 * i), z}
end
hull { points = points, angular_velocity = {0, 0, 1} }
END
exits 0 many.lua --no-record
exits 65 many.lua --no-record --param n=1000000
grep -q "hull: 'points': 1000000 points are too many (wanted at most 65536)" err || fail "a million points: $(cat err)"
