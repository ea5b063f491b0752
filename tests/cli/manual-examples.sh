#!/bin/sh
# SPDX-License-Identifier: MIT
# Examples that other tests do not run, as they stand: of rbsim-control(7), rbsim-recording(5) and the README of the Python package.
. tests/cli/functions
python=
find_python
case $RBSIM in /*) ;; *) RBSIM=$TOP/$RBSIM ;; esac
mkdir bin
ln -s "$RBSIM" bin/rbsim
PATH=$PWD/bin:$PATH
RBSIM_MODULE_DIR=${RBSIM%/*} PYTHONPATH=$TOP/tools/python PYTHONDONTWRITEBYTECODE=1
export PATH RBSIM RBSIM_MODULE_DIR PYTHONPATH PYTHONDONTWRITEBYTECODE
cat >bounce.lua <<'LUA'
local e = param("e", 0.8, "restitution of the ball", {min = 0, max = 1})
world { title = "A bouncing ball", duration = 0.6, gravity = {0, 0, -9.81} }
local rubber = material { name = "rubber", restitution = e }
plane { normal = {0, 0, 1}, material = rubber }
local ball = sphere { name = "ball", radius = 0.1, position = {0, 0, 0.3}, material = rubber }
record { fields = {"+", "events"} }
probe ("height", function() return ball.position.z - 0.1 end, {unit = "m"})
result("bounces", collisions)
camera { size = {160, 120}, fps = 10 }
LUA

# displays PAGE: the displays of its section EXAMPLES as numbered files example-1, ...
displays()
{
	rm -f example-*
	awk '/^\.Sh EXAMPLES/ { on = 1; next } /^\.Sh / { on = 0 } !on { next }
		/^\.Bd/ { file = "example-" ++n; next } /^\.Ed/ { file = ""; next }
		file != "" { gsub(/\\(e|\\)/, "\\"); print >file }' "$TOP/man/$1"
}

# a run is stopped at each of its impacts, and asked where its ball is
displays rbsim-control.7
[ -f example-1 ] && [ ! -f example-2 ] || fail "rbsim-control(7) has other examples"
{ cat example-1; echo wait; } >control.sh
timeout 100 sh control.sh >out 2>err || fail "the example of rbsim-control(7) fails"
[ "$(grep -c '^position 0 0 0.1' out)" -eq 2 ] || fail "the run did not stop at its two impacts: $(cat out)"
count=1

if [ -n "$python" ]; then
	cp bounce.h5 run.h5
	displays rbsim-recording.5
	for example in example-*; do
		# a reader that is not here is no fault of the page
		"$python" -c '
import sys
try:
    exec(compile(open(sys.argv[1]).read(), sys.argv[1], "exec"))
except ImportError as error:
    print("not tried:", error)' "$example" >out 2>err || fail "rbsim-recording(5): $(cat "$example")"
		grep "^not tried" out
		count=$((count + 1))
	done
	awk '/^```python$/ { on = 1; next } /^```$/ { on = 0 } on' "$TOP/tools/python/README.md" >readme.py
	[ "$(grep -c '^import rbsim\|^from concurrent' readme.py)" -eq 2 ] || fail "README.md has other examples"
	"$python" readme.py >out 2>err || { grep -q 'ffmpeg' err || fail "tools/python/README.md: $(cat readme.py)"; }
	count=$((count + 2))
fi
echo "$count examples"
