# SPDX-License-Identifier: MIT
"""One run: arrays, events, a scene's own numbers, and what they are checked against."""
from pathlib import Path

import numpy as np

import rbsim

scene = Path(__file__).with_name("drop.lua")
with rbsim.run(scene, e=0.5) as run:
    print(run)
    ball = run["ball"]
    print("lowest centre", ball.position[:, 2].min(), run.units["position"])
    impacts = run.events[run.events["kind"] == "collision"]
    print("first impact at", impacts["time"][0], "s")

    # a fall of 1.9 m
    assert abs(impacts["time"][0] - np.sqrt(2 * 1.9 / 9.81)) < 1e-12
    # restitution: speeds of approach fall by e from one impact to the next
    speeds = impacts["approach_speed"][:6]
    assert np.allclose(speeds[1:] / speeds[:-1], 0.5, rtol=1e-9)
    # the probe is what the positions say
    assert np.array_equal(run.probes["height"], ball.position[:, 2] - 0.1)
    assert run.results["bounces"] == len(impacts)
    assert run.parameters == {"e": 0.5}
    assert run.status == "complete" and run.replay()
