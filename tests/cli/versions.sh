#!/bin/sh
# SPDX-License-Identifier: MIT
# --version names the libraries as they are loaded, and says of a module that can't be loaded why.
. tests/cli/functions
modules=$(dirname "$(realpath "$RBSIM")")

exits 0 --version
says_nothing err
says out '^rbsim [0-9]+\.[0-9]+\.[0-9]+$'
says out '^built with (gcc|clang) [0-9.]+, Lua 5\.'
says out '^scenes: Lua 5\.[0-9]+\.[0-9]+, Qhull [0-9]+\.[0-9.]+'
says out '^recordings: HDF5 [0-9]+\.[0-9]+\.[0-9]+$'
[ -f "$modules/rbsim-film.so" ] && says out '^films: libpng [0-9.]+, FreeType [0-9]+\.[0-9]+\.[0-9]+, (OSMesa|EGL) \(.+\)$'
[ -f "$modules/rbsim-console.so" ] && says out '^console: ncurses [0-9.]+$'

# another release of a library, which stands in for the one of the build
if [ "${RBSIM_MODE:-release}" = release ] && command -v cc >/dev/null; then
	echo 'const char *curses_version(void) { return "ncurses 99.5"; }' | cc -shared -fPIC -x c - -o other.so &&
		LD_PRELOAD=$PWD/other.so "$RBSIM" --version >out 2>err && [ -f "$modules/rbsim-console.so" ] && says out '^console: ncurses 99\.5$'
fi

# each module alone
mkdir alone
for module in hdf5 film console; do
	[ -f "$modules/rbsim-$module.so" ] || continue
	rm -f alone/*
	cp "$modules/rbsim-$module.so" alone/
	RBSIM_MODULE_DIR=$PWD/alone exits 0 --version
	[ "$(grep -c ': not installed (.*cannot open shared object file' out)" -eq 2 ] ||
		fail "with $module alone: $(grep -c 'not installed' out) of two modules are missing"
done
exits 0 --version -q
"$RBSIM" --version >/dev/full 2>err
got=$?
[ $got -eq 74 ] || fail "standard output is full: exit status $got"
