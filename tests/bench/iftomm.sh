#!/bin/sh
# SPDX-License-Identifier: MIT
# Problems of the IFToMM's library of benchmarks (Gonzalez, Dopico, Lugris, Cuadrado, Multibody Syst. Dyn. 16 (2006) 179), located
# and by steps: what places miss, energy, processor time.
#   A01  pendulum of 1 m and 1 kg from the horizontal, 10 s
#   A02  1 and 10 windows of rods of 1 m and 1 kg, upright at 30 m/s, 10 s: every half turn all of them lie in one line
#   A03  Andrews' squeezing mechanism, 0.03 s (Hairer and Wanner, Solving Ordinary Differential Equations II, VII.7)
#   A05  stiff flyball governor, springs of 8e5 N/m with dampers of 4e4 N s/m for coupler rods, 10 s; the shaft turns freely, with
#        2 pi rad/s at the start
# A01 and A02 have one freedom, angle'' = b sin(angle); their reference is that equation by Runge and Kutta's method with steps of
# 1e-5 s, here. A03's is by tests/reference/squeezer.c (what is published is 1e-9 off),
# A05's by governor.c there. A run that does not end well is shown as its exit status.
. "$(dirname "$0")/functions"

# reference B ANGLE SPEED: sin and cos of the angle from upright after 10 s
reference()
{
	awk -v b="$1" -v q="$2" -v w="$3" 'BEGIN {
		h = 1e-5
		for (k = 0; k < 1000000; k++) {
			a1 = b * sin(q); a2 = b * sin(q + h / 2 * w); a3 = b * sin(q + h / 2 * (w + h / 2 * a1))
			a4 = b * sin(q + h * (w + h / 2 * a2))
			q += h * (w + h / 6 * (a1 + a2 + a3)); w += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
		}
		printf "%.16g %.16g\n", sin(q), cos(q)
	}'
}

cat >A01.lua <<'END'
local h, x, z = param("h", 0.001, "s"), param("x", 0.0, "m"), param("z", 0.0, "m")
world { duration = 10, frame_rate = 10, time_step = h, gravity = {0, 0, -9.81} }
local ball = sphere { radius = 0.01, mass = 1, position = {-1, 0, 0} }
joint { kind = "rod", a = ball, at_b = {0, 0, 0} }
expect("place", function() return (ball.position - {x, 0, z}):length(), 1e9 end)
END
cat >A02.lua <<'END'
local h, x, z = param("h", 0.001, "s"), param("x", 0.0, "m"), param("z", 0.0, "m")
local n = param("windows", 1, "", {min = 1})
world { duration = 10, frame_rate = 10, time_step = h, gravity = {0, 0, -9.81} }
local y, speed, up = vec3(0, 1, 0), 30, {}
local function rod(p, q, spin, v)
	return capsule { radius = 0.005, length = 0.98, mass = 1, inertia = {1 / 12, 1 / 12, 1e-5}, position = (p + q) / 2, velocity = v,
		angular_velocity = {0, spin, 0}, orientation = {axis = y, angle = p.x == q.x and 0 or deg(90)}, collides_with = {} }
end
for k = 0, n do
	up[k] = rod(vec3(k, 0, 0), vec3(k, 0, 1), speed, {speed / 2, 0, 0})
	joint { kind = "hinge", a = up[k], at = {k, 0, 0}, axis = y }
	if k > 0 then
		local level = rod(vec3(k - 1, 0, 1), vec3(k, 0, 1), 0, {speed, 0, 0})
		joint { kind = "hinge", a = up[k - 1], b = level, at = {k - 1, 0, 1}, axis = y }
		joint { kind = "hinge", a = level, b = up[k], at = {k, 0, 1}, axis = y }
	end
end
expect("place", function() return (up[0].point({0, 0, 0.5}) - {x, 0, z}):length(), 1e9 end)
END
cat >A03.lua <<'END'
local h = param("h", 0.001, "s")
world { duration = 0.03, frame_rate = 1 / 0.03, time_step = h }
local xa, ya, xb, yb, xc, yc = -0.06934, -0.00227, -0.03635, 0.03273, 0.014, 0.072
local d, da, e, ea, rr, ra, ss, sa, sb, sc, sd = 0.028, 0.0115, 0.02, 0.01421, 0.007, 0.00092, 0.035, 0.01874, 0.01043, 0.018, 0.02
local ta, tb, u, ua, ub, zf, zt, fa = 0.02308, 0.00916, 0.04, 0.01228, 0.00449, 0.02, 0.04, 0.01421
local beta, theta, gamma, phi, delta, omega, epsilon = -0.0617138900142764496, 0, 0.455279819163070380, 0.222668390165885885,
	0.487364979543842550, -0.222668390165885885, 1.23054744454982119
local cos, sin = math.cos, math.sin
local function body(name, mass, inertia, x, y, forces)
	return sphere { name = name, radius = 1e-3, mass = mass, inertia = {inertia, inertia, inertia}, position = {x, y, 0}, collides_with = {}, forces = forces }
end
local b, p, f = beta + theta, phi + delta, omega + epsilon
local one = body("1", 0.04325, 2.194e-6, ra * cos(beta), ra * sin(beta), {{torque = {0, 0, 0.033}}})
local two = body("2", 0.00365, 4.410e-7, rr * cos(beta) - da * cos(b), rr * sin(beta) - da * sin(b))
local three = body("3", 0.02373, 5.255e-6, xb + sa * sin(gamma) + sb * cos(gamma), yb - sa * cos(gamma) + sb * sin(gamma))
local four = body("4", 0.00706, 5.667e-7, xa + zt * cos(delta) + (e - ea) * sin(p), ya + zt * sin(delta) - (e - ea) * cos(p))
local five = body("5", 0.07050, 1.169e-5, xa + ta * cos(delta) - tb * sin(delta), ya + ta * sin(delta) + tb * cos(delta))
local six = body("6", 0.00706, 5.667e-7, xa + u * sin(epsilon) + (zf - fa) * cos(f), ya - u * cos(epsilon) + (zf - fa) * sin(f))
local seven = body("7", 0.05498, 1.912e-5, xa + ua * sin(epsilon) - ub * cos(epsilon), ya - ua * cos(epsilon) - ub * sin(epsilon))
local wall = sphere { name = "wall", radius = 1e-3, static = true, position = {xc, yc, 0}, collides_with = {} }
local E = vec3(rr * cos(beta) - d * cos(b), rr * sin(beta) - d * sin(b), 0)
local function pin(x, y, at) return joint { kind = "hinge", a = x, b = y, at = at, axis = {0, 0, 1} } end
pin(one, nil, {0, 0, 0})
pin(one, two, {rr * cos(beta), rr * sin(beta), 0})
pin(three, nil, {xb, yb, 0})
pin(five, nil, {xa, ya, 0})
pin(seven, nil, {xa, ya, 0})
pin(five, four, {xa + zt * cos(delta), ya + zt * sin(delta), 0})
pin(seven, six, {xa + u * sin(epsilon), ya - u * cos(epsilon), 0})
pin(two, three, E)
pin(two, four, E)
pin(two, six, E)
local spot = vec3(xb + sd * cos(gamma) + sc * sin(gamma), yb + sd * sin(gamma) - sc * cos(gamma), 0)
spring { a = three, b = wall, at_a = spot - three.position, stiffness = 4530, rest_length = 0.07785 }
-- At t = 0.03 s; an angle is what the body has turned by since the start, to whole turns.
local function off(one, start, wanted)
	local x = one.point({1, 0, 0}) - one.position
	local angle = math.atan(x.y, x.x) - (wanted - start)
	return math.abs(angle - 2 * math.pi * math.floor(angle / (2 * math.pi) + 0.5))
end
expect("beta", function() return off(one, beta, 15.81077119515371), 1e9 end)
expect("place", function()
	return math.max(off(three, gamma, 0.04082224011964579), off(five, delta, 0.52440996587995405), off(seven, epsilon, 1.048080741041938)), 1e9
end)
END

cat >A05.lua <<'END'
local h, angle, height, spin = param("h", 0.001, "s"), param("angle", 0.0, "rad"), param("height", 0.0, "m"), param("spin", 0.0, "rad/s")
world { duration = 10, frame_rate = 10, time_step = h, gravity = {0, 0, -9.81} }
local up, across, w = vec3(0, 0, 1), vec3(0, 1, 0), 2 * math.pi
local function part(mass, inertia, position, orientation)
	return sphere { radius = 0.01, mass = mass, inertia = inertia, position = position, orientation = orientation,
		velocity = vec3(0, 0, w):cross(position), angular_velocity = {0, 0, w}, collides_with = {} }
end
-- What a bar of 3000 kg/m^3 and 1 cm x 1 cm x 1 m has, 0.3 kg; of a rod and its 5 kg, about both.
local thin, thick = 0.3 * 2e-4 / 12, 0.3 * 1.0001 / 12
local shaft = part(0.3, {thick, thick, thin}, vec3(0, 0, 0.5))
local slider = part(3, {0.005, 0.005, 0.005}, vec3(0, 0, 0.5))
joint { kind = "hinge", a = shaft, at = {0, 0, 0}, axis = up }
joint { kind = "slider", a = shaft, b = slider, axis = up }
local middle = (0.3 * 0.5 + 5) / 5.3
local both = thick + 0.3 * (middle - 0.5) ^ 2 + 5 * (1 - middle) ^ 2
local rods = {}
for side = -1, 1, 2 do
	local top, along = vec3(side * 0.05, 0, 1), vec3(side * math.sqrt(0.75), 0, -0.5)
	local rod = part(5.3, {thin, both, both}, top + along * middle, {axis = across, angle = deg(side * 30)})
	joint { kind = "hinge", a = shaft, b = rod, at = top, axis = across }
	spring { a = slider, b = rod, at_a = {side * 0.05, 0, 0}, at_b = {side * (0.5 - middle), 0, 0}, stiffness = 8e5, damping = 4e4, rest_length = 0.5 }
	rods[side] = rod
end
expect("place", function()
	local d = rods[1].position - shaft.position
	local out = vec3(d.x, d.y, 0):length()
	return math.max(math.abs(slider.position.z - height), math.abs(out - 0.05 - middle * math.cos(angle)), math.abs(slider.angular_velocity.z - spin)), 1e9
end)
END

# try CASE SCENE METHOD STEP UNIT [PARAM...]
try()
{
	case="$1, $3${4:+, step $4 s}" scene=$2 method=$3 step=$4 unit=$5
	shift 5
	set -- "$scene" --method "$method" --param h="${step:-0.001}" --no-record --threads 1 --trust "$@"
	status=0
	"$RBSIM" run "$@" >out 2>err || status=$?
	[ $status = 0 ] || { result "$case" 'exit status' $status '' 0; return; }
	"$RBSIM" run "$@" --json >json 2>err
	result "$case" 'miss' "$(grep -o '"text":"place"[^}]*' json | grep -o '"measured":[^,}]*' | cut -d : -f 2)" "$unit"
	result "$case" 'energy unexplained, of what moved' "$(grep -o '"unexplained_share":[^,}]*' json | cut -d : -f 2)" ''
	measure 1 "$RBSIM" run "$@" --quiet >rows
	result "$case" 'processor time' "$(cut -d ' ' -f 2 rows)" s
}

place=$(reference 9.81 -1.5707963267948966 0)
set -- --param x="${place% *}" --param z="${place#* }"
try A01 A01.lua located '' m "$@"
for h in 0.001 0.0001; do try A01 A01.lua stepped $h m "$@"; done
for n in 1 10; do
	place=$(reference "$(awk -v n=$n 'BEGIN { printf "%.17g", 9.81 * ((n + 1) / 2 + n) / ((n + 1) / 3 + n) }')" 0 30)
	set -- --param x="${place% *}" --param z="${place#* }" --param windows=$n
	try "A02 with $n windows" A02.lua located '' m "$@"
	try "A02 with $n windows" A02.lua stepped 0.001 m "$@"
done
try A03 A03.lua located '' rad
for h in 1e-5 1e-6; do try A03 A03.lua stepped $h rad; done
set -- --param angle=0.390073701844645086 --param height=0.619622917061365655 --param spin=5.54820362265492661
try A05 A05.lua located '' 'm, rad/s' "$@"
for h in 1e-2 1e-3 1e-4; do try A05 A05.lua stepped $h 'm, rad/s' "$@"; done
