"""Tasks of all kinds, designed and then verified: none of the program's own results may be rejected."""
import tasks
from corners import designed


def run(attack):
    def draw(rng):
        return tasks.draw(rng, tasks.KINDS[attack.case % len(tasks.KINDS)])

    for _, result, files in designed(attack, draw, time_limit=3):
        if result["status"] == "failed":
            continue
        code, out, err = attack.run("verify", files[1])
        attack.count("results verified")
        if code != 0:
            attack.fail(f"verify rejects with {code}: {out}{err}".strip(), *files)
