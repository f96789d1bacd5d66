"""The page of the league, from its rows."""
import statistics

import check
import programs

HEAD = """# A league of planners

%s
Written by `tests/peers/league.py`. All planners had the same programs and the same limits: %d mm/s per axis, and the
accelerations and jerks of the tables. `tests/peers/check.py` judges every motion from its positions, one a millisecond.
It knows nothing of who planned it.

* *holds* counts motions that exceed no limit of an axis by more than 2 %%. They also keep the tolerances of all
  programmed points and of the legs between them.
* *fastest* counts cases in which no planner that holds is faster by more than 0.1 %%.
* *behind*: how much longer its motions that hold take than those of the fastest planner that holds, in the median.
* *breaks* says what its other motions break, how many of them, and by how much at most.

LinuxCNC 2.9 (Debian's package) and Klipper have no jerk limit, so their motions are judged under limits that they were
never told. Klipper has no tolerance either. It passes corners exactly, and the velocity of the axes steps there
(square_corner_velocity = 5 mm/s). Its arcs are chords of 1 mm. Klipper's planner ran as Python code without a
printer. LinuxCNC 2.10 is its source of August 2026 with its jerk-limited planner, which is the trapezoidal one where
there is no jerk limit. `accdec free` had %d s a program and one thread, the other plans %d s. The computer had other
work during the run, so plans that ended at their time limit may be slower than they could be.

The programs are those of `problems/program` and generated ones (`accdec generate`, F6000, P0.05). Two turns of R10 are
on the exact path, and one program has corners between lines and arcs. *package* stands for programs of LinuxCNC's
package, which nobody here wrote. They are read whole, at P0.05, without tool changes. accdec reads canned cycles, loops
and calls by rs274, which prints inches with four decimals. Such motions break exact stops by up to 1.8 um.
"""

UNFINISHED = """
Not every planner has run at every limit: `motions` says how many, and empty cells in the tables are runs not made yet.
`league.py` makes them.
"""


def name_of(jerk):
    return "no jerk limit" if not jerk else "jerk %d mm/s^3" % jerk


def names(rows, word):
    return list(dict.fromkeys(row[word] for row in rows))


def holding(rows):
    return [row for row in rows if not row["failed"] and not check.breaks(row)]


def broken(rows):
    """What motions break: kind, how many, and the most."""
    kinds = {"tolerance": ("um", lambda r: max(r["point_um"], r["path_um"])), "velocity": ("%", lambda r: r["velocity_pct"]),
             "acceleration": ("%", lambda r: r["acceleration_pct"]), "jerk": ("%", lambda r: r["jerk_pct"])}
    found = []
    for kind, (unit, much) in kinds.items():
        those = [much(row) for row in rows if not row["failed"] and kind + " " in check.breaks(row) + " "]
        if those:
            found.append("%s %d (%.3g %s)" % (kind, len(those), max(those), unit))
    failed = sum(1 for row in rows if row["failed"])
    return ", ".join(found + (["no motion %d" % failed] if failed else [])) or "nothing"


def standing(rows, jerk):
    """A planner's row of the first table, under one jerk limit."""
    rows = [row for row in rows if row["jerk"] == jerk]
    best = {}
    for row in holding(rows):
        case = row["program"], row["acceleration"]
        best[case] = min(best.get(case, row["time_s"]), row["time_s"])
    table = []
    for planner in names(rows, "planner"):
        mine = [row for row in rows if row["planner"] == planner]
        ratios = [row["time_s"] / best[row["program"], row["acceleration"]] for row in holding(mine)]
        table.append({"planner": planner, "motions": len(mine), "holds": len(ratios),
                      "fastest": sum(1 for ratio in ratios if ratio <= 1.001),
                      "behind": "%.1f %%" % (100 * (statistics.median(ratios) - 1)) if ratios else "-",
                      "breaks": broken(mine)})
    return table, len(best)


def markdown(head, lines):
    rule = ["---" if word in ("program", "planner", "breaks") else "--:" for word in head]
    return "\n".join("| " + " | ".join(line) + " |" for line in [head, rule] + lines) + "\n"


def cell(row):
    if row is None:
        return ""
    if row["failed"]:
        return "no motion"
    return "%.3f%s" % (row["time_s"], "*" if check.breaks(row) else "")


def summary(rows, jerks):
    said = []
    for jerk in jerks:
        table, cases = standing(rows, jerk)
        table.sort(key=lambda line: -line["fastest"])
        first = table[0]
        said.append("With %s, `%s` is the fastest planner within all limits and tolerances in %d of %d "
                    "cases." % (name_of(jerk), first["planner"], first["fastest"], cases))
        others = [line for line in table if not line["planner"].startswith("accdec") and line["fastest"]]
        said += ["%s is the fastest in %d." % (line["planner"], line["fastest"]) for line in others]
    return " ".join(said + ["A case is a program at one acceleration."])


def page(rows):
    jerks = sorted(names(rows, "jerk"))
    seconds = {entry["name"]: entry.get("seconds", 30) for entry in programs.LEAGUE["planner"]}
    text = HEAD % (summary(rows, jerks) + "\n", programs.VELOCITY, seconds["accdec free"], seconds["accdec fixed"])
    cases = {(row["program"], row["acceleration"], row["jerk"]) for row in rows}
    if len(rows) < len(cases) * len(names(rows, "planner")):
        text += UNFINISHED
    text += "\n## Who is fastest, who breaks what\n"
    for jerk in jerks:
        table, cases = standing(rows, jerk)
        head = ["planner", "motions", "holds", "fastest", "behind", "breaks"]
        text += "\n%s, %d cases:\n\n" % (name_of(jerk).capitalize(), cases)
        text += markdown(head, [[str(line[word]) for word in head] for line in table])
    planners = names(rows, "planner")
    text += ("\nThe tables below have times in s from the first to the last change of position. An asterisk marks a motion"
             " that\nbreaks something; league.csv says what, and by how much. The bound holds for any motion within the"
             " tolerance\n(`accdec program` computes it; its planes across legs, of `--plan free`, included). The last"
             " column is the bound over the\nfastest time that holds, in %.\n")
    for jerk in jerks:
        text += "\n## %s\n\n" % name_of(jerk).capitalize()
        lines = []
        mine = [row for row in rows if row["jerk"] == jerk]
        for case in dict.fromkeys((row["program"], row["acceleration"]) for row in mine):
            here = {row["planner"]: row for row in mine if (row["program"], row["acceleration"]) == case}
            bounds = [row["any_bound_s"] for row in here.values() if row["any_bound_s"]]
            best = min((row["time_s"] for row in holding(here.values())), default=None)
            lines.append([case[0], str(case[1])] + [cell(here.get(planner)) for planner in planners] + [
                "%.3f" % max(bounds) if bounds else "",
                "%.1f" % (100 * max(bounds) / best) if bounds and best else ""])
        text += markdown(["program", "mm/s^2"] + planners + ["bound", "bound, %"], lines)
    return text
