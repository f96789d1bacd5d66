"""Enclosures: pairs of rationals of denominator 2^BITS with a number between them, in whole numbers and rounded
outwards. No floating point takes part. Also why proofs are not accepted, and numbers of a file."""
from fractions import Fraction
from math import isqrt

BITS = 160
ONE = 1 << BITS


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


def whole(x, least=-(10**8), most=10**8):
    known = isinstance(x, int) and not isinstance(x, bool) and least <= x <= most
    refuse_if(not known, f"{x!r} stands where a whole number from {least} to {most} should")
    return x


class Enclosure:
    """A number x with lo <= x 2^BITS <= hi. a > b: a is surely above b."""

    __slots__ = ("lo", "hi")

    def __init__(self, lo, hi=None):
        self.lo, self.hi = lo, lo if hi is None else hi

    def __add__(self, other):
        other = exact(other)
        return Enclosure(self.lo + other.lo, self.hi + other.hi)

    __radd__ = __add__

    def __neg__(self):
        return Enclosure(-self.hi, -self.lo)

    def __sub__(self, other):
        other = exact(other)
        return Enclosure(self.lo - other.hi, self.hi - other.lo)

    def __rsub__(self, other):
        return exact(other) - self

    def __mul__(self, other):
        other = exact(other)
        if self.lo >= 0 and other.lo >= 0:
            return Enclosure(self.lo * other.lo >> BITS, -(-self.hi * other.hi >> BITS))
        ends = (self.lo * other.lo, self.lo * other.hi, self.hi * other.lo, self.hi * other.hi)
        return Enclosure(min(ends) >> BITS, -(-max(ends) >> BITS))

    __rmul__ = __mul__

    def __truediv__(self, other):
        """By what is above zero."""
        other = exact(other)
        refuse_if(other.lo <= 0, "something is divided by what may be zero")
        low = (self.lo << BITS) // (other.hi if self.lo >= 0 else other.lo)
        return Enclosure(low, -((-self.hi << BITS) // (other.lo if self.hi >= 0 else other.hi)))

    def __rtruediv__(self, other):
        return exact(other) / self

    def __gt__(self, other):
        return self.lo > exact(other).hi

    def __lt__(self, other):
        return self.hi < exact(other).lo

    def __abs__(self):
        return self if self.lo >= 0 else -self if self.hi <= 0 else Enclosure(0, max(-self.lo, self.hi))


def exact(x):
    """Of a rational number, or of what is enclosed already."""
    if x.__class__ is Enclosure:
        return x
    if x.__class__ is int:
        return Enclosure(x << BITS)
    x = Fraction(x)
    return Enclosure((x.numerator << BITS) // x.denominator, -((-x.numerator << BITS) // x.denominator))


def square_root(x):
    """Of the part of x that is not negative."""
    return Enclosure(isqrt(max(x.lo, 0) << BITS), isqrt(max(x.hi, 0) << BITS) + 1)


def exponential(x):
    """Of a number not above zero. A series of falling terms with changing signs, then squared."""
    x = exact(x)
    refuse_if(x.hi > 0, "an exponent is above zero")
    halved = max(0, (-x.lo).bit_length() - BITS)
    term = value = exact(1)
    for k in range(1, 60):
        term = term * -x / (k << halved)
        value = value - term if k % 2 else value + term
    value += Enclosure(-term.hi, term.hi)
    for _ in range(halved):
        value *= value
    return value


DIGITS = 3141592653589793238462643383279502884197169399375105820974944  # of pi
PI = Enclosure(DIGITS * ONE // 10**60, (DIGITS + 1) * ONE // 10**60 + 1)
SERIES = 1 << 12  # units: the series below have at most 60 terms, none above 7, each rounded by at most two units


def cos_sin(angle):
    """Cosine and sine of an angle, rad."""
    angle = exact(angle)
    turns = (angle.lo + PI.lo) // (2 * PI.lo)
    angle -= PI * (2 * turns)
    middle = (angle.lo + angle.hi) // 2
    refuse_if(abs(middle) > 33 * ONE // 10, "an angle is too large")
    term, k, cosine, sine = ONE, 0, 0, 0
    while abs(term) > 1:  # of the cosine; times x/(k + 1) that of the sine
        cosine, sine = cosine + term, sine + (term * middle >> BITS) // (k + 1)
        k += 2
        term = -((term * middle >> BITS) * middle >> BITS) // (k * (k - 1))
    reach = angle.hi - angle.lo + SERIES  # neither is steeper than 1
    return tuple(Enclosure(max(s - reach, -ONE), min(s + reach, ONE)) for s in (cosine, sine))


def cos_sin_degrees(degrees):
    """The same of a rational number of degrees, exact at quarter turns."""
    degrees = Fraction(degrees) % 360
    if degrees % 90 == 0:
        quarter = int(degrees // 90)
        return exact((1, 0, -1, 0)[quarter]), exact((0, 1, 0, -1)[quarter])
    return cos_sin(exact(degrees) * PI / 180)
