#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include <accdec/machine/limits.hpp>
#include <accdec/simulate/joint_distance.hpp>
#include <accdec/simulate/motion_extremes.hpp>
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
      batch_(path, first),
      unseen_(unseen),
      first_(first),
      last_(last) {
  for (std::size_t b = first; b <= last; ++b) errors[b] = std::numeric_limits<double>::infinity();
  std::vector<double> largest(n_);
  for (std::size_t i = first; i <= last + 1; ++i) {
    for (std::size_t a = 0; a < n_; ++a) largest[a] = std::max(largest[a], std::abs(path.point(i)[a]));
  }
  for (std::size_t a = 0; a < machine.axes.size(); ++a) {
    const Axis& axis = machine.axes[a];
    // Half a unit in the last place of every position in a difference of first, second or third order.
    const double rounding = 0.5 * std::numeric_limits<double>::epsilon() * largest[a] * rate_;
    for (const AxisLimit& limit : axis_limits) {
      if (!(axis.*limit.bound < unlimited)) continue;
      worst_.push_back({limit.kind, a, axis.*limit.bound, 0.0, 0, 0, 2.0 * rounding, 4.0 * rounding * rate_,
                        8.0 * rounding * rate_ * rate_});
    }
  }
}

/// Samples begin .. count_ of the batch, one by one. @param value  of a sample
template <class Value>
void SampleChecker::look_values(Worst& worst, std::int64_t begin, const Value& value_of) {
  for (std::int64_t i = begin; i <= batch_.count(); ++i) {
    const double value = value_of(i);
    if (!(value > worst.value) && !(value > worst.bound)) continue;
    if (broken_ && value > worst.bound * (1.0 + verification_tolerance)) {
      // The first of the samples that a jerk is made of is three places before.
      broken_(std::min(batch_.place_first(i, 3), batch_.place_first(i)), batch_.place_last(i), worst.kind,
              value / worst.bound);
    }
    if (!(value > worst.value)) continue;
    worst.value = value;
    worst.sample = sample_ - batch_.count() + i;
    worst.place = batch_.place_last(i);
  }
}

void SampleChecker::look_limit(Worst& worst, std::int64_t begin) {
  const Axis& axis = machine_.axes[worst.axis];
  const double* const v = batch_.velocity(worst.axis);
  const double* const a = batch_.acceleration(worst.axis);
  const auto force = [&](std::int64_t i) { return axis.mass * a[i] + axis.damping * v[i]; };
  const double rounded = axis.mass * worst.da + axis.damping * worst.dv;  // of a force
  const auto power = [&](std::int64_t i, double sign) {
    return sign * force(i) * v[i] - rounded * std::abs(v[i]) - worst.dv * std::abs(force(i));
  };
  switch (worst.kind) {
    case LimitKind::velocity: return look_values(worst, begin, [&](auto i) { return std::abs(v[i]) - worst.dv; });
    case LimitKind::acceleration: return look_values(worst, begin, [&](auto i) { return std::abs(a[i]) - worst.da; });
    case LimitKind::jerk:
      return look_values(worst, begin, [&](auto i) { return std::abs((a[i] - a[i - 1]) * rate_) - worst.dj; });
    case LimitKind::force: return look_values(worst, begin, [&](auto i) { return std::abs(force(i)) - rounded; });
    case LimitKind::power: return look_values(worst, begin, [&](auto i) { return power(i, 1.0); });
    case LimitKind::regeneration: return look_values(worst, begin, [&](auto i) { return power(i, -1.0); });
    case LimitKind::force_speed:  // plans of trajectories refuse it
    case LimitKind::vibration:
    case LimitKind::residual:
    case LimitKind::corner_error:
    case LimitKind::speed_min:
    case LimitKind::power_total:
    case LimitKind::regeneration_total:
    case LimitKind::contour: return;  // of no one axis; named so that the compiler reports a missing new one
  }
}

void SampleChecker::look_limits() {
  const std::int64_t count = batch_.count();
  const std::int64_t begin = std::clamp<std::int64_t>(unseen_ - (sample_ - count) + 1, 1, count + 1);
  batch_.difference(rate_);
  constexpr double room = 1.0 + 1e-12;  // the extremes are rounded otherwise
  for (std::size_t k = 0; k < worst_.size();) {
    const std::size_t axis = worst_[k].axis;
    const Axis& limits = machine_.axes[axis];
    const bool loads =
        limits.force_max < unlimited || limits.power_max < unlimited || limits.regeneration_max < unlimited;
    const MotionExtremes most = motion_extremes(batch_.velocity(axis) + begin, batch_.acceleration(axis) + begin,
                                                count + 1 - begin, limits.mass, limits.damping, loads);
    for (; k < worst_.size() && worst_[k].axis == axis; ++k) {
      Worst& worst = worst_[k];
      const double largest = worst.kind == LimitKind::velocity       ? most.velocity - worst.dv
                             : worst.kind == LimitKind::acceleration ? most.acceleration - worst.da
                             : worst.kind == LimitKind::jerk         ? most.jerk * rate_ - worst.dj
                             : worst.kind == LimitKind::force        ? most.force
                             : worst.kind == LimitKind::power        ? most.power
                                                                     : most.regeneration;
      // One by one only where something is worse than before.
      if (largest * room > std::min(worst.value, worst.bound)) look_limit(worst, begin);
    }
  }
}

/// Joints whose legs the samples i - 1 and i of the batch may lie on.
std::int64_t SampleChecker::first_joint(std::int64_t i) const {
  return std::max<std::int64_t>(static_cast<std::int64_t>(first_) + 1,
                                (std::min(batch_.place_first(i, 1), batch_.place_first(i)) + 1) / 2);
}
std::int64_t SampleChecker::last_joint(std::int64_t i) const {
  return std::min<std::int64_t>(static_cast<std::int64_t>(std::min(last_ + 1, path_.blocks() - 1)),
                                batch_.place_last(i) / 2 + 1);
}

/// The path to each sample is measured against every such joint. Places do not fall within a batch, so the samples
/// beside a joint follow each other.
void SampleChecker::look_joints() {
  const std::int64_t count = batch_.count();
  std::int64_t begin = 1, end = 1;
  for (std::int64_t c = first_joint(1); c <= last_joint(count); ++c) {
    while (last_joint(begin) < c) ++begin;
    end = std::max(end, begin);
    while (end <= count && first_joint(end) <= c) ++end;
    if (end == begin) continue;
    double& error = errors_[static_cast<std::size_t>(c - 1)];
    const double* const joint = path_.point(static_cast<std::size_t>(c));
    error = std::min(error, path_squared(batch_.positions(), n_, joint, begin - 1, end - 1));
  }
}

void SampleChecker::look_at_batch() {
  if (batch_.count() == 0) return;
  look_limits();
  look_joints();
  batch_.end();
}

void SampleChecker::look(const double* position, std::int64_t place_first, std::int64_t place_last) {
  if (!batch_.takes(place_first, place_last)) look_at_batch();
  batch_.add(position, place_first, place_last);
  ++sample_;
}

void SampleChecker::pass(std::int64_t count, const double* position) {
  if (count == 0) return;
  look_at_batch();
  sample_ += count;
  const std::int64_t place = batch_.place_first(0);
  batch_.add(position, place, place);
  look_joints();
  batch_.end_steady();
}

std::int64_t SampleChecker::look_on(ProfileMotion& motion) {
  if (!motion.next()) return 0;
  look(motion.position(), motion.place_first(), motion.place_last());
  const std::int64_t run = motion.next_run(batch_.rows_behind(), batch_.firsts_behind(), batch_.room());
  batch_.add_run(run, motion.place_last());
  sample_ += run;
  pass(motion.pass_steady(), motion.position());
  return 1 + run;
}

/// Rests for as long as a difference of third order reaches back.
void SampleChecker::settle() {
  std::vector<double> end;
  for (std::size_t a = 0; a < n_; ++a) end.push_back(batch_.positions()[a][batch_.count()]);
  const std::int64_t place = batch_.place_first(batch_.count());
  for (int i = 0; i < 3; ++i) look(end.data(), place, 2 * static_cast<std::int64_t>(path_.blocks()) - 1);
  look_at_batch();
}

void SampleChecker::take_roots() {
  for (std::size_t b = first_; b <= last_; ++b) errors_[b] = std::isfinite(errors_[b]) ? std::sqrt(errors_[b]) : 0.0;
}

void SampleChecker::finish_part(bool at_rest) {
  if (at_rest) settle();
  look_at_batch();
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
