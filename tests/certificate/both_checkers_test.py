"""Both checkers on the same files, forged or honest: neither may accept what is not true. Needs a built program
(ACCDEC_BINARY)."""
import copy
import json
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
from check_certificate_test import BINARY, design, verdict  # noqa: E402 isort:skip


def designed(text):
    """The result of a task, from its file's text."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "task.toml"
        path.write_text(text, encoding="utf-8")
        return json.loads(design(path))


def verified(result):
    """Whether `accdec verify` accepts a result, and its words."""
    with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
        file.write(result if isinstance(result, str) else json.dumps(result))
        file.flush()
        done = subprocess.run([BINARY, "verify", file.name], capture_output=True, text=True, timeout=120)
    return done.returncode == 0, done.stdout + done.stderr


class BothCheckers(unittest.TestCase):
    def both(self, result, expected):
        """@param expected  words of both checkers' refusals; True: they accept"""
        for accepted, words in (verified(result), verdict(result)):
            self.assertEqual(accepted is True, expected is True, words)
            self.assertIn("" if expected is True else expected, words)


LINE = """sample_period_ms = 1
[filter]
kind = "averages"
lengths = [9, 1]
[[axis]]
servo_gain_1_s = 30
[[axis]]
servo_gain_1_s = 300
[[corner]]
angle_deg = 25
heading_deg = 45
feed_in_mm_min = 6000
feed_out_mm_min = 1500
contour_max_um = {contour}
"""


class ServosThatDiffer(BothCheckers):
    def test_a_leg_off_its_line(self):
        """100 mm/s (1/30 - 1/300) s/2 = 1.5 mm beside leg 1, whatever the filter."""
        broken = designed(LINE.format(contour=1499.9))
        self.assertEqual((broken["status"], broken["certificate"]["kind"]), ("infeasible", "constant feed"))
        self.both(broken, True)
        held = designed(LINE.format(contour=1500.1))
        self.assertAlmostEqual(held["corners"][0]["contour_deviation_m"], 1.5e-3, delta=1e-11)
        self.assertTrue(verified(held)[0])
        self.both(dict(broken, task=held["task"]), "constant feed")


SLOW = """sample_period_ms = 1
[controller]
delays = ["dwell"{kind}]
{filter}
[design]
order_max = {order}
{family}
[[axis]]
acceleration_max_mm_s2 = 760
[[corner]]
name = "A"
direction_in = [0.76, 0.65]
direction_out = [0.76, -0.65]
feed_in_mm_min = 1200
error_max_um = 300
{delay}
"""


class CornerFeeds(BothCheckers):
    """A lead of N + 2 = 21 samples on both sides, 45 % of which is lost: 20 + 2 21 0.45 = 38.9 samples. With delays a
    corner takes 40 samples, and without any delay, none of order 19 has one."""

    def task(self, **parts):
        return SLOW.format(**{"kind": "", "filter": "", "family": "", "delay": "", "order": 19, **parts})

    def settings(self, **parts):
        return designed(self.task(kind=', "corner-feed"', family='family = "averages"', **parts))

    def test_a_proof_without_them_is_none_that_nothing_exists(self):
        slow = self.settings(delay="delay_samples = 0")
        self.assertEqual(slow["status"], "optimal")
        self.assertAlmostEqual(slow["cycle_time_s"], 0.0389, delta=1e-12)
        self.both(slow, True)
        taps = designed(self.task(delay="delay_samples = 0"))
        self.assertEqual((taps["status"], taps["certificate"]["kind"]), ("infeasible", "branch and bound"))
        self.both(taps, True)
        self.both(dict(taps, task=slow["task"]), "corners at their feeds")
        free = designed(self.task(kind=', "corner-feed"', delay="delay_samples = 0"))
        self.assertIn("corner-feed is not considered with free taps", free["message"])
        self.both(free, True)
        named = {"delays": ["dwell", "corner-feed"], "name": "a control with families"}
        self.assertIsNone(verdict(dict(taps, task=taps["task"] | {"controller": named}))[0])

    def test_a_proof_without_them_is_none_of_a_longer_time(self):
        slow, taps = self.settings(), designed(self.task())
        self.assertAlmostEqual(slow["free_taps_s"], 0.0389, delta=1e-12)  # 40 samples are not shorter
        self.both(slow, True)
        self.assertEqual((taps["status"], round(taps["cycle_time_s"], 12)), ("optimal", 0.04))
        self.both(taps, True)
        forged = dict(taps, task=slow["task"])
        del forged["answer"]
        self.both(forged, "corners at their feeds")

    def test_smaller_delays_of_a_given_filter_are_no_proof(self):
        """Delays take 40 samples. With twice the acceleration a corner at 95 % takes 20 + 2 21 0.05 = 22.1 of them."""
        given = '[filter]\nkind = "averages"\nlengths = [20]'
        plain, slow = (designed(self.task(filter=given, kind=kind).replace("760", "1360").replace("0.76, ", "0.7, ")
                                .replace("0.65", "0.7")) for kind in ("", ', "corner-feed"'))
        self.assertEqual((plain["status"], round(plain["cycle_time_s"], 12)), ("optimal", 0.04))
        self.both(plain, True)
        self.assertEqual((slow["status"], slow["lower_bound_s"], slow.get("certificate")), ("feasible", None, None))
        self.assertIn("corner-feed was not tried", slow["message"])
        self.assertTrue(verified(slow)[0])
        self.both(dict(plain, task=slow["task"]), "at a part of the feed")
        loads = "[[axis]]\nmass_kg = 10\ndamping_N_s_m = 1000\nforce_max_N = 10"  # less than friction at the feed
        stuck = designed(self.task(filter=given, kind=', "corner-feed"').replace("[[axis]]", loads))
        self.both(stuck, True)  # there is no design, at whatever part


SMOOTHED = """sample_period_ms = 1
[controller]
prefilter_taps = {taps}
[design]
order_max = 12
[[axis]]
acceleration_max_mm_s2 = 100000
[[corner]]
name = "A"
angle_deg = 90
feed_in_mm_min = 1200
error_max_um = 10000
[[mode]]
frequency_Hz = {frequency}
residual_max = 0.5
"""


class ConstantFeed(BothCheckers):
    def test_a_band_beside_the_sample_rate_may_be_smoothed(self):
        """1001 Hz look like 1 Hz at 1000 samples a second: the mean of 1000 samples leaves nothing of it."""
        at, beside = (designed(SMOOTHED.format(taps=[1e-3] * 1000, frequency=f)) for f in (1000, 1001))
        self.assertEqual((at["status"], at["certificate"]["kind"]), ("infeasible", "constant feed"))
        self.both(at, True)
        self.assertEqual(beside["status"], "optimal")
        self.both(dict(at, task=beside["task"]), "no limit is broken at constant feed")


JERK = """sample_period_ms = 0.5
[[axis]]
acceleration_max_mm_s2 = 100000
jerk_max_mm_s3 = 1
[[corner]]
name = "A"
angle_deg = 60
heading_deg = 30
turn = "right"
feed_in_mm_min = 13000
feed_out_mm_min = 7500
error_max_um = 2
speed_min_mm_s = 100
"""


class CornerSpeed(BothCheckers):
    def test_small_jerks_take_no_time(self):
        """From rest to the feed there are up to 10^8 samples, which nobody adds one by one."""
        result = designed(JERK)
        self.assertEqual((result["status"], result["certificate"]["kind"]), ("infeasible", "corner speed"))
        began = time.monotonic()
        for jerk in (1, 1e-3, 1e-5):
            for axis in result["task"]["axis"]:
                axis["jerk_max_mm_s3"] = jerk
            self.both(result, True)
        self.assertLess(time.monotonic() - began, 60)


    def test_smoothing_does_not_help(self):
        """The filter and the control's smoothing are one filter, too, with the same limits."""
        result = designed(JERK + "[controller]\nprefilter_taps = [0.5, 0.25, 0.25]\n")
        self.assertEqual((result["status"], result["certificate"]["kind"]), ("infeasible", "corner speed"))
        self.both(result, True)
        for axis in result["task"]["axis"]:  # as good as none
            axis |= {"acceleration_max_mm_s2": 1e7, "jerk_max_mm_s3": 1e11}
        self.both(result, "")


TURNING = """sample_period_ms = 1
[design]
order_max = 80
[[axis]]
mass_kg = 34
coulomb_N = 40
force_max_N = 300
[[corner]]
angle_deg = 50
heading_deg = 30
feed_in_mm_min = 9000
error_max_um = 50
"""


class Reversals(BothCheckers):
    def test_friction_turns_round_with_the_axis(self):
        result = designed(TURNING)
        self.assertEqual(result["status"], "optimal")
        self.both(result, True)
        tree, sets = result["certificate"]["tree"], result["certificate"]["multipliers"]
        splits = [i for i, node in enumerate(tree) if isinstance(node, list) and node[1] == "r"]
        self.assertTrue(splits)
        rows = {(s, r) for s, rows in enumerate(sets) for r, row in enumerate(rows) if row[0] == "reversal"}
        self.assertTrue(rows)
        lighter = copy.deepcopy(result)
        for axis in lighter["task"]["axis"]:
            axis["coulomb_N"] = 10  # a shorter design holds
        self.both(lighter, "")
        self.assertLess(designed(TURNING.replace("= 40", "= 10"))["cycle_time_s"], result["cycle_time_s"])
        for node in ([0, "r", 0, -1], [0, "r", 0, 2**31 - 1], [0, "r", 0, 0.5]):
            forged = copy.deepcopy(result)
            forged["certificate"]["tree"][splits[0]] = node
            self.both(forged, "")
        for sign in (-1, 1):  # of an axis that keeps its direction, and of a sample at which it may reverse
            for row in (["reversal", 0, 1, 5, sign, 1.0], ["reversal", 0, 0, 12, sign, 1.0]):
                forged = copy.deepcopy(result)
                forged["certificate"]["multipliers"] = [rows + [row] for rows in sets]
                self.both(forged, "")


STRAIGHT = """sample_period_ms = 1
[design]
order_max = 40
[[axis]]
acceleration_max_mm_s2 = 100000
[[corner]]
name = "A"
{legs}
feed_in_mm_min = 1200
delay_samples = 5
speed_min_mm_s = 12
"""


class StraightCorners(BothCheckers):
    """The speed falls by the sum of five taps that follow each other. None may be above 2/5, so eleven taps are needed:
    2/5, 2/5 and 1/5 at 0, 5 and 10."""

    def test_smallest_speeds(self):
        for legs in ("angle_deg = 180", "angle_deg = 180\nheading_deg = 30",
                     "direction_in = [0.76, 0.65]\ndirection_out = [7.6, 6.5]"):
            result = designed(STRAIGHT.format(legs=legs))
            self.assertEqual((result["status"], round(result["cycle_time_s"], 12)), ("optimal", 0.016), legs)
            self.assertIn("speed", {row[0] for rows in result["certificate"]["multipliers"] for row in rows})
            self.both(result, True)
            result["task"]["corner"][0]["speed_min_mm_s"] = 9  # then six taps do
            self.both(result, "")


class Rows(BothCheckers):
    def test_rows_without_terms_say_nothing(self):
        """Friction at the feed takes 2 of 1000 N. That is left to spare, however large the multiplier."""
        loads = "[[axis]]\nmass_kg = 10\ndamping_N_s_m = 100\nforce_max_N = 1000\n"
        parts = {"kind": "", "filter": "", "family": "", "delay": "", "order": 30}
        result = designed(SLOW.format(**parts).replace("[[axis]]\n", loads))
        self.both(result, True)
        for rows in result["certificate"]["multipliers"]:
            rows.append(["force start", 0, 500, 1e6])
        self.both(result, True)


class Format(BothCheckers):
    """What the page on the format allows and does not, both checkers see alike."""

    @classmethod
    def setUpClass(cls):
        parts = {"kind": "", "filter": "", "family": "", "delay": ""}
        cls.taps = designed(SLOW.format(**parts, order=19))
        cls.given = designed(SLOW.format(**dict(parts, filter='[filter]\nkind = "averages"\nlengths = [35]'), order=19))
        cls.family = designed(SLOW.format(**dict(parts, family='family = "averages"'), order=50))

    def refused(self, result, **members):
        self.both(dict(result, certificate=result["certificate"] | members), "")

    def test_honest(self):
        for result in (self.taps, self.given, self.family):
            self.both(result, True)
        self.both("\ufeff" + json.dumps(self.taps), True)  # a byte order mark

    def test_members(self):
        for members in ({"bound_samples": None}, {"smoothed": "no"}, {"smoothed": True}, {"conflict": 5}, {"lemmas": {}},
                        {"lemmas": None}, {"tolerance": None}, {"corner_of": None}, {"junk": 1}, {"conflict": [5, {}]}):
            self.refused(self.taps, **members)
        for members in ({"schema": "accdec.certificate/99"}, {"junk": 1}):
            self.refused(self.given, **members)
        self.both(dict(self.given, certificate={"kind": "enumeration", "schema": "accdec.certificate/1"}), True)
        refuted = sum(count for _, _, count in self.family["certificate"]["refuted"])
        self.refused(self.family, refuted=[["bogus", "nonsense", refuted]])
        self.refused(self.family, taps=self.family["certificate"]["taps"] | {"schema": "accdec.certificate/2"})
        for schema in ({"schema": "accdec.result/2"}, {"schema": None}):
            self.refused(dict(self.taps, **schema))

    def test_tables_of_the_task(self):
        task = self.taps["task"]
        for tables in ({"design": [task["design"]]}, {"axis": task["axis"][0]}, {"corner": task["corner"][0]},
                       {"controller": []}, {"mode": {}}, {"design": None}):
            self.both(dict(self.taps, task=task | tables), next(iter(tables)))

    def test_rows_that_no_proof_uses(self):
        sets = self.taps["certificate"]["multipliers"]
        for more in ([["new", 5, 0.0]], [["error", 9, 0.5, 0.0]]):
            self.refused(self.taps, multipliers=[rows + more for rows in sets])
        for unused in ([["new", 1.0]], [["error", 1.0]], 7):
            self.refused(self.taps, multipliers=sets + [unused])


if __name__ == "__main__":
    unittest.main()
