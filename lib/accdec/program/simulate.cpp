#include <accdec/program/simulate.hpp>

#include <algorithm>
#include <array>
#include <cmath>

#include <accdec/program/limit_watch.hpp>
#include <accdec/program/motion_buffer.hpp>

namespace accdec {
namespace {

/// Feeds the commands to the motion buffer and reads joints and limits off it.
class Simulator {
 public:
  Simulator(const CommandTiming& timing, const LegFilters& filters, std::size_t first, std::span<double> errors,
            const SimulationOptions& options)
      : path_(timing.path()),
        filters_(filters),
        order_(filters.order_max()),
        errors_(errors),
        options_(options),
        motion_(filters, path_.dimensions(), path_.point(first)),
        watch_(options.machine, path_.dimensions(), timing.sample_period(), options.blame),
        block_(first) {}

  void command(const double* u, std::int64_t count, const double* end) {
    motion_.change(u, filters_.index(block_));
    watched_until_ = std::max(watched_until_, motion_.sample() + order_ + 2);
    while (count > 0) {
      // Steady motion is passed over, except for the last two samples, where the window of the next joint begins.
      const std::int64_t steady = count - 2 - std::max<std::int64_t>(0, watched_until_ - motion_.sample());
      if (steady > steady_min && !options_.samples) {
        const std::int64_t transient = count - 2 - steady;
        advance(transient, count, end);
        count -= transient;
        flush();
        watch_.steady(motion_, u, block_);
        motion_.pass_over(steady, u, end, count - steady);
        count -= steady;
      } else {
        advance(count, count, end);
        count = 0;
      }
    }
  }

  /// From here on times of joints count.
  void begin() { begin_ = motion_.sample(); }

  void joint(std::size_t b, double time, std::int64_t rest) {
    time += static_cast<double>(begin_);
    const auto reached = static_cast<std::int64_t>(time);
    // A rest longer than the filter adds only samples that stand still in the joint.
    const Filter &in = filters_.of(b), &out = filters_.of(b + 1);
    const std::int64_t seen = std::min<std::int64_t>(rest, in.order() + 1);
    const std::int64_t window = (time > static_cast<double>(reached) ? 1 : 0) + std::max<std::int64_t>(in.order(), seen + out.order()) + 1;
    const double guess = time + 0.5 * (static_cast<double>(seen) + in.mean_delay() + out.mean_delay());
    pending_.push_back({b, reached, reached + window, static_cast<std::int64_t>(guess)});
    watched_until_ = std::max(watched_until_, reached + window + 1);
    block_ = b + 1;
  }

  Simulation finish() {
    const std::vector<double> zero(path_.dimensions(), 0.0), end(motion_.command_end());
    command(zero.data(), order_ + 2, end.data());  // the last step of the jerk, too
    flush();
    Simulation result;
    result.samples = motion_.settled();
    watch_.finish(result.limits, result.limit_lines, path_);
    result.broken = watch_.broken();
    return result;
  }

 private:
  static constexpr std::int64_t steady_min = 16;
  struct Pending {
    std::size_t block;
    std::int64_t begin, end, guess;  // samples
  };

  /// @param left  samples of the command still to come, these included, up to its end point
  void advance(std::int64_t count, std::int64_t left, const double* end) {
    while (count > 0) {
      if (motion_.room() == 0) {
        flush();
        motion_.shift(end, left);
      }
      const std::int64_t now = std::min(count, motion_.room());
      watch_.mark(motion_.index(), block_);
      motion_.advance(now, left, end);
      count -= now;
      left -= now;
    }
  }

  void flush() {
    motion_.make();
    std::size_t done = 0;
    for (; done < pending_.size() && pending_[done].end < motion_.sample(); ++done) errors_[pending_[done].block] = error_of(pending_[done]);
    pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(done));
    watch_.look(motion_, block_);
    if (options_.samples) motion_.deliver(options_.samples);
    motion_.seen();
  }

  double error_of(const Pending& joint) const {
    switch (path_.dimensions()) {
      case 2: return error_of<2>(joint);
      case 3: return error_of<3>(joint);
      default: return error_of<0>(joint);
    }
  }
  /// @tparam axes  their number; 0: only known at run time
  template <std::size_t axes>
  double error_of(const Pending& joint) const;

  const Toolpath& path_;
  const LegFilters& filters_;
  std::int64_t order_;  // of the longest filter
  std::span<double> errors_;
  const SimulationOptions& options_;
  MotionBuffer motion_;
  LimitWatch watch_;
  std::vector<Pending> pending_;
  std::int64_t begin_ = 0;
  std::int64_t watched_until_ = 0;  // no sample before this is passed over
  std::size_t block_;
};

template <std::size_t axes>
double Simulator::error_of(const Pending& joint) const {
  const double* corner = path_.point(joint.block + 1);
  const std::size_t n = axes > 0 ? axes : path_.dimensions();
  std::array<const double*, program_axis_count> position{};
  for (std::size_t i = 0; i < n; ++i) position[i] = motion_.positions(i);
  const auto distance2 = [&](std::int64_t k) {
    double sum = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      const double d = position[i][k] - corner[i];
      sum += d * d;
    }
    return sum;
  };
  // Of the corner from the segment from sample k to k + 1.
  const auto segment2 = [&](std::int64_t k) {
    double ab2 = 1e-300, dot = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      const double d = position[i][k + 1] - position[i][k];
      ab2 += d * d;
      dot += (corner[i] - position[i][k]) * d;
    }
    const double t = std::min(1.0, std::max(0.0, dot / ab2));
    double sum = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      const double x = position[i][k] + t * (position[i][k + 1] - position[i][k]) - corner[i];
      sum += x * x;
    }
    return sum;
  };
  const bool at_samples = ends_leg(path_, joint.block);
  const auto finish = [&](std::int64_t k, double best) {
    if (!at_samples) {
      if (k > joint.begin) best = std::min(best, segment2(k - 1));
      if (k < joint.end) best = std::min(best, segment2(k));
    }
    return std::sqrt(best);
  };
  // Downhill from where an even motion would be nearest; that the nearest sample is within the bound is all that must be known, so
  // the whole window is searched only if the bound is not met.
  std::int64_t k = std::clamp(joint.guess, joint.begin, joint.end);
  double best = distance2(k);
  for (const int step : {1, -1}) {
    while (k + step >= joint.begin && k + step <= joint.end) {
      const double next = distance2(k + step);
      if (!(next < best)) break;
      best = next;
      k += step;
    }
  }
  double error = finish(k, best);
  if (error > path_.tolerance[joint.block]) {
    for (std::int64_t j = joint.begin; j <= joint.end; ++j) error = std::min(error, finish(j, distance2(j)));
  }
  return error;
}

}  // namespace

Simulation simulate_program(const CommandTiming& timing, const LegFilters& filters, std::size_t first, std::size_t last,
                            std::span<double> errors, const SimulationOptions& options) {
  Simulator simulator(timing, filters, first, errors, options);
  if (first == 0 && timing.path().dwell_first > 0.0) {
    const std::vector<double> zero(timing.path().dimensions(), 0.0);
    simulator.command(zero.data(), timing.dwell_samples(timing.path().dwell_first), timing.path().point(0));
  }
  simulator.begin();
  emit_commands(timing, first, last, simulator);
  return simulator.finish();
}

std::int64_t motion_samples(const CommandTiming& timing, const LegFilters& filters) {
  const Toolpath& path = timing.path();
  std::int64_t at = timing.dwell_samples(path.dwell_first), end_of_motion = 0;
  auto dwell = path.dwell.begin();
  for (std::size_t run = 0; run < path.blocks();) {
    const std::size_t end = timing.run_end(run);
    at += CommandTiming::run_samples(timing.run_length(run, end));
    end_of_motion = std::max(end_of_motion, at + filters.of(end).order() + 1);
    at += timing.delay(end);
    for (; dwell != path.dwell.end() && dwell->first <= end; ++dwell) at += timing.dwell_samples(dwell->second);
    run = end + 1;
  }
  return end_of_motion;
}

}  // namespace accdec
