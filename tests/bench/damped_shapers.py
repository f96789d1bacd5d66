#!/usr/bin/env python3
"""Input shapers and kernels of printers' firmware beside the shortest filters that do as well on a damped mode.

    tests/bench/damped_shapers.py PROGRAM OUT.md

The mode has 40 Hz and a damping ratio of 0.1: what the firmware tunes for. Impulse shapers are those of Klipper
(klippy/extras/shaper_defs.py), kernels those of Kalico (`smooth_kernels.py`); both are compared from 36 to 44 Hz. The
four modes of Beckhoff's vibration guard are compared over the deviations that its manual permits (P-AXIS-00571), as
parts by which the frequency that is set may be wrong. The manual does not print their impulses. Those here are the
fewest that are as robust as it says, and their own deviations at 5 % stand beside the manual's.

The demands of each are its own. What impulses leave of the mode over the band is that at their exact times; accdec
designs against them with T = 0.1 ms. Kernels are sampled every 0.5 ms: largest tap, largest difference of neighbouring
taps, and what they leave. accdec proves how short a non-negative filter that is nowhere worse can be. HiGHS refutes one
tap less by linear programs of necessary conditions.
"""

import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

import smooth_kernels as kernels
from smooth_kernels import BAND, DAMPING, EXACT, FEED, FREQUENCY, PERIOD

FINE = 0.1e-3  # s, sample period beside impulses
PERIOD_DAMPED = 1.0 / (FREQUENCY * math.sqrt(1.0 - DAMPING**2))
FALL = math.exp(-DAMPING * math.pi / math.sqrt(1.0 - DAMPING**2))  # over half a damped period


def impulses():
    """Weights and times in damped periods; Singer and Seering for ZV and ZVD, Klipper for MZV and EI (5 %)."""
    k, root = FALL**0.75, math.sqrt(2.0)
    return {
        "ZV": ([1.0, FALL], [0.0, 0.5]),
        "ZVD": ([1.0, 2.0 * FALL, FALL**2], [0.0, 0.5, 1.0]),
        "MZV": ([1.0 - 1.0 / root, (root - 1.0) * k, (1.0 - 1.0 / root) * k**2], [0.0, 0.375, 0.75]),
        "EI": ([0.25 * 1.05, 0.5 * 0.95 * FALL, 0.25 * 1.05 * FALL**2], [0.0, 0.5, 1.0]),
    }


def symmetric():
    """Three impulses alike forward and backward that leave nothing of the mode."""
    end = FALL / (1.0 + FALL) ** 2
    return [end, 1.0 - 2.0 * end, end]


# Impulses of the vibration guard's modes, times in damped periods, and the deviations that its manual permits.
HALVES = [0.0, 0.5, 1.0, 1.5]
GUARD = {
    "guard 1: ZV": (([1.0, FALL], HALVES[:2]), (-0.03, 0.03)),
    "guard 2: ZVD": (([1.0, 2.0 * FALL, FALL**2], HALVES[:3]), (-0.13, 0.19)),
    "guard 3: ZVDD": (([1.0, 3.0 * FALL, 3.0 * FALL**2, FALL**3], HALVES), (-0.20, 0.33)),
    "guard 4: symmetric": ((symmetric(), HALVES[:3]), (-0.10, 0.13)),
}
PROMISE = 0.05  # part that the guard leaves at most


def band_of(deviations):
    """Frequencies of the mode if 40 Hz is set, and off by these parts of the true one."""
    return tuple(FREQUENCY / (1.0 + part) for part in reversed(deviations))


def left(weights, times, frequency):
    """Of impulses at their exact times."""
    w = 2.0 * math.pi * frequency
    ahead = (times[-1] - np.array(times)) * PERIOD_DAMPED
    poles = -DAMPING * w + 1j * w * math.sqrt(1.0 - DAMPING**2)
    return abs(np.sum(np.array(weights) * np.exp(poles * ahead))) / sum(weights)


def deviations_of(weights, times):
    """By how much the frequency set may be wrong until more than the promise is left, by thousandths."""
    def farthest(step):
        part = 0.0
        while left(weights, times, FREQUENCY / (1.0 + part + step)) <= PROMISE:
            part += step
        return part
    return farthest(-0.001), farthest(0.001)


def worst_left(weights, times, band):
    return max(left(weights, times, frequency) for frequency in np.linspace(*band, 401)) * EXACT


def shortest(program, peak, step, allowed, band=BAND, period=FINE):
    """One leg that goes straight on, so that the filter alone costs time."""
    axis = "" if peak is None else (
        f"[[axis]]\nacceleration_max_mm_s2 = {peak * EXACT * FEED / period * 1e3!r}\n"
        f"jerk_max_mm_s3 = {step * EXACT * FEED / period**2 * 1e3!r}\n")
    task = f"""sample_period_ms = {period * 1e3:.10g}
[design]
order_max = 500
{axis}[[corner]]
angle_deg = 180
feed_in_mm_min = {FEED * 6e4!r}
delay_samples = 0
[[mode]]
frequency_Hz = [{band[0]!r}, {band[1]!r}]
damping_ratio = {DAMPING}
residual_max = {allowed!r}
"""
    with tempfile.TemporaryDirectory() as folder:
        path, out = Path(folder, "task.toml"), Path(folder, "result.json")
        path.write_text(task)
        subprocess.run([program, "design", path, "--json", out, "--quiet", "--no-baselines"], check=False, timeout=600)
        result = json.loads(out.read_text())
        verified = subprocess.run([program, "verify", out, "--quiet"], check=False).returncode == 0
    return result, verified


def main():
    program, out = sys.argv[1:]
    lines = ["| shaper | its band, Hz | its time, ms | it leaves | shortest time, ms | shorter by | proof "
             "| one tap less, by HiGHS |", "|---|--:|--:|--:|--:|--:|---|---|"]
    shapers = {name: (shaper, BAND) for name, shaper in impulses().items()}
    shapers |= {name: (shaper, band_of(off)) for name, (shaper, off) in GUARD.items()}
    cases = {name: (shaper[1][-1] * PERIOD_DAMPED, worst_left(*shaper, band), None, None, band, FINE)
             for name, (shaper, band) in shapers.items()}
    for name, kernel in kernels.KERNELS.items():
        taps = kernels.taps_of(*kernel)
        cases[name] = ((len(taps) - 1) * PERIOD, kernels.residual(taps, DAMPING) * EXACT, taps.max(),
                       np.abs(np.diff(np.concatenate([[0.0], taps, [0.0]]))).max(), BAND, PERIOD)
    for name, (time, allowed, peak, step, band, period) in cases.items():
        result, verified = shortest(program, peak, step, allowed, band, period)
        found = len(result["filter"]["taps"])
        proof = result["status"] + (", certificate accepted" if verified else ", NOT VERIFIED")
        fewer = kernels.filter_of(found - 2, (peak or 1.0) * EXACT, (step or 1.0) * EXACT, allowed, DAMPING, band=band,
                                  period=period)
        old, new = 1e3 * time, 1e3 * (found - 1) * period
        by = f"{100 * (1 - new / old):.0f} %" if new <= old - 1e3 * period else "equal to a sample"
        lines.append(f"| {name} | {band[0]:.1f} to {band[1]:.1f} | {old:.2f} | {100 * allowed:.1f} % | {new:.1f} | {by} "
                     f"| {proof} | {'impossible' if fewer is None else 'not refuted'} |")
        print(lines[-1], flush=True)
    lines += ["", "| vibration guard | deviations that the manual permits | of these impulses, at 5 % |", "|---|--:|--:|"]
    for name, (shaper, off) in GUARD.items():
        own = deviations_of(*shaper)
        lines.append(f"| {name} | {100 * off[0]:+.0f} to {100 * off[1]:+.0f} % "
                     f"| {100 * own[0]:+.1f} to {100 * own[1]:+.1f} % |")
        print(lines[-1])
    Path(out).write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
