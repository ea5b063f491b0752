#!/bin/sh
# SPDX-License-Identifier: MIT
# Chains of 1, 2, 10 and 100 hinged links, let go from the horizontal: error of the free end after some time, and processor time
# for a simulated second, located and by steps. With a Python that has `mujoco`, `numpy` and `scipy` (PYTHON=..., python3) the same
# by MuJoCo's RK4 and its default (semi-implicit Euler), in its own process, of which only the steps are timed. The reference is
# independent of both: angles of a plane chain (mass matrix from sums of lengths), by DOP853 at a tolerance of 1e-13.
# With gnuplot OUT=links.png draws error against time. RUNS=9 asks for more repetitions (3), of which the least
# counts; CHAINS='10 1' for one chain of 10 links and a second.
RUNS=${RUNS:-3}
PYTHON=${PYTHON:-python3}
case ${OUT:=} in '' | /*) ;; *) OUT=$PWD/$OUT ;; esac
. "$(dirname "$0")/functions"
# threads of its linear algebra would wait for each other
export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1

cat >chain.lua <<'END'
local n = param("links", 1, "of the chain", {min = 1})
local seconds = param("seconds", 1.0, "simulated", {min = 0})
local h = param("h", 0.001, "step, s", {min = 0})
local long = 2 / math.max(n, 4)
world { duration = seconds, frame_rate = 1 / seconds, gravity = {0, 0, -9.81}, time_step = math.min(h, seconds) }
local last
for k = 1, n do
	local link = box { size = {long, long / 10, long / 10}, mass = 1, position = {(k - 0.5) * long, 0, 0}, collides_with = {} }
	joint { kind = "hinge", a = link, b = last, at = {(k - 1) * long, 0, 0}, axis = {0, 1, 0} }
	last = link
end
local function wanted() return vec3(param("x", 0.0, "m, of the free end"), 0, param("z", 0.0, "m, of the free end")) end
local there = wanted()
expect("place", function() return (last.point({long / 2, 0, 0}) - there):length(), 1e9 end)
END

cat >links.py <<'END'
import math, sys, time
import numpy as np

def reference(n, seconds):
    from scipy.integrate import solve_ivp
    l, g = 2 / max(n, 4), 9.81
    c, inertia = l / 2, (l * l + (l / 10) ** 2) / 12
    i = np.arange(n)
    beyond = n - 1 - np.maximum.outer(i, i)
    a = l * l * beyond + l * c
    a[i, i] = l * l * (n - 1 - i) + c * c + inertia
    weight = g * (l * (n - 1 - i) + c)
    def rate(t, y):
        angle, speed = y[:n], y[n:]
        d = np.subtract.outer(angle, angle)
        force = -(a * np.sin(d)) @ speed ** 2 - weight * np.cos(angle)
        return np.concatenate([speed, np.linalg.solve(a * np.cos(d), force)])
    y = solve_ivp(rate, (0, seconds), np.zeros(2 * n), method="DOP853", rtol=1e-13, atol=1e-14).y[:n, -1]
    return l * np.cos(y).sum(), l * np.sin(y).sum()

def mujoco_case(n, seconds, integrator, h, x, z):
    import mujoco
    l = 2 / max(n, 4)
    xml = '<mujoco><option integrator="%s" timestep="%.17g"><flag contact="disable"/></option><worldbody>' % (integrator, h)
    for k in range(n):
        xml += '<body pos="%.17g 0 0"><joint type="hinge" axis="0 1 0"/><geom type="box" mass="1" pos="%.17g 0 0" size="%.17g %.17g %.17g"/>' % (
            l if k else 0, l / 2, l / 2, l / 20, l / 20)
    xml += '<site name="end" pos="%.17g 0 0"/>' % l + "</body>" * n + "</worldbody></mujoco>"
    model = mujoco.MjModel.from_xml_string(xml)
    least = math.inf
    for _ in range(3):
        data = mujoco.MjData(model)
        begin = time.process_time()
        mujoco.mj_step(model, data, nstep=round(seconds / h))
        least = min(least, time.process_time() - begin)
    mujoco.mj_kinematics(model, data)
    p = data.site("end").xpos
    return math.hypot(p[0] - x, p[2] - z), 1000 * least / seconds

if sys.argv[1] == "reference":
    print("%.17g %.17g" % reference(int(sys.argv[2]), float(sys.argv[3])))
else:
    print("%.3g %.4g" % mujoco_case(int(sys.argv[2]), float(sys.argv[3]), sys.argv[1], *map(float, sys.argv[4:7])))
END

# row LINKS SECONDS METHOD STEP X Z: error, m, and milliseconds for a simulated second
row()
{
	set -- "$@" chain.lua --param links="$1" --param h="$4" --param x="$5" --param z="$6" --method "$3" --no-record --threads 1 --trust
	seconds=$2
	shift 6
	error=$("$RBSIM" run "$@" --param seconds="$seconds" --json 2>err | grep -o '"measured":[0-9.e+-]*' | cut -d : -f 2)
	for case in "$seconds" 0.000001; do
		measure "$RUNS" "$RBSIM" run "$@" --param seconds="$case" --quiet >rows
		cut -d ' ' -f 2 rows | sort -g | head -n 1
	done | paste -s -d ' ' - | awk -v error="${error:-nan}" -v s="$seconds" '{ printf "%.3g %.4g\n", error, 1000 * ($1 - $2) / s }'
}

"$PYTHON" -c 'import numpy, scipy' 2>/dev/null || {
	echo "$BENCH: numpy and scipy are needed for the reference (PYTHON=$PYTHON)" >&2
	exit 0
}
: >table
while read -r links seconds; do
	place=$("$PYTHON" links.py reference "$links" "$seconds")
	x=${place% *} z=${place#* }
	echo "$links rbsim-located - $(row "$links" "$seconds" located 0.001 "$x" "$z")" >>table
	for h in 0.004 0.001 0.00025; do
		echo "$links rbsim-stepped $h $(row "$links" "$seconds" stepped $h "$x" "$z")" >>table
	done
	"$PYTHON" -c 'import mujoco' 2>/dev/null || continue
	for integrator in RK4 Euler; do
		for h in 0.004 0.001 0.00025 0.00005; do
			echo "$links mujoco-$integrator $h $("$PYTHON" links.py $integrator "$links" "$seconds" $h "$x" "$z")" >>table
		done
	done
done <<END
${CHAINS:-1 5
2 3
10 1
100 0.2}
END
while read -r links program step error time; do
	result "$links links, $program, step $step" 'error of the free end' "$error" m
	result "$links links, $program, step $step" 'processor time for a simulated second' "$time" ms
done <table
# a point of MuJoCo that has both less error and less time than a point of rbsim beats it
awk '$2 ~ /^mujoco/ { for (k in e) if (split(k, name, SUBSEP) && name[1] == $1 && $4 < e[k] && $5 < t[k]) print $1 " links, " \
	name[2] " " name[3] " by " $2 " " $3 } $2 ~ /^rbsim/ { e[$1, $2, $3] = $4; t[$1, $2, $3] = $5 }' table | tee beaten >&2
grep -q mujoco table && result 'all links' 'points of rbsim and MuJoCo of which that of MuJoCo has less error and less time' \
	"$(wc -l <beaten)" '' 0
[ -n "$OUT" ] && command -v gnuplot >/dev/null || exit 0
{
	echo "set terminal pngcairo size 1200,900; set output '$OUT'; set multiplot layout 2,2; set logscale xy; set format '%.0e'"
	echo "set xlabel 'processor time, ms per simulated second'; set ylabel 'error of the free end, m'; set key bottom left"
	for n in 1 2 10 100; do
		echo "set title '$n hinged links'"
		for name in rbsim-located rbsim-stepped mujoco-RK4 mujoco-Euler; do
			awk -v n=$n -v name=$name '$1 == n && $2 == name { print $5, ($4 > 1e-16 ? $4 : 1e-16) }' table >"$n-$name"
			[ -s "$n-$name" ] && printf "'%s' with linespoints pointsize 1.5 title '%s', " "$n-$name" $name
		done | sed 's/^/plot /'
		echo
	done
} >plot
gnuplot plot
