"""Axes that turn: charts of their own in degrees, and dashes by which an axis is known in every chart."""
import json

from opened import check


def rotary(page):
    # A linear ramp of 20 ms behind the corner: 60 deg/s of b, 80 mm/s of z.
    task = {"sample_period_ms": 1, "filter": {"kind": "boxcar", "order": 19},
            "axis": [{"name": "x", "velocity_max_mm_s": 120}, {"name": "b", "velocity_max_deg_s": 110},
                     {"name": "z", "mass_kg": 10, "force_max_N": 60}],
            "corner": [{"name": "A", "direction_in": [1, 0, 0], "direction_out": [0, 0.6, 0.8],
                        "feed_in_mm_min": 6000, "feed_out_mm_min": 6000}]}
    page.value(f"accdecPage.state.replace({json.dumps(task)})")
    page.settle()
    drawn = page.value("accdecPage.page.design.views[0].quantities")
    most = {(q["kind"], q["unit"], a["name"]): max(map(abs, a["values"])) for q in drawn for a in q["axes"]}
    wanted = {("velocity", "mm/s", "x"): 100, ("velocity", "mm/s", "z"): 80, ("velocity", "deg/s", "b"): 60,
              ("acceleration", "mm/s^2", "z"): 4000, ("acceleration", "deg/s^2", "b"): 3000, ("force", "N", "z"): 40}
    for one, value in wanted.items():
        check(abs(most[one] - value) <= 1e-6 * value, f"{one}: {most[one]}")
    check(("velocity", "mm/s", "b") not in most, "degrees do not stand among millimetres")
    bounds = {(q["unit"], a["name"]): a["bounds"] for q in drawn for a in q["axes"] if q["kind"] == "velocity"}
    check(bounds["deg/s", "b"] == [110, -110] and bounds["mm/s", "x"] == [120, -120], f"limits of velocity {bounds}")
    dashes = {}
    for quantity in drawn:
        for axis in quantity["axes"]:
            dashes.setdefault(axis["name"], set()).add(tuple(axis["dash"]))
    check(all(len(own) == 1 for own in dashes.values()) and len(set.union(*dashes.values())) == 3,
          f"an axis has its own dashes in every chart {dashes}")
    titles = page.value("[...document.querySelectorAll('#motion h2')].map(h => h.textContent.split(/[:;]/)[0])")
    check({"velocity / mm/s", "velocity / deg/s", "acceleration / deg/s\u00b2"} <= set(titles), f"{titles}")
    task["axis"].pop(), task["corner"][0].update(direction_in=[1, 0], direction_out=[0, 1])
    page.value(f"accdecPage.state.replace({json.dumps(task)})")
    page.settle()
    texts = "[...document.querySelectorAll('#path text')].map(t => t.textContent)"
    said = "['#sentence', '#trouble', '#today'].map(s => document.querySelector(s).textContent)"
    page.wait(f"{texts}.includes('x / \u00b5m')", f"the path of two axes: {page.value(said)}")
    words = page.value(texts)
    check("b / mdeg" in words, f"the path: {words[-4:]}")
    page.value("document.querySelector('#reset').click()")
    page.settle()
