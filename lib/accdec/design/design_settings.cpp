#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/certificate/checked_rows.hpp>
#include <accdec/certificate/family_check.hpp>
#include <accdec/design/anytime.hpp>
#include <accdec/design/design_settings.hpp>
#include <accdec/design/differing_servos.hpp>
#include <accdec/families/poles.hpp>
#include <accdec/families/settable_search.hpp>
#include <accdec/files.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/task/settings_notes.hpp>
#include <accdec/task/settings_text.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// Longest search for what free taps would do, or for the limit that leaves no setting, s.
constexpr double free_taps_seconds = 10.0;
/// Part of the time that is kept for that limit.
constexpr double part_for_reasons = 0.2;

/// The task with all limits wider by this factor. A bound of zero grows, too.
Task widened(Task task, double factor) {
  const double residual = 1e-3 * (factor - 1.0), distance = 1e-6 * (factor - 1.0);
  for (Axis& axis : task.machine.axes) {
    for (const AxisLimit& limit : axis_limits) axis.*limit.bound *= factor;
  }
  task.machine.power_total_max *= factor, task.machine.regeneration_total_max *= factor;
  for (Mode& mode : task.machine.modes) {
    mode.residual_max = mode.residual_max * factor + residual;
    mode.displacement_max = mode.displacement_max * factor + distance;
  }
  for (TaskCorner& corner : task.corners) {
    for (auto* tolerance : {&corner.error_max, &corner.contour_max}) {
      if (*tolerance) *tolerance = **tolerance * factor + distance;
    }
    corner.speed_min /= factor;
  }
  return task;
}

/// The member that needs the least widening of all limits, to 1 % or as far as the time allows, and the limit that it
/// breaks most. Empty if none is found.
std::string closest_break(const Task& task, double seconds, const std::atomic<bool>* cancel) {
  const auto began = std::chrono::steady_clock::now();
  const auto left = [&] { return seconds - seconds_since(began); };
  SettableDesign closest;
  double broken = 1.0, held = unlimited;
  bool searched = true;  // all members, with every factor
  while (held > 1.01 * broken && broken < 1e6 && left() > 0.0) {
    // Up by larger and larger steps, then down by bisection. The larger the factor, the sooner a member is found.
    const double factor = held < unlimited ? std::sqrt(broken * held) : 2.0 * broken * broken;
    SettableDesign found = best_settings(widened(task, factor), left() / 3.0, cancel);
    searched = searched && found.complete;
    if (!found.chosen && !found.complete && held < unlimited) break;
    (found.chosen ? held : broken) = factor;
    if (found.chosen) closest = std::move(found);
    if (cancel != nullptr && cancel->load()) break;
  }
  if (!closest.chosen) return "";
  const Filter filter = make_filter(closest.chosen->filter);
  // Wider tolerances have shorter delays, where the control may wait longer. A limit that is broken with the legs apart
  // is broken with any delay.
  VerificationReport report;
  report.feasible = true;
  if (task.settings->any_delay() || task.settings->names(DelayKind::in_position)) {
    const int longest = filter.order() + Response(task.machine, task.sample_period).order() + 2;
    std::vector<int> apart;
    for (const TaskCorner& corner : task.corners) apart.push_back(corner.delay.value_or(longest));
    report = verify_by_simulation(task, filter, apart);
  }
  if (report.feasible)
    report = verify_by_simulation(task, filter, closest.delays.delays, nullptr, nullptr, closest.delays.parts);
  if (report.feasible) return "";
  const bool closest_of_all = searched && held <= 1.01 * broken;
  return fmt::format("the closest{}, {}, breaks {}", closest_of_all ? "" : " found in the time given",
                     settings_in_words(*closest.chosen), report.worst);
}

/// The poles that the highest order leaves out; empty if it leaves out none that can be set.
std::string poles_left_out(const Task& task) {
  const ControllerSettings& settings = *task.settings;
  const int order_max = task.design.order_max;
  if (!settings.names(SettingFamily::one_pole)) return "";
  int fits = 0;  // samples
  while (order_of_poles({fits + 1.0}, order_max) <= order_max) ++fits;
  const double longest = fits * task.sample_period;
  const auto longer = [&](const SettableStage& stage) {
    const double cap = stage.length_max > 0.0 ? stage.length_max : unlimited;
    return (stage.length_set.empty() ? cap : std::ranges::max(stage.length_set)) > longest * (1.0 + 1e-9);
  };
  if (std::ranges::none_of(settings.stages, longer)) return "";
  return fmt::format(
      "`order_max` = {} has room for a pole of {:.6g} ms at most: longer ones leave more than {:g} % of "
      "their step",
      order_max, 1e3 * longest, 1e2 * pole_rest);
}

/// ", and a delay of 14 ms", or of the shortest to the longest; empty if there is none.
std::string and_delays(const std::vector<int>& delays, double period) {
  const auto [low, high] = std::minmax_element(delays.begin(), delays.end());
  const int least = *low, most = *high;
  if (most == 0) return "";
  if (least == most) return fmt::format(", and a delay of {:.6g} ms", 1e3 * most * period);
  return fmt::format(", and delays of {:.6g} to {:.6g} ms", 1e3 * least * period, 1e3 * most * period);
}

bool corner_feed_alone(const Task& task) {
  const std::vector<DelayKind>& kinds = task.settings->delays;
  return kinds.size() == 1 && kinds.front() == DelayKind::corner_feed;
}

/// Such a control has no delay that could be a cure: other lengths may be one, or smaller steps of the feed.
/// @param lifted  with any step and length  @param seconds  for each of both
void add_corner_feeds(Task lifted, double seconds, const std::atomic<bool>* cancel, std::vector<std::string>& reasons) {
  constexpr double finer = 0.1;  // of the step
  double& step = lifted.settings->corner_feed_step;
  SettableDesign near = best_settings(lifted, seconds, cancel);
  if (near.chosen) {
    reasons.push_back(
        fmt::format("the nearest that do, with any step and length: {}", settings_in_words(*near.chosen)));
    return;
  }
  if (near.complete)
    reasons.push_back(fmt::format("no corner feed of the step {:g} holds it, whatever the lengths", step));
  step *= finer;
  near = best_settings(lifted, seconds, cancel);
  if (near.chosen)
    reasons.push_back(fmt::format("a finer `corner_feed_step`, {:g}, has some that do, with any step and length: {}",
                                  step, settings_in_words(*near.chosen)));
}

/// With any step and length, and any delay.
void add_lengths_and_delays(Task lifted, double seconds, const std::atomic<bool>* cancel,
                            std::vector<std::string>& reasons) {
  lifted.settings->delays.clear();
  const SettableDesign near = best_settings(lifted, seconds, cancel);
  if (near.chosen)
    reasons.push_back(fmt::format("the nearest that do, with any step, length and delay: {}{}",
                                  settings_in_words(*near.chosen),
                                  and_delays(near.delays.delays, lifted.sample_period)));
  else if (near.complete)
    reasons.push_back(
        fmt::format("none does up to order {}, whatever step, length and delay", lifted.design.order_max));
}

/// Adds the proof that no member of the families is shorter.
void prove(const SettableDesign& best, const std::function<bool()>& late, DesignResult& result) {
  if (!best.complete) {
    result.message = "not every member of the family was looked at in the time given";
    return;
  }
  proof::FamilyEnumeration proof;
  if (best.chosen) proof.bound_samples = best.cost;
  try {
    proof.refuted = refute_members(result.task, best.cost, late);
  } catch (const Rejected& reason) {
    result.message = fmt::format("not proved best: {}", reason.what());
    return;
  }
  result.certificate = std::make_shared<Certificate>(Certificate{std::move(proof)});
  if (!best.chosen) return;
  result.status = Status::optimal;
  result.family_bound = result.objective();
}

/// Adds what free taps and delays would do: the best design and the bound known.
void compare_with_taps(const DesignOptions& options, double seconds, DesignResult& result) {
  Task any = result.task;
  any.settings.reset();
  DesignOptions most = options;
  most.time_limit = seconds;
  const bool common = Response(any.machine, any.sample_period).common();
  const DesignResult taps = common ? design_anytime(any, most) : design_differing(any, most);
  if (taps.has_design()) result.free_taps = std::min(taps.objective(), result.objective());
  if (!taps.lower_bound || !taps.certificate || !result.certificate) return;
  const auto* tree = std::get_if<proof::BranchAndBound>(&taps.certificate->proof);
  if (tree == nullptr) return;
  Certificate both = *result.certificate;
  std::get<proof::FamilyEnumeration>(both.proof).taps = *tree;
  result.certificate = std::make_shared<Certificate>(std::move(both));
  result.lower_bound = std::min(*taps.lower_bound, result.objective());
  result.gap = (result.objective() - *result.lower_bound) / result.objective();
}

}  // namespace

bool control_restricts(const Task& task) {
  return task.settings && (task.settings->names_family() || !task.settings->any_delay());
}

DesignResult design_given(Task task, const DesignOptions& options) {
  if (!control_restricts(task)) {
    task.settings.reset();
    return design_task(task, options);
  }
  const auto began = std::chrono::steady_clock::now();
  const auto late = [&] {
    return seconds_since(began) > options.time_limit || (options.cancel != nullptr && options.cancel->load());
  };
  const Filter filter = make_filter(*task.filter);
  if (const auto delays = delays_of_kinds(filter, task, unlimited, late)) {
    DesignResult result = assess(task, filter, delays->delays, false, delays->parts);
    if (result.has_design()) return result;
  }
  DesignResult none;
  none.task = std::move(task);
  const bool any = !late();
  none.status = any ? Status::infeasible : Status::failed;
  none.message = any ? "today's setting breaks a limit, whatever the delays" : "no delays were found in the time given";
  return none;
}

void compare_with_today(DesignResult& result) {
  if (!result.task.baseline) return;
  Task given = result.task;
  given.filter = given.baseline;
  const DesignResult today = design_given(given);
  if (!today.has_design()) {
    result.message += result.message.empty() ? "" : "; ";
    result.message += today.message;
    return;
  }
  Savings savings;
  savings.today = today.objective();
  savings.total = savings.today - result.objective();
  result.savings = savings;
}

std::string why_no_setting_holds(const Task& task, double seconds, const std::atomic<bool>* cancel) {
  std::vector<std::string> reasons;
  if (std::string broken = closest_break(task, 0.5 * seconds, cancel); !broken.empty())
    reasons.push_back(std::move(broken));
  if (std::string stops = exact_stop_rule(&*task.settings); !stops.empty()) reasons.push_back(std::move(stops));
  if (std::string poles = poles_left_out(task); !poles.empty()) reasons.push_back(std::move(poles));
  Task lifted = task;
  for (SettableStage& stage : lifted.settings->stages) {
    stage.length_step = stage.length_max = 0.0;
    stage.length_set.clear();
  }
  if (corner_feed_alone(task))
    add_corner_feeds(std::move(lifted), 0.25 * seconds, cancel, reasons);
  else
    add_lengths_and_delays(std::move(lifted), 0.5 * seconds, cancel, reasons);
  return fmt::format("{}", fmt::join(reasons, "; "));
}

DesignResult design_settings(const Task& asked, const DesignOptions& options) {
  if (options.method == Method::nlp)
    throw std::invalid_argument("the task names a family: its members are enumerated, and no solver is used");
  const auto began = std::chrono::steady_clock::now();
  const auto left = [&] { return options.time_limit - seconds_since(began); };
  const auto late = [&] { return left() <= 0.0 || (options.cancel != nullptr && options.cancel->load()); };
  Task task = asked;
  if (task.filter && !task.baseline) task.baseline = task.filter;
  task.filter.reset();
  if (options.progress) options.progress(fmt::format("looking at {}", families_in_words(*task.settings)));
  const SettableDesign best = best_settings(
      task, options.time_limit - std::min(part_for_reasons * options.time_limit, free_taps_seconds), options.cancel);
  DesignResult result;
  if (best.chosen) {
    result = assess(task, make_filter(best.chosen->filter), best.delays.delays, false, best.delays.parts);
    if (result.has_design()) result.settings = best.chosen;
  } else {
    result.task = task;
    if (best.complete) result.status = Status::infeasible;
  }
  if (result.has_design() || result.status == Status::infeasible) prove(best, late, result);
  if (result.status == Status::infeasible && !result.certificate) result.status = Status::failed;
  if (!best.chosen) {
    const std::string families = families_in_words(*task.settings);
    std::vector<std::string> reasons{
        best.complete ? fmt::format("no setting of {} holds all limits", families)
                      : fmt::format("no setting of {} that holds all limits was found in the time given", families),
        why_no_setting_holds(task, std::clamp(left(), 0.0, free_taps_seconds), options.cancel), result.message};
    std::erase(reasons, "");
    result.message = fmt::format("{}", fmt::join(reasons, "; "));
  }
  if (result.has_design() && !late()) compare_with_taps(options, std::clamp(left(), 1e-3, free_taps_seconds), result);
  if (result.has_design()) compare_with_today(result);
  result.solver.method = "enumeration";
  result.solver.name = "families";
  result.solver.evaluations = best.tried;
  result.solver.wall_time = seconds_since(began);
  result.stop = best.complete ? StopReason::finished : StopReason::time_limit;
  if (!best.complete && options.cancel != nullptr && options.cancel->load()) result.stop = StopReason::interrupted;
  if (!options.exact.certificate) result.certificate.reset();
  return result;
}

}  // namespace accdec
