#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include <accdec/machine/limit_unit.hpp>
#include <accdec/machine/velocity_changes.hpp>
#include <accdec/plan/report/left_at_rest.hpp>
#include <accdec/plan/report/plan_facts.hpp>
#include <accdec/simulate.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// A mode's free vibration as x' + i x. The motion passes it on from sample to sample; a change of velocity adds to x'.
class Swing {
 public:
  /// @param axis  whose velocity excites it
  Swing(std::size_t axis, double period, double frequency, double damping)
      : frequency(frequency),
        axis_(axis),
        damped_(2.0 * std::numbers::pi * frequency * std::sqrt((1.0 - damping) * (1.0 + damping))),
        turn_(period * std::complex<double>(-damping * 2.0 * std::numbers::pi * frequency, damped_)),
        step_(std::exp(turn_)) {}
  void pass(std::int64_t samples, const double* velocities) {
    state_ = state_ * (samples == 1 ? step_ : std::exp(turn_ * static_cast<double>(samples))) +
             (velocities[axis_] - velocity_);
    velocity_ = velocities[axis_];
  }
  /// m, if the axis stands still from the next sample on.
  double amplitude() const { return std::abs(state_ - velocity_ / step_) / damped_; }

  double frequency, at_stop = 0.0;
  std::uint32_t line = 0;

 private:
  std::size_t axis_;
  double damped_, velocity_ = 0.0;
  std::complex<double> turn_, step_, state_ = 0.0;
};

/// The frequencies and damping ratios of a mode at which all moves together are judged. First comes where its bound is
/// used most, then its band as densely as the program's time asks for, in up to `most` steps.
std::vector<std::pair<double, double>> judged_at(const LimitUse& use, const Mode& mode, double time, double most) {
  std::vector<std::pair<double, double>> all{{use.frequency, use.damping}};
  const double width = mode.frequency_high - mode.frequency_low;
  if (width == 0.0 && mode.damping_high == mode.damping_low) return all;
  const double ripples = 8.0 * width * memory_of(mode, mode.damping_low, time);
  const auto steps = static_cast<int>(std::ceil(std::clamp(ripples, width > 0.0 ? 1.0 : 0.0, most)));
  for (int i = 0; i <= steps; ++i) {
    const double frequency = mode.frequency_low + width * i / std::max(1, steps);
    all.emplace_back(frequency, mode.damping_low);
    if (mode.damping_high > mode.damping_low) all.emplace_back(frequency, mode.damping_high);
  }
  return all;
}

/// All that is judged of every limit; none of limits of other kinds.
std::vector<std::vector<Swing>> swings_of(const ProgramResult& result) {
  constexpr double work = 1e8, most = 256.0;
  const Toolpath& path = result.plan.path;
  std::vector<Mode> modes = program_machine(result.task_machine, path).modes;
  std::erase_if(modes, [](const Mode& mode) { return !mode.of_axis(); });
  std::vector<std::vector<Swing>> swings;
  for (std::size_t k = 0; const LimitUse& use : result.check.limits) {
    swings.emplace_back();
    if (use.kind != LimitKind::residual) continue;
    std::size_t axis = 0;
    while (axis + 1 < path.dimensions() && path.axis_name(axis) != use.axis) ++axis;
    const double samples = static_cast<double>(result.check.samples);
    const Mode mode = k < modes.size() ? modes[k] : Mode{use.frequency, use.frequency, 1.0, use.damping, use.damping};
    ++k;
    for (const auto& [frequency, damping] :
         judged_at(use, mode, samples * result.sample_period, std::min(most, work / (samples + 1.0))))
      swings.back().emplace_back(axis, result.sample_period, frequency, damping);
  }
  return swings;
}

/// The blocks behind which the motion comes to rest, in their order.
class Rests {
 public:
  explicit Rests(const Plan& plan) : plan_(plan) { skip(); }
  /// The block behind which the motion rests at a sample, if it has just come there.
  /// @param blocks  the first and the last that the sample may be on
  std::optional<std::size_t> reached(const Sample& sample, std::pair<std::size_t, std::size_t> blocks) {
    for (; next_ + 1 < blocks.first; skip()) ++next_;
    if (next_ + 1 >= plan_.path.blocks() || blocks.second < next_ || !at(next_ + 1, sample)) return std::nullopt;
    const std::size_t block = next_++;
    skip();
    return block;
  }

 private:
  void skip() {
    while (next_ + 1 < plan_.path.blocks() && !rests_after(plan_, next_)) ++next_;
  }
  bool at(std::size_t point, const Sample& sample) const {
    constexpr double near = 1e-10;  // m: sums of samples are rounded
    for (std::size_t a = 0; a < plan_.path.dimensions(); ++a)
      if (std::abs(sample.position[a] - plan_.path.point(point)[a]) > near) return false;
    return true;
  }

  const Plan& plan_;
  std::size_t next_ = 0;
};

}  // namespace

std::vector<LeftAtRest> left_at_rest(const ProgramResult& result) {
  const std::vector<LimitUse>& limits = result.check.limits;
  std::vector<LeftAtRest> left(limits.size());
  std::vector<std::vector<Swing>> swings = swings_of(result);
  if (result.plan.empty() || std::ranges::all_of(swings, &std::vector<Swing>::empty)) return left;
  std::int64_t before = 0;
  Rests rests(result.plan);
  Motion motion(result.plan, result.sample_period);
  for (Sample sample; motion.next(sample); motion.pass_steady()) {
    const std::optional<std::size_t> rest = rests.reached(sample, motion.blocks());
    for (std::vector<Swing>& of_limit : swings) {
      for (Swing& swing : of_limit) {
        swing.pass(sample.number - before, sample.velocity.data());
        if (!rest || swing.amplitude() <= swing.at_stop) continue;
        swing.at_stop = swing.amplitude(), swing.line = result.plan.path.line[*rest];
      }
    }
    before = sample.number;
  }
  for (std::size_t i = 0; i < limits.size(); ++i) {
    for (const Swing& swing : swings[i]) {
      if (swing.amplitude() >= left[i].at_end) left[i].at_end = swing.amplitude(), left[i].frequency = swing.frequency;
      if (swing.at_stop > left[i].at_stop) left[i].at_stop = swing.at_stop, left[i].line = swing.line;
    }
    left[i].above_bound = std::max(left[i].at_end, left[i].at_stop) > limits[i].bound * (1.0 + verification_tolerance);
  }
  return left;
}

std::vector<std::string> left_at_rest_in_words(const ProgramResult& result, const std::vector<LeftAtRest>& left) {
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < left.size(); ++i) {
    const LimitUse& use = result.check.limits[i];
    if (use.kind != LimitKind::residual) continue;
    const auto [unit, per_si] = limit_unit(use.kind, use.axis);
    const std::string stops = left[i].at_stop > 0.0 ? fmt::format(", at stops at most {:.6g} {} (line {})",
                                                                  per_si * left[i].at_stop, unit, left[i].line)
                                                    : "";
    lines.push_back(
        fmt::format("{} of {} after the program's end, all moves together: {:.6g} {} at {:.6g} Hz{}{}",
                    to_string(use.kind), use.axis, per_si * left[i].at_end, unit, left[i].frequency, stops,
                    left[i].above_bound ? ", above the bound, which judges starts, corners and stops alone" : ""));
  }
  return lines;
}

std::string bounds_that_hold(const std::vector<LeftAtRest>& left) {
  return std::ranges::any_of(left, &LeftAtRest::above_bound)
             ? "bounds hold, residuals only of each move alone: all together leave more at a rest"
             : "all bounds hold";
}

}  // namespace accdec
