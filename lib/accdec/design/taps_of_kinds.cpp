#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/design/anytime.hpp>
#include <accdec/design/corner_feed_taps.hpp>
#include <accdec/design/design_settings.hpp>
#include <accdec/design/merged_result.hpp>
#include <accdec/design/one_kind.hpp>
#include <accdec/design/taps_of_kinds.hpp>
#include <accdec/exact/exact.hpp>
#include <accdec/exact/one_width.hpp>
#include <accdec/families/settable_search.hpp>
#include <accdec/files.hpp>
#include <accdec/task/delay_kinds.hpp>
#include <accdec/task/equal_corners.hpp>
#include <accdec/task/objective.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// The cheapest of the filters offered, each with the cheapest delays of the task's kinds.
class Cheapest {
 public:
  explicit Cheapest(const Task& task) : task_(task) {}

  void offer(const ChosenSettings& chosen) {
    const double below = best_.has_design() ? best_.objective() / task_.sample_period * (1.0 - 1e-12) : unlimited;
    DesignResult result = with_delays_of_kinds(task_, chosen, below);
    if (result.has_design()) best_ = std::move(result);
  }
  void offer_taps(const Filter& filter) { offer(as_settings(filter)); }
  void offer_taps(const DesignResult& result) {
    if (result.filter) offer_taps(*result.filter);
  }

  const DesignResult& best() const { return best_; }

 private:
  const Task& task_;
  DesignResult best_;
};

/// A member of the task's own families is a setting. Another member is free taps like any others.
void offer_members(const Task& task, double seconds, const DesignOptions& options, Cheapest& cheapest) {
  Task of_members = task;
  ControllerSettings& settings = *of_members.settings;
  std::erase(settings.families, SettingFamily::taps);
  const bool own = !settings.families.empty();
  if (!own) settings.families = {SettingFamily::averages}, settings.stages.assign(3, {});
  const SettableDesign member = best_settings(of_members, seconds, options.cancel);
  if (!member.chosen) return;
  if (own)
    cheapest.offer(*member.chosen);
  else
    cheapest.offer_taps(make_filter(member.chosen->filter));
}

/// Longest search for one more candidate, s. Most end at once.
constexpr double candidate_seconds = 10.0;

/// The orders of filters that cost less than the best so far; false if there are none.
/// @param delays  samples that the given delays cost  @param of_order  what each order costs beside the filter's own
bool keep_cheaper(const DesignResult& best, double delays, double of_order, Task& task) {
  if (!best.has_design()) return true;
  const LinearCost cost = cost_of(task);
  const double room = best.objective() / task.sample_period * (1.0 - 1e-9) - delays - cost.filter;
  const double most = std::floor(room / (cost.filter + of_order));
  task.design.order_max = static_cast<int>(std::clamp<double>(most, -1.0, task.design.order_max));
  return task.design.order_max >= std::max(1, task.design.order_min);
}

/// The filter that is best if the control only runs on, or only stops.
/// @return why there is none; empty if that is not known
std::string offer_one_kind(const Task& any, bool stops, const DesignOptions& options, Cheapest& cheapest) {
  Task task = any;
  if (stops && !keep_given_stops(task)) return no_given_stops;
  const LinearCost cost = cost_of(task);
  double stopping = 0.0;  // samples that each order costs at the corners
  for (std::size_t j = 0; stops && j < task.corners.size(); ++j)
    stopping += task.corners[j].delay ? 0.0 : cost.delay[j];
  if (!keep_cheaper(cheapest.best(), cost.given_delays(task), stopping, task)) return "";
  const DesignResult found = design_for_one_kind(task, stops, options);
  cheapest.offer_taps(found);
  return found.has_design() ? "" : fmt::format("with {} alone: {}", stops ? "exact stops" : "no delays", found.message);
}

/// Whether the exact method knows the delays: several corners of one in-position width. A single corner may have any.
bool is_one_width(const Task& task) {
  return exact::by_one_width(task) && task.corners.size() > 1 && !task.design.symmetric && exact_covers(task);
}

/// The best filter with one in-position width for all corners, with its bound.
DesignResult design_one_width(const Task& task, const DesignResult& best, const DesignOptions& options,
                              double seconds) {
  ExactOptions exact = exact_options(options, seconds);
  if (best.has_design()) exact.start = best.filter;
  const MergedTask merged = merge_equal_corners(task);
  if (!merged.smaller()) return design_exact(task, exact);
  const DesignResult found = design_exact(merged.task, exact);
  return of_whole_task(task, merged, found).value_or(DesignResult());
}

/// Filters made for the delays that the best has so far, and for shorter ones: of several corners with one width, few
/// filters have such delays.
void offer_for_delays(const Task& any, const DesignOptions& options, Cheapest& cheapest) {
  const DesignResult first = cheapest.best();
  if (!first.has_design() || any.corners.size() < 2) return;
  for (int shorter = 0; shorter < 3; ++shorter) {
    Task given = any;
    give_delays(
        any, [&](std::size_t j) { return std::max(0, first.corners[j].delay - shorter); }, given);
    if (keep_cheaper(cheapest.best(), cost_of(given).given_delays(given), 0.0, given))
      cheapest.offer_taps(design_task(given, options));
  }
}

/// Why a search that found no filter is no proof. @param taps  designed with any delays
const char* why_unproved(const DesignResult& taps, bool slows) {
  if (slows)
    return "proofs about corner feeds need few corners, limits in proportion to the feed, no given delays, and time";
  if (taps.has_design()) return "filters with other delays exist, and no proof is about these kinds together";
  return "the search with delays of any number of samples ended first";
}

}  // namespace

ChosenSettings as_settings(const Filter& filter) {
  const auto taps = filter.taps();
  return {.family = SettingFamily::taps,
          .filter = {.kind = Shape::taps, .order = filter.order(), .taps = {taps.begin(), taps.end()}}};
}

DesignResult with_delays_of_kinds(const Task& task, const ChosenSettings& chosen, double below,
                                  const std::function<bool()>& stop) {
  const Filter filter = make_filter(chosen.filter);
  const auto delays = delays_of_kinds(filter, task, below, stop);
  if (!delays) return {};
  DesignResult result = assess(task, filter, delays->delays, false, delays->parts);
  result.settings = chosen;
  result.settings->delays = delays->kinds;
  result.settings->width = delays->width;
  return result;
}

DesignResult design_taps_of_kinds(const Task& asked, const DesignOptions& options) {
  Task task = asked;
  const ControllerSettings& control = *asked.settings;
  const bool only_taps = !control.names_family();
  if (only_taps && task.filter)
    throw std::invalid_argument("a given filter has no taps to design for the control's kinds of delays");
  const bool runs_on = control.names(DelayKind::continuous), stops = control.names(DelayKind::exact_stop);
  const bool one_kind = control.delays.size() == 1 && (runs_on || stops);
  if (only_taps && one_kind) return design_for_one_kind(task, stops, options);
  const auto began = std::chrono::steady_clock::now();
  const auto left = [&] { return std::max(1e-3, options.time_limit - seconds_since(began)); };
  if (task.filter && !task.baseline) task.baseline = task.filter;
  task.filter.reset();

  Task any = task;
  any.settings.reset();
  DesignOptions within = options;
  const bool one_width = is_one_width(task);
  within.time_limit = (one_width ? 0.3 : 0.6) * options.time_limit;
  const DesignResult taps = one_kind ? design_for_one_kind(task, stops, within) : design_task(any, within);
  const bool slows = control.names(DelayKind::corner_feed);
  if (taps.status == Status::infeasible && !slows) {
    DesignResult none = taps;
    none.task.settings = task.settings;
    return none;
  }
  if (one_kind && taps.has_design()) task = taps.task;  // its proof is about these delays
  Cheapest cheapest(task);
  // Settings first: among equal times they are easier to enter than taps.
  offer_members(task, 0.5 * left(), options, cheapest);
  cheapest.offer_taps(taps);
  const bool met = cheapest.best().has_design() && taps.lower_bound &&
                   cheapest.best().objective() <= *taps.lower_bound * (1.0 + 1e-9);
  std::vector<std::string> reasons;
  if (!met && !one_kind && !control.any_delay()) {
    within.time_limit = std::min(0.2 * left(), candidate_seconds);
    if (runs_on) reasons.push_back(offer_one_kind(any, false, within, cheapest));
    if (stops) reasons.push_back(offer_one_kind(any, true, within, cheapest));
    if (control.names(DelayKind::in_position)) offer_for_delays(any, within, cheapest);
  }
  DesignResult proof = taps;
  if (!met && one_width && left() > 1e-3) {
    DesignResult found = design_one_width(task, cheapest.best(), options, left());
    cheapest.offer_taps(found);
    const bool tells = found.certificate && (found.status == Status::infeasible || found.lower_bound);
    if (tells && (!taps.lower_bound || found.lower_bound.value_or(unlimited) > *taps.lower_bound))
      proof = std::move(found);
  }
  std::optional<CornerFeedBound> slow;
  if (slows) {
    const auto samples = [&] {
      return cheapest.best().has_design() ? cheapest.best().objective() / task.sample_period : unlimited;
    };
    slow = prove_corner_feeds(task, options, left(), samples(), [&](const Filter& filter) {
      cheapest.offer_taps(filter);
      return samples();
    });
  }
  if (proof.status == Status::infeasible && !slows) {
    proof.task = task;
    return proof;
  }
  DesignResult result = cheapest.best();
  result.task = task;
  result.solver = proof.solver, result.stop = proof.stop;
  result.solver.wall_time = seconds_since(began);
  if (!result.has_design()) {
    const bool none = slow && slow->certificate && slow->samples == unlimited;
    result.status = none ? Status::infeasible : Status::failed;
    if (none) result.certificate = slow->certificate;
    if (slow) reasons.push_back(slow->none);
    if (!none) reasons.push_back(std::string("that there is none is not proved: ") + why_unproved(taps, slows));
    std::erase(reasons, "");
    reasons.insert(reasons.begin(), none ? "no filter holds all limits with delays of these kinds"
                                         : "no filter was found that holds all limits with delays of these kinds");
    result.message = fmt::format("{}", fmt::join(reasons, "; "));
    return result;
  }
  if (slow && slow->certificate)
    proof.lower_bound = slow->samples * task.sample_period, proof.certificate = slow->certificate;
  if ((slow || !slows) && proof.lower_bound && proof.certificate) {
    result.lower_bound = proof.lower_bound, result.certificate = proof.certificate;
    judge_gap(result);
    const bool member = result.settings->family != SettingFamily::taps;
    if (member && result.status == Status::optimal) result.family_bound = result.objective();
  }
  compare_with_today(result);
  return result;
}

}  // namespace accdec
