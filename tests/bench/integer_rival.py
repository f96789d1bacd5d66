#!/usr/bin/env python3
"""The whole choice of taps and delay as a mixed-integer linear program, solved by cbc, against the exact method.

  tests/bench/integer_rival.py build/release/apps/accdec [--corners 100] [--seed 30] [--seconds 20]

The corners are a seeded Latin hypercube. Each is designed, and its order is then given to both. cbc gets the file of
`accdec instances --format mps`, whose cones have 64 tangents: its optimum is at most that of the exact method. Times are
CPU seconds of cbc with reading, and the time of the exact method with its proof.
"""
import argparse
import json
import pathlib
import random
import re
import resource
import statistics
import subprocess
import tempfile

RANGES = {"heading_deg": (0, 90), "angle_deg": (20, 170), "feed_in_mm_min": (1000, 6000), "feed_out_mm_min": (1000, 6000),
          "error_max_um": (20, 100), "acceleration_max_mm_s2": (3000, 8000), "jerk_max_mm_s3": (2e5, 1e6)}


def corners(count, seed):
    chosen = random.Random(seed)

    def column(low, high):
        cells = list(range(count))
        chosen.shuffle(cells)
        return [low + (high - low) * (cell + chosen.random()) / count for cell in cells]

    columns = {key: column(*limits) for key, limits in RANGES.items()}
    return [{key: values[i] for key, values in columns.items()} for i in range(count)]


def task_text(values):
    def lines(limits):
        return "".join(f"{key} = {value:.6g}\n" for key, value in values.items() if ("_max_mm_" in key) == limits)
    return f'sample_period_ms = 2.0\n[[axis]]\n{lines(True)}[[corner]]\nname = "A"\n{lines(False)}'


def child_seconds():
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime


def compare(accdec, folder, values, seconds):
    (folder / "task.toml").write_text(task_text(values))
    subprocess.run([accdec, "design", folder / "task.toml", "--json", folder / "design.json", "-q"], check=True)
    order = json.loads((folder / "design.json").read_text())["filter"]["order"]
    (folder / "suite.toml").write_text('solvers = "all"\n[[problem]]\nname = "corner"\ntask = "task.toml"\n'
                                       f'formulation = "design"\norder = {order}\n')
    out = folder / "instances"
    subprocess.run([accdec, "instances", folder / "suite.toml", "--out", out, "--format", "mps", "-q"], check=True)
    entry = json.loads((out / "manifest.json").read_text())["instances"][0]
    proof = json.loads((out / entry["optimum"]["certificate"]).read_text())
    before = child_seconds()
    said = subprocess.run(["cbc", out / entry["file"], "sec", str(seconds), "solve"], capture_output=True, text=True,
                          check=True).stdout
    taken = child_seconds() - before
    found = re.findall(r"(?:Optimal - objective value|Objective value:) *(\S+)", said)
    return {"order": order, "exact": entry["optimum"]["upper"], "exact_s": proof["solver"]["wall_time_s"],
            "cbc": float(found[-1]) if "Optimal solution found" in said else None, "cbc_s": taken}


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("accdec")
    options.add_argument("--corners", type=int, default=100)
    options.add_argument("--seed", type=int, default=30)
    options.add_argument("--seconds", type=float, default=20)
    given = options.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        rows = [compare(given.accdec, pathlib.Path(folder), values, given.seconds)
                for values in corners(given.corners, given.seed)]
    done = [row for row in rows if row["cbc"] is not None]
    ratios = [row["cbc_s"] / row["exact_s"] for row in done]
    print(f"{len(rows)} corners, orders {min(r['order'] for r in rows)} to {max(r['order'] for r in rows)}")
    print(f"{len(done)} solved by cbc, {sum(abs(r['cbc'] - r['exact']) < 1e-6 for r in done)} with the same optimum, "
          f"{sum(r['cbc'] > r['exact'] + 1e-6 for r in done)} with a larger one")
    print(f"median times: cbc {statistics.median(r['cbc_s'] for r in done):.3g} s, exact method "
          f"{statistics.median(r['exact_s'] for r in done):.3g} s, ratio {statistics.median(ratios):.3g} "
          f"({min(ratios):.3g} to {max(ratios):.3g})")


main()
