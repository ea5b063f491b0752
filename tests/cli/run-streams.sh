#!/bin/sh
# SPDX-License-Identifier: MIT
# Data on standard output, talk on standard error; a closed pipe or a full disk ends in an error, not in silence.
. tests/cli/functions

small_scene >s.lua
exits 0 s.lua --no-record --json
says_nothing err
[ "$(wc -l <out)" -eq 1 ] || fail "--json is not one line"
[ "$(value status)" = complete ] || fail "no status"
if command -v python3 >/dev/null; then
	for args in "s.lua --no-record --json" "check s.lua --json" "methods --json"; do
		# shellcheck disable=SC2086
		exits 0 $args
		python3 -m json.tool out >/dev/null || fail "rbsim $args: not JSON"
	done
fi

# one object whatever happens
told()
{
	[ "$(wc -l <out)" -eq 1 ] || fail "--json is not one line"
	if command -v python3 >/dev/null; then
		python3 -m json.tool out >/dev/null || fail "not JSON"
	fi
	[ "$(value status)" = "$1" ] || fail "status $(value status), wanted $1"
	[ "$(value exit_status)" = "${got:?}" ] || fail "exit_status $(value exit_status), wanted $got"
}
echo 'world { duration = 1, gravty = {} } spere {}' >wrong.lua
exits 65 wrong.lua --json
told refused
says out '"mistakes":\["wrong.lua:1: .*gravty.*","wrong.lua:1: .*spere'
exits 65 check wrong.lua --json
told refused
exits 66 missing.lua --json
told refused
says out '"scene":"missing.lua"'
exits 64 --json s.lua --bogus
told refused
exits 64 s.lua --json -p zz=1
told refused
exits 73 s.lua --json -o no/where.h5
told refused
exits 66 info missing.h5 --json
told refused
exits 66 diff a.h5 b.h5 --json
told refused
{ echo 'expect_refused(65, "gravty")'; cat wrong.lua; } >refused.lua
exits 0 refused.lua --json
told refused
exits 0 check s.lua --json
told accepted
small_scene 'expect("no", function() return false end)' >fails.lua
exits 1 fails.lua --json --no-record
told complete
small_scene 'on_frame(function(t, k) if k == 3 then error("stop") end end)' >breaks.lua
exits 65 breaks.lua --json --no-record
told failed
says out '"reason":"breaks.lua:6: stop"'

# a number that is none is not shown as one
echo 'world { duration = 0.1 } sphere { radius = 1, mass = 1e300, velocity = {1e150, 0, 0} }' >huge.lua
exits 0 huge.lua
says err 'energy +not finite at the start, not finite at the end, change not finite'
says err 'momentum +not finite, angular momentum '
exits 0 info huge.h5
says out 'energy +not finite at the start, not finite at the end, largest kinetic not finite'
says out 'momentum +not finite'
exits 0 huge.lua --no-record --json
for key in energy_drift momentum_drift kinetic_energy_max kinetic_energy; do
	[ "$(value $key)" = null ] || fail "$key is $(value $key)"
done
cat >pushed.lua <<'END'
world { duration = 0.1 }
record { ledger = true }
sphere { radius = 1, mass = 1, forces = {{vector = {1e308, 0, 0}}} }
END
exits 0 pushed.lua --no-record --method stepped
says err 'ledger +applied not finite'
says err 'unexplained +not finite, not finite of what moved; of momentum [0-9.e-]+, '
exits 0 pushed.lua --no-record --method stepped --json
for key in applied unexplained_max unexplained_share; do
	[ "$(value $key)" = null ] || fail "$key is $(value $key)"
done

# a motion that is not finite ends the run, and no frame has it, whether an impact does that or the way
cat >heavy.lua <<'END'
world { duration = 0.2, gravity = {0, 0, -9.81} }
plane { material = material { restitution = 0.5 } }
sphere { name = "ball", radius = 0.1, mass = 1e307, position = {0, 0, 1}, velocity = {50, 0, -50} }
END
exits 76 heavy.lua --method located -q
says err "heavy.lua:3: the impulse of 'ball' and '#0' is not finite at t = 0.01"
cat >far.lua <<'END'
world { duration = 100, frame_rate = 1, gravity = {0, 0, 1e307} }
sphere { name = "ball", radius = 1 }
END
for method in located stepped classic; do
	exits 76 far.lua --method $method -q
	says err "far.lua:2: the state of 'ball' is not finite after t = [45]"
	exits 0 plot far.h5 ball.z ball.vz --json
	! grep -q '\[[^]]*null' out || fail "$method: a frame that is not finite"
	rm far.h5
done

# what did not change has no drift, however large beside another
cat >still.lua <<'END'
world { duration = 0.1, gravity = {0, 0, -9.81} }
sphere { radius = 1, mass = 1, position = {0, 0, 1}, velocity = {0, 0, 1e100} }
on_frame(function() error("stop") end)
END
exits 65 still.lua --no-record --json
[ "$(value energy_drift)" = 0 ] || fail "the energy of one frame changes by $(value energy_drift) J"

if [ -e /dev/full ]; then
	for args in "s.lua --no-record --json" "check s.lua" "methods" "--help"; do
		# shellcheck disable=SC2086
		"$RBSIM" $args >/dev/full 2>err
		[ $? -eq 74 ] || fail "rbsim $args >/dev/full: not 74"
		says err 'cannot write standard output'
	done
fi
for args in "s.lua --no-record --json" "methods"; do
	# the reader has gone when the program writes
	# shellcheck disable=SC2086
	{ sleep 0.3; "$RBSIM" $args 2>err; echo $? >status; } | true
	until_true [ -s status ]
	[ "$(cat status)" = 74 ] || fail "rbsim $args into a closed pipe: $(cat status)"
	says err 'Broken pipe'
	rm status
done
