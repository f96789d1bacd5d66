#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <accdec/design/anytime.hpp>
#include <accdec/design/design_settings.hpp>
#include <accdec/design/one_kind.hpp>
#include <accdec/files.hpp>
#include <accdec/task/delay_kinds.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// A task without its control's kinds of delays, with the delays that one kind gives.
class GivenDelays {
 public:
  GivenDelays(const Task& task, const DesignOptions& options) : task_(task), given_(task), options_(options) {
    given_.settings.reset();
  }
  double left() const { return std::max(1e-3, options_.time_limit - seconds_since(began_)); }
  /// @param least, most  of the order
  DesignResult design(int delay, double seconds, int least, int most) {
    give_delays(
        task_, [&](std::size_t) { return delay; }, given_);
    given_.design.order_min = least, given_.design.order_max = most;
    DesignOptions within = options_;
    within.time_limit = seconds;
    return design_task(given_, within);
  }
  DesignResult design(int delay, double seconds) {
    return design(delay, seconds, task_.design.order_min, task_.design.order_max);
  }

 private:
  const Task& task_;
  Task given_;
  const DesignOptions& options_;
  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
};

/// Zeros at the ends of a filter make it shorter than its exact stops. The same taps as many samples later hold the
/// same limits, and a mean of both has no such zeros. Errors behind a servo leave room for a small part of the later
/// ones.
/// @return false: zeros are left
bool fill_ends(DesignResult& result) {
  const Filter& filter = *result.filter;
  const int first = filter.first_nonzero_tap(), length = filter.last_nonzero_tap() - first + 1;
  const int zeros = filter.order() + 1 - length;
  if (zeros == 0) return true;
  std::vector<int> delays;
  for (const CornerResult& corner : result.corners) delays.push_back(corner.delay);
  for (double part = 0.5; part > 1e-7; part *= 0.1) {
    std::vector<double> taps(static_cast<std::size_t>(filter.order()) + 1, 0.0);
    for (int i = 0; i < length; ++i) {
      taps[static_cast<std::size_t>(i)] += (1.0 - part) * filter.tap(first + i);
      taps[static_cast<std::size_t>(i + zeros)] += part * filter.tap(first + i);
    }
    DesignResult full = assess(result.task, Filter(std::move(taps)), delays, false);
    if (!full.has_design()) continue;
    full.status = result.status, full.stop = result.stop, full.message = result.message;
    full.lower_bound = result.lower_bound, full.gap = result.gap;
    full.solver = result.solver, full.certificate = result.certificate;
    result = std::move(full);
    return true;
  }
  return false;
}

/// A design that is proved by the bound of any delays, if at all.
void bound_by_any_delays(const Task& task, double seconds, DesignResult& found) {
  found.status = Status::feasible;
  Task any = task;
  any.settings.reset();
  DesignOptions rest;
  rest.time_limit = seconds;
  const DesignResult bound = design_task(any, rest);
  if (!bound.lower_bound || !bound.certificate) return;
  found.lower_bound = bound.lower_bound, found.certificate = bound.certificate;
  judge_gap(found);
}

/// The filter whose exact stops end first. A limit may ask the stop for a sample more. It may also need a longer
/// filter. The jerk of an axis that goes on spans both legs. Behind a control's smoothing or a servo, the motion goes
/// on after the filter's end.
/// @param order     no shorter filter holds starts and stops
/// @param shortest  whether that is proved
DesignResult shortest_stop(const Task& task, int order, bool shortest, GivenDelays& given) {
  // A filter that is one tap longer costs as much as the first sample more, or more.
  for (int delay = order; delay <= order + 1 && shortest; ++delay) {
    DesignResult result = given.design(delay, given.left());
    if (result.has_design() && result.filter->order() == order) return result;
    shortest = result.status == Status::optimal || result.status == Status::infeasible;
  }
  const int most = task.design.order_max, last = most + exact_stop_more;
  const auto stop_of = [&](int delay) {
    const int least = std::max({task.design.order_min, order, delay - exact_stop_more});
    return given.design(delay, 0.5 * given.left(), least, std::min(delay, most));
  };
  // Longer and longer stops, and then those before the first that holds.
  DesignResult found = stop_of(order);
  const std::string why = found.message;
  int held = order, broken = order;
  while (!found.has_design() && held < last && given.left() > 1e-3) {
    broken = held, held = std::min(last, std::max(held + 1, held * 5 / 4));
    found = stop_of(held);
  }
  for (int delay = broken + 1; delay < held && given.left() > 1e-3; ++delay) {
    if (!found.has_design()) break;
    if (DesignResult shorter = stop_of(delay); shorter.has_design()) held = delay, found = std::move(shorter);
  }
  if (!found.has_design()) {
    found.status = Status::failed;
    found.message = "no filter was found that holds all limits with exact stops; with the shortest, " + why;
  }
  found.task = task;
  found.lower_bound.reset(), found.gap.reset(), found.certificate.reset();
  if (!found.has_design()) return found;
  bound_by_any_delays(task, given.left(), found);
  return found;
}

/// Corners at which no limit asks for the sample more stop without it. @param task  whose delays are open
void shorten_stops(const Task& task, double seconds, DesignResult& result) {
  if (!task.settings) return;
  const auto own = delays_of_kinds(*result.filter, task, unlimited);
  if (!own) return;
  bool shorter = false;
  for (std::size_t j = 0; j < own->delays.size(); ++j) shorter = shorter || own->delays[j] < result.corners[j].delay;
  DesignResult found = shorter ? assess(task, *result.filter, own->delays, false) : DesignResult();
  if (!found.has_design()) return;
  found.solver = result.solver, found.stop = result.stop;
  bound_by_any_delays(task, seconds, found);
  result = std::move(found);
}

bool gives_a_delay(const Task& task) {
  return std::ranges::any_of(task.corners, [](const TaskCorner& corner) { return corner.delay.has_value(); });
}

/// The same from any filter, whose given stops are a sample longer than the filter only where a limit asks for that.
/// @param task  as asked; keeps the orders of such filters
DesignResult stop_of_control(const Task& asked, GivenDelays& given, const DesignOptions& options, Task& task) {
  for (;;) {
    DesignResult result = given.design(task.design.order_max, 0.5 * options.time_limit);
    if (!result.has_design()) return result;
    result = shortest_stop(task, result.filter->order(), result.status == Status::optimal, given);
    if (!result.has_design()) return result;
    const bool filled = fill_ends(result);
    if (filled) shorten_stops(asked, given.left(), result);
    if ((filled && !gives_a_delay(asked)) || delays_of_kinds(*result.filter, asked, unlimited)) return result;
    const int longer = result.filter->order() + 1;
    if (!gives_a_delay(asked) || longer > task.design.order_max) {
      result = DesignResult();
      result.task = task;
      result.message = "no filter was found whose exact stops hold all limits";
      return result;
    }
    task.design.order_min = longer;
  }
}

}  // namespace

bool keep_given_stops(Task& task) {
  DesignBounds& range = task.design;
  for (const TaskCorner& corner : task.corners) {
    if (!corner.delay) continue;
    range.order_min = std::max(range.order_min, *corner.delay - exact_stop_more);
    range.order_max = std::min(range.order_max, *corner.delay);
  }
  return range.order_min <= range.order_max;
}

DesignResult design_for_one_kind(const Task& asked, bool stops, const DesignOptions& options) {
  Task task = asked;
  if (stops && !keep_given_stops(task)) throw std::invalid_argument(fmt::format("delay_samples: {}", no_given_stops));
  GivenDelays given(task, options);
  DesignResult result = stops ? stop_of_control(asked, given, options, task) : given.design(0, options.time_limit);
  if (!stops && asked.settings && result.status == Status::infeasible)
    result.message += "; the control has no delays at corners";
  if (stops && gives_a_delay(task) && result.status == Status::infeasible)
    result.message += fmt::format("; exact stops of the given delays need filters of order {} to {}",
                                  task.design.order_min, task.design.order_max);
  result.task.design = task.design;
  result.task.settings = task.settings;
  return result;
}

}  // namespace accdec
