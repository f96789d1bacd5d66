"""The response of the servo that all axes have."""
from fractions import Fraction

from enclosure import UNIT, exact, exponential
from refusals import NotCovered, number, refuse_if

KEYS = ("servo_gain_1_s", "velocity_feedforward", "response_taps")
REST = Fraction(1, 10**12)  # a servo's response ends where less is left, which its last tap takes
LONGEST = 50000  # taps of a response


def response(tables, period):
    """Taps of the servo that all axes have; [1] without one. A position control of gain Kv leaves c a^k of a step after
    k samples, c = (1 - g)(1 - a)/(Kv T), a = exp(-Kv T)."""
    servos = [[table.get(key) for key in KEYS] for table in tables]
    if any(servo != servos[0] for servo in servos):
        raise NotCovered("axes that respond differently")
    gain, feedforward, taps = servos[0] if servos else (None, None, None)
    if taps is not None:
        taps = [number(tap) for tap in taps]
        refuse_if(not taps or min(taps) < 0 or abs(sum(taps) - 1) > Fraction(1, 10**6), "a response has a wrong tap")
        return [exact(tap / sum(taps)) for tap in taps]
    if gain is None:
        return [UNIT]
    fed = number(feedforward or 0)
    refuse_if(number(gain) <= 0 or not 0 <= fed <= 1, "a servo's gain or feedforward is out of range")
    x = exact(number(gain) * period)
    left_by_each = exponential(-x)
    missing = exact(1 - fed) * (UNIT - left_by_each) / x
    taps = [UNIT - missing]
    while missing.hi >= exact(REST).lo:
        refuse_if(len(taps) > LONGEST, "a servo's response does not end")
        after = missing * left_by_each
        taps.append(missing - after)
        missing = after
    return taps[:-1] + [taps[-1] + missing]
