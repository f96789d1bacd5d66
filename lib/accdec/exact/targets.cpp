#include <algorithm>
#include <cmath>

#include <accdec/exact/servo_ramps.hpp>
#include <accdec/exact/targets.hpp>
#include <accdec/machine/limits.hpp>

namespace accdec::exact {
namespace {

/// The next target between a bound and the smallest value known to be open or found above it.
double large_step(double low, double high) {
  for (const double part : {0.8, 0.9, 0.95, 0.97, 0.985}) {
    if (part * high > low * (1.0 + 1e-3)) return part * high;
  }
  return high;
}

}  // namespace

Targets::Targets(const Task& task)
    : task_(task),
      cost_(cost_of(task)),
      given_(cost_.given_delays(task)),
      // This bound follows from the task's bounds on the order alone.
      low_(cost_.filter * (std::max(task.design.order_min, 0) + 1) + given_) {
  for (const double w : cost_.delay) step_ += 1.5 * w;
}

void Targets::begin(int least_order) {
  first_ = std::max(low_, cost_.filter * (least_order + 1) + given_);
}

double Targets::next_without_design() {
  const double longest =
      cost_.filter * (task_.design.order_max + 1.0) +
      step_ / 1.5 * (task_.design.order_max + static_cast<double>(settling) + ServoRamps(task_).longer()) + given_;
  first_ = std::max(first_ + step_, 1.3 * first_);
  return first_ >= longest ? unlimited : first_;
}

std::optional<double> Targets::next(double gap) {
  if (open_ <= high_ && high_ < unlimited) {
    // The bound can still rise to the start of the open part.
    double target = 0.5 * (low_ + open_);
    if (cost_.whole()) target = std::floor(target);
    if (target <= low_ || open_ - low_ <= 1e-3 * open_) return std::nullopt;
    return target;
  }
  double target = std::min(high_, open_);
  if (gap > 0.0 && high_ < unlimited) {
    target = std::max(0.5 * (low_ + high_), (1.0 - gap) * high_);
    return cost_.whole() ? std::ceil(target) : target;
  }
  if (high_ == unlimited) return next_without_design();
  if (high_ - low_ <= step_) return target;
  if (climb_ > 0.0 && low_ >= climbed_) {
    // Each proof continues the one before. The bound from the chords is usually close to the best one.
    climbed_ = std::min(low_ + climb_, high_);
    climb_ *= 2.0;
    return climbed_;
  }
  target = first_ > low_ && first_ < high_ && low_ < 0.9 * first_ ? first_ : 0.5 * (low_ + high_);
  // With several corners a proof grows fast with its target, and a better design ends it. So take large steps.
  if (task_.corners.size() > 1) target = large_step(low_, high_);
  if (cost_.whole()) target = std::floor(target) + 0.0;
  return target <= low_ || target >= high_ ? high_ : target;
}

}  // namespace accdec::exact
