"""Bounds for a control that passes corners at parts of their feeds: each part's least orders, and the least cost."""
from copy import copy
from itertools import product
from math import ceil
from types import SimpleNamespace

import claim
from enclosure import Enclosure, exact, number, refuse_if, whole
from problem import ROUNDING
from tree import Tree

MOST_WAYS, KINDS = 20000, {"corner-feed", "continuous", "exact-stop"}
IN_PROPORTION = {"velocity", "acceleration", "jerk", "force"}
SETTLED = "; each corner feed lasts until the motion has settled"  # shorter ones are not looked at
of_families = claim.CHECKS["families"]


def require_known(problem):
    """A stop at feed asks no more than a start then, and a slower corner no more than a faster one."""
    for axis in problem.axes:
        loads = axis.damping or axis.coulomb or axis.lines or axis.limits.keys() - IN_PROPORTION
        refuse_if(loads, "corner feeds with limits that are not in proportion to the feed")
    refuse_if(any(mode.most_damping or mode.axis is not None for mode in problem.modes) or problem.supply,
              "corner feeds with modes of axes or with damping, or with a supply")
    refuse_if(any(corner.speed_min or corner.delay is not None for corner in problem.corners),
              "corner feeds with a smallest speed or a given delay")


def at_feeds(problem, parts):
    """The legs as straight lines at feed, and each corner at its part of the feed unless that is an exact stop."""
    problem, corners = copy(problem), []
    for corner, part in zip(problem.corners, parts):
        for feed, speeds in ((corner.feed_in, corner.speed_in), (corner.feed_out, corner.speed_out)):
            corners.append(SimpleNamespace(
                name="", feed_in=feed, feed_out=feed, fastest=feed, weight=1, speed_in=speeds, speed_out=speeds,
                cosine=exact(-1), sine=exact(0), error=None, contour=None, speed_min=0, delay=0))
        if part:
            slow = copy(corner)
            slow.feed_in, slow.feed_out, slow.fastest = (x * part for x in (slow.feed_in, slow.feed_out, slow.fastest))
            slow.speed_in, slow.speed_out = ([x * part for x in leg] for leg in (slow.speed_in, slow.speed_out))
            slow.weight, slow.delay = 1, 0
            corners.append(slow)
    problem.corners, problem.corner_feeds, problem.has_width = corners, False, False
    problem.objective, problem.runs, problem.filter_cost, problem.order_min = "cycle", 1, 1, 0
    return problem


def least_cost(problem, ways, least):
    """Of all ways past the corners. @param least  pairs: the parts' multiples, and the order that none is below"""
    best, longer = None, len(problem.response.lo) - 1
    for chosen in product(ways, repeat=len(problem.corners)):
        order = max((n for slower, n in least if all(a <= b for a, b in zip(slower, chosen))), default=0)
        taps = max(order, problem.order_min) + 1
        if taps > problem.order_max + 1:
            continue
        cost, stop = problem.filter_cost * taps, taps + len(problem.smoothing.lo) - 2
        for corner, way in zip(problem.corners, chosen):
            cost += corner.weight * (2 * (taps + 1 + longer) * (1 - ways[way]) if way else stop)
        best = cost if best is None else min(best, cost)
    return best


def corner_feeds(result, problem, certificate):
    refuse_if(problem.given_filter or "corner-feed" not in problem.kinds, "the control has no corner feeds")
    refuse_if(problem.kinds - KINDS, "corner feeds beside other delays")
    require_known(problem)
    step = problem.corner_feed_step
    feed = ceil(1 / step)  # the number of the feed itself; those before are multiples of the step, 0 is a stop
    parts = [step * way for way in range(feed)] + [1]
    kinds = ["exact-stop"] + ["corner-feed"] * (feed - 1) + ["continuous"]
    ways = {way: parts[way] for way, kind in enumerate(kinds) if kind in problem.kinds}
    refuse_if((feed + 1)**len(problem.corners) > MOST_WAYS, "there are too many ways past the corners")
    least = []
    for part in certificate["parts"]:
        refuse_if(set(part) != {"multiples", "orders"} or len(part["multiples"]) != len(problem.corners),
                  "a part has other members, or not one multiple a corner")
        multiples = [whole(way, 0, feed) for way in part["multiples"]]
        tree = claim.known(part["orders"], ["branch and bound"])
        bound = tree["bound_samples"]
        subject = at_feeds(problem, [parts[way] for way in multiples])
        refuse_if(tree["objective"] != "cycle" or number(tree["runs"]) != 1, "a part is about another objective")
        refuse_if(number(tree.get("tolerance", 2 * ROUNDING)) != 2 * ROUNDING, "a part is about other limits")
        subject, target = claim.searched(subject, tree, None if bound is None else number(bound))
        Tree(subject, tree, target)
        taps = problem.order_max + 2 if bound is None else number(bound)
        least.append((multiples, ceil(taps * (1 - 2 * ROUNDING)) - 1))
    proved, claimed = least_cost(problem, ways, least), certificate["bound_samples"]
    refuse_if(proved is not None and (claimed is None or number(claimed) > proved * (1 + ROUNDING)),
              "the certificate claims more than its parts prove")
    target = claim.target_of(result, problem, "lower_bound_s", claimed)
    if target is None:
        return f"{len(least)} parts of the feeds refuted: no filter holds all limits{SETTLED}"
    words = f"{len(least)} parts of the feeds refuted: no {problem.objective} time is shorter than"
    return f"{words} {float(target * problem.period):.9g} s{SETTLED}"


def families_with_feeds(result, problem, certificate):
    slow = problem.corner_feeds
    return of_families(result, problem, certificate) + (SETTLED if slow else "")


claim.MEMBERS["corner feeds"] = {"bound_samples", "parts"}
claim.LISTS.add("parts")
claim.CHECKS["corner feeds"] = corner_feeds
claim.CHECKS["families"] = families_with_feeds
