#!/bin/sh
# SPDX-License-Identifier: MIT
# A terrain of flat triangles is a plane: what rolls, slides or lands on its inner edges, or falls onto its slope, moves as over one, by every
# method that has it. On a bumpy one every shape ends above it and within the tolerance, and a heap does. From files as from a
# height; files that lie are refused. Recordings, films and exports have it.
. tests/cli/functions
command -v python3 >/dev/null || { echo "no python3 to make and compare files with"; exit 77; }

cat >flat.lua <<'END'
local method = param("method", "located", "of the run")
local floor = param("floor", "height", "what is below", {choices = {"plane", "height", "stl", "ascii", "obj"}})
local body = param("body", "sphere", "what rolls", {choices = {"sphere", "cylinder", "box", "puck", "chip", "rod"}})
local slope, g, r = param("slope", 0.0, "of the floor along x"), 9.81, 0.125
world { duration = 1, frame_rate = 40, gravity = {0, 0, -g}, method = method, tolerance = 1e-6 * r }
local stuff = material { friction = 0.5, restitution = 0.5 }
local keys = {name = "floor", material = stuff}
if floor == "plane" then keys.normal = {-slope, 0, 1} plane(keys)
elseif floor == "height" then
	keys.height, keys.size, keys.cells = function(x, y) return slope * x end, {8, 4}, {16, 8}
	terrain(keys)
else
	keys.file, keys.scale = "mesh-" .. floor .. (floor == "obj" and ".obj" or ".stl"), 0.5
	terrain(keys)
end
local n = vec3(-slope, 0, 1) / math.sqrt(1 + slope ^ 2)
local moves = {name = "body", mass = 1, material = stuff}
if body == "box" then
	moves.size, moves.position, moves.orientation = {0.5, 0.375, 0.25}, n * 0.125, {axis = {0, 1, 0}, angle = -math.atan(slope)}
elseif body == "puck" then
	-- slides over seams and spins
	moves.size, moves.position, moves.velocity, moves.angular_velocity = {0.75, 0.5, 0.25}, {0.1, 0.2, r}, {1, 0.5, 0}, {0, 0, 4}
elseif body == "chip" then
	-- lands on its face, which covers seams, while it turns: its corners slip and stick
	moves.points, moves.position, moves.velocity, moves.angular_velocity = {}, {0.1, 0.2, r}, {1, 0.5, -1}, {1, -2, 5}
	for k, p in ipairs {{4, 0}, {1, 4}, {-3, 2}, {-3, -2}, {1, -4}} do
		moves.points[2 * k - 1], moves.points[2 * k] = {r * p[1], r * p[2], -r}, {r * p[1], r * p[2], r}
	end
elseif body == "rod" then
	moves.radius, moves.length, moves.position, moves.velocity, moves.angular_velocity = r, 0.75, {0.1, 0.2, r}, {1, 0.5, 0}, {0, 0, 4}
	moves.orientation = {axis = {1, 0, 0}, angle = math.pi / 2}
elseif body == "cylinder" then
	moves.radius, moves.length, moves.position, moves.velocity, moves.angular_velocity = r, 0.75, {-1, 0.0625, r}, {2, 0, 0}, {0, 2 / r, 0}
	moves.orientation = {axis = {1, 0, 0}, angle = math.pi / 2}
elseif slope == 0 then
	moves.radius, moves.position, moves.velocity, moves.angular_velocity = r, {-1, 0.03125, r}, {2, 0.25, 0}, {-0.25 / r, 2 / r, 0}
else
	-- falls, bounces, slips and rolls
	moves.radius, moves.position, moves.velocity = r, {1, 0.03125, 1}, {0.25, 0.125, 0}
end
local b = (({sphere = sphere, cylinder = cylinder, box = box, puck = box, chip = hull, rod = capsule})[body])(moves)
for k, axis in ipairs {"x", "y", "z"} do
	result("p" .. axis, function() return b.position[axis] end)
	result("v" .. axis, function() return b.velocity[axis] end)
	result("w" .. axis, function() return b.angular_velocity[axis] end)
end
END
cat >mesh.py <<'END'
# the grid of flat.lua at slope, twice as large, as three files
import struct, sys
slope, nx, ny = float(sys.argv[1]), 16, 8
point = [(16 * (i / nx - 0.5), 8 * (j / ny - 0.5), slope * 16 * (i / nx - 0.5)) for j in range(ny + 1) for i in range(nx + 1)]
faces = []
for j in range(ny):
    for i in range(nx):
        a = j * (nx + 1) + i
        faces += [(a, a + 1, a + nx + 2), (a, a + nx + 2, a + nx + 1)]
with open("mesh-stl.stl", "wb") as f:
    f.write(b"solid not text".ljust(80) + struct.pack("<I", len(faces)))
    for t in faces:
        f.write(struct.pack("<12fH", 0, 0, 0, *(c for v in t for c in point[v]), 0))
with open("mesh-ascii.stl", "w") as f:
    f.write("solid plate\n")
    for t in faces:
        f.write("facet normal 0 0 1\nouter loop\n" + "".join("vertex %r %r %r\n" % point[v] for v in t) + "endloop\nendfacet\n")
    f.write("endsolid\n")
with open("mesh-obj.obj", "w") as f:
    f.write("# quads, with what is not read\nvt 0 0\n" + "".join("v %r %r %r\n" % p for p in point))
    for j in range(ny):
        for i in range(nx):
            a = j * (nx + 1) + i + 1
            f.write("f %d/1 %d//2 %d/1/2 %d\n" % (a, a + 1, a + nx + 2, a + nx + 1))
END
cat >compare.py <<'END'
import json, sys
a, b = (json.load(open(f))["results"] for f in sys.argv[1:3])
bound = float(sys.argv[3])
worst = max(abs(a[k]["value"] - b[k]["value"]) for k in a)
print(f"{sys.argv[4]}: off by {worst:.2g}, bound {bound:g}")
sys.exit(not worst <= bound)
END
# same BODY SLOPE METHOD FLOOR BOUND
same()
{
	for floor in plane "$4"; do
		exits 0 flat.lua --param body="$1" --param slope="$2" --method "$3" --param floor="$floor" --no-record --json --quiet
		cp out "$floor.json"
	done
	python3 compare.py plane.json "$4.json" "$5" "$1, slope $2, $3, $4" >>measured || { cat measured; fail "a terrain is no plane"; }
}
# what is rounded is the place of seams, some ulp of the floor's 4 m, in some hundred events; by steps sums of their 160, and
# where several points bear what needs two, the tolerance, 1.25e-7 m, at which their solution stops, a step, 1 / 160 s
for method in located stepped; do
	same sphere 0 $method height 1e-13
	same box 0 $method height 1e-12
done
same cylinder 0 located height 1e-12
# friction acts where corners are, not where seams cross edges or meet below a face; seams cut pieces, and the direction of a slip
# that ends is known to 1e-5 of the speeds only
for body in puck chip rod; do
	same $body 0 located height 1e-6
done
# these steps are off by 5e-3 from the located answer on the plane itself; the rod takes the same ones on both, to the tolerance above
same chip 0 stepped height 1e-2
same rod 0 stepped height 5e-5
same cylinder 0 stepped height 5e-6
python3 mesh.py 0.25
# a ball that comes to a slope of the plane z = x / 4, and a box that friction holds on it
same sphere 0.25 located height 1e-11
same box 0.25 located height 1e-12
same box 0.25 stepped height 1e-9
for floor in stl ascii obj; do
	same sphere 0.25 located $floor 1e-11
done
cat measured

# a ridge, which is two or four facets in one place, is hit as that of a hull: they were taken for several touches, on which
# friction acts otherwise
cat >ridge.lua <<'END'
local over = param("over", "terrain", "what is hit", {choices = {"terrain", "hull"}})
local body = param("body", "box", "what hits it", {choices = {"box", "capsule", "cylinder"}})
world { duration = 0.75, frame_rate = 4 }
local stuff = material { friction = 0.3, restitution = param("e", 0.6, "restitution") }
if over == "terrain" then
	terrain { height = function(x, y) return -0.5 * math.abs(x) end, size = {2, 2}, cells = {2, 2}, material = stuff }
else
	local points = {{1, 1, -0.5}, {1, -1, -0.5}, {-1, 1, -0.5}, {-1, -1, -0.5}, {0, 1, 0}, {0, -1, 0}}
	hull { points = points, static = true, material = stuff }
end
local keys = {mass = 1, material = stuff, position = {-0.2, -0.13, 0.6}, velocity = {0.3, 0.5, -1}, angular_velocity = {0.5, -0.4, 0.3}}
if body == "box" then
	keys.size, keys.orientation = {0.25, 0.5, 0.25}, {axis = {1, 0.4, 0.1}, angle = math.pi / 4}
else
	keys.radius, keys.length, keys.orientation = 0.125, 0.5, {axis = {0.2, 1, 0}, angle = 1.2}
end
local b = ({box = box, capsule = capsule, cylinder = cylinder})[body](keys)
for k, axis in ipairs {"x", "y", "z"} do
	result("p" .. axis, function() return b.position[axis] end)
	result("v" .. axis, function() return b.velocity[axis] end)
	result("w" .. axis, function() return b.angular_velocity[axis] end)
end
expect("it was hit", function() return collisions() > 0 end)
END
for method in located stepped; do
	for body in box capsule cylinder; do
		restitutions='0 0.6 1'
		# with a sanitizer, all of one body and one of all
		[ "${RBSIM_MODE:-release}" = release ] || [ $body = box ] || restitutions=0.6
		for e in $restitutions; do
			for over in hull terrain; do
				exits 0 ridge.lua --param over=$over --param body=$body --param e=$e --method $method --no-record --json --quiet
				cp out $over.json
			done
			python3 compare.py hull.json terrain.json 1e-9 "ridge, $body, e = $e, $method" || fail "a ridge of terrain is hit otherwise"
		done
	done
done

# every shape on hills, and a heap of all of them
cat >hills.lua <<'END'
local shape = param("shape", "sphere", "what falls")
local count = param("count", 1, "how many")
world { duration = param("duration", 0.6, "s"), frame_rate = 30, gravity = {0, 0, -9.81}, tolerance = 5e-6 }
local stuff = material { friction = 0.6, restitution = 0.2 }
local function height(x, y) return 0.15 * math.sin(3 * x) * math.cos(2.5 * y) + 0.12 * (x * x + y * y) end
local ground = terrain { name = "hills", height = height, size = {4, 4}, cells = {24, 24}, material = stuff }
local make = {
	sphere = function(k) k.radius = 0.12 return sphere(k) end,
	box = function(k) k.size = {0.3, 0.2, 0.15} return box(k) end,
	capsule = function(k) k.radius, k.length = 0.08, 0.2 return capsule(k) end,
	cylinder = function(k) k.radius, k.length = 0.12, 0.15 return cylinder(k) end,
	hull = function(k) k.points = {{0.15, 0, 0}, {-0.1, 0.12, 0}, {-0.1, -0.12, 0}, {0, 0, 0.2}} return hull(k) end,
	union = function(k)
		k.shapes = {{shape = "sphere", radius = 0.1, position = {0.1, 0, 0}}, {shape = "box", size = {0.2, 0.1, 0.1}, position = {-0.1, 0, 0}}}
		return body(k)
	end }
local names, list = {"sphere", "box", "capsule", "cylinder", "hull", "union"}, {}
for i = 1, count do
	local s = shape == "all" and names[(i - 1) % 6 + 1] or shape
	list[i] = make[s] { position = {0.45 * ((i - 1) % 3 - 1) + 0.03, 0.45 * ((i - 1) // 3 % 3 - 1) + 0.02, 0.7 + 0.45 * ((i - 1) // 9)},
		orientation = {axis = {1, 0.3, 0.2}, angle = 0.4 * i}, material = stuff }
end
camera { name = "side", position = {3, -4, 3}, look_at = {0, 0, 0.3}, size = {160, 120}, fps = 1, png = "hills-%d.png" }
record { fields = {"+", "contacts"} }
-- the lowest place is -0.13; nothing has gone through
expect("all are above the ground", function()
	local least = math.huge
	for _, b in ipairs(list) do least = math.min(least, b.position.z - height(b.position.x, b.position.y)) end
	return least > 0
end)
local touched = 0
on_collision(function(c) if c.b == ground or c.a == ground then touched = touched + 1 end end)
expect("the ground was hit", function() return touched > 0 end)
expect("overlap", function() return max_penetration(), 5e-6 end)
END
for method in located stepped; do
	for shape in sphere box capsule cylinder hull union; do
		exits 0 hills.lua --no-record --no-render --quiet --method $method --param shape=$shape
	done
done
exits 0 hills.lua --quiet --method stepped --param shape=all --param count=36 --param duration=1.5 -o heap.h5 --no-render
exits 0 info heap.h5
says out '1 terrain'
exits 0 check hills.lua
says out '1 terrain'
exits 65 check hills.lua --method classic
says err "terrains"

# the same bits with other numbers of threads
for threads in 1 2; do
	exits 0 hills.lua --no-record --no-render --json --quiet --method stepped --param shape=all --param count=18 --threads $threads
	value state_hash >hash.$threads
done
cmp hash.1 hash.2 || fail "threads change what lies on a terrain"

for to in csv=heap.csv glb=heap.glb vtk=heap.pvd dump=heap.dump; do
	exits 0 export heap.h5 --to "${to%=*}" -o "${to#*=}"
done
python3 - <<'END' || fail "glTF has no terrain"
import json, struct
data = open("heap.glb", "rb").read()
size = struct.unpack("<I", data[12:16])[0]
scene = json.loads(data[20:20 + size])
assert any(n.get("name") == "hills" for n in scene["nodes"]), [n.get("name") for n in scene["nodes"]]
END
if [ -f "$(dirname "$RBSIM")/rbsim-film.so" ]; then
	exits 0 render heap.h5
	[ -s hills-0.png ] || fail "no picture"
fi

# what cannot be
refused()
{
	printf 'world { duration = 1 }\nsphere { radius = 1, position = {0, 0, 5} }\nterrain { %s }\n' "$1" >bad.lua
	exits 65 check bad.lua
	says err "^bad.lua:3: terrain: $2"
}
flat='height = function() return 0 end'
refused "$flat, size = {1, 1}" "'height' needs 'cells'"
refused "$flat, size = {1, 1}, cells = {1000, 1000}" "'cells': 1000 x 1000 cells of two triangles are too many \(wanted at most 32768\)"
refused "$flat, size = {1, 1}, cells = {0, 1}" "'cells'"
refused "$flat, size = {-1, 1}, cells = {2, 2}" "'size'"
# two of 64,800 triangles are more than a scene may have, by far
printf 'local function flat() return 0 end\nsphere { radius = 1, position = {0, 0, 5} }\nfor _ = 1, 2 do %s end\n' \
	'terrain { height = flat, size = {9, 9}, cells = {180, 180} }' >two.lua
exits 65 check two.lua --duration 1
says err 'memory'
refused "$flat, size = {1, 1}, cells = {2, 2}, scale = 2" "'scale' is of a 'file'"
refused "$flat, size = {1, 1}, cells = {2, 2}, file = \"a.stl\"" "'file' and 'height' exclude each other"
refused 'height = function() return 0/0 end, size = {1, 1}, cells = {2, 2}' "'height' must return a finite number"
refused 'height = function() return "x" end, size = {1, 1}, cells = {2, 2}' "'height' must return a finite number"
refused 'height = 1, size = {1, 1}, cells = {2, 2}' "'height' must be a function"
refused "$flat, size = {1, 1}, cells = {2, 2}, static = false" "'static' = false: a terrain has no mass"
refused "$flat, size = {1, 1}, cells = {2, 2}, motion = function(t) return {0, 0, 0} end" "'motion': a terrain stays"
refused 'size = {1, 1}' "'file' or 'height' is missing"
refused 'file = "none.stl"' "'file'"
refused 'file = "none.png"' "'file' must name an STL or OBJ file"
python3 - <<'END'
import struct
triangle = struct.pack("<12fH", 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0)
head = b"x".ljust(80)
w = lambda name, data: open(name, "wb").write(data)
w("cut.stl", head + struct.pack("<I", 3) + triangle * 2)
w("many.stl", head + struct.pack("<I", 0xffffffff) + triangle * 5)
w("nan.stl", head + struct.pack("<I", 1) + struct.pack("<12fH", 0, 0, 1, 0, float("nan"), 0, 1, 0, 0, 0, 1, 0, 0))
w("large.stl", head + struct.pack("<I", 65537) + triangle * 65537)
w("flat.stl", head + struct.pack("<I", 1) + struct.pack("<12fH", 0, 0, 1, 0, 0, 0, 1, 0, 0, 2, 0, 0, 0))
w("empty.stl", head + struct.pack("<I", 0))
w("long.stl", b"solid " + b"y" * 1000000 + b"\nvertex 0 0 0\nvertex 1 0 0\n")
w("words.stl", b"solid\nvertex 0 0 x\n")
w("nothing.stl", b"")
w("zero.stl", b"solid\0\nvertex 0 0 0\n\0vertex 1 1 1")
w("far.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n")
w("early.obj", b"v 0 0 0\nv 1 0 0\nf 1 2 3\nv 0 1 0\n")
w("huge.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99999999999999999999\n")
w("two.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\n")
w("points.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\n")
w("wide.obj", b"v 0 0 1e300\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
w("long.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf" + b" 1 2 3" * 40000 + b"\n")
END
refused 'file = "cut.stl"' "'file': 'cut.stl': it is no STL file, or cut off"
refused 'file = "many.stl"' "'file': 'many.stl': it is no STL file, or cut off"
refused 'file = "nan.stl"' "'file': 'nan.stl': triangle 1 has a corner that is not finite"
refused 'file = "large.stl"' "'file': 'large.stl': it has more than 65536 triangles"
refused 'file = "flat.stl"' "'file': none of its 1 triangles has an area"
refused 'file = "empty.stl"' "'file': 'empty.stl': it has no corners"
refused 'file = "long.stl"' "'file': 'long.stl': it is cut off: its last triangle has 2 corners"
refused 'file = "words.stl"' "'file': 'words.stl': line 2 has not three finite numbers"
refused 'file = "nothing.stl"' "'file'"
refused 'file = "zero.stl"' "'file'"
for name in far early huge two; do
	refused "file = \"$name.obj\"" "'file': '$name.obj': line [34] is no face of three vertices or more"
done
refused 'file = "points.obj"' "'file': 'points.obj': it has no triangles"
refused 'file = "wide.obj"' "'file': its vertex 1 is not finite"
refused 'file = "long.obj"' "'file': 'long.obj': it has more than 65536 triangles"
