#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include <accdec/families/trial_search.hpp>
#include <accdec/files.hpp>
#include <accdec/machine/force_speed.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/plan/command/stop_everywhere.hpp>
#include <accdec/plan/feeds/stretches.hpp>
#include <accdec/plan/filters/filter_search.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

constexpr std::size_t whole_max = 20'000;  // blocks up to which a program is judged as a whole
constexpr int rounds_to_judge = 3;
constexpr int mending_rounds_max = 40;  // of mending a plan that may be the best
/// Added to the time of filters whose plan does not hold, s, so that they come after all others.
constexpr double behind_all = 1e12;

class Search {
 public:
  Search(const Toolpath& path, double sample_period, const Machine& machine, const FilterSearchOptions& options)
      : parts_(stretches(path, whole_max)),
        period_(sample_period),
        machine_(machine),
        options_(options),
        start_(std::chrono::steady_clock::now()),
        end_of_first_(options.time_limit + seconds_for_one_plan(path)),
        search_(
            *find_family("trapezoid"),
            {options.order_min, options.order_max, machine.modes.empty() && !limits_jerk(machine)},
            [this](const Filter& filter) { return time_of(filter); }, [this] { return search_.found() && late(); }) {
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
    // A filter longer than the start of the fastest block would only lose time, except if a jerk limit alone binds.
    longest_ = std::clamp(static_cast<int>(std::ceil(1.1 * top / period_ + 2.0 * std::min(ramp_, 400.0))) + 2, 4,
                          options.order_max + 1);
  }

  FilterSearch run() {
    // Outwards from a guess, until longer or shorter ones only lose.
    for (const double factor : {1.25, 0.8}) {
      int losses = 0;
      for (double n = std::min<double>(guess(), longest_);
           n >= 1.5 && n <= longest_ && losses < 3 && !(search_.found() && late()); n *= factor) {
        bool better = false;
        for (const int shorter : ramps(static_cast<int>(n))) better |= search_.offer({static_cast<int>(n), shorter});
        losses = better ? 0 : losses + (search_.found() ? 1 : 0);
      }
    }
    search_.refine(6);
    FilterSearch result;
    if (search_.found()) result.filter = search_.cost() < behind_all ? search_.filter() : best_with_stops();
    result.evaluations = search_.tried();
    return result;
  }

 private:
  double acceleration(std::size_t axis) const {
    if (axis >= machine_.axes.size()) return 1e30;
    const Axis& limits = machine_.axes[axis];
    const double force = force_limit(limits) - limits.coulomb;
    const double by_force = limits.mass > 0.0 && force > 0.0 ? force / limits.mass : unlimited;
    return std::min({limits.acceleration_max, by_force, 1e30});
  }

  std::vector<int> ramps(int longer) const {
    if (ramp_ == 0.0 && machine_.modes.empty()) return {1};
    // As long as the jerk limit requires with the full acceleration, or with less of it; for vibrations any length.
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

  /// Length of the longer average in samples: a right-angled corner's parabola, at least as long as the ramps.
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

  bool late() const { return seconds_since(start_) > options_.time_limit; }

  /// The filter that acts on the command; none if it breaks a vibration bound.
  std::optional<Filter> command_of(const Filter& set) const {
    Machine control;
    control.prefilter_taps = options_.smoothing;
    Filter filter = Response(control, period_).command(set);
    for (const LimitUse& use : vibration_utilisation(filter, period_, machine_)) {
      if (use.utilisation > 1.0) return std::nullopt;
    }
    return filter;
  }

  double time_of(const Filter& set) const {
    const std::optional<Filter> filter = command_of(set);
    if (!filter) return unlimited;
    double time = planned(*filter, rounds_to_judge);
    // Few plans need more rounds to hold, and each costs as much as the first.
    const bool more = !late() || !search_.found();
    if (time > behind_all && time - behind_all < search_.cost() && more) time = planned(*filter, mending_rounds_max);
    if (time > behind_all) time = behind_all + stopping(*filter);
    // A plan that was not finished is judged only where there is no other.
    if (late() && search_.cost() < unlimited) return unlimited;
    if (options_.progress && time < search_.cost() && time < behind_all)
      options_.progress(fmt::format("{} taps: {:.4f} s", set.order() + 1, time));
    return time;
  }

  /// The time of the plan, s, and `behind_all` if it does not hold.
  double planned(const Filter& filter, int rounds) const {
    double time = 0.0;
    bool held = true;
    for (const Toolpath& part : parts_) {
      const Deadline& until = search_.found() ? end_ : end_of_first_;
      const ScheduledPlan plan = schedule_feeds(part, filter, period_, machine_, rounds, until);
      time += static_cast<double>(plan.plan.simulation.samples) * period_;
      held = held && all_holds(plan.plan);
    }
    return held ? time : behind_all + time;
  }

  /// The time of the plan for want of another, s.
  double stopping(const Filter& filter) const {
    double samples = 0.0;
    for (const Toolpath& part : parts_) samples += stop_everywhere_samples(part, filter, period_, machine_);
    return samples * period_;
  }

  /// For a search that ended before a plan held: most likely the program will be planned with stops.
  Filter best_with_stops() const {
    TrialSearch stops(*find_family("trapezoid"), {options_.order_min, options_.order_max}, [this](const Filter& set) {
      const std::optional<Filter> filter = command_of(set);
      return filter ? stopping(*filter) : unlimited;
    });
    stops.offer(search_.best());
    for (double n = 2.0; n <= options_.order_max + 1.0; n = std::max(n + 1.0, 1.25 * n)) {
      for (const int shorter : ramps(static_cast<int>(n))) stops.offer({static_cast<int>(n), shorter});
    }
    stops.refine(6);
    return stops.filter();
  }

  const std::vector<Toolpath> parts_;
  double period_;
  const Machine& machine_;
  const FilterSearchOptions& options_;
  std::chrono::steady_clock::time_point start_;
  const Deadline end_{options_.time_limit};
  /// The guess is judged by a whole plan: it is a good filter, whatever the time limit.
  const Deadline end_of_first_;
  double ramp_ = 0.0;  // samples from no acceleration to the largest at the largest jerk
  int longest_ = 4;
  TrialSearch search_;
};

}  // namespace

FilterSearch search_filter(const Toolpath& path, double sample_period, const Machine& machine,
                           const FilterSearchOptions& options) {
  return Search(path, sample_period, machine, options).run();
}

}  // namespace accdec
