"""Tasks with contours, force-speed curves, modes of axes, a shared supply, a control's smoothing, a measured response,
corners passed at a part of their feed; proofs about merged corners and smoothed filters."""
from collections import namedtuple
from copy import copy
from fractions import Fraction

import claim
import problem as problems
from enclosure import ONE, Enclosure, NotCovered, exact, number, refuse_if, whole
from more.widening import widens
from problem import FLOOR, KEYS, SERVO, STILL, WIDER, allowed, convolved, tables_of

KEYS["task"].add("machine")
KEYS["machine"] = {"power_total_max_W", "regeneration_total_max_W"}
KEYS["axis"] |= {"force_speed_N", "response_taps"}
KEYS["corner"].add("contour_max_um")
KEYS["mode"] |= {"axis", "residual_max_um"}
KEYS["controller"] |= {"prefilter_taps", "corner_feed_step"}
KEYS["design"] |= {"shaper", "shaper_frequency_step_Hz", "length_set_ms", "length_set_2_ms", "length_set_3_ms",
                   "time_constant_step_ms"}
claim.MEMBERS["branch and bound"] |= {"corner_of", "in_position", "smoothed"}
claim.LISTS.add("corner_of")

# lines: |F| + slope |v| <= bound up to the last speed; own: its number if no other axis may stand for it
Axis = namedtuple("Axis", "mass damping coulomb limits lines last_speed own", defaults=((), None, None))
# A mode of an axis has a displacement, m, in place of a residual.
Mode = namedtuple("Mode", "low high least_damping most_damping residual axis displacement", defaults=(None, None))


@widens(problems, "read_axis")
def axis_with_curve(narrow, table, period, fastest):
    axis = Axis(*narrow(table, period, fastest))
    points = [(number(v) / 1000, number(f)) for v, f in table.get("force_speed_N", [])]
    if not points:
        return axis
    (speed, first), lines = points[0], [(Fraction(0), points[0][1])]
    refuse_if(first <= 0 or speed < 0, "a force-speed curve is out of range")
    for (v, f), (w, g) in zip(points, points[1:]):
        refuse_if(w <= v or g > f, "a force-speed curve has speeds that do not rise or forces that do")
        lines.append(((f - g) / (w - v), f + (f - g) / (w - v) * v))
    # The curve is scaled from its origin by as much as verification grants and a standing axis may take.
    scale = WIDER + (STILL * fastest * axis.mass / period / first if axis.coulomb else 0)
    lines = tuple((slope, bound * scale) for slope, bound in lines)
    return axis._replace(lines=lines, last_speed=points[-1][0] * scale)


@widens(problems, "read_corner")
def corner_with_contour(narrow, table, axes):
    corner = narrow(table, axes)
    corner.contour = allowed(table, "contour_max_um")
    corner.speed_min = number(table.get("speed_min_mm_s", 0)) / 1000 / WIDER
    return corner


def read_taps(numbers):
    taps = [number(tap) for tap in numbers]
    refuse_if(not taps or min(taps) < 0 or abs(sum(taps) - 1) > FLOOR * 10**6, "a response has a wrong tap")
    return exact([tap / sum(taps) for tap in taps])


@widens(problems, "read_servo")
def measured_servo(narrow, tables, period):
    measured = [table.get("response_taps") for table in tables]
    if measured[0] is None:
        refuse_if(any(measured), "axes that respond differently", NotCovered)
        return narrow(tables, period)
    servos = [[table.get(key) for key in (*SERVO, "response_taps")] for table in tables]
    refuse_if(any(servo != servos[0] for servo in servos), "axes that respond differently", NotCovered)
    return read_taps(measured[0])


def mode_of_axis(mode, table, names):
    if "residual_max_um" not in table:
        return Mode(*mode)
    refuse_if(table.get("axis") not in names, "a mode names no axis of the task")
    return Mode(*mode)._replace(residual=1, axis=names.index(table["axis"]),
                                displacement=number(table["residual_max_um"]) / 10**6 * WIDER + FLOOR / 1000)


@widens(problems, "read")
def wide_task(narrow, task):
    problem = narrow(task)
    names = [axis.get("name") for axis in tables_of(task, "axis")]
    problem.modes = [mode_of_axis(*pair, names) for pair in zip(problem.modes, tables_of(task, "mode"))]
    own = {mode.axis for mode in problem.modes}
    problem.axes = [axis._replace(own=a if a in own else None) for a, axis in enumerate(problem.axes)]
    machine, control, design = (task.get(name) or {} for name in ("machine", "controller", "design"))
    problem.supply = {kind: number(machine[f"{kind}_total_max_W"]) * WIDER for kind in ("power", "regeneration")
                      if f"{kind}_total_max_W" in machine}
    problem.symmetric = design.get("symmetric", False) is True
    problem.corner_feed_step = number(control.get("corner_feed_step", Fraction(1, 20)))
    # The control delays every corner by one in-position width, if these are all its delays.
    taps = "taps" in (design.get("family") or ["taps"])
    kinds = control.get("delays") or []
    problem.kinds = {kinds} if isinstance(kinds, str) else set(kinds)
    problem.has_width = taps and problem.kinds == {"in-position"}
    problem.latency = round(number(control.get("in_position_latency_ms", 0)) / 1000 / problem.period)
    problem.actual, problem.one_width = control.get("in_position_of") == "actual", False
    for corner in problem.corners:
        speeds = [abs(x) for x in corner.speed_in]
        fastest = Enclosure(max(x.lo for x in speeds), max(x.hi for x in speeds))
        corner.watched = fastest if control.get("in_position_by") == "axis" else corner.feed_in
    problem.smooths = "prefilter_taps" in control
    problem.servo, problem.smoothing = problem.response, read_taps(control.get("prefilter_taps", [1]))
    problem.response = convolved(problem.smoothing, problem.servo)
    return problem


def question(axes, corner):
    """What a corner asks of a filter, to 13 digits: axes can be exchanged and turned round."""
    def told(x):
        return f"{x.lo / ONE:.12e}"

    moves = [(axis, -x * y > 0, told(abs(x / corner.feed_in)), told(abs(y / corner.feed_out)))
             for axis, x, y in zip(axes, corner.speed_in, corner.speed_out)]
    return (corner.error, corner.contour, corner.speed_min, corner.delay, corner.feed_in, corner.feed_out,
            told(1 + corner.cosine), told(1 - corner.cosine), sorted(moves, key=str))


def merge(problem, corner_of):
    """Corners that ask the same of every filter become one that has all their weight."""
    refuse_if(len(corner_of) != len(problem.corners), "the certificate merges another number of corners")
    problem, merged = copy(problem), []
    for corner, kind in zip(problem.corners, corner_of):
        if whole(kind, 0, len(merged)) == len(merged):
            merged.append(copy(corner))
            continue
        same = question(problem.axes, merged[kind]) == question(problem.axes, corner)
        refuse_if(not same, f"corners {merged[kind].name} and {corner.name} are taken for one, but are not")
        merged[kind].weight += corner.weight
    problem.corners = merged
    return problem


@widens(claim, "searched")
def searched(narrow, problem, certificate, target):
    """The filter and the control's smoothing may be one filter, which may be any; corners may be merged."""
    problem, target = narrow(problem, certificate, target)
    problem = copy(problem)
    problem.one_width = certificate.get("in_position", False)
    refuse_if(not isinstance(problem.one_width, bool), "`in_position` is not true or false")
    others = not problem.has_width or any(corner.delay is not None for corner in problem.corners)
    refuse_if(problem.one_width and others, "the certificate is about one in-position width, the control has others")
    smoothed = certificate.get("smoothed", False)
    refuse_if(not isinstance(smoothed, bool), f"{smoothed!r} stands where true or false should")
    if smoothed:
        refuse_if(not problem.smooths, "the certificate is about a smoothing that the control does not have")
        taps, longer, problem = problem.smoothing, len(problem.smoothing.lo) - 1, copy(problem)
        problem.smoothing, problem.response = exact([1]), problem.servo
        problem.order_min, problem.order_max = problem.order_min + longer, problem.order_max + longer
        problem.symmetric = problem.symmetric and (taps.lo, taps.hi) == (taps.lo[::-1], taps.hi[::-1])
        target = None if target is None else target + problem.filter_cost * longer
    return merge(problem, certificate["corner_of"]) if certificate.get("corner_of") else problem, target
