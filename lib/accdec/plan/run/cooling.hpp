#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include <accdec/files.hpp>
#include <accdec/machine.hpp>
#include <accdec/program.hpp>

namespace accdec {

/// Sum of (rms / rating)^2 - 1 over the drives that are warmer than their ratings; 0: all are cool.
inline double excess_of(const std::vector<AxisLoad>& loads) {
  double sum = 0.0;
  for (const AxisLoad& load : loads) sum += std::max(0.0, load.rms * load.rms / (load.rms_max * load.rms_max) - 1.0);
  return sum;
}

/// Slows groups of a plan: all or one of them by one factor, or step by step the group that cools drives most for its
/// time. The fastest plan is the result.
/// @tparam Plan  with members `samples`, and `excess` as above; unlimited: it breaks a limit
template <class Plan>
class Cooling {
 public:
  /// A plan with one group slower by a factor above 1; group 0: all groups
  using Slowed = std::function<Plan(const Plan& from, std::size_t group, double factor)>;

  Cooling(Plan first, std::size_t groups, double trials_max, Slowed slowed, const Deadline& deadline)
      : first_(std::move(first)),
        groups_(groups),
        trials_max_(trials_max),
        slowed_(std::move(slowed)),
        deadline_(deadline) {}

  /// The fastest plan found whose drives are cool.
  std::optional<Plan> run() {
    for (std::size_t group = 0; group <= groups_; ++group) by_one_factor(group);
    apart();
    return std::move(best_);
  }

 private:
  static constexpr double factor_max = 1000.0;  // of all durations
  static constexpr double first_step = 0.05;    // of the durations of a group
  static constexpr double growth = 1.05;        // of the step
  static constexpr double enough = 1e-3;        // of the durations

  Plan slowed(const Plan& from, std::size_t group, double factor) {
    ++trials_;
    Plan trial = slowed_(from, group, factor);
    if (trial.excess <= 0.0 && (!best_ || trial.samples < best_->samples)) best_ = trial;
    return trial;
  }
  bool time_left() const { return trials_ < trials_max_ && !deadline_.over(); }
  /// The least factor found with which slower groups keep the ratings. Slower is not always cooler: a resting drive
  /// cools most while others move, so factors are tried from below.
  void least_factor(const Plan& from, std::size_t group, double low, double high) {
    while (high > low * (1.0 + enough) && time_left()) {
      const double middle = std::sqrt(low * high);
      (slowed(from, group, middle).excess <= 0.0 ? high : low) = middle;
    }
  }

  /// All groups, or one alone, by one factor, unless that is slower than the best plan before it is cool.
  void by_one_factor(std::size_t group) {
    double low = 1.0, high = 1.05;
    while (high < factor_max && !deadline_.over() && (group == 0 || time_left())) {
      const Plan trial = slowed(first_, group, high);
      if (trial.excess <= 0.0) return least_factor(first_, group, low, high);
      if (best_ && trial.samples >= best_->samples) return;
      low = high, high = std::pow(high, 1.4);
    }
  }

  /// Step by step the group that cools most for its time, or all of them.
  void apart() {
    Plan now = first_;
    constexpr double times = 8.0;
    const double most = times * static_cast<double>(first_.samples);
    for (double step = first_step; now.excess > 0.0 && time_left(); step = std::min(1.0, step * growth)) {
      std::optional<Plan> next;
      std::size_t chosen = 0;
      double best_rate = 0.0;
      for (std::size_t group = 0; group <= groups_ && time_left(); ++group) {
        Plan trial = slowed(now, group, 1.0 + step);
        const auto longer = static_cast<double>(std::max<std::int64_t>(1, trial.samples - now.samples));
        const double rate = (now.excess - trial.excess) / longer;
        if (rate > best_rate) best_rate = rate, chosen = group, next = std::move(trial);
      }
      if (!next || static_cast<double>(next->samples) > most) return;
      if (next->excess <= 0.0) least_factor(now, chosen, 1.0, 1.0 + step);
      now = std::move(*next);
    }
  }

  const Plan first_;
  const std::size_t groups_;
  const double trials_max_;
  const Slowed slowed_;
  const Deadline& deadline_;
  std::optional<Plan> best_;
  double trials_ = 0.0;
};

}  // namespace accdec
