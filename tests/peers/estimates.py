#!/usr/bin/python3
"""What accdec program --as predicts, beside the planners of the other controls themselves. See README.md.

Programs are read by LinuxCNC's interpreter, so accdec's reader is not part of the reference. Klipper's look-ahead and its
arcs run in this process, GRBL's planner is compiled with a driver; both come from folders with their sources. LinuxCNC's
times are those that league.py measured.
"""
import argparse
import contextlib
import csv
import io
import json
import pathlib
import statistics
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import klipper
import league_rows
import programs as peers

CONTROLS = ["klipper", "grbl", "linuxcnc-2.9"]
# Settings beside the defaults, to try the rules; LinuxCNC was measured with its defaults only.
OTHER = {
    "klipper": {"square_corner_velocity": 20, "minimum_cruise_ratio": 0, "resolution": 0.2},
    "grbl": {"junction_deviation": 0.05, "arc_tolerance": 0.01, "steps_per_mm": 1000},
}
# arc-corners.ngc with these tolerances, 1000 mm/s^2: LinuxCNC 2.9's times in s, measured by linuxcnc/run.
ARC_CORNERS = {"0.01": 5.780, "0.05": 5.464, "0.5": 4.800}
COLUMNS = ["program", "acceleration_max", "control", "options", "planner_s", "estimate_s"]


def arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--accdec", default=str(peers.ROOT / "build/release/apps/accdec"))
    parser.add_argument("--klipper", required=True, help="folder of Klipper's sources, as git clones them")
    parser.add_argument("--grbl", required=True, help="folder of GRBL's sources, as git clones them")
    parser.add_argument("--out", default=str(peers.ROOT / "results/program"), help="folder for estimates.csv and .md")
    return parser.parse_args()


GRBL_DRIVER = r"""
#include "grbl.h"
#include <stdio.h>
system_t sys; settings_t settings; int32_t sys_position[N_AXIS];
volatile uint8_t sys_rt_exec_state;
static double total;
/* One block leaves the buffer: its time by the trapezoid of its planned speeds, which are in mm and min. */
static void run_block(void) {
  plan_block_t *block = plan_get_current_block();
  if (!block) return;
  double entry = block->entry_speed_sqr, leave = plan_get_exec_block_exit_speed_sqr(), a = block->acceleration;
  double most = plan_compute_profile_nominal_speed(block), length = block->millimeters;
  double top = a * length + 0.5 * (entry + leave);
  if (top > most * most) top = most * most;
  double v = sqrt(top), v0 = sqrt(entry), v1 = sqrt(leave), cruise = length - (2 * top - entry - leave) / (2 * a);
  if (top < entry || top < leave) total += 2 * length / (v0 + v1);
  else total += (2 * v - v0 - v1) / a + (cruise > 0 ? cruise / v : 0);
  plan_discard_current_block();
}
void protocol_execute_realtime(void) { if (plan_check_full_buffer()) run_block(); }
void protocol_auto_cycle_start(void) {}
void protocol_buffer_synchronize(void) { while (plan_get_current_block()) run_block(); }
void st_update_plan_block_parameters(void) {}
uint8_t get_direction_pin_mask(uint8_t axis) { return 1 << axis; }
void limits_soft_check(float *target) { (void)target; }
void spindle_sync(uint8_t state, float speed) { (void)state, (void)speed; }
int main(int count, char **word) {
  double acceleration = atof(word[1]), velocity = atof(word[2]);
  for (int i = 0; i < N_AXIS; ++i) {
    settings.steps_per_mm[i] = atof(word[5]);
    settings.max_rate[i] = 60 * velocity;
    settings.acceleration[i] = acceleration * 3600;
  }
  settings.junction_deviation = atof(word[3]);
  settings.arc_tolerance = atof(word[4]);
  sys.f_override = sys.r_override = 100;
  plan_reset();
  char kind; float at[N_AXIS] = {0}, to[N_AXIS], offset[N_AXIS], feed; double seconds; int a0, a1, a2, clockwise;
  while (scanf(" %c", &kind) == 1) {
    if (kind == 'D') { scanf("%lf", &seconds); protocol_buffer_synchronize(); total += seconds / 60; continue; }
    plan_line_data_t data; memset(&data, 0, sizeof data);
    scanf("%f %f %f %f", to, to + 1, to + 2, &feed);
    data.feed_rate = feed;
    if (feed < 0) data.condition = PL_COND_FLAG_RAPID_MOTION;
    if (kind == 'L') mc_line(to, &data);
    else {
      scanf("%f %f %f %d %d %d %d", offset, offset + 1, offset + 2, &a0, &a1, &a2, &clockwise);
      float here[N_AXIS]; memcpy(here, at, sizeof at);
      mc_arc(to, &data, here, offset, hypot_f(offset[a0], offset[a1]), a0, a1, a2, clockwise);
    }
    memcpy(at, to, sizeof at);
  }
  protocol_buffer_synchronize();
  printf("%.9f\n", 60 * total);
  return count != 6;
}
"""
AVR = {"avr/io.h": "", "avr/pgmspace.h": "#define PSTR(s) s\n", "avr/interrupt.h": "", "avr/wdt.h": "",
       "util/delay.h": "static inline void _delay_ms(double t) { (void)t; }\nstatic inline void _delay_us(double t) { (void)t; }\n"}


class Grbl:
    """grbl/planner.c, motion_control.c (arcs) and nuts_bolts.c, compiled for this machine."""

    def __init__(self, folder, work):
        for name, text in AVR.items():
            (work / name).parent.mkdir(exist_ok=True)
            (work / name).write_text(text)
        (work / "driver.c").write_text(GRBL_DRIVER)
        source = pathlib.Path(folder) / "grbl"
        self.program = work / "grbl"
        subprocess.check_call(
            ["gcc", "-std=gnu99", "-O2", "-w", "-fcommon", "-ffunction-sections", "-Wl,--gc-sections", "-I", str(work), "-I",
             str(source), "-Dhypot_f=hypotf", "-DF_CPU=16000000", "-include", "math.h", "-include", "stdlib.h", "-include",
             "string.h", "-o", str(self.program), str(work / "driver.c")]
            + [str(source / name) for name in ("planner.c", "motion_control.c", "nuts_bolts.c")] + ["-lm"])

    def time(self, moves, acceleration, options):
        lines, at = [], [0.0, 0.0, 0.0]
        for move in moves:
            if move[0] == "dwell":
                lines.append("D %.9g" % move[1])
                continue
            point = "%.9g %.9g %.9g " % tuple(move[1])
            if move[0] == "line":
                lines.append("L " + point + "%.9g" % (-1 if move[2] is None else 60 * move[2]))
            else:
                _, to, center, rotation, axes, feed = move
                lines.append("A " + point + "%.9g " % (60 * feed) + "%.9g %.9g %.9g " % tuple(
                    c - a for c, a in zip(center, at)) + "%d %d %d " % axes + "%d" % (rotation < 0))
            at = move[1]
        words = [acceleration, peers.VELOCITY, options.get("junction_deviation", 0.01), options.get("arc_tolerance", 0.002),
                 options.get("steps_per_mm", 250)]
        return float(subprocess.run([str(self.program)] + ["%g" % w for w in words], input="\n".join(lines) + "\n", text=True,
                                    stdout=subprocess.PIPE, check=True).stdout)


def estimates(accdec, program, task, settings):
    """By control. The plan beside them needs little time and does not matter."""
    words = [w for control in settings for w in ("--as", control)]
    for name, value in {name: value for own in settings.values() for name, value in own.items()}.items():
        words += ["--as-option", "%s=%g" % (name, value)]
    done = subprocess.run([accdec, "program", str(program), "--task", str(task), *words, "--time-limit", "0.5", "--json",
                           "-", "--quiet"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if not done.stdout:
        sys.exit("%s: %s" % (program, done.stderr))
    return {one["control"]: one["time_s"] for one in json.loads(done.stdout)["estimates"]}


def measured(out):
    rows = league_rows.read(out / "league.csv")
    return {(row["program"], row["acceleration"]): row["time_s"] for row in rows
            if row["planner"] == "LinuxCNC 2.9" and not row["jerk"] and row["time_s"]}


def error(row):
    """Of an estimate, %."""
    return 100 * (float(row[5]) / float(row[4]) - 1)


HEAD = """# Times of other controls: estimates beside their planners

Written by `tests/peers/estimates.py`. `accdec program --as CONTROL` estimates the time that another control needs. Here
are its estimates beside what the controls' own planners say, at %d mm/s per axis and the accelerations in the tables.

| control | cases | median of the error, %% | largest, %% | the time beside it |
|---|--:|--:|--:|---|
%s

* Klipper: `LookAheadQueue` and `Move` of klippy/toolhead.py, `check_move` of a Cartesian printer and the arcs of
  gcode_arcs.py (commit %s) ran in Python, without a printer.
* GRBL: planner.c, motion_control.c and nuts_bolts.c of 1.1h (commit %s) were compiled for a PC. A driver keeps
  their buffer full and times the planned trapezoids. The stepper's interrupts were not run.
* LinuxCNC: the times of 2.9 (Debian) in simulation, measured by `league.py` as [league.md](league.md) says.

All programs were read by LinuxCNC's interpreter for these times, and by accdec's reader for the estimates.

The programs are of [league.md](league.md), and `tests/peers/arc-corners.ngc` with corners between lines and arcs.
LinuxCNC's times of the latter vary by a few ms from run to run. On a busy computer it once read the program too late to
look ahead at its start: 5.722 s instead of 5.464 s.

Not run, so not known:

* real machines, whose buffers may run empty
* other versions of these controls
* Klipper with an extruder
* LinuxCNC with [TRAJ] limits below those of the axes, or with helices at corners

`--as linuxcnc-2.9` also estimates moves of other axes than X Y Z. With an axis A (`PEER_AXIS_A=1`), LinuxCNC took 5.646
s for `rotary-stops.ngc`, estimated 5.644 s, and 6.259 s for `rotary.ngc`, estimated 6.362 s. The other estimates refuse
such moves.
"""


def commit(folder):
    done = subprocess.run(["git", "-C", folder, "rev-parse", "--short", "HEAD"], stdout=subprocess.PIPE, text=True)
    return done.stdout.strip() or "unknown"


def page(rows, klipper, grbl):
    beside = {"klipper": "its look-ahead, run", "grbl": "its planner, run", "linuxcnc-2.9": "its samples, measured"}
    lines = []
    for control in CONTROLS:
        errors = [abs(error(row)) for row in rows if row[2] == control]
        if errors:
            lines.append("| %s | %d | %.4f | %.4f | %s |" % (control, len(errors), statistics.median(errors), max(errors),
                                                         beside[control]))
    text = HEAD % (peers.VELOCITY, "\n".join(lines), klipper, grbl)
    for control in CONTROLS:
        text += "\n## %s\n\n| program | mm/s^2 | settings | %s, s | estimate, s | error, %% |\n|---|--:|---|--:|--:|--:|\n" % (
            control, "measured" if control == "linuxcnc-2.9" else "its planner")
        for row in rows:
            if row[2] == control:
                text += "| %s | %s | %s | %s | %s | %+.3f |\n" % (row[0], row[1], row[3] or "default", row[4], row[5], error(row))
    return text


def main():
    options = arguments()
    out = pathlib.Path(options.out)
    linuxcnc = measured(out)
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        planners = {"klipper": klipper.Klipper(options.klipper), "grbl": Grbl(options.grbl, folder)}
        cases = [case[:3] for case in peers.cases(options.accdec, folder)]
        for tolerance, seconds in ARC_CORNERS.items():
            program = folder / ("arc-corners-p%s.ngc" % tolerance)
            program.write_text((HERE / "arc-corners.ngc").read_text().replace("P0.05", "P" + tolerance))
            cases.append((program.stem, program, 1000))
            linuxcnc[program.stem, 1000] = seconds
        for name, program, acceleration in cases:
            program = peers.fair(program, folder)
            with contextlib.redirect_stdout(io.StringIO()):
                moves = klipper.moves_of(program)
            task = peers.task_file(folder, acceleration, None)
            for settings in ({control: {} for control in CONTROLS}, OTHER):
                found = estimates(options.accdec, program, task, settings)
                for control, own in settings.items():
                    if control == "linuxcnc-2.9":
                        reference = linuxcnc.get((name, acceleration))
                        if reference is None:  # no motion in the league
                            continue
                    else:
                        reference = planners[control].time(moves, acceleration, own, peers.VELOCITY)
                    rows.append([name, acceleration, control, " ".join("%s=%g" % item for item in own.items()),
                                 "%.4f" % reference, "%.4f" % found[control]])
                    print(*rows[-1], "%+.3f %%" % error(rows[-1]), flush=True)
    with open(out / "estimates.csv", "w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([COLUMNS] + rows)
    (out / "estimates.md").write_text(page(rows, commit(options.klipper), commit(options.grbl)))


if __name__ == "__main__":
    main()
