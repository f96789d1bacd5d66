#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <accdec/program/read/toolpath.hpp>
#include <accdec/program/simulate/leg_filters.hpp>

namespace accdec {

/// The motion of a whole program, straight from the definitions (see CommandTiming for what a command is): every
/// sample of the command is written down, each of its steps is spread over the next samples by the taps of its leg, and
/// everything is read off the sums. Shares no code with simulate_program, keeps every sample in memory and takes
/// O(samples taps axes): for rechecks of small programs.
struct DirectMotion {
  struct Window {
    std::int64_t first = 0, last = 0;  ///< samples in which the motion passes a joint
  };
  std::int64_t samples = 0;                   ///< as Simulation::samples
  std::vector<std::vector<double>> position;  ///< of every axis, m, by sample; rest before and after included
  std::vector<std::vector<double>> velocity;  ///< m/s
  std::vector<Window> windows;                ///< one a block but the last, of the joint at its end
};

/// Steps of all axes that `direct_motion` would make: its cost, and what to refuse it by.
double direct_motion_steps(const Toolpath& path, double sample_period, std::span<const int> delays,
                           const LegFilters& legs);

DirectMotion direct_motion(const Toolpath& path, double sample_period, std::span<const int> delays,
                           const LegFilters& legs);

/// Least distance of the motion from the joint at the end of block b within its window, m: of the samples for corners
/// and stops, of the polyline through them for the others.
double direct_error(const DirectMotion& motion, const Toolpath& path, std::size_t b);

}  // namespace accdec
