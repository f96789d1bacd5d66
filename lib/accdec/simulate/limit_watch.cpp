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
    : machine_(machine), period_(sample_period), still_(standing_speed(sample_period)), blame_(blame) {
  if (machine_ == nullptr) return;
  for (std::size_t a = 0; a < dimensions; ++a) {
    const Axis& axis = machine_->axes[a];
    for (const AxisLimit& limit : axis_limits) {
      if (axis.*limit.bound < unlimited) worst_.push_back({limit.kind, &limit, a, axis.*limit.bound, 0.0, 0, 0});
    }
  }
  for (const SupplyLimit& limit : supply_limits) {
    if (machine_->*limit.bound < unlimited)
      worst_.push_back({limit.kind, nullptr, dimensions, machine_->*limit.bound, 0.0, 0, 0});
  }
}

AxisState LimitWatch::state_at(std::size_t axis, double velocity, double acceleration, double jerk) const {
  return axis_state(machine_->axes[axis], velocity / period_, acceleration / (period_ * period_),
                    jerk / (period_ * period_ * period_), still_);
}

void LimitWatch::take(Worst& worst, double value, bool blame, const MotionBuffer& motion, std::int64_t index,
                      std::size_t block, std::size_t known) {
  if (blame && value > worst.bound * (1.0 + verification_tolerance)) {
    const auto at = static_cast<std::uint32_t>(block_at(index, block));
    if (broken_.size() == known || broken_.back() != at) broken_.push_back(at);
  }
  if (!(value > worst.value)) return;
  worst.value = value;
  worst.sample = motion.number(index);
  worst.block = block_at(index, block);
}

void LimitWatch::look(const MotionBuffer& motion, std::size_t block) {
  const std::size_t known = broken_.size();
  look_axes(motion, block);
  look_supply(motion, block);
  marks_.clear();
  order_broken(known);
}

void LimitWatch::look_axes(const MotionBuffer& motion, std::size_t block) {
  const std::size_t known = broken_.size();
  MotionExtremes extremes;
  std::size_t seen_axis = program_axis_count;
  for (Worst& worst : worst_) {
    if (worst.limit == nullptr) break;
    const auto v = motion.velocity(worst.axis), a = motion.acceleration(worst.axis),
               b = motion.acceleration_before(worst.axis);
    if (v.size() == 0) break;
    const Axis& axis = machine_->axes[worst.axis];
    // First the largest value of this stretch; its place only if it is the worst so far.
    if (worst.axis != seen_axis) {
      const bool loads = axis.force_max < unlimited || axis.power_max < unlimited || axis.regeneration_max < unlimited;
      extremes =
          motion_extremes(v.data(), a.data(), v.size(), axis.mass / (period_ * period_), axis.damping / period_, loads);
      seen_axis = worst.axis;
    }
    // Loads with dry friction or a force-speed curve do not follow from the extremes.
    const bool by_samples = worst.limit->load && (axis.coulomb > 0.0 || axis.force_speed_max < unlimited);
    const double largest = by_samples ? unlimited
                                      : worst.limit->value({.velocity = extremes.velocity / period_,
                                                            .acceleration = extremes.acceleration / (period_ * period_),
                                                            .jerk = extremes.jerk / (period_ * period_ * period_),
                                                            .force = extremes.force,
                                                            .motoring = extremes.power / period_,
                                                            .braking = extremes.regeneration / period_});
    const bool blame = blame_ && largest > worst.bound * (1.0 + verification_tolerance);
    if (!blame && !(largest > worst.value * (1.0 + 1e-12))) continue;
    // Most samples use less than the worst one, and less than the bound.
    const auto least = [&] { return blame ? std::min(worst.bound, worst.value) : worst.value; };
    const auto look_at = [&](const auto& in_samples, double per) {
      double enough = least() * per * (1.0 - 1e-12);
      for (Eigen::Index i = 0; i < v.size(); ++i) {
        if (in_samples(i) < enough) continue;
        const double value = worst.limit->value(state_at(worst.axis, v[i], a[i], a[i] - b[i]));
        take(worst, value, blame, motion, motion.seen_begin() + i, block, known);
        enough = least() * per * (1.0 - 1e-12);
      }
    };
    switch (worst.kind) {
      case LimitKind::velocity: look_at([&](Eigen::Index i) { return std::abs(v[i]); }, period_); break;
      case LimitKind::acceleration: look_at([&](Eigen::Index i) { return std::abs(a[i]); }, period_ * period_); break;
      case LimitKind::jerk:
        look_at([&](Eigen::Index i) { return std::abs(a[i] - b[i]); }, period_ * period_ * period_);
        break;
      default: look_at([](Eigen::Index) { return unlimited; }, 1.0);
    }
  }
}

void LimitWatch::look_supply(const MotionBuffer& motion, std::size_t block) {
  if (worst_.empty() || worst_.back().limit != nullptr) return;
  const std::size_t known = broken_.size(), axes = worst_.back().axis;
  for (std::int64_t index = motion.seen_begin(); index < motion.index(); ++index) {
    const Eigen::Index i = index - motion.seen_begin();
    double power = 0.0;
    for (std::size_t a = 0; a < axes; ++a)
      power += state_at(a, motion.velocity(a)[i], motion.acceleration(a)[i], 0.0).motoring;
    for (Worst& worst : worst_) {
      if (worst.limit == nullptr)
        take(worst, worst.kind == LimitKind::power_total ? power : -power, blame_, motion, index, block, known);
    }
  }
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
  double power = 0.0;
  for (std::size_t a = 0; !worst_.empty() && worst_.back().limit == nullptr && a < worst_.back().axis; ++a)
    power += state_at(a, u[a], 0.0, 0.0).motoring;
  for (Worst& worst : worst_) {
    const double value = worst.limit != nullptr ? worst.limit->value(state_at(worst.axis, u[worst.axis], 0.0, 0.0))
                         : worst.kind == LimitKind::power_total ? power
                                                                : -power;
    if (!(value > worst.value)) continue;
    worst.value = value;
    worst.sample = motion.sample() + 1;
    worst.block = block;
  }
}

void LimitWatch::finish(std::vector<LimitUse>& limits, const Toolpath& path) const {
  for (const Worst& worst : worst_) {
    LimitUse use;
    use.kind = worst.kind;
    if (worst.limit != nullptr) use.axis = path.axis_name(worst.axis);
    use.line = path.line[std::min(worst.block, path.blocks() - 1)];
    use.value = worst.value;
    use.bound = worst.bound;
    use.utilisation = utilisation_of(worst.kind, worst.value, worst.bound);
    use.sample = worst.sample;
    limits.push_back(use);
  }
}

}  // namespace accdec
