"""The second checker of certificates on damped modes. Needs a built program (ACCDEC_BINARY)."""
import copy
import json
import math
import os
import sys
import tempfile
import unittest
from fractions import Fraction
from pathlib import Path

sys.dont_write_bytecode = True
from check_certificate_test import design, part, verdict  # noqa: E402 isort:skip

import problem  # noqa: E402
from enclosure import ONE  # noqa: E402
from rows import Limits  # noqa: E402


class DampedModes(unittest.TestCase):
    def test_designs_and_forgeries(self):
        text = """sample_period_ms = 1
        [[axis]]
        acceleration_max_mm_s2 = 8000
        jerk_max_mm_s3 = 1000000
        [[corner]]
        angle_deg = 90
        feed_in_mm_min = 6000
        error_max_um = 100
        [[mode]]
        frequency_Hz = 42
        frequency_spread = 0.1
        damping_ratio = [0.02, 0.1]
        residual_max = 0.05
        """
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "task.toml")
            Path(path).write_text(text, encoding="utf-8")
            result = json.loads(design(path))
        self.assertEqual(verdict(result)[0], True, verdict(result)[1])
        mode = result["task"]["mode"][0]
        self.assertEqual(mode["damping_ratio"], [0.02, 0.1])
        for key, other in (("damping_ratio", [0.05, 0.1]), ("frequency_Hz", [39, 45]), ("residual_max", 0.2)):
            forged = copy.deepcopy(result)
            forged["task"]["mode"][0][key] = other
            self.assertEqual(verdict(forged)[0], False)

    def test_row_is_what_is_left(self):
        """By the filter itself at its last tap, seen at any phase."""
        task = {"sample_period_ms": 1, "corner": [{"angle_deg": 90, "feed_in_mm_min": 6000, "error_max_um": 1}],
                "axis": [{}] * 2, "mode": [{"frequency_Hz": 40, "damping_ratio": Fraction(1, 10), "residual_max": 1}]}
        limits, w = Limits(problem.read(task)), 2 * math.pi * 0.04
        for angle in (0.0, 1.0, 2.5):
            box = part((0, 0), (0, 9), 3, {})
            row = limits.row(["damped vibration", 0, 40, Fraction(1, 10), Fraction(angle), 1], box)
            self.assertEqual(len(row.taps), 4)
            for i, c in enumerate(row.taps):
                known = math.exp(-0.1 * w * (3 - i)) * math.cos(w * math.sqrt(0.99) * i - angle)
                self.assertAlmostEqual(c / ONE, known, delta=1e-14)


HEAD = """sample_period_ms = 1
[[axis]]
acceleration_max_mm_s2 = 8000
jerk_max_mm_s3 = 1000000
mass_kg = 50
{axis}
[[corner]]
angle_deg = 120
heading_deg = 10
feed_in_mm_min = 6000
{corner}
"""


def designed(axis="", corner="error_max_um = 100", end=""):
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "task.toml")
        Path(path).write_text(HEAD.format(axis=axis, corner=corner) + end, encoding="utf-8")
        return json.loads(design(path))


class LimitsOfAxes(unittest.TestCase):
    def expect_proved_but_not(self, result, forgeries):
        self.assertEqual(verdict(result)[0], True, verdict(result)[1])
        for forge in forgeries:
            forged = copy.deepcopy(result)
            forge(forged["task"])
            self.assertEqual(verdict(forged)[0], False)

    def test_modes_of_axes(self):
        result = designed(end='[[mode]]\nfrequency_Hz = 40\ndamping_ratio = 0.05\naxis = "x"\nresidual_max_um = 5\n')
        mode = {"residual_max_um": 50, "frequency_Hz": 60, "damping_ratio": 0.2, "axis": "q"}

        def forgery(key, other):
            return lambda task: task["mode"][0].update({key: other})

        self.expect_proved_but_not(result, [forgery(*change) for change in mode.items()])
        rows = [row[0] for rows in result["certificate"]["multipliers"] for row in rows]
        self.assertIn("blend vibration", rows)

    def test_force_speed_curves(self):
        result = designed(axis="force_speed_N = [[0, 350], [50, 320], [150, 150]]")
        rows = {row[0] for rows in result["certificate"]["multipliers"] for row in rows}
        self.assertTrue(rows & {"force_speed start", "force_speed stop", "blend force_speed"}, rows)

        def stronger(task):
            for axis in task["axis"]:
                axis["force_speed_N"] = [[0, 380], [50, 370], [150, 250]]

        self.expect_proved_but_not(result, [stronger])

    def test_contours(self):
        result = designed(corner="contour_max_um = 20")
        self.assertIn("contour", [row[0] for rows in result["certificate"]["multipliers"] for row in rows])
        self.expect_proved_but_not(
            result,
            [
                lambda task: task["corner"][0].update(contour_max_um=40),
                lambda task: task["corner"][0].update(angle_deg=150),
                lambda task: task["corner"][0].pop("contour_max_um"),
            ],
        )


if __name__ == "__main__":
    unittest.main()
