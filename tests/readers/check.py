#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Opens a recording with the readers people use and compares what they see, bit for bit, with h5py.

    check.py RUN.h5

h5py is needed (exit 77 without it); h5dump, MDAnalysis, pyh5md and VTK are each used when present and named when
absent. Exit 0: all that are present agree. Where a package stands in another Python, run it with that one.
"""
import hashlib
import shutil
import subprocess
import sys

try:
    import h5py
    import numpy as np
except ImportError as error:
    print("h5py and numpy are needed:", error)
    sys.exit(77)

ELEMENTS = {"position": 3, "orientation": 4, "velocity": 3, "angular_velocity": 3}
OBSERVABLES = ["kinetic_energy", "potential_energy", "momentum", "angular_momentum", "max_penetration",
               "contacts", "collisions", "rollbacks", "substeps", "smallest_step", "stepped"]


def same(what, a, b):
    a, b = np.asarray(a), np.asarray(b)
    if a.shape != b.shape:
        raise AssertionError(f"{what}: shape {a.shape}, wanted {b.shape}")
    if a.dtype != b.dtype:
        b = b.astype(a.dtype)
    if a.tobytes() != b.tobytes():
        raise AssertionError(f"{what}: {np.count_nonzero(a != b)} of {a.size} values differ")


def text(value):
    return (value.decode() if isinstance(value, bytes) else str(value)).rstrip("\0")


def check_h5py(path):
    """The layout that rbsim-recording(5) states."""
    with h5py.File(path, "r") as f:
        assert list(f["h5md"].attrs["version"]) == [1, 1]
        assert text(f["h5md/modules/units"].attrs["system"]) == "SI"
        assert list(f["h5md/modules/units"].attrs["version"]) == [1, 0]
        assert text(f["h5md/creator"].attrs["name"]) == "rbsim" and text(f["h5md/creator"].attrs["version"])
        assert "name" in f["h5md/author"].attrs
        bodies = f["particles/bodies"]
        assert sorted(f["particles"])[0] == "bodies"
        assert bodies["box"].attrs["dimension"] == 3 and "edges" not in bodies["box"]
        assert [text(b) for b in bodies["box"].attrs["boundary"]] == ["none"] * 3
        count, statics = len(bodies["id"]), len(f["particles/statics/id"])
        step, time = bodies["position/step"], bodies["position/time"]
        frames = len(step)
        for name, width in ELEMENTS.items():
            if name not in bodies or isinstance(bodies[name], h5py.Dataset):
                continue
            assert bodies[name]["value"].shape == (frames, count, width), name
            assert bodies[name]["step"] == step and bodies[name]["time"] == time, f"{name}: not linked"
        for name in OBSERVABLES:
            element = f["observables"][name]
            if isinstance(element, h5py.Group):
                assert len(element["value"]) == frames, name
                assert element["step"] == step and element["time"] == time, f"{name}: not linked"
        assert text(bodies["position/value"].attrs["units"]) == "m"
        assert "unit" not in bodies["position/value"].attrs
        assert len(f["rbsim/names"]) == count + statics
        assert sorted(list(bodies["id"]) + list(f["particles/statics/id"])) == list(range(count + statics))
        assert text(f["rbsim/status"][()]) in ("complete", "interrupted", "failed")
        for source in [f["rbsim/scene"]] + list(f["rbsim/files"].values()):
            if "sha256" in source.attrs:
                digest = hashlib.sha256(source[()]).hexdigest()
                assert text(source.attrs["sha256"]) == digest, f"{source.name}: sha256"
        if "orientation" in bodies and isinstance(bodies["orientation"], h5py.Group):
            q = bodies["orientation/value"][:]
            assert np.all(np.abs(np.sum(q * q, axis=2) - 1) < 1e-5), "quaternions of other than unit length"
        if "events" in f["rbsim"]:
            lengths = {len(column) for column in f["rbsim/events"].values()}
            assert len(lengths) == 1 and lengths.pop() == f["rbsim/frames/event_end"][-1]
        if "contacts" in f["rbsim"]:
            ends = f["rbsim/frames/contact_end"][:]
            per_frame = np.diff(ends, prepend=np.uint64(0))
            same("steps of contacts", f["rbsim/contacts/step"][:], np.repeat(step[:], per_frame.astype(int)))
        moves = frames > 0 and count > 0 and isinstance(bodies.get("position"), h5py.Group)
        assert ("VTKHDF" in f) == moves, "a view for VTK is for what moves"
        if moves:
            check_view(f["VTKHDF"], f)
        return f"h5py {h5py.__version__}, HDF5 {h5py.version.hdf5_version}: {frames} frames, {count} bodies, {statics} statics"


def check_view(view, f):
    """PolyData in time, or a collection of it where contacts or surfaces are recorded."""
    bodies = f["particles/bodies"]
    frames, count = len(bodies["position/step"]), len(bodies["id"])
    parts = {"bodies": view}
    if text(view.attrs["Type"]) == "PartitionedDataSetCollection":
        names = [n for n in view["Assembly"]]
        parts = {n: view[n] for n in names}
        assert sorted(parts) == sorted(set(view) - {"Assembly"}), "parts that are not assembled"
        assert sorted(p.attrs["Index"] for p in parts.values()) == list(range(len(parts)))
    else:
        assert text(view.attrs["Type"]) == "PolyData"
    assert ("contacts" in parts) == ("contacts" in f["rbsim"] and f["rbsim/frames/contact_end"][-1] > 0)
    for part in parts.values():
        assert text(part.attrs["Type"]) == "PolyData" and part["Steps"].attrs["NSteps"] == frames
        same("times", part["Steps/Values"][:], bodies["position/time"][:])
    check_bodies(parts["bodies"], bodies, frames, count)
    if "contacts" in parts:
        check_contacts(parts["contacts"], f)
    if "surfaces" in parts:
        check_surfaces(parts["surfaces"], bodies)
    return parts


def check_bodies(view, bodies, frames, count):
    """One vertex a body, and columns that begin anew with each frame."""
    same("points", view["Points"][:], bodies["position/value"][:].reshape(frames * count, 3))
    assert view["NumberOfPoints"][0] == count
    offsets = np.arange(frames) * count
    same("offsets of points", view["Steps/PointOffsets"][:], offsets)
    for name in ("velocity", "angular_velocity", "orientation"):
        if isinstance(bodies.get(name), h5py.Group):
            value = bodies[name]["value"][:]
            same(name, view["PointData"][name][:], value.reshape(frames * count, value.shape[2]))
            same("offsets of " + name, view["Steps/PointDataOffsets"][name][:], offsets)
    same("ids", view["PointData/id"][:], bodies["id"][:])
    same("vertices", view["Vertices/Connectivity"][:], np.arange(count))
    same("offsets of vertices", view["Vertices/Offsets"][:], np.arange(count + 1))
    for kind in ("Vertices", "Lines", "Strips", "Polygons"):
        cells = count if kind == "Vertices" else 0
        assert view[kind]["NumberOfCells"][0] == view[kind]["NumberOfConnectivityIds"][0] == cells, kind


def check_contacts(view, f):
    """The table itself, from where each frame's rows begin."""
    assert view["Points"] == f["rbsim/contacts/point"], "a copy"
    ends = f["rbsim/frames/contact_end"][:].astype(np.int64)
    rows = np.diff(ends, prepend=0)
    same("contacts of frames", view["NumberOfPoints"][:], rows)
    same("first contacts", view["Steps/PointOffsets"][:], ends - rows)
    same("parts", view["Steps/PartOffsets"][:], np.arange(len(rows)))
    for name in ("force", "normal", "gap", "a", "b"):
        assert view["PointData"][name] == f["rbsim/contacts"][name], f"{name}: a copy"
        same("first of " + name, view["Steps/PointDataOffsets"][name][:], ends - rows)


def check_surfaces(view, bodies):
    """Each body's points keep their place in it: turned back they are those of the first frame, to the 32 bits of points."""
    points, frames = int(view["NumberOfPoints"][0]), len(bodies["position/step"])
    x = view["Points"][:].astype(float).reshape(frames, points, 3)
    corners = view["Polygons/Connectivity"][:].reshape(-1, 3)
    owner = np.full(points, -1)
    owner[corners] = view["CellData/id"][:][:, None]
    assert owner.min() >= 0, "points of no triangle"
    place = {i: k for k, i in enumerate(bodies["id"][:])}
    k = np.array([place[i] for i in owner])
    at = bodies["position/value"][:].astype(float)
    local = x - at[:, k]
    if isinstance(bodies.get("orientation"), h5py.Group):
        q = bodies["orientation/value"][:].astype(float)[:, k] * [1, -1, -1, -1]
        w, v = q[..., :1], q[..., 1:]
        local = local + 2 * np.cross(v, np.cross(v, local) + w * local)
    rounding = 4 * np.finfo(np.float32).eps * (np.abs(x).max() + np.abs(local).max())
    assert np.abs(local - local[0]).max() < rounding, "surfaces that do not move with their bodies"


def check_h5dump(path):
    tool = shutil.which("h5dump")
    if not tool:
        return None
    done = subprocess.run([tool, path], stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)
    if done.returncode != 0 or done.stderr:
        raise AssertionError(f"exit {done.returncode}: {done.stderr.decode(errors='replace')[:500]}")
    return f"{len(done.stdout)} characters"


def check_depth(path):
    """What MDAnalysis asks of /observables: elements have a value, or hold elements that have one."""
    with h5py.File(path, "r") as f:
        for name, element in f["observables"].items():
            for inner, member in element.items() if "value" not in element else []:
                assert "value" in member, f"observables/{name}/{inner} has no value"
        if "ledger" in f["observables"]:
            ledger = f["observables/ledger/momentum"]
            assert ledger["value"] == f["observables/momentum/value"], "two datasets"
            assert ledger["applied/value"].shape[1:] == (2, 3)
    return "depth of observables"


def is_scale(dataset):
    """As h5py's own attribute of that name, which came with 3.8."""
    return h5py.h5ds.is_scale(dataset.id)


def check_dims(path):
    """Every axis of what changes with frames, bodies or joints names a scale, by HDF5's own functions (H5DS)."""
    named = 0
    with h5py.File(path, "r") as f:
        def look(name, dataset):
            nonlocal named
            group = name.split("/")[0]
            if group not in ("particles", "observables", "joints") or "ledger" in name or not isinstance(dataset, h5py.Dataset):
                return
            if is_scale(dataset) or dataset.ndim == 0:
                return
            for axis, dim in enumerate(dataset.dims):
                assert len(dim) == 1, f"{name}: axis {axis} of {dataset.shape} names nothing"
                assert dim[0].shape == dataset.shape[axis:axis + 1], f"{name}: axis {axis}"
                named += 1
        f.visititems(look)
        position = f["particles/bodies/position/value"]
        if position.ndim == 3:
            assert [d[0].name.split("/")[-1] for d in position.dims] == ["time", "id", "axis"], "position"
            assert position.dims[0][0] == f["particles/bodies/position/time"]
        for table, rows in (("rbsim/events", "time"), ("rbsim/contacts", "step")):
            for column in f[table].values() if table in f else []:
                assert is_scale(column) or column.dims[0][0] == f[table][rows], f"{column.name}: no rows"
    return f"{named} axes named"


def check_xarray(path):
    """Times, ids and axes are coordinates, without a word from us."""
    try:
        import h5netcdf
        import xarray
    except ImportError:
        return None
    with h5py.File(path, "r") as f:
        value, time, ids = (f["particles/bodies/" + n][:] for n in ("position/value", "position/time", "id"))
    with xarray.open_datatree(path, engine="h5netcdf", phony_dims="sort") as tree:
        position = tree["particles/bodies/position"]["value"]
        assert position.dims == ("time", "id", "axis"), position.dims
        same("times", position["time"].values, time)
        same("ids", position["id"].values, ids)
        same("heights", position.sel(axis="z").values, value[:, :, 2])
        assert position.attrs["units"] == "m"
        assert tree["observables/momentum"]["value"].dims == ("time", "axis")
        assert tree["particles/bodies"]["inertia"].dims == ("id", "axis", "axis_2") if "inertia" in tree["particles/bodies"] else True
    return f"xarray {xarray.__version__}, h5netcdf {h5netcdf.__version__}"


def check_netcdf(path):
    """The dimensions of netCDF are the same scales."""
    try:
        import netCDF4
    except ImportError:
        return None
    with netCDF4.Dataset(path) as data:
        position = data["particles/bodies/position/value"]
        assert position.dimensions == ("time", "id", "axis"), position.dimensions
        assert data["observables/momentum/value"].dimensions == ("time", "axis")
        assert position.units == "m"
    return f"netCDF4 {netCDF4.__version__}"


def check_pandas(path):
    """A column as a table, times down, bodies across."""
    try:
        import pandas
    except ImportError:
        return None
    with h5py.File(path, "r") as f:
        position = f["particles/bodies/position"]
        frame = pandas.DataFrame(position["value"][:, :, 2], index=position["time"][:], columns=f["particles/bodies/id"][:])
        same("heights", frame.to_numpy(), position["value"][:, :, 2])
    return f"pandas {pandas.__version__}"


def check_mdanalysis(path):
    try:
        import MDAnalysis
        from MDAnalysis.coordinates.H5MD import H5MDReader
    except ImportError:
        return None
    with h5py.File(path, "r") as f:
        position = f["particles/bodies/position/value"][:]
        velocity = f["particles/bodies/velocity/value"][:] if "velocity" in f["particles/bodies"] else None
        time = f["particles/bodies/position/time"][:]
    with H5MDReader(path, convert_units=False) as reader:
        assert reader.n_frames == len(position) and reader.n_atoms == position.shape[1]
        for k, frame in enumerate(reader):
            same(f"positions of frame {k}", frame.positions, position[k].astype(np.float32))
            if velocity is not None:
                same(f"velocities of frame {k}", frame.velocities, velocity[k].astype(np.float32))
            assert frame.time == time[k]
    return f"MDAnalysis {MDAnalysis.__version__}"


def check_pyh5md(path):
    try:
        import pyh5md
    except ImportError:
        return None
    with h5py.File(path, "r") as f:
        position = f["particles/bodies/position/value"][:]
        step = f["particles/bodies/position/step"][:]
    with pyh5md.File(path, "r") as f:
        element = pyh5md.element(f.particles_group("bodies"), "position")
        same("positions", element.value[:], position)
        same("steps", element.step[:], step)
    return "pyh5md " + getattr(pyh5md, "__version__", "")


def check_vtk(path):
    try:
        from vtkmodules.util.numpy_support import vtk_to_numpy
        from vtkmodules.vtkCommonCore import vtkVersion
        from vtkmodules.vtkIOHDF import vtkHDFReader
    except ImportError:
        return None
    if not hasattr(vtkHDFReader, "GetNumberOfSteps"):  # before 9.3 it knows no surfaces that change in time
        return None
    with h5py.File(path, "r") as f:
        bodies = f["particles/bodies"]
        position = bodies["position/value"][:]
        time = bodies["position/time"][:]
        moving = {n: bodies[n]["value"][:] for n in list(ELEMENTS)[1:]
                  if n in bodies and isinstance(bodies[n], h5py.Group)}
        fixed = {"mass": bodies["mass"][:], "id": bodies["id"][:]}
        names = list(f["VTKHDF/Assembly"]) if "Assembly" in f["VTKHDF"] else []
        surfaces = {n: (int(f["VTKHDF"][n]["NumberOfPoints"][0]), f["VTKHDF"][n]["Points"][:],
                        len(f["VTKHDF"][n]["CellData/id"])) for n in ("surfaces", "statics") if n in names}
        contacts = {n: c[:] for n, c in f["rbsim/contacts"].items()} if "contacts" in names else {}
        ends = f["rbsim/frames/contact_end"][:].astype(int) if contacts else []
    reader = vtkHDFReader()
    reader.SetFileName(path)
    assert reader.CanReadFile(path), "VTK cannot read it"
    reader.UpdateInformation()
    assert reader.GetNumberOfSteps() == len(time), f"{reader.GetNumberOfSteps()} steps of {len(time)}"

    def points(data):
        return vtk_to_numpy(data.GetPoints().GetData()) if data.GetNumberOfPoints() else np.empty((0, 3))

    for k in range(len(time)):
        reader.SetStep(k)
        reader.Update()
        data = whole = reader.GetOutputDataObject(0)
        if names:
            assert whole.GetNumberOfPartitionedDataSets() == len(names)
            data = whole.GetPartition(0, 0)
        same(f"points of step {k}", points(data), position[k])
        assert data.GetNumberOfVerts() == position.shape[1], f"{data.GetNumberOfVerts()} vertices"
        for name, value in moving.items():
            same(f"{name} of step {k}", vtk_to_numpy(data.GetPointData().GetArray(name)), value[k])
        for name, value in fixed.items():
            same(f"{name} of step {k}", vtk_to_numpy(data.GetPointData().GetArray(name)), value)
        for name, (count, all_points, cells) in surfaces.items():
            data = whole.GetPartition(names.index(name), 0)
            first = count * k if name == "surfaces" else 0
            same(f"{name} of step {k}", points(data), all_points[first:first + count])
            assert data.GetNumberOfPolys() == cells, f"{name}: {data.GetNumberOfPolys()} triangles"
        if contacts:
            data, rows = whole.GetPartition(names.index("contacts"), 0), slice(ends[k - 1] if k else 0, ends[k])
            same(f"contacts of step {k}", points(data), contacts["point"][rows].reshape(-1, 3))
            if data.GetNumberOfPoints():
                same(f"forces of step {k}", vtk_to_numpy(data.GetPointData().GetArray("force")), contacts["force"][rows])
    return "VTK " + vtkVersion.GetVTKVersion()


def main():
    path = sys.argv[1]
    failed = False
    for name, check in [("h5py", check_h5py), ("depth", check_depth), ("h5dump", check_h5dump), ("dims", check_dims),
                        ("xarray", check_xarray), ("netCDF4", check_netcdf), ("pandas", check_pandas), ("MDAnalysis", check_mdanalysis),
                        ("pyh5md", check_pyh5md), ("VTK", check_vtk)]:
        try:
            said = check(path)
            print(f"{name}: {'absent' if said is None else 'ok, ' + said}")
        except Exception as error:  # whatever a reader throws at this file is a finding
            print(f"{name}: FAILED: {type(error).__name__}: {error}")
            failed = True
    return failed


sys.exit(main())
