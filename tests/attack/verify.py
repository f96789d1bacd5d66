"""Tasks of all kinds, designed and then verified: none of the program's own results may be rejected."""
import tasks
from corners import check_design
from harness import read_json


def run(attack):
    task_path, result_path = attack.path("task.toml"), attack.path("result.json")
    while attack.more():
        kind = tasks.KINDS[attack.case % len(tasks.KINDS)]
        task = attack.task_file(kind)
        code, _, err = attack.run("design", task_path, "--json", result_path, "-q", "--time-limit", 3)
        attack.count("tasks designed")
        if code is None or code == 2:
            attack.fail(f"{kind}: exit {code}: {err.strip()}", task_path)
            continue
        result = read_json(result_path)
        attack.count(f"status {result['status']}")
        if result["status"] == "failed":
            continue
        code, out, err = attack.run("verify", result_path)
        attack.count("results verified")
        if code != 0:
            attack.fail(f"{kind}: verify rejects with {code}: {out}{err}".strip(), task_path, result_path)
        if result["filter"] is not None:
            check_design(attack, task, result, (task_path, result_path))
