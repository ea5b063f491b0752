#!/bin/sh
# SPDX-License-Identifier: MIT
# What a wrong scene, a failed expectation and a failing callback get.
. tests/cli/functions

cat >wrong.lua <<'END'
world { duration = 1, gravty = {0, 0, -9.81} }
sphere { name = "ball", raduis = 1 }
sphere { radius = -1 }
END
exits 65 wrong.lua
says_nothing out
says err "^wrong.lua:1: .*'gravty'.*did you mean 'gravity'"
says err "^wrong.lua:2: .*'ball'.*'raduis'.*did you mean 'radius'"
says err "^wrong.lua:3: .*-1"
[ ! -e wrong.h5 ] || fail "a wrong scene has touched an output"
exits 65 wrong.lua --debug
says err 'scene error, from .*\.c:[0-9]+'
exits 65 check wrong.lua

cat >unread.lua <<'END'
gravity, duration, tolerance = {0, 0, -9.81}, 0.1, function() end
world { duration = duration }
sphere { radius = 1 }
END
exits 0 unread.lua --no-record
says err "warning: unread.lua: nothing reads the global 'gravity'; it is a key of world"
! grep -q "'duration'" err || fail "what is right is told as a mistake"

cat >undefined.lua <<'END'
world { duration = 0.1 }
local mass = 3
count = count or 1
if missing then error "is nil" end
sphere { radius = 1, mass = masss }
on_step(function() bounces = (bounces or 0) + 1 end)
END
exits 0 undefined.lua
says err "warning: undefined.lua:4: nothing assigns the global 'missing'; it is nil$"
says err "warning: undefined.lua:5: nothing assigns the global 'masss'; it is nil .did you mean 'mass'"
[ "$(grep -c "nothing assigns" err)" -eq 2 ] || fail "what is assigned later, or in callbacks, is warned of"
exits 0 info undefined.h5
says_nothing err
# in a coroutine of a helper there is no line of the scene
echo 'return coroutine.wrap(function() return nowhere end)' >helper.lua
printf 'world { duration = 0.1 }\nrequire "helper"()\nsphere { radius = 1 }\n' >undefined.lua
exits 0 undefined.lua --no-record
says err "warning: undefined.lua: nothing assigns the global 'nowhere' .in helper.lua:1.; it is nil"
exits 64 unread.lua --dt 0.1
says err "option '--dt' does not belong to 'run' .did you mean '--time-step'"

small_scene 'expect("the world ends", function() return false end)
expect("small", function() return 2, 1 end)' >fails.lua
exits 1 fails.lua
says err 'FAIL *the world ends'
says err 'FAIL *small: measured 2, bound 1'
[ -f fails.h5 ] || fail "a failed expectation has cost the recording"
exits 0 info fails.h5
says out 'status +complete'
exits 1 fails.lua --no-record -q
says err 'FAIL *the world ends'

small_scene 'on_frame(function(t) if t > 0.2 then error("out of luck") end end)' >breaks.lua
exits 65 breaks.lua
says err 'breaks.lua:6: out of luck'
exits 0 info breaks.h5
says out 'status +failed: .*out of luck'
exits 65 breaks.lua --no-record
says err '^breaks.lua:6: out of luck$'
says err '^stack traceback:$'
[ "$(grep -c 'out of luck' err)" -eq 1 ] || fail "the message stands there more than once"
# what a function of the scene's returned is refused outside of it: there is no place to trace back to
small_scene 'sphere { radius = 0.1, motion = function(t) return {0, 0, t > 0.2 and "x" or 1} end }' >returns.lua
exits 65 returns.lua --no-record
says err "^returns.lua:6: 'motion' must return .*got \\{0, 0, 'x'\\}"
! grep -q 'stack traceback' err || fail 'a traceback of what no function of the scene called'

# a body's name is no global: told also by what is called later
cat >named.lua <<'END'
world { duration = 0.1 }
sphere { name = "s", radius = 1 }
result("x", function() return s.position.x end)
END
exits 65 named.lua --no-record
says err "named.lua:3: attempt to index a nil value \(global 's'\) \(body \"s\" gives the body of that name\)"

# one expectation that is broken does not cost the others
cat >broken.lua <<'END'
world { duration = 0.1 }
sphere { radius = 1 }
expect("first", function() return true end)
expect("breaks", function() return nil + 1 end)
expect("wrong type", function() return "yes" end)
expect("no number", function() return 0 / 0, 1 end)
expect("last", function() return 2, 1 end)
END
exits 65 broken.lua
says err 'expectations +1 of 5 hold'
says err 'ok +first$'
says err 'FAIL breaks: broken.lua:4: attempt to perform arithmetic on a nil value'
says err "FAIL wrong type: broken.lua:5: expect 'wrong type': .*got the text 'yes' and nothing"
says err 'FAIL no number: measured nan, bound 1'
says err 'FAIL last: measured 2, bound 1'
says err '^broken.lua:4: attempt'
says err '^	broken.lua:4: in function'
! grep -q 'did not come to its end' err || fail "the run came to its end"
exits 65 broken.lua --no-record --json
[ "$(value status)" = complete ] || fail "status $(value status)"
[ "$(value exit_status)" = 65 ] || fail "exit_status $(value exit_status)"
[ "$(grep -o '"ok":false' out | wc -l)" -eq 4 ] || fail "not four failed expectations"

# a call's name is not to be assigned to
cat >assigned.lua <<'END'
world { duration = 0.1 }
local sphere_of, sphere = sphere, sphere
sphere { radius = 1 } -- on_step = nothing
function on_step(t, dt)
end
  expect_always = function() return true end
END
exits 65 assigned.lua --no-record
says err "^assigned.lua:4: 'on_step' is a call of the scene language: write on_step\(function\(t, dt\) \.\.\. end\)$"
says err "^assigned.lua:6: 'expect_always' is a call"
[ "$(wc -l <err)" -eq 2 ] || fail "more than two mistakes"

# parameters: what there is, and why a fraction will not do
cat >params.lua <<'END'
world { duration = 0.1 }
sphere { radius = 1, mass = 1 + param("extra", 0, "kg") }
for i = 1, 11 do param("p" .. i, i, "") end
END
exits 64 params.lua --no-record --param extra=0.5
says err 'must be a whole number, as its default 0 is one \(write 0.0 in the scene for any number\)'
exits 64 params.lua --no-record --param extra=much
says err "must be a whole number \(got 'much'\)"
exits 64 params.lua --no-record --param zz=1
says err 'no such parameter; it has extra, p1, p2, .*, p9 and 2 more'

# a scene that breaks off has not come to what it would have declared
printf 'local x = nil + 1\nlocal n = param("n", 5, "bodies")\n' >breaks.lua
exits 65 breaks.lua --param n=3
says err '^breaks.lua:1: .*arithmetic'
if grep -q 'no such parameter' err; then fail "a parameter is unknown that was not come to"; fi

# what is no text
small_scene >s.lua
exits 0 s.lua -q
exits 66 s.h5 --no-record
says err "'s.h5' is not a scene: it begins with bytes that are not text \(a recording\? see rbsim info\)"

cat >refused.lua <<'END'
expect_refused(65, "raduis")
world { duration = 1 }
sphere { raduis = 1 }
END
exits 0 refused.lua
says err 'refused, as the scene expects'
exits 0 check refused.lua
sed 's/"raduis"/"something else"/' refused.lua >otherwise.lua
exits 65 otherwise.lua
says err 'expected to be refused'
sed 's/{ raduis/{ radius/' refused.lua >accepted.lua
exits 1 accepted.lua --no-record
says err 'expected to be refused .* but was not'

# frames beyond this disk (another one may do), or any patience, before anything is made
for rate in 1e12 1e15; do
	small_scene | sed "s/duration = 0.5/duration = 0.5, frame_rate = $rate/" >often.lua
	[ $rate = 1e12 ] && wanted=73 || wanted=65
	exits $wanted often.lua
	says err "^(rbsim: )?often.lua:1: world: 'duration' 0.5 s times 'frame_rate' 1e\+1[25] makes 5e\+1[14] frames, which would take at least [0-9.]+ [TP]B of disk"
	[ ! -e often.h5 ] || fail "a recording of $rate frames a second"
done
exits 65 often.lua --no-record
says err '16 years at a microsecond each'
exits 65 check often.lua

# names up to the system's limit, with everything that stands beside them
long=$(printf '%0252d' 0).h5
small_scene >s.lua
exits 0 s.lua -o "$long" --checkpoint-every 0.001
exits 0 info "$long"
[ -z "$(find . -name '00*checkpoint*')" ] || fail "a checkpoint of a long name stays"
exits 73 s.lua -o "0$long"
says err "cannot create '00"

# However long names are, what was wrong, in which line and why is told.
folder=$(printf "%0200d" 0)
deep=$folder/$folder
mkdir -p "$deep"
exits 66 info "$deep/none.h5"
says err '^rbsim: cannot open .*none.h5.: No such file'
exits 73 s.lua -o "$deep/none/s.h5"
says err '^rbsim: cannot create .*No such file'
printf 'world { duration = 1 }\nsphere { radius = -1 }\n' >"$deep/wrong.lua"
exits 65 "$deep/wrong.lua" --json
says err "wrong.lua:2: sphere: 'radius' must be positive \(got -1\)"
says out '"reason":"[^"]*wrong.lua:2: sphere: .radius. must be positive'
printf 'world { duration = 1 }\nsphere { radius = 1, inertia = {1, 1, 3} }\n' >"$deep/wrong.lua"
exits 65 "$deep/wrong.lua"
says err 'wrong.lua:2: sphere'
# Lua's own errors, too, have their place once
printf 'world { duration = 1 }\nlocal sum = nil + 1\n' >"$deep/wrong.lua"
exits 65 "$deep/wrong.lua"
says err 'wrong.lua:2: attempt to perform arithmetic'
[ "$(grep -o 'wrong\.lua' err | wc -l)" = 1 ] || fail "the place is told twice: $(cat err)"
rm -r "$folder"

# without /proc, or with something else in its place: what is missing is told, and what does not need it goes on; sanitizers
# do not go on without it
case ${RBSIM_MODE:-release} in
asan | tsan) bare=false ;;
*) bare=true ;;
esac
if $bare && unshare -rm true 2>/dev/null; then
	small_scene 'param("r", 0.1, "unused", {min = 0})' >t.lua
	cat >bare.sh <<'END'
mount -t tmpfs none /proc || exit 77
"$RBSIM" s.lua -q -o bare.h5 2>err
[ $? -eq 69 ] && grep -q '/proc/self/exe does not say' err || exit 1
RBSIM_MODULE_DIR=${RBSIM%/*} "$RBSIM" s.lua -q -o bare.h5 2>err
[ $? -eq 73 ] && grep -q "'/proc/self/fd' is missing or not the system's own" err && [ ! -e bare.h5 ] || exit 2
mkdir -p /proc/self/fd && echo nonsense >/proc/self/status
"$RBSIM" s.lua -q --no-record 2>err || exit 3
RBSIM_MODULE_DIR=${RBSIM%/*} "$RBSIM" s.lua -q -o bare.h5 2>err
[ $? -eq 73 ] || exit 4
export RBSIM_MODULE_DIR=${RBSIM%/*}
umount /proc && mount -t tmpfs none /proc
"$RBSIM" sweep t.lua --param r=0.1,0.2 -o bare 2>err
[ $? -eq 69 ] && grep -q '/proc/self/exe does not say' err && [ ! -e bare/point-00000.log ] || exit 5
mkdir /proc/self && ln -s x /proc/self/exe
"$RBSIM" sweep t.lua --param r=0.1,0.2 -o bare 2>err
[ $? -eq 69 ] && grep -q "but 'x'" err || exit 6
"$RBSIM" verify s05 2>err
[ $? -eq 66 ] && grep -q 'cannot find the cases' err || exit 7
END
	unshare -rm sh bare.sh >bare.out 2>&1
	got=$?
	[ $got -eq 0 ] || [ $got -eq 77 ] || fail "without /proc, $got: $(cat bare.out err)"
fi

# a group that nobody is in
cat >groups.lua <<'END'
world { duration = 0.1 }
plane { normal = {0, 0, 1}, group = "walls" }
sphere { name = "ball", radius = 1, position = {0, 0, 2}, collides_with = {"wals", "walls"} }
sphere { radius = 1, position = {4, 0, 2}, collides_with = "wals" }
sphere { radius = 1, position = {8, 0, 2}, collides_with = {} }
END
exits 0 groups.lua --no-record
says err "groups.lua:3: 'ball' collides with group 'wals', which has no body \(did you mean 'walls'\?\)"
[ "$(grep -c warning err)" = 1 ] || fail "one warning for each group"
exits 66 ctl groups.lua play
says err "cannot reach a run at 'groups.lua': it is not a socket"

# a global that is read as a field of _G is missed by nobody
cat >fields.lua <<'END'
world { duration = 0.1 }
sphere { radius = 1 }
if _G.mine or _G["yours"] then error("?") end
local x = _G.mine or theirs
END
exits 0 fields.lua --no-record
says err "fields.lua:4: nothing assigns the global 'theirs'"
[ "$(grep -c "nothing assigns" err)" = 1 ] || fail "a field of _G is warned of"
