"""The problem a proof is about, from a result's task, in SI. Limits are those that a verification takes for held."""
from collections import namedtuple
from fractions import Fraction
from math import prod
from types import SimpleNamespace

from enclosure import (BITS, ONE, Enclosure, NotCovered, cos_sin_degrees, exact, exponential, number, refuse_if,
                       square_root, whole)

WIDER = 1 + Fraction(2, 10**9)  # limits are wider than written by this factor
FLOOR = Fraction(1, 10**12)  # m, and of residuals: less cannot be told from nothing
STILL = Fraction(1, 10**9)  # part of the feed below which an axis stands: no dry friction is against it
ROUNDING = Fraction(1, 10**9)  # of times: shorter by less is not shorter
REST, LONGEST = Fraction(1, 10**12), 50000  # a servo's response ends where less is left; its most taps
# Limits of an axis: keys of a task file and their factors to SI.
LIMITS = {"velocity": ("velocity_max_mm_s", 1000), "acceleration": ("acceleration_max_mm_s2", 1000),
          "jerk": ("jerk_max_mm_s3", 1000), "force": ("force_max_N", 1),
          "power": ("power_max_W", 1), "regeneration": ("regeneration_max_W", 1)}
LOADS, SERVO = ("mass_kg", "damping_N_s_m", "coulomb_N"), ("servo_gain_1_s", "velocity_feedforward")
# Keys of each table. Those that are not read only narrow the motion: what is proved without them is proved with them.
KEYS = {
    "task": set("title sample_period_ms filter baseline design controller axis corner mode program".split()),
    "axis": {"name", *(key for key, _ in LIMITS.values()), *LOADS, *SERVO},
    "corner": set("name angle_deg heading_deg turn direction_in direction_out feed_in_mm_min feed_out_mm_min "
                  "error_max_um speed_min_mm_s delay_samples weight".split()),
    "mode": {"frequency_Hz", "damping_ratio", "residual_max"},
    "controller": set("title parameters parameter_units parameter_unit_ms position_unit_um delays "
                      "delay_words assumed in_position_of in_position_by in_position_latency_ms".split()),
    "design": set("order_min order_max symmetric objective runs coefficient_bits family stages length_step_ms "
                  "length_max_ms alpha_step cutoff_step_Hz".split()),
}

Axis = namedtuple("Axis", "mass damping coulomb limits")  # limits: those given, by kind
Mode = namedtuple("Mode", "low high least_damping most_damping residual")


def tables_of(task, name):
    """All tables of a name, whose keys are known."""
    many = name in ("axis", "corner", "mode")
    tables = task if name == "task" else task.get(name, [] if many else {})
    refuse_if(type(tables) is not (list if many else dict), f"`{name}` is not a {'list' if many else 'table'}")
    for table in (tables := tables if many else [tables]):
        refuse_if(unknown := sorted(set(table) - KEYS[name]), f"a table `{name}` with the keys {unknown}", NotCovered)
    return tables


def read_axis(table, period, fastest):
    limits = {kind: number(table[key]) / si * WIDER for kind, (key, si) in LIMITS.items() if key in table}
    mass, damping, coulomb = (number(table.get(key, 0)) for key in LOADS)
    refuse_if(min(mass, damping, coulomb) < 0, "an axis has a negative load")
    if "force" in limits and coulomb:  # a sample that counts as standing may accelerate by that little
        limits["force"] += STILL * fastest * mass / period
    return Axis(mass, damping, coulomb, limits)


def read_servo(tables, period):
    """Taps of the servo that all axes have; [1] without one. A position control of gain Kv leaves c a^k of a step after
    k samples, c = (1 - g)(1 - a)/(Kv T), a = exp(-Kv T)."""
    servos = [[table.get(key) for key in SERVO] for table in tables]
    refuse_if(any(servo != servos[0] for servo in servos), "axes that respond differently", NotCovered)
    gain, fed = servos[0]
    if gain is None:
        return exact([1])
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
    size, count = 2 * BITS + 64, len(a.lo) + len(b.lo) - 1

    def product(*factors):
        digits = prod(sum(max(tap, 0) << size * i for i, tap in enumerate(taps)) for taps in factors)
        return [digits >> size * i & (1 << size) - 1 for i in range(count)]

    return Enclosure([x >> BITS for x in product(a.lo, b.lo)], [-(-x >> BITS) for x in product(a.hi, b.hi)])


def directions(table, axes):
    """Unit vectors of both legs, and cosine and sine of the angle between them."""
    if "direction_in" in table:
        vectors = [[exact(number(x)) for x in table[key]] for key in ("direction_in", "direction_out")]
        refuse_if({len(vector) for vector in vectors} != {axes}, "a corner has not as many axes as the machine")
        legs = [[x / square_root(sum(y * y for y in vector)) for x in vector] for vector in vectors]
        cosine = -sum(a * b for a, b in zip(*legs))
        return *legs, cosine, square_root((1 - cosine) * (1 + cosine))
    angle, heading = number(table["angle_deg"]), number(table.get("heading_deg", 0))
    change = (180 - angle) * (1 if table.get("turn", "left") == "left" else -1)
    # In the plane of the first two axes; parts below 10^-15 count as none.
    legs = [[exact(0) if abs(x).hi < ONE // 10**15 else x for x in cos_sin_degrees(at)] + [exact(0)] * (axes - 2)
            for at in (heading, heading + change)]
    return *legs, *cos_sin_degrees(angle)


def allowed(table, key):
    """A distance or residual that a verification would take for held; None if it is not limited."""
    scale, least = (10**6, FLOOR / 1000) if key.endswith("um") else (1, FLOOR / 10)
    return max(number(table[key]) / scale * WIDER, FLOOR) + least if key in table else None


def read_corner(table, axes):
    leg_in, leg_out, cosine, sine = directions(table, axes)
    feed_in = number(table["feed_in_mm_min"]) / 60000
    feed_out = number(table["feed_out_mm_min"]) / 60000 if "feed_out_mm_min" in table else feed_in
    weight, delay = number(table.get("weight", 1)), table.get("delay_samples")
    refuse_if(min(feed_in, feed_out, weight) <= 0, "a corner has a feed or weight that is not above zero")
    return SimpleNamespace(
        name=table.get("name", ""), feed_in=feed_in, feed_out=feed_out, fastest=max(feed_in, feed_out), weight=weight,
        speed_in=[x * feed_in for x in leg_in], speed_out=[x * feed_out for x in leg_out], cosine=cosine, sine=sine,
        error=allowed(table, "error_max_um"), delay=None if delay is None else whole(delay, 0))


def read_mode(table):
    ends = table["frequency_Hz"], table.get("damping_ratio", 0)
    low, high, least, most = (number(x) for end in ends for x in (end if isinstance(end, list) else [end, end]))
    refuse_if(not 0 <= least <= most < 1, "a damping ratio is out of range")
    return Mode(low, high, least, most, allowed(table, "residual_max"))


def read(task):
    """From the member `task` of a result file."""
    tables = {name: tables_of(task, name) for name in KEYS}
    design, = tables["design"]
    period = number(task["sample_period_ms"]) / 1000
    corners = [read_corner(table, len(tables["axis"])) for table in tables["corner"]]
    fastest = max((c.fastest for c in corners), default=0)
    axes = [read_axis(table, period, fastest) for table in tables["axis"]]
    problem = SimpleNamespace(
        period=period, fastest=fastest, corners=corners, axes=axes, modes=[*map(read_mode, tables["mode"])],
        corner_feeds=any("corner-feed" in kinds and (  # free taps have none beside delays of any length
            {"filter", "family"} & {*task, *design} or not {"dwell", "timed-axis"} & {*kinds})
            for kinds in (t.get("delays") or [] for t in tables["controller"])) and not all(c.delay for c in corners),
        given_filter="filter" in task, response=read_servo(tables["axis"], period),
        order_min=max(whole(design.get("order_min", 1)), 0), order_max=whole(design.get("order_max", 400)),
        objective=design.get("objective", "cycle"), runs=number(design.get("runs", 1)))
    refuse_if(min(period, problem.runs, fastest) <= 0, "the task has no corner, or no period or runs above zero")
    refuse_if(problem.objective not in ("cycle", "corner"), f"the objective {problem.objective!r}", NotCovered)
    # In samples, of each of the N + 1 taps; each sample of a delay costs its corner's weight.
    problem.filter_cost = problem.runs if problem.objective == "cycle" else sum(c.weight for c in corners)
    return problem
