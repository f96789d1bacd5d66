"""Proofs about families of a controller's filters: every member that could be shorter breaks a limit or needs delays
that cost too much."""
from fractions import Fraction
from functools import lru_cache
from itertools import accumulate, count
from math import ceil, floor, inf

from enclosure import PI, Enclosure, NotCovered, exact, exponential, number, refuse_if, square_root, turned, whole
from filters.members import Filter, ways_left
from problem import ROUNDING
from rows import Limits

IMPULSES = {"zv": [1, 1], "zvd": [1, 2, 1], "mzv": [1, square_root(exact(2)), 1], "ei": [21, 38, 21]}
END = 1 + Fraction(1, 10**9)  # a multiple at the end of its range counts in spite of rounding


class Members:
    """Lists the taps of all members of a task's families, up to a factor, of orders below the end."""

    def __init__(self, task, order_min, order_max, end):
        self.design, self.period, self.end = task["design"], number(task["sample_period_ms"]), end
        self.order_min, self.order_max = order_min, order_max

    def __iter__(self):
        families = self.design["family"]
        for family in families if isinstance(families, list) else [families]:
            refuse_if(family not in LISTS, f"the family {family!r}", NotCovered)
            for taps in map(exact, LISTS[family](self)):
                if self.order_min < len(taps.lo) <= self.end:
                    yield family, taps

    def _lengths(self, stage):
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

    def averages(self):
        """All averages in series. Equal stages count once."""
        stages = range(whole(self.design.get("stages", 2), 1, 3))
        return self._cascades([sorted({1, *self._lengths(stage)}) for stage in stages], [1], None)

    def _cascades(self, stages, taps, before):
        if not stages:
            yield taps
            return
        for length in stages[0]:
            if len(taps) + length - 1 > self.end or (before and before[0] == stages[0] and length > before[1]):
                break
            rest = [0] * (length - 1)
            sums = [0] * length + [*accumulate(taps + rest)]
            yield from self._cascades(stages[1:], [b - a for a, b in zip(sums, sums[length:])], (stages[0], length))

    def shaped(self):
        """Impulses of a shaper behind averages: at whole samples, or at all frequencies of a control that interpolates.
        There an impulse between two samples is on both."""
        shaper, step = self.design.get("shaper", "zv"), self.design.get("shaper_frequency_step_Hz")
        weights, apart = IMPULSES[shaper], Fraction(375 if shaper == "mzv" else 500)  # thousandths of a period
        most = apart / number(step) / self.period if step else 0
        for taps in map(exact, self.averages()):
            for delay in (max(1, most / m) for m in range(floor(most), 0, -1)) if step else count(1):
                over, sums = ceil((len(weights) - 1) * delay), exact(0)
                if len(taps.lo) + over > self.end:
                    break
                for x, weight in ((m * Fraction(delay), weight) for m, weight in enumerate(weights)):
                    for at, part in {(floor(x), 1 - x % 1), (ceil(x), x % 1 or 1)}:
                        before, behind = Enclosure([0] * at), Enclosure([0] * (over - at))
                        sums += before.then(taps * (exact(weight) * part)).then(behind)
                yield sums

    def poles(self):
        """Endless exponentials in series, cut off where less than 1e-4 of the step is left. Equal stages count once."""
        stages = [[0, *self._lengths(s)] for s in range(whole(self.design.get("stages", 2), 1, 3))]

        def more(s, constants):
            if s == len(stages):
                yield self._pole_taps(constants)
                return
            for tau in stages[s]:
                if s and stages[s] == stages[s - 1] and tau > constants[-1]:
                    break
                if len(self._pole_taps([*constants, tau]).lo) > self.end:
                    break
                yield from more(s + 1, [*constants, tau])

        return more(0, [])

    def _pole_taps(self, constants):
        """Up to one tap more than the end. A pole passes on what it does not hold until the next sample."""
        ratios = [exponential(Fraction(-1, tau)) for tau in constants if tau]
        held, taps, rest = [exact(0)] * len(ratios), [], exact(1)
        while rest > Fraction(1, 10**4) * (1 + Fraction(1, 10**10)) and len(taps) <= self.end:
            arrives, rest = exact(0 if taps else 1), exact(0)
            for s, each in enumerate(ratios):
                held[s], arrives = (held[s] + arrives) * each, (held[s] + arrives) * (1 - each)
                rest += held[s]
            taps.append(arrives)
        return exact(taps)

    def _grid(self, key, default, most, taps, least=1):
        """Orders of the first stage's lengths, with all multiples of a step up to most(order)."""
        yield [1]
        step = number(self.design.get(key, default))
        for order in (length - 1 for length in self._lengths(0) if length > least):
            for i in range(1, int(most(order) / step * END) + 1):
                yield taps(order, min(i * step, most(order)))

    def exponentials(self):
        def taps(order, constant):
            each = exponential(-self.period / constant)
            return [*accumulate([each] * order, lambda a, b: a * b, initial=exact(1))]

        return self._grid("time_constant_step_ms", self.period, lambda order: (self.order_max + 1) * self.period, taps)

    def gaussians(self):
        def taps(order, alpha):
            """exp(-e n^2), e = alpha^2/(2 N^2), n = 2 i - N, from the middle on: each by the last one's ratio."""
            n, found = order % 2, []
            unit = exponential(-alpha * alpha / (2 * order * order))
            power = [unit]  # unit^(2^i)
            for _ in range(3):
                power.append(power[-1] * power[-1])
            value, ratio = (unit, power[3]) if n else (exact(1), power[2])  # 4 n + 4 is 8 or 4
            while n <= order:
                found.append(value)
                value, ratio, n = value * ratio, ratio * power[3], n + 2
            return mirrored(order, found)

        return self._grid("alpha_step", Fraction(1, 10), lambda order: Fraction(6), taps)

    def sincs(self):
        def taps(order, cutoff):
            turn, found = PI * (2 * cutoff * self.period / 1000), []
            for n in range(order % 2, order, 2):  # n/2 from the middle; the ends are zero
                x = turn * Fraction(n, 2)
                wave = turned(0, x)[1] / x if n else exact(1)
                found.append(window(n, order) * Enclosure(max(wave.lo, 0), max(wave.hi, 0)))
            return mirrored(order, [*found, exact(0)])

        return self._grid("cutoff_step_Hz", 1, lambda order: 1000 / (order * self.period), taps, 2)


LISTS = {"averages": Members.averages, "shaper": Members.shaped, "one-pole": Members.poles,
         "exponential": Members.exponentials, "gaussian": Members.gaussians, "windowed-sinc": Members.sincs}


def mirrored(order, half):
    """Symmetric taps, from those of the middle on."""
    return half[:0:-1] + half if order % 2 == 0 else half[::-1] + half


@lru_cache(None)
def window(n, order):
    """Blackman's, n half samples from the middle."""
    cosine, _ = turned(0, PI * Fraction(n, order))
    value = cosine / 2 + Fraction(42, 100) + (cosine * cosine * 2 - 1) * Fraction(8, 100)
    return Enclosure(max(value.lo, 0), max(value.hi, 0))


class Ways:
    """How corners may be passed with a member, within the room that it leaves, in samples."""

    def __init__(self, problem, controller, member, room):
        self.problem, self.member, self.room = problem, member, room
        self.kinds = set(controller.get("delays") or ["dwell"])
        unknown = sorted(self.kinds - {"continuous", "dwell", "timed-axis", "exact-stop", "in-position", "corner-feed"})
        refuse_if(unknown, f"delays of the kinds {unknown}", NotCovered)
        self.corners, self.any = range(len(problem.corners)), bool({"dwell", "timed-axis"} & self.kinds)
        self.slow = "corner-feed" in self.kinds
        self.longest = len(member.taps.lo) + len(problem.response.lo)  # longer delays change nothing
        self.step = number(controller.get("corner_feed_step", Fraction(1, 20)))
        self.latency = round(number(controller.get("in_position_latency_ms", 0)) / 1000 / problem.period)
        self.actual = controller.get("in_position_of") == "actual"

    def far(self):
        """Whether the corners' errors alone, at their feeds, surely need delays that cost as much as the room."""
        return self._cost(map(self.member.nearest, self.corners)) >= self.room

    def too_dear(self):
        """Whether all ways that hold all limits surely cost as much as the room."""
        plain, cost = [], self._cost
        width = "in-position" in self.kinds and not self.any
        for j in self.corners:
            plain.append(self._plain(j, (self.room - (0 if width else cost(plain))) / self.problem.corners[j].weight))
            if not width and cost(plain) >= self.room:
                return True
        if not width or cost(plain) < self.room:
            return False
        # One width for all corners: the smaller it is, the longer each delay. Widths that are as good as equal are one.
        ways = ways_left(self.member.moved if self.actual else self.member.gone)
        free = [(j, c.feed_in) for j, c in enumerate(self.problem.corners) if c.delay is None]
        steps = sorted((x * feed, j) for j, feed in free for x, most in zip(ways.lo, ways.hi) if most)
        delays = [self.latency if c.delay is None else inf for c in self.problem.corners]
        while cost(map(min, plain, delays)) < self.room:
            cheap = zip(self.corners, plain, delays)
            if cost(d if d < p and not self.member.breaks(j, d) else p for j, p, d in cheap) < self.room:
                return False
            if not steps:
                break
            width = steps[-1][0]
            while steps and steps[-1][0] * END >= width:
                delays[steps.pop()[1]] += 1
        return True

    def _cost(self, samples):
        return sum(c.weight * x for c, x in zip(self.problem.corners, samples))

    def _plain(self, j, room):
        """The least samples that a corner costs without a width, if they are below the room."""
        corner, least = self.problem.corners[j], inf
        if corner.delay is not None:
            delays = [corner.delay]
        elif self.any:
            delays = range(self.member.nearest(j), self.longest + 1)
        else:
            taps = [i for i, b in enumerate(self.member.taps.hi) if b]
            apart = taps[-1] - taps[0]
            delays = [0] * ("continuous" in self.kinds) + [*range(apart, apart + 3)] * ("exact-stop" in self.kinds)
        for d in delays:
            if d >= room or least < inf:
                break
            if not self.member.breaks(j, d):
                least = d
        if self.slow and not corner.delay:
            for i in range(ceil(1 / self.step) - 1, 0, -1):
                lost = 2 * self.longest * (1 - i * self.step)
                if lost >= min(room, least):
                    break
                if not self.member.breaks(j, 0, i * self.step):
                    return lost
        return least


def refute(problem, task, target):
    """Number of members refuted: all that cost less than the target. None: all there are."""
    given = sum(c.weight * c.delay for c in problem.corners if c.delay is not None)
    limits, refuted, end, room = Limits(problem), 0, problem.order_max + 1, inf
    if target is not None:
        target *= 1 - ROUNDING
        end = min(end, max(0, ceil((target - given) / problem.filter_cost) - 1))
    for family, taps in Members(task, problem.order_min, problem.order_max, end):
        member = Filter(problem, limits, taps)
        if target is not None:
            room = target - problem.filter_cost * len(taps.lo)
        ways = Ways(problem, task.get("controller", {}), member, room)
        broken = not ways.slow and (member.steep() or ways.far()) or member.starts_or_stops_break() or member.rings()
        reason = f"a member of the family {family} with {len(taps.lo)} taps is not refuted"
        refuse_if(not broken and not ways.too_dear(), reason)
        refuted += 1
    return refuted
