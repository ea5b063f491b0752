#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Changes bytes of recordings, checkpoints and sweeps, and gives them to every verb that reads or writes such.

Each must end, by itself, with a status that rbsim(1) states: not by a signal, not as a bug (70), and without leaving a
partial file. Files are those of --folder, made by tests/cli/damage.sh:

  whole.h5                    a complete recording
  cut.h5, cut.h5.checkpoint   those of a run that was killed, of cut.lua
  sweep/                      a finished sweep with recordings

The n-th change is always the same for the same files (--first, --count).
"""
import argparse
import os
import pty
import random
import shutil
import signal
import subprocess
import sys
import time

STATED = {0, 1, 2, 64, 65, 66, 69, 71, 73, 74, 75, 76}


def change(data, source):
    """A few bytes of it otherwise, or its end gone."""
    data = bytearray(data)
    if not data:
        return bytes(data)
    kind = source.randrange(8)
    if kind == 0:
        return bytes(data[: source.randrange(len(data))])
    # half of them near the beginning and near other structures: long runs of numbers are dull
    for _ in range(source.choice((1, 1, 1, 2, 8))):
        at = source.randrange(len(data))
        if source.randrange(2):
            marks = [i for i in (data.find(m, at) for m in (b"OHDR", b"OCHK", b"BT", b"EA", b"FA", b"FR", b"FH", b"SNOD", b"GCOL")) if i >= 0]
            at = min(marks) + source.randrange(64) if marks else source.randrange(min(len(data), 2048))
            at = min(at, len(data) - 1)
        if kind < 4:
            data[at] ^= 1 << source.randrange(8)
        elif kind == 4:
            data[at] = source.randrange(256)
        elif kind == 5:
            size = min(8, len(data) - at)
            data[at : at + size] = source.choice((b"\xff", b"\0", b"\x7f")) * size
        elif kind == 6:
            size = min(source.choice((4, 64, 512)), len(data) - at)
            data[at : at + size] = source.randbytes(size)
        else:
            to = source.randrange(len(data))
            size = min(16, len(data) - max(at, to))
            data[at : at + size] = data[to : to + size]
    return bytes(data)


class Trial:
    def __init__(self, program, folder, timeout_s):
        self.program, self.folder, self.timeout_s = program, folder, timeout_s
        self.environment = dict(os.environ, TERM="xterm", LINES="24", COLUMNS="80")
        self.runs, self.slowest, self.failures = 0, (0, ""), []

    def judge(self, words, status, took_s, what):
        self.runs += 1
        self.slowest = max(self.slowest, (took_s, f"{what}: {' '.join(words)}"))
        if status not in STATED:
            self.failures.append(f"{what}: {' '.join(words)}: status {status} after {took_s:.1f} s")
            print(self.failures[-1], flush=True)

    def run(self, what, *words):
        begin = time.monotonic()
        child = subprocess.Popen([self.program, *words], cwd="work", env=self.environment, stdin=subprocess.DEVNULL,
                                 stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            status = child.wait(self.timeout_s)
        except subprocess.TimeoutExpired:
            child.kill()
            child.wait()
            status = "none"
        self.judge(words, status, time.monotonic() - begin, what)

    def console(self, what, *words):
        """In a terminal, with keys that look around and then leave."""
        begin = time.monotonic()
        pid, terminal = pty.fork()
        if pid == 0:
            os.chdir("work")
            os.execve(self.program, [self.program, *words], self.environment)
        os.set_blocking(terminal, False)
        keys, status, sent = [b" ", b".", b",", b"n", b":seek 50%\n", b"q", b"y", b":quit\n"], "none", 0
        while time.monotonic() - begin < self.timeout_s:
            try:
                os.read(terminal, 1 << 16)
            except (BlockingIOError, OSError):
                pass
            ended, outcome = os.waitpid(pid, os.WNOHANG)
            if ended:
                status = os.waitstatus_to_exitcode(outcome)
                break
            if time.monotonic() - begin > 0.1 * (sent + 1):
                try:
                    os.write(terminal, keys[min(sent, len(keys) - 1)])
                except OSError:
                    pass
                sent += 1
            time.sleep(0.005)
        if status == "none":
            os.kill(pid, signal.SIGKILL)
            os.waitpid(pid, 0)
        os.close(terminal)
        self.judge(words, status, time.monotonic() - begin, what)

    def fresh(self):
        shutil.rmtree("work", ignore_errors=True)
        shutil.copytree(self.folder, "work")

    def put(self, name, number, source):
        path = os.path.join("work", name)
        with open(path, "rb") as file:
            data = file.read()
        with open(path, "wb") as file:
            file.write(change(data, source))
        return f"change {number} of {name}"

    def one(self, number):
        source = random.Random(number)
        kind = number % 8
        self.fresh()
        if kind < 5:
            name = ("whole.h5", "cut.h5")[number % 2]
            what = self.put(name, number, source)
            if kind < 2:
                self.run(what, "info", name)
                self.run(what, "info", name, "--json")
                self.run(what, "plot", name, "energy")
                self.run(what, "plot", name, "height of the ball", "--against", "left.rz")
                for form in ("csv", "glb", "dump"):
                    self.run(what, "export", name, "--to", form, "-o", "exported" if form == "csv" else f"e.{form}", "--force")
                self.run(what, "diff", name, "whole.h5")
            elif kind == 2:
                self.run(what, "replay", name)
                self.run(what, "render", name, "-o", "p%d.png", "--size", "32x32", "--to", "0.02")
            elif kind == 3 and number % 5 == 0:
                self.console(what, "console", name)
            self.run(what, "repair", name)
            self.run(what, "info", name)
        elif kind == 5:
            what = self.put("cut.h5", number, source)
            self.run(what, "cut.lua", "-q", "-o", "cut.h5", "--resume")
            self.run(what, "info", "cut.h5")
        elif kind == 6:
            what = self.put(source.choice(("cut.h5.checkpoint", "cut.h5.checkpoint~")), number, source)
            self.run(what, "cut.lua", "-q", "-o", "cut.h5", "--resume")
        else:
            names = sorted(n for n in os.listdir("work/sweep") if os.path.isfile(os.path.join("work/sweep", n)))
            what = self.put("sweep/" + source.choice(names), number, source)
            self.run(what, "collect", "sweep", "-o", "c.h5")
            self.run(what, "collect", "sweep", "-o", "c.csv")
            self.run(what, "sweep", "sweep", "--status")
            self.run(what, "sweep", "sweep", "-q")
        left = [n for n in os.listdir("work") if "partial" in n]
        if left:
            self.failures.append(f"{what}: left behind: {left}")
            print(self.failures[-1], flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True)
    parser.add_argument("--folder", required=True)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--timeout", type=float, default=60)
    parser.add_argument("--keep", action="store_true", help="leave the last change's files in ./work")
    options = parser.parse_args()
    trial = Trial(os.path.abspath(options.program), os.path.abspath(options.folder), options.timeout)
    for number in range(options.first, options.first + options.count):
        trial.one(number)
    print(f"{options.count} changes, {trial.runs} runs, {len(trial.failures)} without a right end; "
          f"the slowest took {trial.slowest[0]:.1f} s ({trial.slowest[1]})")
    if not options.keep:
        shutil.rmtree("work", ignore_errors=True)
    return 1 if trial.failures else 0


if __name__ == "__main__":
    sys.exit(main())
