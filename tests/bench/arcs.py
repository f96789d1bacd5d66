#!/usr/bin/python3
"""Regenerates results/program/arcs.md: tests/bench/arcs.py [PROGRAM accdec] [--seconds S] [--out FILE]

Arcs on the exact path and with a tolerance, beside references that are computed here. Without a jerk limit the
reference is the least time along the path, by forward and backward integration of the squared speed. With one it is a
tangential S-curve: speed, acceleration and jerk along the path are constants, the best that keep every axis' limits.
"""
import math
import pathlib
import tempfile

import numpy as np

import free_pages
from free_pages import SOURCE

FEED, VELOCITY, ACCELERATION, JERK = 100.0, 200.0, 1000.0, 50000.0  # mm, s
T = 1e-3


class Line:
    def __init__(self, *way):
        self.length = math.sqrt(sum(w * w for w in way))
        self.tangent = np.array(list(way) + [0.0] * (3 - len(way))) / self.length

    def derivatives(self, s):
        """Of the position by the way s: first, second and third, a row for each s."""
        zero = np.zeros((len(s), 3))
        return zero + self.tangent, zero, zero


class Arc:
    def __init__(self, radius, begin, turn, rise=0.0):
        self.radius, self.begin, self.turn = radius, begin, turn
        self.flat = radius * abs(turn)
        self.length = math.hypot(self.flat, rise)
        self.share, self.climb = self.flat / self.length, rise / self.length

    def derivatives(self, s):
        rate = math.copysign(self.share / self.radius, self.turn)
        angle = self.begin + rate * s
        e = np.column_stack([np.cos(angle), np.sin(angle), 0 * s])
        n = np.column_stack([-np.sin(angle), np.cos(angle), 0 * s])
        first = self.radius * rate * n
        first[:, 2] = self.climb
        return first, -self.radius * rate**2 * e, -self.radius * rate**3 * n


def least_time(pieces, parts=1500):
    """s, from rest to rest along the pieces, which meet tangentially: x = s'^2 and u = s'' with
    |first u + second x| <= ACCELERATION for every axis, x(0) = x(end) = 0."""
    total = sum(piece.length for piece in pieces)
    first, second, steps = [], [], []
    for piece in pieces:
        count = max(20, round(parts * piece.length / total))
        ds = piece.length / count
        a, b, _ = piece.derivatives(ds * (np.arange(count) + 0.5))
        first.append(a), second.append(b), steps.append(np.full(count, ds))
    first, second, steps = np.vstack(first), np.vstack(second), np.concatenate(steps)
    fastest = np.minimum(FEED**2, (VELOCITY / np.maximum(np.abs(first).max(axis=1), 1e-12)) ** 2)

    def accelerations(i, x):
        """Least and largest u at the step i; none if they cross."""
        low, high = -np.inf, np.inf
        for a, b in zip(first[i], second[i]):
            if abs(a) > 1e-9:
                ends = sorted(((-ACCELERATION - b * x) / a, (ACCELERATION - b * x) / a))
                low, high = max(low, ends[0]), min(high, ends[1])
            elif abs(b * x) > ACCELERATION:
                return np.inf, -np.inf
        return low, high

    # Backward: the largest x from which the end can be reached; u that leads from x at a step's begin to `after`.
    count = len(steps)
    reach = np.zeros(count + 1)
    for i in range(count - 1, -1, -1):
        lo, hi = 0.0, min(fastest[i], fastest[max(i - 1, 0)])

        def possible(x):
            low, high = accelerations(i, x)
            return low <= high and x + 2 * low * steps[i] <= reach[i + 1] and x + 2 * high * steps[i] >= 0

        if not possible(hi):
            for _ in range(40):
                middle = 0.5 * (lo + hi)
                lo, hi = (middle, hi) if possible(middle) else (lo, middle)
            hi = lo
        reach[i] = hi
    x, time = 0.0, 0.0
    for i in range(count):
        low, high = accelerations(i, x)
        after = min(x + 2 * high * steps[i], reach[i + 1])
        time += 2 * steps[i] / (math.sqrt(x) + math.sqrt(after))
        x = after
    return time


def s_curve(length, v, a, j):
    """Times and jerks of the phases of an S-curve from rest to rest."""
    def ramp(v):
        return (a / j, v / a - a / j) if v * j >= a * a else (math.sqrt(v / j), 0.0)

    def way(v):
        t, flat = ramp(v)
        return v * (2 * t + flat)  # up and down together

    if way(v) > length:
        lo, hi = 0.0, v
        for _ in range(60):
            middle = 0.5 * (lo + hi)
            lo, hi = (middle, hi) if way(middle) <= length else (lo, middle)
        v = lo
    t, flat = ramp(v)
    return [(t, j), (flat, 0), (t, -j), ((length - way(v)) / v, 0), (t, -j), (flat, 0), (t, j)]


def s_curve_time(piece):
    """s, of the fastest tangential S-curve that keeps the limits of every axis."""
    best = math.inf
    curvature = np.linalg.norm(piece.derivatives(np.zeros(1))[1])
    top = FEED if curvature == 0 else min(FEED, math.sqrt(1.42 * ACCELERATION / curvature),
                                          (1.42 * JERK / curvature**2) ** (1 / 3))
    for v in top * np.linspace(0.4, 1, 25):
        for a in ACCELERATION * np.linspace(0.1, 1.4, 27):
            for j in JERK * np.linspace(0.1, 1.4, 14):
                phases = s_curve(piece.length, v, a, j)
                time = sum(t for t, _ in phases)
                if time >= best or not keeps_limits(piece, phases):
                    continue
                best = time
    return best


def keeps_limits(piece, phases):
    s, ds, dds = 0.0, 0.0, 0.0
    for duration, jerk in phases:
        if duration <= 0:
            continue
        t = np.linspace(0, duration, 60 if jerk else 240)
        a = dds + jerk * t
        v = ds + dds * t + 0.5 * jerk * t**2
        way = s + ds * t + 0.5 * dds * t**2 + jerk * t**3 / 6
        first, second, third = piece.derivatives(way)
        a, v = a[:, None], v[:, None]
        if np.abs(first * v).max() > VELOCITY * (1 + 1e-9):
            return False
        if np.abs(first * a + second * v**2).max() > ACCELERATION * (1 + 1e-6):
            return False
        if np.abs(first * jerk + 3 * second * v * a + third * v**3).max() > JERK * (1 + 1e-6):
            return False
        s, ds, dds = way[-1], v[-1, 0], a[-1, 0]
    return True


def trochoid():
    pieces = []
    program = (SOURCE / "problems/program/trochoid.ngc").read_text()
    lines = [line for line in program.splitlines() if line.startswith("G3")]
    for line in lines:
        radius = abs(float(line.split("I")[1].split()[0]))
        pieces.append(Arc(radius, 0.0 if len(pieces) % 2 == 0 else math.pi, math.pi))
    text = "G21 G90 G17 G64 P0.05\nF6000\nG0 X4 Y0\n" + "\n".join(lines) + "\nM2\n"
    return text, pieces


def cases():
    """(name, program, pieces)"""
    head = "G21 G90 G17 G61\nF6000\n"
    for radius in (0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500):
        yield f"full turn, R{radius:g}", head + f"G2 X0 Y0 I{radius} J0\nM2\n", [Arc(radius, math.pi, -2 * math.pi)]
    yield "two turns, R10", head + "G2 X0 Y0 I10 J0 P2\nM2\n", [Arc(10, math.pi, -4 * math.pi)]
    yield "helix, R10, three turns of 5 mm", head + "G2 X0 Y0 Z15 I10 J0 P3\nM2\n", [Arc(10, math.pi, -6 * math.pi, 15)]
    yield "helix, R2, six turns of 1 mm", head + "G2 X0 Y0 Z6 I2 J0 P6\nM2\n", [Arc(2, math.pi, -12 * math.pi, 6)]
    blend = "G21 G90 G17 G64 P0.05\nF6000\n"
    yield ("line, quarter R10, line", blend + "G1 X30 Y0\nG3 X40 Y10 I0 J10\nG1 Y40\nM2\n",
           [Line(30, 0), Arc(10, -math.pi / 2, math.pi / 2), Line(0, 30)])
    yield ("slot, 40 mm by R10", blend + "G1 X40 Y0\nG3 X40 Y20 I0 J10\nG1 X0\nG3 X0 Y0 I0 J-10\nM2\n",
           [Line(40, 0), Arc(10, -math.pi / 2, math.pi), Line(-40, 0), Arc(10, math.pi / 2, math.pi)])
    text, pieces = trochoid()
    yield "trochoid.ngc, its arcs", text, pieces


def files(folder, text, jerk):
    """The program and its task."""
    program = folder / "arcs.ngc"
    program.write_text(text)
    return program, free_pages.task_file(folder, VELOCITY, ACCELERATION, JERK if jerk else 0)


def planned(accdec, folder, text, jerk, seconds):
    """fixed, free, and the bound for any motion: s."""
    program, task = files(folder, text, jerk)
    times = []
    for plan in ("fixed", "free"):
        found, bound = free_pages.planned(accdec, folder, program, task, plan, seconds)
        times.append(found["cycle_time_s"])
    return times + [bound]


HEAD = """# Arcs

Written by `tests/bench/arcs.py`: %g mm/s per axis, F%g, %g mm/s^2, T = %g ms. Turns and helices are on the exact path
(G61), the others within 0.05 mm. Times in s from the first sample to the first at rest.

The references are computed by the script, not by accdec, and keep every axis' limits. *least time* is that along the
exact path without a jerk limit. It comes from forward and backward integration of the squared speed. *S-curve* is the
best tangential S-curve: its speed, acceleration and jerk along the path are constants. The acceleration jumps where a
line meets an arc, so under a jerk limit its S-curves stop there.

A motion within a tolerance may be faster than any on the exact path. `fixed` has one filter, `free` is
`--plan free --time-limit %g`. The bound holds for any motion within the tolerance.

Without a jerk limit `free` is within 1 %% of the least time on every path. With one, no S-curve here is faster by more
than 0.1 %%, and `free` is up to a third faster. The plan `fixed` suits arcs under a jerk limit badly, as its one filter
rounds them and has to slow down for that.
"""


def main():
    options = free_pages.options(__doc__, "arcs.md", 10)
    text = HEAD % (VELOCITY, 60 * FEED, ACCELERATION, 1e3 * T, options.seconds)
    with tempfile.TemporaryDirectory() as folder:
        for jerk in (False, True):
            title = f"Jerk at most {JERK:g} mm/s^3" if jerk else "No jerk limit"
            reference = "S-curve" if jerk else "least time"
            text += f"\n## {title}\n\n| path | {reference} | fixed | free | free, % of it | bound |\n"
            text += "|---|--:|--:|--:|--:|--:|\n"
            for name, program, pieces in cases():
                best = sum(s_curve_time(piece) for piece in pieces) if jerk else least_time(pieces)
                fixed, free, bound = planned(options.accdec, pathlib.Path(folder), program, jerk, options.seconds)
                text += f"| {name} | {best:.3f} | {fixed:.3f} | {free:.3f} | {100 * free / best:.1f} | {bound:.3f} |\n"
                print(text.splitlines()[-1], flush=True)
    options.out.write_text(text)


if __name__ == "__main__":
    main()
