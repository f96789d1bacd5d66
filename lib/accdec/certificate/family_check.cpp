#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include <accdec/certificate/checked_rows.hpp>
#include <accdec/certificate/family_check.hpp>
#include <accdec/certificate/family_members.hpp>
#include <accdec/certificate/member_limits.hpp>
#include <accdec/task/objective.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

constexpr const char* late = "it could not be checked in the time allowed";
constexpr double none = std::numeric_limits<double>::infinity();

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
        room_(room),
        stop_(stop),
        cost_(cost_of(task)),
        longest_(limits.longest_delay()),
        least_(std::move(least)),
        known_(task.corners.size(), std::vector<signed char>(static_cast<std::size_t>(longest_) + 1, unseen)) {}

  /// The rule that refutes it, or empty.
  std::string rule() {
    if (const auto limit = limits_.broken_by_legs()) return std::string(to_string(*limit));
    if (limits_.rings()) return "vibration";
    if (cost_of_least() >= room_) return "delays";
    for (std::size_t j = 0; j < task_.corners.size(); ++j) {
      if (!task_.corners[j].delay) least_[j] = std::max(least_[j], limits_.least_delay(granted_.corners[j]));
      if (cost_of_least() >= room_) return "delays";
    }
    bool simulated = false;
    for (;;) {
      if (stop_ && stop_()) throw Rejected(late);
      const std::optional<std::vector<int>> delays = cheap_delays();
      if (!delays) return simulated ? "simulation" : "delays";
      if (!close_one(*delays)) return "";
      simulated = true;
    }
  }

 private:
  static constexpr signed char unseen = 0, shut = 1, open = 2;

  double cost_of_least() const {
    double sum = 0.0;
    for (std::size_t j = 0; j < least_.size(); ++j) sum += cost_.delay[j] * least_[j];
    return sum;
  }

  bool holds(std::size_t j, int delay) {
    signed char& known = known_[j][static_cast<std::size_t>(std::min(delay, longest_))];
    if (known == unseen) known = limits_.broken_by_blend(granted_.corners[j], std::min(delay, longest_)) ? shut : open;
    return known == open;
  }

  bool kind(DelayKind wanted) const {
    const auto& kinds = task_.settings->delays;
    return std::find(kinds.begin(), kinds.end(), wanted) != kinds.end();
  }
  bool any_delay() const {
    return task_.settings->delays.empty() || kind(DelayKind::dwell) || kind(DelayKind::timed_axis);
  }

  /// The shortest delay without a width; -1: none.
  int plain_delay(std::size_t j, int least, double room) {
    const std::optional<int> given = task_.corners[j].delay;
    if (given) return holds(j, *given) ? *given : -1;
    const int first = std::max(any_delay() ? 0 : apart(), least);
    if (!any_delay() && kind(DelayKind::continuous) && holds(j, 0)) return 0;
    if (!any_delay() && !kind(DelayKind::exact_stop)) return -1;
    constexpr int more = 2;  // samples that a limit may ask for at an exact stop
    const int last = any_delay() ? longest_ : apart() + more;
    for (int d = first; d <= last; ++d) {
      if (cost_.delay[j] * d >= room) return -1;
      if (holds(j, d)) return d;
    }
    return -1;
  }

  /// The least delay at which the legs do not overlap.
  int apart() const {
    int first = 0, last = member_.order();
    while (member_.taps[static_cast<std::size_t>(first)] == 0.0) ++first;
    while (member_.taps[static_cast<std::size_t>(last)] == 0.0) --last;
    return last - first;
  }

  /// Delays that hold all limits within the room, of any kind that the controller has.
  std::optional<std::vector<int>> cheap_delays() {
    const std::size_t corners = task_.corners.size();
    std::vector<int> plain;
    for (std::size_t j = 0; j < corners; ++j) plain.push_back(plain_delay(j, least_[j], room_));
    if (auto found = within(plain)) return found;
    if (any_delay() || !kind(DelayKind::in_position)) return std::nullopt;
    const std::vector<double>& left = limits_.way_watched();
    const int latency = static_cast<int>(std::lround(task_.settings->in_position_latency / task_.sample_period));
    std::vector<double> widths{none};
    for (std::size_t j = 0; j < corners; ++j) {
      for (const double way : left) {
        // On both sides: equal widths of two corners are rounded differently.
        for (const double factor : {1.0 - 1e-9, 1.0 + 1e-9})
          widths.push_back(factor * way * task_.corners[j].geometry().feed_in * task_.sample_period);
      }
    }
    for (const double width : widths) {
      if (stop_ && stop_()) throw Rejected(late);
      std::vector<int> delays = plain;
      for (std::size_t j = 0; j < corners; ++j) {
        const double way = task_.corners[j].geometry().feed_in * task_.sample_period;
        const auto after = [&](double to_go) { return way * to_go > width; };
        const int d = latency + static_cast<int>(std::partition_point(left.begin(), left.end(), after) - left.begin());
        const bool shorter = delays[j] < 0 || d < delays[j];
        if (!task_.corners[j].delay && shorter && holds(j, d)) delays[j] = d;
      }
      if (auto found = within(delays)) return found;
    }
    return std::nullopt;
  }

  std::optional<std::vector<int>> within(const std::vector<int>& delays) const {
    double sum = 0.0;
    for (std::size_t j = 0; j < delays.size(); ++j) {
      if (delays[j] < 0) return std::nullopt;
      sum += cost_.delay[j] * delays[j];
    }
    return sum < room_ ? std::optional(delays) : std::nullopt;
  }

  /// Whether the verification refuses these delays, or the filter; then it knows so of one more delay.
  bool close_one(const std::vector<int>& delays) {
    const Filter filter(member_.taps);
    Task alone = task_;
    alone.corners.clear();
    if (!verify_by_simulation(alone, filter, {}).feasible) {
      room_ = -none;
      return true;
    }
    for (std::size_t j = 0; j < delays.size(); ++j) {
      if (verify_by_simulation(corner_alone(task_, task_.corners[j]), filter, {delays[j]}).feasible) continue;
      known_[j][static_cast<std::size_t>(std::min(delays[j], longest_))] = shut;
      return true;
    }
    return false;
  }

  const Task& task_;
  const Task& granted_;
  const FamilyMember& member_;
  const MemberLimits& limits_;
  double room_;
  const std::function<bool()>& stop_;
  LinearCost cost_;
  int longest_;
  std::vector<int> least_;                       ///< of each corner: every shorter delay breaks its error bound
  std::vector<std::vector<signed char>> known_;  ///< of each corner and delay
};

}  // namespace

std::vector<proof::RefutedMembers> refute_members(const Task& task, double target, const std::function<bool()>& stop) {
  const Task granted = granted_limits(task);
  const CheckedResponse response(task);
  const LinearCost cost = cost_of(task);
  std::vector<int> least;
  for (const TaskCorner& corner : granted.corners)
    least.push_back(corner.delay ? *corner.delay : least_delay_behind(response, corner, task.sample_period));
  // What costs as much as the target up to rounding is not shorter.
  const double limit = std::isinf(target) ? none : target * (1.0 - 1e-9);
  const double given = cost.given_delays(task);
  const double end = std::isinf(limit) ? 1e9 : std::ceil((limit - given) / cost.filter) - 1.0;
  std::vector<proof::RefutedMembers> all;
  for (const SettingFamily family : task.settings->families) {
    const std::string name(to_string(family));
    visit_family(task, family, static_cast<int>(std::clamp(end, 0.0, 1e9)),
                 [&](const FamilyMember& m, const std::string& words) {
                   if (stop && stop()) throw Rejected(late);
                   const double room = std::isinf(limit) ? none : limit - cost.filter * (m.order() + 1);
                   const MemberLimits limits(granted, m, response);
                   const std::string rule = Refutation(task, granted, m, limits, least, room, stop).rule();
                   if (rule.empty()) throw Rejected(fmt::format("{} are not refuted", words));
                   const auto same = [&](const proof::RefutedMembers& r) { return r.family == name && r.rule == rule; };
                   const auto found = std::find_if(all.begin(), all.end(), same);
                   if (found == all.end())
                     all.push_back({name, rule, 1});
                   else
                     ++found->members;
                 });
  }
  return all;
}

std::string check_families(const proof::FamilyEnumeration& proof, const Task& task, const DesignResult& result,
                           const std::function<bool()>& stop) {
  if (!task.settings || !task.settings->names_family())
    throw Rejected("the certificate is about families, the task names none");
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
  if (refuted != proof.refuted) throw Rejected("the certificate counts other refuted members");
  if (std::isinf(target)) return fmt::format("{} members refuted: none holds all limits", members);
  return fmt::format("{} members refuted: within what verification grants none of the family is shorter than {:.9g} s",
                     members, target * task.sample_period);
}

}  // namespace accdec
