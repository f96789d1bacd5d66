#!/usr/bin/python3
"""Small random programs: the bound for any motion and plan `free` beside linear programs by SciPy's HiGHS.

For given samples at which the vertices are passed, the linear program has every sample of the motion free. Its polygons
are inscribed, so every motion that it finds is valid. None may be faster than the bound, and `free` may hardly be
slower than the fastest one. The samples of the passes are searched one by one. Random passes within a motion
shorter than the bound must be impossible.
"""
import argparse
import json
import math
import pathlib
import random
import subprocess
import sys
import tempfile

import numpy as np
import scipy.optimize
import scipy.sparse as sparse

PERIOD, SPEED, FEED, ACCELERATION = 0.005, 200.0, 100.0, 1000.0  # s, mm/s, mm/s, mm/s^2
SIDES = 16


class Program:
    def __init__(self, rng, jerk):
        self.jerk, self.tolerance = jerk, rng.choice([0.02, 0.1, 0.5])
        self.points, angle = [np.zeros(2)], rng.uniform(0, 2 * math.pi)
        for _ in range(rng.randint(3, 5)):
            way = rng.uniform(2, 10) * np.array([math.cos(angle), math.sin(angle)])
            self.points.append(np.round(self.points[-1] + way, 4))
            angle += rng.uniform(0.2, 2.9) * rng.choice([-1, 1])
        self.tried = {}

    def text(self):
        lines = [f"G1 X{x:.4f} Y{y:.4f}" for x, y in self.points[1:]]
        return f"G64 P{self.tolerance} F{60 * FEED:g}\n" + "\n".join(lines) + "\nM2\n"

    def task(self):
        limits = f"velocity_max_mm_s = {SPEED}\nacceleration_max_mm_s2 = {ACCELERATION}\n" + \
                 (f"jerk_max_mm_s3 = {self.jerk}\n" if self.jerk else "")
        return f"sample_period_ms = {1e3 * PERIOD}\n" + "".join(f'[[axis]]\nname = "{a}"\n{limits}' for a in "xy")

    def possible(self, samples):
        """Whether a motion takes so many samples from vertex to vertex."""
        samples = tuple(samples)
        if samples not in self.tried:
            self.tried[samples] = self.solve(samples)
        return self.tried[samples]

    def solve(self, samples):
        count, passes = sum(samples), np.cumsum(samples)
        # At rest before and after.
        rest = sparse.csr_matrix(([1.0] * (count + 7), (range(count + 7), np.clip(range(-3, count + 4), 0, count))))
        rows, most = [], []

        def add(x, y, bound):
            rows.append(sparse.hstack([x, y]))
            most.append(np.broadcast_to(bound, rows[-1].shape[0]))

        steps, zero = rest, lambda m: sparse.csr_matrix(m.shape)
        limits = [SPEED, ACCELERATION, self.jerk]
        for order, limit in enumerate(limits, 1):
            steps = steps[1:] - steps[:-1]
            for sign in (1, -1) if limit else ():
                add(sign * steps, zero(steps), limit * PERIOD ** order)
                add(zero(steps), sign * steps, limit * PERIOD ** order)
        steps, inside = rest[1:] - rest[:-1], math.cos(math.pi / SIDES)
        for side in range(SIDES):
            x, y = math.cos(2 * math.pi * side / SIDES), math.sin(2 * math.pi * side / SIDES)
            add(x * steps, y * steps, inside * FEED * PERIOD)
        for leg, last in enumerate(passes):
            first, (start, end) = last - samples[leg], self.points[leg:leg + 2]
            u = (end - start) / np.linalg.norm(end - start)
            unit = sparse.identity(count + 1, format="csr")
            for side in range(SIDES):
                x, y = math.cos(2 * math.pi * side / SIDES), math.sin(2 * math.pi * side / SIDES)
                d = np.array([x * u[0] - y * u[1], x * u[1] + y * u[0]])
                beside = inside * self.tolerance + max(d @ start, d @ end)
                add(d[0] * unit[first:last + 1], d[1] * unit[first:last + 1], beside)
                add(d[0] * unit[last], d[1] * unit[last], inside * self.tolerance + d @ end)
        bounds = [(None, None)] * (2 * count + 2)
        for axis in range(2):
            for k, point in ((0, self.points[0]), (count, self.points[-1])):
                bounds[axis * (count + 1) + k] = (point[axis], point[axis])
        found = scipy.optimize.linprog(np.zeros(2 * count + 2), sparse.vstack(rows), np.concatenate(most), bounds=bounds,
                                       method="highs")
        return found.status == 0

    def fastest(self):
        """Samples from vertex to vertex of the fastest motion found."""
        legs = [np.linalg.norm(b - a) for a, b in zip(self.points, self.points[1:])]
        best, scale = None, 1.2
        while best is None:
            ramp = FEED / ACCELERATION + (ACCELERATION / self.jerk if self.jerk else 0)
            guess = [math.ceil(scale * (way / FEED + ramp) / PERIOD) for way in legs]
            best, scale = guess if self.possible(guess) else None, 1.3 * scale
        step = 16
        while step:
            for change in self.changes(len(best), step):
                shorter = [n + c for n, c in zip(best, change)]
                if min(shorter) > 0 and self.possible(shorter):
                    best = shorter
                    break
            else:
                step //= 2
        return best

    @staticmethod
    def changes(legs, step):
        """One leg shorter; or one shorter by more than another is longer."""
        for i in range(legs):
            yield [-step * (k == i) for k in range(legs)]
        for i in range(legs):
            for j in range(legs):
                if i != j:
                    yield [(step if k == j else 0) - (step + 1 if k == i else 0) for k in range(legs)]


def planned(accdec, program, folder, seconds):
    """Time and bound of plan `free`, s."""
    (folder / "p.ngc").write_text(program.text())
    (folder / "t.toml").write_text(program.task())
    subprocess.run([accdec, "program", folder / "p.ngc", "--task", folder / "t.toml", "--plan", "free", "--time-limit",
                    str(seconds), "--json", folder / "r.json", "--quiet"], check=True)
    found = json.loads((folder / "r.json").read_text())
    return found["cycle_time_s"], next(b["time_s"] for b in found["bounds"] if b["name"] == "any motion")


def broken(accdec, rng, program, folder, seconds):
    """What does not hold."""
    free, bound = planned(accdec, program, folder, seconds)
    samples = program.fastest()
    least = sum(samples) * PERIOD
    print(f"{len(program.points) - 2} vertices, P{program.tolerance}, jerk {program.jerk or '-'}: bound {bound:.3f}, "
          f"linear programs {least:.3f}, free {free:.3f} s", flush=True)
    found = [] if bound <= least + 1e-9 else ["the bound is above a valid motion"]
    if free > 1.02 * least + 2 * PERIOD:
        found.append("free is slower than a motion of a linear program")
    for _ in range(5):
        shorter = [max(1, n + rng.randint(-2, 2)) for n in samples]
        while sum(shorter) * PERIOD >= bound - 1e-9:
            longest = max(range(len(shorter)), key=shorter.__getitem__)
            shorter[longest] -= 1
        if program.possible(shorter):
            found.append(f"a motion of {sum(shorter)} samples is below the bound")
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("accdec")
    parser.add_argument("--programs", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=4, help="time limit of plan free")
    options = parser.parse_args()
    wrong = 0
    with tempfile.TemporaryDirectory() as name:
        for i in range(options.programs):
            rng = random.Random(f"{options.seed} {i}")
            program = Program(rng, 50000.0 if i % 2 else 0)
            for reason in broken(options.accdec, rng, program, pathlib.Path(name), options.seconds):
                print(f"seed {options.seed} program {i}: {reason}\n{program.text()}{program.task()}")
                wrong += 1
    sys.exit(wrong > 0)


if __name__ == "__main__":
    main()
