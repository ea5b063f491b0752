#!/bin/sh
# SPDX-License-Identifier: MIT
# The ledger: causes have the values of closed forms, nothing that was located is unexplained, steps explain all but what is
# first order in them; it changes no bit, goes through a checkpoint, and is recorded as it is summed up.
. tests/cli/functions

ledger()
{
	exits 0 "$@" --no-render --json --force -o run.h5
	cp out "$1.json"
}

# A ball slides until it rolls, mu m g (v0/mu g)(2/7) of path: m v0^2/7 goes to heat.
cat >slide.lua <<'END'
world { duration = 2, gravity = {0, 0, -9.81} }
local m = material { friction = 0.3, density = 1000 }
plane { normal = {0, 0, 1}, material = m }
sphere { radius = 0.1, mass = 2, position = {0, 0, 0.1}, velocity = {2, 1, 0}, material = m }
END
# Restitution 1/2 from 1 m: a rest of nothing; gravity and the floor balance.
cat >drop.lua <<'END'
world { duration = 5, gravity = {0, 0, -9.81} }
local m = material { friction = 0.4, restitution = 0.5 }
plane { normal = {0, 0, 1}, material = m }
sphere { radius = 0.1, mass = 3, position = {2, 0, 1.1}, material = m }
END
# An oscillator that its damper brings to rest, beside a ball that drag stops.
cat >damped.lua <<'END'
world { duration = 60 }
local wall = sphere { radius = 0.1, static = true, position = {0, 5, 0} }
local bob = sphere { radius = 0.1, mass = 1, position = {2, 5, 0} }
spring { a = wall, b = bob, stiffness = 40, damping = 3, rest_length = 1.5 }
END
cat >drag.lua <<'END'
world { duration = 60 }
drag { linear = 2 }
sphere { radius = 0.1, mass = 1, velocity = {3, 0, 4} }
END
# A belt takes a box along: what the motor gives is twice what the box gets.
cat >belt.lua <<'END'
world { duration = 2, gravity = {0, 0, -9.81} }
local m = material { friction = 0.5 }
box { size = {20, 2, 0.2}, material = m, motion = function(t)
	return {3 * t, 0, -0.1}, {1, 0, 0, 0}, {3, 0, 0}, {0, 0, 0}
end }
box { size = {0.4, 0.4, 0.4}, mass = 5, position = {-5, 0, 0.2}, material = m }
END
# Forces stated, of a field and of callbacks; impulses and velocities that callbacks set.
cat >pushed.lua <<'END'
world { duration = 3, time_step = 0.01, gravity = {0, 0, -1} }
field(function(t, x, v) return {0, 0.3 * math.cos(t), 0} end)
local ball = sphere { radius = 0.1, mass = 2, velocity = {0, 1, 0}, angular_velocity = {0, 0, 3},
	forces = {{vector = {1, 0, 0}, start = 0.5, duration = 1.25}} }
local other = sphere { radius = 0.1, mass = 1, position = {5, 0, 0} }
local done = false
on_step(function(t)
	ball:apply_force({0, 0, 2.5}, vec3(ball.position) + vec3(0, 0.05, 0))
	if t > 1 and not done then
		done = true
		ball:apply_impulse({0, 0.5, 0}, {0, 0, 0})
		other:set_velocity({0, 2, 0})
	end
end)
END
# What is light bounces beside what is heavy and stands, whose potential energy is 1e10 times as large.
cat >light.lua <<'END'
world { duration = 1, gravity = {0, 0, -9.81} }
local m = material { friction = 0.3, restitution = 0.5 }
plane { normal = {0, 0, 1}, material = m }
box { size = {0.3, 0.3, 1.3}, mass = 1000, position = {0, 0, 0.65}, material = m }
sphere { radius = 1e-3, mass = 1e-6, position = {1, 0, 0.13}, velocity = {0.3, 0, 0}, material = m }
END
# A ball that bounces in a groove, on each of its sides with ever smaller rebounds: the last on the one, which from then on is
# held, comes while it is as good as back on the other, where it still approaches.
cat >groove.lua <<'END'
world { duration = 0.4, gravity = {0, 0, -9.8} }
local m = material { friction = 0.019, restitution = 0.38, density = 1000 }
plane { normal = {-0.39, 0.192, 0.9}, material = m }
box { size = {0.8, 1, 0.53}, position = {-0.5, -0.48, 0.75}, orientation = {axis = {-0.26, -0.8, 0.53}, angle = 2},
	static = true, material = m }
sphere { radius = 0.4, position = {0.48, -1.08, 0.9}, material = material { friction = 0.88, density = 1000 } }
END
# Doors that springs and a motor hold against their stops: hinges and stops share what the ground gives.
cat >doors.lua <<'END'
world { duration = 2, gravity = {0, 0, -9.81} }
local function door(y, more)
	local post = box { static = true, size = {0.1, 0.1, 2}, position = {0, y, 0}, collides_with = {} }
	local leaf = box { size = {1, 0.1, 2}, mass = 20, position = {0.5, y, 0}, collides_with = {} }
	local hinge = { kind = "hinge", a = post, b = leaf, at = {0, y, 0}, axis = {0, 0, 1}, limits = {-0.5, 1} }
	for key, value in pairs(more) do hinge[key] = value end
	joint(hinge)
end
door(1, { stiffness = 20, rest = -1 })
door(3, { motor = { speed = 2, torque = 20 } })
END
# Shafts with a universal joint: they turn and go nowhere, and their bearings take nothing in the mean.
cat >shafts.lua <<'END'
world { duration = 1 }
local along = vec3(math.cos(0.5), math.sin(0.5), 0)
local post = sphere { static = true, radius = 0.01, position = {0, 0, -1}, collides_with = {} }
local one = sphere { radius = 0.1, position = {-0.3, 0, 0}, angular_velocity = {10, 0, 0}, collides_with = {} }
local two = sphere { radius = 0.1, position = 0.3 * along, angular_velocity = 10 * math.cos(0.5) * along, collides_with = {} }
joint { kind = "hinge", a = post, b = one, at = {-0.3, 0, 0}, axis = {1, 0, 0}, motor = { speed = 10, torque = 1000 } }
joint { kind = "hinge", a = post, b = two, at = 0.3 * along, axis = along }
joint { kind = "universal", a = one, b = two, at = {0, 0, 0}, axis = {0, 0, 1}, axis_b = {-math.sin(0.5), math.cos(0.5), 0} }
END
for scene in slide drop damped drag belt pushed light groove doors shafts; do
	ledger $scene.lua --method located
done
python3 - <<'END' || fail 'the ledger is not that of the closed forms'
import json
from math import isclose, sqrt

def run(name):
    return json.load(open(name + '.lua.json'))

def near(found, wanted, share=1e-11):
    assert isclose(found, wanted, rel_tol=share, abs_tol=share), (found, wanted)

near(run('slide')['ledger']['sliding'], 2 * 5 / 7)
near(run('drop')['ledger']['impacts'], 3 * 9.81 * 1)
near(run('damped')['ledger']['damping'], 0.5 * 40 * 0.5 ** 2)
near(run('drag')['ledger']['drag'], 12.5)
belt = run('belt')['ledger']
near(belt['sliding'], 0.5 * 5 * 9)
near(belt['driven'], 5 * 9)
pushed = run('pushed')
assert abs(pushed['ledger']['applied']) > 1e-3 and abs(pushed['ledger']['callbacks']) > 1e-3
for name in 'slide', 'drop', 'damped', 'drag', 'belt', 'pushed', 'doors', 'shafts':
    ledger = run(name)['ledger']
    for key in 'unexplained_share', 'momentum_share', 'angular_momentum_share':
        assert ledger[key] <= 1e-12, (name, key, ledger[key])
    whole = run(name)
    change = sum(whole['last'][k] - whole['first'][k] for k in ('kinetic_energy', 'potential_energy'))
    given = sum(ledger[k] for k in ('applied', 'driven', 'callbacks'))
    taken = sum(ledger[k] for k in ('impacts', 'impact_friction', 'sliding', 'rolling', 'joint_friction',
                                    'drag', 'damping'))
    near(change, given - taken + ledger['unexplained'], 1e-13 * ledger['energy_scale'] + 1e-15)
for name in 'light', 'groove':
    assert run(name)['ledger']['unexplained_share'] <= 1e-12, (name, run(name)['ledger'])
END

# The classic method explains all but what is first order in its step.
sed 's/gravity = {0/gravity = {2/' slide.lua >slope.lua
for step in 0.004 0.001; do
	ledger slope.lua --method classic --time-step $step
	mv slope.lua.json slope-$step.json
done
python3 - <<'END' || fail 'what the classic method leaves is not first order'
import json
coarse, fine = (json.load(open(f'slope-{step}.json'))['ledger'] for step in ('0.004', '0.001'))
assert 3 < coarse['unexplained_max'] / fine['unexplained_max'] < 5, (coarse, fine)
assert fine['momentum_share'] < 1e-12 and fine['angular_momentum_share'] < 1e-12
END

# So do steps, of energy; of momentum they leave rounding, of the angular one about the gaps of bodies that rub on each other.
cat >fall.lua <<'END'
world { duration = 2, gravity = {0, 0, -9.81} }
drag { linear = 0.3, quadratic = 0.1 }
sphere { radius = 0.1, mass = 2, position = {1, 2, 0}, velocity = {2, 1, 3}, angular_velocity = {1, 2, 3} }
END
cat >tumble.lua <<'END'
world { duration = 2, gravity = {0, 0, -9.81} }
box { size = {0.1, 0.2, 0.4}, mass = 2, position = {1, 2, 0}, velocity = {2, 1, 3}, angular_velocity = {1, 2, 3} }
END
cat >plate.lua <<'END'
world { duration = 2, gravity = {0, 0, -9.81} }
local m = material { friction = 0.5 }
box { size = {20, 2, 0.2}, material = m, motion = function(t)
	local s, c = math.sin(15 * t), math.cos(15 * t)
	return {0.1 * s, 0, -0.1 + 0.05 * s}, {1, 0, 0, 0}, {1.5 * c, 0, 0.75 * c}, {0, 0, 0}
end }
box { size = {0.4, 0.4, 0.4}, mass = 5, position = {-5, 0, 0.2}, material = m }
END
cat >heap.lua <<'END'
world { duration = 1, gravity = {0, 0, -9.81} }
local m = material { friction = 0.3, restitution = 0.2, density = 1000 }
plane { normal = {0, 0, 1}, material = m }
for i = 0, 26 do
	local x, y, z = i % 3, i // 3 % 3, i // 9
	local at = {0.21 * x + 0.01 * z, 0.21 * y + 0.005 * z, 0.2 + 0.32 * z + 0.05 * x}
	if i % 2 == 0 then
		sphere { radius = 0.1, position = at, material = m }
	else
		box { size = {0.2, 0.15, 0.2}, position = at, material = m, angular_velocity = {x, y, z} }
	end
end
END
# Drag takes of what an impact gives, not of what it has ended.
cat >bounce.lua <<'END'
world { duration = 1 }
drag { linear = 20, quadratic = 5 }
local m = material { restitution = 1 }
plane { normal = {0, 0, 1}, material = m }
sphere { radius = 0.1, mass = 1, position = {0, 0, 0.22}, velocity = {0, 0, -5}, material = m }
END
for step in 0.01 0.0025; do
	for scene in bounce slide drop damped drag belt pushed fall tumble plate heap; do
		exits 0 $scene.lua --method stepped --time-step $step --no-record --json
		cp out $scene-$step.json
	done
done
for options in '--method auto' '--method stepped --rollback global --time-step 0.04'; do
	exits 0 heap.lua $options --no-record --json
	python3 -c 'import json; assert json.load(open("out"))["ledger"]["momentum_share"] < 1e-12' ||
		fail "momentum with $options"
done
python3 - <<'END' || fail 'what steps do is not what the ledger says'
import json

def run(name, step):
    return json.load(open(f'{name}-{step}.json'))['ledger']

# What causes come to, and how far off a step of 1/100 s may leave them: a share of them, or rounding of what sticks.
wanted = {'slide': {'sliding': (10 / 7, 1e-9)}, 'drop': {'impacts': (3 * 9.81, 0.01)}, 'damped': {'damping': (5, 0.05)},
          'drag': {'drag': (12.5, 0.02)}, 'belt': {'sliding': (22.5, 1e-6), 'driven': (45, 1e-6)}}
for name in ('bounce', 'slide', 'drop', 'damped', 'drag', 'belt', 'pushed', 'fall', 'tumble', 'plate', 'heap'):
    coarse, fine = run(name, '0.01'), run(name, '0.0025')
    for cause, (value, share) in wanted.get(name, {}).items():
        for ledger, part in (coarse, 1), (fine, 0.5):
            assert abs(ledger[cause] - value) <= max(part * share, 1e-6) * value, (name, cause, ledger[cause])
    for ledger in coarse, fine:
        assert ledger['momentum_share'] <= 1e-12, (name, ledger)
        assert ledger['angular_momentum_share'] <= (1e-4 if name == 'heap' else 1e-12), (name, ledger)
        assert name in ('damped', 'plate', 'pushed') or ledger['gained_share'] <= 1e-9, (name, ledger)
        for cause in 'impacts', 'impact_friction', 'sliding', 'drag', 'damping':
            assert ledger[cause] >= 0, (name, cause, ledger[cause])
    # first order, if there is anything
    assert coarse['unexplained_share'] < 0.03, (name, coarse)
    assert fine['unexplained_share'] < max(1e-6, 0.5 * coarse['unexplained_share']), (name, coarse, fine)
heap = run('heap', '0.0025')
assert min(heap['impacts'], heap['impact_friction'], heap['sliding']) > 1, heap
END

# A speck that goes back to shorter steps takes with it whom its impulse has pushed (1653); sweeps that have gone far leave
# velocities that are what impulses make of them (68).
for seed in 68 1653; do
	python3 "$TOP/tests/random/run.py" --program "$RBSIM" --seed $seed --methods stepped --checks ledger --param most=4 \
		--param length=2 >out || fail "the ledger of random scene $seed does not close"
done

# It changes no bit of what is simulated.
for scene in fall plate heap; do
	for word in false true; do
		{ cat $scene.lua; echo "record { ledger = $word }"; } >other.lua
		exits 0 other.lua --method stepped --time-step 0.01 --no-record --json
		[ "$(value state_hash)" = "$(value state_hash $scene-0.01.json)" ] ||
			fail "$scene: another hash with ledger = $word under steps"
	done
done
for scene in slide drop belt pushed; do
	hash=$(value state_hash $scene.lua.json)
	for word in false true; do
		{ cat $scene.lua; echo "record { ledger = $word }"; } >other.lua
		exits 0 other.lua --method located --no-record --json
		[ "$(value state_hash)" = "$hash" ] || fail "$scene: another hash with ledger = $word"
	done
done
exits 0 other.lua --no-record
says err '^  ledger +applied .* J, callbacks .* J$'
says err '^  unexplained +[^ ]+ J at most, [^ ]+ of what moved; of momentum [^ ]+, of angular momentum [^ ]+$'
sed -i 's/ledger = true/ledger = false/' other.lua
exits 0 other.lua --no-record
grep -q 'unexplained' err && fail 'a ledger that was not to be kept'
echo 'world { duration = 1 } sphere { radius = 1 } record { ledger = 3 }' >bad.lua
exits 65 bad.lua
says err "'ledger' must be true or false"

# As recorded; tests/cli/run-resume.sh looks at it after checkpoints.
exits 0 belt.lua --no-render --json --force -o whole.h5
cp out whole.json
python3 - <<'END' || fail 'the recording is not what was summed up'
import json, sys
try:
    import h5py
except ImportError:
    sys.exit(0)
whole = json.load(open('whole.json'))['ledger']
with h5py.File('whole.h5') as f:
    books = f['/observables/ledger']
    for name in books:
        if name != 'momentum':
            value = books[name]['value']
            assert value[-1] == whole[name], name
            assert value.attrs['units'] in (b'J', 'J'), name
    for name in books['momentum']:
        assert books['momentum'][name]['value'].shape == (121, 2, 3), name
END

# velocities at the start that a hinge does not allow: what its impulse leaves of the spin (2.5 -> 0.27 rad/s) is past the speed of
# a motor of next to no torque, which took the joint back to it at once, with friction that then stood still
cat >past.lua <<'LUA'
world { duration = 0.01, frame_rate = 100, gravity = {0, 0, 0}, method = "located" }
record { ledger = true }
local function pair(y, keys)
	local b = box { size = {1, 0.2, 0.1}, mass = 1, position = {0, y, 0}, angular_velocity = {0.2, 0.1, 2}, velocity = {3, 0.3, 0},
		collides_with = {} }
	keys.kind, keys.b, keys.at, keys.axis = "hinge", b, {0, y, -0.1}, {0, 0, 1}
	keys.a = box { size = {1, 0.2, 0.1}, mass = 1, position = {0.1, y + 0.2, -0.3}, angular_velocity = {0, 0.3, -0.5},
		collides_with = {} }
	return joint(keys)
end
local weak = 1e-9
local moved, free = pair(0, {motor = {speed = 1.3, torque = weak}, friction = weak}), pair(9, {})
-- the boxes' least moment of inertia about lines parallel to the axis is 0.087
expect("the motor has done next to nothing", function() return math.abs(moved.speed - free.speed), 2 * 2 * weak * 0.01 / 0.087 + 1e-12 end)
LUA
exits 0 run past.lua --no-record --quiet

# two that meet far above a plane keep their angular momentum: arms were those of where the step began (1.3e-3)
cat >above.lua <<'EOF'
world { duration = 0.5, frame_rate = 20, time_step = 0.01 }
record { ledger = true }
local m = material { friction = 0.5, restitution = 1, density = 1000 }
plane { material = m, point = {0, 0, -50} }
box { size = {0.3, 0.2, 0.15}, material = m, position = {3, 1, 0.6}, velocity = {1, 0.5, -3}, angular_velocity = {1, 2, 3},
	orientation = {axis = {1, 2, 0.5}, angle = 0.7} }
box { size = {0.3, 0.2, 0.15}, material = m, position = {3.5, 1.23, -0.4}, velocity = {0, 0.1, 0}, angular_velocity = {3, 2, -3},
	orientation = {axis = {1, 3, 0.5}, angle = 0.3} }
EOF
exits 0 above.lua --no-record --json --method stepped
[ "$(value collisions)" -ge 1 ] || fail "they do not meet"
value angular_momentum_share | awk '{exit !($1 >= 0 && $1 < 1e-12)}' || fail "angular momentum above a plane: $(value angular_momentum_share) unexplained"
