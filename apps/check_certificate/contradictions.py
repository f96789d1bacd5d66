"""Proofs that name nothing: limits that no filter keeps, whatever its order."""
from fractions import Fraction

from axes import curve
from enclosure import ONE, UNIT, ZERO, Enclosure, exact, square_root
from problem import STILL, Refused
from rows import Rows

CELLS = 400


def constant_feed(problem):
    """A limit broken before anything moves but at its feed, in words."""
    for corner in problem.corners:
        for axis, *legs in zip(problem.axes, corner.speed_in, corner.speed_out):
            for leg in legs:
                speed = leg.magnitude()
                moves = speed.lo > exact(max(corner.feed_in, corner.feed_out) * STILL).hi
                friction = exact(axis.damping) * speed + (exact(axis.coulomb) if moves else ZERO)
                for kind, value in (("velocity", speed), ("force", friction), ("power", friction * speed)):
                    if kind in axis.limits and value.lo > exact(axis.limits[kind]).hi:
                        return f"corner {corner.name}: {kind} at constant feed"
                if curve.breaks(axis, speed, friction):
                    return f"corner {corner.name}: force-speed curve at constant feed"
        if corner.speed_min > min(corner.feed_in, corner.feed_out):
            return f"corner {corner.name}: its smallest speed is above a feed"
    longest = 10**6 if problem.given_filter else problem.order_max
    for mode in (m for m in problem.modes if m.least_damping == 0):
        # At n/T every filter leaves 1; e cycles a sample from there at least cos(2 pi e N) >= 1 - (2 pi e N)^2/2.
        cycles = max(1, round((mode.low + mode.high) / 2 * problem.period))
        nearest = min(max(Fraction(cycles) / problem.period, mode.low), mode.high)
        away = Fraction(63, 10) * abs(nearest * problem.period - cycles) * longest
        if mode.residual < 1 - away * away / 2:
            return "vibration: a band holds a multiple of the sample rate"
    raise Refused("no limit is broken at constant feed")


class _Way:
    """How far a leg at least still goes to lose, or has gone to gain, a part of its speed: at most sum (i + 1) c_i over
    c >= 0 of this sum, none above `tap` nor more than `fall` below the one before it. It is least where the early ones
    are largest: any other c of the same sum is below those first and above them then. A smaller sum has less still."""

    def __init__(self, tap, fall):
        self.tap, self.fall = tap, fall

    def _sums(self, top):
        """Sum c_i and sum (i + 1) c_i of c_i = min(tap, top - i fall), down to zero."""
        mass = moment = i = 0
        while top > 0 and mass <= ONE:
            c = min(self.tap, top)
            mass, moment, i, top = mass + c, moment + (i + 1) * c, i + 1, top - self.fall
        return mass, moment

    def __call__(self, part):
        part = max(part, 0)
        low, high = 0, self.tap + self.fall * (part // self.tap + 2)
        for _ in range(45):
            middle = (low + high) // 2
            low, high = (middle, high) if self._sums(middle)[0] <= part else (low, middle)
        return self._sums(low)[1]


class _Crossing:
    """Both legs' speeds about the last sample k at which leg 1 is as fast as leg 2: a that of leg 1 at k + 1, b that of
    leg 2 at k. They bound what both legs are away from the corner point at k, where the motion is nearest across the
    bisector."""

    def __init__(self, rows, corner):
        self.tap, self.way = Enclosure(rows.tap_max), _Way(rows.tap_max, rows.ramp_max)
        self.feed_in, self.feed_out = exact(corner.feed_in), exact(corner.feed_out)
        self.cosine, self.speed = corner.cosine, exact(corner.speed_min)
        self.sine2 = (UNIT - self.cosine) * (UNIT + self.cosine)
        self.equal = self.speed / square_root((UNIT - self.cosine).times(2))  # both legs as fast

    def _faster(self, slower):
        """The faster leg's speed: its square and b^2 less 2 a b cos(theta) make v_min^2."""
        x = Enclosure(slower)
        return (x * self.cosine + square_root(self.speed * self.speed - x * x * self.sine2)).lo

    def _faster_least(self, low, high):
        """Concave up to where both are equal; from there the slower leg is fast enough by itself."""
        if low >= self.equal.lo:
            return low
        end = self._faster(high) if high is not None and high < self.equal.lo else self.equal.lo
        return min(self._faster(low), end)

    def _least_between(self, low, high):
        """With b in a cell. One sample changes a leg's speed by the largest tap at most."""
        a = self._faster_least(low, high) - (self.tap * self.feed_in).hi
        b = max(low, self._faster_least(max(0, a), None) - (self.tap * self.feed_out).hi)
        parts = (Enclosure(a) / self.feed_in).lo, (Enclosure(b) / self.feed_out).lo
        if (high is not None and b > high) or max(parts) > ONE:
            return None  # no leg is faster than its feed
        ways = [feed * Enclosure(self.way(part)) for feed, part in zip((self.feed_in, self.feed_out), parts)]
        return (ways[0] + ways[1]).lo

    def least_distance(self):
        """Of both legs together, m a sample period; None: no speeds are left."""
        width = 2 * self.equal.lo // CELLS
        cells = [(i * width, (i + 1) * width if i < CELLS else None) for i in range(CELLS + 1)]
        return min((x for x in (self._least_between(*cell) for cell in cells) if x is not None), default=None)


def corner_speed(problem):
    """A smallest speed that no filter keeps within the corner's error, in words."""
    rows = Rows(problem)
    for corner in problem.corners:
        if corner.error is None or corner.speed_min <= 0 or (UNIT - corner.cosine).lo < ONE // 10**9:
            continue
        least = _Crossing(rows, corner).least_distance()
        across = square_root((UNIT + corner.cosine) / UNIT.times(2)) * exact(problem.period)
        if least is None or (across * Enclosure(least)).lo > exact(corner.error).hi:
            return f"corner {corner.name}: no filter keeps both its smallest speed and its tolerance"
    raise Refused("no smallest speed is surely too much within its corner's error")
