"""Whole filters: forces, powers, smallest speeds, contours, modes of axes, a control's smoothing, corner feeds."""
from copy import copy

import members
from enclosure import Enclosure, Refused, exact
from members import Filter, along
from more.rows import residual
from more.widening import widens
from problem import STILL, convolved


@widens(members, "not_refuted")
def not_refuted(_, reason):
    """All limits are looked at."""
    raise Refused(reason)


@widens(Filter, "__init__")
def smoothed(narrow, self, problem, limits, taps):
    narrow(self, problem, limits, taps)
    if len(problem.smoothing.lo) > 1:
        self.command = convolved(self.taps, problem.smoothing)
        self.gone = self.command.sums()


@widens(Filter, "rings")
def rings(_, self, j=None, delay=0):
    """Whether a mode is surely left with too much; of the corner's blend, if one is given."""
    for mode in self.problem.modes:
        if j is not None and (mode.axis is None or delay > min(len(self.taps.lo) - 1, self.problem.order_max)):
            continue
        for left, natural, damped, damping in self.residuals(mode):
            bound = residual(self.limits, mode, natural, damped, damping, j, delay)
            if bound and left > bound * bound:
                return True
    return False


@widens(Filter, "breaks")
def breaks(narrow, self, j, delay):
    corner = self.problem.corners[j]
    return narrow(self, j, delay) or self.rings(j, delay) or breaks_on_its_way(self, corner, delay)


def breaks_at_a_part(member, j, part):
    """Whether a corner that is passed without delay at this part of the feed, or the steps of the speed along its legs,
    surely breaks a limit."""
    corner = member.problem.corners[j]
    slow = copy(corner)
    slow.feed_in, slow.feed_out = corner.feed_in * part, corner.feed_out * part
    slow.speed_in, slow.speed_out = ([x * part for x in leg] for leg in (corner.speed_in, corner.speed_out))
    steps = zip(corner.speed_in, slow.speed_in), zip(slow.speed_out, corner.speed_out)
    return (member.too_far(slow, 0) or breaks_on_its_way(member, slow, 0)
            or any(member.axes_break(legs, 0) for legs in (zip(slow.speed_in, slow.speed_out), *steps)))


def breaks_on_its_way(member, corner, delay):
    if corner.speed_min <= 0:
        return strays(member, corner, delay)
    speeds = [abs(along(member.moved, *legs, delay)) for legs in zip(corner.speed_in, corner.speed_out)]
    return exact(corner.speed_min**2) > sum(v * v for v in speeds) or strays(member, corner, delay)


def strays(member, corner, delay):
    """Whether the polyline surely leaves the contour's strips: at no time are both p and q at most m, the tolerance
    over sin(theta). p falls and q rises, so only the chord on which p passes m counts."""
    if corner.contour is None or corner.sine.lo <= 0:
        return False
    most = exact(corner.contour / member.problem.period) / corner.sine
    p, q = member.positions(corner, delay)
    k = next((k for k in range(len(p.lo)) if not p[k] > most), None)
    if k is None or not q[k] > most:
        return k is None
    # The chord passes beyond the point p = q = m.
    return k == 0 or q[k - 1] > most or (p[k - 1] - most) * (q[k] - most) > (most - q[k - 1]) * (most - p[k])


@widens(Filter, "axes_break")
def axes_break(narrow, self, legs, delay):
    """Forces and powers, too: of each axis, and of all that share a supply."""
    legs, powers = list(legs), exact(0)
    if narrow(self, legs, delay):
        return True
    for axis, (into, out) in zip(self.problem.axes, legs):
        if not axis.lines and not self.problem.supply and not {"force", "power", "regeneration"} & set(axis.limits):
            continue
        v = along(self.moved, into, out, delay)
        now = v[1:].then(v[-1:])
        force = (now - v) * (axis.mass / self.problem.period) + now * axis.damping
        force = with_friction(axis, force, now, exact(self.problem.fastest * STILL)) if axis.coulomb else force
        power, size, speed = force * now, abs(force), abs(now)
        values = {"force": size, "power": power, "regeneration": -power}
        curved = any(size + speed * slope > most for slope, most in axis.lines)
        beyond = axis.last_speed is not None and speed > axis.last_speed
        if curved or beyond or any(x > axis.limits[kind] for kind, x in values.items() if kind in axis.limits):
            return True
        powers += power
    sums = {"power": powers, "regeneration": -powers}
    return any(sums[kind] > most for kind, most in self.problem.supply.items())


def with_friction(axis, force, v, still):
    """Dry friction is against the motion. An axis that stands has up to as much where it helps, one that moves as
    slowly as that may have either."""
    dry, (most, least) = exact(axis.coulomb), (still.lo, -still.lo)

    def one(low, high, slow, fast):
        if slow > most or fast < least:
            return (low + dry.lo, high + dry.hi) if slow > 0 else (low - dry.hi, high - dry.lo)
        return min(low + dry.lo, max(low - dry.hi, 0)), max(high - dry.lo, min(high + dry.hi, 0))

    return Enclosure(*map(list, zip(*map(one, force.lo, force.hi, v.lo, v.hi))))
