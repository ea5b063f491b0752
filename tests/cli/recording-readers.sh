#!/bin/sh
# SPDX-License-Identifier: MIT
# A recording opens in the readers that people use, with the same bits (tests/readers/check.py).
set -eu
top=$(cd "$(dirname "$0")/../.." && pwd)
python=${RBSIM_PYTHON:-}
for p in "$python" /usr/bin/python3 python3; do
	[ -n "$p" ] && "$p" -c 'import h5py' 2>/dev/null && { python=$p; break; }
	python=
done
[ -n "$python" ] || { echo "no Python with h5py (RBSIM_PYTHON can name one)"; exit 77; }
cd "$TMPDIR"

cat >all.lua <<'END'
local e = param("e", 0.8, "restitution", {min = 0, max = 1})
world { title = "readers", duration = 1, frame_rate = 60, gravity = {0, 0, -9.81} }
local m = material { name = "rubber", density = 1100, friction = 0.6, restitution = e }
plane { normal = {0, 0, 1}, material = m }
for i = 1, 5 do
	sphere { name = "ball " .. i, radius = 0.1, position = {0.5 * i, 0, 0.2 + 0.1 * i}, material = m,
		velocity = {1, 0, 0} }
end
record { fields = {"position", "orientation", "velocity", "angular_velocity", "contacts", "events"} }
END
sed 's/record {.*/record { precision = "single", compression = 4, every = 7 }/' all.lua >packed.lua
cat >still.lua <<'END'
world { title = "nothing turns", duration = 0.5 }
sphere { radius = 0.1, velocity = {1, 0, 0} }
END
cat >worn.lua <<'END'
world { duration = 0.1 }
sphere { radius = 0.1, texture = "skins/globe.png" }
END
# a body of every shape, whose surfaces VTK is to see
cat >seen.lua <<'END'
world { title = "All shapes", duration = 0.4, frame_rate = 20, gravity = {0, 0, -9.81} }
local m = material { name = "m", friction = 0.4, restitution = 0.2, density = 1000 }
plane { normal = {0, 0, 1}, material = m }
plane { name = "ramp", size = {2, 2}, point = {-2, 0, 0.6}, normal = {0.5, 0, 0.87}, material = m }
terrain { size = {3, 3}, cells = {6, 6}, height = function(x, y) return 0.15 * math.sin(3 * x) end, position = {3, 3, 0.2}, material = m }
sphere { radius = 0.3, position = {-2, 0, 0.95}, material = m, texture = "beachball" }
sphere { radius = 0.1, position = {0, -1, 0.1}, material = m, visible = false }
box { size = {0.6, 0.5, 0.4}, position = {0, 0, 0.2}, material = m }
capsule { radius = 0.15, length = 0.5, position = {1, 0, 1}, material = m, angular_velocity = {1, 2, 3} }
cylinder { radius = 0.2, length = 0.5, position = {2, 0, 0.25}, material = m }
hull { points = {{0,0,0},{0.6,0,0},{0,0.6,0},{0,0,0.6}}, position = {0, 1.5, 1}, material = m, angular_velocity = {3, 0, 1} }
body { position = {1.5, 1.5, 1}, material = m, shapes = { {shape = "sphere", radius = 0.2, position = {-0.3, 0, 0}},
	{shape = "box", size = {0.6, 0.1, 0.1}} } }
record { fields = {"+", "contacts", "surfaces"} }
END
cat >bare.lua <<'END'
world { duration = 0.1 }
plane { normal = {0, 0, 1} }
END
mkdir skins
"$python" - <<'END'
import struct, zlib
def chunk(name, data):
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
rows = b"".join(b"\0" + bytes([40 * y, 0, 255 - x]) for y in range(2) for x in range(1))
open("skins/globe.png", "wb").write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 1, 2, 8, 2, 0, 0, 0))
    + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))
END
"$RBSIM" bare.lua --quiet
# an interrupted run does not stay to make surfaces
echo 'at 0.2 quit' >commands
status=0
"$RBSIM" seen.lua -o cut.h5 --commands commands --quiet || status=$?
[ $status -eq 130 ] || { echo "'quit' ends with $status"; exit 1; }
cp cut.h5 repaired.h5
"$RBSIM" repair repaired.h5
for scene in all packed still worn seen; do
	"$RBSIM" "$scene.lua" -o "$scene.h5" --quiet
	echo "== $scene"
	"$python" "$top/tests/readers/check.py" "$scene.h5"
done

# Who reads while the run ends keeps nothing out of the recording, and reads on. (Before HDF5 1.10.7 and 1.12.1 a program cannot do
# without the library's lock.)
if "$python" -c 'import h5py, sys; v = h5py.h5.get_libversion(); sys.exit(v < (1, 10, 7) or (1, 12, 0) <= v < (1, 12, 1))'; then
	echo 'at 0.2 pause' >commands
	for scene in all seen; do
		"$python" - "$RBSIM" "$scene" <<'END'
import os, subprocess, sys, time
import h5py
program, scene = sys.argv[1:]
run = subprocess.Popen([program, f"{scene}.lua", "-o", f"{scene}.watched.h5", "--listen", "watched", "--commands", "commands"],
                       stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
while not os.path.exists(f"{scene}.watched.h5"):
    assert run.poll() is None, run.stderr.read()
    time.sleep(0.01)
reader = h5py.File(f"{scene}.watched.h5", "r", libver="latest", swmr=True)
height = reader["/particles/bodies/position/value"]
while subprocess.run([program, "ctl", "watched", "play"], capture_output=True).returncode:
    assert run.poll() is None, run.stderr.read()
said = run.communicate()[1]
assert run.returncode == 0 and "VTKHDF" not in said, said
height.refresh()
seen = height[:, 0, 2]
with h5py.File(f"{scene}.h5", "r") as whole:
    want = whole["/particles/bodies/position/value"][:, 0, 2]
assert len(seen) > 1 and (seen == want[:len(seen)]).all()
reader.close()
with h5py.File(f"{scene}.watched.h5", "r") as f:
    assert "VTKHDF" in f, "a reader has kept /VTKHDF out"
    assert (f["/particles/bodies/position/value"][:, 0, 2] == want).all()
END
		"$python" "$top/tests/readers/check.py" "$scene.watched.h5"
	done
fi

# VTK's own picture of them, where there is a VTK that can draw
if "$python" -c 'import vtkmodules.vtkRenderingOpenGL2' 2>/dev/null; then
	"$python" "$top/tests/readers/picture.py" seen.h5 seen.png
fi

# what a scene cannot change is not stored per frame, and what it says is stored as it is
"$python" - <<'END'
import h5py, hashlib
assert "VTKHDF" not in h5py.File("bare.h5", "r")  # nothing moves
v = h5py.File("seen.h5", "r")["VTKHDF"]
assert list(v["Assembly"]) == ["bodies", "surfaces", "statics", "contacts"]
shown = set(v["surfaces/CellData/id"][:]) | set(v["statics/CellData/id"][:])
assert shown == set(range(10)) - {4}, shown  # all but the one that is not visible
assert v["statics/Points"].shape[0] == v["statics/NumberOfPoints"][0], "what stays stands there once"
assert v["surfaces/Polygons/NumberOfCells"][0] == len(v["surfaces/CellData/color"])
# a face of the beach ball is white, the next one is not
ball = v["surfaces/CellData/color"][:][v["surfaces/CellData/id"][:] == 3]
assert len(set(map(bytes, ball))) >= 2
assert "surfaces" in h5py.File("repaired.h5", "r")["VTKHDF"]
for name in ("all", "packed", "still", "worn", "cut"):  # not asked for, or cut short: not there
    assert not {"surfaces", "statics"} & set(h5py.File(name + ".h5", "r")["VTKHDF"])
f = h5py.File("still.h5", "r")
assert f["particles/bodies/orientation"].shape == (1, 4)
assert "angular_velocity" not in f["particles/bodies"]
assert list(f["observables/contacts/value"]) == [0] * 31
f = h5py.File("all.h5", "r")
assert f["rbsim/scene"][()] == open("all.lua", "rb").read()
assert f["rbsim/parameters/e"][()] == 0.8 and f["rbsim/parameters/e"].attrs["max"] == 1
assert [n.decode() for n in f["rbsim/names"]] == [""] + ["ball %d" % i for i in range(1, 6)]
assert list(f["particles/bodies/id"]) == [1, 2, 3, 4, 5] and list(f["particles/statics/id"]) == [0]
assert len(f["rbsim/events/time"]) > 0
assert f["rbsim/status"][()] == b"complete" and len(f["rbsim/state_hash"][()]) == 16
# a picture comes back to the last byte
f = h5py.File("worn.h5", "r")
skin = f["rbsim/files/skins%2Fglobe.png"]
assert skin.dtype == "uint8" and skin[()].tobytes() == open("skins/globe.png", "rb").read()
assert skin.attrs["sha256"] == hashlib.sha256(skin[()].tobytes()).hexdigest() or \
    skin.attrs["sha256"].decode() == hashlib.sha256(skin[()].tobytes()).hexdigest()
assert list(h5py.File("packed.h5", "r")["particles/bodies/position/step"]) == list(range(0, 57, 7)) + [60]
END
