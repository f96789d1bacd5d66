"""Tasks: from files, texts and keyword arguments, and back."""
import math
import os
import pickle
import subprocess

import numpy as np
import pytest

import accdec

FILE = """
sample_period_ms = 0.7
[[axis]]
acceleration_max_mm_s2 = 6000
mass_kg = 34
force_max_N = 465
[[corner]]
name = "A"
angle_deg = 37.5
heading_deg = 12
feed_in_mm_min = 6100
error_max_um = 33
[[mode]]
frequency_Hz = [30, 34]
residual_max = 0.1
[design]
order_max = 120
"""


def from_si():
    return accdec.Task(
        sample_period=0.7e-3, axes={"acceleration_max": 6.0, "mass": 34, "force_max": 465},
        corners={"name": "A", "angle": np.radians(37.5), "heading": np.radians(12), "feed_in": 6100 / 6e4,
                 "error_max": 33e-6},
        modes={"frequency": [30, 34], "residual_max": 0.1}, order_max=120)


def test_si_and_file_keys_make_one_task():
    si, file = from_si(), accdec.Task.parse(FILE)
    assert si == file and hash(si) == hash(file)
    assert si.to_toml() == file.to_toml()


def test_attributes_are_si():
    task = from_si()
    corner, axis = task.corners[0], task.axes[1]
    assert corner["angle"] == pytest.approx(np.radians(37.5), rel=1e-14)
    assert (corner["feed_in"], corner["feed_out"], corner["error_max"]) == (6100 / 6e4, 6100 / 6e4, 33e-6)
    assert corner["delay"] is None and task.taps is None
    turned = np.radians(12 + 180 - 37.5)
    assert corner["direction_out"] == pytest.approx([np.cos(turned), np.sin(turned)], abs=1e-14)
    assert axis["name"] == "y" and axis["force_max"] == 465.0 and axis["jerk_max"] == np.inf
    assert (task.sample_period, task.order_max) == (0.7e-3, 120)


def test_goes_and_comes_back_to_the_last_bit():
    dice = np.random.default_rng(1)
    for _ in range(50):
        task = accdec.Task(sample_period=dice.uniform(1e-4, 1e-2), axes={"acceleration_max": dice.uniform(0.1, 50)},
                           corners={"angle": dice.uniform(0.1, 3.1), "feed_in": dice.uniform(0.01, 1),
                                    "error_max": dice.uniform(1e-6, 1e-3)},
                           filter=dice.uniform(0, 1, 7))
        assert accdec.Task(**task.to_dict()) == task
        assert accdec.Task.parse(task.to_toml()) == task
        assert pickle.loads(pickle.dumps(task)) == task


def test_a_damped_mode_is_a_rectangle():
    def task(**mode):
        return accdec.Task(sample_period=1e-3, corners={"angle": 1.0, "feed_in": 0.1, "error_max": 1e-4},
                           modes={"residual_max": 0.1, **mode})

    robust = task(frequency=40, frequency_spread=0.1, damping_ratio=[0.02, 0.1])
    assert robust == task(frequency=[36, 44], damping_ratio=[0.02, 0.1]) != task(frequency=[36, 44])
    assert accdec.Task.parse(robust.to_toml()) == robust
    with pytest.raises(accdec.InputError, match="runs downwards"):
        task(frequency=40, damping_ratio=[0.1, 0.02])


def test_a_mode_of_an_axis_is_bounded_in_micrometres():
    def task(**mode):
        return accdec.Task(sample_period=1e-3, axes={"acceleration_max": 8.0}, modes={"frequency": 40, **mode},
                           corners={"angle": 2.0, "feed_in": 0.1, "error_max": 1e-4})

    bounded = task(axis="y", residual_max_um=20)
    assert accdec.Task.parse(bounded.to_toml()) == bounded and "residual_max_um = 20" in bounded.to_toml()
    assert task(residual_max=0.1).to_dict()["mode"][0]["residual_max"] == 0.1
    design = accdec.design(bounded)
    (use,) = [limit for limit in design.limits if limit["kind"] == "residual"]
    assert use["axis"] == "y" and use["value"] <= 20e-6 * (1 + 1e-9) and accdec.verify(design).accepted
    with pytest.raises(accdec.InputError, match="name it by `axis`"):
        task(residual_max_um=20)


def test_what_is_read_is_writable():
    task = accdec.Task.parse(FILE)
    assert task.replace(axes=task.axes) == task
    again = task.replace(corners=task.corners).corners[0]
    assert again["angle"] == pytest.approx(task.corners[0]["angle"])
    assert again["direction_out"] == pytest.approx(task.corners[0]["direction_out"])
    with pytest.raises(accdec.InputError, match="angle"):
        task.replace(corners={**task.corners[0], "angle": 1.0})
    servo = task.replace(axes={"jerk_max": 60.0, "servo_gain": 200.0})
    assert servo.replace(axes=servo.axes) == servo


def test_a_force_speed_curve():
    def task(curve):
        return accdec.Task(sample_period=1e-3, axes={"mass": 50.0, "jerk_max": 1000.0, "force_speed_N": curve},
                           corners={"angle": 2.0, "feed_in": 0.1, "error_max": 1e-4})

    bounded = task([[0, 400], [50, 350], [150, 150]])
    assert accdec.Task.parse(bounded.to_toml()) == bounded
    assert bounded.axes[0]["force_speed_N"] == [[0, 400], [50, 350], [150, 150]]
    assert bounded.replace(axes=bounded.axes) == bounded
    with pytest.raises(accdec.InputError, match="must not rise"):
        task([[0, 400], [50, 500]])
    axes = [{"name": "x"}, {"name": "a", "inertia": 0.8, "torque_speed_N_m": [[0, 40], [180, 30]]}]
    turning = accdec.Task(sample_period=1e-3, axes=axes, program=True)
    assert turning.axes[1]["torque_speed_N_m"] == [[0, 40], [180, 30]]
    assert turning.replace(axes=turning.axes) == turning


def test_ratings_and_rotary_axes():
    axes = [{"name": "x", "mass": 34, "force_rms": 260}, {"name": "a", "velocity_max_deg_s": 120, "inertia_kg_m2": 0.8}]
    task = accdec.Task(sample_period=1e-3, axes=axes, program=True)
    assert task.axes[0]["force_rms"] == 260.0
    assert task.axes[1]["velocity_max"] == pytest.approx(math.radians(120), rel=1e-15)
    assert task.axes[1]["inertia"] == 0.8 and "mass" not in task.axes[1]
    assert task.replace(axes=task.axes).to_toml() == task.to_toml()
    assert task.set("axis.a.velocity_max", math.pi).axes[1]["velocity_max"] == math.pi
    with pytest.raises(accdec.InputError, match="axis a has `torque_max`"):
        task.set("axis.a.force_max", 3.0)
    with pytest.raises(accdec.InputError, match=r"did you mean `velocity_max`\?$"):
        accdec.Task(sample_period=1e-3, axes=[axes[0], {"name": "a", "velocity_max_rad_s": 3.0}], program=True)
    assert "inertia_kg_m2 = 0.8" in task.to_toml()
    with pytest.raises(accdec.InputError, match="for rotary axes"):
        accdec.Task(sample_period=1e-3, axes={"name": "x", "jerk_max_deg_s3": 1.0}, program=True)


def test_use_of_limits_of_rotary_axes_is_in_radians():
    axes = [{"name": "x", "acceleration_max": 9.0},
            {"name": "a", "velocity_max": math.pi, "inertia": 0.8, "torque_max": 60.0}]
    task = accdec.Task(sample_period=1e-3, axes=axes, filter={"kind": "averages", "lengths": [40, 20]},
                       corners={"direction_in": [1, 0], "direction_out": [0, 1], "feed_in": 0.1, "delay": 20})
    uses = {(use["kind"], use["axis"]): use for use in accdec.evaluate(task).limits}
    # 100 deg/s within 40 ms
    assert uses["velocity", "a"]["value"] == pytest.approx(math.radians(100))
    assert uses["velocity", "a"]["bound"] == pytest.approx(math.pi)
    assert uses["force", "a"]["value"] == pytest.approx(0.8 * math.radians(2500))
    assert uses["force", "a"]["bound"] == pytest.approx(60.0)
    assert uses["acceleration", "x"]["value"] == pytest.approx(2.5)


def test_writes_and_reads_files(tmp_path):
    path = tmp_path / "task.toml"
    from_si().write(path)
    assert accdec.Task.read(path) == from_si()
    with pytest.raises(accdec.OutputError, match="nowhere"):
        from_si().write(tmp_path / "nowhere" / "task.toml")


def test_changes_make_new_tasks():
    task = from_si()
    assert task.set("corner.A.error_max", 50e-6) == task.set("corner.*.error_max_um", 50)
    assert task.set("corner.A.error_max", 50e-6).corners[0]["error_max"] == 50e-6
    assert task.corners[0]["error_max"] == 33e-6
    assert task.replace(sample_period=1e-3, order_max=50).order_max == 50
    assert task.replace(modes=None).to_dict().get("mode") is None
    given = task.replace(filter=[1, 2, 1])
    assert given.taps == pytest.approx([0.25, 0.5, 0.25]) and given.replace(filter=None) == task
    with pytest.raises(ValueError, match="has no corner `B`"):
        task.set("corner.B.error_max", 1e-6)


@pytest.mark.parametrize("text", [
    FILE.replace("angle_deg = 37.5", "angle_deg = 200"), FILE.replace("error_max_um", "eror_max_um"),
    FILE.replace("order_max = 120", "order_max = 1.5"), FILE + "[", ""])
def test_errors_have_the_text_of_the_command_line(tmp_path, text):
    path = tmp_path / "bad.toml"
    path.write_text(text)
    program = subprocess.run([os.environ["ACCDEC_BINARY"], "design", path], capture_output=True, text=True)
    assert program.returncode == 2
    with pytest.raises(accdec.InputError) as raised:
        accdec.design(path)
    assert str(raised.value) == program.stderr.strip()
    assert raised.value.file == str(path) and raised.value.line > 0
    assert str(raised.value) == f"{path}:{raised.value.line}:{raised.value.column}: {raised.value.message}"


@pytest.mark.parametrize("fields, words", [
    ({"corners": {"angle": 4.0, "feed_in": 0.1}}, "0 < angle <= 3.14159265"),
    ({"corners": {"angle": 1.0, "angle_deg": 57, "feed_in": 0.1}}, "both given"),
    ({"corners": {"angle": 1.0, "feed_in": float("nan")}}, "feed_in"),
    ({"corners": {"angle": 1.0, "feed_in": 0.1, "velocity": 1}}, "velocity"),
    ({"corners": []}, "no corner"),
    ({"corners": {"angle": 1.0, "feed_in": 0.1}, "axes": []}, "`axes` is an empty list"),
    ({"corners": {"angle": "wide", "feed_in": 0.1}}, "`angle` must be a number"),
    ({"corners": {"angle": 1.0, "feed_in": 0.1}, "axes": {"force_max": 10}}, "give mass or damping"),
])
def test_wrong_fields_are_named(fields, words):
    with pytest.raises(accdec.InputError, match=words):
        accdec.Task(sample_period=1e-3, **fields)


def test_no_limit_is_none_or_infinity():
    corner = {"angle": 1.0, "feed_in": 0.1}
    bare = accdec.Task(sample_period=1e-3, corners=corner)
    assert accdec.Task(sample_period=1e-3, corners={**corner, "error_max": None},
                       axes={"jerk_max": np.inf, "velocity_max": None}) == bare


@pytest.mark.parametrize("field, value, said", [
    ("axes", {"acceleration_max": -1},
     "`acceleration_max` = -1 is out of range; allowed is 0 < acceleration_max <= 100000"),
    ("axes", {"acceleration_max_mm_s2": -1}, "`acceleration_max_mm_s2` = -1 is out of range"),
    ("axes", {"acceleration_max": "a"}, '`acceleration_max` must be a number, got "a"'),
    ("corners", {"angle": 4.0, "feed_in": 0.1}, "`angle` = 4 is out of range; allowed is 0 < angle <= 3.14"),
    ("corners", {"angle_deg": 90, "feed_in": -0.1}, "`feed_in` = -0.1 is out of range"),
    ("modes", {"frequency": [30, -2], "residual_max": 0.1}, "`frequency` = -2 is out of range"),
    ("sample_period", 5, "`sample_period` = 5 is out of range; allowed is 1e-07 <= sample_period <= 1")])
def test_errors_have_the_names_and_units_given(field, value, said):
    """1 m/s^2 is not 1000 of what the user wrote."""
    with pytest.raises(accdec.InputError) as refused:
        from_si().replace(**{field: value})
    assert said in str(refused.value)
