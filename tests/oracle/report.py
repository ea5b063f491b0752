# SPDX-License-Identifier: MIT
"""What was compared, how far it was apart, and what that may be."""
import math


class Report:
    def __init__(self, name, pending=()):
        self.name, self.checks, self.notes, self.numbers, self.counts = name, {}, {}, {}, {}
        self.pending = set(pending)

    def bound(self, check, measured, bound, where="", unit=""):
        """`measured` must not be above `bound`; what is not a number is."""
        worst = self.checks.setdefault(check, {"n": 0, "failed": 0, "excess": -math.inf})
        worst["n"] += 1
        excess = measured / bound if bound > 0 else (0.0 if measured <= 0 else math.inf)
        if not measured <= bound:
            worst["failed"] += 1
            excess = math.inf if math.isnan(measured) else excess
        if excess > worst["excess"]:
            worst.update(excess=excess, measured=measured, bound=bound, where=where, unit=unit)

    def bounds(self, check, measured, bound, where, unit=""):
        """The same for arrays; `where` is a function of the row. Only the worst is told."""
        n = len(measured)
        if n == 0:
            return
        ratio = [m / b if b > 0 else (0.0 if m <= 0 else math.inf) for m, b in zip(measured, bound)]
        bad = [not m <= b for m, b in zip(measured, bound)]
        k = max(range(n), key=lambda r: math.inf if math.isnan(ratio[r]) else ratio[r])
        self.bound(check, float(measured[k]), float(bound[k]), where(k), unit)
        self.checks[check]["n"] += n - 1
        self.checks[check]["failed"] += max(0, sum(bad) - 1)

    def true(self, check, holds, where=""):
        self.bound(check, 0.0 if holds else 1.0, 0.5, where)

    def skip(self, check, why):
        self.notes[check] = why

    def count(self, name, n):
        self.counts[name] = self.counts.get(name, 0) + int(n)

    def number(self, name, x):
        self.numbers[name] = x

    @property
    def failures(self):
        return [c for c, w in self.checks.items() if w["failed"] and c not in self.pending]

    def lines(self, everything=False):
        for check, w in self.checks.items():
            if not w["failed"] and not everything:
                continue
            mark = "ok" if not w["failed"] else "known" if check in self.pending else "FAIL"
            yield (f"  {mark:8} {check}: {w['measured']:.3g} {w['unit']} (bound {w['bound']:.3g}), "
                   f"{w['failed']} of {w['n']} beyond; worst: {w['where']}")
        if everything:
            for check, why in self.notes.items():
                yield f"  left out {check}: {why}"
