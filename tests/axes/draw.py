"""Random machines and corners: a period, limits of a filter of a few samples, and what the kind of the machine adds."""
import math

RADIANS = 1000.0 * math.pi / 180.0  # of a metre: a degree counts as a millimetre

KINDS = ("servo", "differ", "prefilter", "friction", "force-speed", "damped", "residual", "contour", "supply",
         "measured", "several", "all")


def draw(rng, kind):
    period = math.exp(rng.uniform(math.log(0.05), math.log(20.0))) * 1e-3  # s
    feed = rng.uniform(500.0, 20000.0) / 6e4  # m/s
    samples = rng.uniform(3.0, 9.0)  # that an acceleration takes
    has = {k for k in KINDS[:-2] if k not in ("differ", "measured") and rng.random() < 0.4} if kind == "all" else {kind}
    task = {"sample_period_ms": period * 1e3, "design": {"order_max": 120}}
    if "prefilter" in has:
        weights = [rng.random() + 0.01 for _ in range(rng.randrange(2, 6))]
        task["controller"] = {"prefilter_taps": [w / math.fsum(weights) for w in weights]}
    axis = _axis(rng, feed, feed / (samples * period), samples * period, has)
    if has & {"servo", "differ"}:
        axis["servo_gain_1_s"] = min(max(math.exp(rng.uniform(math.log(0.05), math.log(3.0))) / period, 1.0), 1e4)
        axis["velocity_feedforward"] = rng.choice([0.0, 0.5, 0.95, 1.0])
    if "measured" in has:
        axis["response_taps"] = _response(rng)
    if has & {"friction", "force-speed", "supply"}:
        _loads(rng, axis, feed, feed / (samples * period), has, task)
    task["axis"] = [axis]
    if "differ" in has:
        other = min(max(axis["servo_gain_1_s"] * math.exp(rng.uniform(-0.5, 0.5)), 1.0), 1e4)
        task["axis"] = [{"name": "x", **axis}, {"name": "y", **axis, "servo_gain_1_s": other}]
    if "measured" in has and rng.random() < 0.5:
        task["axis"] = [{"name": "x", **axis}, {"name": "y", **axis, "response_taps": _response(rng)}]
    modes = [_mode(rng, samples * period, feed, k) for k in ("damped", "residual") if k in has]
    if modes:
        task["mode"] = modes
    count = rng.choice([2, 3]) if kind == "several" else 1
    task["corner"] = [_corner(rng, task, feed * (rng.uniform(0.5, 1.0) if j else 1.0), samples, has, j)
                      for j in range(count)]
    return task


def _response(rng):
    """Of sum 1, in one of two with an undershoot."""
    taps = [rng.random() for _ in range(rng.randrange(2, 9))]
    if rng.random() < 0.5:
        taps += [-0.2 * rng.random() for _ in range(rng.randrange(1, 3))]
    total = math.fsum(taps)
    if total < 0.2 * max(taps):  # an undershoot that leaves almost no motion is no servo
        return _response(rng)
    return [tap / total for tap in taps]


def turned(task):
    """The same task on rotary axes a and b: inertia and torque instead of mass and force."""
    axes = [{"name": n, **a} for n, a in zip("xy", task["axis"] * 2)] if len(task["axis"]) == 1 else task["axis"]
    units = {"velocity_max_mm_s": ("velocity_max_deg_s", 1.0),
             "acceleration_max_mm_s2": ("acceleration_max_deg_s2", 1.0),
             "jerk_max_mm_s3": ("jerk_max_deg_s3", 1.0), "mass_kg": ("inertia_kg_m2", RADIANS**-2),
             "damping_N_s_m": ("damping_N_m_s", RADIANS**-2), "coulomb_N": ("coulomb_N_m", 1.0 / RADIANS),
             "force_max_N": ("torque_max_N_m", 1.0 / RADIANS), "force_rms_N": ("torque_rms_N_m", 1.0 / RADIANS)}
    other = {"x": "a", "y": "b"}
    turned_axes = []
    for axis in axes:
        said = {units[k][0]: v * units[k][1] for k, v in axis.items() if k in units}
        rest = {k: v for k, v in axis.items() if k not in units and k not in ("name", "force_speed_N")}
        if "force_speed_N" in axis:
            rest["torque_speed_N_m"] = [[speed, force / RADIANS] for speed, force in axis["force_speed_N"]]
        turned_axes.append({"name": other[axis["name"]], **said, **rest})
    modes = [{**m, "axis": other[m["axis"]]} if "axis" in m else m for m in task.get("mode", [])]
    return {**task, "axis": turned_axes, **({"mode": modes} if modes else {})}


def _axis(rng, feed, acceleration, time, has):
    axis = {"acceleration_max_mm_s2": acceleration * 1e3 * rng.uniform(1.0, 2.0)}
    if rng.random() < (0.3 if has & {"friction", "supply", "force-speed"} else 0.8):
        axis["jerk_max_mm_s3"] = acceleration / (rng.uniform(0.1, 0.5) * time) * 1e3
    if rng.random() < 0.2:
        axis["velocity_max_mm_s"] = feed * rng.uniform(1.0, 1.2) * 1e3
    return axis


def _loads(rng, axis, feed, acceleration, has, task):
    """Drives that are strong enough for the acceleration, not for much more."""
    mass = rng.uniform(5.0, 100.0)
    peak = mass * acceleration
    axis["mass_kg"], axis["damping_N_s_m"] = mass, rng.choice([0.0, rng.uniform(0.0, 0.5) * peak / feed])
    if "friction" in has:
        axis["coulomb_N"] = peak * rng.uniform(0.02, 0.5)
    moving = axis["damping_N_s_m"] * feed + axis.get("coulomb_N", 0.0)
    axis["force_max_N"] = peak * rng.uniform(0.8, 1.5) + moving
    if "force-speed" in has:
        first, last = axis["force_max_N"] * rng.uniform(0.9, 1.1), feed * rng.uniform(1.05, 2.0)
        bend = rng.uniform(0.2, 0.7)
        axis["force_speed_N"] = [[0.0, first], [bend * last * 1e3, first * rng.uniform(1.0 - 0.5 * bend, 0.99)],
                                 [last * 1e3, max(0.3 * first, 1.1 * moving)]]
        slopes = [(b[1] - a[1]) / (b[0] - a[0]) for a, b in zip(axis["force_speed_N"], axis["force_speed_N"][1:])]
        if not 0.0 > slopes[0] > slopes[1]:
            axis["force_speed_N"] = [axis["force_speed_N"][0], [last * 1e3, max(0.5 * first, 1.1 * moving)]]
            if axis["force_speed_N"][1][1] >= first:
                del axis["force_speed_N"]
    if "supply" in has:
        power = (peak + moving) * feed
        task["machine"] = {"power_total_max_W": power * rng.uniform(0.7, 1.6) + moving * feed,
                           "regeneration_total_max_W": peak * feed * rng.uniform(0.3, 1.2)}


def _mode(rng, time, feed, kind):
    frequency = rng.uniform(0.4, 1.2) / time
    mode = {"frequency_Hz": frequency}
    if rng.random() < 0.5:
        mode["frequency_spread"] = rng.uniform(0.02, 0.15)
    low = rng.uniform(0.005, 0.1)
    mode["damping_ratio"] = rng.choice([low, [low, low + rng.uniform(0.01, 0.1)]])
    if kind == "damped":
        mode["residual_max"] = rng.choice([0.03, 0.05, 0.1, 0.3])
    else:
        mode["axis"] = rng.choice(["x", "y"])
        mode["residual_max_um"] = feed / (2.0 * math.pi * frequency) * rng.choice([0.03, 0.05, 0.1, 0.3]) * 1e6
    return mode


def _corner(rng, task, feed, samples, has, j):
    angle = rng.choice([rng.uniform(20.0, 175.0), 90.0])
    corner = {"name": chr(ord("A") + j), "angle_deg": angle, "turn": rng.choice(["left", "right"]),
              "heading_deg": rng.choice([0.0, 45.0, rng.uniform(-180.0, 180.0)]), "feed_in_mm_min": feed * 6e4}
    corner["feed_out_mm_min"] = corner["feed_in_mm_min"] * rng.choice([1.0, rng.uniform(0.5, 1.0)])
    axis, period = task["axis"][0], task["sample_period_ms"] / 1e3
    late = (1.0 - axis.get("velocity_feedforward", 0.0)) / axis.get("servo_gain_1_s", math.inf)
    late += period * sum(i * max(tap, 0.0) for i, tap in enumerate(axis.get("response_taps", [])))
    # The error of an average without delay sets the scale, Eq. (6) of Shih, Chen and Lee.
    scale = feed * (samples * period / 4.0 + 0.5 * late) * max(math.cos(math.radians(angle) / 2.0), 0.1) * 1e6
    corner["error_max_um"] = scale * rng.uniform(0.1, 1.2)
    if "contour" in has:
        corner["contour_max_um"] = scale * rng.uniform(0.3, 1.2)
    return corner
