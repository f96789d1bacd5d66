"""Sliders in a notebook: what they show is the design of the task that they say."""
import subprocess
import sys

import pytest

import accdec

TASK = accdec.Task(sample_period=1e-3, axes={"acceleration_max": 6.0},
                   corners={"name": "A", "angle_deg": 95, "feed_in": 0.1, "error_max": 50e-6})


def named(box, words):
    one, = [row.children[1] for row in box.children[:-1] if row.children[0].value.startswith(words)]
    return one


def test_a_slider_designs_again():
    pytest.importorskip("ipywidgets")
    box = accdec.sliders(TASK)
    assert box.task == TASK and box.result.fun == accdec.design(TASK).fun
    slider = named(box, "corner A error_max_um")
    assert slider.value == 50.0
    slider.value = 20.0
    narrow = TASK.replace(corners={"name": "A", "angle_deg": 95, "feed_in": 0.1, "error_max": 20e-6})
    assert box.result.fun == accdec.design(narrow).fun > accdec.design(TASK).fun
    assert "<svg" in box.children[-1].value


def test_every_limit_has_one():
    pytest.importorskip("ipywidgets")
    box = accdec.sliders(accdec.Task(sample_period=1e-3, axes=[{"acceleration_max": 6.0}, {"jerk_max": 900.0}],
                                     corners={"angle_deg": 95, "feed_in": 0.1, "error_max": 50e-6}))
    words = " ".join(row.children[0].value for row in box.children[:-1])
    for key in ("axis x acceleration_max", "axis y jerk_max", "angle_deg", "feed_in", "error_max"):
        assert key in words, words


def test_the_ends_of_sliders():
    pytest.importorskip("ipywidgets")
    box = accdec.sliders({"sample_period_ms": 1, "axis": [{"acceleration_max_mm_s2": 6000}],
                          "corner": [{"name": "A", "angle_deg": 95, "heading_deg": 0, "feed_in_mm_min": 6000,
                                      "error_max_um": 0}]})
    angle, heading, error = (named(box, f"corner A {key}") for key in ("angle_deg", "heading_deg", "error_max_um"))
    assert angle.max == 180.0 and angle.value == 95.0
    assert heading.value == 0.0 and heading.min == -180.0 and heading.max == 180.0
    assert error.value == 0.0 and error.max > 0.0
    heading.value = -30.0
    # cos(-30), sin(-30) in degrees
    assert list(box.task.corners[0]["direction_in"]) == pytest.approx([0.75 ** 0.5, -0.5]) and box.result is not None


def test_without_ipywidgets_it_says_so():
    script = ("import sys; sys.modules['ipywidgets'] = None; import accdec\n"
              "try: accdec.sliders({'sample_period': 1e-3, 'corners': {'angle_deg': 95, 'feed_in': 0.1}})\n"
              "except ImportError as error: print(error)")
    said = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert "python3-ipywidgets" in said.stdout, said.stderr
