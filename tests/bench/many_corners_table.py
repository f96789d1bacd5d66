#!/usr/bin/env python3
"""Designs the tasks of many_corners.py one after another and checks each proof.

  many_corners_table.py FOLDER [--accdec build/release/apps/accdec] [--time-limit 60] [--threads 1] [--out results/exact]

FOLDER holds the tasks. Writes many_corners.csv, one row a task, and many_corners.svg, processor time in user mode over
the number of corners. Rows that the table has already are kept: remove those, or the file, that are to be run
again.
"""
import argparse
import csv
import json
import pathlib
import resource
import subprocess
import sys
import time

sys.dont_write_bytecode = True
import figure

COLUMNS = (
    "kind",
    "corners",
    "seed",
    "status",
    "cycle_ms",
    "bound_ms",
    "gap_percent",
    "user_s",
    "wall_s",
    "linear_programs",
    "check_s",
    "proof",
)
TITLE = "Proofs for several corners that share a filter: processor time"
# Place beside the number of corners.
BESIDE = {"jerk": 0, "force": 0.12, "vibration": 0.24, "power": -0.12, "unequal": -0.24}


def user_time():
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime


def run(arguments):
    before, began = user_time(), time.monotonic()
    done = subprocess.run(arguments, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    return done, user_time() - before, time.monotonic() - began


def row_of(accdec, task, limit, threads):
    result = task.with_suffix(".json")
    options = ["--no-baselines", "--time-limit", str(limit), "--threads", str(threads)]
    _, user, wall = run([accdec, "design", task, *options, "--json", result])
    found = json.loads(result.read_text())
    check, checking, _ = run([accdec, "verify", result])
    result.unlink()
    kind, corners, seed = task.stem.split("-")
    proof = "accepted" if found.get("certificate") and check.returncode == 0 else "none"
    return (
        kind,
        corners,
        seed,
        found["status"],
        f"{1e3 * found['cycle_time_s']:.6g}",
        f"{1e3 * (found['lower_bound_s'] or 0):.6g}",
        f"{100 * (found['gap'] or 0):.2f}",
        f"{user:.2f}",
        f"{wall:.2f}",
        found["solver"]["evaluations"],
        f"{checking:.2f}",
        proof,
    )


def draw(out):
    rows = list(csv.DictReader((out / "many_corners.csv").open()))

    def points(label, chosen, **style):
        return {"label": label, "x": [int(r["corners"]) + BESIDE[r["kind"]] for r in chosen],
                "y": [float(r["user_s"]) for r in chosen], **style}

    proved = [r for r in rows if r["status"] == "optimal"]
    # Every second symbol is filled.
    series = [points(kind, [r for r in proved if r["kind"] == kind], style=2 * i) for i, kind in enumerate(BESIDE)]
    series.append(points("open: stopped without a whole proof", [r for r in rows if r not in proved], style=1))
    figure.draw(out / "many_corners.svg", TITLE, {"label": "corners that share the filter", "range": [1.5, 12.5]},
                {"label": "processor time in user mode / s", "log": True, "range": [0.007, 60]}, series)


def size_of(row):
    return int(row[1]), row[0], int(row[2])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--accdec", default="build/release/apps/accdec")
    parser.add_argument("--time-limit", type=float, default=60.0)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("results/exact"))
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    table = given.out / "many_corners.csv"
    rows = list(csv.reader(table.open()))[1:] if table.exists() else []
    known = {tuple(r[:3]) for r in rows}
    tasks = [t for t in given.folder.glob("*.toml") if tuple(t.stem.split("-")) not in known]
    for task in sorted(tasks, key=lambda t: size_of(t.stem.split("-"))):
        rows.append([str(x) for x in row_of(given.accdec, task, given.time_limit, given.threads)])
        with table.open("w", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(COLUMNS)
            writer.writerows(sorted(rows, key=size_of))
    draw(given.out)


if __name__ == "__main__":
    main()
