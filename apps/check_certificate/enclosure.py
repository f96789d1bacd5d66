"""Enclosures: pairs of rationals of denominator 2^BITS with a number between them, in whole numbers and rounded
outwards. No floating point takes part."""
from fractions import Fraction
from math import isqrt

BITS = 160
ONE = 1 << BITS


def up(a, b):
    """a/b rounded up, b > 0."""
    return -(-a // b)


class Enclosure:
    """A number x with lo <= x 2^BITS <= hi."""

    __slots__ = ("lo", "hi")

    def __init__(self, lo, hi=None):
        self.lo, self.hi = lo, lo if hi is None else hi

    def __add__(self, other):
        return Enclosure(self.lo + other.lo, self.hi + other.hi)

    def __sub__(self, other):
        return Enclosure(self.lo - other.hi, self.hi - other.lo)

    def __neg__(self):
        return Enclosure(-self.hi, -self.lo)

    def __mul__(self, other):
        ends = (self.lo * other.lo, self.lo * other.hi, self.hi * other.lo, self.hi * other.hi)
        return Enclosure(min(ends) >> BITS, -(-max(ends) >> BITS))

    def __truediv__(self, other):
        """By what is above zero."""
        if other.lo <= 0:
            raise ZeroDivisionError("division by what may be zero")
        low = (self.lo << BITS) // (other.hi if self.lo >= 0 else other.lo)
        return Enclosure(low, up(self.hi << BITS, other.lo if self.hi >= 0 else other.hi))

    def times(self, whole):
        """By a whole number, exactly."""
        return Enclosure(*sorted((self.lo * whole, self.hi * whole)))

    def magnitude(self):
        if self.lo >= 0:
            return self
        return -self if self.hi <= 0 else Enclosure(0, max(-self.lo, self.hi))

    def is_zero(self):
        return self.lo == self.hi == 0


def exact(x):
    """Of a rational number."""
    x = Fraction(x)
    return Enclosure((x.numerator << BITS) // x.denominator, up(x.numerator << BITS, x.denominator))


ZERO, UNIT = Enclosure(0), Enclosure(ONE)


def square_root(x):
    """Of the part of x that is not negative."""
    return Enclosure(isqrt(max(x.lo, 0) << BITS), isqrt(max(x.hi, 0) << BITS) + 1)


def exponential(x):
    """Of an enclosed number, not above zero. A series of falling terms with changing signs, then squared."""
    if x.hi > 0:
        raise ValueError("an exponent is above zero")
    halved = 0
    while -x.lo >> halved >= ONE:
        halved += 1
    part = Enclosure((-x.hi) >> halved, up(-x.lo, 1 << halved))  # from 0 to 1
    term, value, k = UNIT, UNIT, 0
    while term.hi > 1:
        k += 1
        term = term * part
        term = Enclosure(term.lo // k, up(term.hi, k))
        value = value - term if k % 2 else value + term
    value = Enclosure(value.lo - term.hi, value.hi + term.hi)
    for _ in range(halved):
        value = value * value
    return value


def _inverse_tangent(n, bits):
    """atan(1/n) in units of 2^-bits, to within one a term."""
    power = total = (1 << bits) // n
    k = 1
    while power:
        power, k = power // (n * n), k + 2
        total += (-1) ** (k // 2) * (power // k)
    return total


def _pi():
    guard = 16  # bits: the series have fewer than 2^8 terms, their factors add up to 20
    x = 16 * _inverse_tangent(5, BITS + guard) - 4 * _inverse_tangent(239, BITS + guard)
    return Enclosure((x >> guard) - 1, (x >> guard) + 2)


PI = _pi()
SERIES = 1 << 12  # units: the series below have at most 60 terms, none above 7, each rounded by at most two units


def cos_sin(angle):
    """Cosine and sine of an enclosed angle, rad."""
    turns = (angle.lo + PI.lo) // (2 * PI.lo)
    angle = angle - PI.times(2 * turns)
    middle = (angle.lo + angle.hi) // 2
    if abs(middle) > 33 * ONE // 10:
        raise ValueError("an angle is too large")
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
        return Enclosure((ONE, 0, -ONE, 0)[quarter]), Enclosure((0, ONE, 0, -ONE)[quarter])
    return cos_sin(exact(degrees) * PI / exact(180))
