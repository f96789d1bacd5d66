"""Why proofs are not accepted, and numbers of a file that are what they should be."""
from fractions import Fraction


class Refused(Exception):
    """Why a proof is not accepted."""


class NotCovered(Refused):
    """The proof may hold, but it is of a kind that this checker does not know."""


def refuse_if(condition, reason):
    if condition:
        raise Refused(reason)


def number(x):
    """A number of a JSON file, exactly as written."""
    refuse_if(isinstance(x, (bool, str)) or not hasattr(x, "__le__"), f"{x!r} stands where a number should")
    return Fraction(x)


def whole(x):
    known = isinstance(x, int) and not isinstance(x, bool) and abs(x) <= 10**8
    refuse_if(not known, f"{x!r} stands where a whole number up to 10^8 should")
    return x
