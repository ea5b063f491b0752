#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""The oracle's gaps against closed forms, and against what moving a body by a known way does to them."""
import sys

try:
    import numpy as np
except ImportError as error:
    print("numpy is needed:", error)
    sys.exit(77)

from gaps import close_gaps, parted
from recording import BOX, CAPSULE, CYLINDER, HULL, RECTANGLE, SPHERE, dot, matrices, piece_of

COUNT = 60
RANDOM = np.random.default_rng(7)
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
FACES = [np.array(f) for f in ([0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3])]
SHAPES = {
    "sphere": piece_of(SPHERE, 0.5, (0, 0, 0), None),
    "box": piece_of(BOX, 0, (1, 2, 3), None),
    "rectangle": piece_of(RECTANGLE, 0, (1, 2, 0), None),
    "capsule": piece_of(CAPSULE, 0.3, (0, 0, 1), None),
    "cylinder": piece_of(CYLINDER, 0.7, (0, 0, 1.5), None),
    "hull": piece_of(HULL, 0, (0, 0, 0), (CORNERS, FACES)),
}


def turns():
    return matrices(RANDOM.normal(size=(COUNT, 4)))


def directions():
    u = RANDOM.normal(size=(COUNT, 3))
    return u / np.linalg.norm(u, axis=1, keepdims=True)


def outside(q, half):
    """Signed distance of points from a box."""
    d = np.abs(q) - half
    return np.linalg.norm(np.maximum(d, 0), axis=-1) + np.minimum(d.max(-1), 0)


def balls():
    """A ball at random places, also within: signed distances of a point have closed forms."""
    r, p = turns(), RANDOM.normal(size=(COUNT, 3)) * 1.2
    q = np.einsum("kji,kj->ki", r, p)
    around = np.stack([np.hypot(q[:, 0], q[:, 1]), q[:, 2]], 1)
    flat = np.concatenate([np.maximum(np.abs(q[:, :2]) - [0.5, 1], 0), q[:, 2:]], 1)
    axis = np.stack([around[:, 0], np.maximum(np.abs(q[:, 2]) - 0.5, 0)], 1)
    normals = np.array([[-1, 0, 0], [0, -1, 0], [0, 0, -1], np.ones(3) / np.sqrt(3)])
    planes = (q @ normals.T - [0, 0, 0, 1 / np.sqrt(3)]).max(1)
    wanted = {"box": outside(q, [0.5, 1, 1.5]), "rectangle": np.linalg.norm(flat, axis=1),
              "capsule": np.linalg.norm(axis, axis=1) - 0.3, "cylinder": outside(around, [0.7, 0.75]),
              "hull": np.where(planes < 0, planes, np.nan)}
    for name, exact in wanted.items():
        pieces = [SHAPES[name], SHAPES["sphere"]]
        which = np.zeros(COUNT, int), np.ones(COUNT, int)
        gap, _ = close_gaps(pieces, which, (np.zeros((COUNT, 3)), p), (r, turns()))
        # from deep inside other faces are as near, or nearly: the overlaps that matter are a thousandth of the size
        rows = ~np.isnan(exact) & (exact > -1e-3)
        yield f"ball and {name}", np.abs(gap - exact + 0.5)[rows].max(initial=0), 1e-10


def pairs():
    """Two bodies at random that are put together along their normal, and then by d more: they overlap by at most d."""
    names = list(SHAPES)
    for k, a in enumerate(names):
        for b in names[k:]:
            pieces, which = [SHAPES[a], SHAPES[b]], (np.zeros(COUNT, int), np.ones(COUNT, int))
            ra, rb, u = turns(), turns(), directions()
            zero = np.zeros((COUNT, 3))
            apart = -parted(pieces, which, (zero, zero), (ra, rb), u)[:, None] * u
            gap, n = close_gaps(pieces, which, (zero, apart), (ra, rb))
            yield f"{a} and {b}: below what is known", max(0, -gap.min()), 1e-9
            for d in (0, 1e-6):
                place = apart - (gap + d)[:, None] * n
                deep, m = close_gaps(pieces, which, (zero, place), (ra, rb))
                known = parted(pieces, which, (zero, place), (ra, rb), m)
                yield f"{a} and {b}: at least {-d:g}", max(0, (-d - deep).max()), 1e-9 + 0.2 * d
                yield f"{a} and {b}: its own normal", np.abs(known - deep).max(), 1e-12
                if d == 0:  # further on, corners may miss each other
                    yield f"{a} and {b}: not apart", max(0, deep.max()), 1e-9


def mirrored():
    """From b to a it is the same gap, the other way."""
    pieces, one, two = [SHAPES["cylinder"], SHAPES["box"]], np.zeros(COUNT, int), np.ones(COUNT, int)
    ra, rb, p = turns(), turns(), 1.6 * directions()
    zero = np.zeros((COUNT, 3))
    g, n = close_gaps(pieces, (one, two), (zero, p), (ra, rb))
    h, m = close_gaps(pieces, (two, one), (p, zero), (rb, ra))
    rows = g > -1e-3
    yield "either way", np.abs(g - h)[rows].max(initial=0), 1e-10
    yield "normals", (dot(n, m)[g > 1e-3] + 1).max(initial=0), 1e-8


def main():
    failed = 0
    for make in (balls, pairs, mirrored):
        for name, measured, bound in make():
            if not measured <= bound:
                print(f"FAIL {name}: {measured:.3g}, bound {bound:.3g}")
                failed += 1
    print("gaps:", "ok" if not failed else f"{failed} fail")
    return failed > 0


if __name__ == "__main__":
    sys.exit(main())
