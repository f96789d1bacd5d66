"""The second checker of certificates on settings of controllers and on given filters. Needs a built program
(ACCDEC_BINARY)."""
import copy
import json
import sys
import tempfile
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
from check_certificate_test import ROOT, design, verdict  # noqa: E402 isort:skip


def count_all_as(rule, refuted):
    """The same members of each family, under one rule."""
    for entry in refuted:
        entry[1] = rule


class Families(unittest.TestCase):
    def test_accepted_and_forged(self):
        good = json.loads(design(ROOT / "problems/settings/two-averages.toml"))
        self.assertEqual(good["status"], "optimal")
        accepted, words = verdict(good)
        self.assertIs(accepted, True, words)
        self.assertIn("members refuted: no member is shorter than 0.044 s; free taps: ", words)

        def refused(change, reason):
            bad = copy.deepcopy(good)
            change(bad)
            accepted, words = verdict(bad)
            self.assertIs(accepted, False)
            self.assertIn(reason, words)

        refused(lambda r: r.update(family_bound_s=0.045), "above the time")
        refused(lambda r: r.update(family_bound_s=0.043), "below that time")
        refused(lambda r: r["certificate"].update(bound_samples=43), "proves less")
        refused(lambda r: r["certificate"]["refuted"].pop(), "counts")
        for rule in ("acceleration", "delays", "velocity", "luck"):
            refused(lambda r, rule=rule: count_all_as(rule, r["certificate"]["refuted"]), "do not refute them")
        refused(lambda r: r.update(lower_bound_s=0.043), "proves less")
        refused(lambda r: r["task"]["corner"][0].update(error_max_um=80), "not refuted")
        refused(lambda r: r["task"]["design"].update(length_step_ms=2), "not those of the settings")
        refused(lambda r: r["task"]["design"].pop("family"), "names none")
        refused(lambda r: r["settings"]["values"][0].update(value=16.0), "not those of the settings")
        refused(lambda r: r["settings"].update(family="gaussian"), "not those of the settings")
        taps = good["filter"]["taps"]
        refused(lambda r: r["filter"].update(taps=[(a + b) / 2 for a, b in zip(taps, taps[1:] + taps[:1])]),
                "not those of the settings")

    def test_shapers(self):
        text = (ROOT / "problems/corner/vibration-band.toml").read_text(encoding="utf-8")
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "shaper.toml"
            path.write_text(text + '\n[design]\nfamily = "shaper"\nstages = 1\n', encoding="utf-8")
            accepted, words = verdict(design(path))
            self.assertIs(accepted, True, words)
            step = '\n[design]\nfamily = "shaper"\nstages = 1\nshaper_frequency_step_Hz = 15\n'
            path.write_text(text + step, encoding="utf-8")
            between = json.loads(design(path))
        delay = 500 / between["settings"]["values"][-1]["value"] / between["task"]["sample_period_ms"]
        self.assertGreater(abs(delay - round(delay)), 0.01)
        accepted, words = verdict(between)
        self.assertIs(accepted, True, words)
        between["task"]["design"]["shaper_frequency_step_Hz"] = 1
        accepted, words = verdict(between)
        self.assertIs(accepted, False)

    def test_widths_gaussians_and_axes_as_they_are(self):
        """Each with a tolerance that allows shorter ones, which the proof then misses. ShippedProofs accepts them."""
        for name in ("in-position", "gaussian-or-sinc", "axes-as-they-are"):
            result = json.loads(design(ROOT / f"problems/settings/{name}.toml"))
            for corner in result["task"]["corner"]:
                corner["error_max_um"] *= 1.2
            accepted, words = verdict(result)
            self.assertIs(accepted, False)
            self.assertIn("a member of the family", words)


TASK = """sample_period_ms = 2
{controller}
[design]
{family}
[[axis]]
acceleration_max_mm_s2 = 6000
jerk_max_mm_s3 = 500000
{axis}
[[corner]]
angle_deg = 95
heading_deg = 20
feed_in_mm_min = 6000
feed_out_mm_min = 5000
error_max_um = 50
{corner}
"""
AVERAGES = 'family = "averages"\nstages = 2'
MODE = "[[mode]]\nfrequency_Hz = [38, 42]\nresidual_max = 0.1"
GIVEN = '[filter]\nkind = "averages"\nlengths = [22, 15]\n'
EVERY_KIND = {
    "poles": {"family": 'family = "one-pole"\norder_max = 500'},
    "exponentials": {"family": 'family = "exponential"\ntime_constant_step_ms = 3\norder_max = 100'},
    "mzv": {"family": 'family = "shaper"\nshaper = "mzv"\nstages = 1', "corner": MODE},
    "ei": {"family": 'family = "shaper"\nshaper = "ei"\nstages = 1', "corner": MODE},
    "sets": {"family": 'family = "averages"\nstages = 3\nlength_set_ms = [4, 8, 16, 32]\nlength_set_2_ms = [6, 12]'},
    "caps": {"family": AVERAGES + "\nlength_step_ms = [2, 4]\nlength_max_ms = [30, 20]"},
    "corner feeds": {"controller": '[controller]\ndelays = ["corner-feed", "exact-stop"]', "family": AVERAGES},
    "latency": {"controller": '[controller]\ndelays = ["continuous", "in-position"]\nin_position_latency_ms = 4',
                "family": AVERAGES},
    "width by axis": {"controller": '[controller]\ndelays = ["continuous", "in-position"]\nin_position_by = "axis"',
                      "family": AVERAGES},
    "minutes": {"controller": '[controller]\nparameters = ["P", "Q"]\nparameter_units = ["min", "min"]\n'
                              "parameter_unit_ms = [60000, 60000]", "family": AVERAGES},
    "smoothing": {"controller": "[controller]\nprefilter_taps = [0.25, 0.5, 0.25]", "family": AVERAGES},
    "forces": {"family": AVERAGES, "axis": "mass_kg = 30\nforce_max_N = 150\ncoulomb_N = 20\ndamping_N_s_m = 100"},
    "a shared supply": {"controller": "[machine]\npower_total_max_W = 9\nregeneration_total_max_W = 12",
                        "family": AVERAGES, "axis": "mass_kg = 30\npower_max_W = 8\ncoulomb_N = 5"},
    "a contour": {"family": AVERAGES, "corner": "contour_max_um = 20"},
    "a smallest speed": {"family": AVERAGES, "corner": "speed_min_mm_s = 20"},
    "a curve": {"family": AVERAGES, "axis": "mass_kg = 30\nforce_speed_N = [[0, 200], [60, 180], [200, 40]]"},
    "a given filter": {"controller": GIVEN + "[machine]\npower_total_max_W = 12", "family": "order_max = 100",
                       "axis": "mass_kg = 10\nservo_gain_1_s = 80"},
    "a smoothed filter": {"controller": GIVEN + "[controller]\nprefilter_taps = [0.5, 0.5]", "family": ""},
}


class EveryKind(unittest.TestCase):
    def test_accepted_and_no_longer_so_with_wider_limits(self):
        for name, parts in EVERY_KIND.items():
            with self.subTest(name), tempfile.TemporaryDirectory() as folder:
                path = Path(folder) / "task.toml"
                filled = {"controller": "", "axis": "", "corner": "", **parts}
                path.write_text(TASK.format(**filled), encoding="utf-8")
                result = json.loads(design(path))
                accepted, words = verdict(result)
                self.assertIs(accepted, True, words)
                self.assertEqual("until the motion has settled" in words, name == "corner feeds")
                self.assertEqual(result["status"], "optimal")
                result["task"]["corner"][0]["error_max_um"] = 150
                for axis in result["task"]["axis"]:
                    axis["jerk_max_mm_s3"] *= 100
                    axis["acceleration_max_mm_s2"] *= 100
                self.assertIs(verdict(result)[0], False)


if __name__ == "__main__":
    unittest.main()
