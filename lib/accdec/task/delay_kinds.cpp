#include <algorithm>
#include <cmath>

#include <accdec/corner.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/task/blend_check.hpp>
#include <accdec/task/delay_kinds.hpp>
#include <accdec/task/delays_by_formula.hpp>
#include <accdec/task/least_delays.hpp>
#include <accdec/task/objective.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// Widths closer than this part are one width: no controller tells them apart.
constexpr double same_width = 1e-9;

/// The state of a delay of which only the error was looked at.
constexpr signed char only_error = 2;

bool names(const std::vector<DelayKind>& kinds, DelayKind kind) {
  return std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
}

/// See the public one. @param mask  one per corner: whether it is in-position
std::optional<WidthInterval> width_of(const InPosition& in_position, const Task& task, const std::vector<int>& delays,
                                      const std::vector<bool>& mask) {
  WidthInterval width{0.0, unlimited};
  for (std::size_t j = 0; j < delays.size(); ++j) {
    if (!mask[j]) continue;
    const int waited = delays[j] - in_position.latency();
    if (waited < 0) return std::nullopt;
    width.low = std::max(width.low, in_position.way_left(task.corners[j], waited));
    if (waited > 0) width.high = std::min(width.high, in_position.way_left(task.corners[j], waited - 1));
  }
  if (width.low >= width.high * (1.0 - same_width)) return std::nullopt;
  return width;
}

/// Looks for the cheapest delays of a filter of which everything but the blends holds.
class KindChoice {
 public:
  /// @param behind  the filter behind the machine's response  @param least  of the same filter; it is kept
  KindChoice(const Filter& filter, const FilterBehind& behind, const LeastDelays& least, const Task& task,
             const BlendLimits& limits, double samples, const std::function<bool()>& stop)
      : filter_(filter),
        least_(least),
        in_position_(least.in_position()),
        corner_feeds_(least.corner_feeds()),
        task_(task),
        kinds_(task.settings->delays),
        cost_(cost_of(task)),
        stop_(stop),
        last_(last_delay(task, behind.longest_order())),
        best_(samples) {
    for (const TaskCorner& corner : task.corners) checks_.emplace_back(behind, corner, task, limits);
    known_.assign(checks_.size(), std::vector<signed char>(static_cast<std::size_t>(last_) + 1, -1));
  }

  std::optional<KindDelays> run() {
    for (std::size_t j = 0; j < checks_.size(); ++j) others_.push_back(with_corner_feed(j, other_kinds(j)));
    offer(std::vector<int>(checks_.size(), -1));
    if (names(kinds_, DelayKind::in_position)) every_width();
    if (!found_ || late_) return std::nullopt;
    std::vector<bool> mask;
    for (const DelayKind kind : found_->kinds) mask.push_back(kind == DelayKind::in_position);
    if (std::find(mask.begin(), mask.end(), true) != mask.end())
      found_->width = width_of(in_position_, task_, found_->delays, mask);
    return found_;
  }

 private:
  struct Choice {
    int delay = -1;  ///< -1: there is none
    DelayKind kind = DelayKind::continuous;
    double part = 1.0;  ///< of the feed
    double lost = 0.0;  ///< samples, by that part
    double samples() const { return delay < 0 ? unlimited : delay + lost; }
  };

  /// The least cost of all corners with their other kinds, or these delays by the width.
  /// @param growing  the delays may grow
  double least_cost(const std::vector<int>& by_width, bool growing) const {
    double sum = cost_.filter * (filter_.order() + 1);
    for (std::size_t j = 0; j < others_.size(); ++j) {
      double samples = others_[j].samples();
      if (!task_.corners[j].delay && (growing || by_width[j] >= least_.of(j)))
        samples = std::min<double>(samples, std::max(by_width[j], least_.of(j)));
      sum += cost_.delay[j] * samples;
    }
    return sum;
  }

  bool holds(std::size_t j, int delay) {
    const auto at = static_cast<std::size_t>(delay);
    if (at >= known_[j].size()) return checks_[j].holds(delay);
    signed char& known = known_[j][at];
    if (known < 0 || known == only_error) known = checks_[j].holds(delay) ? 1 : 0;
    late_ = late_ || (stop_ && stop_());
    return known == 1;
  }
  bool error_holds(std::size_t j, int delay) {
    const auto at = static_cast<std::size_t>(delay);
    if (at >= known_[j].size()) return checks_[j].error_holds(delay);
    signed char& known = known_[j][at];
    if (known < 0) known = checks_[j].error_holds(delay) ? only_error : 0;
    return known != 0;
  }

  /// The shortest delay of a corner without a width.
  Choice other_kinds(std::size_t j) {
    const std::optional<int> given = task_.corners[j].delay;
    if (names(kinds_, DelayKind::continuous) && given.value_or(0) == 0 && holds(j, 0))
      return {0, DelayKind::continuous};
    const auto held = [&](int d) { return !late_ && holds(j, d); };
    const auto late = [&](int /*delay*/) { return late_; };
    for (const DelayKind free : {DelayKind::dwell, DelayKind::timed_axis}) {
      if (!names(kinds_, free)) continue;
      const auto ends = [&](int d) { return late_ || !checks_[j].longer_may_hold(d); };
      const auto d = first_delay(least_.of(j), given.value_or(last_), held, ends);
      if (!d) continue;
      const int longer = *d - least_.apart();
      const bool stops = longer >= 0 && longer <= exact_stop_more && names(kinds_, DelayKind::exact_stop);
      return {*d, stops ? DelayKind::exact_stop : free};
    }
    if (names(kinds_, DelayKind::exact_stop)) {
      // An exact stop waits for the command, whatever the servo still has to go.
      const int apart = least_.apart(), most = apart + exact_stop_more;
      const auto d = first_delay(apart, most, held, late);
      if (d && given.value_or(*d) == *d) return {*d, DelayKind::exact_stop};
    }
    return {};
  }

  /// This choice, or a part of the feed if that loses less.
  Choice with_corner_feed(std::size_t j, const Choice& choice) {
    if (late_ || !names(kinds_, DelayKind::corner_feed) || task_.corners[j].delay.value_or(0) != 0) return choice;
    const double room = std::min(choice.samples(), best_ / cost_.delay[j]);
    const auto part = corner_feeds_.largest(task_.corners[j], room, stop_);
    return part ? Choice{0, DelayKind::corner_feed, *part, corner_feeds_.lost(*part)} : choice;
  }

  /// Takes for every corner the shorter of both kinds, if all have one and they cost least. The limits are looked at
  /// only where errors alone leave that open.
  void offer(const std::vector<int>& by_width) {
    if (least_cost(by_width, false) >= best_) return;
    if (const auto open = chosen(by_width, &KindChoice::error_holds); !open) return;
    if (auto choice = chosen(by_width, &KindChoice::holds)) found_ = std::move(choice), best_ = cost_of_choice(*found_);
  }

  double cost_of_choice(const KindDelays& choice) const { return cost_(filter_.order(), choice.delays) + choice.lost; }

  /// Empty unless it costs less than the best. @param held  whether a delay of a corner does
  std::optional<KindDelays> chosen(const std::vector<int>& by_width, bool (KindChoice::*held)(std::size_t, int)) {
    std::vector<int> delays;
    std::vector<DelayKind> kinds;
    std::vector<double> parts;
    double lost = 0.0;
    for (std::size_t j = 0; j < others_.size(); ++j) {
      const bool shorter = by_width[j] >= 0 && !task_.corners[j].delay && by_width[j] < others_[j].samples();
      if (shorter && (this->*held)(j, by_width[j])) {
        delays.push_back(by_width[j]), kinds.push_back(DelayKind::in_position), parts.push_back(1.0);
      } else if (others_[j].delay >= 0) {
        delays.push_back(others_[j].delay), kinds.push_back(others_[j].kind), parts.push_back(others_[j].part);
        lost += cost_.delay[j] * others_[j].lost;
      } else {
        return std::nullopt;
      }
    }
    KindDelays choice{std::move(delays), std::move(kinds), std::nullopt, {}, lost};
    if (lost > 0.0) choice.parts = std::move(parts);
    if (!(cost_of_choice(choice) < best_ * (1.0 - 1e-12))) return std::nullopt;
    return choice;
  }

  /// From the widest on, one step of one or more delays after another.
  void every_width() {
    std::vector<int> delays(checks_.size(), in_position_.latency());
    if (least_cost(delays, true) >= best_) return;
    struct Step {
      double width;
      std::size_t corner;
    };
    std::vector<Step> steps;
    const int longest = in_position_.longest();
    for (std::size_t j = 0; j < checks_.size(); ++j) {
      for (int d = 0; d < longest; ++d) steps.push_back({in_position_.way_left(task_.corners[j], d), j});
    }
    std::sort(steps.begin(), steps.end(), [](const Step& a, const Step& b) { return a.width > b.width; });
    offer(delays);
    for (std::size_t i = 0; i < steps.size() && !late_;) {
      const double width = steps[i].width;
      for (; i < steps.size() && steps[i].width >= width * (1.0 - same_width); ++i) ++delays[steps[i].corner];
      late_ = late_ || (stop_ && stop_());
      if (least_cost(delays, true) >= best_) return;
      offer(delays);
    }
  }

  const Filter& filter_;
  const LeastDelays& least_;
  const InPosition& in_position_;
  const CornerFeeds& corner_feeds_;
  const Task& task_;
  const std::vector<DelayKind>& kinds_;
  LinearCost cost_;
  const std::function<bool()>& stop_;
  int last_;  ///< longer delays change nothing
  double best_;
  bool late_ = false;
  std::vector<BlendCheck> checks_;
  std::vector<std::vector<signed char>> known_;  ///< of each corner and delay: -1 until it is checked, only_error, 0, 1
  std::vector<Choice> others_;
  std::optional<KindDelays> found_;
};

}  // namespace

std::optional<WidthInterval> width_of(const Filter& filter, const Task& task, const std::vector<int>& delays,
                                      const std::vector<bool>& in_position) {
  const FilterBehind behind(filter, task.machine, task.sample_period);
  return width_of(InPosition(behind, task), task, delays, in_position);
}

std::optional<KindDelays> delays_of_kinds(const Filter& filter, const Task& task, double samples,
                                          const std::function<bool()>& stop) {
  if (!task.settings || task.settings->delays.empty()) {
    const auto delays = delays_by_formula(filter, task, samples, stop);
    if (!delays) return std::nullopt;
    return KindDelays{*delays, {}, std::nullopt};
  }
  const BlendLimits limits(filter, task.machine, task.sample_period);
  const FilterBehind behind(filter, task.machine, task.sample_period);
  const LeastDelays least(filter, behind, task, limits);
  if (least.cost() >= samples || !holds_without_blends(limits, filter, task, stop)) return std::nullopt;
  return KindChoice(filter, behind, least, task, limits, samples, stop).run();
}

}  // namespace accdec
