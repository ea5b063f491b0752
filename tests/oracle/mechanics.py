# SPDX-License-Identifier: MIT
"""Energy and momentum from columns, flights between frames, what steps did, and the ledger's sums."""
import numpy as np

from recording import dot, turn

GIVEN = ("applied", "driven", "callbacks", "unexplained")
TAKEN = ("impacts", "impact_friction", "sliding", "rolling", "joint_friction", "drag", "damping")
PAYING, PAID = 8, 0.01  # parts of a step from which on motion pays for lifting, and what share of it may be told of nobody
STOPPED = 4e-7  # of a tolerance, by which a body that is stopped would have moved in the step
FLIGHT = 256  # units of rounding that a body may be off its parabola, in what the parabola is made of


def complete(rec):
    return rec.bodies > 0 and all(c is not None for c in (rec.position, rec.orientation, rec.velocity))


def round_ones(rec):
    """[bodies and statics]: spheres, which touch at one point."""
    return np.array([len(p) == 1 and len(p[0].vertices) == 1 and p[0].disc == 0 for p in rec.pieces], bool)


def spin_momentum(rec, rotation, spin, inertia):
    """I w about the centre of mass, world axes."""
    return turn(rotation, turn(inertia, turn(np.swapaxes(rotation, -1, -2), spin)))


class Totals:
    """Sums over bodies for every frame, each with the sum of its terms' sizes: what rounding is a share of."""

    def __init__(self, rec):
        free = ~rec.driven
        m = np.where(free, rec.mass, 0)
        inertia = np.where(free[:, None, None], rec.inertia, 0)
        x, v, w = rec.com, rec.velocity, rec.spin
        p = m[:, None] * v
        spin = spin_momentum(rec, rec.rotation, w, inertia[None])
        self.kinetic = 0.5 * (dot(p, v) + dot(w, spin)).sum(1)
        # a needle that spins about itself: what rounding turns of the spin goes into its large moments of inertia
        stiff, fast = np.linalg.norm(inertia, axis=(1, 2)), np.linalg.norm(w, axis=2)
        self.kinetic_size = self.kinetic + (fast * np.linalg.norm(spin, axis=2)).sum(1)
        reach = np.abs(rec.position) + np.linalg.norm(rec.center, axis=1)[:, None]
        weight = m[:, None] * rec.gravity + free[:, None] * rec.gravity_force
        self.potential = -dot(weight[None], x).sum(1)
        self.potential_size = dot(np.abs(weight)[None], reach).sum(1)
        self.momentum = p.sum(1)
        self.momentum_size = np.linalg.norm(p, axis=2).sum(1)
        self.angular = (np.cross(x, p) + spin).sum(1)
        self.angular_size = (np.linalg.norm(reach, axis=2) * np.linalg.norm(p, axis=2)
                             + stiff * fast).sum(1)
        if rec.springs is not None:
            self.add_springs(rec)

    def add_springs(self, rec):
        s = rec.springs
        for k in range(len(s["a"])):
            a, b = self.ends(rec, s["a"][k], s["at_a"][k]), self.ends(rec, s["b"][k], s["at_b"][k])
            length = np.linalg.norm(b - a, axis=1)
            stretch = length - s["rest_length"][k]
            self.potential += 0.5 * s["stiffness"][k] * stretch * stretch
            far = np.linalg.norm(a, axis=1) + np.linalg.norm(b, axis=1) + s["rest_length"][k]
            self.potential_size += s["stiffness"][k] * (np.abs(stretch) * far + stretch * stretch)

    @staticmethod
    def ends(rec, who, at):
        i = np.full(rec.frames, rec.index[who])
        p, r = rec.pose(np.arange(rec.frames), i)
        if np.isnan(at[0]):
            at = rec.center[i[0]] if i[0] < rec.bodies else np.zeros(3)
        return p + turn(r, np.broadcast_to(at, p.shape))


def observables(rec, report):
    """Bounds: one unit of rounding for each operation that a term takes (some thirty), and each that sums them."""
    t = Totals(rec)
    unit = rec.unit * (64 + 2 * rec.bodies)

    def where(k):
        return f"frame {k}"

    for name, mine, size in (("kinetic_energy", t.kinetic, t.kinetic_size),
                             ("potential_energy", t.potential, t.potential_size),
                             ("momentum", t.momentum, t.momentum_size),
                             ("angular_momentum", t.angular, t.angular_size)):
        off = np.abs(mine - rec.observed[name])
        off = off.max(1) if off.ndim > 1 else off
        report.bounds(name.replace("_", " "), off, unit * size + 1e-300, where)
        relative = off / np.where(size > 0, size, 1)
        report.number(name, float(relative.max(initial=0)))
    return t


def touched(rec):
    """[frames, bodies]: a contact row at the frame, and [frames, bodies] how many events since the frame before."""
    contact, events = np.zeros((rec.frames, rec.bodies), bool), np.zeros((rec.frames, rec.bodies), int)
    for side in ("i", "j"):
        for table, count in ((rec.contacts, contact), (rec.events, events)):
            rows = table[side] < rec.bodies
            np.add.at(count, (table["frame"][rows], table[side][rows]), 1)
    return contact, events


def alone(rec):
    """Nothing acts on all bodies but gravity and contact."""
    return not (rec.drag or rec.fields or rec.pushes)


def pulled(rec):
    """[bodies]: those with forces of their own and on springs."""
    ids = [rec.forces["body"]] if rec.forces is not None else []
    ids += [rec.springs["a"], rec.springs["b"]] if rec.springs is not None else []
    out = np.zeros(rec.bodies + rec.statics, bool)
    for who in ids:
        out[rec.index[who]] = True
    return out[:rec.bodies]


def fliers(rec):
    """[frames, bodies]: located throughout the interval that ends there, by gravity alone where nothing touches."""
    located = (rec.observed["stepped"] == 0) & (rec.method != "classic")
    located[0] = False
    return located[:, None] & ~(rec.driven | pulled(rec))[None]


def acceleration(rec):
    with np.errstate(all="ignore"):
        return rec.gravity + np.where(rec.driven[:, None], 0, rec.gravity_force / rec.mass[:, None])


def fuzz(rec, frame, body):
    """What rounding of a spin is a share of in its angular momentum."""
    return np.linalg.norm(rec.inertia, axis=(1, 2))[body] * np.linalg.norm(rec.spin[frame, body], axis=1)


def flights(rec, report, geometry):
    """What nothing touches goes on parabolas and keeps its angular momentum about its centre."""
    if rec.contacts is None or rec.events is None or not alone(rec):
        report.skip("flights", "contacts and events are not recorded" if rec.events is None else "other forces act")
        return
    contact, events = touched(rec)
    free = fliers(rec) & (events == 0) & ~contact
    free[1:] &= ~contact[:-1]
    frame, body = np.nonzero(free)
    if len(frame) == 0:
        return
    dt = (rec.time[frame] - rec.time[frame - 1])[:, None]
    g = acceleration(rec)[body]
    x0, v0 = rec.com[frame - 1, body], rec.velocity[frame - 1, body]
    x, v = x0 + dt * v0 + 0.5 * dt * dt * g, v0 + dt * g
    reach = np.linalg.norm(rec.center, axis=1)[body]
    late = rec.unit * rec.time[frame]  # times of frames are rounded
    speed = np.linalg.norm(v0, axis=1) + np.linalg.norm(dt * g, axis=1)
    size = np.abs(rec.position[frame, body]).max(1) + reach + dt[:, 0] * speed

    def where(k):
        return f"frame {frame[k]}, body {rec.id[body[k]]}"

    place, near = np.linalg.norm(x - rec.com[frame, body], axis=1), FLIGHT * (rec.unit * size + late * speed) + 1e-300
    # an impact on a neighbour that it touched without force goes on through that contact, which is not told
    off = np.nonzero(place > near)[0]
    keep = np.ones(len(frame), bool)
    keep[off] = ~geometry.touch(frame[off] - 1, body[off], np.full(len(off), -1))
    frame, body, place, near, v, g, speed, late = (c[keep] for c in (frame, body, place, near, v, g, speed, late))
    report.bounds("flights, place", place, near, where, "m")
    bound = FLIGHT * (rec.unit * speed + late * np.linalg.norm(g, axis=1)) + 1e-300
    report.bounds("flights, velocity", np.linalg.norm(v - rec.velocity[frame, body], axis=1), bound, where, "m/s")
    spin = [spin_momentum(rec, rec.rotation[k, body], rec.spin[k, body], rec.inertia[body]) for k in (frame - 1, frame)]
    bound = 1e-11 * np.linalg.norm(spin[0], axis=1) + FLIGHT * rec.unit * fuzz(rec, frame, body) + 1e-300
    if rec.unit < 1e-10:
        report.bounds("flights, spin", np.linalg.norm(spin[1] - spin[0], axis=1), bound, where, "kg m^2/s")
    report.count("flights", len(frame))


def beside(rec, scale):
    """[frames, bodies]: the largest of those that a body touches, or has met since the frame before."""
    out, scale = np.zeros(scale.shape), np.pad(scale, ((0, 0), (0, 1)))  # 0: of what does not move
    for table in (rec.contacts, rec.events):
        for side, other in (("i", "j"), ("j", "i")):
            rows = table[side] < rec.bodies
            frame = table["frame"][rows]
            np.maximum.at(out, (frame, table[side][rows]), scale[frame, np.minimum(table[other][rows], rec.bodies)])
    return out


def steps(rec, report):
    """Frames that one step ends at: force x step + impulses of events = change of momentum less what gravity gave."""
    if rec.contacts is None or rec.events is None or not alone(rec):
        return
    one = (rec.observed["substeps"] == 1) & (rec.observed["rollbacks"] == 0)
    if rec.method == "stepped":  # of which some bodies may have gone back
        one |= np.diff(rec.time, prepend=0) <= (1 + 1e-9) * rec.time_step
    one &= np.abs(rec.observed["stepped"] - np.diff(rec.time, prepend=0)) <= 1e-9 * rec.time_step
    one[0] = False
    if not one.any():
        return
    dt = np.diff(rec.time, prepend=0)
    m = np.where(rec.driven, 0, rec.mass)
    linear, angular = np.zeros(rec.com.shape), np.zeros(rec.com.shape)
    size, moment, apart, couple = (np.zeros(rec.com.shape[:2]) for _ in range(4))
    way, angle = (np.linalg.norm(c, axis=2) * dt[:, None] for c in (rec.velocity, rec.spin))
    way[1:] = np.maximum(way[1:], np.linalg.norm(np.diff(rec.com, axis=0), axis=2))  # overlaps are closed, too
    for c in (way, angle):
        c[1:] = np.maximum(c[1:], c[:-1])
    ways = np.pad(way, ((0, 0), (0, 1)))  # of what does not move
    ball = round_ones(rec)
    for table, kind, column in ((rec.contacts, None, "force"), (rec.events, 0, "impulse")):
        push = table[column] * (dt[table["frame"]][:, None] if column == "force" else 1)
        for side, sign in (("i", -1), ("j", 1)):
            rows = table[side] < rec.bodies
            at = (table["frame"][rows], table[side][rows])
            np.add.at(linear, at, sign * push[rows])
            arm = table["point"][rows] - rec.com[at]
            np.add.at(angular, at, sign * np.cross(arm, push[rows]))
            np.add.at(size, at, np.linalg.norm(push[rows], axis=1))
            np.add.at(moment, at, np.linalg.norm(push[rows], axis=1) * np.linalg.norm(arm, axis=1))
            off = ways[at[0], np.minimum(table["j" if side == "i" else "i"][rows], rec.bodies)]
            if "gap" in table:
                off = off + np.abs(table["gap"][rows])
            np.add.at(apart, at, np.linalg.norm(push[rows], axis=1) * off)
            if column == "impulse":
                # one point stands for all of a pair: what rubs at several of them is a couple as well
                several = rows & ~(ball[table["i"]] | ball[table["j"]])
                normal = table["normal"][several]
                rubs = push[several] - np.sum(push[several] * normal, axis=1)[:, None] * normal
                np.add.at(couple, (table["frame"][several], table[side][several]), np.linalg.norm(rubs, axis=1))
    change = np.zeros(rec.com.shape)
    change[1:] = np.diff(rec.velocity, axis=0) - (dt[1:, None, None] * acceleration(rec))
    turned = spin_momentum(rec, rec.rotation, rec.spin, np.where(rec.driven[:, None, None], 0, rec.inertia)[None])
    frame, body = np.nonzero(one[:, None] & ~(rec.driven | pulled(rec))[None])
    off = np.linalg.norm(m[:, None] * change - linear, axis=2)[frame, body]
    weight = m * np.linalg.norm(acceleration(rec), axis=1)
    scale = size + m * np.linalg.norm(rec.velocity, axis=2) + dt[:, None] * weight
    # one solution of a group is as exact as its largest impulses are, also for a light body between heavy ones
    slack = 1e-9 * np.maximum(scale, beside(rec, scale))
    # what has come to rest is stopped, from speeds up to that (src/stepped/stillness.c)
    still = (np.abs(rec.velocity).max(2) == 0) & (np.abs(rec.spin).max(2) == 0)
    slack += np.where(still, m * STOPPED * (rec.tolerance / np.where(dt > 0, dt, np.inf))[:, None], 0)

    def where(k):
        return f"frame {frame[k]}, body {rec.id[body[k]]}"

    # what lifts bodies may be taken from linear motion then, and what contacts would have to pull for is in no row
    parts = rec.observed["smallest_step"] <= (1 + 1e-9) / PAYING * dt
    slack += np.where(parts[:, None], PAID * (size + m * np.linalg.norm(rec.velocity, axis=2)), 0)
    report.bounds("steps, momentum", off, slack[frame, body] + 1e-300, where, "N s")
    off = np.linalg.norm(np.diff(turned, axis=0, prepend=turned[:1]) - angular, axis=2)[frame, body]
    reach = np.sqrt(np.trace(rec.inertia, axis1=1, axis2=2) / np.where(m > 0, m, 1))
    # points and arms are those of one moment of the step: first order in what the body turns and moves by, before or
    # after what stops it; and one point stands for those of both bodies, a gap apart
    # and found from where either is
    spin_scale = size * (1e-9 * reach + way) + couple * reach + moment * angle + apart + np.linalg.norm(
        turned, axis=2) * (1e-9 + dt[:, None] * np.linalg.norm(rec.spin, axis=2))
    # impulses that were taken back leave the rounding of what they would have stopped
    spin_scale += FLIGHT * rec.unit * m * np.linalg.norm(rec.velocity, axis=2) * reach
    report.bounds("steps, angular momentum", off, (spin_scale + slack * reach)[frame, body] + 1e-300, where, "N m s")
    report.count("steps", len(frame))


def ledger(rec, report, totals):
    """The sums that the specification states; what is taken counts with a minus. Momentum adds up as it is."""
    if not rec.ledger:
        report.skip("ledger", "not recorded")
        return
    total = rec.observed["kinetic_energy"] + rec.observed["potential_energy"]
    given = [rec.ledger[n] for n in GIVEN if n in rec.ledger]
    taken = [rec.ledger[n] for n in TAKEN if n in rec.ledger]
    size = np.abs(total) + np.abs(total[0]) + totals.potential_size + sum(np.abs(c) for c in given + taken)
    off = np.abs(total - total[0] - sum(given) + sum(taken))
    report.bounds("ledger, energy", off, 64 * rec.unit * np.maximum.accumulate(size) + 1e-300,
                  lambda k: f"frame {k}", "J")
    if "unexplained" in rec.ledger:
        scale = float((rec.observed["kinetic_energy"] + np.abs(rec.observed["potential_energy"]
                       - rec.observed["potential_energy"][0]) + sum(np.abs(c) for c in given + taken)).max())
        worst = float(np.abs(rec.ledger["unexplained"]).max())
        report.number("unexplained", worst / scale if scale > 0 else 0.0)
        if not rec.observed["stepped"].any() and rec.method != "classic":
            report.bound("ledger, unexplained", worst, 1e-12 * scale + 1e-300, "all frames", "J")
    scale = np.maximum.accumulate(size).max()
    for name, c in rec.ledger.items():
        report.true("ledger, finite", bool(np.isfinite(c).all()), name)
    # of one impact only the sum of both is what bodies lost: which part friction took depends on how it is told apart
    lost = {n: c for n, c in rec.ledger.items() if n in TAKEN}
    lost["impacts"] = lost.pop("impacts", 0) + lost.pop("impact_friction", 0)
    for name, c in lost.items():
        report.bound("ledger, taken", float(-np.diff(c, prepend=0).min()), 1e-12 * scale + 1e-300, name, "J")
    for name, here in ((("driven", rec.driven.any()), ("callbacks", rec.pushes), ("drag", rec.drag),
                        ("damping", rec.springs is not None), ("applied", rec.forces is not None or rec.fields))):
        if name in rec.ledger and not here:
            report.true("ledger, nobody", not rec.ledger[name].any(), f"'{name}' without one")
    if rec.books:
        momenta(rec, report, totals)


def momenta(rec, report, totals):
    """By cause they add up to what there is, and gravity's share is known beforehand."""
    located = not rec.observed["stepped"].any() and rec.method != "classic"
    if "applied" in rec.books and rec.forces is None and not rec.fields and rec.method != "classic":
        free = ~rec.driven
        weight = rec.mass[free].sum() * rec.gravity + free.sum() * rec.gravity_force
        off = np.linalg.norm(rec.books["applied"][:, 0] - rec.time[:, None] * weight, axis=1)
        parts = np.linalg.norm(rec.mass[free].sum() * rec.gravity) + np.linalg.norm(free.sum() * rec.gravity_force)
        report.bounds("ledger, weight", off, 1e-12 * rec.time * parts + 1e-300, lambda f: f"frame {f}", "N s")
    for name, here in (("driven", rec.driven.any()), ("callbacks", rec.pushes), ("drag", rec.drag),
                       ("static", rec.statics > 0)):
        if name in rec.books and not here:
            report.true("ledger, nobody", not rec.books[name].any(), f"momentum '{name}' without one")
    if "unexplained" in rec.books and rec.method != "classic":
        off = np.abs(rec.books["unexplained"]).max(2)
        size = np.stack([totals.momentum_size, totals.angular_size], 1)
        size = size + sum(np.linalg.norm(c, axis=2) for n, c in rec.books.items() if n != "unexplained")
        if not located:  # impulses that have cancelled since: as large as what the energy moves
            energy = (rec.observed["kinetic_energy"] + np.abs(rec.observed["potential_energy"]
                      - rec.observed["potential_energy"][0])).max()
            size[:, 0] += np.sqrt(2 * rec.mass[~rec.driven].sum() * energy)
        share = off / np.maximum(size.max(0), 1e-300)
        # by steps bodies rub on each other across their gaps, and are moved while they go on: first order, of the angular one
        report.bounds("ledger, momentum unexplained" if located else "ledger, momentum by steps",
                      share.max(1) if located else share[:, 0], np.full(rec.frames, 1e-12), lambda f: f"frame {f}")
        if not located:
            report.number("angular momentum by steps", float(share[:, 1].max()))
    if rec.books:
        now = np.stack([rec.observed["momentum"], rec.observed["angular_momentum"]], 1)
        off = np.abs(now - now[0] - sum(rec.books.values())).max(2)
        size = np.stack([totals.momentum_size, totals.angular_size], 1)
        size = np.maximum.accumulate(size + sum(np.abs(c).max(2) for c in rec.books.values()))
        for k, name in enumerate(("momentum", "angular momentum")):
            report.bounds(f"ledger, {name}", off[:, k], 256 * rec.unit * size[:, k] + 1e-300, lambda f: f"frame {f}")


def check(rec, report, geometry):
    if not complete(rec):
        report.skip("energy", "poses or velocities are not recorded")
        return
    totals = observables(rec, report)
    flights(rec, report, geometry)
    steps(rec, report)
    ledger(rec, report, totals)
