#!/bin/sh
# SPDX-License-Identifier: MIT
# Arrows of every kind point where they should and are as long as scale says, of the bodies that were chosen; what they need is
# recorded by default, so the recording gives the same pictures, also between frames. Springs have the looks that were given.
. tests/cli/functions
command -v ffmpeg >/dev/null || { echo "no ffmpeg"; exit 77; }
command -v python3 >/dev/null || { echo "no python3 to look at pictures with"; exit 77; }

# a ball of 2 kg that moves to the right and turns about the upward axis, one that hangs on a spring stretched by 0.1 m, one
# that lies; arrows of 1 m
cat >arrows.lua <<'END'
world { duration = 0.25, frame_rate = 4, gravity = {0, 0, -10} }
plane { normal = {0, 0, 1}, point = {0, 0, -2.2}, visible = false }
local function ball(name, x, more)
	local def = { name = name, radius = 0.2, mass = 2, position = {x, 0, 0}, color = {0.2, 0.2, 0.2}, texture = "none" }
	for key, value in pairs(more) do def[key] = value end
	return sphere(def)
end
local a = ball("a", -2, {velocity = {0.5, 0, 0}, angular_velocity = {0, 0, 4}, forces = {{vector = {0, 0, 20}}}})
local hook = ball("hook", 1, {static = true, position = {1, 0, 1.9}, radius = 0.01, mass = 1})
local b = ball("b", 1, {})
local c = ball("c", 3, {position = {3, 0, -2}})
spring { a = hook, b = b, stiffness = 200, rest_length = 1.8, radius = 0.05, color = {1, 0, 0} }
spring { a = hook, b = c, stiffness = 0, visible = false, color = {0, 0, 1} }
joint { kind = "rod", a = hook, b = b, length = 1.9, visible = true, radius = 1e-3 }
local function look(name, vectors, fps)
	camera { name = name, projection = "orthographic", position = {0, -9, 0}, height = 5, background = {0, 0, 0}, size = {320, 200},
		fps = fps or 4, png = name .. "/%d.png", vectors = vectors, samples = 1 }
end
look("none", {})
look("velocity", {{"velocity", scale = 2}})
look("others", {{"velocity", bodies = {b, c}, scale = 2}})
look("momentum", {"momentum", scale = 1})
look("spin", {{"angular_velocity", bodies = {a}, scale = 0.25}})
look("spring", {{"spring", scale = 0.05}}, 16)
look("contact", {{"contact", scale = 0.05}})
look("force", {{"force", bodies = {c}, scale = 1}, {"acceleration", bodies = {c}}})
look("joint", {"joint", "velocity", "contact", "acceleration", "force"}, 16)
END
exits 0 arrows.lua -q
cat >look.py <<'END'
import subprocess
W, H = 320, 200
def picture(name):
    return subprocess.run(["ffmpeg", "-v", "error", "-i", name + ".png", "-f", "rawvideo", "-pix_fmt", "rgb24", "-"],
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, check=True).stdout
plain = picture("none/0")
def box(name):  # m, right and up from the middle, of what differs from the picture without arrows
    raw, plain = picture(name), picture("none/" + name.split("/")[1])
    at = [(i % W, i // W) for i in range(W * H) if raw[3 * i:3 * i + 3] != plain[3 * i:3 * i + 3]]
    assert at, f"{name}: no arrow"
    xs, ys = [(x + 0.5 - W / 2) / 40 for x, y in at], [(H / 2 - y - 0.5) / 40 for x, y in at]
    return min(xs), min(ys), max(xs), max(ys)
def same(name, got, wanted):  # arrows are 3 px thick, their heads more, their rims one more
    for g, w in zip(got, wanted):
        assert w is None or abs(g - w) < 0.12, f"{name}: {got}, wanted {wanted}"
same("velocity", box("velocity/0"), (-2, None, -1, None))
assert picture("others/0") == plain, "arrows of bodies that were not chosen, or of what stands"
same("momentum", box("momentum/0"), (-2, None, -1, None))
same("spin", box("spin/0"), (None, 0, None, 1))
same("spring", box("spring/0"), (None, 0, None, 1))
assert 0.8 < box("spring/0")[0] and box("spring/0")[2] < 1.2
same("contact", box("contact/1"), (2.85, -2.2, 3.15, -1.2))
assert picture("force/1") == picture("none/1"), "a body that lies has a force on it"
reds = sum(1 for i in range(W * H) if plain[3 * i] > 100 and plain[3 * i + 1] < 60 and plain[3 * i + 2] < 60)
blues = sum(1 for i in range(W * H) if plain[3 * i + 2] > 100 and plain[3 * i] < 60)
assert reds > 50 and blues == 0, f"a spring of {reds} red points, one that is hidden of {blues}"
END
python3 look.py || fail "the pictures are wrong"
mkdir again && mv velocity spring joint contact again
exits 0 render arrows.h5 --camera velocity,spring,joint,contact
! grep warning err || fail "what arrows need is not recorded"
for name in velocity/0 spring/2 joint/0 joint/1 joint/3 contact/1; do
	cmp "$name.png" "again/$name.png" >/dev/null || fail "$name.png is another one from the recording"
done

# what is small for its distance, like planets, has arrows that are seen, and a dot if it has a label
cat >small.lua <<'END'
world { duration = 1, frame_rate = 1 }
local a = sphere { name = "a", radius = 1e-4, position = {-5, 0, 0}, velocity = {0, 0, 2}, color = {1, 0, 0}, texture = "none" }
local b = sphere { name = "b", radius = 1e-4, position = {5, 0, 0}, color = {1, 0, 0}, texture = "none" }
local c = sphere { name = "c", radius = 1e-4, static = true, color = {1, 0, 0}, texture = "none" }
for _, look in ipairs {{"none", {}}, {"velocity", {}}, {"label", {b, c}}} do
	camera { name = look[1], projection = "orthographic", position = {0, -9, 0}, height = 8, background = {0, 0, 0}, size = {320, 200},
		labels = look[2], vectors = look[1] == "velocity" and "velocity" or nil, png = "small/" .. look[1] .. "%d.png" }
end
END
exits 0 small.lua -q
cat >look.py <<'END'
import subprocess
W, H = 320, 200
def picture(name):
    return subprocess.run(["ffmpeg", "-v", "error", "-i", "small/" + name + "0.png", "-f", "rawvideo", "-pix_fmt", "rgb24", "-"],
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, check=True).stdout
plain, arrow, label = picture("none"), picture("velocity"), picture("label")
rows = {i // W for i in range(W * H) if arrow[3 * i:3 * i + 3] != plain[3 * i:3 * i + 3]}
# 25 px a metre: 1.5 quarters of 10 m / cbrt(2) are 2.98 m
assert abs(len(rows) - 75) < 6, f"an arrow of {len(rows)} px"
for x in (160, 285):
    near = [3 * (W * y + i) for y in range(98, 104) for i in range(x - 4, x + 4)]
    seen, bare = (sum(p[i] > 100 for i in near) for p in (label, plain))
    assert seen > bare + 4, f"at {x} {seen} red points with a label, {bare} without"
END
python3 look.py || fail "the pictures of what is small are wrong"

# fields that the scene states are kept; the warning is of films of the recording
sed 's/^world.*/& record { fields = "position" }/' arrows.lua >few.lua
exits 0 few.lua --camera contact --force
says err "'few.h5' holds no contacts \('fields' of record\): films of it do not show their arrows"
cmp contact/1.png again/contact/1.png || fail "few fields change the pictures of the run"
cat >wrong.lua <<'END'
world { duration = 1 }
local s = sphere { radius = 1 }
camera { vectors = "velocty" }
camera { vectors = {"velocity", {"force", scale = -1}} }
camera { vectors = {{"force", bodies = {}}} }
camera { vectors = {{"force", bodys = {s}}} }
camera { vectors = {{5, bodies = {s}}} }
END
exits 65 wrong.lua
says err "wrong.lua:3: camera: 'vectors' must be one of velocity, .* \(did you mean 'velocity'\?\)"
for text in "4: camera: vectors\[2\]: 'scale' must be positive \(got -1\)" "5: camera: vectors\[1\]: 'bodies' must not be empty" \
	"6: camera: vectors\[1\]: unknown key 'bodys'" "7: camera: vectors\[1\]\[1\]: must be one of"; do
	says err "wrong.lua:$text"
done
