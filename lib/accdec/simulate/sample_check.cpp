#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include <accdec/machine/limits.hpp>
#include <accdec/simulate/sample_check.hpp>
#include <accdec/verify.hpp>

namespace accdec {

SampleChecker::SampleChecker(const Toolpath& path, const Machine& machine, double sample_period,
                             std::span<double> errors, Broken broken)
    : SampleChecker(path, machine, sample_period, errors, std::move(broken), 0, path.blocks() - 1, 0) {}

SampleChecker::SampleChecker(const Toolpath& path, const Machine& machine, double sample_period,
                             std::span<double> errors, Broken broken, std::size_t first, std::size_t last, int unseen)
    : path_(path),
      machine_(machine),
      rate_(1.0 / sample_period),
      n_(path.dimensions()),
      errors_(errors),
      broken_(std::move(broken)),
      before_(path.point(first), path.point(first) + path.dimensions()),
      now_(before_),
      velocity_(n_),
      acceleration_(n_),
      jerk_(n_),
      largest_(n_),
      unseen_(unseen),
      first_(first),
      last_(last),
      places_{2 * static_cast<std::int64_t>(first), 2 * static_cast<std::int64_t>(first),
              2 * static_cast<std::int64_t>(first)} {
  for (std::size_t b = first; b <= last; ++b) errors[b] = std::numeric_limits<double>::infinity();
  for (std::size_t i = first; i <= last + 1; ++i) {
    for (std::size_t a = 0; a < n_; ++a) largest_[a] = std::max(largest_[a], std::abs(path.point(i)[a]));
  }
  for (std::size_t a = 0; a < machine.axes.size(); ++a) {
    const Axis& axis = machine.axes[a];
    // Half a unit in the last place of every position in a difference of first, second or third order.
    const double rounding = 0.5 * std::numeric_limits<double>::epsilon() * largest_[a] * rate_;
    for (const AxisLimit& limit : axis_limits) {
      if (!(axis.*limit.bound < unlimited)) continue;
      worst_.push_back({limit.kind, a, axis.*limit.bound, 0.0, 0, 0, 2.0 * rounding, 4.0 * rounding * rate_,
                        8.0 * rounding * rate_ * rate_});
    }
  }
}

double SampleChecker::value_of(const Worst& worst) const {
  const Axis& axis = machine_.axes[worst.axis];
  const double v = velocity_[worst.axis], a = acceleration_[worst.axis];
  const auto force = [&] { return axis.mass * a + axis.damping * v; };
  const auto rounded = [&] { return axis.mass * worst.da + axis.damping * worst.dv; };  // of a force
  switch (worst.kind) {
    case LimitKind::force: return std::abs(force()) - rounded();
    case LimitKind::power: return force() * v - rounded() * std::abs(v) - worst.dv * std::abs(force());
    case LimitKind::regeneration: return -force() * v - rounded() * std::abs(v) - worst.dv * std::abs(force());
    case LimitKind::velocity:
    case LimitKind::acceleration:
    case LimitKind::jerk:         // see look_limits
    case LimitKind::force_speed:  // plans of trajectories refuse it
    case LimitKind::vibration:
    case LimitKind::residual:
    case LimitKind::corner_error:
    case LimitKind::speed_min:
    case LimitKind::power_total:
    case LimitKind::regeneration_total:
    case LimitKind::contour: break;  // of no one axis; named so that the compiler reports a missing new one
  }
  return 0.0;
}

void SampleChecker::look_limits(std::int64_t place_first, std::int64_t place_last) {
  for (Worst& worst : worst_) {
    // Millions of samples are looked at: the usual limits first.
    const double value = worst.kind == LimitKind::acceleration ? std::abs(acceleration_[worst.axis]) - worst.da
                         : worst.kind == LimitKind::velocity   ? std::abs(velocity_[worst.axis]) - worst.dv
                         : worst.kind == LimitKind::jerk       ? std::abs(jerk_[worst.axis]) - worst.dj
                                                               : value_of(worst);
    if (!(value > worst.value) && !(value > worst.bound)) continue;
    if (broken_ && value > worst.bound * (1.0 + verification_tolerance)) {
      broken_(std::min(places_[2], place_first), place_last, worst.kind, value / worst.bound);
    }
    if (!(value > worst.value)) continue;
    worst.value = value;
    worst.sample = sample_;
    worst.place = place_last;
  }
}

/// Measures the segment to this sample against every joint whose legs its samples may lie on.
void SampleChecker::look_joints(std::int64_t place_first, std::int64_t place_last) {
  const std::int64_t last = static_cast<std::int64_t>(std::min(last_ + 1, path_.blocks() - 1));
  const std::int64_t from = std::max<std::int64_t>(static_cast<std::int64_t>(first_) + 1,
                                                   (std::min(places_[0], place_first) + 1) / 2),
                     to = std::min(last, place_last / 2 + 1);
  for (std::int64_t c = from; c <= to; ++c) {
    double& error = errors_[static_cast<std::size_t>(c - 1)];
    const double* const joint = path_.point(static_cast<std::size_t>(c));
    error = std::min(error, n_ == 3 ? segment_distance2(before_.data(), now_.data(), joint, 3)
                                    : segment_distance2(before_.data(), now_.data(), joint, n_));
  }
}

void SampleChecker::look(const double* position, std::int64_t place_first, std::int64_t place_last) {
  ++sample_;
  for (std::size_t a = 0; a < n_; ++a) {
    before_[a] = now_[a];
    now_[a] = position[a];
    const double v = (now_[a] - before_[a]) * rate_, acceleration = (v - velocity_[a]) * rate_;
    jerk_[a] = (acceleration - acceleration_[a]) * rate_;
    acceleration_[a] = acceleration;
    velocity_[a] = v;
  }
  if (sample_ > unseen_) look_limits(place_first, place_last);
  look_joints(place_first, place_last);
  places_[2] = places_[1];
  places_[1] = places_[0];
  places_[0] = place_first;
}

void SampleChecker::pass(std::int64_t count, const double* position) {
  if (count == 0) return;
  sample_ += count;
  before_ = now_;
  std::copy_n(position, n_, now_.begin());
  look_joints(places_[0], places_[0]);
}

/// Rests for as long as a difference of third order reaches back.
void SampleChecker::settle() {
  const std::vector<double> end = now_;
  for (int i = 0; i < 3; ++i) look(end.data(), places_[0], 2 * static_cast<std::int64_t>(path_.blocks()) - 1);
}

void SampleChecker::take_roots() {
  for (std::size_t b = first_; b <= last_; ++b) errors_[b] = std::isfinite(errors_[b]) ? std::sqrt(errors_[b]) : 0.0;
}

void SampleChecker::finish_part(bool at_rest) {
  if (at_rest) settle();
  take_roots();
}

SampleCheck SampleChecker::finish() {
  SampleCheck check;
  check.samples = sample_ + 1;
  settle();
  take_roots();
  for (std::size_t b = 0; b + 1 < path_.blocks(); ++b) {
    if (path_.joint[b] == Joint::stop) errors_[b] = std::min(errors_[b], path_.tolerance[b]);
    check.errors_hold = check.errors_hold && holds(errors_[b], path_.tolerance[b]);
  }
  for (const Worst& worst : worst_) {
    const std::size_t block = std::min(static_cast<std::size_t>(worst.place / 2), path_.blocks() - 1);
    LimitUse use;
    use.kind = worst.kind;
    use.axis = path_.axis_name(worst.axis);
    use.line = path_.line[block];
    use.value = worst.value;
    use.bound = worst.bound;
    use.utilisation = utilisation_of(worst.kind, worst.value, worst.bound);
    use.sample = worst.sample;
    check.limits_hold = check.limits_hold && use.utilisation <= 1.0 + verification_tolerance;
    check.limits.push_back(use);
  }
  return check;
}

bool holds(double error, double bound) {
  return error <= bound * (1.0 + verification_tolerance) + position_floor;
}

}  // namespace accdec
