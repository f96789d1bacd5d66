#!/usr/bin/python3
"""The corner of problems/corner/acceleration-jerk.toml behind a position control of Kv = 200 1/s without feedforward:
no filter and delay of 49 samples keep 50 um, some of 50 samples do. Linear programs over the taps for every delay and
sample: the error is at least its part along each of many directions, so what they find is a lower bound."""
import math
import sys
import tomllib
from pathlib import Path

import numpy as np
from scipy.optimize import linprog

ROOT = Path(__file__).resolve().parents[2]
DIRECTIONS = 128
FAR = 60e-6  # m; with 8 directions alone, a larger error needs no other


def least_error(task, gain, length):
    """Least error, m, of any taps b_0 .. b_N and delay d with N + 1 + d = length."""
    corner, axes, period = task["corner"][0], task["axis"], task["sample_period_ms"] / 1e3
    heading, angle = math.radians(corner.get("heading_deg", 0.0)), math.radians(corner["angle_deg"])
    after = heading + (1.0 if corner.get("turn", "left") == "left" else -1.0) * (math.pi - angle)
    legs = [np.array([math.cos(a), math.sin(a)]) for a in (heading, after)]
    feed = corner["feed_in_mm_min"] / 6e4
    fastest = feed * max(np.abs(leg).max() for leg in legs)
    tap_max = axes[0]["acceleration_max_mm_s2"] / 1e3 * period / fastest
    step_max = axes[0]["jerk_max_mm_s3"] / 1e3 * period**2 / fastest
    left = math.exp(-gain * period)  # of the following error after a sample
    late = (1.0 - left) / gain  # s of velocity that a sample of it adds to the error
    way = np.linspace(0.0, 2.0 * math.pi, DIRECTIONS, endpoint=False)
    rays = np.column_stack([np.cos(way), np.sin(way)])
    least = math.inf
    for delay in range(length):
        n = length - delay  # taps
        # Columns: the part of each tap in position and following error at every sample, between even motions.
        samples = np.arange(0, length + 60)
        behind = np.zeros((len(samples), n, 2))
        for i in range(n):
            command = np.where(samples[:, None] <= i, feed * legs[0], 0.0) \
                + np.where(samples[:, None] > i + delay, feed * legs[1], 0.0)
            at = -feed * period * i * legs[0]  # at sample 0, i samples before the corner
            lag = feed * legs[0] * late / (1.0 - left)
            behind[0, i] = at - lag
            for k in samples[1:]:
                at = at + period * command[k]
                lag = left * lag + late * command[k]
                behind[k, i] = at - lag
        steps = np.zeros((n + 1, n))
        for i in range(n):
            steps[i, i] += 1.0
            steps[i + 1, i] -= 1.0
        # Each axis behind the corner, as part of the fastest.
        late_steps, early_steps = np.vstack([np.zeros((delay, n)), steps]), np.vstack([steps, np.zeros((delay, n))])
        blend = [legs[1][a] * late_steps - legs[0][a] * early_steps for a in range(2)]
        steps = np.vstack([steps, *(rows * feed / fastest for rows in blend)])
        limits = np.column_stack([np.vstack([steps, -steps]), np.zeros(2 * len(steps))])

        def bound(k, some):
            rows = np.column_stack([some @ behind[k].T * 1e6, -np.ones(len(some))])
            found = linprog(np.append(np.zeros(n), 1.0), np.vstack([rows, limits]),
                            np.concatenate([np.zeros(len(some)), np.full(2 * len(steps), step_max)]),
                            np.append(np.ones(n), 0.0)[None, :], [1.0], [(0.0, tap_max)] * n + [(0.0, None)])
            return found.fun * 1e-6 if found.status == 0 else math.inf

        if n * tap_max < 1.0:
            continue  # too short to reach the feed
        for k in samples:
            if bound(k, rays[::DIRECTIONS // 8]) < min(least, FAR):
                least = min(least, bound(k, rays))
    return least


def main():
    task = tomllib.loads((ROOT / "problems/corner/acceleration-jerk.toml").read_text())
    wrong = 0
    for length, kept in ((49, False), (50, True)):
        found = least_error(task, 200.0, length)
        print(f"{length} samples: at least {1e6 * found:.3f} um")
        wrong += (found <= 50e-6) != kept
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
