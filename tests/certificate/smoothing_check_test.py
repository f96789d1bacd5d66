"""Both checkers on proofs of filters in front of a control's smoothing. Needs a built program (ACCDEC_BINARY)."""
import sys
import unittest

sys.dont_write_bytecode = True
from both_checkers_test import BothCheckers, designed  # noqa: E402 isort:skip

TASK = """sample_period_ms = 1
[controller]
prefilter_taps = [0.1, 0.4, 0.35, 0.15]
[design]
{design}
[[axis]]
acceleration_max_mm_s2 = 6000
jerk_max_mm_s3 = 500000
{axis}
[[corner]]
angle_deg = 95
heading_deg = 2
feed_in_mm_min = 6000
{corner}
{more}
"""
ERROR = "error_max_um = 50"
CASES = {
    "corner": {},
    "servo": {"axis": "servo_gain_1_s = 200"},
    "force": {"axis": "mass_kg = 30\ndamping_N_s_m = 100\ncoulomb_N = 20\nforce_max_N = 190"},
    "inertia": {"axis": "mass_kg = 30\nforce_max_N = 150"},
    "force by speed": {"axis": "mass_kg = 30\ndamping_N_s_m = 50\nforce_speed_N = [[20, 190], [200, 100]]"},
    "mode": {"more": "[[mode]]\nfrequency_Hz = [40, 44]\nresidual_max = 0.1"},
    "damped mode": {"more": "[[mode]]\nfrequency_Hz = 40\ndamping_ratio = 0.05\nresidual_max = 0.1"},
    "mode of an axis": {"axis": 'name = "x"\n[[axis]]\nname = "y"\nacceleration_max_mm_s2 = 6000\n'
                                'jerk_max_mm_s3 = 500000',
                        "more": "[[mode]]\naxis = 'x'\nfrequency_Hz = 40\ndamping_ratio = 0.05\nresidual_max_um = 20"},
    "friction of an axis that reverses": {"axis": "mass_kg = 34\ncoulomb_N = 40\nforce_max_N = 300",
                                          "more": "[[corner]]\nangle_deg = 50\nheading_deg = 30\n"
                                                  "feed_in_mm_min = 5000\nerror_max_um = 50"},
    "contour": {"corner": ERROR + "\ncontour_max_um = 30"},
    "symmetric": {"design": "order_max = 60\nsymmetric = true"},
    "given delay": {"corner": "delay_samples = 9"},
    "three corners": {"more": "[[corner]]\nangle_deg = 60\nfeed_in_mm_min = 5000\nerror_max_um = 80\n"
                              "[[corner]]\nangle_deg = 130\nfeed_in_mm_min = 6000\nerror_max_um = 30\nweight = 3"},
    "infeasible": {"design": "order_min = 2\norder_max = 15"},
}


class Smoothing(BothCheckers):
    def test_proofs(self):
        for name, parts in CASES.items():
            with self.subTest(name):
                parts = {"design": "order_max = 60", "axis": "", "corner": ERROR, "more": "", **parts}
                result = designed(TASK.format(**parts))
                self.assertEqual(result["status"], "infeasible" if name == "infeasible" else "optimal")
                self.assertNotIn("smoothed", result["certificate"])
                self.both(result, True)
                self.refuse_forgeries(result)

    def refuse_forgeries(self, result):
        """A bound that is a sample longer, and a control without the smoothing that the proof rests on."""
        proof = result["certificate"]
        if proof["bound_samples"] is None:
            return self.both(dict(result, task=dict(result["task"], design={"order_max": 40})), "")
        longer = {"bound_samples": proof["bound_samples"] + 1}
        self.both(dict(result, lower_bound_s=result["lower_bound_s"] + 1e-3, certificate=proof | longer), "")
        # Behind three samples more, errors are larger and limits leave more: nothing of the proof fits.
        taps = [0.01] * 50 + [0.5]
        self.both(dict(result, task=dict(result["task"], controller={"prefilter_taps": taps})), "")


if __name__ == "__main__":
    unittest.main()
