"""The problem a proof is about, from the task in a result file: SI, exact rationals, and enclosures of what is
irrational. Its limits are those that a verification would take for held."""
from collections import namedtuple
from copy import copy
from fractions import Fraction
from types import SimpleNamespace

from axes import curve, modes, servo
from enclosure import ONE, UNIT, ZERO, cos_sin_degrees, exact, square_root
from refusals import NotCovered, Refused, number, refuse_if, whole

GRANTED = Fraction(2, 10**9)  # relative part by which limits are wider than written
WIDER = 1 + GRANTED
FLOOR = Fraction(1, 10**12)  # m, and of residuals: less cannot be told from nothing
# Keys of a task file and their factors to SI.
LIMITS = {
    "velocity": ("velocity_max_mm_s", 1000), "acceleration": ("acceleration_max_mm_s2", 1000),
    "jerk": ("jerk_max_mm_s3", 1000), "force": ("force_max_N", 1),
    "power": ("power_max_W", 1), "regeneration": ("regeneration_max_W", 1),
}
AXIS_KEYS = {key for key, _ in LIMITS.values()} | set(servo.KEYS) | {
    "name", "mass_kg", "damping_N_s_m", "coulomb_N", "force_speed_N"}
STILL = Fraction(1, 10**9)  # part of the feed below which an axis stands: no dry friction is against it

# limits: those given, by kind; own: its number if it has modes of its own, as then no other axis stands for it
Axis = namedtuple("Axis", "mass damping coulomb limits lines last_speed own", defaults=((), None, None))
# A mode of an axis has a displacement in place of a residual.
Mode = namedtuple("Mode", "low high residual least_damping most_damping axis displacement", defaults=(0, 0, None, None))


def _axis(table, period, fastest):
    if set(table) - AXIS_KEYS:
        raise NotCovered(f"an axis with the keys {sorted(set(table) - AXIS_KEYS)}")
    limits = {kind: number(table[key]) / per_si * WIDER for kind, (key, per_si) in LIMITS.items() if key in table}
    mass, damping, coulomb = (number(table.get(key, 0)) for key in ("mass_kg", "damping_N_s_m", "coulomb_N"))
    refuse_if(min(mass, damping, coulomb) < 0, "an axis has a negative load")
    if coulomb > 0 and "force" in limits:  # a sample that counts as standing may accelerate by that little
        limits["force"] += STILL * fastest * mass / period
    standing = STILL * fastest * mass / period if coulomb > 0 else 0
    return Axis(mass, damping, coulomb, limits, *curve.lines(table.get("force_speed_N"), WIDER, standing), None)


def _unit(vector):
    vector = [exact(number(x)) for x in vector]
    length = square_root(sum((x * x for x in vector), ZERO))
    return [x / length for x in vector]


def _heading(degrees, axes):
    """In the plane of the first two axes; parts below 10^-15 count as none."""
    parts = [ZERO if x.magnitude().hi < ONE // 10**15 else x for x in cos_sin_degrees(degrees)]
    return parts + [ZERO] * (axes - 2)


def _corner(table, axes):
    if "direction_in" in table:
        part_in, part_out = _unit(table["direction_in"]), _unit(table["direction_out"])
        cosine = -sum((a * b for a, b in zip(part_in, part_out)), ZERO)
        sine = square_root((UNIT - cosine) * (UNIT + cosine))
    else:
        angle, heading = number(table["angle_deg"]), number(table.get("heading_deg", 0))
        cosine, sine = cos_sin_degrees(angle)
        change = (180 - angle) * (1 if table.get("turn", "left") == "left" else -1)
        part_in, part_out = _heading(heading, axes), _heading(heading + change, axes)
    refuse_if(not len(part_in) == len(part_out) == axes, "a corner has another number of axes than the machine")
    feed_in = number(table["feed_in_mm_min"]) / 60000
    feed_out = number(table["feed_out_mm_min"]) / 60000 if "feed_out_mm_min" in table else feed_in
    weight, delay, error = number(table.get("weight", 1)), table.get("delay_samples"), table.get("error_max_um")
    contour = table.get("contour_max_um")
    known = min(feed_in, feed_out, weight) > 0 and (delay is None or whole(delay) >= 0)
    refuse_if(not known, "a corner has a feed, weight or delay below what a task may have")
    error, contour = [
        None if most is None else max(number(most) / 10**6 * WIDER, FLOOR) + FLOOR / 1000 for most in (error, contour)
    ]
    along = [[exact(feed) * x for x in part] for feed, part in ((feed_in, part_in), (feed_out, part_out))]
    speed_min = number(table.get("speed_min_mm_s", 0)) / 1000 / WIDER
    return SimpleNamespace(
        name=table.get("name", ""), feed_in=feed_in, feed_out=feed_out, part_in=part_in, part_out=part_out,
        cosine=cosine, sine=sine, error=error, contour=contour, speed_min=speed_min, delay=delay, weight=weight,
        speed_in=along[0], speed_out=along[1],
    )


def _mode(table, names):
    if "frequency_spread" in table:
        raise NotCovered("a spread of frequencies that is not written as a band")
    (low, high), (least, most) = [
        [number(x) for x in (end if isinstance(end, list) else [end, end])]
        for end in (table["frequency_Hz"], table.get("damping_ratio", 0))
    ]
    refuse_if(not 0 <= least <= most < 1, "a damping ratio is out of range")
    axis, metres = modes.of_axis(table, names, WIDER, FLOOR / 1000)
    residual = 1 if metres else max(number(table["residual_max"]) * WIDER, FLOOR) + FLOOR / 10
    return Mode(low, high, residual, least, most, axis, metres)


def read(task):
    """From the member `task` of a result file."""
    design, period = task.get("design", {}), number(task["sample_period_ms"]) / 1000
    feeds = [number(c[key]) for c in task["corner"] for key in ("feed_in_mm_min", "feed_out_mm_min") if key in c]
    axes = [_axis(table, period, max(feeds, default=0) / 60000) for table in task["axis"]]
    bounded = [_mode(table, [axis.get("name") for axis in task["axis"]]) for table in task.get("mode", [])]
    axes = [axis._replace(own=a if any(m.axis == a for m in bounded) else None) for a, axis in enumerate(axes)]
    if "prefilter_taps" in task.get("controller", {}):
        raise NotCovered("a control's own smoothing")
    problem = SimpleNamespace(
        period=period,
        response=servo.response(task["axis"], period),
        order_min=max(whole(design.get("order_min", 1)), 0),
        order_max=whole(design.get("order_max", 400)),
        symmetric=design.get("symmetric", False) is True,
        objective=design.get("objective", "cycle"),
        runs=number(design.get("runs", 1)),
        axes=axes,
        supply=task.get("machine", {}),
        corners=[_corner(table, len(axes)) for table in task["corner"]],
        modes=bounded,
        given_filter="filter" in task,
    )
    refuse_if(min(problem.period, problem.runs) <= 0, "the task's period or its number of runs is not above zero")
    refuse_if(not problem.corners, "the task has no corner")
    if problem.objective not in ("cycle", "corner"):
        raise NotCovered(f"the objective {problem.objective!r}")
    # In samples, of each of the N + 1 taps; each sample of a delay costs its corner's weight.
    problem.filter_cost = problem.runs if problem.objective == "cycle" else sum(c.weight for c in problem.corners)
    return problem


def _close(a, b):
    """Enclosed numbers, not below zero, that differ by no more than a part in 10^12."""
    return max(a.hi - b.lo, b.hi - a.lo) <= max(min(a.lo, b.lo), 0) // 10**12 + (1 << 24)


def _same_question(axes, a, b):
    """Whether the axes of one corner can be exchanged and turned round so that it is the other."""
    told = [(c.error, c.contour, c.speed_min, c.delay, c.feed_in, c.feed_out) for c in (a, b)]
    turned = _close(UNIT + a.cosine, UNIT + b.cosine) and _close(UNIT - a.cosine, UNIT - b.cosine)
    if told[0] != told[1] or not turned:
        return False
    asked, left = [
        [(axis, x.magnitude(), y.magnitude(), (x * y).hi < 0) for axis, x, y in zip(axes, c.part_in, c.part_out)]
        for c in (a, b)
    ]
    for axis, x, y, turned in asked:
        same = (o for o in left if o[0] == axis and o[3] == turned and _close(x, o[1]) and _close(y, o[2]))
        found = next(same, None)
        if found is None:
            return False
        left.remove(found)
    return True


def merge(problem, corner_of):
    """Corners that ask the same of every filter become one that has all their weight."""
    refuse_if(len(corner_of) != len(problem.corners), "the certificate merges another number of corners")
    merged = []
    for corner, kind in zip(problem.corners, corner_of):
        refuse_if(not 0 <= whole(kind) <= len(merged), "the certificate merges a corner with one that is not there")
        if kind == len(merged):
            merged.append(copy(corner))
        elif _same_question(problem.axes, merged[kind], corner):
            merged[kind].weight += corner.weight
        else:
            raise Refused(f"corners {merged[kind].name} and {corner.name} are taken for one, but are not")
    problem = copy(problem)
    problem.corners = merged
    return problem
