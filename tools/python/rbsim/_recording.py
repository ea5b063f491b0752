# SPDX-License-Identifier: MIT
"""A recording as arrays."""
import base64
import html
import os
import tempfile
import weakref
from pathlib import Path
from typing import Any, Callable, Dict, Iterator, List, Mapping, Optional, Tuple, Union

import h5py
import numpy as np

from ._program import RbsimError, call, options_of

Array = np.ndarray
PathLike = Union[str, "os.PathLike[str]"]

#: Films with more bytes are not put into a notebook.
FILM_BYTES_MAX = 32 << 20

_BODIES = "/particles/bodies"


def _unescape(name: str) -> str:
    """A name as the scene has it, from one that HDF5 can hold."""
    out, at = "", 0
    while at < len(name):
        code = name[at + 1:at + 3]
        if name[at] == "%" and len(code) == 2 and all(c in "0123456789ABCDEF" for c in code):
            out += chr(int(code, 16))
            at += 3
        else:
            out += name[at] if name[at:] != "%" else ""
            at += 1
    return out


def _text(value: Any) -> str:
    if isinstance(value, bytes):
        return value.rstrip(b"\0").decode("utf-8", "replace")
    return str(value)


def _kinds(column: "h5py.Dataset") -> Dict[int, str]:
    """Names of the numbers in a column, which its attribute lists: "0 fixed, 1 ball"."""
    kinds: Dict[int, str] = {}
    for part in _text(column.attrs.get("kinds", b"")).split(", "):
        number, _, name = part.partition(" ")
        if number.isdigit():
            kinds[int(number)] = name
    return kinds


class _Named(Dict[str, float]):
    """Values by name; one that there is not is told with those that there are."""

    def __missing__(self, name: str) -> float:
        raise KeyError(f"no '{name}' (there are: {', '.join(self) or 'none'})")


class _Lazy(Mapping[str, Any]):
    """Values by name, each read when it is asked for first."""

    def __init__(self, readers: Dict[str, Callable[[], Any]]) -> None:
        self._readers = readers
        self._values: Dict[str, Any] = {}

    def __getitem__(self, name: str) -> Any:
        if name not in self._values:
            if name not in self._readers:
                raise KeyError(f"no '{name}' (there are: {', '.join(self._readers) or 'none'})")
            self._values[name] = self._readers[name]()
        return self._values[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._readers)

    def __len__(self) -> int:
        return len(self._readers)

    def __repr__(self) -> str:
        return f"<{', '.join(self._readers) or 'none'}>"


def _count(number: int, one: str, more: str) -> str:
    return f"{number} {one if number == 1 else more}"


class Body:
    """One moving body of a run: its columns through all frames."""

    def __init__(self, run: "Run", index: int) -> None:
        self.run = run
        #: its place along the second axis of the run's arrays
        self.index = index

    @property
    def id(self) -> int:
        """Its place in the scene."""
        return int(self.run.ids[self.index])

    @property
    def name(self) -> str:
        return self.run.names[self.id]

    @property
    def mass(self) -> float:
        return float(self.run._read(f"{_BODIES}/mass")[self.index])

    @property
    def position(self) -> Array:
        """[frames, 3], m, of the object's origin."""
        return self.run.position[:, self.index]

    @property
    def orientation(self) -> Array:
        """[frames, 4], a unit quaternion w, x, y, z."""
        return self.run.orientation[:, self.index]

    @property
    def velocity(self) -> Array:
        """[frames, 3], m/s, of the centre of mass."""
        return self.run.velocity[:, self.index]

    @property
    def angular_velocity(self) -> Array:
        """[frames, 3], rad/s, world axes."""
        return self.run.angular_velocity[:, self.index]

    @property
    def force(self) -> Array:
        """[frames, 3], N; where the scene records forces."""
        return self.run.force[:, self.index]

    def __repr__(self) -> str:
        return f"<body {self.name!r}, id {self.id}>"


class Joint:
    """One joint of a run; what it does through all frames, where the scene records joints."""

    def __init__(self, run: "Run", index: int) -> None:
        self.run = run
        #: its place in the order of the scene
        self.index = index

    def _of(self, name: str) -> Any:
        return self.run._read(f"/joints/{name}")[self.index]

    def _column(self, name: str) -> Array:
        if f"/joints/{name}/value" not in self.run._file:
            raise AttributeError(f"'{self.run.path}' holds no motion of joints: ask for it with "
                                 'record { fields = {"+", "joints"} }')
        return self.run._read(f"/joints/{name}/value")[:, self.index]

    @property
    def name(self) -> str:
        """ "" of one that has none."""
        return _text(self._of("name"))

    @property
    def kind(self) -> str:
        """fixed, ball, hinge, slider, cylindrical, universal, rod or rope."""
        kinds = _kinds(self.run._file["/joints/kind"])
        return kinds.get(int(self._of("kind")), str(self._of("kind")))

    @property
    def a(self) -> int:
        """Id of its first body; -1: the world."""
        return int(self._of("a"))

    @property
    def b(self) -> int:
        """Id of its second body; -1: the world."""
        return int(self._of("b"))

    @property
    def point_a(self) -> Array:
        """m, of the first body, world coordinates at the start."""
        return np.asarray(self._of("point_a"))

    @property
    def point_b(self) -> Array:
        """m, of the second body, world coordinates at the start."""
        return np.asarray(self._of("point_b"))

    @property
    def angle(self) -> Array:
        """[frames]: of a hinge rad, of a slider the way, of a rod or rope the distance of its ends, m; 0 of others."""
        return self._column("angle")

    @property
    def speed(self) -> Array:
        """[frames]: the rate of `angle`, rad/s or m/s."""
        return self._column("speed")

    @property
    def force(self) -> Array:
        """[frames, 3], N, on b at its point, world axes."""
        return self._column("force")

    @property
    def torque(self) -> Array:
        """[frames, 3], N m, on b at its point, world axes."""
        return self._column("torque")

    def __repr__(self) -> str:
        return f"<joint {repr(self.name) if self.name else self.index}, {self.kind}>"


class Run:
    """A recording. Arrays are read when they are asked for first; all are in SI units."""

    def __init__(self, path: PathLike, summary: Optional[Dict[str, Any]] = None,
                 folder: Optional["tempfile.TemporaryDirectory[str]"] = None) -> None:
        self.path = Path(path)
        #: what `rbsim run --json` has printed; empty for a recording that was opened
        self.summary: Dict[str, Any] = summary or {}
        self._folder = folder  # removed with this object
        self._arrays: Dict[str, Array] = {}
        self._film: Optional[bytes] = None
        try:
            try:
                self._file = h5py.File(str(path), "r")
            except OSError:
                # one that still grows, or whose run was killed
                self._file = h5py.File(str(path), "r", libver="latest", swmr=True)
        except OSError as error:
            if os.path.isdir(path):
                raise RbsimError(66, f"'{path}' is a folder: open_sweep opens that of a sweep") from None
            why = os.strerror(error.errno) if error.errno else str(error)
            raise RbsimError(66, f"cannot open '{path}': {why}") from None
        if "/rbsim/version" not in self._file:
            is_table = "/points/state_hash" in self._file
            self._file.close()
            raise RbsimError(66, f"'{path}' is the table of a sweep: open_sweep opens its folder" if is_table else
                             f"'{path}' is not a recording of rbsim")
        self._closer = weakref.finalize(self, self._file.close)
        #: frames that all columns have: those of a run that was killed may differ
        self.frame_count = min((len(dataset) for dataset in self._columns()), default=0)
        self.names: List[str] = [_text(name) for name in self._file["/rbsim/names"][()]]
        #: of moving bodies, in the order of the arrays: their places in the scene
        self.ids: Array = self._file[f"{_BODIES}/id"][()]

    # ---- the file ----

    def _columns(self) -> Iterator["h5py.Dataset"]:
        """All datasets with a row for each frame."""
        for group in (self._file[_BODIES], self._file["/observables"], self._file.get("/joints", {})):
            for element in group.values():
                if isinstance(element, h5py.Group):
                    for name in ("value", "step", "time"):
                        if name in element:
                            yield element[name]
        for element in self._file.get("/observables/probes", {}).values():
            yield element["value"]
        yield from self._file.get("/rbsim/frames", {}).values()

    def _read(self, path: str) -> Array:
        """A dataset; those with a row for each frame are cut to the frames that are whole."""
        if path not in self._arrays:
            if path not in self._file:
                raise AttributeError(f"'{self.path}' does not hold '{path}': was it asked for with "
                                     "record { fields = ... }?")
            values = self._file[path][()]
            self._arrays[path] = values[:self.frame_count] if path.endswith(("/value", "/step", "/time")) and \
                not path.startswith("/rbsim") else values
        return self._arrays[path]

    def _reader(self, path: str) -> Callable[[], Array]:
        return lambda: self._read(path)

    def _column(self, name: str) -> Array:
        return self._read(f"{_BODIES}/{name}/value")

    def close(self) -> None:
        """Closes the file, and removes it where it was made for this object only."""
        self._closer()
        if self._folder:
            self._folder.cleanup()

    def __enter__(self) -> "Run":
        return self

    def __exit__(self, *unused: object) -> None:
        self.close()

    # ---- what it says of itself ----

    def _about(self, name: str) -> str:
        return _text(self._file[f"/rbsim/{name}"][()]) if f"/rbsim/{name}" in self._file else ""

    @property
    def status(self) -> str:
        """complete, running, interrupted or failed."""
        return self._about("status")

    @property
    def reason(self) -> str:
        """Why the run ended before its time, "" where it did not."""
        return self._about("reason")

    @property
    def title(self) -> str:
        return self._about("title")

    @property
    def state_hash(self) -> str:
        """Hash of the last state: the same for the same bits."""
        return self._about("state_hash")

    @property
    def scene(self) -> str:
        """The text of the scene."""
        return self._about("scene")

    @property
    def method(self) -> str:
        return self._about("method")

    @property
    def parameters(self) -> Dict[str, Any]:
        """Values of the scene's parameters."""
        found: Dict[str, Any] = {}
        for name, dataset in self._file.get("/rbsim/parameters", {}).items():
            value = dataset[()]
            found[_unescape(name)] = _text(value) if isinstance(value, (bytes, str)) else value.item()
        return found

    @property
    def ok(self) -> bool:
        """Whether every expectation holds, of a run that was made here."""
        return all(expectation["ok"] for expectation in self.summary.get("expectations", []))

    # ---- columns ----

    @property
    def time(self) -> Array:
        """[frames], s."""
        return self._read("/observables/kinetic_energy/time" if "/observables/kinetic_energy/time" in self._file
                          else f"{_BODIES}/position/time")

    @property
    def frame(self) -> Array:
        """[frames]: numbers of the frames."""
        return self._read("/observables/kinetic_energy/step")

    @property
    def position(self) -> Array:
        """[frames, bodies, 3], m, of the objects' origins."""
        return self._column("position")

    @property
    def velocity(self) -> Array:
        """[frames, bodies, 3], m/s, of the centres of mass."""
        return self._column("velocity")

    @property
    def orientation(self) -> Array:
        """[frames, bodies, 4], unit quaternions w, x, y, z; the same for all frames where nothing can turn."""
        element = self._file[f"{_BODIES}/orientation"] if f"{_BODIES}/orientation" in self._file else None
        if isinstance(element, h5py.Dataset):
            return np.broadcast_to(element[()], (self.frame_count, len(self.ids), 4))
        return self._column("orientation")

    @property
    def angular_velocity(self) -> Array:
        """[frames, bodies, 3], rad/s, world axes."""
        return self._column("angular_velocity")

    @property
    def acceleration(self) -> Array:
        """[frames, bodies, 3], m/s^2, of the centres of mass; where the scene records it."""
        return self._column("acceleration")

    @property
    def angular_acceleration(self) -> Array:
        """[frames, bodies, 3], rad/s^2; where the scene records it."""
        return self._column("angular_acceleration")

    @property
    def force(self) -> Array:
        """[frames, bodies, 3], N, of all that acts; where the scene records it."""
        return self._column("force")

    @property
    def torque(self) -> Array:
        """[frames, bodies, 3], N m, about the centres of mass; where the scene records it."""
        return self._column("torque")

    @property
    def observables(self) -> Mapping[str, Array]:
        """Numbers of every frame: kinetic_energy, momentum, max_penetration, ..., and ledger/NAME."""
        readers: Dict[str, Callable[[], Array]] = {}

        def visit(prefix: str, group: "h5py.Group") -> None:
            for name, element in group.items():
                if not isinstance(element, h5py.Group) or prefix + name == "probes":
                    continue
                if "value" in element:
                    readers[prefix + name] = self._reader(f"/observables/{prefix}{name}/value")
                visit(f"{prefix}{name}/", element)  # one that has a value may have others within it

        visit("", self._file["/observables"])
        return _Lazy(readers)

    @property
    def energy(self) -> Array:
        """[frames], J: kinetic and potential."""
        energy: Array = self._read("/observables/kinetic_energy/value") + self._read("/observables/potential_energy/value")
        return energy

    @property
    def probes(self) -> Mapping[str, Array]:
        """The scene's probes by name, [frames] each; NaN where one had no value."""
        return _Lazy({_unescape(name): self._reader(f"/observables/probes/{name}/value")
                      for name in self._file.get("/observables/probes", {})})

    @property
    def results(self) -> Dict[str, float]:
        """The scene's results by name; NaN until the run has come to its end."""
        return _Named((_unescape(name), float(dataset[()]))
                      for name, dataset in self._file.get("/results", {}).items())

    @property
    def units(self) -> Dict[str, str]:
        """Units by name, of columns of bodies, observables, probes and results; "" of pure numbers."""
        found: Dict[str, str] = {"time": "s"}
        for folder in (_BODIES, "/observables", "/observables/probes", "/results"):
            for name, element in self._file.get(folder, {}).items():
                value = element.get("value") if isinstance(element, h5py.Group) else element
                if isinstance(value, h5py.Dataset):
                    found[_unescape(name)] = _text(value.attrs.get("units", b""))
        return found

    def _table(self, group: str, kinds: Optional[Dict[int, str]] = None) -> Array:
        """A group of columns as one structured array."""
        if group not in self._file:
            raise AttributeError(f"'{self.path}' holds no {group.rsplit('/', 1)[-1]}: ask for them with "
                                 f"record {{ fields = {{\"+\", \"{group.rsplit('/', 1)[-1]}\"}} }}")
        columns = {name: dataset[()] for name, dataset in self._file[group].items()}
        rows = min((len(column) for column in columns.values()), default=0)
        ends = self._file.get(f"/rbsim/frames/{group.rsplit('/', 1)[-1][:-1]}_end")
        if ends is not None:  # a run that was killed may have written rows of frames that are not whole
            rows = min(rows, int(ends[self.frame_count - 1]) if self.frame_count else 0)
        types: List[Tuple[Any, ...]] = []
        for name, column in columns.items():
            kind: Any = "U16" if kinds and name == "kind" else column.dtype
            types.append((name, kind, column.shape[1:]))
        table = np.empty(rows, dtype=types)
        for name, column in columns.items():
            if kinds and name == "kind":
                table[name] = [kinds.get(int(kind), str(kind)) for kind in column[:rows]]
            else:
                table[name] = column[:rows]
        return table

    @property
    def events(self) -> Array:
        """Impacts and transitions in order of time: time, kind (a text), a, b (ids), point, normal, impulse, ..."""
        kinds = _kinds(self._file["/rbsim/events/kind"]) if "/rbsim/events/kind" in self._file else {}
        return self._table("/rbsim/events", kinds)

    @property
    def contacts(self) -> Array:
        """Lasting contacts, a row for each frame that one is seen in: step, a, b (ids), point, normal, force, gap."""
        return self._table("/rbsim/contacts")

    # ---- bodies ----

    def index(self, body: Union[str, int]) -> int:
        """Place of a moving body along the second axis: by its name, or by its id in the scene."""
        for k, number in enumerate(self.ids):
            if number == body or (isinstance(body, str) and self.names[number] == body):
                return k
        raise KeyError(f"no moving body {body!r}")

    def __getitem__(self, body: Union[str, int]) -> Body:
        return Body(self, self.index(body))

    @property
    def bodies(self) -> List[Body]:
        return [Body(self, k) for k in range(len(self.ids))]

    # ---- joints ----

    @property
    def joints(self) -> List[Joint]:
        """All joints in the order of the scene; none of a scene without."""
        return [Joint(self, k) for k in range(len(self._file["/joints/kind"]) if "/joints/kind" in self._file else 0)]

    def joint(self, joint: Union[str, int]) -> Joint:
        """A joint by its name, or by its place in the order of the scene."""
        for one in self.joints:
            if joint == one.index or (joint and one.name == joint):
                return one
        raise KeyError(f"no joint {joint!r}")

    def frames(self) -> Any:
        """A pandas frame with the time, energies, counts and probes of every frame."""
        import pandas  # type: ignore[import-untyped,unused-ignore]
        columns: Dict[str, Array] = {"time": self.time}
        for name, values in list(self.observables.items()) + list(self.probes.items()):
            if values.ndim == 1:
                columns[name] = values
        return pandas.DataFrame(columns, index=pandas.Index(self.frame, name="frame"))

    # ---- the program ----

    def render(self, output: PathLike, **options: Any) -> Path:
        """Makes a film or picture with `rbsim render`: render("f.mp4", camera="main", speed=0.25)."""
        call(["render", str(self.path), "-o", str(output), "-q", *options_of(options)])
        return Path(output)

    def replay(self) -> bool:
        """Whether another run of the recorded scene gives the same bits."""
        return call(["replay", str(self.path), "-q"], allowed=(0, 1))[0] == 0

    def film(self, **options: Any) -> bytes:
        """The bytes of an .mp4 film of all that moves, or of a camera of the scene (camera=NAME)."""
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "film.mp4"
            return self.render(path, **options).read_bytes()

    def __repr__(self) -> str:
        return (f"<run {str(self.path)!r}: {_count(self.frame_count, 'frame', 'frames')} of "
                f"{_count(len(self.ids), 'body', 'bodies')}, {self.status}>")

    def _repr_html_(self) -> str:
        """For notebooks: what the run is, its numbers, and its film."""
        rows = "".join(f"<tr><td>{html.escape(name)}</td><td>{value:.9g} {html.escape(self.units.get(name, ''))}</td></tr>"
                       for name, value in self.results.items())
        text = f"<p>{html.escape(repr(self))}</p>" + (f"<table>{rows}</table>" if rows else "")
        try:
            if self._film is None:
                self._film = self.film()
        except RbsimError as error:
            return f"{text}<p>no film: {html.escape(error.message)}</p>"
        if len(self._film) > FILM_BYTES_MAX:
            return f"{text}<p>the film is too large for a notebook: run.render(\"film.mp4\")</p>"
        film = base64.b64encode(self._film).decode("ascii")
        return f'{text}<video controls loop muted src="data:video/mp4;base64,{film}"></video>'


def open(path: PathLike) -> Run:  # noqa: A001 (meant to be called as rbsim.open)
    """Opens a recording, also one that still grows or whose run was killed."""
    return Run(path)
