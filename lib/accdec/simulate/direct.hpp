#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <accdec/filter.hpp>
#include <accdec/machine.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

/// The filter that each block's command passes: one for all, or, in results of earlier versions (`--plan per-leg`), one
/// of several, that changes only where legs meet.
struct BlockFilters {
  std::vector<Filter> filters{Filter{{1.0}}};
  std::vector<std::uint16_t> of_block;  ///< index of the filter of every block; empty: the first for all
  int behind = 0;                       ///< samples in which a servo behind the filters comes to rest

  std::size_t index(std::size_t block) const { return of_block.empty() ? 0 : of_block[block]; }
  const Filter& of(std::size_t block) const { return filters[index(block)]; }
  int order_max() const;
};

/// The motion of a whole program, straight from the definitions (CommandTiming defines a command). Every sample of the
/// command is written down. Each step is spread over the next samples by the taps of its block's filter, and the sums
/// are the motion. It shares no code with simulate_program, keeps every sample in memory and takes
/// O(samples taps axes): for rechecks of small programs. Long rests are cut short where nothing moves any more.
struct DirectMotion {
  struct Window {
    std::int64_t first = 0, last = 0;  ///< kept samples in which the motion passes a joint
  };
  struct Cut {
    std::int64_t before = 0, count = 0;  ///< so many samples of rest are left out before this kept one
  };
  /// The kept sample with the motion of sample k.
  std::int64_t kept(std::int64_t k) const;

  std::int64_t samples = 0;                   ///< as Simulation::samples
  std::vector<Cut> cuts;                      ///< ascending
  std::vector<std::vector<double>> position;  ///< of every axis, m, by kept sample; rest before and after included
  std::vector<std::vector<double>> velocity;  ///< m/s
  std::vector<Window> windows;                ///< one per block except the last, for the joint at its end
};

/// Steps of all axes that `direct_motion` would make: its cost, by which to refuse it.
double direct_motion_steps(const Toolpath& path, double sample_period, std::span<const int> delays,
                           const BlockFilters& filters);

DirectMotion direct_motion(const Toolpath& path, double sample_period, std::span<const int> delays,
                           const BlockFilters& filters);

/// The motion that the servos of the axes make of a command, sample by sample. With a gain Kv and a feedforward g, the
/// following error after a sample of constant velocity v is
///   e[k] = a e[k-1] + (1 - g) (1 - a)/Kv v[k],  a = exp(-Kv T).
/// It is the state of the loop and knows no taps. Measured taps are summed product by product. Axes may differ.
/// @param command  its rests as long as the servos need, see BlockFilters::behind  @param machine  as many axes
DirectMotion behind_servos(const DirectMotion& command, const Machine& machine, double sample_period);

/// Samples from the end of the command, DirectMotion::samples, until the motion stays within a distance in m of the end
/// of the path.
std::int64_t direct_settling(const DirectMotion& motion, const Toolpath& path, double within);

/// Least distance of the motion from a point within kept samples, m. @param between  of the polyline through them, too
double direct_distance(const DirectMotion& motion, const double* point, std::int64_t first, std::int64_t last,
                       bool between);
/// Least distance of the motion from the joint at the end of block b within its window, m. For corners and stops it is
/// the distance of the samples, for the others that of the polyline through them.
double direct_error(const DirectMotion& motion, const Toolpath& path, std::size_t b);

}  // namespace accdec
