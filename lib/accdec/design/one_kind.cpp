#include <algorithm>
#include <chrono>
#include <functional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <accdec/design/anytime.hpp>
#include <accdec/design/design_settings.hpp>
#include <accdec/design/one_kind.hpp>
#include <accdec/files.hpp>
#include <accdec/machine/response.hpp>
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
  /// @param of  a corner's number: its delay  @param least, most  of the order
  template <class DelayOf>
  DesignResult design_each(const DelayOf& of, double seconds, int least, int most) {
    give_delays(task_, of, given_);
    given_.design.order_min = least, given_.design.order_max = most;
    DesignOptions within = options_;
    within.time_limit = seconds;
    return design_task(given_, within);
  }
  DesignResult design(int delay, double seconds, int least, int most) {
    return design_each([=](std::size_t) { return delay; }, seconds, least, most);
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

/// A design that is proved by the bound of any delays, if at all.
void bound_by_any_delays(const Task& task, double seconds, DesignResult& found) {
  found.status = Status::feasible;
  found.lower_bound.reset(), found.gap.reset(), found.certificate.reset();
  Task any = task;
  any.settings.reset();
  DesignOptions rest;
  rest.time_limit = seconds;
  const DesignResult bound = design_task(any, rest);
  if (!bound.lower_bound || !bound.certificate) return;
  found.lower_bound = bound.lower_bound, found.certificate = bound.certificate;
  judge_gap(found);
}

/// Samples at rest that keep the jerks of two legs apart.
constexpr int jerk_span = 2;

/// Samples by which an exact stop is longer than the order: the control's smoothing ends later than the filter.
int smoothing_of(const Task& task) {
  return Response(task.machine, task.sample_period).prefilter_order();
}

/// A limit asks for a sample more at some corner, whatever the filter of this order. Looks for the cheapest choice of
/// corners that wait for it, and refutes all cheaper ones.
/// @param stop    samples of an exact stop  @param result  with all corners waiting
DesignResult with_fewest_waits(const Task& task, int stop, DesignResult result, GivenDelays& given) {
  constexpr std::size_t most_corners = 8;
  std::vector<std::size_t> open;
  for (std::size_t j = 0; j < task.corners.size(); ++j) {
    if (!task.corners[j].delay) open.push_back(j);
  }
  if (open.size() < 2) return result;
  struct Choice {
    double weight = 0.0;
    std::vector<int> more;
  };
  std::vector<Choice> choices;
  bool decided = open.size() <= most_corners;
  const unsigned all = decided ? (1u << open.size()) - 1 : 1;
  for (unsigned waiting = 1; waiting < all; ++waiting) {
    Choice choice{0.0, std::vector<int>(task.corners.size(), 0)};
    for (std::size_t i = 0; i < open.size(); ++i) {
      if ((waiting >> i) % 2 == 1) choice.weight += task.corners[open[i]].weight, choice.more[open[i]] = 1;
    }
    choices.push_back(std::move(choice));
  }
  std::ranges::stable_sort(choices, std::less<>(), &Choice::weight);
  for (const Choice& choice : choices) {
    DesignResult found = given.design_each([&](std::size_t j) { return stop + choice.more[j]; }, given.left(),
                                           task.design.order_min, task.design.order_max);
    if (found.has_design() && found.filter->order() == result.filter->order() && decided) return found;
    decided = decided && (found.status == Status::optimal || found.status == Status::infeasible);
    if (!decided) break;
  }
  if (!decided) {
    result.task = task;
    bound_by_any_delays(task, given.left(), result);
  }
  return result;
}

/// The filter whose exact stops end first. A limit may ask the stop for a sample more. It may also need a longer
/// filter. The jerk of an axis that goes on spans both legs. Behind a servo, the motion goes on after the command's
/// end.
/// @param order     no shorter filter holds starts and stops
/// @param shortest  whether that is proved
DesignResult shortest_stop(const Task& task, int order, bool shortest, GivenDelays& given) {
  const int smoothing = smoothing_of(task);
  // A filter that is one tap longer costs as much as the first sample more, or more.
  for (int more = 0; more <= exact_stop_more && shortest; ++more) {
    DesignResult result = given.design(order + smoothing + more, given.left());
    if (result.has_design() && result.filter->order() == order)
      return more == 0 || !task.settings ? result
                                         : with_fewest_waits(task, order + smoothing, std::move(result), given);
    shortest = result.status == Status::optimal || result.status == Status::infeasible;
  }
  const int most = task.design.order_max, last = most + smoothing + exact_stop_more;
  const auto stop_of = [&](int delay) {
    const int least = std::max({task.design.order_min, order, delay - smoothing - exact_stop_more});
    return given.design(delay, 0.5 * given.left(), least, std::min(delay - smoothing, most));
  };
  // Longer and longer stops, and then those before the first that holds.
  DesignResult found = stop_of(order + smoothing);
  const std::string why = found.message;
  int held = order + smoothing, broken = held;
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
  if (!found.has_design()) {
    found.lower_bound.reset(), found.gap.reset(), found.certificate.reset();
    return found;
  }
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
  const int apart = asked.design.order_max + Response(asked.machine, asked.sample_period).order() + jerk_span;
  for (;;) {
    DesignResult result = given.design(apart, 0.5 * options.time_limit);
    if (!result.has_design()) return result;
    result = shortest_stop(task, result.filter->order(), result.status == Status::optimal, given);
    if (!result.has_design()) return result;
    shorten_stops(asked, given.left(), result);
    if (!gives_a_delay(asked) || delays_of_kinds(*result.filter, asked, unlimited)) return result;
    const int longer = result.filter->order() + 1;
    if (longer > task.design.order_max) {
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
  const int smoothing = smoothing_of(task);
  for (const TaskCorner& corner : task.corners) {
    if (!corner.delay) continue;
    const int longest = *corner.delay - smoothing;
    range.order_min = std::max(range.order_min, longest - exact_stop_more);
    range.order_max = std::min(range.order_max, longest);
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
