#!/bin/sh
# SPDX-License-Identifier: MIT
# Drops of several bodies that come to slip and stick in many ways are located to their end. What is asked of each is in its
# comment; the moments are reached by nothing but all that has gone before.
. tests/cli/functions

ends()
{
	timeout "$PATIENCE" "$RBSIM" run "$1" --method located --no-record --quiet >out 2>err </dev/null || fail "$1: exit status $?"
}

# one of two points of a pair begins to slip where the other slips at 1e-8 m/s and turns: its direction turns at a rate
# without bound at its beginning, which no step is short enough for
cat >begins.lua <<'LUA'
world { duration = 1.01, frame_rate = 60, gravity = {0, 0, -9.81} }
local m = material { name = "m", friction = 0.5, restitution = 0.5, density = 1000 }
plane { name = "ground", material = m, normal = {0.24505552754901574, 0, 0.9695090450417023}, point = {0, 0, 0} }
body { name = "club", material = m, position = {0, 0, 0.5}, shapes = {
	{ shape = "sphere", position = {0.15, 0, 0}, radius = 0.1 },
	{ shape = "box", position = {-0.1, 0, 0.05}, size = {0.2, 0.1, 0.1} } } }
capsule { name = "capsule", material = m, radius = 0.142988635254675, length = 0.23264086372276344,
	position = {0, -0.08557040715468203, 1.35},
	orientation = {0.8309917508672178, 0.22400712868014652, 0.5049858112460562, -0.06529047963734655},
	velocity = {-0.9921770019729408, 1.499406132095121, 0.3072753143047233},
	angular_velocity = {0.7086127688249615, 1.7554652726435371, 0} }
box { name = "box", material = m, size = {0.2749661864315877, 0.27088323885860216, 0.39910189170125077},
	position = {0.0027934819606771077, -0.005954549509877768, 2.243949369816097} }
box { name = "plank", material = m, size = {0.22079046309642777, 0.38089160433891533, 0.14394307482407387},
	position = {0, 0, 3.3403245383501035},
	orientation = {0.9659258262890683, 0, 0.1830127018922193, 0.1830127018922193},
	velocity = {1.1920921606223045, 1.5248297756436067, 0} }
LUA
exits 0 run begins.lua --method located --no-record --quiet

# a slip of 1e-5 m/s that turns: were it to creep at once the way that balances, a contact beside it would slip that sticks,
# and if that slips it would pull, in turn and without end
cat >turns.lua <<'LUA'
world { duration = 1.1, frame_rate = 20, gravity = {0, 0, -9.81} }
local m = material { name = "m", friction = 0.5, restitution = 0.2, density = 1000 }
plane { name = "ground", material = m, normal = {0, 0, 1}, point = {0, 0, 0} }
body { name = "dumbbell", material = m, position = {0, 0, 0.5}, shapes = {
	{ shape = "sphere", position = {0.15, 0, 0}, radius = 0.1 },
	{ shape = "sphere", position = {-0.1, 0, 0.05}, radius = 0.08 } },
	velocity = {0, 0, 0.9247348671176967}, angular_velocity = {0, 0, -7.224651632021937} }
cylinder { name = "disc", material = m, radius = 0.06900488488254046, length = 0.050798687991140595,
	position = {0, 0, 1.786203882718401}, orientation = {0.9659258262890683, 0, 0.25881904510252074, 0} }
LUA
ends turns.lua

# two cylinders that roll on each other, with a friction of 1e3 and almost no force between them: past the cone slipping would
# go backwards (friction jams it), sticking is unlawful by less than the solver sees, and without a force they part. They stuck
# for pieces of one ulp of time without end
cat >parts.lua <<'LUA'
world { duration = 1.3, frame_rate = 30, gravity = {0, 0, 0} }
local m = material { name = "m", friction = 1000, restitution = 0 }
cylinder { name = "a", material = m, mass = 8.4869360699136074, radius = 0.95390853657733332, length = 1.9162318314931337,
	position = {0, 0, 0},
	orientation = {-0.1569275249185457, 0.1526518181215184, 0.16588324104784705, -0.96153727160552427},
	velocity = {-0.33484202867617185, 0.5183301827664083, -0.34387215098366103},
	angular_velocity = {0.14442010290914922, 0.88640720302106779, 0.25231039776933001} }
cylinder { name = "b", material = m, mass = 2.6643513464713484, radius = 0.67122995958096732, length = 0.71018056458646472,
	position = {0.17532805810565191, -1.9923789010319899, -1.0671108072115845},
	orientation = {0.41041486251726084, -0.39728819412827571, 0.23871652919194658, -0.7853255058393187},
	velocity = {0.27797938237111836, 1.4022967224924949, 0.57288441749162211},
	angular_velocity = {-1.4394333024553487, -1.9943969246886735, -1.3562894818371722} }
local parted = false
on_transition(function(c) parted = c.kind == "lift" end)
expect("they part", function() return parted end)
LUA
ends parts.lua

# of two points of a pair that jam, forces grow to 1e8 N: as one they have a force, and one of them alone has none
cat >jams.lua <<'LUA'
world { duration = 0.72, frame_rate = 60, gravity = {0, 0, -9.81} }
record { ledger = true }
local m = material { name = "m", friction = 2, restitution = 0, density = 1000 }
plane { name = "ground", material = m, normal = {0, 0, 1}, point = {0, 0, 0} }
hull { name = "first", material = m, position = {-0.014978357015111007, 0, 0.5},
	orientation = {0.7071067811865476, 0, 0.4999999999999999, 0.4999999999999999}, points = {
		{0.051892582159078604, 0.07916494435562194, 0.02363415130884791},
		{-0.1266757110642499, -0.01479942972591064, 0.12860082800249745},
		{0.08582267247958875, -0.048743265209232056, 0.12251841043290901},
		{0.08985978931949179, 0.10904444858503326, -2.8640615816616366e-05},
		{-0.18675144519467746, 0.07111176180961704, 0.07257008325688258},
		{0.15584182610723735, -0.019344805456864955, -0.1743787203105753} } }
hull { name = "second", material = m, position = {0.09009852981975694, 0.020100498149726143, 1.35},
	orientation = {0.0927252356038541, -0.7695266381393512, -0.6166635299890855, -0.13768396659581658},
	velocity = {-0.190157769397175, 0, 0}, points = {
		{0.09580094365795322, -0.0068655226800051206, -0.004091465657522997},
		{0.1427493916236044, -0.15699267774687187, 0.07294156184409789},
		{0.08779588824054452, -0.13769760737273745, 0.10816733542750745},
		{-0.13258332166462028, 0.1872178037626368, 0.1055961009156055},
		{-0.017626760798081398, 0.033586656866768594, 0.18956150119407383},
		{-0.053189469299931263, -0.1183574395076438, 0.07580844505778644},
		{0.16126097423676278, -0.13759900754428678, 0.10566577176672415},
		{-0.04447502317904051, 0.07493142356007837, -0.009105318781029548} } }
LUA
exits 0 run jams.lua --method located --no-record --quiet --json
# no impulse of a jam adds energy
gained=$(value gained_share)
awk -v gained="$gained" 'BEGIN { exit !(gained != "" && gained + 0 < 1e-13) }' || fail "energy gained: $gained"

# a corner that begins to slip: friction goes against the way that it takes, from the first moment on. The answers are of the one
# angle at which the slip that friction leaves goes against it, of 20,000 that were tried
cat >aims.lua <<'LUA'
world { duration = 0.001, gravity = {0, 0, -9.81}, frame_rate = 1000 }
local friction, answer = param("mu", 1000.0), param("answer", 0.02399)
local m = material { name = "m", friction = friction, restitution = 0 }
local n = vec3(0.010074551682450132, -0.1994761233125126, 0.97985089663509972)
plane { normal = n, point = {-0.14038313679684564, -0.013517391463426079, 0.010001426956827097}, material = m }
local b = hull { material = m, density = 1012.5741933238554,
	position = {0.030724506921540488, 0.05475785206434286, 0.26145080184844333},
	orientation = {-0.78063089568236477, 0.11932429909450142, -0.5521551644704229, 0.26739818754134304},
	velocity = {1.2764651821084598, -0.71135229651726106, -1.0636526344668349},
	angular_velocity = {2.190461011144738, 5.5613686920062779, -1.0906240813543426}, points = {
		{-0.053314945220296339, -0.035636182950495081, -0.3214980027268895},
		{0.35461873918997255, -0.38658200730092984, 0.34105389788332757},
		{0.20448462553232086, -0.42717146401991002, -0.17347065581378079},
		{-0.06294398773765951, 0.15818905616683063, 0.099285695775653507},
		{-0.12151439287633714, -0.020029120173359137, -0.17174447788408986},
		{-0.047785126217456078, -0.19821641762453732, -0.071686949549403661},
		{0.12848891609907562, 0.15782800939887046, -6.7480339954844031e-05},
		{-0.048706794655368785, -0.21401698058248142, 0.14248529932322429},
		{0.19591260679955766, 0.015640628476113898, -0.24194987908427013},
		{0.23508940152653093, -0.48714993866742173, -0.11747292504686463},
		{0.13215722524973234, -0.36759918759576743, 0.016777300172132061},
		{-0.24027807996330883, 0.1609321954195202, 0.15108392530238557},
		{0.025917806108351388, 0.082913878631396598, 0.059778812281401833} } }
local first
on_frame(function(t) first = first or (b.force - vec3(0, 0, -9.81) * b.mass):dot(n) end)
expect("its normal force", function() return math.abs(first / answer - 1), 1e-3 end)
LUA
for case in 0.3:16.56 10:2.154 100:0.2374 1000:0.02399; do
	exits 0 run aims.lua --method located --no-record -p mu="${case%:*}" -p answer="${case#*:}"
done
# two balls on a floor meet, and slide alike from then on: there is no force between them, and their accelerations differ by
# rounding, by which they touched again at the moment of the impact without end
cat >alike.lua <<'LUA'
world { duration = 0.02, gravity = {0, 0, -9.81} }
local m = material { friction = 0.5, restitution = 0 }
plane { name = "floor", material = m }
local a = sphere { name = "a", radius = 0.009, position = {-0.0095, 0, 0.009}, velocity = {0.3, 0, 0}, material = m }
local b = sphere { name = "b", radius = 0.009, position = {0.0095, 0, 0.009}, velocity = {-0.2, 0, 0}, material = m }
expect("they stay beside each other", function() return math.abs(b.position.x - a.position.x - 0.018) < 1e-15 end)
LUA
ends alike.lua

# of a small ball that falls along a wall, which it touches, the solver leaves 1e-16 of its weight as a force: a slip against its
# friction would begin backwards, and ended at once, without end
cat >along.lua <<'LUA'
world { duration = 0.037, gravity = {0, 0, -9.81} }
local m = material { friction = 0.5, restitution = 0.9 }
plane { name = "floor", material = m }
plane { name = "left", normal = {1, 0, 0}, point = {-0.00029313997798571535, 0, 0}, material = m }
plane { name = "right", normal = {-1, 0, 0}, point = {0.00029313997798571535, 0, 0}, material = m }
for _, ball in ipairs {
	{-0.00013104665932857178, 0.0001, 0.0096662003484489674, 0},
	{0.00013104665932857178, 0.000102426754030999, 0.017481137422062754, -0.0045084797468581059},
	{-0.00013104665932857178, 0.00031229012392895906, 0.038458893596201339, -0.024371055715377433},
	{0.00013104665932857178, 0.00031484040721394208, 0.0091839968866162559, -0.026948597900000246} } do
	sphere { radius = 0.0001, position = {ball[1], 0, ball[2]}, velocity = {ball[3], 0, ball[4]}, material = m }
end
LUA
ends along.lua

# the same until they come to rest: series of impacts of each with each, of which one pair's begins another's anew. As a jam
# they take 8,000 impacts, to their ends 50,000
exits 0 run along.lua --method located --no-record --quiet --json --duration 0.04
impacts=$(value collisions)
[ "$impacts" -lt 20000 ] || fail "balls that jam: $impacts impacts"
# of balls without restitution one rolls, meets its neighbour, and both begin to slide, 1e-13 s after the last time
cat >creeps.lua <<'LUA'
world { duration = 0.1, gravity = {0, 0, -9.81} }
local m = material { friction = 1, restitution = 0 }
plane { normal = {-0.47942553860420301, 0, 0.87758256189037276}, material = m }
plane { normal = {0.87758256189037276, 0, 0.47942553860420301}, material = m,
	point = {-0.026354241136051018, 0, -0.014397387550568316} }
plane { normal = {-0.87758256189037276, 0, -0.47942553860420301}, material = m,
	point = {0.026354241136051018, 0, 0.014397387550568316} }
for _, ball in ipairs {
	{-0.022461853226896145, -0.00063225285850628844, 0.24312499313207997, 0.13281978909130976},
	{-0.0047942553860420263, 0.0087758256189037296, 0.32162989752805649, 0.17570721382778046},
	{0.012756115229101658, 0.018398487093627108, -0.01039338642892056, -0.043226929956160912},
	{-0.032608991755907007, 0.017941959629363458, 0.18235279938820242, -0.11049254778164877} } do
	sphere { radius = 0.01, position = {ball[1], 0, ball[2]}, velocity = {ball[3], 0, ball[4]}, material = m }
end
LUA
ends creeps.lua

# a ball that rattles between two walls goes on over a fold of the floor by 1e-5 rad: where it meets with the second side in a jam,
# next to nothing parts from the first one, and only rest would stop both
cat >fold.lua <<'LUA'
local R, w = 0.05, 1e-3
world { duration = 0.12, frame_rate = 100, gravity = {0, 0, -9.81} }
local m, hard = material { friction = 0, restitution = 0 }, material { friction = 0, restitution = 1 }
contact_pair(m, hard, { friction = 0, restitution = 1 })
plane { material = m, point = {0, 0, -R} }
plane { material = m, normal = {-1e-5, 0, 1}, point = {0, 0, -R} }
plane { material = hard, normal = {0, 1, 0}, point = {0, -R - w, 0} }
plane { material = hard, normal = {0, -1, 0}, point = {0, R + w, 0} }
local ball = sphere { radius = R, material = m, position = {-0.1, 0, 0}, velocity = {1, 30, 0} }
expect("it goes on", function() return math.abs(ball.velocity.x - 1), 1e-5 end)
expect("it rattles on", function() return math.abs(math.abs(ball.velocity.y) - 30), 1e-12 end)
LUA
ends fold.lua

# two points of a cylinder jam in a crease: impulses that stop both cannot push them apart, and grew to 1e15 N s against each other,
# whose rounding was 2e-3 of the momentum
cat >crease.lua <<'LUA'
world { duration = 0.01, frame_rate = 100, gravity = {0, 0, -9.81} }
record { ledger = true }
local m = material { name = "m", friction = 1000, restitution = 0 }
terrain { size = {12, 12}, cells = {12, 12}, material = m, height = function(x, y)
	return 0.26355971943981188 * math.sin(0.8302163339161106 * x) * math.cos(-1.4347878227366466 * y)
end }
cylinder { material = m, mass = 3.9236018093086682, radius = 0.031000903040338951, length = 0.20684619726978787,
	position = {0.036201616376405128, 0.039931920434403793, 0.036064156210347489},
	orientation = {-0.26642730938309289, 0.64980965880793895, -0.12386085981836983, 0.7010152520023013},
	velocity = {-0.082292594384577686, 0.514612688874032, -0.1285052135889877},
	angular_velocity = {-22.435419588020107, -3.8877010250953061, -1.2014407022557665} }
LUA
exits 0 run crease.lua --method located --no-record --quiet --json
share=$(value momentum_share)
awk -v share="$share" 'BEGIN { exit !(share != "" && share + 0 < 1e-13) }' || fail "unexplained momentum: $share"

# a slip creeps on a body that others hold with forces that are open, at the limit of their friction: what turning the slip has
# left across it told these forces from others that hold, and pieces of 1e-9 s followed the way that it turned
cat >creeps.lua <<'LUA'
world { duration = 0.2846, frame_rate = 60, gravity = {0, 0, -9.81}, method = "located" }
local m = material { friction = 0.3, restitution = 0, density = 1000 }
plane { material = m, normal = {0.03470051710789559, 0, 0.9993977557071282} }
box { material = m, position = {0.0002384550933840256, 0, 0.15},
	orientation = {axis = {0.3036827199844168, -0.9106695781996853, -0.09989281341626048}, angle = 1.160217604050413},
	size = {0.08991390826713877, 0.09262454320917439, 0.07311523755224052} }
cylinder { material = m, position = {-0.0029399665107491357, 0, 0.4},
	orientation = {axis = {-1.5592449344085477, -1.3337344411051788, -0.30057515473387725}, angle = 1.1759453984379993},
	radius = 0.04506512764914857, length = 0.050789281519448885 }
box { material = m, position = {-0.00388062234364127, 0, 0.65},
	orientation = {axis = {-0.18732457885318185, -0.34725546206538305, -0.973044342429296}, angle = 2.7404256218793255},
	size = {0.14784503162583396, 0.11597744127795892, 0.146600946824728} }
LUA
exits 0 run creeps.lua --no-record --json --quiet
[ "$(value body_steps)" -lt 150000 ] || fail "a creeping slip among open forces: $(value body_steps) body steps"

# a hull leans on a ball that rolls away from it, which each impact between them lets slip for 2e-11 s. They overlap by rounding
# then, and what comes back after that was seen 1e-9 s later, when it was as fast as before: impacts without end
cat >leans.lua <<'LUA'
world { duration = 1.1e-5, gravity = {0, 0, -9.81}, method = "located" }
local m = material { friction = 1, restitution = 0.5, density = 1000 }
plane { material = m }
hull { material = m, position = {-0.034866358495226797, -0.059100538764937649, 0.0051786411369449349},
	orientation = {0.36338685692651157, -0.19938857251868433, -0.90066583691397195, 0.13036579144118632},
	velocity = {0.00082558136618845199, -0.044924417408524459, 0.058991154946907563},
	angular_velocity = {7.027980159311217, 0.12915402794666397, 1.4268140520793972e-14},
	points = {{-0.00507475, 0.000496861, 0.00216614}, {0.0179098, -0.00196621, -0.00308622},
		{0.000917441, 0.014774, -0.00490968}, {0.00338123, -0.00499537, 0.0129833}, {-0.00196146, 0.0164543, -0.00362179},
		{0.00862946, 0.0056029, -0.00904568}, {-0.00798955, -6.99705e-05, 0.000556713}, {0.0107137, 0.00584793, -0.00163884},
		{0.0145823, -0.00539725, 0.00816993}} }
sphere { material = m, radius = 0.018050831835504065,
	position = {-0.061815902162655138, -0.043765058546676186, 0.018050831855327978},
	velocity = {-0.0067759477269704561, -0.097883567137377128, -8.4040818724176855e-06},
	angular_velocity = {5.422776896173918, -0.37735125383608981, -6.4491554258615418} }
LUA
exits 0 run leans.lua --no-record --json --quiet
[ "$(value body_steps)" -lt 20000 ] || fail "a hull that leans on a ball: $(value body_steps) body steps"

# a slip of 1e-6 m/s that is to creep, beside one that sticks and one that slips: forces across it balance only the other way,
# in which it would stop at once and begin anew
cat >backwards.lua <<'LUA'
world { duration = 0.0003, frame_rate = 10000, gravity = {0, 0, -9.81} }
local m = material { name = "m", friction = 3, restitution = 0, density = 1000 }
plane { name = "ground", material = m, normal = {0.0459637926776572, 0, 0.9989431063692693} }
capsule { name = "b13", material = m, radius = 0.052170070842433025, length = 0.06132864791557722,
	position = {-0.020791805875280855, 0.35680265144353551, 0.055203492864045071},
	orientation = {0.36571815067089586, -0.68786063238461947, 0.21138929989394098, 0.59026481224586036},
	velocity = {0.028119691155714839, 0.070032530090249845, 0.018560865751209941},
	angular_velocity = {-1.5808302512368508, 0.79386608908128076, -0.62852851367554219} }
body { name = "b14", material = m, position = {0.11067764359770832, 0.31497797903629771, 0.023800425766450729},
	orientation = {0.99876092141094297, 0.0002105980052672078, -0.04976508578559919, 0.00011725014526087962},
	velocity = {0.00012428546244710835, -0.0005360720870030086, 9.1679054318646993e-05},
	angular_velocity = {0.017750801748051995, 0.0039757471242439198, -0.00081675739710050513},
	shapes = { { shape = "sphere", position = {0.03375873331142767, 0, 0}, radius = 0.03375873331142767 },
		{ shape = "box", position = {-0.027006986649142136, 0, 0},
			size = {0.06751746662285533, 0.0405104799737132, 0.0405104799737132} } } }
LUA
ends backwards.lua

# a box on two corners that stick, the load of which on the way between them nothing tells, in part at the limit of their friction;
# the smallest such forces go beyond it, others do not
cat >shares.lua <<'LUA'
world { duration = 0.0006, frame_rate = 10000, gravity = {0, 0, -9.81} }
local m = material { friction = 0.5, restitution = 0.5, density = 1000 }
plane { material = m }
box { material = m, position = {0.085731943389562706, -0.084068154478072143, 0.13544013694591267},
	orientation = {0.70644223894451696, 0.70045624431033948, -0.096752518347864302, 0.030649029920349232},
	velocity = {0.78448546562648569, -0.073881606340037126, -0.51069105693872352},
	angular_velocity = {0.54549270257708882, 5.7921195541892141, -2.1734875303786116e-15},
	size = {0.221367257784962, 0.23493628676378192, 0.28318828572579235} }
cylinder { material = m, position = {-0.025312665066980912, 0.00013102287079499092, 0.30606112680776337},
	orientation = {0.089585673455321327, 0.20696416918530719, 0.97418290857363454, 0.010387513080893357},
	velocity = {1.7253755045100916, -0.20682411671879317, 0.17049380376806497},
	angular_velocity = {0.5540419050484483, 5.7913144037572604, -0.047024609328308681},
	radius = 0.12514060545327024, length = 0.14331073433631758 }
hull { material = m, position = {-0.18787006568703701, -0.045132751540727718, 0.45608307066035264},
	orientation = {0.30898597187091159, 0.56120593000892272, -0.73377191172957157, 0.22617328504166534},
	velocity = {-2.0940086819204269, -0.52588693315690804, 1.5553282168050178},
	angular_velocity = {40.575355510307574, -7.5760173100558852, -6.8433830974026719},
	points = {
		{-0.0820012, 0.107219, 0.115697}, {0.0390152, -0.0755616, 0.107973}, {-0.107257, 0.0550829, -0.0186854}, {0.00943768, -0.0733467, 0.102836},
		{-0.0267372, 0.0931858, -0.0293998}, {-0.0418879, -0.0803116, 0.0677003}, {0.0148021, -0.0120798, 0.019394}, {-0.043387, 0.0741809, -0.0628723},
		{-0.0901116, 0.0329555, 0.0408056} } }
sphere { material = m, position = {0.0012098479006070345, -0.00032428043767033745, 0.57514337632961299},
	orientation = {0.99844259642157007, -0.016866839641979801, -0.053030866306787001, 0.0039520362090139328},
	velocity = {-0.085933937314363579, 0.019306196955273164, -0.60241194649258945},
	angular_velocity = {-1.5447044661816023, -12.393471706898845, 0.31828023507676972},
	radius = 0.18829862804206352 }
LUA
ends shares.lua

# two boxes, held together by a joint or by two, that slide on four corners until they stand: three would bear them, and of how
# the fourth is loaded it depends how they slide. The smallest forces would pull, and what was taken instead went after the
# forces of the joints in each piece anew, so that contacts went from these to the smallest, and back, in pieces of an ulp
cat >joined.lua <<'LUA'
local which, made = param("which", 1, ""), param("made", "fixed", "")
math.randomseed(which)
local function drawn(low, high) return low + (high - low) * math.random() end
local function vector(low, high) return vec3(drawn(low, high), drawn(low, high), drawn(low, high)) end
world { duration = 0.6, frame_rate = 20, gravity = {0, 0, -9.81} }
local axis, angle = vector(-1, 1):unit(), drawn(0, 3)
local m = material { name = "m", friction = 0.5, restitution = 0, density = 1000 }
plane { material = m }
local function turned(x)
	return math.cos(angle) * x + math.sin(angle) * axis:cross(x) + (1 - math.cos(angle)) * axis:dot(x) * axis
end
local size, other = vector(0.1, 0.3), vector(0.1, 0.3)
local off = turned(vec3((size.x + other.x) / 2, 0.02, -0.03))
local v = vec3(drawn(-1, 1), drawn(-1, 1), drawn(-2, 0))
local w = vector(-5, 5)
local share = other.x * other.y * other.z / (size.x * size.y * size.z + other.x * other.y * other.z)
local first = vec3(0, 0, 0.45)
local function part(s, place)
	return box { material = m, size = {s.x, s.y, s.z}, position = place, orientation = {axis = axis, angle = angle},
		velocity = v + w:cross(place - first - share * off), angular_velocity = w }
end
local a, b = part(size, first), part(other, first + off)
local keys = {kind = made, a = a, b = b, at = first + 0.5 * off}
if made == "hinge" then
	keys.axis = turned(vec3(0.3, 0.4, 0.5))
	joint { kind = "ball", a = a, b = b, at = first + turned(vec3(0.1, 0.2, 0.05)) }
end
joint(keys)
expect("they stand", function() return a.velocity:length() + a.angular_velocity:length(), 0 end)
LUA
for which in '1 fixed' '3 hinge'; do
	exits 0 run joined.lua --method located --no-record --quiet --param which="${which% *}" --param made="${which#* }"
done

# a box with its load near a corner slides and turns on four: the same however the scene is turned (by 2e-6 m otherwise before)
cat >corner.lua <<'LUA'
local a = param("turned", 0.0, "")
local function turned(x, y) return {math.cos(a) * x - math.sin(a) * y, math.sin(a) * x + math.cos(a) * y, 0} end
world { duration = 0.9, frame_rate = 10, gravity = {0, 0, -9.81} }
local m = material { friction = 0.4, restitution = 0.2 }
plane { material = m }
local b = box { material = m, mass = 1, size = {0.5, 0.6, 0.4}, center_of_mass = {0.12, 0.12, 0}, position = {0, 0, 0.2},
	orientation = {axis = {0, 0, 1}, angle = a}, velocity = turned(1.5, 1), angular_velocity = {0, 0, 9} }
expect("its way", function()
	local p = b.position
	print(string.format("way %.12f %.12f", math.cos(a) * p.x + math.sin(a) * p.y, math.cos(a) * p.y - math.sin(a) * p.x))
	return b.velocity:length(), 0
end)
LUA
for turned in 0.0 0.7 2.1; do
	exits 0 run corner.lua --method located --no-record --param turned=$turned
	sed -n 's/^way //p' out err
done | awk '{x = $1 - first[1]; y = $2 - first[2]}
	NR == 1 {first[1] = $1; first[2] = $2}
	NR > 1 && (x * x + y * y > 1e-18) {bad = 1}
	END {exit NR != 3 || bad}' || fail "a box that slides and turns goes otherwise where the scene is turned"
