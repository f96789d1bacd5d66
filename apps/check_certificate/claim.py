"""What a result claims, and the check of its certificate."""
import base64
import json
import math
import zlib
from decimal import Decimal

import contradictions
import delays
import families
import problem as problems
from problem import GRANTED, NotCovered, Refused, number, refuse_if, whole
from tree import ROUNDING, Tree

SCHEMA = "accdec.certificate/1"
CONTRADICTIONS = {"constant feed": contradictions.constant_feed, "corner speed": contradictions.corner_speed}
MOST_UNPACKED = 2 * 10**9  # bytes


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


def _unpacked(certificate):
    if certificate["kind"] != "packed":
        return certificate
    unpack = zlib.decompressobj(16 + zlib.MAX_WBITS)
    text = unpack.decompress(base64.b64decode(certificate["gzip"], validate=True), MOST_UNPACKED)
    refuse_if(not unpack.eof or unpack.unused_data, "the packed certificate is cut off or has something behind it")
    return parse(text.decode())


def _design(result, problem):
    """Taps, delays and cost in samples of the recorded design."""
    if any("feed_part" in c for c in result["corners"]):
        raise NotCovered("corners passed at a part of the feed")
    taps, found = result["filter"]["taps"], [whole(c["delay_samples"]) for c in result["corners"]]
    refuse_if(len(found) != len(problem.corners) or min(found) < 0, "the result has not one delay a corner")
    other = any(c.delay not in (None, d) for c, d in zip(problem.corners, found))
    refuse_if(other, "a delay of the result is not the one the task gives")
    known = problem.given_filter or problem.order_min <= len(taps) - 1 <= problem.order_max
    refuse_if(not known, "the order of the result is outside the task's")
    cost = problem.filter_cost * len(taps) + sum(c.weight * d for c, d in zip(problem.corners, found))
    recorded = result["cycle_time_s" if problem.objective == "cycle" else "corner_time_s"]
    wrong = abs(number(recorded) / problem.period - cost) > cost * ROUNDING
    refuse_if(wrong, "the time of the result is not that of its order and delays")
    return taps, found, cost


def _claimed(result, problem, certificate):
    """Samples that no design is shorter than, as a result and its certificate say; None: there is no design."""
    refuse_if(certificate["objective"] != problem.objective, "the certificate is about another objective than the task")
    runs = number(certificate["runs"]) if problem.objective == "cycle" else problem.runs
    refuse_if(runs != problem.runs, "the certificate is about another number of runs than the task")
    refuse_if(number(certificate.get("tolerance", GRANTED)) != GRANTED, "the certificate is about other limits")
    proved = certificate["bound_samples"]
    if result["status"] == "infeasible":
        refuse_if(proved is not None, "the certificate proves a bound, not that nothing exists")
        return None
    target, (_, _, cost) = number(result["lower_bound_s"]) / problem.period, _design(result, problem)
    refuse_if(target > cost * (1 + ROUNDING), "the lower bound is above the time of the result's design")
    if result["status"] == "optimal":
        refuse_if(target < cost * (1 - ROUNDING), "the status is optimal, but the lower bound is below that time")
        target = cost
    if proved is None:
        return target
    refuse_if(number(proved) < target * (1 - ROUNDING), "the certificate proves less than the result claims")
    return number(proved)


def _enumeration(result, problem):
    refuse_if(not problem.given_filter, "the certificate is about a given filter, the task leaves the filter open")
    if result["status"] != "optimal":
        raise NotCovered("that a given filter has no delays at all")
    taps, found, cost = _design(result, problem)
    other = abs(number(result["lower_bound_s"]) / problem.period - cost) > cost * ROUNDING
    refuse_if(other, "the status is optimal, but the lower bound is not the time of the result's design")
    tried = delays.smallest(problem, taps, found)
    return f"{tried} smaller delays of the recorded taps refuted (not checked: that these are the task's filter)"


def _branch_and_bound(result, problem, certificate):
    if problem.given_filter:
        raise NotCovered("a proof over all filters for a task that gives one")
    target = _claimed(result, problem, certificate)
    if certificate.get("corner_of"):
        problem = problems.merge(problem, certificate["corner_of"])
    leaves = Tree(problem, certificate, target).leaves
    if target is None:
        return f"{leaves} parts refuted: no design of order {problem.order_max} or less keeps all limits"
    return f"{leaves} parts refuted: no {problem.objective} time is shorter than {float(target * problem.period):.9g} s"


def _families(result, problem, certificate):
    named = "family" in result["task"].get("design", {})
    refuse_if(not named, "the certificate is about families, the task names none")
    target, words = None, "no member keeps all limits"
    if result["status"] == "infeasible":
        refuse_if(certificate["bound_samples"] is not None, "the certificate proves a bound, not that nothing exists")
    else:
        target, (_, _, cost) = number(result["family_bound_s"]) / problem.period, _design(result, problem)
        refuse_if(target > cost * (1 + ROUNDING), "the family's bound is above the time of the result's design")
        if result["status"] == "optimal":
            below = target < cost * (1 - ROUNDING)
            refuse_if(below, "the status is optimal, but the family's bound is below that time")
            target = cost
        less = number(certificate["bound_samples"]) < target * (1 - ROUNDING)
        refuse_if(less, "the certificate proves less than the result claims")
        words = f"no member is shorter than {float(target * problem.period):.9g} s"
    refuted = families.refute(problem, result["task"], target)
    counted = sum(whole(members) for _, _, members in certificate["refuted"])
    refuse_if(counted != refuted, f"the certificate counts {counted} members, there are {refuted}")
    if result.get("lower_bound_s") is None:
        return f"{refuted} members refuted: {words}"
    taps = _branch_and_bound(dict(result, status="feasible"), problem, certificate["taps"])
    return f"{refuted} members refuted: {words}; free taps: {taps}"


def _check(result):
    refuse_if(result.get("certificate") is None, "there is no certificate")
    if result["status"] not in ("optimal", "feasible", "infeasible"):
        raise NotCovered(f"the status {result['status']!r}")
    problem, certificate = problems.read(result["task"]), _unpacked(result["certificate"])
    if certificate["kind"] == "enumeration":
        return _enumeration(result, problem)
    if certificate["schema"] != SCHEMA:
        raise NotCovered(f"the schema {certificate['schema']!r}")
    if certificate["kind"] == "branch and bound":
        return _branch_and_bound(result, problem, certificate)
    if certificate["kind"] == "families":
        return _families(result, problem, certificate)
    if certificate["kind"] not in CONTRADICTIONS:
        raise NotCovered(f"a certificate of the kind {certificate['kind']!r}")
    refuse_if(result["status"] != "infeasible", "the certificate is one of infeasibility, the status is not")
    return CONTRADICTIONS[certificate["kind"]](problem)


def check(text):
    """What is proved, in words. @raise Refused"""
    try:
        return _check(parse(text))
    except RecursionError as error:
        raise Refused("it is nested too deeply") from error
    except (LookupError, TypeError, ValueError, AttributeError, ArithmeticError, zlib.error) as error:
        raise Refused(f"it cannot be read: {type(error).__name__}: {error}") from error
