"""Whole programs, against the command line and scipy.signal."""
import json
import os
import pathlib
import re
import subprocess

import numpy as np
import pytest
import scipy.signal

import accdec

PROBLEMS = pathlib.Path(__file__).parents[2] / "problems" / "program"
MILL = PROBLEMS / "mill.toml"
STAR = PROBLEMS / "star.ngc"


def planned(folder, plan, *more):
    """The star's plan of the module, and the folder of the files that the command writes of the same."""
    subprocess.run([os.environ["ACCDEC_BINARY"], "program", str(STAR), "--task", MILL, "--plan", plan, "--json",
                    folder / "plan.json", "--samples", folder / "star.csv", "--figure", folder / "star.html", *more,
                    "-q"], check=True)
    return accdec.program(str(STAR), MILL, plan=plan), folder


def without_bounds(text):
    """How close bounds are depends on the clock."""
    row = r"(?<=>)(any motion|monotone legs)</td>(<td class=.n.[^>]*>[^<]*</td>)*"
    return re.sub(row + "|at least [^<]*|[0-9]+ linear programs(, not all of them solved)?", "", text)


@pytest.fixture(scope="module")
def fixed(tmp_path_factory):
    folder = tmp_path_factory.mktemp("fixed")
    return planned(folder, "fixed", "--emit", folder / "star.ngc")


@pytest.fixture(scope="module")
def profiles(tmp_path_factory):
    return planned(tmp_path_factory.mktemp("profiles"), "profiles")


def test_the_plan_is_that_of_the_program(fixed):
    ours, folder = fixed
    assert_same_plan(ours, folder)


@pytest.mark.parametrize("name, feeds", [("zigzag", "keep"), ("trochoid", "choose")])
def test_other_plans_are_those_of_the_program(tmp_path, name, feeds):
    file = PROBLEMS / f"{name}.ngc"
    subprocess.run([os.environ["ACCDEC_BINARY"], "program", file, "--task", MILL, "--feeds", feeds, "--json",
                    tmp_path / "plan.json", "-q"], check=True)
    assert_same_plan(accdec.program(file, MILL, plan="fixed", feeds=feeds), tmp_path)


def assert_same_plan(ours, folder):
    theirs = json.loads((folder / "plan.json").read_text())
    assert ours.success and ours.cycle_time == theirs["cycle_time_s"]
    assert ours.lower_bound == theirs["lower_bound_s"] <= ours.cycle_time
    assert len(ours.delays) == len(ours.errors) == len(ours.lines) == theirs["commanded_blocks"]
    assert ours.delays.base is ours and not ours.delays.flags.writeable
    bounded = np.isfinite(ours.tolerances)
    assert np.all(ours.errors[bounded] <= ours.tolerances[bounded] * (1 + 1e-9))


def test_bounds_stand_beside_their_classes_of_motions(fixed):
    plan, _ = fixed
    assert [bound["name"] for bound in plan.bounds] == ["way over feed", "any motion", "monotone legs"]
    assert plan.bounds[0]["time"] == plan.lower_bound
    for bound in plan.bounds:
        assert 0 < bound["time"] <= plan.cycle_time and bound["motions"]
        # A slow machine adds "not finished" to a bound.
        assert f"at least {bound['time']:.6g} s ({bound['name']}" in repr(plan)
    assert "bound, any motion" in str(plan)


def test_estimates_are_those_of_the_program(tmp_path):
    plan = accdec.program(STAR, MILL, estimate=["grbl", "klipper"],
                          estimate_options={"square_corner_velocity": 8})
    subprocess.run([os.environ["ACCDEC_BINARY"], "program", STAR, "--task", MILL, "--as", "grbl", "--as",
                    "klipper", "--as-option", "square_corner_velocity=8", "--json", tmp_path / "plan.json", "-q"],
                   check=True)
    theirs = json.loads((tmp_path / "plan.json").read_text())["estimates"]
    assert [(ours["control"], ours["time"], ours["not_known"]) for ours in plan.estimates] == [
        (other["control"], other["time_s"], other["not_known"]) for other in theirs]
    assert plan.estimates[1]["parameters"]["square_corner_velocity"] == 8.0
    assert "grbl would take" in str(plan)
    with pytest.raises(ValueError, match="parameter of grbl"):
        accdec.program(STAR, MILL, estimate=["grbl"], estimate_options={"resolution": 1})


def test_samples_are_a_filtered_motion():
    """They add up, hold the limits, and start as lfilter makes the programmed feed start."""
    plan = accdec.program(STAR, MILL, feeds="keep")
    motion = plan.samples()
    period = motion["time"][1]
    assert motion["time"][-1] == pytest.approx(plan.cycle_time, rel=1e-12)
    assert motion["position"] == pytest.approx(
        motion["position"][0] + np.cumsum(motion["velocity"], axis=0) * period, abs=1e-9)
    acceleration = np.abs(np.diff(motion["velocity"], axis=0)) / period
    limits = {axis["name"]: axis["acceleration_max"] for axis in accdec.Task.read(MILL, program=True).axes}
    for column, name in enumerate(motion["axes"]):
        assert acceleration[:, column].max() <= limits[name.lower()] * (1 + 1e-9)
    # Legs may be shortened by 1e-7 of their duration to end on a sample, and so are as much faster.
    speed = np.hypot(*motion["velocity"].T)
    assert speed.max() <= 0.1 * (1 + 1.1e-7)
    smooth = scipy.signal.lfilter(plan.taps, [1.0], np.full(len(plan.taps), 0.1))
    assert speed[1:len(smooth) + 1] == pytest.approx(smooth, rel=2e-7)  # the start from rest


def test_loads_are_those_of_the_samples():
    period, rated = 1e-3, {"x": 400.0, "y": None}
    axes = [{"name": name, "velocity_max": 0.3, "acceleration_max": 3.0, "jerk_max": 300.0, "mass": 34.0,
             "damping": 150.0, "force_rms": rating} for name, rating in rated.items()]
    ours = accdec.program(str(STAR), accdec.Task(sample_period=period, axes=axes, program=True), plan="fixed")
    samples = ours.samples()
    velocity = np.vstack([np.zeros(2), samples["velocity"][:, :2], np.zeros(2)])
    force = 34.0 * np.diff(velocity, axis=0) / period + 150.0 * velocity[1:]
    assert [load["axis"] for load in ours.axis_loads] == ["x", "y"]
    for load, column in zip(ours.axis_loads, force.T):
        assert load["peak"] == pytest.approx(np.abs(column).max(), rel=1e-6)
        assert load["rms"] == pytest.approx(np.sqrt(np.mean(column**2)), rel=3 / len(column))
        assert load.get("rms_max") == rated[load["axis"]]
    assert "axis_loads" in json.loads(ours.to_json())


def test_profiles_are_the_fastest_plan(tmp_path, profiles):
    ours, folder = profiles
    theirs = json.loads((folder / "plan.json").read_text())
    assert ours.success and ours.plan == theirs["plan"] == "profiles" and ours.cycle_time == theirs["cycle_time_s"]
    assert all(ours.cycle_time <= other["cycle_time"] for other in ours.candidates if other["verified"])
    assert ours.candidates and not ours.errors.flags.writeable
    motion, table = ours.samples(), np.genfromtxt(folder / "star.csv", delimiter=",", names=True)
    period = motion["time"][1]
    assert np.allclose(motion["time"], table["time_s"], rtol=1e-12)
    for column, name in enumerate(motion["axes"]):
        assert np.allclose(1e3 * motion["position"][:, column], table[f"{name.lower()}_mm"], atol=1e-6)
    # The samples themselves hold the limits and end where the program does.
    for axis in accdec.Task.read(MILL, program=True).axes:
        column = [name.lower() for name in motion["axes"]].index(axis["name"]) if axis["name"] in "xy" else None
        if column is not None:
            acceleration = np.diff(motion["velocity"][:, column]) / period
            assert np.abs(acceleration).max() <= axis["acceleration_max"] * (1 + 1e-9)
    bounded = np.isfinite(ours.tolerances)
    assert np.all(ours.errors[bounded] <= ours.tolerances[bounded] * (1 + 1e-9))
    accdec.plot(ours, path=tmp_path / "star.html")
    assert (tmp_path / "star.html").read_text() == ours.page()


def test_a_plan_beside_profiles_may_be_the_fastest(tmp_path):
    """Under a jerk limit and with short blocks one filter is."""
    ours = accdec.program(PROBLEMS / "raster.ngc", MILL, plan="profiles")
    times = {other["plan"]: other["cycle_time"] for other in ours.candidates}
    assert ours.success and ours.plan not in times and all(ours.cycle_time <= time for time in times.values())


def test_free_motions_are_faster_than_profiles():
    """No limit is broken, and the corner is passed within its tolerance of 0.5 mm."""
    folder = PROBLEMS / "linuxcnc"
    plan = accdec.program(folder / "corner-p0.5.ngc", folder / "limits.toml", plan="free", progress=lambda line: None)
    assert plan.success and plan.plan == "free" and plan.delays is None
    assert [other["plan"] for other in plan.candidates] == ["profiles", "fixed"]
    assert all(plan.cycle_time < other["cycle_time"] for other in plan.candidates)
    motion = plan.samples()
    acceleration = np.diff(motion["velocity"], axis=0) / motion["time"][1]
    assert np.abs(acceleration).max() <= 1.0 * (1 + 1e-6)
    assert np.hypot(*(motion["position"] - [0.05, 0.0]).T).min() <= 0.501e-3  # between two samples it is nearer
    assert "plan free" in str(plan) and "<html" in plan.page()
    with pytest.raises(RuntimeError, match="only plan fixed"):
        plan.emit()
    with pytest.raises(ValueError, match="only plan fixed keeps feeds"):
        accdec.program(folder / "corner-p0.5.ngc", folder / "limits.toml", plan="free", feeds="keep")


def test_emits_and_draws(fixed):
    plan, folder = fixed
    assert plan.emit() == (folder / "star.ngc").read_text()
    program = os.environ["ACCDEC_BINARY"]
    subprocess.run([program, "plot", folder / "plan.json", "--out", folder / "star.svg"], check=True)
    assert without_bounds(accdec.plot(plan).svg) == without_bounds((folder / "star.svg").read_text())
    assert "cycle time" in str(plan)


def test_the_page_is_that_of_the_program(fixed, profiles):
    for plan, folder in (fixed, profiles):
        assert without_bounds(plan.page()) == without_bounds((folder / "star.html").read_text())


def test_arcs_are_widened(tmp_path):
    """Where the tolerance of 10 um binds, the larger radius allows a faster motion within it."""
    circle = tmp_path / "circle.ngc"
    circle.write_text("G21 G90 G17 G64 P0.01\nG1 X5 Y0 F3000\nG3 X5 Y0 I-5 J0\nG3 X5 Y0 I-5 J0\nM2\n")
    times = []
    for widened in (False, True):
        plan = accdec.program(circle, {"sample_period": 1e-3, "axes": {"acceleration_max": 1.0, "jerk_max": 20.0}},
                              compensate_arcs=widened)
        assert plan.success
        motion = plan.samples()
        radius = np.hypot(*motion["position"].T)
        middle = slice(len(radius) * 2 // 5, len(radius) * 3 // 5)
        assert np.abs(radius[middle] - 5e-3).max() < 10.01e-6
        times.append(plan.cycle_time)
    assert times[1] < times[0]
    with pytest.raises(ValueError, match="feeds"):
        accdec.program(circle, MILL, compensate_arcs=True, feeds="keep")


def test_errors_are_those_of_the_program(tmp_path):
    bad = tmp_path / "bad.ngc"
    bad.write_text("G21 G90\nG1 X10 F100\nG1 Q\n")
    said = subprocess.run([os.environ["ACCDEC_BINARY"], "program", bad, "--task", MILL], capture_output=True, text=True)
    with pytest.raises(ValueError) as raised:
        accdec.program(bad, MILL)
    assert str(raised.value) == said.stderr.strip()
    with pytest.raises(ValueError, match="plan"):
        accdec.program(bad, MILL, plan="fastest")
