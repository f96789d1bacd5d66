#!/usr/bin/env python3
"""Input shapers and kernels of printers' firmware beside the shortest filters that do as well on a damped mode.

    tests/bench/damped_shapers.py PROGRAM OUT.md

The mode has 40 Hz, to 10 % either side, and a damping ratio of 0.1: what the firmware tunes for. Impulse shapers are
those of Klipper (klippy/extras/shaper_defs.py), kernels those of Kalico (`smooth_kernels.py`). Each is sampled every T,
impulses at the nearest sample. Its own demands are measured: largest tap, largest difference of neighbouring taps (kernels
only), and the most it leaves of the mode. accdec then proves how short a non-negative filter that is nowhere worse can
be. HiGHS refutes one tap less by linear programs of necessary conditions.
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


def sampled(weights, times):
    at = [round(t * PERIOD_DAMPED / PERIOD) for t in times]
    taps = np.zeros(at[-1] + 1)
    taps[at] = weights
    return taps / taps.sum()


def shortest(program, peak, step, allowed):
    """One leg that goes straight on, so that the filter alone costs time."""
    axis = "" if peak is None else (
        f"[[axis]]\nacceleration_max_mm_s2 = {peak * EXACT * FEED / PERIOD * 1e3!r}\n"
        f"jerk_max_mm_s3 = {step * EXACT * FEED / PERIOD**2 * 1e3!r}\n")
    task = f"""sample_period_ms = {PERIOD * 1e3}
{axis}[[corner]]
angle_deg = 180
feed_in_mm_min = {FEED * 6e4!r}
delay_samples = 0
[[mode]]
frequency_Hz = [{BAND[0]!r}, {BAND[1]!r}]
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
    ms = 1e3 * PERIOD
    lines = ["| shaper | its time, ms | it leaves | shortest time, ms | shorter by | proof | one tap less, by HiGHS |",
             "|---|--:|--:|--:|--:|---|---|"]
    cases = {name: (sampled(*shaper), False) for name, shaper in impulses().items()}
    cases |= {name: (kernels.taps_of(*kernel), True) for name, kernel in kernels.KERNELS.items()}
    for name, (taps, smooth) in cases.items():
        allowed = kernels.residual(taps, DAMPING) * EXACT
        peak = taps.max() if smooth else None
        step = np.abs(np.diff(np.concatenate([[0.0], taps, [0.0]]))).max() if smooth else None
        result, verified = shortest(program, peak, step, allowed)
        found = len(result["filter"]["taps"])
        proof = result["status"] + (", certificate accepted" if verified else ", NOT VERIFIED")
        refuted = kernels.filter_of(found - 2, (peak or 1.0) * EXACT, (step or 1.0) * EXACT, allowed, DAMPING) is None
        old, new = (len(taps) - 1) * ms, (found - 1) * ms
        lines.append(f"| {name} | {old:.1f} | {100 * allowed:.1f} % | {new:.1f} | {100 * (1 - new / old):.0f} % "
                     f"| {proof} | {'impossible' if refuted else 'not refuted'} |")
        print(lines[-1], flush=True)
    Path(out).write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
