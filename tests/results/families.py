#!/usr/bin/env python3
"""Families beside the proved optimum, over the corners of the studies `along-axes` and `any-corner*`.

  families.py [RESULTS/STUDY]   prints the table of results/study/findings.md from the rows of these studies

A family counts with its best member under the same limits at every corner. `best` is the fastest of all families that a
study computes, `averages (ZV)` the faster of two averages alone and with one ZV pair.
"""
import csv
import io
import lzma
import math
import pathlib
import statistics
import sys

STUDIES = ("along-axes", "any-corner", "any-corner-friction", "any-corner-power", "any-corner-vibration")
SAMPLES = 1.0 + 1e-9  # ms; times are whole samples of 1 ms
FREE_JERK = 13.7e6  # mm/s^3: a step to the full force, 465 N on 34 kg, within one sample of 1 ms keeps it
FORCE = 465.0  # N, of the axes with friction and of those with little power


def rows_of(folder, study):
    packed = pathlib.Path(folder, study, "rows.csv.xz")
    return list(csv.DictReader(io.StringIO(lzma.decompress(packed.read_bytes()).decode())))


def time(row, family):
    text = row.get(f"{family}.cycle_time_ms")
    return float(text) if text else math.inf


def best(row):
    """The fastest of all families."""
    names = {key.split(".")[0] for key in row if key.endswith(".cycle_time_ms")} - {"optimum"}
    return min(time(row, name) for name in names)


def only(family):
    return lambda row: time(row, family)


def averages_zv(row):
    return min(time(row, "trapezoid"), time(row, "trapezoid-zv"))


def feed(row):
    """The faster of both legs, m/s."""
    return max(float(row["feed_in_mm_min"]), float(row["feed_out_mm_min"])) / 6e4


def friction(row):
    """The share of the force that friction takes at feed."""
    return float(row["damping_N_s_m"]) * feed(row) / FORCE


def power(row):
    """The power limit as a share of full force at feed; from 1 on it does not bind."""
    return float(row["power_max_W"]) / (FORCE * feed(row))


def jerk_free(row):
    return float(row["jerk_max_mm_s3"]) >= FREE_JERK


def jerk_and_friction(low, high):
    return lambda row: not jerk_free(row) and low <= friction(row) < high


def residual(low, high):
    return lambda row: low <= float(row["residual_max"]) < high


def everything(_):
    return True


# study, which of its corners in words, which of its corners, family in words, its time
LINES = (
    ("along-axes", "all", everything, "two averages", only("trapezoid")),
    ("any-corner", "all", everything, "two averages", only("trapezoid")),
    ("any-corner", "all", everything, "three averages", only("averages")),
    ("any-corner", "all", everything, "Gaussian", only("gaussian")),
    ("any-corner", "all", everything, "quintic S-curve (paper)", only("s-curve")),
    ("any-corner-friction", "jerk limited, friction below 40 %", jerk_and_friction(0.0, 0.4), "best", best),
    ("any-corner-friction", "jerk limited, friction 40 to 74 %", jerk_and_friction(0.4, 1.0), "best", best),
    ("any-corner-friction", "jerk free", jerk_free, "exponential", only("exponential")),
    ("any-corner-friction", "jerk free", jerk_free, "two averages", only("trapezoid")),
    ("any-corner-power", "power at most 60 % of F v", lambda r: power(r) < 0.6, "best", best),
    ("any-corner-power", "power 60 to 100 % of F v", lambda r: 0.6 <= power(r) < 1.0, "best", best),
    ("any-corner-power", "power above F v, which never binds", lambda r: power(r) >= 1.0, "best", best),
    ("any-corner-vibration", "residual 0.01 to 0.05", residual(0.01, 0.05), "averages (ZV)", averages_zv),
    ("any-corner-vibration", "residual 0.05 to 0.2", residual(0.05, 0.2), "averages (ZV)", averages_zv),
    ("any-corner-vibration", "residual 0.2 to 1", residual(0.2, 1.01), "averages (ZV)", averages_zv),
)


def summary(rows, family):
    """Numbers of corners: all, with a member that holds all limits, at the optimum, far above it; excess of members."""
    both = [(family(row), time(row, "optimum")) for row in rows]
    held = [(a, b) for a, b in both if a < math.inf]
    share = sorted(100 * (a / b - 1) for a, b in held)
    return {
        "corners": len(rows),
        "hold": len(held),
        "optimum": sum(a - b < 0.5 for a, b in held),
        "far": sum(a - b > 3 * SAMPLES for a, b in held),
        "median": statistics.median(share),
        "ninth": share[int(0.9 * len(share))],
        "most": share[-1],
        "most_ms": max(a - b for a, b in held),
    }


def line(folder, study, words, name):
    """The summary behind one line of the table."""
    which, family = next((w, f) for s, t, w, n, f in LINES if (s, t, n) == (study, words, name))
    return summary([row for row in rows_of(folder, study) if which(row)], family)


def table(folder):
    lines = ["| study | corners | number | family | at the optimum | > 3 ms longer | median | 9 of 10 | largest |",
             "|---|---|--:|---|--:|--:|--:|--:|--:|"]
    rows = {study: rows_of(folder, study) for study in STUDIES}
    for study, words, which, name, family in LINES:
        s = summary([row for row in rows[study] if which(row)], family)
        number = s["corners"] if s["hold"] == s["corners"] else f"{s['hold']} of {s['corners']}"
        lines.append(f"| {study} | {words} | {number} | {name} | {s['optimum']} | {s['far']} | {s['median']:.1f} % "
                     f"| {s['ninth']:.1f} % | {s['most']:.1f} %, {s['most_ms']:.0f} ms |")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    print(table(*sys.argv[1:2] or ["results/study"]), end="")
