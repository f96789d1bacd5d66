"""Proofs about families of a controller's filters: every member that could be shorter breaks a limit or needs delays
that cost too much."""
from fractions import Fraction
from itertools import count, product
from math import ceil, floor

from delays import breaks_a_limit, breaks_axis, too_far
from enclosure import PI, UNIT, ZERO, cos_sin, exact, exponential, square_root
from problem import NotCovered, Refused, number, refuse_if, whole

IMPULSES = {"zv": [1, 1], "zvd": [1, 2, 1], "ei": [21, 38, 21]}  # in whole numbers; those of mzv are not rational


def _per_stage(design, key, stages):
    """A time of each stage, ms; None where the task has none."""
    given = design.get(key)
    given = given if isinstance(given, list) else [given] * stages
    refuse_if(len(given) not in (1, stages), f"{key} has not one number a stage")
    given = given * stages if len(given) == 1 else given
    return [None if x is None else number(x) for x in given]


def _whole_lengths(times, most):
    return sorted({1} | {round(t) for t in times if abs(t - round(t)) <= Fraction(1, 10**6) and t <= most})


def _stages(task, most):
    """The lengths of each stage in samples, 1 for one that is off."""
    design, period = task["design"], number(task["sample_period_ms"])
    stages = whole(design.get("stages", 2))
    refuse_if(not 1 <= stages <= 3, "the task has not one to three stages")
    steps, caps = _per_stage(design, "length_step_ms", stages), _per_stage(design, "length_max_ms", stages)
    if "length_set_ms" in design:
        sets = [design.get(f"length_set_{i + 1}_ms", design["length_set_ms"]) for i in range(stages)]
        return [_whole_lengths({number(t) / period for t in times}, most) for times in sets]
    all_lengths = []
    for step, cap in zip(steps, caps):
        samples = max(1, round((step or period) / period))
        last = most if cap is None else min(most, int(cap / period * (1 + Fraction(1, 10**9))))
        all_lengths.append(sorted({1, *range(samples, last + 1, samples)}))
    return all_lengths


def _averaged(taps, length):
    sums, total = [], 0
    for i in range(len(taps) + length - 1):
        total += (taps[i] if i < len(taps) else 0) - (taps[i - length] if i >= length else 0)
        sums.append(total)
    return sums


def _cascades(stages, taps, end, before=None):
    """Taps of all averages in series, in whole numbers, of orders below the end. Equal stages count once."""
    if not stages:
        yield taps
        return
    same = before is not None and before[0] == stages[0]
    for length in stages[0]:
        if len(taps) + length - 2 >= end or (same and length > before[1]):
            break
        yield from _cascades(stages[1:], _averaged(taps, length), end, (stages[0], length))


def _delays(task):
    """Samples between impulses, rising: whole ones, or of all frequencies of a control that interpolates."""
    step = task["design"].get("shaper_frequency_step_Hz")
    lowest = 500 / (number(step) * number(task["sample_period_ms"])) if step else 0
    return (lowest / m for m in range(floor(lowest), 0, -1)) if step else count(1)


def _members(family, task, end):
    impulses, shaper = [1], task["design"].get("shaper", "zv")
    if family == "shaper" and shaper in IMPULSES:
        impulses = IMPULSES[shaper]
    elif family != "averages":
        raise NotCovered(f"the family {family!r}" + (f", {shaper}" if family == "shaper" else ""))
    gaps = len(impulses) - 1
    for taps in _cascades(_stages(task, end), [1], end):
        for delay in _delays(task) if gaps else [0]:
            sums = [0] * (len(taps) + ceil(gaps * delay))
            if len(sums) > end:
                break
            for m, impulse in enumerate(impulses):
                # An impulse between two samples is on both, in whole numbers.
                x, scale = m * delay, Fraction(delay).denominator
                for sample, part in ((floor(x), int(scale - x % 1 * scale)), (ceil(x), int(x % 1 * scale))):
                    for i, b in enumerate(taps):
                        sums[i + sample] += impulse * part * b
            yield sums


def _rings(problem, taps):
    for mode in problem.modes:
        for f, z in product((mode.low, (mode.low + mode.high) / 2, mode.high), {mode.least_damping, mode.most_damping}):
            natural = PI * exact(2 * f * problem.period)
            turn, fall = natural * square_root(exact(1 - z * z)), exponential(-(natural * exact(z)))
            cosines, sines, fallen = ZERO, ZERO, UNIT
            for i, b in reversed(list(enumerate(taps))):
                cosine, sine = cos_sin(turn.times(i))
                cosines, sines = cosines + (fallen * cosine).times(b), sines + (fallen * sine).times(b)
                fallen = fallen * fall if z else UNIT
            bound = exact(mode.residual * sum(taps))
            if (cosines * cosines + sines * sines).lo > (bound * bound).hi:
                return True
    return False


def _starts_or_stops_break(problem, gone):
    for corner in problem.corners:
        for axis, into, out in zip(problem.axes, corner.speed_in, corner.speed_out):
            start = [into * b for b in gone] + [into]
            stop = [out * (UNIT - b) for b in gone] + [ZERO]
            if any(breaks_axis(exact(problem.period), axis, speeds) for speeds in (start, stop)):
                return True
    return False


def _need_too_much(problem, gone, room):
    """Whether the corners' smallest delays cost as much as the room, or there are none."""
    order, cost = len(gone) - 2, 0
    for corner in problem.corners:
        last = order + 2 if corner.delay is None else corner.delay
        if room is not None:
            last = min(last, ceil((room - cost) / corner.weight) - 1)
        delay = 0 if corner.delay is None else corner.delay
        if last < delay:
            return True
        left, gained = [UNIT - b for b in gone] + [ZERO] * last, [ZERO] * last + gone
        # Up to 90 degrees no smaller delay is nearer.
        if corner.cosine.lo >= 0 and too_far(problem, corner, left, gained):
            return True
        while delay <= last and breaks_a_limit(problem, corner, gone, delay):
            delay += 1
        if delay > last:
            return True
        cost += corner.weight * delay
    return False


def refute(problem, task, target):
    """Number of members refuted: all that cost less than the target. None: all there are."""
    kinds = task.get("controller", {}).get("delays", ["dwell"])
    if not {"dwell", "timed-axis"} & set(kinds) or "corner-feed" in kinds:
        raise NotCovered(f"delays of the kinds {kinds}")
    if problem.supply or len(problem.response) > 1 or any(axis.coulomb > 0 for axis in problem.axes):
        raise NotCovered("families with a servo, dry friction or a shared supply")
    given, refuted = sum(c.weight * c.delay for c in problem.corners if c.delay is not None), 0
    end = problem.order_max + 1
    if target is not None:
        target *= 1 - Fraction(1, 10**9)
        end = min(end, max(0, ceil((target - given) / problem.filter_cost) - 1))
    families = task["design"]["family"]
    for family in families if isinstance(families, list) else [families]:
        for taps in _members(family, task, end):
            if len(taps) - 1 < problem.order_min:
                continue
            sums = [0]
            for b in taps:
                sums.append(sums[-1] + b)
            gone = [exact(Fraction(s, sums[-1])) for s in sums]
            room = None if target is None else target - problem.filter_cost * len(taps)
            if not (_starts_or_stops_break(problem, gone) or _rings(problem, taps)
                    or _need_too_much(problem, gone, room)):
                raise Refused(f"a member of the family {family} with {len(taps)} taps is not refuted")
            refuted += 1
    return refuted
