#!/bin/sh
# SPDX-License-Identifier: MIT
# A film of several cameras: each has its part of the picture and shows there what it shows alone, at the film's times, with its
# texts, functions and own place; from the recording as in the run. What is no list of cameras is told.
. tests/cli/functions
command -v ffmpeg >/dev/null || { echo "no ffmpeg"; exit 77; }
command -v python3 >/dev/null || { echo "no python3 to look at pictures with"; exit 77; }

cat >split.lua <<'END'
world { duration = 1, frame_rate = 4, gravity = {0, 0, -2} }
local a = sphere { name = "a", radius = 0.5, position = {0, 0, 1}, velocity = {1, 0, 0} }
local b = box { name = "b", size = {1, 1, 1}, position = {2, 0, -1} }
local function look(name, size, more)
	local def = { name = name, size = size, fps = 4, samples = 1, png = name .. "/%d.png" }
	for key, value in pairs(more) do def[key] = value end
	camera(def)
end
look("front", {160, 48}, {position = {0, -6, 1}, trails = {a}, labels = {a}, overlay = "energy"})
look("moves", {80, 48}, {position = function(t) return {t, -5, 2} end, text = function(t) return "t = " .. t end})
look("rides", {80, 48}, {mount = a, offset = {0, -3, 0}, level = true, look_at = b})
look("third", {53, 32}, {position = {0, -6, 1}, projection = "orthographic", height = 5})
camera { name = "sees all", size = {53, 32}, fps = 4, samples = 1, png = "all/%d.png" }
look("cone", {106, 32}, {position = {0, -6, 1}, frustum = {-1.5, 2.5, -1, 1, 5, 99}})
look("wide", {53, 32}, {position = {0, -6, 1}, frustum = {-1.5, 2.5, -2, 2, 5, 99}})
film { rows = {{"cone", "cone", "cone"}}, size = {159, 32}, png = "cones/%d.png", fps = 4 }
film { name = "big", rows = {{"front"}, {"moves", "rides"}}, size = {160, 96}, fps = 4, png = "big/%d.png" }
film { rows = {{"third", "sees all", "third"}}, size = {159, 32}, png = "late/%d.png", video = "late.mp4", fps = 4 }
END
exits 0 split.lua
says err "film +big/%d.png, film 'big': 5 pictures"
says err "film +late.mp4 and late.*, film 3: 5 pictures"
cat >look.py <<'END'
import subprocess
def picture(name, width, height):
    raw = subprocess.run(["ffmpeg", "-v", "error", "-i", name + ".png", "-f", "rawvideo", "-pix_fmt", "rgb24", "-"],
                         stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, check=True).stdout
    assert len(raw) == 3 * width * height, f"{name} is not {width} x {height}"
    return [raw[3 * width * y:3 * width * (y + 1)] for y in range(height)]
def part(rows, left, top, width, height):
    return [row[3 * left:3 * (left + width)] for row in rows[top:top + height]]
for k in range(5):
    late, big = picture(f"late/{k}", 159, 32), picture(f"big/{k}", 160, 96)
    third = picture(f"third/{k}", 53, 32)
    assert part(late, 0, 0, 53, 32) == third and part(late, 53, 0, 53, 32) == picture(f"all/{k}", 53, 32), f"a part at {k}"
    assert part(late, 106, 0, 53, 32) == third, f"one camera in two parts at {k}"
    cone = part(picture(f"cones/{k}", 159, 32), 0, 0, 53, 32)
    assert cone == picture(f"wide/{k}", 53, 32), "a frustum is drawn out to another shape"
    assert part(big, 0, 0, 160, 48) == picture(f"front/{k}", 160, 48), f"the upper row at {k}"
    assert part(big, 0, 48, 80, 48) == picture(f"moves/{k}", 80, 48), f"functions at {k}"
    assert part(big, 80, 48, 80, 48) == picture(f"rides/{k}", 80, 48), f"a mounted camera at {k}"
END
python3 look.py || fail "the pictures are wrong"
mkdir again && mv big late late.mp4 again
exits 0 render split.h5 -q --camera big
for k in 0 1 2 3 4; do
	cmp "big/$k.png" "again/big/$k.png" || fail "picture $k is another one from the recording"
done
exits 0 render split.h5 -q --camera big --frame 2 -o one.png
pixels() { ffmpeg -v error -i "$1" -f md5 - </dev/null; }
[ "$(pixels one.png)" = "$(pixels big/2.png)" ] || fail "a single picture is not that of the film"
# a contact sheet: its first cell is the film at the start, but for what is written
exits 0 render split.h5 --camera big --contact-sheet --size 480x288 -o sheet.png
exits 0 render split.h5 --camera big --frame 0 --size 480x288 -o first.png
cat >cell.py <<'END'
exec(open("look.py").read().split("for k in")[0])
sheet, first = picture("sheet", 1960, 1192), picture("first", 480, 288)
for x, y, width, height in (242, 146, 238, 100), (2, 146, 236, 100), (4, 4, 200, 60):
    cell, whole = part(sheet, 8 + x, 8 + y, width, height), part(first, x, y, width, height)
    off = sum(abs(a - b) > 8 for one, other in zip(cell, whole) for a, b in zip(one, other)) / (3 * width * height)
    assert off < 0.05, f"{off} of the part at {x}, {y} is another picture"
END
python3 cell.py || fail "the contact sheet is wrong"
exits 64 render split.h5 -o x.mp4
says err "there are 10 cameras: choose one with --camera \(there are front, moves, rides, third, sees all, cone, wide, big, and 2 without a name\)"
exits 0 split.lua --help
says out '^  big$'
cat >cameras.lua <<'END'
camera { name = "one", size = {40, 30}, position = {0, -6, 1}, samples = 1 }
film { rows = {{"one", "one"}}, size = {80, 30}, png = "with/%d.png" }
END
exits 0 render split.h5 -q --with cameras.lua
[ -s with/4.png ] || fail "no film of a file of cameras"

# gaps follow the height, and take no room that cells need: it was a bug message
cat >narrow.lua <<'END'
world { duration = 0.25, frame_rate = 4 }
sphere { radius = 1 }
camera { name = "one", size = {16, 16}, position = {0, -6, 0}, samples = 1 }
film { rows = {{"one", "one", "one", "one", "one", "one", "one", "one"}}, size = {16, 2400}, png = "narrow/%d.png", fps = 4 }
END
exits 0 narrow.lua -q
[ -s narrow/1.png ] || fail "no film of narrow cells"

# what --camera cannot name is counted beside what it can
cat >nameless.lua <<'END'
camera { name = "a", position = {0, -9, 0} }
camera { position = {0, 9, 0} }
film { rows = {{"a"}}, video = "film.mp4" }
END
exits 64 render split.h5 --with nameless.lua --contact-sheet -o none.png
says err "there are 3 cameras: choose one with --camera \(there are a, and 2 without a name\)"

cat >wrong.lua <<'END'
world { duration = 1 }
sphere { radius = 1 }
camera { name = "front" }
film { video = "a.mp4" }
film { rows = {{"front"}} }
film { rows = {"front"}, video = "a.mp4" }
film { rows = {{"frnt"}}, video = "a.mp4" }
film { rows = {{5}}, video = "a.mp4" }
film { rows = {{}}, video = "a.mp4" }
film { rows = {{"front"}}, video = "a.mp4", from = 2, to = 1 }
film { name = "front", rows = {{"front"}}, video = "a.avi" }
END
exits 65 wrong.lua
for text in "4: film: 'rows' is missing" "5: film: needs 'video' or 'png'" "6: film: rows\[1\]: must be a list of names" \
	"7: film: rows\[1\]\[1\]: no camera is named 'frnt' so far \(did you mean 'front'" "8: film: rows\[1\]\[1\]: must be the name" \
	"9: film: rows\[1\]: must be a list" "10: film: 'from' must not be after" "11: film.*'video' must end in" "11: .*'front' is taken"; do
	says err "wrong.lua:$text"
done
