"""Single corners: the program's `optimal` and `infeasible` against linear programs, its designs against the model in
numpy."""
from pathlib import Path

import judge
import model
import tasks
from harness import read_json


def check_design(attack, task, result, files):
    """Taps and delays of a result hold every limit of the task, by simulation here."""
    delays = [c["delay_samples"] for c in result["corners"]]
    use, name = model.worst_use(task, result["filter"]["taps"], delays)
    attack.count("designs simulated")
    if use > 1.0 + 1e-7:
        attack.fail(f"breaks {name}: {use:.9f}", *files)


def check_optimum(attack, task, result, files):
    total = result["filter"]["order"] + result["corners"][0]["delay_samples"]
    shorter = judge.exists(task, total - 1)
    attack.count("optima judged")
    if attack.case % 4 == 0:
        # The judge must also find what there is, or it would refute everything.
        attack.count("optima found again")
        if judge.exists(task, total) is False:
            attack.fail(f"the judge finds no corner of N + d = {total}, the program did", *files)
    if shorter is None:
        attack.count("undecided by the judge")
    elif shorter:
        attack.fail(f"optimal with N + d = {total}, but {total - 1} exists", *files)


def designed(attack, draw, time_limit=20):
    """Case after case: a task that `draw` makes of random numbers, the program's result of it, and their two files."""
    files = attack.path("task.toml"), attack.path("result.json")
    while attack.more():
        task = draw(attack.rng())
        Path(files[0]).write_text(tasks.to_toml(task))
        code, _, err = attack.run("design", files[0], "--json", files[1], "-q", "--time-limit", time_limit)
        attack.count("tasks designed")
        if code is None or code == 2:
            attack.fail(f"exit {code}: {err.strip()}", files[0])
            continue
        result = read_json(files[1])
        attack.count(f"status {result['status']}")
        if result["filter"] is not None:
            check_design(attack, task, result, files)
        yield task, result, files


def run(attack):
    def draw(rng):
        return tasks.draw(rng, tasks.JUDGED[attack.case % len(tasks.JUDGED)], longest=12)

    for task, result, files in designed(attack, draw):
        if result["status"] == "optimal":
            check_optimum(attack, task, result, files)
        elif result["status"] == "infeasible":
            # Nothing is easier than a long filter and a full stop.
            attack.count("infeasible judged")
            if judge.exists(task, 80, order_min=40, order_max=40):
                attack.fail("infeasible, but an exact stop of order 40 exists", *files)
