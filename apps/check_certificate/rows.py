"""Limits of a task as rows `terms <= bound`, from the names a certificate gives them. A row holds for every design in
the part of the search that it is asked for; README.md of lib/accdec/certificate has the formulas."""
from math import floor

import chords
from axes import curve, modes
from enclosure import ONE, UNIT, ZERO, Enclosure, cos_sin, exact, square_root
from problem import NotCovered, number, refuse_if, whole
from tube import Plant, tube

TAPS, RESPONSES, RISES, FALLS, DELAYS, SAMPLES = range(6)


class Empty(Exception):
    """No filter is in a part of the search."""


class Row:
    """Coefficients of what is never negative, so that lower ends stand for them: of taps, of responses B_k, of
    p_k = sum b_i max(i - k, 0), of q_m = sum b_i max(m - i, 0), of delays and samples less the least of their
    ranges."""

    def __init__(self, order, response, window):
        self.order, self.response_taps, self.window, self.terms, self.bound = order, response, window, [], 0

    def term(self, what, at, c):
        if not c.is_zero():
            self.terms.append((what, at, c.lo))

    def tap(self, i, c):
        if 0 <= i <= self.order:
            self.term(TAPS, i, c)

    def response(self, k, c):
        if k > self.order:  # B_k = 1
            self.bound -= c.lo
        elif k > 0:
            self.term(RESPONSES, k, c)

    def to_go(self, k, c):
        """c p_k, behind the servo's taps r_j: c sum_j r_j p_{k-j}. The first tap of a window stands for those before
        it, too, and has no part in it."""
        if self.window and len(self.response_taps) > 1:
            for i in range(1, self.order + 1):
                late = enumerate(self.response_taps[max(0, k - i + 1):], max(0, k - i + 1))
                self.term(TAPS, i, c * sum((tap.times(i - k + j) for j, tap in late), ZERO))
            return
        for j, tap in enumerate(self.response_taps):
            self._to_go(k - j, c if len(self.response_taps) == 1 else c * tap)

    def gone(self, m, c):
        """c q_m, behind the servo's taps: c sum_j r_j q_{m-j}"""
        for j, tap in enumerate(self.response_taps):
            self._gone(m - j, c if len(self.response_taps) == 1 else c * tap)

    def _to_go(self, k, c):
        self.bound += c.lo * min(k, 0)  # p_k = p_0 - k for k < 0
        if k < self.order:
            self.term(RISES, max(k, 0) + 1, c)

    def _gone(self, m, c):
        self.bound -= c.lo * max(m - self.order, 0)  # q_m = q_N + m - N for m > N
        if min(m, self.order) > 0:
            self.term(FALLS, min(m, self.order) - 1, c)

    def limit(self, c):
        self.bound += c.hi


def sign_of(x):
    return -1 if whole(x) < 0 else 1


def member(items, i, what):
    refuse_if(not 0 <= whole(i) < len(items), f"a multiplier names {what} that is not there")
    return items[i]


class Rows:
    def __init__(self, problem):
        self.problem, self.period = problem, exact(problem.period)
        self.longer = len(problem.response) - 1  # by how many samples the servo lengthens a motion
        self.start, self.stop, self.plants = [], [], []
        self.tap_max = self.ramp_max = ONE  # at least what any tap, any difference of two may be, times ONE
        for a, axis in enumerate(problem.axes):
            self._events(axis, [(c.speed_in[a], c.speed_out[a]) for c in problem.corners])

    def _events(self, axis, legs):
        """The fastest start along a leg 1 and stop along a leg 2. An axis that one leg alone moves starts and stops in
        the blend as well."""
        period, limits = self.problem.period, axis.limits
        for stop, speeds in ((False, self.start), (True, self.stop)):
            ends = [(y, x) if stop else (x, y) for x, y in legs]
            speed = Enclosure(max((other if mine.is_zero() else mine).magnitude().lo for mine, other in ends))
            speeds.append(speed)
            if speed.lo <= 0:
                continue
            if not self.longer:
                self.plants.append(Plant(axis, period, speed, stop))
            if "acceleration" in limits:
                self.tap_max = min(self.tap_max, (exact(limits["acceleration"] * period) / speed).hi)
            if not self.longer and "force" in limits and axis.mass > 0 and (not stop or axis.damping == 0):
                force = limits["force"] + (axis.coulomb if stop else -axis.coulomb)
                self.tap_max = min(self.tap_max, (exact(force * period / axis.mass) / speed).hi)
            if "jerk" in limits:
                self.ramp_max = min(self.ramp_max, (exact(limits["jerk"] * period**2) / speed).hi)

    def tube(self, box):
        """Bounds on responses in a part; None if no filter is in it."""
        if not box.tube_known:
            box.tube = tube(self.plants, self.tap_max, self.ramp_max, box.order, box.cuts)
            box.tube_known = True
        return box.tube

    def bounds(self, box):
        """The same. @raise Empty"""
        if self.tube(box) is None:
            raise Empty
        return box.tube

    def corner(self, j):
        return member(self.problem.corners, j, "a corner")

    def axis(self, a):
        return member(self.problem.axes, a, "an axis")

    def mode(self, m):
        return member(self.problem.modes, m, "a mode")

    def limit(self, axis, kind):
        refuse_if(kind not in axis.limits, f"a multiplier names a limit of {kind} that is not there")
        return exact(axis.limits[kind])

    def single_delay(self, j, box):
        self.corner(j)
        refuse_if(box.corners[j][0] != box.corners[j][1], "a limit of the blend is used for several delays at once")
        return box.corners[j][0]

    def build(self, entry, box):
        """The row that an entry names, without its multiplier. @raise Empty if no filter is in the part"""
        if not isinstance(entry[0], str) or entry[0] not in KINDS:
            raise NotCovered(f"a row of the kind {entry[0]!r}")
        kind, named, in_windows, *options = KINDS[entry[0]]
        refuse_if(len(entry) != named + 2, f"a row `{entry[0]}` has {len(entry)} entries, not {named + 2}")
        refuse_if(box.window and not in_windows, f"a row `{entry[0]}` says nothing of filters of any order")
        if self.longer and entry[0] not in BEHIND_A_SERVO:
            raise NotCovered(f"a row `{entry[0]}` behind a servo")
        row = Row(box.order, self.problem.response, box.window)
        kind(self, row, box, *options, *entry[1:-1])
        return row

    def inside(self, box, *taps):
        """The first and the last tap of a window stand for many."""
        beyond = box.window and not all(1 <= i < box.order for i in taps)
        refuse_if(beyond, "a multiplier names a limit beyond its window")

    # ---- One a kind of row.

    def tap_difference(self, row, box, k, sign):
        self.inside(box, whole(k), k - 1)
        c = (UNIT / Enclosure(self.ramp_max)).times(sign_of(sign))
        row.tap(k, c)
        row.tap(k - 1, -c)
        row.limit(UNIT)

    def event_force(self, row, box, stop, a, k, line=None):
        axis = self.axis(a)
        slope, most = curve.force_of(axis, line, self.limit)
        scale = (self.stop if stop else self.start)[a] / most
        if not 1 <= whole(k) <= box.order + 1:
            return
        self.inside(box, k - 1)
        drag = scale * (exact(axis.damping) - slope if stop else exact(axis.damping) + slope)
        row.tap(k - 1, scale * exact(axis.mass) / self.period)
        row.response(k, drag)
        dry = exact(axis.coulomb) / most  # against a start, for a stop
        row.limit(UNIT + drag + dry if stop else UNIT - dry)

    def blend(self, row, box, limit, j, a, k, sign, line=None, direction=1):
        corner, axis, d = self.corner(j), self.axis(a), self.single_delay(j, box)
        into, out = corner.speed_in[a], corner.speed_out[a]
        slope, most = curve.line(axis, line) if limit == "force_speed" else (ZERO, self.limit(axis, limit))
        unit = UNIT.times(sign_of(sign)) / most
        refuse_if(whole(k) < 1, "a multiplier names a sample that is not there")
        before = 1 if limit == "jerk" else 0
        self.inside(box, *(k - 1 - i - e for i in range(before + 1) for e in (0, d)))

        def acceleration(at, c):  # a_at = (out b_{at-1-d} - in b_{at-1})/T
            row.tap(at - 1, -(c * into / self.period))
            row.tap(at - 1 - d, c * out / self.period)

        if limit == "acceleration":
            acceleration(k, unit)
        elif limit == "jerk":
            acceleration(k, unit / self.period)
            acceleration(k - 1, -(unit / self.period))
        else:
            acceleration(k, unit * exact(axis.mass))
            drag = unit * exact(axis.damping) + (slope / most).times(sign_of(direction))
            row.limit(-(drag * into))
            row.response(k, -(drag * into))
            row.response(k - d, drag * out)
            # Dry friction is against an axis that keeps its direction. If it reverses, friction may help everywhere.
            forward = 1 if (into + out).lo > 0 else -1
            helps = 1 if (into * out).lo < 0 else -forward * sign_of(sign)
            row.limit((UNIT / most * exact(axis.coulomb)).times(helps))
        row.limit(UNIT)

    def _seen(self, row, box, j, angle, exactly):
        """cos(alpha) v1 p + cos(theta - alpha) v2 q <= eps/T, over the faster feed: coefficients of p and q. Unless p
        and q are known exactly, those below zero are traded for the most they take away: p <= N, and as much more as
        the servo's taps are, q <= k - d."""
        corner, (d1, _, _, k2) = self.corner(j), box.corners[j]
        refuse_if(corner.error is None, "a multiplier names a corner error that is not bounded")
        ca, sa = cos_sin(exact(number(angle)))
        fastest = max(corner.feed_in, corner.feed_out)
        row.limit(exact(corner.error / self.problem.period / fastest))
        of_p = ca * exact(corner.feed_in / fastest)
        of_q = (corner.cosine * ca + corner.sine * sa) * exact(corner.feed_out / fastest)
        if exactly:
            return of_p, of_q
        refuse_if(box.window and min(of_p.lo, of_q.lo) < 0, "an error's direction bounds nothing in a window")
        row.bound += max(-of_p.lo, 0) * (box.order + self.longer) + max(-of_q.lo, 0) * max(k2 - d1, 0)
        return tuple(Enclosure(max(c.lo, 0), max(c.hi, 0)) for c in (of_p, of_q))

    def error(self, row, box, j, angle):
        self.corner(j)
        d1, d2, k1, k2 = box.corners[j]
        of_p, of_q = self._seen(row, box, j, angle, (d1, k1) == (d2, k2) and not box.window)
        row.to_go(k2, of_p)
        row.gone(min(k1 - d2, box.order) if box.window else k1 - d2, of_q)

    def contour(self, row, box, j, out):
        """The nearer leg is min(p, q) sin(theta) away. So p(c) <= m and q(c - d) <= m at one time c, m the tolerance
        over sin(theta). Between whole numbers both are linear; over c1 .. c2 and d1 .. d2 they are at least p(c2) and
        q(c1 - d2)."""
        corner, (c1, c2), d2 = self.corner(j), box.times[j], box.corners[j][1]
        refuse_if(corner.contour is None, "a multiplier names a contour that is not bounded")
        refuse_if(corner.sine.lo <= 0 or not isinstance(out, bool), "a contour of collinear legs, or of no leg")
        fastest, time = max(corner.feed_in, corner.feed_out), c1 - d2 if out else c2
        at, add = floor(time), row.gone if out else row.to_go
        scale = exact((corner.feed_out if out else corner.feed_in) / fastest)
        add(at, scale * exact(1 - (time - at)))
        add(at + 1, scale * exact(time - at))
        row.limit(exact(corner.contour / self.problem.period / fastest) / corner.sine)

    def range_error(self, row, box, j, angle, *touches):
        of_p, of_q = self._seen(row, box, j, angle, False)
        a, a_after, a_high, b, b_after, b_high = touches
        refuse_if({type(x) for x in touches[1:3] + touches[4:]} != {bool}, "a range error lacks a true or false")
        d1, d2, k1, k2 = box.corners[j]
        bounds = self.bounds(box)
        # p_k >= p_a - z G, z = k - a, G = 1 - B_e, and z G <= z0 G + g (z - z0)
        e, (low, high) = whole(a) + a_after, bounds.at(a + a_after)
        g, z0 = of_p * Enclosure(ONE - low if a_high else ONE - high), (k1 if a_high else k2) - a
        row.to_go(a, of_p)
        row.response(e, of_p.times(z0))
        row.limit(of_p.times(z0) + g.times(k1 - a - z0))
        row.term(SAMPLES, j, -g)
        # q_m >= q_b + y B_e, y = m - b, and y B >= y0 B + h (y - y0)
        e, (low, high) = whole(b) + b_after, bounds.at(b + b_after)
        h, y0 = of_q * Enclosure(high if b_high else low), (k2 - d1 if b_high else k1 - d2) - b
        row.gone(b, of_q)
        row.response(e, of_q.times(y0))
        row.limit(-h.times(k1 - d1 - b - y0))
        row.term(SAMPLES, j, h)
        row.term(DELAYS, j, -h)

    def budget(self, row, box):
        refuse_if(box.budget is None, "a multiplier names a budget of delays, but there is no target")
        for j, corner in enumerate(self.problem.corners):
            row.term(DELAYS, j, exact(corner.weight))
        row.limit(exact(box.budget))

    def response(self, row, box, k, sign):
        if not 1 <= whole(k) <= box.order:
            return
        low, high = self.bounds(box).at(k)
        row.response(k, UNIT.times(sign_of(sign)))
        row.bound += high if sign_of(sign) > 0 else -low


# Rows of the command, and of what is known of the motion behind a servo.
BEHIND_A_SERVO = {
    "jerk", "blend acceleration", "blend jerk", "error", "contour", "budget", "vibration", "damped vibration",
    "blend vibration",
}
# Name in the file: what makes the row; how many entries it has between its name and its multiplier; whether it can
# speak of filters of any order. Then follows what else the name says.
KINDS = {
    "jerk": (Rows.tap_difference, 2, True),
    "force start": (Rows.event_force, 2, True, False), "force stop": (Rows.event_force, 2, True, True),
    "force_speed start": (Rows.event_force, 3, True, False), "force_speed stop": (Rows.event_force, 3, True, True),
    "blend force_speed": (Rows.blend, 6, True, "force_speed"),
    "blend acceleration": (Rows.blend, 4, True, "acceleration"),
    "blend jerk": (Rows.blend, 4, True, "jerk"),
    "blend force": (Rows.blend, 4, True, "force"),
    "error": (Rows.error, 2, True), "contour": (Rows.contour, 2, False),
    "range error": (Rows.range_error, 8, False), "budget": (Rows.budget, 0, False),
    "vibration": (modes.vibration, 3, True), "damped vibration": (modes.vibration, 4, False),
    "blend vibration": (modes.blend_vibration, 5, False),
    "power start": (chords.event_power, 4, False, False), "regeneration stop": (chords.event_power, 4, False, True),
    "blend power": (chords.blend_power, 6, False, "power"),
    "blend regeneration": (chords.blend_power, 6, False, "regeneration"),
    "speed": (chords.speed, 4, False), "response": (Rows.response, 2, False),
}
