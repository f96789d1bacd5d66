"""SIGKILL at random times: an output is the old one or the new one, whole; a study or comparison goes on and loses
nothing."""
import os
import shutil
import time
from pathlib import Path

from harness import leftovers, read_json
from outputs import make_inputs

STUDY = """title = "killed"
task = "task.toml"
compute = ["optimum"]
[[vary]]
name = "angle_deg"
key = "corner.A.angle_deg"
range = { from = 30, to = 150, count = 25 }
"""


def _whole_result(path):
    if read_json(path)["status"] != "optimal":
        raise ValueError("another status")


def _whole_program(path):
    if not read_json(path)["schema"].startswith("accdec.program/"):
        raise ValueError("another schema")


def _whole_text(ending):
    def check(path):
        if not Path(path).read_text().rstrip().endswith(ending):
            raise ValueError("no end")

    return check


class Victim:
    """A command with one output, what a whole output is, and how long the command runs when nobody disturbs it."""

    def __init__(self, attack, name, command, whole):
        self.target, self.command, self.whole = attack.path(name), (*command, attack.path(name)), whole
        began = time.monotonic()
        for _ in range(3):
            code, _, err = attack.run(*self.command)
            if code != 0:
                attack.fail(f"{command[0]} does not run: {code}: {err}")
        self.seconds = (time.monotonic() - began) / 3.0

    def kill(self, attack):
        process = attack.start(*self.command)
        time.sleep(attack.rng().uniform(0.0, 1.1 * self.seconds))
        attack.kill(process)
        attack.count(f"kills of {self.command[0]}")
        try:
            self.whole(self.target)
        except (OSError, ValueError, KeyError) as error:
            attack.fail(f"a killed {self.command[0]} left half a file: {error}", self.target)


def _victims(attack):
    make_inputs(attack)
    p = attack.path
    return [
        Victim(attack, "killed.json", ("design", p("task.toml"), "-q", "--json"), _whole_result),
        Victim(
            attack,
            "killed-program.json",
            ("program", p("part.ngc"), "--task", p("machine.toml"), "-q", "--json"),
            _whole_program,
        ),
        Victim(attack, "killed.svg", ("plot", p("result.json"), "--out"), _whole_text("</svg>")),
        Victim(attack, "killed.ngc", ("generate", "star", "--blocks", "2000", "--out"), _whole_text("M2")),
    ]


def _no_leftovers(attack, names):
    """SIGKILL leaves no chance to remove a temporary; it must be told from the output by its name, and be one a kill at
    most."""
    left = leftovers(attack.work, names)
    if len(left) > 1:
        attack.fail(f"a kill left {left}")
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
    victims = _victims(attack)
    Path(attack.path("study.toml")).write_text(STUDY)
    code, _, err = attack.run(
        "study", attack.path("study.toml"), "--out", attack.path("reference"), "-q", "--workers", "1"
    )
    if code != 0:
        attack.fail(f"the study does not run: {code}: {err}")
        return
    reference = _rows(attack.path("reference"))
    names = [*os.listdir(attack.work), "out"]
    while attack.more():
        if attack.case % 40 == 39:
            _kill_study(attack, reference)
        else:
            victims[attack.case % len(victims)].kill(attack)
            _no_leftovers(attack, names)
