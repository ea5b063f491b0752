#!/bin/sh
# SPDX-License-Identifier: MIT
# Gravitation: error of the place at the end against a known answer, and processor time, of two bodies on ellipses, the figure
# eight, the Pythagorean problem; the time of a pair in a cluster of 400 points, located and by steps; and the time of a step and
# body, located from 10 to 1,000 points and by steps of 10,000 and 100,000, with what the tree's sums are wrong by. With a Python that has
# the package `rebound` (PYTHON=..., python3) the same by its IAS15 (Rein and Spiegel, MNRAS 446 (2015) 1424), in its own process,
# of which only the integration is timed.
# RUNS=9 asks for more repetitions (3): of times the least is taken, and the start of the program is taken off.
. "$(dirname "$0")/functions"
RUNS=${RUNS:-3}
PYTHON=${PYTHON:-python3}

cat >case.lua <<'END'
local name = param("case", "0.5", "which", {choices = {"0.5", "0.9", "0.99", "eight", "30", "60", "70", "start"}})
local plain = material { name = "plain", friction = 0 }
local function point(mass, x, v)
	return sphere { radius = 1e-6, mass = mass, position = x, velocity = v or {0, 0, 0}, material = plain, collides_with = {} }
end
local duration, body, wanted
if name == "eight" then
	duration, wanted = 63.2591398, vec3(0.97000421375646, -0.24308766531606, 0)
	local x, v = vec3(0.97000436, -0.24308753, 0), vec3(-0.93240737, -0.86473146, 0)
	body = point(1, x, -0.5 * v)
	point(1, -1 * x, -0.5 * v)
	point(1, {0, 0, 0}, v)
elseif tonumber(name) and tonumber(name) > 1 then
	duration = tonumber(name)
	wanted = ({["30"] = vec3(0.856340498897316, 2.28709366369625, 0), ["60"] = vec3(0.743807500118, 1.939947951095, 0),
		["70"] = vec3(6.93346359901, 20.26180430595, 0)})[name]
	body = point(3, {1, 3, 0})
	point(4, {-2, -1, 0})
	point(5, {1, -1, 0})
else
	local a = ({["0.5"] = 2, ["0.9"] = 10, ["0.99"] = 100})[name] or 2
	local v = 2 * a - 1
	duration, wanted = 10 * 2 * math.pi * math.sqrt(a ^ 3 / (a * v)), vec3(0.5, 0, 0)
	if name == "start" then duration = 1e-9 end
	point(a * v / 2, {-0.5, 0, 0}, {0, -v / 2, 0})
	body = point(a * v / 2, {0.5, 0, 0}, {0, v / 2, 0})
end
world { duration = duration, frame_rate = 1 / duration, gravitation = {G = 1}, method = "located" }
expect("place", function() return (body.position - wanted):length(), 1e9 end)
END
cat >ias15.py <<'END'
import math, sys, time, rebound
name = sys.argv[1]
s = rebound.Simulation()
s.integrator = "ias15"
if name == "eight":
    end, wanted, k = 63.2591398, (0.97000421375646, -0.24308766531606), 0
    x, y, u, v = 0.97000436, -0.24308753, -0.93240737, -0.86473146
    for a, b, c, d in ((x, y, -u / 2, -v / 2), (-x, -y, -u / 2, -v / 2), (0, 0, u, v)):
        s.add(m=1, x=a, y=b, vx=c, vy=d)
elif float(name) > 1:
    end, k = float(name), 0
    wanted = {"30": (0.856340498897316, 2.28709366369625), "60": (0.743807500118, 1.939947951095),
              "70": (6.93346359901, 20.26180430595)}[name]
    for m, a, b in ((3, 1, 3), (4, -2, -1), (5, 1, -1)):
        s.add(m=m, x=a, y=b)
else:
    a = {"0.5": 2, "0.9": 10, "0.99": 100}[name]
    v = 2 * a - 1
    end, wanted, k = 10 * 2 * math.pi * math.sqrt(a ** 3 / (a * v)), (0.5, 0), 1
    s.add(m=a * v / 2, x=-0.5, vy=-v / 2)
    s.add(m=a * v / 2, x=0.5, vy=v / 2)
begin = time.process_time()
s.integrate(end, exact_finish_time=1)
took = time.process_time() - begin
p = s.particles[k]
print(math.hypot(p.x - wanted[0], p.y - wanted[1]), 1000 * took)
END

# milliseconds CASE: least processor time of some runs
milliseconds()
{
	measure "$RUNS" "$RBSIM" run case.lua --param case="$1" --no-record --threads 1 --trust --quiet >rows
	cut -d ' ' -f 2 rows | sort -g | head -n 1 | awk '{ print 1000 * $1 }'
}

start=$(milliseconds start)
other=0
"$PYTHON" -c 'import rebound' 2>/dev/null || other=$?
[ $other -eq 0 ] || echo "$BENCH: no python package 'rebound' (PYTHON names another interpreter): rbsim alone" >&2
# bars: of the pericentre at 1 m, so that the largest distances are 3, 19 and 199 m (scenes/verify/G01 to G03 derive them)
while read -r name bar; do
	run case.lua --param case="$name" --no-record --threads 1 --trust
	result "$name" "error of the place" "$(measured place)" m "$bar"
	result "$name" "time" "$(milliseconds "$name" | awk -v start="$start" '{ printf "%.2f", $1 - start }')" ms
	[ $other -eq 0 ] || continue
	for _ in $(seq "$RUNS"); do "$PYTHON" ias15.py "$name"; done | sort -g -k 2 | head -n 1 >ias15
	result "$name" "error of the place, IAS15" "$(cut -d ' ' -f 1 ias15)" m
	result "$name" "time, IAS15" "$(cut -d ' ' -f 2 ias15 | awk '{ printf "%.2f", $1 }')" ms
done <<'END'
0.5 1e-13
0.9 1e-11
0.99 1e-9
eight 1e-13
30 1e-10
60 1e-5
70 1e-4
END

cat >cloud.lua <<'END'
local n = param("n", 400, "points")
world { duration = 0.1, frame_rate = 10, time_step = 0.001, gravitation = {G = 1, softening = 0.05} }
for k = 1, n do
	sphere { radius = 1e-4, mass = 1 / n, collides_with = {}, position = {math.random(), math.random(), math.random()} }
end
END
for method in located stepped; do
	run cloud.lua --method $method --no-record --threads 1 --trust
	steps=$(value body_steps)
	measure "$RUNS" "$RBSIM" run cloud.lua --method $method --no-record --threads 1 --trust --quiet >rows
	cut -d ' ' -f 2 rows | sort -g | head -n 1 | awk -v steps="$steps" -v start="$start" \
		'{ printf "%.2f", 1e9 * ($1 - start / 1000) / steps / 400 }' >pair
	result "400 points, $method" "time of a pair in a sum" "$(cat pair)" ns
done

# time of a step and body: start and the two frames of a run of one step are taken off
while read -r method n steps bar; do
	cat >many.lua <<END_OF_SCENE
world { duration = $steps * 1e-5, frame_rate = 1 / ($steps * 1e-5), time_step = 1e-5, gravitation = {G = 1, softening = 0.05} }
for k = 1, $n do
	sphere { radius = 1e-4, mass = 1 / $n, collides_with = {}, position = {math.random(), math.random(), math.random()} }
end
END_OF_SCENE
	sed "s/$steps \* 1e-5/1 * 1e-5/g" many.lua >one.lua
	for scene in one many; do
		run $scene.lua --method "$method" --no-record --threads 1 --trust
		value body_steps >$scene.steps
		measure "$RUNS" "$RBSIM" run $scene.lua --method "$method" --no-record --threads 1 --trust --quiet >rows
		cut -d ' ' -f 2 rows | sort -g | head -n 1 >$scene.time
	done
	took=$(paste many.time one.time many.steps one.steps | awk '{ printf "%.3g", 1e6 * ($1 - $2) / ($3 - $4) }')
	result "$n points, $method" "time of a step and body" "$took" us "$bar"
	[ "$method" = located ] || result "$n points, $method" "largest error of 64 accelerations" "$(value gravitation_error)" "" 1e-2
done <<'END'
located 10 1000000
located 100 100000
located 1000 20000
stepped 10000 21
stepped 100000 5 2.5
END
