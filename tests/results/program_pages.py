"""What is recomputed of the pages of whole programs, results/program."""
import re
import sys


def motion_time(path):
    """From the first to the last change of position in a file of samples, s, as tests/peers judges it."""
    with open(path) as file:
        head = file.readline().strip().split(",")
        columns = [i for i, name in enumerate(head) if re.fullmatch("[xyz]_mm", name)]
        positions = [[line.split(",")[i] for i in columns] for line in file]
    changes = [i for i in range(1, len(positions)) if positions[i] != positions[i - 1]]
    return 1e-3 * (changes[-1] - changes[0] + 1)


def league(page):
    """The page is that of league.csv; accdec's motions again for some programs and limits."""
    sys.path.insert(0, str(page.source / "tests/peers"))
    import league_page
    import league_rows
    import programs

    written = league_rows.read(page.path.with_suffix(".csv"))
    page.same("the page is that of league.csv", page.text, league_page.page(written))
    times = {league_rows.key(row): row["time_s"] for row in written}
    for name, acceleration, jerk in (("linuxcnc/corner-p0.05", 1000, 0), ("linuxcnc/zigzag-g61.1", 1000, 0),
                                     ("linuxcnc/corner-p0.5", 1000, 50000)):
        program = programs.fair(page.source / f"problems/program/{name}.ngc", page.folder)
        task = programs.task_file(page.folder, acceleration, jerk)
        for plan in ("fixed", "profiles"):
            samples = page.folder / "samples.csv"
            page.run("program", program, "--task", task, "--plan", plan, "--time-limit", 60, "--samples", samples,
                     "--quiet")
            page.same(f"{name}, {acceleration} mm/s^2, jerk {jerk}, {plan}",
                      f"{times[name, acceleration, jerk, f'accdec {plan}']:.3f}", f"{motion_time(samples):.3f}")


def arcs(page):
    """References and the plan `fixed` again, for two paths without a jerk limit."""
    sys.path.insert(0, str(page.source / "tests/bench"))
    import arcs as script

    cases = {name: (text, pieces) for name, text, pieces in script.cases()}
    for name in ("full turn, R5", "line, quarter R10, line"):
        text, pieces = cases[name]
        row = page.row(page.rows("path", "least time", "fixed"), "path", name)
        page.same(f"{name}, least time", row["least time"], f"{script.least_time(pieces):.3f}")
        program, task = script.files(page.folder, text, jerk=False)
        plan = page.result("program", program, "--task", task, "--plan", "fixed")
        page.same(f"{name}, fixed", row["fixed"], f"{plan['cycle_time_s']:.3f}")


def free(page):
    """Plan `free` and its bound again, for two corners."""
    sys.path.insert(0, str(page.source / "tests/bench"))
    import free_bounds as script

    for name, jerk in (("linuxcnc/corner-p0.05", 0), ("linuxcnc/corner-p0.5", script.JERK)):
        program = page.source / f"problems/program/{name}.ngc"
        found = script.row(name, jerk, *script.planned(page.program, page.folder, program, jerk, 60))
        head = found[:found.index("|", found.index("|", 1) + 1) + 1]
        (printed,) = page.find(re.escape(head) + r"([^|]*\|[^|]*\|[^|]*\|[^|]*\|)")
        page.same(f"the row {head}", head + printed, found)


def estimates(page):
    """Estimates again; the times of the controls' own planners are in the table that estimates.py wrote."""
    sys.path.insert(0, str(page.source / "tests/peers"))
    import estimates as peers_estimates
    import programs

    written = [list(row.values()) for row in page.csv("estimates.csv")]
    names = re.search(r"\(commit (\w+)\).*\(commit (\w+)\)", page.text, re.S).groups()
    page.same("the page is that of estimates.csv", page.text, peers_estimates.page(written, *names))
    program = programs.fair(page.source / "problems/program/star.ngc", page.folder)
    task = programs.task_file(page.folder, 1000, None)
    for settings in ({control: {} for control in peers_estimates.CONTROLS}, peers_estimates.OTHER):
        found = peers_estimates.estimates(page.program, program, task, settings)
        for control, own in settings.items():
            words = ["star", "1000", control, " ".join("%s=%g" % item for item in own.items())]
            (printed,) = [row[5] for row in written if row[:4] == words]
            page.same(" ".join(words), printed, f"{found[control]:.4f}")


def linuxcnc_loop(page):
    """What is predicted; what LinuxCNC logged is in the tables that its scripts wrote."""
    sys.path.insert(0, str(page.source / "tests/peers"))
    import loop

    logged = page.rows("motion", "samples predicted")
    for row, wrote in zip(logged, page.csv("linuxcnc-loop.csv")):
        page.same(row["motion"], [row["samples predicted"], row["samples logged"], row["delays, ms"],
                                  row["largest difference, um"]], list(wrote.values())[1:])
    times = page.rows("program", "predicted, ms")
    page.same("table of times", [sorted(row.values()) for row in times],
              [sorted(row.values()) for row in page.csv("linuxcnc-identify.csv")])
    (page.folder / "corner.ngc").write_text(loop.CORNER)
    samples = page.folder / "samples.csv"
    page.run("program", page.folder / "corner.ngc", "--task", page.task(loop.CORNER_TASK + loop.SMOOTHED), "--samples",
             samples, "--quiet")
    predicted = loop.columns(samples, ("x_mm", "y_mm", "z_mm"))
    page.same("corner", logged[0]["samples predicted"],
              str(len(predicted) - loop.last_motion(predicted) - loop.first_motion(predicted)))
    mill = re.sub(r"(?ms)^\[filter\].*?(?=^\[\[)", '[filter]\nkind = "averages"\nlengths = [18, 7]\n' + loop.SMOOTHED,
                  (page.source / "problems/program/mill.toml").read_text())
    for name in ("legs", "zigzag"):
        plan = page.result("program", page.source / f"problems/program/{name}.ngc", "--feeds", "keep", "--task",
                           page.task(mill))
        page.same(name, page.row(times, "program", name)["predicted, ms"], f"{1e3 * plan['cycle_time_s']:.0f}")


def controllers(page):
    """A control without kinds of delays takes as long as its filter, given to the task."""
    rows = [row for row in page.rows("control", "program") if row["control"] == "beckhoff-nc-ptp"]
    for name in ("zigzag", "star"):
        row = page.row(rows, "program", name)
        length = int(re.fullmatch(r"(\d+) ms", row["settings"])[1])
        task = page.task("sample_period_ms = 1.0\n[filter]\nkind = \"averages\"\n"
                         f"lengths = [{length}]\n[[axis]]\nvelocity_max_mm_s = 500\nacceleration_max_mm_s2 = 6000\n"
                         "[program]\nerror_max_um = 20\n")
        result = page.result("program", page.source / f"problems/program/{name}.ngc", "--feeds", "keep", "--task", task)
        page.same(f"{name}, {length} ms", row["set"], f"{result['cycle_time_s']:.3f}")


def recipes(page):
    """Averages take as long as the page says where the task gives them as its filter."""
    mill = (page.source / "problems/program/mill.toml").read_text()
    for row in page.rows("recipe", "program"):
        if row["program"] not in ("zigzag", "star") or "taps" in row["filter"]:
            continue
        lengths = [int(length) for length in re.findall(r"(\d+) ms", row["filter"])]
        lengths *= 2 if "twice" in row["filter"] else 1
        given = f'[filter]\nkind = "averages"\nlengths = {lengths}\n'
        task = page.task(re.sub(r"(?ms)^\[filter\].*?(?=^\[\[)", given, mill) + "[program]\nerror_max_um = 20\n")
        program = page.source / f"problems/program/{row['program']}.ngc"
        result = page.result("program", program, "--feeds", "keep", "--task", task)
        page.same(f"{row['program']}, {row['filter']}", row["best"], f"{result['cycle_time_s']:.3f}")


def programs(page):
    task = page.source / "problems/program/mill.toml"
    without_filter = re.sub(r"(?ms)^\[filter\].*?(?=^\[\[)", "", task.read_text())
    shipped, filters = page.rows("program", "blocks"), page.rows("program", "filter of mill.toml")

    def plan(name, limits, *options):
        program = page.source / f"problems/program/{name}.ngc"
        return page.result("program", program, "--task", limits, "--feeds", "keep", *options)

    for name in ("zigzag", "star"):
        result, row = plan(name, task), page.row(shipped, "program", name)
        page.same(f"{name}, cycle time", row["cycle time"], f"{result['cycle_time_s']:.3f}")
        page.same(f"{name}, exact stops", row["exact stops"], f"{result['cycle_time_exact_stop_s']:.3f}")
        printed = page.row(filters, "program", name)["filter of mill.toml"]
        page.same(f"{name}, filter given", printed, f"{result['cycle_time_s']:.3f}")
    # The search for a filter ends by itself after a few seconds, long before this limit.
    designed = plan("zigzag", page.task(without_filter), "--time-limit", 60)["cycle_time_s"]
    printed = page.row(filters, "program", "zigzag")["filter designed"]
    page.same("zigzag, filter designed", printed, f"{designed:.3f}")
    limits = page.source / "problems/program/linuxcnc/limits.toml"
    rows = {row["by"]: row for row in page.rows("path", "by") if row["path"] == "corner"}
    fresh = plan("linuxcnc/corner-p0.5", limits)
    bounds = {bound["name"]: bound["time_s"] for bound in fresh["bounds"]}
    for by, seconds in (("accdec, one filter", fresh["cycle_time_s"]),
                        ("any motion within the tolerance, lower bound", bounds["any motion"]),
                        ("way over feed, lower bound", bounds["way over feed"])):
        page.same(f"linuxcnc/corner-p0.5, {by}", rows[by]["P0.5"].split()[0], f"{seconds:.3f}")


CHECKS = {
    "program/league.md": league,
    "program/arcs.md": arcs,
    "program/free.md": free,
    "program/estimates.md": estimates,
    "program/linuxcnc-loop.md": linuxcnc_loop,
    "program/controllers.md": controllers,
    "program/recipes.md": recipes,
    "program/programs.md": programs,
}
