# SPDX-License-Identifier: MIT
"""Impacts that were told, against the motion before and after.

Of a body that has one event between two frames and flies otherwise, the motion up to the event follows from the frame
before, and the one after it from the frame behind: closed forms for the centre of mass, Runge and Kutta's formula for a
free turning, whose angular momentum stays.
"""
import numpy as np

from contacts import ANGLE, Rows
from mechanics import FLIGHT, acceleration, alone, complete, fliers, round_ones, spin_momentum, touched
from recording import COLLISION, MERGE, dot, matrices, turn

TURN, TURNS_MOST = 0.005, 1600  # radians a step of the integration, and how many steps


def product(a, b):
    w, v = a[:, :1], a[:, 1:]
    u, x = b[:, :1], b[:, 1:]
    return np.concatenate([w * u - dot(v, x)[:, None], w * x + u * v + np.cross(v, x)], 1)


def turning(rec, body, q, spin, dt):
    """Orientation and spin after dt [K] of free turning; the angular momentum is kept."""
    inertia = rec.inertia[body]
    momentum = spin_momentum(rec, matrices(q), spin, inertia)
    inverse = np.linalg.pinv(inertia)

    def rate(q):
        r = matrices(q)
        w = turn(r, turn(inverse, turn(np.swapaxes(r, 1, 2), momentum)))
        return w, 0.5 * product(np.concatenate([np.zeros((len(q), 1)), w], 1), q)

    angle = np.linalg.norm(spin, axis=1) * np.abs(dt)
    count = int(min(TURNS_MOST, 1 + angle.max(initial=0) / TURN))
    h = (dt / count)[:, None]
    for _ in range(count):
        _, k1 = rate(q)
        _, k2 = rate(q + 0.5 * h * k1)
        _, k3 = rate(q + 0.5 * h * k2)
        _, k4 = rate(q + h * k3)
        q = q + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        q = q / np.linalg.norm(q, axis=1, keepdims=True)
    return q, rate(q)[0], angle <= TURN * TURNS_MOST


class Side:
    """One body of each impact, at its moment, as the frame before (-1) or behind (0) tells."""

    def __init__(self, rec, body, frame, time):
        still = body >= rec.bodies
        i = np.where(still, 0, body)
        dt = time - rec.time[frame]
        g = acceleration(rec)[i]
        x, v, w = rec.com[frame, i], rec.velocity[frame, i], rec.spin[frame, i]
        self.x = x + dt[:, None] * v + 0.5 * (dt * dt)[:, None] * g
        self.v = v + dt[:, None] * g
        self.q, self.w, self.good = turning(rec, i, rec.orientation[frame, i].copy(), w, dt)
        self.q[still] = rec.static_orientation[body[still] - rec.bodies]
        self.r = matrices(self.q)
        self.p = self.x - turn(self.r, rec.center[i])
        self.p[still] = self.x[still] = rec.static_position[body[still] - rec.bodies]
        self.v[still] = self.w[still] = 0
        self.spin = spin_momentum(rec, self.r, self.w, np.where(still[:, None, None], 0, rec.inertia[i]))
        self.mass = np.where(still, 0, rec.mass[i])
        self.stiff = np.where(still, 0, np.linalg.norm(rec.inertia[i], axis=(1, 2)))

    def at(self, point):
        return self.v + np.cross(self.w, point - self.x)


def check(rec, report, geometry, rows_most=4000):
    t = rec.events
    if t is None or not complete(rec):
        report.skip("impacts", "events are not recorded")
        return
    hit = t["kind"] == COLLISION
    count = np.zeros(rec.frames, int)
    np.add.at(count, t["frame"][hit], 1)
    report.true("impacts counted", np.array_equal(count, rec.observed["collisions"].astype(int)))
    before = np.concatenate([[-np.inf], rec.time])[t["frame"]]
    # what steps end with is told at the frame's own time
    late = 1e-9 * rec.time_step
    report.true("events in their frames", bool(((t["time"] >= before - late) &
                                               (t["time"] <= rec.time[t["frame"]] + late)).all()))
    report.true("events in order", bool((np.diff(t["time"]) >= 0).all()))
    touch = t["kind"] <= MERGE  # what scripts change has one body, and no normal; so may joints
    report.true("ids of events", bool((t["a"] <= t["b"]).all() and (t["a"] < t["b"])[touch].all() and
                                      rec.can_meet(t["i"], t["j"])[touch].all()))
    report.count("impacts", hit.sum())

    def where(rows):
        def tell(k):
            e = rows[k]
            return f"event {e} at {t['time'][e]:.9g} s, {rec.label((t['i'][e], t['j'][e]))}"
        return tell

    rows = np.nonzero(touch)[0]
    off = np.abs(np.linalg.norm(t["normal"][rows], axis=1) - 1)
    report.bounds("normals of events are units", off, np.full(len(rows), 1e-14), where(rows))
    rows = np.nonzero(hit)[0]
    impulse, normal = t["impulse"][rows], t["normal"][rows]
    push = dot(impulse, normal)
    rub = np.linalg.norm(impulse - push[:, None] * normal, axis=1)
    size = np.linalg.norm(impulse, axis=1)
    friction = rec.friction[rec.species[t["i"][rows]], rec.species[t["j"][rows]]]
    # an impact of a union may have several points, each with a normal of its own
    one = convex(geometry, t, rows)
    tell = where(rows[one])
    report.bounds("impulses push", -push[one], 1e-12 * size[one] + 1e-300, tell, "N s")
    # points of one patch have normals that differ by what touching leaves open; impulses of rounding have no direction
    angle = np.where(round_ones(rec)[t["i"][rows]] | round_ones(rec)[t["j"][rows]], 1e-9, 1e-5)
    bound = angle * size + 1e-12 * (carried(rec, t["frame"][rows], t["i"][rows])
                                    + carried(rec, t["frame"][rows], t["j"][rows])) + 1e-300
    report.bounds("cone of impulses", (rub - friction * push)[one], bound[one], tell, "N s")
    report.bounds("approach", -t["approach_speed"][rows], np.full(len(rows), 0.0), where(rows), "m/s")
    if rec.contacts is None or not alone(rec):
        report.skip("impacts against motion", "other forces act" if rec.contacts else "contacts are not recorded")
        return
    rows = rows[np.unique(np.linspace(0, len(rows) - 1, min(len(rows), rows_most)).astype(int))] if len(rows) else rows
    lone(rec, report, geometry, rows, where)


def carried(rec, frame, i):
    """What momentum the bodies had at the frame; none if they are not pushed."""
    moves = rec.yields(i)
    mass = np.where(moves, rec.mass[np.where(moves, i, 0)], 0)
    return np.where(moves, mass, 0) * np.linalg.norm(rec.motion(frame, i)[1], axis=1)


def convex(geometry, t, rows):
    parts = np.array([len(p) for p in geometry.of])
    return (parts[t["i"][rows]] <= 1) & (parts[t["j"][rows]] <= 1)


def lone(rec, report, geometry, rows, where):
    """Impacts of bodies that have no other event between the two frames, and no contact at either."""
    t = rec.events
    contact, events = touched(rec)
    free = fliers(rec) & (events == 1) & ~contact
    free[1:] &= ~contact[:-1]
    free = np.concatenate([free, np.ones((rec.frames, rec.statics), bool)], 1)
    frame, i, j = t["frame"][rows], t["i"][rows], t["j"][rows]
    good = free[frame, i] & free[frame, j]
    if good.any():
        lone_of(rec, report, geometry, rows[good], where)


def lone_of(rec, report, geometry, rows, where):
    t = rec.events
    frame, i, j = t["frame"][rows], t["i"][rows], t["j"][rows]
    if len(rows) == 0:
        return
    time, point, normal = t["time"][rows], t["point"][rows], t["normal"][rows]
    impulse, told = t["impulse"][rows], t["approach_speed"][rows]
    pairs = [(Side(rec, b, frame - 1, time), Side(rec, b, frame, time)) for b in (i, j)]
    passed = np.zeros(len(rows), bool)
    for (old, new), sign, body, partner in zip(pairs, (-1, 1), (i, j), (j, i)):
        change = old.mass[:, None] * (new.v - old.v) - sign * impulse * (body < rec.bodies)[:, None]
        off = np.nonzero(np.linalg.norm(change, axis=1) > 1e-9 * np.linalg.norm(impulse, axis=1))[0]
        # what it touched without force has passed it on
        passed[off] |= geometry.touch(frame[off] - 1, body[off], partner[off])
    if passed.any():
        return lone_of(rec, report, geometry, rows[~passed], where)
    good = np.logical_and.reduce([s.good for pair in pairs for s in pair])
    tell = where(rows)
    late = rec.unit * time
    point_like = round_ones(rec)
    many = ~convex(geometry, t, rows)
    patch = ~(point_like[i] | point_like[j])
    for (old, new), sign, body in zip(pairs, (-1, 1), (i, j)):
        moves = body < rec.bodies
        size = np.abs(old.x).max(1) + np.linalg.norm(old.p - old.x, axis=1)
        fast = np.linalg.norm(old.v, axis=1) + np.linalg.norm(new.v, axis=1)
        step = rec.time[frame] - rec.time[frame - 1]
        slack = FLIGHT * (rec.unit * (size + fast * step) + late * fast)
        report.bounds("impacts, place", np.linalg.norm(new.x - old.x, axis=1), slack + 1e-300, tell, "m")
        g = np.linalg.norm(acceleration(rec)[np.where(moves, body, 0)], axis=1)
        off = np.linalg.norm(old.mass[:, None] * (new.v - old.v) - sign * impulse * moves[:, None], axis=1)
        bound = FLIGHT * old.mass * (rec.unit * (fast + g * step) + late * g) + 1e-12 * np.linalg.norm(impulse, axis=1)
        report.bounds("impacts, momentum", off, bound + 1e-300, tell, "N s")
        arm = point - old.x
        off = new.spin - old.spin - sign * np.cross(arm, impulse) * moves[:, None]
        # several points of a patch may rub in several directions: about the normal that is more than the sum tells
        off = np.where(patch[:, None], off - dot(off, normal)[:, None] * normal, off)
        off = np.where(many, 0, np.linalg.norm(off, axis=1))
        bound = 1e-9 * (np.linalg.norm(old.spin, axis=1) + np.linalg.norm(new.spin, axis=1)) + np.linalg.norm(
            impulse, axis=1) * (slack + 1e-12 * np.linalg.norm(arm, axis=1))
        bound += FLIGHT * rec.unit * old.stiff * (np.linalg.norm(old.w, axis=1) + np.linalg.norm(new.w, axis=1))
        report.bounds("impacts, angular momentum", off, bound + 1e-300, tell, "N m s")
    (a0, a1), (b0, b1) = pairs
    before, after = (dot(b.at(point) - a.at(point), normal) for a, b in ((a0, b0), (a1, b1)))
    scale = sum(np.linalg.norm(s.v, axis=1) + np.linalg.norm(s.w, axis=1) * np.linalg.norm(point - s.x, axis=1)
                for s in (a0, b0, a1, b1))
    rows_good = np.nonzero(good)[0]
    # of a patch that turns the fastest point is told, not the middle
    turning_by = sum(np.linalg.norm(s.w, axis=1) * np.where(b < rec.bodies, geometry.radius[b], 0)
                     for s, b in ((a0, i), (b0, j)))
    off = np.where(patch, np.maximum(-told - before, told + before - 2 * turning_by), np.abs(told + before))
    report.bounds("approach speeds", off[good], (1e-9 * scale + 1e-300)[good], lambda k: tell(rows_good[k]), "m/s")
    central = good.copy()
    for s, body in ((a0, i), (b0, j)):
        arm = point - s.x
        central &= (body >= rec.bodies) | (np.linalg.norm(np.cross(arm, normal), axis=1) <=
                                          1e-9 * np.linalg.norm(arm, axis=1))
    e = rec.restitution[rec.species[i], rec.species[j]]
    # what rises by less than rounding does not rise: the last of infinitely many bounces
    least = 1e-6 * np.sqrt(np.linalg.norm(rec.gravity) * np.minimum(geometry.radius[i], geometry.radius[j]))
    k = np.nonzero(central & (told > least))[0]
    report.bounds("restitution", np.abs(after - e * told)[k], (1e-9 * scale)[k], lambda r: tell(k[r]), "m/s")
    report.count("lone impacts", len(rows))
    places(rec, report, geometry, rows, (a0, b0), good, tell)
    energy_taken(rec, report, rows, pairs, good)


def energy_taken(rec, report, rows, pairs, good):
    """Frames of which all impacts are alone: what the ledger's impacts and their friction took in them."""
    names = ("impacts", "impact_friction")
    if any(n not in rec.ledger for n in names):
        return
    lost, size = np.zeros(rec.frames), np.zeros(rec.frames)
    for old, new in pairs:
        for side, sign in ((old, 1), (new, -1)):
            kinetic = 0.5 * (np.where(side.mass > 0, side.mass, 0) * dot(side.v, side.v) + dot(side.w, side.spin))
            np.add.at(lost, rec.events["frame"][rows], sign * kinetic)
            np.add.at(size, rec.events["frame"][rows], kinetic)
    count = np.zeros(rec.frames, int)
    np.add.at(count, rec.events["frame"][rows[good]], 1)
    total = sum(rec.ledger[n] for n in names)
    took = np.diff(total, prepend=0)
    frames = np.nonzero((count > 0) & (count == rec.observed["collisions"]))[0]
    report.bounds("ledger, impacts", np.abs(took - lost)[frames], (1e-9 * size + 4 * rec.unit * np.abs(total))[frames],
                  lambda k: f"frame {frames[k]}", "J")


def places(rec, report, geometry, rows, sides, good, tell):
    """Points and normals at the moments of impacts; of several points of a union their middle is told, in the air."""
    good = good & convex(geometry, rec.events, rows)
    if not good.any():
        return

    def pose_of(side):
        return side.p[good], side.r[good]

    poses = iter(map(pose_of, sides))
    c = Rows(rec, geometry, rec.events, rows[good], lambda _, i: next(poses))
    (di, qi), (dj, qj) = c.surface()
    where = np.nonzero(good)[0]
    slack = 1e-9 * c.size() + c.slack()
    report.bounds("points of impacts", np.maximum(np.abs(di), np.abs(dj)), slack, lambda k: tell(where[k]), "m")
    s = c.parted(qi, qj)
    k = np.nonzero(~np.isnan(s))[0]
    report.bounds("normals of impacts", np.abs(s[k]), (slack + ANGLE * c.size())[k], lambda r: tell(where[k[r]]), "m")
    off = c.from_plane()
    k = np.nonzero(~np.isnan(off))[0]
    report.bounds("normals of impacts on planes", off[k], np.full(len(k), 1e-14), lambda r: tell(where[k[r]]))
