#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Does the oracle notice? Spoils one thing in copies of recordings and asks for the check that must fail.

    spoil.py LOCATED.h5 STEPPED.h5 STEPS.h5     of wall.lua beside this file, by each method; one step a frame
"""
import os
import shutil
import sys
import tempfile

try:
    import h5py
    import numpy as np
except ImportError as error:
    print("h5py and numpy are needed:", error)
    sys.exit(77)

from oracle import PARTS, examine
from recording import matrices, turn

BODIES, OBSERVED = "particles/bodies/", "observables/"


def scaled(path, factor, rows=...):
    def spoil(f):
        f[path][rows] = f[path][rows] * factor
    return spoil


def added(path, what):
    def spoil(f):
        f[path][...] = f[path][...] + what
    return spoil


def row_with(f, table):
    """The row with the largest force."""
    return int(np.linalg.norm(f[f"rbsim/{table}/force"][:], axis=1).argmax())


def contact(column, change):
    def spoil(f):
        k = row_with(f, "contacts")
        value = f[f"rbsim/contacts/{column}"][k]
        f[f"rbsim/contacts/{column}"][k] = change(value, f["rbsim/contacts/normal"][k])
    return spoil


def event(column, change):
    """All impacts: which of them are alone between two frames is the scene's affair."""
    def spoil(f):
        hit = f["rbsim/events/kind"][:] == 0
        value, n = f[f"rbsim/events/{column}"][:], f["rbsim/events/normal"][:]
        value[hit] = change(value[hit], n[hit])
        f[f"rbsim/events/{column}"][:] = value
    return spoil


def pushed_in(f):
    """A body that rests goes into what is below it by two tolerances, in one frame."""
    frame = len(f["observables/kinetic_energy/step"]) - 1
    rows = np.nonzero(f["rbsim/contacts/step"][:] == f["observables/kinetic_energy/step"][frame])[0]
    n, b = f["rbsim/contacts/normal"][rows[-1]], f["rbsim/contacts/b"][rows[-1]]
    index = list(f[BODIES + "id"][:]).index(b)
    f[BODIES + "position/value"][frame, index] -= 2 * f["rbsim/tolerance"][()] * n


def shifted_column(f):
    v = f[BODIES + "velocity/value"][:]
    f[BODIES + "velocity/value"][:] = np.roll(v, 1, axis=1)


def shifted_axis(f):
    w = f[BODIES + "angular_velocity/value"][:]
    f[BODIES + "angular_velocity/value"][:] = np.roll(w, 1, axis=2)


def late(f):
    x = f[BODIES + "position/value"][:]
    f[BODIES + "position/value"][1:] = x[:-1]


def without_force(f):
    """Potential energy as if there were no gravity_force."""
    x, q = f[BODIES + "position/value"][:], f[BODIES + "orientation/value"][:]
    x = x + turn(matrices(q), f[BODIES + "center_of_mass"][:][None])
    free = np.isfinite(f[BODIES + "mass"][:])
    f[OBSERVED + "potential_energy/value"][:] += (x[:, free] @ f["rbsim/gravity_force"][:]).sum(1)


def about_origin_of_object(f):
    """Potential energy of the object's origin in place of the centre of mass."""
    r = matrices(f[BODIES + "orientation/value"][:])
    m = np.where(np.isfinite(f[BODIES + "mass"][:]), f[BODIES + "mass"][:], 0)
    off = turn(r, f[BODIES + "center_of_mass"][:][None]) @ f["rbsim/gravity"][:]
    f[OBSERVED + "potential_energy/value"][:] += off @ m


def unit(path, said):
    def spoil(f):
        f[path].attrs["units"] = np.bytes_(said)
    return spoil


def moved(one, other, joules):
    def spoil(f):
        for name, sign in ((one, -1), (other, 1)):
            column = f[f"{OBSERVED}ledger/{name}/value"]
            column[:] = column[:] + sign * joules * np.arange(len(column))
    return spoil


def without_unit(path):
    def spoil(f):
        del f[path].attrs["units"]
    return spoil


def swapped(path, i, j):
    def spoil(f):
        value = f[path][:]
        value[[i, j]] = value[[j, i]]
        f[path][:] = value
    return spoil


def across(n):
    aside = np.cross(n, [0.36, 0.48, 0.8])
    return aside / np.linalg.norm(aside, axis=-1, keepdims=True)


def turned(v, n):
    """By a thousandth of a radian."""
    v = v + 1e-3 * across(n)
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def view_of_its_own(f):
    view = f["VTKHDF/bodies"] if "bodies" in f["VTKHDF"] else f["VTKHDF"]
    points = view["Points"][:]
    del view["Points"]
    points[-1, 0] += 1e-3
    view.create_dataset("Points", data=points)


CHECKS = {
    "bodies": {"inertias", "centres of mass"},
    "layout": {"units", "ids", "names", "times", "views"},
    "overlaps": {"overlap", "overlap told", "overlap told, located"},
    "contacts": {"contacts counted", "points on bodies", "normals part", "normals of planes", "forces push",
                 "cone of friction"},
    "mechanics": {"kinetic energy", "potential energy", "momentum", "angular momentum", "flights, place",
                  "ledger, energy", "ledger, momentum", "ledger, weight", "steps, momentum",
                  "steps, angular momentum"},
    "impacts": {"impacts counted", "impulses push", "impacts, momentum", "points of impacts", "normals of impacts",
                "normals of impacts on planes", "approach speeds", "restitution", "ledger, impacts"},
}

LOCATED = [
    ("sign of a contact's normal", contact("normal", lambda v, n: -v), "normals part|normals of planes|forces push"),
    ("a contact's normal turned", contact("normal", turned), "normals part|normals of planes"),
    ("sign of a contact's force", contact("force", lambda v, n: -v), "forces push"),
    ("friction outside the cone", contact("force", lambda v, n: v + 3 * np.linalg.norm(v) * across(n)),
     "cone of friction"),
    ("a contact's point off", contact("point", lambda v, n: v + 1e-4 * n), "points on bodies"),
    ("a contact's bodies", contact("a", lambda v, n: v ^ 1), "points on bodies|normals part"),
    ("sign of impacts' normals", event("normal", lambda v, n: -v), "impulses push"),
    ("impacts' normals turned", event("normal", turned), "normals of impacts|normals of impacts on planes"),
    ("sign of impulses", event("impulse", lambda v, n: -v), "impulses push"),
    ("impulses 1e-6 larger", event("impulse", lambda v, n: v * (1 + 1e-6)), "impacts, momentum"),
    ("impacts' points off", event("point", lambda v, n: v + 1e-4 * n), "points of impacts"),
    ("approach speeds", event("approach_speed", lambda v, n: v * 1.001), "approach speeds"),
    ("a body pushed in", pushed_in, "overlap"),
    ("an overlap that is not", added(OBSERVED + "max_penetration/value", 1e-8), "overlap told, located"),
    ("columns of bodies shifted", shifted_column, "kinetic energy"),
    ("axes of spins shifted", shifted_axis, "kinetic energy"),
    ("positions of the frame before", late, "flights, place"),
    ("kinetic energy", scaled(OBSERVED + "kinetic_energy/value", 1 + 1e-9), "kinetic energy"),
    ("energy without gravity_force", without_force, "potential energy"),
    ("energy of the origin", about_origin_of_object, "potential energy"),
    ("momentum", scaled(OBSERVED + "momentum/value", -1.0), "momentum"),
    ("angular momentum", scaled(OBSERVED + "angular_momentum/value", 1 + 1e-9), "angular momentum"),
    ("a mass", scaled(BODIES + "mass", 1.001, slice(2, 3)), "kinetic energy"),
    ("an inertia", scaled(BODIES + "inertia", 1.001, slice(5, 6)), "kinetic energy|angular momentum"),
    ("a spring's stiffness", scaled("rbsim/springs/stiffness", 1.001), "potential energy"),
    ("restitution", scaled("rbsim/materials/pair_restitution", 1.01), "restitution"),
    ("friction", scaled("rbsim/materials/pair_friction", 0.5), "cone of friction"),
    ("a unit", unit(OBSERVED + "momentum/value", "N m"), "units"),
    ("a unit too few", without_unit("rbsim/events/impulse"), "units"),
    ("shapes", swapped("rbsim/shapes/kind", 0, 3), "overlap"),
    ("ids", swapped(BODIES + "id", 0, 1), "ids"),
    ("times", scaled("observables/kinetic_energy/time", 1 + 1e-9), "times"),
    ("collisions", scaled(OBSERVED + "collisions/value", 2), "impacts counted"),
    ("contacts counted", scaled(OBSERVED + "contacts/value", 2), "contacts counted"),
    ("what VTK sees", view_of_its_own, "views"),
    ("energy taken by impacts", scaled(OBSERVED + "ledger/impacts/value", 1 + 1e-9), "ledger, energy"),
    ("energy moved from a cause to another", moved("impacts", "sliding", 1e-3), "ledger, impacts"),
    ("weight", scaled(OBSERVED + "ledger/momentum/applied/value", 1 + 1e-9), "ledger, momentum|ledger, weight"),
    ("a unit of the ledger", unit(OBSERVED + "ledger/momentum/static/value", "kg m/s"), "units"),
]

STEPPED = [
    ("sign of a contact's force, stepped", contact("force", lambda v, n: -v), "forces push"),
    ("sign of a contact's normal, stepped", contact("normal", lambda v, n: -v), "normals part|normals of planes"),
    ("a body pushed in, stepped", pushed_in, "overlap"),
]

# one step a frame
STEPS = [
    ("a force a millionth larger, stepped", contact("force", lambda v, n: v * (1 + 1e-6)), "steps, momentum"),
    ("impulses a millionth larger, stepped", event("impulse", lambda v, n: v * (1 + 1e-6)), "steps, momentum"),
    ("a contact's point off, stepped", contact("point", lambda v, n: v + 0.2 * across(n)), "steps, angular momentum"),
]


def main():
    failed = 0
    with tempfile.TemporaryDirectory() as folder:
        for path, spoils in zip(sys.argv[1:], (LOCATED, STEPPED, STEPS)):
            clean = examine(path, frames=8)
            if clean.failures:
                print(f"{path}: fails as it is: {', '.join(clean.failures)}")
                print("\n".join(clean.lines()))
                failed += 1
            for name, spoil, wanted in spoils:
                copy = os.path.join(folder, "spoiled.h5")
                shutil.copy(path, copy)
                with h5py.File(copy, "r+") as f:
                    spoil(f)
                checks = set(wanted.split("|"))
                found = examine(copy, frames=4, pending=False, parts=[p for p in PARTS if checks & CHECKS[p]]).failures
                ok = bool(checks & set(found))
                print(f"{'ok' if ok else 'MISSED':7} {name}: {', '.join(found) or 'nothing found'}", flush=True)
                failed += not ok
    return failed > 0


if __name__ == "__main__":
    sys.exit(main())
