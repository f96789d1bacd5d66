"""What a result claims, and the check of its certificate."""
import base64
import json
import math
import zlib
from collections import Counter
from decimal import Decimal
from importlib import import_module, util

import families
import members
import problem as problems
from enclosure import NotCovered, Refused, number, refuse_if, whole
from problem import ROUNDING, WIDER
from tree import Tree

# Members of each kind of certificate; those that are lists.
MEMBERS = {"packed": {"gzip"}, "enumeration": set(), "families": {"bound_samples", "refuted", "taps"},
           "branch and bound": set("objective runs tolerance bound_samples conflict multipliers lemmas tree".split())}
LISTS, STATUSES = {"conflict", "multipliers", "lemmas", "tree", "refuted"}, {"optimal", "feasible", "infeasible"}


def _decimal(text):
    value = Decimal(text)
    refuse_if(not math.isfinite(float(value)) or (value and not float(value)), f"the number {text} is out of range")
    return value


def _object(pairs):
    refuse_if(len(dict(pairs)) != len(pairs), "a key stands twice in its object")
    return dict(pairs)


def parse(text):
    """JSON with its numbers as they are written."""
    return json.loads(text, parse_float=_decimal, parse_constant=_decimal, object_pairs_hook=_object)


def known(certificate, kinds):
    """A certificate, if it is of one of these kinds."""
    kind, schema = certificate["kind"], certificate.get("schema")
    right = kind in kinds and (schema == "accdec.certificate/1" or kind == "enumeration" and schema is None)
    refuse_if(not right, f"a certificate of the kind {kind!r} and schema {schema!r}", NotCovered)
    wrong = [key for key, x in certificate.items()
             if key not in {"kind", "schema"} | MEMBERS[kind] or isinstance(x, list) != (key in LISTS)
             or x is None and key != "bound_samples" or key == "conflict" and {*map(type, x)} - {str}]
    refuse_if(wrong, f"a certificate of the kind {kind!r} with such members {wrong}", NotCovered)
    return certificate


def unpacked(certificate):
    if certificate["kind"] != "packed":
        return certificate
    unpack = zlib.decompressobj(16 + zlib.MAX_WBITS)
    text = unpack.decompress(base64.b64decode(known(certificate, ["packed"])["gzip"], validate=True), 2 * 10**9)
    refuse_if(not unpack.eof or unpack.unused_data, "the packed certificate is cut off or has something behind it")
    return parse(text.decode())


def recorded(result, problem):
    """Taps, delays and cost in samples of the recorded design."""
    taps, found = result["filter"]["taps"], [whole(c["delay_samples"], 0) for c in result["corners"]]
    refuse_if(len(found) != len(problem.corners), "the result has not one delay a corner")
    other = any(c.delay not in (None, d) for c, d in zip(problem.corners, found))
    refuse_if(other, "a delay of the result is not the one the task gives")
    known = problem.given_filter or problem.order_min <= len(taps) - 1 <= problem.order_max
    refuse_if(not known, "the order of the result is outside the task's")
    # A corner at a part of the feed loses the rest for as long as both its steps take.
    lost = [2 * (len(taps) + len(problem.response.lo)) * (1 - number(c.get("feed_part", 1))) for c in result["corners"]]
    cost = problem.filter_cost * len(taps) + sum(c.weight * (d + x) for c, d, x in zip(problem.corners, found, lost))
    time = number(result["cycle_time_s" if problem.objective == "cycle" else "corner_time_s"]) / problem.period
    refuse_if(abs(time - cost) > cost * ROUNDING, "the time of the result is not that of its order and delays")
    return taps, found, cost


def target_of(result, problem, bound, proved):
    """Samples that no design takes less than, by result and certificate; None: there is no design."""
    if result["status"] == "infeasible":
        refuse_if(proved is not None, "the certificate proves a bound, not that nothing exists")
        return None
    target, (_, _, cost) = number(result[bound], bound) / problem.period, recorded(result, problem)
    refuse_if(target > cost * (1 + ROUNDING), "the lower bound is above the time of the result's design")
    if result["status"] == "optimal":
        refuse_if(target < cost * (1 - ROUNDING), "the status is optimal, but the lower bound is below that time")
        target = cost
    refuse_if(proved is None, "the certificate proves that nothing exists, the result has a design")
    refuse_if(number(proved) < target * (1 - ROUNDING), "the certificate proves less than the result claims")
    return number(proved)


def enumeration(result, problem, _):
    refuse_if(not problem.given_filter, "the certificate is about a given filter, the task leaves the filter open")
    refuse_if(result["status"] != "optimal", "that a given filter has no delays at all", NotCovered)
    slow = problem.corner_feeds or any("feed_part" in c for c in result["corners"])
    refuse_if(slow, "a proof about delays for a control that may pass corners at a part of the feed", NotCovered)
    taps, found, cost = recorded(result, problem)
    target_of(result, problem, "lower_bound_s", cost)
    tried = members.smallest_delays(problem, taps, found)
    return f"{tried} smaller delays of the recorded taps refuted (not checked: that these are the task's filter)"


def searched(problem, certificate, target):
    """Problem and target that the tree of a certificate is about."""
    return problem, target


def branch_and_bound(result, problem, certificate):
    refuse_if(problem.given_filter, "a proof over all filters for a task that gives one", NotCovered)
    refuse_if(problem.corner_feeds, "the certificate is about corners at their feeds, the control may pass them slower")
    refuse_if(certificate["objective"] != problem.objective, "the certificate is about another objective than the task")
    refuse_if(number(certificate.get("tolerance", WIDER - 1)) != WIDER - 1, "the certificate is about other limits")
    refuse_if(problem.objective == "cycle" and number(certificate["runs"]) != problem.runs, "it is about other runs")
    target = target_of(result, problem, "lower_bound_s", certificate["bound_samples"])
    subject, end = searched(problem, certificate, target)
    leaves = Tree(subject, certificate, end).leaves
    if target is None:
        return f"{leaves} parts refuted: no design of order {problem.order_max} or less keeps all limits"
    return f"{leaves} parts refuted: no {problem.objective} time is shorter than {float(target * problem.period):.9g} s"


def of_families(result, problem, certificate):
    refuse_if("family" not in result["task"].get("design", {}), "a certificate about families, the task names none")
    target = target_of(result, problem, "family_bound_s", certificate["bound_samples"])
    refuted = Counter(families.refute(problem, result["task"], target))
    families.compare(certificate["refuted"], refuted)
    least = "keeps all limits" if target is None else f"is shorter than {float(target * problem.period):.9g} s"
    words = f"{sum(refuted.values())} members refuted: no member {least}"
    if result.get("lower_bound_s") is None:
        return words
    problem.corner_feeds, taps = False, known(certificate["taps"], ["branch and bound"])
    return f"{words}; free taps: {branch_and_bound(dict(result, status='feasible'), problem, taps)}"


CHECKS = {"enumeration": enumeration, "branch and bound": branch_and_bound, "families": of_families}


def proved(result):
    refuse_if(result.get("certificate") is None and result["schema"] == "accdec.result/1", "there is no certificate")
    refuse_if(result["schema"] != "accdec.result/1" or result["status"] not in STATUSES, "schema or status", NotCovered)
    problem, certificate = problems.read(result["task"]), known(unpacked(result["certificate"]), CHECKS)
    return CHECKS[certificate["kind"]](result, problem, certificate)


def check_by_what_is_known(text):
    try:
        result = parse(text.removeprefix("\ufeff"))  # a byte order mark
        if result.get("settings") is not None and util.find_spec("more"):
            import_module("more")
        return proved(result)
    except (LookupError, TypeError, ValueError, AttributeError, ArithmeticError, RecursionError, zlib.error) as error:
        raise Refused(f"it cannot be read: {type(error).__name__}: {error}") from error


def check(text):
    """What is proved, in words. The folder `more` adds what no shipped proof uses, once something is not known."""
    try:
        return check_by_what_is_known(text)
    except NotCovered:
        if util.find_spec("more") is None:
            raise
    import_module("more")
    return check_by_what_is_known(text)
