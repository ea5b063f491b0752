#!/bin/sh
# SPDX-License-Identifier: MIT
# Symbolic links where a scene's files go: none leads out of the folder, whatever it is and whenever it was made. What users
# name themselves may go through links in its folders.
. tests/cli/functions
command -v ffmpeg >/dev/null || { echo "no ffmpeg"; exit 77; }

mkdir work outside outside/folder
cd work || exit 1
echo 'not yours' >../outside/file
cp ../outside/file ../outside/file.want

# untouched: nothing outside has changed
untouched()
{
	cmp -s ../outside/file ../outside/file.want || fail "$1: the file outside has changed"
	[ "$(find ../outside | sort | tr '\n' ' ')" = "../outside ../outside/file ../outside/file.want ../outside/folder " ] ||
		fail "$1: made outside: $(find ../outside)"
	[ -z "$(find . -name '*partial*')" ] || fail "$1: left behind: $(find . -name '*partial*')"
}

scene()
{
	small_scene "$1" | sed 's/duration = 0.5/duration = 0.1/' >s.lua
}
camera='position = {2, 2, 1}, look_at = {0, 0, 0}, size = {64, 64}, fps = 20'

# a folder on the way
ln -s ../outside/folder link
for names in 'record { file = "link/x.h5" }' "camera { $camera, video = \"link/x.mp4\" }" \
	"camera { $camera, png = \"link/%d.png\" }" "camera { $camera, png = \"link/deep/%d.png\" }" \
	"camera { $camera, video = \"link/x.gif\" }"; do
	scene "$names"
	for force in '' --force; do
		exits 73 s.lua -q $force
		says err "'link' is a symbolic link"
		untouched "$names $force"
	done
	rm -f s.h5*
done
# also where the picture is drawn later
scene "camera { name = \"main\", $camera, png = \"link/%d.png\" }"
exits 0 s.lua -q --no-render
exits 73 render s.h5 -q
untouched "render"
rm -f s.h5
# trusted, and named by the user, it may lead on
exits 0 s.lua -q --no-render -o link/x.h5
[ -f ../outside/folder/x.h5 ] || fail "a user's own link is not followed"
rm ../outside/folder/*
scene 'record { file = "link/x.h5" }'
exits 0 s.lua -q --trust
[ -f ../outside/folder/x.h5 ] || fail "a trusted scene's link is not followed"
rm ../outside/folder/*

# the last name: refused, and replaced with --force
for names in 'record { file = "x.h5" }:x.h5' "record { file = \"s.h5\" } camera { $camera, video = \"x.mp4\" }:x.mp4" \
	"record { file = \"s.h5\" } camera { $camera, video = \"x.gif\" }:x.gif" \
	"record { file = \"s.h5\" } camera { $camera, png = \"x%d.png\" }:x0.png"; do
	name=${names##*:}
	for target in ../outside/file ../outside/nothing; do
		scene "${names%:*}"
		rm -f s.h5* x*
		ln -s $target "$name"
		exits 73 s.lua -q
		untouched "$name to $target"
		exits 0 s.lua -q --force
		[ -f "$name" ] && [ ! -L "$name" ] || fail "$name is still a link"
		untouched "$name to $target, --force"
		rm -f s.h5* x*
	done
done
scene ''
ln -s ../outside/file s.h5
exits 73 s.lua -q
exits 0 s.lua -q --force
untouched "the scene's own name"
rm -f s.h5

# a run to go on with: its files, or those that it makes, are links
small_scene 'on_frame(function() local x = 0 for i = 1, 1e5 do x = x + i end end)' | sed 's/duration = 0.5/duration = 10/' >l.lua
exits 0 l.lua -q -o whole.h5
pid=
trap '[ -n "$pid" ] && kill -9 $pid 2>/dev/null' EXIT
"$RBSIM" l.lua -q -o l.h5 --checkpoint-every 0.01 >out 2>err &
pid=$!
until_true [ -s 'l.h5.checkpoint~' ]
kill -TERM $pid
ended 75 "interrupted"
mkdir kept
mv l.h5* kept
again()
{
	rm -rf l.h5*
	cp kept/* .
}

again
for name in l.h5.checkpoint.partial l.h5.partial l.h5.checkpoint.partial-0; do ln -s ../outside/file $name; done
exits 0 l.lua -q -o l.h5 --resume --checkpoint-every 0.01
rm -f l.h5.checkpoint.partial l.h5.partial l.h5.checkpoint.partial-0
untouched "a checkpoint's partial file"
exits 0 diff -q whole.h5 l.h5

again
rm 'l.h5.checkpoint~'
ln -sf ../kept/nothing l.h5.checkpoint
exits 66 l.lua -q -o l.h5 --resume
says err "'l.h5.checkpoint': it is a symbolic link"
[ ! -e kept/nothing ] || fail "made through a link"
again
ln -sf ../outside/file 'l.h5.checkpoint~'
exits 0 l.lua -q -o l.h5 --resume --checkpoint-every 0.01
untouched "the checkpoint before"

again
mv l.h5 ../outside/folder
cp ../outside/folder/l.h5 ../outside/folder/want
ln -s ../outside/folder/l.h5 l.h5
exits 73 l.lua -q -o l.h5 --resume
says err "'l.h5': it is a symbolic link"
exits 73 repair l.h5
says err "'l.h5': it is a symbolic link"
cmp -s ../outside/folder/l.h5 ../outside/folder/want || fail "a recording was changed through a link"
rm -f l.h5* ../outside/folder/*

# stopped: every thread of process $pid has come to rest, which the signal alone does not wait for
stopped()
{
	[ -d /proc/$pid/task ] || return 1
	for stat in /proc/$pid/task/*/stat; do
		case $(sed 's/.*) //' "$stat" 2>/dev/null) in T*) ;; *) return 1 ;; esac
	done
}

# changed while it runs: the folder that was there when it began is what holds
scene "camera { $camera, png = \"films/%04d.png\" } on_frame(function() local x = 0 for i = 1, 1e6 do x = x + i end end)"
sed -i 's/duration = 0.1/duration = 20/' s.lua
"$RBSIM" s.lua -q >out 2>err &
pid=$!
until_true [ -f films/0002.png ]
# the program finds the folder or the link, never neither
kill -STOP $pid
until_true stopped
mv films before && ln -s ../outside/folder films
kill -CONT $pid
wait $pid
got=$?
pid=
[ $got -eq 69 ] || [ $got -eq 73 ] || fail "a folder that becomes a link: exit status $got"
says err "'films' is a symbolic link"
untouched "a folder that becomes a link"
rm -rf films before s.h5*

# a sweep's points
scene "param('n', 1, 'number') camera { $camera, png = \"%d.png\" }"
exits 0 sweep s.lua -q -p n=1:2:1 -o sweep
mv sweep/point-00001 moved && ln -s ../../outside/folder sweep/point-00001
rm -f sweep/point-0000*.json sweep/point-0000*.log
ln -s ../../outside/file sweep/point-00000.json
ln -s ../../outside/file sweep/point-00000.log
"$RBSIM" sweep s.lua -q -p n=1:2:1 -o sweep >out 2>err
[ $? -ne 0 ] || fail "a sweep into links says nothing"
untouched "a sweep"
