#!/usr/bin/python3
"""Regenerates results/program/free.md: tests/bench/free_bounds.py [PROGRAM accdec] [--seconds S] [--out FILE]

Plan `free` beside the bound for any motion, on shipped and generated programs, with and without a jerk limit.
"""
import argparse
import json
import pathlib
import subprocess
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parents[2]
VELOCITY, ACCELERATION, JERK = 200, 1000, 50000  # mm, s
SHIPPED = [f"linuxcnc/corner-p{p}" for p in ("0.01", "0.05", "0.5")] + \
          [f"linuxcnc/zigzag-p{p}" for p in ("0.01", "0.05", "0.5")] + ["pocket", "star", "zigzag", "raster"]
GENERATED = [("hilbert", 770), ("relief", 300), ("spiral", 800)]


def task_file(folder, jerk):
    task = folder / "task.toml"
    task.write_text("sample_period_ms = 1\n" + "".join(
        f'[[axis]]\nname = "{axis}"\nvelocity_max_mm_s = {VELOCITY}\nacceleration_max_mm_s2 = {ACCELERATION}\n'
        + (f"jerk_max_mm_s3 = {JERK}\n" if jerk else "") for axis in "xyz"))
    return task


def cases(accdec, folder):
    """(name, file)"""
    for name in SHIPPED:
        yield name, SOURCE / f"problems/program/{name}.ngc"
    for kind, blocks in GENERATED:
        file = folder / f"{kind}.ngc"
        subprocess.run([accdec, "generate", kind, "--blocks", str(blocks), "--feed", "6000", "--out", file], check=True)
        yield f"{kind}, {blocks} blocks", file


def planned(accdec, folder, program, jerk, seconds):
    """The faster of the plans that free begins with, free, and the bound for any motion: s."""
    result = folder / "r.json"
    subprocess.run([accdec, "program", program, "--task", task_file(folder, jerk), "--plan", "free", "--time-limit",
                    str(seconds), "--json", result, "--quiet"], check=True, capture_output=True)
    found = json.loads(result.read_text())
    bound = max(b["time_s"] for b in found["bounds"] if b["name"] != "monotone legs")
    others = min(c["cycle_time_s"] for c in found["candidates"])
    return min(others, found["cycle_time_s"]) if found["plan"] != "free" else others, found["cycle_time_s"], bound


def row(name, jerk, others, free, bound):
    return (f"| {name} | {jerk if jerk else '-'} | {others:.3f} | {free:.3f} | {bound:.3f} | "
            f"{100 * (free / bound - 1):.1f} |")


HEAD = f"""# Free motion and its bound

Written by `tests/bench/free_bounds.py`: {VELOCITY} mm/s and {ACCELERATION} mm/s^2 per axis, F6000, T = 1 ms. `free` is
`--plan free --time-limit %g` (half as long again for the zig-zags of `linuxcnc/`). *bound* holds for any motion within
the tolerance of the path, whoever plans it. The column *above* is how much longer `free` takes than
its bound. A better plan or a better bound may show that much. Times in s.

The last three programs are made by `accdec generate` at F6000 and P0.05. The computer had other work. So programs of
many blocks may end above what `free` finds in that time on idle cores.

Corners, zig-zags, long legs and the spiral are within 4 %% of their bound. On other fine chords the bound counts the
acceleration that the axes need to go back and forth, and no jerk limit. There the gap is mostly the bound's.

| program | jerk, mm/s^3 | profiles or fixed | free | bound | above, %% |
|---|--:|--:|--:|--:|--:|
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("accdec", nargs="?", default=str(SOURCE / "build/release/apps/accdec"))
    parser.add_argument("--seconds", type=float, default=100)
    parser.add_argument("--out", type=pathlib.Path, default=SOURCE / "results/program/free.md")
    options = parser.parse_args()
    text = HEAD % options.seconds
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for program, file in cases(options.accdec, folder):
            # The bound of a hundred different corners takes more of the time limit.
            seconds = options.seconds * (1.5 if "zigzag-p" in program else 1)
            for jerk in (0, JERK):
                text += row(program, jerk, *planned(options.accdec, folder, file, jerk, seconds)) + "\n"
                print(text.splitlines()[-1], flush=True)
    options.out.write_text(text)


if __name__ == "__main__":
    main()
