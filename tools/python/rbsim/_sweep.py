# SPDX-License-Identifier: MIT
"""One run for each point of a range of parameters, over any executor of concurrent.futures."""
import json
import os
import subprocess
import tempfile
import time
from concurrent.futures import Executor
from pathlib import Path
from typing import Any, Dict, Iterator, List, Mapping, Optional, Sequence, Tuple, Union

import h5py
import numpy as np

from ._program import RbsimError, call, call_json, options_of, program, text_of
from ._recording import Array, Run, _text, _unescape

PathLike = Union[str, "os.PathLike[str]"]
Values = Union[str, Sequence[Any]]


def _values(name: str, values: Values) -> str:
    """Values of a parameter as the command line takes them: a text as it is ("0:1:0.1"), else a list."""
    if isinstance(values, str):
        return values
    texts = [text_of(value) for value in values]
    for text in texts:
        if "," in text or ":" in text or not text:
            raise ValueError(f"parameter '{name}': the value '{text}' cannot stand in a list of values")
    if not texts:
        raise ValueError(f"parameter '{name}' has no values")
    return ",".join(texts)


def _task(rbsim: str, folder: str, task: int, tasks: int, words: Sequence[str]) -> Tuple[int, str]:
    """One share of a sweep, run wherever the executor runs it; the folder must be there too."""
    done = subprocess.run([rbsim, "sweep", folder, "--task", str(task), "--tasks", str(tasks), "--jobs", "1", "-q",
                           *words], stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace",
                          check=False)
    return done.returncode, done.stderr


class Sweep:
    """A folder of runs: its table, and each run."""

    def __init__(self, folder: PathLike, temporary: Optional["tempfile.TemporaryDirectory[str]"] = None) -> None:
        self.folder = Path(folder)
        self._temporary = temporary  # removed with this object
        self._columns: Optional[Dict[str, Array]] = None
        self._units: Dict[str, str] = {}

    @property
    def status(self) -> Dict[str, Any]:
        """What `rbsim sweep DIR --status --json` says: how many points are done, failed, missing, ..., and failures."""
        out = call(["sweep", str(self.folder), "--status", "--json"])[1]
        found = json.loads(out)
        assert isinstance(found, dict)
        return found

    def collect(self) -> Path:
        """Makes the table anew: sweep.h5 in the folder."""
        self._columns = None
        call(["collect", str(self.folder), "--force", "-q"])
        return self.folder / "sweep.h5"

    @property
    def columns(self) -> Dict[str, Array]:
        """The table: parameters, the scene's results, numbers of every run, probes, expectations, by name."""
        if self._columns is None:
            path = self.folder / "sweep.h5"
            if not path.exists():
                self.collect()
            found: Dict[str, Array] = {}
            with h5py.File(str(path), "r") as file:
                for group in ("points", "parameters", "results", "probes", "expectations"):
                    for name, dataset in file.get(group, {}).items():
                        values = dataset[()]
                        if values.dtype.kind == "S":
                            values = np.array([_text(value) for value in values])
                        found[_unescape(name)] = values
                        self._units[_unescape(name)] = _text(dataset.attrs.get("units", b""))
            self._columns = found
        return self._columns

    @property
    def units(self) -> Dict[str, str]:
        """Units of the columns, "" of pure numbers."""
        assert self.columns is not None
        return self._units

    def column(self, name: str) -> Array:
        """A column of the table, one value for each point; NaN where its run has none."""
        if name not in self.columns:
            raise KeyError(f"no column '{name}' (there are: {', '.join(self.columns)})")
        return self.columns[name]

    def to_pandas(self) -> Any:
        """The table as a pandas frame."""
        import pandas  # type: ignore[import-untyped,unused-ignore]
        return pandas.DataFrame({name: list(values) for name, values in self.columns.items()})

    def __len__(self) -> int:
        return len(self.column("index"))

    @property
    def runs(self) -> Sequence[Run]:
        """The run of each point, opened when it is asked for."""
        return _Runs(self)

    def __repr__(self) -> str:
        return f"<sweep {str(self.folder)!r}: {len(self)} {'point' if len(self) == 1 else 'points'}>"

    def close(self) -> None:
        """Removes the folder where it was made for this object only."""
        if self._temporary:
            self._temporary.cleanup()

    def __enter__(self) -> "Sweep":
        return self

    def __exit__(self, *unused: object) -> None:
        self.close()


class _Runs(Sequence[Run]):
    def __init__(self, sweep: Sweep) -> None:
        self._sweep = sweep

    def __len__(self) -> int:
        return len(self._sweep)

    def __getitem__(self, point: Any) -> Any:
        if isinstance(point, slice):
            return [self[k] for k in range(*point.indices(len(self)))]
        number = range(len(self))[point]
        found = sorted(self._sweep.folder.glob("point-*.h5"))
        for path in found:
            if int(path.stem.split("-")[1]) == number:
                return Run(path)
        raise RbsimError(66, f"point {number} of '{self._sweep.folder}' has no recording")

    def __iter__(self) -> Iterator[Run]:
        return (self[k] for k in range(len(self)))


def _run_shares(executor: Executor, folder: Path, tasks: int, words: List[str], attempts: int) -> None:
    """Has the executor run all shares. One whose worker dies is asked for again: it goes on where it was.

    Runs of one that was killed may still be at work, and hold its points, so later attempts wait ever longer.
    """
    todo = list(range(tasks))
    for attempt in range(attempts):
        if attempt > 0:
            time.sleep(0.1 * 4 ** attempt)
        futures = [(task, executor.submit(_task, program(), str(folder.resolve()), task, tasks, words))
                   for task in todo]
        again, said = [], ""
        for task, future in futures:
            try:
                status, message = future.result()
            except Exception as error:  # a worker that died; executors differ in what they raise
                again.append(task)
                said = f"a worker died: {error!r}"
                continue
            # 1: points have failed, which the table tells; 75 and signals: the share has more to do
            if status in (75, 130, 137, 143) or status < 0:
                again.append(task)
                said = f"a share of the sweep ended with status {status}: {message.strip()}"
            elif status not in (0, 1):
                raise RbsimError(status, message.strip() or "a share of the sweep has failed")
        if not again:
            return
        todo = again
    raise RbsimError(75, f"{len(todo)} of {tasks} shares are not done after {attempts} attempts; {said}")


def sweep(scene: PathLike, parameters: Optional[Mapping[str, Values]] = None, *, folder: Optional[PathLike] = None,
          executor: Optional[Executor] = None, tasks: Optional[int] = None, attempts: int = 5, seeds: int = 1,
          options: Optional[Mapping[str, Any]] = None, flags: Sequence[str] = ()) -> Sweep:
    """Runs a scene for each combination of values: sweep("bounce.lua", {"e": [0.2, 0.5], "mu": "0:1:0.1"}).

    Without an executor the runs go on this machine's processors. Any executor of concurrent.futures carries them
    elsewhere (a ProcessPoolExecutor, Dask's client.get_executor(), mpi4py.futures.MPIPoolExecutor): it gets `tasks`
    shares (default: one for each point), each a call of the program on `folder`, which all workers must see. A share
    whose worker dies is given out again, `attempts` times in all, and goes on from what was done. The results are the
    same bits in every way of running them.

    Without `folder` the runs are in a temporary folder that is removed with the object; one that holds this sweep
    already is gone on with. `options` are those of `rbsim sweep`, {"sample": "latin:100", "seed": 7, "duration": 2}.
    Points that fail are in `sweep.status["failures"]`.
    """
    temporary = None if folder is not None else tempfile.TemporaryDirectory(prefix="rbsim-sweep-")
    path = Path(folder) if folder is not None else Path(temporary.name) / "sweep"  # type: ignore[union-attr]
    words = ["sweep", str(scene), "-o", str(path)]
    for name, values in (parameters or {}).items():
        words += ["--param", f"{name}={_values(name, values)}"]
    if seeds != 1:
        words += ["--seeds", str(seeds)]
    more = options_of(dict(options or {}), flags)
    if executor is None:
        call([*words, *more, "-q"], allowed=(0, 1))
    else:
        _, plan = call_json([*words, *more, "--plan", "--json"])
        count = int(plan["points"])
        _run_shares(executor, path, min(tasks or count, count), [], attempts)
    made = Sweep(path, temporary)
    made.collect()
    return made


def open_sweep(folder: PathLike) -> Sweep:
    """A folder that `rbsim sweep` has made; its table is made anew."""
    made = Sweep(folder)
    made.collect()
    return made
