"""Enclosures: numbers, or lists of them, each between two whole multiples of 2^-BITS. Why proofs are not accepted."""
from fractions import Fraction
from itertools import accumulate, repeat
from math import isqrt
from operator import add, neg

BITS, GUARD = 160, 64
ONE = 1 << BITS


class Refused(Exception):
    """Why a proof is not accepted."""


class NotCovered(Refused):
    """The proof may hold, but it is of a kind that this checker does not know."""


def refuse_if(condition, reason, kind=Refused):
    if condition:
        raise kind(reason)


def number(x, what="a number"):
    """A number of a JSON file, exactly as written."""
    refuse_if(isinstance(x, bool) or not hasattr(x, "__round__"), f"{x!r} stands where {what} should")
    return Fraction(x)


def whole(x, least=-(10**8), most=10**8):
    known = isinstance(x, int) and not isinstance(x, bool) and least <= x <= most
    refuse_if(not known, f"{x!r} stands where a whole number from {least} to {most} should")
    return x


def each(f, *xs):
    """f of whole numbers; if some of them are lists, of their items beside the single ones."""
    if list not in map(type, xs):
        return f(*xs)
    return list(map(f, *(x if type(x) is list else repeat(x) for x in xs)))


def _least(a, b, c, d):
    return (a * c if a >= 0 and c >= 0 else min(a * c, a * d, b * c, b * d)) >> BITS


def _largest(a, b, c, d):
    return -(-(b * d if a >= 0 and c >= 0 else max(a * c, a * d, b * c, b * d)) >> BITS)


class Enclosure:
    """A number x with lo <= x 2^BITS <= hi, or a list of such. a > b: a is surely above b, somewhere in lists."""

    __slots__ = ("lo", "hi")

    def __init__(self, lo, hi=None):
        self.lo, self.hi = lo, lo if hi is None else hi

    def __add__(self, other):
        other = exact(other)
        return Enclosure(each(add, self.lo, other.lo), each(add, self.hi, other.hi))

    __radd__ = __add__

    def __neg__(self):
        return Enclosure(each(neg, self.hi), each(neg, self.lo))

    def __sub__(self, other):
        return self + -exact(other)

    def __rsub__(self, other):
        return -self + other

    def __mul__(self, other):
        ends = self.lo, self.hi, (other := exact(other)).lo, other.hi
        return Enclosure(each(_least, *ends), each(_largest, *ends))

    __rmul__ = __mul__

    def __truediv__(self, other):
        """By one number, which is above zero."""
        other = exact(other)
        refuse_if(other.lo <= 0, "something is divided by what may be zero")
        return self * Enclosure(ONE * ONE // other.hi, -(-ONE * ONE // other.lo))

    def __rtruediv__(self, other):
        return exact(other) / self

    def __abs__(self):
        return Enclosure(each(lambda a, b: max(a, -b, 0), self.lo, self.hi),
                         each(lambda a, b: max(-a, b), self.lo, self.hi))

    def __gt__(self, other):
        above = each(int.__gt__, self.lo, exact(other).hi)
        return any(above) if type(above) is list else above

    def __getitem__(self, at):
        return Enclosure(self.lo[at], self.hi[at])

    def then(self, other):
        return Enclosure(self.lo + other.lo, self.hi + other.hi)

    def sums(self):
        """Of the first items, from none on."""
        return Enclosure(*([*accumulate(end, initial=0)] for end in (self.lo, self.hi)))

    def total(self):
        return Enclosure(sum(self.lo), sum(self.hi))

    def positive(self):
        """The part that is not negative."""
        return Enclosure(max(self.lo, 0), max(self.hi, 0))


def exact(x):
    """Of a rational number, or of what is enclosed already, or of a list of both."""
    if type(x) is Enclosure:
        return x
    if type(x) is int:
        return Enclosure(x << BITS)
    if type(x) is list:
        return Enclosure([exact(y).lo for y in x], [exact(y).hi for y in x])
    x = Fraction(x)
    return Enclosure((x.numerator << BITS) // x.denominator, -((-x.numerator << BITS) // x.denominator))


def square_root(x):
    """Of the part of x that is not negative."""
    return Enclosure(isqrt(max(x.lo, 0) << BITS), isqrt(max(x.hi, 0) << BITS) + 1)


def turned(fall, angle):
    """Real and imaginary part of exp(-fall + i angle), fall >= 0. The series of a part of it, then squared. Neither
    changes by more than its argument; rounding stays far below the last unit, as GUARD bits more are kept."""
    fall, angle = exact(fall), exact(angle)
    refuse_if(fall.lo < 0, "an exponent is above zero")
    halved = max(0, max(fall.lo, abs(angle.lo)).bit_length() - BITS + 2)
    refuse_if(halved > GUARD // 2, "an angle or an exponent is too large")
    unit = BITS + GUARD
    x, y = ((z << GUARD) >> halved for z in (-fall.lo, angle.lo))
    a, b, real, imaginary = 1 << unit, 0, 1 << unit, 0
    for k in range(1, 50):
        a, b = (a * x - b * y >> unit) // k, (a * y + b * x >> unit) // k
        real, imaginary = real + a, imaginary + b
    for _ in range(halved):
        real, imaginary = real * real - imaginary * imaginary >> unit, 2 * real * imaginary >> unit
    reach = fall.hi - fall.lo + angle.hi - angle.lo + 2
    return tuple(Enclosure(max((z >> GUARD) - reach, -ONE), min((z >> GUARD) + reach, ONE)) for z in (real, imaginary))


def exponential(x):
    """Of a number not above zero."""
    return turned(-exact(x), 0)[0].positive()


DIGITS = 3141592653589793238462643383279502884197169399375105820974944  # of pi
PI = Enclosure(DIGITS * ONE // 10**60, (DIGITS + 1) * ONE // 10**60 + 1)


def cos_sin_degrees(degrees):
    """Of a rational number of degrees, exact at quarter turns."""
    degrees = Fraction(degrees) % 360
    if degrees % 90 == 0:
        quarter = int(degrees // 90)
        return exact((1, 0, -1, 0)[quarter]), exact((0, 1, 0, -1)[quarter])
    return turned(0, exact(degrees) * PI / 180)
