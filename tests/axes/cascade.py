"""A cascaded control loop with dry friction: position control, velocity control of a quarter of a millisecond, a drive
that lags, a mass. Its measured response predicts its corners: within 0.1 um without friction, and within 5 um with 40 N
where the velocity control is as stiff as that of a linear motor. A soft loop gives way to friction, which no response
has: there by what a step of the friction from one direction to the other moves it."""
import math

import numpy as np

import moved
import machine

CONTROL, STEP = 0.25e-3, 0.05e-3  # s
FRICTION = 40.0  # N
NEAR, FRICTIONLESS = 5e-6, 1e-7  # m
# Gains of position (1/s), velocity (N s/m) and its integral (N/m).
STIFF, SOFT = (400.0, 40000.0, 8e6), (200.0, 8000.0, 4e5)


class Loop:
    """Each axis alone. The velocity control is proportional and integral; force follows it with a lag of 0.5 ms."""

    mass, lag = 34.0, 0.5e-3  # kg, s

    def __init__(self, gains, friction):
        (self.gain, self.damping, self.stiffness), self.friction = gains, friction

    def follow(self, velocity, period):
        """Positions at the ends of the samples."""
        s = x = v = force = integral = 0.0
        samples = []
        for command in velocity.tolist():
            for _ in range(round(period / CONTROL)):
                s += command * CONTROL
                error = self.gain * (s - x) - v
                integral += self.stiffness * error * CONTROL
                asked = self.damping * error + integral
                for _ in range(round(CONTROL / STEP)):
                    force += (asked - force) * STEP / self.lag
                    v = self._pushed(v, force)
                    x += v * STEP
            samples.append(x)
        return np.array(samples)

    def _pushed(self, v, force):
        momentum = v + force / self.mass * STEP
        dry = self.friction / self.mass * STEP
        return 0.0 if abs(momentum) <= dry else momentum - math.copysign(dry, momentum)

    def taps(self, period):
        """Measured without friction: positions behind a velocity of one sample."""
        pulse = np.zeros(max(60, math.ceil(0.3 / period)))
        pulse[0] = 1.0
        taps = np.diff(self.follow(pulse, period), prepend=0.0) / period
        taps = taps[: np.flatnonzero(np.abs(taps) > 1e-9)[-1] + 1]
        return taps / taps.sum()


def check(rng, cases):
    """Evaluates a filter behind the measured response, and lets the loop itself pass the corner."""
    period = rng.choice([0.5e-3, 1e-3, 2e-3])
    gains = rng.choice([STIFF, SOFT])
    response = Loop(gains, 0.0).taps(period)
    lengths = [rng.randrange(4, 30), rng.randrange(2, 12)]
    corner = {"name": "A", "angle_deg": rng.uniform(60.0, 130.0), "heading_deg": rng.uniform(-180.0, 180.0),
              "turn": "left", "feed_in_mm_min": rng.uniform(1500.0, 8000.0), "delay_samples": rng.randrange(0, 25)}
    corner["feed_out_mm_min"] = corner["feed_in_mm_min"] * rng.uniform(0.6, 1.0)
    task = {"sample_period_ms": period * 1e3, "filter": {"kind": "averages", "lengths": lengths},
            "axis": [{"response_taps": response.tolist()}], "corner": [corner]}
    _, result = cases.result("evaluate", task)
    taps = np.convolve(*(np.ones(n) / n for n in lengths))
    command = machine.Command(task, corner, taps, corner["delay_samples"], len(response))
    for friction in (0.0, FRICTION):
        loop = Loop(gains, friction)
        passed = np.column_stack([loop.follow(column, period) for column in command.velocity.T]) - command.way
        nearest = np.linalg.norm(passed[command.blend], axis=1).min()
        said = result["corners"][0]["corner_error_m"]
        gives_way = 2.0 * friction / (gains[0] * gains[1]) if gains == SOFT else 0.0
        if abs(nearest - said) > (NEAR + gives_way if friction else FRICTIONLESS):
            raise moved.Differs(f"the loop with {friction} N passes at {nearest:.9g} m, predicted are {said:.9g}")
    return "predicted"
