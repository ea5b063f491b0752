#!/bin/sh
# SPDX-License-Identifier: MIT
# Handles of joints: what they show in callbacks and at the end, what is refused, and release, also over a checkpoint.
. tests/cli/functions

# a ball that hangs still, one that swings on a hinge, and a bar fixed to the world; forces in closed form
cat >hang.lua <<'END'
world { duration = 0.5, frame_rate = 60, gravity = {0, 0, -10}, method = "located" }
local a = sphere { name = "a", radius = 0.1, mass = 2, position = {0, 0, -1} }
local rod = joint { kind = "rod", name = "rod", a = a, at_b = {0, 0, 0} }
local b = sphere { name = "b", radius = 0.1, mass = 3, position = {1, 3, 0} }
local hinge = joint { kind = "hinge", a = b, at = {0, 3, 0}, axis = {0, -1, 0} }
local c = box { name = "c", size = {1, 0.2, 0.2}, mass = 3, position = {0.5, 6, 0} }
local weld = joint { kind = "fixed", a = c, at = {0, 6, 0} }
expect_always("the rod carries 20 N down on the world", function() return (rod.force - vec3(0, 0, -20)):length(), 1e-12 end)
expect_always("and no torque", function() return rod.torque:length(), 1e-12 end)
expect_always("its length stays", function() return math.abs(rod.length - 1) + math.abs(rod.speed), 1e-12 end)
expect_always("the wall carries weight and moment", function()
	return (weld.force - vec3(0, 0, -30)):length() + (weld.torque - vec3(0, 15, 0)):length(), 1e-12
end)
expect_always("what hangs is accelerated by nothing", function() return a.force:length() + c.force:length() + c.torque:length(), 1e-12 end)
-- b against a is the world against the ball: about -y by the angle that the ball has fallen
expect_always("the angle is where the ball is", function()
	return math.abs(hinge.angle - math.atan(-b.position.z, b.position.x)), 1e-12
end)
expect_always("its speed is that of the ball", function()
	return math.abs(hinge.speed - b.velocity:length()), 1e-12
end)
-- Newton's second law for the ball: the joint gives what weight lacks
expect_always("the force is what accelerates", function()
	return (b.mass * b.acceleration - (-hinge.force + b.mass * vec3(0, 0, -10))):length(), 1e-11
end)
expect("names and ends", function()
	return rod.name == "rod" and hinge.name == nil and rod.kind == "rod" and rod.a == a and rod.b == nil
		and tostring(rod) == "joint rod 'rod'" and not rod.released
end)
END
exits 0 hang.lua --no-record --quiet

# release: the ball flies on, on its parabola; the same bits over a checkpoint
cat >release.lua <<'END'
world { duration = 1, frame_rate = 60, gravity = {0, 0, -10} }
local a = sphere { name = "a", radius = 0.1, mass = 2, position = {1, 0, 0} }
local b = sphere { name = "b", radius = 0.1, mass = 2, position = {2, 0, 0} }
local upper = joint { kind = "rod", a = a, at_b = {0, 0, 0} }
local lower = joint { kind = "rod", a = a, b = b }
record { fields = {"+", "joints"} }
on_frame(function(t, k)
	if k == 30 then
		state.joint, state.t, state.p, state.v = lower, t, vec3(b.position), vec3(b.velocity)
		lower:release()
	end
end)
expect("the ball flies on", function()
	local dt = time() - state.t
	return (b.position - (vec3(state.p) + dt * vec3(state.v) + dt * dt / 2 * vec3(0, 0, -10))):length(), 1e-12
end)
expect("one is released, the other is not", function()
	return state.joint == lower and lower.released and not upper.released and lower.force:length() == 0
end)
expect("the other ball still hangs", function() return math.abs(a.position:length() - 1), 1e-12 end)
END
exits 0 release.lua --quiet -o whole.h5
exits 0 replay whole.h5
for at in 0.3 0.7; do
	printf 'at %s checkpoint\nat %s quit\n' $at "$(awk "BEGIN { print $at + 0.1 }")" >commands
	exits 130 release.lua --quiet -o parts.h5 --commands commands --force
	[ -s parts.h5.checkpoint ] || fail "no checkpoint at $at"
	exits 0 release.lua --quiet -o parts.h5 --resume
	exits 0 diff whole.h5 parts.h5
done

# motors: one that keeps a speed and is told another, at another torque; by I w / tau it is there, and stays
cat >motor.lua <<'END'
world { duration = 2, frame_rate = 50, time_step = 1e-3, method = "stepped" }
local wheel = cylinder { name = "wheel", radius = 1, length = 0.1, mass = 4 } -- I = 2 kg m^2
local axle = joint { kind = "hinge", a = wheel, at = {0, 0, 0}, axis = {0, 0, -1}, motor = {speed = 3, torque = 12} }
local early, late
on_frame(function(t, k)
	if k == 40 then early = wheel.angular_velocity.z end
	if k == 50 then axle:set_motor { speed = -1, torque = 8 } end
	if k == 90 then late = wheel.angular_velocity.z end
end)
expect("it keeps its first speed from 0.5 s on, rad/s", function() return math.abs(early - 3), 1e-9 end)
-- 4 rad/s less at 8 N m take 1 s from 1 s on: at 1.8 s it turns at 3 - 4 * 0.8
expect("then slows down by its torque, rad/s", function() return math.abs(late - (3 - 4 * 0.8)), 1e-9 end)
expect("its handle says so", function() return math.abs(axle.speed - wheel.angular_velocity.z), 1e-12 end)
END
exits 0 motor.lua --no-record --quiet
sed 's/method = "stepped"/method = "located"/' motor.lua >located.lua
exits 0 located.lua --no-record --quiet
cat >follow.lua <<'END'
world { duration = 1, frame_rate = 50, time_step = 1e-3, method = "stepped", gravity = {0, 0, -10} }
local e = box { name = "e", size = {0.2, 0.2, 0.2}, mass = 1 }
local lift = joint { kind = "slider", a = e, axis = {0, 0, -1}, motor = {way = function(t) return 0.1 * math.sin(3 * t) end, force = 100} }
expect_always("the way is that of the function, m", function() return math.abs(lift.way - 0.1 * math.sin(3 * time())), 1e-7 end)
expect_always("and where the box is", function() return math.abs(lift.way - e.position.z), 1e-12 end)
END
exits 0 follow.lua --no-record --quiet
sed 's/return 0.1 \* math.sin(3 \* t) end, f/return t < 0.5 and 0 or "far" end, f/; /^expect/d' follow.lua >wrong.lua
exits 65 wrong.lua --no-record --quiet
says err "wrong.lua:3: 'way' must return a finite number \(got the text 'far'\) \(motor of slider #0 at t = 0.5"
# located, exactly; told to go elsewhere and back to its function, also over a checkpoint
sed 's/method = "stepped"/method = "located"/; s/1e-7/1e-14/; s/mass = 1 }/mass = 1, velocity = {0, 0, 0.3} }/' follow.lua >located.lua
exits 0 located.lua --no-record --quiet
sed 's/3 \* t) end, f/3 * t), t < 0.5 and 0.3 * math.cos(3 * t) or nil end, f/; /^expect/d' located.lua >wrong.lua
exits 65 wrong.lua --no-record --quiet
says err "wrong.lua:3: 'way' of the motor of slider #0 at t = .*: it returns a speed always or never"
sed 's/return 0.1 \* math.sin(3 \* t) end, f/return t < 0.5 and 0 or 0.01 end, f/; /^expect/d; s/velocity = {0, 0, 0.3}/velocity = {0, 0, 0}/' located.lua >wrong.lua
exits 65 wrong.lua --no-record --quiet
says err "wrong.lua:3: 'way' of the motor of slider #0 jumps by 0.01 m at t = 0.5 s: what a motor follows moves without jumps"
# Told to go elsewhere, a motor pushes with all of it and brakes with half of what it has beside the load, also by steps: the
# closed form without gravity, of an arm of I: a push over a third of the way. Its moments are a step off at most. It does not
# swing there, nor where it starts behind what it follows, and hangs on.
cat >back.lua <<'END'
local h, g, goal, way = param("h", 1e-3, "s"), param("g", 0.0, "m/s^2"), param("goal", 1.0, "rad"), param("way", "told", "", {choices = {"told", "sine"}})
world { duration = 3, frame_rate = 50, time_step = h, gravity = {0, 0, -g}, method = "stepped" }
local arm = sphere { radius = 0.1, mass = 1, position = {0.5, 0, 0} }
local function follow(t) if way == "told" then return 0, 0 end return math.sin(3 * t), 3 * math.cos(3 * t) end
local motor = joint { kind = "hinge", a = arm, at = {0, 0, 0}, axis = {0, 1, 0}, motor = {angle = follow, torque = 8} }
local a = 8 / (0.25 + 0.4 * 0.01)
local push = math.sqrt(2 / 3 / a)
local brake = 4 / 3 / (a * push)
local function closed_form(t)
	if t < push then return a * t * t / 2 end
	if t < push + brake then return 1 - 2 / 3 * (1 - (t - push) / brake) ^ 2 end
	return 1
end
if way == "told" then on_step(function() motor:set_motor { angle = goal } end) end
if way == "told" and g == 0 then
	expect_always("as in closed form", function() return math.abs(motor.angle - closed_form(time())), 1.5 * a * push * h end)
end
expect_always("it stays where it is to be", function()
	return time() < 1.6 and 0 or math.abs(motor.angle - (way == "told" and goal or follow(time()))), 1e-9
end)
END
for h in 4e-3 1e-3 3e-4; do
	exits 0 back.lua --no-record --quiet --param h=$h
	exits 0 back.lua --no-record --quiet --param h=$h --param g=9.81 --param goal=-1
	exits 0 back.lua --no-record --quiet --param h=$h --param g=9.81 --param way=sine
done
cat >told.lua <<'END'
world { duration = 3, frame_rate = 20, gravity = {0, 0, -10}, method = "located" }
local arm = box { name = "arm", size = {1, 0.1, 0.1}, mass = 1, position = {0.5, 0, 0} }
local function swing(t) return 0.2 * math.sin(t) ^ 2 end
local pin = joint { kind = "hinge", a = arm, at = {0, 0, 0}, axis = {0, 1, 0}, motor = {angle = swing, torque = 8} }
on_frame(function(t, k)
	if k == 20 then
		state.follows = math.abs(pin.angle - swing(1))
		pin:set_motor { angle = -1 }
	end
	if k == 30 then state.between = pin.angle end
	if k == 40 then
		state.there = math.abs(pin.angle + 1)
		pin:set_motor { angle = swing, torque = 10 }
	end
end)
expect("it follows", function() return state.follows, 1e-14 end)
expect("is on its way", function() return state.between > -1 and state.between < 0 end)
expect("and where it was told", function() return state.there, 1e-13 end)
expect("and back", function() return math.abs(pin.angle - swing(3)), 1e-13 end)
END
exits 0 told.lua --quiet -o whole.h5 --force
for at in 1.3 2.2; do
	printf 'at %s checkpoint\nat %s quit\n' $at "$(awk "BEGIN { print $at + 0.1 }")" >commands
	exits 130 told.lua --quiet -o parts.h5 --commands commands --force
	exits 0 told.lua --quiet -o parts.h5 --resume
	exits 0 diff whole.h5 parts.h5
done

refused()
{
	cat >wrong.lua <<END
world { duration = 0.1, gravity = {0, 0, -10} }
local a = sphere { name = "a", radius = 0.1, position = {1, 0, 0} }
local ball = joint { kind = "ball", name = "socket", a = a, at = {0, 0, 0} }
local hinge = joint { kind = "hinge", a = sphere { radius = 0.1, position = {1, 5, 0} }, at = {0, 5, 0}, axis = {0, 1, 0} }
local turned = joint { kind = "hinge", a = sphere { radius = 0.1, position = {1, 9, 0} }, at = {0, 9, 0}, axis = {0, 1, 0}, motor = {speed = 1, torque = 1} }
on_frame(function() $1 end)
END
	exits 65 wrong.lua --no-record --quiet
	says err "wrong.lua:6: .*$2"
}
refused 'ball:set_motor { speed = 1 }' "set_motor: a joint of kind 'ball' has no motor"
refused 'hinge:set_motor { speed = 1 }' "set_motor: this joint has none"
refused 'turned:set_motor { angle = function(t) return t end }' "set_motor: 'angle' must be a finite number, or the function"
refused 'turned:set_motor { angle = 1, speed = 1 }' "set_motor: 'speed' and 'angle' exclude each other"
refused 'print(ball.speed)' "a joint of kind 'ball' has no 'speed'"
refused 'print(hinge.way)' "a joint of kind 'hinge' has no 'way' \(did you mean 'angle'\?\)"
refused 'hinge.angle = 1' "a joint's 'angle' can't be assigned"
refused 'hinge.mine = 1' "a joint has no field 'mine' to assign"
refused 'hinge.release()' 'release: called without its joint'

# set_position: what opens a joint is refused, by all methods alike; along what is free, or with all that is joined, bodies go.
cat >moved.lua <<'END'
local what = param("what", "apart", "what is done", {choices = {"apart", "rod", "rope", "limit", "turned", "slack", "along", "both", "released", "speed"}})
world { duration = 0.5, frame_rate = 60, gravity = {0, 0, -10} }
local a = sphere { name = "a", radius = 0.1, mass = 2, position = {0, 0, 1} }
local b = sphere { name = "b", radius = 0.1, mass = 2, position = {1, 0, 1} }
local c = sphere { name = "c", radius = 0.1, mass = 2, position = {0, 5, 1} }
local d = sphere { name = "d", radius = 0.1, mass = 2, position = {1, 5, 1} }
local e = box { name = "e", size = {0.1, 0.1, 0.1}, mass = 2, position = {0, 9, 1} }
local f = sphere { name = "f", radius = 0.1, mass = 2, position = {3, 5, 1} }
local ball = joint { kind = "ball", name = "ball", a = a, b = b, at = {0.5, 0, 1} }
joint { kind = "rope", name = "rope", a = c, b = d, length = 1.05 }
joint { kind = "rod", name = "rod", a = d, b = f }
joint { kind = "slider", name = "rail", a = e, axis = {1, 0, 0}, limits = {-1, 1} }
local function by(body, x, y, z) return body.position + vec3(x, y, z) end
on_frame(function(t, k)
	if k ~= 10 then return end
	if what == "apart" then b:set_position(by(b, 0.5, 0, 0)) end -- line 16
	if what == "rod" then f:set_position(by(f, -0.25, 0, 0)) end
	if what == "rope" then c:set_position(by(c, -0.25, 0, 0)) end
	if what == "limit" then e:set_position(by(e, 1.5, 0, 0)) end
	if what == "turned" then e:set_position(by(e, 0, 0.125, 0)) end
	if what == "slack" then c:set_position(by(c, 0.25, 0, 0)) end
	if what == "along" then e:set_position(by(e, -0.5, 0, 0)) end
	if what == "both" then a:set_position(by(a, 0.3, 4, 0.1)) b:set_position(by(b, 0.3, 4, 0.1)) end
	if what == "released" then b:set_position(by(b, 0.5, 0, 0)) ball:release() end
	if what == "speed" then f:set_velocity({4, 0, 0}) end
end)
result("length", function() return (d.position - f.position):length() end)
expect("momentum stays", function()
	return what == "speed" and math.abs(c.momentum.x + d.momentum.x + f.momentum.x - 8) or 0, 1e-6
end)
expect("it has gone along", function() return what == "along" and math.abs(e.position.x + 0.5) or 0, 1e-6 end)
END
for method in located auto stepped; do
	for case in "apart 16 b ball ball 0.5" "rod 17 f rod rod 0.25" "rope 18 c rope rope 0.2" \
		"limit 19 e slider rail 0.5" "turned 20 e slider rail 0.125"; do
		set -- $case
		exits 65 moved.lua --no-record --quiet --method $method -p what=$1
		says err "^moved.lua:$2: set_position: body $3 opens $4 '$5' by $6[0-9]* m "
	done
	for case in slack along both released speed; do
		exits 0 moved.lua --no-record --quiet --method $method -p what=$case
	done
done
