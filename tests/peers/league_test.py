#!/usr/bin/python3
"""The league's checker against motions in closed form, and its runs against planners that misbehave."""
import os
import pathlib
import subprocess
import sys
import tempfile
import time
import types
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import numpy as np

import check
import league
import league_page
import league_rows

T = check.T


def along(distance, speed, acceleration):
    """Positions every T of a trapezoid of speed whose phases are whole numbers of samples."""
    up, flat = round(speed / acceleration / T), round((distance / speed - speed / acceleration) / T)
    steps = np.concatenate([np.arange(1, up + 1), np.full(flat - 1, up), np.arange(up, 0, -1)]) * acceleration * T * T
    return np.concatenate([[0.0], np.cumsum(steps)])


def line(x, y=0.0):
    return np.column_stack([x, np.zeros(len(x)) + y, np.zeros(len(x))])


class Checker(unittest.TestCase):
    points, tolerances = np.array([[0.0, 0, 0], [10, 0, 0]]), np.zeros(2)

    def judge(self, motion, points=None, tolerances=None, jerk=0, acceleration=1000, velocity=200):
        row = check.check(motion, self.points if points is None else points,
                          self.tolerances if tolerances is None else tolerances, acceleration, velocity, jerk)
        return {"acceleration": acceleration, **row}

    def test_a_trapezoid_holds_its_limits(self):
        row = self.judge(line(along(10, 50, 1000)))
        self.assertAlmostEqual(row["time_s"], 10 / 50 + 50 / 1000, delta=1.001 * T)
        self.assertEqual(check.breaks(row), "")
        self.assertAlmostEqual(row["acceleration_pct"], 0, delta=1e-6)
        self.assertAlmostEqual(row["velocity_pct"], 100 * (50 / 200 - 1), delta=1e-6)

    def test_more_than_a_limit_is_named(self):
        fast = line(along(10, 50, 1000))
        self.assertIn("acceleration by 25.0 %", check.breaks(self.judge(fast, acceleration=800)))
        self.assertIn("velocity by 25.0 %", check.breaks(self.judge(fast, velocity=40)))
        # A step of the acceleration of 1000 mm/s^2 is a jerk of 10^6 mm/s^3.
        self.assertIn("jerk by 1900.0 %", check.breaks(self.judge(fast, jerk=50000)))

    def test_a_corner_is_measured_from_its_point(self):
        points = np.array([[0.0, 0, 0], [10, 0, 0], [10, 10, 0]])
        # Straight from (9.9, 0) to (10, 0.1): half the diagonal of 0.1 from the corner, 70.71 um.
        leg = along(10, 50, 1000)[:-1]
        leg = leg[leg < 9.9]
        corner = np.vstack([line(leg), [[9.9, 0, 0], [10, 0.1, 0]]])
        rest = np.array([[10, y, 0] for y in np.linspace(0.15, 10, 300)])
        motion = np.vstack([corner, rest])
        row = self.judge(motion, points, np.array([0, 0.1, 0]))
        self.assertAlmostEqual(row["error_um"], 1e3 * 0.1 / np.sqrt(2), delta=0.01)
        self.assertAlmostEqual(row["point_um"], 1e3 * (0.1 / np.sqrt(2) - 0.1), delta=0.01)
        row = self.judge(motion, points, np.array([0, 0.05, 0]))
        self.assertIn("tolerance at a point by 20.7 um", check.breaks(row))

    def test_a_motion_that_leaves_its_leg_is_found(self):
        x = along(10, 50, 1000)
        row = self.judge(line(x, 0.2 * np.sin(np.pi * x / 10) ** 2), tolerances=np.array([0.15, 0.15]))
        self.assertAlmostEqual(row["path_um"], 50, delta=0.5)
        self.assertIn("tolerance along the path", check.breaks(row))
        self.assertNotIn("at a point", check.breaks(row))

    def test_it_must_arrive(self):
        self.assertIn("does not end", check.breaks(self.judge(line(along(9, 50, 1000)))))
        with self.assertRaisesRegex(ValueError, "nothing moves"):
            self.judge(line(np.zeros(5)))


class Planners(unittest.TestCase):
    def motion(self, command, **limits):
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            options = types.SimpleNamespace(accdec="accdec")
            before = league.LIMIT, league.LARGEST
            league.LIMIT, league.LARGEST = limits.get("seconds", 20), limits.get("bytes", before[1])
            try:
                return league.motion_of({"name": "mine", "command": command}, folder / "it's.ngc", 1000, 0, options, folder)
            finally:
                league.LIMIT, league.LARGEST = before

    def test_a_line_is_a_planner(self):
        motion, report = self.motion("printf 'z_mm,t,x_mm\\n1,0,2\\n3,0,4\\n' > {samples}; test {velocity} = 200 && grep -q 1000 {task}")
        self.assertEqual(motion.tolist(), [[2, 0, 1], [4, 0, 3]])
        self.assertEqual(report, {})

    def test_failures_have_a_reason(self):
        for command, reason in {
            "exit 3": "no samples .exit code 3",
            "echo no licence >&2; exit 1": "no licence .exit code 1",
            "true": "no samples",
            "printf 'x_mm,y_mm\\n1,nan\\n' > {samples}": "a position is no number",
            "printf 'a,b\\n1,2\\n' > {samples}": "names none of x_mm",
            "printf 'x_mm\\n' > {samples}": "no samples",
            "printf 'x_mm,y_mm\\n1\\n' > {samples}": "",
            "mkfifo {samples}": "no samples",
            "mkdir {samples}": "no samples",
            "ln -s /dev/zero {samples}": "no samples",
            "truncate -s 300M {samples}": "more than 200000000 bytes",
        }.items():
            with self.subTest(command), self.assertRaisesRegex(ValueError, reason):
                self.motion(command)

    def test_a_planner_that_hangs_forks_or_writes_without_end_is_stopped(self):
        with self.assertRaisesRegex(ValueError, "did not end within 1 s"):
            self.motion("sleep 100 & sleep 100", seconds=1)
        with self.assertRaisesRegex(ValueError, "exit code"):
            self.motion("yes > {samples}", bytes=100000)
        with self.assertRaisesRegex(ValueError, "exit code"):
            self.motion("yes >&2", bytes=100000)

    def test_nothing_outlives_a_planner(self):
        mark = "8765%d" % os.getpid()
        began = time.monotonic()
        with self.assertRaisesRegex(ValueError, "no samples"):  # the sleepers hold its standard error open
            self.motion("for i in 1 2 3; do (setsid sleep %s &); done; setsid -f sleep %s; sleep 0.2" % (mark, mark))
        self.assertLess(time.monotonic() - began, 10)
        self.assertNotEqual(subprocess.call(["pgrep", "-f", "^sleep " + mark]), 0)

    def test_reports_of_others_are_refused(self):
        for report in ([], {"bounds": 3}, {"bounds": [{}]}, {"bounds": [{"name": "x", "time_s": "y"}]}):
            with self.subTest(report), self.assertRaisesRegex(ValueError, "its report"):
                league.bounds_of(report)

    def test_entries_are_checked_before_anything_runs(self):
        good = 'name = "a"\ncommand = "x"\n'
        for text, message in {
            "": "planner",
            "planner = 3": "no list",
            "planner = [3]": "1: expected a table",
            "\xff": "planner",
            "[[planner]]\n" + good + 'comand = "x"': "comand = 'x'; allowed are name",
            "[[planner]]\ncommand = 'x'": "has no name",
            "[[planner]]\n" + good + "[[planner]]\n" + good: '2: the name "a" is taken',
            "[[planner]]\n" + good + 'jerk = "no"': '"own" or "ignored"',
            "[[planner]]\n" + good + 'seconds = "x"': "seconds = 'x'",
            "[[planner]]\n" + good + "jobs = 0": "at least 1",
            "[[planner]]\n" + good + "needs = [1]": "needs has 1",
            "[[planner]]\n" + good + 'needs = ["{program}"]': "{program} stands for nothing; allowed are {accdec}",
            "[[planner]]\nname = 'a'\ncommand = 'x {unknown}'": "{unknown} stands for nothing; allowed are {acc",
            "[[planner]]\nname = 'a'\ncommand = 'x {0}'": "{0} stands for nothing",
            "[[planner]]\nname = 'a'\ncommand = 'x {jerk.real}'": "stands for nothing",
            "[[planner]]\nname = 'a'\ncommand = 'x {jerk:>9}'": "stands for nothing",
            "[[planner]]\nname = 'a'\ncommand = 'x {jerk'": "1 command: expected '}'",
            "[[planner]]\nname = 'a'\ncommand = 'x }'": "1 command: Single '}'",
        }.items():
            with self.subTest(text), tempfile.TemporaryDirectory() as folder:
                file = pathlib.Path(folder) / "mine.toml"
                file.write_text(text, encoding="latin-1")
                with self.assertRaises(SystemExit) as ended:
                    league.entries(types.SimpleNamespace(league=file))
                self.assertIn("mine.toml: ", str(ended.exception))
                self.assertIn(message, str(ended.exception))
        everything = league.entries(types.SimpleNamespace(league=None))
        self.assertEqual(everything[0]["name"], "LinuxCNC 2.9")


class Rows(unittest.TestCase):
    def test_they_are_read_as_written(self):
        rows = [{"program": "a", "acceleration": 500, "jerk": 0, "planner": "p", "time_s": 1.25, "error_um": 3.0,
                 "point_um": 2.5, "path_um": -9.0, "end_um": 0.0, "velocity_pct": -50.0, "acceleration_pct": 0.0,
                 "jerk_pct": 0.0, "any_bound_s": 1.0, "legs_bound_s": None, "failed": ""},
                {"program": "a", "acceleration": 500, "jerk": 0, "planner": "q", "failed": "no, it did not"}]
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "rows.csv"
            league_rows.write(path, rows)
            read = league_rows.read(path)
        self.assertEqual([league_rows.key(row) for row in read], [league_rows.key(row) for row in rows])
        self.assertEqual((read[0]["time_s"], read[0]["point_um"], read[0]["path_um"]), (1.25, 2.5, 0.0))
        self.assertEqual(check.breaks(read[0]), "tolerance at a point by 2.5 um")
        self.assertEqual(read[1]["failed"], "no, it did not")

    def test_who_breaks_a_limit_is_not_the_fastest(self):
        row = {"program": "a", "acceleration": 1000, "jerk": 0, "failed": "", "error_um": 0.0, "point_um": 0.0, "path_um": 0.0,
               "end_um": 0.0, "velocity_pct": 0.0, "acceleration_pct": 0.0, "jerk_pct": 0.0, "any_bound_s": None}
        rows = [{**row, "planner": "cheat", "time_s": 1.0, "jerk_pct": 50.0}, {**row, "planner": "first", "time_s": 1.2},
                {**row, "planner": "second", "time_s": 1.5}, {**row, "planner": "none", "time_s": None, "failed": "no"}]
        table, cases = league_page.standing(rows, 0)
        self.assertEqual(cases, 1)
        self.assertEqual([(t["planner"], t["holds"], t["fastest"], t["behind"], t["breaks"]) for t in table], [
            ("cheat", 0, 0, "-", "jerk 1 (50 %)"), ("first", 1, 1, "0.0 %", "nothing"), ("second", 1, 0, "25.0 %", "nothing"),
            ("none", 0, 0, "-", "no motion 1")])


if __name__ == "__main__":
    unittest.main()
