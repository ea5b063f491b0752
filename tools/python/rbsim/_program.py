# SPDX-License-Identifier: MIT
"""Finding the program and calling it."""
import json
import os
import shutil
import subprocess
from pathlib import Path
from typing import Any, Dict, List, Optional, Sequence, Tuple


class RbsimError(RuntimeError):
    """The program has failed: `status` is its exit status (rbsim(1)), `message` what it has said."""

    def __init__(self, status: int, message: str) -> None:
        super().__init__(f"rbsim: {message} (exit status {status})")
        self.status = status
        self.message = message

    def __reduce__(self) -> Tuple[Any, ...]:
        return (type(self), (self.status, self.message))


class ExpectationError(RbsimError):
    """An expectation of the scene does not hold; the run and its recording are whole."""


def program() -> str:
    """Path of the program: RBSIM in the environment, `rbsim` in PATH, or that of the tree around this package."""
    named = os.environ.get("RBSIM") or shutil.which("rbsim")
    if named:
        return named
    built = Path(__file__).resolve().parents[3] / "build" / "release" / "rbsim"
    if built.exists():
        return str(built)
    raise RbsimError(69, "no program 'rbsim': set RBSIM, put it into PATH, or build it with make")


def version() -> str:
    """What `rbsim --version` says in its first line: "rbsim 0.1.0"."""
    return call(["--version"])[1].splitlines()[0]


def call(arguments: Sequence[str], allowed: Sequence[int] = (0,)) -> Tuple[int, str]:
    """Calls the program; its exit status and standard output. RbsimError for a status that is not allowed."""
    done = subprocess.run([program(), *arguments], stdin=subprocess.DEVNULL, capture_output=True, text=True,
                          errors="replace", check=False)
    if done.returncode not in allowed:
        said = [line for line in done.stderr.splitlines() if line.strip()]
        message = "\n".join(said) if said else "it ended without a word"
        if message.startswith("rbsim: "):
            message = message[len("rbsim: "):]
        # a negative number is that of a signal
        raise RbsimError(done.returncode, message)
    return done.returncode, done.stdout


def call_json(arguments: Sequence[str], allowed: Sequence[int] = (0,)) -> Tuple[int, Dict[str, Any]]:
    """The same for calls with --json: the object that was printed."""
    status, out = call(arguments, allowed)
    found = json.loads(out)
    if not isinstance(found, dict):
        raise RbsimError(70, "the program has printed no object")
    return status, found


def text_of(value: Any) -> str:
    """A parameter's value as the command line takes it; numbers so that they are read back to the same bit."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, str)):
        return str(value)
    if hasattr(value, "item"):  # a number of numpy's
        return text_of(value.item())
    if isinstance(value, float):
        return repr(value)
    raise TypeError(f"a parameter must be a number, a truth value or a text, not {type(value).__name__}")


def options_of(options: Dict[str, Any], flags: Optional[Sequence[str]] = None) -> List[str]:
    """Options by their names in Python: {"time_step": 0.01} is --time-step 0.01; None is left out, True is a flag."""
    out: List[str] = list(flags or [])
    for name, value in options.items():
        word = "--" + name.replace("_", "-")
        if value is None or value is False:
            continue
        out += [word] if value is True else [word, text_of(value)]
    return out
