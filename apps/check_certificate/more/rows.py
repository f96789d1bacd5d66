"""Rows that no shipped proof names. README.md of lib/accdec/certificate has the formulas."""
from copy import copy
from fractions import Fraction
from math import floor

from enclosure import BITS, ONE, PI, Enclosure, NotCovered, exact, refuse_if, square_root, turned
from more.widening import widens
from problem import STILL
from rows import BEHIND_A_SERVO, IN_WINDOWS, KINDS, Limits, Row, turns
from tube import tube

ANY_SAMPLE, NOTHING = (0, 2**31 - 1), exact([0])


@widens(Limits, "__init__")
def limits_behind_smoothing(narrow, self, problem):
    """Limits are then on the taps of the command. It has each designed tap times the largest of the smoothing."""
    narrow(self, problem)
    self.command_max = self.tap_max
    if len(problem.smoothing.lo) > 1:
        self.tap_max = min(ONE, -(-self.command_max * ONE // max(problem.smoothing.lo)))


@widens(Limits, "tube")
def tube_behind_smoothing(narrow, self, box):
    """Taps of the motion are averages of the command's."""
    if len(self.problem.smoothing.lo) > 1 and box.tube is False:
        box.tube = tube(self.before, self.command_max, self.ramp_max, box.order + self.longer, box.cuts)
    return narrow(self, box)


@widens(Row, "__init__")
def row_of_command(narrow, self, limits, box):
    narrow(self, limits, box)
    self.behind = limits.problem.smoothing  # the taps behind the designed ones: of the command, or of the motion


def add_behind(row, c, values, k):
    """c times the value of number k - i for each designed tap i; beyond them the first or the last one counts. An end
    of a window stands for taps at any distance, so any value from there on may be its own."""
    at = [min(max(k - i, 0), len(values.lo) - 1) for i in row.indices]
    weights = [values[n] for n in at]
    if row.box.window:
        weights[0], weights[-1] = (Enclosure(min(x.lo), max(x.hi)) for x in (values[at[0]:], values[:at[-1] + 1]))
    row.taps = [tap + part for tap, part in zip(row.taps, (exact(weights) * c).lo)]


@widens(Row, "tap")
def tap_behind(narrow, self, n, c):
    """c sum_j g_j b_{n-j}"""
    if len(self.behind.lo) == 1:
        return narrow(self, n, c)
    add_behind(self, c, NOTHING.then(self.behind).then(NOTHING), n + 1)


@widens(Row, "move")
def speed_behind(narrow, self, k, into, out, d):
    if len(self.behind.lo) == 1:
        return narrow(self, k, into, out, d)
    self.limit(-into)
    add_behind(self, -into, self.behind.sums(), k)
    add_behind(self, out, self.behind.sums(), k - d)


@widens(Row, "inside")
def inside_behind(narrow, self, *taps):
    """Behind a servo the ends have weights of their own."""
    if len(self.behind.lo) == len(self.problem.smoothing.lo):
        narrow(self, *taps, *(i - len(self.behind.lo) + 1 for i in taps))


@widens(Row, "vibration")
def vibration_behind_smoothing(narrow, self, *at, **named):
    """Of the command, whose taps are as many more as the smoothing has."""
    taps = self.problem.smoothing
    if len(taps.lo) == 1:
        return narrow(self, *at, **named)
    refuse_if(self.box.window, "a row `vibration` behind a smoothing says nothing of filters of any order")
    longer = copy(self.box)
    longer.order += len(taps.lo) - 1
    command = Row(self.limits, longer)
    narrow(command, *at, **named)
    self.taps = [sum(c * (g.lo if c >= 0 else g.hi) for c, g in zip(command.taps[i:], taps)) >> BITS
                 for i in self.indices]
    self.bound += command.bound


def acceleration(row, k, sign):
    """A tap of the command, which has no bound of its own behind a smoothing."""
    row.inside(k)
    row.tap(k, exact(sign) / Enclosure(row.limits.command_max))
    row.limit(1)


@widens(Limits, "named")
def named(narrow, self, letter, x):
    """Yes or no b, too."""
    refuse_if(letter == "b" and not isinstance(x, bool), f"{x!r} stands where true or false should")
    return x if letter == "b" else narrow(self, letter, x)


def budget(row):
    row.others[:len(row.box.corners)] = [exact(corner.weight).lo for corner in row.problem.corners]
    row.limit(row.box.budget)


def force(row, event, *at, axis=None):
    """Of the motion behind the response."""
    row.behind = row.problem.response
    row.load("force", event, *at, axis=axis)


def response(row, k, sign):
    add_behind(row, exact(sign), row.problem.response.sums(), k)
    row.limit(row.responses(k) * sign)


def power(row, *at):
    row.behind = row.problem.response
    row.power(*at)


def force_speed(row, event, *at):
    """|F| + slope |V| <= bound: a force with more or less damping."""
    *at, line, direction = at if event == "blend" else (*at, 1)
    a, _, sign, *_ = row.legs(event, at)
    axis = row.problem.axes[a]
    slope, bound = axis.lines[line]
    force(row, event, *at, axis=axis._replace(damping=axis.damping + sign * direction * slope, limits={"force": bound}))


def speed(row, j, k, low, high):
    """|V| >= v_min with V between the directions low and high: n V >= v_min cos((high - low)/2), n half way. In the
    plane of motion V = v1 (1 - B_k) (1, 0) + v2 B_{k-d} (-cos theta, sin theta)."""
    corner, (d1, d2, _, _) = row.problem.corners[j], row.box.corners[j]
    refuse_if(corner.speed_min == 0, "a row `speed` names a corner without a smallest speed")
    refuse_if(not low < high or exact(high - low).hi >= PI.lo, "a sector is half a turn or more, or none")
    if not 1 <= k <= row.box.order + row.limits.longer + d1:
        return
    row.behind = row.problem.response
    into = (1 - row.responses(k)) * corner.feed_in
    out = Enclosure(row.responses(k - d2).lo, row.responses(k - d1).hi) * corner.feed_out

    def seen(angle):
        """Parts of both legs' unit vectors along a direction, and to the left of it."""
        ca, sa = turned(0, angle)
        return ca, corner.sine * sa - corner.cosine * ca, -sa, corner.sine * ca + corner.cosine * sa

    # Outside by so little is allowed and paid for; not behind, where a narrow sector has both edges beside it, too.
    outside = corner.fastest / 10**12
    of_in, of_out, _, _ = seen((low + high) / 2)
    edges = [(x * into + y * out) for _, _, x, y in (seen(low), seen(high))]
    beside = min(edges[0].lo, -edges[1].hi, (of_in * into + of_out * out).lo) < -exact(outside).lo
    refuse_if(beside, "a sector does not hold all directions that are left in its part")
    refuse_if(d1 != d2 and of_out.lo < 0, "a sector is used for several delays, but does not hold for all")
    # half - n V/v_min <= 0; of several delays the least has the most of leg 2
    row.move(k, -of_in * (corner.feed_in / corner.speed_min), -of_out * (corner.feed_out / corner.speed_min), d1)
    row.limit(2 * outside / corner.speed_min - turned(0, (high - low) / 2)[0])


def contour(row, j, out):
    """The nearer leg is min(p, q) sin(theta) away. So p(c) <= m and q(c - d) <= m at one time c, m the tolerance over
    sin(theta). Between whole numbers both are linear; over c1 .. c2 and d1 .. d2 they are at least p(c2) and
    q(c1 - d2)."""
    corner, (c1, c2), (_, d2, _, _) = row.problem.corners[j], row.box.ranges[j, "c"], row.box.corners[j]
    feed, time, add = (corner.feed_out, c1 - d2, row.gone) if out else (corner.feed_in, c2, row.to_go)
    part = time - floor(time)
    add(floor(time), exact(feed / corner.fastest * (1 - part)))
    add(floor(time) + 1, exact(feed / corner.fastest * part))
    row.limit(corner.contour / row.problem.period / corner.fastest / corner.sine)


def width(row, i, j):
    """v_i p(e_i) <= v_j p(e_j - 1), e the delay less the latency: corner i at its longest, j at its shortest."""
    problem, box = row.problem, row.box
    refuse_if(not problem.one_width or problem.symmetric, "a row `width` for a control with other delays")
    last = box.corners[j][0] - problem.latency - 1
    refuse_if(last < 0, "a multiplier names the width before a corner that may not wait for it")
    feeds = [exact(problem.corners[c].watched) for c in (i, j)]
    faster = max(feeds, key=lambda feed: feed.hi)
    for sample, feed in ((box.corners[i][1] - problem.latency, feeds[0]), (last, -feeds[1])):
        for n, tap in enumerate(problem.response if problem.actual else problem.smoothing):
            row.add(tap * (feed / faster), [max(k - sample + n, 0) for k in row.indices])
    row.limit(Fraction(1, 10**9))


def reversal_range(row, j, a):
    return row.box.ranges.get((j, a, "r"), ANY_SAMPLE)


def reversal(row, j, a, k, sign):
    """An axis that reverses moves as along leg 2 from the end of its range on, and stands at most before its start."""
    *_, into, out, d, _ = row.legs("blend", (j, a, k, sign))
    refuse_if(not -into * out > 0, "a multiplier names a reversal that is not there")
    first, last = reversal_range(row, j, a)
    refuse_if(k < last if sign > 0 else k >= first, "a multiplier names a sample at which an axis may reverse")
    c = exact((1 if out.lo < 0 else -1) * sign / row.problem.corners[j].fastest)
    row.behind = row.problem.response
    row.move(k, into * c, out * c, d)
    row.limit(0 if sign > 0 else 2 * STILL)


@widens(Row, "direction")
def direction(narrow, self, at, into, out):
    """From the end of its range on, an axis has reversed."""
    kept = narrow(self, at, into, out)
    reversed_ = not kept and at[2] >= reversal_range(self, at[0], at[1])[1]
    return (1 if out.lo > 0 else -1) if reversed_ else kept


def range_error(row, j, angle, a, a_after, a_high, b, b_after, b_high):
    refuse_if("t" in row.box.ranges, "a multiplier names samples where errors are bounded at instants")
    (d1, d2, k1, k2), (of_p, of_q), corners = row.box.corners[j], row.seen(j, angle, False), len(row.box.corners)
    # p_k >= p_a - z G, z = k - a, G = 1 - B_e, and z G <= z0 G + g (z - z0)
    e = row.responses(a + a_after)
    g, z0 = of_p * (1 - Enclosure(e.lo if a_high else e.hi)), (k1 if a_high else k2) - a
    row.to_go(a, of_p)
    row.response(a + a_after, of_p * z0)
    row.limit(of_p * z0 + g * (k1 - a - z0))
    # q_m >= q_b + y B_e, y = m - b, and y B >= y0 B + h (y - y0)
    e = row.responses(b + b_after)
    h, y0 = of_q * Enclosure(e.hi if b_high else e.lo), (k2 - d1 if b_high else k1 - d2) - b
    row.gone(b, of_q)
    row.response(b + b_after, of_q * y0)
    row.limit(-h * (k1 - d1 - b - y0))
    row.others[j], row.others[corners + j] = (-h).lo, (h - g).lo


def residual(limits, mode, natural, damped, z, j=None, d=0):
    """The bound of a mode's residual. An axis' amplitude in metres bounds the residual of the filter. Both legs of a
    blend excite the mode through the same filter, the first one d samples earlier: times
    |v2 - v1 exp(-(z w + i wd) d)|/wd. A start or stop has one leg. None if nothing excites the mode."""
    if mode.axis is None:
        return exact(mode.residual)
    most = max(limits.ends[mode.axis], key=lambda x: x.lo)
    if j is not None:
        corner = limits.problem.corners[j]
        along, across = turned(natural * z * d, damped * d)
        along = abs(corner.speed_out[mode.axis] - corner.speed_in[mode.axis] * along)
        across = abs(corner.speed_in[mode.axis] * across)
        most = square_root(along * along + across * across)
    return damped / most * (mode.displacement / limits.problem.period) if most.lo > 0 else None


def vibration(row, m, *at):
    *corner, frequency, z, angle = at if len(at) > 2 else (at[0], 0, at[1])
    mode, j = row.problem.modes[m], corner[0] if corner else None
    refuse_if(mode.axis is None and j is not None, "a multiplier sees a blend in a mode of the filter")
    d1, d2, _, _ = row.box.corners[j or 0] if corner else (0, 0, 0, 0)
    refuse_if(d1 != d2, "a limit of the blend is used for several delays at once")
    many = corner and d1 >= row.problem.order_max + 2 + row.limits.longer and row.problem.corners[j].delay is None
    refuse_if(many, "a multiplier names the phase of a delay that stands for many")
    natural, damped, _, _ = turns(frequency * row.problem.period, z, row.box.order)
    bound = residual(row.limits, mode, natural, damped, z, j, d1)
    refuse_if(bound is None, "a multiplier names a mode that nothing excites")
    row.vibration(m, frequency, z, angle, bound=bound)


KINDS |= {
    "acceleration": (acceleration, "ks"), "budget": (budget, ""), "range error": (range_error, "jxkbbkbb"),
    "contour": (contour, "jb"), "width": (width, "jj"), "reversal": (reversal, "jaks"), "speed": (speed, "jkxx"),
    "force start": (force, "ak", "start"), "force stop": (force, "ak", "stop"), "blend force": (force, "jaks", "blend"),
    "blend force_speed": (force_speed, "jaksks", "blend"),
    "force_speed start": (force_speed, "akk", "start"), "force_speed stop": (force_speed, "akk", "stop"),
    "response": (response, "ks"), "power start": (power, "akxx", "power", "start"),
    "regeneration stop": (power, "akxx", "regeneration", "stop"),
    **{f"blend {kind}": (power, "jaksxx", kind, "blend") for kind in ("power", "regeneration")},
    "vibration": (vibration, "mxx"), "damped vibration": (vibration, "mxxx"), "blend vibration": (vibration, "mjxxx"),
}
BEHIND_A_SERVO |= {"acceleration", "contour", "budget", "blend vibration", "width", "force start", "force stop",
                   "blend force", "force_speed start", "force_speed stop", "blend force_speed", "reversal", "response",
                   "power start", "regeneration stop", "blend power", "blend regeneration", "speed"}
IN_WINDOWS |= {"acceleration", "force_speed start", "force_speed stop", "blend force_speed"}
