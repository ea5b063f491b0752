# SPDX-License-Identifier: MIT
"""A sweep over processes: one run for each value, and the table of them."""
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np

import rbsim

scene = Path(__file__).with_name("drop.lua")


def main() -> None:
    with ProcessPoolExecutor(max_workers=2) as pool:
        sweep = rbsim.sweep(scene, {"e": [0.7, 0.8, 0.9]}, executor=pool)
    for e, kept in zip(sweep.column("e"), sweep.column("energy kept")):
        print(f"e = {e}: {kept:.4g} {sweep.units['energy kept']} kept")
    assert np.all(np.diff(sweep.column("energy kept")) > 0)
    assert sweep.runs[2].parameters["e"] == 0.9
    sweep.close()


if __name__ == "__main__":
    main()
