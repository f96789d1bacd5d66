#!/usr/bin/env python3
"""What proofs cost to check: processor time of `design` and of `verify`, and the size of the result with its
certificate.

  certificate_times.py TASK.toml ... [--accdec build/release/apps/accdec] [--time-limit 60]

Prints a table in Markdown. The time the program takes for `--version` is taken off both.
"""
import argparse
import json
import pathlib
import resource
import statistics
import subprocess
import tempfile


def processor_seconds(arguments):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    code = subprocess.run(arguments, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, code


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tasks", nargs="+", type=pathlib.Path)
    parser.add_argument("--accdec", default="build/release/apps/accdec")
    parser.add_argument("--time-limit", type=float, default=60.0)
    options = parser.parse_args()
    start = statistics.median(processor_seconds([options.accdec, "--version"])[0] for _ in range(9))
    print("| task | status | proof ms | check ms | result kB |\n|---|---|--:|--:|--:|")
    slower = 0
    for task in options.tasks:
        with tempfile.NamedTemporaryFile(suffix=".json") as file:
            proof, _ = processor_seconds(
                [
                    options.accdec,
                    "design",
                    task,
                    "--time-limit",
                    str(options.time_limit),
                    "--quiet",
                    "--json",
                    file.name,
                ]
            )
            # The middle of three: a check of a short proof lasts no longer than the clock's step.
            checks = [processor_seconds([options.accdec, "verify", file.name]) for _ in range(3)]
            result = json.load(open(file.name))
            size = pathlib.Path(file.name).stat().st_size
        check = statistics.median(seconds for seconds, _ in checks) - start
        wanted = 1 if result["status"] == "infeasible" else 0
        status = result["status"] if checks[0][1] == wanted or result["status"] == "infeasible" else "refused"
        slower += check > proof - start
        print(
            f"| {task.stem} | {status} | {1e3 * (proof - start):.1f} | {1e3 * max(check, 0.0):.1f} | {1e-3 * size:.0f} |",
            flush=True,
        )
    print(f"\nSlower to check than to prove: {slower} of {len(options.tasks)}.")


if __name__ == "__main__":
    main()
