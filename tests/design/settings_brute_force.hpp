#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <accdec/design.hpp>
#include <accdec/result.hpp>
#include <accdec/task.hpp>

// The best setting of a controller by brute force: every member, every delay and every width, by the formulas of the
// model written once more.

namespace accdec::testing {

inline constexpr double none = std::numeric_limits<double>::infinity();

inline std::vector<double> convolve(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> c(a.size() + b.size() - 1, 0.0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < b.size(); ++j) c[i + j] += a[i] * b[j];
  }
  return c;
}

/// The sums of a filter: B_k = sum_{i<k} b_i, p(k) = sum b_i max(i - k, 0), q(k) = sum b_i max(k - i, 0).
class Sums {
 public:
  explicit Sums(const std::vector<double>& taps) : n_(static_cast<int>(taps.size()) - 1), b_{0.0}, q_{0.0} {
    for (const double tap : taps) b_.push_back(b_.back() + tap);
    for (std::size_t k = 1; k < b_.size(); ++k) q_.push_back(q_.back() + b_[k]);
    p_.assign(b_.size(), 0.0);
    for (std::size_t k = taps.size() - 1; k-- > 0;) p_[k] = p_[k + 1] + (1.0 - b_[k + 1]);
  }
  int order() const { return n_; }
  double b(int k) const { return k <= 0 ? 0.0 : k > n_ ? 1.0 : b_[static_cast<std::size_t>(k)]; }
  double p(int k) const { return k < 0 ? p_[0] - k : k > n_ ? 0.0 : p_[static_cast<std::size_t>(k)]; }
  double q(int k) const { return k <= 0 ? 0.0 : k > n_ ? q_.back() + (k - n_ - 1) : q_[static_cast<std::size_t>(k)]; }

 private:
  int n_;
  std::vector<double> b_, p_, q_;
};

/// A filter behind nothing, behind the control's smoothing, and behind the servo, which all axes have alike.
struct Behind {
  Sums command, motion;

  Behind(const Task& task, const std::vector<double>& taps)
      : command(convolve(taps, smoothing(task))), motion(convolve(convolve(taps, smoothing(task)), servo(task))) {}

  static std::vector<double> smoothing(const Task& task) {
    return task.machine.prefilter_taps.empty() ? std::vector{1.0} : task.machine.prefilter_taps;
  }
  /// A position control of gain Kv that feeds the part g of the velocity forward: what is missing of a step falls by
  /// a = exp(-Kv T) in every sample.
  static std::vector<double> servo(const Task& task) {
    const Axis& axis = task.machine.axes.front();
    if (!axis.response_taps.empty()) return axis.response_taps;
    if (!(axis.servo_gain < unlimited)) return {1.0};
    const double x = axis.servo_gain * task.sample_period, a = std::exp(-x);
    double missing = (1.0 - axis.velocity_feedforward) * (1.0 - a) / x;
    std::vector<double> taps{1.0 - missing};
    for (; missing > 1e-12; missing *= a) taps.push_back(missing * (1.0 - a));
    return taps;
  }
};

/// Dry friction opposes the motion; at rest it takes what it can of the force.
inline double force_of(const Axis& axis, double v, double a) {
  const double moving = axis.mass * a + axis.damping * v;
  if (std::abs(v) > 1e-9) return moving + std::copysign(axis.coulomb, v);
  return std::copysign(std::max(0.0, std::abs(moving) - axis.coulomb), moving);
}

/// Velocity, acceleration and jerk are of the command, loads of the motion.
inline bool sample_holds(const Axis& axis, double v, double a, double jerk, double force, double motion_v) {
  const double slack = 1.0 + 1e-9;
  return std::abs(v) <= axis.velocity_max * slack && std::abs(a) <= axis.acceleration_max * slack &&
         std::abs(jerk) <= axis.jerk_max * slack && std::abs(force) <= axis.force_max * slack &&
         force * motion_v <= axis.power_max * slack && -force * motion_v <= axis.regeneration_max * slack;
}

/// Samples from a step of the command until its motion is steady.
inline int lead_of(const Behind& filter) {
  return filter.motion.order() + 2;
}

/// Rest, leg 1, the corner with this delay, leg 2, rest: all limits of a corner. It may be passed at a part of the
/// feed, to which the command steps on leg 1, and from which it steps on leg 2.
inline bool holds(const Task& task, const TaskCorner& corner, const Behind& filter, int delay, double part = 1.0) {
  const Corner& g = corner.geometry();
  const double period = task.sample_period;
  const int lead = part < 1.0 ? lead_of(filter) : 0;
  const auto velocity = [&](const Sums& sums, int axis, int event, int k) {
    const double in = g.feed_in * g.direction_in[axis], out = g.feed_out * g.direction_out[axis];
    if (event == 0) return in * sums.b(k);
    if (event == 1) {
      return in * (1.0 - (1.0 - part) * sums.b(k + lead) - part * sums.b(k)) +
             out * (part * sums.b(k - delay) + (1.0 - part) * sums.b(k - delay - lead));
    }
    return out * (1.0 - sums.b(k));
  };
  double nearest = none, slowest = none;
  for (int event = 0; event < 3; ++event) {
    const int around = event == 1 ? lead : 0;
    for (int k = -around; k <= filter.motion.order() + delay + 3 + around; ++k) {
      double speed = 0.0, power = 0.0;
      for (int axis = 0; axis < 2; ++axis) {
        const auto of = [&](const Sums& sums, int back) { return velocity(sums, axis, event, k - back); };
        const double v = of(filter.command, 0), a = (v - of(filter.command, 1)) / period;
        const double before = (of(filter.command, 1) - of(filter.command, 2)) / period;
        const double motion_v = of(filter.motion, 0), motion_a = (motion_v - of(filter.motion, 1)) / period;
        const Axis& limits = task.machine.axes[static_cast<std::size_t>(axis)];
        const double force = force_of(limits, motion_v, motion_a);
        if (!sample_holds(limits, v, a, (a - before) / period, force, motion_v)) return false;
        speed += motion_v * motion_v, power += force * motion_v;
      }
      if (power > task.machine.power_total_max * (1.0 + 1e-9)) return false;
      if (event != 1) continue;
      slowest = std::min(slowest, std::sqrt(speed));
      const Sums& m = filter.motion;
      const double to_go = (1.0 - part) * m.p(k + lead) + part * m.p(k),
                   gone = part * m.q(k - delay) + (1.0 - part) * m.q(k - delay - lead);
      const Eigen::VectorXd s = period * (g.feed_out * gone * g.direction_out - g.feed_in * to_go * g.direction_in);
      nearest = std::min(nearest, s.norm());
    }
  }
  return nearest <= *corner.error_max * (1.0 + 1e-9) && slowest * (1.0 + 1e-9) >= corner.speed_min;
}

/// Whether the filter leaves more of a vibration at its last tap than a mode allows, each of one frequency and damping.
inline bool rings(const Task& task, const std::vector<double>& taps) {
  const std::vector<double> command = convolve(taps, Behind::smoothing(task));
  for (const Mode& mode : task.machine.modes) {
    if (mode.axis >= 0) continue;
    const double w = 2.0 * std::numbers::pi * mode.frequency_low * task.sample_period, z = mode.damping_low;
    double cosines = 0.0, sines = 0.0;
    for (std::size_t i = 0; i < command.size(); ++i) {
      const auto back = static_cast<double>(command.size() - 1 - i);
      const double fall = command[i] * std::exp(-z * w * back), turn = w * std::sqrt(1.0 - z * z) * back;
      cosines += fall * std::cos(turn), sines += fall * std::sin(turn);
    }
    if (std::hypot(cosines, sines) > mode.residual_max * (1.0 + 1e-9)) return true;
  }
  return false;
}

/// Whether an axis swings farther than its mode allows behind a start, the corner or a stop. Every change of the
/// velocity swings by itself, dies away and is added up at the last of them.
inline bool swings(const Task& task, const TaskCorner& corner, const std::vector<double>& taps, int delay) {
  const std::vector<double> command = convolve(taps, Behind::smoothing(task));
  const Corner& g = corner.geometry();
  for (const Mode& mode : task.machine.modes) {
    if (mode.axis < 0) continue;
    const double in = g.feed_in * g.direction_in[mode.axis], out = g.feed_out * g.direction_out[mode.axis];
    const double w = 2.0 * std::numbers::pi * mode.frequency_low, z = mode.damping_low, wd = w * std::sqrt(1.0 - z * z);
    for (int event = 0; event < 3; ++event) {
      std::vector<double> changes(command.size() + static_cast<std::size_t>(delay), 0.0);
      for (std::size_t i = 0; i < command.size(); ++i) {
        if (event == 0) changes[i] += in * command[i];
        if (event == 1) changes[i] -= in * command[i], changes[i + static_cast<std::size_t>(delay)] += out * command[i];
        if (event == 2) changes[i] -= out * command[i];
      }
      while (!changes.empty() && std::abs(changes.back()) < 1e-12) changes.pop_back();
      double cosines = 0.0, sines = 0.0;
      for (std::size_t i = 0; i < changes.size(); ++i) {
        const double t = static_cast<double>(changes.size() - 1 - i) * task.sample_period;
        cosines += changes[i] * std::exp(-z * w * t) * std::cos(wd * t);
        sines += changes[i] * std::exp(-z * w * t) * std::sin(wd * t);
      }
      if (std::hypot(cosines, sines) / wd > mode.displacement_max * (1.0 + 1e-9)) return true;
    }
  }
  return false;
}

/// The cheapest delays of a filter, samples of the objective.
inline double cheapest(const Task& task, const std::vector<double>& taps) {
  if (rings(task, taps)) return none;
  const int n = static_cast<int>(taps.size()) - 1;
  const auto& kinds = task.settings->delays;
  const auto has = [&](DelayKind kind) { return std::find(kinds.begin(), kinds.end(), kind) != kinds.end(); };
  const bool any = kinds.empty() || has(DelayKind::dwell);
  const Behind filter(task, taps);
  int last = filter.motion.order() + 2;
  for (const Mode& mode : task.machine.modes)  // the phase between the legs
    last += mode.axis < 0 ? 0 : static_cast<int>(1.0 / (mode.frequency_low * task.sample_period));
  std::vector<std::vector<bool>> good;
  for (const TaskCorner& corner : task.corners) {
    good.emplace_back();
    for (int d = 0; d <= last; ++d)
      good.back().push_back(holds(task, corner, filter, d) && !swings(task, corner, taps, d));
  }
  const double step = task.settings->corner_feed_step;
  std::vector<std::vector<bool>> by_part;
  for (const TaskCorner& corner : task.corners) {
    by_part.emplace_back();
    for (int m = 1; has(DelayKind::corner_feed) && m * step < 1.0 - 1e-9; ++m)
      by_part.back().push_back(holds(task, corner, filter, 0, m * step));
  }
  const Sums& watched = task.settings->in_position_actual ? filter.motion : filter.command;
  // The control waits for the first sample within the width.
  const auto left = [&](int samples) {
    double least = none;
    for (int i = 0; i <= samples; ++i) least = std::min(least, std::abs(watched.p(i)));
    return least;
  };
  // The speed along leg 1, or that of its fastest axis.
  const auto watched_feed = [&](const TaskCorner& corner) {
    const Corner& g = corner.geometry();
    double part = task.settings->in_position_by_axis ? 0.0 : 1.0;
    for (Eigen::Index a = 0; a < g.axes() && task.settings->in_position_by_axis; ++a)
      part = std::max(part, std::abs(g.direction_in[a]));
    return g.feed_in * part;
  };
  const int latency = static_cast<int>(std::lround(task.settings->in_position_latency / task.sample_period));
  std::vector<double> widths{none};
  if (has(DelayKind::in_position)) {
    for (const TaskCorner& corner : task.corners) {
      for (int d = 0; d <= watched.order(); ++d) widths.push_back(watched_feed(corner) * left(d));
    }
    std::sort(widths.begin(), widths.end());
    const std::vector<double> ends = widths;
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
      if (std::isfinite(ends[i + 1])) widths.push_back(0.5 * (ends[i] + ends[i + 1]));
    }
  }
  double best = none;
  for (const double width : widths) {
    double cost = task.design.runs * (n + 1);
    for (std::size_t j = 0; j < task.corners.size(); ++j) {
      double least = none;
      for (int d = 0; d <= last; ++d) {
        const double feed = watched_feed(task.corners[j]);
        const bool by_width = has(DelayKind::in_position) && d >= latency && feed * left(d - latency) <= width &&
                              (d == latency || feed * left(d - latency - 1) > width);
        const bool kind =
            any || (d == 0 && has(DelayKind::continuous)) || (d >= n && d <= n + 1 && has(DelayKind::exact_stop));
        if ((kind || by_width) && good[j][static_cast<std::size_t>(d)]) least = std::min<double>(least, d);
      }
      if (has(DelayKind::corner_feed)) {
        for (std::size_t m = 0; m < by_part[j].size(); ++m)
          if (by_part[j][m]) least = std::min(least, 2.0 * lead_of(filter) * (1.0 - (m + 1.0) * step));
      }
      cost += task.corners[j].weight * least;
    }
    best = std::min(best, cost);
  }
  return best;
}

inline std::vector<double> average(int length) {
  return std::vector<double>(static_cast<std::size_t>(length), 1.0 / length);
}

/// Two or three impulses a delay apart. An impulse between two samples is shared as a linear interpolation does it.
inline std::vector<double> impulses(const std::string& shaper, double delay) {
  const double root = std::sqrt(2.0);
  std::vector<double> weights{0.5, 0.5};
  if (shaper == "zvd") weights = {0.25, 0.5, 0.25};
  if (shaper == "mzv") weights = {1.0 - 1.0 / root, root - 1.0, 1.0 - 1.0 / root};
  if (shaper == "ei") weights = {0.2625, 0.475, 0.2625};
  const double end = static_cast<double>(weights.size() - 1) * delay;
  std::vector<double> taps(static_cast<std::size_t>(std::ceil(end - 1e-6)) + 1, 0.0);
  for (std::size_t k = 0; k < taps.size(); ++k) {
    for (std::size_t i = 0; i < weights.size(); ++i)
      taps[k] += weights[i] * std::max(0.0, 1.0 - std::abs(static_cast<double>(k) - static_cast<double>(i) * delay));
  }
  return taps;
}

inline std::vector<double> divided_by_sum(std::vector<double> taps) {
  double sum = 0.0;
  for (const double tap : taps) sum += tap;
  for (double& tap : taps) tap /= sum;
  return taps;
}

/// Filters of a length and a number.
inline std::vector<std::vector<double>> with_numbers(const Task& task, int length) {
  std::vector<std::vector<double>> all;
  const ControllerSettings& settings = *task.settings;
  const int n = length - 1;
  if (n == 0) return {{1.0}};
  const double period = task.sample_period;
  for (int m = 1;; ++m) {
    std::vector<double> taps;
    if (settings.families.front() == SettingFamily::exponential) {
      const double tau = m * settings.time_constant_step;
      if (tau > (task.design.order_max + 1) * period * 1.000001) return all;
      for (int i = 0; i <= n; ++i) taps.push_back(std::exp(-i * period / tau));
    } else if (settings.families.front() == SettingFamily::gaussian) {
      const double alpha = m * settings.alpha_step;
      if (alpha > 6.000001) return all;
      for (int i = 0; i <= n; ++i) taps.push_back(std::exp(-0.5 * std::pow(alpha * (2.0 * i - n) / n, 2)));
    } else {
      const double f = m * settings.cutoff_step;
      if (n < 2 || f > 1.000001 / (n * period)) return all;
      for (int i = 0; i <= n; ++i) {
        const double turn = 2.0 * std::numbers::pi * i / n, x = std::numbers::pi * f * period * (2.0 * i - n);
        const double window = std::max(0.0, 0.42 - 0.5 * std::cos(turn) + 0.08 * std::cos(2.0 * turn));
        taps.push_back((i == 0 || i == n ? 0.0 : window) *
                       (std::abs(x) < 1e-12 ? 1.0 : std::max(0.0, std::sin(x) / x)));
      }
    }
    all.push_back(divided_by_sum(taps));
  }
}

/// Two endless poles in series, or one if the other is 0, cut off where 1e-4 of the step is left. Their taps are by the
/// formula: (1 - a) (1 - b) (a^(i+1) - b^(i+1)) / (a - b), or (1 - a)^2 (i + 1) a^i.
inline std::vector<double> poles(int one, int other, int order_max) {
  const auto ratio = [](int tau) { return tau > 0 ? std::exp(-1.0 / tau) : 0.0; };
  const double a = ratio(one), b = ratio(other);
  std::vector<double> taps;
  double left = 1.0;
  for (int i = 0; left > 1.0000001e-4 && i <= order_max + 1; ++i) {
    const double tap = one == other ? (1.0 - a) * (1.0 - a) * (i + 1.0) * std::pow(a, i)
                                    : (1.0 - a) * (1.0 - b) * (std::pow(a, i + 1) - std::pow(b, i + 1)) / (a - b);
    taps.push_back(tap), left -= tap;
  }
  return divided_by_sum(taps);
}

/// The least cost of all members of the task's one family.
inline double brute_force(const Task& task) {
  const ControllerSettings& settings = *task.settings;
  const SettableStage& stage = settings.stages.front();
  std::vector<int> lengths;
  for (int length = 1; length <= task.design.order_max + 1; ++length) {
    const double time = length * task.sample_period;
    const int step = std::max(1, static_cast<int>(std::lround(stage.length_step / task.sample_period)));
    const bool capped = stage.length_max > 0.0 && time > stage.length_max * (1.0 + 1e-9);
    if (length % step == 0 && !capped) lengths.push_back(length);
  }
  double best = none;
  const auto offer = [&](const std::vector<double>& taps) {
    const int order = static_cast<int>(taps.size()) - 1;
    if (order >= task.design.order_min && order <= task.design.order_max) best = std::min(best, cheapest(task, taps));
  };
  if (settings.families.front() == SettingFamily::one_pole) {
    lengths.insert(lengths.begin(), 0);
    for (const int one : lengths) {
      for (const int other : settings.stages.size() > 1 ? lengths : std::vector{0})
        offer(poles(one, other, task.design.order_max));
    }
    return best;
  }
  if (lengths.empty() || lengths.front() != 1) lengths.insert(lengths.begin(), 1);
  const SettingFamily family = settings.families.front();
  if (family != SettingFamily::averages && family != SettingFamily::shaper) {
    for (const int length : lengths) {
      for (const auto& taps : with_numbers(task, length)) offer(taps);
    }
    return best;
  }
  std::vector<double> delays;
  for (int delay = 1; delay <= task.design.order_max; ++delay) delays.push_back(delay);
  if (const double step = settings.shaper_frequency_step; step > 0.0) {
    delays.clear();
    const double periods = std::string(settings.shaper->name) == "mzv" ? 0.375 : 0.5;
    for (int m = 1; periods / (m * step * task.sample_period) >= 1.0; ++m)
      delays.push_back(periods / (m * step * task.sample_period));
  }
  for (const int a : lengths) {
    for (const int b : lengths) {
      if (b > a) break;
      if (settings.families.front() == SettingFamily::averages) {
        offer(convolve(average(a), average(b)));
        continue;
      }
      for (const double delay : delays) {
        const std::vector<double> pair = impulses(std::string(settings.shaper->name), delay);
        if (a + b + static_cast<int>(pair.size()) - 3 > task.design.order_max) continue;
        offer(convolve(convolve(average(a), average(b)), pair));
      }
    }
  }
  return best;
}

/// Designs a task and compares its time with brute force.
/// @param best, nothing  statuses of the result if there is a setting, and if there is none
inline DesignResult as_brute_force(const Task& task, Status best, Status nothing, const std::string& what) {
  const double expected = brute_force(task);
  DesignResult result = design_task(task);
  EXPECT_EQ(result.status, std::isinf(expected) ? nothing : best) << what << ": " << result.message;
  if (std::isfinite(expected) && result.has_design()) {
    EXPECT_NEAR(result.objective() / task.sample_period, expected, 1e-6) << what;
  }
  return result;
}

}  // namespace accdec::testing
