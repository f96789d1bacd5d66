"""Axes that respond differently, in proofs about constant feed: there their servos matter to contours alone."""
import claim
import problem as problems
from enclosure import NotCovered, exact, number, refuse_if
from more import contradictions
from more.widening import widens
from problem import SERVO

KEYS = {*SERVO, "response_taps"}


def lag(table, period):
    """Time by which an axis is behind a command of constant speed, s."""
    if "response_taps" in table:
        taps = [number(tap) for tap in table["response_taps"]]
        refuse_if(not abs(sum(taps) - 1) < 1e-6, "a response has a wrong sum")
        return period * sum(i * tap for i, tap in enumerate(taps)) / sum(taps)
    if "servo_gain_1_s" not in table:
        return 0
    gain, fed = (number(table.get(key, 0)) for key in SERVO)
    refuse_if(gain <= 0 or not 0 <= fed <= 1, "a servo's gain or feedforward is out of range")
    return (1 - fed) / gain


def leaves_line(lags, speeds, most):
    """Whether the place behind the command surely is farther than this from the line. Its part along it is off."""
    behind, feed2 = [x * exact(late) for x, late in zip(speeds, lags)], sum(x * x for x in speeds)
    along = sum(x * b for x, b in zip(speeds, behind)) / feed2
    off = [b - x * along for x, b in zip(speeds, behind)]
    return sum(x * x for x in off).lo > (exact(most) * exact(most)).hi


@widens(claim, "proved")
def proved(narrow, result):
    """Each axis runs at its feed whatever its servo, so that all other limits are those without servos."""
    try:
        return narrow(result)
    except NotCovered:
        tables = result["task"]["axis"]
        if (result.get("certificate") or {}).get("kind") != "constant feed":
            raise
        plain = [{key: x for key, x in table.items() if key not in KEYS} for table in tables]
        checked = dict(result, task=dict(result["task"], axis=plain))
        period = number(result["task"]["sample_period_ms"]) / 1000
        lags, subject = [lag(table, period) for table in tables], problems.read(checked["task"])
        for corner in subject.corners:
            if corner.contour is not None and any(leaves_line(lags, leg, corner.contour)
                                                  for leg in (corner.speed_in, corner.speed_out)):
                claim.known(result["certificate"], ["constant feed"])
                contradictions.refuse_unless_infeasible(result)
                return f"corner {corner.name}: the servos leave the line of a leg at constant feed"
        return narrow(checked)
