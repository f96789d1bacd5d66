"""Nodes about symmetric filters. Such a filter becomes one of the part's order or of one less by zeros at both ends.
Splits of contour times (j, "c") and of the samples at which an axis reverses (j, axis, "r"). Delays by one width."""
from fractions import Fraction

from enclosure import exact, number, refuse_if, whole
from more.rows import ANY_SAMPLE
from more.widening import widens
from tree import Tree


def orders(tree, part):
    """That order depends on the delays alone, so there must be one each."""
    refuse_if(not tree.problem.symmetric, "the tree refutes symmetric filters only, the task allows any")
    refuse_if(part.order < part.ranges["N"][0], "the tree goes on where every design is too long")
    one = all(d1 == d2 for d1, d2, _, _ in part.corners)
    refuse_if(not one, f"{part} refutes symmetric filters of one order for several delays at once")
    return [n for n in (part.order, part.order - 1) if n >= tree.problem.order_min]


def symmetric_part(tree, ranges, order):
    part = tree.reduced(ranges)
    part.order, part.symmetric = order, True
    return part


def symmetric_tree(tree, ranges, depth, order):
    node, part = tree.next(), symmetric_part(tree, ranges, order)
    refuse_if(depth > 1000, "the tree is too deep")
    if type(node) is int:
        tree.leaf(node, part)
    elif node == "unreachable":
        tree.leaves += 1
        refuse_if(tree.limits.tube(part) is not None, f"{part} is called unreachable, but is not")
    elif not tree.refutes_otherwise(node, part):
        for half in tree.halves(node, ranges, "Br"):
            symmetric_tree(tree, half, depth + 1, order)


@widens(Tree, "all_samples")
def all_samples(narrow, self, ranges, j, order):
    narrow(self, ranges, j, order)
    ranges[j, "c"] = tuple(map(Fraction, ranges[j, "k"]))


@widens(Tree, "reduced")
def reduced(narrow, self, ranges, window=False):
    """At the last sample the motion has ended: a contour that holds later holds there."""
    part = narrow(self, ranges, window)
    for j, (_, d2, _, _) in enumerate(part.corners):
        low, high = ranges[j, "c"]
        part.ranges[j, "c"] = low, min(high, Fraction(part.order + 1 + self.limits.longer + d2))
    return part


def by_width(problem, ranges, last):
    """Delays that one width may give: from the latency on, up to the last. A faster corner waits as long or longer, as
    v_i p(e_i) < v_j p(e_j - 1). Speeds that differ by a part of 10^-12 count as equal."""
    speeds, ends = [exact(corner.watched).hi for corner in problem.corners], {}
    for j, speed in enumerate(speeds):
        slower = [i for i, v in enumerate(speeds) if v * 10**12 <= speed * (10**12 + 1)]
        faster = [i for i, v in enumerate(speeds) if v * (10**12 + 1) >= speed * 10**12]
        ends[j, "d"] = (max(problem.latency, *(ranges[i, "d"][0] for i in slower)),
                        min([ranges[i, "d"][1] for i in faster] + ([] if last is None else [last])))
    return ranges | ends


@widens(Tree, "reduced")
def reduced_by_width(narrow, self, ranges, window=False):
    """From the filter's last tap on no way is left."""
    if window or not self.problem.one_width:
        return narrow(self, ranges, window)
    ranges = by_width(self.problem, ranges, None)
    part = narrow(self, ranges)
    longer = self.limits.longer if self.problem.actual else len(self.problem.smoothing.lo) - 1
    left = {key: ends for key, ends in part.ranges.items() if key[1:] == ("d",)}
    return narrow(self, by_width(self.problem, ranges | left, part.order + longer + self.problem.latency))


@widens(Tree, "root")
def root_from(narrow, self):
    ranges = narrow(self)
    for j in range(len(self.problem.corners) if self.problem.one_width else 0):
        low, high = ranges[j, "d"]
        ranges[j, "d"] = low, high + self.problem.latency
        self.all_samples(ranges, j, self.problem.order_max)
    for j, least in self.least:
        low, high = ranges[whole(j, 0, len(self.problem.corners) - 1), "d"]
        ranges[j, "d"] = max(low, whole(least)), high
    return ranges


@widens(Tree, "lemma")
def lemma_from(narrow, self, lemma):
    """A lemma may be about delays of at least these."""
    self.least = lemma.get("from", [])
    narrow(self, lemma)
    self.least = []


@widens(Tree, "node")
def node_of_lemma_from(narrow, self, ranges, depth, window):
    node = self.tree[self.at] if self.at < len(self.tree) else None
    if isinstance(node, list) and len(node) == 2 and node[0] == "lemma":
        part, lemma = self.reduced(ranges, window), self.lemmas[whole(node[1], 0, self.known - 1)]
        before = any(part.corners[j][0] < least for j, least in lemma.get("from", []))
        refuse_if(before, f"{part} has shorter delays than lemma {node[1]}")
    narrow(self, ranges, depth, window)


Tree.least = []
Tree.refutes_otherwise = lambda self, node, part: False


@widens(Tree, "halves")
def halves(narrow, self, node, ranges, kinds):
    if "B" in kinds and isinstance(node, list) and len(node) == 4 and node[1] == "r":
        key, at = (whole(node[0]), whole(node[2]), "r"), whole(node[3])
        low, high = ranges.get(key, ANY_SAMPLE)
        refuse_if(not low <= at < high, "the tree splits outside the part")
        return ranges | {key: (low, at)}, ranges | {key: (at + 1, high)}
    if "N" not in kinds or not isinstance(node, list) or len(node) != 3 or node[1] != "c":
        return narrow(self, node, ranges, kinds)
    key, at = (whole(node[0]), "c"), number(node[2])
    refuse_if(key not in ranges, "the tree splits a corner that is not there")
    low, high = ranges[key]
    refuse_if(not low < at < high, "the tree splits outside the part")
    return ranges | {key: (low, at)}, ranges | {key: (at, high)}


@widens(Tree, "node")
def node_of_symmetric(narrow, self, ranges, depth, window):
    node = self.tree[self.at] if self.at < len(self.tree) else None
    pair = isinstance(node, list) and len(node) == 2 and type(node[0]) is int
    if window or node != ["symmetric"] and not pair:
        return narrow(self, ranges, depth, window)
    self.at += 1
    for i, order in enumerate(orders(self, self.reduced(ranges))):
        if pair:
            self.leaf(node[i], symmetric_part(self, ranges, order))
        else:
            symmetric_tree(self, ranges, depth + 1, order)


@widens(Tree, "minimum")
def minimum(narrow, self, c, part):
    return narrow(self, [a + b >> 1 for a, b in zip(c, reversed(c))] if part.symmetric else c, part)
