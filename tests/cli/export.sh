#!/bin/sh
# SPDX-License-Identifier: MIT
# rbsim export: tables, an animated glTF, surfaces for VTK, a dump of LAMMPS's form. Values are those of the recording.
. tests/cli/functions
command -v python3 >/dev/null || { echo "no python3 to look into files with"; exit 77; }

cat >all.lua <<'END'
world { duration = 1, frame_rate = 20, gravity = {0, 0, -9.81} }
local m = material { name = "m", restitution = 0.5, density = 1000, friction = 0.3 }
plane { normal = {0, 0, 1}, material = m }
plane { name = "shelf", normal = {0, 0, 1}, point = {0, 5, -1}, size = {2, 1} }
sphere { name = "ball", radius = 0.5, position = {0, 0, 1}, material = m, angular_velocity = {0, 0, 20} }
sphere { name = "twin", radius = 0.5, position = {0, 3, 1}, material = m }
box { name = "a \"box\", 1", size = {1, 2, 0.5}, position = {3, 0, 1}, material = m, angular_velocity = {7, 0, 1} }
capsule { radius = 0.2, length = 1, position = {5, 0, 1}, material = m }
cylinder { name = "drum", radius = 0.3, length = 1, position = {7, 0, 1}, material = m }
hull { name = "hull", points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, position = {9, 0, 1}, material = m }
body { name = "union", shapes = {{shape = "sphere", radius = 0.1, position = {-1, 0, 0}},
	{shape = "box", size = {1, 1, 1}, position = {1, 0, 0}, orientation = {axis = {0, 0, 1}, angle = 0.5}}},
	position = {12, 0, 1}, material = m }
sphere { name = "ghost", radius = 0.1, position = {0, 9, 9}, visible = false }
record { fields = {"+", "events", "contacts"} }
probe("height, in m", function() return 1 + time() end, {unit = "m"})
probe("collisions", function() return 2 end)
result("end", function() return time() end, {unit = "s"})
END
exits 0 all.lua -q -o run.h5

# glTF: what the standard asks for, and volumes, times and last positions as they are
exits 0 export run.h5 --to glb
says out '^run.glb: 21 frames$'
python3 "$TOP/tests/gltf.py" run.glb >told || fail "run.glb: no glTF"
# Khronos' own validator, where npm has installed it (NODE_PATH)
if node -e 'require("gltf-validator")' 2>/dev/null; then
	node "$TOP/tests/readers/gltf_validator.js" run.glb >out 2>err || fail "run.glb: the validator objects"
fi
python3 - <<'END' || fail "run.glb shows something else"
import json, math
t = json.load(open("told"))
assert "ghost" not in t["nodes"] and "#5" in t["nodes"], t["nodes"]
v = t["volumes"]
exact = {"ball": math.pi / 6, "twin": math.pi / 6, 'a "box", 1': 1, "#5": 0, "drum": math.pi * 0.09, "hull": 1 / 6,
         "union": 1 + 4 / 3 * math.pi * 1e-3, "shelf": 0}
exact["#5"] = math.pi * 0.04 + 4 / 3 * math.pi * 0.008
for name, volume in exact.items():
    # 24 sides of a circle have 0.989 of its area, as many steps of a half circle about as much
    assert 0.96 * volume - 1e-6 <= v[name] <= volume + 1e-6, (name, v[name], volume)
assert abs(v['a "box", 1'] - 1) < 1e-6 and abs(v["hull"] - 1 / 6) < 1e-6
assert len(t["tracks"]) == 2 * 7, t["tracks"].keys()
assert t["tracks"]["ball.translation"]["times"] == [0, 1] and t["tracks"]["ball.translation"]["count"] == 21
END

# springs are lines from end to end, in every frame
cat >coils.lua <<'END'
world { duration = 1, frame_rate = 20, gravity = {0, 0, -9.81} }
local top = sphere { name = "top", radius = 0.1, position = {0, 0, 3}, static = true }
local a = box { name = "a", size = {0.2, 0.2, 0.2}, position = {0.5, 0, 2}, velocity = {0, 3, 0}, angular_velocity = {5, 0, 1} }
local b = sphere { name = "b", radius = 0.1, position = {0, 0.5, 1} }
spring { a = top, b = a, stiffness = 200, color = "#ff0000" }
spring { a = top, b = b, stiffness = 20, visible = false }
spring { a = a, b = b, stiffness = 20, radius = 0.05 }
END
exits 0 coils.lua -q
exits 0 export coils.h5 --to glb
exits 0 export coils.h5 --to csv
python3 "$TOP/tests/gltf.py" coils.glb >sprung || fail "coils.glb: no glTF"
python3 - <<'END' || fail "coils.glb has other springs"
import csv, json
t = json.load(open("sprung"))
assert t["nodes"][1:] == ["a", "b", "top", "spring#0", "spring#2"], t["nodes"]
at = {}
for row in csv.DictReader(open("coils-bodies.csv")):
    at.setdefault(row["name"], []).append([float(row[k]) for k in "xyz"])
at["top"] = [[0, 0, 3]] * 21
for name, ends in ("spring#0", ("top", "a")), ("spring#2", ("a", "b")):
    track = [t["tracks"][f"{name}.{path}"]["rows"] for path in ("translation", "rotation", "scale")]
    assert all(len(rows) == 21 for rows in track)
    for k, (start, (x, y, z, w), scale) in enumerate(zip(*track)):
        way = [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)]
        for c in range(3):
            assert abs(start[c] - at[ends[0]][k][c]) < 1e-6, (name, k, start)
            assert abs(start[c] + scale[2] * way[c] - at[ends[1]][k][c]) < 1e-5, (name, k, c)
    # from frame to frame they turn no further than their ends make them
    turns = [abs(sum(p * q for p, q in zip(*two))) for two in zip(track[1], track[1][1:])]
    assert min(turns) > 0.9, (name, min(turns))
END

# tables: a row for each body and frame, whose numbers are those of the glTF to its rounding
exits 0 export run.h5 --to csv --json
says out '"outputs":\["run-bodies.csv","run-frames.csv","run-events.csv","run-contacts.csv","run-results.csv"\]'
python3 - <<'END' || fail "the tables are others"
import csv, json
rows = list(csv.DictReader(open("run-bodies.csv")))
assert len(rows) == 21 * 8 and rows[-1]["frame"] == "20" and float(rows[-1]["time"]) == 1
assert any(r["name"] == 'a "box", 1' for r in rows)
last = {r["name"]: r for r in rows if r["frame"] == "20"}
tracks = json.load(open("told"))["tracks"]
for name in ("ball", "drum", "union", 'a "box", 1'):
    x = [float(last[name][k]) for k in "xyz"]
    assert all(abs(a - b) < 1e-6 * (1 + abs(a)) for a, b in zip(x, tracks[name + ".translation"]["last"])), (name, x)
    q = [float(last[name]["q" + k]) for k in "xyzw"]
    assert abs(abs(sum(a * b for a, b in zip(q, tracks[name + ".rotation"]["last"]))) - 1) < 1e-6
frames = list(csv.DictReader(open("run-frames.csv")))
assert len(frames) == 21 and float(frames[4]["height, in m"]) == 1.2, frames[4]
assert frames[4]["collisions: probe"] == "2", frames[4]
events = list(csv.DictReader(open("run-events.csv")))
assert events and {e["kind"] for e in events} >= {"collision"} and events[0]["name_b"] is not None
contacts = list(csv.DictReader(open("run-contacts.csv")))
assert contacts and all(float(c["fz"]) >= 0 for c in contacts if c["a"] == "0")
assert list(csv.reader(open("run-results.csv"))) == [["name", "value", "unit"], ["end", "1", "s"]]
END

# and each says how many of what it has
exits 0 export run.h5 --to csv --force
for table in bodies:row frames:frame events:event contacts:row results:result; do
	count=$(python3 -c 'import csv, sys; print(len(list(csv.reader(open(sys.argv[1])))) - 1)' "run-${table%:*}.csv")
	word=${table#*:}$([ "$count" = 1 ] || echo s)
	grep -qx "run-${table%:*}.csv: $count $word" out || fail "run-${table%:*}.csv has $count $word, told: $(cat out)"
done

# the dump: atoms are bodies of a volume
exits 0 export run.h5 -o run.dump
python3 - <<'END' || fail "another dump"
import csv
lines = open("run.dump").read().split("\n")
assert lines[:4] == ["ITEM: TIMESTEP", "0", "ITEM: NUMBER OF ATOMS", "8"], lines[:4]
assert lines[4] == "ITEM: BOX BOUNDS ff ff ff"
names = lines[8].split()[2:]
assert len(lines) == 21 * 17 + 1
atoms = {int(a.split()[0]): dict(zip(names, map(float, a.split()))) for a in lines[-9:-1]}
rows = {int(r["id"]): r for r in csv.DictReader(open("run-bodies.csv")) if r["frame"] == "20"}
assert set(atoms) == {i + 1 for i in rows}
low, high = zip(*[map(float, lines[k].split()) for k in (5, 6, 7)])
for i, r in rows.items():
    a = atoms[i + 1]
    assert a["x"] == float(r["x"]) and a["quatw"] == float(r["qw"]) and a["omegaz"] == float(r["wz"])
    assert all(low[k] <= a["xyz"[k]] <= high[k] for k in range(3))
assert atoms[3]["radius"] == 0.5 and atoms[5]["radius"] == 0 and atoms[5]["shapey"] == 1
END

# VTK: a list of times, and files whose parts have the lengths that they say
exits 0 export run.h5 --to vtk
python3 - <<'END' || fail "other surfaces"
import re, struct, xml.etree.ElementTree as tree, os
sets = tree.parse("run.pvd").getroot().findall("Collection/DataSet")
assert len(sets) == 42 and float(sets[-1].get("timestep")) == 1 and len(os.listdir("run-vtk")) == 42
forces = [s for s in sets if s.get("name") == "contacts"]
sets = [s for s in sets if s.get("name") == "surfaces"]
assert len(forces) == len(sets) == 21
for one in sets:
    data = open(one.get("file"), "rb").read()
    head, rest = data.split(b'<AppendedData encoding="raw">\n_', 1)
    piece = tree.fromstring(head + b"</VTKFile>").find("PolyData/Piece")
    points, cells = int(piece.get("NumberOfPoints")), int(piece.get("NumberOfPolys"))
    found = {}
    for array in piece.iter("DataArray"):
        at = int(array.get("offset"))
        size, = struct.unpack_from("<Q", rest, at)
        code = {"Float32": "f", "Int64": "q", "Int32": "i"}[array.get("type")]
        found[array.get("Name")] = struct.unpack_from(f"<{size // struct.calcsize(code)}{code}", rest, at + 8)
        end = at + 8 + size
    assert rest[end:].strip() == b"</AppendedData>\n</VTKFile>", rest[end:end + 40]
    assert len(found["Points"]) == len(found["normal"]) == len(found["colour"]) == 3 * points
    assert len(found["connectivity"]) == 3 * cells and max(found["connectivity"]) < points
    assert found["offsets"] == tuple(range(3, 3 * cells + 1, 3)) and len(found["id"]) == cells
corners = {c for k, i in enumerate(found["id"]) if i == 4 for c in found["connectivity"][3 * k:3 * k + 3]}
middle = [sum(found["Points"][3 * c + k] for c in corners) / len(corners) for k in range(3)]
import csv
contacts = list(csv.DictReader(open("run-contacts.csv")))
at = 0
for one in forces:
    piece = tree.parse(one.get("file")).getroot().find("PolyData/Piece")
    column = {a.get("Name"): a.text.split() for a in piece.iter("DataArray")}
    count = int(piece.get("NumberOfVerts"))
    assert column["offsets"] == [str(i + 1) for i in range(count)]
    for i, c in enumerate(contacts[at:at + count]):
        assert [float(v) for v in column["force"][3 * i:3 * i + 3]] == [float(c["f" + k]) for k in "xyz"]
        assert [float(v) for v in column["Points"][3 * i:3 * i + 3]] == [float(c["p" + k]) for k in "xyz"]
        assert (column["a"][i], column["b"][i], float(column["gap"][i])) == (c["a"], c["b"], float(c["gap"]))
    at += count
assert at == len(contacts) > 0
row = [r for r in csv.DictReader(open("run-bodies.csv")) if r["id"] == "4"][-1]
assert all(abs(middle[k] - float(row["xyz"[k]])) < 1e-5 for k in range(3)), (middle, row)
END

# a scene in which nothing turns, one frame; nothing is replaced without --force
cat >still.lua <<'END'
world { duration = 0.1, frame_rate = 10 }
sphere { name = "s", radius = 1, mass = 1, position = {1e6, 0, 0}, texture = "none" }
END
exits 0 still.lua -q
# springs are lines of a file of their own, unless both ends are hidden
cat >springs.lua <<'END'
world { duration = 0.1, frame_rate = 20 }
local a = sphere { radius = 0.1, position = {0, 0, 0} }
local b = sphere { radius = 0.1, position = {2, 0, 0} }
local c = sphere { radius = 0.1, position = {4, 0, 0}, visible = false }
local d = sphere { radius = 0.1, position = {6, 0, 0}, visible = false }
spring { a = c, b = d, stiffness = 1, rest_length = 2 }
spring { a = a, b = b, stiffness = 1, rest_length = 2, at_b = {0, 0, 0.5} }
END
exits 0 springs.lua -q
exits 0 export springs.h5 --to vtk
python3 - <<'END' || fail "springs are no lines"
import os, xml.etree.ElementTree as tree
sets = tree.parse("springs.pvd").getroot().findall(".//DataSet")
assert [s.get("file") for s in sets][:2] == ["springs-vtk/000000.vtp", "springs-vtk/000000-springs.vtp"], sets
assert len(os.listdir("springs-vtk")) == len(sets) == 6
piece = tree.parse("springs-vtk/000000-springs.vtp").getroot().find("PolyData/Piece")
arrays = {a.get("Name"): [float(x) for x in a.text.split()] for a in piece.iter("DataArray")}
assert arrays == {"Points": [0, 0, 0, 2, 0, 0.5], "spring": [1], "connectivity": [0, 1], "offsets": [2]}, arrays
assert piece.get("NumberOfPoints") == "2" and piece.get("NumberOfLines") == "1"
END

for form in glb csv vtk dump; do
	exits 0 export still.h5 --to $form -q
	says_nothing out
	exits 73 export still.h5 --to $form
	says err 'exists'
	exits 0 export still.h5 --to $form --force
done
python3 "$TOP/tests/gltf.py" still.glb >told || fail "still.glb: no glTF"
exits 64 export still.h5
says err "needs '--to' csv, glb, vtk or dump"
exits 64 export still.h5 --to obj
says err 'not one of: csv, glb, vtk, dump'
exits 64 export still.h5 --to glb -o still.dump
says err "'still.dump' is a name for '--to' dump"
exits 64 export still.h5 --to vtk -o still.vtk
exits 66 export none.h5 --to glb
exits 66 export all.lua --to csv
mkdir -p far
exits 0 export still.h5 --to glb -o far/away.glb
[ -f far/away.glb ] || fail "no far/away.glb"
exits 73 export still.h5 --to glb -o nowhere/away.glb
sed 's/texture/visible = false, texture/' still.lua >hidden.lua
exits 0 hidden.lua -q
exits 66 export hidden.h5 --to glb
says err 'no visible body'
[ ! -e hidden.glb ] || fail "half a file stays"
echo 'record { fields = {"velocity"} }' >>still.lua
exits 0 still.lua -q --force
exits 66 export still.h5 --to dump --force
says err 'holds no positions'
exits 0 export still.h5 --to csv --force
