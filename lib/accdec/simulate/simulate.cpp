#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>

#include <accdec/machine/limits.hpp>
#include <accdec/simulate/contour_watch.hpp>
#include <accdec/simulate/joint_distance.hpp>
#include <accdec/simulate/limit_watch.hpp>
#include <accdec/simulate/mode_watch.hpp>
#include <accdec/simulate/motion_buffer.hpp>
#include <accdec/simulate/simulate.hpp>

namespace accdec {
namespace {

const Filter& longest(std::span<const Filter> filters) {
  return *std::ranges::max_element(filters, {}, &Filter::order);
}

/// Feeds the commands to the motion buffer and reads joints and limits off it. `Motion` hands out samples of the same
/// buffer one by one. For 10^6 blocks on one core, that alone takes 2.4 s (zigzag) and 0.08 s (raster). This whole
/// check takes 0.5 s and 0.07 s, as it judges thousands of samples at a time and passes over steady ones.
/// @tparam axes  their number; 0: only known at run time
template <std::size_t axes>
class Simulator {
 public:
  Simulator(const CommandTiming& timing, std::span<const Filter> filters, std::size_t first, std::span<double> errors,
            const SimulationOptions& options)
      : path_(timing.path()),
        mean_delay_(filters.front().mean_delay()),
        order_(longest(filters).order()),
        errors_(errors),
        options_(options),
        motion_(filters, path_.dimensions(), path_.point(first)),
        watch_(options.machine, path_.dimensions(), timing.sample_period(), options.blame),
        block_(first) {}

  [[gnu::always_inline]] inline void command(const AxisRow<axes>& u0, const AxisRow<axes>& u, std::int64_t count,
                                             const AxisRow<axes>& end) {
    if (count <= steady_min && count <= motion_.room()) {
      watched_until_ = std::max(watched_until_, motion_.sample() + order_ + 3);
      append(u0, u, count);
    } else {
      const AxisRow<axes> u0_copy = u0, u_copy = u, end_copy = end;  // so that the caller's may stay in registers
      long_command(u0_copy, u_copy, count, end_copy);
    }
  }

  /// From here on times of joints count.
  void begin() { begin_ = motion_.sample(); }

  void joint(std::size_t b, double time, std::int64_t rest) {
    time += static_cast<double>(begin_);
    const auto reached = static_cast<std::int64_t>(time);
    // A rest longer than the filter adds only samples that stand still in the joint.
    const std::int64_t seen = std::min<std::int64_t>(rest, order_ + 1);
    const std::int64_t window = (time > static_cast<double>(reached) ? 1 : 0) + seen + order_ + 1;
    const auto guess = static_cast<std::int64_t>(time + 0.5 * static_cast<double>(seen) + mean_delay_);
    const JointWindow& whole = pending_.emplace_back(JointWindow{b, reached, reached + window, !ends_leg(path_, b)});
    // As many places as lanes of the widest registers; segments end one sample later.
    const std::int64_t last = whole.last - (whole.path ? 8 : 7);
    const std::int64_t near = std::clamp(guess - 4, whole.first, std::max(whole.first, last));
    near_.push_back({b, near, std::min(whole.last, near + whole.last - last), whole.path});
    watched_until_ = std::max(watched_until_, reached + window + 1);
    block_ = b + 1;
  }

  /// @param at  where the command ended  @param rest  samples that it rests there
  Simulation finish(const double* at, std::int64_t rest) {
    AxisRow<axes> end{};
    std::copy_n(at, dimensions(), end.begin());
    command({}, {}, order_ + 2 + rest, end);  // the last step of the jerk, too
    flush();
    Simulation result;
    result.samples = motion_.settled() + rest;
    watch_.finish(result.limits, path_);
    result.broken = watch_.broken();
    return result;
  }

 private:
  static constexpr std::int64_t steady_min = 16;

  [[gnu::noinline]] void long_command(AxisRow<axes> u0, const AxisRow<axes>& u, std::int64_t count,
                                      const AxisRow<axes>& end) {
    watched_until_ = std::max(watched_until_, motion_.sample() + order_ + 3);
    while (count > 0) {
      // Steady motion is skipped, except for the last two samples, where the window of the next joint begins.
      const std::int64_t steady = count - 2 - std::max<std::int64_t>(1, watched_until_ - motion_.sample());
      if (steady > steady_min && !options_.samples) {
        const std::int64_t transient = count - 2 - steady;
        advance(u0, u, transient, count, end);
        count -= transient;
        flush();
        watch_.steady(motion_, u.data(), block_);
        motion_.pass_over(steady, u.data(), end.data(), count - steady);
        count -= steady;
        u0 = u;
      } else {
        advance(u0, u, count, count, end);
        count = 0;
      }
    }
  }

  /// @param left  samples of the command still to come, these included, up to its end point
  void advance(const AxisRow<axes>& u0, const AxisRow<axes>& u, std::int64_t count, std::int64_t left,
               const AxisRow<axes>& end) {
    for (bool first = true; count > 0; first = false) {
      if (motion_.room() == 0) {
        flush();
        AxisRow<axes> at = end;
        for (std::size_t a = 0; a < dimensions(); ++a)
          at[a] -= static_cast<double>(first ? left - 1 : left) * u[a] + (first ? u0[a] : 0.0);
        motion_.shift(at.data());
      }
      const std::int64_t now = std::min(count, motion_.room());
      append(first ? u0 : u, u, now);
      count -= now;
      left -= now;
    }
  }

  [[gnu::always_inline]] inline void append(const AxisRow<axes>& u0, const AxisRow<axes>& u, std::int64_t count) {
    watch_.mark(motion_.index(), block_);
    motion_.append<axes>(u0, u, count);
  }

  void flush() {
    motion_.make();
    for (std::size_t a = 0; a < dimensions(); ++a) position_[a] = motion_.positions(a);
    std::size_t done = 0;
    while (done < pending_.size() && pending_[done].last < motion_.sample()) ++done;
    judge(done);
    pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(done));
    near_.erase(near_.begin(), near_.begin() + static_cast<std::ptrdiff_t>(done));
    watch_.look(motion_, block_);
    if (options_.samples) motion_.deliver(options_.samples);
    motion_.seen();
  }

  /// Errors of the first `count` joints.
  void judge(std::size_t count) {
    squared_.resize(std::max(squared_.size(), count));
    const auto find = [&](const std::vector<JointWindow>& windows, std::size_t first, std::size_t last) {
      least_squared(position_.data(), dimensions(), path_.programmed_points(), windows.data() + first, last - first,
                    squared_.data() + first);
    };
    if (options_.whole_windows) {
      find(pending_, 0, count);
    } else {
      find(near_, 0, count);
      for (std::size_t i = 0; i < count; ++i)
        if (std::sqrt(squared_[i]) > path_.tolerance[pending_[i].block]) find(pending_, i, i + 1);
    }
    for (std::size_t i = 0; i < count; ++i) errors_[pending_[i].block] = std::sqrt(squared_[i]);
  }

  std::size_t dimensions() const { return axes > 0 ? axes : path_.dimensions(); }

  const Toolpath& path_;
  double mean_delay_;   // of the first filter, samples
  std::int64_t order_;  // of the longest filter
  std::span<double> errors_;
  const SimulationOptions& options_;
  MotionBuffer motion_;
  LimitWatch watch_;
  std::vector<JointWindow> pending_;  // joints whose windows are not yet over
  std::vector<JointWindow> near_;     // of each, the part where it is expected to be passed
  std::vector<double> squared_;
  std::array<const double*, program_axis_count> position_{};  // of every axis by sample number
  std::int64_t begin_ = 0;
  std::int64_t watched_until_ = 0;  // no sample before this is skipped
  std::size_t block_;
};

template <std::size_t axes>
Simulation simulate(const CommandTiming& timing, std::span<const Filter> filters, std::size_t first, std::size_t last,
                    std::span<double> errors, const SimulationOptions& options) {
  Simulator<axes> simulator(timing, filters, first, errors, options);
  if (first == 0 && timing.path().dwell_first > 0.0) {
    AxisRow<axes> at{};
    std::copy_n(timing.path().point(0), timing.path().dimensions(), at.begin());
    simulator.command({}, {}, timing.dwell_samples(timing.path().dwell_first), at);
  }
  simulator.begin();
  emit_commands<axes>(timing, first, last, simulator);
  return simulator.finish(timing.path().point(last + 1), last + 1 == timing.path().blocks() ? timing.dwell_last() : 0);
}

Simulation simulate(const CommandTiming& timing, std::span<const Filter> filters, std::size_t first, std::size_t last,
                    std::span<double> errors, const SimulationOptions& options) {
  switch (timing.path().dimensions()) {
    case 2: return simulate<2>(timing, filters, first, last, errors, options);
    case 3: return simulate<3>(timing, filters, first, last, errors, options);
    default: return simulate<0>(timing, filters, first, last, errors, options);
  }
}

/// The machine with its limits of loads only, or with all others.
Machine limited_by(Machine machine, bool loads) {
  for (const SupplyLimit& limit : supply_limits) {
    if (!loads) machine.*limit.bound = unlimited;
  }
  for (Axis& axis : machine.axes) {
    for (const AxisLimit& limit : axis_limits) {
      if (limit.load != loads) axis.*limit.bound = unlimited;
    }
  }
  return machine;
}

Simulation simulate_servo(const CommandTiming& timing, const Filter& filter, std::size_t first, std::size_t last,
                          std::span<double> errors, SimulationOptions options) {
  SimulationOptions commanded = options;
  commanded.samples = {};
  commanded.whole_windows = false;
  Machine of_command, of_motion;
  if (options.machine != nullptr) {
    of_command = limited_by(*options.machine, false), of_motion = limited_by(*options.machine, true);
    commanded.machine = &of_command, options.machine = &of_motion;
  }
  Simulation result = simulate(timing, std::span(&filter, 1), first, last, errors, commanded);
  Simulation behind = simulate(timing, options.motion, first, last, errors, options);
  result.limits.insert(result.limits.end(), behind.limits.begin(), behind.limits.end());
  const auto place = [&](const LimitUse& use) {
    if (use.axis.empty()) return program_axis_count * axis_limits.size();  // the supply stands behind all axes
    std::size_t row = 0;
    while (axis_limits[row].kind != use.kind) ++row;
    std::size_t axis = 0;
    while (timing.path().axis_name(axis) != use.axis) ++axis;
    return axis * axis_limits.size() + row;
  };
  std::stable_sort(result.limits.begin(), result.limits.end(),
                   [&](const LimitUse& a, const LimitUse& b) { return place(a) < place(b); });
  std::vector<std::uint32_t> broken;
  std::set_union(result.broken.begin(), result.broken.end(), behind.broken.begin(), behind.broken.end(),
                 std::back_inserter(broken));
  result.broken = std::move(broken);
  return result;
}

}  // namespace

Simulation simulate_program(const CommandTiming& timing, const Filter& filter, std::size_t first, std::size_t last,
                            std::span<double> errors, const SimulationOptions& options) {
  SimulationOptions watched = options;
  const std::span<const Filter> motion = options.motion.empty() ? std::span(&filter, 1) : options.motion;
  std::optional<PathContour> contour;
  if (timing.path().contour_max < unlimited) {
    contour.emplace(timing, longest(motion).order(), first, last);
    watched.samples = [&](std::int64_t k, std::int64_t count, const double* const* position,
                          const double* const* velocity) {
      contour->look(k, count, position);
      if (options.samples) options.samples(k, count, position, velocity);
    };
  }
  Simulation result = options.motion.empty() ? simulate(timing, motion, first, last, errors, watched)
                                             : simulate_servo(timing, filter, first, last, errors, watched);
  if (contour) contour->finish(result);
  if (options.machine != nullptr && has_mode_of_axis(*options.machine))
    watch_modes(timing, filter, first, last, *options.machine, result);
  return result;
}

std::int64_t motion_samples(const CommandTiming& timing, const Filter& filter) {
  return timing.command_samples() + filter.order() + 1;
}

}  // namespace accdec
