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
look("more", {"energy", "kinetic_energy", "line"}, {from = 0.5, speed = 0.5, to = 1, overlay = "time"})
END
cat >>plots.lua <<'END'
local b = sphere { name = "b", visible = false, radius = 0.1, mass = 2, position = {5, 0, 0}, velocity = {0, 0, 1}, angular_velocity = {0, 4, 0},
	forces = {{vector = {0, 0, 4}}} }
local c = sphere { name = "c", visible = false, radius = 0.1, position = {5, 9, 0}, angular_velocity = {0, 0, 3} }
joint { name = "turns", kind = "hinge", a = c, at = {5, 9, 0}, axis = {0, 0, 1}, visible = false }
look("parts", {"b.z", "b.az", "b.angle", "turns.angle"})
look("sums", {"momentum", "#1.speed", "joint#0.speed", "collisions"})
END
exits 0 plots.lua -q
# the energy of a pendulum and the momentum of two bodies on a spring, which vary by rounding alone
cat >flat.lua <<'END'
world { duration = 2, frame_rate = 16, gravity = {0, 0, -9.81} }
local bob = sphere { radius = 0.1, mass = 1, position = {1, 0, 0}, visible = false }
joint { kind = "rod", a = bob, at_b = {0, 0, 0}, visible = false }
camera { position = {0, -9, 0}, background = {0, 0, 0}, size = {320, 180}, fps = 1, samples = 1, png = "flat/%d.png",
	overlay = {"energy", "scale"}, plots = {"energy", "kinetic_energy"} }
END
cat >still.lua <<'END'
world { duration = 2, frame_rate = 16, gravity = {0, 0, 0} }
local a = sphere { radius = 0.1, mass = 1.1, position = {0.7, 0.3, 0}, velocity = {0.3, 0, 0.7}, visible = false }
local b = sphere { radius = 0.1, mass = 3.3, position = {-0.7, 0, 0}, velocity = {-0.1, 0, -0.7 / 3}, visible = false }
spring { a = a, b = b, stiffness = 40, rest_length = 1, visible = false }
camera { position = {0, -9, 0}, background = {0, 0, 0}, size = {320, 180}, fps = 1, samples = 1, png = "still/%d.png",
	plots = {"momentum", "energy"} }
END
exits 0 flat.lua -q
exits 0 still.lua -q
exits 0 plot flat.h5 energy --json
python3 -c "
import json
energy = json.load(open('out'))['quantities'][0]['values']
assert min(energy) < max(energy), 'the energy does not vary'" || fail "nothing to be seen as flat"
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
def alone(name, number, bottom=0.9775, size=0.2294):  # points of the diagram of that number from below
    return {x: [y for y in ys if 0 < bottom - (size + 0.0125) * number - y / H < size] for x, ys in curve(name).items()}
for name in "parts", "sums":
    for number in range(4):
        assert len([x for x, ys in alone(name + "/8", number).items() if ys]) > 80, f"{name}: diagram {number} has no curve"
top = min(min(ys) for ys in curve("parts/8").values())
assert top > 8, f"the diagram at the top is cut off: its curve reaches row {top}, where its name should be"
z = {x: sum(ys) / len(ys) for x, ys in alone("parts/8", 0).items() if ys}
at = sorted(z)
slopes = [(z[at[k + 8]] - z[at[k]]) / 8 for k in (6, len(at) - 16)]
assert slopes[1] < 2 * slopes[0] < 0, f"z = t + t^2 rises ever faster: {slopes}"
def rows(name, *of):
    return [y for ys in alone(name, *of).values() for y in ys]
for name, number in ("still/2", 0), ("still/2", 1):
    seen = rows(name, number, 0.9775, 0.25)
    assert len(seen) > 80 and max(seen) - min(seen) <= 6, f"{name}: what is constant but for rounding takes {min(seen)} to {max(seen)} px"
# 13 px of the energy below, of which nothing is in diagrams, and as many again of the scale above
seen = rows("flat/2", 0, 0.93, 0.25)
assert len(seen) > 80 and max(seen) - min(seen) <= 6, "the energy of a pendulum is not flat"
assert max(max(ys) for ys in curve("flat/2").values()) < H - 13, "a diagram where the energy is written"
assert max(curve("half/8")) < 85, "a curve where there is no number"
END
python3 look.py || fail "the pictures are wrong"
mkdir again && mv line half more parts sums again
exits 0 render plots.h5 -q
for name in line/3 half/8 more/0 more/2 parts/8 sums/7; do
	cmp "$name.png" "again/$name.png" || fail "$name.png is another one from the recording"
done

# a single picture is that of the film: its curve begins where the film does, and its time is told as there
pixels()
{
	ffmpeg -v error -i "$1" -f rawvideo -pix_fmt rgb24 - </dev/null >"$2"
}
for pair in line/3 more/2; do
	exits 0 render plots.h5 --camera "${pair%/*}" --frame 6 -o one.png --force -q
	pixels one.png one.raw
	pixels "$pair.png" film.raw
	cmp one.raw film.raw || fail "the picture of frame 6 by itself is another one than $pair"
done

cat >wrong.lua <<'END'
world { duration = 1 }
sphere { radius = 1 }
probe("height", function() return 1 end)
camera { plots = {"heigt"} }
camera { plots = "height" }
camera { plots = {{"height", at = {2, 0}}} }
camera { plots = {5} }
sphere { name = "ball", radius = 1, position = {9, 0, 0} }
sphere { name = "rock", radius = 1, position = {-9, 0, 0}, static = true }
joint { name = "bar", kind = "rod", a = "ball", at_b = {9, 0, 9} }
camera { plots = {"bal.vx"} }
camera { plots = {"ball.vq"} }
camera { plots = {"rock.z"} }
camera { plots = {"bar.angle"} }
camera { plots = {"height", "height", "height", "height", "height"} }
END
exits 65 wrong.lua
says err "wrong.lua:4: camera: plots\[1\]: there is no probe or quantity 'heigt' so far \(did you mean 'height'\?\)"
says err "wrong.lua:11: .* quantity 'bal.vx' so far \(did you mean 'ball.vx'\?\)"
says err "wrong.lua:12: .* quantity 'ball.vq'"
says err "wrong.lua:13: .* the body of 'rock.z' never moves"
says err "wrong.lua:14: .* quantity 'bar.angle'"
for text in "5: camera: 'plots' must be a list" "6: camera: plots\[1\]: 'at' must lie in" "7: camera: plots\[1\]: must be the name" \
	"15: camera: 'plots' must be a list of at most 4 names \(got 5\)"; do
	says err "wrong.lua:$text"
done
