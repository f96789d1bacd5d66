"""The response behind the filter, against a simulation of the loop by formulas of its own: fourth order, T/50."""
import math

import numpy as np
import pytest

import accdec

T = 1e-3


def everyday(gain, feedforward=0.0, **changes):
    servo = {} if gain is None else {"servo_gain": gain, "velocity_feedforward": feedforward}
    fields = dict(sample_period=T, axes={"acceleration_max": 6.0, "jerk_max": 500.0, **servo},
                  corners={"angle_deg": 95, "feed_in": 0.1, "feed_out": 0.1, "error_max": 50e-6})
    return accdec.Task(**{**fields, **changes})


def loop(task, taps, delay, gain, feedforward, steps=50):
    """Positions at the samples of a position control x' = Kv (s - x) + g s' with the filtered command s, relative to
    the corner point. The velocity command is constant within a sample."""
    corner = task.corners[0]
    rest = int(round(30.0 / (gain * T))) + len(taps)
    into, out = (corner[f"feed_{leg}"] * corner[f"direction_{leg}"] for leg in ("in", "out"))
    zeros = [np.zeros((n, len(into))) for n in (rest, delay, rest)]
    command = np.vstack([np.tile(into, (2 * rest, 1)), zeros[1], np.tile(out, (2 * rest, 1)), zeros[2]])
    velocity = np.vstack([np.convolve(column, taps)[:len(column)] for column in command.T]).T
    return np.array([axis_loop(speeds.tolist(), -2 * rest * T * start, gain, feedforward, steps)
                     for speeds, start in zip(velocity.T, into)]).T


def axis_loop(velocity, s, gain, feedforward, steps):
    """Of one axis. The end of a sample is linear in its begin, the command and the speed there."""
    h = T / steps

    def sample(x, s, v):
        for i in range(steps):
            now, ahead = s + i * h * v, feedforward * v
            half, end = now + h / 2 * v, now + h * v
            k1 = gain * (now - x) + ahead
            k2 = gain * (half - x - h / 2 * k1) + ahead
            k3 = gain * (half - x - h / 2 * k2) + ahead
            k4 = gain * (end - x - h * k3) + ahead
            x += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        return x

    of_x, of_s, of_v = sample(1.0, 0.0, 0.0), sample(0.0, 1.0, 0.0), sample(0.0, 0.0, 1.0)
    x, samples = s, []
    for v in velocity:
        x = of_x * x + of_s * s + of_v * v
        s += T * v
        samples.append(x)
    return samples


def nearest(samples):
    return np.linalg.norm(samples, axis=1).min()


def test_redesign_behind_a_servo_holds_the_tolerance_in_the_loop():
    task = everyday(200.0)
    result = accdec.design(task)
    assert result.outcome == "optimal" and result.fun == pytest.approx(0.050, rel=1e-9)
    delay = int(result.delays[0])
    error = nearest(loop(task, result.x, delay, 200.0, 0.0))
    assert error <= 50e-6 * (1 + 1e-6)
    assert result.corners[0]["corner_error"] == pytest.approx(error, rel=1e-6)
    assert accdec.verify(result).accepted
    # The design without the servo, in the loop: twice its tolerance.
    ideal = accdec.design(everyday(None))
    beside = nearest(loop(task, ideal.x, int(ideal.delays[0]), 200.0, 0.0))
    assert ideal.fun == pytest.approx(0.042, rel=1e-9) and 90e-6 < beside < 110e-6


def test_two_averages_behind_a_servo():
    table = accdec.baselines(everyday(200.0), time_limit=60)
    best = table[table["filter"].str.startswith("two averages (")].iloc[0]
    assert best["order"] == 28 and best["cycle_time"] == pytest.approx(0.050, rel=1e-9)


def test_random_corners_are_predicted_as_the_loop_moves():
    dice = np.random.default_rng(7)
    for _ in range(100):
        gain, feedforward = float(np.exp(dice.uniform(np.log(30), np.log(1000)))), float(dice.choice([0, 0.5, 0.95, 1]))
        taps = np.convolve(np.ones(dice.integers(2, 40)), np.ones(dice.integers(1, 20)))
        taps, delay = taps / taps.sum(), int(dice.integers(0, 40))
        task = everyday(gain, feedforward, corners={
            "angle_deg": dice.uniform(20, 170), "heading_deg": dice.uniform(-180, 180),
            "feed_in": dice.uniform(0.02, 0.3), "feed_out": dice.uniform(0.02, 0.3), "delay": delay}, filter=taps)
        predicted = accdec.evaluate(task).corners[0]["corner_error"]
        assert predicted == pytest.approx(nearest(loop(task, taps, delay, gain, feedforward)), abs=1e-7)


def test_axes_that_differ_are_judged():
    axes = [{"servo_gain": 200.0, "name": "x"}, {"servo_gain": 100.0, "name": "y"}]
    corner = {"angle_deg": 95, "heading_deg": 20, "feed_in": 0.1, "delay": 12}
    taps = np.ones(20) / 20
    task = everyday(200.0, axes=axes, corners=corner, filter=taps)
    found = accdec.evaluate(task).corners[0]
    one, other = (loop(task, taps, 12, gain, 0.0) for gain in (200.0, 100.0))
    rows = min(len(one), len(other)) // 2
    # Both simulations have the corner at row 2 rest: the same instant counted from there.
    at = [2 * (int(round(30.0 / (gain * T))) + len(taps)) for gain in (200.0, 100.0)]
    span = min(rows, at[0], at[1])
    moved = np.column_stack([one[at[0]:at[0] + span, 0], other[at[1]:at[1] + span, 1]])
    assert found["corner_error"] == pytest.approx(np.linalg.norm(moved, axis=1).min(), rel=1e-4)
    # A straight leg is no longer straight.
    assert found["contour_deviation"] > 0
    designed = accdec.design(everyday(200.0, axes=axes))
    assert designed.outcome == "feasible" and "not proved" in designed.message


def test_nonlinear_problems_consider_it():
    task = everyday(200.0)
    problem = accdec.problem(task, "margin", order=28, delays=[21])
    assert problem.check_derivatives(problem.x0) == []
    # The start is a trapezoid; its row is the square of the error over the tolerance, less the objective.
    taps = np.minimum(np.minimum(np.arange(29) + 1, 10), 29 - np.arange(29))
    square = problem.rows(problem.x0)[problem.row_names.index("corner error, corner A")] + problem.fun(problem.x0)
    error = nearest(loop(task, taps / taps.sum(), 21, 200.0, 0.0))
    assert 50e-6 * np.sqrt(square) == pytest.approx(error, abs=1e-7)


class Cascade:
    """A position control of 200 1/s around a velocity control (8000 N s/m, 400 kN/m) at 0.25 ms, a drive that lags
    0.5 ms, and 34 kg with dry friction; each axis alone. Plant by steps of 0.05 ms."""
    gain, damping, stiffness, mass, lag, control, step = 200.0, 8000.0, 4e5, 34.0, 0.5e-3, 0.25e-3, 0.05e-3

    def __init__(self, friction=0.0):
        self.friction = friction

    def follow(self, velocity):
        """Positions at the samples, one column an axis, for a velocity command that is constant in a sample."""
        return np.array([self.follow_axis(column.tolist()) for column in velocity.T]).T

    def follow_axis(self, velocity):
        x, v, force, integral, s = (0.0,) * 5
        samples = []
        for command in velocity:
            for _ in range(round(T / self.control)):
                s += command * self.control
                error = self.gain * (s - x) - v
                integral += self.stiffness * error * self.control
                asked = self.damping * error + integral
                for _ in range(round(self.control / self.step)):
                    force += (asked - force) * self.step / self.lag
                    sticks = abs(v) < 1e-6 and abs(force) <= self.friction
                    opposed = math.copysign(self.friction, v) if v else 0.0
                    v = 0.0 if sticks else v + (force - opposed) / self.mass * self.step
                    x += v * self.step
            samples.append(x)
        return samples

    def taps(self):
        pulse = np.zeros((400, 1))
        pulse[0] = 1.0
        taps = np.diff(Cascade().follow(pulse)[:, 0], prepend=0.0) / T
        taps = taps[:np.flatnonzero(np.abs(taps) > 1e-9)[-1] + 1]
        return taps / taps.sum()


@pytest.mark.parametrize("friction", [0.0, 40.0])
def test_measured_taps_predict_a_cascaded_loop(friction):
    dice, cascade = np.random.default_rng(11), Cascade(friction)
    response = cascade.taps()
    assert response.min() < 0.0  # it overshoots: no design, but a judgement
    for _ in range(6):
        taps = np.convolve(np.ones(dice.integers(10, 40)), np.ones(dice.integers(4, 16)))
        taps, delay = taps / taps.sum(), int(dice.integers(5, 30))
        task = accdec.Task(sample_period=T, filter=taps, axes={"response_taps": response}, corners={
            "angle_deg": dice.uniform(60, 130), "heading_deg": 30, "feed_in": 0.1, "feed_out": 0.08, "delay": delay})
        corner = task.corners[0]
        legs = [corner[f"feed_{leg}"] * corner[f"direction_{leg}"] for leg in ("in", "out")]
        command = np.vstack([np.tile(legs[0], (400, 1)), np.zeros((delay, 2)), np.tile(legs[1], (400, 1))])
        velocity = np.vstack([np.convolve(column, taps)[:len(column)] for column in command.T]).T
        moved = cascade.follow(velocity) - 400 * T * legs[0]
        assert accdec.evaluate(task).corners[0]["corner_error"] == pytest.approx(nearest(moved), abs=5e-6)
