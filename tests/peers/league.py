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
import shutil
import signal
import string
import subprocess
import sys
import tempfile
import threading
import tomllib
import uuid

sys.dont_write_bytecode = True
import check
import league_page
import league_rows
import programs

LIMIT = 900  # s, for a planner's command
RUNS = "ACCDEC_LEAGUE_RUN=%s" % uuid.uuid4()  # in the environment of all that planners start
LARGEST = 2 * 1024**3  # bytes of a file that it writes
LARGEST_READ = 2 * 10**8  # and of one that is read


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


KEYS = {"name": str, "command": str, "jerk": str, "needs": list, "seconds": int, "jobs": int}
WORDS = {"program", "samples", "report", "accdec", "peers", "task", "acceleration", "jerk", "velocity", "seconds"}


def require_words(where, text, known):
    """Braces in a text stand for words that are known."""
    try:
        fields = [field for field in string.Formatter().parse(text) if field[1] is not None]
    except ValueError as error:
        sys.exit("%s: %s; a brace of the command itself is doubled" % (where, error))
    for _, name, form, turned in fields:
        if name not in known or form or turned:
            sys.exit("%s: {%s} stands for nothing; allowed are {%s}; a brace of the command itself is doubled" %
                     (where, name, "}, {".join(sorted(known))))


def require_planner(file, number, entry, taken):
    """Ends with a message if an entry cannot be run."""
    where = "%s: [[planner]] %d" % (file, number)
    if not isinstance(entry, dict):
        sys.exit("%s: expected a table with name and command" % where)
    for key, value in entry.items():
        if type(value) is not KEYS.get(key) or value == "":
            kinds = ", ".join("%s (%s)" % (k, v.__name__) for k, v in KEYS.items())
            sys.exit("%s: %s = %r; allowed are %s" % (where, key, value, kinds))
    for key in ("name", "command"):
        if key not in entry:
            sys.exit("%s: has no %s" % (where, key))
    if entry["name"] in taken:
        sys.exit('%s: the name "%s" is taken already' % (where, entry["name"]))
    if entry.setdefault("jerk", "own") not in ("own", "ignored"):
        sys.exit('%s: jerk = "%s"; "own" or "ignored" is possible' % (where, entry["jerk"]))
    for key in ("seconds", "jobs"):
        if entry.get(key, 1) < 1:
            sys.exit("%s: %s = %d; at least 1 is possible" % (where, key, entry[key]))
    require_words(where + " command", entry["command"], WORDS)
    for need in entry.get("needs", []):
        if not isinstance(need, str):
            sys.exit("%s: needs has %r; files are possible" % (where, need))
        require_words(where + " needs", need, {"accdec"})


def entries(options):
    """Those of league.toml and of the user's file."""
    found = []
    for file in [programs.HERE / "league.toml"] + ([options.league] if options.league else []):
        try:
            listed = tomllib.loads(file.read_text(encoding="utf-8"))["planner"]
        except (OSError, KeyError, ValueError) as error:
            sys.exit("%s: %s; expected [[planner]] with name, command, jerk" % (file, error))
        if not isinstance(listed, list):
            sys.exit("%s: `planner` is no list; expected [[planner]]" % file)
        for number, entry in enumerate(listed, 1):
            require_planner(file, number, entry, {other["name"] for other in found})
            found.append(entry)
    return found


def planners(options):
    """Those that are asked for and whose needs are there; says which are not."""
    found = []
    for entry in entries(options):
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


def end_all(mark):
    """Kills all processes that have the mark in their environment, also those in sessions of their own."""
    for _ in range(100):
        alive = False
        for process in pathlib.Path("/proc").glob("[0-9]*"):
            try:
                if mark in (process / "environ").read_bytes():
                    os.kill(int(process.name), signal.SIGKILL)
                    alive = True
            except OSError:  # it has ended, or is not ours
                pass
        if not alive:
            return


def file_of(path):
    """A file that a planner wrote; no link, pipe or folder, and none that would fill the memory."""
    if path.is_symlink() or not path.is_file():
        return None
    if path.stat().st_size > LARGEST_READ:
        raise ValueError("%s has more than %d bytes" % (path.name, LARGEST_READ))
    return path


def motion_of(planner, program, acceleration, jerk, options, folder):
    """The samples, and the report if the planner wrote one; raises ValueError with the reason."""
    samples, report = folder / "samples.csv", folder / "report.json"
    words = {"program": program, "samples": samples, "report": report, "accdec": options.accdec, "peers": programs.HERE,
             "task": programs.task_file(folder, acceleration, jerk), "acceleration": acceleration, "jerk": jerk,
             "velocity": programs.VELOCITY, "seconds": planner.get("seconds", 30)}
    command = planner["command"].format(**{k: shlex.quote(str(v)) for k, v in words.items()})
    mark = "%s.%s" % (RUNS, uuid.uuid4())
    with tempfile.TemporaryFile() as said:
        with subprocess.Popen(["bash", "-c", command], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=said,
                              start_new_session=True, preexec_fn=limits_of_a_process,
                              env={**os.environ, **dict([mark.split("=")])}) as process:
            try:
                process.wait(timeout=LIMIT)
            except subprocess.TimeoutExpired:
                raise ValueError("did not end within %d s" % LIMIT)
            finally:
                try:
                    os.killpg(process.pid, signal.SIGKILL)
                except ProcessLookupError:
                    pass
                end_all(mark.encode())
        said.seek(0)
        first = said.read(10000).decode(errors="replace").strip().splitlines()
    if process.returncode != 0 or not file_of(samples):
        raise ValueError("%s (exit code %d)" % (first[0][:200] if first else "no samples", process.returncode))
    return programs.samples_of(samples), json.loads(report.read_text()) if file_of(report) else {}


def bounds_of(report):
    """Of accdec's report: the largest bound for any motion and for sums of monotone legs. Times are counted from the
    first to the last change of position, a period less than there."""
    found = {}
    try:
        for bound in report.get("bounds", []):
            name = "legs_bound_s" if bound["name"] == "monotone legs" else "any_bound_s"
            found[name] = max(found.get(name, 0.0), bound["time_s"] - check.T)
    except (AttributeError, KeyError, TypeError):
        raise ValueError("its report is none of accdec program")
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
        except (OSError, ValueError, subprocess.CalledProcessError) as error:
            rows = [{"failed": str(error).replace(str(folder) + "/", ""), "jerk": jerk} for jerk in jerks]
    for row in rows:
        row.update(program=name, acceleration=acceleration, planner=planner["name"])
        what = row["failed"] or "%.3f s %s" % (row["time_s"], check.breaks(row))
        print("%s, %d mm/s^2, jerk %s: %s %s" % (name, acceleration, row["jerk"] or "-", planner["name"], what), flush=True)
    return rows


def main():
    options = arguments()
    takers = planners(options)
    if not shutil.which(options.accdec):
        sys.exit("--accdec: %s cannot be run; it makes programs of the league" % options.accdec)
    try:
        options.out.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=options.out).close()
    except OSError as error:
        sys.exit("--out: %s cannot be written to: %s" % (options.out, error.strerror))
    table = options.out / "league.csv"
    rows = {league_rows.key(row): row for row in league_rows.read(table)}
    lock, stopped = threading.Lock(), threading.Event()
    for number in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, lambda taken, _: sys.exit(128 + taken))
    with tempfile.TemporaryDirectory() as folder:
        everything = programs.cases(options.accdec, pathlib.Path(folder))
        order = [case[0] for case in everything]
        cases = [case for case in everything if any(word in case[0] for word in options.programs)]

        def run(planner, case, jerks):
            found = judged(planner, case, jerks, options)
            if stopped.is_set():  # its planner was killed, and did not fail
                return
            with lock:
                rows.update((league_rows.key(row), row) for row in found)
                league_rows.write(table, sorted(rows.values(), key=lambda r: (
                    order.index(r["program"]) if r["program"] in order else len(order), r["acceleration"], r["jerk"])))

        for planner in takers:
            work = list(runs(cases, planner, rows, options))
            with concurrent.futures.ThreadPoolExecutor(planner.get("jobs", options.jobs)) as pool:
                try:
                    for done in [pool.submit(run, planner, *one) for one in work]:
                        done.result()
                except BaseException:
                    stopped.set()
                    pool.shutdown(wait=False, cancel_futures=True)
                    end_all(RUNS.encode())
                    raise
    written = league_rows.read(table)
    (options.out / "league.md").write_text(league_page.page(written))
    print("wrote", table, "and", options.out / "league.md")


if __name__ == "__main__":
    main()
