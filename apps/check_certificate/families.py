"""Proofs about families of filters: every member that could be shorter breaks a limit or needs delays that do."""
from collections import Counter
from fractions import Fraction
from functools import lru_cache, reduce
from itertools import accumulate, combinations_with_replacement
from math import ceil, inf

import members
from enclosure import PI, NotCovered, exact, exponential, number, refuse_if, turned, whole
from members import Filter, ways_left
from problem import ROUNDING, convolved
from rows import Limits

END = 1 + Fraction(1, 10**9)  # a multiple at the end of its range counts in spite of rounding
ANY = {"dwell", "timed-axis"}  # kinds of delays of any length
DELAYS = ANY | {"continuous", "exact-stop", "in-position"}


class Members:
    """Lists the taps of all members of a task's families, up to a factor, of orders below the end."""

    def __init__(self, problem, design, end):
        self.problem, self.period, self.design, self.end = problem, problem.period * 1000, design, end

    def __iter__(self):
        families = self.design["family"]
        for family in families if isinstance(families, list) else [families]:
            refuse_if(family not in LISTS, f"the family {family!r}", NotCovered)
            for taps in map(exact, LISTS[family](self)):
                if self.problem.order_min < len(taps.lo) <= self.end:
                    yield family, taps

    def lengths(self):
        """What each stage can be set to, in samples."""
        ends = [self.design.get("length_step_ms", self.period), self.design.get("length_max_ms", 10**8)]
        ends = [set(end) if isinstance(end, list) else {end} for end in ends]
        refuse_if(max(map(len, ends)) > 1, "stages of different lengths", NotCovered)
        step, most = (number(*end) / self.period for end in ends)
        samples = max(1, round(step))
        return range(samples, min(self.end, int(most * END)) + 1, samples)

    def averages(self):
        """All averages in series. Equal stages count once."""
        stages = whole(self.design.get("stages", 2), 1, 3)
        for lengths in combinations_with_replacement(sorted({1, *self.lengths()}), stages):
            if sum(lengths) - stages < self.end:
                yield reduce(convolved, (exact([1] * length) for length in lengths))

    def symmetric(self, key, default, most, tap, least=1):
        """Taps at x = |2 i - N|/N, for orders of a stage's lengths and all multiples of a step up to most(order)."""
        yield [1]
        step = number(self.design.get(key, default))
        for order in (length - 1 for length in self.lengths() if length > least):
            for i in range(1, int(most(order) / step * END) + 1):
                value = min(i * step, most(order))
                half = [tap(order, value, Fraction(n, order)) for n in range(order % 2, order + 1, 2)]
                yield half[::-1] + half[1 - order % 2:]

    def gaussians(self):
        return self.symmetric("alpha_step", Fraction(1, 10), lambda _: 6, lambda _, a, x: exponential(-(a * x)**2 / 2))

    def sincs(self):
        def tap(order, cutoff, x):
            z = PI * (cutoff * self.period / 1000 * order * x)
            return blackman(x) * (turned(0, z)[1] / z).positive() if x else exact(1)

        return self.symmetric("cutoff_step_Hz", 1, lambda order: 1000 / (order * self.period), tap, 2)


LISTS = {"averages": Members.averages, "gaussian": Members.gaussians, "windowed-sinc": Members.sincs}


@lru_cache(None)
def blackman(x):
    """The window at a part of its half width; the ends are zero."""
    cosine, _ = turned(0, PI * x)
    value = cosine / 2 + Fraction(42, 100) + (cosine * cosine * 2 - 1) * Fraction(8, 100)
    return value.positive() if x < 1 else exact(0)


def plain_delay(problem, kinds, member, j, room):
    """The least samples that a corner costs without an in-position width; infinite if as many as the room."""
    def held(delays):
        return next((d for d in delays if d * corner.weight < room and not member.breaks(j, d)), inf)

    corner, stop = problem.corners[j], len(member.command.lo) - 1
    if kinds & ANY:  # longer ones change nothing
        return held(range(len(member.gone.lo) + len(problem.response.lo)) if corner.delay is None else [corner.delay])
    ways = [held([0] * ("continuous" in kinds)), held([stop, stop + 1] * ("exact-stop" in kinds))]
    return min((d for d in ways if corner.delay in (None, d)), default=inf)


def passes_too_late(problem, controller, member, room):
    """Whether all ways to pass the corners that hold all limits surely cost as much as the room, in samples."""
    def dear(samples):
        return any(cost >= room for cost in accumulate(c.weight * x for c, x in zip(problem.corners, samples)))

    kinds, corners = set(controller.get("delays") or ["dwell"]), range(len(problem.corners))
    refuse_if(kinds - DELAYS, f"delays of the kinds {sorted(kinds - DELAYS)}", NotCovered)
    plain = [plain_delay(problem, kinds, member, j, room) for j in corners]
    if not dear(plain) or "in-position" not in kinds or kinds & ANY:
        return dear(plain)
    # One width for all corners: the smaller it is, the longer each delay. Widths that are as good as equal are one.
    ways = ways_left(member.moved if controller.get("in_position_of") == "actual" else member.gone)
    axis = controller.get("in_position_by") == "axis"
    speeds = [max(abs(x).lo for x in c.speed_in) if axis else exact(c.feed_in).lo for c in problem.corners]
    steps = sorted((x * v, j) for j, v in enumerate(speeds) for x, most in zip(ways.lo, ways.hi) if most)
    latency = round(number(controller.get("in_position_latency_ms", 0)) / 1000 / problem.period)
    delays = [latency if c.delay is None else inf for c in problem.corners]
    while not dear(map(min, plain, delays)):
        if not dear(d if d < p and not member.breaks(j, d) else p for j, p, d in zip(corners, plain, delays)):
            return False
        if not steps:
            break
        width = ceil(steps[-1][0] / END)
        while steps and steps[-1][0] >= width:
            delays[steps.pop()[1]] += 1
    return True


def why(problem, controller, member, room):
    """What refutes a member, if anything does; more/splits.py names it."""
    return member.starts_or_stops_break() or member.rings() or passes_too_late(problem, controller, member, room)


def refute(problem, task, target):
    """Family and reason of each member that costs less than the target. None: of all there are."""
    limits, end, most = Limits(problem), problem.order_max + 1, inf
    if target is not None:
        most, given = target * (1 - ROUNDING), sum(c.weight * (c.delay or 0) for c in problem.corners)
        end = min(end, max(0, ceil((most - given) / problem.filter_cost) - 1))
    for family, taps in Members(problem, task["design"], end):
        room, member = most - problem.filter_cost * len(taps.lo), Filter(problem, limits, taps)
        yield family, why(problem, task.get("controller", {}), member, room) or members.not_refuted(
            f"a member of the family {family} with {len(taps.lo)} taps is not refuted")


def compare(claimed, refuted):
    """The members that a certificate counts, by family and rule, with those refuted, by family and reason."""
    counts = sum((Counter({family: whole(n, 0)}) for family, _, n in claimed), Counter())
    seen = sum((Counter({family: n}) for (family, _), n in refuted.items()), Counter())
    refuse_if(counts != seen, f"the certificate counts the members {dict(counts)}, there are {dict(seen)}")
