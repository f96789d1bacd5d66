"""Single corners: the program's `optimal` and `infeasible` against linear programs, its designs against the model in
numpy."""
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


def run(attack):
    task_path, result_path = attack.path("task.toml"), attack.path("result.json")
    while attack.more():
        kind = tasks.JUDGED[attack.case % len(tasks.JUDGED)]
        task = attack.task_file(kind, longest=12)
        code, _, err = attack.run("design", task_path, "--json", result_path, "-q", "--time-limit", 20)
        attack.count("corners designed")
        if code is None or code == 2:
            attack.fail(f"exit {code}: {err.strip()}", task_path)
            continue
        result = read_json(result_path)
        attack.count(f"status {result['status']}")
        if result["filter"] is not None:
            check_design(attack, task, result, (task_path, result_path))
        if result["status"] == "optimal":
            check_optimum(attack, task, result, (task_path, result_path))
        elif result["status"] == "infeasible":
            # Nothing is easier than a long filter and a full stop.
            attack.count("infeasible judged")
            if judge.exists(task, 80, order_min=40, order_max=40):
                attack.fail("infeasible, but an exact stop of order 40 exists", task_path, result_path)
