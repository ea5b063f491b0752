#!/bin/sh
# SPDX-License-Identifier: MIT
# Velocities that callbacks set between frames are seen between frames: a ball that falls and is thrown up once, in the
# middle of a frame interval, stands in every picture within half a pixel of where the closed form has it.
. tests/cli/functions
command -v ffmpeg >/dev/null || { echo "no ffmpeg"; exit 77; }
command -v python3 >/dev/null || { echo "no python3 to look at pictures with"; exit 77; }

cat >s.lua <<'END'
world { duration = 0.4, frame_rate = 10, gravity = {0, 0, -9.81}, time_step = 0.0125,
	method = param("method", "located", "of the run") }
local ball = sphere { radius = 0.1, position = {0, 0, 1.1}, color = {1, 1, 1} }
state.done = false
on_step(function(t) if t > 0.1499 and not state.done then state.done = true ball:set_velocity {0, 0, 2} end end)
camera { position = {0, -40, 1}, look_at = {0, 0, 1}, fov = 0.03, size = {64, 192}, speed = 0.05, fps = 20,
	background = {0, 0, 0}, shadows = false, overlay = {}, png = "live/%04d.png" }
END
cat >look.py <<'END'
import math, subprocess, sys
W, H = 64, 192
raw = subprocess.run(["ffmpeg", "-v", "error", "-i", sys.argv[1] + "/%04d.png", "-f", "rawvideo", "-pix_fmt", "gray", "-"],
                     stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, check=True).stdout
pixel = 2 * 40 * math.tan(0.015) / H

def height(t):
    s, u = 0.15, t - 0.15
    return 1.1 - 9.81 * t * t / 2 if t < s else 1.1 - 9.81 * s * s / 2 + 2 * u - 9.81 * u * u / 2

count, worst, worst_s = len(raw) // (W * H), 0, 0
for n in range(count):
    picture = raw[n * W * H:(n + 1) * W * H]
    rows = [y + 0.5 for y in range(H) for x in range(W) if picture[y * W + x] > 12]
    t = n * 0.05 / 20
    off = abs(1 + (H / 2 - sum(rows) / max(len(rows), 1)) * pixel - height(t))
    if off > worst:
        worst, worst_s = off, t
print(f"{sys.argv[1]}: {count} pictures, at most {worst / pixel:.2f} pixels off, at {worst_s:.4f} s")
sys.exit(count != 161 or worst > 0.5 * pixel)
END
for method in located stepped; do
	rm -rf live
	exits 0 s.lua --param method=$method --force --quiet
	mv live "$method-live"
	exits 0 render s.h5 --force --quiet
	mv live "$method-recorded"
	for way in live recorded; do
		python3 look.py "$method-$way" >>measured || failed=yes
	done
done
cat measured
[ -z "${failed:-}" ] || fail "pictures are off"
