#!/usr/bin/env python3
"""Writes random tasks of several corners that share one filter, for measuring how far proofs reach.

  many_corners.py FOLDER [--corners 2,3,4,6,8,12] [--kinds ...] [--seeds 0-1]

One file a task, named KIND-CORNERS-SEED.toml; the same arguments write the same bytes.
"""
import argparse
import math
import pathlib
import random

KINDS = ("jerk", "force", "vibration", "power", "unequal")


def axes(kind):
    if kind == "force":
        return "[[axis]]\nmass_kg = 34\ndamping_N_s_m = 400\nforce_max_N = 250\n"
    if kind == "power":
        return "[[axis]]\nmass_kg = 34\ndamping_N_s_m = 60\nforce_max_N = 300\npower_max_W = 30\n"
    both = "[[axis]]\nacceleration_max_mm_s2 = 6000\njerk_max_mm_s3 = 600000\n" \
           "[[axis]]\nacceleration_max_mm_s2 = 5000\njerk_max_mm_s3 = 500000\n"
    if kind == "vibration":
        both += "[[mode]]\nfrequency_Hz = [30, 34]\nresidual_max = 0.1\n"
    return both


def corner(dice, kind):
    feed = 60 * dice.randint(40, 130)
    lines = ["[[corner]]", f"angle_deg = {dice.randint(35, 150)}", f"heading_deg = {dice.choice([0, 30, 45, 90])}",
             f"feed_in_mm_min = {feed}"]
    if kind == "unequal":
        lines.append(f"feed_out_mm_min = {60 * dice.randint(40, 130)}")
    else:
        lines.append(f"feed_out_mm_min = {feed}")
    lines.append(f"error_max_um = {round(math.exp(dice.uniform(math.log(10), math.log(150))), 3)}")
    lines.append(f"weight = {dice.randint(1, 12)}")
    return "\n".join(lines) + "\n"


def task(kind, corners, seed):
    dice = random.Random(f"{kind} {corners} {seed}")
    head = f'title = "{corners} random corners, {kind}, seed {seed}"\nsample_period_ms = 1.0\n'
    return head + axes(kind) + "".join(corner(dice, kind) for _ in range(corners))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--corners", default="2,3,4,6,8,12")
    parser.add_argument("--kinds", default=",".join(KINDS))
    parser.add_argument("--seeds", default="0-1", help="first-last")
    given = parser.parse_args()
    first, last = (int(x) for x in given.seeds.split("-"))
    given.folder.mkdir(parents=True, exist_ok=True)
    for kind in given.kinds.split(","):
        for corners in given.corners.split(","):
            for seed in range(first, last + 1):
                (given.folder / f"{kind}-{corners}-{seed}.toml").write_text(task(kind, int(corners), seed))


if __name__ == "__main__":
    main()
