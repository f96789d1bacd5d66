"""Whole filters: the limits that their motions surely break, and what their corners cost at least."""
from bisect import bisect_right
from copy import copy
from functools import cached_property
from itertools import product
from math import ceil
from operator import mul

from enclosure import BITS, ONE, Enclosure, each, exact, number, refuse_if
from problem import STILL, convolved
from rows import Limits, turns


class Filter:
    """Taps, up to a factor, before a control's smoothing and servo."""

    def __init__(self, problem, limits, taps):
        self.problem, self.limits, self.known = problem, limits, {}
        taps = exact(taps)
        self.order, self.taps = len(taps.lo) - 1, taps / taps.total()
        self.command = convolved(self.taps, problem.smoothing)
        self.gone = self.command.sums()  # B_k of the command

    @cached_property
    def moved(self):
        """B_k of the motion."""
        motion = convolved(self.command, self.problem.servo)
        return self.gone if motion is self.command else motion.sums()

    def steep(self):
        """Whether a tap or a difference of two is surely above what any filter may have. Corners keep their feeds."""
        zero = Enclosure([0])
        steps = self.command.then(zero) - zero.then(self.command)
        return abs(steps) > Enclosure(self.limits.ramp_max) or self.command > Enclosure(self.limits.tap_max)

    def starts_or_stops_break(self):
        corners, zero = self.problem.corners, exact(0)
        starts, stops = ([Enclosure(max(abs(x).lo for x in axis)) for axis in zip(*legs)]
                         for legs in ((c.speed_in for c in corners), (c.speed_out for c in corners)))
        events, fastest = ([(zero, x) for x in starts], [(x, zero) for x in stops]), self.problem.fastest
        return any(self.axes_break(legs, 0, fastest) for legs in events)

    def rings(self, j=None, delay=0):
        """Whether a mode is surely left with too much; of the corner's blend, if one is given."""
        order = len(self.command.lo) - 1
        for mode in self.problem.modes:
            if j is not None and (mode.axis is None or delay > min(self.order, self.problem.order_max)):
                continue
            parts = ceil(8 * (mode.high - mode.low) * self.problem.period * (order + 1)) + 1
            band = {mode.low + (mode.high - mode.low) * i / parts for i in range(parts + 1)}
            for f, z in product(band, {mode.least_damping, mode.most_damping}):
                natural, damped, *waves = turns(f * self.problem.period, z, order)
                bound = self.limits.residual(mode, natural, damped, z, j, delay)
                left = [(wave * self.command[::-1]).total() for wave in waves]
                if bound and sum(x * x for x in map(abs, left)) > bound * bound:
                    return True
        return False

    def breaks(self, j, delay, part=None):
        """Whether a corner with this delay surely breaks a limit; or one that is passed at this part of the feed, or
        the steps of the speed along its legs."""
        if (j, delay, part) not in self.known:
            corner = self.problem.corners[j]
            if part is None:
                broken = delay < self.nearest(j) or self._corner_breaks(corner, delay) or self.rings(j, delay)
            else:
                slow = copy(corner)
                slow.feed_in, slow.feed_out = corner.feed_in * part, corner.feed_out * part
                slow.speed_in, slow.speed_out = ([x * part for x in leg] for leg in (corner.speed_in, corner.speed_out))
                steps = zip(corner.speed_in, slow.speed_in), zip(slow.speed_out, corner.speed_out)
                fastest = max(corner.feed_in, corner.feed_out)
                broken = self._corner_breaks(slow, 0) or any(self.axes_break(legs, 0, fastest) for legs in steps)
            self.known[j, delay, part] = broken
        return self.known[j, delay, part]

    def nearest(self, j):
        """A delay of a corner below which its error is too large."""
        if j not in self.known:
            first, last = 0, len(self.moved.lo)
            while first < last:
                middle = (first + last) // 2
                too_far = self.too_far(self.problem.corners[j], middle, True)
                first, last = (middle + 1, last) if too_far else (first, middle)
            self.known[j] = first
        return self.known[j]

    def _corner_breaks(self, corner, delay):
        if self.too_far(corner, delay) or self._strays(corner, delay):
            return True
        if corner.speed_min > 0:
            speeds = [abs(along(self.moved, *legs, delay)) for legs in zip(corner.speed_in, corner.speed_out)]
            if exact(corner.speed_min**2) > sum(v * v for v in speeds):
                return True
        return self.axes_break(zip(corner.speed_in, corner.speed_out), delay, max(corner.feed_in, corner.feed_out))

    def axes_break(self, legs, delay, fastest):
        period, powers = self.problem.period, exact(0)
        for axis, (into, out) in zip(self.problem.axes, legs):
            v, zero = along(self.gone, into, out, delay), Enclosure([0])
            steps = v[1:] - v[:-1]
            jerks = steps.then(zero) - zero.then(steps)
            for n, (kind, values) in enumerate((("velocity", v), ("acceleration", steps), ("jerk", jerks))):
                if kind in axis.limits and abs(values) > axis.limits[kind] * period**n:
                    return True
            if not axis.lines and not self.problem.supply and not {"force", "power", "regeneration"} & set(axis.limits):
                continue
            v = along(self.moved, into, out, delay)
            now = v[1:].then(v[-1:])
            force = (now - v) * (axis.mass / period) + now * axis.damping
            force = with_friction(axis, force, now, exact(fastest * STILL)) if axis.coulomb else force
            power, size, speed = force * now, abs(force), abs(now)
            values = {"force": size, "power": power, "regeneration": -power}
            curved = any(size + speed * slope > most for slope, most in axis.lines)
            beyond = axis.last_speed is not None and speed > axis.last_speed
            if curved or beyond or any(x > axis.limits[kind] for kind, x in values.items() if kind in axis.limits):
                return True
            powers += power
        sums = {"power": powers, "regeneration": -powers}
        return any(sums[kind] > most for kind, most in self.problem.supply.items())

    def too_far(self, corner, delay, shorter=False):
        """Whether no sample is within the corner error; also with all shorter delays, with which leg 2 is at least as
        far along."""
        if corner.error is None:
            return False
        (p, q), cosine, bound = self._positions(corner, delay), corner.cosine, exact(corner.error / self.problem.period)
        if corner.sine.lo > 0:
            # Within the error neither leg is farther than that over sin(theta). Rounding disorders p and q by less.
            reach = (bound / corner.sine).hi + (1 << 32)
            near = slice(len(p.lo) - bisect_right(p.lo[::-1], reach), bisect_right(q.lo, reach))
            p, q = p[near], q[near]
        if shorter and cosine.lo < 0:
            nearest = p * -cosine
            q = Enclosure(each(max, q.lo, nearest.lo), each(max, q.hi, nearest.hi))
        both = each(mul, p.lo, q.lo) if cosine.lo >= 0 else each(mul, p.hi, q.hi)
        most = bound.hi ** 2 << BITS
        return all((a * a + b * b << BITS) + 2 * cosine.lo * ab > most for a, b, ab in zip(p.lo, q.lo, both))

    def _positions(self, corner, delay):
        """Ways that leg 1 has to go and leg 2 has gone, over the period, at every sample."""
        if "ways" not in self.known:
            self.known["ways"] = ways_left(self.moved), self.moved[1:].sums()
        for at, feed in enumerate((corner.feed_in, corner.feed_out)):
            if (at, feed) not in self.known:
                self.known[at, feed] = self.known["ways"][at] * feed
        p, q, rest = self.known[0, corner.feed_in], self.known[1, corner.feed_out], Enclosure([0] * delay)
        return p.then(rest), rest.then(q)

    def _strays(self, corner, delay):
        """Whether the polyline surely leaves the contour's strips: at no time are both p and q at most m, the tolerance
        over sin(theta). p falls and q rises, so only the chord on which p passes m counts."""
        if corner.contour is None or corner.sine.lo <= 0:
            return False
        most, (p, q) = exact(corner.contour / self.problem.period) / corner.sine, self._positions(corner, delay)
        k = next((k for k in range(len(p.lo)) if not p[k] > most), None)
        if k is None or not q[k] > most:
            return k is None
        # The chord passes beyond the point p = q = m.
        return k == 0 or q[k - 1] > most or (p[k - 1] - most) * (q[k] - most) > (most - q[k - 1]) * (most - p[k])


def ways_left(gone):
    """p_k, from all B_k."""
    return (1 - gone[:0:-1]).sums()[::-1]


def along(gone, into, out, delay):
    """Speeds in (1 - B_k) + out B_{k-d} from k = 0, the last at full speed of leg 1."""
    return (1 - gone.then(Enclosure([ONE] * delay))) * into + Enclosure([0] * delay).then(gone) * out


def with_friction(axis, force, v, still):
    """Dry friction is against the motion. An axis that stands has up to as much where it helps, one that moves as
    slowly as that may have either."""
    dry, (most, least) = exact(axis.coulomb), (still.lo, -still.lo)

    def one(low, high, slow, fast):
        if slow > most or fast < least:
            return (low + dry.lo, high + dry.hi) if slow > 0 else (low - dry.hi, high - dry.lo)
        return min(low + dry.lo, max(low - dry.hi, 0)), max(high - dry.lo, min(high + dry.hi, 0))

    return Enclosure(*map(list, zip(*map(one, force.lo, force.hi, v.lo, v.hi))))


def smallest_delays(problem, taps, delays):
    """Number of smaller delays that break a limit: all of them."""
    taps = [number(b) for b in taps]
    refuse_if(min(taps) < 0 or not abs(sum(taps) - 1) < 1e-9, "the taps are negative or do not have the sum 1")
    given = Filter(problem, Limits(problem), taps)
    tried = [(j, d) for j, c in enumerate(problem.corners) if c.delay is None for d in range(delays[j])]
    for j, delay in tried:
        reason = f"corner {problem.corners[j].name}: the delay {delay} breaks no limit, or none surely"
        refuse_if(not given.breaks(j, delay), reason)
    return len(tried)
