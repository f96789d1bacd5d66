"""The second checker of certificates: its arithmetic, its rows against filters that hold them, the shipped tasks'
proofs, and forgeries. Needs a built program (ACCDEC_BINARY) and, for forgeries at random, python3-numpy."""
import copy
import json
import math
import os
import random
import shutil
import subprocess
import sys
import tempfile
import unittest
from fractions import Fraction
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CHECKER = ROOT / "apps/check_certificate"
sys.dont_write_bytecode = True
sys.path[:0] = [str(CHECKER), str(ROOT / "tests/attack")]

import claim  # noqa: E402
import problem  # noqa: E402
from enclosure import (  # noqa: E402
    ONE, PI, NotCovered, Refused, cos_sin_degrees, exact, exponential, square_root, turned)
from rows import Limits  # noqa: E402
from tree import Part  # noqa: E402

BINARY = os.environ.get("ACCDEC_BINARY", str(ROOT / "build/release/apps/accdec"))


def verdict(result):
    """Whether the checker accepts a result; None where it does not know a kind. And its words."""
    try:
        return True, claim.check(result if isinstance(result, str) else json.dumps(result))
    except NotCovered as reason:
        return None, str(reason)
    except Refused as reason:
        return False, str(reason)


def part(d, k, order, cuts):
    """Of one corner: ranges of its delay, sample and contour time, and of responses by sample."""
    ranges = {(0, "d"): d, (0, "k"): k, (0, "c"): tuple(map(Fraction, k)), "N": (0, order)}
    return Part(ranges | {(s, "B"): ends for s, ends in cuts.items()})


def design(task, *options):
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "result.json")
        if isinstance(task, dict):
            import tasks

            path = os.path.join(folder, "task.toml")
            Path(path).write_text(tasks.to_toml(task))
        else:
            path = task
        subprocess.run([BINARY, "design", path, "--json", out, "-q", *options], capture_output=True, timeout=120)
        return Path(out).read_text(encoding="utf-8") if os.path.exists(out) else None


class BehindAServo(unittest.TestCase):
    TASK = (ROOT / "problems/corner/acceleration-jerk.toml").read_text(encoding="utf-8").replace(
        "[[axis]]\n", "[[axis]]\nservo_gain_1_s = 200\n")
    SECOND = "[[corner]]\nangle_deg = 60\nheading_deg = 30\nfeed_in_mm_min = 7200\nerror_max_um = 80\n"

    def test_exponential(self):
        for x in (Fraction(0), Fraction(1, 5), Fraction(1, 1000), Fraction(7), Fraction(33)):
            enclosed, known = exponential(-exact(x)), math.exp(-x)
            self.assertTrue(enclosed.lo <= enclosed.hi and enclosed.hi - enclosed.lo < 1 << 12)
            self.assertAlmostEqual(enclosed.lo / ONE / known, 1, delta=1e-14)

    def test_response_is_that_of_the_loop(self):
        """Following error v (1 - g)/Kv: the mean delay of the taps."""
        table = {"servo_gain_1_s": 150, "velocity_feedforward": Fraction(1, 4)}
        taps = [tap / ONE for tap in problem.read_servo([table, dict(table)], Fraction(1, 1000)).lo]
        self.assertAlmostEqual(sum(taps), 1, delta=1e-14)
        self.assertAlmostEqual(sum(k * tap for k, tap in enumerate(taps)), 1000 * 0.75 / 150, delta=1e-9)

    def test_designs_behind_a_servo(self):
        with tempfile.TemporaryDirectory() as folder:
            for text in (self.TASK, self.TASK + self.SECOND):
                path = os.path.join(folder, "task.toml")
                Path(path).write_text(text, encoding="utf-8")
                result = json.loads(design(path))
                self.assertEqual(verdict(result)[0], True, verdict(result)[1])
                for axis in result["task"]["axis"]:  # almost an ideal servo: shorter designs exist
                    axis["servo_gain_1_s"] = 9000
                self.assertEqual(verdict(result)[0], False)
                result["task"]["axis"][0]["servo_gain_1_s"] = 100
                self.assertIsNone(verdict(result)[0])


class Arithmetic(unittest.TestCase):
    def test_known_values(self):
        one = 1 << 220  # Machin's formula, each series with fewer than 100 terms

        def inverse_tangent(n):
            return sum((-1) ** k * (one // n ** (2 * k + 1) // (2 * k + 1)) for k in range(100))

        machin = 16 * inverse_tangent(5) - 4 * inverse_tangent(239)
        self.assertTrue(PI.lo << 60 <= machin - 4000 and machin + 4000 <= PI.hi << 60)
        self.assertLessEqual(PI.hi - PI.lo, 2)
        cosine, sine = cos_sin_degrees(60)
        self.assertTrue(cosine.lo <= ONE // 2 <= cosine.hi)
        self.assertTrue(3 * ONE**2 // 4 in range(sine.lo**2, sine.hi**2 + 1))
        self.assertEqual(cos_sin_degrees(-90)[1].hi, -ONE)
        root = square_root(exact(2))
        self.assertTrue(root.lo**2 <= 2 * ONE**2 <= root.hi**2)

    def test_operations_enclose(self):
        rng = random.Random(1)
        for _ in range(2000):
            a, b = (Fraction(rng.randint(-(10**9), 10**9), rng.randint(1, 10**9)) for _ in range(2))
            for got, true in ((exact(a) + exact(b), a + b), (exact(a) - exact(b), a - b), (exact(a) * exact(b), a * b),
                              (exact(a) / exact(abs(b) + 1), a / (abs(b) + 1)), (exact(a) * -7, -7 * a)):
                self.assertTrue(got.lo <= true * ONE <= got.hi)
            cosine, sine = turned(0, a)
            one = cosine * cosine + sine * sine
            self.assertTrue(one.lo <= ONE <= one.hi)
            self.assertAlmostEqual(cosine.lo / ONE, math.cos(a), 9)
            self.assertAlmostEqual(sine.hi / ONE, math.sin(a), 9)


class RowsHold(unittest.TestCase):
    """A random filter whose own motion gives the limits holds every row of every part that it is in."""

    def setUp(self):
        import more  # noqa: F401  rows of the core, as they are used beside the others

        self.rng = rng = random.Random(7)
        self.order = n = rng.randint(4, 12)
        self.random_case(rng, n)

    def random_case(self, rng, n):
        weights = [rng.choice([0, 1, 2, 5, 9]) + (1 if i == n // 2 else 0) for i in range(n + 1)]
        self.taps = [Fraction(w, sum(weights)) for w in weights]
        self.delay, self.k = rng.randint(0, n + 2), rng.randint(0, 2 * n)
        self.period, self.mass, self.drag = Fraction(1, 1000), 20, rng.choice([0, 100])
        angle, feeds = rng.choice([30, 90, 120, 173]), (6000, rng.choice([3000, 6000, 9000]))
        corner = {"angle_deg": angle, "heading_deg": rng.choice([0, 20, 90]), "error_max_um": 1}
        corner |= {"feed_in_mm_min": feeds[0], "feed_out_mm_min": feeds[1]}
        task = {"sample_period_ms": 1, "corner": [corner], "axis": [{"mass_kg": 20, "damping_N_s_m": self.drag}] * 2,
                "mode": [{"frequency_Hz": 37, "residual_max": 1}]}
        self.problem = problem.read(task)
        self.set_limits()

    def response(self, k):
        return sum(self.taps[: max(k, 0)], Fraction(0))

    def to_go(self, k):
        return sum(b * max(i - k, 0) for i, b in enumerate(self.taps))

    def gone(self, m):
        return sum(b * max(m - i, 0) for i, b in enumerate(self.taps))

    def motion(self, into, out, d):
        """Velocity, acceleration, jerk of an axis, in floating point."""
        n = self.order
        v = [into * float(1 - self.response(k)) + out * float(self.response(k - d)) for k in range(-2, n + d + 5)]
        a = [(y - x) * 1000 for x, y in zip(v, v[1:])]
        return v[2:], a[1:], [(y - x) * 1000 for x, y in zip(a, a[1:])]

    def set_limits(self):
        """Each as wide as the start, the blend and the stop of this filter use it."""
        corner = self.problem.corners[0]
        self.speeds = [(a.lo / ONE, b.lo / ONE) for a, b in zip(corner.speed_in, corner.speed_out)]
        wide = 1 + 1e-9
        axes = []
        for axis, (into, out) in zip(self.problem.axes, self.speeds):
            most = {kind: 1e-9 for kind in problem.LIMITS}
            for legs in ((0.0, into, 0), (into, out, self.delay), (out, 0.0, 0)):
                for v, a, j in zip(*self.motion(*legs)):
                    force = float(axis.mass) * a + float(axis.damping) * v
                    for kind, value in zip(most, (abs(v), abs(a), abs(j), abs(force), force * v, -force * v)):
                        most[kind] = max(most[kind], value * wide)
            axes.append(axis._replace(limits={kind: Fraction(value) for kind, value in most.items()}))
        self.problem.axes = axes
        fastest = [math.hypot(*v) for v in zip(*(self.motion(i, o, self.delay)[0] for i, o in self.speeds))]
        corner.speed_min = Fraction(min(fastest[: self.order + self.delay + 2]) / wide)
        p, q = float(self.to_go(self.k)) * 0.1, float(self.gone(self.k - self.delay)) * float(corner.feed_out)
        corner.error = Fraction(math.sqrt(max(p * p + q * q + 2 * p * q * corner.cosine.lo / ONE, 0)) * wide * 1e-3)
        phases = [2 * math.pi * 0.037 * i for i in range(self.order + 1)]
        rest = [sum(float(b) * f(x) for b, x in zip(self.taps, phases)) for f in (math.cos, math.sin)]
        self.problem.modes = [self.problem.modes[0]._replace(residual=Fraction(math.hypot(*rest) * wide))]

    def value(self, row, box):
        d1, _, k1, _ = box.corners[0]
        of_taps = sum(b * c for b, c in zip(self.taps, row.taps))
        return of_taps + row.others[0] * (self.delay - d1) + row.others[1] * (self.k - k1)

    def names(self, rng, box):
        """One row of every kind at random places."""
        k, sign, axis = rng.randint(1, self.order + self.delay + 2), rng.choice([1, -1]), rng.randint(0, 1)
        touch = lambda: [rng.randint(-2, self.order + 3), rng.random() < 0.5, rng.random() < 0.5]  # noqa: E731
        speeds = sorted([rng.uniform(1e-3, 0.1), 0.2])
        low, corner = rng.uniform(-1, 2), self.problem.corners[0]
        yield from ([f"blend {limit}", 0, axis, k, sign] for limit in ("acceleration", "jerk", "force"))
        yield from (["jerk", k, sign], ["force start", axis, k], ["force stop", axis, k], ["response", k, sign])
        p, q = float(self.to_go(self.k)) * 0.1, float(self.gone(self.k - self.delay)) * float(corner.feed_out)
        along = math.atan2(q * corner.sine.lo / ONE, p + q * corner.cosine.lo / ONE)  # where the error row is tight
        angle = rng.choice([rng.uniform(-4, 4), along])
        yield from (["error", 0, angle], ["range error", 0, angle, *touch(), *touch()])
        yield from (["vibration", 0, 37, rng.uniform(-4, 4)], ["power start", axis, k, *speeds])
        yield from (["regeneration stop", axis, k, *speeds], ["speed", 0, k, low, low + rng.uniform(0.1, 3)])
        yield from ([f"blend {limit}", 0, axis, k, sign, *speeds] for limit in ("power", "regeneration"))

    def test_rows(self):
        rng, kinds = self.rng, {}
        for case in range(250):
            if case % 5 == 0:
                self.order = rng.randint(4, 12)
                self.random_case(rng, self.order)
            limits, n = Limits(self.problem), self.order
            single = rng.random() < 0.5
            d1 = self.delay if single else rng.randint(0, self.delay)
            d2 = self.delay if single else self.delay + rng.randint(0, 3)
            k1, k2 = rng.randint(0, self.k), self.k + rng.randint(0, 3)
            at = rng.randint(1, n)
            cut = self.response(at)
            cuts = rng.choice([{}, {at: (cut, cut)}])
            box = part((d1, d2), (k1, k2), n, cuts)
            bounds = limits.tube(box)
            self.assertIsNotNone(bounds, "the filter is in the part")
            for s in range(-1, n + 4):
                at = min(max(s, 0), n + 1)
                self.assertTrue(bounds[0][at] <= self.response(s) * ONE + 1 <= bounds[1][at] + 2, (s, str(box)))
            for name in self.names(rng, box):
                try:
                    row = limits.row([*name, 1.0], box)
                except Refused:
                    continue  # it says nothing of this part
                kinds[name[0]] = kinds.get(name[0], 0) + 1
                self.assertLessEqual(self.value(row, box), row.bound + ONE // 10**12, (name, str(box)))
        self.assertEqual(len(kinds), 15, kinds)


class ShippedProofs(unittest.TestCase):
    """A checker is trusted because it can be read. The core alone, without `more`, accepts all that is shipped."""

    def test_core_has_less_than_1000_lines_with_comments(self):
        lines = [line for file in CHECKER.glob("*.py") for line in file.read_text(encoding="utf-8").splitlines()]
        self.assertLess(sum(bool(line.strip()) for line in lines), 1000)
        self.assertLessEqual(max(map(len, lines)), 120)

    def test_core_accepts_all(self):
        with tempfile.TemporaryDirectory() as folder:
            core, results = Path(folder) / "core", []
            core.mkdir()
            for file in CHECKER.glob("*.py"):
                shutil.copy(file, core)
            for kind in ("corner", "machine", "paper", "settings", "suite"):
                for file in sorted((ROOT / "problems" / kind).glob("*.toml")):
                    result = design(file)
                    if result and json.loads(result)["certificate"]:
                        self.assertEqual(json.loads(result)["status"], "optimal", file.name)
                        results.append(Path(folder) / f"{kind}-{file.stem}.json")
                        results[-1].write_text(result, encoding="utf-8")
            self.assertGreaterEqual(len(results), 43)
            done = subprocess.run([sys.executable, core, *results], capture_output=True, text=True, timeout=500)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            self.assertEqual(done.stdout.count(": proved: "), len(results))


class Forgeries(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.good = json.loads(design(ROOT / "problems/corner/minimum-speed.toml"))

    def refused(self, change, reason):
        bad = copy.deepcopy(self.good)
        change(bad, bad["certificate"])
        accepted, words = verdict(bad)
        self.assertIsNot(accepted, True)
        self.assertIn(reason, words)

    def test_claims(self):
        self.assertIs(verdict(self.good)[0], True)
        self.refused(lambda r, c: c.update(bound_samples=c["bound_samples"] + 1), "")
        self.refused(lambda r, c: c.update(tolerance=1e-9), "other limits")
        self.refused(lambda r, c: c.update(objective="corner"), "objective")
        self.refused(lambda r, c: r.update(lower_bound_s=2 * r["lower_bound_s"]), "above")
        self.refused(lambda r, c: r.update(lower_bound_s=None), "None stands where lower_bound_s should")
        self.refused(lambda r, c: c["tree"].pop(), "cut off")
        self.refused(lambda r, c: c["tree"].append(0), "goes on")
        self.refused(lambda r, c: r["corners"][0].update(delay_samples=0), "time of the result")
        self.refused(lambda r, c: r["task"]["corner"][0].update(error_max_um=200), "not refuted")

    def test_unknown_kinds_are_not_covered(self):
        self.refused(lambda r, c: c.update(schema="accdec.certificate/2"), "schema")
        self.refused(lambda r, c: c.update(kind="new"), "kind")
        self.refused(lambda r, c: c["tree"].__setitem__(0, ["new", 1]), "node")
        self.refused(lambda r, c: c["multipliers"][0].append(["new", 0, 1.0]), "row of the kind")
        self.assertIsNone(verdict(self.good | {"status": "new"})[0])
        for table in ("axis", "corner", "design"):
            tables = lambda r: [r["task"][table]] if table == "design" else r["task"][table]  # noqa: E731
            self.refused(lambda r, c: tables(r)[0].update(snap=1.0), f"a table `{table}` with the keys ['snap']")
        self.refused(lambda r, c: r["task"].update(mode=[{"frequency_hz": 40}]), "frequency_hz")
        self.refused(lambda r, c: r["task"].update(machine={"new": 1}), "`machine`")
        self.refused(lambda r, c: r["task"].update(supply={"new": 1}), "`task` with the keys ['supply']")

    def no_design(self, rows):
        """That this task, of which there is a design, has none: by one leaf about the delay of that design."""
        forged = copy.deepcopy(self.good)
        forged["task"]["corner"][0]["delay_samples"] = self.good["corners"][0]["delay_samples"]
        forged |= {"status": "infeasible", "filter": None, "corners": [], "lower_bound_s": None}
        forged["certificate"] |= {"bound_samples": None, "multipliers": [rows], "tree": [0]}
        return verdict(forged)

    def test_rounding_is_no_proof(self):
        for narrow in (1e-15, 5e-14, 4e-13):  # half a turn away from where the motion goes
            accepted, words = self.no_design([["speed", 0, 1, math.pi - narrow, math.pi + narrow, 1.0]])
            self.assertIs(accepted, False)
            self.assertIn("does not hold all directions", words)
        for multiplier in (1.0, 1e-303, 5e-324):
            rows = [["blend acceleration", 0, 0, k, -1, multiplier] for k in range(1, 450)]
            self.assertIs(self.no_design(rows)[0], False)

    def test_another_kind_for_a_given_filter(self):
        """Smaller delays break a limit, whatever else is said of them: neither checker takes that for another proof."""
        forged = json.loads(design(ROOT / "problems/machine/given-filter.toml"))
        for kind, accepted in (("enumeration", True), ("constant feed", False), ("corner speed", False)):
            forged["certificate"] = {"kind": kind, "schema": "accdec.certificate/1"}
            self.assertIs(verdict(forged)[0], accepted)
            with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
                json.dump(forged, file)
                file.flush()
                done = subprocess.run([BINARY, "verify", file.name], capture_output=True, timeout=120)
                self.assertEqual(done.returncode == 0, accepted, done.stdout)
        self.assertIs(verdict(dict(forged, certificate={"kind": "enumeration"}, lower_bound_s=0.086))[0], False)

    def test_at_random(self):
        """One entry damaged; what is accepted must still be true."""
        try:
            import forge
            import mutate
        except ImportError:
            self.skipTest("needs python3-numpy")
        refused = 0
        for case in range(15):  # one of every kind that there is
            rng = random.Random(case)
            task = forge.draw(rng, case)
            original = json.loads(design(task, "--time-limit", "3") or "{}")
            if not original.get("certificate"):
                continue
            self.assertIs(verdict(original)[0], True, (case, verdict(original)))
            for kind in forge.places(original["certificate"]):
                forged = copy.deepcopy(original)
                forge.forge(rng, forged["certificate"], kind)
                accepted, _ = verdict(forged)
                refused += accepted is not True
                if accepted:
                    with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
                        json.dump(forged, file)
                        file.flush()
                        self.assertIsNone(mutate.lie(task, original, file.name), (case, kind))
        self.assertGreater(refused, 30)


if __name__ == "__main__":
    unittest.main()
