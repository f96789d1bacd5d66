"""Both checkers on proofs of free taps with the delays that a control has. Needs a built program (ACCDEC_BINARY)."""
import copy
import sys
import unittest

sys.dont_write_bytecode = True
from both_checkers_test import BothCheckers, designed  # noqa: E402 isort:skip

TASK = """sample_period_ms = 1
[controller]
delays = ["{kind}"]
{control}
[design]
order_max = 60
[[axis]]
acceleration_max_mm_s2 = 6000
{axis}
[[corner]]
name = "A"
angle_deg = 95
feed_in_mm_min = 6000
error_max_um = {first}
[[corner]]
name = "B"
angle_deg = {angle}
heading_deg = 20
feed_in_mm_min = {feed}
error_max_um = {error}
weight = 2
"""
WIDTHS = {
    "unequal feeds": {},
    "equal feeds": {"feed": 6000},
    "latency": {"control": "in_position_latency_ms = 4"},
    "smoothing": {"control": "prefilter_taps = [0.25, 0.5, 0.25]"},
    "of the motion": {"control": 'in_position_of = "actual"', "axis": "servo_gain_1_s = 200"},
    "of the command": {"axis": "servo_gain_1_s = 200"},
    "by axis": {"control": 'in_position_by = "axis"'},
    "by axis, equal feeds": {"control": 'in_position_by = "axis"', "feed": 6000},
    "by axis, of the motion": {"control": 'in_position_by = "axis"\nin_position_of = "actual"',
                               "axis": "servo_gain_1_s = 200"},
}


class OneWidth(BothCheckers):
    def result(self, **parts):
        parts = {"kind": "in-position", "control": "", "axis": "", "first": 40, "feed": 4000, "angle": 60,
                 "error": 25, **parts}
        return designed(TASK.format(**parts))

    def test_proofs(self):
        for name, parts in WIDTHS.items():
            with self.subTest(name):
                result = self.result(**parts)
                self.assertEqual((result["status"], result["certificate"]["in_position"]), ("optimal", True))
                self.both(result, True)
                self.refuse_forgeries(result)

    def refuse_forgeries(self, result):
        """A bound that is a sample longer; a proof that hides its delays; a control with others."""
        proof = result["certificate"]
        longer = {"bound_samples": proof["bound_samples"] + 1}
        self.both(dict(result, lower_bound_s=result["lower_bound_s"] + 1e-3, certificate=proof | longer), "")
        self.both(dict(result, certificate=proof | {"in_position": False}), "")
        self.both(dict(result, certificate=proof | {"in_position": 1}), "")
        other = result["task"] | {"controller": dict(result["task"]["controller"], delays=["dwell"])}
        self.both(dict(result, task=other), "")

    def test_rows_and_lemmas_of_widths(self):
        result = self.result(first=5, feed=2500, angle=120, error=10)
        proof = result["certificate"]
        self.assertIn("width", {row[0] for rows in proof["multipliers"] for row in rows})
        self.assertTrue(any("from" in lemma for lemma in proof["lemmas"]))
        bare = [[row for row in rows if row[0] != "width"] for rows in proof["multipliers"]]
        self.both(dict(result, certificate=proof | {"multipliers": bare}), "not refuted by its multipliers")
        turned = [[["width", row[2], row[1], row[3]] if row[0] == "width" else row for row in rows]
                  for rows in proof["multipliers"]]
        self.both(dict(result, certificate=proof | {"multipliers": turned}), "")
        for change in (lambda lemma: lemma.pop("from", None), lambda lemma: lemma.update({"from": [[7, 1]]}),
                       lambda lemma: lemma.update({"from": [[0, 55]]})):
            forged = copy.deepcopy(result)
            for lemma in forged["certificate"]["lemmas"]:
                if "from" in lemma:
                    change(lemma)
            self.both(forged, "")


SLOW = """sample_period_ms = 1
[controller]
delays = [{kinds}]
corner_feed_step = 0.1
{control}
[design]
order_max = 40
{design}
[[axis]]
acceleration_max_mm_s2 = 6000
jerk_max_mm_s3 = 800000
[[corner]]
name = "A"
angle_deg = 95
feed_in_mm_min = 6000
error_max_um = 250
[[corner]]
name = "B"
angle_deg = 60
heading_deg = 20
feed_in_mm_min = 4000
error_max_um = 150
weight = 2
"""
FEEDS = {
    "feeds": {"kinds": '"corner-feed"'},
    "and none lower": {"kinds": '"corner-feed", "continuous"'},
    "and stops": {"kinds": '"corner-feed", "exact-stop"', "design": 'objective = "corner"'},
    "behind a smoothing": {"control": "prefilter_taps = [0.25, 0.5, 0.25]"},
}


class CornerFeeds(BothCheckers):
    def test_proofs(self):
        for name, parts in FEEDS.items():
            with self.subTest(name):
                parts = {"kinds": '"corner-feed", "continuous"', "control": "", "design": "", **parts}
                result = designed(SLOW.format(**parts))
                self.assertEqual((result["status"], result["certificate"]["kind"]), ("optimal", "corner feeds"))
                self.both(result, True)
                self.refuse_forgeries(result)

    def test_no_filter_at_any_part(self):
        """Without a delay no filter within the acceleration errs by less than 0.98 of 17 equal taps: at 95 degrees,
        0.068 mm/sample x 4.23 samples, about 280 um. At a tenth of the feed that is 28 um."""
        for kinds in ('"corner-feed"', '"corner-feed", "continuous"'):
            task = SLOW.format(kinds=kinds, control="", design="").replace("error_max_um = 250", "error_max_um = 25")
            result = designed(task)
            self.assertEqual((result["status"], result["certificate"]["kind"]), ("infeasible", "corner feeds"))
            self.assertIsNone(result["certificate"]["bound_samples"])
            self.both(result, True)
            self.both(dict(result, certificate=result["certificate"] | {"parts": []}), "")
            self.both(dict(result, certificate=result["certificate"] | {"bound_samples": 42}), "")
            task = copy.deepcopy(result["task"])
            task["corner"][0]["error_max_um"] = 60
            self.both(dict(result, task=task), "")

    def refuse_forgeries(self, result):
        proof, task = result["certificate"], result["task"]
        longer = dict(result, lower_bound_s=result["lower_bound_s"] + 1e-4, status="feasible")
        self.both(longer | {"certificate": proof | {"bound_samples": proof["bound_samples"] + 0.1}}, "")
        for i, part in enumerate(proof["parts"]):
            self.both(dict(result, certificate=proof | {"parts": proof["parts"][:i] + proof["parts"][i + 1:]}), "")
            slower = part | {"multiples": [1 for _ in part["multiples"]]}
            if max(part["multiples"]) > 1:
                self.both(dict(result, certificate=proof | {"parts": [*proof["parts"][:i], slower,
                                                                      *proof["parts"][i + 1:]]}), "")
        for change in ({"delays": ["dwell", "corner-feed"]}, {"corner_feed_step": 0.05}):
            self.both(dict(result, task=task | {"controller": task["controller"] | change}), "")
        tree = proof["parts"][0]["orders"]  # of corners at their feeds, if anything
        self.both(dict(result, certificate=tree | {"bound_samples": proof["bound_samples"]}), "")
        given = [corner | {"delay_samples": 0} for corner in task["corner"]]
        self.both(dict(result, task=task | {"corner": given}), "")


if __name__ == "__main__":
    unittest.main()
