"""Limits of a task as rows `terms <= bound` that hold for every design in a part; formulas: lib/accdec/certificate."""
from functools import lru_cache

from enclosure import ONE, PI, Enclosure, NotCovered, exact, number, refuse_if, square_root, turned, whole
from tube import least_before, tube


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
        self.problem, self.before, self.ends = problem, [], []  # least B_{k-1} by B_k; speed of start and stop by axis
        self.longer = len(problem.response.lo) - 1  # motions take so many samples more than commands
        self.tap_max = self.ramp_max = ONE  # at least what any tap, any difference of two may be, times ONE
        for a, axis in enumerate(problem.axes):
            legs = [(c.speed_in[a], c.speed_out[a]) for c in problem.corners]
            # An axis that one leg alone moves starts and stops in the blend as well, at feed.
            ends = ([abs(x if x.lo or x.hi or problem.corner_feeds else y).lo for x, y in one]
                    for one in (legs, [leg[::-1] for leg in legs]))
            self.ends.append([Enclosure(max(speeds)) for speeds in ends])
            for stop, speed in enumerate(self.ends[-1]):
                if speed.lo > 0:
                    self.bound_taps(axis, speed, stop)

    def bound_taps(self, axis, speed, stop):
        period, limits = self.problem.period, axis.limits
        if "acceleration" in limits:
            self.tap_max = min(self.tap_max, (limits["acceleration"] * period / speed).hi)
        if "jerk" in limits:
            self.ramp_max = min(self.ramp_max, (limits["jerk"] * period**2 / speed).hi)
        if axis.mass > 0:
            self.before += least_before(axis, period, speed, stop)
            if not self.longer and "force" in limits and not (stop and axis.damping):
                most = (limits["force"] + (axis.coulomb if stop else -axis.coulomb)) * period / axis.mass
                self.tap_max = min(self.tap_max, (most / speed).hi)

    def tube(self, box):
        """Bounds on the motion's responses in a part; None if no filter is in it."""
        if box.tube is False:
            box.tube = tube(self.before, self.tap_max, self.ramp_max, box.order + self.longer, box.cuts)
        return box.tube

    def known(self, entry):
        """Refuses an entry that names no row."""
        name = entry[0]
        refuse_if(not isinstance(name, str) or name not in KINDS, f"a row of the kind {name!r}", NotCovered)
        refuse_if(self.longer and name not in BEHIND_A_SERVO, f"a row `{name}` behind a response", NotCovered)
        refuse_if(len(entry) != (size := len(KINDS[name][1]) + 2), f"`{name}` has {len(entry)} entries, not {size}")

    def row(self, entry, box):
        """The row that an entry names, without its multiplier. @raise Empty if no filter is in the part"""
        name, (kind, named, *options) = entry[0], KINDS[entry[0]]
        refuse_if(box.window and name not in IN_WINDOWS, f"a row `{name}` says nothing of filters of any order")
        row = Row(self, box)
        kind(row, *options, *(self.named(*x) for x in zip(named, entry[1:])))
        return row

    def named(self, letter, x):
        """Part of an entry: number of a corner j, an axis a, a mode m; sample k; sign s; any number x."""
        counted = {"j": self.problem.corners, "a": self.problem.axes, "m": self.problem.modes}
        if letter in counted:
            return whole(x, 0, len(counted[letter]) - 1)
        return {"k": whole, "s": lambda y: -1 if whole(y) < 0 else 1, "x": number}[letter](x)


class Row:
    """Least coefficients of what is never negative: of taps b_i; of others, which are all corners' delays, then all
    their samples, less the least of their ranges. B_k, p_k and q_m are sums of taps."""

    def __init__(self, limits, box):
        self.limits, self.problem, self.box, self.bound = limits, limits.problem, box, 0
        self.taps, self.others, self.indices = [0] * (box.order + 1), [0] * 2 * len(box.corners), range(box.order + 1)

    def limit(self, c):
        self.bound += exact(c).hi

    def tap(self, i, c):
        if 0 <= i <= self.box.order:
            self.taps[i] += c.lo

    def add(self, c, weights):
        """c times the sum of taps of these weights, whole numbers not below zero."""
        self.taps = [tap + c.lo * weight for tap, weight in zip(self.taps, weights)]

    def response(self, k, c):
        """c B_k"""
        self.add(c, (i < k for i in self.indices))

    def to_go(self, k, c):
        """c p_k behind the response's taps. The first tap of a window stands for those before it: it has no part."""
        for j in range(self.limits.longer + 1):
            weights = (max(i - k + j, 0) * (i > 0 or not self.box.window) for i in self.indices)
            self.add(c * self.problem.response[j], weights)

    def gone(self, m, c):
        """c q_m behind the response's taps"""
        for j in range(self.limits.longer + 1):
            self.add(c * self.problem.response[j], (max(m - j - i, 0) for i in self.indices))

    def inside(self, *taps):
        """The first and the last tap of a window stand for many."""
        beyond = self.box.window and not all(1 <= i < self.box.order for i in taps)
        refuse_if(beyond, "a multiplier names a limit beyond its window")

    def responses(self, k):
        """Bounds on B_k of the motion. @raise Empty"""
        if self.limits.tube(self.box) is None:
            raise Empty
        return Enclosure(*(end[min(max(k, 0), len(end) - 1)] for end in self.box.tube))

    def tap_difference(self, k, sign):
        self.inside(k, k - 1)
        c = exact(sign) / Enclosure(self.limits.ramp_max)
        self.tap(k, c)
        self.tap(k - 1, -c)
        self.limit(1)

    def bounded_response(self, k, sign):
        self.response(k, exact(sign))
        self.limit(self.responses(k) * sign)

    def legs(self, event, at):
        """The axis, sample, sign, speeds V_k = in (1 - B_k) + out B_{k-d} and further numbers of an entry: of a blend
        as they are named, of a start in the direction of the motion, of a stop against it."""
        if event == "blend":
            j, a, k, sign, *at = at
            corner, (d1, d2, _, _) = self.problem.corners[j], self.box.corners[j]
            refuse_if(d1 != d2, "a limit of the blend is used for several delays at once")
            return a, k, sign, corner.speed_in[a], corner.speed_out[a], d1, at
        a, k, *at = at
        start, stop = self.limits.ends[a]
        return (a, k, -1, stop, exact(0), 0, at) if event == "stop" else (a, k, 1, exact(0), start, 0, at)

    def accelerate(self, k, into, out, d):
        """a_k T, both speeds times any factor"""
        self.tap(k - 1, -into)
        self.tap(k - 1 - d, out)

    def move(self, k, into, out, d):
        """V_k, likewise"""
        self.limit(-into)
        self.response(k, -into)
        self.response(k - d, out)

    def direction(self, at, into, out):  # friction is against it; 0: the axis reverses, it may help everywhere
        return 0 if -into * out > 0 else 1 if (into + out).lo > 0 else -1

    def load(self, kind, event, *at, axis=None):
        a, k, sign, into, out, d, _ = self.legs(event, at)
        axis, period = axis or self.problem.axes[a], self.problem.period
        self.inside(*(k - 1 - i - e for i in range(1 + (kind == "jerk")) for e in (0, d)))
        most = axis.limits[kind]
        c = exact({"acceleration": 1, "jerk": 1 / period, "force": axis.mass}[kind] / period / most * sign)
        self.accelerate(k, into * c, out * c, d)
        if kind == "jerk":
            self.accelerate(k - 1, -into * c, -out * c, d)
        if kind == "force":
            c = exact(axis.damping / most * sign)
            self.move(k, into * c, out * c, d)
            self.limit(-(self.direction(at, into, out) * sign or -1) * axis.coulomb / most)
        self.limit(1)

    def power(self, kind, event, *at):
        """F <= P (1/l + 1/u - V/(l u)), times l/P, for speeds V in [l, u]: the hyperbola P/V lies below its chord
        there; for V < l the chord is above P/l, which must then be more than the force can be."""
        a, k, sign, into, out, d, (low, high) = self.legs(event, at)
        axis, sign = self.problem.axes[a], sign if event == "blend" else 1
        into, out, bound = into * sign, out * sign, axis.limits[kind]
        refuse_if(axis.coulomb > 0, "a chord of power or regeneration with dry friction", NotCovered)
        refuse_if(not 0 < low < high, "a chord's ends are not 0 < low < high")
        speeds = into * (1 - self.responses(k)) + out * self.responses(k - d)
        # Leg 1 has lost what leg 2 has gained: the speed is between 0 and those of the legs.
        beyond = min(speeds.hi, max(into.hi, out.hi, 0)) > exact(high).lo
        refuse_if(beyond, "a chord ends below speeds that are left in its part")
        if exact(low).hi > speeds.lo:
            fastest, most = Enclosure(max(abs(into).hi, abs(out).hi)), axis.limits
            caps = [exact(most["force"])] if "force" in most else []
            caps += [fastest * axis.damping + axis.mass * most["acceleration"]] if "acceleration" in most else []
            holds = any((cap * low).hi <= exact(bound).lo for cap in caps)
            refuse_if(not holds, "a chord begins above speeds that are left in its part")
        force = (-low if kind == "regeneration" else low) / bound
        c, e = exact(force * axis.mass / self.problem.period), exact(force * axis.damping + 1 / high)
        self.accelerate(k, into * c, out * c, d)
        self.move(k, into * e, out * e, d)
        self.limit(1 + low / high)

    def seen(self, j, angle, exactly):
        """cos(alpha) v1 p + cos(theta - alpha) v2 q <= eps/T, over the faster feed: coefficients of p and q. Unless p
        and q are known exactly, those below zero are traded for the most they take away: p <= N + R, q <= k - d."""
        corner, (d1, _, _, k2), (ca, sa) = self.problem.corners[j], self.box.corners[j], turned(0, angle)
        self.limit(corner.error / self.problem.period / corner.fastest)
        of_p = ca * (corner.feed_in / corner.fastest)
        of_q = (corner.cosine * ca + corner.sine * sa) * (corner.feed_out / corner.fastest)
        if exactly:
            return of_p, of_q
        refuse_if(self.box.window and min(of_p.lo, of_q.lo) < 0, "an error's direction bounds nothing in a window")
        most = self.box.order + self.limits.longer, max(k2 - d1, 0)
        self.bound += sum(max(-c.lo, 0) * x for c, x in zip((of_p, of_q), most))
        return of_p.positive(), of_q.positive()

    def error(self, j, angle):
        d1, d2, k1, k2 = self.box.corners[j]
        of_p, of_q = self.seen(j, angle, (d1, k1) == (d2, k2) and not self.box.window)
        self.to_go(k2, of_p)
        self.gone(min(k1 - d2, self.box.order) if self.box.window else k1 - d2, of_q)

    def vibration(self, m, frequency, *damping_and_angle, bound=None):
        """What is left at the last tap: tap i has fallen by exp(-z w (N - i)) there."""
        mode, order, (*damping, angle) = self.problem.modes[m], self.box.order, damping_and_angle
        z = damping[0] if damping else 0
        refuse_if(not mode.low <= frequency <= mode.high, "a multiplier's frequency is outside its band")
        refuse_if(not mode.least_damping <= z <= mode.most_damping, "a multiplier's damping is outside its range")
        _, damped, cosine, sine = turns(frequency * self.problem.period, z, order)
        c, s = turned(0, damped * order - angle)
        self.taps = (cosine * c + sine * s).lo[::-1]
        if self.box.window:  # the taps an end stands for have any phase
            self.taps[0] = self.taps[-1] = -ONE
        self.limit(mode.residual if bound is None else bound)


# Name in the file: what makes the row, its entries between name and multiplier, what else the name says.
KINDS = {
    "jerk": (Row.tap_difference, "ks"), "response": (Row.bounded_response, "ks"), "error": (Row.error, "jx"),
    "vibration": (Row.vibration, "mxx"), "damped vibration": (Row.vibration, "mxxx"),
    "force start": (Row.load, "ak", "force", "start"), "force stop": (Row.load, "ak", "force", "stop"),
    **{f"blend {kind}": (Row.load, "jaks", kind, "blend") for kind in ("acceleration", "jerk", "force")},
    "power start": (Row.power, "akxx", "power", "start"),
    "regeneration stop": (Row.power, "akxx", "regeneration", "stop"),
    **{f"blend {kind}": (Row.power, "jaksxx", kind, "blend") for kind in ("power", "regeneration")},
}
# Rows of the command before a servo, and of the motion behind it as far as it is known; rows of filters of any order.
BEHIND_A_SERVO = {"jerk", "blend acceleration", "blend jerk", "error", "vibration", "damped vibration"}
IN_WINDOWS = {"jerk", "force start", "force stop", "blend acceleration", "blend jerk", "blend force", "error",
              "vibration"}
