#!/bin/sh
# SPDX-License-Identifier: MIT
# film off and on: exactly the pictures of the time between are left out, and the others stay as they are.
. tests/cli/functions
[ -f "$(dirname "$RBSIM")/rbsim-film.so" ] || { echo "no renderer was built"; exit 77; }

small_scene 'camera { name = "main", position = {0, -3, 1}, look_at = {0, 0, 0.3}, size = {64, 48}, fps = 20, png = "p/%d.png" }' |
	sed 's/duration = 0.5/duration = 1, frame_rate = 40/' >s.lua
exits 0 s.lua --no-record --json
[ "$(value pictures)" = 21 ] || fail "$(value pictures) pictures, wanted 21"
mv p whole
cat >commands <<'END'
at 0.24 film off
at 0.24 film off
at 0.6 film on
END
exits 0 s.lua --no-record --json --commands commands
[ "$(value pictures)" = 14 ] || fail "$(value pictures) pictures, wanted 14"
[ "$(value left_out)" = 7 ] || fail "$(value left_out) pictures were left out, wanted 7"
says out '"status":"complete","pictures":14'
# the commands take effect at the frames of 0.25 s, whose picture is there, and of 0.6 s, whose picture is not
for k in $(seq 0 20); do
	case $k in
	[6-9] | 1[0-2]) [ ! -e p/$k.png ] || fail "picture $k was not left out" ;;
	*) cmp "whole/$k.png" "p/$k.png" || fail "picture $k is another one" ;;
	esac
done
rm -r p
exits 0 s.lua --no-record --commands commands
says err 'film .*: 14 pictures.*; 7 left out by command$'

# off from the first frame on: only its picture
rm -r p
echo film off >commands
exits 0 s.lua --no-record --json --commands commands
[ "$(ls p)" = 0.png ] || fail "pictures: $(ls p)"

# a run without films has none to switch
small_scene >none.lua
exits 0 none.lua --no-record --commands commands
says out "error 'film': no camera of this run makes a film"
