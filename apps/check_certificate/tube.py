"""Bounds on the cumulative response B_0 .. B_{N+1} that limits on start and stop leave, and splits of the proof."""
from enclosure import BITS, ONE, exact

SWEEPS, STEPS = 10, 50  # over all samples; of a bisection


def up(a, b):
    """a/b rounded up, b > 0."""
    return -(-a // b)


def least_before(axis, period, speed, stop):
    """Of B_{k-1}, by B_k, for each limit on the start or stop of an axis of mass: functions of numbers times ONE, which
    round down. Each is concave. Over the speed s the force is slope B_k - m/T B_{k-1}, the same of 1 - B at a stop."""
    inertia, limits, found = exact(axis.mass / period), axis.limits, []
    slope = inertia + axis.damping
    if "force" in limits:  # dry friction is against a start and helps a stop
        most = (limits["force"] + (axis.coulomb if stop else -axis.coulomb)) / speed + axis.damping * stop
        found.append(lambda y: (slope.lo * y - (most.hi << BITS)) // inertia.hi)
    if "power" in limits and not stop:  # force B_k <= P/s^2
        power = (limits["power"] / (speed * speed)).hi << 2 * BITS
        found.append(lambda y: (slope.lo * y - up(power, max(y, 1))) // inertia.hi)
    if "regeneration" in limits and stop and axis.coulomb == 0:  # without its dry friction a stop would brake more
        braking = (limits["regeneration"] / (speed * speed)).hi << 2 * BITS
        found.append(lambda y: ONE - up(slope.hi * max(ONE - y, 1) + up(braking, max(ONE - y, 1)), inertia.lo))
    return found


def highest_after(least, x, high):
    """Of B_k, where B_{k-1} <= x and B_k <= high. Constant speed keeps the limit; what is above x is an interval."""
    low = min(x, high)
    for _ in range(STEPS if least(high) > x else 0):
        middle = (low + high) // 2
        low, high = (low, middle) if least(middle) > x else (middle, high)
    return high


def tube(limits, tap_max, ramp_max, order, cuts):
    """Lists of the least and the largest B_k; None if no filter of this order or less is left. limits: least B_{k-1} by
    B_k. tap_max, ramp_max: of any tap, of any difference of two, times ONE. cuts: bounds of B by sample."""
    last = order + 1
    low, high, most = [0] * last + [ONE], [0] + [ONE] * last, 0
    for sample, (least, largest) in cuts.items():
        k = min(sample, last)
        low[k], high[k] = max(low[k], exact(least).lo), min(high[k], exact(largest).hi)
    for k in range(1, last):  # tap i is at most (i + 1) ramp_max, and as much from the other end
        most += min(tap_max, ramp_max * k)
        high[k], low[last - k] = min(high[k], most), max(low[last - k], ONE - most)
    for _ in range(SWEEPS):
        for k in range(1, last + 1):
            high[k], low[k] = min(high[k], high[k - 1] + tap_max), max(low[k], low[k - 1])
            for least in limits:
                high[k] = highest_after(least, high[k - 1], high[k])
        for k in range(last, 0, -1):
            before = (min(least(low[k]), least(high[k])) for least in limits)
            low[k - 1], high[k - 1] = max(low[k - 1], low[k] - tap_max, *before), min(high[k - 1], high[k])
        if any(a > b for a, b in zip(low, high)):
            return None
    return low, high
