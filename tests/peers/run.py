#!/usr/bin/python3
"""LinuxCNC and accdec side by side: the same programs at the same limits, both motions judged by one checker. See
README.md."""
import argparse
import concurrent.futures
import csv
import json
import os
import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
VELOCITY = 200  # mm/s of every axis
JERK = 50000  # mm/s^3, in the rows with a jerk limit
SHIPPED = ["pocket", "zigzag", "trochoid", "engraving", "raster", "star"]
GENERATED = {"hilbert": 1000, "relief": 3000, "spiral": 1000}  # kind: blocks
TOLERANCES = ["g61.1", "p0.01", "p0.05", "p0.1", "p0.5"]
PLANS = ["fixed", "profiles"]


def arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--install", action="store_true", help="install linuxcnc-uspace and gcc with apt-get first (root)"
    )
    parser.add_argument("--accdec", default=str(ROOT / "build/release/apps/accdec"), help="the program to compare")
    parser.add_argument("--out", default=str(ROOT / "results/program"), help="folder for peers.csv and peers.md")
    parser.add_argument(
        "--only", nargs="*", help="only programs whose name contains one of these words; the rows of others stay"
    )
    parser.add_argument(
        "--only-accdec", action="store_true", help="LinuxCNC's rows stay as peers.csv has them; only its interpreter runs"
    )
    parser.add_argument("--plans", nargs="*", default=PLANS, choices=PLANS)
    parser.add_argument(
        "--warp", type=int, default=5, help="LinuxCNC's servo thread runs so many times faster than the clock"
    )
    parser.add_argument("--jobs", type=int, default=2, help="programs at a time")
    return parser.parse_args()


def install():
    subprocess.check_call(["apt-get", "update", "-qq"])
    subprocess.check_call(
        ["apt-get", "install", "-y", "-qq", "--no-install-recommends", "linuxcnc-uspace", "gcc", "libc6-dev"],
        env={**os.environ, "DEBIAN_FRONTEND": "noninteractive"},
    )


def fair(program, folder):
    """A copy with G61.1 before its last move: LinuxCNC would else keep half its acceleration there for a blend that
    never comes."""
    lines = pathlib.Path(program).read_text().splitlines()
    moves = [i for i, line in enumerate(lines) if any(c in line.split("(")[0].upper() for c in "XYZ")]
    if not any("G61.1" in line.upper() for line in lines):
        lines.insert(moves[-1], "G61.1")
    copy = folder / pathlib.Path(program).name
    copy.write_text("\n".join(lines) + "\n")
    return copy


def cases(accdec, folder):
    """name, program, acceleration in mm/s^2, whether also with a jerk limit"""
    found = []
    problems = ROOT / "problems/program"
    for name in SHIPPED:
        found.append((name, problems / (name + ".ngc"), 1000, True))
    for path in ("corner", "zigzag"):
        for tolerance in TOLERANCES:
            for acceleration in (500, 1000, 5000):
                name = "linuxcnc/%s-%s" % (path, tolerance)
                found.append((name, problems / (name + ".ngc"), acceleration, acceleration == 1000))
    for kind, blocks in GENERATED.items():
        program = folder / (kind + "-generated.ngc")
        subprocess.check_call(
            [
                accdec,
                "generate",
                kind,
                "--blocks",
                str(blocks),
                "--feed",
                "6000",
                "--tolerance",
                "0.05",
                "--out",
                str(program),
            ]
        )
        found.append((kind, program, 1000, True))
    return found


def task_file(folder, acceleration, jerk):
    path = folder / ("limits-%d-%s.toml" % (acceleration, jerk or "none"))
    path.write_text(
        "sample_period_ms = 1.0\n[[axis]]\nvelocity_max_mm_s = %d\nacceleration_max_mm_s2 = %d\n%s"
        % (VELOCITY, acceleration, "jerk_max_mm_s3 = %d\n" % jerk if jerk else "")
    )
    return path


def samples_of_accdec(path):
    """Columns x_mm, y_mm, z_mm of a sample file; an axis that never moves is not in it."""
    import numpy as np

    with open(path) as file:
        names = file.readline().strip().split(",")
    table = np.loadtxt(
        path,
        delimiter=",",
        skiprows=1,
        usecols=[names.index(a) for a in ("x_mm", "y_mm", "z_mm") if a in names],
        ndmin=2,
    )
    motion, column = np.zeros((len(table), 3)), 0
    for i, axis in enumerate("xyz"):
        if axis + "_mm" in names:
            motion[:, i] = table[:, column]
            column += 1
    return motion


def compare(case, options, folder):
    """All rows of one program."""
    import numpy as np
    import check

    name, program, acceleration, with_jerk = case
    folder = pathlib.Path(tempfile.mkdtemp(dir=folder))
    program = fair(program, folder)
    points, tolerances, kinds = check.load_points(
        subprocess.check_output([sys.executable, str(HERE / "moves.py"), str(program)], text=True)
    )
    rows = []

    def judge(planner, motion, jerk, bounds=None):
        row = {"program": name, "acceleration_max": acceleration, "jerk_max": jerk or "", "planner": planner}
        row.update(check.check(motion, points, tolerances, kinds, acceleration, VELOCITY, jerk))
        row.update(bounds or {})
        rows.append(row)
        limit = "jerk %g" % jerk if jerk else "no jerk limit"
        print("%s, %d mm/s^2, %s: %s %.3f s" % (name, acceleration, limit, planner, row["time_s"]), flush=True)

    if options.only_accdec:
        rows += [row for row in options.earlier if (row["program"], row["acceleration_max"]) == (name, acceleration)]
    else:
        out = folder / "linuxcnc.csv"
        subprocess.check_call(
            [str(HERE / "linuxcnc/run"), str(program), str(out), str(acceleration), str(VELOCITY)],
            env={**os.environ, "PEER_WARP": str(options.warp)},
        )
        motion = np.loadtxt(out, delimiter=",", skiprows=1)
        judge("LinuxCNC", motion, None)
        if with_jerk:
            judge("LinuxCNC", motion, JERK)
    for jerk in (None, JERK) if with_jerk else (None,):
        for plan in options.plans:
            samples, report = folder / "samples.csv", folder / "report.json"
            report.unlink(missing_ok=True)
            done = subprocess.run(
                [
                    options.accdec,
                    "program",
                    str(program),
                    "--task",
                    str(task_file(folder, acceleration, jerk)),
                    "--plan",
                    plan,
                    "--time-limit",
                    "60",
                    "--samples",
                    str(samples),
                    "--json",
                    str(report),
                ],
                stdout=subprocess.DEVNULL,
                stderr=subprocess.PIPE,
                text=True,
            )
            if done.returncode != 0:
                rows.append(
                    {
                        "program": name,
                        "acceleration_max": acceleration,
                        "jerk_max": jerk or "",
                        "planner": "accdec " + plan,
                        "breaks": "no plan: "
                        + (done.stderr.strip().splitlines() or ["exit code %d" % done.returncode])[-1],
                    }
                )
                continue
            document = json.loads(report.read_text())
            bounds = {
                key: document[key] for key in ("lower_bound_s", "corner_bound_s") if document.get(key) is not None
            }
            judge("accdec " + plan, samples_of_accdec(samples), jerk, bounds)
    return rows


COLUMNS = (
    ["program", "acceleration_max", "jerk_max", "planner", "time_s", "error_max_mm", "excess_max_mm"]
    + [what + "_" + axis for what in ("velocity", "acceleration", "jerk") for axis in "xyz"]
    + ["corner_bound_s", "lower_bound_s", "breaks"]
)


def write_csv(path, rows):
    with open(path, "w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, extrasaction="ignore", lineterminator="\n")
        writer.writeheader()
        for row in rows:
            writer.writerow({k: "%.6g" % v if isinstance(v, float) else v for k, v in row.items()})


def earlier_rows(path, cases):
    """Rows of these programs and accelerations that an earlier run wrote."""
    if not path.exists():
        return []
    rows = []
    with open(path, newline="") as file:
        for row in csv.DictReader(file):
            if (row["program"], int(row["acceleration_max"])) not in cases:
                continue
            words = ("program", "planner", "breaks")
            numbers = {k: float(v) for k, v in row.items() if k not in words and v != ""}
            rows.append(
                {
                    "jerk_max": "",
                    **{k: row[k] for k in words},
                    **numbers,
                    "acceleration_max": int(row["acceleration_max"]),
                }
            )
            if row["jerk_max"]:
                rows[-1]["jerk_max"] = int(row["jerk_max"])
    return rows


def summary(rows):
    """Who is faster how often without a jerk limit, from the rows themselves; without their rows, nothing."""
    text = []
    for plan in ("profiles", "fixed"):
        ratios = {}
        for row in rows:
            same = [
                r
                for r in rows
                if r["planner"] == "LinuxCNC"
                and (r["program"], r["acceleration_max"], r["jerk_max"])
                == (row["program"], row["acceleration_max"], "")
            ]
            if row["jerk_max"] == "" and row["planner"] == "accdec " + plan and "time_s" in row and same:
                ratios[row["program"], row["acceleration_max"]] = row["time_s"] / same[0]["time_s"]
        if not ratios:
            continue
        slower = [
            "%s at %d mm/s^2 (%+.1f %%)" % (*key, 100 * (ratio - 1)) for key, ratio in ratios.items() if ratio >= 1
        ]
        text += [
            "Without a jerk limit `%s` is faster than LinuxCNC in %d of %d cases%s."
            % (plan, len(ratios) - len(slower), len(ratios), "; slower in " + ", ".join(slower) if slower else ""),
            "",
        ]
    return text


def write_table(path, rows, plans):
    text = [
        "# Beside LinuxCNC",
        "",
        "Written by `tests/peers/run.py`. LinuxCNC 2.9 (Debian) in simulation and accdec ran the same programs at the same limits, %d mm/s per axis,"
        % VELOCITY,
        "with one position per millisecond. Times in s run from the first to the last change of position. `tests/peers/check.py` judged every motion",
        "from its positions only. In brackets: the largest distance of a programmed point from the motion, um. An asterisk marks a motion that breaks a",
        "limit or a tolerance; peers.csv says which, and gives the peak acceleration and jerk of every axis. LinuxCNC 2.9 has no jerk limit, so its rows",
        "under a jerk limit break it.",
        "",
        "The bound holds for sums of monotone legs, as filters and profiles make them. It is the larger of two bounds: linear programs for the corners of",
        "straight legs, with the jerk limit, and way over feed, without it. It is one period less than `accdec program` prints, as times are counted here.",
        "Free motions may be faster. With every sample free, linear programs at 1000 mm/s^2 find 1.129 s for linuxcnc/corner-p0.5, where the bound is 1.143 s.",
        "For corner-p0.05 they find 1.176 s, where it is 1.179 s. `accdec program` also prints a bound for any motion within the tolerance: 1.126 and 1.173 s there. On",
        "linuxcnc/zigzag-p0.5 it is 12.96 s, where a free motion takes 14.239 s. Both bounds are weak on curves of fine chords, where one corner begins before",
        "the last has ended.",
        "",
        "One filter for a whole program is as long as its corners need, and shrinks the radius of every curve by v^2 s^2/(2 R). On the spiral this costs more",
        "time than LinuxCNC loses, which leaves its tolerance there.",
        "",
    ] + summary(rows)
    for jerk in ("", JERK):
        text += [
            "## " + ("Jerk at most %g mm/s^3" % jerk if jerk else "No jerk limit"),
            "",
            "| program | mm/s^2 | LinuxCNC | "
            + " | ".join("accdec " + p for p in plans)
            + " | profiles/LinuxCNC | bound | of profiles, % |",
            "|---|--:|--:|" + "--:|" * (len(plans) + 3),
        ]
        keys = dict.fromkeys((r["program"], r["acceleration_max"]) for r in rows if r["jerk_max"] == jerk)
        for name, acceleration in keys:
            mine = {
                r["planner"]: r
                for r in rows
                if (r["program"], r["acceleration_max"], r["jerk_max"]) == (name, acceleration, jerk)
            }

            def cell(planner):
                row = mine.get(planner, {})
                if "time_s" not in row:
                    return "-"
                return "%.3f (%.1f)%s" % (row["time_s"], 1e3 * row["error_max_mm"], "*" if row["breaks"] else "")

            ours, theirs = mine.get("accdec profiles", {}), mine["LinuxCNC"]
            ratio = "%.3f" % (ours["time_s"] / theirs["time_s"]) if "time_s" in ours else "-"
            bound = max([ours[key] for key in ("corner_bound_s", "lower_bound_s") if key in ours], default=None)
            bound = bound - 1e-3 if bound else None
            bounds = "%.3f | %.1f" % (bound, 100 * bound / ours["time_s"]) if bound else "- | -"
            text.append(
                "| %s | %d | %s | %s | %s | %s |"
                % (name, acceleration, cell("LinuxCNC"), " | ".join(cell("accdec " + p) for p in plans), ratio, bounds)
            )
        text.append("")
    pathlib.Path(path).write_text("\n".join(text))


def main():
    options = arguments()
    if options.install:
        install()
    for needed in ("/usr/bin/rs274" if options.only_accdec else "/usr/bin/linuxcnc", options.accdec):
        if not os.path.exists(needed):
            sys.exit(needed + " is missing" + ("; run with --install" if needed != options.accdec else ""))
    sys.path.insert(0, str(HERE))
    sys.dont_write_bytecode = True
    out = pathlib.Path(options.out)
    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        work = cases(options.accdec, pathlib.Path(folder))
        chosen = [c for c in work if not options.only or any(word in c[0] for word in options.only)]
        rows = earlier_rows(out / "peers.csv", [(c[0], c[2]) for c in work if c not in chosen])
        # Before the table is written again, which begins with the first program.
        earlier = earlier_rows(out / "peers.csv", [(c[0], c[2]) for c in chosen]) if options.only_accdec else []
        options.earlier = [row for row in earlier if row["planner"] == "LinuxCNC"]
        order = {(c[0], c[2]): i for i, c in enumerate(work)}
        with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
            for result in pool.map(lambda case: compare(case, options, folder), chosen):
                rows = sorted(rows + result, key=lambda row: order[row["program"], row["acceleration_max"]])
                write_csv(out / "peers.csv", rows)
                write_table(out / "peers.md", rows, options.plans)
    print("wrote", out / "peers.csv", "and", out / "peers.md")


if __name__ == "__main__":
    main()
