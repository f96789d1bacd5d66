"""A servo behind the filter of a program, against a simulation of the loop by its own formulas: fourth order, T/50."""
import json
import math
import random

import numpy as np
import pytest

import accdec

T = 1e-3


def task(gain, feedforward, **axis):
    return accdec.Task(sample_period=T, axes={"velocity_max": 0.3, "acceleration_max": 3.0, "jerk_max": 300.0,
                                              "servo_gain": gain, "velocity_feedforward": feedforward, **axis},
                       program=True)


def loop(command, gain, feedforward, steps=50):
    """Positions at the samples of x' = Kv (s - x) + g s' for the command s, which moves evenly within a sample."""
    h = T / steps

    def sample(x, s, v):
        for i in range(steps):
            now = s + i * h * v
            half, end = now + h / 2 * v, now + h * v
            k1 = gain * (now - x) + feedforward * v
            k2 = gain * (half - x - h / 2 * k1) + feedforward * v
            k3 = gain * (half - x - h / 2 * k2) + feedforward * v
            k4 = gain * (end - x - h * k3) + feedforward * v
            x = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        return x

    # The end of a sample is linear in its begin, the command and the speed there.
    of_x, of_s, of_v = sample(1.0, 0.0, 0.0), sample(0.0, 1.0, 0.0), sample(0.0, 0.0, 1.0)
    motion = [command[0]]
    for before, after in zip(command, command[1:]):
        motion.append(of_x * motion[-1] + of_s * before + of_v * (after - before) / T)
    return np.array(motion)


def random_program(seed):
    """Straight moves of 3 to 25 mm that turn by 30 to 170 degrees, with points of the corners in m."""
    draw = random.Random(seed)
    heading, at, points = draw.uniform(0, 360), np.zeros(2), []
    text = "G21 G90\n"
    for i in range(12):
        heading += draw.choice([-1, 1]) * draw.uniform(30, 170)
        at = at + draw.uniform(3, 25) * np.array([math.cos(math.radians(heading)), math.sin(math.radians(heading))])
        mode = draw.choice(["G64 P0.02", "G64 P0.05", "G64 P0.1", "G61", "G61.1"])
        text += f"{mode}\nG1 X{at[0]:.4f} Y{at[1]:.4f} F{draw.uniform(1500, 9000):.0f}\n"
        points.append(np.round(at, 4) * 1e-3)
    return text + "M2\n", points


@pytest.mark.parametrize("seed, gain, feedforward", [(1, 200.0, 0.0), (2, 80.0, 0.8), (3, 35.0, 0.0), (4, 400.0, 0.3)])
@pytest.mark.parametrize("feeds", ["choose", "keep"])
def test_corner_errors_are_those_of_the_loop(tmp_path, seed, gain, feedforward, feeds):
    text, points = random_program(seed)
    (tmp_path / "part.ngc").write_text(text)
    plan = accdec.program(tmp_path / "part.ngc", task(gain, feedforward), feeds=feeds, time_limit=4)
    assert plan.success, plan.message
    samples = plan.samples()
    rest = int(round(10.0 / gain / T))
    command = np.vstack([samples["position"], np.tile(samples["position"][-1], (rest, 1))])
    motion = loop(command, gain, feedforward)
    assert np.abs(motion[:len(samples["motion"])] - samples["motion"]).max() < 1e-9
    ends = [b for b in range(len(plan.lines)) if b + 1 == len(plan.lines) or plan.lines[b] != plan.lines[b + 1]]
    assert len(ends) == len(points)
    after = 0
    for block, point in list(zip(ends, points))[:-1]:
        # In the order of the program: the path may come near a corner more than once.
        distance = np.linalg.norm(motion[after:] - point, axis=1)
        near = np.flatnonzero(distance <= max(2.0 * plan.errors[block], 0.2e-3))
        first = near[0]
        last = first + next((i for i in range(1, len(near)) if near[i] != first + i), len(near))
        error = distance[first:last].min()
        assert error == pytest.approx(plan.errors[block], abs=2e-6)
        assert error <= plan.tolerances[block] * (1 + 1e-6)
        after += first
    outside = np.linalg.norm(motion[len(samples["time"]) - 1:] - motion[-1], axis=1) > plan.servo["within"]
    settled = (np.flatnonzero(outside)[-1] + 1) * T if outside.any() else 0.0
    assert plan.servo["settling"] == pytest.approx(settled, abs=1.001 * T)


def test_legs_bend_where_servos_differ(tmp_path):
    """One move from rest to rest: each axis follows by its own loop, and the program says how far they leave the line."""
    gains = (60.0, 90.0)
    axes = [{"name": name, "velocity_max": 0.3, "acceleration_max": 3.0, "jerk_max": 300.0, "servo_gain": gain}
            for name, gain in zip("xy", gains)]
    (tmp_path / "part.ngc").write_text("G21 G90 F6000\nG1 X24 Y18\nM2\n")
    plan = accdec.program(tmp_path / "part.ngc", accdec.Task(sample_period=T, axes=axes, program=True), time_limit=4)
    assert plan.success, plan.message
    command = plan.samples()["position"]
    command = np.vstack([command, np.tile(command[-1], (400, 1))])
    motion = np.column_stack([loop(column, gain, 0.0) for column, gain in zip(command.T, gains)])
    off = np.abs(0.6 * motion[:, 0] - 0.8 * motion[:, 1])
    assert plan.servo["leg_error"] == pytest.approx(off.max(), rel=1e-6)
    assert plan.servo["leg_line"] == 2


def test_loads_and_limits(tmp_path):
    """Force is of the motion, acceleration of the command."""
    text, _ = random_program(7)
    (tmp_path / "part.ngc").write_text(text)
    plan = accdec.program(tmp_path / "part.ngc", task(60.0, 0.0, mass=25.0, damping=80.0, force_max=48.0), time_limit=4)
    assert plan.success, plan.message
    command = plan.samples()["position"]
    motion = loop(np.vstack([command, np.tile(command[-1], (400, 1))]), 60.0, 0.0)
    velocity = np.diff(motion, axis=0) / T
    force = 25.0 * np.diff(velocity, axis=0, prepend=0.0 * velocity[:1]) / T + 80.0 * velocity
    assert np.abs(force).max() <= 48.0 * (1 + 1e-6)
    acceleration = np.diff(command, n=2, axis=0) / T**2
    assert np.abs(acceleration).max() <= 3.0 * (1 + 1e-6)
    reported = {use["axis"]: use["value"] for use in json.loads(plan.to_json())["limits"] if use["kind"] == "force"}
    for column, name in enumerate(plan.samples()["axes"]):
        assert reported[name.lower()] == pytest.approx(np.abs(force[:, column]).max(), rel=1e-6)
