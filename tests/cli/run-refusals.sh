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
exits 65 breaks.lua --no-record --debug
says err 'traceback'

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
