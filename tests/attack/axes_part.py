"""Axes as they are (servo, smoothing, friction, force-speed curve, supply, damped modes, contour): designs that
`verify` may not reject, and forged results that it may not accept. Judge: the machine of tests/axes."""
import json
import sys
from pathlib import Path

import mutate
import tasks
from harness import read_json

sys.path.append(str(Path(__file__).resolve().parents[1] / "axes"))
import draw  # noqa: E402
import moved  # noqa: E402

FORGERIES = 10  # of a design


def wrong(task, result):
    """What a result says and the machine does not do; None if all of it is so."""
    try:
        moved.check(task, result)
    except (moved.Differs, ValueError, IndexError, KeyError) as reason:
        return str(reason)
    return None


def run(attack):
    task_path, result_path, forged_path = map(attack.path, ("task.toml", "result.json", "forged.json"))
    task = original = None
    while attack.more():
        rng = attack.rng()
        if attack.case % FORGERIES == 0:
            task = draw.draw(rng, draw.KINDS[attack.case // FORGERIES % len(draw.KINDS)])
            Path(task_path).write_text(tasks.to_toml(task))
            code, _, err = attack.run("design", task_path, "--json", result_path, "-q", "--time-limit", 1)
            original = read_json(result_path) if code == 0 else None
            if code == 2:
                attack.fail(f"exit 2: {err.strip()}", task_path)
            if original is None:
                continue
            attack.count("designs moved")
            reason = wrong(task, original)
            code, out, err = attack.run("verify", result_path)
            if code != 0 or reason:
                attack.fail(f"verify: {code} {out}{err}; moved: {reason}", task_path, result_path)
        if original is None:
            continue
        forged = mutate.mutate(rng, original)
        Path(forged_path).write_text(json.dumps(forged, indent=2))
        code, _, _ = attack.run("verify", forged_path)
        attack.count("results mutated")
        if code is None:
            attack.fail("verify did not end", forged_path)
        if code != 0:
            continue
        attack.count("accepted, still true")
        why = mutate.lie(task, original, forged_path, wrong)
        if why:
            attack.fail(f"accepted: {why}", task_path, result_path, forged_path)
