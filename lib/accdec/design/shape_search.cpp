#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <vector>

#include <accdec/design/shape_search.hpp>
#include <accdec/files/seconds_since.hpp>
#include <accdec/motion/shapes.hpp>
#include <accdec/task/delays_by_formula.hpp>
#include <accdec/task/objective.hpp>
#include <accdec/task/order_bound.hpp>
#include <accdec/task/verifier.hpp>

namespace accdec {
namespace {

using ShapeOf = std::function<Filter(int order)>;

/// Kaiser's window: of a band that must be quiet, the larger beta the less is left (1e-7 from about 15 on).
Filter kaiser(int order, double beta) {
  std::vector<double> taps;
  for (int i = 0; i <= order; ++i) {
    const double x = order > 0 ? 2.0 * i / order - 1.0 : 0.0;
    taps.push_back(std::cyl_bessel_i(0.0, beta * std::sqrt(std::max(0.0, 1.0 - x * x))));
  }
  return Filter(std::move(taps));
}

std::vector<ShapeOf> shapes(bool quiet) {
  std::vector<ShapeOf> list;
  // Where next to nothing may be left only they do, so they come first: time may be short.
  for (const double beta : {18.0, 14.0, 10.0, 6.0}) {
    if (quiet) list.push_back([beta](int n) { return kaiser(n, beta); });
  }
  list.insert(list.end(), {[](int n) { return n < 4 ? boxcar(n) : trapezoid(n, n / 4); },
                           [](int n) { return n < 3 ? boxcar(n) : trapezoid(n, n / 3); },
                           [](int n) { return n < 2 ? boxcar(n) : trapezoid(n, n / 2); }, boxcar,
                           [](int n) { return n < 10 ? boxcar(n) : trapezoid(n, n / 10); },
                           [](int n) { return hann(std::max(n, 2)); }, [](int n) { return blackman(std::max(n, 2)); }});
  return list;
}

class ShapeSearch {
 public:
  ShapeSearch(const Task& task, std::function<bool()> stop)
      : task_(task), stop_(std::move(stop)), cost_(cost_of(task)) {}

  void try_shape(const ShapeOf& shape) {
    const int last = task_.design.order_max;
    const int first = std::max({1, task_.design.order_min, order_lower_bound(task_, last)});
    // Limits are held from some order on, near enough: doubled steps find one, halved ones the least.
    int low = first - 1, high = first;
    for (int step = std::max(1, first / 8); !stop_() && !offer(shape, high); step *= 2) {
      if (high == last) return;
      low = high;
      high = std::min(last, high + step);
    }
    while (high - low > 1 && !stop_()) {
      const int middle = low + (high - low) / 2;
      (offer(shape, middle) ? high : low) = middle;
    }
    // A longer filter may need shorter delays.
    for (int i = 1; i <= 4 && !stop_(); ++i) {
      if (const int order = high + i * std::max(1, high / 12); order <= last) offer(shape, order);
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

  /// Whether a shape of this order holds all limits; the shortest few are kept.
  bool offer(const ShapeOf& shape, int order) {
    ++tried_;
    Filter filter = shape(order);
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

std::optional<DesignResult> best_shape(const Task& task, double seconds, const std::atomic<bool>* cancel) {
  using Clock = std::chrono::steady_clock;
  const auto began = Clock::now();
  const auto elapsed = [began] { return seconds_since(began); };
  ShapeSearch search(task, [&] { return elapsed() > seconds || (cancel != nullptr && cancel->load()); });
  for (const ShapeOf& shape : shapes(!task.machine.modes.empty())) search.try_shape(shape);
  auto result = search.verified();
  if (result) result->solver.wall_time = elapsed();
  return result;
}

}  // namespace accdec
