#!/usr/bin/env python3
"""The smooth input shapers of Kalico beside the shortest filters that do as well.

    tests/bench/smooth_kernels.py PROGRAM OUT.md

Kalico (a fork of the printer firmware Klipper) smooths motion with polynomial kernels w(t) over a time T_sm = c/f
against a resonance near f Hz (klippy/extras/shaper_defs.py, coefficients below, highest power first, of t/T_sm over
[-1/2, 1/2]). Each kernel is sampled every T, and its own demands are measured: largest tap (peak acceleration), largest
difference of neighbouring taps, both ends included (peak jerk), and the worst residual of an undamped mode from 0.9 f
to 1.1 f. The question: how short is the shortest non-negative filter that is nowhere worse? accdec answers with a
proof; the second method is a linear program (HiGHS) whose rows are necessary conditions, so that an order which it
finds infeasible is impossible. Kalico tunes its kernels for damped modes: so the table also says what both leave of a
mode with a damping ratio of 0.1, and how short a filter for that mode could be (linear programs alone; with a proof in
`damped_shapers.py`).
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from scipy.optimize import linprog

KERNELS = {
    "smooth_zv": (
        0.8025,
        [-118.4265334338076, 5.861885495127615, 29.52796003014231, -1.465471373781904, 0.01966833207740377],
    ),
    "smooth_mzv": (
        0.95625,
        [
            -1906.717580206364,
            125.8892756660212,
            698.0200035767849,
            -37.75923018121473,
            -62.18762409216703,
            1.57172781617736,
            1.713117990217123,
        ],
    ),
    "smooth_ei": (
        1.06625,
        [
            -1797.048868963208,
            120.5310596109878,
            669.6653197989012,
            -35.71975707450795,
            -62.49388325512682,
            1.396748042940248,
            1.848276903900512,
        ],
    ),
}
FREQUENCY = 40.0  # Hz
PERIOD = 0.5e-3  # s
FEED = 0.1  # m/s
DAMPING = 0.1  # ratio, for which Kalico tunes
BAND = (0.9 * FREQUENCY, 1.1 * FREQUENCY)  # Hz
EXACT = 1.0 + 1e-9  # limits are the kernel's own values, up to rounding


def taps_of(duration, coefficients):
    """The kernel at the middles of its sample periods, with sum 1."""
    count = int(round(duration / FREQUENCY / PERIOD))
    at = (np.arange(count) + 0.5) / count - 0.5
    taps = np.maximum(np.polyval(coefficients, at), 0.0)
    return taps / taps.sum()


def residual(taps, damping=0.0, band=BAND):
    """Worst residual vibration over a band, as a share of that of the unfiltered command; a mode of this damping."""
    worst = 0.0
    for frequency in np.linspace(*band, 401):
        at = 2.0 * np.pi * frequency * PERIOD * np.arange(len(taps))[::-1]  # the last tap acts last and rings longest
        worst = max(worst, abs(np.sum(taps * np.exp((-damping + 1j * np.sqrt(1.0 - damping**2)) * at))))
    return worst


def filter_of(order, peak, step, allowed, damping=0.0, inside=False, band=BAND, period=PERIOD):
    """A filter of this order within the limits by a linear program, or None. The circle of the residual is replaced by
    a polygon of 72 sides about it (necessary conditions) or inside it, at 41 frequencies."""
    n, sides = order + 1, 72
    difference = np.eye(n + 1, n) - np.eye(n + 1, n, -1)
    rows, bounds = [difference, -difference], [np.full(2 * n + 2, step)]
    for frequency in np.linspace(*band, 41):
        at = 2.0 * np.pi * frequency * period * np.arange(n)[::-1]
        weight = np.exp((-damping + 1j * np.sqrt(1.0 - damping**2)) * at)
        rows.append((weight[None, :] * np.exp(-2j * np.pi * np.arange(sides) / sides)[:, None]).real)
        bounds.append(np.full(sides, allowed * (np.cos(np.pi / sides) if inside else 1.0)))
    answer = linprog(
        np.zeros(n),
        A_ub=np.vstack(rows),
        b_ub=np.concatenate(bounds),
        A_eq=np.ones((1, n)),
        b_eq=[1.0],
        bounds=(0.0, peak),
        method="highs",
    )
    return answer.x if answer.status == 0 else None


def shortest_damped(taps, peak, step):
    """Fewest taps that are nowhere worse than `taps` on a mode with DAMPING; the range that the polygons leave open."""
    allowed = residual(taps, DAMPING)
    fewest = next(n for n in range(1, len(taps) + 1) if filter_of(n - 1, peak, step, allowed, DAMPING) is not None)
    enough = next(
        (
            n
            for n in range(fewest, len(taps) + 1)
            if filter_of(n - 1, peak, step, allowed * 0.999, DAMPING, inside=True) is not None
        ),
        len(taps),
    )
    return str(fewest) if fewest == enough else f"{fewest} to {enough}"


def shortest(program, peak, step, allowed):
    """Result and whether it verifies: one leg that goes straight on, so that the filter alone costs time."""
    task = f"""sample_period_ms = {PERIOD * 1e3}
[[axis]]
acceleration_max_mm_s2 = {peak * EXACT * FEED / PERIOD * 1e3!r}
jerk_max_mm_s3 = {step * EXACT * FEED / PERIOD**2 * 1e3!r}
[[corner]]
angle_deg = 180
feed_in_mm_min = {FEED * 6e4!r}
feed_out_mm_min = {FEED * 6e4!r}
delay_samples = 0
[[mode]]
frequency_Hz = [{BAND[0]!r}, {BAND[1]!r}]
residual_max = {allowed!r}
"""
    with tempfile.TemporaryDirectory() as folder:
        path, out = Path(folder, "task.toml"), Path(folder, "result.json")
        path.write_text(task)
        subprocess.run([program, "design", path, "--json", out, "--quiet"], check=False, timeout=600)
        result = json.loads(out.read_text())
        verified = subprocess.run([program, "verify", out, "--quiet"], check=False).returncode == 0
    return result, verified


def main():
    program, out = sys.argv[1:]
    lines = [
        "| kernel | taps | its residual, undamped | damped | shortest taps, undamped | accdec | one tap less, by HiGHS "
        "| their residual, damped | shortest taps, damped, by HiGHS |",
        "|---|--:|--:|--:|--:|---|---|--:|--:|",
    ]
    for name, (duration, coefficients) in KERNELS.items():
        taps = taps_of(duration, coefficients)
        peak = taps.max()
        step = np.abs(np.diff(np.concatenate([[0.0], taps, [0.0]]))).max()
        allowed = residual(taps) * EXACT
        result, verified = shortest(program, peak, step, allowed)
        found = np.array(result["filter"]["taps"]) / np.sum(result["filter"]["taps"])
        proof = result["status"] + (", certificate accepted" if verified else ", NOT VERIFIED")
        refuted = filter_of(len(found) - 2, peak * EXACT, step * EXACT, allowed) is None
        lines.append(
            f"| {name} | {len(taps)} | {100 * residual(taps):.1f} % | {100 * residual(taps, DAMPING):.1f} % "
            f"| {len(found)} | {proof} | {'impossible' if refuted else 'not refuted'} "
            f"| {100 * residual(found, DAMPING):.1f} % | {shortest_damped(taps, peak * EXACT, step * EXACT)} |"
        )
    text = "\n".join(lines) + "\n"
    Path(out).write_text(text)
    print(text, end="")


if __name__ == "__main__":
    main()
