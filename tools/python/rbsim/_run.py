# SPDX-License-Identifier: MIT
"""One run of a scene."""
import os
import tempfile
from pathlib import Path
from typing import Any, Mapping, Optional, Sequence, Union

from ._program import ExpectationError, RbsimError, call_json, options_of, text_of
from ._recording import Run


def run(scene: Union[str, "os.PathLike[str]"], *, output: Optional[Union[str, "os.PathLike[str]"]] = None,
        parameters: Optional[Mapping[str, Any]] = None, options: Optional[Mapping[str, Any]] = None,
        flags: Sequence[str] = (), films: bool = False, check: bool = False, **more: Any) -> Run:
    """Runs a scene and opens its recording.

    Parameters of the scene are given by name, run("bounce.lua", e=0.5), or in `parameters` where a name is one of those
    used here. Without `output` the recording is a file of its own that is removed with the object; an `output` that is
    there is replaced. `options` are those of rbsim(1), {"duration": 2, "threads": 1}; `films`: also make what the scene's
    cameras ask for. An expectation that does not hold shows in `run.ok` and `run.summary`; with `check` it is an
    ExpectationError. Everything else that fails is an RbsimError.
    """
    folder = None if output is not None else tempfile.TemporaryDirectory(prefix="rbsim-")
    path = Path(output) if output is not None else Path(folder.name) / "run.h5"  # type: ignore[union-attr]
    words = ["run", str(scene), "-o", str(path), "--force", "--json", *options_of(dict(options or {}), flags)]
    for name, value in {**(parameters or {}), **more}.items():
        words += ["--param", f"{name}={text_of(value)}"]
    if not films:
        words.append("--no-render")
    status, summary = call_json(words, allowed=(0, 1))
    if status == 1 and check:
        failed = [e["text"] for e in summary["expectations"] if not e["ok"]]
        raise ExpectationError(1, f"'{scene}': does not hold: {'; '.join(failed)}")
    if not path.exists():
        raise RbsimError(70, f"'{scene}' was run, but there is no '{path}'")
    return Run(path, summary, folder)
