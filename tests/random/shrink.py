#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Makes a failing random scene smaller while the same check fails, and writes it as plain calls.

    shrink.py --seed 17 --method auto --check gain -o smaller.lua
    shrink.py --file scene.lua --method located --check exit76

Calls, keys, parts of unions, corners of hulls and simulated time are taken away, numbers lose digits. A gain, or what the
ledger leaves open, has to stay a tenth of what it was, so that it does not become another one. Without --check the first that fails is taken.
"""
import argparse
import os
import re
import sys
import time

import run as runner

TOKEN = re.compile(r'\s*("(?:[^"\\]|\\.)*"|[-+]?(?:0x[0-9a-fp.+-]+|(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)|[A-Za-z_][\w.]*|[{}(),=])')


class Table:
    """A table of a call: items are (key or None, value); what makes a function has a name."""

    def __init__(self, items, made=None):
        self.items, self.made = items, made

    def __str__(self):
        inner = ", ".join(("%s = %s" % (k, v)) if k else str(v) for k, v in self.items)
        return "%s(%s)" % (self.made, inner) if self.made else "{%s}" % inner

    def without(self, i):
        return Table(self.items[:i] + self.items[i + 1:], self.made)

    def changed(self, i, value):
        return Table(self.items[:i] + [(self.items[i][0], value)] + self.items[i + 1:], self.made)


class Parser:
    def __init__(self, text):
        self.tokens, at = [], 0
        while at < len(text.rstrip()):
            found = TOKEN.match(text, at)
            if not found:
                raise ValueError("not a plain call: %s" % text[at:at + 40])
            self.tokens.append(found.group(1))
            at = found.end()
        self.at = 0

    def next(self):
        self.at += 1
        return self.tokens[self.at - 1]

    def peek(self, ahead=0):
        return self.tokens[self.at + ahead] if self.at + ahead < len(self.tokens) else ""

    def list_until(self, end):
        items = []
        while self.peek() != end:
            key = None
            if self.peek(1) == "=":
                key = self.next()
                self.next()
            items.append((key, self.value()))
            if self.peek() == ",":
                self.next()
        self.next()
        return items

    def value(self):
        token = self.next()
        if token == "{":
            return Table(self.list_until("}"))
        if self.peek() == "(":
            self.next()
            return Table(self.list_until(")"), token)
        return token

    def call(self):
        name = self.next()
        if self.peek() == "(":
            self.next()
            return name, Table(self.list_until(")"), "")
        return name, self.value()


def parsed(lines):
    return [Parser(line).call() for line in lines]


def lines_of(calls):
    return ["%s %s" % (n, t) if t.made is None else "%s(%s)" % (n, str(Table(t.items))[1:-1]) for n, t in calls]


def smaller_values(value, depth=0):
    """Tables with one thing less, or with a number that has fewer digits; the boldest first."""
    if not isinstance(value, Table):
        if re.fullmatch(r"[-+]?[\d.]+([eE][-+]?\d+)?", value):
            x = float(value)
            for digits in (1, 2, 3):
                text = "%.*g" % (digits, x)
                if len(text) < len(value):
                    yield text
        return
    for i, (key, v) in enumerate(value.items):
        nested = isinstance(v, Table) and not key
        if key and key not in ("name", "duration", "static") or nested and len(value.items) > 1:
            yield value.without(i)
    if all(not isinstance(v, Table) for _, v in value.items) and len(value.items) == 3 and depth:
        for text in ("{0, 0, 0}", "{1, 0, 0}", "{0, 0, 1}"):
            if str(value) != text:
                yield Parser(text).value()
        for i in range(3):
            if value.items[i][1] != "0":
                yield value.changed(i, "0")
    for i, (key, v) in enumerate(value.items):
        for smaller in smaller_values(v, depth + 1):
            yield value.changed(i, smaller)


def mentions(call, name):
    return re.search(re.escape(name), str(call[1])) is not None


class Shrinker:
    def __init__(self, bench, method, check, seconds):
        self.method, self.check = method, check
        checks = {"ends", "slow"} if check.startswith(("exit", "signal", "slow")) else {check}
        checks = {"copies"} if check in ("turned", "mirrored") else checks
        self.judge = runner.Judge(bench, checks)
        self.deadline = time.monotonic() + seconds
        self.least, self.shortest, self.tries, self.text, self.reason = 0.0, 0.0, 0, "", None

    def late(self):
        return time.monotonic() > self.deadline

    def fails(self, calls):
        self.tries += 1
        run, found = self.judge.judge(lines_of(calls), self.method)
        for check, text in found:
            size = run.rise if check == "gain" else run.unexplained
            if check != self.check or (check in ("gain", "ledger") and size < self.least):
                continue
            # Another message would be another failure.
            shape = "no end" if "no end" in text else ""
            if check.startswith(("exit", "signal")):
                shape = re.sub(r"'[^']*'|[-\d.e+]+", "", text)
            if self.reason is None:
                self.reason, self.least = shape, 0.1 * size
            if shape == self.reason:
                self.text = text
                return True
        return False

    def duration(self, calls):
        """The shortest that still fails, to a tenth."""
        i = next(k for k, c in enumerate(calls) if c[0] == "world")
        j = next((k for k, item in enumerate(calls[i][1].items) if item[0] == "duration"), None)
        for factor in (0.1, 0.3, 0.6, 0.9) if j is not None else ():
            while not self.late() and float(calls[i][1].items[j][1]) > self.shortest:
                seconds = "%.4g" % (factor * float(calls[i][1].items[j][1]))
                shorter = calls[:i] + [("world", calls[i][1].changed(j, seconds))] + calls[i + 1:]
                if not self.fails(shorter):
                    break
                calls = shorter
        return calls

    def fewer_calls(self, calls):
        size = max(1, len(calls) // 2)
        while size and not self.late():
            at = len(calls) - size
            while at > 0 and not self.late():
                gone = [c for c in calls[at:at + size] if c[0] != "world"]
                names = [str(v) for c in gone for k, v in c[1].items if k == "name" and c[0] != "material"]
                rest = [c for k, c in enumerate(calls) if (k < at or k >= at + size or c[0] == "world") and
                        not (c[0] in ("spring", "on_step") and any(mentions(c, n) for n in names))]
                if gone and self.fails(rest):
                    calls = rest
                at -= size
            size //= 2
        return calls

    def fewer_keys(self, calls):
        for i in range(len(calls) - 1, -1, -1):
            progress = True
            while progress and not self.late():
                progress = False
                for smaller in smaller_values(calls[i][1]):
                    tried = calls[:i] + [(calls[i][0], smaller)] + calls[i + 1:]
                    if self.late():
                        break
                    if self.fails(tried):
                        calls, progress = tried, True
                        break
        return calls

    def shrink(self, calls):
        if not self.fails(calls):
            sys.exit("it does not fail")
        self.shortest = 1e-3 * runner.duration_of(lines_of(calls))
        last = None
        while last != lines_of(calls) and not self.late():
            last = lines_of(calls)
            calls = self.fewer_keys(self.duration(self.fewer_calls(self.duration(calls))))
        self.fails(calls)
        return calls


def main():
    here = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    here.add_argument("--program", default=os.environ.get("RBSIM") or os.path.join(runner.HERE, "../../build/release/rbsim"))
    here.add_argument("--seed", type=int)
    here.add_argument("--file")
    here.add_argument("--param", action="append", default=[], help="NAME=VALUE of scene.lua")
    here.add_argument("--method", default="auto")
    here.add_argument("--check", help="gain, overlap, lost, slow, exit76, signal6, threads, turned, mirrored, ...")
    here.add_argument("--processor", type=float, default=0)
    here.add_argument("--seconds", type=float, default=120, help="give up then, with what there is")
    here.add_argument("-o", "--output")
    o = here.parse_args()
    bench = runner.Bench(o.program, o.processor)
    try:
        lines = runner.read_file(o.file) if o.file else bench.emit(o.seed, 1, o.param)[0]
        if not o.check:
            _, found = runner.Judge(bench, {"ends", "slow", "gain", "ledger", "overlap", "lost", "threads", "copies", "order"}).judge(lines, o.method)
            if not found:
                sys.exit("nothing fails")
            o.check = found[0][0]
        shrinker = Shrinker(bench, o.method, o.check, o.seconds)
        small = lines_of(shrinker.shrink(parsed(lines)))
    finally:
        bench.close()
    origin = os.path.basename(o.file) if o.file else "seed %d" % o.seed
    text = "-- %s, --method %s: %s: %s\n%s" % (origin, o.method, o.check, shrinker.text, runner.plain(small))
    if o.output:
        with open(o.output, "w") as f:
            f.write(text)
    else:
        print(text, end="")
    print("%d tries, %d calls of %d" % (shrinker.tries, len(small), len(lines)), file=sys.stderr)


if __name__ == "__main__":
    main()
