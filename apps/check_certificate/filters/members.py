"""Whole filters: the limits that their motions surely break, and what their corners cost at least."""
from copy import copy
from functools import cached_property
from itertools import accumulate, product
from math import atan2, ceil
from types import SimpleNamespace

from enclosure import BITS, ONE, Enclosure, Refused, exact, number, refuse_if
from problem import STILL, convolved
from rows import Limits, Row


class Filter:
    """Taps, up to a factor, before a control's smoothing and servo."""

    def __init__(self, problem, limits, taps):
        self.problem, self.limits, self.known = problem, limits, {}
        total = exact(sum(taps))
        self.order, self.taps = len(taps) - 1, [b / total for b in map(exact, taps)]

    @cached_property
    def command(self):
        return self.taps if len(self.problem.smoothing) == 1 else convolved(self.taps, self.problem.smoothing)

    @cached_property
    def motion(self):
        return self.command if len(self.problem.servo) == 1 else convolved(self.command, self.problem.servo)

    @cached_property
    def gone(self):
        """B_k of the command."""
        return [exact(0), *accumulate(self.command)]

    @cached_property
    def moved(self):
        """B_k of the motion."""
        return self.gone if self.motion is self.command else [exact(0), *accumulate(self.motion)]

    def steep(self):
        """Whether a tap or a difference of two is surely above what any filter may have. Corners keep their feeds."""
        steps = zip([exact(0), *self.command], [*self.command, exact(0)])
        steep = any(abs(b - a).lo > self.limits.ramp_max for a, b in steps)
        return steep or any(b.lo > self.limits.tap_max for b in self.command)

    def starts_or_stops_break(self):
        corners, zero = self.problem.corners, exact(0)
        still = exact(max(max(c.feed_in, c.feed_out) for c in corners) * STILL)
        starts, stops = ([Enclosure(max(abs(x).lo for x in axis)) for axis in zip(*legs)]
                         for legs in ((c.speed_in for c in corners), (c.speed_out for c in corners)))
        events = [(zero, x) for x in starts], [(x, zero) for x in stops]
        return any(self.axes_break(legs, 0, still) for legs in events)

    def rings(self, j=None, delay=0):
        """Whether a mode is surely left with too much; of the corner's blend, if one is given. Each is seen at the
        phase at which most is left."""
        corners, order = [(delay, delay, 0, 0)] * len(self.problem.corners), len(self.command) - 1
        box = SimpleNamespace(order=order, window=False, corners=corners)

        def left(m, *at):
            row = Row(self.limits, box)
            row.vibration(m, *([] if j is None else [j]), *at)
            return sum(c * (self.command[i].lo if c > 0 else self.command[i].hi) for _, i, c in row.terms), row.bound

        for m, mode in enumerate(self.problem.modes):
            if j is not None and (mode.axis is None or delay > min(self.order, self.problem.order_max)):
                continue
            parts = ceil(8 * (mode.high - mode.low) * self.problem.period * (order + 1)) + 1
            band = {mode.low + (mode.high - mode.low) * i / parts for i in range(parts + 1)}
            for f, z in product(band, {mode.least_damping, mode.most_damping}):
                try:
                    phase = atan2(*(left(m, f, z, angle)[0] for angle in (number(1.5707963267948966), 0)))
                    most, bound = left(m, f, z, number(phase))
                except Refused:
                    continue  # nothing excites it
                if most > bound * ONE:
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
                still = exact(max(corner.feed_in, corner.feed_out) * STILL)
                broken = self._corner_breaks(slow, 0) or any(self.axes_break(legs, 0, still) for legs in steps)
            self.known[j, delay, part] = broken
        return self.known[j, delay, part]

    def nearest(self, j):
        """A delay of a corner below which its error is too large."""
        if j not in self.known:
            first, last = 0, len(self.motion) + 1
            while first < last:
                middle = (first + last) // 2
                too_far = self.too_far(self.problem.corners[j], middle, True)
                first, last = (middle + 1, last) if too_far else (first, middle)
            self.known[j] = first
        return self.known[j]

    def _corner_breaks(self, corner, delay):
        if self.too_far(corner, delay) or self._strays(corner, delay):
            return True
        still = exact(max(corner.feed_in, corner.feed_out) * STILL)
        if corner.speed_min > 0:
            speeds = [along(self.moved, *legs, delay) for legs in zip(corner.speed_in, corner.speed_out)]
            if min(sum(v * v for v in now).hi for now in zip(*speeds)) < exact(corner.speed_min**2).lo:
                return True
        return self.axes_break(list(zip(corner.speed_in, corner.speed_out)), delay, still)

    def axes_break(self, legs, delay, still):
        period, totals = self.problem.period, []
        for axis, (into, out) in zip(self.problem.axes, legs):
            v, bounds = along(self.gone, into, out, delay), axis.limits
            steps = [y - x for x, y in zip(v, v[1:])]
            jerks = [y - x for x, y in zip([exact(0), *steps], [*steps, exact(0)])]
            for n, (kind, values) in enumerate((("velocity", v), ("acceleration", steps), ("jerk", jerks))):
                if kind in bounds and any(abs(x) > bounds[kind] * period**n for x in values):
                    return True
            if not axis.lines and not self.problem.supply and not {"force", "power", "regeneration"} & set(bounds):
                continue
            moved, powers = along(self.moved, into, out, delay), []
            for before, now in zip(moved, [*moved[1:], moved[-1]]):
                force = with_friction(axis, (now - before) * (axis.mass / period) + now * axis.damping, now, still)
                values = {"force": abs(force), "power": force * now, "regeneration": -force * now}
                if above_curve(axis, abs(now), abs(force)) or any(values[k] > bounds[k] for k in values if k in bounds):
                    return True
                powers.append(values["power"])
            totals.append(powers)
        signs = {"power": 1, "regeneration": -1}
        sums = [sum(powers) for powers in zip(*totals)] if self.problem.supply else []
        return any(total * signs[kind] > most for kind, most in self.problem.supply.items() for total in sums)

    def too_far(self, corner, delay, shorter=False):
        """Whether no sample is within the corner error; also with all shorter delays, with which leg 2 is at least as
        far along."""
        if corner.error is None:
            return False
        bound, cosine = exact(corner.error / self.problem.period), corner.cosine
        most = (bound * bound).hi << BITS
        for p, q in self._positions(corner, delay):
            if shorter and cosine.lo < 0:
                nearest = p * -cosine
                q = Enclosure(max(q.lo, nearest.lo), max(q.hi, nearest.hi))
            both = (p.lo * q.lo if cosine.lo >= 0 else p.hi * q.hi) * cosine.lo >> BITS - 1
            if p.lo**2 + q.lo**2 + both <= most:
                return False
        return True

    def _positions(self, corner, delay):
        """Ways that leg 1 has to go and leg 2 has gone, over the period, at every sample."""
        if "ways" not in self.known:
            gone = accumulate(self.moved[1:], initial=exact(0))
            self.known["ways"] = ways_left(self.moved), [*gone]
        for at, feed in enumerate((corner.feed_in, corner.feed_out)):
            if (at, feed) not in self.known:
                self.known[at, feed] = [x * feed for x in self.known["ways"][at]]
        p, q = self.known[0, corner.feed_in], self.known[1, corner.feed_out]
        for k in range(len(p) + delay):
            beyond = k - delay - len(q) + 1
            gone = q[max(0, k - delay)] if beyond <= 0 else q[-1] + beyond * corner.feed_out
            yield p[k] if k < len(p) else p[-1], gone

    def _strays(self, corner, delay):
        """Whether the polyline surely leaves the contour's strips: at no time are both p and q at most m, the tolerance
        over sin(theta). p falls and q rises, so only the chord on which p passes m counts."""
        if corner.contour is None or corner.sine.lo <= 0:
            return False
        most, before = exact(corner.contour / self.problem.period) / corner.sine, None
        for p, q in self._positions(corner, delay):
            if p > most:
                before = p, q
                continue
            if not q > most:
                return False
            # The chord passes beyond the point p = q = m.
            beyond = before is None or (before[0] - most) * (q - most) > (most - before[1]) * (most - p)
            return beyond or before[1] > most
        return True


def ways_left(gone):
    """p_k, from all B_k."""
    return [*accumulate((1 - b for b in reversed(gone[1:])), initial=exact(0))][::-1]


def along(gone, into, out, delay):
    """Speeds in (1 - B_k) + out B_{k-d} from k = 0, the last at full speed of leg 1."""
    zero = exact(0)
    return [into * (1 - a) + out * b for a, b in zip(gone + [exact(1)] * delay, [zero] * delay + gone)]


def with_friction(axis, force, v, still):
    """Dry friction is against the motion. An axis that stands has up to as much where it helps, one that moves as
    slowly as that may have either."""
    dry = exact(axis.coulomb)
    if v.lo > still.lo or v.hi < -still.lo:
        return force + dry if v.lo > 0 else force - dry
    low, high = max(force.lo - dry.hi, 0), min(force.hi + dry.hi, 0)
    return Enclosure(min(force.lo + dry.hi, low), max(force.hi - dry.hi, high))


def above_curve(axis, speed, force):
    """Whether a force at a speed, both not below zero, is surely above the force-speed curve."""
    beyond = axis.last_speed is not None and speed > axis.last_speed
    return beyond or any(force + speed * slope > most for slope, most in axis.lines)


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
