"""Random design tasks of every kind, as dictionaries with the keys of task files.

Limits are drawn from the number of samples they make a filter take, so that most tasks have an answer and none takes
long.
"""
import json
import math

import model

KINDS = (
    "plain",
    "axes",
    "force",
    "vibration",
    "power",
    "regeneration",
    "speed",
    "symmetric",
    "given",
    "fixed-delay",
    "several",
    "ties",
    "velocity",
    "servo",
)
# Kinds whose feasible filters are a convex set for each (order, delay, sample): those the judge can decide.
JUDGED = ("plain", "axes", "force", "vibration", "ties", "velocity", "servo")


def _axis(rng, name, feed, period, samples, kinds):
    """One axis on which reaching `feed` (m/s) takes about `samples` samples by every limit in `kinds`."""
    axis = {"name": name}
    acceleration = feed / (samples * period)
    if "acceleration" in kinds:
        axis["acceleration_max_mm_s2"] = acceleration * 1e3 * rng.uniform(1.0, 2.0)
    if "jerk" in kinds:
        axis["jerk_max_mm_s3"] = acceleration / (rng.uniform(0.1, 0.5) * samples * period) * 1e3
    if "velocity" in kinds:
        axis["velocity_max_mm_s"] = feed * rng.uniform(1.0, 1.2) * 1e3
    if kinds & {"force", "power", "regeneration"}:
        mass = rng.uniform(5.0, 100.0)
        damping = rng.choice([0.0, rng.uniform(0.0, 1.0) * mass * acceleration / feed])
        axis["mass_kg"], axis["damping_N_s_m"] = mass, damping
        axis["force_max_N"] = mass * acceleration * rng.uniform(1.0, 1.5) + damping * feed
        if damping > 0.0 and rng.random() < 0.05:
            axis["force_max_N"] = damping * feed * rng.uniform(0.7, 1.05)  # may not even hold the feed
        if "power" in kinds:
            axis["power_max_W"] = axis["force_max_N"] * feed * rng.uniform(0.4, 1.0) + damping * feed * feed
        if "regeneration" in kinds:
            axis["regeneration_max_W"] = mass * acceleration * feed * rng.uniform(0.2, 1.0)
    return axis


def _corner(rng, period, feed, samples, axes, fixed_plane):
    corner = {}
    if axes <= 2 and fixed_plane:
        corner["angle_deg"] = rng.choice([rng.uniform(10.0, 175.0), float(rng.randrange(15, 180, 15))])
        corner["heading_deg"] = rng.choice([0.0, 30.0, 45.0, 90.0, rng.uniform(-180.0, 180.0)])
        corner["turn"] = rng.choice(["left", "right"])
        angle = math.radians(corner["angle_deg"])
    else:
        while True:
            a = [round(rng.gauss(0.0, 1.0), 2) for _ in range(axes)]
            b = [round(rng.gauss(0.0, 1.0), 2) for _ in range(axes)]
            if axes == 1:
                a, b = [1.0], [rng.choice([1.0, -1.0])]
            la, lb = math.hypot(*a), math.hypot(*b)
            if la > 0.1 and lb > 0.1:
                break
        cosine = -sum(x * y for x, y in zip(a, b)) / (la * lb)
        angle = math.acos(max(-1.0, min(1.0, cosine)))
        corner["direction_in"], corner["direction_out"] = a, b
    corner["feed_in_mm_min"] = feed * 6e4
    corner["feed_out_mm_min"] = feed * 6e4 * rng.choice([1.0, 1.0, rng.uniform(0.4, 1.0)])
    # The error of a moving average without delay, Eq. (6) of Shih, Chen and Lee, sets the scale.
    scale = feed * samples * period / 4.0 * max(math.cos(angle / 2.0), 0.05)
    corner["error_max_um"] = scale * rng.uniform(0.05, 1.3) * 1e6
    return corner


def _given_filter(rng, samples):
    order = max(2, int(samples * rng.uniform(1.2, 2.5)))
    kind = rng.choice(["boxcar", "trapezoid", "s-curve", "hann", "blackman", "taps"])
    spec = {"kind": kind, "order": order}
    if kind == "trapezoid":
        spec["ramp"] = rng.randrange(1, order // 2 + 1)
    if kind == "taps":
        spec = {"kind": kind, "taps": [rng.choice([0.0, rng.random()]) for _ in range(order)] + [1.0]}
    return spec


def _servo(rng, task):
    """A position control for all axes, with forces: dry friction only where no axis reverses."""
    period = task["sample_period_ms"] / 1e3
    servo = {"servo_gain_1_s": min(rng.uniform(0.7, 2.5) / period, 1e4),
             "velocity_feedforward": rng.choice([0.0, 0.5, 0.95])}
    for axis, into, out in zip(task["axis"], *model.directions(task["corner"][0])):
        axis.update(servo)
        if into * out > -1e-12 and rng.random() < 0.5:
            axis["coulomb_N"] = axis["force_max_N"] * rng.uniform(0.02, 0.5)
            axis["force_max_N"] += axis["coulomb_N"]


def draw(rng, kind, longest=16):
    """A random task of a kind. `longest`: most samples an acceleration takes; the order ends near one to two times
    that."""
    period = rng.choice([0.25, 0.5, 1.0, 1.0, 2.0, 4.0]) * 1e-3
    feed = rng.uniform(500.0, 20000.0) / 6e4
    samples = rng.uniform(3.0, longest)
    axes = rng.choice([1, 2, 3, 4, 5]) if kind == "axes" else 2
    task = {"sample_period_ms": period * 1e3}
    limits = {"acceleration", "jerk"}
    if kind in ("axes", "force", "ties", "several", "symmetric", "fixed-delay"):
        limits = rng.choice([{"acceleration", "jerk"}, {"acceleration"}, {"acceleration", "jerk", "force"}, {"force"}])
    if kind in ("power", "regeneration"):
        limits = {"force", kind} | rng.choice([set(), {"acceleration", "jerk"}])
    if kind == "servo":
        limits, samples = {"force"} | rng.choice([set(), {"acceleration", "jerk"}]), min(samples, 6.0)
    if kind == "velocity":
        limits = limits | {"velocity"}
    corners = rng.randrange(2, 4) if kind == "several" else 1
    names = [f"x{i}" for i in range(axes)]
    alike = kind == "ties" or rng.random() < 0.3
    one = _axis(rng, names[0], feed, period, samples, limits)
    task["axis"] = [one] + [
        dict(one, name=n) if alike else _axis(rng, n, feed, period, samples, limits) for n in names[1:]
    ]
    task["corner"] = [
        _corner(rng, period, feed * (1.0 if i == 0 else rng.uniform(0.4, 1.0)), samples, axes, rng.random() < 0.7)
        for i in range(corners)
    ]
    for i, corner in enumerate(task["corner"]):
        corner["name"] = chr(ord("A") + i)
        if kind == "several":
            corner["weight"] = float(rng.choice([1, 1, 2, 5, 10]))
        if kind == "fixed-delay":
            corner["delay_samples"] = rng.randrange(0, int(samples) + 1)
            del corner["error_max_um"]
        if kind == "speed":
            slow = min(corner["feed_in_mm_min"], corner["feed_out_mm_min"]) / 60.0
            corner["speed_min_mm_s"] = slow * rng.uniform(0.02, 0.2)
            corner["angle_deg"], corner["error_max_um"] = rng.uniform(60.0, 170.0), corner["error_max_um"] * 4.0
            corner.pop("direction_in", None), corner.pop("direction_out", None)
    if kind == "symmetric" or (kind == "ties" and rng.random() < 0.3):
        task["design"] = {"symmetric": kind == "symmetric"}
    if kind == "vibration":
        low = rng.uniform(0.4, 1.5) / (samples * period)
        task["mode"] = [
            {
                "frequency_Hz": rng.choice([low, [low, low * rng.uniform(1.01, 1.15)]]),
                "residual_max": rng.choice([0.02, 0.05, 0.1, 0.3]),
            }
        ]
    if kind == "servo":
        _servo(rng, task)
    if kind == "given":
        task["filter"] = _given_filter(rng, samples)
    return task


def to_toml(task):
    """TOML text. JSON scalars, strings and arrays of numbers are TOML as they stand."""
    lines = [f"{k} = {json.dumps(v)}" for k, v in task.items() if not isinstance(v, (dict, list))]
    for key, value in task.items():
        for table in value if isinstance(value, list) else [value] if isinstance(value, dict) else []:
            lines.append(f"[[{key}]]" if isinstance(value, list) else f"[{key}]")
            lines += [f"{k} = {json.dumps(v)}" for k, v in table.items()]
    return "\n".join(lines) + "\n"
