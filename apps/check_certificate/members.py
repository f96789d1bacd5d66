"""Whole filters: the limits that their motions surely break."""
from bisect import bisect_right
from functools import cached_property, lru_cache
from itertools import product
from math import ceil, inf

from enclosure import ONE, Enclosure, NotCovered, exact, number, refuse_if
from problem import convolved
from rows import Limits, turns

NOTHING = Enclosure([0])


class Filter:
    """Taps, up to a factor, before a servo."""

    def __init__(self, problem, limits, taps):
        self.problem, self.limits = problem, limits
        self.command = self.taps = taps / taps.total()
        self.gone = self.taps.sums()  # B_k of the command
        self.breaks, self.ways = lru_cache(None)(self.breaks), lru_cache(None)(self.ways)

    @cached_property
    def moved(self):
        """B_k of the motion."""
        return convolved(self.taps, self.problem.response).sums()

    def starts_or_stops_break(self):
        nothing = exact(0)
        starts, stops = zip(*(((nothing, start), (stop, nothing)) for start, stop in self.limits.ends))
        return self.axes_break(starts, 0) or self.axes_break(stops, 0)

    def rings(self):
        """Whether a mode is surely left with too much."""
        return any(left > mode.residual**2 for mode in self.problem.modes for left, *_ in self.residuals(mode))

    def residuals(self, mode):
        """Squares of what is left of a mode, at frequencies and damping ratios throughout its ranges, and these."""
        order, width = len(self.command.lo) - 1, mode.high - mode.low
        parts = ceil(8 * width * self.problem.period * (order + 1)) + 1
        band = {mode.low + width * i / parts for i in range(parts + 1)}
        for frequency, damping in product(band, {mode.least_damping, mode.most_damping}):
            natural, damped, *waves = turns(frequency * self.problem.period, damping, order)
            left = [abs((wave * self.command[::-1]).total()) for wave in waves]
            yield sum(x * x for x in left), natural, damped, damping

    def breaks(self, j, delay):
        """Whether a corner with this delay surely breaks a limit."""
        corner = self.problem.corners[j]
        legs = zip(corner.speed_in, corner.speed_out)
        return self.too_far(corner, delay) or self.axes_break(legs, delay)

    def axes_break(self, legs, delay):
        for axis, (into, out) in zip(self.problem.axes, legs):
            v = along(self.gone, into, out, delay)
            steps = v[1:] - v[:-1]
            jerks = steps.then(NOTHING) - NOTHING.then(steps)
            for n, (kind, values) in enumerate((("velocity", v), ("acceleration", steps), ("jerk", jerks))):
                if kind in axis.limits and abs(values) > axis.limits[kind] * self.problem.period**n:
                    return True
        return False

    def ways(self, feed_in, feed_out):
        return ways_left(self.moved) * feed_in, self.moved[1:].sums() * feed_out

    def positions(self, corner, delay):
        """Ways that leg 1 has to go and leg 2 has gone, over the period, at every sample."""
        (to_go, gone), rest = self.ways(corner.feed_in, corner.feed_out), Enclosure([0] * delay)
        return to_go.then(rest), rest.then(gone)

    def too_far(self, corner, delay):
        """Whether every sample is farther from the corner than its error allows."""
        if corner.error is None:
            return False
        (p, q), error = self.positions(corner, delay), exact(corner.error / self.problem.period)
        # Within the error neither leg is farther than that over sin(theta); rounding disorders p, q by less than 2^32.
        reach = (error / corner.sine).hi + 2**32 if corner.sine.lo > 0 else inf
        near = slice(len(p.lo) - bisect_right(p.lo[::-1], reach), bisect_right(q.lo, reach))
        p, q = p[near], q[near]
        return min((p * p + q * q + p * q * (corner.cosine * 2)).lo, default=inf) > (error * error).hi


def ways_left(gone):
    """p_k, from all B_k."""
    return (1 - gone[:0:-1]).sums()[::-1]


def along(gone, into, out, delay):
    """Speeds in (1 - B_k) + out B_{k-d} from k = 0, the last at full speed of leg 1."""
    return (1 - gone.then(Enclosure([ONE] * delay))) * into + Enclosure([0] * delay).then(gone) * out


def not_refuted(reason):
    """A filter is a design, or breaks a limit that is not looked at here."""
    raise NotCovered(reason)


def smallest_delays(problem, taps, delays):
    """Number of smaller delays that break a limit: all of them."""
    taps = [number(b) for b in taps]
    refuse_if(min(taps) < 0 or not abs(sum(taps) - 1) < 1e-9, "the taps are negative or do not have the sum 1")
    given = Filter(problem, Limits(problem), exact(taps))
    tried = [(j, d) for j, c in enumerate(problem.corners) if c.delay is None for d in range(delays[j])]
    for j, delay in tried:
        if not given.breaks(j, delay):
            not_refuted(f"corner {problem.corners[j].name}: the delay {delay} breaks no limit, or none surely")
    return len(tried)
