"""Bounds on the cumulative response B_0 .. B_{N+1} that limits on start and stop leave, and splits of the proof."""
from math import isqrt

from enclosure import BITS, ONE, exact

SWEEPS, ENOUGH = 40, ONE // 10**7  # sweeps that change less end


def up(a, b):
    """a/b rounded up, b > 0."""
    return -(-a // b)


class Plant:
    """Start or stop of an axis, divided by its speed s: m/T, c, F/s, P/s^2, R/s^2, the last three in whole numbers;
    None: no such limit."""

    def __init__(self, axis, period, speed, stop):
        def over(kind, by, less=0, more=0):
            return ((exact(axis.limits[kind]) - less) / by + more).hi << BITS if kind in axis.limits else None

        inertia, drag = exact(axis.mass / period), exact(axis.damping)
        self.inertia, self.slope = inertia, inertia + drag
        # slope B_k - m/T B_{k-1} <= F/s, at the stop F/s + c. Dry friction is against a start and helps a stop.
        self.force = over("force", speed, -axis.coulomb, drag) if stop else over("force", speed, axis.coulomb)
        self.power = None if stop else over("power", speed * speed)
        # Without its dry friction a stop would brake more.
        self.regeneration = over("regeneration", speed * speed) if stop and axis.coulomb == 0 else None

    def highest_after(self, x, high):
        """Of B_k, where B_{k-1} <= x and B_k <= high."""
        slope, push = self.slope, self.inertia.hi * x
        if slope.lo <= 0:
            return high
        if self.force is not None:
            high = min(high, up(self.force + push, slope.lo))
        if self.power is not None:  # slope B_k^2 - m/T B_{k-1} B_k <= P/s^2: up to the larger root
            square = push * push + (4 * slope.hi * self.power << BITS)
            high = min(high, up(push + isqrt(square) + 1, 2 * slope.lo))
        if self.regeneration is not None:
            # With w = 1 - B_k: slope w^2 - m/T (1 - B_{k-1}) w + R/s^2 >= 0, so w is not between the roots.
            left = self.inertia.lo * (ONE - x)
            square = left * left - (4 * slope.hi * self.regeneration << BITS)
            if square > 0 and left > 0:
                roots = left + isqrt(square)  # over 2 slope the larger one; R over half of it the smaller one
                if ONE - high > up(2 * self.regeneration << BITS, roots):
                    high = min(high, ONE - roots // (2 * slope.hi))
        return high

    def lowest_before(self, low, high):
        """Of B_{k-1}, where low <= B_k <= high."""
        pull, least, inertia = self.slope.lo * low, [0], self.inertia
        if inertia.lo <= 0:
            return 0
        if self.force is not None:
            least.append((pull - self.force) // inertia.hi)
        if self.power is not None and low > 0:
            least.append((pull - up(self.power << BITS, low)) // inertia.hi)
        if self.regeneration is not None and high < ONE:
            # 1 - B_{k-1} <= (slope w + R/(s^2 w)) T/m, convex in w: largest at an end
            ends = [self.slope.hi * w + up(self.regeneration << BITS, w) for w in (ONE - low, ONE - high)]
            least.append(ONE - up(max(ends), inertia.lo))
        return max(least)


def tube(plants, tap_max, ramp_max, order, cuts):
    """Lists of the least and the largest B_k; None if no filter of this order or less is left. tap_max, ramp_max: of
    any tap, of any difference of two, times ONE. cuts: bounds of B by sample."""
    last = order + 1
    low, high, most = [0] * last + [ONE], [0] + [ONE] * last, 0
    for sample, (least, largest) in cuts.items():
        k = min(sample, last)
        low[k], high[k] = max(low[k], exact(least).lo), min(high[k], exact(largest).hi)
    for k in range(1, last):  # tap i is at most (i + 1) ramp_max, and as much from the other end
        most += min(tap_max, ramp_max * k)
        high[k], low[last - k] = min(high[k], most), max(low[last - k], ONE - most)
    for _ in range(SWEEPS):
        before = low + high
        for k in range(1, last + 1):
            top = min(high[k], high[k - 1] + tap_max)
            for p in plants:
                top = p.highest_after(high[k - 1], top)
            high[k], low[k] = top, max(low[k], low[k - 1])
            if low[k] > top:
                return None
        for k in range(last, 0, -1):
            least = max(low[k - 1], low[k] - tap_max)
            for p in plants:
                least = max(least, p.lowest_before(low[k], high[k]))
            low[k - 1], high[k - 1] = least, min(high[k - 1], high[k])
            if least > high[k - 1]:
                return None
        if all(abs(a - b) < ENOUGH for a, b in zip(before, low + high)):
            break
    return low, high
