"""The tree of a proof: parts of all designs, each split in two or refuted, in preorder."""
from fractions import Fraction
from math import ceil, floor
from types import SimpleNamespace

from enclosure import ONE, NotCovered, Refused, number, refuse_if, whole
from problem import ROUNDING
from rows import Empty, Limits

SPLITS = {"": "dkcBN", "window": "dk", "symmetric": "B"}  # kinds that may be split, in each kind of tree


def part(corners, times, order, cuts=(), budget=None, window=False):
    """By corner (d1, d2, k1, k2), and (c1, c2) of its contour; the largest order, -1: none is left; bounds of responses
    by sample; what the target leaves for delays."""
    return SimpleNamespace(corners=corners, times=times, order=order, cuts=dict(cuts), budget=budget, window=window,
                           symmetric=False, tube=False)


def told(box):
    ranges = [f"d = {d1} .. {d2} (k = {k1} .. {k2})" for d1, d2, k1, k2 in box.corners]
    return ", ".join([f"order up to {box.order}", *ranges, *(f"B_{k} split" for k in box.cuts)])


class Tree:
    """Checks a proof that no design costs less than the target, in samples; None: that there is no design."""

    def __init__(self, problem, certificate, target):
        self.problem, self.limits = problem, Limits(problem)
        self.sets, self.lemmas = certificate["multipliers"], certificate.get("lemmas", [])
        self.known, self.leaves, self.limit = 0, 0, None  # limit: what a design must cost less than
        for lemma in self.lemmas:  # whatever it costs, and by no other lemma
            self._lemma(lemma)
        self.known = len(self.lemmas)
        self.limit = None if target is None else target * (1 - ROUNDING)
        self._whole(certificate["tree"], self._root(), "")

    def _root(self):
        """Ranges of a part: of the order, of the delay, sample and contour time of each corner."""
        most, ranges = self.problem.order_max, {}
        # From a delay of N + 2 and from k = N + d + 1 on nothing changes, or as much later as a response takes.
        for j, c in enumerate(self.problem.corners):
            ranges[j, "d"] = (0, most + 2 + self.limits.longer) if c.delay is None else (c.delay, c.delay)
            self._all_samples(ranges, j, most)
        return ranges | {"N": (self.problem.order_min, most)}

    def _all_samples(self, ranges, j, order):
        last = ranges[j, "d"][1] + order + 1 + self.limits.longer
        ranges[j, "k"], ranges[j, "c"] = (0, last), (Fraction(0), Fraction(last))

    def _whole(self, tree, ranges, kind):
        self.tree, self.at = tree, 0
        self._node(ranges, 0, kind, None)
        refuse_if(self.at != len(tree), "the tree goes on after its end")

    def _lemma(self, lemma):
        refuse_if(("order" in lemma) == ("window" in lemma), "a lemma has either an order or a window")
        ranges, corners = self._root(), len(self.problem.corners)
        for j, delay in lemma["delays"]:
            d1, d2 = ranges[whole(j, 0, corners - 1), "d"]
            refuse_if(whole(delay) < d1, "a lemma names a delay that its corner cannot have")
            ranges[j, "d"] = d1, min(d2, delay)
            self._all_samples(ranges, j, self.problem.order_max)
        if "order" in lemma:
            least, most = ranges["N"]
            return self._whole(lemma["tree"], ranges | {"N": (least, min(most, whole(lemma["order"])))}, "")
        order, anchor, at = lemma["window"]
        for j in range(corners):
            self._all_samples(ranges, j, whole(order, 2, 10**6))
        bounded = self.problem.corners[whole(anchor, 0, corners - 1)].error is not None
        refuse_if(not bounded or not 0 <= whole(at) <= ranges[anchor, "k"][1], "a lemma's window has no anchor")
        self._whole(lemma["tree"], ranges | {"N": (order, order), (anchor, "k"): (at, at)}, "window")

    def _reduced(self, ranges, window):
        """What the target leaves of a part: the largest order, delays, a budget for them."""
        (least, order), budget = ranges["N"], None
        corners = [[*ranges[j, "d"], *ranges[j, "k"]] for j in range(len(self.problem.corners))]
        times = [ranges[j, "c"] for j in range(len(corners))]
        cuts = {key[0]: ends for key, ends in ranges.items() if key[1:] == ("B",)}
        if self.limit is not None:
            weights, each = [c.weight for c in self.problem.corners], self.problem.filter_cost
            room = self.limit - sum(w * c[0] for w, c in zip(weights, corners))
            order = min(order, ceil(room / each) - 2)  # the largest N with each (N + 1) < room
            budget = room - each * (least + 1)
        if order < least:
            return part(corners, times, -1, cuts)
        last = order + 1 + self.limits.longer
        for j, corner in enumerate(corners):
            if budget is not None:
                corner[1] = min(corner[1], corner[0] + floor(budget / weights[j]))
            # There the motion has ended: a contour that holds later holds there.
            corner[3], times[j] = min(corner[3], last + corner[1]), (times[j][0], min(times[j][1], last + corner[1]))
        return part(corners, times, order, cuts, budget, window)

    def _node(self, ranges, depth, kind, order):
        """@param ranges  as splits have left them  @param order  of symmetric filters"""
        refuse_if(self.at >= len(self.tree), "the tree is cut off: not every part is refuted")
        refuse_if(depth > 1000, "the tree is too deep")
        node, box, self.at = self.tree[self.at], self._reduced(ranges, kind == "window"), self.at + 1
        pair = isinstance(node, list) and len(node) == 2 and not kind
        if kind == "symmetric":
            box.order, box.symmetric = order, True
        if node is None and not kind:
            left = box.order >= 0 and all(c[2] <= c[3] for c in box.corners) and all(a <= b for a, b in box.times)
            refuse_if(left, f"{told(box)} is left out as too long, but is not")
        elif box.order < 0:
            raise Refused("the tree goes on where every design is too long")
        elif type(node) is int:
            self._leaf(node, box)
        elif node == "unreachable" and kind != "window":
            self.leaves += 1
            refuse_if(self.limits.tube(box) is not None, f"{told(box)} is called unreachable, but is not")
        elif node == ["symmetric"] and not kind:
            for n in self._symmetric_orders(box):
                self._node(ranges, depth + 1, "symmetric", n)
        elif pair and type(node[0]) is int:
            for index, n in zip(node, self._symmetric_orders(box)):
                box.order, box.symmetric, box.tube = n, True, False
                self._leaf(index, box)
        elif pair and node[0] == "lemma":
            lemma = self.lemmas[whole(node[1], 0, self.known - 1)]
            self.leaves += 1
            covers = all(box.corners[j][1] <= delay for j, delay in lemma["delays"])
            refuse_if(not covers or box.order > lemma.get("order", box.order), f"{told(box)} is not in lemma {node[1]}")
        else:
            for half in self._halves(node, ranges, box.order, SPLITS[kind]):
                self._node(half, depth + 1, kind, order)

    def _halves(self, node, ranges, order, kinds):
        kind, at = node[-2:] if isinstance(node, list) and len(node) in (2, 3) else (None, None)
        known = isinstance(kind, str) and kind in set(kinds) and (kind == "N") == (len(node) == 2)
        refuse_if(not known, f"a node {node!r}", NotCovered)
        key = "N" if kind == "N" else (whole(node[0]), kind)
        if kind == "B":
            refuse_if(not 1 <= key[0] <= order or not 0 <= number(at) <= 1, "no response is split there")
        refuse_if(kind != "B" and key not in ranges, "the tree splits a corner that is not there")
        low, high = ranges.get(key, (Fraction(0), Fraction(1)))
        if kind in "Bc":
            at = number(at)
            return ranges | {key: (low, min(at, high))}, ranges | {key: (max(at, low), high)}
        refuse_if(not low <= whole(at) < high, "the tree splits outside the part")
        return ranges | {key: (low, at)}, ranges | {key: (at + 1, high)}

    def _symmetric_orders(self, box):
        """A symmetric filter becomes one of the part's order or of one less by zeros at both ends. That order depends
        on the delays alone, so there must be one each."""
        refuse_if(not self.problem.symmetric, "the tree refutes symmetric filters only, the task allows any")
        one = all(d1 == d2 for d1, d2, _, _ in box.corners)
        refuse_if(not one, f"{told(box)} refutes symmetric filters of one order for several delays at once")
        return [n for n in (box.order, box.order - 1) if n >= self.problem.order_min]

    def _leaf(self, index, box):
        """Rows times multipliers >= 0 add up to a sum that is above its bound for all filters of the part."""
        rows, bound = self.sets[whole(index, 0, len(self.sets) - 1)], 0
        taps, delays, samples = [0] * (box.order + 1), *([0] * len(box.corners) for _ in range(2))
        self.leaves += 1
        factors = [number(row[-1]) for row in rows]
        least, most = min(factors, default=0), max(factors, default=0)
        refuse_if(least < 0, "a multiplier is negative")
        for entry, y in zip(rows, factors):
            try:
                row = self.limits.row(entry, box) if y else None
            except Empty:
                return
            if row is None or row.bound >= 0 and not any((*row.taps, *row.delays, *row.samples)):
                continue  # it says nothing of the filter, and holds
            factor = int(y / most * 2**64)  # any in this proportion prove
            taps, delays, samples = ([a + factor * c for a, c in zip(total, more)] for total, more in (
                (taps, row.taps), (delays, row.delays), (samples, row.samples)))
            bound += factor * row.bound
        for (d1, d2, k1, k2), of_delay, of_sample in zip(box.corners, delays, samples):
            bound -= min(of_delay, 0) * (d2 - d1) + min(of_sample, 0) * (k2 - k1)
        value = self._minimum(taps, box)
        refuse_if(value is not None and value <= bound * 2 * ONE, f"{told(box)} is not refuted by its multipliers")

    def _minimum(self, c, box):
        """At most 2 sum c b, times ONE, over taps of the sum 1 none above the largest allowed: with any level l, sum
        c b is l + most sum min(0, c - l) or more. None: not even full taps reach 1."""
        most = self.limits.tap_max
        c = [a + b for a, b in zip(c, reversed(c))] if box.symmetric else [2 * a for a in c]
        if box.window:  # the ends stand for many taps: the level must not be above theirs
            ends = min(c[0], c[-1])
            c = [ends, *c[1:-1], ends]
        elif len(c) * most < ONE:
            return None
        level = sorted(c)[min(len(c) - 1, ONE // most)]
        level = min(level, ends) if box.window else level
        return level * ONE + most * sum(a - level for a in c if a < level)
