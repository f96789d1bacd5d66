"""Bounds of `margin` and `delay` problems (accdec.refutation/1): both checkers accept what `accdec instances` writes,
and refuse forgeries. Needs a built program (ACCDEC_BINARY)."""
import copy
import json
import math
import random
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
from both_checkers_test import BothCheckers, designed, verified  # noqa: E402 isort:skip
from check_certificate_test import BINARY, ROOT, verdict  # noqa: E402 isort:skip

TASK = """sample_period_ms = 1
[design]
symmetric = {symmetric}
[[axis]]
{axis}
[[corner]]
name = "A"
angle_deg = {angle}
heading_deg = {heading}
feed_in_mm_min = {feed}
error_max_um = {error}
{corner}
"""
SECOND = '[[corner]]\nname = "B"\nangle_deg = 130\nfeed_in_mm_min = 2000\nerror_max_um = 15\nweight = 2\n'
RAMP = "acceleration_max_mm_s2 = 6000\njerk_max_mm_s3 = 1500000"
BOXCAR = f"acceleration_max_mm_s2 = {100 / 0.012 * (1 + 1e-9)!r}"  # no tap above 1/12: one filter of order 11 is left


def task(axis=RAMP, angle=95, heading=30, feed=2500, error=40, symmetric="false", corner=""):
    return TASK.format(**locals())


def problem(text, name, order, delays=None, formulation=("margin", "delay"), expected="feasible"):
    """Task and lines of the suite."""
    given = "" if delays is None else f"delay_samples = {delays}\n"
    return text, (f'[[problem]]\nname = "{name}"\ntask = "{name}.toml"\nformulation = {list(formulation)}\n'
                  f'order = {order}\nexpected = "{expected}"\n{given}')


PROBLEMS = {
    "plain": problem(task(), "plain", 11, 4),
    "later": problem(task(), "later", 11, 7, ["margin"]),
    "boxcar": problem(task(BOXCAR, 90, 0, 6000, 30), "boxcar", 11, 5),
    "symmetric": problem(task(symmetric="true"), "symmetric", 11, 4),
    "ringing": problem(task(corner="[[mode]]\nfrequency_Hz = [90, 110]\nresidual_max = 0.3\ndamping_ratio = [0, 0.1]"),
                       "ringing", 11, 4),
    "two": problem(task() + SECOND, "two", 11, [4, 3]),
    "power": problem(task("mass_kg = 34\ndamping_N_s_m = 60\nforce_max_N = 465\npower_max_W = 140", 90, 20, 15000,
                          200), "power", 15, 7),
    "speed": problem(task("acceleration_max_mm_s2 = 6000", corner="speed_min_mm_s = 22", symmetric="true"),
                     "speed", 11, 5),
    "short": problem(task(), "short", 4, 1, expected="infeasible"),
    "given": problem(task(corner="delay_samples = 2", error=3), "given", 11, formulation=["delay"],
                     expected="infeasible"),
    "beside": problem(task(corner="delay_samples = 2", error=3) + SECOND, "beside", 11, formulation=["delay"],
                      expected="infeasible"),
}


def write_instances(folder, suite):
    done = subprocess.run([BINARY, "instances", suite, "--out", f"{folder}/out", "--format", "nl", "-q"],
                          capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    out = Path(folder) / "out"
    manifest = json.loads((out / "manifest.json").read_text(encoding="utf-8"))
    proofs = {}
    for entry in manifest["instances"]:
        file = entry["optimum"]["certificate"]
        if file and entry["formulation"] != "design":
            proofs[entry["problem"], entry["formulation"]] = json.loads((out / file).read_text(encoding="utf-8"))
    return manifest["instances"], proofs


class InstanceProofs(BothCheckers):
    @classmethod
    def setUpClass(cls):
        with tempfile.TemporaryDirectory() as folder:
            suite = 'solvers = ["ipopt"]\n'
            for name, (text, lines) in PROBLEMS.items():
                (Path(folder) / f"{name}.toml").write_text(text, encoding="utf-8")
                suite += lines
            (Path(folder) / "suite.toml").write_text(suite, encoding="utf-8")
            cls.entries, cls.proofs = write_instances(folder, f"{folder}/suite.toml")

    def optimum(self, name, formulation):
        return next(entry["optimum"] for entry in self.entries
                    if (entry["problem"], entry["formulation"]) == (name, formulation))

    def forged(self, name, formulation, **members):
        return copy.deepcopy(self.proofs[name, formulation]) | members

    def test_all_are_proved(self):
        for entry in self.entries:
            name, optimum = (entry["problem"], entry["formulation"]), entry["optimum"]
            with self.subTest(name):
                proof = self.proofs[name]
                self.both(proof, True)
                self.assertEqual((proof["task"], proof["at"]), (entry["task"], entry["at"]))
                if optimum["proof"] == "proved":
                    self.assertEqual(proof["lower"], optimum["lower"])
                    self.assertLessEqual(optimum["upper"] - optimum["lower"], 5e-5 * max(1, optimum["upper"]))
                else:
                    self.assertEqual(optimum["proof"], "infeasible proved")
                    self.assertIsNone(proof["lower"])

    def test_values_are_those_of_linear_acceleration(self):
        """One boxcar of L = 12 taps is left. At real instants it is linear Acc/Dec of duration L T, whose error is
        v L T/4 cos(theta/2) (1 - d/L)^2. At whole samples p = (12 - k)(11 - k)/24 of k and q = m (m + 1)/24 of m."""
        taps, way = 12, 0.1e-3
        delay = taps * (1 - math.sqrt(30e-6 / (way * taps / 4 * math.sqrt(0.5))))
        self.assertLess(self.proofs["boxcar", "delay"]["lower"], delay * (1 + 1e-9))
        self.assertGreater(self.proofs["boxcar", "delay"]["lower"], delay * (1 - 1e-4))
        proof = self.proofs["boxcar", "margin"]
        k, d = proof["at"]["samples"][0], proof["at"]["delays"][0]
        p, q = (taps - k) * (taps - 1 - k) / 24, (k - d) * (k - d + 1) / 24
        sigma = (p * p + q * q) * (way / 30e-6) ** 2
        self.assertLess(proof["lower"], sigma * (1 + 1e-9))
        self.assertGreater(proof["lower"], sigma * (1 - 1e-4))

    def test_more_is_not_proved(self):
        for name, formulation in self.proofs:
            forged = self.forged(name, formulation)
            if forged["lower"] is None:
                continue
            with self.subTest((name, formulation)):
                forged["lower"] = self.optimum(name, formulation)["upper"] * 1.001 + 1e-4
                self.refused(forged)  # for a delay, the parts say less
                for part in forged["parts"]:
                    if "delay" in part:
                        part["delay"] = part["delay"] * 1.001 + 1e-3
                self.refused(forged)

    def refused(self, forged):
        for accepted, words in (verified(forged), verdict(forged)):
            self.assertIs(accepted is True, False, words)

    def test_other_places_are_not_proved(self):
        later, plain = self.proofs["later", "margin"], self.forged("plain", "margin")
        self.assertLess(later["lower"], plain["lower"])
        self.refused(plain | {"at": later["at"]})  # there are filters below
        for member, value in (("order", 10**7), ("order", -1), ("order", 1.5), ("order", "11"), ("delays", []),
                              ("delays", [4, 4]), ("delays", [-1]), ("delays", [None]), ("samples", [17]),
                              ("samples", [-1]), ("samples", []), ("samples", [1e300]), ("samples", [float("nan")]),
                              ("frequencies", [[90]]), ("frequencies", None), ("frequencies", {})):
            with self.subTest((member, value)):
                self.refused(self.forged("plain", "margin", at=plain["at"] | {member: value}))
        self.refused(self.forged("plain", "delay", at=plain["at"]))
        short = self.forged("short", "margin")
        short["at"]["order"] = 11
        self.refused(short)
        ringing = self.forged("ringing", "margin")
        ringing["at"]["frequencies"][0][0] = 80
        self.both(ringing, "outside")
        ringing["at"]["frequencies"][0] = [100]  # fewer bounds than the proof names
        self.refused(ringing)
        # No blend has such a sample: nothing is left there, but that proves nothing.
        empty = self.forged("plain", "margin", at=plain["at"] | {"samples": [99]})
        empty["parts"][0]["certificate"] |= {"tree": [None]}
        self.refused(empty)

    def test_results_cannot_hold_such_proofs(self):
        result = designed(task())
        self.both(result, True)
        for name in ("plain", "power", "short"):
            for formulation in ("margin", "delay"):
                proof = self.proofs[name, formulation]
                inner = proof["parts"][0]["certificate"]
                for forged in (dict(result, certificate=inner), dict(result, certificate=proof),
                               dict(result, certificate=inner | {"bound_samples": 99}),
                               dict(result, status="infeasible", certificate=inner),
                               dict(result, schema="accdec.refutation/1"), dict(proof, schema="accdec.result/1")):
                    self.refused(forged)
        # A task with the one order and delay, whose sample is still free.
        given = task(corner="delay_samples = 4").replace("[design]", "[design]\norder_min = 11\norder_max = 11")
        narrow, inner = designed(given), self.proofs["plain", "margin"]["parts"][0]["certificate"]
        self.refused(dict(narrow, status="infeasible", certificate=inner))
        whole = self.forged("plain", "margin")
        whole["parts"][0]["certificate"] = result["certificate"]
        self.refused(whole)

    def test_trees_must_be_whole(self):
        for name in (("plain", "delay"), ("two", "delay"), ("power", "margin"), ("power", "delay"), ("speed", "delay")):
            with self.subTest(name):
                tree = self.proofs[name]["parts"][0]["certificate"]["tree"]
                for i in range(0, len(tree), 1 + len(tree) // 12):
                    forged = self.forged(*name)
                    del forged["parts"][0]["certificate"]["tree"][i]
                    self.refused(forged)
                forged["parts"][0]["certificate"]["tree"] = tree + [0]
                self.refused(forged)

    def test_cells_are_what_their_sets_refute(self):
        proof = self.proofs["plain", "delay"]
        certificate = proof["parts"][0]["certificate"]
        cells = [node for node in certificate["tree"] if isinstance(node, list) and node[0] == "instants"]
        self.assertGreater(len(cells), 0)
        *_, cell = cells
        self.assertEqual(cell[4], cell[3] + 1)

        def changed(change):
            forged = self.forged("plain", "delay")
            change(forged["parts"][0]["certificate"])
            return forged

        def errors(certificate, index):
            return [row for row in certificate["multipliers"][index] if row[0] == "error"]

        def turn(index):
            def change(certificate):
                for row in errors(certificate, index):
                    row[2] += 0.3
            return change

        self.assertGreater(len(errors(certificate, cell[3])), 0)
        self.both(changed(turn(cell[3])), "more than one direction")

        def backwards(certificate):
            for index in cell[3:]:
                for row in errors(certificate, index):
                    row[2] += math.pi
        self.both(changed(backwards), "does not grow with both distances")

        def alone(certificate):
            certificate["tree"] = [cell[3]]
        self.both(changed(alone), "no instant")

        def one_cell(certificate):
            certificate["tree"] = [cell]
        self.refused(changed(one_cell))

        def outside(certificate):
            certificate["tree"] = [["t", 25], *certificate["tree"], cell]
        self.both(changed(outside), "outside")

        def negative(certificate):
            certificate["multipliers"][cell[3]][0][-1] *= -1
        self.both(changed(negative), "negative")

        def by_range(certificate):
            certificate["multipliers"][cell[3]] = [["range error", 0, 0.7, 5, False, False, 1, False, False, 1.0]]
        self.both(changed(by_range), "samples where errors are bounded at instants")
        self.refused(self.forged("plain", "margin", parts=proof["parts"]))
        self.refused(self.forged("plain", "delay", parts=self.proofs["plain", "margin"]["parts"]))

    def test_sums_are_of_different_corners(self):
        two = self.forged("two", "delay")
        self.assertEqual(sorted(part["corner"] for part in two["parts"]), [0, 1])
        for parts in ([two["parts"][0]] * 2, [two["parts"][0]], [], [dict(two["parts"][0], corner=2), two["parts"][1]]):
            self.refused(two | {"parts": parts})
        self.refused(two | {"lower": None})
        given = self.forged("two", "delay")
        given["task"]["corner"][0]["delay_samples"] = 3
        self.refused(given)  # one part counts for nothing
        self.refused(self.forged("given", "delay", lower=1.0))

    def test_other_limits_are_refused(self):
        def with_(**tables):
            proof = self.forged("plain", "margin")
            for name, keys in tables.items():
                tables = proof["task"].setdefault(name, {})
                for table in tables if isinstance(tables, list) else [tables]:
                    table |= keys
            return proof

        for forged in (with_(axis={"servo_gain_1_s": 200}), with_(corner={"contour_max_um": 10}),
                       with_(machine={"power_total_max_W": 5}), with_(controller={"prefilter_taps": [0.5, 0.5]})):
            self.refused(forged)
        for member, value in (("bound_samples", 5), ("runs", 2), ("objective", "corner"), ("tolerance", 0.1),
                              ("corner_of", [0]), ("smoothed", True), ("smoothed", 0), ("lemmas", False),
                              ("kind", "enumeration")):
            proof = self.forged("plain", "margin")
            proof["parts"][0]["certificate"][member] = value
            self.refused(proof)
        proof = self.forged("plain", "margin")
        proof["parts"][0]["certificate"] |= {"lemmas": [], "conflict": [], "corner_of": [], "smoothed": False,
                                             "in_position": False}
        self.both(proof, True)

    def test_random_changes_prove_nothing_false(self):
        """Whatever a checker accepts is not above the value of a known point."""
        rng = random.Random(5)
        for _ in range(60):
            name = rng.choice(sorted(self.proofs))
            forged = self.forged(*name)
            if forged["lower"] is None or forged["lower"] > 1e6:
                continue
            forged["lower"] *= 1 + rng.choice((1e-6, 1e-3, 0.1))
            part = rng.choice(forged["parts"])
            if "delay" in part:
                part["delay"] *= 1 + rng.choice((1e-6, 1e-3, 0.1))
            certificate = part["certificate"]
            if rng.random() < 0.5:
                rows = rng.choice(certificate["multipliers"])
                if rows:
                    row = rng.choice(rows)
                    i = rng.randrange(1, len(row))
                    row[i] = row[i] + rng.choice((1, -1)) if isinstance(row[i], int) else row[i] * rng.uniform(0.9, 1.1)
            elif isinstance(node := rng.choice(certificate["tree"]), list):
                i = rng.randrange(len(node))
                if isinstance(node[i], float):
                    node[i] *= rng.uniform(0.9, 1.1)
            upper = self.optimum(*name)["upper"]
            for accepted, words in (verified(forged), verdict(forged)):
                self.assertTrue(accepted is not True or forged["lower"] <= upper * (1 + 1e-9), words)


def by_hand(task, delay, cells):
    """A proof for the boxcar's task that owes nothing to the program: no row but the error is needed."""
    def ramp(z):
        return min(max(z, 0), 1) ** 2 / 2 + max(z - 1, 0)

    multipliers, tree = [], []

    def refute(first, last):
        if last - first > 1:
            middle = (first + last) // 2
            tree.append(["t", 24 * middle / cells])
            refute(first, middle)
            refute(middle, last)
            return
        at = 12 * (first + last) / cells
        p, q = (sum(map(ramp, z)) for z in ((i + 1 - at for i in range(12)), (at - delay - i for i in range(12))))
        multipliers.append([["error", 0, min(max(math.atan2(q, p), 1e-12), math.pi / 2 - 1e-12), 1.0]])
        tree.append(["instants", at, at - delay, len(multipliers) - 1, len(multipliers) - 1])

    refute(0, cells)
    certificate = {"schema": "accdec.certificate/1", "kind": "branch and bound", "objective": "cycle", "runs": 1,
                   "bound_samples": None, "multipliers": multipliers, "tree": tree}
    return {"schema": "accdec.refutation/1", "formulation": "delay", "lower": delay, "task": task,
            "at": {"order": 11, "delays": [5], "frequencies": []},
            "parts": [{"corner": 0, "delay": delay, "certificate": certificate}]}


class ByHand(BothCheckers):
    def test_delay_of_linear_acceleration(self):
        """At right angles d = L (1 - sqrt(eps/(v L T/4 cos 45 deg))), see above."""
        delay = 12 * (1 - math.sqrt(30e-6 / (0.1e-3 * 12 / 4 * math.sqrt(0.5))))
        limits = {"acceleration_max_mm_s2": 100 / 0.012 * (1 + 1e-9)}
        corner = {"name": "A", "angle_deg": 90, "heading_deg": 0, "feed_in_mm_min": 6000, "error_max_um": 30}
        task = {"sample_period_ms": 1, "axis": [{"name": name} | limits for name in "xy"], "corner": [corner]}
        self.both(by_hand(task, 0.99 * delay, 64), True)
        self.both(by_hand(task, 0.999 * delay, 256), True)
        self.both(by_hand(task, 1.0001 * delay, 256), "is not refuted by its multipliers")


class ShippedSuites(BothCheckers):
    """The second checker takes the shorter half only: it needs a minute for all."""

    def test_all_are_proved(self, part=0.5):
        for suite in ("quick", "forms"):
            with tempfile.TemporaryDirectory() as folder:
                entries, proofs = write_instances(folder, str(ROOT / f"problems/suite/{suite}.toml"))
            self.assertEqual(len(proofs), len(entries))
            names = sorted(proofs, key=lambda name: len(json.dumps(proofs[name])))
            for i, name in enumerate(names):
                with self.subTest(name):
                    accepted, words = verified(proofs[name])
                    self.assertTrue(accepted, words)
                    if i < part * len(names):
                        accepted, words = verdict(proofs[name])
                        self.assertIs(accepted, True, words)


class EveryShippedProof(ShippedSuites):
    def test_all_are_proved(self, part=1.0):
        super().test_all_are_proved(part)


if __name__ == "__main__":
    unittest.main()
