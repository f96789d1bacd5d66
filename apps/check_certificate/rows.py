"""Limits of a task as rows `terms <= bound`, from the names a certificate gives them. A row holds for every design in
the part of the search that it is asked for; README.md of lib/accdec/certificate has the formulas."""
from functools import lru_cache
from math import floor

from enclosure import (ONE, PI, Enclosure, NotCovered, Refused, exact, number, refuse_if, square_root, turned,
                       whole)
from tube import Plant, tube


class Empty(Exception):
    """No filter is in a part of the search."""


@lru_cache(None)
def turns(cycles, damping, order):
    """exp(-z w n) cos(w_d n), and with the sine, at n = 0 .. order, for 2 pi w cycles a sample."""
    natural, cosine, sine = PI * (2 * cycles), exact([1]), exact([0])
    damped = natural * square_root(exact(1 - damping * damping)) if damping else natural
    while (n := len(cosine.lo)) <= order:
        c, s = turned(natural * damping * n, damped * n)
        cosine, sine = cosine.then(cosine * c - sine * s), sine.then(sine * c + cosine * s)
    return natural, damped, cosine[:order + 1], sine[:order + 1]


class Limits:
    """What a task's limits say of every filter."""

    def __init__(self, problem):
        self.problem, self.plants, self.ends = problem, [], []
        self.smooths, self.longer = len(problem.smoothing.lo) > 1, len(problem.response.lo) - 1  # motions are so longer
        self.tap_max = self.ramp_max = ONE  # at least what any tap, any difference of two may be, times ONE
        for a, axis in enumerate(problem.axes):
            legs = [(c.speed_in[a], c.speed_out[a]) for c in problem.corners]
            # An axis that one leg alone moves starts and stops in the blend as well.
            ends = ([abs(x if x.lo or x.hi else y).lo for x, y in one] for one in (legs, [leg[::-1] for leg in legs]))
            self.ends.append([Enclosure(max(speeds)) for speeds in ends])
            self._bound_taps(axis)

    def _bound_taps(self, axis):
        period, limits = self.problem.period, axis.limits
        for stop, speed in enumerate(self.ends[-1]):
            if speed.lo <= 0 or self.smooths:
                continue
            taps = [limits["acceleration"] * period] if "acceleration" in limits else []
            if not self.longer:
                self.plants.append(Plant(axis, period, speed, stop))
                if "force" in limits and axis.mass > 0 and not (stop and axis.damping):
                    taps.append((limits["force"] + (axis.coulomb if stop else -axis.coulomb)) * period / axis.mass)
            self.tap_max = min([self.tap_max, *((x / speed).hi for x in taps)])
            if "jerk" in limits:
                self.ramp_max = min(self.ramp_max, (limits["jerk"] * period**2 / speed).hi)

    def tube(self, box):
        """Bounds on responses in a part; None if no filter is in it."""
        if box.tube is False:
            box.tube = tube(self.plants, self.tap_max, self.ramp_max, box.order, box.cuts)
        return box.tube

    def row(self, entry, box):
        """The row that an entry names, without its multiplier. @raise Empty if no filter is in the part"""
        name = entry[0]
        kind, named, *options = KINDS.get(name) if isinstance(name, str) and name in KINDS else (None, "")
        behind = self.longer and name not in (BEHIND_SMOOTHING if self.smooths else BEHIND_A_SERVO)
        refuse_if(behind or not kind, f"a row of the kind {name!r}" + " behind a response" * bool(kind), NotCovered)
        refuse_if(len(entry) != len(named) + 2, f"a row `{name}` has {len(entry)} entries, not {len(named) + 2}")
        refuse_if(box.window and name in NOT_IN_WINDOWS, f"a row `{name}` says nothing of filters of any order")
        row = Row(self, box)
        try:
            kind(row, *options, *(self._named(*x) for x in zip(named, entry[1:])))
        except (LookupError, TypeError, ArithmeticError) as error:
            raise Refused(f"a row `{name}` names what the task does not have") from error
        return row

    def _named(self, letter, x):
        """Part of an entry: number of a corner j, an axis a, a mode m; sample k; sign s; yes or no b; any number x."""
        counted = {"j": self.problem.corners, "a": self.problem.axes, "m": self.problem.modes}
        if letter in counted:
            return whole(x, 0, len(counted[letter]) - 1)
        refuse_if(letter == "b" and not isinstance(x, bool), f"{x!r} stands where true or false should")
        return {"b": bool, "k": whole, "s": lambda y: -1 if whole(y) < 0 else 1, "x": number}[letter](x)

    def residual(self, mode, natural, damped, z, j=None, d=0):
        """The bound of a mode's residual. An axis' amplitude in metres bounds the residual of the filter. Both legs of
        a blend excite the mode through the same filter, the first one d samples earlier: times
        |v2 - v1 exp(-(z w + i wd) d)|/wd. A start or stop has one leg. None if nothing excites the mode."""
        if mode.axis is None:
            return exact(mode.residual)
        speed = max(self.ends[mode.axis], key=lambda x: x.lo)
        if j is not None:
            corner = self.problem.corners[j]
            along, across = turned(natural * z * d, damped * d)
            along = abs(corner.speed_out[mode.axis] - corner.speed_in[mode.axis] * along)
            across = abs(corner.speed_in[mode.axis] * across)
            speed = square_root(along * along + across * across)
        return damped / speed * (mode.displacement / self.problem.period) if speed.lo > 0 else None


class Row:
    """Least coefficients of what is never negative: of taps b_i, of delays and samples less the least of their ranges.
    All else is made of taps: B_k = sum_{i<k} b_i, p_k = sum b_i max(i - k, 0), q_m = sum b_i max(m - i, 0)."""

    def __init__(self, limits, box):
        self.limits, self.problem, self.box, self.bound = limits, limits.problem, box, 0
        self.indices, (self.delays, self.samples) = range(box.order + 1), ([0] * len(box.corners) for _ in range(2))
        self.taps = [0] * (box.order + 1)

    def add(self, c, weights):
        """c times the sum of taps of these weights, whole numbers not below zero."""
        self.taps = [tap + c.lo * weight for tap, weight in zip(self.taps, weights)]

    def limit(self, c):
        self.bound += exact(c).hi

    def tap(self, i, c):
        if 0 <= i <= self.box.order:
            self.taps[i] += c.lo

    def left(self, k, c):
        """c (1 - B_k)"""
        self.add(c, (i >= k for i in self.indices))

    def response(self, k, c):
        self.add(c, (i < k for i in self.indices))

    def to_go(self, k, c):
        """c p_k behind the response's taps. The first tap of a window stands for those before it: it has no part."""
        self._way(c, [[0 if self.box.window and i == 0 else max(i - k + j, 0) for i in self.indices]
                      for j in range(self.limits.longer + 1)])

    def gone(self, m, c):
        """c q_m behind the response's taps"""
        self._way(c, [[max(m - j - i, 0) for i in self.indices] for j in range(self.limits.longer + 1)])

    def _way(self, c, weights):
        for j, one in enumerate(weights):
            self.add(c * self.problem.response[j], one)

    def inside(self, *taps):
        """The first and the last tap of a window stand for many."""
        beyond = self.box.window and not all(1 <= i < self.box.order for i in taps)
        refuse_if(beyond, "a multiplier names a limit beyond its window")

    def responses(self, k):
        """Bounds on B_k. @raise Empty"""
        if self.limits.tube(self.box) is None:
            raise Empty
        return Enclosure(*(end[min(max(k, 0), self.box.order + 1)] for end in self.box.tube))

    def single_delay(self, j):
        d1, d2, _, _ = self.box.corners[j]
        refuse_if(d1 != d2, "a limit of the blend is used for several delays at once")
        return d1

    # ---- One a kind of row.

    def tap_difference(self, k, sign):
        self.inside(k, k - 1)
        c = exact(sign) / Enclosure(self.limits.ramp_max)
        self.tap(k, c)
        self.tap(k - 1, -c)
        self.limit(1)

    def bounded_response(self, k, sign):
        if 1 <= k <= self.box.order:
            self.response(k, exact(sign))
            self.limit(self.responses(k) * sign)

    def budget(self):
        self.delays = [exact(corner.weight).lo for corner in self.problem.corners]
        self.limit(self.box.budget)

    def _legs(self, event, at):
        """The axis, sample, sign, speeds V_k = in (1 - B_k) + out B_{k-d} and further numbers of an entry: of a blend
        as they are named, of a start in the direction of the motion, of a stop against it."""
        if event == "blend":
            j, a, k, sign, *at = at
            corner, d = self.problem.corners[j], self.single_delay(j)
            return a, k, sign, corner.speed_in[a], corner.speed_out[a], d, at
        a, k, *at = at
        start, stop = self.limits.ends[a]
        return (a, k, -1, stop, exact(0), 0, at) if event == "stop" else (a, k, 1, exact(0), start, 0, at)

    def _acceleration(self, k, into, out, d):
        """a_k T, both speeds times any factor"""
        self.tap(k - 1, -into)
        self.tap(k - 1 - d, out)

    def _speed(self, k, into, out, d):
        self.left(k, into)
        self.response(k - d, out)

    def load(self, kind, event, *at):
        a, k, sign, into, out, d, at = self._legs(event, at)
        axis, period = self.problem.axes[a], self.problem.period
        if not 1 <= k <= self.box.order + 2 + d:  # the jerk of the end is one later
            return
        self.inside(*(k - 1 - i - e for i in range(1 + (kind == "jerk")) for e in (0, d)))
        slope, most = axis.lines[at[0]] if kind == "force_speed" else (0, axis.limits[kind])
        c = exact({"acceleration": 1, "jerk": 1 / period}.get(kind, axis.mass) / period / most * sign)
        self._acceleration(k, into * c, out * c, d)
        if kind == "jerk":
            self._acceleration(k - 1, -into * c, -out * c, d)
        elif kind != "acceleration":
            c = exact((axis.damping * sign + slope * (at[1] if at[1:] else 1)) / most)
            self._speed(k, into * c, out * c, d)
            # Dry friction is against an axis that keeps its direction. If it reverses, friction may help everywhere.
            against = -1 if into * out < 0 else sign if (into + out).lo > 0 else -sign
            self.limit(-against * axis.coulomb / most)
        self.limit(1)

    def power(self, kind, event, *at):
        """F <= P (1/l + 1/u - V/(l u)), times l/P, for speeds V in [l, u]: the hyperbola P/V lies below its chord
        there; for V < l the chord is above P/l, which must then be more than the force can be."""
        a, k, sign, into, out, d, (low, high) = self._legs(event, at)
        axis, sign = self.problem.axes[a], sign if event == "blend" else 1
        into, out, bound = into * sign, out * sign, axis.limits[kind]
        refuse_if(axis.coulomb > 0, "a chord of power or regeneration with dry friction", NotCovered)
        refuse_if(not 0 < low < high, "a chord's ends are not 0 < low < high")
        if not 1 <= k <= self.box.order + 1 + d:
            return
        speeds = into * (1 - self.responses(k)) + out * self.responses(k - d)
        # Leg 1 has lost what leg 2 has gained: the speed is between 0 and those of the legs.
        beyond = min(speeds.hi, max(into.hi, out.hi, 0)) > exact(high).lo
        refuse_if(beyond, "a chord ends below speeds that are left in its part")
        if exact(low).hi > speeds.lo:
            caps = [exact(axis.limits["force"])] if "force" in axis.limits else []
            if "acceleration" in axis.limits:
                fastest = Enclosure(max(abs(into).hi, abs(out).hi))
                caps.append(fastest * axis.damping + axis.mass * axis.limits["acceleration"])
            holds = caps and min((cap * low).hi for cap in caps) <= exact(bound).lo
            refuse_if(not holds, "a chord begins above speeds that are left in its part")
        force = (-low if kind == "regeneration" else low) / bound
        c, e = exact(force * axis.mass / self.problem.period), exact(force * axis.damping + 1 / high)
        self._acceleration(k, into * c, out * c, d)
        self._speed(k, into * e, out * e, d)
        self.limit(1 + low / high)

    def speed(self, j, k, low, high):
        """|V| >= v_min with V between the directions low and high: n V >= v_min cos((high - low)/2), n half way. In the
        plane of motion V = v1 (1 - B_k) (1, 0) + v2 B_{k-d} (-cos theta, sin theta)."""
        corner, (d1, d2, _, _) = self.problem.corners[j], self.box.corners[j]
        refuse_if(not low < high or exact(high - low).hi >= PI.lo, "a sector is half a turn or more, or none")
        if not 1 <= k <= self.box.order + d1:
            return
        into = (1 - self.responses(k)) * corner.feed_in
        out = Enclosure(self.responses(k - d2).lo, self.responses(k - d1).hi) * corner.feed_out

        def seen(angle):
            """Parts of both legs' unit vectors along a direction, and to the left of it."""
            ca, sa = turned(0, angle)
            return ca, corner.sine * sa - corner.cosine * ca, -sa, corner.sine * ca + corner.cosine * sa

        # Outside by so little is allowed and paid for; not behind, where a narrow sector has both edges beside it, too.
        outside = max(corner.feed_in, corner.feed_out) / 10**12
        of_in, of_out, _, _ = seen((low + high) / 2)
        edges = [(x * into + y * out) for _, _, x, y in (seen(low), seen(high))]
        beside = min(edges[0].lo, -edges[1].hi, (of_in * into + of_out * out).lo) < -exact(outside).lo
        refuse_if(beside, "a sector does not hold all directions that are left in its part")
        refuse_if(d1 != d2 and of_out.lo < 0, "a sector is used for several delays, but does not hold for all")
        # half - n V/v_min <= 0; of several delays the least has the most of leg 2
        self._speed(k, -of_in * (corner.feed_in / corner.speed_min), -of_out * (corner.feed_out / corner.speed_min), d1)
        self.limit(2 * outside / corner.speed_min - turned(0, (high - low) / 2)[0])

    def _seen(self, j, angle, exactly):
        """cos(alpha) v1 p + cos(theta - alpha) v2 q <= eps/T, over the faster feed: coefficients of p and q. Unless p
        and q are known exactly, those below zero are traded for the most they take away: p <= N, and as much more as
        the response's taps are, q <= k - d."""
        corner, (d1, _, _, k2) = self.problem.corners[j], self.box.corners[j]
        (ca, sa), fastest = turned(0, angle), max(corner.feed_in, corner.feed_out)
        self.limit(corner.error / self.problem.period / fastest)
        of_p, of_q = ca * (corner.feed_in / fastest), corner.cosine * ca + corner.sine * sa
        of_q *= corner.feed_out / fastest
        if exactly:
            return of_p, of_q
        refuse_if(self.box.window and min(of_p.lo, of_q.lo) < 0, "an error's direction bounds nothing in a window")
        most = self.box.order + self.limits.longer, max(k2 - d1, 0)
        self.bound += sum(max(-c.lo, 0) * x for c, x in zip((of_p, of_q), most))
        return (Enclosure(max(c.lo, 0), max(c.hi, 0)) for c in (of_p, of_q))

    def error(self, j, angle):
        d1, d2, k1, k2 = self.box.corners[j]
        of_p, of_q = self._seen(j, angle, (d1, k1) == (d2, k2) and not self.box.window)
        self.to_go(k2, of_p)
        self.gone(min(k1 - d2, self.box.order) if self.box.window else k1 - d2, of_q)

    def contour(self, j, out):
        """The nearer leg is min(p, q) sin(theta) away. So p(c) <= m and q(c - d) <= m at one time c, m the tolerance
        over sin(theta). Between whole numbers both are linear; over c1 .. c2 and d1 .. d2 they are at least p(c2) and
        q(c1 - d2)."""
        corner, (c1, c2), d2 = self.problem.corners[j], self.box.times[j], self.box.corners[j][1]
        fastest, time = max(corner.feed_in, corner.feed_out), c1 - d2 if out else c2
        scale, add = (corner.feed_out if out else corner.feed_in) / fastest, self.gone if out else self.to_go
        part = time - floor(time)
        add(floor(time), exact(scale * (1 - part)))
        add(floor(time) + 1, exact(scale * part))
        self.limit(corner.contour / self.problem.period / fastest / corner.sine)

    def range_error(self, j, angle, a, a_after, a_high, b, b_after, b_high):
        (d1, d2, k1, k2), (of_p, of_q) = self.box.corners[j], self._seen(j, angle, False)
        # p_k >= p_a - z G, z = k - a, G = 1 - B_e, and z G <= z0 G + g (z - z0)
        e = self.responses(a + a_after)
        g, z0 = of_p * (1 - Enclosure(e.lo if a_high else e.hi)), (k1 if a_high else k2) - a
        self.to_go(a, of_p)
        self.left(a + a_after, -of_p * z0)
        self.limit(g * (k1 - a - z0))
        # q_m >= q_b + y B_e, y = m - b, and y B >= y0 B + h (y - y0)
        e = self.responses(b + b_after)
        h, y0 = of_q * Enclosure(e.hi if b_high else e.lo), (k2 - d1 if b_high else k1 - d2) - b
        self.gone(b, of_q)
        self.response(b + b_after, of_q * y0)
        self.limit(-h * (k1 - d1 - b - y0))
        self.samples[j], self.delays[j] = (h - g).lo, (-h).lo

    def vibration(self, m, *at):
        """What is left at the last tap: tap i has fallen by exp(-z w (N - i)) there."""
        *corner, frequency, z, angle = at if len(at) > 2 else (at[0], 0, at[1])
        mode, order, j = self.problem.modes[m], self.box.order, *corner, *[None] * (not corner)
        refuse_if(not mode.low <= frequency <= mode.high, "a multiplier's frequency is outside its band")
        refuse_if(not mode.least_damping <= z <= mode.most_damping, "a multiplier's damping is outside its range")
        refuse_if((mode.axis is None) and j is not None, "a multiplier sees a blend in a mode of the filter")
        d = 0 if j is None else self.single_delay(j)
        many = d >= self.problem.order_max + 2 + self.limits.longer and self.problem.corners[j].delay is None
        refuse_if(many, "a multiplier names the phase of a delay that stands for many")
        natural, damped, cosine, sine = turns(frequency * self.problem.period, z, order)
        bound, (c, s) = self.limits.residual(mode, natural, damped, z, j, d), turned(0, damped * order - angle)
        refuse_if(bound is None, "a multiplier names a mode that nothing excites")
        self.taps = (cosine * c + sine * s).lo[::-1]
        if self.box.window:  # the taps an end stands for have any phase
            self.taps[0] = self.taps[-1] = -ONE
        self.limit(bound)


# Name in the file: what makes the row, its entries between name and multiplier, what else the name says.
KINDS = {
    "jerk": (Row.tap_difference, "ks"), "response": (Row.bounded_response, "ks"), "budget": (Row.budget, ""),
    "error": (Row.error, "jx"), "range error": (Row.range_error, "jxkbbkbb"), "contour": (Row.contour, "jb"),
    "speed": (Row.speed, "jkxx"), "vibration": (Row.vibration, "mxx"),
    "damped vibration": (Row.vibration, "mxxx"), "blend vibration": (Row.vibration, "mjxxx"),
    "blend force_speed": (Row.load, "jaksks", "force_speed", "blend"),
    **{f"blend {kind}": (Row.power, "jaksxx", kind, "blend") for kind in ("power", "regeneration")},
    **{f"blend {kind}": (Row.load, "jaks", kind, "blend") for kind in ("acceleration", "jerk", "force")},
    **{f"{kind} {event}": (Row.load, "akk"[:count], kind, event) for kind, count in (("force", 2), ("force_speed", 3))
       for event in ("start", "stop")},
    "power start": (Row.power, "akxx", "power", "start"),
    "regeneration stop": (Row.power, "akxx", "regeneration", "stop"),
}
# Rows of the command, and of what is known of the motion behind a servo.
BEHIND_SMOOTHING = {"error", "contour", "budget"}
BEHIND_A_SERVO = BEHIND_SMOOTHING | {
    "jerk", "blend acceleration", "blend jerk", "vibration", "damped vibration", "blend vibration"}
NOT_IN_WINDOWS = {"contour", "range error", "budget", "response", "speed", "damped vibration", "blend vibration",
                  "power start", "regeneration stop", "blend power", "blend regeneration"}
