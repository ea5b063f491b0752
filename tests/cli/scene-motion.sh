#!/bin/sh
# SPDX-License-Identifier: MIT
# Functions of time that drive bodies: wraps and kinks are followed, jumps and contradictions refused, by every method.
. tests/cli/functions

cat >motion.lua <<'END'
local kind = param("kind", "wrap", "which function")
local given = param("given", true, "with velocities")
local most = param("most", 1e9, "calls of it in the whole run")
local calls = 0
world { duration = 2, gravity = {0, 0, -9.81}, time_step = 1e-2, frame_rate = 10 }
local stuff = material { name = "stuff", friction = 0.5, restitution = 0 }
local c, s = math.cos, math.sin
local functions = {
	wrap = function(t) return {0, 0, 0}, {axis = {0, 0, 1}, angle = 9 * t % (2 * math.pi)}, {0, 0, 0}, {0, 0, 9} end,
	flip = function(t)
		local side = math.floor(7 * t) % 2 == 0 and 1 or -1
		return {0, 0, 0}, {side * c(4.5 * t), 0, 0, side * s(4.5 * t)}, {0, 0, 0}, {0, 0, 9}
	end,
	fast = function(t) return {0, 0, 0}, {axis = {0, 0, 1}, angle = 300 * t}, {0, 0, 0}, {0, 0, 300} end,
	jump = function(t) return {t < 1.2345 and 0 or 0.02, 0, 0}, nil, {0, 0, 0} end,
	late = function(t) return {0, 0, t <= 1.2 and 0 or -0.02}, nil, {0, 0, 0} end,
	once = function(t) return {t > 0 and 0.1 or 0, 0, 0}, nil, {0, 0, 0} end,
	belt = function(t) return {t % 1, 0, 0}, nil, {1, 0, 0} end,
	turn = function(t) return {0, 0, 0}, {axis = {0, 0, 1}, angle = t < 1 and 0 or 1}, {0, 0, 0}, {0, 0, 0} end,
	kink = function(t) return {0, 0, 0.2 * math.max(t - 1.2345, 0)}, nil, {0, 0, t < 1.2345 and 0 or 0.2} end,
	saw = function(t)
		local u = t % 0.5
		return {0, 0, 0.05 * math.min(u, 0.5 - u)}, nil, {0, 0, u < 0.25 and 0.05 or -0.05}
	end,
	wrong = function(t) return {0, 0, 0.02 * s(5 * t)}, nil, {0, 0, 0.1001 * c(5 * t)} end,
	spins = function(t) return {0, 0, 0}, {axis = {0, 0, 1}, angle = 3 * t}, {0, 0, 0}, {0, 0, 2} end,
	right = function(t) return {0, 0, 0.02 * s(5 * t)}, nil, {0, 0, 0.1 * c(5 * t)} end,
	some = function(t) return {0, 0, 0}, nil, t < 1 and {0, 0, 0} or nil end,
	nan = function(t) return {0, 0, t > 1 and 0/0 or 0}, nil, {0, 0, 0} end,
	short = function(t) return t > 1 and {0, 0} or {0, 0, 0}, nil, {0, 0, 0} end,
}
plane { name = "floor", material = stuff, motion = function(t)
	local x, q, v, w = functions[kind](t)
	calls = calls + 1
	if given then return x, q, v, w end
	return x, q
end }
local ball = sphere { radius = 0.1, position = {0, 0, 0.1}, material = stuff }
expect("it is asked a few times a step", function() return calls, most end)
expect("it rests on the floor", function()
	local x = functions[kind](time())
	return math.abs(ball.position.z - 0.1 - x[3]), 1e-3
end)
END

for method in located stepped auto; do
	for given in true false; do
		run="motion.lua --no-record --method $method --param given=$given --param"
		for kind in wrap flip fast kink saw right; do
			exits 0 $run kind=$kind
		done
		for kind in jump late once belt turn; do
			exits 65 $run kind=$kind
			says err "motion.lua:[0-9]+: 'motion' of 'floor' jumps by [0-9.]+ (m|rad) at t = [0-9]"
		done
		for kind in nan short; do
			exits 65 $run kind=$kind
			says err "'motion' must return a finite position"
		done
	done
	# what is smooth is not looked at closely: three times in each of 200 steps; pieces of the exact method, ten and more
	most=600
	[ $method = stepped ] || most=2000
	for given in true false; do
		exits 0 motion.lua --no-record --method $method --param given=$given --param kind=right --param most=$most
	done
	run="motion.lua --no-record --method $method --param"
	exits 65 $run kind=jump
	says err 'jumps by 0.02 m at t = 1.2345 s'
	exits 65 $run kind=wrong
	says err "'motion' of 'floor' at t = [0-9.]+ s: its velocity is [0-9.e-]+ m/s off"
	exits 65 $run kind=spins
	says err "its angular velocity is .* rad/s off what leads from one orientation to the next"
	exits 65 $run kind=some
	says err "'motion' must return a velocity always or never"
done

# a pendulum whose pivot shakes up and down, so fast that steps are cut: parts of a step add up to it, without rests of
# rounding (2e-18 s) beside them, from which joints would learn what is noise
cat >shaken.lua <<'END'
local g, l, amp, w = 9.81, 0.2, 0.02, 250
world { duration = 0.3, gravity = {0, 0, -g} }
local function shake(t) return {0, 0, amp * math.cos(w * t)}, nil, {0, 0, -amp * w * math.sin(w * t)} end
local pivot = sphere { radius = 0.005, collides_with = {}, motion = shake }
local bob = sphere { radius = 0.01, mass = 1, position = {l * math.sin(0.3), 0, amp + l * math.cos(0.3)} }
joint { kind = "hinge", a = bob, b = pivot, at = {0, 0, amp}, axis = {0, 1, 0} }
expect("it stays upright", function() return l * math.cos(0.35) - (bob.position.z - pivot.position.z), 0 end)
END
exits 0 shaken.lua --no-record --method stepped --time-step 1e-2 --json
smallest=$(sed 's/.*"smallest_step":\([^,]*\),.*/\1/' out)
awk -v h="$smallest" 'BEGIN { exit !(h > 2e-12) }' || fail "the smallest step is $smallest s"
