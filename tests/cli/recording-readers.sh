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
for scene in all packed still worn; do
	"$RBSIM" "$scene.lua" -o "$scene.h5" --quiet
	echo "== $scene"
	"$python" "$top/tests/readers/check.py" "$scene.h5"
done

# what a scene cannot change is not stored per frame, and what it says is stored as it is
"$python" - <<'END'
import h5py, hashlib
assert "VTKHDF" not in h5py.File("bare.h5", "r")  # nothing moves
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
