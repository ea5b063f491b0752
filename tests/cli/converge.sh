#!/bin/sh
# SPDX-License-Identifier: MIT
# rbsim converge: errors and orders that are known, failures as crosses, pictures, files, advice, refusals.
. tests/cli/functions

cat >throw.lua <<'END'
local limit = param("limit", 1.0, "longest step that its callback allows, s")
local wrong = param("wrong", 0.0, "by how much the reference starts elsewhere, m")
world { title = "It's a `throw` of 50%", duration = 0.5, gravity = {0, 0, -10}, time_step = 1 / 600 }
sphere { name = "ball", radius = 0.1, position = {0, 0, 0}, velocity = {1, 0, 3}, angular_velocity = {0, 0, 1} }
on_step(function(t, dt) if dt > limit then error("too coarse") end end)
reference(function(t)
	return { ball = { position = vec3(t + wrong, 0, 3 * t - 5 * t * t), velocity = vec3(1, 0, 3 - 10 * t),
		angular_velocity = vec3(0, 0, 1) } }
end)
END
classic="--methods classic,classic-global --runs 1"

# three bodies that turn about principal axes, each from an orientation of its own: all of them are compared
cat >turn.lua <<'END'
world { duration = 0.4, gravity = {0, 0, 0} }
local turns = {{1, 0, 0, 0}, {0.8, 0.6, 0, 0}, {0.6, 0, 0.8, 0}}
local axes = {{0, 0, 1}, {0, -0.96, 0.28}, {0.96, 0, -0.28}}
for i = 1, 3 do
	local w = 2 * i
	box { name = "b" .. i, size = {0.1 * i, 0.3, 0.2}, mass = i, position = {i, 0, 0}, orientation = turns[i],
		angular_velocity = {w * axes[i][1], w * axes[i][2], w * axes[i][3]} }
end
reference(function(t)
	local all = {}
	for i = 1, 3 do
		local a = axes[i]
		local half = i * t
		local s, c = math.sin(half), math.cos(half)
		local q = turns[i]
		local u = {s * a[1], s * a[2], s * a[3]}
		all["b" .. i] = { position = vec3(i, 0, 0), velocity = vec3(0, 0, 0), angular_velocity = vec3(2 * i * a[1], 2 * i * a[2], 2 * i * a[3]),
			orientation = {
				c * q[1] - u[1] * q[2] - u[2] * q[3] - u[3] * q[4],
				c * q[2] + u[1] * q[1] + u[2] * q[4] - u[3] * q[3],
				c * q[3] + u[2] * q[1] + u[3] * q[2] - u[1] * q[4],
				c * q[4] + u[3] * q[1] + u[1] * q[3] - u[2] * q[2] } }
	end
	return all
end)
END
exits 0 converge turn.lua --methods located --runs 1 --dt 0.01 --json
python3 - <<'END' || fail "bodies that turn are not where they should be"
import json
errors = json.load(open("out"))["rows"][0]["errors"]
assert sorted(errors) == ["angular_velocity", "energy", "orientation", "penetration", "position", "velocity"], errors
for name, error in errors.items():
    assert error["max"] < 1e-13, (name, error)
END

# a method that is named twice is run once
exits 0 converge throw.lua --methods classic,classic-global,classic --runs 1 --dt 0.01 --json
python3 -c 'import json; assert len(json.load(open("out"))["rows"]) == 2' || fail "not two methods"

# Semi-implicit Euler falls short by g t dt/2: at the end 10 x 0.5 x dt / 2.
exits 0 converge throw.lua $classic --dt 0.01,0.001 --json
[ "$(wc -l <out)" -eq 1 ] || fail "not one object"
python3 - <<'END' || fail "the errors of a throw are not g t dt/2"
import json
r = json.load(open("out"))
assert r["reference"]["kind"] == "scene" and not r["energy_is_drift"]
assert len(r["rows"]) == 4, r["rows"]
for row in r["rows"]:
    error, dt = row["errors"]["position"], row["time_step"]
    assert abs(error["max"] - 2.5 * dt) < 1e-12 and error["final"] == error["max"], row
    assert error["rms"] < error["max"] and row["wall_time"] > 0 and row["runs"] == 1
    # kinetic energy and that of gravity, by hand: m g (g t dt/2) of m (1 + 9)/2, and no error of speed
    assert abs(row["errors"]["energy"]["max"] - 10 * 2.5 * dt / 5) < 0.02 * dt, row["errors"]["energy"]
    assert row["errors"]["velocity"]["max"] < 1e-13
for method in r["methods"]:
    assert abs(method["order"] - 1) < 1e-3 and method["order_points"] == 2, method
assert r["advice"]["row"] is None and "no setting reaches" in r["advice"]["text"]
END
exits 0 converge throw.lua $classic --dt 0.01,0.001 --error 0.01
says out '^for an error of 0.01 m the cheapest is method classic, rollback (selective|global), time step 0.000980392 s'
says out '^  classic: order 1.00 in the time step, from 2 points'
says out "It's a .throw. of 50%"
exits 0 converge throw.lua $classic --dt 0.01,0.001 --quantity velocity
says out 'order none: all errors are those of rounding'
exits 0 converge throw.lua $classic --dt 0.001 --param wrong=0.5
says out 'mind .* at the start the reference is 0.5 m away'

# What fails is told, and is not the end; nothing but failures is.
exits 0 converge throw.lua $classic --dt 0.01,0.001 --param limit=0.005
says out 'classic +0.00833333  failed: throw.lua:5: too coarse'
says out 'classic +0.000980392 +2.45e-03'
exits 65 converge throw.lua $classic --dt 0.01 --param limit=0.005
says out 'no error of position is available'
# a first setting that takes longer than all of the budget
long_scene >long.lua
exits 76 converge long.lua --methods classic --dt 0.00001 --budget 0.5
says out 'too long: ended after'

# What a reference says is looked at before it is believed.
for said in 'return 1:must return a table' 'return { bal = {} }:no body is called .bal.' 'return { ball = 1 }:must be a table' \
	'return { ball = { place = {0, 0, 0} } }:unknown key .place.' 'return { ball = { position = {0, 0, 0/0} } }:finite' \
	'return { ball = { orientation = {1, 1, 0, 0} } }:length 1' 'error("mine"):mine'; do
	sed -e '/^reference/,$d' throw.lua >said.lua
	echo "reference(function(t) ${said%:*} end)" >>said.lua
	exits 65 converge said.lua --methods classic --dt 0.01 --json
	grep -q "failed.*said.lua.*${said#*:}" out || fail "reference with '${said%:*}': $(cat out)"
done

# Without a reference of its own a scene is measured against finer runs. Two balls' fall, before they land.
small_scene >small.lua
exits 0 converge small.lua --methods classic --dt 0.01,0.003,0.001 --duration 0.1 --error 1e-3 --json --budget 20
python3 - <<'END' || fail "a converged run does not serve as a reference"
import json
r = json.load(open("out"))
assert r["reference"]["kind"] == "run" and r["reference"]["agrees"], r["reference"]
assert r["reference"]["error"] < 1e-4 and not r["reference"]["diverges"], r["reference"]
assert abs(r["methods"][0]["order"] - 1) < 0.2, r["methods"]
END
# A gas of hard balls forgets where it came from: no order, and errors up to a horizon.
cat >gas.lua <<'END'
world { duration = 8, time_step = 1 / 60 }
local m = material { restitution = 1, friction = 0, density = 1000 }
for _, n in ipairs { {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1} } do
	plane { normal = n, position = -0.5 * vec3(n[1], n[2], n[3]), material = m }
end
for i = 0, 26 do
	sphere { radius = 0.1, position = {0.3 * (i % 3 - 1), 0.3 * (i // 3 % 3 - 1), 0.3 * (i // 9 - 1)}, material = m,
		velocity = {math.cos(i), math.sin(2 * i), math.cos(3 * i)} }
end
END
exits 0 converge gas.lua --methods classic --dt 0.01,0.002 --budget 10 --runs 1
says out 'finer steps or rounding do not lead to one answer'
says out 'order none: refining does not lead to one answer'

# Files: by their endings, whole or not at all, never over another one without --force.
exits 0 converge throw.lua $classic --dt 0.01,0.001 -o report.csv
[ "$(wc -l <report.csv)" -eq 5 ] && [ "$(sed 's/[^,]//g' report.csv | sort -u | wc -l)" -eq 1 ] || fail "report.csv is no table"
exits 73 converge throw.lua $classic --dt 0.01 -o report.csv
says err 'exists'
exits 0 converge throw.lua $classic --dt 0.01 -o report.csv --force
[ "$(wc -l <report.csv)" -eq 3 ] || fail "--force did not replace the report"
exits 0 converge throw.lua $classic --dt 0.01 -o report.json
python3 -c 'import json; assert len(json.load(open("report.json"))["rows"]) == 2' || fail "report.json is not the report"
exits 64 converge throw.lua -o report.pdf
exits 73 converge throw.lua $classic --dt 0.01 -o nowhere/report.csv
says_nothing out # refused before anything runs
ls ./*.partial* >/dev/null 2>&1 && fail "partial files stay"

# Without gnuplot: the table goes on, a picture is refused before anything runs.
real=$RBSIM
mkdir empty
printf '#!/bin/sh\nPATH=%s exec %s "$@"\n' "$TMPDIR/empty" "$real" >without
printf '#!/bin/sh\nPATH=%s:$PATH exec %s "$@"\n' "$TMPDIR/broken" "$real" >with
chmod +x without with
RBSIM=$TMPDIR/without
exits 0 converge throw.lua $classic --dt 0.01
says out 'no picture: .*gnuplot'
exits 69 converge throw.lua $classic --dt 0.01 -o report.svg
says err "there is no 'gnuplot'"
says_nothing out
mkdir broken
printf '#!/bin/sh\necho "line 0: no such terminal" >&2\nexit 1\n' >broken/gnuplot
chmod +x broken/gnuplot
RBSIM=$TMPDIR/with
exits 69 converge throw.lua $classic --dt 0.01 -o report.svg
says err 'no such terminal'
[ -e report.svg ] && fail "half a picture stays"
RBSIM=$real

# The command line
exits 64 converge throw.lua --methods classic,fast
says err "'fast' is not one of: classic"
exits 64 converge throw.lua --dt 0.01,zero
exits 64 converge throw.lua --dt 0.01,0
exits 64 converge throw.lua --dt 0.01,0.001 --tolerance 1e-6
exits 64 converge throw.lua --time-step 0.01
exits 64 throw.lua --dt 0.01
exits 64 converge
exits 0 converge throw.lua --methods classic --tolerance 1e-6,1e-7 --runs 1
says out 'tolerance'
echo 'sphere { raduis = 1 }' >bad.lua
exits 65 converge bad.lua --json
[ "$(value exit_status)" = 65 ] || fail "a refusal is not told as JSON"

command -v gnuplot >/dev/null || { echo "no gnuplot: pictures are not looked at"; exit 77; }
exits 0 converge throw.lua $classic --dt 0.01,0.001 --param limit=0.005
says out 'X'
says out '1e-0[0-9] [|+]'
exits 0 converge throw.lua $classic --dt 0.01,0.001 -o report.svg
says report.svg '</svg>'
says report.svg 'classic-global'
says report.svg 'wall time'
exits 0 converge throw.lua $classic --dt 0.01,0.001 -o report.png
[ "$(head -c 4 report.png | tail -c 3)" = PNG ] || fail "report.png is no PNG"
# an error of 0 has a place on the logarithmic axis
cat >rest.lua <<'END'
world { duration = 0.1, gravity = {0, 0, 0} }
sphere { name = "ball", radius = 0.1, position = {0, 0, 0} }
reference(function(t) return { ball = { position = vec3(0, 0, 0) } } end)
END
exits 0 converge rest.lua --methods classic --dt 0.01 --runs 1
says out 'left edge: error 0'
says out 'A'
