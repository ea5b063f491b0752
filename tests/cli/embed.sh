#!/bin/sh
# SPDX-License-Identifier: MIT
# The library as installed: examples/embed.c, built through pkg-config against the shared and the static one, gets the
# numbers of `rbsim run` to the bit; nothing but rbsim_* is visible.
. tests/cli/functions

case ${RBSIM_MODE:-release} in
release | debug) ;;
*) echo "sanitizers go into the library through tests/test_embed.c"; exit 77 ;;
esac
for tool in cc pkg-config nm make; do
	command -v $tool >/dev/null || { echo "no $tool here"; exit 77; }
done
# the build that is under test, and what it was built with
build=${RBSIM%/*}
set -- make -C "$TOP" --no-print-directory -o all BUILD="$build" MODE="${RBSIM_MODE:-release}" prefix="$PWD/usr"
[ -f "$build/rbsim-film.so" ] || set -- "$@" WITH_FILM=0
[ -f "$build/rbsim-console.so" ] || set -- "$@" WITH_CONSOLE=0
"$@" install >out 2>err || fail "make install failed"
export PKG_CONFIG_PATH="$PWD/usr/lib/pkgconfig${PKG_CONFIG_PATH:+:$PKG_CONFIG_PATH}"
version=$("$RBSIM" --version | sed -n 's/^rbsim //p')
[ "$(pkg-config --modversion rbsim)" = "$version" ] || fail "rbsim.pc has another version than $version"

# shellcheck disable=SC2046 # flags
cc -std=c17 -Wall -Wextra -Werror $(pkg-config --cflags rbsim) "$TOP/examples/embed.c" $(pkg-config --libs rbsim) \
	-o shared 2>err || fail "examples/embed.c does not build"
readelf -d shared | grep -q "NEEDED.*librbsim\.so\.${version%%.*}\]" || fail "the shared library has another name"
# shellcheck disable=SC2046
cc $(pkg-config --cflags rbsim) "$TOP/examples/embed.c" -L"$PWD/usr/lib" -Wl,-Bstatic -lrbsim -Wl,-Bdynamic \
	$(pkg-config --static --libs rbsim | sed 's/-lrbsim//') -o static 2>err || fail "it does not build statically"

small_scene 'require "rbsim.pile"
local v = param("v", 1)
on_step(function() end)' >scene.lua
exits 0 scene.lua --param v=2 -o run.h5 --quiet
exits 0 export run.h5 --to csv -o run.csv
for kind in shared static; do
	[ $kind = static ] && export RBSIM_LUA_PATH="$PWD/usr/share/rbsim/lua"
	LD_LIBRARY_PATH=$PWD/usr/lib ./$kind scene.lua left $kind.h5 v=2 >$kind.out 2>err || fail "$kind: it fails"
	says $kind.out '^recorded: 31 frames, complete, the last one off by 0 m$'
	exits 0 diff run.h5 $kind.h5
	exits 0 replay $kind.h5
done
cmp shared.out static.out || fail "shared and static differ"

# the manual's example
awk '/^\.Bd/ { on = 1; next } /^\.Ed/ { on = 0 } on' "$TOP/man/rbsim.3" | sed 's/\\e/\\/g' >example.c
# shellcheck disable=SC2046
cc -std=c17 -Wall -Wextra -Werror $(pkg-config --cflags rbsim) example.c $(pkg-config --libs rbsim) -o example 2>err ||
	fail "the example of rbsim(3) does not build"
rm run.h5
LD_LIBRARY_PATH=$PWD/usr/lib ./example >out 2>err || fail "the example of rbsim(3) fails"
[ "$(wc -l <out)" -eq 31 ] || fail "the example of rbsim(3) prints $(wc -l <out) lines"

for file in usr/lib/librbsim.so usr/lib/librbsim.a; do
	case $file in *.a) dynamic= ;; *) dynamic=-D ;; esac
	# shellcheck disable=SC2086
	nm $dynamic --defined-only -g $file | awk 'NF == 3 && $2 ~ /[A-Z]/ { print $3 }' | sed 's/@.*//' | sort -u |
		grep -v '^RBSIM_0$' >names
	sed -n 's/^.*[ *]\(rbsim_[a-z_]*\)(.*/\1/p' "$TOP/include/rbsim.h" | sort -u >declared
	diff declared names >err || fail "$file shows other names than rbsim.h"
done

# what a caller gets wrong
LD_LIBRARY_PATH=$PWD/usr/lib ./shared scene.lua nobody other.h5 >out 2>err
[ $? -eq 64 ] || fail "a body that is not there"
LD_LIBRARY_PATH=$PWD/usr/lib ./shared scene.lua left run.h5 >out 2>err
[ $? -eq 73 ] || fail "a recording that exists"
says err "'run.h5'.*exists"
LD_LIBRARY_PATH=$PWD/usr/lib ./shared run.h5 left other.h5 >out 2>err
[ $? -eq 66 ] || fail "a recording for a scene"
LD_LIBRARY_PATH=$PWD/usr/lib ./shared scene.lua left /no/such/folder/other.h5 >out 2>err
[ $? -eq 73 ] || fail "a folder that is not there"

# a run that fails in its first frame has failed: its program has not closed it
small_scene 'on_frame(function() error("enough") end)' >first.lua
LD_LIBRARY_PATH=$PWD/usr/lib ./shared first.lua left first.h5 >out 2>err
[ $? -eq 65 ] || fail "a first frame that fails"
exits 0 info first.h5
says out 'status +failed: .*enough'

"$@" uninstall >out 2>err || fail "make uninstall failed"
[ -z "$(find usr -type f -o -type l)" ] || fail "uninstall leaves $(find usr -type f -o -type l)"
