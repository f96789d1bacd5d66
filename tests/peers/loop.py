#!/usr/bin/python3
"""LinuxCNC with a filter of accdec in its loop: every sample beside the prediction.

Exports the filter of a plan as a HAL component, builds it with halcompile, puts it behind every joint of a LinuxCNC
without a screen, runs the emitted program (--emit --dwell-axis A) and compares the logged positions with the plan's
samples. The task has the control's own smoothing as prefilter_taps, [1 5 5 1]/12. Needs root, linuxcnc-uspace and linuxcnc-uspace-dev; without
them it says so and ends with 77.
"""
import argparse
import csv
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
SMOOTHING = [1 / 12, 5 / 12, 5 / 12, 1 / 12]  # of LinuxCNC 2.9: half a sample of ramp, then its cubic interpolator
SMOOTHED = f"[controller]\nprefilter_taps = {SMOOTHING}\n"
ALLOWED = 1.0  # um
SKIPPED = 77
# LinuxCNC's own limits are far above the filter's: its steps of velocity then fit into one sample.
ACCELERATION, VELOCITY = 10000000, 10000
CORNER = "G21 G17 G90 G94\nG64 P0.05\nG1 X20 F6000\nX18.256885 Y19.923894\nM2\n"  # 95 degrees
CORNER_TASK = "sample_period_ms = 1.0\n[[axis]]\nacceleration_max_mm_s2 = 6000\njerk_max_mm_s3 = 500000\n"


def arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--accdec", default=str(ROOT / "build/release/apps/accdec"))
    parser.add_argument("--out", help="write the table as CSV to this file")
    parser.add_argument("--programs", nargs="*", default=["corner", "zigzag"], help="corner, or of problems/program")
    parser.add_argument("--keep", help="keep programs, logs and components in this folder")
    return parser.parse_args()


def missing():
    tools = [tool for tool in ("linuxcnc", "halcompile", "gcc", "unshare") if not shutil.which(tool)]
    if tools:
        return "not installed: " + ", ".join(tools) + " (packages linuxcnc-uspace and linuxcnc-uspace-dev)"
    return "" if os.geteuid() == 0 else "needs root for namespaces of its own"


def columns(path, names):
    """These columns of a CSV, in mm; 0 where the file has none."""
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    return [[float(row.get(name, 0.0)) for name in names] for row in rows]


def first_motion(samples):
    start = samples[0]
    return next(k for k, s in enumerate(samples) if max(abs(x - y) for x, y in zip(s, start)) > 1e-9)


def last_motion(samples):
    return first_motion(samples[::-1])


def run(name, accdec, folder):
    """One program: (samples, samples as logged, largest difference in um, delays)."""
    program, task = folder / (name + ".ngc"), folder / (name + ".toml")
    if name == "corner":
        program.write_text(CORNER)
        task.write_text(CORNER_TASK + SMOOTHED)
    else:
        shutil.copy(ROOT / "problems/program" / (name + ".ngc"), program)
        task.write_text((ROOT / "problems/program/mill.toml").read_text() + SMOOTHED)
    emitted, samples, result = folder / (name + "-a.ngc"), folder / "samples.csv", folder / "result.json"
    subprocess.check_call(
        [accdec, "--quiet", "program", program, "--task", task, "--emit", emitted, "--dwell-axis", "A"]
        + ["--samples", samples, "--json", result]
    )
    component = folder / "accdec_filter.comp"
    subprocess.check_call([accdec, "export", result, "--format", "linuxcnc-comp", "--out", component])
    subprocess.check_call(["halcompile", "--compile", component.name], cwd=folder, stdout=subprocess.DEVNULL)
    log = folder / (name + "-log.csv")
    subprocess.check_call(
        [HERE / "linuxcnc/run", emitted, log, str(ACCELERATION), str(VELOCITY)],
        env={**os.environ, "PEER_FILTER": str(folder / "accdec_filter.so")},
    )
    names = ("x_mm", "y_mm", "z_mm")
    logged, predicted = columns(log, names), columns(samples, names)
    # The way to where the program begins is not part of the plan.
    ends = len(logged) - last_motion(logged), len(predicted) - last_motion(predicted)
    length = min(ends[1] - first_motion(predicted), ends[0])
    worst = max(
        abs(logged[ends[0] - k][a] - predicted[ends[1] - k][a]) for k in range(1, length + 1) for a in range(3)
    )
    delays = json.loads(result.read_text())["delay_total_s"]
    return ends[1] - first_motion(predicted), ends[0] - first_motion(logged), 1e3 * worst, delays


def main():
    options = arguments()
    reason = missing()
    if reason:
        print("skipped:", reason)
        return SKIPPED
    rows, failed = [], False
    with tempfile.TemporaryDirectory() as temporary:
        for name in options.programs:
            folder = pathlib.Path(options.keep or temporary, name)
            folder.mkdir(parents=True)
            predicted, logged, worst, delays = run(name, options.accdec, folder)
            rows.append([name, predicted, logged, f"{1e3 * delays:.0f}", f"{worst:.6f}"])
            failed = failed or worst > ALLOWED
            print(f"{name}: {predicted} samples predicted, {logged} logged, largest difference {worst:.3g} um")
    if options.out:
        with open(options.out, "w", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(["program", "samples_predicted", "samples_logged", "delays_ms", "largest_difference_um"])
            writer.writerows(rows)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
