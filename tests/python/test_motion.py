"""Motion around corners, against scipy.signal."""
import numpy as np
import pytest
import scipy.signal

import accdec


def task(angle_deg=70.0, feed_in=0.1, feed_out=0.07, **axis):
    return accdec.Task(sample_period=1e-3, corners={"angle_deg": angle_deg, "heading_deg": 20, "feed_in": feed_in,
                                                    "feed_out": feed_out}, axes=axis)


def commanded(corner, motion, delay):
    """The unfiltered command: rest, leg 1 to the row `corner`, a gap of the delay, leg 2 to the row `stop`, rest."""
    command = np.zeros_like(motion["velocity"])
    command[motion["start"] + 1:motion["corner"] + 1] = corner["feed_in"] * corner["direction_in"]
    command[motion["corner"] + 1 + delay:motion["stop"] + 1] = corner["feed_out"] * corner["direction_out"]
    return command


@pytest.mark.parametrize("delay", [0, 1, 7, 20])
def test_simulation_is_what_lfilter_makes_of_the_command(delay):
    taps = np.random.default_rng(delay).uniform(0, 1, 12)
    taps /= taps.sum()
    given = task(mass=34, damping=200)
    motion = accdec.simulate(given, taps=taps, delay=delay)
    velocity = scipy.signal.lfilter(taps, [1.0], commanded(given.corners[0], motion, delay), axis=0)
    assert motion["velocity"] == pytest.approx(velocity, abs=1e-14)
    acceleration = np.diff(velocity, axis=0, prepend=0.0) / 1e-3
    assert motion["acceleration"] == pytest.approx(acceleration, abs=1e-9)
    assert motion["jerk"] == pytest.approx(np.diff(acceleration, axis=0, prepend=0.0) / 1e-3, abs=1e-6)
    assert motion["force"] == pytest.approx(34 * acceleration + 200 * velocity, abs=1e-7)
    assert motion["power"] == pytest.approx(motion["force"] * velocity, abs=1e-7)
    position = np.cumsum(velocity, axis=0) * 1e-3
    length = (motion["corner"] - motion["start"]) * 1e-3 * given.corners[0]["feed_in"]
    position -= length * given.corners[0]["direction_in"]
    assert motion["position"] == pytest.approx(position, abs=1e-12)
    assert motion["time"][motion["corner"]] == 0.0 and np.diff(motion["time"]) == pytest.approx(1e-3)


def error_by_lfilter(taps, angle, feed_in, feed_out, delay):
    """Least distance from the corner at a sample, from convolved commands."""
    n = len(taps)
    along = np.concatenate([np.full(3 * n, feed_in), np.zeros(3 * n + delay)])
    away = np.concatenate([np.zeros(3 * n + delay), np.full(3 * n, feed_out)])
    one = np.cumsum(scipy.signal.lfilter(taps, [1.0], along)) * 1e-3 - 3 * n * feed_in * 1e-3
    two = np.cumsum(scipy.signal.lfilter(taps, [1.0], away)) * 1e-3
    x = one - two * np.cos(angle)  # u1 . u2 = -cos(theta)
    y = two * np.sin(angle)
    return np.hypot(x, y).min()


def test_smallest_delay_is_the_first_that_holds():
    dice = np.random.default_rng(5)
    for _ in range(60):
        taps = dice.uniform(0, 1, dice.integers(2, 25))
        taps /= taps.sum()
        angle, feed_in, feed_out = dice.uniform(0.2, 3.0), dice.uniform(0.02, 0.3), dice.uniform(0.02, 0.3)
        bound = error_by_lfilter(taps, angle, feed_in, feed_out, 0) * dice.uniform(0.02, 1.1)
        found = int(accdec.smallest_delay(taps, angle, feed_in, bound, feed_out=feed_out, sample_period=1e-3))
        errors = [error_by_lfilter(taps, angle, feed_in, feed_out, d) for d in range(found + 1)]
        assert errors[-1] <= bound * (1 + 1e-9) + 1e-15
        assert all(e > bound * (1 - 1e-9) for e in errors[:-1])


def test_smallest_delay_broadcasts():
    taps = accdec.taps("hann", 40)
    angles, feeds = np.radians([[60.0], [90.0], [120.0]]), np.array([0.05, 0.1])
    table = accdec.smallest_delay(taps, angles, feeds, 20e-6, sample_period=1e-3)
    assert table.shape == (3, 2) and table.dtype == np.int32
    for i in range(3):
        for j in range(2):
            one = accdec.smallest_delay(taps, angles[i, 0], feeds[j], 20e-6, sample_period=1e-3)
            assert one.shape == () and one == table[i, j]


def test_a_million_corners():
    dice = np.random.default_rng(2)
    taps = accdec.taps("trapezoid", 60, ramp=20)
    angle, bound = dice.uniform(0.2, 3.0, 1_000_000), dice.uniform(5e-6, 200e-6, 1_000_000)
    delays = accdec.smallest_delay(taps, angle, 0.1, bound, sample_period=1e-3)
    for i in dice.integers(0, 1_000_000, 50):
        assert delays[i] == accdec.smallest_delay(taps, angle[i], 0.1, bound[i], sample_period=1e-3)
    assert delays.min() >= 0 and delays.max() <= 60


@pytest.mark.parametrize("change", [{"angle": 0.0}, {"angle": 4.0}, {"feed_in": -1.0}, {"error_max": -1e-6},
                                    {"sample_period": 0.0}, {"angle": np.nan}, {"error_max": np.nan}])
def test_smallest_delay_says_what_is_allowed(change):
    given = {"angle": np.array([1.0, 2.0]), "feed_in": 0.1, "error_max": 1e-5, "sample_period": 1e-3, **change}
    with pytest.raises(ValueError, match=next(iter(change))):
        accdec.smallest_delay([0.5, 0.5], **given)


def test_residual_vibration_is_the_frequency_response():
    taps = accdec.taps("s-curve", 30)
    f = np.linspace(0.0, 500.0, 301)
    _, response = scipy.signal.freqz(taps, worN=f, fs=1000.0)
    assert accdec.residual_vibration(taps, f, 1e-3) == pytest.approx(np.abs(response), abs=1e-13)


def test_shapes_are_those_of_scipy():
    hann = scipy.signal.windows.hann(21)
    assert accdec.taps("hann", 20) == pytest.approx(hann / hann.sum(), abs=1e-15)
    blackman = scipy.signal.windows.blackman(21)
    assert accdec.taps("blackman", 20) == pytest.approx(blackman / blackman.sum(), abs=1e-15)
    averages = scipy.signal.convolve(np.full(5, 0.2), np.full(8, 0.125))
    assert accdec.taps("averages", lengths=[8, 5]) == pytest.approx(averages, abs=1e-15)
    with pytest.raises(accdec.InputError, match="hann"):
        accdec.taps("han", 20)
