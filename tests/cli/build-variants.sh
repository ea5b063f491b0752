#!/bin/sh
# SPDX-License-Identifier: MIT
# Builds without films and without the console, and through the other way to OpenGL: from this build's objects, of which only those
# that differ are made anew.
. tests/cli/functions
from=
built_beside "what a build leaves out"

# variant FOLDER TARGET... ARGUMENT...: makes these in a folder with what is made already
variant()
{
	into=$PWD/$1
	shift
	mkdir "$into"
	(cd "$from" && find src flags modules -name '*.d' -o -type f -print | tar cf - -T -) | tar xf - -C "$into"
	make -C "$TOP" MODE="${RBSIM_MODE:-release}" BUILD="$into" "$@" >make.log 2>&1 || fail "$(tail -n 20 make.log)"
}

plain=$RBSIM
# on a machine that has what a build needs, and neither OpenGL nor libpng, FreeType and ncurses
mkdir needed
for package in lua5.4 lua-5.4 lua5.5 lua-5.5 hdf5-serial hdf5 libxxhash libmd qhullstatic_r qhull_r; do
	folder=$(pkg-config --variable=pcfiledir $package 2>/dev/null) && cp "$folder/$package.pc" needed/
done
export PKG_CONFIG_LIBDIR="$PWD/needed" PKG_CONFIG_PATH=
pkg-config --exists libpng && fail "libpng is not hidden"
variant bare "$PWD/bare/rbsim" "$PWD/bare/rbsim-hdf5.so" WITH_FILM=0 WITH_CONSOLE=0
unset PKG_CONFIG_LIBDIR PKG_CONFIG_PATH
RBSIM=$PWD/bare/rbsim
cp "$TOP/tests/scenes/drop.lua" drop.lua
small_scene 'camera { name = "side", position = {3, 0, 1}, look_at = {0, 0, 0}, size = {64, 48}, png = "side%d.png" }' >two.lua
exits 0 drop.lua --force --no-record
exits 0 two.lua --force
says err 'built without films .*: the scene.s cameras make none'
exits 0 info two.h5
exits 69 two.lua --force --camera side
says err 'this program was built without films'
exits 69 render two.h5 --frame 1 -o one.png
says err 'this program was built without films'
[ ! -e one.png ] || fail "a picture without films"
script -qec "'$RBSIM' console two.lua" /dev/null </dev/null >out 2>&1 && fail "a console without the console"
says out 'this program was built without the console'

# the other way draws the same, to the bit: both end in Mesa's rasteriser, of one version here
RBSIM=$plain
pkg-config --exists osmesa && pkg-config --exists egl opengl || { echo "there is but one way to OpenGL here"; exit 0; }
variant egl "$PWD/egl/rbsim-film.so" GL=egl
variant osmesa "$PWD/osmesa/rbsim-film.so" GL=osmesa
ldd egl/rbsim-film.so | grep -q OSMesa && fail "EGL's way needs OSMesa"
for way in egl osmesa; do
	cp "$from/rbsim-hdf5.so" $way/
	for variant in "" texture light shadows; do
		RBSIM_MODULE_DIR=$PWD/$way exits 0 "$TOP/tests/scenes/film/looks.lua" --param variant="$variant" -o looks.h5 --force --quiet
		for camera in front lamps wire; do
			RBSIM_MODULE_DIR=$PWD/$way exits 0 render looks.h5 --camera $camera --frame 2 \
				-o "$way-$variant-$camera.png" --force --quiet
			[ $way = egl ] || cmp "egl-$variant-$camera.png" "osmesa-$variant-$camera.png" ||
				fail "camera $camera, variant '$variant': the ways differ"
		done
	done
done
