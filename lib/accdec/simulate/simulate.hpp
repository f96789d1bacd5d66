#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <accdec/filter.hpp>
#include <accdec/machine.hpp>
#include <accdec/simulate/command_stream.hpp>
#include <accdec/verify.hpp>

namespace accdec {

/// Receives the filtered motion: `count` samples from sample number `first` on. position[i] and velocity[i] point to
/// the values of axis i, in m and m per sample.
using SampleSink = std::function<void(std::int64_t first, std::int64_t count, const double* const* position,
                                      const double* const* velocity)>;

/// m/s, up to which an axis of a program stands still: in a sample it moves no farther than positions can tell. Its dry
/// friction then takes whatever part of the force helps.
constexpr double standing_speed(double sample_period) {
  return position_floor / sample_period;
}

struct SimulationOptions {
  const Machine* machine = nullptr;  ///< as many axes as the path; none: limits are not checked
  bool blame = false;                ///< find the blocks during whose command a limit is broken, see Simulation::broken
  SampleSink samples;                ///< if set, gets every sample, including those of steady motion
  std::span<const Filter> motion{};  ///< behind the servo, see simulate_program; none: the filter itself
  bool whole_windows = false;        ///< search the whole window of every joint, see the errors of simulate_program
};

/// Result of the simulation of a program, or of a part of it.
struct Simulation {
  std::int64_t samples =
      0;  ///< from the last at rest before to the first at rest after the motion, and the dwell after that
  std::vector<LimitUse>
      limits;  ///< worst use of every finite axis limit; `sample` counts from the start of the program
  std::vector<std::uint32_t> broken;  ///< blocks commanded (or about to be, after their delay) when a limit was broken
  /// Points of the path where the motion leaves the blocks by more than Toolpath::contour_max, ascending. Point b + 1
  /// is that of joint b.
  struct OffPath {
    std::uint32_t point = 0;
    double use = 0.0;  ///< of what is allowed
  };
  std::vector<OffPath> off;
};

/// Filters the command samples of a program and follows the motion sample by sample.
///
/// A change of the command by D at a sample adds D b_0, D b_1 .. to the N + 1 following changes of velocity. So each
/// change costs O(N), however many moves overlap, and each sample a few additions. If nearly every sample has a change,
/// as in finely divided programs, the same products are summed sample by sample instead, several samples per
/// instruction. Stretches of steady motion are passed over in one step. Velocity and
/// position are computed from the command again every few thousand samples, so that rounding does not accumulate.
///
/// With `options.motion`, one filter for all axes or one an axis, the filter is that of the command. Errors, loads and
/// the sink's samples are then of the motion behind the servo, all other limits and the number of samples of the
/// command.
///
/// Limits of a path (Toolpath::contour_max, see PathContour) and of modes of axes (ModeWatch) stand behind all others.
///
/// @param first, last  blocks to simulate; the motion begins and ends at rest there
/// @param errors       of every joint first .. last - 1, indexed by block: min |S| over the samples of its window
/// [reached, left +
///                     N + 1] for corners and stops, the distance of the path through those samples for smooth and
///                     straight joints, m; N is the order of the motion's filter. Unless the whole windows
///                     are asked for, samples near the middle of the window are searched first, and others only if
///                     these are not within the tolerance
Simulation simulate_program(const CommandTiming& timing, const Filter& filter, std::size_t first, std::size_t last,
                            std::span<double> errors, const SimulationOptions& options = {});

/// The time model: samples of the motion as simulate_program counts them, from the timing alone.
std::int64_t motion_samples(const CommandTiming& timing, const Filter& filter);

}  // namespace accdec
