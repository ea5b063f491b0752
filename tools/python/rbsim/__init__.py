# SPDX-License-Identifier: MIT
"""Runs, recordings and sweeps of rbsim as numpy arrays.

    import rbsim
    run = rbsim.run("bounce.lua", e=0.5)
    run.time, run["ball"].position[:, 2], run.events["time"], run.probes["height"], run.results["bounces"]

    run = rbsim.open("bounce.h5")                      # a recording that is there
    sweep = rbsim.sweep("bounce.lua", {"e": [0.2, 0.5, 0.8]})
    sweep.column("e"), sweep.column("bounces"), sweep.runs[0]

The program `rbsim` does all the work; it is found by the environment variable RBSIM, in PATH, or in the tree that this
package lies in. SI units throughout; quaternions are w, x, y, z.
"""
from ._program import ExpectationError, RbsimError, program, version
from ._recording import Body, Joint, Run, open  # noqa: A004 (the name is that of the module's function)
from ._run import run
from ._sweep import Sweep, open_sweep, sweep

__version__ = "0.1.0"
__all__ = ["Body", "ExpectationError", "Joint", "RbsimError", "Run", "Sweep", "open", "open_sweep", "program", "run",
           "sweep", "version"]
