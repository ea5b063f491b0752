#!/bin/sh
# SPDX-License-Identifier: MIT
# film move, orbit, zoom: from the next frame on a film's pictures are those of a camera that stands there; the state stays as it
# is; a run that goes on from a checkpoint makes the same pictures; what cannot be moved is told.
. tests/cli/functions
[ -f "$(dirname "$RBSIM")/rbsim-film.so" ] || { echo "no renderer was built"; exit 77; }

command -v ffmpeg >/dev/null || { echo "no ffmpeg"; exit 77; }

# pixels FOLDER: a line for each picture, in order (their files say how they were made, too)
pixels()
{
	ffmpeg -v error -start_number 0 -i "$1/%d.png" -f framemd5 - | sed -n 's/^0,.*, *//p'
}
# alike FOLDER FOLDER FIRST LAST: these pictures are the same
alike()
{
	pixels "$1" | sed -n "$(($3 + 1)),$(($4 + 1))p" >pixels.1
	pixels "$2" | sed -n "$(($3 + 1)),$(($4 + 1))p" >pixels.2
	[ "$(wc -l <pixels.1)" = $(($4 - $3 + 1)) ] || fail "there are $(wc -l <pixels.1) pictures in '$1'"
	cmp -s pixels.1 pixels.2
}

scene()
{
	small_scene "$1" | sed 's/duration = 0.5/duration = 1, frame_rate = 20/'
}
# $1: position, $2: look_at, $3: more keys, $4: name
camera()
{
	echo "camera { name = \"$4\", position = {$1}, look_at = {$2}, size = {64, 48}, png = \"$4/%d.png\" $3 }"
}
scene "$(camera '0, -4, 1' '0, 0, 1' '' main)" >s.lua
exits 0 s.lua --no-record --json
hash=$(value state_hash)
mv main plain

# moved to the right and forward, taken nearer, turned around: closed forms of where it stands then
follows()
{
	rm -rf main there
	echo "at 0.5 film $1" >commands
	exits 0 s.lua --no-record --json --commands commands
	[ "$(value state_hash)" = "$hash" ] || fail "film $1 has changed the state"
	scene "$(camera "$2" "$3" '' there)" >t.lua
	exits 0 t.lua --no-record
	alike main plain 0 10 || fail "film $1: something has changed before it"
	alike main there 11 20 || fail "film $1: it does not stand where it should"
}
follows 'move 1 0 2' '1, -2, 1' '1, 2, 1'
follows 'zoom 2' '0, -2, 1' '0, 0, 1'
follows 'main zoom 0.5' '0, -8, 1' '0, 0, 1'

# one after the other, around and over; with two cameras only the one that is named
{ scene "$(camera '0, -4, 1' '0, 0, 1' '' main)"; camera '3, -4, 1' '0, 0, 1' '' other; } >two.lua
rm -rf main
exits 0 two.lua --no-record
mv other other-plain
rm -rf main there
printf 'at 0.25 film main orbit 90 0\nat 0.5 film main orbit 0 30\n' >commands
exits 0 two.lua --no-record --commands commands
alike other other-plain 0 20 || fail 'the camera that nobody moved has been'
alike main plain 0 5 || fail 'something has changed before the first command'
alike main plain 6 6 && fail 'the first command has done nothing'
mv main second
rm -r other
echo 'at 0.25 film main orbit 90 0' >commands
exits 0 two.lua --no-record --commands commands
alike main second 6 10 || fail 'the second command has changed what was before'
alike main second 11 11 && fail 'the second command has done nothing'

# one with a function of time stands still from there on; an orthographic one shows less when it is taken nearer
rm -rf main there
scene 'camera { name = "main", position = function(t) return {t, -4, 1} end, look_at = {0, 0, 1}, size = {64, 48}, png = "main/%d.png" }' >s.lua
exits 0 s.lua --no-record --json
hash=$(value state_hash)
rm -rf plain && mv main plain
follows 'move 0 0 0' '0.55, -4, 1' '0, 0, 1'
scene "$(camera '0, -4, 1' '0, 0, 1' ', projection = "orthographic", height = 4' main)" >s.lua
rm -rf main there
echo 'at 0.5 film zoom 2' >commands
exits 0 s.lua --no-record --commands commands
scene "$(camera '0, -4, 1' '0, 0, 1' ', projection = "orthographic", height = 2' there)" >t.lua
exits 0 t.lua --no-record
alike main there 11 20 || fail 'an orthographic camera does not show less'

# a run that was interrupted after it goes on to the same pictures
scene "$(camera '0, -4, 1' '0, 0, 1' '' main)" >s.lua
rm -rf main there
printf 'at 0.25 film orbit 40 10\nat 0.25 film move 0.5 0 0\n' >commands
exits 0 s.lua -o whole.h5 --commands commands
mv main whole
printf 'at 0.25 film orbit 40 10\nat 0.25 film move 0.5 0 0\nat 0.5 checkpoint\nat 0.5 quit\n' >commands
exits 130 s.lua -o part.h5 --commands commands
exits 0 s.lua -o part.h5 --resume
alike whole main 0 20 || fail 'the run that went on has other pictures'

# what cannot be
refuses()
{
	echo "$2" >commands
	exits 0 "$1" --no-record --force --commands commands
	says out "error .*$3"
}
malformed()
{
	echo "$1" >commands
	exits 66 two.lua --no-record --force --commands commands
	says err "commands:1: .*$2"
}
refuses two.lua 'film zoom 2' '2 cameras make films; name the one to move'
refuses two.lua 'film mian zoom 2' "no camera 'mian' makes one.*'main'"
malformed 'film main zoom 0' 'a number above 0'
malformed 'film main turn 0' 'move, orbit or zoom'
malformed 'film main' "'on', 'off', or move"
scene 'camera { png = "free/%d.png" }' >free.lua
refuses free.lua 'film zoom 2' "has no 'position'"

# cameras in a film of several are moved by their own name, all of them by the film's; after a checkpoint, too
camera_alone() { echo "camera { name = \"$1\", position = {$2}, look_at = {$3}, size = {64, 48} }"; }
split()
{
	scene "$(camera_alone main "$1" "$2"; camera_alone side "$3" "$4")"
	echo "film { name = \"both\", rows = {{\"main\", \"side\"}}, size = {128, 48}, png = \"$5/%d.png\" }"
}
split '0, -4, 1' '0, 0, 1' '4, 0, 1' '0, 0, 1' both >split.lua
exits 0 split.lua --no-record
rm -rf plain && mv both plain
moves()
{
	rm -rf both there
	echo "at 0.5 film $1" >commands
	exits 0 split.lua --no-record --commands commands
	split "$2" "$3" "$4" "$5" there >t.lua
	exits 0 t.lua --no-record
	alike both plain 0 10 || fail "film $1: something has changed before it"
	alike both there 11 20 || fail "film $1: the cameras do not stand where they should"
}
moves 'side zoom 2' '0, -4, 1' '0, 0, 1' '2, 0, 1' '0, 0, 1'
moves 'both zoom 2' '0, -2, 1' '0, 0, 1' '2, 0, 1' '0, 0, 1'
moves 'move 1 0 2' '1, -2, 1' '1, 2, 1' '2, 1, 1' '-2, 1, 1'
echo "at 0.5 film sid zoom 2" >commands
"$RBSIM" split.lua --no-record --force --commands commands >out 2>err </dev/null
says out "'film': no camera 'sid' makes one \(did you mean 'side'\?\)"
