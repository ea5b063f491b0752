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

# A speed that is a function of time: pictures stand where the integral of its inverse says, end with the film, and are the same
# from the recording and in a film of several; the speed of the command line replaces it. What is no speed is told.
cat >speed.lua <<'END2'
world { duration = 2, frame_rate = 8 }
sphere { name = "s", radius = 1, velocity = {1, 0, 0} }
local function look(name, speed, more)
	local def = { name = name, position = {0, -9, 0}, size = {32, 32}, fps = 8, samples = 1, speed = speed, png = name .. "/%d.png",
		text = function(t) print(string.format("%s %.17g", name, t)) return "" end }
	for key, value in pairs(more or {}) do def[key] = value end
	camera(def)
end
look("one", function(t) return 1 end)
look("slow", function(t) return t < 1 and 0.25 or 1 end, {overlay = "time", size = {240, 64}})
look("grows", function(t) return 1 + t end, {from = 0.5, to = 1.5})
film { name = "both", rows = {{"slow", "grows"}}, size = {64, 32}, png = "both/%d.png" }
END2
exits 0 speed.lua
cat >times.py <<'END2'
import math
def times(name):
    return sorted({float(line.split()[1]) for line in open("err") if line.startswith(name + " ")})
assert times("one") == [k / 8 for k in range(17)], "frames are met to the bit"
slow = times("slow")
assert slow[:32] == [k / 32 for k in range(32)] and slow[-1] <= 2, "a quarter of the speed"
assert all(abs(b - a - 1 / 8) < 1e-15 for a, b in zip(slow[32:], slow[33:])), "the whole speed"
assert all(min(abs(t - 1.5 * math.exp(k / 8) + 1) for t in times("grows")) < 1e-5 for k in range(5)), "t' = 1 + t"
END2
python3 times.py || fail "pictures stand at other times"
[ "$(ls slow | wc -l)" = 40 ] && [ "$(ls grows | wc -l)" = 5 ] && [ "$(ls both | wc -l)" = 40 ] || fail "not as many pictures"
mkdir again && cp -r one slow grows both again
exits 0 render speed.h5 --force -q
for name in one slow grows both; do
	diff -r "$name" "again/$name" || fail "$name is another film from the recording"
done
exits 0 render speed.h5 --camera slow --speed 1 -o plain/%d.png
[ "$(ls plain | wc -l)" = 17 ] || fail "the speed of the command line does not hold"
for wrong in "0" "'fast'" "0/0" "error('no')"; do
	echo "world { duration = 1 } sphere { radius = 1 } camera { name = 'c', png = 'c/%d.png', speed = function(t) return $wrong end }" >wrong.lua
	exits 65 wrong.lua -q
	says err "^wrong.lua:1: .* \(camera 'c', speed at t = 0 s\)"
done
for wrong in 1e-300 1e-12; do
	printf 'world { duration = 1 }\nsphere { radius = 1 }\ncamera { png = "c/%%d.png", speed = function() return %s end }\n' $wrong >wrong.lua
	exits 65 wrong.lua --force
	says err "^wrong.lua:3: the speed .* \(camera of line 3, speed at t = "
done
echo "world { duration = 1 } sphere { radius = 1 } camera { speed = 'fast' } camera { speed = 0 }" >wrong.lua
exits 65 wrong.lua
says err "'speed' must be a number or a function \(got the text 'fast'\)"
says err "'speed' must be positive \(got 0\)"
