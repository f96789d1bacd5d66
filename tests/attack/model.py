"""The model once more, in plain numpy: sampled commands, shifted and summed. Nothing of the program's formulas is used.

A corner's motion is linear in the taps, so the motion of every unit tap is simulated and kept as a column.
"""
import math
from types import SimpleNamespace

import numpy as np


def directions(corner):
    """Unit vectors of both legs; as many entries as given, or two for a corner in a plane."""
    if "direction_in" in corner:
        a, b = np.array(corner["direction_in"], float), np.array(corner["direction_out"], float)
        return a / np.linalg.norm(a), b / np.linalg.norm(b)
    heading, angle = math.radians(corner.get("heading_deg", 0.0)), math.radians(corner["angle_deg"])
    turned = heading + (1.0 if corner.get("turn", "left") == "left" else -1.0) * (math.pi - angle)
    return np.array([math.cos(heading), math.sin(heading)]), np.array([math.cos(turned), math.sin(turned)])


def machine_axes(task, count):
    """One axis table alone applies to every axis."""
    return task["axis"] * count if len(task["axis"]) == 1 else task["axis"]


def settling(task):
    """Samples after which all but 1e-13 of a servo's following error is gone; 0 without one."""
    gain = task["axis"][0].get("servo_gain_1_s")
    return math.ceil(30.0 / (gain * task["sample_period_ms"] / 1e3)) if gain else 0


def followed(velocity, axis, period):
    """What a position control makes of a velocity that is constant within each sample. Its following error e changes by
    e' = (1 - g) v - Kv e."""
    gain, moved, error = axis["servo_gain_1_s"], np.zeros_like(velocity), np.zeros(velocity.shape[1])
    left = math.exp(-gain * period)
    for n, v in enumerate(velocity):
        after = left * error + (1.0 - left) * (1.0 - axis.get("velocity_feedforward", 0.0)) * v / gain
        moved[n] = v - (after - error) / period
        error = after
    return moved


def unit_motions(task, corner, order, delay):
    """Velocity, acceleration, jerk (samples x taps) per axis over rest, leg 1, gap, leg 2, rest; position over the
    blend alone. `moved` and `pulled` are velocity and acceleration behind the servo, if any, as the position is."""
    period = task["sample_period_ms"] / 1e3
    u1, u2 = directions(corner)
    v1 = corner["feed_in_mm_min"] / 6e4
    v2 = corner.get("feed_out_mm_min", corner["feed_in_mm_min"]) / 6e4
    longest = order + settling(task)
    leg, rest = longest + 3, longest + 4
    end_of_leg = rest + leg
    total = end_of_leg + delay + leg + rest
    motion = SimpleNamespace(
        velocity=[], acceleration=[], jerk=[], position=[], moved=[], pulled=[],
        blend=slice(end_of_leg - 1, end_of_leg + longest + delay + 2)
    )
    for x1, x2, axis in zip(u1, u2, machine_axes(task, len(u1))):
        command = np.zeros(total)
        command[rest:end_of_leg] = v1 * x1
        command[end_of_leg + delay : end_of_leg + delay + leg] = v2 * x2
        velocity = np.zeros((total, order + 1))
        for i in range(order + 1):
            velocity[i:, i] = command[: total - i]
        acceleration = np.diff(velocity, axis=0, prepend=0.0) / period
        motion.velocity.append(velocity)
        motion.acceleration.append(acceleration)
        motion.jerk.append(np.diff(acceleration, axis=0, prepend=0.0) / period)
        moved = followed(velocity, axis, period) if settling(task) else velocity
        motion.moved.append(moved)
        motion.pulled.append(np.diff(moved, axis=0, prepend=0.0) / period)
        way = np.cumsum(moved, axis=0) * period - leg * period * v1 * x1
        motion.position.append(way[motion.blend])
    return motion


LINEAR = (
    ("velocity_max_mm_s", "velocity", 1e-3),
    ("acceleration_max_mm_s2", "acceleration", 1e-3),
    ("jerk_max_mm_s3", "jerk", 1e-3),
)


def linear_rows(task, corner, motion):
    """Matrix A with |A b| <= 1: velocity, acceleration, jerk and force of all axes, scaled by their bounds."""
    rows = []
    for i, axis in enumerate(machine_axes(task, len(motion.velocity))):
        for key, quantity, unit in LINEAR:
            if key in axis:
                rows.append(getattr(motion, quantity)[i] / (axis[key] * unit))
        if "force_max_N" in axis:
            force = axis.get("mass_kg", 0.0) * motion.pulled[i] + axis.get("damping_N_s_m", 0.0) * motion.moved[i]
            # Dry friction of an axis that keeps its direction; where it stands, friction helps to stop it. Taps have
            # the sum 1.
            along = sum(x[i] for x in directions(corner))
            rows.append((force + math.copysign(axis.get("coulomb_N", 0.0), along)) / axis["force_max_N"])
    return np.unique(np.vstack(rows).round(14), axis=0) if rows else np.zeros((0, motion.velocity[0].shape[1]))


def residual_rows(mode, period, order, count=33):
    """Frequencies of a band and, for each, the two rows whose length is the residual vibration."""
    band = mode["frequency_Hz"]
    low, high = (band[0], band[-1]) if isinstance(band, list) else (band, band)
    angles = 2.0 * math.pi * period * np.outer(np.linspace(low, high, count if high > low else 1), np.arange(order + 1))
    return np.stack([np.cos(angles), np.sin(angles)], axis=1)


def worst_use(task, taps, delays):
    """Largest use of any limit (1 is the bound) by the taps and delays, and its name. Distances below 1e-12 m are
    zero."""
    taps = np.asarray(taps, float) / math.fsum(taps)
    worst, name = 0.0, "none"

    def offer(use, what):
        nonlocal worst, name
        if use > worst:
            worst, name = use, what

    for corner, delay in zip(task["corner"], delays):
        motion = unit_motions(task, corner, len(taps) - 1, delay)
        rows = linear_rows(task, corner, motion)
        if rows.size:
            offer(float(np.abs(rows @ taps).max()), "linear")
        for i, axis in enumerate(machine_axes(task, len(motion.velocity))):
            v, a = motion.velocity[i] @ taps, motion.acceleration[i] @ taps
            power = (axis.get("mass_kg", 0.0) * a + axis.get("damping_N_s_m", 0.0) * v) * v
            if "power_max_W" in axis:
                offer(float(power.max()) / axis["power_max_W"], "power")
            if "regeneration_max_W" in axis:
                offer(float(-power.min()) / axis["regeneration_max_W"], "regeneration")
        error = corner_error(motion, taps)
        if "error_max_um" in corner and error > 1e-12:
            offer(error / (corner["error_max_um"] * 1e-6) if corner["error_max_um"] > 0.0 else math.inf, "corner error")
        if "contour_max_um" in corner:
            offer(contour(corner, motion, taps) / (corner["contour_max_um"] * 1e-6), "contour")
        if corner.get("speed_min_mm_s", 0.0) > 0.0:
            speed = np.sqrt(sum((v[motion.blend] @ taps) ** 2 for v in motion.velocity)).min()
            offer(corner["speed_min_mm_s"] * 1e-3 / speed if speed > 0.0 else math.inf, "smallest speed")
    for mode in task.get("mode", []):
        rows = residual_rows(mode, task["sample_period_ms"] / 1e3, len(taps) - 1)
        offer(float(np.hypot(rows[:, 0] @ taps, rows[:, 1] @ taps).max()) / mode["residual_max"], "vibration")
    return worst, name


def value_at(task, taps, delays, limit):
    """What a recorded limit of an axis is used at the event and sample that it names, in SI; None where there is
    none."""
    taps = np.asarray(taps, float) / math.fsum(taps)
    j, corner = next(((j, c) for j, c in enumerate(task["corner"]) if c["name"] == limit["corner"]), (None, None))
    if corner is None:
        return None
    motion = unit_motions(task, corner, len(taps) - 1, delays[j])
    # Last samples at rest, of leg 1 and of leg 2, each commanded at full speed for as long.
    leg, corner_row = len(taps) + 2 + settling(task), motion.blend.start
    zero = {"start": corner_row - leg, "blend": corner_row, "stop": corner_row + delays[j] + leg}.get(limit["event"])
    if zero is None or not 0 <= zero + limit["sample"] < len(motion.velocity[0]):
        return None
    axes = machine_axes(task, len(motion.velocity))
    i = next((i for i, axis in enumerate(axes) if axis.get("name", "xyzabcuvw"[i]) == limit["axis"]), 0)
    v, a, jerk, moved, pulled = (
        quantity[i][zero + limit["sample"]] @ taps
        for quantity in (motion.velocity, motion.acceleration, motion.jerk, motion.moved, motion.pulled)
    )
    force = axes[i].get("mass_kg", 0.0) * pulled + axes[i].get("damping_N_s_m", 0.0) * moved
    coulomb, feed = axes[i].get("coulomb_N", 0.0), max(corner[k] for k in corner if k.startswith("feed_")) / 6e4
    if abs(moved) > 1e-9 * feed:
        force += math.copysign(coulomb, moved)
    else:
        force = math.copysign(max(0.0, abs(force) - coulomb), force)
    return {
        "velocity": abs(v),
        "acceleration": abs(a),
        "jerk": abs(jerk),
        "force": abs(force),
        "power": force * moved,
        "regeneration": -force * moved,
    }.get(limit["kind"])


def contour(corner, motion, taps):
    """Largest distance of the path from the two legs, m: at 33 points of every line between samples of the blend. At
    the ends of the blend it is that from the leg's own line, which the motion keeps far from the corner."""
    position = np.stack([p @ taps for p in motion.position], axis=1)
    shares = np.linspace(0.0, 1.0, 33)[:, None, None]
    path = (position[:-1] + shares * (position[1:] - position[:-1])).reshape(-1, position.shape[1])
    u1, u2 = directions(corner)
    distances = []
    for leg in (-u1, u2):
        along = np.maximum(path @ leg, 0.0)
        distances.append(np.linalg.norm(path - along[:, None] * leg, axis=1))
    ends = (np.linalg.norm(x - (x @ u) * u) for x, u in ((position[0], u1), (position[-1], u2)))
    return float(max(np.minimum(*distances).max(), *ends))


def corner_error(motion, taps):
    """Smallest distance from the corner at a sample of the blend, m."""
    return float(np.sqrt(sum((p @ np.asarray(taps)) ** 2 for p in motion.position)).min())
