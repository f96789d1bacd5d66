#include <algorithm>
#include <cmath>
#include <utility>

#include <accdec/program/plan/joint_delays.hpp>
#include <accdec/program/plan/program_plan.hpp>

namespace accdec {

JointDelays::JointDelays(const Toolpath& path, const LegFilters& filters, double sample_period, const Machine& machine)
    : path_(path),
      filters_(filters.filters()),
      period_(sample_period),
      limits_(filters, machine, sample_period),
      finders_(filters_.size() * filters_.size()) {
  // Half the mean absolute deviation of the taps: a smooth joint passed without delay errs by it times |v2 u2 - v1 u1|
  // T at most.
  for (const Filter& filter : filters_) {
    double& spread = spread_.emplace_back(0.0);
    for (int i = 0; i <= filter.order(); ++i) spread += filter.tap(i) * std::max(0.0, i - filter.mean_delay());
  }
}

void JointDelays::load(std::size_t block, double factor, std::array<double, program_axis_count>& velocity,
                       double& speed) const {
  const std::size_t n = path_.dimensions();
  const double* p = path_.point(block);
  const double scale = factor / path_.duration[block];
  double sum = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    velocity[i] = (p[n + i] - p[i]) * scale;
    sum += velocity[i] * velocity[i];
  }
  speed = std::sqrt(sum);
}

double JointDelays::cos_interior() const {
  double dot = 0.0;
  for (std::size_t i = 0; i < path_.dimensions(); ++i) dot += in_[i] * out_[i];
  return std::clamp(-dot / (speed_in_ * speed_out_), -1.0, 1.0);
}

int JointDelays::within_limits(std::size_t f_in, std::size_t f_out, int delay) {
  return limits_.any() ? limits_.smallest(f_in, f_out, in_.data(), out_.data(), delay, possible_) : delay;
}

const DelayFinder& JointDelays::finder(std::size_t f_in, std::size_t f_out) {
  std::unique_ptr<DelayFinder>& finder = finders_[f_in * filters_.size() + f_out];
  if (!finder) finder = std::make_unique<DelayFinder>(filters_[f_in], filters_[f_out]);
  return *finder;
}

int JointDelays::exact_stop(std::size_t f_in, std::size_t f_out) const {
  return std::max(0, filters_[f_in].last_nonzero_tap() - filters_[f_out].first_nonzero_tap());
}

int JointDelays::stop(std::size_t b, std::size_t f_in, std::size_t f_out) {
  load(b, 1.0, in_, speed_in_);
  load(b + 1, 1.0, out_, speed_out_);
  return within_limits(f_in, f_out, exact_stop(f_in, f_out));
}

int JointDelays::corner(std::size_t b, std::size_t f_in, std::size_t f_out, double factor_in, double factor_out) {
  load(b, factor_in, in_, speed_in_);
  load(b + 1, factor_out, out_, speed_out_);
  const int delay = finder(f_in, f_out)(cos_interior(), speed_in_ * period_, speed_out_ * period_, path_.tolerance[b]);
  return within_limits(f_in, f_out, delay);
}

int JointDelays::smooth(std::size_t b, std::size_t f) {
  load(b, 1.0, in_, speed_in_);
  load(b + 1, 1.0, out_, speed_out_);
  double change2 = 0.0;
  for (std::size_t i = 0; i < path_.dimensions(); ++i) change2 += (out_[i] - in_[i]) * (out_[i] - in_[i]);
  const double bound = path_.tolerance[b], spread = spread_[f] * period_;
  int delay = 0;
  if (spread * spread * change2 > bound * bound) {
    delay = smallest_path_delay(filters_[f], cos_interior(), speed_in_ * period_, speed_out_ * period_, bound,
                                exact_stop(f, f));
  }
  return within_limits(f, f, delay);
}

bool JointDelays::starts(std::size_t b, std::size_t f) {
  if (!limits_.any()) return true;
  load(b, 1.0, in_, speed_in_);
  if (limits_.start_factor(f, in_.data()) >= 1.0) return true;
  out_.fill(0.0);
  if (!limits_.holds(filters_[f], filters_[f], in_.data(), out_.data(), 0)) return false;
  std::swap(in_, out_);
  return limits_.holds(filters_[f], filters_[f], in_.data(), out_.data(), 0);
}

}  // namespace accdec
