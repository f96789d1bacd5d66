#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include <accdec/certificate/checked_rows.hpp>
#include <accdec/certificate/family_check.hpp>
#include <accdec/design/anytime.hpp>
#include <accdec/design/design_settings.hpp>
#include <accdec/families/settable_search.hpp>
#include <accdec/files.hpp>
#include <accdec/task/objective.hpp>
#include <accdec/task/settings_text.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// Longest search for what free taps would do, s.
constexpr double free_taps_seconds = 10.0;

/// The worst limit that the longest averages break with the longest delays of the controller; empty if there is none,
/// or if the controller has no averages.
std::string longest_break(const Task& task) {
  const ControllerSettings& settings = *task.settings;
  const SettingFamily first = settings.families.front();
  if (first != SettingFamily::averages && first != SettingFamily::shaper) return "";
  const int stages = static_cast<int>(settings.stages.size());
  FilterSpec spec{.kind = Shape::averages};
  for (const SettableStage& stage : settings.stages) {
    const std::vector<int> lengths = settable_lengths(stage, task.sample_period, task.design.order_max / stages + 1);
    spec.lengths.push_back(lengths.empty() ? 1 : lengths.back());
    spec.order += spec.lengths.back() - 1;
  }
  const auto& kinds = settings.delays;
  const bool never_stops = !kinds.empty() && std::all_of(kinds.begin(), kinds.end(),
                                                         [](DelayKind kind) { return kind == DelayKind::continuous; });
  const std::vector<int> delays(task.corners.size(), never_stops ? 0 : spec.order + 2);
  const VerificationReport report = verify_by_simulation(task, make_filter(spec), delays);
  return report.feasible ? "" : report.worst;
}

/// The worst limit of the slowest member, and the nearest settings beyond steps and caps that hold all limits.
std::string no_member(const Task& task, double seconds, const std::atomic<bool>* cancel) {
  std::string text = fmt::format("no setting of {} holds all limits", families_in_words(*task.settings));
  Task lifted = task;
  lifted.settings->delays.clear();
  for (SettableStage& stage : lifted.settings->stages) {
    stage.length_step = stage.length_max = 0.0;
    stage.length_set.clear();
  }
  if (const std::string broken = longest_break(task); !broken.empty())
    text += fmt::format("; the longest averages break {}", broken);
  const SettableDesign near = best_settings(lifted, seconds, cancel);
  if (near.chosen)
    return fmt::format("{}; the nearest that do, with any step, length and delay: {}", text,
                       settings_in_words(*near.chosen));
  if (near.complete)
    text += fmt::format("; none does up to order {}, whatever step, length and delay", task.design.order_max);
  return text;
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
  const DesignResult taps = design_anytime(any, most);
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

/// Today's setting with the best delays that the controller can give it.
void compare_with_today(DesignResult& result) {
  if (!result.task.baseline) return;
  const Filter today = make_filter(*result.task.baseline);
  const auto delays = delays_of_kinds(today, result.task, unlimited);
  if (!delays || !verify_by_simulation(result.task, today, delays->delays, nullptr, nullptr, delays->parts).feasible) {
    result.message += result.message.empty() ? "" : "; ";
    result.message += "today's setting breaks a limit, whatever the delays";
    return;
  }
  const double time =
      objective_time(result.task, today.order(), delays->delays) + delays->lost * result.task.sample_period;
  Savings savings;
  savings.today = time;
  savings.total = time - result.objective();
  result.savings = savings;
}

}  // namespace

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
  const SettableDesign best = best_settings(task, options.time_limit, options.cancel);
  DesignResult result;
  if (best.chosen) {
    result = assess(task, make_filter(best.chosen->filter), best.delays.delays, false, best.delays.parts);
    if (result.has_design()) result.settings = best.chosen;
  } else {
    result.task = task;
    if (best.complete) result.status = Status::infeasible;
    if (!best.complete) result.message = "no setting was found in the time given";
  }
  if (result.has_design() || result.status == Status::infeasible) prove(best, late, result);
  if (result.status == Status::infeasible && !result.certificate) result.status = Status::failed;
  if (!best.chosen && best.complete) {
    const std::string reason = no_member(task, std::clamp(left(), 0.0, free_taps_seconds), options.cancel);
    result.message = result.message.empty() ? reason : fmt::format("{}; {}", reason, result.message);
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
