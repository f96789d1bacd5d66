"""SIGKILL at random times: an output is the old one or the new one, whole; a study or comparison goes on and loses nothing."""
import os
import shutil
import time
from pathlib import Path

from harness import leftovers, read_json
from outputs import TASK

STUDY = """title = "killed"
task = "task.toml"
compute = ["optimum"]
[[vary]]
name = "angle_deg"
key = "corner.A.angle_deg"
range = { from = 30, to = 150, count = 25 }
"""


def _kill_design(attack):
    target = attack.path("result.json")
    names = {"task.toml", "study.toml", "result.json", "reference", "out"}
    process = attack.start("design", attack.path("task.toml"), "--json", target, "-q")
    time.sleep(attack.rng().uniform(0.0, 0.06))
    attack.kill(process)
    attack.count("kills of a design")
    if os.path.exists(target):
        try:
            if read_json(target)["status"] != "optimal":
                attack.fail("a killed design left another status", target)
        except (ValueError, KeyError):
            attack.fail("a killed design left half a file", target)
    # SIGKILL leaves no chance to remove a temporary; it must be told from the output by its name, and be one at most.
    left = leftovers(attack.work, names)
    if len(left) > 1:
        attack.fail(f"a killed design left {left}")
    for name in left:
        attack.count("temporaries left by SIGKILL")
        os.unlink(attack.path(name))


def _rows(folder):
    return Path(folder, "rows.jsonl").read_text()


def _kill_study(attack, reference):
    """Killed over and over until it is through; the rows must be those of an undisturbed run."""
    out, rng = attack.path("out"), attack.rng()
    shutil.rmtree(out, ignore_errors=True)
    for _ in range(8):
        process = attack.start("study", attack.path("study.toml"), "--out", out, "-q", "--workers", "1")
        time.sleep(rng.uniform(0.01, 0.3))
        if process.poll() is not None:
            break
        attack.kill(process)
        attack.count("kills of a study")
    code, _, err = attack.run("study", attack.path("study.toml"), "--out", out, "-q", "--workers", "1")
    if code != 0:
        attack.fail(f"a killed study does not go on: {code}: {err}")
    elif _rows(out) != reference:
        attack.fail("a killed study ends with other rows", str(Path(out, "rows.jsonl")))


def run(attack):
    Path(attack.path("task.toml")).write_text(TASK)
    Path(attack.path("study.toml")).write_text(STUDY)
    code, _, err = attack.run("study", attack.path("study.toml"), "--out", attack.path("reference"), "-q", "--workers", "1")
    if code != 0:
        attack.fail(f"the study does not run: {code}: {err}")
        return
    reference = _rows(attack.path("reference"))
    while attack.more():
        if attack.case % 10 == 9:
            _kill_study(attack, reference)
        else:
            _kill_design(attack)
