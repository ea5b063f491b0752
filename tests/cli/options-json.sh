#!/bin/sh
# SPDX-License-Identifier: MIT
# With --json every verb that takes it prints one object, which tells the exit status, whether it succeeds, fails, or its command line
# is wrong.
. tests/cli/functions
command -v python3 >/dev/null || { echo "no python3 to read JSON with"; exit 77; }

small_scene 'local e = param("e", 0.5, "x")' >s.lua
exits 0 s.lua -q -o run.h5
exits 0 s.lua -q --duration 0.3 -o other.h5
exits 0 sweep s.lua -p e=0.1,0.5 -o d -q
echo 'sphere { raduis = 1 }' >wrong.lua
printf 'world { duration = 0.1 }\nsphere { radius = 1 }\nexpect("no", function() return false end)\n' >no.lua
printf 'world { duration = 0.1 }\nsphere { radius = 1 }\non_frame(function() error("no") end)\n' >stops.lua
cat >tells.py <<'END_PYTHON'
import json, sys
text = open("out").read()
assert text.endswith("\n") and text.count("\n") == 1, f"{text.count(chr(10))} lines"
told = json.loads(text)["exit_status"]
assert told == int(sys.argv[1]), f"exit_status {told}"
END_PYTHON

# tells STATUS ARGUMENT...: exits with it, and says so in the only object
tells()
{
	exits "$@"
	python3 tells.py "$1" || fail "rbsim $*"
}

tells 0 s.lua --no-record --json
tells 65 wrong.lua --json
tells 1 no.lua --json --no-record
tells 65 stops.lua --json --no-record
tells 66 none.lua --json
tells 73 s.lua -o run.h5 --json
tells 0 s.lua -o run.h5 --resume --json
tells 0 check s.lua --json
tells 65 check wrong.lua --json
tells 0 info run.h5 --json
tells 0 info run.h5 --scene --json
tells 66 info s.lua --json
tells 0 diff run.h5 run.h5 --json
tells 1 diff run.h5 other.h5 --json
tells 66 diff run.h5 none.h5 --json
tells 0 replay run.h5 --json
tells 66 replay none.h5 --json
tells 0 repair run.h5 --json
tells 66 repair s.lua --json
tells 0 converge s.lua --methods located --dt 0.1 --runs 1 --json
tells 65 converge wrong.lua --json
tells 64 verify nothing --json
tells 0 methods --json
tells 0 sweep d --json
tells 0 sweep d --status --json
tells 0 sweep d --plan --json
tells 66 sweep none --status --json
tells 0 collect d --json
tells 73 collect d --json
tells 66 collect none --json
tells 0 plot run.h5 left.z --json
tells 64 plot run.h5 lfet.z --json
tells 0 export run.h5 --to dump --json
tells 66 export none.h5 --to dump --json
tells 66 render none.h5 --json
tells 66 ctl --json none.sock status
# a command line that is wrong before it says --json
tells 64 run s.lua --bogus --json
tells 64 export run.h5 --to foo --json
tells 64 sweep s.lua --seeds none --json
tells 64 ctl --bogus --json none.sock status
