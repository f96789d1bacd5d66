#pragma once

#include <vector>

#include <accdec/estimate/control_moves.hpp>

namespace accdec {

/// A straight move of a control that cuts arcs into lines.
struct Segment {
  Vector direction;     ///< unit
  double length = 0.0;  ///< m
  double feed = 0.0;    ///< m/s
  bool rapid = false;
  bool rests = false;  ///< the control waits at its end for the motion to stop
  double dwell = 0.0;  ///< s, at its end
};

/// How many lines a control makes of an arc.
using ArcCut = double (*)(const ControlMove& arc, double setting);

/// @param rests_for_words  M codes wait for the motion to stop
std::vector<Segment> segments_of(const std::vector<ControlMove>& moves, ArcCut cut, double setting,
                                 bool rests_for_words);

}  // namespace accdec
