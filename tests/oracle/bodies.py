# SPDX-License-Identifier: MIT
"""Centres of mass and inertias from shapes: of a sphere, a box, a cylinder, a capsule by formula, of a hull by tetrahedra,
of a union from its parts. What the scene itself states for a body is not compared."""
import numpy as np

from recording import BOX, CAPSULE, CYLINDER, HULL, SPHERE, UNION, matrices

ROUNDING = 256  # units that sums over corners and parts may be off, in what is summed up


def round_inertia(kind, r, h):
    """Across the axis and along it, of mass 1; a capsule's cylinder and its two half balls weigh as their volumes."""
    cylinder = np.array([(3 * r * r + h * h) / 12, r * r / 2])
    if kind == CYLINDER:
        return cylinder
    balls = 4 * r / (4 * r + 3 * h)
    ends = np.array([0.4 * r * r + h * h / 4 + 3 * h * r / 8, 0.4 * r * r])
    return (1 - balls) * cylinder + balls * ends


def hull_inertia(vertices, faces):
    """Tetrahedra from the middle of the corners: integrals of x_i x_j are those of each one's corners and their sum."""
    middle = vertices.mean(0)
    volume, first, second = 0.0, np.zeros(3), np.zeros((3, 3))
    for face in faces:
        p = vertices[face] - middle
        for i in range(1, len(p) - 1):
            corners = np.array([p[0], p[i], p[i + 1]])
            part = np.linalg.det(corners) / 6
            total = corners.sum(0)
            volume += part
            first += part * total / 4
            second += part * (np.outer(total, total) + corners.T @ corners) / 20
    centre = first / volume
    second = second / volume - np.outer(centre, centre)
    return volume, middle + centre, np.trace(second) * np.eye(3) - second


def solid_of(solids, kind, number, radius, size):
    """Volume, centre of mass, and inertia about it of mass 1, in the coordinates of the object."""
    ball = 4 / 3 * np.pi * radius ** 3
    if kind == SPHERE:
        return ball, np.zeros(3), 0.4 * radius ** 2 * np.eye(3)
    if kind == BOX:
        squares = np.asarray(size) ** 2
        return np.prod(size), np.zeros(3), np.diag(squares.sum() - squares) / 12
    if kind in (CAPSULE, CYLINDER):
        across, along = round_inertia(kind, radius, size[2])
        volume = np.pi * radius ** 2 * size[2] + (ball if kind == CAPSULE else 0)
        return volume, np.zeros(3), np.diag([across, across, along])
    if kind == HULL:
        return hull_inertia(*solids[number][:2])
    return union_inertia(solids, solids[number])


def union_inertia(solids, parts):
    shares, places, tensors = [], [], []
    for p in parts:
        volume, centre, inertia = solid_of(solids, p.kind, p.solid, p.radius, p.size)
        r = matrices(p.orientation)
        shares.append(p.share * volume)
        places.append(p.position + r @ centre)
        tensors.append(r @ inertia @ r.T)
    volume = sum(shares)
    shares = np.array(shares) / volume
    whole = shares @ np.array(places)
    away = np.array(places) - whole
    tensors = [t + (d @ d) * np.eye(3) - np.outer(d, d) for t, d in zip(tensors, away)]
    return volume, whole, np.einsum("k,kij->ij", shares, np.array(tensors))


def check(rec, report):
    free = [i for i in range(rec.bodies) if not rec.driven[i]]
    if rec.states_inertia:
        report.skip("centres of mass", "the scene states some")
        return
    known = {}
    for i in free:
        kind, number, radius, size = key = rec.shape[i]
        if kind not in (SPHERE, BOX, CAPSULE, CYLINDER, HULL, UNION):
            continue
        if key not in known:
            known[key] = solid_of(rec.solids, *key)
        _, centre, inertia = known[key]
        reach = max(p.reach + np.linalg.norm(p.middle) for p in rec.pieces[i])
        report.bound("centres of mass", np.abs(rec.center[i] - centre).max(), ROUNDING * 2.0 ** -53 * reach,
                     rec.label([i]), "m")
        if rec.has_inertia:
            report.bound("inertias", np.abs(rec.inertia[i] / rec.mass[i] - inertia).max(),
                         ROUNDING * 2.0 ** -53 * reach ** 2, rec.label([i]), "m^2")
