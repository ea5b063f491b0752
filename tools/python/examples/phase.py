# SPDX-License-Identifier: MIT
"""A phase portrait and a spectrum: what one does with arrays, without another library."""
from pathlib import Path

import numpy as np

import rbsim

scene = Path(__file__).with_name("drop.lua")
with rbsim.run(scene, options={"duration": 1}) as run:
    height, speed = run.probes["height"], run["ball"].velocity[:, 2]
    # between impacts the energy per weight, height + v^2 / 2g, keeps its value
    level = height + speed**2 / (2 * 9.81)
    steps = np.abs(np.diff(level))
    print("levels:", np.unique(level.round(6)))
    assert np.sum(steps > 1e-9) == run.results["bounces"]
    power = np.abs(np.fft.rfft(height - height.mean()))
    print("strongest frequency:", np.fft.rfftfreq(len(height), run.time[1])[power.argmax()], "Hz")
