"""What a result claims, and the check of its certificate."""
import base64
import json
import math
import zlib
from decimal import Decimal

import problem as problems
from enclosure import NotCovered, Refused, number, refuse_if, whole
from filters import contradictions, families, members
from problem import ROUNDING, WIDER
from tree import Tree


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
    text = unpack.decompress(base64.b64decode(certificate["gzip"], validate=True), 2 * 10**9)
    refuse_if(not unpack.eof or unpack.unused_data, "the packed certificate is cut off or has something behind it")
    return parse(text.decode())


def _design(result, problem):
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
    recorded = result["cycle_time_s" if problem.objective == "cycle" else "corner_time_s"]
    wrong = abs(number(recorded) / problem.period - cost) > cost * ROUNDING
    refuse_if(wrong, "the time of the result is not that of its order and delays")
    return taps, found, cost


def _target(result, problem, bound, proved):
    """Samples that no design takes less than, by result and certificate; None: there is no design."""
    if result["status"] == "infeasible":
        refuse_if(proved is not None, "the certificate proves a bound, not that nothing exists")
        return None
    target, (_, _, cost) = number(result[bound]) / problem.period, _design(result, problem)
    refuse_if(target > cost * (1 + ROUNDING), "the lower bound is above the time of the result's design")
    if result["status"] == "optimal":
        refuse_if(target < cost * (1 - ROUNDING), "the status is optimal, but the lower bound is below that time")
        target = cost
    if proved is None:
        return target
    refuse_if(number(proved) < target * (1 - ROUNDING), "the certificate proves less than the result claims")
    return number(proved)


def _enumeration(result, problem, _):
    refuse_if(not problem.given_filter, "the certificate is about a given filter, the task leaves the filter open")
    slow = any("feed_part" in c for c in result["corners"])
    reason = "that a given filter has no delays at all, or passes corners at a part of the feed"
    refuse_if(slow or result["status"] != "optimal", reason, NotCovered)
    taps, found, _ = _design(result, problem)
    _target(result, problem, "lower_bound_s", None)
    tried = members.smallest_delays(problem, taps, found)
    return f"{tried} smaller delays of the recorded taps refuted (not checked: that these are the task's filter)"


def _branch_and_bound(result, problem, certificate):
    refuse_if(problem.given_filter, "a proof over all filters for a task that gives one", NotCovered)
    asked = [certificate["objective"], number(certificate.get("tolerance", WIDER - 1))]
    asked += [number(certificate["runs"])] if problem.objective == "cycle" else []
    for got, known, what in zip(asked, (problem.objective, WIDER - 1, problem.runs), ("objective", "limits", "runs")):
        refuse_if(got != known, f"the certificate is about other {what} than the task")
    target = _target(result, problem, "lower_bound_s", certificate["bound_samples"])
    searched, more = problems.together(problem) if certificate.get("smoothed") else (problem, 0)
    end = None if target is None else target + more
    if certificate.get("corner_of"):
        searched = problems.merge(searched, certificate["corner_of"])
    leaves = Tree(searched, certificate, end).leaves
    if target is None:
        return f"{leaves} parts refuted: no design of order {problem.order_max} or less keeps all limits"
    return f"{leaves} parts refuted: no {problem.objective} time is shorter than {float(target * problem.period):.9g} s"


def _families(result, problem, certificate):
    refuse_if("family" not in result["task"].get("design", {}), "a certificate about families, the task names none")
    target = _target(result, problem, "family_bound_s", certificate["bound_samples"])
    refuted = families.refute(problem, result["task"], target)
    counted = sum(whole(members) for _, _, members in certificate["refuted"])
    refuse_if(counted != refuted, f"the certificate counts {counted} members, there are {refuted}")
    least = "keeps all limits" if target is None else f"is shorter than {float(target * problem.period):.9g} s"
    words = f"{refuted} members refuted: no member {least}"
    if result.get("lower_bound_s") is None:
        return words
    return f"{words}; free taps: {_branch_and_bound(dict(result, status='feasible'), problem, certificate['taps'])}"


def _contradiction(result, problem, certificate):
    refuse_if(result["status"] != "infeasible", "the certificate is one of infeasibility, the status is not")
    return getattr(contradictions, certificate["kind"].replace(" ", "_"))(problem)


CHECKS = {"enumeration": _enumeration, "branch and bound": _branch_and_bound, "families": _families,
          "constant feed": _contradiction, "corner speed": _contradiction}


def check(text):
    """What is proved, in words. @raise Refused"""
    try:
        result = parse(text)
        refuse_if(result.get("certificate") is None, "there is no certificate")
        known = result["status"] in ("optimal", "feasible", "infeasible")
        refuse_if(not known, f"the status {result['status']!r}", NotCovered)
        problem, certificate = problems.read(result["task"]), _unpacked(result["certificate"])
        kind, schema = certificate["kind"], certificate.get("schema")
        known = kind in CHECKS and (kind == "enumeration" or schema == "accdec.certificate/1")
        refuse_if(not known, f"a certificate of the kind {kind!r} and schema {schema!r}", NotCovered)
        return CHECKS[kind](result, problem, certificate)
    except RecursionError as error:
        raise Refused("it is nested too deeply") from error
    except (LookupError, TypeError, ValueError, AttributeError, ArithmeticError, zlib.error) as error:
        raise Refused(f"it cannot be read: {type(error).__name__}: {error}") from error
