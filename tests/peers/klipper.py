#!/usr/bin/python3
"""klipper.py FOLDER PROGRAM SAMPLES ACCELERATION VELOCITY: the motion that Klipper plans, one position a millisecond.

FOLDER has Klipper's sources, as git clones them. Its look-ahead, its corners and its arcs run in this process, without
a printer; the program is read by LinuxCNC's interpreter. ACCELERATION in mm/s^2 and VELOCITY in mm/s. SAMPLES is a CSV
file with the columns x_mm, y_mm, z_mm.
"""
import contextlib
import importlib.util
import io
import os
import pathlib
import sys
import tempfile
import types

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

T = 1e-3  # s


def moves_of(program):
    """The program by LinuxCNC's interpreter, mm and mm/s: ("line", end, feed or None), ("arc", end, center, turns, plane,
    feed), ("dwell", seconds), ("rest",)."""
    import gcode
    import moves

    class Canon(moves.Canon):
        def __init__(self, parameters):
            super().__init__([0.0], parameters)
            self.feed, self.list = 0.0, []

        def set_feed_rate(self, feed):
            self.feed = moves.INCH * feed / 60.0

        def go(self, p, feed):
            to = [moves.INCH * v for v in p[:3]]
            if max(abs(a - b) for a, b in zip(to, self.at)) > 1e-9:
                self.list.append(("line", to, feed))
            self.at = to

        def straight_traverse(self, *p):
            self.go(p, None)

        def straight_feed(self, *p):
            self.go(p, self.feed)

        def arc_feed(self, x1, y1, cx, cy, rotation, z1, *rest):
            axes = {1: (0, 1, 2), 2: (1, 2, 0), 3: (2, 0, 1)}[self.plane]
            to, center = [0.0] * 3, list(self.at)
            for axis, value in zip(axes, (x1, y1, z1)):
                to[axis] = moves.INCH * value
            for axis, value in zip(axes, (cx, cy)):
                center[axis] = moves.INCH * value
            self.list.append(("arc", to, center, rotation, axes, self.feed))
            self.at = to

        def dwell(self, seconds):
            self.list.append(("dwell", seconds))

    with tempfile.TemporaryDirectory() as folder:
        parameters = os.path.join(folder, "parameters.var")
        open(parameters, "w").close()
        canon = Canon(parameters)
        result, line = gcode.parse(str(program), canon, "G21 G17 G90 G94", "")
    if result > gcode.MIN_ERROR:
        sys.exit("%s:%d: %s" % (program, line, gcode.strerror(result)))
    return canon.list


class Klipper:
    """klippy/toolhead.py, klippy/kinematics/cartesian.py and klippy/extras/gcode_arcs.py without a printer."""

    def __init__(self, folder):
        klippy = pathlib.Path(folder) / "klippy"
        for name in ("mcu", "chelper", "stepper", "kinematics", "kinematics.extruder", "kinematics.idex_modes"):
            sys.modules.setdefault(name, types.ModuleType(name))
        sys.modules["kinematics"].__path__ = []
        sys.modules["kinematics"].extruder = sys.modules["kinematics.extruder"]
        sys.modules["kinematics"].idex_modes = sys.modules["kinematics.idex_modes"]
        self.toolhead = self.load("klipper_toolhead", klippy / "toolhead.py")
        self.cartesian = self.load("kinematics.cartesian", klippy / "kinematics/cartesian.py")
        self.arcs = self.load("klipper_arcs", klippy / "extras/gcode_arcs.py")

    @staticmethod
    def load(name, path):
        spec = importlib.util.spec_from_file_location(name, path)
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        return module

    def time(self, moves, acceleration, options, velocity, planned=None):
        """s; appends the planned moves, and dwells as their seconds, to `planned`."""
        head = types.SimpleNamespace(
            max_velocity=velocity, max_accel=acceleration, extra_axes=[],
            square_corner_velocity=options.get("square_corner_velocity", 5.0),
            min_cruise_ratio=options.get("minimum_cruise_ratio", 0.5))
        self.toolhead.ToolHead._calc_junction_deviation(head)
        limits = types.SimpleNamespace(limits=[(-1e9, 1e9)] * 3, max_z_velocity=velocity, max_z_accel=acceleration,
                                       _check_endstops=lambda move: None)
        queue = self.toolhead.LookAheadQueue()
        total, at = 0.0, [0.0, 0.0, 0.0, 0.0]

        def flush(lazy):
            nonlocal total
            for move in queue.flush(lazy=lazy):
                total += move.accel_t + move.cruise_t + move.decel_t
                if planned is not None:
                    planned.append(move)

        def go(to, speed):
            nonlocal at
            move = self.toolhead.Move(head, at, list(to) + [0.0], speed)
            if not move.move_d:
                return
            self.cartesian.CartKinematics.check_move(limits, move)
            at = list(move.end_pos)
            if queue.add_move(move):
                flush(True)

        for move in moves:
            if move[0] == "dwell":
                flush(False)
                total += move[1]
                if planned is not None:
                    planned.append(float(move[1]))
            elif move[0] == "line":
                go(move[1], head.max_velocity if move[2] is None else move[2])
            else:
                _, to, center, rotation, (first, second, third), feed = move
                arc = types.SimpleNamespace(mm_per_arc_segment=options.get("resolution", 1.0), gcode=types.SimpleNamespace(
                    create_gcode_command=lambda name, line, words: words))
                arc.gcode_move = types.SimpleNamespace(cmd_G1=lambda words: go([words[a] for a in "XYZ"], feed))
                command = types.SimpleNamespace(get_float=lambda name, default: default)
                self.arcs.ArcSupport.planArc(arc, list(at), list(to), (center[first] - at[first], center[second] - at[second]),
                                             rotation < 0, command, True, first, second, third)
        flush(False)
        return total


def sampled(moves, seconds):
    """Positions every T of planned moves, mm: along each its trapezoid of speed, one after another."""
    import numpy as np

    count = int(np.ceil(seconds / T)) + 1
    samples, begin, next_one = np.zeros((count, 3)), 0.0, 0
    at = np.zeros(3)
    for move in moves:
        if isinstance(move, float):  # a dwell
            end, from_, ratio, way = begin + move, at, np.zeros(3), None
        else:
            end = begin + move.accel_t + move.cruise_t + move.decel_t
            from_, ratio = np.array(move.start_pos[:3]), np.array(move.axes_r[:3])
            way = move
        last = min(count, int(np.ceil(end / T - 1e-9)))
        t = T * np.arange(next_one, last) - begin
        if way is None:
            samples[next_one:last] = at
        else:
            up, flat = np.clip(t, 0, move.accel_t), np.clip(t - move.accel_t, 0, move.cruise_t)
            down = np.clip(t - move.accel_t - move.cruise_t, 0, move.decel_t)
            along = (move.start_v * up + 0.5 * move.accel * up**2 + move.cruise_v * flat
                     + move.cruise_v * down - 0.5 * move.accel * down**2)
            samples[next_one:last] = from_ + along[:, None] * ratio
            at = np.array(move.end_pos[:3])
        begin, next_one = end, max(next_one, last)
    samples[next_one:] = at
    return samples


def main(folder, program, out, acceleration, velocity):
    import numpy as np

    with contextlib.redirect_stdout(io.StringIO()):
        moves = moves_of(program)
    planned = []
    seconds = Klipper(folder).time(moves, float(acceleration), {}, float(velocity), planned)
    np.savetxt(out, sampled(planned, seconds), fmt="%.9f", delimiter=",", header="x_mm,y_mm,z_mm", comments="")


if __name__ == "__main__":
    main(*sys.argv[1:])
