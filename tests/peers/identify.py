#!/usr/bin/python3
"""LinuxCNC's filter found in its own logs, and the times of other programs predicted with it.

1. A straight move in LinuxCNC without a filter gives the control's own smoothing (accdec identify --prefilter).
2. The same move with a filter in the loop, of which `identify` is told nothing, gives the filter in front of it.
3. Other programs are planned at their feeds with the filter found, and run in LinuxCNC with the one that is there. Their cycle times
   must be within 1 %.

Needs root, linuxcnc-uspace and linuxcnc-uspace-dev; without them it says so and ends with 77.
"""
import argparse
import csv
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import loop

ALLOWED = 0.01  # of the cycle time
TAPS_ALLOWED = 1e-3  # of the sum of all
THERE = [18, 7]  # ms, the averages in the loop
# 300 whole samples. LinuxCNC ends other moves with a shorter sample that its smoothing does not explain.
MOVE = "G21 G17 G90 G94\nG64\nG1 X30 F6000\nM2\n"
WARP = "4"


def arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--accdec", default=str(loop.ROOT / "build/release/apps/accdec"))
    parser.add_argument("--out", help="write the table as CSV to this file")
    parser.add_argument("--programs", nargs="*", default=["legs", "zigzag"], help="of problems/program")
    return parser.parse_args()


def linuxcnc(program, log, component=None):
    environment = {**os.environ, "PEER_WARP": WARP}
    if component:
        environment["PEER_FILTER"] = str(component)
    subprocess.check_call([loop.HERE / "linuxcnc/run", program, log, str(loop.ACCELERATION), str(loop.VELOCITY)],
                          env=environment)


def timed(log, out):
    """A log with a time column, and rests at both ends, during which LinuxCNC's sampler was off."""
    rows = loop.columns(log, ("x_mm", "y_mm", "z_mm"))
    rows = [rows[0]] * 20 + rows + [rows[-1]] * 20
    with open(out, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["t_ms", "x_mm", "y_mm", "z_mm"])
        writer.writerows([k, *(f"{x:.9f}" for x in row)] for k, row in enumerate(rows))


def identify(accdec, log, task, *options):
    text = subprocess.run([accdec, "identify", log, "--task", task, *options], check=True, capture_output=True,
                          text=True).stdout
    table = re.search(r"(?m)^\[\w+\]\n(?:.+\n?)+", text)[0]
    numbers = re.search(r"(?:lengths|taps) = (\[.+\])", table)[1]
    return table, json.loads(numbers)


def component(accdec, folder):
    """The averages that are there, built for HAL."""
    task, result = folder / "there.toml", folder / "there.json"
    task.write_text('sample_period_ms = 1\n[filter]\nkind = "averages"\nlengths = ' + f"{THERE}\n"
                    "[[axis]]\nacceleration_max_mm_s2 = 6000\n[[corner]]\nangle_deg = 95\nfeed_in_mm_min = 6000\n")
    subprocess.check_call([accdec, "--quiet", "design", task, "--json", result])
    subprocess.check_call([accdec, "export", result, "--format", "linuxcnc-comp", "--out", folder / "accdec_filter.comp"])
    subprocess.check_call(["halcompile", "--compile", "accdec_filter.comp"], cwd=folder, stdout=subprocess.DEVNULL)
    return folder / "accdec_filter.so"


def predicted(accdec, name, found, folder):
    """Plans a program with the filter found: (emitted program, cycle time in ms)."""
    program, task = folder / f"{name}.ngc", folder / f"{name}.toml"
    shutil.copy(loop.ROOT / "problems/program" / f"{name}.ngc", program)
    head, *tables = re.split(r"(?m)^(?=\[)", (loop.ROOT / "problems/program/mill.toml").read_text())
    task.write_text(head + found + "".join(table for table in tables if not table.startswith("[filter]")))
    emitted, result = folder / f"{name}-a.ngc", folder / f"{name}.json"
    subprocess.check_call([accdec, "--quiet", "program", program, "--task", task, "--feeds", "keep", "--emit", emitted,
                           "--dwell-axis", "A", "--json", result])
    return emitted, 1e3 * json.loads(result.read_text())["cycle_time_s"]


def main():
    options = arguments()
    reason = loop.missing()
    if reason:
        print("skipped:", reason)
        return loop.SKIPPED
    failed, rows = False, []
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        (folder / "move.ngc").write_text(MOVE)
        period = "sample_period_ms = 1\n"
        (folder / "task.toml").write_text(period)
        linuxcnc(folder / "move.ngc", folder / "own.csv")
        timed(folder / "own.csv", folder / "own-timed.csv")
        table, taps = identify(options.accdec, folder / "own-timed.csv", folder / "task.toml", "--prefilter")
        off = max(abs(a - b) for a, b in zip(taps, loop.SMOOTHING))
        print("own smoothing:", [round(tap, 6) for tap in taps], f"off by at most {off:.2g}")
        failed = failed or len(taps) != len(loop.SMOOTHING) or off > TAPS_ALLOWED
        there = component(options.accdec, folder)
        linuxcnc(folder / "move.ngc", folder / "log.csv", there)
        timed(folder / "log.csv", folder / "log-timed.csv")
        (folder / "task.toml").write_text(period + table)
        found, lengths = identify(options.accdec, folder / "log-timed.csv", folder / "task.toml")
        print("averages found:", lengths, "there:", THERE)
        failed = failed or lengths != THERE
        for name in options.programs:
            emitted, time = predicted(options.accdec, name, found + table, folder)
            linuxcnc(emitted, folder / "run.csv", there)
            samples = loop.columns(folder / "run.csv", ("x_mm", "y_mm", "z_mm"))
            # One sample more, as in the report: up to the first at rest.
            logged = len(samples) - loop.last_motion(samples) - loop.first_motion(samples) + 1
            off = time / logged - 1.0
            failed = failed or abs(off) > ALLOWED
            rows.append([name, f"{time:.0f}", logged, f"{100 * off:.4f}"])
            print(f"{name}: {time:.0f} ms predicted, {logged} ms logged, {100 * off:.4f} % off")
    if options.out:
        with open(options.out, "w", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(["program", "predicted_ms", "logged_ms", "off_percent"])
            writer.writerows(rows)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
