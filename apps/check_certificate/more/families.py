"""Families of a controller's filters whose stages differ; shapers, exponentials, poles; corners passed at a part of
their feed."""
from fractions import Fraction
from itertools import accumulate, count
from math import ceil, floor

import families
from enclosure import Enclosure, exact, exponential, number, square_root, whole
from families import DELAYS, END, LISTS, Members
from more.members import breaks_at_a_part
from more.widening import widens

IMPULSES = {"zv": [1, 1], "zvd": [1, 2, 1], "mzv": [1, square_root(exact(2)), 1], "ei": [21, 38, 21]}
DELAYS.add("corner-feed")


@widens(families, "plain_delay")
def plain_delay(narrow, problem, kinds, member, j, room):
    least, corner = narrow(problem, kinds, member, j, room), problem.corners[j]
    longest, step = len(member.taps.lo) + len(problem.response.lo), problem.corner_feed_step
    if problem.corner_feeds and not corner.delay:
        for i in range(ceil(1 / step) - 1, 0, -1):
            lost = 2 * longest * (1 - i * step)
            if lost >= min(room / corner.weight, least):
                break
            if not breaks_at_a_part(member, j, i * step):
                return lost
    return least


@widens(Members, "lengths")
def lengths(_, self, stage=0):
    """What a stage can be set to, in samples."""
    def given(key):
        """One number, or one a stage."""
        numbers = self.design.get(key)
        return numbers[min(stage, len(numbers) - 1)] if isinstance(numbers, list) else numbers

    times = self.design.get(f"length_set_{stage + 1}_ms", self.design.get("length_set_ms"))
    if times is not None:
        times = [number(t) / self.period for t in times]
        return sorted({round(t) for t in times if abs(t - round(t)) <= t / 10**6 and t < self.end + 1})
    samples = max(1, round(number(given("length_step_ms") or self.period) / self.period))
    last = int(number(given("length_max_ms") or 10**8) / self.period * END)
    return range(samples, min(self.end, last) + 1, samples)


def averages(members):
    """All averages in series. Equal stages count once."""
    stages = range(whole(members.design.get("stages", 2), 1, 3))
    return cascades(members, [sorted({1, *members.lengths(stage)}) for stage in stages], [1], None)


def cascades(members, stages, taps, before):
    if not stages:
        yield taps
        return
    for length in stages[0]:
        if len(taps) + length - 1 > members.end or (before and before[0] == stages[0] and length > before[1]):
            break
        sums = [0] * length + [*accumulate(taps + [0] * (length - 1))]
        yield from cascades(members, stages[1:], [b - a for a, b in zip(sums, sums[length:])], (stages[0], length))


def shaped(members):
    """Impulses of a shaper behind averages: at whole samples, or at all frequencies of a control that interpolates.
    There an impulse between two samples is on both."""
    shaper, step = members.design.get("shaper", "zv"), members.design.get("shaper_frequency_step_Hz")
    weights, apart = IMPULSES[shaper], Fraction(375 if shaper == "mzv" else 500)  # thousandths of a period
    most = apart / number(step) / members.period if step else 0
    for taps in map(exact, averages(members)):
        for delay in (max(1, most / m) for m in range(floor(most), 0, -1)) if step else count(1):
            over, sums = ceil((len(weights) - 1) * delay), exact(0)
            if len(taps.lo) + over > members.end:
                break
            for x, weight in ((m * Fraction(delay), weight) for m, weight in enumerate(weights)):
                for at, part in {(floor(x), 1 - x % 1), (ceil(x), x % 1 or 1)}:
                    before, behind = Enclosure([0] * at), Enclosure([0] * (over - at))
                    sums += before.then(taps * (exact(weight) * part)).then(behind)
            yield sums


def poles(members):
    """Endless exponentials in series, cut off where less than 1e-4 of the step is left. Equal stages count once."""
    stages = [[0, *members.lengths(s)] for s in range(whole(members.design.get("stages", 2), 1, 3))]

    def more(s, constants):
        if s == len(stages):
            yield pole_taps(members, constants)
            return
        for tau in stages[s]:
            if s and stages[s] == stages[s - 1] and tau > constants[-1]:
                break
            if len(pole_taps(members, [*constants, tau]).lo) > members.end:
                break
            yield from more(s + 1, [*constants, tau])

    return more(0, [])


def pole_taps(members, constants):
    """Up to one tap more than the end. A pole passes on what it does not hold until the next sample."""
    ratios = [exponential(Fraction(-1, tau)) for tau in constants if tau]
    held, taps, rest = [exact(0)] * len(ratios), [], exact(1)
    while rest > Fraction(1, 10**4) * (1 + Fraction(1, 10**10)) and len(taps) <= members.end:
        arrives, rest = exact(0 if taps else 1), exact(0)
        for s, each in enumerate(ratios):
            held[s], arrives = (held[s] + arrives) * each, (held[s] + arrives) * (1 - each)
            rest += held[s]
        taps.append(arrives)
    return exact(taps)


def exponentials(members):
    yield [1]
    step = number(members.design.get("time_constant_step_ms", members.period))
    most = (members.problem.order_max + 1) * members.period
    for order in (length - 1 for length in members.lengths() if length > 1):
        for i in range(1, int(most / step * END) + 1):
            each = exponential(-members.period / min(i * step, most))
            yield [*accumulate([each] * order, lambda a, b: a * b, initial=exact(1))]


LISTS |= {"averages": averages, "shaper": shaped, "one-pole": poles, "exponential": exponentials}
