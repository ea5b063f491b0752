#!/bin/sh
# SPDX-License-Identifier: MIT
# A camera without a position sees all that moves over the whole time that it shows: in every picture of ten scenes without a
# camera every moving body is to be seen, by its colour. What flies off for ever is left out and named.
. tests/cli/functions
command -v ffmpeg >/dev/null || { echo "no ffmpeg"; exit 77; }
command -v python3 >/dev/null || { echo "no python3 to look at pictures with"; exit 77; }

cat >s.lua <<'END'
local n = param("scene", 1, "which", {min = 1, max = 11})
local colors = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {1, 0, 1}}
local count = 0
local function look(def)
	count = count + 1
	def.color, def.texture, def.name = colors[count], "none", "body" .. count
	return def
end
local function ball(def) return sphere(look(def)) end
local down = {0, 0, -9.81}
local rubber = material { restitution = 0.8, friction = 0.3 }
local scenes = {
	function() -- a drop
		world { duration = 3, gravity = down }
		plane { material = rubber }
		ball { radius = 0.1, position = {0, 0, 2}, material = rubber }
	end,
	function() -- a throw, with nothing below
		world { duration = 3, gravity = down }
		ball { radius = 0.2, position = {0, 0, 0}, velocity = {5, 0, 12} }
	end,
	function() -- from a ramp over the floor
		world { duration = 4, gravity = down }
		plane { material = rubber }
		box(look { size = {0.4, 0.3, 0.2}, position = {0, 0, 1}, velocity = {3, 1, 0}, angular_velocity = {1, 8, 2}, material = rubber })
		ball { radius = 0.2, position = {-2, 0, 0.2}, velocity = {1, 0, 0}, material = rubber }
	end,
	function() -- two meet in space and part
		world { duration = 4 }
		ball { radius = 0.3, position = {-2, 0, 0}, velocity = {1.5, 0, 0} }
		ball { radius = 0.3, position = {2, 0.2, 0}, velocity = {-1.5, 0, 0} }
	end,
	function() -- on a spring
		world { duration = 4, gravity = down }
		local b = ball { radius = 0.2, position = {0, 0, 0} }
		spring { a = b, b = sphere { static = true, visible = false, radius = 0.05, position = {1, 0, 2} }, stiffness = 400 }
	end,
	function() -- in a room
		world { duration = 5, gravity = down }
		for _, n in ipairs {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}} do
			plane { normal = n, position = vec3(n) * -2, material = rubber }
		end
		for k = 1, 5 do
			ball { radius = 0.2, position = {-1.2 + 0.6 * k, 0, 0.3 * k}, velocity = {2 - k, k, 0}, material = rubber }
		end
	end,
	function() -- a cue ball
		world { duration = 3, gravity = down }
		plane { material = rubber }
		for k = 1, 4 do ball { radius = 0.1, position = {0.25 * k, 0, 0.1}, material = rubber } end
		ball { radius = 0.1, position = {-2, 0.05, 0.1}, velocity = {4, 0, 0}, material = rubber }
	end,
	function() -- a driven body
		world { duration = 4 }
		box(look { size = {0.5, 0.5, 0.5}, motion = function(t) return {6 * math.sin(t), 0, 2 * math.cos(3 * t)} end })
	end,
	function() -- up and down, from one metre to ten
		world { duration = 3, gravity = down }
		plane { material = rubber }
		ball { radius = 0.5, position = {0, 0, 0.5}, velocity = {0, 0, 13}, material = rubber }
		ball { radius = 0.3, position = {2, 0, 0.3}, material = rubber }
	end,
	function() -- a capsule and a cylinder roll away from each other
		world { duration = 3, gravity = down }
		plane { material = rubber }
		capsule(look { radius = 0.2, length = 0.6, position = {0, -0.5, 0.2}, orientation = {axis = {1, 0, 0}, angle = math.pi / 2},
			velocity = {2, 0, 0}, material = rubber })
		cylinder(look { radius = 0.2, length = 0.6, position = {0, 0.5, 0.2}, orientation = {axis = {1, 0, 0}, angle = math.pi / 2},
			velocity = {-2, 0, 0}, material = rubber })
	end,
	function() -- one stays, one is gone
		world { duration = 20, gravity = {0, 0, 0} }
		ball { radius = 0.1, position = {0, 0, 0}, angular_velocity = {0, 0, 1} }
		ball { radius = 0.1, position = {1, 0, 0}, velocity = {50, 0, 0} }
	end,
}
scenes[n]()
END
cat >look.py <<'END'
import subprocess, sys
W, H = 320, 180
folder, bodies = sys.argv[1], int(sys.argv[2])
colors = [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 0), (1, 0, 1)][:bodies]
raw = subprocess.run(["ffmpeg", "-v", "error", "-i", folder + "/%03d.png", "-f", "rawvideo", "-pix_fmt", "rgb24", "-"],
                     stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, check=True).stdout
count, good = len(raw) // (3 * W * H), 0
for n in range(count):
    picture = raw[3 * n * W * H:3 * (n + 1) * W * H]
    seen = set()
    for pixel in set(zip(picture[0::3], picture[1::3], picture[2::3])):
        most = max(pixel)
        if most > 30 and all(c > 0.6 * most or c < 0.4 * most for c in pixel):
            seen.add(tuple(int(c > 0.6 * most) for c in pixel))
    good += all(c in seen for c in colors)
print(f"{folder}: all of {bodies} to be seen in {good} of {count} pictures")
sys.exit(count < 12 or good != count)
END

# a program with a sanitizer draws slowly: of these a box, what is driven, a capsule and a cylinder
n=0 few=' 3 8 10 '
for bodies in 1 1 2 2 1 5 5 1 2 2; do
	n=$((n + 1))
	[ "${RBSIM_MODE:-release}" = release ] || case $few in *" $n "*) ;; *) continue ;; esac
	exits 0 s.lua --param scene=$n -o $n.h5 --force --quiet
	exits 0 render $n.h5 -o "$n/%03d.png" --fps 5 --size 320x180 --force
	if grep -q "leaves out" err; then fail "$(cat err)"; fi
	python3 look.py $n $bodies >>measured || { tail -n 1 measured >&2; missed=1; }
done
cat measured
[ -z "${missed-}" ] || fail "a moving body is not to be seen"

# what flies off for ever is named, and the rest is seen
exits 0 s.lua --param scene=11 -o 11.h5 --force --quiet
exits 0 render 11.h5 -o '11/%03d.png' --fps 1 --size 320x180
grep -q "leaves out what flies off: 'body2'" err || fail "$(cat err)"
python3 look.py 11 1 || fail "what stays is not to be seen"

# without --output a film goes beside the recording; a run films from its recording and says so where there is none
mkdir beside
exits 0 s.lua --param scene=1 -o beside/one.h5 --quiet --duration 0.2
exits 0 render beside/one.h5 --size 64x48
[ -s beside/one.mp4 ] || fail "no film beside the recording: $(cat err)"
printf 'world { duration = 1, gravity = {0, 0, -9.81} }\nsphere { radius = 0.1, color = {1, 0, 0}, texture = "none" }\ncamera { png = "live/%%03d.png", size = {320, 180}, fps = 15 }\n' >live.lua
exits 0 live.lua
python3 look.py live 1 || fail "the film of a run"
mv live first
exits 0 render live.h5
diff -r live first >/dev/null || fail "the film of the run is not that of its recording"
rm -r live
exits 0 live.lua --no-record --force
grep -q "shows the start" err || fail "$(cat err)"
[ -s live/000.png ] || fail "no film without a recording"
