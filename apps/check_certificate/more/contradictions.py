"""Proofs that name nothing: limits that no filter keeps, whatever its order."""
from copy import copy
from fractions import Fraction

import claim
from enclosure import ONE, Enclosure, Refused, exact, refuse_if, square_root
from members import Filter
from rows import Limits

CELLS = 400


def constant_feed(problem):
    """A limit broken before anything moves but at its feed, in words."""
    steady = Filter(problem, Limits(problem), exact([1]))
    for corner in problem.corners:
        if any(steady.axes_break([(x, x) for x in leg], 0) for leg in (corner.speed_in, corner.speed_out)):
            return f"corner {corner.name}: a limit of an axis at constant feed"
        if corner.speed_min > min(corner.feed_in, corner.feed_out):
            return f"corner {corner.name}: its smallest speed is above a feed"
    longest = (10**6 if problem.given_filter else problem.order_max) + len(problem.smoothing.lo) - 1
    for mode in (m for m in problem.modes if m.least_damping == 0):
        # At n/T every filter leaves 1. Rounding may move a band by e cycles a sample. Then at least
        # cos(2 pi e N) >= 1 - (2 pi e N)^2/2 is left. N is the order with the control's smoothing.
        cycles = max(1, round((mode.low + mode.high) / 2 * problem.period))
        nearest = min(max(Fraction(cycles) / problem.period, mode.low), mode.high)
        moved = abs(nearest * problem.period - cycles)
        away = Fraction(63, 10) * moved * longest
        if moved <= Fraction(cycles, 10**12) and mode.residual < 1 - away * away / 2:
            return "vibration: a band holds a multiple of the sample rate"
    raise Refused("no limit is broken at constant feed")


def _way(tap, fall, part):
    """How far a leg at least still goes to lose, or has gone to gain, a part of its speed: at most sum (i + 1) c_i over
    c >= 0 of this sum, none above `tap` nor more than `fall` below the one before it. It is least where the early ones
    are largest: any other c of the same sum is below those first and above them then. A smaller sum has less still."""
    def sums(top):
        """Sum c_i and sum (i + 1) c_i of c_i = min(tap, top - i fall), down to zero: as many are full, then n less and
        less, the first of them h."""
        full = max(0, (top - tap) // fall + 1)
        n, h = -(-top // fall) - full, top - full * fall
        pairs = n * (n - 1) // 2  # sum j for j < n
        ramp = n * h - fall * pairs
        return full * tap + ramp, (full * (full + 1) // 2 * tap + (full + 1) * ramp
                                   + h * pairs - fall * (pairs * (2 * n - 1) // 3))

    fall = max(fall, 1)
    low, high = 0, tap + fall * (max(part, 0) // tap + 2)
    for _ in range(45):
        middle = (low + high) // 2
        low, high = (middle, high) if sums(middle)[0] <= part else (low, middle)
    return sums(low)[1]


def _least_distance(limits, corner):
    """Of both legs together from the corner point, across the bisector, m a sample period; None: no speeds are left.
    About the last sample k at which leg 1 is as fast as leg 2: a is the speed of leg 1 at k + 1, b of leg 2 at k."""
    tap, feeds, cosine = Enclosure(limits.tap_max), (corner.feed_in, corner.feed_out), corner.cosine
    speed = corner.speed_min
    equal = (exact(speed) / square_root((1 - cosine) * 2)).lo  # both legs as fast

    def faster(slower):
        """The faster leg's speed: its square and b^2 less 2 a b cos(theta) make v_min^2."""
        x = Enclosure(slower)
        return (x * cosine + square_root(speed * speed - x * x * (1 - cosine) * (1 + cosine))).lo

    def faster_least(low, high):
        """Concave up to where both are equal; from there the slower leg is fast enough by itself."""
        return low if low >= equal else min(faster(low), faster(high) if high is not None and high < equal else equal)

    least, width = None, 2 * equal // CELLS
    for i in range(CELLS + 1):
        low, high = i * width, (i + 1) * width if i < CELLS else None
        # One sample changes a leg's speed by the largest tap at most.
        a = faster_least(low, high) - (tap * feeds[0]).hi
        b = max(low, faster_least(max(0, a), None) - (tap * feeds[1]).hi)
        parts = [(Enclosure(x) / feed).lo for x, feed in zip((a, b), feeds)]
        if (high is None or b <= high) and max(parts) <= ONE:  # no leg is faster than its feed
            ways = (Enclosure(_way(limits.tap_max, limits.ramp_max, part)) * feed for part, feed in zip(parts, feeds))
            distance = sum(ways).lo
            least = distance if least is None else min(least, distance)
    return least


def corner_speed(problem):
    """A smallest speed that no filter keeps within the corner's error, in words. None at all: the filter, the control's
    smoothing and the servo in series are one filter, too, whose taps the same limits bound."""
    problem = copy(problem)
    problem.smoothing = problem.response = exact([1])
    for corner in problem.corners:
        if corner.error is None or corner.speed_min <= 0 or (1 - corner.cosine).lo < ONE // 10**9:
            continue
        least = _least_distance(Limits(problem), corner)
        across = square_root((1 + corner.cosine) / 2) * problem.period
        if least is None or across * Enclosure(least) > corner.error:
            return f"corner {corner.name}: no filter keeps both its smallest speed and its tolerance"
    raise Refused("no smallest speed is surely too much within its corner's error")


def refuse_unless_infeasible(result):
    refuse_if(result["status"] != "infeasible", "the certificate is one of infeasibility, the status is not")


def contradiction(result, problem, certificate):
    refuse_unless_infeasible(result)
    return {"constant feed": constant_feed, "corner speed": corner_speed}[certificate["kind"]](problem)


claim.MEMBERS |= {"constant feed": set(), "corner speed": set()}
claim.CHECKS |= {"constant feed": contradiction, "corner speed": contradiction}
