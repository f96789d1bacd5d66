"""Whether a design moves the machine of `machine.py` as its result says: distances, loads and ringing."""
import copy
import math

import numpy as np

import machine

NEAR = 1e-5  # of a value; the servo's steps are exact to about 1e-7 of it
LEAST = 1e-9  # m, of distances


class Differs(Exception):
    """What a result says and the machine does not do."""


def same(what, said, found, least):
    if abs(said - found) > NEAR * max(abs(said), abs(found)) + least:
        raise Differs(f"{what} is said to be {said:.9g}, and is {found:.9g}")


def within(what, found, bound):
    if found > bound * (1.0 + NEAR):
        raise Differs(f"{what} is {found:.9g}, allowed are {bound:.9g}")


def said_of(result, kind, corner="", axis=""):
    """What the result says of a limit, or None."""
    found = [u for u in result["limits"] if (u["kind"], u["corner"], u["axis"]) == (kind, corner, axis)]
    return found[0] if found else None


def motion_of(task, corner, command):
    """Positions of both axes from the corner point, and velocities as their differences: behind the servo, if any."""
    axes = task["axis"] * 2 if len(task["axis"]) == 1 else task["axis"]
    columns = []
    for i, axis in enumerate(axes):
        columns.append(followed(axis, command.velocity[:, i], command.period))
    position = np.column_stack(columns)
    velocity = np.diff(position, axis=0, prepend=0.0) / command.period
    return position - command.way, velocity


def followed(axis, velocity, period):
    """Positions of an axis behind its servo, or its measured response, if it has any."""
    if "servo_gain_1_s" in axis:
        return machine.follow(velocity, period, axis["servo_gain_1_s"], axis.get("velocity_feedforward", 0.0))
    moved = machine.delayed_sum(velocity, axis["response_taps"]) if "response_taps" in axis else velocity
    return np.cumsum(moved) * period


def rest_of(task):
    """Samples after which nothing of a servo's tail is left that counts."""
    gains = [axis["servo_gain_1_s"] for axis in task["axis"] if "servo_gain_1_s" in axis]
    rest = math.ceil(30.0 / (min(gains) * task["sample_period_ms"] / 1e3)) if gains else 0
    return max(rest, *(len(axis.get("response_taps", [])) for axis in task["axis"]), 0) + 4


def contour_of(corner, path):
    """Largest distance of a polyline from the nearer leg: at a point of it, or where both legs are equally far."""
    u1, u2 = machine.directions(corner)

    def to_legs(points):
        return [np.linalg.norm(points - np.maximum(points @ leg, 0.0)[:, None] * leg, axis=1) for leg in (-u1, u2)]

    parts = np.linspace(0.0, 1.0, 9)[:, None, None]
    points = np.vstack([(path[:-1] + parts[:-1] * (path[1:] - path[:-1])).transpose(1, 0, 2).reshape(-1, 2), path[-1:]])
    one, other = to_legs(points)
    at = np.flatnonzero((one[:-1] < other[:-1]) != (one[1:] < other[1:]))
    low, high = points[at], points[at + 1]
    for _ in range(50):
        middle = 0.5 * (low + high)
        first, second = to_legs(middle)
        before = ((first < second) == (one[at] < other[at]))[:, None]
        low, high = np.where(before, middle, low), np.where(before, high, middle)
    return max(np.minimum(one, other).max(), np.minimum(*to_legs(low)).max(initial=0.0))


def polyline_of(path):
    """Smallest distance of a polyline from the corner point."""
    way = np.diff(path, axis=0)
    squares = np.maximum((way**2).sum(axis=1), 1e-300)
    foot = np.clip(-(path[:-1] * way).sum(axis=1) / squares, 0.0, 1.0)
    return np.linalg.norm(path[:-1] + foot[:, None] * way, axis=1).min()


def check_distances(task, result, j, command, position, velocity):
    corner, said = task["corner"][j], result["corners"][j]
    path = position[command.blend]
    same("corner error", said["corner_error_m"], np.linalg.norm(path, axis=1).min(), LEAST)
    same("speed", said["speed_min_m_s"], np.linalg.norm(velocity[command.blend], axis=1).min(), 1e-7)
    same("polyline", said["polyline_error_m"], polyline_of(path), LEAST)
    contour = contour_of(corner, path)
    same("contour", said["contour_deviation_m"], contour, LEAST)
    if "error_max_um" in corner:
        within("corner error", np.linalg.norm(path, axis=1).min(), corner["error_max_um"] * 1e-6 + LEAST)
    if "contour_max_um" in corner:
        within("contour", contour, corner["contour_max_um"] * 1e-6 + LEAST)


def rates(command):
    """Velocity, acceleration and jerk are limits of the command."""
    acceleration = np.diff(command.velocity, axis=0, prepend=0.0) / command.period
    jerk = np.diff(acceleration, axis=0, prepend=0.0) / command.period
    return {(kind, name): np.abs(values[:, i]) for i, name in enumerate("xy")
            for kind, values in (("velocity", command.velocity), ("acceleration", acceleration), ("jerk", jerk))}


def loads(task, corner, command, velocity):
    """Drives within their limits bring the mass along; what they were asked for."""
    if "mass_kg" not in task["axis"][0]:
        return {}
    drives = machine.Drives(task, max(machine.feeds(corner)))
    behind = drives.run(velocity, command.period)
    if behind > 2.0 * NEAR * max(machine.feeds(corner)):
        raise Differs(f"drives at their limits leave the axes {behind:.9g} m/s behind")
    return drives.loads(velocity)


def check_limits(result, corner, command, values):
    """Every limit of an axis or of the supply, and the sample at which it is said to be used most."""
    zero = {"start": command.start - 1, "blend": command.corner - 1, "stop": command.stop - 1}
    for (kind, axis), column in values.items():
        said, what = said_of(result, kind, corner["name"], axis), f"{kind} of {axis or 'all axes'}"
        if said is None:
            continue
        same(what, said["value"], column.max(), 2.0 * NEAR * said["bound"])
        within(what, column.max(), said["bound"])
        row = zero.get(said["event"], -1) + said["sample"]
        if said["event"] not in zero or not 0 <= row < len(column):
            raise Differs(f"{what}: there is no sample {said['sample']} of {said['event']}")
        same(f"{what} at its sample", said["value"], column[row], 2.0 * NEAR * said["bound"])


def grid(task, result, mode, kind, corner="", axis=""):
    """Frequencies and damping ratios at which a mode is simulated: its edges, a few between, and where the result says
    that it is worst."""
    band, ratios = ([v[0], v[-1]] if isinstance(v, list) else [v, v] for v in
                    (mode["frequency_Hz"], mode.get("damping_ratio", 0.0)))
    if "frequency_spread" in mode:
        band = [band[0] * (1.0 - mode["frequency_spread"]), band[0] * (1.0 + mode["frequency_spread"])]
    said = said_of(result, kind, corner, axis)
    places = {(f, z) for f in np.linspace(*band, 7) for z in np.linspace(*ratios, 3)}
    return said, [(said["frequency_Hz"], said.get("damping_ratio", 0.0)), *sorted(places)]


def check_mode(what, said, places, left_at):
    """@param left_at  what is left at a frequency and a damping ratio"""
    left = [left_at(f, z) for f, z in places]
    if abs(left[0] - said["value"]) > 1e-3 * said["value"] + 1e-4 * said["bound"]:
        raise Differs(f"{what} is said to be {said['value']:.9g}, and is {left[0]:.9g}")
    if max(left) > said["value"] * (1.0 + 1e-3) + 1e-4 * said["bound"]:
        raise Differs(f"{what} is said to be {said['value']:.9g} at most, and is {max(left):.9g}")
    within(what, max(left) / (1.0 + 1e-3), said["bound"])


def check_modes(task, result, j, command):
    corner, period = task["corner"][j], command.period
    for mode in task.get("mode", []):
        if "axis" not in mode:
            taps = np.convolve(result["filter"]["taps"], task.get("controller", {}).get("prefilter_taps", [1.0]))
            step = np.concatenate([[0.0], np.cumsum(taps / taps.sum())])

            def left_at(f, z):
                damped = 2.0 * math.pi * f * math.sqrt(1.0 - z * z)
                return machine.ringing(step, period, f, z) * damped

            check_mode("vibration", *grid(task, result, mode, "vibration"), left_at)
            continue
        i, delay = "xy".index(mode["axis"]), result["corners"][j]["delay_samples"]
        later = delay if machine.directions(corner)[1][i] != 0.0 else 0
        ends = [(at - 1, at + command.order + 1 + more) for at, more in
                ((command.start, 0), (command.corner, later), (command.stop, 0))]
        column = command.velocity[:, i]

        def left_behind(f, z):
            return max(machine.ringing(column[first:end], period, f, z) for first, end in ends)

        check_mode("residual", *grid(task, result, mode, "residual", corner["name"], mode["axis"]), left_behind)


def check(task, result):
    """@throws Differs"""
    for j, corner in enumerate(task["corner"]):
        delay = result["corners"][j]["delay_samples"]
        command = machine.Command(task, corner, result["filter"]["taps"], delay, rest_of(task))
        position, velocity = motion_of(task, corner, command)
        check_distances(task, result, j, command, position, velocity)
        check_limits(result, corner, command, rates(command) | loads(task, corner, command, velocity))
        check_modes(task, result, j, command)


def blind_to(rng, task, result):
    """A limit that is used by more than half, told wrong by 1 %, or a drive of half its force: what `check` does not
    see; None if it sees all."""
    used = rng.choice([u for u in result["limits"] if u["utilisation"] > 0.5])
    told = copy.deepcopy(result)
    drives = copy.deepcopy(task)
    if used["kind"] == "force" and rng.random() < 0.5:
        drives["axis"][0]["force_max_N"] *= 0.5
    else:
        next(u for u in told["limits"] if u == used)["value"] *= rng.choice([0.99, 1.01])
    if used["kind"] in ("corner_error", "contour"):
        return None  # its value stands among the corner's
    try:
        check(drives, told)
    except Differs:
        return None
    return f"{used['kind']} {used['axis']}"
