#!/bin/sh
# SPDX-License-Identifier: MIT
# Heaps, piles and stacks by steps: do they stand, and what does the way there cost?
. "$(dirname "$0")/functions"
case ${HEAP_DIR:-/} in
/*) ;;
*) HEAP_DIR=$TOP/$HEAP_DIR ;;
esac

for e in 0 0.5; do
	# a run that gives up is a result too, and says so as its status
	run "$SCENES/heap.lua" --param e=$e --no-record --threads 1 || [ -s out ] || continue
	result "heap of 100, e = $e" "status" "$(value status)" ""
	result "heap of 100, e = $e" "fastest ball at the end" "$(calc "$(measured "the heap is at rest")")" m/s \
		"$(calc 9.81/240)"
	result "heap of 100, e = $e" "largest overlap over tolerance" \
		"$(calc "$(value max_penetration) / $(value tolerance)")" "" 1
	result "heap of 100, e = $e" "rollbacks" "$(value rollbacks)" ""
	result "heap of 100, e = $e" "discarded of all body-steps" "$(calc "100 * $(value discarded_body_steps) / \
		($(value body_steps) + $(value discarded_body_steps))")" "%"
	result "heap of 100, e = $e" "body-steps over those asked for" "$(calc "$(value body_steps) / ($(value bodies) * \
		$(value duration) / $(value time_step))")" ""
	result "heap of 100, e = $e" "clusters ended without restitution" "$(value plastic_ends)" ""
	result "heap of 100, e = $e" "smallest step" "$(calc "$(value smallest_step)")" s
	result "heap of 100, e = $e" "time" "$(calc "$(value wall_time)")" s
done

# mean FILE: of the overlaps of all contacts in a recording, over r
mean()
{
	/usr/bin/python3 - "$1" <<-'END' 2>mean-err || echo "unknown"
		import sys
		import h5py
		gap = h5py.File(sys.argv[1], "r")["/rbsim/contacts/gap"][()]
		print("%.3g" % (gap.clip(max=0).mean() / -0.5 if len(gap) else 0))
	END
}

# pile SHAPE SIDE LAYERS THREADS TOLERANCE STEPS: the stepped method on a falling lattice; nanoseconds for each body and
# step, over the tolerance in radii
pile()
{
	spent >began
	run "$BENCH_SCENES/pile.lua" --method stepped --param shape="$1" --param side="$2" --param layers="$3" \
		--param steps="$6" --tolerance "$(calc "0.5 * $5")" -o pile.h5 --force --threads "$4" || [ -s out ] || return 0
	name="pile of $(value bodies), $1, $4 thread(s), tolerance $5 r, $6 steps"
	spent >ended
	processor=$(calc "1e9 * ($(cat ended) - $(cat began)) / $(value body_steps)")
	cost=$(calc "1e9 * $(value wall_time) / $(value body_steps)") deepest=$(calc "$(value max_penetration) / 0.5")
	mean=$(mean pile.h5)
	result "$name" "status" "$(value status)" ""
	result "$name" "time per body-step" "$cost" ns
	result "$name" "body-steps per second" "$(calc "$(value body_steps) / $(value wall_time)")" "1/s"
	result "$name" "largest overlap over r" "$deepest" "" "$5"
	result "$name" "mean overlap of contacts over r" "$mean" ""
	result "$name" "sweeps of each contact" "$(calc "$(value row_sweeps) / $(value contact_rows)")" ""
	result "$name" "factorizations" "$(value factorizations)" ""
	result "$name" "residual over the tolerance" "$(calc "$(value residual) / $(value tolerance)")" "" 1
	echo "$cost $deepest $mean" >>"points.$1.$2.$4"
}

# HEAP_DIR=folder (from the top of the sources) keeps the diagram: error against time over the tolerance, beside what other
# engines reach on this heap with 10,000 spheres, measured on a machine like this one
draw()
{
	gnuplot <<-END
		set terminal svg size 800,560 font "sans,13" background "white"
		set output "$HEAP_DIR/heap.svg"
		set logscale xy
		set format "10^{%L}"
		set xlabel "time of one body in one step, ns (one thread)"
		set ylabel "overlap, radii"
		set grid
		set key below
		\$others << EOD
		2290 0.119 Box3D
		3340 0.091 Rapier f32
		4050 0.097 Rapier f64
		5020 0.022 Bullet
		4050 0.0098 ODE
		4600 0.040 Jolt
		14800 0.017 MuJoCo
		EOD
		plot "points.sphere.10.1" using 1:2 with linespoints pt 7 lc 1 title "1,000 spheres, deepest", \
			"" using 1:3 with linespoints pt 6 lc 1 title "mean of contacts", \
			"points.sphere.32.1" using 1:2 with linespoints pt 7 lc 2 title "10,240 spheres, deepest", \
			"points.box.10.1" using 1:2 with linespoints pt 5 lc 3 title "1,000 boxes, deepest", \
			"" using 1:3 with linespoints pt 4 lc 3 title "mean of contacts", \
			\$others using 1:2 with points pt 2 lc 0 title "others, 10,000 spheres", \
			\$others using 1:2:3 with labels offset 1,0.7 left notitle
	END
}

for tolerance in 1e-2 1e-3 1e-4 1e-5 1e-6; do
	pile sphere 10 10 1 $tolerance 600
	pile box 10 10 1 $tolerance 300
done
for tolerance in 1e-2 1e-3 1e-4; do
	pile sphere 32 10 1 $tolerance 600
done
pile sphere 10 10 2 1e-2 600
pile sphere 32 10 2 1e-2 600
pile box 10 10 2 1e-2 300
for tolerance in 1e-2 1e-4; do
	pile turned 10 10 1 $tolerance 960
	pile turned 25 8 1 $tolerance 960
done
pile box 32 10 1 1e-2 60
pile box 32 10 2 1e-2 60
[ -z "${HEAP_DIR-}" ] || draw
# HEAP_BASE=program: an earlier version on the same machine; what 1e-6 r costs over its 1e-2 r, processor time
if [ -n "${HEAP_BASE-}" ]; then
	now=$RBSIM
	pile sphere 10 10 1 1e-6 600
	fine=$processor
	echo "$BENCH: '$HEAP_BASE'" >&2
	RBSIM=$HEAP_BASE
	pile sphere 10 10 1 1e-2 600
	coarse=$processor
	pile sphere 10 10 1 1e-6 600
	RBSIM=$now
	result "pile of 1000, sphere" "time at 1e-6 r over the base's" "$(calc "$fine / $processor")" "" 1
	result "pile of 1000, sphere" "time at 1e-6 r over the base's at 1e-2 r" "$(calc "$fine / $coarse")" "" 4.35
fi
# 100,000, of which the falling and the first impacts are in this many steps
pile sphere 100 10 1 1e-2 200
pile sphere 100 10 2 1e-2 200
pile box 100 10 2 1e-2 40
# the same height on a floor that grows: how the time grows with the number of bodies
for side in 8 16 32 64; do
	pile sphere $side 4 1 1e-2 600
	echo "$(value bodies) $(value wall_time)" >>growth
done
result "piles of 4 layers" "exponent of growth" "$(fit growth)" "" 1.1
# a cube that grows, where impulses go through all layers
for side in 5 10 20 40; do
	pile sphere $side $side 1 1e-2 $((200 + 10 * side))
	echo "$(value bodies) $(calc "$(value wall_time) / $(value body_steps)")" >>cube
done
result "growing cube" "exponent of the time of a body-step" "$(fit cube)" ""

for count in 2 5 10; do
	for ratio in 1e3 1e4 1e6; do
		for rate in 60 240; do
			run "$BENCH_SCENES/stack.lua" --method stepped --param count=$count --param ratio=$ratio \
				--param rate=$rate --no-record --threads 1 || continue
			result "stack of $count, top $ratio, 1/$rate s" "compression after 100 s" \
				"$(calc "$(measured compression)")" m 1e-6
			result "stack of $count, top $ratio, 1/$rate s" "drift after 100 s" "$(calc "$(measured drift)")" m 1e-6
			result "stack of $count, top $ratio, 1/$rate s" "time" "$(calc "$(value wall_time)")" s
		done
	done
done

run "$BENCH_SCENES/666.lua" --method stepped --no-record --threads 1 || exit 0
result "666, dt 1e-3" "sum of overlap squared" "$(calc "$(measured "sum of overlap squared, m^2")")" m^2
result "666, dt 1e-3" "RMS overlap per contact over R" "$(calc "$(measured "RMS overlap per contact over R")")" "" 1e-6
