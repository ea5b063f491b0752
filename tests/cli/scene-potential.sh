#!/bin/sh
# SPDX-License-Identifier: MIT
# Fields with a potential, and fields that ask for the body: energy and ledger, by every method; what is refused.
. tests/cli/functions

refused()
{
	cat >scene.lua
	exits 65 scene.lua --no-record
	says err "$1"
}
refused "scene.lua:3: field: 'potential' must be a function" <<'END'
world { duration = 1 }
sphere { radius = 1 }
field(function(t, x, v) return {0, 0, 0} end, { potential = 3 })
END
refused "scene.lua:3: field: unknown key 'potentail' \(did you mean 'potential'" <<'END'
world { duration = 1 }
sphere { radius = 1 }
field(function(t, x, v) return {0, 0, 0} end, { potentail = function() return 0 end })
END
refused "scene.lua:3: 'potential' must return a finite number of joules \(got .*potential at t = 0 s" <<'END'
world { duration = 1 }
sphere { radius = 1 }
field(function(t, x, v) return {0, 0, 0} end, { potential = function() return "much" end })
END

# a trap whose stiffness is each body's mass times k, which may grow with time
cat >trap.lua <<'END'
local grows = param("grows", 0.0, "1/s")
local k, bound = 4, param("bound", 1e-12, "m")
world { duration = 2, time_step = param("step", 0.01, "s"), frame_rate = 4 }
local plain = material { name = "plain", friction = 0 }
local light = sphere { name = "light", radius = 0.1, mass = 1, position = {1, 0, 0}, material = plain, collides_with = {} }
local heavy = sphere { name = "heavy", radius = 0.1, mass = 3, position = {0, 2, 0}, material = plain, collides_with = {} }
field(function(t, x, v, body) return -k * (1 + grows * t) * body.mass * vec3(x) end,
	{ potential = function(t, x, body) return 0.5 * k * (1 + grows * t) * body.mass * x:dot(x) end })
-- one without, beside it: it does work
field(function(t, x, v) return {0, 0, 0.5} end)
record { ledger = true }
if grows == 0 then
	local w = math.sqrt(k)
	expect("place of the heavy one", function() return math.abs(heavy.position.y - 2 * math.cos(w * 2)), bound end)
end
-- half of k m r^2 of both
local start
on_frame(function(t) if t == 0 then start = energy() end end)
expect("energy at the start", function() return math.abs(start - (0.5 * k * 1 + 0.5 * k * 3 * 4)), 1e-12 end)
END
# below KEY BOUND: of the last run's JSON
below()
{
	awk -v x="$(value "$1")" -v most="$2" 'BEGIN { if (x < 0) x = -x; exit !(x != "" && x + 0 <= most) }' ||
		fail "$1: $(value "$1"), bound $2"
}
exits 0 trap.lua --method located --no-record --json
below unexplained_max 1e-12
exits 0 trap.lua --method located --no-record --json --param grows=0.5
below unexplained_max 1e-9
applied=$(value applied)
awk -v a="$applied" 'BEGIN { exit !(a > 1) }' || fail "a trap that grows stiffer gives $applied J"
# by steps: of first order
exits 0 trap.lua --method stepped --no-record --json --param bound=0.1
below unexplained_max 1
coarse=$(value unexplained_max)
exits 0 trap.lua --method stepped --no-record --json --param bound=0.01 --param step=0.001
awk -v a="$coarse" -v b="$(value unexplained_max)" 'BEGIN { exit !(b < 0.2 * a) }' || fail "unexplained: $coarse, $(value unexplained_max)"
exits 0 trap.lua --method stepped --no-record --json --param step=0.001 --param grows=0.5
awk -v a="$applied" -v b="$(value applied)" 'BEGIN { d = a - b; exit !((d < 0 ? -d : d) < 0.02 * a) }' || fail "applied: $applied, $(value applied)"
# a recording has the energy, with the scene's own potential
exits 0 trap.lua --method located -o trap.h5
exits 0 replay trap.h5
exit 0
