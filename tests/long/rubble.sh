#!/bin/sh
# SPDX-License-Identifier: MIT
# The middle of a heap that its own gravitation holds is pressed as that of a fluid ball, whose pressure is (2 pi/3) G rho^2 (R^2 -
# r^2): the mean within a third of the radius, 14/15 of that at r = 0, against the mean stress of a thousand grains there, from the
# forces in their contacts, sum f . l/(3 V). Friction lets outer layers carry some of it.
. tests/cli/functions

cp "$TOP"/scenes/verify/rubble.lua .
cat >heap.lua <<'END_OF_SCENE'
local rubble = require "rubble"
local count = 1000
local radius = (0.6 / count) ^ (1 / 3)
world { duration = 8, frame_rate = 1, time_step = 5e-3, gravitation = {G = 1}, method = "stepped" }
record { fields = {"+", "contacts"} }
local stone = material { name = "stone", friction = 0.5, restitution = 0.3 }
rubble.cloud { count = count, radius = radius, spacing = 2.05 * radius, mass = 1 / count, material = stone }
expect("overlap, m", function() return max_penetration(), 1e-4 * radius end)
END_OF_SCENE
exits 0 heap.lua -o heap.h5
exits 0 export heap.h5 --to csv -o heap
python3 - <<'END_OF_PYTHON' || fail 'the stress in the middle is not that of a fluid ball'
import csv, math
radius = (0.6 / 1000) ** (1 / 3)
at = {int(r["id"]): [float(r[k]) for k in "xyz"] for r in csv.DictReader(open("heap-bodies.csv")) if r["frame"] == "8"}
middle = [sum(p[k] for p in at.values()) / len(at) for k in range(3)]
def away(p): return math.dist(p, middle)
# of the homogeneous ball with the same second moments, grains included
R = math.sqrt(5 / 3 * (sum(away(p) ** 2 for p in at.values()) / len(at) + 0.6 * radius ** 2))
density = 1 / (4 / 3 * math.pi * R ** 3)
inner, sum_fl = R / 3, 0
for r in csv.DictReader(open("heap-contacts.csv")):
    if r["frame"] != "8":
        continue
    a, b = at[int(r["a"])], at[int(r["b"])]
    way = [y - x for x, y in zip(a, b)]
    # the part of the line from centre to centre that is within
    share = sum(away([x + w * (s + 0.5) / 100 for x, w in zip(a, way)]) < inner for s in range(100)) / 100
    sum_fl += share * sum(float(r[f]) * w for f, w in zip(("fx", "fy", "fz"), way))
pressure, fluid = sum_fl / (4 * math.pi * inner ** 3), 14 / 15 * 2 * math.pi / 3 * density ** 2 * R ** 2
print(f"pressure {pressure:.4f}, of a fluid ball {fluid:.4f}: {pressure / fluid:.3f}")
raise SystemExit(not abs(pressure / fluid - 1) <= 0.2)
END_OF_PYTHON
