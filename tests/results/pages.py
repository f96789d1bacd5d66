"""What is recomputed of every page under results/. Each check is cheap and gives the same on any machine."""
import json
import re
import subprocess
import sys

import families
import program_pages
import shapers
from page import ms

CHECKS = {**shapers.CHECKS, **program_pages.CHECKS}


def check_of(name):
    def add(function):
        CHECKS[name] = function
        return function

    return add


def best_of(page, task, *families):
    """The optimum of a task and the best of some families, ms, by a study of one point."""
    row = page.study(f'task = "{task}"\ncompute = ["optimum", {", ".join(json.dumps(f) for f in families)}]\n'
                     '[[vary]]\nkey = "sample_period_ms"\nvalues = [1]\n')[0]
    return [f"{float(row[f'{name}.cycle_time_ms']):g}" for name in ("optimum", *families)]


@check_of("README.md")
def readme(page):
    table = page.rows("task", "N", "delays")
    for task, file in (("acceleration-jerk", "corner/acceleration-jerk"), ("sharp-angle", "corner/sharp-angle"),
                       ("force-friction", "corner/force-friction"), ("vibration-band", "corner/vibration-band"),
                       ("friction-machine", "study/friction-machine"), ("light-machine", "study/light-machine")):
        row = page.row(table, "task", task)
        family, time = re.match(r"([a-z-]+) ([0-9.]+)", row["best family"]).groups()
        optimum, best = best_of(page, f"../{file}.toml", family)
        page.same(f"{task}, optimum", row["cycle time"], optimum)
        page.same(f"{task}, best {family}", time, best)
    printed, order, delay = page.find(r"It takes ([0-9.]+) s with N = (\d+) and d = (\d+)\.")
    plan = page.result("program", page.source / "problems/program/legs.ngc", "--task",
                       page.source / "problems/program/legs.toml")
    page.same("legs.ngc", printed, f"{plan['cycle_time_s']:.3f}")
    page.same("legs.ngc, order", order, str(plan["filter"]["order"]))
    sentences_of_families(page)


def sentences_of_families(page):
    """The sentences to remember say what the table of families does."""

    def line(*names):
        return families.line(page.source / "results/study", *names)

    near, lost, corners, most = page.find(r"come within (\d+) ms of the proved optimum at 100 random corners along the "
                                          r"axes\. At any heading they lose more than 3 ms at (\d+) of (\d+), at most "
                                          r"([0-9.]+) %")
    along, anywhere = line("along-axes", "all", "two averages"), line("any-corner", "all", "two averages")
    page.same("two averages along the axes", near, f"{along['most_ms']:.0f}")
    page.same("two averages anywhere", (lost, corners, most),
              (str(anywhere["far"]), str(anywhere["corners"]), f"{anywhere['most']:.1f}"))
    held, corners = page.find(r"within 3 ms of the optimum at (\d+) of (\d+) random corners")
    free = line("any-corner-friction", "jerk free", "exponential")
    page.same("exponential with friction", (held, corners), (str(free["corners"] - free["far"]), str(free["corners"])))
    loose, quiet = page.find(r"([0-9.]+) % longer in the median down to a residual of 0\.2, ([0-9.]+) % below 0\.05")
    page.same("vibration", (loose, quiet), tuple(
        f"{line('any-corner-vibration', words, 'averages (ZV)')['median']:.1f}"
        for words in ("residual 0.2 to 1", "residual 0.01 to 0.05")))
    friction, power = page.find(r"([0-9.]+) and ([0-9.]+) % in the median")
    page.same("friction and power", (friction, power), tuple(f"{line(*names, 'best')['median']:.1f}" for names in (
        ("any-corner-friction", "jerk limited, friction 40 to 74 %"),
        ("any-corner-power", "power at most 60 % of F v"))))


@check_of("optima/optima.md")
def optima(page):
    table = page.rows("row", "task", "status")
    for task, file in (("exact-stop", "corner/exact-stop"), ("minimum-speed", "corner/minimum-speed"),
                       ("six-axes", "corner/six-axes"), ("power", "corner/power"),
                       ("three-corners", "machine/three-corners")):
        row, result = page.row(table, "task", task), page.design(f"{file}.toml")
        page.same(f"{task}, optimum", row["cycle ms"], ms(result["cycle_time_s"]))
        page.same(f"{task}, bound", row["bound ms"], ms(result["lower_bound_s"]))
    # The csv beside it is of the same run.
    fresh = {row["task"]: row for row in page.csv("optima.csv")}
    for row in table:
        page.same(f"{row['task']}, optima.csv", row["cycle ms"], fresh[row["task"]]["cycle_time_ms"])


@check_of("readme/README.md")
def picture(page):
    (task,) = page.find(r"accdec design (problems/\S+)")
    result = page.design(page.source / task)
    drawn = (page.path.parent / "corner.svg").read_text()
    (order,) = re.search(r"filter taps, order (\d+)", drawn).groups()
    page.same("order drawn in corner.svg", order, str(result["filter"]["order"]))


@check_of("exact/many_corners.md")
def many_corners(page):
    tasks = page.folder / "tasks"
    subprocess.run([sys.executable, "-B", page.source / "tests/bench/many_corners.py", tasks, "--corners", "2"],
                   check=True)
    recorded = {f"{row['kind']}-{row['corners']}-{row['seed']}": row for row in page.csv("many_corners.csv")}
    results = {task.stem: page.design(task) for task in sorted(tasks.glob("*.toml"))}
    for name, result in results.items():
        page.same(f"{name}, cycle time", recorded[name]["cycle_ms"], ms(result["cycle_time_s"]))
    row = page.row(page.rows("corners", "proved within 60 s"), "corners", "2")
    page.same("2 corners, proved", row["proved within 60 s"], f"{len(results)} of {len(results)}")


@check_of("exact/certificates.md")
def certificates(page):
    table = page.rows("task", "proof ms")
    for task in ("acceleration-jerk", "flat-angle", "force-friction", "sharp-angle", "vibration-band"):
        result = page.folder / "proof.json"
        page.run("design", page.source / f"problems/corner/{task}.toml", "--quiet", "--json", result)
        printed = page.row(table, "task", task)["result kB"]
        # Times and versions in a result have more or fewer digits from run to run.
        page.same(f"{task}, kB of its result", printed, 1e-3 * result.stat().st_size, within=0.6)


@check_of("comparison/findings.md")
def comparison(page):
    whole, taps, delays = page.find(r"`design, three corners` is (\d+) samples "
                                    r"\((\d+) of the filter, (\d+) of delays\)")
    task = (page.source / "problems/machine/three-corners.toml").read_text()
    result = page.design(f"{task}\n[design]\norder_min = {int(taps) - 1}\norder_max = {int(taps) - 1}\n")
    page.same("three corners at the suite's order", whole, ms(result["cycle_time_s"]))
    fresh = sum(c["weight"] * c["delay_samples"] for c in weighted(result))
    page.same("three corners, delays", delays, f"{fresh:g}")


@check_of("comparison/benchmark.md")
def benchmark(page):
    """One hypercube by itself: its problems do not depend on the others."""
    count, total = page.find(r"The optima of the (\d+) problems `jerk` are (\d+) samples in all")
    blocks = (page.source / "problems/suite/benchmark-500.toml").read_text().split("[[hypercube]]\n")
    jerk = next(block for block in blocks if block.startswith('name = "jerk"'))
    folder = (page.source / "problems/suite").resolve()
    jerk = jerk.replace('task = "', f'task = "{folder}/')
    (page.folder / "suite.toml").write_text(f"{blocks[0]}\n[[hypercube]]\n{jerk}")
    page.run("compare", "suite.toml", "--out", "out", "--solvers", "exact", "-q")
    lines = [json.loads(line) for line in (page.folder / "out/raw.jsonl").read_text().splitlines()]
    optima = [line["upper"] for line in lines if line["record"] == "problem" and line["proof"] == "proved"]
    page.same("problems jerk", count, str(len(optima)))
    page.same("their optima", total, f"{sum(optima):g}")


def weighted(result):
    """The corners of a result with their weights in the task."""
    corners = result["task"]["corner"]
    return [dict(found, weight=asked.get("weight", 1)) for found, asked in zip(result["corners"], corners)]


@check_of("paper/report.md")
def paper(page):
    page.run("paper", "--out", page.folder / "paper")
    fresh = (page.folder / "paper/report.md").read_text().splitlines()
    page.same("lines", len(page.text.splitlines()), len(fresh))
    for number, (printed, computed) in enumerate(zip(page.text.splitlines(), fresh), 1):
        page.same(f"line {number}", printed, computed)


@check_of("python/peers.md")
def python(page):
    limits = {"acceleration": "", "acceleration and jerk": "jerk_max_mm_s3 = 500000\n"}
    rows = page.rows("corner", "way")
    for corner, jerk in limits.items():
        result = page.design("sample_period_ms = 1.0\n[[axis]]\nacceleration_max_mm_s2 = 6000\n" + jerk +
                             "[[corner]]\nangle_deg = 95\nfeed_in_mm_min = 6000\nerror_max_um = 50\n")
        printed = next(row["found"] for row in rows if row["corner"] == corner and "accdec" in row["way"])
        page.same(corner, printed, f"{ms(result['corner_time_s'])} ms")


@check_of("study/growth.md")
def growth(page):
    task = re.search(r'TASK = """(.*?)"""', (page.source / "tests/bench/study-growth").read_text(), re.S).group(1)
    (page.folder / "task.toml").write_text(task)
    (page.folder / "plain.toml").write_text(
        'task = "task.toml"\ncompute = ["given"]\n'
        '[[vary]]\nname = "angle_deg"\nkey = "corner.A.angle_deg"\nrange = { from = 20, to = 170, count = 10 }\n'
        '[[vary]]\nname = "feed"\nkey = "corner.A.feed_in_mm_min"\nrange = { from = 1000, to = 9000, count = 10 }\n'
        '[[vary]]\nname = "period"\nkey = "sample_period_ms"\nrange = { from = 0.5, to = 1, count = 10 }\n')
    for shard in ("1/2", "2/2"):
        page.run("study", "plain.toml", "--out", "parts", "--shard", shard, "--workers", "1", "--quiet")
    size = sum(journal.stat().st_size for journal in (page.folder / "parts").glob("*.journal"))
    row = page.row(page.rows("layer", "10^3"), "layer", "journal on the disk, bytes")
    # A point's time has more or fewer digits from run to run.
    page.same("journal, bytes a point", row["10^3"], size / 1000, within=0.02 * size / 1000)


VARIED = {"heading_deg": "corner.A.heading_deg", "angle_deg": "corner.A.angle_deg",
          "feed_in_mm_min": "corner.A.feed_in_mm_min", "feed_out_mm_min": "corner.A.feed_out_mm_min",
          "tolerance_um": "corner.A.error_max_um", "acceleration_max_mm_s2": "axis.*.acceleration_max_mm_s2",
          "jerk_max_mm_s3": "axis.*.jerk_max_mm_s3", "damping_N_s_m": "axis.*.damping_N_s_m",
          "power_max_W": "axis.*.power_max_W", "residual_max": "mode.0.residual_max"}


def point_again(page, study, row, *computations):
    """One row of a Latin hypercube computed again."""
    shipped = (page.source / f"problems/study/{study}.toml").read_text()
    (task,) = re.search(r'^task = "(.*)"', shipped, re.M).groups()
    vary = "".join(f'[[vary]]\nname = "{name}"\nkey = "{key}"\nvalues = [{row[name]}]\n'
                   for name, key in VARIED.items() if name in row)
    (fresh,) = page.study(f'task = "{task}"\ncompute = {json.dumps(computations)}\n{vary}')
    for name in computations:
        column = f"{name}.cycle_time_ms"
        page.same(f"{study}, point {row['index']}, {name}", row[column], fresh[column])


@check_of("study/findings.md")
def study_findings(page):
    folder = page.path.parent
    page.same("the table of families", (families.table(folder) in page.text), True)
    for study, computations in (("along-axes", ("optimum", "trapezoid")), ("any-corner", ("optimum", "trapezoid")),
                                ("any-corner-friction", ("optimum", "exponential")), ("any-corner-power", ("optimum",)),
                                ("any-corner-vibration", ("optimum", "trapezoid-zv"))):
        rows = families.rows_of(folder, study)
        short = [row for row in rows if 20 <= families.time(row, "optimum") <= 60]
        for row in short[:2]:
            point_again(page, study, row, *computations)
    loose, tight = page.find(r"\(50 um: from (\d+) to (\d+) ms\)")
    for jerk, printed in ((1e7, loose), (1e6, tight)):
        row = next(r for r in page.csv("price-of-smoothness/rows.csv")
                   if [float(r[key]) for key in ("heading_deg", "angle_deg", "tolerance_um")] == [0, 95, 50]
                   and abs(float(r["jerk_max_mm_s3"]) / jerk - 1) < 1e-9)
        page.same(f"the price of smoothness at {jerk:g} mm/s^3", printed, f"{families.time(row, 'optimum'):g}")
        point_again(page, "price-of-smoothness", row, "optimum", "trapezoid")
    along, across, there, turned = page.find(r"The optimum is (\d+) ms at heading 0 and (\d+) at 20; "
                                             r"two averages take (\d+) and (\d+)\.")
    rows = page.study('task = "../corner/acceleration-jerk.toml"\ncompute = ["optimum", "trapezoid"]\n'
                      '[[vary]]\nname = "heading"\nkey = "corner.A.heading_deg"\nvalues = [0, 20]\n')
    for row, optimum, averages in zip(rows, (along, across), (there, turned)):
        page.same(f"heading {row['heading']}, optimum", optimum, f"{families.time(row, 'optimum'):g}")
        page.same(f"heading {row['heading']}, two averages", averages, f"{families.time(row, 'trapezoid'):g}")
