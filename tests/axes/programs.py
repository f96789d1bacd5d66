"""Random programs of axes as they are. Their commands are sampled, filtered and followed by the machine of
`machine.py`; the result must say what that machine does: errors, distances from the moves, loads and ringing."""
import math

import numpy as np

import draw
import machine
import moved

STILL = 1e-12  # m; an axis that moves less in a sample stands


def task_of(rng):
    """A task of a program, and the program: a few moves, some shorter than the filter, at up to two feeds."""
    has = rng.choice(draw.KINDS[:-2])
    task = draw.draw(rng, has)
    corner = task.pop("corner")[0]
    task["program"] = {"error_max_um": corner["error_max_um"]}
    if "contour_max_um" in corner:
        task["program"]["contour_max_um"] = corner["contour_max_um"]
    axis = task["axis"][0]
    if len(task["axis"]) == 1 and "servo_gain_1_s" in axis and rng.random() < 0.5:  # axes that differ
        slower = max(1.0, axis["servo_gain_1_s"] * rng.uniform(0.6, 1.0))
        task["axis"] = [{"name": "x", **axis}, {"name": "y", **axis, "servo_gain_1_s": slower}]
    for axis in task["axis"]:  # a servo moves a mass after the last sample of the program
        if "servo_gain_1_s" in axis or "response_taps" in axis:
            axis.setdefault("mass_kg", 20.0), axis.setdefault("damping_N_s_m", 100.0)
        if "force_max_N" in axis and rng.random() < 0.3:
            axis["force_rms_N"] = axis["force_max_N"] * rng.uniform(0.5, 1.0)
    period, at, heading = task["sample_period_ms"], np.zeros(2), rng.uniform(0.0, 2.0 * math.pi)
    filter_way = corner["feed_in_mm_min"] / 6e4 * period * 20.0  # mm
    lines = ["G90 G61.1" if rng.random() < 0.1 else "G90 G64"]
    for move in range(rng.randrange(2, 6)):
        if move > 0 and rng.random() < 0.15:
            lines.append(f"G4 P{period / 1e3 * rng.choice([10.0, 200.0]):.6f}")
        at = at + filter_way * rng.uniform(0.3, 4.0) * np.array([math.cos(heading), math.sin(heading)])
        lines.append(f"G1 X{at[0]:.6f} Y{at[1]:.6f} F{corner['feed_in_mm_min'] * rng.choice([1.0, 0.7]):.4f}")
        heading += rng.choice([-1.0, 1.0]) * rng.uniform(0.1, 2.8)
    return task, "\n".join([*lines, "M2", ""])


class Command:
    """What the commands of a result move, sample by sample, before and behind the filter."""

    def __init__(self, task, result, rest):
        self.period, said = task["sample_period_ms"] / 1e3, result["commands"]
        self.points = np.reshape(said["points_m"], (-1, len(said["axes"])))
        self.joints, rows = [], [self.points[:1]]
        taps = np.asarray(result["filter"]["taps"], float)
        self.taps = np.convolve(taps / math.fsum(taps), task.get("controller", {}).get("prefilter_taps", [1.0]))
        self.order, now, first = len(self.taps) - 1, 0, 0
        for b, kind in enumerate(said["joint"]):
            last = b + 1 == len(said["joint"])
            if kind in "sl" and said["delay_samples"][b] == 0 and not last:
                continue
            times = np.concatenate([[0.0], np.cumsum(said["duration_s"][first:b + 1])]) / self.period
            samples = max(1, math.ceil(times[-1] - 1e-9 - 1e-11 * times[-1]))
            times *= samples / times[-1]
            rows.append(np.column_stack([np.interp(np.arange(1, samples + 1), times, self.points[first:b + 2, a])
                                         for a in range(self.points.shape[1])]))
            waits = 0 if last else said["delay_samples"][b]
            for block, seconds in said["dwell"]:
                waits += math.ceil(seconds / self.period - 1e-9) if block == b and not last else 0
            self.joints += [(i, now + times[i - first + 1], 0) for i in range(first, b)]
            self.joints += [] if last else [(b, now + samples, waits)]
            rows.append(np.repeat(self.points[b + 1:b + 2], waits, axis=0))
            now, first = now + samples + waits, b + 1
        self.samples = now + self.order + 1
        rows.append(np.repeat(self.points[-1:], self.order + rest + 4, axis=0))
        self.raw = np.diff(np.vstack(rows), axis=0, prepend=self.points[:1]) / self.period
        self.velocity = machine.delayed_sum(self.raw, self.taps)


def motion_of(task, command):
    axes = task["axis"] * 2 if len(task["axis"]) == 1 else task["axis"]
    columns = [moved.followed(axis, column, command.period) for axis, column in zip(axes, command.velocity.T)]
    position = np.column_stack(columns)
    return position + command.points[0], np.diff(position, axis=0, prepend=0.0) / command.period


def said_of(result, kind, axis=""):
    return next((u for u in result["limits"] if (u["kind"], u["axis"]) == (kind, axis)), None)


def check_errors(task, result, command, position, order):
    for b, reached, waits in command.joints:
        kind, said = result["commands"]["joint"][b], result["commands"]["error_m"][b]
        part = position[math.floor(reached + 1e-9):math.ceil(reached - 1e-9) + waits + order + 2]
        # A servo's tail may last until a later move comes back here: any end of the window behind the filter's counts.
        least = np.minimum.accumulate(np.linalg.norm(part - command.points[b + 1], axis=1))[waits + command.order + 1:]
        found = least[np.abs(least - said).argmin()]
        if kind in "sl":
            found = moved.polyline_of(part - command.points[b + 1])
        moved.same(f"error of joint {b}", said, found, 2.0 * moved.LEAST)
        if kind == "c":
            moved.within(f"error of joint {b}", found, task["program"]["error_max_um"] * 1e-6 + moved.LEAST)


def from_moves(points, position, parts=32):
    """Largest distance of the steps of a motion from the moves: of dense points, so a little too small."""
    steps = np.linspace(0.0, 1.0, parts, endpoint=False)[:, None, None]
    dense = (position[:-1] + steps * np.diff(position, axis=0)).reshape(-1, position.shape[1])
    least = np.full(len(dense), math.inf)
    for start, end in zip(points[:-1], points[1:]):
        way = end - start
        part = np.clip((dense - start) @ way / (way @ way), 0.0, 1.0)
        least = np.minimum(least, np.linalg.norm(dense - start - part[:, None] * way, axis=1))
    return least.max()


def check_contour(task, result, command, position):
    said = said_of(result, "contour")
    if said is None:
        return
    found = from_moves(command.points, position)
    moved.within("distance from the moves", found, said["value"] + moved.LEAST)
    moved.within("distance from the moves", found, task["program"]["contour_max_um"] * 1e-6 + moved.LEAST)


def events(command):
    """Changes of the command that count together, for each axis: those until the motion goes on evenly, and those
    before     every corner, behind which it would if nothing came later."""
    changes = np.abs(np.diff(command.raw, axis=0, prepend=0.0)) * command.period > STILL
    span = command.order - np.flatnonzero(command.taps)[0]
    found, parts, before = [[]], [], 0
    for k in np.flatnonzero(changes.any(axis=1)):
        moves = k > 0 and (np.abs(command.raw[k - 1]) * command.period > STILL).any()
        if moves and k - before > span:
            found.append([])
        if k in command.corners:
            parts.append(found[-1][:])
        found[-1].append(k)
        before = k
        if k in command.stops:  # the command comes to rest there
            found.append([])
    return [[[k for k in event if changes[k, a]] for event in found + parts] for a in range(command.raw.shape[1])]


def check_modes(task, result, command):
    for mode in task.get("mode", []):
        if "axis" not in mode:
            step = np.concatenate([[0.0], np.cumsum(command.taps)])
            said, places = moved.grid(task, with_corners(result), mode, "vibration")
            moved.check_mode("vibration", said, places, lambda f, z: machine.ringing(step, command.period, f, z)
                             * 2.0 * math.pi * f * math.sqrt(1.0 - z * z))
            continue
        a = "xy".index(mode["axis"])
        change = np.diff(command.raw[:, a], prepend=0.0)
        parts = []
        for event in filter(None, events(command)[a]):
            steps = np.zeros(event[-1] - event[0] + command.order + 2)
            for k in event:
                steps[k - event[0] + 1:] += change[k]
            parts.append(machine.delayed_sum(steps, command.taps))
        said, places = moved.grid(task, with_corners(result), mode, "residual", "", mode["axis"])
        moved.check_mode("residual", said, places,
                         lambda f, z: max(machine.ringing(p, command.period, f, z) for p in parts))


def with_corners(result):
    return {"limits": [{**u, "corner": ""} for u in result["limits"]]}


def check_limits(task, result, command, velocity):
    acceleration = np.diff(command.velocity, axis=0, prepend=0.0) / command.period
    jerk = np.diff(acceleration, axis=0, prepend=0.0) / command.period
    values = {(kind, name): np.abs(column[:, i]) for i, name in enumerate("xy")
              for kind, column in (("velocity", command.velocity), ("acceleration", acceleration), ("jerk", jerk))}
    if "mass_kg" in task["axis"][0]:
        fastest = np.linalg.norm(velocity, axis=1).max()
        drives = machine.Drives(task, 0.0)
        drives.still = STILL / command.period
        behind = drives.run(velocity, command.period)
        if behind > 2.0 * moved.NEAR * fastest:
            raise moved.Differs(f"drives at their limits leave the axes {behind:.9g} m/s behind")
        values |= drives.loads(velocity)
        for load in result["axis_loads"]:
            force = drives.asked[:, "xy".index(load["axis"])]
            moved.same("peak of the force", load["force_peak_N"], np.abs(force).max(), 1e-6)
            rms = math.sqrt((force**2).sum() / result["samples"])  # until the servo rests
            moved.same("force", load["force_rms_N"], rms, 1e-6)
            moved.within("force", rms, drives.axes["xy".index(load["axis"])].get("force_rms_N", math.inf))
    for (kind, axis), column in values.items():
        said = said_of(result, kind, axis)
        if said:
            moved.same(f"{kind} of {axis or 'all axes'}", said["value"], column.max(), 2.0 * moved.NEAR * said["bound"])
            moved.within(f"{kind} of {axis or 'all axes'}", column.max(), said["bound"])


def check(task, result):
    """@throws Differs"""
    rest = moved.rest_of(task)
    command = Command(task, result, rest)
    letters = result["commands"]["joint"]
    command.corners = {round(reached) + 1 for b, reached, _ in command.joints if letters[b] == "c"}
    command.stops = {round(reached) + 1 for b, reached, _ in command.joints if letters[b] == "."}
    if command.samples != result["samples"]:
        raise moved.Differs(f"{result['samples']} samples are said, {command.samples} are commanded")
    position, velocity = motion_of(task, command)
    position = np.vstack([command.points[:1], position])  # sample 0 is the start
    servo = any("servo_gain_1_s" in axis or "response_taps" in axis for axis in task["axis"])
    check_errors(task, result, command, position, command.order + (rest if servo else 0))
    check_contour(task, result, command, position)
    check_modes(task, result, command)
    check_limits(task, result, command, velocity)
