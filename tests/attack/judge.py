"""Is any corner as short as N + d = L? Decided by linear programs over every (N, d, k), solved by HiGHS.

For a fixed order N, delay d and sample k all limits but power, regeneration and smallest speed are convex in the taps:
rows |A b| <= 1 and cones. The cone of the corner error is the objective: the smallest |S[k]| is found by a polygon of
tangents that is refined where the optimum lies. Every value of it is a lower bound, so a polygon that is above the
tolerance refutes (N, d, k) at once.
"""
import math

import numpy as np
from scipy.optimize import linprog

import model

MARGIN = 1e-6  # relative; answers nearer to a bound than this are left undecided


def plane(position):
    """Rows (2 x taps) of a corner's position in an orthonormal basis of the plane of its legs."""
    stacked = np.stack(position)  # axes x taps
    u, s, vt = np.linalg.svd(stacked, full_matrices=False)
    rank = min(2, len(s))
    rows = s[:rank, None] * vt[:rank]
    return rows if rank == 2 else np.vstack([rows, np.zeros_like(rows)])


def _tangents(rows, angles):
    return np.cos(angles)[:, None] * rows[0] + np.sin(angles)[:, None] * rows[1]


def smallest_error(rows, cones, position, stop_above, symmetric=False):
    """Smallest |position . b| over b >= 0, sum 1, |rows b| <= 1, |cone b| <= bound; None if there is no such b.

    `cones`: pairs of an array (cones x 2 x taps) and their bound; only those that an answer breaks get rows.
    Ends early with a lower bound once that exceeds `stop_above`.
    """
    n = rows.shape[1]
    scale = max(float(np.abs(position).max()), 1e-30)
    rows_of_error = plane(position) / scale
    angles = np.linspace(0.0, 2.0 * math.pi, 12, endpoint=False)
    error_cuts = _tangents(rows_of_error, angles)
    upper, bounds = [np.vstack([rows, -rows])], [np.ones(2 * len(rows))]
    equal = [np.append(np.ones(n), 0.0)]
    if symmetric:
        for i in range(n // 2):
            row = np.zeros(n + 1)
            row[i], row[n - 1 - i] = 1.0, -1.0
            equal.append(row)
    objective = np.append(np.zeros(n), 1.0)
    for _ in range(100):
        left = np.vstack(
            [
                np.hstack([np.vstack(upper), np.zeros((sum(len(u) for u in upper), 1))]),
                np.hstack([error_cuts, -np.ones((len(error_cuts), 1))]),
            ]
        )
        right = np.concatenate(bounds + [np.zeros(len(error_cuts))])
        for method in ("highs", "highs-ds", "highs-ipm"):  # now and then HiGHS ends without knowing
            answer = linprog(
                objective,
                A_ub=left,
                b_ub=right,
                A_eq=np.array(equal),
                b_eq=[1.0] + [0.0] * (len(equal) - 1),
                bounds=[(0.0, None)] * (n + 1),
                method=method,
            )
            if answer.status in (0, 2):
                break
        else:
            raise Unsolved(answer.message)
        if answer.status == 2:
            return None
        taps, low = answer.x[:n], answer.x[n] * scale
        if low > stop_above * (1.0 + MARGIN):
            return low
        at = rows_of_error @ taps
        done = math.hypot(*at) * scale <= low * (1.0 + 0.1 * MARGIN) + 1e-15
        if not done:
            error_cuts = np.vstack([error_cuts, _tangents(rows_of_error, np.array([math.atan2(at[1], at[0])]))])
        for cone, bound in cones:
            at = cone @ taps
            length = np.hypot(at[:, 0], at[:, 1])
            for worst in {int(np.argmax(length)), 0, len(cone) - 1}:
                if length[worst] > bound * (1.0 + 0.1 * MARGIN):
                    upper.append(_tangents(cone[worst], np.array([math.atan2(at[worst, 1], at[worst, 0])])))
                    bounds.append(np.array([bound]))
                    done = False
        if done:
            return low
    return low


class Unsolved(RuntimeError):
    """A linear program that HiGHS gave no answer to."""


def _pair(task, corner, order, delay, tolerance, symmetric):
    """Smallest error over all samples k, or None. Stops at the first k that is within the tolerance."""
    motion = model.unit_motions(task, corner, order, delay)
    rows = model.linear_rows(task, corner, motion)
    period = task["sample_period_ms"] / 1e3
    cones = [(model.residual_rows(m, period, order, 8001), m["residual_max"]) for m in task.get("mode", [])]
    best = None
    # Before k = d leg 2 has not begun, after the last sample of leg 1 it is over: both only lead away.
    last = order + model.settling(task)
    for k in sorted(range(min(delay, last), max(delay, last) + 1), key=lambda k: abs(2 * k - order - delay)):
        error = smallest_error(rows, cones, [p[k] for p in motion.position], tolerance, symmetric)
        if error is None:
            return None  # the limits alone exclude this pair, whatever k
        best = error if best is None else min(best, error)
        if best <= tolerance * (1.0 - MARGIN):
            return best
    return best


def exists(task, total, order_min=1, order_max=400):
    """Whether some corner has N + d = total: True, False, or None when the margin decides, or HiGHS has no answer."""
    corner = task["corner"][0]
    tolerance = corner["error_max_um"] * 1e-6
    symmetric = task.get("design", {}).get("symmetric", False)
    undecided = False
    # With d = N the legs do not overlap, but the jerk still spans both; from d = N + 2 more delay changes nothing.
    for order in range(max(order_min, (total - 1 - model.settling(task)) // 2), min(order_max, total) + 1):
        try:
            error = _pair(task, corner, order, total - order, tolerance, symmetric)
        except Unsolved:
            undecided = True
            continue
        if error is None or error > tolerance * (1.0 + MARGIN):
            continue
        if error <= tolerance * (1.0 - MARGIN):
            return True
        undecided = True
    return None if undecided else False
