#!/bin/sh
# SPDX-License-Identifier: MIT
# rbsim verify: shipped cases pass, a case that fails is shown with its figures, and so are one that hangs and one that
# breaks; variations reach the scene; words that name no case are refused.
. tests/cli/functions

# The shipped ones: all of the quick subset where the program is fast, some everywhere. S40 fills the memory that a script
# may have with bodies, for which a program under tsan needs more than the time that a script may take.
exits 0 verify --quick s05 s09 s12
says out '^S12_ball_ball_wall +three impacts .* pass$'
says out '^3 of 3 cases pass; [0-9]+ of [0-9]+ runs in '
if [ "${RBSIM_MODE:-release}" != tsan ]; then
	exits 0 verify --quick s40
	says out '^S40_bad_input +refused, as it must be .* pass$'
fi
if [ "${RBSIM_MODE:-release}" = release ]; then
	exits 0 verify --quick
fi
exits 0 verify S12 --json
python3 - <<'END' || fail 'the JSON of verify is not what it should be'
import json
whole = json.load(open('out'))
assert whole['case_count'] == 1 and whole['case_failures'] == whole['run_failures'] == whole['exit_status'] == 0
(case,) = whole['cases']
assert case['case'] == 'S12_ball_ball_wall' and case['passed'] is True
runs = {run['variation']: run for run in case['runs']}
assert len(runs) == 10, sorted(runs)
for name in 'base', 'turn=1', 'turn=2', 'shift=1', 'harmless=true', 'zero_field=true':
    assert runs[name]['passed'] and len(runs[name]['expectations']) == 4, name
assert sum(name.startswith('time_step=') for name in runs) == 2 == sum(name.startswith('frame_rate=') for name in runs)
assert all(e['measured'] <= e['bound'] for run in runs.values() for e in run['expectations'])
END

# Cases that fail, each in its way; a file that is no case is left alone.
mkdir cases
echo 'error("not a case")' >cases/part.lua
cat >cases/T1_wrong.lua <<'END'
local verify = require "rbsim.verify"
local way = param("way", 1, "which way", {choices = {1, 2}})
verify.case { title = "Wrong", duration = 1, time_step = {0.1, 0.05, 1}, frame_rate = {10, 1, 20}, quick = "more",
	leave_out = {shift = "because of this test"} }
local ball = verify.sphere { name = "ball", radius = 0.1, velocity = {1, 2, 3} }
expect("velocity along x", function() return verify.velocity(ball).x, 1 + 1e-12 end)
expect("turned, it has none along its own x", function()
	return math.abs(ball.velocity.x - verify.vector({1, 2, 3}).x), way == 2 and verify.turn == 2 and -1 or 1e-12
end)
END
cat >cases/T2_hangs.lua <<'END'
local verify = require "rbsim.verify"
verify.case { title = "Hangs", duration = 1, time_step = {0.1}, frame_rate = {10}, processor_seconds = 0.3,
	leave_out = {turn = "x", shift = "x", harmless = "x", zero_field = "x", time_step = "x", frame_rate = "x"} }
sphere { radius = 0.1 }
on_frame(function() for i = 1, 3e7 do local x = i * i end end)
expect("it ends", function() return true end)
END
cat >cases/T3_breaks.lua <<'END'
world { duration = 1 }
sphere { radius = 0.1 }
on_frame(function(t) if t > 0.5 then error("broken") end end)
expect("it ends", function() return true end)
END
cat >cases/T4_empty.lua <<'END'
world { duration = 1 }
sphere { radius = 0.1 }
END
cat >cases/T5_not_refused.lua <<'END'
world { duration = 1 }
sphere { radius = 0.1 }
expect_refused(65, "never")
END
cat >cases/T6_right.lua <<'END'
world { duration = 1 }
sphere { radius = 0.1 }
expect("nothing", function() return 0, 0 end)
END
exits 1 verify --scenes cases
says out '^T1_wrong +velocity along x .* 1 +1  pass$'
says out 'it has none along its own x +way=2 turn=2 .*  FAIL$'
says out '\(not varied: shift: because of this test\)'
says out '^T2_hangs +no end within 0.3 s .* FAIL$'
says out '^T3_breaks +cases/T3_breaks.lua:3: broken .* FAIL$'
says out '^T4_empty +expects nothing .* FAIL$'
says out '^T5_not_refused +exit status 1: .* FAIL$'
says out '^ +expected to be refused with status 65, but was not$'
says out '^T6_right +nothing +base +0 +0  pass$'
says out '^1 of 6 cases pass; 18 of 23 runs'
exits 1 verify t1 --scenes cases --jobs 1 --quiet
[ "$(wc -l <out)" -eq 1 ] || fail 'quiet tells more than what fails'
exits 0 verify t1 --scenes cases --quick
says out '^1 of 1 case pass; 4 of 4 runs'
exits 0 verify T6 --scenes cases --method classic

# A machine that is busy with others is no fault of a run: its limit is of processor time.
mkdir slow
cat >slow/T7_waits.lua <<'END'
local verify = require "rbsim.verify"
verify.case { title = "Waits", duration = 1, time_step = {0.1}, frame_rate = {10}, processor_seconds = 5,
	leave_out = {turn = "x", shift = "x", harmless = "x", zero_field = "x", time_step = "x", frame_rate = "x"} }
sphere { radius = 0.1 }
on_frame(function() for i = 1, 1e7 do local x = i * i end end)
expect("it ends", function() return true end)
END
"$RBSIM" verify --scenes slow >out 2>err &
pid=$!
child=
has_child()
{
	child=$(cat "/proc/$pid/task/$pid/children") && [ -n "$child" ]
}
until_true has_child
child=${child% }
kill -STOP "$child" || fail "the run was not found"
sleep 6
kill -CONT "$child"
ended 0 "a run that was stopped for longer than its limit"
says out '^T7_waits +it ends .* pass$'

exits 64 verify s93
says err "unknown case 's93'.* there are "
exits 64 verify zeno --scenes cases --json
says out '"exit_status":64'
exits 64 verify --jobs 0
exits 66 verify --scenes nowhere
says err "no folder 'nowhere'"
mkdir empty
exits 66 verify --scenes empty
says err "none in 'empty'"
RBSIM_VERIFY_PATH=empty
export RBSIM_VERIFY_PATH
exits 66 verify
exits 0 verify --scenes cases T6
