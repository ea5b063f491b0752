# SPDX-License-Identifier: MIT
"""Gaps of all pairs of bodies at chosen frames, beside what the recording says of the deepest overlap."""
import numpy as np

from gaps import close_gaps
from recording import PLANE, dot, matrices, turn

PRECISION = 1e-11  # of a gap, of the size of the pair; what gaps.py reaches is about a tenth of it


class Geometry:
    """All distinct pieces of a recording, which bodies have which, and spheres around both."""

    def __init__(self, rec):
        self.rec, self.pieces, number = rec, [], {}
        self.of = []
        for made in rec.pieces:
            row = []
            for p in made:
                if id(p) not in number:
                    number[id(p)] = len(self.pieces)
                    self.pieces.append(p)
                row.append(number[id(p)])
            self.of.append(row)
        self.middle = np.array([p.middle for p in self.pieces]).reshape(-1, 3)
        self.reach = np.array([p.reach for p in self.pieces])
        self.point = np.array([len(p.vertices) == 1 and p.disc == 0 for p in self.pieces], bool)
        self.plane = rec.kind == PLANE
        self.solid = np.nonzero(~self.plane)[0]
        self.planes = np.nonzero(self.plane)[0]
        # of bodies, in object coordinates
        self.center, self.radius = np.zeros((len(self.of), 3)), np.zeros(len(self.of))
        for i, row in enumerate(self.of):
            if row:
                self.center[i] = self.middle[row].mean(0)
                self.radius[i] = (np.linalg.norm(self.middle[row] - self.center[i], axis=1) + self.reach[row]).max()

    def spread(self, frame, i, j):
        """Piece pairs of body pairs: rows (frame, i, j, piece of i, piece of j)."""
        rows = [(f, a, b, p, q) for f, a, b in zip(frame, i, j) for p in self.of[a] for q in self.of[b]]
        return np.array(rows, int).reshape(-1, 5).T

    def near(self, frame):
        """Pairs of bodies, planes apart, whose spheres touch, and how many pairs can meet at all."""
        rec, s = self.rec, self.solid
        p, r = rec.pose(frame, s)
        c, radius = p + turn(r, self.center[s]), self.radius[s]
        found, pairs = [], 0
        order = np.arange(len(s))
        for k in range(len(s)):
            rest = order[k + 1:]
            ok = rec.can_meet(s[k], s[rest])
            pairs += int(ok.sum())
            d = c[rest] - c[k]
            close = ok & (dot(d, d) <= (radius[k] + radius[rest]) ** 2)
            found.extend((s[k], s[m]) for m in rest[close])
        return np.array(found, int).reshape(-1, 2), pairs

    def gaps(self, frame, i, j):
        """Signed gaps and normals from i to j of body pairs without planes; of unions that of the nearest pieces."""
        f, a, b, p, q = self.spread(frame, i, j)
        pa, ra = self.rec.pose(f, a)
        pb, rb = self.rec.pose(f, b)
        apart = pb + turn(rb, self.middle[q]) - pa - turn(ra, self.middle[p])
        gap = np.linalg.norm(apart, axis=1) - self.reach[p] - self.reach[q]
        normal = np.zeros((len(f), 3))
        both = self.point[p] & self.point[q]
        length = np.linalg.norm(apart, axis=1)
        normal[both] = apart[both] / np.where(length > 0, length, 1)[both][:, None]
        rows = np.nonzero(~both & (gap <= 0))[0]
        if len(rows):
            gap[rows], normal[rows] = close_gaps(self.pieces, (p[rows], q[rows]), (pa[rows], pb[rows]),
                                                 (ra[rows], rb[rows]))
        size = self.reach[p] + self.reach[q]
        return f, a, b, gap, normal, size

    def touch(self, frame, body, partner):
        """Which bodies of these rows touch another than `partner` (-1: any) at their frames, with force or without."""
        found = np.zeros(len(frame), bool)
        for f in np.unique(frame):
            pairs, _ = self.near(f)
            rows = np.nonzero(frame == f)[0]
            some = pairs[np.isin(pairs, body[rows]).any(1)]
            if len(some):
                _, a, b, gap, _, size = self.gaps(np.full(len(some), f), some[:, 0], some[:, 1])
                close = gap <= 1e-9 * size
                some = np.stack([a[close], b[close]], 1)
            for r in rows:
                mine = some[(some == body[r]).any(1)]
                found[r] = (mine.sum(1) - body[r] != partner[r]).any()
                for plane in self.planes[self.planes != partner[r]]:
                    gap, _ = self.above(np.array([f]), body[r:r + 1], np.array([plane]))
                    found[r] |= bool(gap[0] <= 1e-9 * self.radius[body[r]])
        return found

    def above(self, frame, i, plane):
        """Gaps of bodies from an infinite plane, both one body or arrays, and the plane's normal."""
        p, r = self.rec.pose(frame, plane)
        n = r[..., 2]
        pa, ra = self.rec.pose(frame, i)
        least = np.full(len(pa), np.inf)
        rows_of = {}
        for row, body in enumerate(np.broadcast_to(i, len(pa))):
            for piece in self.of[body]:
                rows_of.setdefault(piece, []).append(row)
        for number, rows in rows_of.items():
            piece, m = self.pieces[number], n[rows] if n.ndim > 1 else np.broadcast_to(n, (len(rows), 3))
            x = turn(ra[rows][:, None], piece.vertices[None])
            low = np.einsum("kvi,ki->kv", x, m).min(1) - piece.ball
            if piece.disc:
                axis = ra[rows] @ piece.axis
                low -= piece.disc * np.linalg.norm(np.cross(axis, m), axis=1)
            low += dot(pa[rows] - (p[rows] if p.ndim > 1 else p), m)
            np.minimum.at(least, rows, low)
        return least, n


def chosen(rec, count):
    """Frames to look at: the first, the last, those of the deepest overlaps that were told, and some between."""
    if rec.frames <= count:
        return np.arange(rec.frames)
    told = np.argsort(-rec.observed["max_penetration"], kind="stable")[:max(1, count // 4)]
    between = np.linspace(0, rec.frames - 1, max(2, count - len(told))).round().astype(int)
    return np.unique(np.concatenate([told, between]))


def rounding(rec, frame, i):
    """How far coordinates of a body are rounded."""
    p, _ = rec.pose(frame, i)
    return 64 * rec.unit * np.abs(p).max(-1)


def check(rec, report, geometry, count=24, pairs_most=20000):
    if rec.position is None or rec.orientation is None or rec.bodies == 0:
        report.skip("overlap", "poses are not recorded")
        return
    told, close, pairs, deepest = rec.observed["max_penetration"], 0, 0, 0.0
    movers = geometry.solid[rec.yields(geometry.solid)]
    for frame in chosen(rec, count):
        found, many = geometry.near(frame)
        pairs += many + len(movers) * len(geometry.planes)
        worst, slack, who = 0.0, 0.0, None
        if len(found):
            at = np.full(len(found), frame)
            _, a, b, gap, _, size = geometry.gaps(at, found[:, 0], found[:, 1])
            k = gap.argmin()
            if -gap[k] > worst:
                worst, who = -gap[k], (a[k], b[k])
            slack = max(slack, PRECISION * size[k] + rounding(rec, frame, a[k]) + rounding(rec, frame, b[k]))
        for plane in geometry.planes:
            some = movers[rec.can_meet(movers, np.full(len(movers), plane))]
            if not len(some):
                continue
            gap, _ = geometry.above(np.full(len(some), frame), some, np.full(len(some), plane))
            k = gap.argmin()
            if -gap[k] > worst:
                worst, who = -gap[k], (some[k], plane)
            slack = max(slack, 64 * rec.unit * geometry.radius[some[k]] + rounding(rec, frame, some[k])
                        + rounding(rec, frame, plane))
        deepest, where = max(deepest, worst), f"frame {frame}" + (f", {rec.label(who)}" if who else "")
        stepped = rec.observed["stepped"][frame] > 0 or rec.method == "classic"
        report.bound("overlap told", worst - told[frame], slack, where, "m")
        if not stepped:
            report.bound("overlap told, located", told[frame] - worst, slack, where, "m")
        if rec.rollback != "none":
            report.bound("overlap", worst, rec.tolerance[frame] * (1 + 1e-9) + slack, where, "m")
        close += len(found)
        if close > pairs_most:
            break
    report.count("pairs", pairs)
    report.number("deepest", deepest)
    report.number("told", float(told.max(initial=0)))
