#pragma once

#include <map>
#include <string>
#include <vector>

#include <accdec/estimate/control_moves.hpp>

// The planners of other controls, in klipper.cpp, grbl.cpp and linuxcnc.cpp. All return seconds.

namespace accdec {

/// Its settings in SI units, by name.
using ControlSettings = std::map<std::string, double, std::less<>>;

/// Klipper's look-ahead: klippy/toolhead.py, klippy/extras/gcode_arcs.py and klippy/kinematics/cartesian.py of August
/// 2026; docs/Kinematics.md explains the rules.
double klipper_time(const std::vector<ControlMove>& moves, const ControlSettings& settings);

/// GRBL 1.1h's look-ahead: grbl/planner.c and grbl/motion_control.c.
double grbl_time(const std::vector<ControlMove>& moves, const ControlLimits& limits, const ControlSettings& settings);

/// LinuxCNC 2.9's trajectory planner: src/emc/tp and src/emc/task/emccanon.cc.
double linuxcnc_time(const std::vector<ControlMove>& moves, const ControlLimits& limits,
                     const ControlSettings& settings);

}  // namespace accdec
