#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <accdec/machine/utilisation.hpp>
#include <accdec/program/simulate/command_stream.hpp>
#include <accdec/program/simulate/leg_filters.hpp>

namespace accdec {

/// Receives the filtered motion: `count` samples from sample number `first` on; position[i] and velocity[i] point at
/// the values of axis i, m and m a sample.
using SampleSink = std::function<void(std::int64_t first, std::int64_t count, const double* const* position,
                                      const double* const* velocity)>;

struct SimulationOptions {
  const Machine* machine = nullptr;  ///< as many axes as the path; none: limits are not looked at
  bool blame = false;                ///< find the blocks during whose command a limit is broken, see Simulation::broken
  SampleSink samples;                ///< when set, gets every sample, those of steady motion included
  bool whole_windows = false;        ///< search the whole window of every joint, see the errors of simulate_program
};

/// What the simulation of a program, or of a part of it, found.
struct Simulation {
  std::int64_t samples =
      0;  ///< from the last at rest before to the first at rest after the motion, and the dwell after that
  std::vector<LimitUse>
      limits;  ///< worst use of every finite axis limit; `sample` counts from the start of the program
  std::vector<std::uint32_t> limit_lines;  ///< line of the block commanded when it occurred, one a limit
  std::vector<std::uint32_t> broken;  ///< blocks commanded (or about to be, after their delay) when a limit was broken
};

/// Filters the command samples of a program and follows the motion sample by sample.
///
/// A change of the command by D at a sample adds D b_0, D b_1 .. to the N + 1 following changes of velocity: the cost
/// is that of the changes, O(N) each, whatever the number of moves that overlap, plus a few additions a sample. Where
/// nearly every sample has a change, as in finely divided programs, the same products are summed sample by sample
/// instead, several samples an instruction. Stretches of steady motion are passed over in one step. Where legs have
/// filters of their own, a leg ends by a change to rest through its filter and the next starts through its own, so that
/// what is followed is the sum of all legs' filtered commands. Velocity and position are anew computed from the command
/// every few thousand samples, so that rounding does not accumulate.
///
/// @param first, last  blocks to simulate; the motion begins and ends at rest there
/// @param errors       of every joint first .. last - 1, indexed by block: min |S| over the samples of its window
/// [reached, left +
///                     N + 1] for corners and stops, the distance of the path through those samples for smooth and
///                     straight joints, m; N is the order of the longer of the two legs' filters. Where moves overlap a
///                     path may come near a joint more than once; unless the whole windows are asked for, an approach
///                     that is within the tolerance is taken for the nearest
Simulation simulate_program(const CommandTiming& timing, const LegFilters& filters, std::size_t first, std::size_t last,
                            std::span<double> errors, const SimulationOptions& options = {});

/// The time model: samples of the motion as simulate_program counts them, from the timing alone. The last leg to end is
/// not always the last to come to rest.
std::int64_t motion_samples(const CommandTiming& timing, const LegFilters& filters);

}  // namespace accdec
