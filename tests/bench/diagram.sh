#!/bin/sh
# SPDX-License-Identifier: MIT
# Error against time of heaps and a hopper by steps, beside other engines: is one of them below and left of the curve? Theirs, in
# `others`, were measured with the same scenes on one machine, on which a sphere of the heap took 690 ns at 1e-2 r: times of
# this one are taken relative to that. Processor time, one thread. DIAGRAM_DIR=folder (from the top of the sources) keeps
# diagram.svg, SCALE=0.2 runs shorter.
. "$(dirname "$0")/functions"
SCALE=${SCALE:-1}

# ns a body-step, deepest overlap in r (spheres: of 10,000; of cubes and hopper it is not known: whatever 1e-2 r costs), name
cat >others.spheres <<'END'
1190 0.03 Box3D
1940 0.097 Rapier
2065 0.0098 ODE
2146 0.040 Jolt
2160 0.022 Bullet
END
cat >others.cubes <<'END'
1236 0.01 Box3D
2940 0.01 Rapier
3160 0.01 Jolt
3990 0.01 ODE
END
cat >others.hopper <<'END'
2390 0.01 Box3D
2420 0.01 ODE
3050 0.01 Jolt
END

# point NAME TOLERANCE RADIUS ARGUMENT...: a row `ns overlap tolerance` of curve.NAME
point()
{
	name=$1 tolerance=$2 radius=$3
	shift 3
	spent >before
	run "$@" --method stepped --tolerance "$(calc "$radius * $tolerance")" --no-record --no-render --threads 1 ||
		[ -s out ] || return 0
	spent >after
	ns=$(awk -v bodies="$(value body_steps)" '{ t[NR] = $1 } END { printf "%.4g", 1e9 * (t[2] - t[1]) / bodies }' before after)
	deepest=$(calc "$(value max_penetration) / $radius")
	result "$name, $tolerance r" "time per body-step" "$ns" ns
	result "$name, $tolerance r" "largest overlap over r" "$deepest" "" "$tolerance"
	echo "$ns $deepest $tolerance" >>"curve.$name"
}

for tolerance in 1e-1 1e-2 1e-3 1e-4 1e-5 1e-6; do
	point spheres "$tolerance" 0.5 "$BENCH_SCENES/pile.lua" --param side=10 --param layers=10 --param steps=600
done
for tolerance in 1e-1 1e-2 1e-4 1e-6; do
	point cubes "$tolerance" 0.5 "$BENCH_SCENES/pile.lua" --param shape=turned --param side=10 --param layers=10 \
		--param steps="$(calc "int(960 * $SCALE)")"
	point hopper "$tolerance" 0.1 "$SCENES/hopper.lua" --param n=1000 --param seconds="$(calc "3 * $SCALE")"
done

# 1e-2 r of spheres here, over the 690 ns there
factor=$(awk '$3 == "1e-2" { print $1 / 690 }' curve.spheres)
result "this machine" "time over the other one's" "$factor" ""

# ratio NAME NS OVERLAP: what this overlap costs by steps, over NS there; between points of the curve straight in logarithms
ratio()
{
	awk -v ns="$2" -v factor="$factor" -v overlap="$3" '
		{ x[NR] = log($2); y[NR] = log($1); n = NR }
		END {
			at = log(overlap); cost = y[1]
			for (k = 2; k <= n && at < x[k - 1]; k++)
				cost = at < x[k] ? y[k] : y[k - 1] + (y[k] - y[k - 1]) * (at - x[k - 1]) / (x[k] - x[k - 1])
			printf "%.3g", exp(cost) / (ns * factor)
		}' "curve.$1"
}
for scene in "spheres 1" "cubes 1.3" "hopper 2.5"; do
	name=${scene% *}
	while read -r ns overlap engine; do
		result "$name" "time over $engine's at its overlap" "$(ratio "$name" "$ns" "$overlap")" "" "${scene#* }"
	done <"others.$name"
done

[ -n "${DIAGRAM_DIR-}" ] && command -v gnuplot >/dev/null || exit 0
case $DIAGRAM_DIR in /*) ;; *) DIAGRAM_DIR=$TOP/$DIAGRAM_DIR ;; esac
gnuplot <<END
set terminal svg size 800,560 font "sans,13" background "white"
set output "$DIAGRAM_DIR/diagram.svg"
set logscale xy
set format "10^{%L}"
set xlabel "time of one body in one step, ns (one thread)"
set ylabel "deepest overlap, radii"
set grid
set key below
plot for [k=1:3] "curve.".word("spheres cubes hopper", k) using 1:2 with linespoints pt 7 lc k title word("spheres cubes hopper", k), \
	for [k=1:3] "others.".word("spheres cubes hopper", k) using (\$1 * $factor):2 with points pt 2 lc k notitle, \
	for [k=1:3] "others.".word("spheres cubes hopper", k) using (\$1 * $factor):2:3 with labels offset 1,0.7 left notitle
END
