"""Both checkers on proofs of loads behind a servo. Needs a built program (ACCDEC_BINARY)."""
import copy
import sys
import unittest

sys.dont_write_bytecode = True
from both_checkers_test import BothCheckers, designed  # noqa: E402 isort:skip

TASK = """sample_period_ms = 1
{control}
[design]
{design}
[[axis]]
{axis}
{servo}
[[corner]]
angle_deg = 95
heading_deg = 2
feed_in_mm_min = 6000
{corner}
{more}
"""
ERROR, FORCE = "error_max_um = 50", "mass_kg = 30\ndamping_N_s_m = 100\nforce_max_N = 190"
SMOOTHING = "[controller]\nprefilter_taps = [0.1, 0.4, 0.35, 0.15]"
CASES = {
    "force": {},
    "feedforward": {"servo": "servo_gain_1_s = 100\nvelocity_feedforward = 0.9"},
    "measured": {"servo": "response_taps = [0, 0.3, 0.4, 0.2, 0.1]"},
    "acceleration and jerk": {"axis": FORCE.replace("190", "120") + "\nacceleration_max_mm_s2 = 6000\n"
                                       "jerk_max_mm_s3 = 900000"},
    "dry friction": {"axis": FORCE + "\ncoulomb_N = 20"},
    "inertia": {"axis": "mass_kg = 30\nforce_max_N = 150"},
    "force by speed": {"axis": "mass_kg = 30\ndamping_N_s_m = 50\nforce_speed_N = [[20, 190], [200, 100]]"},
    "smoothing": {"control": SMOOTHING},
    "friction of an axis that reverses": {"axis": "mass_kg = 34\ncoulomb_N = 40\nforce_max_N = 300",
                                          "more": "[[corner]]\nangle_deg = 50\nheading_deg = 30\n"
                                                  "feed_in_mm_min = 5000\nerror_max_um = 50"},
    "mode": {"more": "[[mode]]\nfrequency_Hz = 40\nresidual_max = 0.1"},
    "contour": {"corner": ERROR + "\ncontour_max_um = 60"},
    "symmetric": {"design": "order_max = 60\nsymmetric = true"},
    "power": {"axis": FORCE + "\npower_max_W = 10"},
    "power behind a smoothing": {"control": SMOOTHING, "axis": FORCE + "\npower_max_W = 10"},
    "regeneration": {"axis": FORCE + "\nregeneration_max_W = 5"},
    "power and acceleration": {"axis": FORCE + "\npower_max_W = 8\nacceleration_max_mm_s2 = 6000\n"
                                               "jerk_max_mm_s3 = 900000", "servo": "servo_gain_1_s = 600"},
    "smallest speed": {"corner": "error_max_um = 200\nspeed_min_mm_s = 45"},
    "given delay": {"corner": "delay_samples = 9"},
    "three corners": {"more": "[[corner]]\nangle_deg = 60\nfeed_in_mm_min = 5000\nerror_max_um = 80\n"
                              "[[corner]]\nangle_deg = 130\nfeed_in_mm_min = 6000\nerror_max_um = 30\nweight = 3"},
    "infeasible": {"design": "order_max = 12", "corner": "delay_samples = 9", "axis": FORCE.replace("190", "60")},
}


LOADS = ("force", "power", "regeneration", "speed")


def names_load(result):
    sets = [*result["certificate"]["multipliers"], *(s for s in result["certificate"].get("lemmas", []))]
    return any(load in str(row[0]) for load in LOADS for rows in sets for row in rows if isinstance(row, list))


class BehindAServo(BothCheckers):
    def test_proofs(self):
        for name, parts in CASES.items():
            with self.subTest(name):
                parts = {"control": "", "design": "order_max = 60", "axis": FORCE, "servo": "servo_gain_1_s = 200",
                         "corner": ERROR, "more": "", **parts}
                result = designed(TASK.format(**parts))
                self.assertEqual(result["status"], "infeasible" if name == "infeasible" else "optimal")
                self.assertTrue(names_load(result))
                self.both(result, True)
                self.refuse_forgeries(result)

    def refuse_forgeries(self, result):
        """A bound a sample longer; a drive of ten times the force and power; a servo that spreads every force."""
        proof = result["certificate"]
        if proof["bound_samples"] is not None:
            longer = {"bound_samples": proof["bound_samples"] + 1}
            self.both(dict(result, lower_bound_s=result["lower_bound_s"] + 1e-3, certificate=proof | longer), "")
        stronger, slower = copy.deepcopy(result), copy.deepcopy(result)
        for axis in stronger["task"]["axis"]:
            if "force_max_N" in axis:
                axis["force_max_N"] *= 10
            else:
                axis["mass_kg"] *= 0.1
            for key in {"power_max_W", "regeneration_max_W"} & axis.keys():
                axis[key] *= 10
        for axis in slower["task"]["axis"]:
            for key in ("servo_gain_1_s", "velocity_feedforward", "response_taps"):
                axis.pop(key, None)
            axis["response_taps"] = [0.02] * 50
        self.both(stronger, "")
        self.both(slower, "")


if __name__ == "__main__":
    unittest.main()
