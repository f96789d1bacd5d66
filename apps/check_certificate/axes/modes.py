"""Rows of modes. What a mode of an axis is left with in metres is a bound on the residual of the filter. Both legs of a
blend excite the mode through the same filter, the first one d samples earlier. So the amplitude is the filter's residual
times |v2 - v1 exp(-(z w + j wd) d T)|/wd, wd = w sqrt(1 - z^2). A start or stop has one leg."""
from enclosure import BITS, ONE, PI, UNIT, Enclosure, cos_sin, exact, exponential, square_root
from refusals import number, refuse_if

TAPS = 0  # as in rows.py


def of_axis(table, names, wider, more):
    """Number of the axis and the amplitude granted, m, of a table [[mode]]; none for a mode of the filter."""
    if "residual_max_um" not in table:
        return None, None
    refuse_if(table.get("axis") not in names, "a mode names no axis of the task")
    return names.index(table["axis"]), number(table["residual_max_um"]) / 10**6 * wider + more


def bound(rows, mode, frequency, z, j, box):
    """@param j  the corner whose blend it is; None: starts and stops"""
    refuse_if((mode.axis is None) and j is not None, "a multiplier sees a blend in a mode of the filter")
    if mode.axis is None:
        return exact(mode.residual)
    a, natural = mode.axis, PI * exact(2 * frequency)
    damped = natural * square_root(exact(1 - z * z))
    speed = max(rows.start[a], rows.stop[a], key=lambda x: x.lo)
    if j is not None:
        corner, d = rows.corner(j), rows.single_delay(j, box)
        many = corner.delay is None and d >= rows.problem.order_max + 2 + rows.longer
        refuse_if(many, "a multiplier names the phase of a delay that stands for many")
        gap = exact(d * rows.problem.period)
        left = corner.speed_in[a] * (exponential(-(natural * exact(z) * gap)) if z and d else UNIT)
        cosine, sine = cos_sin(damped * gap)
        along, across = corner.speed_out[a] - left * cosine, left * sine
        speed = square_root(along.magnitude() * along.magnitude() + across.magnitude() * across.magnitude())
    refuse_if(speed.lo <= 0, "a multiplier names a mode that nothing excites")
    return exact(mode.displacement) * damped / speed


def blend_vibration(rows, row, box, m, j, frequency, z, angle):
    vibration(rows, row, box, m, frequency, z, angle, corner=j)


def vibration(rows, row, box, m, frequency, *rest, corner=None):
    """What is left at the last tap: tap i has fallen by exp(-z w (N - i)) there."""
    mode, frequency, z = rows.mode(m), number(frequency), number((0, *rest)[-2])
    refuse_if(not mode.low <= frequency <= mode.high, "a multiplier's frequency is outside its band")
    refuse_if(not mode.least_damping <= z <= mode.most_damping, "a multiplier's damping is outside its range")
    natural, fall = PI * exact(2 * frequency * rows.problem.period), UNIT
    if z:
        natural, fall = natural * square_root(exact(1 - z * z)), exponential(-(natural * exact(z)))
    phase, turn = cos_sin(natural.times(box.order) - exact(number(rest[-1]))), cos_sin(natural)
    # Rotations and falls keep the length of an error: each adds that of its own factors and of rounding.
    (cosine, sine), (c, s) = (x.lo for x in phase), ((x * fall).lo for x in turn)
    error, each = sum(x.hi - x.lo for x in phase), 2 * sum((x * fall).hi - (x * fall).lo for x in turn) + 4
    for i in range(box.order, -1, -1):
        end = box.window and i in (0, box.order)  # the taps an end stands for have any phase
        row.term(TAPS, i, Enclosure(-ONE if end else cosine - error))
        cosine, sine = cosine * c + sine * s >> BITS, sine * c - cosine * s >> BITS
        error += each
    row.limit(bound(rows, mode, frequency, z, corner, box))
