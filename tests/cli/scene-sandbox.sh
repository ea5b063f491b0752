#!/bin/sh
# SPDX-License-Identifier: MIT
# A scene from somebody else reads and writes nothing outside of its folders, ends, and --trust lifts it.
. tests/cli/functions

mkdir -p scene secret
echo 'return { radius = 1 }' >secret/key.lua
echo png >secret/key.png
ln -s ../secret/key.lua scene/link.lua
ln -s ../secret/key.png scene/link.png
ln -s ../secret scene/folder

refused()
{
	printf '%s\n' 'world { duration = 0.1 }' "$1" >scene/bad.lua
	exits 65 scene/bad.lua -o out.h5
	grep -Fq -- "scene/bad.lua:2: $2" err || fail "'$1' does not get '$2'"
	[ ! -e out.h5 ] || fail "'$1' has touched the output"
}
refused 'io.open("secret/key.lua")' "attempt to index a nil value (global 'io')"
refused 'os.execute("touch touched")' "attempt to index a nil value (global 'os')"
refused 'require "link"' "require 'link': there is no such file in the scene's folder"
refused 'require "folder.key"' "require 'folder.key': there is no such file in the scene's folder"
refused 'require "../secret/key"' "require '../secret/key': a name is a file beside the scene"
refused 'sphere { radius = 1, texture = "../secret/key.png" }' "sphere: 'texture' must be a path within the scene's folder"
refused 'sphere { radius = 1, texture = "link.png" }' "sphere: 'texture': there is no file 'link.png' in the scene's folder"
refused 'record { file = "../x.h5" }' "record: 'file' must be a path within the output folder"
echo 'local t = {} for i = 1, 1e9 do t[i] = {} end' >scene/bad.lua
exits 65 scene/bad.lua
says err 'needs more than 256 MiB of memory \(--trust lifts this\)'
[ ! -e touched ] || fail "a scene ran a program"

echo 'sphere { radius = 1, texture = "own.png" } world { duration = 0.1 }' >scene/good.lua
printf '\211PNG\r\n\032\n\0\0\0\rIHDR\0\0\0\1\0\0\0\1\10\2\0\0\0\0\0\0\0' >scene/own.png
exits 0 scene/good.lua --no-record --quiet
(cd scene && "$RBSIM" good.lua --no-record --quiet) || fail "a texture beside the scene is not found from its folder"

echo 'world { duration = 0.1 } sphere { radius = 1 } io.open("touched", "w"):close() assert(os.time() > 0)' >scene/mine.lua
exits 65 scene/mine.lua --no-record
exits 0 scene/mine.lua --no-record --quiet --trust
[ -e touched ] || fail "a trusted scene is kept from its files"

# Bytecode is no scene.
printf '\033Lua\124\000' >code.lua
exits 66 code.lua
says err "'code.lua' is not a scene: it begins with bytes that are not text"
exits 66 nothing.lua
says err "nothing.lua.*No such file"
