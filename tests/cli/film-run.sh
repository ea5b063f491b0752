#!/bin/sh
# SPDX-License-Identifier: MIT
# Cameras of a scene become pictures and video while it runs; what can't be made is refused before the run.
. tests/cli/functions
command -v ffmpeg >/dev/null || { echo "no ffmpeg"; exit 77; }

cat >two.lua <<'END'
world { title = "Two films", duration = 0.5, frame_rate = 20, gravity = {0, 0, -9.81} }
plane { texture = "checker" }
local ball = sphere { name = "ball", radius = 0.5, position = {0, 0, 2}, angular_velocity = {3, 1, 0} }
camera { name = "main", position = {4, -5, 3}, look_at = ball, size = {80, 60}, samples = 1, overlay = {"time", "title"}, video = "main.mp4" }
camera { name = "side", position = {0, -6, 1}, look_at = {0, 0, 1}, size = {64, 48}, samples = 1, png = "side/%03d.png" }
camera { name = "idle", position = {0, -6, 1} }
END

# both at once, with a recording
exits 0 two.lua
grep -q 'film .*main.mp4' err || fail "the summary does not name the film"
[ "$(find side -name "*.png" | wc -l)" -eq 11 ] || fail "$(find side -name "*.png" | wc -l) pictures instead of 11"
[ -s two.h5 ] || fail "no recording"
pictures=$(ffprobe -v error -count_frames -show_entries stream=nb_read_frames,width,height,pix_fmt -of csv=p=0 main.mp4)
[ "$pictures" = "80,60,yuv420p,11" ] || fail "the film is $pictures"
[ "$(find . -name '.*' -type f | wc -l)" -eq 0 ] || fail "left behind: $(ls -A)"
size=$(od -An -tu1 -j16 -N8 side/000.png | tr -s ' ' ' ')
[ "$size" = " 0 0 0 64 0 0 0 48" ] || fail "a picture of$size"
strings -n 3 side/010.png | grep -q '0.5 s' || fail "no time in the picture's text"

# what was filmed does not change what was simulated
exits 0 two.lua --no-render -o plain.h5
exits 0 diff two.h5 plain.h5

# nothing is replaced without being asked, and nothing is touched then
cp main.mp4 before.mp4
rm two.h5
exits 73 two.lua
grep -q "main.mp4" err || fail "which film is in the way?"
[ ! -e two.h5 ] || fail "a recording beside a film that was refused"
cmp -s main.mp4 before.mp4 || fail "the film was touched"
exits 0 two.lua --force
exits 0 two.lua --force --camera side --no-record
grep -q 'main.mp4' err && fail "a film of a camera that was not chosen"
exits 64 two.lua --force --camera sid
grep -q "there is no camera 'sid' (there are main, side, idle)" err || fail "$(cat err)"

# the same bytes for any number of threads
LP_NUM_THREADS=0 exits 0 two.lua --no-record --force --camera side
cp -r side side0
LP_NUM_THREADS=3 exits 0 two.lua --no-record --force --camera side
diff -r side side0 >/dev/null || fail "pictures depend on the number of threads"

# no ffmpeg: pictures work, video is refused before the run
rm -f two.h5 main.mp4
RBSIM_FFMPEG=/nonexistent/ffmpeg exits 69 two.lua
grep -q 'ffmpeg' err || fail "$(cat err)"
[ ! -e two.h5 ] || fail "the run began"
RBSIM_FFMPEG=/nonexistent/ffmpeg exits 0 two.lua --camera side --force
# no renderer: the run works without, and says what is missing with
mkdir bare
cp "$(dirname "$RBSIM")/rbsim-hdf5.so" bare
RBSIM_MODULE_DIR=$PWD/bare exits 69 two.lua --force
grep -q 'rbsim-film.so' err || fail "$(cat err)"
RBSIM_MODULE_DIR=$PWD/bare exits 0 two.lua --force --no-render
rm two.h5
# one that dies in the middle: the run is complete, the film is not there, and its words are told
cat >dying <<'END'
#!/bin/sh
case $* in *-version*|*-encoders*) exec ffmpeg "$@" ;; esac
head -c 30000 >/dev/null
echo "the disk of this encoder is melting" >&2
exit 3
END
chmod +x dying
RBSIM_FFMPEG=$PWD/dying exits 69 two.lua --force
grep -q 'melting' err || fail "$(cat err)"
[ ! -e main.mp4 ] || fail "half a film under its name"
exits 0 info two.h5
grep -q complete out || fail "the recording suffered"

RBSIM_FFMPEG=$PWD/dying "$RBSIM" two.lua --force --json >out 2>err </dev/null
[ "$(value status)" = complete ] || fail "the run's status is that of its film"
[ "$(value exit_status)" = 69 ] || fail "the exit status does not tell of the film"

# outputs in each other's way
exits 64 two.lua --force -o main.mp4
exits 64 two.lua -o film.gif --force
cat >twins.lua <<'END'
world { duration = 0.1 }
sphere { radius = 1 }
camera { position = {5, 5, 5}, png = "o/%d.png" }
camera { position = {5, 5, 5}, png = "./o/%1d.png" }
END
exits 65 twins.lua --no-record
grep -q 'twins.lua:4: camera 2 writes to' err || fail "$(cat err)"

# one that begins after the end
cat >late.lua <<'END'
world { duration = 0.1 }
sphere { radius = 1 }
camera { position = {5, 5, 5}, size = {16, 16}, from = 7, png = "late/%d.png" }
END
exits 0 late.lua --no-record
grep -q 'begins at 7 s, after the end' err || fail "$(cat err)"
[ ! -e late ] || fail "a folder for no picture"

# wrong cameras
refused()
{
	printf 'world { duration = 0.1 }\nlocal b = sphere { radius = 1 }\ncamera { %s }\n' "$2" >bad.lua
	exits "$1" bad.lua --no-record
	grep -q "$3" err || fail "'$2' said: $(cat err)"
}
refused 65 'size = {0, 60}, png = "x%d.png"' "bad.lua:3: camera: 'size'"
refused 65 'png = "x.png"' "'png' must hold one %d"
refused 65 'video = "x.avi"' "must end in .mp4"
refused 65 'position = {0, 0.2, 0.5}, png = "in/%d.png"' "inside"
mkdir locked
chmod 555 locked
if [ "$(id -u)" -ne 0 ]; then
	refused 73 'png = "locked/%d.png"' "locked"
fi
echo text >file
refused 73 'png = "file/%d.png"' "file"
[ ! -e in/0.png ] || fail "a picture from inside a body"
