"""Explanations and baselines: those of the command line, and what they claim, designed again."""
import json
import os
import subprocess

import numpy as np
import pytest
from test_design import everyday, hard

import accdec


def test_an_explanation_is_that_of_the_program(tmp_path):
    task = everyday()
    task.write(tmp_path / "task.toml")
    told = []
    ours = accdec.explain(task, progress=told.append)
    said = subprocess.run([os.environ["ACCDEC_BINARY"], "explain", tmp_path / "task.toml", "--json",
                           tmp_path / "e.json"], capture_output=True, text=True, check=True)
    theirs = json.loads((tmp_path / "e.json").read_text())
    assert ours.gains == theirs["gains"] and ours.bindings == theirs["bindings"] and ours.remedies == []
    assert str(ours) == said.stdout and ours.proved and ours.complete and told
    assert ours.result.fun == pytest.approx(theirs["objective_s"], rel=1e-15)


def test_what_it_gains_is_gained():
    task = everyday()
    base = accdec.design(task).fun
    alone = [gain for gain in accdec.explain(task, by=0.2).gains if gain["solved"] and gain["key"]]
    assert alone
    for gain in alone:
        relaxed = task
        for lever in gain["levers"]:
            relaxed = relaxed.set(lever["key"], lever["relaxed"])
        assert base - accdec.design(relaxed).fun == pytest.approx(gain["gain_s"], abs=1e-12), gain["name"]


def test_the_smallest_change_is_enough_and_less_is_not():
    task = everyday(order_max=12, axes={"acceleration_max": 6.0})
    assert accdec.design(task).outcome == "infeasible"
    remedies = [r for r in accdec.explain(task).remedies if r["helps"] == "yes"]
    assert remedies
    for remedy in remedies:
        enough, less = task, task
        for lever in remedy["levers"]:
            enough = enough.set(lever["key"], lever["enough"])
            # 1 % of the change less; whole numbers one less.
            change = lever["enough"] - lever["value"]
            back = 1 if lever["key"].endswith("order_max") else 0.01 * change
            less = less.set(lever["key"], lever["enough"] - back)
        assert accdec.design(enough).success, remedy["name"]
        if remedy["smallest"]:
            assert accdec.design(less).outcome == "infeasible", remedy["name"]


def test_baselines_are_no_shorter_and_hold():
    table = accdec.baselines(everyday(baseline={"kind": "trapezoid", "order": 40, "ramp": 12}))
    assert table["filter"].tolist()[:2] == ["designed", "yours"] and len(table) > 5
    found = table[table["order"].notna()]
    assert (found["cycle_time"] >= table["cycle_time"][0] - 1e-12).all()
    for name, result in table.attrs["results"].items():
        if result.success:
            assert accdec.evaluate(everyday(), result.x, result.delays).success, name
            assert accdec.verify(result), name
    best = found["cycle_time"][2:].min()
    assert table.attrs["saving"] == pytest.approx(1.0 - table["cycle_time"][0] / best, rel=1e-12)
    assert np.isfinite(table["more"][1])
    # The family of boxcars by hand: every order with the smallest delay at which all holds.
    task = everyday(axes={"acceleration_max": 6.0})
    row = accdec.baselines(task).set_index("kind").loc["boxcar"]
    shortest = min(order + 1 + int(result.delays[0]) for order in range(1, 60)
                   if (result := accdec.design(task.replace(filter=accdec.taps("boxcar", order)))).success)
    assert row["cycle_time"] == pytest.approx(1e-3 * shortest, rel=1e-12)


def test_a_finer_period_saves_rounding():
    coarse, fine = accdec.baselines(everyday()), accdec.baselines(everyday(), finer=2)
    # Every design at T is one at T/2 with taps halved, nearly: never longer by more than a sample.
    assert fine["cycle_time"][0] <= coarse["cycle_time"][0] + 1e-3
    assert fine.attrs["results"]["designed"].task.sample_period == pytest.approx(0.5e-3, rel=1e-15)


def test_its_time_is_limited():
    """The design found first is there, even if nothing else is."""
    ours = accdec.explain(hard(), time_limit=1.5, design_time_limit=1.0)
    assert not ours.complete and ours.result.success
    assert "Stopped early" in str(ours)


def test_wrong_arguments_are_named():
    with pytest.raises(ValueError, match="by"):
        accdec.explain(everyday(), by=1.5)
    with pytest.raises(ValueError, match="time_limit"):
        accdec.explain(everyday(), time_limit=0)
    with pytest.raises(ValueError, match="finer"):
        accdec.baselines(everyday(), finer=0)
