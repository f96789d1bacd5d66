"""Axes as they are (servo, smoothing, measured response, friction, force-speed curve, supply, rating, damped modes,
contour, rotary axes, position units): designs and programs that `verify` may not reject, and forged results that it may
not accept. Judge: the machine of tests/axes."""
import copy
import csv
import json
import sys
from pathlib import Path

import mutate
import tasks
from harness import read_json

sys.path.append(str(Path(__file__).resolve().parents[1] / "axes"))
import draw  # noqa: E402
import moved  # noqa: E402
import programs  # noqa: E402

FORGERIES = 10  # of a result
NEAR = 1e-9  # of a time that two ways of writing a task must agree on


def wrong(task, result):
    """What a result says and the machine does not do; None if all of it is so."""
    try:
        (moved if "corner" in task else programs).check(task, result)
    except (moved.Differs, ValueError, IndexError, KeyError) as reason:
        return str(reason)
    return None


class Case:
    """A task or program, its result, and forgeries of it."""

    def __init__(self, attack, rng):
        self.attack, self.rng = attack, rng
        self.task_path, self.result_path, self.program_path = map(
            attack.path, ("task.toml", "result.json", "part.ngc"))
        self.program = attack.case // FORGERIES % 3 == 2
        if self.program:
            self.task, text = programs.task_of(rng)
            Path(self.program_path).write_text(text)
        else:
            self.task = draw.draw(rng, draw.KINDS[attack.case // FORGERIES % len(draw.KINDS)])
        self.original = self.found(self.task)
        if self.original is None:
            return
        attack.count("programs moved" if self.program else "designs moved")
        reason = wrong(self.task, self.original)
        code, out, err = attack.run("verify", self.result_path)
        if code != 0 or reason:
            attack.fail(f"verify: {code} {out}{err}; moved: {reason}", *self.files())
        if self.program:
            self.units()
        else:
            self.turned()

    def files(self):
        return self.task_path, self.result_path, self.program_path

    def found(self, task, *more):
        """Its result, or None if there is none."""
        Path(self.task_path).write_text(tasks.to_toml(task))
        Path(self.result_path).unlink(missing_ok=True)
        what = ["program", self.program_path, "--task", self.task_path] if self.program else ["design", self.task_path]
        code, _, err = self.attack.run(*what, "--json", self.result_path, "-q", "--time-limit", 1, *more)
        if code == 2:
            self.attack.fail(f"exit 2: {err.strip()}", self.task_path, self.program_path)
        if code != 0 or not Path(self.result_path).exists():
            return None
        result = read_json(self.result_path)
        return result if result.get("filter") and result["status"] in ("optimal", "feasible") else None

    def turned(self):
        """Rotary axes of the same inertia and torque have the same optimum."""
        other = draw.turned(self.task) if self.original["status"] == "optimal" and self.rng.random() < 0.5 else None
        if other is None:
            return
        result = self.found(other)
        self.attack.count("turned into rotary axes")
        if result is None or result["status"] != "optimal":
            self.attack.fail("no optimum on rotary axes", *self.files())
        elif abs(result["cycle_time_s"] - self.original["cycle_time_s"]) > NEAR * result["cycle_time_s"]:
            self.attack.fail(f"rotary: {result['cycle_time_s']} s instead of {self.original['cycle_time_s']} s",
                             *self.files())
        else:
            code, out, err = self.attack.run("verify", self.result_path)
            if code != 0:
                self.attack.fail(f"rotary: verify {code} {out}{err}", *self.files())
        self.found(self.task)

    def units(self):
        """Samples in whole units are nowhere more than half a unit from those that are not rounded."""
        if self.rng.random() < 0.5:
            return
        unit, samples = self.rng.choice([0.01, 0.1, 1.0, 7.0]), self.attack.path("samples.csv")
        rows, results = [], []
        stepped = {**self.task, "controller": {**self.task.get("controller", {}), "position_unit_um": unit}}
        for task in (self.task, stepped):
            results.append(self.found(task, "--samples", samples))
            if results[-1] is None or results[-1]["commands"] != results[0]["commands"]:
                return self.found(self.task)  # the time limit led to another plan
            with open(samples, encoding="utf-8") as file:
                rows.append(list(csv.DictReader(file)))
        self.attack.count("programs in whole units")
        for plain, whole in zip(*rows, strict=True):
            for axis in "xy":
                count = next(v for k, v in whole.items() if k.startswith(f"{axis}_") and "unit" in k)
                if abs(int(count) * unit - 1e3 * float(plain[f"{axis}_mm"])) > 0.5 * unit + 2e-3:
                    reason = f"{count} units of {unit} um for {plain[f'{axis}_mm']} mm"
                    return self.attack.fail(reason, *self.files(), samples)
        return self.found(self.task)

    def forge(self, rng):
        """A damaged or forged result: refused, or still true."""
        path, forged = self.attack.path("forged.json"), copy.deepcopy(self.original)
        forged = mutate.change_places(rng, forged) if self.program else mutate.mutate(rng, forged)
        Path(path).write_text(json.dumps(forged, indent=2))
        code, _, _ = self.attack.run("verify", path)
        self.attack.count("results mutated")
        if code is None:
            self.attack.fail("verify did not end", path)
        if code != 0:
            return
        self.attack.count("accepted, still true")
        why = wrong(self.task, forged) if self.program else mutate.lie(self.task, self.original, path, wrong)
        if why:
            self.attack.fail(f"accepted: {why}", *self.files(), path)


def run(attack):
    case = None
    while attack.more():
        rng = attack.rng()
        if attack.case % FORGERIES == 0:
            case = Case(attack, rng)
        if case and case.original:
            case.forge(rng)
