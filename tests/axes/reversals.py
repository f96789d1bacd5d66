#!/usr/bin/python3
"""Corners at which an axis with dry friction reverses: nothing is shorter than what accdec proves.
reversals.py --binary ACCDEC [--count N] [--seed S]

Linear programs over the taps for every delay, sample nearest to the corner and sample at which each axis reverses.
With that sample the sign of the friction is known in every sample. The error is at least its part along each of many
directions. The task CORNER and random ones: no taps and delay one sample shorter than the proved design hold all
limits. Some do if friction helps all the time, so that the proofs depend on the reversal."""
import argparse
import itertools
import json
import math
import random
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from scipy.optimize import linprog

DIRECTIONS = 64
CORNER = dict(period=1.0, order=80, mass=34.0, damping=0.0, coulomb=40.0, force=300.0, angle=50.0, heading=30.0,
              feed_in=9000.0, feed_out=9000.0, error=50.0)
TEXT = """sample_period_ms = {period}
[design]
order_max = {order}
[[axis]]
mass_kg = {mass}
damping_N_s_m = {damping}
coulomb_N = {coulomb}
force_max_N = {force}
[[corner]]
angle_deg = {angle}
heading_deg = {heading}
feed_in_mm_min = {feed_in}
feed_out_mm_min = {feed_out}
error_max_um = {error}
"""


def draw(rng):
    """Few taps; an axis or both reverse."""
    return dict(period=4.0, order=14, mass=rng.uniform(20.0, 40.0), damping=rng.choice([0.0, rng.uniform(0.0, 200.0)]),
                coulomb=rng.uniform(30.0, 120.0), force=rng.uniform(220.0, 500.0), angle=rng.uniform(15.0, 85.0),
                heading=rng.uniform(0.0, 360.0), feed_in=rng.uniform(4e3, 13e3), feed_out=rng.uniform(4e3, 13e3),
                error=rng.uniform(20.0, 700.0))


class Corner:
    """All taps and delays of one length, in samples of filter and delay together."""

    def __init__(self, task, length):
        heading, after = math.radians(task["heading"]), math.radians(task["heading"] + 180.0 - task["angle"])
        self.legs = [task[feed] / 6e4 * np.array([math.cos(a), math.sin(a)])
                     for feed, a in (("feed_in", heading), ("feed_out", after))]
        self.task, self.length, self.period = task, length, task["period"] / 1e3
        self.reverses = [a for a in range(2) if self.legs[0][a] * self.legs[1][a] < 0.0]
        way = np.linspace(0.0, 2.0 * math.pi, DIRECTIONS, endpoint=False)
        self.rays = np.column_stack([np.cos(way), np.sin(way)])

    def speeds(self, command, taps):
        """Columns of taps: speeds at samples 0, 1 .. of a command given by sample."""
        samples = range(self.length + 2)
        return np.array([[command(k - i) for i in range(taps)] for k in samples])

    def pushed(self, speeds, signs):
        """Rows: the force of an axis in both directions, from sample 1 on, but for friction of these signs."""
        task = self.task
        force = task["mass"] * np.diff(speeds, axis=0) / self.period + task["damping"] * speeds[1:]
        dry = task["coulomb"] * np.asarray(signs)
        return np.vstack([force, -force]), np.concatenate([task["force"] - dry, task["force"] + dry])

    def shorter(self, delay, reversal, k, error):
        """Whether taps hold all limits with the nearest sample k and these samples of the reversals, and an error along
        the rays below this one, in m. None: friction helps until the end."""
        taps, (v1, v2) = self.length - delay, self.legs
        after = np.arange(1, self.length + 2)
        rows, bounds = [], []

        def add(some):
            rows.append(some[0])
            bounds.append(some[1])

        for a in range(2):
            start = self.speeds(lambda n: v1[a] * (n > 0), taps)
            stop = self.speeds(lambda n: v2[a] * (n <= 0), taps)
            blend = self.speeds(lambda n: v1[a] * (n <= 0) + v2[a] * (n > delay), taps)
            add(self.pushed(start, np.sign(v1[a]) * np.ones(len(after))))
            add(self.pushed(stop, np.sign(v2[a]) * np.ones(len(after))))
            if a not in self.reverses:
                add(self.pushed(blend, np.sign(v1[a]) * np.ones(len(after))))
                continue
            out, at = np.sign(v2[a]), reversal[a] if reversal else self.length + 2
            add(self.pushed(blend, np.where(after < at, -out, out)))
            if reversal:
                add((out * blend[:at], np.zeros(at)))
                add((-out * blend[at:], np.zeros(len(blend) - at)))
        place = [(-max(i - k, 0) * v1 + max(k - i - delay, 0) * v2) * self.period for i in range(taps)]
        add((self.rays @ np.array(place).T, np.full(DIRECTIONS, error)))
        scale = np.abs(np.vstack(rows)).max(axis=1)
        scale[scale == 0.0] = 1.0
        found = linprog(np.zeros(taps), np.vstack(rows) / scale[:, None], np.concatenate(bounds) / scale,
                        np.ones((1, taps)), [1.0], [(0.0, None)] * taps)
        return found.status == 0

    def any_shorter(self, reversing, error):
        """@param reversing  false: with friction that helps"""
        for delay in range(self.length):
            for k in range(self.length + 1):
                if not self.shorter(delay, None, k, error):
                    continue
                if not reversing:
                    return True
                for samples in itertools.product(range(1, self.length + 2), repeat=len(self.reverses)):
                    if self.shorter(delay, dict(zip(self.reverses, samples)), k, error):
                        return True
        return False


def designed(binary, task):
    with tempfile.TemporaryDirectory() as folder:
        path, out = Path(folder) / "task.toml", Path(folder) / "result.json"
        path.write_text(TEXT.format(**task))
        subprocess.run([binary, "design", path, "--json", out, "-q", "--time-limit", "60"], capture_output=True,
                       check=False)
        accepted = subprocess.run([binary, "verify", out, "-q"], capture_output=True, check=False).returncode == 0
        return json.loads(out.read_text()), accepted


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--binary", required=True)
    parser.add_argument("--count", type=int, default=12)
    parser.add_argument("--seed", type=int, default=28)
    options = parser.parse_args()
    rng, wrong, decided = random.Random(options.seed), 0, 0
    for task in [CORNER] + [draw(rng) for _ in range(options.count)]:
        result, accepted = designed(options.binary, task)
        length = round(result["cycle_time_s"] / (task["period"] / 1e3))
        corner = Corner(task, length - 1)
        if result["status"] == "infeasible" or not corner.reverses:
            continue
        error = task["error"] * 1e-6
        helped = corner.any_shorter(False, error)
        # Within the polygon of the rays the error surely holds.
        beaten = helped and corner.any_shorter(True, error * math.cos(math.pi / DIRECTIONS))
        decided += helped and not beaten
        print(f"{result['status']}, {length} samples, {len(corner.reverses)} axes reverse, "
              f"shorter with friction that helps: {helped}")
        if result["status"] != "optimal" or not accepted or beaten:
            wrong += 1
            print(f"  wrong: accepted {accepted}, beaten {beaten}: {task}")
    print(f"{decided} proofs depend on the reversal")
    return 1 if wrong or decided == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
