"""Force-speed curves of axes: |F| + slope |v| <= bound for each line of the curve, and no speed beyond the last."""
from enclosure import ZERO, exact
from refusals import number, refuse_if, whole


def lines(points, wider, standing):
    """Slopes and bounds, and the last speed, in SI. What verification grants scales the curve from its origin.
    standing: N, the force of a sample that counts as standing."""
    if points is None:
        return (), None
    points = [(number(v) / 1000, number(f)) for v, f in points]
    first = points[0][1]
    refuse_if(first <= 0 or min(points)[0] < 0, "a force-speed curve is out of range")
    scale, found = wider + standing / first, [(0, first)]
    for (v, f), (w, g) in zip(points, points[1:]):
        refuse_if(w <= v, "the speeds of a force-speed curve do not rise")
        found.append(((f - g) / (w - v), f + (f - g) / (w - v) * v))
    slopes = [slope for slope, _ in found[1:]]
    refuse_if(min([0, *slopes]) < 0, "the forces of a force-speed curve rise")
    return tuple((slope, bound * scale) for slope, bound in found), points[-1][0] * scale


def line(axis, i):
    refuse_if(not 0 <= whole(i) < len(axis.lines), "a multiplier names a line that no force-speed curve has")
    return [exact(x) for x in axis.lines[i]]


def breaks(axis, speed, force):
    """Whether a force at a speed, both not below zero, is surely above the curve."""
    beyond = axis.last_speed is not None and speed.lo > exact(axis.last_speed).hi
    return beyond or any((force + exact(s) * speed - exact(most)).lo > 0 if s else force.lo > exact(most).hi
                         for s, most in axis.lines)


def force_of(axis, i, limit):
    """Slope and bound: of a line, or of the largest force."""
    return line(axis, i) if i is not None else (ZERO, limit(axis, "force"))
