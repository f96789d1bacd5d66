#!/usr/bin/python3
"""Regenerates results/program/free.md: tests/bench/free_bounds.py [PROGRAM accdec] [--seconds S] [--out FILE]
[--only PROGRAM..]

Plan `free` beside the bound for any motion, on shipped and generated programs, with and without a jerk limit.
"""
import pathlib
import subprocess
import tempfile

import free_pages
from free_pages import SOURCE

VELOCITY, ACCELERATION, JERK = 200, 1000, 50000  # mm, s
SHIPPED = [f"linuxcnc/corner-p{p}" for p in ("0.01", "0.05", "0.5")] + \
          [f"linuxcnc/zigzag-p{p}" for p in ("0.01", "0.05", "0.5")] + ["pocket", "star", "zigzag", "raster"]
GENERATED = [("hilbert", 770), ("relief", 300), ("spiral", 800)]


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
    task = free_pages.task_file(folder, VELOCITY, ACCELERATION, jerk)
    found, bound = free_pages.planned(accdec, folder, program, task, "free", seconds)
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

Without a jerk limit all programs but raster are within 1 %% of their bound. With one, corners, zig-zags, long legs and
the spiral are within 2.5 %%, the other fine chords within 14.3 %%. There plan and bound may both be to blame.

| program | jerk, mm/s^3 | profiles or fixed | free | bound | above, %% |
|---|--:|--:|--:|--:|--:|
"""


def known_rows(page):
    """Rows of the page as it is, by program and jerk limit."""
    cells = (line.split("|") for line in page.read_text().splitlines() if line.startswith("| ") and " | " in line)
    return {(c[1].strip(), c[2].strip()): "|".join(c) for c in cells}


ONLY = ("--only", {"nargs": "+", "metavar": "PROGRAM",
                   "help": "rows of these programs, by the beginnings of their names; the others stay as they are"})


def main():
    options = free_pages.options(__doc__, "free.md", 100, [ONLY])
    known = known_rows(options.out) if options.only else {}
    text = HEAD % options.seconds
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for program, file in cases(options.accdec, folder):
            # The bound of a hundred different corners takes more of the time limit.
            seconds = options.seconds * (1.5 if "zigzag-p" in program else 1)
            for jerk in (0, JERK):
                if options.only and not program.startswith(tuple(options.only)):
                    text += known[program, str(jerk or "-")] + "\n"
                    continue
                text += row(program, jerk, *planned(options.accdec, folder, file, jerk, seconds)) + "\n"
                print(text.splitlines()[-1], flush=True)
    options.out.write_text(text)


if __name__ == "__main__":
    main()
