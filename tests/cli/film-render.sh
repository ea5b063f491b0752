#!/bin/sh
# SPDX-License-Identifier: MIT
# rbsim render: pictures and video from a recording, which alone is needed for it.
. tests/cli/functions
command -v ffmpeg >/dev/null || { echo "no ffmpeg"; exit 77; }

cat >helper.lua <<'END'
return { height = 2 }
END
cat >s.lua <<'END'
local v = param("v", 1, "speed")
world { title = "Slow", duration = 1, frame_rate = 10, gravity = {0, 0, -1} }
plane { texture = "checker" }
local ball = sphere { name = "ball", radius = 0.5, position = {0, 0, require("helper").height}, velocity = {v, 0, 0} }
camera { name = "main", position = {4, -5, 3}, look_at = ball, size = {64, 48}, samples = 1, png = "live/%02d.png" }
camera { name = "moving", position = function(t) return {4 - t, -5, 3} end, size = {64, 48}, samples = 1,
	look_at = function(t) return ball.position end, png = "flight/%02d.png" }
END
exits 0 s.lua --param v=2
mkdir alone
mv s.h5 alone
cd alone || exit 1

# without scene and helper: the same pictures to the byte, those of functions too
exits 0 render s.h5
diff -r live ../live >/dev/null || fail "the pictures differ from those of the run"
diff -r flight ../flight >/dev/null || fail "the pictures of the moving camera differ"
[ "$(find flight -name "*.png" | wc -l)" -eq 11 ] || fail "not eleven pictures"
cmp -s flight/00.png flight/10.png && fail "the camera does not move"

# a film of its own: slow motion has more pictures, time lapse fewer
exits 0 render s.h5 --camera main -o slow.mp4 --speed 0.25
n=$(ffprobe -v error -count_frames -show_entries stream=nb_read_frames -of csv=p=0 slow.mp4)
[ "$n" = 41 ] || fail "$n pictures in slow motion"
exits 0 render s.h5 --camera main -o 'lapse/%d.png' --speed 5 --from 0.5 --size 32x24
[ "$(find lapse -name "*.png" | wc -l)" -eq 2 ] || fail "$(ls lapse) in time lapse"
cmp -s lapse/0.png lapse/1.png && fail "nothing moves in time lapse"
exits 73 render s.h5 --camera main -o slow.mp4
exits 0 render s.h5 --camera main -o slow.webm --fps 5 --to 0.4
exits 0 render s.h5 --camera main -o slow.gif --fps 5 --to 0.4
n=$(ffprobe -v error -count_frames -show_entries stream=nb_read_frames -of csv=p=0 slow.gif)
[ "$n" = 3 ] || fail "$n pictures in the gif"

# one picture: that of the film
exits 0 render s.h5 --camera main --frame 7 -o seven.png
ffmpeg -v error -i seven.png -f rawvideo seven.raw </dev/null
ffmpeg -v error -i live/07.png -f rawvideo live.raw </dev/null
cmp -s seven.raw live.raw || fail "frame 7 is another picture than in the film"
exits 64 render s.h5 --camera main --frame 99 -o x.png
exits 64 render s.h5 --camera main --frame 1 -o x.mp4
exits 0 render s.h5 --camera main --contact-sheet -o sheet.png
w=$(ffprobe -v error -show_entries stream=width -of csv=p=0 sheet.png)
[ "$w" -gt 1000 ] || fail "a sheet of $w pixels"

# cameras given afterwards, and their mistakes
printf 'camera { name = "late", mount = body "ball", offset = {0, -3, 1}, look_at = body "ball", size = {64, 48}, png = "late/%%d.png" }\n' >with.lua
exits 0 render s.h5 --with with.lua
[ "$(find late -name "*.png" | wc -l)" -eq 11 ] || fail "the late camera"
echo 'sphere { radius = 1 }' >with.lua
exits 65 render s.h5 --with with.lua
grep -q '^with.lua:1:' err || fail "$(cat err)"
echo 'camera { mount = body "bal" }' >with.lua
exits 65 render s.h5 --with with.lua
grep -q "ball" err || fail "$(cat err)"

# what the recording lacks is told
printf 'record { fields = {"position"} }\ncamera { name = "arrows", position = {0, -6, 2}, size = {64, 48}, vectors = "velocity", png = "a/%%d.png" }\nsphere { radius = 0.5, velocity = {1, 0, 0} }\nworld { duration = 0.1 }\n' >v.lua
exits 0 v.lua --no-render
exits 0 render v.h5
grep -q "holds no velocities" err || fail "$(cat err)"
# a film does not take the recording's place, and cameras given afterwards are named by their own file
cp s.h5 s.mp4
exits 64 render s.mp4 --camera main -o ./s.mp4 --force
printf '\ncamera { name = "in", position = {0, 0, 2}, png = "in/%%d.png", look_at = {5, 0, 0} }\n' >with.lua
exits 65 render s.h5 --with with.lua
grep -q "with.lua:2: camera 'in': is inside" err || fail "$(cat err)"

# wrong inputs
exits 64 render s.h5 --camera main --frame 1 -o x.png --speed 2
exits 64 render s.h5 --camera main -o x.mp4 --size ' 5x5'
exits 64 render s.h5 -o x.mp4
grep -q 'choose one with --camera' err || fail "$(cat err)"
exits 64 render s.h5 --camera main -o x.avi
exits 64 render s.h5 --camera main -o x.png
exits 64 render s.h5 --camera main -o x.mp4 --size 0x48
exits 64 render s.h5 --camera main -o x.mp4 --from 99
exits 64 render s.h5 --camera main -o x.mp4 --from 0.5 --to 0.1
head -c 3000 s.h5 >cut.h5
exits 66 render cut.h5 --camera main -o x.mp4
echo nothing >text.h5
exits 66 render text.h5 -o x.mp4
exits 66 render absent.h5 -o x.mp4
[ ! -e x.mp4 ] || fail "half a film"
[ ! -e x.png ] || fail "half a picture"

# a scene of one's own that asks for what the sandbox lacks: what is needed stands in the first line
cat >own.lua <<'END'
local home = os.getenv("HOME")
world { duration = 0.1 }
sphere { radius = 0.1 }
camera { position = {2, 2, 2}, size = {32, 32}, png = "own/%d.png" }
END
exits 0 own.lua --trust --no-render
exits 66 render own.h5
head -n 1 err >first
says first 'without --trust, with which it was recorded'
exits 0 render own.h5 --trust
