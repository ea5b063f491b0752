#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Records scenes with contacts and events, lets the oracle look at each, and prints a row for each.

    scenes.py --program RBSIM [--share quick|scenes|verify|steps|random] [--seconds S] [NAME ...]

Scenes are copied, with a call of record { } behind them. A run that does not end within --seconds of wall time is asked
to stop, and what it has recorded counts. Names choose among those of a share by their beginning.
"""
import argparse
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile

try:
    import h5py  # noqa: F401
except ImportError as error:
    print("h5py and numpy are needed:", error)
    sys.exit(77)

from oracle import examine

TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
RECORD = '\nrecord { fields = {"position", "orientation", "velocity", "angular_velocity", "contacts", "events"} }\n'

# What `make test` looks at: every shape, both methods, what pulls and what is driven, for as long as little costs.
QUICK = [
    ("scenes/bounce.lua", ["--duration", "3"]),
    ("scenes/billiard.lua", []),
    ("scenes/card_house.lua", ["--duration", "0.2"]),
    ("scenes/cradle.lua", ["--duration", "0.7"]),
    ("scenes/gas.lua", ["--duration", "0.3"]),
    ("scenes/hopper.lua", ["--param", "n=40", "--duration", "0.5"]),
    ("scenes/marble_run.lua", ["--duration", "0.7"]),
    ("scenes/off_center.lua", ["--duration", "0.5"]),
    ("scenes/scripted.lua", ["--duration", "1"]),
    ("scenes/two_materials.lua", ["--duration", "0.5"]),
    ("scenes/tumbling_hull.lua", ["--duration", "1"]),
    ("scenes/wrecking_ball.lua", ["--duration", "0.3"]),
    ("scenes/verify/B03_rolling.lua", ["--duration", "0.2"]),
    ("scenes/verify/C03_driven_floor.lua", ["--param", "part=belt"]),
    ("scenes/verify/C18_sticks.lua", []),
    ("scenes/verify/C09_same_solid.lua", ["--duration", "0.5"]),
    ("scenes/verify/C10_impacts_lose.lua", []),
    ("scenes/verify/C10_impacts_lose.lua", ["--param", "batch=2", "--param", "frame_rate=60"]),
    ("scenes/verify/S33_dzhanibekov.lua", ["--duration", "0.5"]),
    ("scenes/verify/S35_tip_impact.lua", []),
    ("scenes/verify/S41_stiff_spring.lua", ["--duration", "0.2"]),
]


def is_scene(path):
    with open(path, encoding="utf-8") as f:
        return re.search(r"^\s*(world|verify\.case)\b", f.read(), re.M)


def random_scenes(program, first, count, folder):
    """Those of tests/random, each as a file of plain calls."""
    for seed in range(first, first + count):
        path = os.path.join(folder, f"random-{seed}.lua")
        with open(path, "w", encoding="utf-8") as f:
            subprocess.run([sys.executable, os.path.join(TOP, "tests/random/run.py"), "--program", program, "--emit",
                            str(seed)], stdout=f, check=True)
        yield path, []


def share_of(name):
    if name == "quick":
        return [(path, given) for path, given in QUICK]
    folder = os.path.join(TOP, "scenes", *(["verify"] if name == "verify" else []))
    paths = [os.path.join(folder, f) for f in sorted(os.listdir(folder)) if f.endswith(".lua")]
    if name in ("scenes", "verify"):
        return [(p, []) for p in paths if is_scene(p)]
    if name == "steps":
        return [(p, ["--method", "stepped", "--duration", "0.5"]) for p in paths]
    raise SystemExit(f"no share '{name}'")


def copy(scene, folder):
    """The scene beside the files that it may require."""
    home = os.path.dirname(scene)
    for name in os.listdir(home):
        path = os.path.join(home, name)
        if os.path.isdir(path) and name == "skins" or os.path.isfile(path) and name.endswith((".lua", ".png")):
            (shutil.copytree if os.path.isdir(path) else shutil.copy)(path, os.path.join(folder, name))
    made = os.path.join(folder, os.path.basename(scene))
    with open(made, "r+", encoding="utf-8") as f:
        if not re.search(r"^record\b", f.read(), re.M):
            f.write(RECORD)
    return made


def frame_rate(program, scene, given, env):
    """What one step for each frame is."""
    said = subprocess.run([program, "check", "--json", scene] + given, stdout=subprocess.PIPE, text=True, env=env,
                          check=True).stdout
    return json.loads(said)["frame_rate"]


def record(program, scene, given, folder, seconds, one_step):
    env = dict(os.environ, RBSIM_LUA_PATH=os.path.join(TOP, "lua"))
    made = copy(scene, folder)
    if one_step:
        given = given + ["--time-step", repr(1 / frame_rate(program, made, given, env))]
    out = os.path.join(folder, "run.h5")
    run = subprocess.Popen([program, made, "-o", out, "--no-render", "--quiet", "--force", *given], env=env, cwd=folder,
                           stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    try:
        _, said = run.communicate(timeout=seconds)
    except subprocess.TimeoutExpired:
        run.send_signal(signal.SIGTERM)
        _, said = run.communicate()
    # 1: an expectation of a whole run fails; 76: a run that failed in the end, whose frames count all the same
    if os.path.exists(out):
        return out, ""
    return None, f"exit {run.returncode}: {said.decode(errors='replace').strip().splitlines()[:1]}"


def row(report):
    n, c = report.numbers, report.counts
    energy = max(n.get("kinetic_energy", 0), n.get("potential_energy", 0))
    momentum = max(n.get("momentum", 0), n.get("angular_momentum", 0))
    verdict = "ok" if not report.failures else "FAIL"
    return (f"{report.name:34.34} {c.get('pairs', 0):9d} {n.get('deepest', 0):9.2e} {n.get('told', 0):9.2e} "
            f"{energy:8.1e} {momentum:8.1e} {c.get('contacts', 0):8d} {c.get('impacts', 0):7d} "
            f"{c.get('lone impacts', 0):6d} {c.get('flights', 0):7d} {c.get('steps', 0):6d}  {verdict}")


HEAD = (f"{'scene':34} {'pairs':>9} {'overlap':>9} {'told':>9} {'energy':>8} {'momentum':>8} {'contacts':>8} "
        f"{'impacts':>7} {'lone':>6} {'flights':>7} {'steps':>6}  verdict")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--program", default=os.environ.get("RBSIM", "rbsim"))
    parser.add_argument("--share", default="quick")
    parser.add_argument("--seconds", type=float, default=60, help="of wall time that a run may take")
    parser.add_argument("--frames", type=int, default=24, help="at which gaps of all pairs are looked at")
    parser.add_argument("--first", type=int, default=1, help="seed of the first random scene")
    parser.add_argument("--count", type=int, default=20, help="random scenes")
    parser.add_argument("--all", action="store_true", help="tell also what agrees")
    parser.add_argument("--strict", action="store_true", help="what is known to be wrong counts as well")
    parser.add_argument("--keep", help="folder that recordings are copied to")
    parser.add_argument("--one-step", action="store_true", help="a step for each frame")
    parser.add_argument("--given", default="", help="more options for the program")
    parser.add_argument("name", nargs="*")
    options = parser.parse_args()
    print(HEAD, flush=True)
    with tempfile.TemporaryDirectory() as folder:
        program = os.path.abspath(options.program)
        scenes = random_scenes(program, options.first, options.count, folder) if options.share == "random" else (
            share_of(options.share))
        return judge(options, program, scenes) > 0


def judge(options, program, scenes):
    """How many of the recordings are not what they should be."""
    failed = 0
    for scene, given in scenes:
        scene = os.path.join(TOP, scene)
        name = os.path.splitext(os.path.basename(scene))[0]
        if options.name and not any(name.lower().startswith(n.lower()) for n in options.name):
            continue
        with tempfile.TemporaryDirectory() as folder:
            path, why = record(program, scene, given + options.given.split(), folder,
                               options.seconds, options.one_step or options.share == "steps")
            if not path:
                print(f"{name:34.34} no recording: {why}")
                continue
            report = examine(path, name, options.frames, pending=not options.strict)
            if options.keep:
                shutil.copy(path, os.path.join(options.keep, name + ".h5"))
        print(row(report), flush=True)
        for line in report.lines(options.all):
            print(line, flush=True)
        failed += bool(report.failures)
    return failed


if __name__ == "__main__":
    sys.exit(main())
