#!/usr/bin/python3
"""One checker for everybody's motion: positions every millisecond against the points of a program and the limits of the
axes."""
import pathlib
import subprocess
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
T = 1e-3


def points_of(program):
    """The points that a program asks for, mm, and their tolerances, by LinuxCNC's interpreter (moves.py)."""
    done = subprocess.run([sys.executable, str(HERE / "moves.py"), str(program)], capture_output=True, text=True)
    if done.returncode != 0:
        raise ValueError((done.stderr.strip().splitlines() or ["moves.py cannot read it"])[-1])
    rows = [line.split() for line in done.stdout.splitlines()]
    return np.array([[float(v) for v in r[:3]] for r in rows]), np.array([float(r[3]) for r in rows])


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
    found, at, reached = np.zeros(len(points)), 0, np.zeros(len(points), int)
    for k in range(1, len(points)):
        reach = way[at] + 1.02 * np.linalg.norm(points[k] - points[k - 1]) + 0.2
        last = min(len(motion) - 1, int(np.searchsorted(way, reach)) + 1)
        if last <= at:
            last = min(at + 1, len(motion) - 1)
        if last == at:
            found[k], reached[k] = np.linalg.norm(motion[at] - points[k]), at
            continue
        d = distances(motion[at : last + 1], points[k])
        i = int(np.argmin(d))
        found[k] = d[i]
        at += i
        reached[k] = at
    return found, reached


def beyond_the_path(motion, points, tolerances, reached):
    """How far the samples leave the legs that they run along, mm, beyond the tolerances of the legs' ends.

    A sample may be near any of the 25 legs around the point that the motion reached last: fine chords are shorter than
    their tolerance.
    """
    if len(points) < 2:
        return 0.0
    a, d = points[:-1], np.diff(points, axis=0)
    length2 = np.einsum("ij,ij->i", d, d)
    length2[length2 == 0] = 1
    allowed = np.maximum(tolerances[:-1], tolerances[1:])
    leg = np.searchsorted(reached, np.arange(len(motion)), side="right") - 1
    best = np.full(len(motion), np.inf)
    for offset in range(-12, 13):
        k = np.clip(leg + offset, 0, len(d) - 1)
        t = np.clip(np.einsum("ij,ij->i", motion - a[k], d[k]) / length2[k], 0, 1)
        best = np.minimum(best, np.linalg.norm(a[k] + t[:, None] * d[k] - motion, axis=1) - allowed[k])
    return float(best.max())


def check(motion, points, tolerances, acceleration, velocity, jerk):
    """motion: rows of x, y, z in mm; limits of every axis in mm/s^n, jerk 0 if there is none. Returns the numbers of a
    row: how far points, path and end are beyond their tolerances, um, and by how much limits are exceeded, %."""
    moving = np.nonzero(np.any(np.diff(motion, axis=0) != 0, axis=1))[0]
    if not len(moving):
        raise ValueError("nothing moves")
    first, last = moving[0], moving[-1] + 1
    motion = motion[first : last + 1]
    rested = np.vstack([np.repeat(motion[:1], 3, 0), motion, np.repeat(motion[-1:], 3, 0)])
    v = np.diff(rested, axis=0) / T
    a = np.diff(v, axis=0) / T
    j = np.diff(a, axis=0) / T
    errors, reached = nearest_in_order(motion, points)
    judged = np.arange(1, len(points) - 1)
    excess = errors[judged] - tolerances[judged]
    row = {
        "time_s": (last - first) * T,
        "error_um": 1e3 * (float(errors[judged].max()) if len(judged) else 0.0),
        "point_um": 1e3 * (float(excess.max()) if len(judged) else 0.0),
        "path_um": 1e3 * beyond_the_path(motion, points, tolerances, reached),
        "end_um": 1e3 * float(np.linalg.norm(motion[-1] - points[-1])),
    }
    for what, values, bound in (("velocity", v, velocity), ("acceleration", a, acceleration), ("jerk", j, jerk)):
        row[what + "_pct"] = 100 * (float(np.abs(values).max()) / bound - 1) if bound else 0.0
    return row


def breaks(row):
    """What a judged motion breaks, in words; empty if nothing. A limit may be exceeded by 2 %.

    A polyline through samples cuts a curve by up to |A| T^2/8, |A| at most sqrt(3) of one axis' for three of them. Logged
    positions have nine decimals, and an exact stop may fall between two samples: 0.3 um. Arcs are chords of at most
    0.2 um.
    """
    slack = 0.3 + 1e3 * 1.75 * row["acceleration"] * T * T / 8
    found = []
    if row["point_um"] > slack:
        found.append("tolerance at a point by %.1f um" % row["point_um"])
    if row["path_um"] > slack + 0.2:
        found.append("tolerance along the path by %.1f um" % row["path_um"])
    for what in ("velocity", "acceleration", "jerk"):
        if row[what + "_pct"] > 2:
            found.append("%s by %.1f %%" % (what, row[what + "_pct"]))
    if row["end_um"] > 1:
        found.append("does not end where the program does")
    return "; ".join(found)
