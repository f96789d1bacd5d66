"""Counts of members by what refutes them: each counts under one rule, which must be true of it."""
from collections import Counter
from copy import copy
from itertools import combinations

import families
from enclosure import refuse_if
from more.widening import widens

CURVE, OF_COMMAND = "force_speed", {"velocity", "acceleration", "jerk"}
ANY_LATE, MOST = {"delays", "simulation"}, 12


def alone(problem, kind):
    """The problem with limits of one kind."""
    one = copy(problem)
    one.axes = [axis._replace(limits={k: most for k, most in axis.limits.items() if k == kind},
                              lines=axis.lines if kind == CURVE else (),
                              last_speed=axis.last_speed if kind == CURVE else None) for axis in problem.axes]
    one.supply = {k: most for k, most in problem.supply.items() if f"{k}_total" == kind}
    return one


def starts_or_stops_break(member, kind):
    one = copy(member)
    one.problem = alone(member.problem, kind)
    return one.starts_or_stops_break()


@widens(families, "why")
def why(_, problem, controller, member, room):
    """All rules under which a member may count: kinds of limits that a start or stop breaks, "vibration", "delays".
    The other checker leaves out loads of dry friction and of a supply: members that break no other limit may count as
    late there.
    """
    kinds = {kind for axis in problem.axes for kind in axis.limits} | {f"{kind}_total" for kind in problem.supply}
    kinds |= {CURVE} if any(axis.lines for axis in problem.axes) else set()
    broken = member.starts_or_stops_break()
    rules = {kind for kind in kinds if broken and starts_or_stops_break(member, kind)}
    if problem.modes and member.rings():
        rules.add("vibration")
    unseen = problem.supply or any(axis.coulomb for axis in problem.axes)
    if (unseen and not rules & OF_COMMAND) if broken else families.passes_too_late(problem, controller, member, room):
        rules |= ANY_LATE
    return frozenset(rules)


@widens(families, "compare")
def compare(narrow, claimed, refuted):
    """By the marriage theorem: no set of rules counts fewer members than there are that no other rule refutes."""
    narrow(claimed, refuted)
    for family in {family for family, _ in refuted}:
        counts = Counter()
        for name, rule, n in claimed:
            counts.update({rule: n} if name == family else {})
        refuse_if(len(counts) > MOST, f"the certificate counts members of the family {family} under unknown rules")
        sets = {rules: n for (name, rules), n in refuted.items() if name == family}
        for chosen in (set(part) for size in range(len(counts)) for part in combinations(counts, size)):
            only = sum(n for rules, n in sets.items() if not rules & (counts.keys() - chosen))
            refuse_if(only > sum(counts[rule] for rule in chosen),
                      f"the certificate counts members of the family {family} under rules that do not refute them")
