# SPDX-License-Identifier: MIT
"""Signed gaps between convex pieces, many pairs at a time, from support functions alone.

The gap of A and B is the largest s(n) over unit directions n, where s(n) = min over B of n.x - max over A of n.x: what
parts them along n. Any n gives a lower bound, so a gap that is found is never larger than the true one: an overlap that
is there cannot be missed, whatever becomes of the iteration. For pieces that are apart the best n is that of the
nearest points, which Gilbert's iteration finds (a hull of at most four points that comes nearest to the origin).
For pieces that overlap by little, B is put off by m along the best direction so far, and the nearest points of
the two, now apart, give the next one: since n.u = 1 - |n - u|^2/2, the distance of the shifted pair is the largest
s(n) + m - m |n - u|^2/2, a step of the proximal point method, which never makes s less and ends at once on faces.
"""
import numpy as np

from recording import dot

FINE = 1e-12  # of the size of a pair: the iteration ends where upper and lower bound are so close
ROUNDS, STEPS = 60, 12
DIRECTIONS_MOST = 2000  # of one pair: more edges than that are left to the iteration
ROWS = 4096


class Batch:
    """Pieces of K pairs' one side, as arrays: vertices [K, V, 3] from an origin of the pair, discs, balls."""

    def __init__(self, pieces, which, position, rotation):
        widest = max(len(p.vertices) for p in pieces)
        table = np.stack([np.concatenate([p.vertices] + [p.vertices[:1]] * (widest - len(p.vertices)))
                          for p in pieces])
        self.vertices = np.einsum("kij,kvj->kvi", rotation, table[which]) + position[:, None]
        self.ball = np.array([p.ball for p in pieces])[which]
        self.disc = np.array([p.disc for p in pieces])[which]
        self.axis = np.einsum("kij,kj->ki", rotation, np.stack([p.axis for p in pieces])[which])

    def part(self, rows):
        other = object.__new__(Batch)
        for name, value in self.__dict__.items():
            setattr(other, name, value[rows])
        return other

    def farthest(self, n):
        """The point of the core that is farthest along n [K, 3]."""
        along = np.einsum("kvi,ki->kv", self.vertices, n)
        at = self.vertices[np.arange(len(n)), along.argmax(1)]
        if self.disc.any():
            aside = n - dot(n, self.axis)[:, None] * self.axis
            length = np.sqrt(dot(aside, aside))
            aside /= np.where(length > 0, length, 1)[:, None]
            # along the axis what is left is rounding, and not across it
            aside -= dot(aside, self.axis)[:, None] * self.axis
            at = at + self.disc[:, None] * aside
        return at

    def height(self, n):
        """Support function of the core for unit directions [K, C, 3] -> [K, C]."""
        reach = np.einsum("kvi,kci->kvc", self.vertices, n).max(1)
        if self.disc.any():
            cosine = np.einsum("kci,ki->kc", n, self.axis)
            reach = reach + self.disc[:, None] * np.linalg.norm(n - cosine[:, :, None] * self.axis[:, None], axis=2)
        return reach


def nearest_of(simplex, count):
    """The point of each hull of 1 to 4 points [K, 4, 3], the last of `count` the newest, that is nearest to the origin,
    and which of its points it needs. The newest is always needed, or nothing has been gained."""
    k = len(simplex)
    rows = np.arange(k)
    newest = simplex[rows, count - 1]
    best, keep = newest.copy(), np.zeros((k, 4), bool)
    keep[rows, count - 1] = True
    least = dot(best, best)

    def offer(v, valid, members):
        nonlocal best, least, keep
        size = dot(v, v)
        better = valid & (size < least)
        best = np.where(better[:, None], v, best)
        least = np.where(better, size, least)
        mask = np.zeros((k, 4), bool)
        mask[rows, count - 1] = True
        for m in members:
            mask[:, m] = True
        keep = np.where(better[:, None], mask, keep)

    others = [0, 1, 2]
    for i in others:
        there = count - 1 > i
        e = simplex[:, i] - newest
        ee = dot(e, e)
        t = -dot(newest, e) / np.where(ee > 0, ee, 1)
        offer(newest + t[:, None] * e, there & (ee > 0) & (t > 0) & (t <= 1), [i])
    for i, j in ((0, 1), (0, 2), (1, 2)):
        there = count - 1 > j
        e, f = simplex[:, i] - newest, simplex[:, j] - newest
        n = np.cross(e, f)
        nn = dot(n, n)
        safe = np.where(nn > 0, nn, 1)
        s = dot(np.cross(f, newest), n) / safe
        t = dot(np.cross(newest, e), n) / safe
        v = n * (dot(newest, n) / safe)[:, None]
        offer(v, there & (nn > 0) & (s >= 0) & (t >= 0) & (s + t <= 1), [i, j])
    full = count == 4
    if full.any():
        e, f, g = (simplex[:, i] - newest for i in others)
        volume = dot(np.cross(e, f), g)
        safe = np.where(volume != 0, volume, 1)
        s = -dot(np.cross(f, g), newest) / safe
        t = -dot(np.cross(g, e), newest) / safe
        u = -dot(np.cross(e, f), newest) / safe
        inside = full & (volume != 0) & (s >= 0) & (t >= 0) & (u >= 0) & (s + t + u <= 1)
        offer(np.zeros_like(newest), inside, others)
    return best, keep


def nearest(a, b, shift, size):
    """The direction from a to b, shifted, along which the cores are farthest apart, and how far: at most the distance.
    Where they overlap, zero or what was found."""
    k = len(size)
    simplex, count = np.zeros((k, 4, 3)), np.zeros(k, int)
    v = b.vertices.mean(1) + shift - a.vertices.mean(1)
    v = np.where(dot(v, v)[:, None] > 0, v, [[0, 0, 1.0]])
    best, normal = np.full(k, -np.inf), v / np.linalg.norm(v, axis=1, keepdims=True)
    live = np.arange(k)
    for _ in range(ROUNDS):
        length = np.linalg.norm(v[live], axis=1)
        n = v[live] / length[:, None]
        pa, pb = a.part(live), b.part(live)
        w = pb.farthest(-n) + shift[live] - pa.farthest(n)
        low = dot(n, w)
        better = low > best[live]
        best[live] = np.where(better, low, best[live])
        normal[live] = np.where(better[:, None], n, normal[live])
        first = count[live] == 0
        same = (simplex[live] == w[:, None]).all(2) & (np.arange(4) < count[live][:, None])
        done = ~first & (length - best[live] <= FINE * size[live]) | same.any(1)
        live, w = live[~done], w[~done]
        if len(live) == 0:
            break
        simplex[live, count[live]] = w
        count[live] += 1
        point, keep = nearest_of(simplex[live], count[live])
        order = np.argsort(~keep, axis=1, kind="stable")
        simplex[live] = np.take_along_axis(simplex[live], order[:, :, None], 1)
        count[live] = keep.sum(1)
        v[live] = point
        live = live[dot(point, point) > (1e-15 * size[live]) ** 2]
        if len(live) == 0:
            break
    return best, normal


def best_of(pieces, which, rotation, a, b):
    """The best of the directions that shapes offer, and what it parts: cores only."""
    k = len(which[0])
    best, normal = np.full(k, -np.inf), np.zeros((k, 3))
    keys = which[0] * len(pieces) + which[1]
    for key in np.unique(keys):
        rows = np.nonzero(keys == key)[0]
        pa, pb = pieces[key // len(pieces)], pieces[key % len(pieces)]
        for part in np.array_split(rows, -(-len(rows) // 256)):
            made = []
            turned = {0: (pa, rotation[0][part]), 1: (pb, rotation[1][part])}
            for p, r in turned.values():
                if len(p.normals):
                    made.append(np.einsum("kij,cj->kci", r, p.normals))
            ea, eb = (np.einsum("kij,cj->kci", r, p.edges) for p, r in turned.values())
            if 0 < ea.shape[1] * eb.shape[1] <= DIRECTIONS_MOST:
                n = np.cross(ea[:, :, None], eb[:, None]).reshape(len(part), -1, 3)
                length = np.linalg.norm(n, axis=2, keepdims=True)
                fallback = b.vertices[part].mean(1) - a.vertices[part].mean(1) + 1e-300
                fallback /= np.linalg.norm(fallback, axis=1, keepdims=True)
                made.append(np.where(length > 1e-9, n / np.where(length > 1e-9, length, 1), fallback[:, None]))
            middle = b.vertices[part].mean(1) - a.vertices[part].mean(1)
            length = np.linalg.norm(middle, axis=1, keepdims=True)
            made.append(np.where(length > 0, middle / np.where(length > 0, length, 1), [[0, 0, 1.0]])[:, None])
            n = np.concatenate(made, 1)
            n = np.concatenate([n, -n], 1)
            s = -b.part(part).height(-n) - a.part(part).height(n)
            at = s.argmax(1)
            rows_here = np.arange(len(part))
            best[part], normal[part] = s[rows_here, at], n[rows_here, at]
    return best, normal


def close_gaps(pieces, which, position, rotation):
    """Gap and normal of each of K pairs: which = (a, b) numbers of pieces, poses of each side."""
    k = len(which[0])
    gap, normal = np.empty(k), np.empty((k, 3))
    for rows in np.array_split(np.arange(k), -(-k // ROWS)) if k else []:
        gap[rows], normal[rows] = some_gaps(pieces, [w[rows] for w in which], [p[rows] for p in position],
                                            [r[rows] for r in rotation])
    return gap, normal


def some_gaps(pieces, which, position, rotation):
    zero = np.zeros_like(position[0])
    a = Batch(pieces, which[0], zero, rotation[0])
    b = Batch(pieces, which[1], position[1] - position[0], rotation[1])
    reach = np.array([np.linalg.norm(p.vertices, axis=1).max() + p.disc for p in pieces])
    ball = a.ball + b.ball
    size = reach[which[0]] + reach[which[1]] + ball
    best, normal = nearest(a, b, zero, size)
    # cores that are well apart are done; others may be deeper than what was found
    rows = np.nonzero(best < 1e-3 * size)[0]
    if len(rows):
        pa, pb = a.part(rows), b.part(rows)
        s, n = best_of(pieces, [w[rows] for w in which], [r[rows] for r in rotation], pa, pb)
        better = s > best[rows]
        s = np.where(better, s, best[rows])
        n = np.where(better[:, None], n, normal[rows])
        for k in range(STEPS):
            # where many directions part as well, slopes are those of the overlap, and m must not be far above it
            m = np.maximum(10.0 ** -min(3 + k, 7) * size[rows], 2 * np.abs(s))
            _, new = nearest(pa, pb, m[:, None] * n, size[rows])
            got = -pb.height(-new[:, None])[:, 0] - pa.height(new[:, None])[:, 0]
            gained = got - s
            n = np.where((gained > 0)[:, None], new, n)
            s = np.maximum(s, got)
            if k >= 4 and not (gained > FINE * size[rows]).any():
                break
        best[rows], normal[rows] = s, n
    return best - ball, normal


def parted(pieces, which, position, rotation, n):
    """s(n) of pairs along given unit directions."""
    a = Batch(pieces, which[0], np.zeros_like(position[0]), rotation[0])
    b = Batch(pieces, which[1], position[1] - position[0], rotation[1])
    n = n[:, None]
    return -b.height(-n)[:, 0] - a.height(n)[:, 0] - a.ball - b.ball
