#!/usr/bin/python3
"""Replays emitted programs at overridden feeds: tests/program/override_replay.py ACCDEC

A control reads what --emit wrote: feeds of blocks, path modes, dwells, and the taps of the JSON. It commands every feed
move at so many times its F, holds the command back for the dwells in whole samples, and filters it. Every vertex's
distance to that motion is compared with the result's `feed_overrides`. Nothing here is the program's own code.
"""
import json
import math
import pathlib
import random
import re
import subprocess
import sys
import tempfile

T = 1e-3
RAPID = 200.0  # mm/s, every axis
SMOOTH = math.radians(20.0)  # joints that turn less are passed without a sample in them
TASK = f"""sample_period_ms = 1.0
[[axis]]
velocity_max_mm_s = {RAPID}
acceleration_max_mm_s2 = 1000
"""


class Block:
    def __init__(self, start, end, speed, rapid, line):
        self.start, self.end, self.speed, self.rapid, self.line = start, end, speed, rapid, line
        self.stops, self.tolerance, self.rest = True, None, 0


def read(text):
    """The blocks of an emitted program, with the rest of the command after each in samples."""
    blocks, at, feed, mode = [], [0.0, 0.0, 0.0], None, "G61"
    for number, line in enumerate(text.splitlines(), 1):
        words = re.findall(r"([A-Z])\s*(-?[0-9.]+)", re.sub(r"\([^)]*\)", "", line))
        codes = {"G" + value for letter, value in words if letter == "G"}
        values = dict((letter, float(value)) for letter, value in words if letter != "G")
        if "G4" in codes:
            blocks[-1].rest += math.ceil(values["P"] / T - 1e-6)
            continue
        for code in codes & {"G61", "G61.1", "G64"}:
            mode, tolerance = code, values.get("P", None)
        feed = values.get("F", feed)
        end = [values.get(axis, old) for axis, old in zip("XYZ", at)]
        if end == at:
            continue
        way = math.dist(at, end)
        rapid = "G0" in codes
        speed = way / max(abs(b - a) / RAPID for a, b in zip(at, end)) if rapid else feed / 60.0
        blocks.append(Block(at, end, speed, rapid, number))
        blocks[-1].stops = mode == "G61.1"
        blocks[-1].tolerance = tolerance if mode == "G64" else 0.0
        at = end
    return blocks


def turn(a, b):
    """Angle in rad between two blocks."""
    u, v = [[e - s for s, e in zip(x.start, x.end)] for x in (a, b)]
    cosine = sum(p * q for p, q in zip(u, v)) / (math.hypot(*u) * math.hypot(*v))
    return math.acos(max(-1.0, min(1.0, cosine)))


def command(blocks, factor, order):
    """Positions every sample, and for every joint the time in samples when the command is there. Moves between two
    corners, rests or delays take a whole number of samples, all a little slower."""
    positions, reached, first = [blocks[0].start], [], 0
    while first < len(blocks):
        last = first
        while last + 1 < len(blocks) and not blocks[last].stops and blocks[last].rest == 0 \
                and turn(blocks[last], blocks[last + 1]) < SMOOTH:
            last += 1
        times = [math.dist(b.start, b.end) / b.speed / (1.0 if b.rapid else factor) / T for b in blocks[first:last + 1]]
        total = sum(times)
        count = max(1, math.ceil(total - 1e-6))
        scale = count / total
        begun, i, base = 0.0, 0, len(positions) - 1
        for k in range(1, count + 1):
            while i < len(times) - 1 and begun + times[i] * scale <= k:
                begun += times[i] * scale
                reached.append(base + begun)
                i += 1
            part = 1.0 if k == count else min(1.0, (k - begun) / (times[i] * scale))
            block = blocks[first + i]
            positions.append([s + part * (e - s) for s, e in zip(block.start, block.end)])
        for _ in range(i, len(times)):
            reached.append(base + count)
        rest = blocks[last].rest + (order if blocks[last].stops else 0)
        positions.extend([blocks[last].end] * rest)
        first = last + 1
    return positions, reached


def filtered(positions, taps):
    """The positions through the filter; it rests before and after."""
    padded = [positions[0]] * (len(taps) - 1) + positions + [positions[-1]] * len(taps)
    used = [(i, tap) for i, tap in enumerate(taps) if tap != 0.0]
    return [[sum(tap * padded[k - i][a] for i, tap in used) for a in range(3)]
            for k in range(len(taps) - 1, len(padded))]


def to_segment(point, a, b):
    d = [q - p for p, q in zip(a, b)]
    whole = sum(x * x for x in d)
    part = max(0.0, min(1.0, sum((c - p) * x for c, p, x in zip(point, a, d)) / whole)) if whole > 0.0 else 0.0
    return math.dist(point, [p + part * x for p, x in zip(a, d)])


def vertex_errors(blocks, factor, taps):
    """Of every joint with a tolerance: its error in um at samples where a corner or a rest is, else of the path."""
    order = max(i for i, tap in enumerate(taps) if tap) - min(i for i, tap in enumerate(taps) if tap)
    positions, reached = command(blocks, factor, order)
    motion = filtered(positions, taps)
    errors = []
    for b in range(len(blocks) - 1):
        corner = blocks[b].end
        angle = turn(blocks[b], blocks[b + 1])
        if blocks[b].stops or angle < 1e-7:
            continue
        begin = math.floor(reached[b])
        end = min(len(motion) - 1, begin + blocks[b].rest + len(taps) + 1)
        distance = min(math.dist(corner, motion[k]) for k in range(begin, end + 1))
        if angle < SMOOTH:
            distance = min(to_segment(corner, motion[k], motion[k + 1]) for k in range(begin, end))
        errors.append((1e3 * distance, blocks[b].line))
    return errors


def planned(accdec, folder, program, task, *options):
    (folder / "p.ngc").write_text(program)
    (folder / "task.toml").write_text(task)
    run = subprocess.run([accdec, "program", "p.ngc", "--task", "task.toml", "--json", "r.json", "--emit", "e.ngc",
                          "--quiet", *options], cwd=folder, capture_output=True, text=True)
    if run.returncode != 0:
        raise SystemExit(f"{program}\n{run.stdout}{run.stderr}")
    return json.loads((folder / "r.json").read_text()), (folder / "e.ngc").read_text()


def random_program(seed):
    """Short and long moves, close corners, arcs, rapid moves and stops."""
    draw = random.Random(seed)
    lines = [f"G21 G90 G64 P{draw.choice([0.01, 0.05, 0.2])} F{draw.choice([1500, 3000, 6000])}"]
    x = y = 0.0
    for _ in range(12):
        size = draw.choice([0.3, 2.0, 10.0])
        to_x, to_y = x + draw.uniform(-size, size), y + draw.uniform(-size, size)
        kind = draw.random()
        if kind < 0.2:
            radius = math.dist((x, y), (to_x, to_y)) * draw.uniform(0.6, 3.0)
            lines.append(f"G{draw.choice([2, 3])} X{to_x:.4f} Y{to_y:.4f} R{radius:.4f}")
        else:
            feed = f" F{draw.choice([1500, 6000])}" if kind > 0.7 else ""
            lines.append(f"G{0 if kind > 0.93 else 1} X{to_x:.4f} Y{to_y:.4f}" + feed)
        if draw.random() < 0.08:
            lines.append("G61.1")
        elif draw.random() < 0.1:
            lines.append("G64 P0.05")
        x, y = to_x, to_y
    return "\n".join(lines) + "\nM2\n"


def generated(accdec, folder, kind):
    subprocess.run([accdec, "generate", kind, "--blocks", "14", "--out", "g.ngc"], cwd=folder, check=True)
    return (folder / "g.ngc").read_text()


def compare(name, result, text):
    """@returns how many figures differ from those of the replay"""
    blocks, taps, wrong = read(text), result["filter"]["taps"], 0
    corners = result["corners"]
    for at in [{"percent": 100, "worst_error_m": corners["worst_error_m"]}] + result["feed_overrides"]:
        printed = 1e6 * at["worst_error_m"]
        replayed = max((error for error, _ in vertex_errors(blocks, 0.01 * at["percent"], taps)), default=0.0)
        if abs(printed - replayed) > 1e-3 + 1e-4 * replayed:
            print(f"{name}, {at['percent']} %: printed {printed:.4f} um, replayed {replayed:.4f} um")
            wrong += 1
    return wrong


def main():
    accdec, wrong = str(pathlib.Path(sys.argv[1]).resolve()), 0
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        programs = {f"random {seed}": random_program(seed) for seed in range(1, 6)}
        programs |= {kind: generated(accdec, folder, kind) for kind in ("zigzag", "pocket")}
        for count, (title, program) in enumerate(programs.items()):
            for feeds in ("keep", "choose"):
                jerk = "jerk_max_mm_s3 = 50000\n" if count % 2 else ""
                wrong += compare(f"{title}, {feeds}", *planned(accdec, folder, program, TASK + jerk, "--feeds", feeds))
    print("all figures are those of the replay" if wrong == 0 else f"{wrong} figures differ")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
