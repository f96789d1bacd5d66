#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include <fmt/format.h>

#include <accdec/certificate/checked_rows.hpp>
#include <accdec/certificate/corner_feed_check.hpp>
#include <accdec/certificate/family_check.hpp>
#include <accdec/certificate/family_members.hpp>
#include <accdec/certificate/late_outlines.hpp>
#include <accdec/certificate/member_ways.hpp>
#include <accdec/certificate/refuted_outlines.hpp>
#include <accdec/task/objective.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

constexpr const char* late = "it could not be checked in the time allowed";
constexpr double none = std::numeric_limits<double>::infinity();

/// The least that a member costs by the errors of its corners.
class CostOfErrors {
 public:
  CostOfErrors(const Task& task, const Task& granted, const MemberLimits& limits, const Ways& ways)
      : task_(task), granted_(granted), limits_(limits), ways_(ways), cost_(cost_of(task)) {
    if (task.settings)
      latency_ = static_cast<int>(std::lround(task.settings->in_position_latency / task.sample_period));
  }

  int latency() const { return latency_; }  ///< samples, of an in-position check
  /// Raises delays to those that the errors need, until they cost as much as the room. @return whether they do
  bool raise(std::vector<int>& delays, double room, bool between) const {
    std::vector<double> slower;  // samples of each corner at a part of the feed
    for (std::size_t j = 0; j < delays.size(); ++j)
      slower.push_back(ways_.slows(j) ? ways_.samples_of(ways_.largest_part()) : none);
    bool dear = least(delays, slower) >= room;
    for (std::size_t j = 0; !dear && j < delays.size(); ++j) {
      if (task_.corners[j].delay.value_or(0) > 0) continue;
      const TaskCorner& corner = granted_.corners[j];
      if (!task_.corners[j].delay) delays[j] = std::max(delays[j], limits_.least_delay(corner, between));
      if (ways_.slows(j)) slower[j] = least_at_part(corner, between);
      dear = least(delays, slower) >= room;
    }
    return dear;
  }

 private:
  double least(const std::vector<int>& delays, const std::vector<double>& slower) const {
    double sum = 0.0;
    for (std::size_t j = 0; j < delays.size(); ++j)
      sum += cost_.delay[j] * std::min(slower[j], least_by_delay(j, delays[j]));
    return sum;
  }

  /// Samples that a corner costs at least at its feed. @param delay  shorter ones break its error
  double least_by_delay(std::size_t j, int delay) const {
    const bool any = ways_.any_delay() || task_.corners[j].delay;
    double least = any ? delay : none;
    if (!any && ways_.kind(DelayKind::continuous) && delay == 0) least = 0.0;
    if (!any && ways_.kind(DelayKind::exact_stop)) least = std::min<double>(least, ways_.apart());
    if (!any && ways_.kind(DelayKind::in_position)) least = std::min<double>(least, std::max(delay, latency_));
    return least;
  }

  /// Samples of the largest part of the feed at which the error may hold: it is in proportion to that.
  double least_at_part(const TaskCorner& corner, bool between) const {
    if (!corner.error_max) return ways_.samples_of(ways_.largest_part());
    int far = ways_.largest_part() + 1, near = Ways::at_part;
    while (far - near > 1) {
      const int way = near + (far - near) / 2;
      (limits_.too_far(corner, 0, between, ways_.part_of(way)) ? far : near) = way;
    }
    return near > Ways::at_part ? ways_.samples_of(near) : none;
  }

  const Task& task_;
  const Task& granted_;
  const MemberLimits& limits_;
  const Ways& ways_;
  LinearCost cost_;
  int latency_ = 0;
};

/// Refutes one member.
class Refutation {
 public:
  /// @param limits  of the member
  /// @param least   of each corner: a delay below which every member's error is too large
  Refutation(const Task& task, const Task& granted, const FamilyMember& member, const MemberLimits& limits,
             std::vector<int> least, double room, const std::function<bool()>& stop)
      : task_(task),
        granted_(granted),
        member_(member),
        limits_(limits),
        ways_(task, granted, member, limits),
        room_(room),
        stop_(stop),
        cost_(cost_of(task)),
        errors_(task, granted, limits, ways_),
        least_(std::move(least)) {}

  /// The rule that refutes it, or empty. @param late_by_errors  whether its errors are known to make it late
  std::string rule(bool late_by_errors) {
    if (const auto limit = limits_.broken_by_legs()) return std::string(to_string(*limit));
    if (late_by_errors) return "delays";
    between_ = least_;
    late_by_errors_ = errors_.raise(least_, room_, false);
    if (late_by_errors_) return "delays";
    if (limits_.rings()) return "vibration";
    bool simulated = false;
    for (;;) {
      if (stop_ && stop_()) throw Rejected(late);
      const std::optional<std::vector<int>> ways = cheap_ways();
      if (!ways) return simulated ? "simulation" : "delays";
      if (!close_one(*ways)) return "";
      simulated = true;
    }
  }
  /// Whether that found its errors alone to make it late.
  bool late_by_errors() const { return late_by_errors_; }
  /// The same if the motion's positions between samples count, too.
  bool late_between_samples() { return errors_.raise(between_, room_, true); }

 private:
  /// The cheapest way without a width; -1: none.
  int plain_way(std::size_t j) {
    const int delay = plain_delay(j, least_[j], room_);
    if (!ways_.slows(j)) return delay;
    for (int way = ways_.largest_part(); way > Ways::at_part; --way) {
      if (ways_.samples_of(way) * cost_.delay[j] >= room_ || (delay >= 0 && ways_.samples_of(way) >= delay)) break;
      if (ways_.holds(j, way)) return way;
    }
    return delay;
  }

  /// The shortest delay without a width; -1: none.
  int plain_delay(std::size_t j, int least, double room) {
    const std::optional<int> given = task_.corners[j].delay;
    if (ways_.any_delay() && given) return ways_.holds(j, *given) ? *given : -1;
    const double most = room / cost_.delay[j];
    if (ways_.any_delay()) return ways_.first_held(j, least, ways_.longest(), most);
    if (ways_.kind(DelayKind::continuous) && given.value_or(0) == 0 && ways_.holds(j, 0)) return 0;
    if (!ways_.kind(DelayKind::exact_stop)) return -1;
    constexpr int more = 1;  // sample that a limit may ask for at an exact stop
    const int apart = ways_.apart(), first = given ? apart : std::max(apart, least);
    const int stop = ways_.first_held(j, first, apart + more, most);
    return given.value_or(stop) == stop ? stop : -1;
  }

  /// Ways that hold all limits within the room, of any kind that the controller has.
  std::optional<std::vector<int>> cheap_ways() {
    const std::size_t corners = task_.corners.size();
    std::vector<int> plain;
    for (std::size_t j = 0; j < corners; ++j) plain.push_back(plain_way(j));
    if (auto found = within(plain)) return found;
    if (ways_.any_delay() || !ways_.kind(DelayKind::in_position)) return std::nullopt;
    const std::vector<double>& left = limits_.way_watched();
    if (auto found = by_width(none, plain)) return found;
    for (std::size_t j = 0; j < corners; ++j) {
      // Larger widths give no corner a delay that is long enough, and smaller ones cost too much.
      const auto too_wide = [&](double to_go) { return !any_in_position(below * to_go * way_of(j)); };
      const auto cheap = [&](double to_go) { return least_by_width(above * to_go * way_of(j), plain) < room_; };
      const auto first = std::partition_point(left.begin(), left.end(), too_wide);
      const auto last = std::partition_point(first, left.end(), cheap);
      for (auto to_go = first; to_go != last; ++to_go) {
        if (stop_ && stop_()) throw Rejected(late);
        // On both sides: equal widths of two corners are rounded differently.
        for (const double factor : {below, above}) {
          if (auto found = by_width(factor * *to_go * way_of(j), plain)) return found;
        }
      }
    }
    return std::nullopt;
  }

  /// The way of a full-speed sample of leg 1: along it, or of its fastest axis where the control watches each axis.
  double way_of(std::size_t j) const {
    const Corner& g = task_.corners[j].geometry();
    double part = 0.0;
    for (Eigen::Index a = 0; a < g.axes(); ++a) part = std::max(part, std::abs(g.direction_in[a]));
    return (task_.settings->in_position_by_axis ? part : 1.0) * g.feed_in * task_.sample_period;
  }
  /// The delay that this width gives a corner.
  int delay_of(std::size_t j, double width) const {
    const std::vector<double>& left = limits_.way_watched();
    const double way = way_of(j);
    const auto waits = [&](double to_go) { return way * to_go > width; };
    return errors_.latency() + static_cast<int>(std::partition_point(left.begin(), left.end(), waits) - left.begin());
  }
  bool open(std::size_t j) const { return !task_.corners[j].delay; }
  /// Whether this width gives any corner a delay whose error may hold.
  bool any_in_position(double width) const {
    for (std::size_t j = 0; j < least_.size(); ++j) {
      if (open(j) && delay_of(j, width) >= least_[j]) return true;
    }
    return false;
  }
  /// The least cost of the delays that this width or a smaller one gives.
  double least_by_width(double width, const std::vector<int>& plain) const {
    double sum = 0.0;
    for (std::size_t j = 0; j < plain.size(); ++j) {
      double samples = plain[j] < 0 ? none : ways_.samples_of(plain[j]);
      if (open(j)) samples = std::min<double>(samples, std::max(least_[j], delay_of(j, width)));
      sum += cost_.delay[j] * samples;
    }
    return sum;
  }
  /// The shorter ones of the ways and the delays of this width, if they hold all limits within the room.
  std::optional<std::vector<int>> by_width(double width, const std::vector<int>& plain) {
    std::vector<int> ways = plain, delays;
    double sum = 0.0;
    for (std::size_t j = 0; j < ways.size(); ++j) {
      const double samples = ways[j] < 0 ? none : ways_.samples_of(ways[j]);
      const int d = open(j) ? delay_of(j, width) : -1;
      delays.push_back(d >= least_[j] && d < samples ? d : -1);
      sum += cost_.delay[j] * (delays[j] >= 0 ? delays[j] : samples);
    }
    // Limits take all samples: only where the cost leaves it open.
    if (sum >= room_) return std::nullopt;
    for (std::size_t j = 0; j < ways.size(); ++j) {
      if (delays[j] >= 0 && ways_.holds(j, delays[j])) ways[j] = delays[j];
    }
    return within(ways);
  }

  std::optional<std::vector<int>> within(const std::vector<int>& ways) const {
    double sum = 0.0;
    for (std::size_t j = 0; j < ways.size(); ++j) {
      if (ways[j] < 0) return std::nullopt;
      sum += cost_.delay[j] * ways_.samples_of(ways[j]);
    }
    return sum < room_ ? std::optional(ways) : std::nullopt;
  }

  /// Whether the verification refuses these ways, or the filter; then it knows so of one more way.
  bool close_one(const std::vector<int>& ways) {
    const Filter filter(member_.taps);
    Task alone = task_;
    alone.corners.clear();
    if (!verify_by_simulation(alone, filter, {}).feasible) {
      room_ = -none;
      return true;
    }
    for (std::size_t j = 0; j < ways.size(); ++j) {
      const int delay = ways[j] > Ways::at_part ? 0 : ways[j];
      const Task one = corner_alone(task_, task_.corners[j]);
      if (verify_by_simulation(one, filter, {delay}, nullptr, nullptr, {ways_.part_of(ways[j])}).feasible) continue;
      ways_.shut(j, ways[j]);
      return true;
    }
    return false;
  }

  static constexpr double below = 1.0 - 1e-9, above = 1.0 + 1e-9;

  const Task& task_;
  const Task& granted_;
  const FamilyMember& member_;
  const MemberLimits& limits_;
  Ways ways_;
  double room_;
  const std::function<bool()>& stop_;
  LinearCost cost_;
  CostOfErrors errors_;
  std::vector<int> least_;    ///< of each corner: every shorter delay breaks its error bound
  std::vector<int> between_;  ///< the same between samples, as far as it is known
  bool late_by_errors_ = false;
};

/// Members of each family and rule. Rules are looked at in one order, so that each member has one.
std::map<std::pair<std::string, std::string>, int> counts(const std::vector<proof::RefutedMembers>& refuted) {
  std::map<std::pair<std::string, std::string>, int> members;
  for (const proof::RefutedMembers& r : refuted) members[{r.family, r.rule}] += r.members;
  return members;
}

}  // namespace

std::vector<proof::RefutedMembers> refute_members(const Task& task, double target, const std::function<bool()>& stop) {
  if (std::ranges::any_of(task.machine.modes, [](const Mode& mode) { return mode.of_axis(); }))
    throw Rejected("the vibration of an axis (residual_max_um) may hold at longer delays than were looked at");
  const Task granted = granted_limits(task);
  const CheckedResponse response(task);
  const LinearCost cost = cost_of(task);
  std::vector<int> least;
  for (const TaskCorner& corner : granted.corners)
    least.push_back(corner.delay ? *corner.delay : least_delay_behind(response, corner, task.sample_period));
  // A member that costs as much as the target up to rounding is not shorter.
  const double limit = std::isinf(target) ? none : target * (1.0 - 1e-9);
  const double given = cost.given_delays(task);
  const double end = std::isinf(limit) ? 1e9 : std::ceil((limit - given) / cost.filter) - 1.0;
  const int order_end = static_cast<int>(std::clamp(end, 0.0, 1e9));
  const RefutedOutlines outlines(granted, response, std::min(order_end, task.design.order_max + 1));
  std::vector<proof::RefutedMembers> all;
  long looked_at = 0;
  for (const SettingFamily family : task.settings->families) {
    const std::string name(to_string(family));
    const auto count = [&](const std::string& rule) {
      const auto same = [&](const proof::RefutedMembers& r) { return r.family == name && r.rule == rule; };
      const auto found = std::find_if(all.begin(), all.end(), same);
      if (found == all.end())
        all.push_back({name, rule, 1});
      else
        ++found->members;
    };
    LateOutlines lates;
    bool outlined = false, covered = false;
    const auto refuted = [&](const AveragesOutline& outline) {
      if (++looked_at % 4096 == 0 && stop && stop()) throw Rejected(late);
      const char* rule = outlines.rule(outline);
      if (rule == nullptr) {
        outlined = true, covered = lates.covers(outline);
        if (covered && outlines.legs_hold(outline)) rule = "delays";
      }
      if (rule != nullptr) count(rule);
      return rule != nullptr;
    };
    const auto refute = [&](const FamilyMember& m, const std::string& words) {
      if (stop && stop()) throw Rejected(late);
      const double room = std::isinf(limit) ? none : limit - cost.filter * (m.order() + 1);
      const MemberLimits limits(granted, m, response);
      Refutation refutation(task, granted, m, limits, least, room, stop);
      const std::string rule = refutation.rule(covered);
      if (rule.empty()) throw Rejected(fmt::format("{} are not refuted", words));
      count(rule);
      if (outlined && refutation.late_by_errors())
        lates.remember(lates.asks_between() && refutation.late_between_samples());
    };
    visit_family(task, family, order_end, refute, refuted);
  }
  return all;
}

std::string check_families(const proof::FamilyEnumeration& proof, const Task& task, const DesignResult& result,
                           const std::function<bool()>& stop) {
  if (!task.settings || !task.settings->names_family())
    throw Rejected("the certificate is about families, the task names none");
  if (task.settings->names(SettingFamily::taps))
    throw Rejected("free taps are a family of the task, and the certificate is about settings alone");
  double target = none;
  if (result.status == Status::infeasible) {
    if (proof.bound_samples) throw Rejected("the certificate proves a bound, not that no member holds");
  } else {
    if (!proof.bound_samples) throw Rejected("the certificate proves that no member holds, the result is one");
    if (!result.family_bound) throw Rejected("the result claims no bound of its family");
    const bool optimal = result.status == Status::optimal;
    if (optimal && *result.family_bound < result.objective() * (1.0 - 1e-9))
      throw Rejected("the status is optimal, but the family's bound is below the cycle time");
    target = (optimal ? result.objective() : *result.family_bound) / task.sample_period;
    if (*proof.bound_samples < target * (1.0 - 1e-9))
      throw Rejected(
          fmt::format("the certificate proves {} samples, the result claims {}", *proof.bound_samples, target));
    // Members are refuted up to the result's own claim.
    if (*proof.bound_samples > target * (1.0 + 1e-9))
      throw Rejected(fmt::format("the certificate claims {} samples, the result {}", *proof.bound_samples, target));
  }
  const auto refuted = refute_members(task, target, stop);
  int members = 0;
  for (const proof::RefutedMembers& r : refuted) members += r.members;
  if (counts(refuted) != counts(proof.refuted)) throw Rejected("the certificate counts other refuted members");
  const std::string about = task.settings->names(DelayKind::corner_feed) ? fmt::format("; {}", about_corner_feeds) : "";
  if (std::isinf(target)) return fmt::format("{} members refuted: none holds all limits{}", members, about);
  return fmt::format(
      "{} members refuted: none of the family is shorter than {:.9g} s, within the tolerance of the verification{}",
      members, target * task.sample_period, about);
}

}  // namespace accdec
