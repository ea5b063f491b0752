#!/bin/sh
# SPDX-License-Identifier: MIT
# Diagrams in pictures: the curve lies where the probe's values are, grows with the film, has gaps where there is no number, and is
# the same from the recording. Names that nothing has are told, with the nearest.
. tests/cli/functions
command -v ffmpeg >/dev/null || { echo "no ffmpeg"; exit 77; }
command -v python3 >/dev/null || { echo "no python3 to look at pictures with"; exit 77; }

cat >plots.lua <<'END'
world { duration = 2, frame_rate = 8 }
sphere { radius = 1, visible = false }
probe("line", function() return 3 * time() end, {unit = "m"})
probe("half", function() return time() < 1 and time() or 0/0 end)
local function look(name, plots, more)
	local def = { name = name, position = {0, -9, 0}, background = {0, 0, 0}, size = {320, 180}, fps = 4, samples = 1,
		png = name .. "/%d.png", plots = plots }
	for key, value in pairs(more or {}) do def[key] = value end
	camera(def)
end
look("line", {{"line", at = {0, 1}, size = {0.5, 0.5}}})
look("half", {{"half", at = {0, 1}, size = {0.5, 0.5}}})
look("more", {"energy", "kinetic_energy", "line"}, {from = 0.5, speed = 0.5, to = 1})
END
exits 0 plots.lua -q
cat >look.py <<'END'
import subprocess
W, H = 320, 180
def curve(name):  # points in the colour of curves, px, by column
    raw = subprocess.run(["ffmpeg", "-v", "error", "-i", name + ".png", "-f", "rawvideo", "-pix_fmt", "rgb24", "-"],
                         stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, check=True).stdout
    columns = {}
    for i in range(W * H):
        r, g, b = raw[3 * i:3 * i + 3]
        if r > 120 and g > 100 and b < r // 2:
            columns.setdefault(i % W, []).append(i // W)
    return columns
whole, begun = curve("line/8"), curve("line/2")
assert min(whole) <= 2 and 155 <= max(whole) <= 165, "the curve of the whole run has the width of the diagram"
assert 36 <= max(begun) <= 44, f"at a quarter of the run the curve ends at {max(begun)} px, wanted 40"
tops = [sum(whole[x]) / len(whole[x]) for x in range(10, 150)]
slope = (tops[-1] - tops[0]) / (len(tops) - 1)
assert slope < -0.3 and all(abs(tops[k] - tops[0] - slope * k) < 1.5 for k in range(len(tops))), "no straight line"
assert max(curve("half/8")) < 85, "a curve where there is no number"
END
python3 look.py || fail "the pictures are wrong"
mkdir again && mv line half more again
exits 0 render plots.h5 -q
for name in line/3 half/8 more/0 more/2; do
	cmp "$name.png" "again/$name.png" || fail "$name.png is another one from the recording"
done

cat >wrong.lua <<'END'
world { duration = 1 }
sphere { radius = 1 }
probe("height", function() return 1 end)
camera { plots = {"heigt"} }
camera { plots = "height" }
camera { plots = {{"height", at = {2, 0}}} }
camera { plots = {5} }
camera { plots = {"height", "height", "height", "height", "height"} }
END
exits 65 wrong.lua
says err "wrong.lua:4: camera: 'plots': no probe is named 'heigt' so far \(did you mean 'height'\?\)"
for line in 5 6 7 8; do
	says err "wrong.lua:$line: camera: 'plots' must be"
done
