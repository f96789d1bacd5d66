"""Bounds of single problems of `accdec instances`, of the schema accdec.refutation/1. The order, the delays and the
samples are given there. So trees are about less than all designs of a task, and errors may be at real instants."""
from fractions import Fraction
from math import ceil, isqrt

import claim
import problem as problems
from enclosure import BITS, exact, number, refuse_if, whole
from more.widening import widens
from problem import ROUNDING
from rows import KINDS
from tree import Part, Tree

SCHEMA = "accdec.refutation/1"
BARE = set("schema kind objective runs tolerance bound_samples multipliers tree".split())
# These members count as absent if they have these values; a certificate here has none of them otherwise.
ABSENT = {"conflict": [], "corner_of": [], "in_position": False, "lemmas": [], "smoothed": False}


class Narrow(Tree):
    """A tree about one order, one delay a corner, and one sample a corner or the instants of one corner."""

    def __init__(self, problem, certificate, samples, of_instants):
        self.samples, self.of_instants = samples, of_instants  # corner and delay; None
        super().__init__(problem, certificate, None)

    def root(self):
        ranges = super().root() | {(j, "k"): (k, k) for j, k in enumerate(self.samples)}
        last = Fraction(2 * (self.problem.order_max + 1))
        return ranges | {"t": (Fraction(0), last)} if self.of_instants else ranges

    def node(self, ranges, depth, window):
        if self.at < len(self.tree) and self.refutes_otherwise(self.tree[self.at], self.reduced(ranges)):
            self.at += 1
        else:
            super().node(ranges, depth, window)

    def halves(self, node, ranges, kinds):
        if "t" not in ranges or not isinstance(node, list) or len(node) != 2 or node[0] != "t":
            return super().halves(node, ranges, kinds)
        (low, high), at = ranges["t"], number(node[1])
        refuse_if(not low <= at <= high, "the tree splits outside the part")
        return ranges | {"t": (low, at)}, ranges | {"t": (at, high)}

    def refutes_otherwise(self, node, part):
        """The error in one direction, by the distances' tangents, is linear in the instant. If it is above its bound at
        both ends of the part, it is above it between them."""
        if "t" not in part.ranges or not isinstance(node, list) or len(node) != 5 or node[0] != "instants":
            return False
        touch_in, touch_out = number(node[1]), number(node[2])
        sets = [self.sets[whole(i, 0, len(self.sets) - 1)] for i in node[3:]]
        directions = {number(row[2]) for rows in sets for row in rows if row[0] == "error"}
        refuse_if(len(directions) > 1, "instants are refuted by errors in more than one direction")
        for index, instant in zip(node[3:], part.ranges["t"]):
            part.tangents = *self.of_instants, touch_in, touch_out, instant
            self.leaf(index, part)
        return True


Part.tangents = None


def ramp(z):
    """Integral over 0 .. z of a tap that is spread evenly over one sample; and its slope."""
    slope = min(max(z, Fraction(0)), Fraction(1))
    return slope * slope / 2 + max(z - 1, Fraction(0)), slope


def error(row, j, angle):
    """cos(alpha) v1 p(t) + cos(theta - alpha) v2 q(t - d) by tangents of p and q, for all delays up to d."""
    if "t" not in row.box.ranges:
        row.error(j, angle)
        return
    refuse_if(not row.box.tangents or row.box.tangents[0] != j, "a multiplier names an error at no instant")
    _, delay, touch_in, touch_out, instant = row.box.tangents
    of_p, of_q = row.seen(j, angle, True)
    refuse_if(min(of_p.lo, of_q.lo) < 0, "an error's direction does not grow with both distances")
    for c, starts, beyond in ((of_p, (i + 1 - touch_in for i in row.indices), touch_in - instant),
                              (of_q, (touch_out - i for i in row.indices), instant - delay - touch_out)):
        weights = exact([value + slope * beyond for value, slope in map(ramp, starts)])
        row.taps = [tap + part for tap, part in zip(row.taps, (c * weights).lo)]


KINDS["error"] = error, "jx"


def narrowed(file, factors):
    """The problem at the given place, with its tolerances times these factors; None: without."""
    task, at = dict(file["task"]), file["at"]
    corners, modes = [], []
    for table, delay, factor in zip(task["corner"], at["delays"], factors):
        table = table | {"delay_samples": whole(delay, 0)}
        error = number(table.pop("error_max_um", 0))
        corners.append(table | ({"error_max_um": error * factor} if error and factor is not None else {}))
    for table, frequencies in zip(task.get("mode", []), at["frequencies"]):
        band, ratios = (end if isinstance(end, list) else [end, end]
                        for end in (table["frequency_Hz"], table.get("damping_ratio", 0)))
        outside = [f for f in frequencies if not float(band[0]) <= float(number(f)) <= float(band[1])]
        refuse_if(outside, "a mode is bounded outside its band")
        modes += [table | {"frequency_Hz": f, "damping_ratio": z}
                  for f in frequencies for z in sorted({number(z) for z in ratios})]
    order = whole(at["order"], 0, 10**6)
    task |= {"corner": corners, "mode": modes,
             "design": task.get("design", {}) | {"order_min": order, "order_max": order}}
    return problems.read({key: x for key, x in task.items() if key not in ("controller", "filter", "baseline")})


def require_place(file, of_delay):
    task, at = file["task"], file["at"]
    places = {"order", "delays", "frequencies"} | (set() if of_delay else {"samples"})
    refuse_if(set(at) != places, f"a place with the members {sorted(at)}")
    refuse_if("prefilter_taps" in task.get("controller", {}), "a problem behind a smoothing")
    lists = [at["delays"], at.get("samples", []), at["frequencies"], *at["frequencies"]]
    refuse_if(not all(isinstance(x, list) for x in lists), "the place has something else where a list belongs")
    counts = [len(at["delays"]), len(at.get("samples", at["delays"])), len(at["frequencies"])]
    refuse_if(counts != 2 * [len(task["corner"])] + [len(task.get("mode", []))],
              "the place has not one delay and sample a corner, or not one list of frequencies a mode")
    for k, d in zip(at.get("samples", []), at["delays"]):
        whole(k, 0, at["order"] + d + 1)
    problem = narrowed(file, [None] * counts[0])
    wide = len(problem.response.lo) > 1 or problem.supply or any(c.contour is not None for c in problem.corners)
    refuse_if(wide or any(mode.axis is not None for mode in problem.modes),
              "a problem with a response, contour, supply or mode of an axis")


def leaves_none(file, part):
    """Whether the delays refuted are all that the corner may have. From N + 1 on the path passes the corner itself."""
    given = file["task"]["corner"][part["corner"]].get("delay_samples")
    return part["delay"] >= file["at"]["order"] + 1 or given is not None and given <= part["delay"]


def require_sum(file, lower):
    """That the delays that the parts refute are a bound of the weighted delay; without one, that none is left."""
    total, none, seen = 0, False, set()
    for part in file["parts"]:
        j, delay = whole(part["corner"], 0, len(file["task"]["corner"]) - 1), number(part["delay"])
        refuse_if(j in seen or delay < 0, "the parts are not one a corner, or a delay is negative")
        seen.add(j)
        corner = file["task"]["corner"][j]
        refuse_if(number(corner.get("error_max_um", 0)) <= 0, "a part is about a corner without a tolerance")
        given = corner.get("delay_samples")
        none |= leaves_none(file, part)
        total += number(corner.get("weight", 1)) * delay if given is None else 0
    refuse_if(lower is None and not none, "a corner may have more than the delays that are refuted")
    refuse_if(lower is not None and lower > total * (1 + ROUNDING),
              f"the delays refuted are a bound of {float(total)}, {float(lower or 0)} is claimed")


def tree_of(file, certificate):
    tree, design = claim.known(claim.unpacked(certificate), ["branch and bound"]), file["task"].get("design", {})
    objective = design.get("objective", "cycle")
    runs = number(design.get("runs", 1)) if objective == "cycle" else 1
    further = {key for key in tree if key not in ABSENT or repr(tree[key]) != repr(ABSENT[key])} - BARE
    other = (further or tree["bound_samples"] is not None or tree["objective"] != objective
             or number(tree.get("runs", 1)) != runs or number(tree.get("tolerance", 2 * ROUNDING)) != 2 * ROUNDING)
    refuse_if(other, "the certificate of a refutation has a bound, lemmas, merged corners or another objective")
    return tree


def refutation(file):
    refuse_if(set(file) != {"schema", "formulation", "lower", "at", "task", "parts"}, "other members than it has")
    of_delay = ["margin", "delay"].index(file["formulation"]) == 1
    require_place(file, of_delay)
    lower, parts, corners = file["lower"], file["parts"], len(file["task"]["corner"])
    lower = None if lower is None else number(lower)
    refuse_if(not parts or lower is not None and lower <= 0, "there are no parts, or the bound is not above zero")
    if summed := of_delay and "corner" in parts[0]:
        require_sum(file, lower)
    refuse_if(not summed and (len(parts) > 1 or of_delay and lower is not None), "the parts are not of such a bound")
    # A tolerance times the square root of the bound, rounded up.
    factors, leaves = [None] * corners, 0
    if not of_delay and lower is not None:
        factors = [Fraction(isqrt(ceil(lower * 4**BITS)) + 1, 2**BITS)] * corners
    for part in parts:
        refuse_if(set(part) != ({"corner", "delay", "certificate"} if summed else {"certificate"}),
                  "a part has other members")
        if summed:
            factors = [1 if j == part["corner"] else None for j in range(corners)]
        at_instants = (part["corner"], number(part["delay"])) if summed else None
        leaves += Narrow(narrowed(file, factors), tree_of(file, part["certificate"]), file["at"].get("samples", []),
                         at_instants).leaves
    place = f"order {file['at']['order']} with limits on the blends at delay {file['at']['delays']}"
    if lower is None:
        which = summed and next(part for part in parts if leaves_none(file, part))
        within = f"passes corner {which['corner']} within its tolerance at a delay that it may have" if which else \
            "holds all limits"
        return f"{leaves} parts refuted: no filter of {place} {within}"
    least = "weighted delays of" if of_delay else f"at sample {file['at']['samples']} a sigma of"
    return f"{leaves} parts refuted: filters of {place} need {least} more than {float(lower):.9g}"


@widens(claim, "proved")
def proved(narrow, result):
    return refutation(result) if result.get("schema") == SCHEMA else narrow(result)
