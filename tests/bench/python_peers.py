#!/usr/bin/env python3
"""One corner, four ways to its shortest motion, in one run: accdec's exact method, a script on SciPy's HiGHS, a search
with SciPy's SLSQP, and one with cvxopt's cone solver.

  PYTHONPATH=build/release/apps/python tests/bench/python_peers.py [--out results/python] [--repeats 3]

The scripts are what an engineer would write who knows that for a fixed order N, delay d and sample k all limits are
convex, and that feasibility is monotone in N + d: bisection over N + d, and for each the pairs (N, d). They share the
model in numpy (tests/attack/model.py), not the program's. Times are CPU seconds of this process, medians.
"""
import argparse
import csv
import math
import pathlib
import statistics
import sys
import time

import numpy as np
import scipy.optimize

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "attack"))
import judge  # noqa: E402
import model  # noqa: E402

import accdec  # noqa: E402

CORNERS = {
    "acceleration": [{"acceleration_max_mm_s2": 6000}],
    "acceleration and jerk": [{"acceleration_max_mm_s2": 6000, "jerk_max_mm_s3": 5e5}],
}
LONGEST = 100  # N + d the scripts begin to bisect from


def task_of(axis):
    return {"sample_period_ms": 1.0, "axis": axis,
            "corner": [{"name": "A", "angle_deg": 95, "feed_in_mm_min": 6000, "error_max_um": 50}]}


def bisect(exists, low, high):
    """Smallest total that exists; nothing below `low` does, `high` does."""
    while low < high:
        middle = (low + high) // 2
        low, high = (low, middle) if exists(middle) else (middle + 1, high)
    return low


def orders(total, least):
    """Pairs with N + d = total worth a look: from d = N + 2 on more delay changes nothing."""
    return range(max(least, (total - 1) // 2), total + 1)


def least_order(task):
    """No filter of fewer samples holds the acceleration: v/(a T) taps."""
    corner = task["corner"][0]
    speed = corner["feed_in_mm_min"] / 6e4
    steepest = max(abs(x) for u in model.directions(corner) for x in u) * speed
    return math.ceil(steepest / (task["axis"][0]["acceleration_max_mm_s2"] / 1e3 * task["sample_period_ms"] / 1e3)) - 1


def ours(task):
    result = accdec.design(task)
    assert result.outcome == "optimal"
    return result.order + int(result.delays[0]), "proved, certificate"


def highs(task):
    least = least_order(task)
    return bisect(lambda total: judge.exists(task, total, least) is True, least, LONGEST), "proved by tolerance 1e-6"


class Cone:
    """Is the error of (N, d, k) within the tolerance? One second-order cone program by cvxopt."""

    def __init__(self, task):
        import cvxopt
        import cvxopt.solvers
        cvxopt.solvers.options["show_progress"] = False
        self.x, self.task, self.corner = cvxopt, task, task["corner"][0]
        self.bound = self.corner["error_max_um"] * 1e-6

    def pair(self, order, delay):
        motion = model.unit_motions(self.task, self.corner, order, delay)
        limits = model.linear_rows(self.task, self.corner, motion)
        for k in sorted(range(min(delay, order), max(delay, order) + 1), key=lambda k: abs(2 * k - order - delay)):
            error = self.least_error(limits, [p[k] for p in motion.position])
            if error is None:
                return False
            if error <= self.bound * (1 + 1e-6):
                return True
        return False

    def least_error(self, limits, position):
        n = limits.shape[1]
        m = self.x.matrix
        # Variables b_0 .. b_N, e: minimise e within |limits b| <= 1, b >= 0, sum 1, |position b| <= e (in mm).
        linear = np.vstack([np.hstack([limits, np.zeros((len(limits), 1))]),
                            np.hstack([-limits, np.zeros((len(limits), 1))]),
                            np.hstack([-np.eye(n), np.zeros((n, 1))])])
        cone = np.zeros((1 + len(position), n + 1))
        cone[0, n] = -1.0
        for i, row in enumerate(position):
            cone[1 + i, :n] = -1e3 * np.asarray(row)
        right = np.concatenate([np.ones(2 * len(limits)), np.zeros(n), np.zeros(1 + len(position))])
        try:
            answer = self.x.solvers.conelp(m(np.append(np.zeros(n), 1.0)), m(np.vstack([linear, cone])), m(right),
                                           {"l": len(linear), "q": [1 + len(position)], "s": []},
                                           m(np.append(np.ones(n), 0.0)[None, :]), m(np.ones(1)))
        except (ArithmeticError, ValueError):
            return math.inf
        return answer["x"][n] * 1e-3 if answer["status"] == "optimal" else None

    def search(self):
        least = least_order(self.task)
        return bisect(lambda total: any(self.pair(n, total - n) for n in orders(total, least)), least, LONGEST)


def cvxopt(task):
    return Cone(task).search(), "within the solver's 1e-7"


def slsqp(task):
    """Per pair the least error at given delay, a nonlinear problem with exact derivatives from accdec.problem."""
    made, least = accdec.Task(**task), least_order(task)

    def pair(order, delay):
        p = accdec.problem(made, "margin", order=order, delays=[delay], reduced=True)
        found = scipy.optimize.minimize(p.fun, p.x0, jac=p.grad, method="SLSQP", bounds=p.bounds,
                                        constraints=p.constraints(dense=True), options={"maxiter": 100})
        return p.violation(found.x) <= 1e-7 and found.fun <= 1.0 + 1e-7

    return bisect(lambda total: any(pair(n, total - n) for n in orders(total, least)), least, LONGEST), "nothing proved"


def measure(method, task, repeats):
    times = []
    for _ in range(repeats):
        before = time.process_time()
        total, proof = method(task)
        times.append(time.process_time() - before)
        if times[0] > 5.0:
            break
    return total + 1, proof, statistics.median(times), len(times)


def main():
    arguments = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    arguments.add_argument("--out", type=pathlib.Path)
    arguments.add_argument("--repeats", type=int, default=3)
    given = arguments.parse_args()
    rows = []
    for name, axis in CORNERS.items():
        fastest = None
        for method in (ours, slsqp, cvxopt, highs):
            samples, proof, seconds, repeats = measure(method, task_of(axis), given.repeats)
            fastest = fastest or seconds
            rows.append([name, method.__name__ if method is not ours else "accdec exact", samples, proof,
                         f"{seconds:.3g}", f"{seconds / fastest:.3g}", repeats])
            print(*rows[-1], sep=", ", flush=True)
    if given.out:
        given.out.mkdir(parents=True, exist_ok=True)
        with open(given.out / "peers.csv", "w", newline="") as file:
            table = csv.writer(file, lineterminator="\n")
            table.writerow(["corner", "method", "corner_samples", "proof", "cpu_s", "times_as_long", "repeats"])
            table.writerows(rows)


if __name__ == "__main__":
    main()
