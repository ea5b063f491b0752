#!/bin/sh
# SPDX-License-Identifier: MIT
# Slow motion shows the arc: a ball that bounces, at a twentieth of its speed, stands in every picture within half a pixel
# of where the closed form has it, in the film of the run and in that of its recording, by every method.
. tests/cli/functions
command -v ffmpeg >/dev/null || { echo "no ffmpeg"; exit 77; }
command -v python3 >/dev/null || { echo "no python3 to look at pictures with"; exit 77; }

cat >s.lua <<'END'
local method = param("method", "auto", "of the run")
-- of the classic method such steps as leave its own error of position, g h t / 2, far below a pixel
world { duration = 1.2, frame_rate = 20, gravity = {0, 0, -9.81}, method = method,
	time_step = method == "classic" and 1e-4 or nil }
local rubber = material { restitution = 0.8, friction = 0 }
plane { material = rubber, color = {0, 0, 0} }
sphere { radius = 0.1, position = {0, 0, 1.1}, material = rubber, color = {1, 1, 1} }
camera { position = {0, -40, 0.6}, look_at = {0, 0, 0.6}, fov = 0.03, size = {64, 192}, speed = 0.05, fps = 20,
	background = {0, 0, 0}, shadows = false, overlay = {}, png = "live/%04d.png" }
END
cat >look.py <<'END'
import math, subprocess, sys
W, H = 64, 192
folder, bound = sys.argv[1], float(sys.argv[2])
raw = subprocess.run(["ffmpeg", "-v", "error", "-i", folder + "/%04d.png", "-f", "rawvideo", "-pix_fmt", "gray", "-"],
                     stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, check=True).stdout
pixel = 2 * 40 * math.tan(0.015) / H  # metres, at the ball

def height(t):
    drop, g, e = 1.0, 9.81, 0.8
    t0 = math.sqrt(2 * drop / g)
    if t < t0:
        return 0.1 + drop - g * t * t / 2
    v, t = e * g * t0, t - t0
    while t > 2 * v / g:
        t -= 2 * v / g
        v *= e
    return 0.1 + v * t - g * t * t / 2

count, worst, worst_s = len(raw) // (W * H), 0, 0
for n in range(count):
    picture = raw[n * W * H:(n + 1) * W * H]
    rows = [y + 0.5 for y in range(H) for x in range(W) if picture[y * W + x] > 12]
    t = n * 0.05 / 20
    found = 0.6 + (H / 2 - sum(rows) / max(len(rows), 1)) * pixel
    if abs(found - height(t)) > worst:
        worst, worst_s = abs(found - height(t)), t
print(f"{folder}: {count} pictures, {1000 * pixel:.2f} mm a pixel, at most {1000 * worst:.2f} mm"
      f" ({worst / pixel:.2f} pixels) off, at {worst_s:.4f} s")
sys.exit(count != 481 or worst > bound * pixel)
END

# a program with a sanitizer draws slowly, and the same whatever moved the ball
methods='auto stepped classic'
[ "${RBSIM_MODE:-release}" = release ] || methods=auto
for method in $methods; do
	rm -rf live
	exits 0 s.lua --param method=$method --force --quiet
	cp -r live "$method-live"
	rm -rf live
	exits 0 render s.h5 --force --quiet
	cp -r live "$method-recorded"
	for way in live recorded; do
		python3 look.py "$method-$way" 0.5 >>measured || fail "$(tail -n 1 measured)"
	done
done
cat measured

# What a film from the recording would lack is said before the run, by render, and without positions nothing is filmed.
cat >few.lua <<'END'
local more = param("more", false, "adds to the default")
world { duration = 0.2, frame_rate = 20, gravity = {0, 0, -9.81} }
record { fields = more and {"+", "contacts"} or {"velocity"} }
sphere { radius = 0.1, position = {0, 0, 1.1} }
camera { position = {0, -4, 0.6}, look_at = {0, 0, 0.6}, size = {64, 48}, speed = 0.3, png = "few/%03d.png" }
END
exits 0 few.lua --no-render
grep -q "'few.h5' holds no positions.*no film can be made" err || fail "no warning: $(cat err)"
grep -q "'few.h5' holds no events" err || fail "no warning of events: $(cat err)"
exits 66 render few.h5
grep -q "holds no positions ('fields' of record" err || fail "$(cat err)"
exits 0 few.lua --no-render --force --param more=true
grep -q "warning" err && fail "a warning of nothing: $(cat err)"
exits 0 render few.h5
exits 0 info few.h5
grep -q "position velocity contacts events" out || fail "fields: $(cat out)"
