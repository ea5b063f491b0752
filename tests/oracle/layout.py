# SPDX-License-Identifier: MIT
"""What the file says of itself: units of every dataset, ids and names, steps and times, and VTK's views."""
import h5py
import numpy as np

from recording import text

ENERGY, MOMENTUM, ANGULAR = "J", "kg m/s", "kg m^2/s"
UNITS = {
    "/particles/bodies/position/value": "m",
    "/particles/bodies/velocity/value": "m/s",
    "/particles/bodies/angular_velocity/value": "rad/s",
    "/particles/bodies/acceleration/value": "m/s^2",
    "/particles/bodies/force/value": "N",
    "/particles/bodies/torque/value": "N m",
    "/particles/bodies/mass": "kg",
    "/particles/bodies/inertia": "kg m^2",
    "/particles/bodies/center_of_mass": "m",
    "/particles/statics/position": "m",
    "/observables/kinetic_energy/value": ENERGY,
    "/observables/potential_energy/value": ENERGY,
    "/observables/momentum/value": MOMENTUM,
    "/observables/angular_momentum/value": ANGULAR,
    "/observables/max_penetration/value": "m",
    "/observables/smallest_step/value": "s",
    "/observables/stepped/value": "s",
    "/rbsim/time_step": "s",
    "/rbsim/tolerance": "m",
    "/rbsim/stepped_tolerance": "m",
    "/rbsim/frame_rate": "1/s",
    "/rbsim/duration": "s",
    "/rbsim/gravity": "m/s^2",
    "/rbsim/gravity_force": "N",
    "/rbsim/materials/density": "kg/m^3",
    "/rbsim/shapes/radius": "m",
    "/rbsim/shapes/size": "m",
    "/rbsim/solids/volume": "m^3",
    "/rbsim/solids/centroid": "m",
    "/rbsim/solids/vertices": "m",
    "/rbsim/solids/parts/radius": "m",
    "/rbsim/solids/parts/size": "m",
    "/rbsim/solids/parts/position": "m",
    "/rbsim/springs/at_a": "m",
    "/rbsim/springs/at_b": "m",
    "/rbsim/springs/stiffness": "N/m",
    "/rbsim/springs/damping": "N s/m",
    "/rbsim/springs/rest_length": "m",
    "/rbsim/springs/radius": "m",
    "/rbsim/drags/linear": "N s/m",
    "/rbsim/drags/quadratic": "N s^2/m^2",
    "/rbsim/forces/vector": "N",
    "/rbsim/forces/torque": "N m",
    "/rbsim/forces/point": "m",
    "/rbsim/forces/start": "s",
    "/rbsim/forces/duration": "s",
    "/rbsim/events/time": "s",
    "/rbsim/events/point": "m",
    "/rbsim/events/impulse": "N s",
    "/rbsim/events/approach_speed": "m/s",
    "/rbsim/contacts/point": "m",
    "/rbsim/contacts/force": "N",
    "/rbsim/contacts/torque": "N m",
    "/rbsim/contacts/gap": "m",
}
LEDGER, BOOKS = "/observables/ledger/", "/observables/ledger/momentum/"
# what is the scene's own, or a camera's, or says itself what it is
LEFT_OUT = ("/rbsim/parameters/", "/rbsim/files/", "/rbsim/cameras/", "/results/", "/observables/probes/", "/VTKHDF/",
            "/axis", "/quaternion", "/limit", "/joints/row")
KINDS = ["sphere", "plane", "rectangle", "box", "capsule", "cylinder", "hull", "union", "terrain"]
EVENTS = ["collision", "rest", "slide", "roll", "lift", "edge", "merge", "impulse",
          "angular_impulse", "displacement"]


def datasets(group, path=""):
    """Every name of every dataset, hard links too, which h5py's own visit tells once."""
    for name, item in group.items():
        if isinstance(item, h5py.Dataset):
            yield f"{path}/{name}", item
        elif isinstance(item, h5py.Group):
            yield from datasets(item, f"{path}/{name}")


def wanted_unit(name):
    if name in UNITS:
        return UNITS[name]
    if name.startswith(LEDGER) and name.endswith("/value"):
        if name == BOOKS + "value":  # a link to the bodies' momentum
            return MOMENTUM
        return ENERGY if not name.startswith(BOOKS) else f"{MOMENTUM}, {ANGULAR}"
    return "s" if name.endswith("/time") else None


def units(f, report):
    for name, dataset in datasets(f):
        if name.startswith(LEFT_OUT):
            continue
        said = text(dataset.attrs["units"]) if "units" in dataset.attrs else None
        report.true("units", said == wanted_unit(name), f"{name}: '{said}', wanted '{wanted_unit(name)}'")
        report.true("units", "unit" not in dataset.attrs, f"{name}: has H5MD's own 'unit'")
    report.true("units", text(f["h5md/modules/units"].attrs["system"]) == "SI", "module of units")


def names(f, report):
    ids = np.concatenate([f["particles/bodies/id"][:], f["particles/statics/id"][:]])
    count = len(ids)
    report.true("ids", sorted(ids) == list(range(count)), "each place in the scene once")
    for group in ("bodies", "statics"):
        own = f[f"particles/{group}/id"][:]
        report.true("ids", (np.diff(own) > 0).all(), f"{group} in the order of the scene")
        same = f["rbsim/shapes/material"][:][own] == f[f"particles/{group}/species"][:] if count else np.ones(1, bool)
        report.true("ids", bool(np.all(same)), f"species of {group} are materials of shapes")
    said = [text(n) for n in f["rbsim/names"][:]]
    given = [n for n in said if n]
    report.true("names", len(said) == count and len(set(given)) == len(given), "one for each, none twice")
    if count:
        static = f["rbsim/shapes/static"][:].astype(bool)
        report.true("ids", sorted(np.nonzero(static)[0]) == sorted(f["particles/statics/id"][:]), "statics are static")
    for path, kinds, where in (("rbsim/shapes", KINDS, f["rbsim/shapes"].attrs),
                               ("rbsim/events/kind", EVENTS, f["rbsim/events/kind"].attrs
                                if "events" in f["rbsim"] else None)):
        if where is not None and "kinds" in where:
            told = [word.split()[1] for word in text(where["kinds"]).split(",")]
            report.true("kinds", told[:len(kinds)] == kinds, path)


def frames(f, report):
    """step and time are one dataset under many names, and frame k is at k/frame_rate, but for the last."""
    time, step = f["observables/kinetic_energy/time"], f["observables/kinetic_energy/step"]
    for name, dataset in datasets(f):
        if name.startswith(("/particles/", "/observables/")) and name.endswith(("/step", "/time")):
            report.true("steps linked", dataset == (time if name.endswith("time") else step), name)
    rate, duration = f["rbsim/frame_rate"][()], f["rbsim/duration"][()]
    k, t = step[:], time[:]
    report.true("steps ascend", bool((np.diff(k) > 0).all() and (np.diff(t) > 0).all()))
    at = k / rate
    last = (t == duration) & (np.arange(len(t)) == len(t) - 1)
    ulp = np.spacing(np.abs(at))
    report.true("times", bool((last | (np.abs(t - at) <= ulp)).all()), "of frames")
    for name, group in f["observables"].items():
        if isinstance(group, h5py.Group) and "value" in group:
            report.true("lengths", len(group["value"]) == len(k), name)
    if BOOKS in f:
        report.true("steps linked", f[BOOKS]["value"] == f["observables/momentum/value"], BOOKS + "value")


def views(f, report):
    """/VTKHDF: PolyData in time, its columns the same bytes as ours."""
    if "VTKHDF" not in f:
        report.skip("views", "there are none")
        return
    v, bodies = f["VTKHDF"], f["particles/bodies"]
    if "Assembly" in v:  # a collection: of bodies, and of what else there is
        report.true("views", text(v.attrs["Type"]) == "PartitionedDataSetCollection", "type of the collection")
        v = v["bodies"]
    count, n = len(bodies["id"]), len(f["observables/kinetic_energy/step"])
    report.true("views", text(v.attrs["Type"]) == "PolyData" and v["Steps"].attrs["NSteps"] == n, "type and steps")

    def same(name, mine, other):
        report.true("views", mine.shape == other.shape and mine.dtype == other.dtype
                    and mine.tobytes() == other.tobytes(), name)

    same("Values", v["Steps/Values"][:], f["observables/kinetic_energy/time"][:])
    moving = {"Points": "position", "PointData/orientation": "orientation", "PointData/velocity": "velocity",
              "PointData/angular_velocity": "angular_velocity"}
    offsets = v["Steps/PointOffsets"][:] if "PointOffsets" in v["Steps"] else np.arange(n) * count
    for name, source in moving.items():
        if name not in v:
            report.true("views", source not in bodies or isinstance(bodies[source], h5py.Dataset), f"{name} is missing")
            continue
        column = v[name][:]
        many = len(column) // n if n else 0
        if many == count:
            same(name, column.reshape(n, count, -1), bodies[source]["value"][:])
        report.true("views", bool((offsets == np.arange(n) * many).all()), f"offsets of {name}")
    for name, source in (("mass", "mass"), ("id", "id")):
        if name in v["PointData"]:
            same(name, v["PointData"][name][:][:count], bodies[source][:])


def check(path, report):
    with h5py.File(path, "r") as f:
        units(f, report)
        names(f, report)
        frames(f, report)
        views(f, report)
