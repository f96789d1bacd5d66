"""A machine in numbers of its own: what a filtered command does to a servo, to drives and to a vibrating axis.

Nothing here is a formula of the library. The command is sampled and delayed, the position control is integrated by
Runge and Kutta, drives push a mass against dry friction and saturate, a mass on a spring rides on the moving axis.
"""
import math

import numpy as np

STILL = 1e-9  # an axis slower than this part of the feed stands


def directions(corner):
    """Unit vectors along both legs of a corner in a plane."""
    heading, angle = math.radians(corner["heading_deg"]), math.radians(corner["angle_deg"])
    out = heading + (1.0 if corner["turn"] == "left" else -1.0) * (math.pi - angle)
    legs = [np.array([math.cos(a), math.sin(a)]) for a in (heading, out)]
    return [np.where(np.abs(leg) < 1e-15, 0.0, leg) for leg in legs]


def feeds(corner):
    return [corner[key] / 6e4 for key in ("feed_in_mm_min", "feed_out_mm_min")]


class Command:
    """Velocity of both axes, sample by sample: rest, leg 1, `delay` samples of pause, leg 2, rest; then filtered."""

    def __init__(self, task, corner, taps, delay, rest):
        self.period = task["sample_period_ms"] / 1e3
        taps = np.asarray(taps, float) / math.fsum(taps)
        smoothing = task.get("controller", {}).get("prefilter_taps", [1.0])
        self.order = len(taps) + len(smoothing) - 2
        leg = rest + self.order + 4
        self.start, self.corner = rest, rest + leg
        self.stop = self.corner + delay + leg
        raw = np.zeros((self.stop + leg + rest, 2))
        (u1, u2), (v1, v2) = directions(corner), feeds(corner)
        raw[self.start : self.corner] = v1 * u1
        raw[self.corner + delay : self.stop] = v2 * u2
        self.velocity = delayed_sum(delayed_sum(raw, taps), smoothing)
        self.way = leg * self.period * v1 * u1  # from the start to the corner point
        self.blend = slice(self.corner - 1, self.stop - 1)


def delayed_sum(raw, taps):
    """Each tap passes the command on, so many samples later."""
    total = np.zeros_like(raw)
    for i, tap in enumerate(taps):
        total[i:] += tap * raw[: len(raw) - i]
    return total


def follow(velocity, period, gain, feedforward):
    """Positions at the ends of the samples of x' = Kv (s - x) + g s', s the command: fourth order Runge-Kutta.

    With steps of 0.01/Kv the lag is off by 0.01^4/120, about 1e-10 of it: an axis that stands is seen to (`STILL`).
    """
    steps = max(1, math.ceil(gain * period / 0.01))
    h, s, x, samples = period / steps, 0.0, 0.0, []
    for v in velocity.tolist():
        ahead, origin = feedforward * v, s
        for i in range(steps):
            now = origin + i * h * v
            half, end = now + 0.5 * h * v, now + h * v
            k1 = gain * (now - x) + ahead
            k2 = gain * (half - x - 0.5 * h * k1) + ahead
            k3 = gain * (half - x - 0.5 * h * k2) + ahead
            k4 = gain * (end - x - h * k3) + ahead
            x += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        s = origin + period * v
        samples.append(x)
    return np.array(samples)


class Drives:
    """Two axes that push their masses along a motion as far as their limits let them.

    In every sample a drive asks for the force that brings its mass to the velocity of the motion. What it gets is cut
    to its largest force, its curve, its power and that of the supply. Then the mass moves, with dry friction.
    """

    def __init__(self, task, feed):
        self.axes = task["axis"] * 2 if len(task["axis"]) == 1 else task["axis"]
        self.supply, self.still = task.get("machine", {}), STILL * feed
        self.asked = np.zeros((0, 2))  # N, of every sample and axis

    def _asked(self, axis, before, velocity, period):
        force = axis["mass_kg"] * (velocity - before) / period + axis["damping_N_s_m"] * velocity
        dry = axis.get("coulomb_N", 0.0)
        if abs(velocity) > self.still:
            return force + math.copysign(dry, velocity)
        return math.copysign(max(0.0, abs(force) - dry), force)

    def _allowed(self, axis, velocity, force):
        """The force cut to the axis' own limits, at a speed."""
        size, speed = abs(force), abs(velocity)
        size = min(size, axis.get("force_max_N", math.inf))
        if "force_speed_N" in axis:
            at, most = zip(*axis["force_speed_N"])
            beyond = speed > at[-1] * 1e-3 * (1.0 + 1e-9)
            size = min(size, 0.0 if beyond else float(np.interp(speed * 1e3, at, most)))
        bound = axis.get("power_max_W" if force * velocity > 0.0 else "regeneration_max_W", math.inf)
        if speed > 0.0:
            size = min(size, bound / speed)
        return math.copysign(size, force)

    @staticmethod
    def _moved(axis, before, force, period):
        """Velocity after a sample: backward Euler, in which dry friction takes what it can."""
        momentum = axis["mass_kg"] / period * before + force
        dry = axis.get("coulomb_N", 0.0)
        if abs(momentum) <= dry:
            return 0.0
        return (momentum - math.copysign(dry, momentum)) / (axis["mass_kg"] / period + axis["damping_N_s_m"])

    def run(self, velocity, period):
        """The largest difference from the motion's velocity, m/s; what was asked of the drives is in `asked`."""
        worst, now, everything = 0.0, [0.0, 0.0], []
        for before, target in zip(np.vstack([np.zeros(2), velocity[:-1]]).tolist(), velocity.tolist()):
            asked = [self._asked(a, b, t, period) for a, b, t in zip(self.axes, before, target)]
            everything.append(asked)
            power = sum(f * v for f, v in zip(asked, target))
            got = [self._allowed(a, t, f) for a, t, f in zip(self.axes, target, asked)]
            cut = max(power / self.supply.get("power_total_max_W", math.inf),
                      -power / self.supply.get("regeneration_total_max_W", math.inf))
            if cut > 1.0:
                got = [f / cut for f in got]
            now = [self._moved(a, n, f, period) for a, n, f in zip(self.axes, now, got)]
            worst = max(worst, *(abs(n - t) for n, t in zip(now, target)))
        self.asked = np.array(everything)
        return worst

    def loads(self, velocity):
        """What was asked of the drives, sample by sample: by kind and axis."""
        power = self.asked * velocity
        values = {("power_total", ""): power.sum(axis=1), ("regeneration_total", ""): -power.sum(axis=1)}
        for i, (axis, name) in enumerate(zip(self.axes, "xy")):
            force, speed = np.abs(self.asked[:, i]), np.abs(velocity[:, i])
            values |= {("force", name): force, ("power", name): power[:, i], ("regeneration", name): -power[:, i]}
            if "force_speed_N" in axis:
                values["force_speed", name] = on_curve(axis, speed, force)
        return values


def on_curve(axis, speed, force):
    """How far out speeds and forces are, times the curve's first force: by halving, whether a part of both fits."""
    at, most = zip(*axis["force_speed_N"])
    at = [1e-3 * v for v in at]
    low, high = np.zeros_like(speed), np.full_like(speed, 1e3)
    for _ in range(60):
        part = 0.5 * (low + high)
        fits = (speed * part <= at[-1]) & (force * part <= np.interp(speed * part, at, most))
        low, high = np.where(fits, part, low), np.where(fits, high, part)
    return most[0] / low


def ringing(velocity, period, frequency, damping, steps=50):
    """Amplitude, m, of a mass on a spring that rides on an axis, after the last change of the axis' velocity.

    Fourth order Runge-Kutta of x'' = -2 z w (x' - s') - w^2 (x - s), fifty steps a sample. Amplitude: the envelope, of
    position and velocity.
    """
    w = 2.0 * math.pi * frequency
    moving = np.array([[0.0, 1.0], [-w * w, -2.0 * damping * w]])
    h = period / steps

    def slope(state, s, v):
        return moving @ state + np.array([0.0, 2.0 * damping * w * v + w * w * s])

    def after_sample(state, v):
        """From the state relative to the axis, whose velocity is v during the sample."""
        s = 0.0
        for _ in range(steps):
            k1 = slope(state, s, v)
            k2 = slope(state + 0.5 * h * k1, s + 0.5 * h * v, v)
            k3 = slope(state + 0.5 * h * k2, s + 0.5 * h * v, v)
            k4 = slope(state + h * k3, s + h * v, v)
            state, s = state + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4), s + h * v
        return state - np.array([s, 0.0])

    # A sample maps state and velocity linearly, so three runs of the fifty steps tell what every sample does.
    free = np.column_stack([after_sample(e, 0.0) for e in np.eye(2)])
    pushed = after_sample(np.zeros(2), 1.0)
    state = np.array([0.0, velocity[0]])  # relative position, own velocity
    damped = w * math.sqrt(1.0 - damping**2)
    for v in velocity[:-1]:
        state = free @ state + pushed * v
    return math.hypot(state[0], (state[1] - velocity[-1] + damping * w * state[0]) / damped)
