#!/usr/bin/python3
"""moves.py PROGRAM.ngc: the points a program asks for, by LinuxCNC's own interpreter (its python module gcode).

One line a point, mm: x y z tolerance kind. `tolerance` is G64 P in force at the end of the move, 0 for exact path and
stop, and kind is `corner` for the end of a move and `arc` for a point inside an arc. The first line is the start.
"""
import math
import os
import re
import shutil
import sys
import tempfile

import gcode
from rs274 import interpret

INCH = 25.4
ARC_STEP = 0.25  # mm, largest distance of the points written of an arc
ARC_CHORD = 2e-4  # mm, largest distance of their chords from it


class Canon(interpret.Translated):
    """Receives the interpreter's canonical calls, lengths in inches."""

    def __init__(self, tolerances, parameter_file):
        self.parameter_file = parameter_file
        self.tolerances = tolerances  # of every line of the program, mm
        self.line = 0
        self.plane = 1
        self.at = [0.0, 0.0, 0.0]
        self.g5x_index = 1
        for axis in "xyzabcuvw":
            setattr(self, "g5x_offset_" + axis, 0.0)
            setattr(self, "g92_offset_" + axis, 0.0)
        self.rotation_cos, self.rotation_sin = 1.0, 0.0

    def tolerance(self):
        return self.tolerances[min(self.line, len(self.tolerances)) - 1]

    def point(self, p, kind):
        print("%.9f %.9f %.9f" % tuple(p), self.tolerance(), kind)

    def straight(self, *p):
        to = [INCH * v for v in p[:3]]
        if max(abs(a - b) for a, b in zip(to, self.at)) > 1e-9:
            self.point(to, "corner")
        self.at = to

    straight_traverse = straight_feed = straight_probe = straight

    def arc_feed(self, x1, y1, cx, cy, rotation, z1, *rest):
        first, second, third = {1: (0, 1, 2), 2: (1, 2, 0), 3: (2, 0, 1)}[self.plane]
        x1, y1, cx, cy, z1 = (INCH * v for v in (x1, y1, cx, cy, z1))
        x0, y0, z0 = self.at[first], self.at[second], self.at[third]
        r0, r1 = math.hypot(x0 - cx, y0 - cy), math.hypot(x1 - cx, y1 - cy)
        a0, a1 = math.atan2(y0 - cy, x0 - cx), math.atan2(y1 - cy, x1 - cx)
        turn = (a1 - a0) * (1 if rotation > 0 else -1) % (2 * math.pi)
        if turn < 1e-6:
            turn += 2 * math.pi
        turn = (turn + 2 * math.pi * (abs(rotation) - 1)) * (1 if rotation > 0 else -1)
        radius = max(r0, r1)
        count = max(2, math.ceil(abs(turn) * radius / min(ARC_STEP, math.sqrt(8 * radius * ARC_CHORD))))
        for i in range(1, count + 1):
            t = i / count
            to = [0.0, 0.0, 0.0]
            r, a = r0 + t * (r1 - r0), a0 + t * turn
            to[first], to[second], to[third] = cx + r * math.cos(a), cy + r * math.sin(a), z0 + t * (z1 - z0)
            if i == count:
                to[first], to[second] = x1, y1
            self.at = to
            self.point(to, "corner" if i == count else "arc")

    def next_line(self, state):
        self.line = state.sequence_number

    def set_plane(self, plane):
        self.plane = plane

    def ignore(self, *arguments):
        pass

    set_feed_rate = dwell = comment = message = set_traverse_rate = set_feed_mode = select_plane = change_tool = ignore
    tool_offset = set_spindle_rate = user_defined_function = ignore

    def check_abort(self):
        return False

    def get_tool(self, pocket):
        return (-1,) + (0.0,) * 9 + (0.0, 0.0, 0.0, 0)

    def get_block_delete(self):
        return False

    def get_external_length_units(self):
        return 1.0

    def get_external_angular_units(self):
        return 1.0

    def get_axis_mask(self):
        return 7


def tolerances_of(program):
    """G64 P in force on every line, mm; the interpreter keeps path modes to itself."""
    tolerances, now, unit = [], 0.0, 1.0
    for line in open(program):
        line = re.sub(r"\(.*?\)|;.*", "", line).upper()
        if re.search(r"G0*61(\.1)?(?![\d.])", line):
            now = 0.0
        units = re.findall(r"G0*2([01])(?![\d.])", line)
        if units:
            unit = INCH if units[-1] == "0" else 1.0
        blend = re.search(r"G0*64(?![\d.])", line)
        if blend:
            p = re.search(r"P\s*([\d.]+)", line)
            now = unit * float(p.group(1)) if p else 0.0
        tolerances.append(now)
    return tolerances


def main(program):
    folder = tempfile.mkdtemp()
    try:
        parameters = os.path.join(folder, "parameters.var")
        open(parameters, "w").close()
        canon = Canon(tolerances_of(program), parameters)
        canon.point([0.0, 0.0, 0.0], "corner")
        result, line = gcode.parse(program, canon, "G21 G17 G90 G94", "")
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    if result > gcode.MIN_ERROR:
        sys.exit("%s:%d: %s" % (program, line, gcode.strerror(result)))


if __name__ == "__main__":
    main(sys.argv[1])
