#include <algorithm>
#include <chrono>

#include <fmt/format.h>

#include <accdec/design/coarse_design.hpp>
#include <accdec/design/larger_order.hpp>
#include <accdec/design/standard_shapes.hpp>
#include <accdec/exact/first_designs.hpp>
#include <accdec/exact/size.hpp>
#include <accdec/files.hpp>

namespace accdec {
namespace {

/// Linear programs of longer filters would take too long for this note.
constexpr int most_order = 3200;

}  // namespace

std::string larger_order_note(const Task& task, double seconds, const std::atomic<bool>* cancel) {
  using Clock = std::chrono::steady_clock;
  const auto began = Clock::now();
  const auto stop = [&] { return seconds_since(began) > seconds || (cancel != nullptr && cancel->load()); };
  Task longer = task;
  longer.design.order_min = std::max(task.design.order_min, task.design.order_max + 1);
  longer.design.order_max = std::min(most_order, 8 * task.design.order_max);
  if (longer.design.order_max < longer.design.order_min) return "; a larger order_max was not tried";
  std::string unknown = "; whether a larger order_max has one was not found out";
  if (stop()) return unknown;
  const auto does = [](int order, double cycle_time) {
    return fmt::format("; a longer filter does: with [design] order_max = {} there is a verified design of {:g} ms",
                       order, 1e3 * cycle_time);
  };
  DesignOptions options;
  options.cancel = cancel;
  if (const auto coarse = coarse_design(longer, options, 0.3 * seconds))
    return does(coarse->filter->order(), coarse->objective());
  try {
    exact::Workbench bench(longer, stop);
    const int least = exact::FirstDesigns(bench).smallest_order();
    const auto& best = bench.designs.best;
    if (stop() && !best) return unknown;
    if (least > longer.design.order_max)
      return fmt::format("; with order_max = {} there is none either, a larger one was not tried",
                         longer.design.order_max);
    double cycle_time = best ? best->value * task.sample_period : 0.0;
    int order = best ? best->filter.order() : 0;
    if (!best) {
      longer.design.order_min = least;
      const auto shape = best_standard_shape(longer, 0.5 * seconds, cancel);
      if (!shape) return unknown;
      cycle_time = shape->objective(), order = shape->filter->order();
    }
    return does(order, cycle_time);
  } catch (const exact::TooLarge&) {
    return unknown;
  }
}

}  // namespace accdec
