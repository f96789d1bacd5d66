"""The tree of a proof: parts of all designs, each split in two or refuted, in preorder."""
from fractions import Fraction
from math import ceil, floor

from enclosure import ONE
from problem import NotCovered, Refused, number, refuse_if, whole
from rows import Empty, Rows

ROUNDING = Fraction(1, 10**9)  # of times: shorter by less is not shorter


class Box:
    """A part: by corner (d1, d2, k1, k2), and (c1, c2) of its contour; bounds on the order; cuts (sample, at most?,
    level) of responses."""

    def __init__(self, corners, times, order_most, order_least=0, cuts=(), window=False):
        self.corners, self.times, self.cuts, self.window = corners, times, cuts, window
        self.order_least, self.order_most = order_least, order_most
        self.order, self.budget = -1, None  # what the target leaves
        self.tube, self.tube_known = None, False

    def copy(self, **changes):
        other = Box(self.corners, self.times, self.order_most, self.order_least, self.cuts, self.window)
        other.order, other.budget = self.order, self.budget
        other.__dict__.update(changes)
        return other

    def with_corner(self, j, corner):
        return self.copy(corners=[corner if i == j else c for i, c in enumerate(self.corners)])

    def __str__(self):
        ranges = [f"d = {d1} .. {d2} (k = {k1} .. {k2})" for d1, d2, k1, k2 in self.corners]
        ranges += [f"B_{k} {'<=' if upper else '>='} {float(level):.6g}" for k, upper, level in self.cuts]
        return ", ".join([f"order up to {self.order}", *ranges])


def tagged(node, at, *tags):
    return isinstance(node, list) and len(node) > at and isinstance(node[at], str) and node[at] in tags


def is_whole(x):
    return isinstance(x, int) and not isinstance(x, bool)


class Tree:
    """Checks a proof that no design costs less than the target, in samples; None: that there is no design."""

    def __init__(self, problem, certificate, target):
        self.problem, self.rows = problem, Rows(problem)
        self.sets, self.lemmas = certificate["multipliers"], certificate.get("lemmas", [])
        self.known, self.leaves, self.limit = 0, 0, None  # limit: what a design must cost less than
        for lemma in self.lemmas:  # whatever it costs, and by no other lemma
            self._lemma(lemma)
        self.known = len(self.lemmas)
        self.limit = None if target is None else target * (1 - ROUNDING)
        self._whole(certificate["tree"], self._node, self._root())

    def _root(self):
        most, corners = self.problem.order_max, []
        # From a delay of N + 2 and from k = N + d + 1 on nothing changes, or as much later as a servo takes.
        for c in self.problem.corners:
            d1, d2 = (0, most + 2 + self.rows.longer) if c.delay is None else (c.delay, c.delay)
            corners.append((d1, d2, 0, d2 + most + 1 + self.rows.longer))
        return Box(corners, [(Fraction(0), Fraction(k2)) for _, _, _, k2 in corners], most)

    def _whole(self, tree, check, box):
        self.tree, self.at = tree, 0
        check(box, 0)
        refuse_if(self.at != len(tree), "the tree goes on after its end")

    def _next(self, depth):
        refuse_if(self.at >= len(self.tree), "the tree is cut off: not every part is refuted")
        refuse_if(depth > 1000, "the tree is too deep")
        self.at += 1
        return self.tree[self.at - 1]

    def _lemma(self, lemma):
        refuse_if(("order" in lemma) == ("window" in lemma), "a lemma has either an order or a window")
        box = self._root()
        for j, delay in lemma["delays"]:
            refuse_if(not 0 <= whole(j) < len(box.corners), "a lemma names a corner that is not there")
            d1, d2 = box.corners[j][0], min(box.corners[j][1], whole(delay))
            refuse_if(d2 < d1, "a lemma names a delay that its corner cannot have")
            box = box.with_corner(j, (d1, d2, 0, d2 + self.problem.order_max + 1 + self.rows.longer))
        if "order" in lemma:
            self._whole(lemma["tree"], self._node, box.copy(order_most=min(box.order_most, whole(lemma["order"]))))
            return
        order, anchor, at = (whole(x) for x in lemma["window"])
        refuse_if(not (2 <= order <= 10**6 and 0 <= anchor < len(box.corners)), "a lemma's window is none")
        corners = [(d1, d2, 0, d2 + order + 1 + self.rows.longer) for d1, d2, _, _ in box.corners]
        bounded = self.problem.corners[anchor].error is not None and 0 <= at <= corners[anchor][3]
        refuse_if(not bounded, "a lemma's window has no anchor")
        corners[anchor] = corners[anchor][:2] + (at, at)
        self._whole(lemma["tree"], self._window, box.copy(corners=corners, order=order, window=True))

    def _window(self, box, depth):
        node = self._next(depth)
        if is_whole(node):
            self._leaf(node, box, False)
        elif tagged(node, 1, "d", "k"):
            for part in self._split(node, box):
                self._window(part, depth + 1)
        else:
            raise Refused("filters of any order are neither refuted nor split on a delay or sample")

    def _reduced(self, box):
        """What the target leaves of a part: the largest order, delays, a budget for them. Order -1: nothing."""
        least = max(self.problem.order_min, box.order_least)
        if self.limit is None:
            reduced = box.copy(order=box.order_most if box.order_most >= least else -1)
        else:
            filter_cost, weights = self.problem.filter_cost, [c.weight for c in self.problem.corners]
            room = self.limit - sum(w * c[0] for w, c in zip(weights, box.corners))
            order = min(box.order_most, ceil(room / filter_cost) - 2)  # the largest N with filter_cost (N + 1) < room
            room -= filter_cost * (least + 1)
            reduced = box.copy(order=order if order >= least else -1, budget=room)
            if reduced.order >= 0:
                most = [d1 + floor(room / w) for w, (d1, _, _, _) in zip(weights, box.corners)]
                reduced.corners = [(c[0], min(c[1], m)) + c[2:] for c, m in zip(box.corners, most)]
        if reduced.order >= 0:
            last = reduced.order + 1 + self.rows.longer
            reduced.corners = [(d1, d2, k1, min(k2, last + d2)) for d1, d2, k1, k2 in reduced.corners]
            # There the motion has ended: a contour that holds later holds there.
            reduced.times = [(c1, min(c2, last + c[1])) for (c1, c2), c in zip(box.times, reduced.corners)]
        return reduced

    def _node(self, part, depth):
        """`part` is as splits have left it, `box` what the target leaves of it."""
        node, box = self._next(depth), self._reduced(part)
        if node is None:
            if box.order >= 0 and all(k1 <= k2 for _, _, k1, k2 in box.corners) and all(a <= b for a, b in box.times):
                raise Refused(f"{box} is left out as too long, but is not")
        elif box.order < 0:
            raise Refused("the tree goes on where every design is too long")
        elif node == "unreachable":
            self._unreachable(box)
        elif is_whole(node):
            self._leaf(node, box, False)
        elif node == ["symmetric"]:
            for one in self._symmetric_orders(box):
                self._exact_order(one, depth + 1)
        elif isinstance(node, list) and len(node) == 2 and is_whole(node[0]):
            for index, one in zip(node, self._symmetric_orders(box)):
                self._leaf(index, one, True)
        elif tagged(node, 0, "lemma") and len(node) == 2:
            self._by_lemma(node[1], box)
        else:
            for half in self._halves(node, part, box):
                self._node(half, depth + 1)

    def _halves(self, node, part, box):
        if tagged(node, 0, "N") and len(node) == 2:
            least = max(self.problem.order_min, part.order_least)
            refuse_if(not least <= whole(node[1]) < part.order_most, "the tree splits outside the part")
            return part.copy(order_most=node[1]), part.copy(order_least=node[1] + 1)
        if tagged(node, 1, "B") and len(node) == 3:
            return self._response_split(node, part, box.order)
        if tagged(node, 1, "d", "k"):
            return self._split(node, part)
        if tagged(node, 1, "c") and len(node) == 3:
            return self._contour_split(node, part)
        raise NotCovered(f"a node {node!r}")

    @staticmethod
    def _contour_split(node, box):
        j, at = node[0], number(node[2])
        refuse_if(not 0 <= whole(j) < len(box.corners), "the tree splits a corner that is not there")
        c1, c2 = box.times[j]
        refuse_if(not c1 < at < c2, "the tree splits outside the part")
        return tuple(box.copy(times=[*box.times[:j], half, *box.times[j + 1:]]) for half in ((c1, at), (at, c2)))

    @staticmethod
    def _split(node, box):
        j, what, at = node
        refuse_if(not 0 <= whole(j) < len(box.corners), "the tree splits a corner that is not there")
        d1, d2, k1, k2 = box.corners[j]
        low, high = (d1, d2) if what == "d" else (k1, k2)
        refuse_if(not low <= whole(at) < high, "the tree splits outside the part")
        if what == "d":
            return box.with_corner(j, (d1, at, k1, k2)), box.with_corner(j, (at + 1, d2, k1, k2))
        return box.with_corner(j, (d1, d2, k1, at)), box.with_corner(j, (d1, d2, at + 1, k2))

    @staticmethod
    def _response_split(node, box, order):
        sample, level = whole(node[0]), number(node[2])
        refuse_if(not (1 <= sample <= order and 0 <= level <= 1), "the tree splits a response that is not there")
        return tuple(box.copy(cuts=box.cuts + ((sample, upper, level),)) for upper in (True, False))

    def _by_lemma(self, index, box):
        refuse_if(not 0 <= whole(index) < self.known, "the tree names a lemma that is not there")
        self.leaves += 1
        lemma = self.lemmas[index]
        covers = "window" in lemma or box.order <= lemma["order"]
        covers = covers and all(box.corners[j][1] <= delay for j, delay in lemma["delays"])
        refuse_if(not covers, f"{box} is not what lemma {index} is about")

    def _symmetric_orders(self, box):
        """A symmetric filter becomes one of the part's order or of one less by zeros at both ends. That order depends
        on the delays alone, so there must be one each."""
        refuse_if(not self.problem.symmetric, "the tree refutes symmetric filters only, the task allows any")
        if any(d1 != d2 for d1, d2, _, _ in box.corners):
            raise Refused(f"{box} refutes symmetric filters of one order for several delays at once")
        return [box.copy(order=n) for n in (box.order, box.order - 1) if n >= self.problem.order_min]

    def _exact_order(self, box, depth):
        node = self._next(depth)
        if is_whole(node):
            self._leaf(node, box, True)
        elif node == "unreachable":
            self._unreachable(box)
        elif tagged(node, 1, "B"):
            for part in self._response_split(node, box, box.order):
                self._exact_order(part, depth + 1)
        else:
            raise Refused("symmetric filters of one order are neither refuted nor split on a response")

    def _unreachable(self, box):
        self.leaves += 1
        if self.rows.tube(box) is not None:
            raise Refused(f"{box} is called unreachable, but is not")

    def _leaf(self, index, box, symmetric):
        """Rows times multipliers >= 0 add up to a sum that is above its bound for all filters of the part."""
        refuse_if(not 0 <= whole(index) < len(self.sets), "the tree names multipliers that are not there")
        self.leaves += 1
        sums, bound = [[0] * (box.order + 1) for _ in range(4)] + [[0] * len(box.corners) for _ in range(2)], 0
        for entry, factor in self._factors(self.sets[index]):
            try:
                row = self.rows.build(entry, box)
            except Empty:
                return
            if not row.terms and row.bound >= 0:
                continue  # it says nothing of the filter, and holds
            for what, at, c in row.terms:
                sums[what][at] += factor * c
            bound += factor * row.bound
        for (d1, d2, k1, k2), of_delay, of_sample in zip(box.corners, *sums[4:]):
            bound -= min(of_delay, 0) * (d2 - d1) + min(of_sample, 0) * (k2 - k1)
        value = self._minimum(self._coefficients(*sums[:4]), box.window, symmetric)
        if value is not None and value <= bound * 2 * ONE:
            raise Refused(f"{box} is not refuted by its multipliers")

    @staticmethod
    def _factors(rows):
        """Rows with whole numbers in the proportion of their multipliers: any that are not negative prove."""
        refuse_if(not all(isinstance(row, list) and len(row) > 1 for row in rows), "a row is no list of two or more")
        factors = [number(row[-1]) for row in rows]
        refuse_if(any(y < 0 for y in factors), "a multiplier is negative")
        return [(row, int(y / max(factors) * 2**64)) for row, y in zip(rows, factors) if y > 0]

    @staticmethod
    def _coefficients(taps, responses, rises, falls):
        """Of each tap in all sums together."""
        slope = value = 0
        for i, change in enumerate(rises):  # what stands at i rises by one a tap from there on
            slope += change
            value += slope
            taps[i] += value
        slope = value = steps = 0
        for i in reversed(range(len(taps))):  # and falls to one at i; B_i has the taps before i
            slope += falls[i]
            value += slope
            taps[i] += value + steps
            steps += responses[i]
        return taps

    def _minimum(self, c, window, symmetric):
        """At most 2 sum c b, times ONE, over taps of the sum 1 none above the largest allowed: with any level l, sum
        c b is l + most sum min(0, c - l) or more. None: not even full taps reach 1."""
        most, ends = self.rows.tap_max, None
        c = [a + b for a, b in zip(c, reversed(c))] if symmetric else [2 * a for a in c]
        if window:  # the ends stand for many taps: the level must not be above theirs
            ends = min(c[0], c[-1])
            c = [ends, *c[1:-1], ends]
        elif len(c) * most < ONE:
            return None
        level = sorted(c)[min(len(c) - 1, ONE // most)]
        level = level if ends is None else min(level, ends)
        return level * ONE + most * sum(a - level for a in c if a < level)
