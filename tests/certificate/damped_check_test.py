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
from check_certificate_test import design, verdict  # noqa: E402 isort:skip

import problem  # noqa: E402
from axes import modes  # noqa: E402
from enclosure import ONE  # noqa: E402
from rows import TAPS, Row, Rows  # noqa: E402
from tree import Box  # noqa: E402


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
        rows, w = Rows(problem.read(task)), 2 * math.pi * 0.04
        for angle in (0.0, 1.0, 2.5):
            row = Row(3, rows.problem.response, False)
            modes.vibration(rows, row, Box([(0, 0, 0, 9)], [(Fraction(0), Fraction(9))], 3).copy(order=3), 0, 40, Fraction(1, 10), Fraction(angle))
            self.assertEqual([what for what, _, _ in row.terms], 4 * [TAPS])
            for _, i, c in row.terms:
                known = math.exp(-0.1 * w * (3 - i)) * math.cos(w * math.sqrt(0.99) * i - angle)
                self.assertAlmostEqual(c / ONE, known, delta=1e-14)


if __name__ == "__main__":
    unittest.main()
