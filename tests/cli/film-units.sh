#!/bin/sh
# SPDX-License-Identifier: MIT
# Pictures of the outer planets, in SI units or in AU and days, tell times and lengths in the camera's units: the same texts and
# the same bar, of the right length; planets too small to be seen are dots; from the recording as in the run. Unknown units are
# refused with the nearest one.
. tests/cli/functions
command -v ffmpeg >/dev/null || { echo "no ffmpeg"; exit 77; }
command -v python3 >/dev/null || { echo "no python3 to look at pictures with"; exit 77; }

cat >solar.lua <<'END'
local units = param("units", "SI", "of the scene", {choices = {"SI", "AU"}})
local told = param("told", "days", "in the pictures", {choices = {"days", "years", "default"}})
local au, day, sun = 1, 1, 1
if units == "SI" then au, day, sun = 149597870700, 86400, 1.98847e30 end
local names = {days = {length = "AU", time = "d"}, years = {length = "km", time = "yr"}}
local u = names[told]
if units == "AU" then u = {length = {"AU", 1}, time = {"d", 1}} end
world { title = "Planets", duration = 2e4 * day, frame_rate = 1 / (100 * day), gravitation = {G = 2.95912208286e-4 * au ^ 3 / day ^ 2 / sun} }
local list = {}
for _, d in ipairs {{"Sun", 1, {0, 0, 0}, {0, 0, 0}}, {"Jupiter", 9.5e-4, {5.2, 0, 0}, {0, 0.00754, 0}},
	{"Neptune", 5.2e-5, {0, 30, 0}, {-0.00314, 0, 0}}} do
	list[#list + 1] = sphere { name = d[1], radius = 4.7e-4 * au, mass = d[2] * sun, position = au * vec3(d[3]),
		velocity = au / day * vec3(d[4]), color = {1, 0, 0} }
end
camera { name = "far", projection = "orthographic", position = vec3(0, 0, 50) * au, up = {0, 1, 0}, height = 72 * au, trails = list,
	overlay = {"title", "time", "scale"}, units = u, speed = 2e4 * day, fps = 1, background = {0, 0, 0}, size = {640, 360},
	samples = 1, png = "far/%d.png" }
camera { name = "near", mount = list[2], offset = vec3(0, -6e-3, 0) * au, look_at = list[2], overlay = {"time", "scale"}, units = u,
	speed = 2e4 * day, fps = 1, background = {0, 0, 0}, size = {640, 360}, png = "near/%d.png" }
END
cat >look.py <<'END'
import subprocess, sys
W, H = 640, 360
def picture(name):
    raw = subprocess.run(["ffmpeg", "-v", "error", "-i", name, "-f", "rawvideo", "-pix_fmt", "rgb24", "-"],
                         stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, check=True).stdout
    return [[tuple(raw[3 * (W * y + x):3 * (W * y + x) + 3]) for x in range(W)] for y in range(H)]
def texts(p):  # the corners: title, bar, time
    return [row[:W] for row in p[:50]] + [row[:320] for row in p[H - 40:]]
def bar(p):  # longest row of ink
    best = 0
    for row in p[:60]:
        run = 0
        for pixel in row[W // 2:]:
            run = run + 1 if min(pixel) > 220 else 0
            best = max(best, run)
    return best
def red(p): return sum(1 for row in p for r, g, b in row if r > 60 and g < r // 3 and b < r // 3)
days, own, years, plain = (picture(f"{f}/far/1.png") for f in ("days", "own", "years", "default"))
assert texts(days) == texts(own), "in SI and in AU the texts differ"
assert texts(days) != texts(years) and texts(days) != texts(plain), "units change nothing"
# 72 AU are 360 px, a fifth of the width 128 px or 25.6 AU: a bar of 20 AU
assert bar(days) == 100, f"20 AU are {bar(days)} px, wanted 100"
# 2e9 km are 13.37 AU, 66.8 px
assert bar(years) == 67, f"2e9 km are {bar(years)} px, wanted 67"
# beside Jupiter: 2 tan(22.5 deg) 6e-3 AU in 360 px; a fifth of the width is 1.77e-3 AU, so a bar of 1e-3 AU
near = picture("days/near/1.png")
assert abs(bar(near) - 1e-3 * 360 / (2 * 0.41421356 * 6e-3)) <= 1, bar(near)
assert sum(1 for row in near for pixel in row if max(pixel) > 40) > 500, "Jupiter is not to be seen"
# dots of 6 px * 0.75, on three trails that take two planets' pixels more
first = picture("days/far/0.png")
assert red(first) >= 3 * 9, f"{red(first)} red pixels of three planets at the start"
print("bars of 20 AU, 2e9 km, 0.001 AU:", bar(days), bar(years), bar(near), "px")
END
for told in days years default own; do
	units=SI
	[ $told = own ] && units=AU
	mkdir $told
	(cd $told && exits 0 ../solar.lua --param units=$units --param told="$([ $told = own ] && echo days || echo $told)" --quiet -o run.h5) ||
		exit 1
done
python3 look.py || fail "pictures"

# a recording tells the same
(cd days && mv far first && exits 0 render run.h5 --camera far && diff -r far first) || fail "the recording's film differs"

# what is no unit
refused()
{
	printf 'world { duration = 1 }\nsphere { radius = 1 }\ncamera { units = %s, png = "x%%d.png" }\n' "$1" >bad.lua
	exits 65 check bad.lua
	says err "^bad.lua:3: camera: units: $2"
}
refused '{length = "au"}' "'length': unknown unit 'au' \(did you mean 'AU'\?\)"
refused '{time = "day"}' "'time': unknown unit 'day'"
refused '{time = "yrs"}' "'time': unknown unit 'yrs' \(did you mean 'yr'\?\)"
refused '{time = "AU"}' "'time': unknown unit 'AU'"
refused '{time = {"d", -1}}' "'time' must be the name of a unit, or \{NAME, SIZE\}"
refused '{time = {1, 1}}' "'time' must be"
refused '{time = 5}' "'time' must be"
refused '{lenght = "m"}' "unknown key 'lenght' \(did you mean 'length'\?\)"
refused '"AU"' "must be a table"
