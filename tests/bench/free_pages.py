"""Shared by free_bounds.py and arcs.py: their options, the task of three equal axes, and runs of the program."""
import argparse
import json
import pathlib
import subprocess

SOURCE = pathlib.Path(__file__).resolve().parents[2]


def options(description, page, seconds, more=()):
    """Of a script that writes results/program/<page>. more: further options, (name, keywords of argparse)."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("accdec", nargs="?", default=str(SOURCE / "build/release/apps/accdec"))
    parser.add_argument("--seconds", type=float, default=seconds)
    parser.add_argument("--out", type=pathlib.Path, default=SOURCE / "results/program" / page)
    for option, keywords in more:
        parser.add_argument(option, **keywords)
    return parser.parse_args()


def task_file(folder, velocity, acceleration, jerk):
    """Of axes x, y, z at 1 ms; mm, s; jerk 0: no limit."""
    task = folder / "task.toml"
    task.write_text("sample_period_ms = 1\n" + "".join(
        f'[[axis]]\nname = "{axis}"\nvelocity_max_mm_s = {velocity:g}\nacceleration_max_mm_s2 = {acceleration:g}\n'
        + (f"jerk_max_mm_s3 = {jerk:g}\n" if jerk else "") for axis in "xyz"))
    return task


def planned(accdec, folder, program, task, plan, seconds):
    """The result, and its bound for any motion in s."""
    result = folder / "r.json"
    subprocess.run([accdec, "program", program, "--task", task, "--plan", plan, "--time-limit", str(seconds), "--json",
                    result, "--quiet"], check=True, capture_output=True)
    found = json.loads(result.read_text())
    return found, max(b["time_s"] for b in found["bounds"] if b["name"] != "monotone legs")
