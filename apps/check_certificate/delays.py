"""Proofs about a given filter: every delay that is smaller breaks a limit."""
from axes import curve
from enclosure import UNIT, ZERO, Enclosure, exact
from problem import STILL, NotCovered, Refused, number, refuse_if


def too_far(problem, corner, left, gained):
    """Whether no sample is within the corner error. Positions are sums of speeds: leg 1 has
    sum_{j > k} (1 - B_j) to go, leg 2 gone sum_{j <= k} B_{j-d}."""
    if corner.error is None:
        return False
    bound, to_go, gone = exact(corner.error / problem.period), sum(left[1:], ZERO), ZERO
    into, out = exact(corner.feed_in), exact(corner.feed_out)
    for k, (a, b) in enumerate(zip(left, gained)):
        to_go, gone = to_go - a if k > 0 else to_go, gone + b
        p, q = to_go * into, gone * out
        if (p * p + q * q + (p * q * corner.cosine).times(2)).lo <= (bound * bound).hi:
            return False
    return True


def strays(problem, corner, left, gained):
    """Whether the polyline surely leaves the contour's strips: at no time are both p and q at most m, the tolerance
    over sin(theta). p falls and q rises, so only the chord on which p passes m counts."""
    if corner.contour is None or corner.sine.lo <= 0:
        return False
    most = exact(corner.contour / problem.period) / corner.sine
    to_go, gone, before = sum(left[1:], ZERO), ZERO, None
    for k, (a, b) in enumerate(zip(left, gained)):
        to_go, gone = to_go - a if k > 0 else to_go, gone + b
        p, q = to_go * exact(corner.feed_in), gone * exact(corner.feed_out)
        if p.lo > most.hi:
            before = p, q
            continue
        if q.lo <= most.hi:
            return False
        # The chord passes beyond the point p = q = m.
        beyond = ((before[0] - most) * (q - most)).lo > ((most - before[1]) * (most - p)).hi if before else True
        return beyond or before[1].lo > most.hi
    return True


def with_friction(axis, force, v, still):
    """Dry friction is against the motion. An axis that stands has up to as much where it helps, one that moves as
    slowly as that may have either."""
    dry = exact(axis.coulomb)
    if v.lo > still:
        return force + dry
    if v.hi < -still:
        return force - dry
    low, high = max(force.lo - dry.hi, 0), min(force.hi + dry.hi, 0)
    return Enclosure(min(force.lo + dry.hi, low), max(force.hi - dry.hi, high))


def breaks_axis(period, axis, speeds, still=0):
    limits, before = {kind: exact(bound).hi for kind, bound in axis.limits.items()}, ZERO
    for old, v in zip(speeds, speeds[1:] + speeds[-1:]):
        acceleration = (v - old) / period
        force = with_friction(axis, exact(axis.mass) * acceleration + exact(axis.damping) * v, v, still)
        jerk, before = (acceleration - before) / period, acceleration
        values = {"velocity": v.magnitude(), "acceleration": acceleration.magnitude(), "jerk": jerk.magnitude()}
        values |= {"force": force.magnitude(), "power": force * v, "regeneration": -(force * v)}
        above = axis.lines and curve.breaks(axis, v.magnitude(), force.magnitude())
        if above or any(values[kind].lo > bound for kind, bound in limits.items()):
            return True
    return False


def breaks_a_limit(problem, corner, gone, delay):
    """The motion about a corner, sample by sample: k = 0 is the last at full speed of leg 1. gone: B_k."""
    left, gained = [UNIT - b for b in gone] + [ZERO] * delay, [ZERO] * delay + gone
    legs = zip(corner.speed_in, corner.speed_out)
    speeds = [[into * a + out * b for a, b in zip(left, gained)] for into, out in legs]
    slowest = min(sum((v * v for v in now), ZERO).hi for now in zip(*speeds))
    if slowest < (exact(corner.speed_min) * exact(corner.speed_min)).lo or too_far(problem, corner, left, gained):
        return True
    if strays(problem, corner, left, gained):
        return True
    still = exact(max(corner.feed_in, corner.feed_out) * STILL).lo
    return any(breaks_axis(exact(problem.period), axis, along, still) for axis, along in zip(problem.axes, speeds))


def smallest(problem, taps, delays):
    """Number of smaller delays that break a limit: all of them."""
    if len(problem.response) > 1:
        raise NotCovered("delays of a given filter behind a servo")
    if problem.supply or any(mode.axis is not None for mode in problem.modes):
        raise NotCovered("delays of a given filter with a shared supply or a mode of an axis")
    taps = [number(b) for b in taps]
    refuse_if(min(taps) < 0 or not abs(sum(taps) - 1) < 1e-9, "the taps are negative or do not have the sum 1")
    gone = [exact(sum(taps[:k]) / sum(taps)) for k in range(len(taps) + 1)]
    tried = [(c, d) for c, end in zip(problem.corners, delays) if c.delay is None for d in range(end)]
    for corner, delay in tried:
        if not breaks_a_limit(problem, corner, gone, delay):
            raise Refused(f"corner {corner.name}: the delay {delay} breaks no limit, or none surely")
    return len(tried)
