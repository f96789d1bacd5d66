#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/design.hpp>
#include <accdec/design/fixed_order.hpp>
#include <accdec/design/last_zeros.hpp>
#include <accdec/filter.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/task/conflict.hpp>
#include <accdec/task/objective.hpp>
#include <accdec/task/order_bound.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// The search over N and integer d around the two smooth problems.
class Search {
 public:
  Search(const Task& task, const DesignOptions& options) : task_(task), options_(options), at_(task, options) {}

  /// Whether some order up to a few times the shortest start has a relaxed design, or a plain shape holds all limits.
  /// Without limits on starting, the best filter passes the command through. The interpolation of the relaxation cannot
  /// express this.
  bool has_relaxed_design() {
    for (const int order : {task_.design.order_min, task_.design.order_min + 1}) {
      if (order > task_.design.order_max) break;
      std::vector<double> pass_through(static_cast<std::size_t>(order) + 1, 0.0);
      pass_through[0] = 1.0;
      for (const Filter& filter : {Filter(pass_through), boxcar(order)}) {
        if (assess(task_, filter, at_.rounded_up(at_.guess_delays(filter), order), false).status == Status::feasible)
          return true;
      }
    }
    const int first = likely_order(std::max(task_.design.order_min, order_lower_bound(task_, task_.design.order_max)));
    const int last = std::min(task_.design.order_max, 3 * first + 30);
    for (int order = first; order <= last && !at_.stopped(); order = std::max(order + 1, order + order / 3)) {
      if (at_.relaxed(order)) return true;
    }
    return false;
  }

  DesignResult run() {
    const int last = task_.design.order_max;
    const int first = std::max(task_.design.order_min, order_lower_bound(task_, last));
    const int likely = first > last ? first : likely_order(first);
    // Orders that do not hold take longest: a design comes first.
    if (likely > first && at_.relaxed(likely)) integer_design(likely);
    const auto holds = [&](int n) { return at_.relaxed(n).has_value(); };
    const int low = first > last ? first : smallest_order(first, likely, holds);
    if (low <= last) {
      design_around(best_order(low), low);
      // If legs must part at the lowest orders, overlapping legs with a longer filter may be faster or slower.
      if (!at_.stopped() && at_.relaxed(low)->parted) {
        const int longer =
            smallest_order(low, low, [&](int n) { return worth(n) && at_.relaxed(n) && !at_.relaxed(n)->parted; });
        if (longer <= last && worth(longer)) design_around(best_order(longer), longer);
      }
    }
    return finish();
  }

 private:
  struct Candidate {
    double cost = 0.0;  // samples, weighted
    std::vector<int> delays;
    Filter filter;
  };

  /// Whether an order could beat the incumbent if its delays cost nothing.
  bool worth(int order) const { return !incumbent_ || at_.filter_cost() * (order + 1.0) < incumbent_->cost; }

  void design_around(int best, int low) {
    // The relaxation differs from the integer problem by about a sample. So neighbouring orders are tried too, nearest
    // first.
    for (const int step : {0, 1, -1, 2, -2, 3, 4}) {
      const int order = best + step;
      if (order < low || order > task_.design.order_max || at_.stopped()) continue;
      if (incumbent_ && optimistic_cost(order) >= incumbent_->cost) continue;
      integer_design(order);
    }
    // If a relaxation held but could not be rounded at its best order, a larger order may work.
    const int last = std::min(task_.design.order_max, 2 * best + 20);
    for (int order = best + 5; !incumbent_ && order <= last && !at_.stopped(); order += 1 + order / 16)
      integer_design(order);
  }

  double relaxed_cost(int order) {
    const auto& r = at_.relaxed(order);
    return r ? r->cost : nlp::infinity;
  }

  double optimistic_cost(int order) {
    const auto& r = at_.relaxed(order);
    if (!r) return nlp::infinity;
    double cost = at_.filter_cost() * (order + 1.0);
    // The B-spline path is farther off than the samples by up to an eighth of a second difference: at most about one
    // sample of delay.
    for (std::size_t j = 0; j < task_.corners.size(); ++j) {
      cost += task_.corners[j].weight * std::max(0.0, std::ceil(r->delays[j] - 1.0));
    }
    return cost;
  }

  /// About the smallest order that holds, at least `bound`. Behind a servo that bound knows no force: the motion goes
  /// on after the command. If a mass starts at its largest force, the command may end earlier by the servo's lag.
  int likely_order(int bound) const {
    if (Response(task_.machine, task_.sample_period).ideal()) return bound;
    Task ideal = task_;
    ideal.machine.prefilter_taps.clear();
    for (Axis& axis : ideal.machine.axes) axis.servo_gain = unlimited, axis.response_taps.clear();
    const int last = task_.design.order_max, order = order_lower_bound(ideal, last);
    return order > last ? bound : std::max(bound, order - static_cast<int>(at_.lag()));
  }

  /// Smallest order from `first` on for which `holds` is true; order_max + 1 if there is none. Feasibility is monotone
  /// in N, because a zero tap can be appended. @param near  where to begin
  template <class Predicate>
  int smallest_order(int first, int near, Predicate holds) {
    const int last = task_.design.order_max;
    int bad = first - 1, good = last + 1, step = 1;
    for (int at = near; !at_.stopped(); step *= 2) {
      const bool enough = holds(at);
      (enough ? good : bad) = at;
      const int next = enough ? std::max(first, at - step) : std::min(last, at + step);
      if (next <= bad || next >= good || next == at) break;
      at = next;
    }
    while (good - bad > 1 && !at_.stopped()) {
      const int middle = bad + (good - bad) / 2;
      (holds(middle) ? good : bad) = middle;
    }
    return good;
  }

  /// Order of least relaxed cost: with larger N the delays get shorter, so the sum has one minimum.
  int best_order(int low) {
    double least = nlp::infinity;
    int best = low;
    const auto ceiling = [&] { return static_cast<int>(std::min(least / at_.filter_cost(), 1e9)); };
    const auto cost = [&](int order) {
      const double c = relaxed_cost(order);
      if (c < least) least = c, best = order;
      return c;
    };
    cost(low);
    int a = low, b = low, step = 1;
    // Bracket by doubling, then narrow by thirds.
    while (b < task_.design.order_max && !at_.stopped()) {
      const int next = std::min({task_.design.order_max, b + step, std::max(ceiling(), b)});
      if (next == b) break;
      const bool rising = cost(next) > cost(b);
      if (!rising) a = b;
      b = next;
      if (rising) break;
      step *= 2;
    }
    while (b - a > 2 && !at_.stopped()) {
      const int left = a + (b - a) / 3, right = b - (b - a) / 3;
      (cost(left) <= cost(right) ? b : a) = cost(left) <= cost(right) ? right : left;
    }
    for (int order = a; order <= b && !at_.stopped(); ++order) cost(order);
    return best;
  }

  void integer_design(int order) {
    const auto& r = at_.relaxed(order);
    if (!r) return;
    std::vector<int> delays = at_.rounded_up(r->delays, order);
    std::vector<int> samples;
    for (std::size_t j = 0; j < delays.size(); ++j) {
      const double t = r->instants[j] + delays[j] - r->delays[j];
      samples.push_back(r->instants[j] < 0.0 ? (order + delays[j]) / 2 : static_cast<int>(std::lround(t - 0.5)));
    }
    const auto part = [&] { delays = at_.parting_delays(order); };
    bool ok = attempt(order, delays, samples, *r->filter);
    // Repair: lengthen the delay of the corner with the largest error use, until all hold or the legs part.
    for (int tries = 0; !ok && tries < 12 && !at_.stopped(); ++tries) {
      if (!lengthen(delays, order)) break;
      ok = attempt(order, delays, samples, *r->filter);
    }
    if (!ok && !at_.stopped()) {
      part();
      ok = attempt(order, delays, samples, *r->filter);
    }
    if (ok) shorten(order, delays, samples, *r->filter);
  }

  /// Shortens delays while that holds, the heaviest corner first, by steps that halve.
  void shorten(int order, std::vector<int> delays, const std::vector<int>& samples, const Filter& start) {
    std::vector<std::size_t> by_weight(delays.size());
    for (std::size_t j = 0; j < by_weight.size(); ++j) by_weight[j] = j;
    std::stable_sort(by_weight.begin(), by_weight.end(),
                     [&](std::size_t i, std::size_t j) { return task_.corners[i].weight > task_.corners[j].weight; });
    for (const std::size_t j : by_weight) {
      if (task_.corners[j].delay) continue;
      for (int step = 1 + delays[j] / 4; step > 0 && !at_.stopped(); step /= 2) {
        while (delays[j] >= step && !at_.stopped()) {
          delays[j] -= step;
          if (attempt(order, delays, samples, start)) continue;
          delays[j] += step;
          break;
        }
      }
    }
  }

  bool lengthen(std::vector<int>& delays, int order) const {
    std::optional<std::size_t> worst;
    for (std::size_t j = 0; j < delays.size(); ++j) {
      const TaskCorner& corner = task_.corners[j];
      if (corner.delay || !(corner.error_max || corner.contour_max) || delays[j] >= at_.parting_delays(order)[j])
        continue;
      if (!worst || last_error_use_[j] > last_error_use_[*worst]) worst = j;
    }
    if (!worst) return false;
    ++delays[*worst];
    return true;
  }

  bool attempt(int order, const std::vector<int>& delays, const std::vector<int>& samples, const Filter& start) {
    const std::optional<Filter> filter = at_.largest_margin(order, delays, start, samples);
    last_error_use_.assign(delays.size(), 0.0);
    if (!filter) return false;
    DesignResult result = assess(task_, *filter, delays, false);
    for (const LimitUse& use : result.limits) {
      if (use.kind != LimitKind::corner_error && use.kind != LimitKind::contour) continue;
      for (std::size_t j = 0; j < delays.size(); ++j) {
        if (task_.corners[j].name == use.corner) last_error_use_[j] = std::max(last_error_use_[j], use.utilisation);
      }
    }
    if (result.status != Status::feasible) {
      last_message_ = result.message;
      return false;
    }
    const Filter shorter = without_last_zeros(task_, *filter, delays);
    if (shorter.order() < order) result = assess(task_, shorter, delays, false);
    const double cost = result.objective() / task_.sample_period;
    if (!incumbent_ || cost < incumbent_->cost - 1e-9) {
      incumbent_ = Candidate{cost, delays, shorter};
      if (options_.nlp.improved) options_.nlp.improved(result.objective(), at_.counts());
      at_.tell(fmt::format("N = {}: verified {} time {:.3f} ms", order, to_string(task_.design.objective),
                           result.objective() * 1e3));
    }
    return true;
  }

  DesignResult finish() {
    DesignResult result;
    if (incumbent_) {
      result = assess(task_, incumbent_->filter, incumbent_->delays, false);
      if (at_.stopped()) result.message = "stopped early; the best verified design so far";
    } else {
      result.task = task_;
      result.status = Status::failed;
      result.message = at_.stopped() ? "stopped before a verified design was found" : no_design();
    }
    result.stop = at_.stop_reason();
    result.solver = at_.report();
    return result;
  }

  /// Why there is no design, as far as a local solver can tell: limits such that, without any one of them, it finds a
  /// design.
  std::string no_design() const {
    std::string message = fmt::format("{} found no design up to order {} ([design] order_max)", options_.nlp.solver,
                                      task_.design.order_max);
    // Finding the conflicting limits takes many small searches: they share the rest of the time.
    bool in_time = true;
    const auto has_design = [&](const Task& task) {
      DesignOptions quiet = options_;
      quiet.progress = nullptr;
      quiet.nlp.improved = nullptr;
      quiet.time_limit = options_.time_limit - at_.elapsed();
      in_time = in_time && quiet.time_limit > 0.0;
      return in_time && Search(task, quiet).has_relaxed_design();
    };
    const std::vector<std::string> conflict = limits_in_conflict(task_, false, has_design);
    in_time = in_time && at_.elapsed() < options_.time_limit;
    if (in_time && !conflict.empty())
      message += fmt::format("; limits in conflict (by local search, not proved): {}", fmt::join(conflict, ", "));
    const std::string& last = last_message_.empty() ? at_.last_message() : last_message_;
    if (!last.empty()) message += "; last: " + last;
    return message;
  }

  const Task& task_;
  const DesignOptions& options_;
  FixedOrderDesigner at_;
  std::optional<Candidate> incumbent_;
  std::vector<double> last_error_use_;
  std::string last_message_;  // of the last design that did not verify
};

}  // namespace

DesignResult design_nlp(const Task& task, const DesignOptions& options) {
  solvers::find_solver(options.nlp.solver);
  const int last = task.design.order_max;
  const int first = std::min(last, std::max(task.design.order_min, order_lower_bound(task, last)));
  if (std::string why = step_too_long(task, first, options.time_limit); !why.empty()) {
    DesignResult failed;
    failed.task = task;
    failed.stop = StopReason::time_limit;
    failed.message = std::move(why);
    return failed;
  }
  return Search(task, options).run();
}

}  // namespace accdec
