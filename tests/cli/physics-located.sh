#!/bin/sh
# SPDX-License-Identifier: MIT
# tests/scenes/stress.lua with a few draws and the default method: runs end, stay finite and within the tolerance. Where
# all of it is located, either rollback gives the same bits.
. tests/cli/functions

run()
{
	timeout "$PATIENCE" "$RBSIM" "$TOP/tests/scenes/stress.lua" --no-record --json --quiet "$@" >out 2>err </dev/null
	got=$?
	[ $got -ne 124 ] || fail "rbsim stress.lua $*: no end within 100 s"
	[ $got -eq 0 ] || fail "rbsim stress.lua $*: exit status $got"
}

# DRAW COUNT
draws='1,1 2,2 4,1 1,5 2,5 6,5' more='1 2 3 5 9'
[ "${RBSIM_MODE:-release}" = release ] || draws='1,1 2,5' more='3 9'
for draw in $draws; do
	# shellcheck disable=SC2086
	set -- "${draw%,*}" "${draw#*,}"
	run --method located --rollback selective --param k="$1" --param count="$2"
	hash=$(value state_hash)
	[ ${#hash} -eq 16 ] || fail "no state hash"
	run --method located --rollback global --param k="$1" --param count="$2"
	[ "$(value state_hash)" = "$hash" ] || fail "k = $1: rollback global ends in another state than selective"
done
for k in $more; do
	run --param k=$k
done

# a pile that is located to its end: no contact is left to drift into another, however many things happen at one moment
cat >pile.lua <<'LUA'
world { duration = 0.6, gravity = {0, 0, -9.81}, frame_rate = 60, method = "located" }
local m = material { name = "m", density = 1000, friction = 0.5, restitution = 0.1 }
plane { normal = {0, 0, 1}, material = m }
for i = 0, 39 do
	sphere { radius = 0.05, material = m,
		position = {0.102 * (i % 3) + 0.0001 * i, 0.102 * (i // 3 % 3), 0.06 + 0.11 * (i // 9)} }
end
LUA
exits 0 pile.lua --no-record --json --quiet
deepest=$(value max_penetration)
awk -v d="$deepest" 'BEGIN { exit !(d < 1e-14) }' || fail "bodies of a pile overlap by $deepest m"

# boxes that fall turning are too dense to locate: auto leaves them to steps, whatever acts on them
cat >crowd.lua <<'LUA'
local kind = param("kind", "drag", "what acts", {choices = {"drag", "field", "spring", "motion"}})
world { duration = 0.3, frame_rate = 20, gravity = {0, 0, kind == "field" and 0 or -9.81}, time_step = 1 / 240, seed = 3 }
local m = material { name = "m", friction = 0.5, restitution = 0.3 }
if kind == "motion" then
	box { size = {1, 1, 0.2}, material = m, motion = function(t) return {0.2, 0.2, -0.1 + 0.01 * math.sin(60 * t)} end }
else
	plane { normal = {0, 0, 1}, material = m }
end
local first
for z = 0, 3 do for y = 0, 3 do for x = 0, 2 do
	local b = box { size = {0.1, 0.1, 0.1}, mass = 1, material = m, position = {0.13 * x, 0.13 * y, 0.1 + 0.13 * z},
		angular_velocity = {math.random(), math.random(), math.random()} }
	if kind == "spring" and first then spring { a = first, b = b, stiffness = 1, damping = 0.1 } end
	first = first or b
end end end
if kind == "drag" then drag { linear = 0.1 } end
if kind == "field" then field(function(_, x) return {0, 0, -9.81 - x.x} end) end
LUA
for kind in drag field spring motion; do
	exits 0 crowd.lua --param kind=$kind --no-record --json --quiet
	stepped=$(value stepped)
	awk -v s="$stepped" 'BEGIN { exit !(s > 0 && s < 0.3) }' || fail "boxes, $kind: stepped $stepped s of 0.3"
done
exits 0 check crowd.lua --no-record
says out '^  crowds +too dense to locate are left to steps'

# but a pair is no crowd, however often it collides within a time step, nor is what stands, however many its pieces
exits 0 "$TOP/scenes/verify/S10_galperin.lua" --param k=3 --param zero_field=true --time-step 1 --no-record --json --quiet
[ "$(value stepped)" = 0 ] || fail "3141 impacts of a pair: stepped $(value stepped) s"
cat >tower.lua <<'LUA'
world { duration = 1, frame_rate = 1, gravity = {0, 0, -9.81} }
local m = material { name = "m", friction = 0.5, restitution = 0 }
plane { normal = {0, 0, 1}, material = m }
for k = 0, 39 do box { size = {0.5, 0.5, 0.25}, mass = 1, material = m, position = {0, 0, 0.125 + 0.25 * k} } end
field(function() return {0, 0, 0} end)
LUA
exits 0 tower.lua --no-record --json --quiet
[ "$(value stepped)" = 0 ] || fail "a tower that stands: stepped $(value stepped) s"

# what slides on and on is not lifted by the rounding of its weight: 1e4 s, 1e-12 of its velocity
exits 0 "$TOP/scenes/verify/S27_frictionless.lua" --param what=box --param zero_field=true --no-record --json --quiet

# two tiles that lean face on face, whose slips have no time to turn: points one too many, and pieces that ended at once
for spacing in 0.01 0.011 0.0125 0.014; do
	exits 0 "$TOP/scenes/dominoes.lua" --param count=2 --param spacing=$spacing --method located --no-record --no-render --json --quiet
done
# auto leaves to steps what rattles on and on
exits 0 "$TOP/scenes/dominoes.lua" --param count=3 --no-record --no-render --json --quiet
stepped=$(value stepped)
awk -v s="$stepped" 'BEGIN { exit !(s > 0 && s < 0.65) }' || fail "three tiles: stepped $stepped s of 0.675"

# how fast a ball has come to spin does not make its pieces shorter: the cost of a tilted turntable is linear in the time
cat >turntable.lua <<'LUA'
local w = 6
world { duration = 5, gravity = {0.86, 0, -9.77}, frame_rate = 10, method = "located" }
local m = material { name = "m", friction = 2, restitution = 0 }
plane { material = m, motion = function(t)
	return {0, 0, 0}, {axis = {0, 0, 1}, angle = w * t}, {0, 0, 0}, {0, 0, w}
end }
sphere { radius = 0.05, position = {0.3, 0, 0.05}, material = m }
LUA
for duration in 5 10 20; do
	exits 0 turntable.lua --duration $duration --no-record --json --quiet
	echo "$(value body_steps)"
done >steps
awk '{ n[NR] = $1 } END { exit !(n[3] - n[2] < 3 * (n[2] - n[1])) }' steps ||
	fail "a turntable: $(tr '\n' ' ' <steps)body steps in 5, 10 and 20 s"

# what a callback throws into what it lies on comes up again with e times that, whatever it lies on
cat >thrown.lua <<'LUA'
world { duration = 0.6, frame_rate = 20, gravity = {0, 0, -10} }
local m = material { name = "m", restitution = 0.5, friction = 0.4 }
local kind = param("kind", "driven", "what it lies on", {choices = {"plane", "driven", "box"}})
local v = kind == "driven" and 0.5 or 0
if kind == "box" then
	box { size = {4, 4, 1}, position = {0, 0, -0.5}, static = true, material = m }
elseif kind == "plane" then
	plane { material = m }
else
	plane { material = m, motion = function(t) return {0, 0, v * t}, nil, {0, 0, v} end }
end
local ball = param("body", "sphere", "", {choices = {"sphere", "box"}}) == "sphere"
	and sphere { radius = 0.1, mass = 2, position = {0, 0, 0.1}, velocity = {0, 0, v}, material = m }
	or box { size = {0.2, 0.2, 0.2}, mass = 2, position = {0, 0, 0.1}, velocity = {0, 0, v}, material = m }
local thrown = false
on_step(function(t)
	if not thrown and t >= 0.3 then
		thrown = t
		ball:apply_impulse({0, 0, -2 * 4})
	end
end)
-- 0.3 s later: up by 2 m/s, back by gravity
expect("it comes up again", function()
	local s = time() - thrown
	return math.abs(ball.position.z - (0.1 + v * time() + 2 * s - 5 * s ^ 2)), 1e-12
end)
LUA
for body in sphere box; do
	for kind in plane driven box; do
		exits 0 thrown.lua --param kind=$kind --param body=$body --method located --no-record --json --quiet
	done
done

# of two bodies that are hit within a moment, after a rebound, the nearer is: a search ends with what is known to come
for order in 1 2 3; do
	cat >near.lua <<LUA
world { duration = 1e-3, frame_rate = 1000, method = "located" }
local m = material { friction = 0, restitution = 1, density = 1000 }
local near, mover
local function far()
	box { group = "far", collides_with = "mover", size = {1, 1, 1}, density = 1e6, position = {0.5 + 5e-11, 0, 0}, material = m }
end
local function nearer()
	near = box { group = "near", collides_with = "mover", size = {1, 1, 1}, position = {0.5 + 3e-11, 0, 0}, material = m }
end
local function moves()
	mover = box { group = "mover", size = {1, 1, 1}, position = {-0.5, 0, 0}, velocity = {-1, 0, 0}, material = m }
end
for _, add in ipairs(({{moves, far, nearer}, {far, nearer, moves}, {nearer, far, moves}})[$order]) do add() end
box { group = "back", collides_with = "mover", size = {1, 1, 1}, position = {-1.5 - 4e-13, 0, 0}, static = true, material = m }
expect("the near one goes on", function() return math.abs(near.velocity.x - 1) + math.abs(mover.velocity.x), 1e-12 end)
LUA
	exits 0 near.lua --no-record --json --quiet
done

# friction of 2 on a slope: under a body that rolls on its round end a slip begins, and while it is slow its force grows
# without bounds in a direction in which it could not stop
cat >turn.lua <<'LUA'
world { duration = 1.6, gravity = {0, 0, -9.81} }
local m = material { friction = 2 }
plane { normal = {0.4195734717835499, 0, 0.9077213789349123}, material = m }
body { material = m, position = {-0.06536548882505674, 0, 0.9230512854040719},
	orientation = {0.7071067811865476, 0, 0.4999999999999999, 0.4999999999999999}, shapes = {
	{ shape = "sphere", position = {0.15, 0, 0}, radius = 0.1 },
	{ shape = "cylinder", position = {-0.1, 0, 0.05}, radius = 0.08, length = 0.2 } } }
record { ledger = true }
LUA
exits 0 turn.lua --method located --no-record --json --quiet
value unexplained_share | awk '{ exit !($1 <= 1e-12) }' || fail "turn.lua: unexplained are $(value unexplained_share)"

# far from the origin, where an ulp is not small beside 1e-9 of their size, joints hold to the rounding of coordinates
cat >far.lua <<'LUA'
local kind = param("kind", "ball", "joint")
world { duration = 0.05, frame_rate = 200, gravity = {-2.664, -5.185, -7.89} }
local q = {0.8694394712075739, -0.13244759784951302, 0.4034575205162421, 0.252496869028259}
local a = box { size = {2e-3, 2e-3, 2e-3}, position = {999999.9980537501, -1999999.9989403987, 300000.00058254326},
	orientation = q }
local b = box { size = {2e-3, 3e-3, 2e-3}, position = {1000000.001820497, -1999999.9988340735, 299999.9992407858},
	orientation = q }
local turns = kind == "hinge" or kind == "slider" or kind == "cylindrical" or kind == "universal"
joint { kind = kind, a = a, b = b, axis = turns and {1, 2, 3} or nil, axis_b = kind == "universal" and {2, -1, 0} or nil,
	at_a = {0.0011601400563289819, -0.0019343668716472163, 0.0004028645623218168},
	at_b = {-0.0019664166392991183, -2.649734790367269e-06, -0.0011760946303733825} }
LUA
for kind in fixed ball hinge slider cylindrical universal; do
	exits 0 far.lua --param kind=$kind --method located --no-record --json --quiet
done

# a flat end beside the centre of mass takes a fall at the point of its rim nearest to that, whichever way all of it is turned
cat >flat.lua <<'LUA'
local turn = param("turn", 0, "angle about (1, 2, 3)")
local axis = vec3(1, 2, 3):unit()
local function turned(v)
	v = vec3(v)
	return math.cos(turn) * v + math.sin(turn) * axis:cross(v) + (1 - math.cos(turn)) * axis:dot(v) * axis
end
world { duration = 0.3, gravity = turned {0, 0, -9.81} }
local smooth = material { friction = 0 }
plane { normal = turned {0, 0, 1}, material = smooth }
local b = body { position = turned {0, 0, 0.5}, material = smooth, orientation = {axis = axis, angle = turn}, shapes = {
	{ shape = "sphere", radius = 0.1, position = {0.15, 0, 0} },
	{ shape = "cylinder", radius = 0.08, length = 0.2, position = {-0.1, 0, -0.05} } } }
local times, impulse, speed = 0, 0, 0
on_collision(function(c)
	times, impulse, speed = times + 1, impulse + c.impulse:length(), math.max(speed, c.approach_speed)
end)
expect("it hits once", function() return times == 1 end)
expect("the impulse", function()
	local lever = b.center_of_mass.x + 0.02
	return math.abs(impulse * (1 / b.mass + lever ^ 2 / b.inertia[2][2]) / speed - 1), 1e-12
end)
LUA
for turn in 0 1 2 3; do
	exits 0 flat.lua --param turn=$turn --method located --no-record --json --quiet
done

# what rolls or spins beside what it touches, at the same velocity: no end, as bounds took the mantle of a cylinder to move
cat >beside.lua <<'LUA'
local kinds, tilt, r = param("kinds", "cs", "both shapes"), param("tilt", 0.0, "of the slope, rad"), 0.125
world { duration = 0.2, gravity = {8 * math.sin(tilt), 0, -8 * math.cos(tilt)} }
local m = material { friction = 0.5, restitution = 0.25, density = 1000 }
plane { normal = {0, 0, 1}, material = m }
local bodies, lies = {}, {axis = {1, 0, 0}, angle = math.pi / 2}
for k = 1, 2 do
	local def = { radius = r, position = {2 * r * k, 0, r}, velocity = {r, 0, 0}, angular_velocity = {0, 1, 0}, material = m }
	local kind = kinds:sub(k, k)
	if kind == "s" then
		bodies[k] = sphere(def)
	else
		def.length, def.orientation = 2 * r, lies
		bodies[k] = (kind == "c" and cylinder or capsule)(def)
	end
end
expect("they roll on", function()
	return math.abs(bodies[1].velocity.x - bodies[1].angular_velocity.y * r), 1e-12
end)
LUA
for kinds in cs sc cc pc ps; do
	exits 0 beside.lua --param kinds=$kinds --method located --no-record --json --quiet
done
for kinds in cc pp; do
	exits 0 beside.lua --param kinds=$kinds --param tilt=0.1 --method located --no-record --json --quiet
done

# a can that wobbles on its end by less than the tolerance lands, and the ledger has what that takes; where nothing slips it would
# wobble for ever, the faster the lower it is, in pieces of 1e-7 s
cat >wobble.lua <<'LUA'
local tilt, rate, friction = param("tilt", 1e-9, "rad"), param("rate", 1e-4, "rad/s"), param("friction", 0.0, "of the floor")
local r, h = 0.13, 0.3
world { duration = 0.3, gravity = {0, 0, -9.81} }
local m = material { friction = friction, restitution = param("restitution", 0.25, "of all"), density = 1000 }
plane { normal = {0, 0, 1}, material = m }
local can = cylinder { radius = r, length = h, material = m, orientation = {axis = {0, 1, 0}, angle = tilt},
	position = {0, 0, h / 2 * math.cos(tilt) + r * math.sin(tilt)}, velocity = {0.1, 0, 0}, angular_velocity = {rate, rate, 1} }
expect("it lies flat", function() return math.abs(can.position.z - h / 2), 1e-15 end)
LUA
for params in '' '--param tilt=1e-7 --param rate=1e-3' '--param restitution=0' '--param restitution=0.9' '--param friction=0.5'; do
	# shellcheck disable=SC2086
	exits 0 wobble.lua $params --method located --no-record --json --quiet
	for share in unexplained momentum angular_momentum; do
		awk -v name="\"${share}_share\":" '{ at = index($0, name); share = substr($0, at + length(name)) + 0 }
			END { exit !(at > 0 && share >= 0 && share < 1e-12) }' out || fail "wobble $params: $share"
	done
done
