#!/usr/bin/python3
"""A league of planners: the same programs at the same limits, all motions judged by one checker. See README.md.

Rows that are there already stay. So a run that was stopped goes on, and a new planner needs only its own runs.
"""
import argparse
import concurrent.futures
import json
import os
import pathlib
import shlex
import signal
import subprocess
import sys
import tempfile
import threading
import tomllib

sys.dont_write_bytecode = True
import check
import league_page
import league_rows
import programs

LIMIT = 900  # s, for a planner's command
LARGEST = 2 * 1024**3  # bytes of a file that it writes


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--accdec", default=str(programs.ROOT / "build/release/apps/accdec"))
    parser.add_argument("--league", type=pathlib.Path, help="a TOML file with more [[planner]]s")
    parser.add_argument("--out", default=programs.ROOT / "results/program", type=pathlib.Path,
                        help="folder for league.csv and league.md")
    parser.add_argument("--programs", nargs="*", default=[""], help="only programs whose name has one of these words")
    parser.add_argument("--planners", nargs="*", default=[""], help="only planners whose name has one of these words")
    parser.add_argument("--jerks", nargs="*", type=int, help="only these, mm/s^3; 0: none")
    parser.add_argument("--accelerations", nargs="*", type=int, help="only these, mm/s^2")
    parser.add_argument("--again", action="store_true", help="run again what has rows")
    parser.add_argument("--jobs", type=int, default=2, help="commands at a time, of planners that may")
    return parser.parse_args()


def planners(options):
    """Those of league.toml and of the user's file whose needs are there; says which are not."""
    entries = list(programs.LEAGUE["planner"])
    if options.league:
        try:
            entries += tomllib.loads(options.league.read_text())["planner"]
        except (OSError, KeyError, tomllib.TOMLDecodeError) as error:
            sys.exit("%s: %s; expected [[planner]] with name, command, jerk" % (options.league, error))
    found = []
    for entry in entries:
        for name in ("name", "command"):
            if not isinstance(entry.get(name), str):
                sys.exit("a [[planner]] has no %s" % name)
        if entry.setdefault("jerk", "own") not in ("own", "ignored"):
            sys.exit('planner %s: jerk = "%s"; "own" or "ignored" is possible' % (entry["name"], entry["jerk"]))
        if not any(word in entry["name"] for word in options.planners):
            continue
        needs = [os.path.expandvars(path.format(accdec=options.accdec)) for path in entry.get("needs", [])]
        missing = [path for path in needs if not os.path.exists(path)]
        if missing:
            print("%s takes no part: %s is missing" % (entry["name"], ", ".join(missing)), flush=True)
        else:
            found.append(entry)
    return found


def limits_of_a_process():
    import resource

    resource.setrlimit(resource.RLIMIT_FSIZE, (LARGEST, LARGEST))


def motion_of(planner, program, acceleration, jerk, options, folder):
    """The samples, and the report if the planner wrote one; raises ValueError with the reason."""
    samples, report = folder / "samples.csv", folder / "report.json"
    words = {"program": program, "samples": samples, "report": report, "accdec": options.accdec, "peers": programs.HERE,
             "task": programs.task_file(folder, acceleration, jerk), "acceleration": acceleration, "jerk": jerk,
             "velocity": programs.VELOCITY, "seconds": planner.get("seconds", 30)}
    command = planner["command"].format(**{k: shlex.quote(str(v)) for k, v in words.items()})
    with subprocess.Popen(["bash", "-c", command], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                          stderr=subprocess.PIPE, start_new_session=True, preexec_fn=limits_of_a_process) as process:
        try:
            said = process.communicate(timeout=LIMIT)[1].decode(errors="replace").strip().splitlines()
        except subprocess.TimeoutExpired:
            raise ValueError("did not end within %d s" % LIMIT)
        finally:
            try:
                os.killpg(process.pid, signal.SIGKILL)
            except ProcessLookupError:
                pass
    if process.returncode != 0 or not samples.exists():
        raise ValueError("%s (exit code %d)" % (said[0][:200] if said else "no samples", process.returncode))
    return programs.samples_of(samples), json.loads(report.read_text()) if report.exists() else {}


def bounds_of(report):
    """Of accdec's report: the largest bound for any motion and for sums of monotone legs. Times are counted from the
    first to the last change of position, a period less than there."""
    found = {}
    for bound in report.get("bounds", []):
        name = "legs_bound_s" if bound["name"] == "monotone legs" else "any_bound_s"
        found[name] = max(found.get(name, 0.0), bound["time_s"] - check.T)
    return found


def runs(cases, planner, known, options):
    """(case, jerks that one run is judged by), those that have no row yet."""
    for case in cases:
        if options.accelerations is not None and case[2] not in options.accelerations:
            continue
        jerks = [jerk for jerk in case[3] if (options.jerks is None or jerk in options.jerks) and
                 (options.again or (case[0], case[2], jerk, planner["name"]) not in known)]
        if planner["jerk"] == "ignored":
            yield from [(case, jerks)] if jerks else []
        else:
            yield from ((case, [jerk]) for jerk in jerks)


def judged(planner, case, jerks, options):
    """The rows of one run."""
    name, program, acceleration, _ = case
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        os.chmod(folder, 0o755)
        try:
            program = programs.fair(program, folder)
            points, tolerances = check.points_of(program)
            motion, report = motion_of(planner, program, acceleration, jerks[0], options, folder)
            for jerk in jerks:
                row = {"failed": "", **check.check(motion, points, tolerances, acceleration, programs.VELOCITY, jerk)}
                rows.append({**row, **bounds_of(report), "jerk": jerk})
        except (ValueError, subprocess.CalledProcessError) as error:
            rows = [{"failed": str(error).replace(str(folder) + "/", ""), "jerk": jerk} for jerk in jerks]
    for row in rows:
        row.update(program=name, acceleration=acceleration, planner=planner["name"])
        what = row["failed"] or "%.3f s %s" % (row["time_s"], check.breaks(row))
        print("%s, %d mm/s^2, jerk %s: %s %s" % (name, acceleration, row["jerk"] or "-", planner["name"], what), flush=True)
    return rows


def main():
    options = arguments()
    options.out.mkdir(parents=True, exist_ok=True)
    table = options.out / "league.csv"
    rows = {league_rows.key(row): row for row in league_rows.read(table)}
    lock = threading.Lock()
    with tempfile.TemporaryDirectory() as folder:
        everything = programs.cases(options.accdec, pathlib.Path(folder))
        order = [case[0] for case in everything]
        cases = [case for case in everything if any(word in case[0] for word in options.programs)]

        def run(planner, case, jerks):
            found = judged(planner, case, jerks, options)
            with lock:
                rows.update((league_rows.key(row), row) for row in found)
                league_rows.write(table, sorted(rows.values(), key=lambda r: (
                    order.index(r["program"]) if r["program"] in order else len(order), r["acceleration"], r["jerk"])))

        for planner in planners(options):
            work = list(runs(cases, planner, rows, options))
            with concurrent.futures.ThreadPoolExecutor(planner.get("jobs", options.jobs)) as pool:
                for done in [pool.submit(run, planner, *one) for one in work]:
                    done.result()
    written = league_rows.read(table)
    (options.out / "league.md").write_text(league_page.page(written))
    print("wrote", table, "and", options.out / "league.md")


if __name__ == "__main__":
    main()
