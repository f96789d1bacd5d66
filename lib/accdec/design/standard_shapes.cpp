#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <functional>
#include <vector>

#include <accdec/design/standard_shapes.hpp>
#include <accdec/family.hpp>
#include <accdec/files.hpp>
#include <accdec/motion/least_held.hpp>
#include <accdec/task/delays_by_formula.hpp>
#include <accdec/task/objective.hpp>
#include <accdec/task/order_bound.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// The one member of each order that is looked at.
using MemberOf = std::function<FilterSpec(int order)>;

/// Kaiser's window: of a band that must be quiet, the larger beta the less is left (1e-7 from about 15 on).
FilterSpec kaiser(int order, double beta) {
  FilterSpec spec{.kind = Shape::taps, .order = order};
  for (int i = 0; i <= order; ++i) {
    const double x = order > 0 ? 2.0 * i / order - 1.0 : 0.0;
    spec.taps.push_back(std::cyl_bessel_i(0.0, beta * std::sqrt(std::max(0.0, 1.0 - x * x))));
  }
  return spec;
}

/// Two averages, the second a part of the order long.
MemberOf two_averages(int part) {
  return [part, &family = *find_family("trapezoid")](int order) {
    return family.member(std::array{order - order / part + 1, order / part + 1});
  };
}

MemberOf window(const char* name) {
  return [&family = *find_family(name)](int order) {
    FilterSpec spec = family.member({});
    spec.order = std::max(order, family.least_order);
    return spec;
  };
}

std::vector<MemberOf> members(bool quiet) {
  std::vector<MemberOf> list;
  // Only Kaiser windows do if next to nothing may be left. So they come first: time may be short.
  for (const double beta : {18.0, 14.0, 10.0, 6.0}) {
    if (quiet) list.push_back([beta](int n) { return kaiser(n, beta); });
  }
  for (const int part : {4, 3, 2}) list.push_back(two_averages(part));
  list.push_back([&family = *find_family("boxcar")](int order) { return family.member(std::array{order + 1}); });
  list.push_back(two_averages(10));
  for (const char* name : {"hann", "blackman"}) list.push_back(window(name));
  return list;
}

class StandardShapes {
 public:
  StandardShapes(const Task& task, std::function<bool()> stop)
      : task_(task), stop_(std::move(stop)), cost_(cost_of(task)) {}

  void try_members(const MemberOf& member) {
    const int last = task_.design.order_max;
    const int first = std::max({1, task_.design.order_min, order_lower_bound(task_, last)});
    // Limits hold approximately from some order on: doubled steps find such an order, halved steps the smallest.
    int low = first - 1, high = first;
    for (int step = std::max(1, first / 8); !stop_() && !offer(member, high); step *= 2) {
      if (high == last) return;
      low = high;
      high = std::min(last, high + step);
    }
    high = least_held(low, high, [&](int order) { return stop_() || offer(member, order); });
    // A longer filter may need shorter delays.
    for (int i = 1; i <= 4 && !stop_(); ++i) {
      if (const int order = high + i * std::max(1, high / 12); order <= last) offer(member, order);
    }
  }

  /// The best that holds in simulation.
  std::optional<DesignResult> verified() {
    std::sort(found_.begin(), found_.end(), [](const Found& a, const Found& b) { return a.cost < b.cost; });
    for (const Found& design : found_) {
      DesignResult result = assess(task_, design.filter, design.delays, false);
      result.solver.method = "shapes", result.solver.name = "standard shapes", result.solver.version = "accdec";
      result.solver.evaluations = tried_;
      if (result.status == Status::feasible) return result;
      if (stop_()) break;
    }
    return std::nullopt;
  }

 private:
  struct Found {
    Filter filter;
    std::vector<int> delays;
    double cost;
  };

  /// Whether the member of this order holds all limits; the shortest few are kept.
  bool offer(const MemberOf& member, int order) {
    ++tried_;
    Filter filter = make_filter(member(order));
    if (filter.order() > task_.design.order_max) return false;
    auto delays = delays_by_formula(filter, task_, unlimited, stop_);
    if (!delays) return false;
    const double cost = cost_(filter.order(), *delays);
    if (found_.size() < 4) {
      found_.push_back({std::move(filter), std::move(*delays), cost});
      return true;
    }
    const auto worst =
        std::max_element(found_.begin(), found_.end(), [](const Found& a, const Found& b) { return a.cost < b.cost; });
    if (cost < worst->cost) *worst = {std::move(filter), std::move(*delays), cost};
    return true;
  }

  const Task& task_;
  std::function<bool()> stop_;
  LinearCost cost_;
  std::vector<Found> found_;
  long tried_ = 0;
};

}  // namespace

std::optional<DesignResult> best_standard_shape(const Task& task, double seconds, const std::atomic<bool>* cancel) {
  using Clock = std::chrono::steady_clock;
  const auto began = Clock::now();
  const auto elapsed = [began] { return seconds_since(began); };
  StandardShapes search(task, [&] { return elapsed() > seconds || (cancel != nullptr && cancel->load()); });
  for (const MemberOf& member : members(!task.machine.modes.empty())) search.try_members(member);
  auto result = search.verified();
  if (result) result->solver.wall_time = elapsed();
  return result;
}

}  // namespace accdec
