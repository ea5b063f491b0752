#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Random scenes (scene.lua), run by every method, and what must hold of every one of them.

    run.py --seeds 200                          200 seeds from 1 on, and a table
    run.py --seed 17 --methods auto             one
    run.py --emit 17 >scene.lua                 a seed as plain calls
    run.py --file scene.lua                     the same checks on a file of plain calls

A check gives a line `FAIL seed method check: what was found`; the exit status is 1 if there is any that --known does not
list, or if one is listed that holds. What is checked:

    ends       exit status 0, within the processor time (which is limited for each run: --processor)
    slow       no more than 2 s of processor time a simulated second (times --slack)
    gain       energy never rises by more than 1e-9 of its scale where nothing could give any
    ledger     where it is kept: what it cannot explain is below 1e-12 of what moved, located (velocities of motions stated);
               by steps so is what it cannot explain of momentum, and no energy comes from nowhere
    order      by steps, energy that it cannot explain is less with a shorter step
    overlap    no frame shows one beyond the tolerance
    lost       every position is a number, nobody is behind an infinite plane
    threads    the same bits with 1 and 3 threads
    copies     turned and mirrored scenes move alike, as long as a change by 1e-12 does not matter
"""
import argparse
import json
import math
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
CALLS = "world sphere box capsule cylinder hull body plane spring field".split()
HEADER = "local functions, watch = require 'functions', require 'watch' local %s = %s\n" % (
    ", ".join(CALLS), ", ".join("watch." + c for c in CALLS))
FOOTER = "\nwatch.look()\n"
SECONDS_PER_SECOND = 2.0
# Below this a run is start and load.
LEAST_SECONDS = 0.2
GAIN = 1e-9
# Of energy and momenta, located.
UNEXPLAINED = 1e-12
# Share of the energy beyond which what steps leave unexplained is theirs, not that of the tolerance.
ROUGH = 1e-6
DISTURBANCE = 1e-12
# Copies are compared until the disturbance has grown to this share of the scene.
GROWN = 1e-7


class Bench:
    """Runs scenes in a folder of its own."""

    def __init__(self, program, processor):
        self.program = os.path.abspath(program)
        self.processor = processor
        self.folder = tempfile.mkdtemp(prefix="random-")
        for name in ("scene.lua", "functions.lua", "watch.lua"):
            shutil.copy(os.path.join(HERE, name), self.folder)

    def close(self):
        shutil.rmtree(self.folder, ignore_errors=True)

    def start(self, arguments, limit):
        """Exit status (negative: a signal), output, messages, processor seconds."""
        def limited():
            signal.setitimer(signal.ITIMER_PROF, limit)
            resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(limit) + 1, math.ceil(limit) + 3))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        out = open(os.path.join(self.folder, "out"), "w+")
        err = open(os.path.join(self.folder, "err"), "w+")
        child = subprocess.Popen([self.program] + arguments, stdout=out, stderr=err, stdin=subprocess.DEVNULL,
                                 cwd=self.folder, preexec_fn=limited)
        # Only what waits for ever without computing comes to this.
        signal.signal(signal.SIGALRM, lambda *_: child.kill())
        signal.alarm(60 + math.ceil(20 * limit))
        _, status, usage = os.wait4(child.pid, 0)
        signal.alarm(0)
        child.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0)
        err.seek(0)
        result = child.returncode, out.read(), err.read(), usage.ru_utime + usage.ru_stime
        out.close()
        err.close()
        return result

    def emit(self, first, count, params):
        """The scenes of seeds as lists of lines."""
        arguments = ["scene.lua", "--no-record", "--param", "seed=%d" % first, "--param", "emit=%d" % count]
        for p in params:
            arguments += ["--param", p]
        status, _, text, _ = self.start(arguments, 600)
        if status:
            sys.exit("cannot make scenes: %s" % text.strip())
        scenes = []
        for line in text.split("\n"):
            if line.startswith("seed "):
                scenes.append([])
            elif line.startswith("="):
                scenes[-1].append(line[1:])
            elif line.startswith("+"):
                scenes[-1][-1] += line[1:]
        return scenes

    def write(self, lines):
        with open(os.path.join(self.folder, "s.lua"), "w") as f:
            f.write(HEADER + "\n".join(lines) + FOOTER)

    def run(self, method, *params, threads=2, duration=None, processor=None, step=None):
        """One run of the scene that was written."""
        arguments = ["s.lua", "--no-record", "--json", "--method", method, "--threads", str(threads)]
        for p in params:
            arguments += ["--param", p]
        if duration:
            arguments += ["--duration", repr(duration)]
        if step:
            arguments += ["--time-step", repr(step)]
        return Run(*self.start(arguments, processor or self.processor))


class Run:
    def __init__(self, status, out, err, seconds):
        self.status, self.seconds = status, seconds
        self.frames, self.places, self.talk = [], [], []
        for line in err.split("\n"):
            try:
                if line.startswith("@ "):
                    self.frames.append([float(x) for x in line[2:].split()])
                    continue
                if line.startswith("# "):
                    self.places.append([])
                if line.startswith(("# ", ", ")):
                    self.places[-1].append([float(x) for x in line[2:].split()])
                    continue
            except ValueError:
                pass
            if line.strip():
                self.talk.append(line)
        try:
            self.facts = json.loads(out.replace("nan", "NaN")) if out.strip() else {}
        except ValueError:
            self.facts = {}

    def why(self):
        message = self.facts.get("reason") or (self.facts.get("error") or "")
        if isinstance(message, dict):
            message = json.dumps(message)
        text = message or (self.talk[-1] if self.talk else "")
        name = "exit %d" % self.status if self.status >= 0 else "signal %d" % -self.status
        return "%s, %.2f s: %s" % (name, self.seconds, text.strip()[:200])

    def over_time(self):
        return self.status in (-signal.SIGPROF, -signal.SIGXCPU, -signal.SIGKILL)


def passive(lines, springs):
    """Nothing in the scene can give energy; springs only give back."""
    text = "\n".join(lines)
    words = [r"motion\s*=", r"^field", r"^on_", r"\bforces\s*=", "gravitation"] + ([] if springs else [r"^spring"])
    return not any(re.search(w, text, re.M) for w in words)


def duration_of(lines):
    found = re.search(r"\bduration = ([-+0-9.e]+)", "\n".join(l for l in lines if l.startswith("world")))
    return float(found.group(1)) if found else 1.0


def gains(run):
    """The largest rise of energy over its scale: from the start, and from the lowest before."""
    if not run.frames:
        return 0.0, 0.0
    first = run.frames[0]
    kinetic = max(f[2] for f in run.frames)
    potential = max(abs((f[1] - f[2]) - (first[1] - first[2])) for f in run.frames)
    # What coordinates and their potential round away is no gain.
    scale, rounding = kinetic + potential, 64 * 2.0 ** -52 * max(abs(f[1]) for f in run.frames)
    lowest, start, rise = first[1], 0.0, 0.0
    for f in run.frames:
        start = max(start, f[1] - first[1] - rounding)
        rise = max(rise, f[1] - lowest - rounding)
        lowest = min(lowest, f[1])
    return (start / scale, rise / scale) if scale > 0 else (0.0, 0.0)


def extent(run):
    """The largest coordinate at the start."""
    return max((abs(x) for p in run.places[:1] for q in p for x in q), default=1.0) or 1.0


def promised(run):
    """m: the largest overlap that a frame may show: that of steps, where some were taken."""
    return run.facts["stepped_tolerance" if run.facts["stepped"] > 0 else "tolerance"]


def apart(a, b):
    """Distances of places, frame by frame, as a share of the scene."""
    size = extent(a)
    result = []
    for p, q in zip(a.places, b.places):
        result.append(max(math.dist(x, y) / size for x, y in zip(p, q)))
    return result


class Judge:
    """All checks of one scene by one method."""

    def __init__(self, bench, checks, slack=1.0):
        self.bench, self.checks, self.slack = bench, checks, slack

    def judge(self, lines, method, number=0, limit=None):
        """The first run, and what was found wrong: a list of (check, text)."""
        bench, checks, found = self.bench, self.checks, []
        bench.write(lines)
        seconds = duration_of(lines)
        allowed = self.slack * max(LEAST_SECONDS, SECONDS_PER_SECOND * seconds)
        limit = limit or max(bench.processor, allowed)
        places = ["places=true"] if "copies" in checks else []
        run = bench.run(method, *places, processor=limit)
        run.allowed = allowed
        if run.over_time() or ("slow" in checks and run.seconds > allowed):
            found.append(("slow", "%.2f s of processor for %g s%s" % (
                run.seconds, seconds, ", no end" if run.over_time() else "")))
        if run.status and not run.over_time() and "ends" in checks and (method, run.status) != ("classic", 65):
            found.append(("exit%d" % run.status if run.status > 0 else "signal%d" % -run.status, run.why()))
        run.gain = run.rise = 0.0
        if passive(lines, method == "located"):
            run.gain, run.rise = gains(run)
        if "gain" in checks and run.rise > GAIN and method != "classic":
            found.append(("gain", "energy rises by %.3g of its scale, from the start by %.3g" % (run.rise, run.gain)))
        run.ledger = run.facts.get("ledger") or {}
        shares = [run.ledger.get(k, 0.0) for k in ("unexplained_share", "momentum_share", "angular_momentum_share")]
        run.unexplained = max([x if x == x else math.inf for x in shares])
        if "ledger" in checks and method == "located" and not re.search(r"shaken\(.*false\)", "\n".join(lines)) and \
                run.unexplained > UNEXPLAINED:
            found.append(("ledger", "unexplained are %.3g of the energy, %.3g and %.3g of the momenta" % tuple(shares)))
        if "ledger" in checks and method in ("stepped", "auto") and not shares[1] <= UNEXPLAINED:
            found.append(("ledger", "unexplained are %.3g of the momentum" % shares[1]))
        if "ledger" in checks and method in ("stepped", "auto") and passive(lines, False) and \
                not run.ledger.get("gained_share", 0.0) <= GAIN:
            found.append(("ledger", "%.3g of the energy comes from nowhere" % run.ledger["gained_share"]))
        deepest = max((f[3] for f in run.frames), default=0.0)
        run.overlap = deepest / promised(run) if run.facts else 0.0
        if "overlap" in checks and run.overlap > 1 and not run.status:
            found.append(("overlap", "%.3g m, %.3g tolerances" % (deepest, run.overlap)))
        if "lost" in checks and any(not f[4] <= 1e-3 for f in run.frames):
            found.append(("lost", "behind a plane by %g of its size" % max(f[4] for f in run.frames)))
        if run.status or run.over_time():
            return run, found
        if "threads" in checks:
            for threads in (1, 3):
                other = bench.run(method, threads=threads, processor=2 * limit)
                if other.facts.get("state_hash") != run.facts.get("state_hash") and not other.over_time():
                    found.append(("threads", "%s with %d threads, %s with 2" % (
                        other.facts.get("state_hash"), threads, run.facts.get("state_hash"))))
        if "order" in checks and method == "stepped":
            found += self.order(run, 16 * limit)
        if "copies" in checks and not re.search(r"^on_", "\n".join(lines), re.M):
            found += self.copies(run, method, number, 2 * limit)
        return run, found

    def order(self, run, limit):
        """First order: a sixteenth of the step leaves less, or its quarter does: by chance the first has left little."""
        shares = [run.ledger.get("unexplained_share", 0.0)]
        if not shares[0] > ROUGH:
            return []
        for parts in 16, 64:
            fine = self.bench.run("stepped", processor=limit, step=run.facts["time_step"] / parts)
            if fine.over_time():
                return []
            shares.append((fine.facts.get("ledger") or {}).get("unexplained_share", math.inf))
            if shares[-1] < 0.5 * shares[-2]:
                return []
        return [("order", "%.3g of the energy is unexplained, %.3g and %.3g by steps of 1/16 and 1/64 of it" % tuple(shares))]

    def copies(self, run, method, number, limit):
        found = []
        grown = [0.0] * len(run.places)
        for sign in (1, -1):
            other = self.bench.run(method, "places=true", "disturb=%g" % (sign * DISTURBANCE), processor=limit)
            far = apart(run, other)
            grown = [max(a, b) for a, b in zip(grown, far)] if len(far) == len(run.places) else []
        own = 0 if method == "located" else 100 * run.facts.get("stepped_tolerance", 0) / extent(run)
        for name, params in (("turned", "turn=%d" % (1 if number % 2 else 3)), ("turned", "turn=2"), ("mirrored", "mirror=true")):
            other = self.bench.run(method, "places=true", params, processor=limit)
            if other.over_time():
                continue
            far = apart(run, other)
            worst = 0.0
            for k, d in enumerate(far):
                if k >= len(grown) or grown[k] > GROWN:
                    break
                worst = max(worst, grown[k])
                if not d <= 1e-12 + 30 * worst + own:
                    found.append((name, "%s: frame %d is %.3g off where a change by %g grows to %.3g" % (
                        params, k, d, DISTURBANCE, worst)))
                    break
            if other.status:
                found.append((name, "%s: %s" % (params, other.why())))
        return found


class Table:
    """Numbers of all runs of a method."""

    def __init__(self):
        self.rows = {}

    def add(self, method, seed, run, found):
        row = self.rows.setdefault(method, dict(runs=0, gains=[0, 0, 0], failed=0, slow=0, other=0, overlap=0, lost=0,
                                                bits=0, copies=0, worst=(0.0, 0), open=(0.0, 0), seconds=0.0))
        row["runs"] += 1
        row["seconds"] += run.seconds
        for i, bound in enumerate((GAIN, 1e-4, 1e-2)):
            row["gains"][i] += run.rise > bound
        row["worst"] = max(row["worst"], (run.rise, seed))
        row["open"] = max(row["open"], (run.unexplained, seed))
        row["failed"] += run.status == 76
        row["slow"] += run.over_time() or run.seconds > run.allowed
        row["other"] += run.status not in (0, 76) and not run.over_time()
        kinds = {check for check, _ in found}
        for key, check in (("overlap", "overlap"), ("lost", "lost"), ("bits", "threads")):
            row[key] += check in kinds
        row["copies"] += bool(kinds & {"turned", "mirrored"})

    def show(self):
        form = "%-8s %6s %7s %7s %7s %5s %6s %6s %8s %5s %5s %7s %9s  %-16s %s"
        print(form % ("method", "runs", ">1e-9", ">1e-4", ">1e-2", "76", ">2s/s", "other", "overlap", "lost", "bits", "copies",
                      "processor", "most rise (seed)", "most unexplained (seed)"))
        for method, r in self.rows.items():
            print(form % (method, r["runs"], *r["gains"], r["failed"], r["slow"], r["other"], r["overlap"], r["lost"], r["bits"],
                          r["copies"], "%.0f s" % r["seconds"], "%.3g (%d)" % r["worst"], "%.3g (%d)" % r["open"]))


def read_known(path):
    """Lines `seed method check reason`."""
    known = {}
    if path:
        for line in open(path):
            words = line.split("#")[0].split(None, 3)
            if len(words) >= 3:
                known[(int(words[0]), words[1], words[2])] = words[3] if len(words) > 3 else ""
    return known


def read_file(path):
    """A file of plain calls, one a line, as `plain` writes it; what it took from functions.lua is there anyway."""
    with open(path) as f:
        text = re.sub(r"^local functions = \{\}\n(function functions\..*?^end\n)*", "", f.read(), flags=re.M | re.S)
    return [line for line in text.split("\n") if line.strip() and not line.startswith("--")]


def main():
    here = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    here.add_argument("--program", default=os.environ.get("RBSIM") or os.path.join(HERE, "../../build/release/rbsim"))
    here.add_argument("--first", type=int, default=1, help="first seed")
    here.add_argument("--seed", type=int, help="only this one")
    here.add_argument("--seeds", type=int, default=10, help="how many")
    here.add_argument("--methods", default="located,stepped,auto")
    here.add_argument("--checks", default="ends,slow,gain,ledger,overlap,lost", help="of those above, or all")
    here.add_argument("--copies-every", type=int, default=1, help="threads and copies only of each n-th seed")
    here.add_argument("--located-every", type=int, default=1, help="the located method only with each n-th seed")
    here.add_argument("--param", action="append", default=[], help="NAME=VALUE of scene.lua")
    here.add_argument("--processor", type=float, default=0, help="seconds after which a run is ended, at least")
    here.add_argument("--slack", type=float, default=1, help="this many times the processor time, for slow machines")
    here.add_argument("--known", help="file of failures that are known")
    here.add_argument("--times", action="store_true", help="a line for each run: seed, method, processor seconds")
    here.add_argument("--emit", type=int, metavar="SEED", help="print a scene")
    here.add_argument("--file", help="check this scene")
    o = here.parse_args()
    checks = set(o.checks.split(","))
    if "all" in checks:
        checks = {"ends", "slow", "gain", "ledger", "overlap", "lost", "threads", "copies", "order"}
    bench = Bench(o.program, o.processor)
    try:
        sys.exit(run_all(o, bench, checks))
    finally:
        bench.close()


def plain(lines):
    """A scene that needs no other file: what it takes from functions.lua is in it."""
    text = "\n".join(lines) + "\n"
    with open(os.path.join(HERE, "functions.lua")) as f:
        made = re.findall(r"^function functions\.(\w+)(.*?^end\n)", f.read(), re.M | re.S)
    used = ["function functions.%s%s" % part for part in made if "functions.%s(" % part[0] in text]
    return ("local functions = {}\n" + "".join(used) if used else "") + text


def run_all(o, bench, checks):
    if o.emit is not None:
        print(plain(bench.emit(o.emit, 1, o.param)[0]), end="")
        return 0
    if o.file:
        scenes, o.first = [read_file(o.file)], 0
    elif o.seed is not None:
        scenes, o.first = bench.emit(o.seed, 1, o.param), o.seed
    else:
        scenes = bench.emit(o.first, o.seeds, o.param)
    known, table, bad, seen, ran = read_known(o.known), Table(), 0, set(), set()
    dear = checks & {"threads", "copies", "order"}
    for k, lines in enumerate(scenes):
        seed = o.first + k
        for method in o.methods.split(","):
            if method == "located" and (seed - 1) % o.located_every:
                continue
            judge = Judge(bench, checks if (seed - 1) % o.copies_every == 0 else checks - dear, o.slack)
            # what is known to take for ever is looked at for a moment only
            run, found = judge.judge(lines, method, seed, LEAST_SECONDS if (seed, method, "slow") in known else None)
            if method == "classic" and run.status == 65:
                continue  # a shape that it does not take
            ran.add((seed, method, bool(run.ledger)))
            table.add(method, seed, run, found)
            if o.times:
                print("%d %s %.3f s" % (seed, method, run.seconds))
            for check, text in found:
                key = seed, method, check
                seen.add(key)
                if key in known:
                    continue
                bad += method != "classic"
                print("FAIL %d %s %s: %s" % (seed, method, check, text), flush=True)
    for key in known:
        told = key[:2] + (True,) in ran or (key[2] != "ledger" and key[:2] + (False,) in ran)
        # what took too long was not looked at to its end
        if told and key not in seen and (key[0], key[1], "slow") not in seen:
            bad += 1
            print("FAIL %d %s %s: holds now; take it out of the known ones" % key)
    table.show()
    return 1 if bad else 0


if __name__ == "__main__":
    main()
