# SPDX-License-Identifier: MIT
"""A recording as plain arrays: what the file says, and centres of mass, matrices and pieces that follow from it.

Nothing here knows how the program computes; it reads what rbsim-recording(5) states. Bodies are counted by index: those
that move first, in their order, then statics. An id is a place in the scene.
"""
import re
from collections import namedtuple

import h5py
import numpy as np

SPHERE, PLANE, RECTANGLE, BOX, CAPSULE, CYLINDER, HULL, UNION = range(8)
COLLISION, MERGE = 0, 6  # kinds of events; between them transitions of contacts
HOOKS = ("on_step", "on_frame", "on_collision", "on_transition")
# A part of a union, as the recording has it.
Part = namedtuple("Part", "kind solid radius size position orientation share")
PUSHES = ("apply_impulse", "apply_force", "apply_torque", "set_velocity", "set_angular_velocity", "set_position")


def text(value):
    return (value.decode() if isinstance(value, bytes) else str(value)).rstrip("\0")


def matrices(q):
    """Rotation matrices of quaternions w, x, y, z: [..., 4] -> [..., 3, 3]."""
    q = np.asarray(q, float)
    w, x, y, z = np.moveaxis(q / np.linalg.norm(q, axis=-1, keepdims=True), -1, 0)
    rows = [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
            2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
            2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]
    return np.stack(rows, -1).reshape(q.shape[:-1] + (3, 3))


def turn(r, v):
    """Matrices times vectors, over any leading axes."""
    return np.einsum("...ij,...j->...i", r, v)


def dot(a, b):
    return np.einsum("...i,...i->...", a, b)


class Piece:
    """A convex piece in object coordinates: the hull of points, widened by a disc about `axis` and by a ball."""

    def __init__(self, vertices, ball=0.0, disc=0.0, axis=(0, 0, 1), normals=(), edges=()):
        self.vertices = np.atleast_2d(np.asarray(vertices, float))
        self.ball, self.disc, self.axis = float(ball), float(disc), np.asarray(axis, float)
        self.normals = np.asarray(normals, float).reshape(-1, 3)
        self.edges = np.asarray(edges, float).reshape(-1, 3)
        self.middle = (self.vertices.max(0) + self.vertices.min(0)) / 2
        self.reach = np.linalg.norm(self.vertices - self.middle, axis=1).max() + self.ball + self.disc

    def moved(self, position, orientation):
        r = matrices(orientation)
        return Piece(self.vertices @ r.T + position, self.ball, self.disc, r @ self.axis, self.normals @ r.T,
                     self.edges @ r.T)


def distinct(directions):
    """Unit directions without repetition, a direction and its opposite counting as one."""
    kept = []
    for d in directions:
        if all(abs(abs(d @ k) - 1) > 1e-12 for k in kept):
            kept.append(d)
    return kept


def piece_of(kind, radius, size, solid):
    x, y, z = np.asarray(size) / 2
    axes = np.eye(3)
    if kind == SPHERE:
        return Piece([[0, 0, 0]], ball=radius)
    if kind == CAPSULE:
        return Piece([[0, 0, -z], [0, 0, z]], ball=radius, edges=axes[2:])
    if kind == CYLINDER:
        return Piece([[0, 0, -z], [0, 0, z]], disc=radius, normals=axes[2:], edges=axes[2:])
    if kind == BOX:
        corners = [[i * x, j * y, k * z] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)]
        return Piece(corners, normals=axes, edges=axes)
    if kind == RECTANGLE:
        corners = [[i * x, j * y, 0] for i in (-1, 1) for j in (-1, 1)]
        return Piece(corners, normals=axes[2:], edges=axes[:2])
    vertices, faces = solid
    normals, edges = [], []
    for face in faces:
        p = vertices[face]
        n = sum(np.cross(p[i] - p[0], p[i + 1] - p[0]) for i in range(1, len(p) - 1))
        normals.append(n / np.linalg.norm(n))
        along = np.roll(p, -1, 0) - p
        edges.extend(along / np.linalg.norm(along, axis=1, keepdims=True))
    return Piece(vertices, normals=normals, edges=distinct(edges))


class Recording:
    def __init__(self, path):
        self.path = path
        with h5py.File(path, "r") as f:
            self.read_frames(f)
            self.read_bodies(f)
            self.read_shapes(f)
            self.read_forces(f)
            self.read_tables(f)

    def read_frames(self, f):
        bodies = f["particles/bodies"]
        self.bodies, self.statics = len(bodies["id"]), len(f["particles/statics/id"])
        self.step = f["observables/kinetic_energy/step"][:]
        self.time = f["observables/kinetic_energy/time"][:]
        self.frames = len(self.step)
        wide = (self.frames, self.bodies)

        def column(name, width):
            if name not in bodies:
                return None
            if isinstance(bodies[name], h5py.Dataset):
                return np.broadcast_to(bodies[name][:], wide + (width,)).astype(float)
            return bodies[name]["value"][:].astype(float)

        self.position, self.orientation = column("position", 3), column("orientation", 4)
        self.velocity, self.spin = column("velocity", 3), column("angular_velocity", 3)
        value = bodies["position/value"] if self.bodies and "position" in bodies else None
        self.unit = 2.0 ** (-24 if value is not None and value.dtype == np.float32 else -53)
        if self.spin is None and self.velocity is not None:
            self.spin = np.zeros(wide + (3,))
        self.observed = self.values_in(f["observables"])
        self.ledger, self.books = {}, {}
        if "ledger" in f["observables"]:
            ledger = f["observables/ledger"]
            self.ledger, self.books = self.values_in(ledger), self.values_in(ledger.get("momentum", {}))

    @staticmethod
    def values_in(group):
        """Of each observable of the group its values: not of what the group links to, nor of groups of observables."""
        return {name: e["value"][:] for name, e in group.items() if isinstance(e, h5py.Group) and "value" in e
                and not any(isinstance(item, h5py.Group) for item in e.values())}

    def read_bodies(self, f):
        bodies, statics = f["particles/bodies"], f["particles/statics"]
        self.id = np.concatenate([bodies["id"][:], statics["id"][:]]).astype(int)
        self.index = np.full(self.id.max() + 1 if len(self.id) else 0, -1)
        self.index[self.id] = np.arange(len(self.id))
        self.species = np.concatenate([bodies["species"][:], statics["species"][:]]).astype(int)
        self.mass = bodies["mass"][:]
        self.driven = ~np.isfinite(self.mass)
        zero = np.zeros((self.bodies, 3, 3))
        self.has_inertia = "inertia" in bodies
        self.inertia = bodies["inertia"][:] if self.has_inertia else zero
        self.center = bodies["center_of_mass"][:]
        self.static_position = statics["position"][:].reshape(-1, 3)
        self.static_orientation = statics["orientation"][:].reshape(-1, 4)
        if self.position is not None and self.orientation is not None:
            self.rotation = matrices(self.orientation)
            self.com = self.position + turn(self.rotation, self.center[None])

    def read_shapes(self, f):
        shapes, count = f["rbsim/shapes"], self.bodies + self.statics
        self.solids = solids = self.read_solids(f)
        self.shape = []
        self.kind = np.zeros(count, int)
        self.pieces = [[] for _ in range(count)]
        made = {}
        for i, who in enumerate(self.id):
            kind = self.kind[i] = int(shapes["kind"][who])
            number = int(shapes["solid"][who]) if "solid" in shapes else -1
            key = (kind, number, float(shapes["radius"][who]), tuple(shapes["size"][who]))
            self.shape.append(key)
            if key not in made:
                made[key] = self.pieces_of(solids, *key)
            self.pieces[i] = made[key]
        self.group = shapes["group"][:][self.id] if "group" in shapes else None
        self.meets = shapes["collides_with"][:][self.id] if "collides_with" in shapes else None

    @staticmethod
    def read_solids(f):
        """Of each solid either corners and faces, or its parts: kind, solid, radius, size, position, orientation."""
        if "rbsim/solids" not in f:
            return []
        s = {k: v[:] for k, v in f["rbsim/solids"].items() if isinstance(v, h5py.Dataset)}
        parts = {k: v[:] for k, v in f["rbsim/solids/parts"].items()}
        solids, corner, loop, bound, part = [], 0, 0, 0, 0
        for n, faces, many in zip(s["vertex_count"], s["face_count"], s["part_count"]):
            if many:
                rows = range(part, part + many)
                solids.append([Part(int(parts["kind"][k]), int(parts["solid"][k]), float(parts["radius"][k]),
                                    tuple(parts["size"][k]), parts["position"][k], parts["orientation"][k],
                                    float(parts["share"][k])) for k in rows])
                part += many
                continue
            first = s["face_first"][bound:bound + faces + 1]
            loops = [s["loops"][loop + a:loop + b] for a, b in zip(first, first[1:])]
            solids.append((s["vertices"][corner:corner + n], loops))
            corner, loop, bound = corner + n, loop + first[-1], bound + faces + 1
        return solids

    @staticmethod
    def pieces_of(solids, kind, number, radius, size):
        if kind == PLANE:
            return []
        if kind != UNION:
            return [piece_of(kind, radius, size, solids[number] if kind == HULL else None)]
        return [piece_of(p.kind, p.radius, p.size, solids[p.solid] if p.kind == HULL else None)
                .moved(p.position, p.orientation) for p in solids[number]]

    def read_forces(self, f):
        run = f["rbsim"]
        self.gravity, self.gravity_force = run["gravity"][:], run["gravity_force"][:]
        self.springs = {k: v[:] for k, v in run["springs"].items()} if "springs" in run else None
        self.drag = "drags" in run
        self.fields = "fields" in run
        scene = text(run["scene"][()])
        every = scene + "".join(text(v[()]) for v in run["files"].values() if v.dtype.kind == "S")
        self.states_inertia = re.search(r"\b(inertia|center_of_mass)\s*=", every) is not None
        self.pushes = any(w in scene for w in HOOKS) and any(w in every for w in PUSHES)
        self.forces = {k: v[:] for k, v in run["forces"].items()} if "forces" in run else None

    def read_tables(self, f):
        run = f["rbsim"]
        self.friction = run["materials/pair_friction"][:]
        self.restitution = run["materials/pair_restitution"][:]
        self.materials = {k: v[:] for k, v in run["materials"].items()}
        self.tolerance = np.where(np.cumsum(self.observed["stepped"]) > 0, run["stepped_tolerance"][()],
                                  run["tolerance"][()])  # of each frame
        for name in ("time_step", "frame_rate", "duration"):
            setattr(self, name, float(run[name][()]))
        self.status, self.method = text(run["status"][()]), text(run["method"][()])
        self.rollback = text(run["rollback"][()])
        self.events = self.table(f, "events")
        self.contacts = self.table(f, "contacts")

    def table(self, f, name):
        """Columns, and `end` by frames; ids become indices with a sign of -1 where their order is the other one."""
        if name not in f["rbsim"]:
            return None
        t = {k: v[:] for k, v in f["rbsim"][name].items()}
        t["end"] = f[f"rbsim/frames/{name[:-1]}_end"][:].astype(int)
        total = t["end"][-1] if len(t["end"]) else 0
        for k in t:
            if k != "end":
                t[k] = t[k][:total]
        t["frame"] = np.repeat(np.arange(len(t["end"])), np.diff(t["end"], prepend=0))
        t["i"], t["j"] = self.index[t["a"]], self.index[t["b"]]
        return t

    def label(self, indices):
        return " and ".join(f"body {self.id[i]}" for i in indices)

    # ---- poses of any body, moving or static ----

    def pose(self, frame, i):
        """Positions and matrices of the bodies i at the frames, both arrays of one length."""
        frame, i = np.broadcast_arrays(frame, i)
        p, r = np.empty(i.shape + (3,)), np.empty(i.shape + (3, 3))
        moves = i < self.bodies
        p[moves], r[moves] = self.position[frame[moves], i[moves]], self.rotation[frame[moves], i[moves]]
        if not moves.all():
            still = i[~moves] - self.bodies
            p[~moves], r[~moves] = self.static_position[still], matrices(self.static_orientation[still])
        return p, r

    def motion(self, frame, i):
        """Centre of mass, its velocity, and spin."""
        frame, i = np.broadcast_arrays(frame, i)
        x, v, w = (np.zeros(i.shape + (3,)) for _ in range(3))
        moves = i < self.bodies
        at = (frame[moves], i[moves])
        x[moves], v[moves], w[moves] = self.com[at], self.velocity[at], self.spin[at]
        x[~moves] = self.static_position[i[~moves] - self.bodies]
        return x, v, w

    def yields(self, i):
        i = np.asarray(i)
        return (i < self.bodies) & ~np.append(self.driven, np.ones(self.statics, bool))[i]

    def can_meet(self, i, j):
        ok = self.yields(i) | self.yields(j)
        if self.meets is not None:
            ok &= (self.meets[i] & self.group[j]) != 0
            ok &= (self.meets[j] & self.group[i]) != 0
        return ok
