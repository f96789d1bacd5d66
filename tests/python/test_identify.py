"""Filters found in logs: as the program finds them, and as they were put in."""
import os
import subprocess

import numpy as np
import pytest

import accdec

TASK = {"sample_period": 1e-3}


def logged(taps, noise=0.0, speed=0.1):
    command = 1e-3 * speed * np.clip(np.arange(400) - 50, 0, 200)
    moved = np.convolve(np.pad(command, (len(taps) - 1, 0)), taps, "valid")
    return moved + np.random.default_rng(1).normal(0.0, noise, len(moved)) if noise else moved


def test_a_pole_behind_a_prefilter_and_two_axes():
    ratio = np.exp(-1 / 7.4)
    taps = np.convolve(ratio ** np.arange(200) * (1 - ratio), np.array([1, 5, 5, 1]) / 12)
    x = logged(taps)
    found = accdec.identify({"x": x, "y": -0.5 * x},
                            {**TASK, "controller": {"prefilter_taps": [1 / 12, 5 / 12, 5 / 12, 1 / 12]}})
    best = found["fits"][0]
    assert best["family"] == "one-pole" and best["time_constant"] == pytest.approx(7.4e-3, rel=0.01)
    assert found["moves"][0]["way"] == pytest.approx([0.02, -0.01], abs=1e-6)
    assert np.abs(found["modelled"]["x"] - x).max() < 1e-6


def test_a_file_gives_what_the_program_writes(tmp_path):
    x = logged(accdec.taps("averages", lengths=[22, 22]), 1e-6)
    (tmp_path / "task.toml").write_text("sample_period_ms = 1\n")
    rows = [f"{k},{1e3 * at:.6f}" for k, at in enumerate(x)]
    (tmp_path / "log.csv").write_text("\n".join(["t_ms,x_mm", *rows, ""]))
    ours = accdec.identify(tmp_path / "log.csv", tmp_path / "task.toml", noise=1e-6)
    said = subprocess.run([os.environ["ACCDEC_BINARY"], "identify", tmp_path / "log.csv", "--task",
                           tmp_path / "task.toml", "--noise-um", "1"], capture_output=True, text=True, check=True)
    assert f"lengths = {ours['fits'][0]['filter']['lengths']}" in said.stdout
    # Neighbours that noise hides are listed, and likelihoods are shares of one.
    assert sum(fit["likelihood"] for fit in ours["fits"]) == pytest.approx(1.0, abs=1e-3)
    assert f"{len(ours['fits']) - 1} more" in said.stdout or said.stdout.count("also fits") == len(ours["fits"]) - 1
    task = accdec.Task(**TASK, program=True, filter=ours["fits"][0]["filter"])
    assert len(task.taps) == 43


def test_units_of_a_file_and_other_names(tmp_path):
    x = logged(accdec.taps("averages", lengths=[22]), 1e-6)
    rows = [f"{k},{1e3 * at:.6f}" for k, at in enumerate(x)]
    (tmp_path / "log.csv").write_text("\n".join(["t,x", *rows, ""]))
    with pytest.raises(accdec.InputError, match="names no known unit"):
        accdec.identify(tmp_path / "log.csv", TASK)
    best = accdec.identify(tmp_path / "log.csv", TASK, units="ms,mm")["fits"][0]
    assert best["filter"]["lengths"] == [22]
    zv = {"kind": "averages", "lengths": [11], "shaper": "zv", "shaper_delay": 11}
    assert {"family": "shaper", "filter": zv} in best["aliases"]
    with pytest.raises(ValueError, match="no unit of times"):
        accdec.identify(tmp_path / "log.csv", TASK, units="mm,s")
    with pytest.raises(ValueError, match="units: belongs to a file"):
        accdec.identify({"x": x}, TASK, units="ms,mm")


def test_a_prefilter_is_all_that_is_found():
    found = accdec.identify({"x": logged(np.array([1, 5, 5, 1]) / 12)}, TASK)
    assert found["fits"][0]["family"] == "taps"
    assert found["fits"][0]["filter"]["taps"] == pytest.approx([1 / 12, 5 / 12, 5 / 12, 1 / 12], abs=1e-6)


@pytest.mark.parametrize("log, kind, text", [
    ({}, ValueError, "at least one axis"),
    ({"x": []}, ValueError, "one row of numbers"),
    ({"x": [0.0, np.nan]}, ValueError, "must be finite numbers"),
    ({"x": np.zeros(100)}, ValueError, "begin and end at rest"),
    ({"x": np.zeros(100), "y": np.zeros(99)}, ValueError, "equally many samples, got 99 and 100"),
    ({1: np.zeros(100)}, TypeError, "must be a text"),
    (7, TypeError, "must be a path"),
    ("none.csv", accdec.InputError, "no such file"),
])
def test_bad_logs_are_named(log, kind, text):
    with pytest.raises(kind, match=text):
        accdec.identify(log, TASK)


def test_units_and_noise_are_checked():
    x = logged(accdec.taps("boxcar", 20))
    with pytest.raises(ValueError, match="units of the positions"):
        accdec.identify({"x": 1e3 * x}, TASK)
    with pytest.raises(ValueError, match="noise: must be"):
        accdec.identify({"x": x}, TASK, noise=0.0)
    with pytest.raises(ValueError, match="servo"):
        accdec.identify({"x": x}, {**TASK, "axes": {"servo_gain_1_s": 100, "acceleration_max": 6.0}})
