#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include <accdec/certificate/checked_rows.hpp>
#include <accdec/certificate/family_check.hpp>
#include <accdec/certificate/family_members.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/task/objective.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

constexpr const char* late = "it could not be checked in the time allowed";
constexpr double none = std::numeric_limits<double>::infinity();

/// The value that a limit bounds: the checker's own list.
double sampled(LimitKind kind, double v, double a, double before, const Axis& axis, double period) {
  const double force = axis.mass * a + axis.damping * v;
  switch (kind) {
    case LimitKind::velocity: return std::abs(v);
    case LimitKind::acceleration: return std::abs(a);
    case LimitKind::jerk: return std::abs(a - before) / period;
    case LimitKind::force: return std::abs(force);
    case LimitKind::power: return force * v;
    case LimitKind::regeneration: return -force * v;
    case LimitKind::vibration:
    case LimitKind::corner_error:
    case LimitKind::speed_min:
    case LimitKind::power_total:
    case LimitKind::regeneration_total: break;  // not of an axis
  }
  return 0.0;
}

std::optional<LimitKind> broken(const Axis& axis, double v, double a, double before, double period) {
  for (const AxisLimit& limit : axis_limits) {
    if (axis.*limit.bound < unlimited && sampled(limit.kind, v, a, before, axis, period) > axis.*limit.bound)
      return limit.kind;
  }
  return std::nullopt;
}

/// What bounds a member's acceleration and jerk at any speed.
struct Steepness {
  double tap = 0.0, step = 0.0;  ///< the largest tap, and the largest difference of neighbours

  /// Whether a leg at this speed keeps the limits by more than rounding.
  bool surely_holds(const Axis& axis, double speed, double period) const {
    constexpr double below = 1.0 - 1e-9;
    return std::min({axis.force_max, axis.power_max, axis.regeneration_max}) >= unlimited &&
           speed <= below * axis.velocity_max && speed * tap <= below * axis.acceleration_max * period &&
           speed * step <= below * axis.jerk_max * period * period;
  }
};

Steepness steepness_of(const FamilyMember& member) {
  Steepness steep;
  double before = 0.0;
  for (const double tap : member.taps) {
    steep.tap = std::max(steep.tap, tap);
    steep.step = std::max(steep.step, std::abs(tap - before));
    before = tap;
  }
  steep.step = std::max(steep.step, before);
  return steep;
}

/// Refutes one member.
class Refutation {
 public:
  Refutation(const Task& task, const Task& granted, const FamilyMember& member, double room,
             const std::function<bool()>& stop)
      : task_(task),
        granted_(granted),
        member_(member),
        room_(room),
        stop_(stop),
        cost_(cost_of(task)),
        // Longer delays change nothing.
        longest_(member.order() + 2),
        known_(task.corners.size(), std::vector<signed char>(static_cast<std::size_t>(longest_) + 1, unseen)) {}

  /// The rule that refutes it, or empty.
  std::string rule() {
    if (const auto limit = broken_by_legs()) return std::string(to_string(*limit));
    if (rings()) return "vibration";
    double least_cost = 0.0;
    for (std::size_t j = 0; j < task_.corners.size(); ++j) {
      least_.push_back(least_delay(j));
      least_cost += cost_.delay[j] * least_.back();
      if (least_cost >= room_) return "delays";
    }
    bool simulated = false;
    for (;;) {
      const std::optional<std::vector<int>> delays = cheap_delays();
      if (!delays) return simulated ? "simulation" : "delays";
      if (!close_one(*delays)) return "";
      simulated = true;
    }
  }

 private:
  static constexpr signed char unseen = 0, shut = 1, open = 2;

  static double at(const std::vector<double>& values, int k) {
    return values[static_cast<std::size_t>(std::clamp(k, 0, static_cast<int>(values.size()) - 1))];
  }
  double tap(int i) const { return i < 0 || i > member_.order() ? 0.0 : member_.taps[static_cast<std::size_t>(i)]; }

  std::optional<LimitKind> broken_by_legs() const {
    const Steepness steep = steepness_of(member_);
    const double period = task_.sample_period;
    for (const TaskCorner& corner : granted_.corners) {
      const Corner& g = corner.geometry();
      for (std::size_t x = 0; x < granted_.machine.axes.size(); ++x) {
        const Axis& axis = granted_.machine.axes[x];
        const auto e = static_cast<Eigen::Index>(x);
        const double in = g.feed_in * g.direction_in[e], out = g.feed_out * g.direction_out[e];
        if (steep.surely_holds(axis, std::max(std::abs(in), std::abs(out)), period)) continue;
        for (int k = 0; k <= member_.order() + 2; ++k) {
          const double now = tap(k - 1) / period, before = tap(k - 2) / period;
          if (const auto limit = broken(axis, in * at(member_.gone, k), in * now, in * before, period)) return limit;
          if (const auto limit = broken(axis, out * at(member_.left, k), -out * now, -out * before, period))
            return limit;
        }
      }
    }
    return std::nullopt;
  }

  /// At frequencies closer together than the response can hide a peak between, and a few damping ratios.
  bool rings() const {
    constexpr int ratios = 4;
    for (const Mode& mode : granted_.machine.modes) {
      const double band = mode.frequency_high - mode.frequency_low, spread = mode.damping_high - mode.damping_low;
      const int steps = 2 + static_cast<int>(std::min(1e5, 8.0 * band * task_.sample_period * (member_.order() + 1)));
      for (int i = 0; i <= steps * (ratios + 1); ++i) {
        const int line = i / (steps + 1);
        if (line > (spread > 0.0 ? ratios : 0)) break;
        const double f = mode.frequency_low + band * (i % (steps + 1)) / steps;
        if (left(f, mode.damping_low + spread * line / ratios) > mode.residual_max) return true;
      }
    }
    return false;
  }

  /// Amplitude of a vibration at the last tap.
  double left(double frequency, double damping) const {
    const double w = 2.0 * std::numbers::pi * frequency * task_.sample_period;
    const std::complex<double> turn =
        std::polar(std::exp(-damping * w), -w * std::sqrt((1.0 - damping) * (1.0 + damping)));
    std::complex<double> sum = 0.0;
    for (const double tap : member_.taps) sum = sum * turn + tap;
    return std::abs(sum);
  }

  bool holds(std::size_t j, int delay) {
    signed char& known = known_[j][static_cast<std::size_t>(std::min(delay, longest_))];
    if (known == unseen) known = blend_breaks(granted_.corners[j], std::min(delay, longest_)) ? shut : open;
    return known == open;
  }

  bool blend_breaks(const TaskCorner& corner, int delay) const {
    const Corner& g = corner.geometry();
    const double period = task_.sample_period, cosine = g.cos_interior();
    const int last = member_.order() + delay + 2;
    if (corner.error_max) {
      double nearest = none;
      for (int k = 0; k <= last; ++k) {
        const double p = g.feed_in * period * at(member_.way_left, k), m = k - delay;
        const double beyond = std::max(0.0, m - (member_.order() + 1));
        const double q = g.feed_out * period * (m <= 0 ? 0.0 : at(member_.way_gone, k - delay) + beyond);
        nearest = std::min(nearest, p * p + q * q + 2.0 * p * q * cosine);
      }
      if (std::sqrt(std::max(0.0, nearest)) > *corner.error_max * (1.0 + 1e-12)) return true;
    }
    std::vector<double> speed(static_cast<std::size_t>(last) + 1, 0.0);
    for (std::size_t x = 0; x < granted_.machine.axes.size(); ++x) {
      const auto e = static_cast<Eigen::Index>(x);
      const double in = g.feed_in * g.direction_in[e], out = g.feed_out * g.direction_out[e];
      double before = 0.0;
      for (int k = 0; k <= last; ++k) {
        const double v = in * at(member_.left, k) + (k > delay ? out * at(member_.gone, k - delay) : 0.0);
        const double a = (out * tap(k - 1 - delay) - in * tap(k - 1)) / period;
        if (broken(granted_.machine.axes[x], v, a, before, period)) return true;
        before = a;
        speed[static_cast<std::size_t>(k)] += v * v;
      }
    }
    return corner.speed_min > 0.0 &&
           corner.speed_min > std::sqrt(*std::min_element(speed.begin(), speed.end())) * (1.0 + 1e-12);
  }

  bool kind(DelayKind wanted) const {
    const auto& kinds = task_.settings->delays;
    return std::find(kinds.begin(), kinds.end(), wanted) != kinds.end();
  }
  bool any_delay() const {
    return task_.settings->delays.empty() || kind(DelayKind::dwell) || kind(DelayKind::timed_axis);
  }

  /// A delay below which the corner's error is too large. At every shorter delay, leg 2 is at least as far away sample
  /// by sample. The nearest of all such positions therefore bounds the error of them all.
  int least_delay(std::size_t j) const {
    const TaskCorner& corner = granted_.corners[j];
    if (task_.corners[j].delay) return *task_.corners[j].delay;
    if (!corner.error_max) return 0;
    const Corner& g = corner.geometry();
    const double period = task_.sample_period, cosine = g.cos_interior();
    const double allowed = *corner.error_max * *corner.error_max * (1.0 + 1e-9);
    const auto too_far = [&](int delay) {
      for (int k = 0; k <= member_.order() + delay + 2; ++k) {
        const double p = g.feed_in * period * at(member_.way_left, k);
        const double beyond = std::max(0, k - delay - member_.order() - 1);
        double q = g.feed_out * period * (k <= delay ? 0.0 : at(member_.way_gone, k - delay) + beyond);
        q = std::max(q, -p * cosine);  // the nearest, if that is farther along leg 2
        if (p * p + q * q + 2.0 * p * q * cosine <= allowed) return false;
      }
      return true;
    };
    int first = 0, last = longest_;
    while (first < last) {
      const int middle = first + (last - first) / 2;
      if (too_far(middle))
        first = middle + 1;
      else
        last = middle;
    }
    return first;
  }

  /// The shortest delay without a width; -1: none.
  int plain_delay(std::size_t j, int least, double room) {
    const std::optional<int> given = task_.corners[j].delay;
    if (given) return holds(j, *given) ? *given : -1;
    const int first = std::max(any_delay() ? 0 : apart(), least);
    if (!any_delay() && kind(DelayKind::continuous) && holds(j, 0)) return 0;
    if (!any_delay() && !kind(DelayKind::exact_stop)) return -1;
    for (int d = first; d <= longest_; ++d) {
      if (cost_.delay[j] * d >= room) return -1;
      if (holds(j, d)) return d;
    }
    return -1;
  }

  /// The least delay at which the legs do not overlap.
  int apart() const {
    int first = 0, last = member_.order();
    while (tap(first) == 0.0) ++first;
    while (tap(last) == 0.0) --last;
    return last - first;
  }

  /// Delays that hold all limits within the room, of any kind that the controller has.
  std::optional<std::vector<int>> cheap_delays() {
    const std::size_t corners = task_.corners.size();
    std::vector<int> plain;
    for (std::size_t j = 0; j < corners; ++j) plain.push_back(plain_delay(j, least_[j], room_));
    if (auto found = within(plain)) return found;
    if (any_delay() || !kind(DelayKind::in_position)) return std::nullopt;
    std::vector<double> widths{none};
    for (std::size_t j = 0; j < corners; ++j) {
      for (const double way : member_.way_left) {
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
        const auto after = [&](double left) { return way * left > width; };
        const auto& left = member_.way_left;
        const int d = static_cast<int>(std::partition_point(left.begin(), left.end(), after) - left.begin());
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
  const LinearCost cost = cost_of(task);
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
                   const std::string rule = Refutation(task, granted, m, room, stop).rule();
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
  if (has_dry_friction(task.machine) || limits_supply(task.machine))
    throw Rejected("a proof about families is not known with dry friction or a shared supply");
  double target = none;
  if (result.status == Status::infeasible) {
    if (proof.bound_samples) throw Rejected("the certificate proves a bound, not that no member holds");
  } else {
    if (!result.family_bound) throw Rejected("the result claims no bound of its family");
    const bool optimal = result.status == Status::optimal;
    if (optimal && *result.family_bound < result.objective() * (1.0 - 1e-9))
      throw Rejected("the status is optimal, but the family's bound is below the cycle time");
    target = (optimal ? result.objective() : *result.family_bound) / task.sample_period;
    if (proof.bound_samples.value_or(none) < target * (1.0 - 1e-9))
      throw Rejected(
          fmt::format("the certificate proves {} samples, the result claims {}", *proof.bound_samples, target));
    // Members are refuted up to the result's own claim.
    if (proof.bound_samples.value_or(target) > target * (1.0 + 1e-9))
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
