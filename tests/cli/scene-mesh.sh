#!/bin/sh
# SPDX-License-Identifier: MIT
# hull { file = ... }: the solid is that of the file's corners, the recording holds the file, mistakes are told by name.
. tests/cli/functions

mkdir parts
cat >parts/block.obj <<'END'
# a block of 200 x 100 x 50 mm
v 0 0 0
v 200 0 0
v 0 100 0
v 200 100 0
v 0 0 50
v 200 0 50
v 0 100 50
v 200 100 50
v 100 50 25
f 1 2 4
END
cat >block.lua <<'END'
local scale = param("scale", 0.001, "of the file")
world { duration = 0.5, gravity = {0, 0, -9.81} }
plane { normal = {0, 0, 1} }
local a = hull { name = "a", file = "parts/block.obj", scale = scale, density = 1000, position = {0, 0, 0.5} }
local b = box { name = "b", size = {0.2, 0.1, 0.05}, density = 1000, position = {1, 0, 0.5} }
hull { file = "parts/block.obj", scale = scale, density = 1000, position = {2, 0, 0.5} }
body { shapes = {{shape = "hull", file = "parts/block.obj", scale = scale}}, position = {3, 0, 1} }
expect("mass", function() return math.abs(a.mass - 1), 1e-12 end)
expect("inertia", function() return math.abs(a.inertia[1][1] - b.inertia[1][1]), 1e-15 end)
expect("centre", function() return (a.center_of_mass - vec3(0.1, 0.05, 0.025)):length(), 1e-15 end)
expect("it has fallen", function() return math.abs(a.position.z), 1e-6 end)
END
exits 0 block.lua --no-render
# the recording holds the file, once
exits 0 info block.h5
[ "$(grep -c 'block.obj' out)" = 1 ] || fail "the file is not in the recording once"
mv parts gone
exits 0 replay block.h5
exits 65 block.lua --no-record
says err "block.lua:4: hull 'a': 'file': there is no file 'parts/block.obj' in the scene's folder"
mv gone parts
exits 1 sweep block.lua -p scale=0.001,0.002 -o d -q --jobs 1
exits 0 sweep d --status
says out '1 done, 1 failed'

# binary STL
python3 - <<'END' 2>/dev/null || { echo "no python3 to write a binary file with"; exit 77; }
import struct
c = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
t = [(a, b, d) for a in range(8) for b in range(8) for d in range(8) if a < b < d]
with open("cube.stl", "wb") as f:
    f.write(b"solid cube".ljust(80, b" ") + struct.pack("<I", len(t)))
    for k in t:
        f.write(struct.pack("<3f", 0, 0, 0) + b"".join(struct.pack("<3f", *c[i]) for i in k) + b"\0\0")
END
cat >cube.lua <<'END'
world { duration = 0.1 }
local cube = hull { name = "cube", file = "cube.stl", density = 2 }
expect("mass", function() return math.abs(cube.mass - 2), 1e-14 end)
END
exits 0 cube.lua --no-record

# wrong NAME PATTERN KEYS
wrong()
{
	echo "world { duration = 0.1 } hull { name = 'h', $3, mass = 1 }" >"$1.lua"
	exits 65 "$1.lua" --no-record
	says err "$1.lua:1: hull 'h': $2"
}
head -c 500 cube.stl >cut.stl
printf 'v 0 0 0\nv 1 0 0\nv 0 1 nan\n' >nan.obj
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n' >flat.obj
wrong cut "'file': 'cut.stl': line|'file': 'cut.stl': it has no corners" 'file = "cut.stl"'
wrong nan "'file': 'nan.obj': line 3 has not three finite numbers" 'file = "nan.obj"'
wrong flat "'file': " 'file = "flat.obj"'
wrong both "'points' and 'file' exclude each other" 'file = "flat.obj", points = {}'
wrong none "'points' or 'file' is missing" 'position = {0, 0, 0}'
wrong kind "'file' must name an STL or OBJ file" 'file = "part.step"'
wrong type "'file' must name an STL or OBJ file, .*got 5" 'file = 5'
wrong away "'file': there is no file '../flat.obj'" 'file = "../flat.obj"'
wrong scale "'scale' must be" 'file = "cube.stl", scale = -1'
wrong scaled "'scale' is of a 'file'" 'points = {{0, 0, 0}}, scale = 2'
