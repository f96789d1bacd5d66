"""Rows for limits that are not convex: power, regeneration and smallest speed, each by a chord over the speeds or
directions that are left in a part of the search."""
from fractions import Fraction

from enclosure import ONE, PI, UNIT, ZERO, Enclosure, cos_sin, exact
from problem import NotCovered, number, refuse_if, whole


def _ends(low, high):
    refuse_if(not number(low) < number(high), "a chord's ends are not low < high")
    return number(low), number(high)


def _power(rows, row, box, axis, regeneration, into, out, d, k, low, high):
    """F <= P (1/l + 1/u - V/(l u)), times l/P, for speeds V in [l, u]: the hyperbola P/V lies below its chord there;
    for V < l the chord is above P/l, which must then be more than the force can be. V = in (1 - B_k) + out B_{k-d}."""
    if axis.coulomb > 0:
        raise NotCovered("a chord of power or regeneration with dry friction")
    bound, (low, high) = Fraction(rows.limit(axis, regeneration).hi, ONE), _ends(low, high)
    refuse_if(low <= 0, "a chord begins at no positive speed")
    bounds = rows.bounds(box)
    speeds = into * (UNIT - Enclosure(*bounds.at(k))) + out * Enclosure(*bounds.at(k - d))
    # Leg 1 has lost what leg 2 has gained: the speed is between 0 and those of the legs.
    beyond = min(speeds.hi, max(into.hi, out.hi, 0)) > exact(high).lo
    refuse_if(beyond, "a chord ends below speeds that are left in its part")
    if exact(low).hi > speeds.lo:
        top = Fraction(max(into.magnitude().hi, out.magnitude().hi), ONE)
        caps = [axis.limits["force"]] if "force" in axis.limits else []
        if "acceleration" in axis.limits:
            caps.append(axis.mass * axis.limits["acceleration"] + axis.damping * top)
        refuse_if(not caps or low * min(caps) > bound, "a chord begins above speeds that are left in its part")
    inertia, force = axis.mass / rows.problem.period, (-low if regeneration == "regeneration" else low) / bound
    for at, c in ((k, exact(force * (inertia + axis.damping) + 1 / high)), (k - 1, exact(-force * inertia))):
        row.limit(-(c * into))  # c V_at
        row.response(at, -(c * into))
        row.response(at - d, c * out)
    row.limit(exact(1 + low / high))


def event_power(rows, row, box, stop, a, k, low, high):
    """Power at the start, regeneration at the stop."""
    axis, speed = rows.axis(a), (rows.stop if stop else rows.start)[a]
    refuse_if(speed.is_zero(), "a multiplier names an axis that stands still")
    if not 1 <= whole(k) <= box.order + 1:
        return
    legs, kind = ((speed, ZERO), "regeneration") if stop else ((ZERO, speed), "power")
    _power(rows, row, box, axis, kind, *legs, 0, k, low, high)


def blend_power(rows, row, box, kind, j, a, k, sign, low, high):
    d, axis, corner = rows.single_delay(j, box), rows.axis(a), rows.corner(j)
    if not 1 <= whole(k) <= box.order + d + 1:
        return
    into, out = (leg[a].times(-1 if whole(sign) < 0 else 1) for leg in (corner.speed_in, corner.speed_out))
    _power(rows, row, box, axis, kind, into, out, d, k, low, high)


def speed(rows, row, box, j, k, low, high):
    """|V| >= v_min with V between the directions low and high: n V >= v_min cos((high - low)/2), n half way. In the
    plane of motion V = v1 (1 - B_k) (1, 0) + v2 B_{k-d} (-cos theta, sin theta)."""
    corner, (low, high) = rows.corner(j), _ends(low, high)
    d1, d2, _, _ = box.corners[j]
    least = corner.speed_min
    refuse_if(least <= 0, "a multiplier names a smallest speed that is not there")
    refuse_if(exact(high - low).hi >= PI.lo, "a sector is half a turn or more")
    if not 1 <= whole(k) <= box.order + d1:
        return
    bounds = rows.bounds(box)
    into = exact(corner.feed_in) * (UNIT - Enclosure(*bounds.at(k)))
    out = exact(corner.feed_out) * Enclosure(bounds.at(k - d2)[0], bounds.at(k - d1)[1])

    def left_of(angle):
        """How far V is to the left of a direction."""
        ca, sa = cos_sin(exact(angle))
        return (corner.sine * ca + corner.cosine * sa) * out - sa * into

    # Outside by so little is allowed and paid for; not behind, where a narrow sector has both edges beside it, too.
    outside = max(corner.feed_in, corner.feed_out) / 10**12
    of_in, sa = cos_sin(exact((low + high) / 2))
    of_out = corner.sine * sa - corner.cosine * of_in
    front = of_in * into + of_out * out
    beside = min(left_of(low).lo, -left_of(high).hi, front.lo) < -exact(outside).lo
    refuse_if(beside, "a sector does not hold all directions that are left in its part")
    refuse_if(d1 != d2 and of_out.lo < 0, "a sector is used for several delays, but does not hold for all")
    of_in, of_out = of_in * exact(corner.feed_in / least), of_out * exact(corner.feed_out / least)
    half, _ = cos_sin(exact((high - low) / 2))
    # half - n V/v_min <= 0; of several delays the least has the most of leg 2
    row.response(k, of_in)
    row.response(k - d1, -of_out)
    row.limit(of_in - half + exact(2 * outside / least))
