# SPDX-License-Identifier: MIT
"""Recorded contacts: their points lie on both bodies, their normals part them, their forces push and obey friction.

Where the bodies were located to rounding, so is all this. Under steps a row is about the step that ends at the frame:
points and normals may be those of its beginning, off by the way that the bodies make in it.
"""
import numpy as np

import gaps
from mechanics import touched
from overlaps import PRECISION, rounding
from recording import PLANE, Piece, dot, matrices, turn

ANGLE = 1e-9  # of a located normal: what doubles leave of one between features that are a thousandth of the body


class Rows:
    """Points between two bodies with a normal, at frames or at moments between them."""

    def __init__(self, rec, geometry, table, rows, pose):
        """`pose`: of bodies at these rows, (rows, indices) -> positions and matrices."""
        self.rec, self.geometry, self.rows = rec, geometry, rows
        self.i, self.j = table["i"][rows], table["j"][rows]
        self.point, self.normal = table["point"][rows], table["normal"][rows]
        self.pose_i, self.pose_j = pose(rows, self.i), pose(rows, self.j)

    def surface(self):
        """Signed distances of the points from both bodies' surfaces: [rows] each, and the nearest piece."""
        return [self.from_body(self.i, self.pose_i), self.from_body(self.j, self.pose_j)]

    def from_body(self, body, pose):
        g, n = self.geometry, len(self.rows)
        gap, piece = np.full(n, np.inf), np.full(n, -1)
        plane = g.plane[body]
        p, r = pose
        gap[plane] = dot(self.point[plane] - p[plane], r[plane][..., 2])
        owner = [(k, q) for k in np.nonzero(~plane)[0] for q in g.of[body[k]]]
        if owner:
            k, q = np.array(owner).T
            far = self.distance(k, q, p, r)
            for row, number, d in zip(k, q, far):
                if d < gap[row]:
                    gap[row], piece[row] = d, number
        return gap, piece

    def distance(self, k, q, p, r):
        """From points to pieces: a point is a ball without size."""
        g = self.geometry
        pieces = g.pieces + [Piece([[0, 0, 0]])]
        dust = np.full(len(k), len(g.pieces))
        offset = self.point[k] - p[k]
        center = turn(r[k], g.middle[q])
        far = np.linalg.norm(offset - center, axis=1) - g.reach[q]
        simple = g.point[q]
        near = np.nonzero(~simple & (far <= 0.1 * g.reach[q]))[0]
        if len(near):
            zero = np.zeros((len(near), 3))
            eye = np.broadcast_to(np.eye(3), (len(near), 3, 3))
            far[near], _ = gaps.close_gaps(pieces, (q[near], dust[near]), (zero, offset[near]), (r[k][near], eye))
        return far

    def parted(self, piece_i, piece_j):
        """What the normals part the nearest pieces by; NaN where one is a plane, whose normal is asked instead."""
        g, s = self.geometry, np.full(len(self.rows), np.nan)
        rows = np.nonzero((piece_i >= 0) & (piece_j >= 0))[0]
        if len(rows):
            (pi, ri), (pj, rj) = self.pose_i, self.pose_j
            s[rows] = gaps.parted(g.pieces, (piece_i[rows], piece_j[rows]), (pi[rows], pj[rows]),
                                  (ri[rows], rj[rows]), self.normal[rows])
        return s

    def from_plane(self):
        """How far normals are off those of the planes: NaN where none is one."""
        off = np.full(len(self.rows), np.nan)
        for body, (_, r), sign in ((self.i, self.pose_i, 1), (self.j, self.pose_j, -1)):
            plane = self.geometry.plane[body]
            off[plane] = np.linalg.norm(self.normal[plane] - sign * r[plane][:, :, 2], axis=1)
        return off

    def size(self):
        """Of the smaller of the two."""
        radius = np.where(self.geometry.plane, np.inf, self.geometry.radius)
        return np.minimum(radius[self.i], radius[self.j])

    def slack(self):
        big = np.maximum(self.geometry.radius[self.i], self.geometry.radius[self.j])
        at = np.maximum(np.abs(self.pose_i[0]).max(1), np.abs(self.pose_j[0]).max(1))
        return PRECISION * big + 16 * self.rec.unit * np.maximum(at, np.abs(self.point).max(1))


def velocities(rec, frame, i, point):
    x, v, w = rec.motion(frame, i)
    return v + np.cross(w, point - x)


def check(rec, report, geometry, rows_most=4000):
    t = rec.contacts
    if t is None or rec.position is None or rec.orientation is None:
        report.skip("contacts", "contacts are not recorded")
        return
    total = len(t["a"])
    counted = np.diff(t["end"], prepend=0)
    more = counted - rec.observed["contacts"].astype(int)
    # by steps there are rows, too, of what was over before the frame, and of impacts that were passed on
    report.true("contacts counted", bool(np.where(rec.observed["stepped"] > 0, more >= 0, more == 0).all()))
    report.true("contacts of frames", np.array_equal(t["step"], rec.step[t["frame"]]))
    report.count("contacts", total)
    if total == 0:
        return
    rows = np.unique(np.linspace(0, total - 1, min(total, rows_most)).astype(int))
    frame = t["frame"][rows]
    c = Rows(rec, geometry, t, rows, lambda _, i: rec.pose(frame, i))
    stepped = (rec.observed["stepped"][frame] > 0) | (rec.method == "classic")

    def where(k):
        return f"frame {frame[k]}, {rec.label((c.i[k], c.j[k]))}, row {rows[k]}"

    report.true("ids of contacts", bool((t["a"] < t["b"]).all() and rec.can_meet(t["i"], t["j"]).all()))
    report.bounds("normals are units", np.abs(np.linalg.norm(c.normal, axis=1) - 1), np.full(len(rows), 1e-14), where)
    shapes(rec, report, c, frame, stepped, where)
    forces(rec, report, c, frame, stepped, where)


def way(rec, c, frame, stepped):
    """What a row may be off under steps: the way that the two make in one, at speeds that a frame may not show."""
    speed = np.zeros(len(frame))
    for i in (c.i, c.j):
        radius = np.where(rec.kind[i] == PLANE, 0, c.geometry.radius[i])
        now, last = (np.linalg.norm(v, axis=1) + np.linalg.norm(w, axis=1) * radius
                     for _, v, w in (rec.motion(frame, i), rec.motion(np.maximum(frame - 1, 0), i)))
        speed += np.maximum(now, last)
    g = np.linalg.norm(rec.gravity) * rec.time_step
    return np.where(stepped, 2 * (speed + g) * rec.time_step, 0)


def shapes(rec, report, c, frame, stepped, where):
    (di, qi), (dj, qj) = c.surface()
    off = way(rec, c, frame, stepped)
    # either side of the gap may have the point
    bound = rec.tolerance[frame] + c.slack() + off
    report.bounds("points on bodies", np.maximum(np.abs(di), np.abs(dj)), bound, where, "m")
    s = c.parted(qi, qj)
    rows = np.nonzero(~np.isnan(s))[0]
    report.bounds("normals part", -s[rows], (bound + ANGLE * c.size() + off)[rows], lambda k: where(rows[k]), "m")
    off_plane = c.from_plane()
    rows = np.nonzero(~np.isnan(off_plane))[0]
    tilt = np.where(stepped, np.linalg.norm(rec.motion(frame, c.j)[2], axis=1) * rec.time_step, 0) + 1e-14
    report.bounds("normals of planes", off_plane[rows], tilt[rows], lambda k: where(rows[k]))
    gap = rec.contacts["gap"][c.rows]
    ok = ~np.isnan(s) & ~stepped
    rows = np.nonzero(ok)[0]
    report.bounds("gaps told", np.abs(gap - s)[rows], (bound + ANGLE * c.size())[rows], lambda k: where(rows[k]), "m")


def forces(rec, report, c, frame, stepped, where):
    force = rec.contacts["force"][c.rows]
    push = dot(force, c.normal)
    rub = force - push[:, None] * c.normal
    size = np.linalg.norm(force, axis=1)
    friction = rec.friction[rec.species[c.i], rec.species[c.j]]
    scale = max(float(size.max()), 1e-300)
    least = 1e-12 * scale
    report.bounds("forces push", -push, np.full(len(push), least), where, "N")
    # of a step that was halved it is a mean of forces about normals of which the last is told
    between = np.diff(rec.time, prepend=0)
    whole = between / np.maximum(np.ceil(between / rec.time_step * (1 - 1e-9)), 1)
    halved = stepped & (rec.observed["smallest_step"] < 0.75 * whole)[frame]
    turned = np.where(halved, np.minimum(way(rec, c, frame, stepped) / c.size(), 1), 0)
    report.bounds("cone of friction", np.linalg.norm(rub, axis=1) - friction * push,
                  1e-9 * size + least + (1 + friction) * size * turned, where, "N")
    slip = velocities(rec, frame, c.j, c.point) - velocities(rec, frame, c.i, c.point)
    slip -= dot(slip, c.normal)[:, None] * c.normal
    speed = np.linalg.norm(slip, axis=1)
    (_, vi, wi), (_, vj, wj) = rec.motion(frame, c.i), rec.motion(frame, c.j)
    rate = np.linalg.norm(vi, axis=1) + np.linalg.norm(vj, axis=1)
    spun = np.linalg.norm(wi - wj, axis=1) * c.size()
    # slower slip may be rounding, or begin within the step, when a row is also the sum of points with their own slip
    fall = 4 * np.maximum(friction, 1) * np.linalg.norm(rec.gravity) * rec.time_step
    fast = np.where(stepped, fall + 0.1 * rate + 4 * spun, 1e-6 * rate + 1e-9)
    # one that creeps (rbsim-scene(5)) rubs against where it is going, not against where it has gone up to now
    creeps = speed <= 2e-5 * (rate + spun + np.sqrt(2 * np.linalg.norm(rec.gravity) * c.size()))
    # bodies that parted within the step: where they met, neither has at the frame the speed that it had
    parted = stepped & (rec.contacts["gap"][c.rows] > c.size())
    # impacts within the step, before which slip had another direction
    struck = np.zeros(len(speed), bool)
    if rec.events is not None:
        impacts = np.pad(touched(rec)[1], ((0, 0), (0, 1)))
        struck = stepped & sum(impacts[frame, np.minimum(body, rec.bodies)] > 0 for body in (c.i, c.j)).astype(bool)
    rows = np.nonzero((speed > fast) & (push > 1e-6 * scale) & (friction > 0) & ~parted & ~struck)[0]
    against = rub[rows] + (friction * push / speed)[rows][:, None] * slip[rows]
    if len(rows):
        report.bounds("friction against slip", np.linalg.norm(against, axis=1),
                      (friction * push * np.where(stepped, 0.5, np.where(creeps, 0.01, 1e-6)))[rows],
                      lambda k: where(rows[k]), "N")
