"""The problem a proof is about, from the task in a result file: SI, exact rationals, and enclosures of what is
irrational. Its limits are those that a verification would take for held."""
from collections import namedtuple
from copy import copy
from fractions import Fraction
from types import SimpleNamespace

from enclosure import (BITS, ONE, Enclosure, NotCovered, cos_sin_degrees, exact, exponential, number, refuse_if,
                       square_root, whole)

WIDER = 1 + Fraction(2, 10**9)  # limits are wider than written by this factor
FLOOR = Fraction(1, 10**12)  # m, and of residuals: less cannot be told from nothing
STILL = Fraction(1, 10**9)  # part of the feed below which an axis stands: no dry friction is against it
ROUNDING = Fraction(1, 10**9)  # of times: shorter by less is not shorter
REST, LONGEST = Fraction(1, 10**12), 50000  # a servo's response ends where less is left; its most taps
# Limits of an axis: keys of a task file and their factors to SI.
LIMITS = {
    "velocity": ("velocity_max_mm_s", 1000), "acceleration": ("acceleration_max_mm_s2", 1000),
    "jerk": ("jerk_max_mm_s3", 1000), "force": ("force_max_N", 1),
    "power": ("power_max_W", 1), "regeneration": ("regeneration_max_W", 1),
}
LOADS, SERVO = ("mass_kg", "damping_N_s_m", "coulomb_N"), ("servo_gain_1_s", "velocity_feedforward", "response_taps")
# Keys of each table. Those that this checker does not read change no limit of the motion, or only narrow it.
KEYS = {
    "task": "title sample_period_ms filter baseline design controller machine axis corner mode program",
    "axis": " ".join([*(key for key, _ in LIMITS.values()), *LOADS, *SERVO, "name force_speed_N"]),
    "corner": "name angle_deg heading_deg turn direction_in direction_out feed_in_mm_min feed_out_mm_min error_max_um "
              "contour_max_um speed_min_mm_s delay_samples weight",
    "mode": "frequency_Hz damping_ratio residual_max axis residual_max_um",
    "machine": "power_total_max_W regeneration_total_max_W",
    "controller": "name file title parameters parameter_units parameter_unit_ms prefilter_taps position_unit_um delays "
                  "delay_words in_position_of in_position_latency_ms corner_feed_step",
    "design": "order_min order_max symmetric objective runs coefficient_bits family stages shaper length_step_ms "
              "length_max_ms length_set_ms length_set_2_ms length_set_3_ms time_constant_step_ms "
              "alpha_step cutoff_step_Hz shaper_frequency_step_Hz",
}

# limits: those given, by kind; lines: |F| + slope |v| <= bound; own: its number if no other may stand for it
Axis = namedtuple("Axis", "mass damping coulomb limits lines last_speed own", defaults=((), None, None))
# A mode of an axis has a displacement, m, in place of a residual.
Mode = namedtuple("Mode", "low high residual least_damping most_damping axis displacement", defaults=(0, 0, None, None))


def _tables(task, name):
    """All tables of a name, whose keys are known."""
    tables = [task] if name == "task" else task.get(name, [])
    for table in tables if isinstance(tables, list) else [tables]:
        unknown = sorted(set(table) - set(KEYS[name].split()))
        refuse_if(unknown, f"a table `{name}` with the keys {unknown}", NotCovered)
    return tables


def _axis(table, period, fastest, own):
    limits = {kind: number(table[key]) / si * WIDER for kind, (key, si) in LIMITS.items() if key in table}
    mass, damping, coulomb = (number(table.get(key, 0)) for key in LOADS)
    refuse_if(min(mass, damping, coulomb) < 0, "an axis has a negative load")
    # A sample that counts as standing may accelerate by that little.
    standing = STILL * fastest * mass / period if coulomb else 0
    if "force" in limits:
        limits["force"] += standing
    points = [(number(v) / 1000, number(f)) for v, f in table.get("force_speed_N", [])]
    if not points:
        return Axis(mass, damping, coulomb, limits, own=own)
    (speed, first), lines = points[0], [(Fraction(0), points[0][1])]
    refuse_if(first <= 0 or speed < 0, "a force-speed curve is out of range")
    for (v, f), (w, g) in zip(points, points[1:]):
        refuse_if(w <= v or g > f, "a force-speed curve has speeds that do not rise or forces that do")
        lines.append(((f - g) / (w - v), f + (f - g) / (w - v) * v))
    scale = WIDER + standing / first  # what verification grants scales the curve from its origin
    lines = tuple((slope, bound * scale) for slope, bound in lines)
    return Axis(mass, damping, coulomb, limits, lines, points[-1][0] * scale, own)


def _taps(numbers):
    taps = [number(tap) for tap in numbers]
    refuse_if(not taps or min(taps) < 0 or abs(sum(taps) - 1) > FLOOR * 10**6, "a response has a wrong tap")
    return exact([tap / sum(taps) for tap in taps])


def _servo(tables, period):
    """Taps of the servo that all axes have; [1] without one. A position control of gain Kv leaves c a^k of a step after
    k samples, c = (1 - g)(1 - a)/(Kv T), a = exp(-Kv T)."""
    servos = [[table.get(key) for key in SERVO] for table in tables]
    refuse_if(any(servo != servos[0] for servo in servos), "axes that respond differently", NotCovered)
    gain, fed, taps = servos[0]
    if taps is not None or gain is None:
        return _taps([1] if taps is None else taps)
    x, fed = number(gain) * period, number(fed or 0)
    refuse_if(x <= 0 or not 0 <= fed <= 1, "a servo's gain or feedforward is out of range")
    left_by_each = exponential(-x)
    missing = (1 - left_by_each) * (1 - fed) / x
    taps = [1 - missing]
    while missing.hi >= exact(REST).lo:
        refuse_if(len(taps) > LONGEST, "a servo's response does not end")
        taps.append(missing - missing * left_by_each)
        missing *= left_by_each
    return exact(taps[:-1] + [taps[-1] + missing])


def convolved(a, b):
    """Taps in series, none negative: digits of the product of two whole numbers."""
    if b.lo == b.hi == [ONE]:
        return a
    size, count = BITS // 4 + 8, len(a.lo) + len(b.lo) - 1

    def product(*factors):
        packed = (b"".join(max(tap, 0).to_bytes(size, "little") for tap in taps) for taps in factors)
        x, y = (int.from_bytes(digits, "little") for digits in packed)
        digits = (x * y).to_bytes(size * (count + 1), "little")
        return [int.from_bytes(digits[size * i:size * i + size], "little") for i in range(count)]

    return Enclosure([x >> BITS for x in product(a.lo, b.lo)], [-(-x >> BITS) for x in product(a.hi, b.hi)])


def _directions(table, axes):
    """Unit vectors of both legs, and cosine and sine of the angle between them."""
    if "direction_in" in table:
        legs = []
        for key in ("direction_in", "direction_out"):
            vector = [exact(number(x)) for x in table[key]]
            legs.append([x / square_root(sum(x * x for x in vector)) for x in vector])
        refuse_if({len(leg) for leg in legs} != {axes}, "a corner has another number of axes than the machine")
        cosine = -sum(a * b for a, b in zip(*legs))
        return *legs, cosine, square_root((1 - cosine) * (1 + cosine))
    angle, heading = number(table["angle_deg"]), number(table.get("heading_deg", 0))
    change = (180 - angle) * (1 if table.get("turn", "left") == "left" else -1)
    # In the plane of the first two axes; parts below 10^-15 count as none.
    legs = [[exact(0) if abs(x).hi < ONE // 10**15 else x for x in cos_sin_degrees(at)] + [exact(0)] * (axes - 2)
            for at in (heading, heading + change)]
    return *legs, *cos_sin_degrees(angle)


def _corner(table, axes):
    part_in, part_out, cosine, sine = _directions(table, axes)
    feed_in = number(table["feed_in_mm_min"]) / 60000
    feed_out = number(table["feed_out_mm_min"]) / 60000 if "feed_out_mm_min" in table else feed_in
    weight, delay = number(table.get("weight", 1)), table.get("delay_samples")
    refuse_if(min(feed_in, feed_out, weight) <= 0, "a corner has a feed or weight that is not above zero")
    error, contour = (max(number(table[key]) / 10**6 * WIDER, FLOOR) + FLOOR / 1000 if key in table else None
                      for key in ("error_max_um", "contour_max_um"))
    return SimpleNamespace(
        name=table.get("name", ""), feed_in=feed_in, feed_out=feed_out, part_in=part_in, part_out=part_out,
        speed_in=[x * feed_in for x in part_in], speed_out=[x * feed_out for x in part_out], cosine=cosine, sine=sine,
        error=error, contour=contour, speed_min=number(table.get("speed_min_mm_s", 0)) / 1000 / WIDER,
        delay=None if delay is None else whole(delay, 0), weight=weight)


def _mode(table, names):
    (low, high), (least, most) = ([number(x) for x in (end if isinstance(end, list) else [end, end])]
                                  for end in (table["frequency_Hz"], table.get("damping_ratio", 0)))
    refuse_if(not 0 <= least <= most < 1, "a damping ratio is out of range")
    if "residual_max_um" not in table:
        return Mode(low, high, max(number(table["residual_max"]) * WIDER, FLOOR) + FLOOR / 10, least, most)
    refuse_if(table.get("axis") not in names, "a mode names no axis of the task")
    metres = number(table["residual_max_um"]) / 10**6 * WIDER + FLOOR / 1000
    return Mode(low, high, 1, least, most, names.index(table["axis"]), metres)


def read(task):
    """From the member `task` of a result file."""
    tables = {name: _tables(task, name) for name in KEYS}
    design, control, machine = (tables[name] or {} for name in ("design", "controller", "machine"))
    period, axes = number(task["sample_period_ms"]) / 1000, tables["axis"]
    corners = [_corner(table, len(axes)) for table in tables["corner"]]
    modes = [_mode(table, [axis.get("name") for axis in axes]) for table in tables["mode"]]
    fastest = max((max(c.feed_in, c.feed_out) for c in corners), default=0)
    problem = SimpleNamespace(
        period=period, fastest=fastest, corners=corners, modes=modes, given_filter="filter" in task,
        axes=[_axis(table, period, fastest, a if any(m.axis == a for m in modes) else None)
              for a, table in enumerate(axes)],
        supply={kind: number(machine[f"{kind}_total_max_W"]) * WIDER for kind in ("power", "regeneration")
                if f"{kind}_total_max_W" in machine},
        smoothing=_taps(control.get("prefilter_taps", [1])), servo=_servo(axes, period),
        order_min=max(whole(design.get("order_min", 1)), 0), order_max=whole(design.get("order_max", 400)),
        symmetric=design.get("symmetric", False) is True,
        objective=design.get("objective", "cycle"), runs=number(design.get("runs", 1)))
    refuse_if(min(period, problem.runs, fastest) <= 0, "the task has no corner, or no period or runs above zero")
    refuse_if(problem.objective not in ("cycle", "corner"), f"the objective {problem.objective!r}", NotCovered)
    problem.response = convolved(problem.smoothing, problem.servo)
    # In samples, of each of the N + 1 taps; each sample of a delay costs its corner's weight.
    problem.filter_cost = problem.runs if problem.objective == "cycle" else sum(c.weight for c in corners)
    return problem


def _question(axes, corner):
    """What a corner asks of a filter, to 13 digits: axes can be exchanged and turned round."""
    def told(x):
        return f"{x.lo / ONE:.12e}"

    moves = [(axis, x * y < 0, told(abs(x)), told(abs(y))) for axis, x, y in zip(axes, corner.part_in, corner.part_out)]
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
        same = _question(problem.axes, merged[kind]) == _question(problem.axes, corner)
        refuse_if(not same, f"corners {merged[kind].name} and {corner.name} are taken for one, but are not")
        merged[kind].weight += corner.weight
    problem.corners = merged
    return problem


def together(problem):
    """The filter and the control's smoothing as one filter, which may be any; and what that costs more."""
    taps, longer, one = problem.smoothing, len(problem.smoothing.lo) - 1, copy(problem)
    one.smoothing, one.response = _taps([1]), problem.servo
    one.order_min, one.order_max = problem.order_min + longer, problem.order_max + longer
    one.symmetric = problem.symmetric and (taps.lo, taps.hi) == (taps.lo[::-1], taps.hi[::-1])
    return one, problem.filter_cost * longer
