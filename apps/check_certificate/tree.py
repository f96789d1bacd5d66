"""The tree of a proof: parts of all designs, each split in two or refuted, in preorder."""
from itertools import chain
from math import ceil, floor

from enclosure import ONE, NotCovered, number, refuse_if, whole
from problem import ROUNDING
from rows import Empty, Limits


class Part:
    """Ranges of the order "N", of delay (j, "d") and sample (j, "k") of corner j, of the response (s, "B") at sample s.
    Samples that the target leaves for delays. In a window filters have any order."""

    def __init__(self, ranges, budget=None, window=False):
        self.ranges, self.budget, self.window, self.order = ranges, budget, window, ranges["N"][1]
        self.corners = [ranges[j, "d"] + ranges[j, "k"] for j, kind in (key for key in ranges if key[1:] == ("d",))]
        self.cuts = {key[0]: ends for key, ends in ranges.items() if key[1:] == ("B",)}
        self.tube = self.symmetric = False

    def __str__(self):
        ranges = [f"d = {d1} .. {d2} (k = {k1} .. {k2})" for d1, d2, k1, k2 in self.corners]
        return ", ".join([f"order up to {self.order}", *ranges, *(f"B_{k} split" for k in self.cuts)])


class Tree:
    """Checks a proof that no design costs less than the target, in samples; None: that there is no design."""

    def __init__(self, problem, certificate, target):
        self.problem, self.limits = problem, Limits(problem)
        self.sets, self.lemmas = certificate["multipliers"], certificate.get("lemmas", [])
        for entry in chain(*self.sets):
            self.limits.known(entry)
        self.known, self.leaves, self.limit = 0, 0, None  # limit: what a design must cost less than
        for lemma in self.lemmas:  # whatever it costs, and by no other lemma
            self.lemma(lemma)
        self.known = len(self.lemmas)
        self.limit = None if target is None else target * (1 - ROUNDING)
        self.whole(certificate["tree"], self.root())

    def root(self):
        most, ranges = self.problem.order_max, {"N": (self.problem.order_min, self.problem.order_max)}
        # From a delay of N + 2 and from k = N + d + 1 on nothing changes, or as much later as a response takes.
        for j, c in enumerate(self.problem.corners):
            ranges[j, "d"] = (0, most + 2 + self.limits.longer) if c.delay is None else (c.delay, c.delay)
            self.all_samples(ranges, j, most)
        return ranges

    def all_samples(self, ranges, j, order):
        last = ranges[j, "d"][1] + order + 1 + self.limits.longer
        ranges[j, "k"] = 0, last

    def whole(self, tree, ranges, window=False):
        self.tree, self.at = tree, 0
        self.node(ranges, 0, window)
        refuse_if(self.at != len(tree), "the tree goes on after its end")

    def lemma(self, lemma):
        refuse_if(("order" in lemma) == ("window" in lemma), "a lemma has either an order or a window")
        ranges, corners = self.root(), len(self.problem.corners)
        for j, delay in lemma["delays"]:
            d1, d2 = ranges[whole(j, 0, corners - 1), "d"]
            refuse_if(whole(delay) < d1, "a lemma names a delay that its corner cannot have")
            ranges[j, "d"] = d1, min(d2, delay)
            self.all_samples(ranges, j, self.problem.order_max)
        if "order" in lemma:
            least, most = ranges["N"]
            return self.whole(lemma["tree"], ranges | {"N": (least, min(most, whole(lemma["order"])))})
        order, anchor, at = lemma["window"]
        for j in range(corners):
            self.all_samples(ranges, j, whole(order, 2, 10**6))
        bounded = self.problem.corners[whole(anchor, 0, corners - 1)].error is not None
        refuse_if(not bounded or not 0 <= whole(at) <= ranges[anchor, "k"][1], "a lemma's window has no anchor")
        return self.whole(lemma["tree"], ranges | {"N": (order, order), (anchor, "k"): (at, at)}, True)

    def reduced(self, ranges, window=False):
        """Samples that the target leaves of a part."""
        (least, order), left, budget = ranges["N"], dict(ranges), None
        if self.limit is not None:
            room = self.limit - sum(c.weight * ranges[j, "d"][0] for j, c in enumerate(self.problem.corners))
            order = min(order, ceil(room / self.problem.filter_cost) - 2)  # the largest N with cost (N + 1) < room
            budget = room - self.problem.filter_cost * (least + 1)
        for j, corner in enumerate(self.problem.corners):
            d1, d2 = ranges[j, "d"]
            d2 = d2 if budget is None else min(d2, d1 + floor(budget / corner.weight))
            left[j, "d"] = d1, d2
            left[j, "k"] = ranges[j, "k"][0], min(ranges[j, "k"][1], order + 1 + self.limits.longer + d2)
        return Part(left | {"N": (least, order)}, budget, window)

    def next(self):
        refuse_if(self.at >= len(self.tree), "the tree is cut off: not every part is refuted")
        self.at += 1
        return self.tree[self.at - 1]

    def node(self, ranges, depth, window):
        """@param ranges  as splits have left them"""
        node, part = self.next(), self.reduced(ranges, window)
        refuse_if(depth > 1000, "the tree is too deep")
        least, most = part.ranges["N"]
        if node is None and not window:
            left = least <= most and all(low <= high for key, (low, high) in part.ranges.items() if key[-1] in "dkc")
            refuse_if(left, f"{part} is left out as too long, but is not")
            return
        refuse_if(most < least, "the tree goes on where every design is too long")
        if type(node) is int:
            self.leaf(node, part)
        elif node == "unreachable" and not window:
            self.leaves += 1
            refuse_if(self.limits.tube(part) is not None, f"{part} is called unreachable, but is not")
        elif isinstance(node, list) and len(node) == 2 and node[0] == "lemma" and not window:
            lemma = self.lemmas[whole(node[1], 0, self.known - 1)]
            self.leaves += 1
            covers = all(part.corners[j][1] <= delay for j, delay in lemma["delays"])
            refuse_if(not covers or most > lemma.get("order", most), f"{part} is not in lemma {node[1]}")
        else:
            for half in self.halves(node, ranges, "dk" if window else "dkBN"):
                self.node(half, depth + 1, window)

    def halves(self, node, ranges, kinds):
        kind, at = node[-2:] if isinstance(node, list) and len(node) in (2, 3) else (None, None)
        known = isinstance(kind, str) and kind in set(kinds) and (kind == "N") == (len(node) == 2)
        refuse_if(not known, f"a node {node!r}", NotCovered)
        key = "N" if kind == "N" else (whole(node[0], kind == "B"), kind)
        refuse_if(kind != "B" and key not in ranges, "the tree splits a corner that is not there")
        low, high = ranges.get(key, (0, 1))
        at, apart = (number(at), 0) if kind == "B" else (whole(at), 1)
        refuse_if(not low <= at <= high - apart, "the tree splits outside the part")
        return ranges | {key: (low, at)}, ranges | {key: (at + apart, high)}

    def leaf(self, index, part):
        """Rows times multipliers >= 0 add up to a sum that is above its bound for all filters of the part."""
        rows, bound = self.sets[whole(index, 0, len(self.sets) - 1)], 0
        ranges = [part.ranges[j, kind] for kind in "dk" for j in range(len(part.corners))]
        total = [0] * (part.order + 1 + len(ranges))
        self.leaves += 1
        factors = [number(row[-1]) for row in rows]
        least, most = min(factors, default=0), max(factors, default=0)
        refuse_if(least < 0, "a multiplier is negative")
        for entry, y in zip(rows, factors):
            try:
                row = self.limits.row(entry, part)
            except Empty:
                return
            if y == 0 or max(row.taps) <= row.bound and max(row.others) <= 0:
                continue  # it holds whatever the filter, whose taps have the sum 1
            factor = int(y / most * 2**64)  # any in this proportion prove
            total = [a + factor * c for a, c in zip(total, row.taps + row.others)]
            bound += factor * row.bound
        bound -= sum(min(c, 0) * (high - low) for c, (low, high) in zip(total[part.order + 1:], ranges))
        value = self.minimum(total[:part.order + 1], part)
        refuse_if(value is not None and value <= bound * ONE, f"{part} is not refuted by its multipliers")

    def minimum(self, c, part):
        """At most sum c b, times ONE, over taps of the sum 1 none above the largest allowed: with any level l, sum c b
        is l + most sum min(0, c - l) or more. None: not even full taps reach 1."""
        most = self.limits.tap_max
        if part.window:  # the ends stand for many taps: the level must not be above theirs
            ends = min(c[0], c[-1])
            c = [ends, *c[1:-1], ends]
        elif len(c) * most < ONE:
            return None
        level = sorted(c)[min(len(c) - 1, ONE // most)]
        level = min(level, ends) if part.window else level
        return level * ONE + most * sum(a - level for a in c if a < level)
