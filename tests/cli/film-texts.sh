#!/bin/sh
# SPDX-License-Identifier: MIT
# Labels stand above their bodies wherever these go, within the picture, and above each other where they would overlap; texts
# stand where they are put, and tell what functions return; a recording gives the same pictures. What is no text is told.
. tests/cli/functions
command -v ffmpeg >/dev/null || { echo "no ffmpeg"; exit 77; }
command -v python3 >/dev/null || { echo "no python3 to look at pictures with"; exit 77; }

cat >texts.lua <<'END'
world { title = "Texts", duration = 1, frame_rate = 2, gravity = {0, 0, -2} }
local function ball(name, x, z, vx)
	return sphere { name = name, radius = 0.25, position = {x, 0, z}, velocity = {vx, 0, 0}, visible = false, collides_with = {} }
end
local a, b, edge = ball("alpha", -2, 1, 4), ball("beta", 2, 1, 0), ball("a name that is long", 3.9, -1, 0)
local beside = ball("beside", -1.3, 1, 4)
local gone = ball("gone", 0, 50, 0)
local bar = box { name = "bar", size = {2, 0.1, 0.1}, position = {0, 0, -0.75}, visible = false, collides_with = {}, static = true }
local joined = body { name = "union", position = {0, 0, -0.75}, visible = false, collides_with = {}, static = true,
	shapes = {{shape = "box", size = {2, 0.1, 0.1}}, {shape = "sphere", radius = 0.1, position = {0.5, 0, 0.2}}} }
local function look(name, more)
	camera { name = name, projection = "orthographic", position = {0, -9, 0}, height = 5, background = {0, 0, 0}, size = {320, 200},
		fps = 2, png = name .. "/%d.png", labels = more.labels, text = more.text, overlay = more.overlay }
end
look("none", {})
look("one", {labels = {a, gone}})
look("two", {labels = {a, {b, "other"}}})
look("edge", {labels = {edge}})
look("beside", {labels = {a, {beside, "far wider"}}})
look("bar", {labels = {bar}})
look("union", {labels = {joined}})
look("low", {text = {{"one\ntwo", at = {1, 0}}}})
look("high", {overlay = "title", text = {"first", function(t) return "t = " .. t end}})
look("large", {text = {{function(t) return ("%.1f"):format(a.position.x) end, at = {0.5, 0.5}, size = 0.2}}})
END
exits 0 texts.lua -q
cat >look.py <<'END'
import subprocess
W, H = 320, 200
def picture(name):
    return subprocess.run(["ffmpeg", "-v", "error", "-i", name, "-f", "rawvideo", "-pix_fmt", "gray", "-"],
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, check=True).stdout
def box(name, part=(0, 0, W, H)):
    raw = picture(name + ".png")
    at = [(x, y) for y in range(part[1], part[3]) for x in range(part[0], part[2]) if raw[W * y + x] > 60]
    assert at, f"{name} is empty"
    return min(x for x, y in at), min(y for x, y in at), max(x for x, y in at), max(y for x, y in at)
def near(what, got, wanted, by):
    assert abs(got - wanted) <= by, f"{what}: {got}, wanted {wanted}"
assert max(picture("none/0.png")) < 60
# 40 px a metre: alpha at x = -2 + 4 t, z = 1 - t^2, its label above z + 0.25
for k, t in enumerate((0, 0.5, 1)):
    left, top, right, bottom = box(f"one/{k}")
    near("the middle of a label", (left + right) / 2, 160 + 40 * (-2 + 4 * t), 3)
    assert 1 < 100 - 40 * (1 - t * t + 0.25) - bottom < 10, f"a label at {top} to {bottom} at {t} s"
# at 1 s both are at the same place
left, top, right, bottom = box("two/2", (200, 0, W, H))
single = box("one/2", (200, 0, W, H))
assert bottom - top > 1.8 * (single[3] - single[1]) and right - left < 60, "labels cover each other"
# a line from the label that had to move, 40 px a metre, down to the body that it is of, and none from the other
top = 100 - 40 * (1 + 0.25)
raw = picture("beside/0.png")
for x, wanted in ((160 - 40 * 1.3, True), (160 - 40 * 2, False)):
    rows = [y for y in range(int(top) - 13, int(top) - 3) if max(raw[W * y + int(x) + d] for d in (-1, 0)) > 200]
    # where the lower label is, the line may be behind letters
    assert (len(rows) >= 8) == wanted, f"a line of {rows} at {x}"
assert box("edge/0")[2] < W - 2, "a label is cut"
near("the label of a bar that lies, below it", box("bar/0")[3], 100 + 40 * (0.75 - 0.05) - 4, 5)
near("the label of a union whose highest part is small", box("union/0")[3], 100 + 40 * (0.75 - 0.3) - 4, 5)
left, top, right, bottom = box("low/0")
assert right > 300 and bottom > 180 and left > 270 and bottom - top > 12, "a text at the lower right corner"
first, second = box("high/0", (0, 0, W, 40)), box("high/1", (0, 0, W, 40))
assert first[3] < 40 and second[2] > first[2] - 3, "lines at the upper left corner"
assert picture("high/0.png") != picture("high/1.png"), "a function is not asked again"
left, top, right, bottom = box("large/0")
near("the middle of a large text", (left + right) / 2, 160, 3)
assert 20 < bottom - top < 45, f"a large text is {bottom - top} px high"
END
python3 look.py || fail "the pictures are wrong"
mkdir again && mv none one two beside edge bar union low high large again
exits 0 render texts.h5 -q
for name in one two high large; do
	for k in 0 1 2; do
		cmp "$name/$k.png" "again/$name/$k.png" >/dev/null || fail "$name/$k.png is another one from the recording"
	done
done

cat >wrong.lua <<'END'
world { duration = 1 }
local s = sphere { radius = 1 }
camera { labels = {1} }
camera { labels = {{s, 5}} }
camera { labels = s }
camera { text = 5 }
camera { text = {"a", {"b", at = {2, 0}}} }
camera { text = {"b", at = {0, 0}, sise = 1} }
camera { text = {{at = {0, 0}}} }
END
exits 65 wrong.lua
for text in "3: camera: labels\[1\]: must be a body" "4: camera: labels\[1\]\[2\]: must be a text" "5: camera: 'labels' must be a list" \
	"6: camera: 'text' must be a text" "7: camera: text\[2\]: 'at' must lie in" "8: camera: text: unknown key 'sise'" \
	"9: camera: text\[1\]\[1\]: must be a text"; do
	says err "wrong.lua:$text"
done
cat >late.lua <<'END'
world { duration = 1 }
sphere { radius = 1 }
camera { name = "c", position = {0, -9, 0}, text = function(t) return t < 0.5 and "x" or nil end, png = "late/%d.png" }
END
exits 65 late.lua
grep -q "late.lua:3: 'text' must return a text (got nothing) (camera 'c', text at t = 0.5 s)" err || fail "$(cat err)"

# bodies by their names are those by their handles
cat >names.lua <<'END'
world { duration = 0.5, frame_rate = 4 }
local a = sphere { name = "a", radius = 0.5, velocity = {0, 0, 2} }
local b = box { name = "b", size = {1, 1, 1}, position = {2, 0, 0}, velocity = {1, 0, 0} }
for name, of in pairs { handles = {a = a, b = b}, names = {a = "a", b = "b"} } do
	camera { name = name, position = {0, -8, 0}, size = {96, 64}, samples = 1, png = name .. "/%d.png", trails = {of.a, of.b},
		labels = {of.a, {of.b, "box"}}, vectors = {{"velocity", bodies = {of.b}}} }
end
END
exits 0 names.lua -q
for k in 0 1 2; do
	[ "$(ffmpeg -v error -i names/$k.png -f md5 - </dev/null)" = "$(ffmpeg -v error -i handles/$k.png -f md5 - </dev/null)" ] ||
		fail "names of bodies are not their handles in picture $k"
done
echo 'world { duration = 1 } sphere { name = "a", radius = 1 } camera { trails = {"b"} }' >wrong.lua
exits 65 wrong.lua
says err "camera: trails\[1\]: no body is named 'b' so far"
