#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include <accdec/simulate/limit_watch.hpp>
#include <accdec/simulate/motion_extremes.hpp>
#include <accdec/verify.hpp>

namespace accdec {

static_assert(
    most_differences == 1,
    "samples of programs are watched for accelerations and jerks: here, in sample_check.cpp, blend_limits.cpp");

LimitWatch::LimitWatch(const Machine* machine, std::size_t dimensions, double sample_period, bool blame)
    : machine_(machine), period_(sample_period), blame_(blame) {
  for (std::size_t a = 0; machine_ != nullptr && a < dimensions; ++a) {
    const Axis& axis = machine_->axes[a];
    for (const AxisLimit& limit : axis_limits) {
      if (axis.*limit.bound < unlimited) worst_.push_back({&limit, a, axis.*limit.bound, 0.0, 0, 0});
    }
  }
}

double LimitWatch::value_at(const Worst& worst, double velocity, double acceleration, double jerk) const {
  const Axis& axis = machine_->axes[worst.axis];
  const double v = velocity / period_, a = acceleration / (period_ * period_);
  return worst.limit->value(axis_state(axis, v, a, jerk / (period_ * period_ * period_)));
}

void LimitWatch::look(const MotionBuffer& motion, std::size_t block) {
  const std::size_t known = broken_.size();
  MotionExtremes extremes;
  std::size_t seen_axis = program_axis_count;
  for (Worst& worst : worst_) {
    const auto v = motion.velocity(worst.axis), a = motion.acceleration(worst.axis),
               b = motion.acceleration_before(worst.axis);
    if (v.size() == 0) break;
    // First the largest value of this stretch; its place only if it is the worst so far.
    if (worst.axis != seen_axis) {
      const Axis& axis = machine_->axes[worst.axis];
      const bool loads = axis.force_max < unlimited || axis.power_max < unlimited || axis.regeneration_max < unlimited;
      extremes =
          motion_extremes(v.data(), a.data(), v.size(), axis.mass / (period_ * period_), axis.damping / period_, loads);
      seen_axis = worst.axis;
    }
    const double largest = worst.limit->value({.velocity = extremes.velocity / period_,
                                               .acceleration = extremes.acceleration / (period_ * period_),
                                               .jerk = extremes.jerk / (period_ * period_ * period_),
                                               .force = extremes.force,
                                               .motoring = extremes.power / period_,
                                               .braking = extremes.regeneration / period_});
    const double broken = worst.bound * (1.0 + verification_tolerance);
    const bool blame = blame_ && largest > broken;
    if (!blame && !(largest > worst.value * (1.0 + 1e-12))) continue;
    for (Eigen::Index i = 0; i < v.size(); ++i) {
      const double value = value_at(worst, v[i], a[i], a[i] - b[i]);
      const std::int64_t index = motion.seen_begin() + i;
      if (blame && value > broken) {
        const auto at = static_cast<std::uint32_t>(block_at(index, block));
        if (broken_.size() == known || broken_.back() != at) broken_.push_back(at);
      }
      if (!(value > worst.value)) continue;
      worst.value = value;
      worst.sample = motion.number(index);
      worst.block = block_at(index, block);
    }
  }
  marks_.clear();
  order_broken(known);
}

/// The motion goes on: only the end of the list changes. Sorting all of it would take quadratic time.
void LimitWatch::order_broken(std::size_t known) {
  if (broken_.size() == known) return;
  const auto added = broken_.begin() + static_cast<std::ptrdiff_t>(known);
  std::sort(added, broken_.end());
  const auto first = std::lower_bound(broken_.begin(), added, *added);
  std::inplace_merge(first, added, broken_.end());
  broken_.erase(std::unique(first, broken_.end()), broken_.end());
}

std::size_t LimitWatch::block_at(std::int64_t index, std::size_t current) const {
  const auto after = std::upper_bound(marks_.begin(), marks_.end(), index,
                                      [](std::int64_t i, const auto& mark) { return i < mark.first; });
  return after == marks_.begin() ? current : std::prev(after)->second;
}

void LimitWatch::steady(const MotionBuffer& motion, const double* u, std::size_t block) {
  for (Worst& worst : worst_) {
    const double value = value_at(worst, u[worst.axis], 0.0, 0.0);
    if (!(value > worst.value)) continue;
    worst.value = value;
    worst.sample = motion.sample() + 1;
    worst.block = block;
  }
}

void LimitWatch::finish(std::vector<LimitUse>& limits, const Toolpath& path) const {
  for (const Worst& worst : worst_) {
    LimitUse use;
    use.kind = worst.limit->kind;
    use.axis = path.axis_name(worst.axis);
    use.line = path.line[std::min(worst.block, path.blocks() - 1)];
    use.value = worst.value;
    use.bound = worst.bound;
    use.utilisation = utilisation_of(worst.limit->kind, worst.value, worst.bound);
    use.sample = worst.sample;
    limits.push_back(use);
  }
}

}  // namespace accdec
