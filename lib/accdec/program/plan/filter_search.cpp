#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include <accdec/files/seconds_since.hpp>
#include <accdec/motion/shapes.hpp>
#include <accdec/program/plan/filter_search.hpp>
#include <accdec/program/plan/stretches.hpp>
#include <accdec/task/verifier.hpp>

namespace accdec {
namespace {

constexpr std::size_t whole_max = 20'000;  // blocks up to which a program is judged as a whole
constexpr int rounds_to_judge = 3;

class Search {
 public:
  Search(const Toolpath& path, double sample_period, const Machine& machine, const FilterSearchOptions& options)
      : parts_(stretches(path, whole_max)),
        period_(sample_period),
        machine_(machine),
        options_(options),
        start_(std::chrono::steady_clock::now()) {
    double top = 0.0;
    for (const Toolpath& part : parts_) {
      for (std::size_t b = 0; b < part.blocks(); ++b) {
        for (std::size_t a = 0; a < part.dimensions(); ++a) {
          top = std::max(top, std::abs(part.point(b + 1)[a] - part.point(b)[a]) / part.duration[b] / acceleration(a));
        }
      }
    }
    for (std::size_t a = 0; a < machine.axes.size(); ++a) {
      if (machine.axes[a].jerk_max < unlimited)
        ramp_ = std::max(ramp_, acceleration(a) / (machine.axes[a].jerk_max * period_));
    }
    // A filter longer than the fastest block's start would only ever lose time, or hold a jerk limit that binds alone.
    longest_ = std::clamp(static_cast<int>(std::ceil(1.1 * top / period_ + 2.0 * std::min(ramp_, 400.0))) + 2, 4,
                          options.order_max + 1);
  }

  FilterSearch run() {
    // Outwards from a guess, until longer or shorter ones only lose.
    for (const double factor : {1.25, 0.8}) {
      int losses = 0;
      for (double n = std::min<double>(guess(), longest_); n >= 1.5 && n <= longest_ && losses < 3 && !late();
           n *= factor) {
        const double before = time_;
        for (const int shorter : ramps(static_cast<int>(n))) offer(static_cast<int>(n), shorter);
        losses = time_ < before ? 0 : losses + (found() ? 1 : 0);
      }
    }
    for (int step = std::max(1, best_.first / 6); found() && step > 0 && !late();) {
      const auto before = best_;
      for (const int d : {-step, step}) {
        offer(before.first + d, std::min(before.second, before.first + d));
        if (before.second > 1) {
          offer(before.first, before.second + d);
          offer(before.first + d, before.second + d);
        }
      }
      if (before == best_) step /= 2;
    }
    FilterSearch result;
    if (found()) result.filter = make(best_.first, best_.second);
    result.evaluations = static_cast<long>(seen_.size());
    return result;
  }

 private:
  static Filter make(int longer, int shorter) { return trapezoid(longer + shorter - 2, shorter - 1); }

  double acceleration(std::size_t axis) const {
    if (axis >= machine_.axes.size()) return 1e30;
    const Axis& limits = machine_.axes[axis];
    const double by_force = limits.mass > 0.0 ? limits.force_max / limits.mass : unlimited;
    return std::min({limits.acceleration_max, by_force, 1e30});
  }

  std::vector<int> ramps(int longer) const {
    if (ramp_ == 0.0 && machine_.modes.empty()) return {1};
    // As long as the jerk limit asks for with the whole acceleration, or less of it; for vibrations anything.
    std::vector<int> result;
    for (const double part : {0.75, 1.0}) {
      if (ramp_ > 0.0) result.push_back(std::clamp(static_cast<int>(std::ceil(part * ramp_)), 1, longer));
    }
    for (const double part : {0.01, 0.25, 0.5, 0.75, 1.0}) {
      if (!machine_.modes.empty()) result.push_back(std::max(1, static_cast<int>(part * longer)));
    }
    std::sort(result.begin(), result.end());
    result.erase(std::unique(result.begin(), result.end()), result.end());
    return result;
  }

  /// Of the longer average, samples: a right-angled corner's parabola, at least as long as the ramps.
  double guess() const {
    std::vector<double> tolerances;
    for (const Toolpath& part : parts_) {
      for (const double t : part.tolerance) {
        if (t > 0.0 && t < unlimited) tolerances.push_back(t);
      }
    }
    double a = unlimited;
    for (std::size_t i = 0; i < parts_.front().dimensions(); ++i) a = std::min(a, acceleration(i));
    double tau = 20.0;
    if (!tolerances.empty() && a < 1e30) {
      const auto middle = tolerances.begin() + static_cast<std::ptrdiff_t>(tolerances.size() / 2);
      std::nth_element(tolerances.begin(), middle, tolerances.end());
      tau = std::sqrt(4.0 * std::sqrt(2.0) * *middle / a) / period_;
    }
    return std::max({2.0, tau, std::min(ramp_, 400.0)});
  }

  bool found() const { return time_ < unlimited; }
  bool late() const { return seconds_since(start_) > options_.time_limit; }

  void offer(int longer, int shorter) {
    const int order = longer + shorter - 2;
    if (shorter < 1 || shorter > longer || order < options_.order_min || order > options_.order_max) return;
    if (found() && late()) return;
    const auto [entry, first] = seen_.emplace(std::pair{longer, shorter}, unlimited);
    if (!first) return;
    const Filter filter = make(longer, shorter);
    for (const LimitUse& use : vibration_utilisation(filter, period_, machine_)) {
      if (use.utilisation > 1.0) return;
    }
    double time = 0.0;
    for (const Toolpath& part : parts_) {
      const ScheduledPlan plan = schedule_feeds(part, filter, period_, machine_, rounds_to_judge);
      // What does not hold yet will by a little more time.
      time += static_cast<double>(plan.plan.simulation.samples) * period_ * (all_holds(plan.plan) ? 1.0 : 1.01);
    }
    entry->second = time;
    if (!(time < time_)) return;
    time_ = time;
    best_ = {longer, shorter};
    if (options_.progress) options_.progress(fmt::format("{} taps: {:.4f} s", order + 1, time));
  }

  const std::vector<Toolpath> parts_;
  double period_;
  const Machine& machine_;
  const FilterSearchOptions& options_;
  std::chrono::steady_clock::time_point start_;
  double ramp_ = 0.0;  // samples from no acceleration to the largest at the largest jerk
  int longest_ = 4;
  std::map<std::pair<int, int>, double> seen_;
  std::pair<int, int> best_{0, 0};
  double time_ = unlimited;
};

}  // namespace

FilterSearch search_filter(const Toolpath& path, double sample_period, const Machine& machine,
                           const FilterSearchOptions& options) {
  return Search(path, sample_period, machine, options).run();
}

}  // namespace accdec
