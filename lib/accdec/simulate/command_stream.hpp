#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include <accdec/simulate.hpp>

namespace accdec {

/// Number of whole samples for `length` samples of time, rounded up. Sums of many durations depend on their order, by
/// about 1e-13 of them. A time that exceeds whole samples by up to a hundred times as much still counts as that many.
inline std::int64_t whole_samples(double length) {
  return static_cast<std::int64_t>(std::ceil(length - 1e-9 - 1e-11 * length));
}

/// A joint this near a sample, in samples, counts as on it. Positions are those of its own time.
inline constexpr double near_sample = 1e-9;

/// How a program becomes a stream of command samples. The time model, the simulation and the planner share this
/// definition.
///
/// A *run* is a maximal sequence of blocks joined by smooth or straight joints without delay. Its blocks take D = sum
/// L_i/(v_i T) samples at their feeds. The run is commanded in n = ceil(D) whole samples (see `whole_samples`) with all
/// its feeds lowered by D/n. So it begins and ends exactly on a sample. Within a run a joint may fall between two
/// samples: the command position at a sample is the point of the path reached at that time. After a run the command
/// rests for the delay of its last joint (and the dwell, in whole samples). After the last sample of the command the
/// filter needs N + 1 more to come to rest.
class CommandTiming {
 public:
  /// @param delays  samples, one per block (of the joint at its end; the last one is not used); kept by reference
  CommandTiming(const Toolpath& path, double sample_period, std::span<const int> delays)
      : path_(path), sample_period_(sample_period), delays_(delays) {}

  /// Whether a run ends with block b.
  bool ends_run(std::size_t b) const { return ends_leg(path_, b) || delays_[b] > 0; }
  std::size_t run_end(std::size_t first) const {
    while (!ends_run(first)) ++first;
    return first;
  }
  /// First block of the run of block b.
  std::size_t run_begin(std::size_t b) const {
    while (b > 0 && !ends_run(b - 1)) --b;
    return b;
  }
  /// D of blocks first .. last, samples, not rounded.
  double run_length(std::size_t first, std::size_t last) const {
    // Four independent sums, so that none waits for another.
    std::array<double, 4> sum{};
    std::size_t b = first;
    for (; b + 3 <= last; b += 4) {
      for (std::size_t i = 0; i < 4; ++i) sum[i] += path_.duration[b + i];
    }
    for (; b <= last; ++b) sum[0] += path_.duration[b];
    return ((sum[0] + sum[1]) + (sum[2] + sum[3])) / sample_period_;
  }
  /// n of a run of length D.
  static std::int64_t run_samples(double length) { return std::max<std::int64_t>(1, whole_samples(length)); }
  std::int64_t dwell_samples(double dwell) const { return whole_samples(dwell / sample_period_); }

  const Toolpath& path() const { return path_; }
  double sample_period() const { return sample_period_; }
  int delay(std::size_t b) const { return delays_[b]; }

  /// All command samples of the program: runs, delays and dwells.
  std::int64_t command_samples() const;
  /// Samples of the dwells after the last block, during which the command rests at the end of the path.
  std::int64_t dwell_last() const;

 private:
  const Toolpath& path_;
  double sample_period_;
  std::span<const int> delays_;
};

/// When the command begins and ends every block, in samples.
struct BlockTimes {
  std::vector<double> begins, ends;  ///< the last block never ends
};
/// Blocks first .. last, whose command begins with the first. The dwell before a program counts.
BlockTimes block_times(const CommandTiming& timing, std::size_t first, std::size_t last);

/// Values of all axes. @tparam axes  their number; 0: only known at run time
template <std::size_t axes>
using AxisRow = std::array<double, (axes > 0 ? axes : program_axis_count)>;

/// Emits the command samples of blocks first .. last, which must begin and end with runs, to
///   sink.command(u0, u, count, end)  `count` samples, the first moving by u0, the others by u (m, AxisRow), the last
///   reaching `end` sink.joint(b, time, rest)        joint b is reached `time` samples after the beginning, where the
///   command then rests for `rest`
/// joint comes after the command that reaches it, and before anything later. The joint of the last block is not
/// emitted.
template <std::size_t axes = 0, class Sink>
void emit_commands(const CommandTiming& timing, std::size_t first, std::size_t last, Sink& sink) {
  const Toolpath& path = timing.path();
  const std::size_t n = axes > 0 ? axes : path.dimensions();
  const AxisRow<axes> zero{};
  AxisRow<axes> at{};
  std::copy_n(path.point(first), n, at.begin());
  std::int64_t k = 0;  // samples emitted
  const auto first_dwell = std::lower_bound(path.dwell.begin(), path.dwell.end(), first,
                                            [](const auto& dwell, std::size_t block) { return dwell.first < block; });
  auto next_dwell = static_cast<std::size_t>(first_dwell - path.dwell.begin());

  for (std::size_t run = first; run <= last;) {
    const std::size_t end = timing.run_end(run);
    const double length = timing.run_length(run, end);
    std::int64_t left = CommandTiming::run_samples(length);
    const double scale = static_cast<double>(left) / (length * timing.sample_period());
    // Times within a run count from sample k, so that long runs lose no digits.
    double t = 0.0;
    AxisRow<axes> part{};  // moved in the sample under way, before block b
    for (std::size_t b = run; b <= end; ++b) {
      const double tau = path.duration[b] * scale, whole = static_cast<double>(left);
      const double e = b == end ? whole : std::min(t + tau, whole);
      const auto count = static_cast<std::int64_t>(e + near_sample);
      const double* p = path.point(b);
      if (count > 0) {
        const double per_sample = 1.0 / tau, after = e - static_cast<double>(count);
        const bool begins_sample = std::abs(t) < near_sample;
        AxisRow<axes> u0{}, u{};
        for (std::size_t i = 0; i < n; ++i) {
          u[i] = (p[n + i] - p[i]) * per_sample;
          // A jerk is a small difference of steps: a difference of positions would lose its digits.
          u0[i] = begins_sample ? u[i] : part[i] + u[i] * (1.0 - t);
          part[i] = u[i] * after;
          at[i] = p[n + i] - part[i];
        }
        sink.command(u0, u, count, at);
        k += count;
        left -= count;
        t = after;
      } else {  // the block ends within the sample under way
        for (std::size_t i = 0; i < n; ++i) part[i] += p[n + i] - p[i];
        t = e;
      }
      if (b < end) sink.joint(b, static_cast<double>(k) + (std::abs(t) < near_sample ? 0.0 : t), 0);
    }
    if (end == last) break;
    std::int64_t rest = timing.delay(end);
    for (; next_dwell < path.dwell.size() && path.dwell[next_dwell].first <= end; ++next_dwell) {
      if (path.dwell[next_dwell].first == end) rest += timing.dwell_samples(path.dwell[next_dwell].second);
    }
    sink.joint(end, static_cast<double>(k), rest);
    if (rest > 0) sink.command(zero, zero, rest, at);
    k += rest;
    run = end + 1;
  }
}

}  // namespace accdec
