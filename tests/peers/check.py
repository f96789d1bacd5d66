#!/usr/bin/python3
"""One checker for everybody's motion: positions every millisecond against the points of a program and the limits of the
axes."""
import numpy as np

T = 1e-3


def load_points(text):
    rows = [line.split() for line in text.splitlines()]
    return (
        np.array([[float(v) for v in r[:3]] for r in rows]),
        np.array([float(r[3]) for r in rows]),
        [r[4] for r in rows],
    )


def distances(points, point):
    """Of one point from every segment of a polyline."""
    a, d = points[:-1], np.diff(points, axis=0)
    length2 = np.einsum("ij,ij->i", d, d)
    t = np.clip(np.einsum("ij,ij->i", point - a, d) / np.where(length2 > 0, length2, 1), 0, 1)
    return np.linalg.norm(a + t[:, None] * d - point, axis=1)


def nearest_in_order(motion, points):
    """Smallest distance of the polyline through the samples from every point, the points in their order.

    The search for a point begins where the one before was nearest, and ends one and a half of their distance and 1 mm
    farther along the motion.
    """
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(motion, axis=0), axis=1))])
    found, at = np.zeros(len(points)), 0
    for k in range(1, len(points)):
        reach = way[at] + 1.02 * np.linalg.norm(points[k] - points[k - 1]) + 0.2
        last = min(len(motion) - 1, int(np.searchsorted(way, reach)) + 1)
        if last <= at:
            last = min(at + 1, len(motion) - 1)
        if last == at:
            found[k] = np.linalg.norm(motion[at] - points[k])
            continue
        d = distances(motion[at : last + 1], points[k])
        i = int(np.argmin(d))
        found[k] = d[i]
        at += i
    return found


def check(motion, points, tolerances, kinds, acceleration, velocity, jerk):
    """motion: rows of x, y, z in mm; limits of every axis in mm/s^n, jerk None if there is none. Returns a
    dictionary."""
    moving = np.nonzero(np.any(np.diff(motion, axis=0) != 0, axis=1))[0]
    first, last = moving[0], moving[-1] + 1
    motion = motion[first : last + 1]
    rested = np.vstack([np.repeat(motion[:1], 3, 0), motion, np.repeat(motion[-1:], 3, 0)])
    v = np.diff(rested, axis=0) / T
    a = np.diff(v, axis=0) / T
    j = np.diff(a, axis=0) / T
    errors = nearest_in_order(motion, points)
    judged = np.arange(1, len(points) - 1)
    # Beyond the tolerance: the positions are logged with nine decimals, an exact stop may fall between two samples.
    excess = errors[judged] - tolerances[judged]
    result = {
        "time_s": (last - first) * T,
        "error_max_mm": float(errors[judged].max()) if len(judged) else 0.0,
        "excess_max_mm": float(excess.max()) if len(judged) else 0.0,
        "end_error_mm": float(np.linalg.norm(motion[-1] - points[-1])),
    }
    for i, axis in enumerate("xyz"):
        result["acceleration_" + axis] = float(np.abs(a[:, i]).max())
        result["jerk_" + axis] = float(np.abs(j[:, i]).max())
        result["velocity_" + axis] = float(np.abs(v[:, i]).max())
    broken = []
    # A polyline through samples cuts a curve by up to |A| T^2/8, |A| at most sqrt(2) of one axis' for two of them.
    if result["excess_max_mm"] > 3e-4 + 1.5 * acceleration * T * T / 8:
        broken.append("tolerance by %.1f um" % (1e3 * result["excess_max_mm"]))
    for what, bound in (("velocity", velocity), ("acceleration", acceleration), ("jerk", jerk)):
        most = max(result[what + "_" + axis] for axis in "xyz")
        if bound and most > bound * (1 + 1e-3):
            broken.append("%s by %.1f %%" % (what, 100 * (most / bound - 1)))
    if result["end_error_mm"] > 1e-3:
        broken.append("does not end where the program does")
    result["breaks"] = "; ".join(broken)
    return result
