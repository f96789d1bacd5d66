#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include <accdec/machine/limits.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/task/check_delays.hpp>
#include <accdec/task/corner_feed.hpp>
#include <accdec/task/simulation.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// Velocity and position of the two legs on their own, rows k = 0 .. N + 2 from their command edges, and as many more
/// as the machine's response takes. Positions are of the motion.
struct Legs {
  struct Velocity {
    Eigen::MatrixXd stop, start;
    Eigen::VectorXd at(Eigen::Index in, Eigen::Index out) const { return (stop.row(in) + start.row(out)).transpose(); }
  };
  Velocity command, motion;
  Eigen::MatrixXd stop_position, start_position;
};

Legs simulate_legs(const Task& task, const Filter& filter, const Corner& corner) {
  const int rows = filter.order() + Response(task.machine, task.sample_period).order() + 3;
  const SampledResponse r = simulate_response(filter, corner, rows, task.sample_period, task.machine);
  const auto velocity = [&](const SampledMotion& m) {
    return Legs::Velocity{m.velocity.middleRows(m.corner, rows), m.velocity.middleRows(m.corner + rows, rows)};
  };
  const SampledMotion& m = r.motion();
  return {velocity(r.command), velocity(m), m.position.middleRows(m.corner, rows),
          m.position.middleRows(m.corner + rows, rows)};
}

/// The delays below a given one at which the error of a corner exceeds its bound. For a filter of a million taps,
/// delays are not tried one by one. In a range of delays and samples, the distances of both legs from the corner have
/// lower bounds. Usually these bounds alone are too far from the corner.
class ErrorRanges {
 public:
  ErrorRanges(const Corner& corner, const Legs& legs, double bound, const std::function<bool()>& stop)
      : cosine_(-corner.direction_in.dot(corner.direction_out)),
        sine_((corner.direction_out + cosine_ * corner.direction_in).norm()),
        bound_(bound),
        tail_(static_cast<int>(legs.stop_position.rows()) - 1),
        left_(static_cast<std::size_t>(tail_) + 1),
        gone_(left_.size()),
        stop_(stop) {
    for (int k = 0; k <= tail_; ++k) {
      const double here = legs.stop_position.row(k).norm();
      left_[index(k)] = k > 0 ? std::min(left_[index(k - 1)], here) : here;
    }
    for (int m = tail_; m >= 0; --m) {
      const double here = legs.start_position.row(m).norm();
      gone_[index(m)] = m < tail_ ? std::min(gone_[index(m + 1)], here) : here;
    }
  }

  /// Delays below `end` for which this is not shown, in rising order.
  std::vector<int> open(int end) {
    open_.assign(static_cast<std::size_t>(end), 0);
    if (end > 0) visit({0, end - 1, 0, tail_ + end - 1});
    std::vector<int> delays;
    for (int d = 0; d < end; ++d) {
      if (open_[index(d)] != 0) delays.push_back(d);
    }
    return delays;
  }

 private:
  struct Range {
    int d1, d2, k1, k2;
  };
  static std::size_t index(int i) { return static_cast<std::size_t>(i); }

  /// Least distance from the corner point, leg 1 with at least `p` to go and leg 2 at least `q` gone.
  double least(double p, double q) const {
    if (cosine_ < 0.0 && p < -q * cosine_) return q * sine_;
    if (cosine_ < 0.0 && q < -p * cosine_) return p * sine_;
    return std::hypot(p + q * cosine_, q * sine_);
  }

  void visit(const Range& r) {
    if (r.d1 == r.d2 && open_[index(r.d1)] != 0) return;
    if (stop_ && stop_()) return mark(r);
    const double p = left_[index(std::min(r.k2, tail_))], q = gone_[index(std::clamp(r.k1 - r.d2, 0, tail_))];
    // Less the possible rounding of the sum of both.
    if (least(p, q) - 1e-15 * (p + q) > bound_) return;
    if (r.k1 == r.k2 && r.d1 == r.d2) return mark(r);
    if (r.d2 - r.d1 > r.k2 - r.k1) {
      const int middle = r.d1 + (r.d2 - r.d1) / 2;
      visit({r.d1, middle, r.k1, r.k2});
      visit({middle + 1, r.d2, r.k1, r.k2});
    } else {
      const int middle = r.k1 + (r.k2 - r.k1) / 2;
      visit({r.d1, r.d2, r.k1, middle});
      visit({r.d1, r.d2, middle + 1, r.k2});
    }
  }
  void mark(const Range& r) { std::fill(open_.begin() + r.d1, open_.begin() + r.d2 + 1, 1); }

  double cosine_, sine_, bound_;
  int tail_;
  std::vector<double> left_, gone_;  // m: least way left up to a sample, least way gone from a sample on
  const std::function<bool()>& stop_;
  std::vector<char> open_;
};

/// The value that a limit bounds at a sample: this check's own list.
double sampled(LimitKind kind, double velocity, double acceleration, double jerk, double force, double power) {
  switch (kind) {
    case LimitKind::velocity: return std::abs(velocity);
    case LimitKind::acceleration: return std::abs(acceleration);
    case LimitKind::jerk: return std::abs(jerk);
    case LimitKind::force: return std::abs(force);
    case LimitKind::power: return power;
    case LimitKind::regeneration: return -power;
    case LimitKind::force_speed:  // left to the simulation
    case LimitKind::residual:
    case LimitKind::vibration:
    case LimitKind::corner_error:
    case LimitKind::speed_min:
    case LimitKind::power_total:
    case LimitKind::regeneration_total:
    case LimitKind::contour: break;  // not of an axis
  }
  return 0.0;
}

/// A force with dry friction, which is against the motion, or helps an axis that stands.
double with_friction(const Axis& axis, double force, double velocity, double still) {
  if (std::abs(velocity) > still) return force + (velocity > 0.0 ? axis.coulomb : -axis.coulomb);
  return std::copysign(std::max(0.0, std::abs(force) - axis.coulomb), force);
}

/// Whether the blend at a delay breaks any limit of a corner whatever rounding does.
bool breaks(const Task& task, const TaskCorner& corner, const Legs& legs, int delay) {
  const double period = task.sample_period, allowed = 1.0 + granted_tolerance;
  const Eigen::Index tail = legs.stop_position.rows() - 1, axes = legs.stop_position.cols();
  const Eigen::Index last = tail + delay;
  const double still = 1e-9 * std::max(corner.geometry().feed_in, corner.geometry().feed_out);
  double nearest = unlimited, slowest = unlimited;
  Eigen::VectorXd before_velocity, before_moved, before_acceleration = Eigen::VectorXd::Zero(axes);
  for (Eigen::Index k = 0; k <= last; ++k) {
    const Eigen::Index m = std::clamp<Eigen::Index>(k - delay, 0, tail), in = std::min(k, tail);
    const Eigen::VectorXd v = legs.command.at(in, m), moved = legs.motion.at(in, m);
    const Eigen::VectorXd s = (legs.stop_position.row(in) + legs.start_position.row(m)).transpose();
    nearest = std::min(nearest, s.norm());
    if (k <= last - 1) slowest = std::min(slowest, moved.norm());
    const Eigen::VectorXd acceleration =
        k == 0 ? Eigen::VectorXd::Zero(axes).eval() : ((v - before_velocity) / period).eval();
    double together = 0.0;
    for (Eigen::Index a = 0; a < axes; ++a) {
      const Axis& axis = task.machine.axes[static_cast<std::size_t>(a)];
      const double moved_by = k == 0 ? 0.0 : (moved[a] - before_moved[a]) / period;
      const double force = with_friction(axis, axis.mass * moved_by + axis.damping * moved[a], moved[a], still);
      together += force * moved[a];
      const double jerk = (acceleration[a] - before_acceleration[a]) / period;
      for (const AxisLimit& limit : axis_limits) {
        if (sampled(limit.kind, v[a], acceleration[a], jerk, force, force * moved[a]) > axis.*limit.bound * allowed)
          return true;
      }
    }
    if (together > task.machine.power_total_max * allowed || -together > task.machine.regeneration_total_max * allowed)
      return true;
    before_velocity = v, before_moved = moved;
    before_acceleration = acceleration;
  }
  if (corner.error_max && nearest > granted_error(*corner.error_max)) return true;
  return corner.speed_min > slowest * allowed;
}

constexpr const char* late = "not checked in time";
constexpr const char* slower = "the control may pass corners at a part of the feed, which was not tried";

/// Delays below the claimed one that the error alone does not exclude.
std::vector<int> delays_to_try(const Task& task, const TaskCorner& corner, const Legs& legs, int claimed,
                               const std::function<bool()>& stop) {
  // If axes respond differently, the ways left and gone are not along the legs.
  if (corner.error_max && Response(task.machine, task.sample_period).common())
    return ErrorRanges(corner.geometry(), legs, granted_error(*corner.error_max), stop).open(claimed);
  std::vector<int> all(static_cast<std::size_t>(claimed));
  std::iota(all.begin(), all.end(), 0);
  return all;
}

/// Whether a leg by itself breaks a limit, with any delay.
bool leg_breaks(const std::vector<LimitUse>& limits) {
  return std::any_of(limits.begin(), limits.end(), [](const LimitUse& use) {
    return (use.event == Event::start || use.event == Event::stop) && !use.axis.empty() && !granted(use.utilisation);
  });
}

}  // namespace

std::string check_smallest_delays(const Task& task, const Filter& filter, const std::vector<int>& delays,
                                  const std::function<bool()>& stop) {
  if (may_pass_slower(task)) return slower;
  for (std::size_t j = 0; j < task.corners.size(); ++j) {
    const TaskCorner& corner = task.corners[j];
    if (corner.delay || delays[j] == 0) continue;
    const Legs legs = simulate_legs(task, filter, corner.geometry());
    for (const int d : delays_to_try(task, corner, legs, delays[j], stop)) {
      if (stop && stop()) return late;
      // Next to a bound the sums of legs and the simulation may round to different sides of it.
      if (!breaks(task, corner, legs, d) && verify_by_simulation(corner_alone(task, corner), filter, {d}).feasible) {
        return fmt::format("corner {}: delay {} is claimed to be the smallest, but {} holds every limit too",
                           corner.name, delays[j], d);
      }
    }
    if (stop && stop()) return late;
  }
  return {};
}

std::string check_no_delays(const Task& task, const Filter& filter, const std::function<bool()>& stop) {
  Task filter_alone = task;
  filter_alone.corners.clear();
  if (!verify_by_simulation(filter_alone, filter, {}).feasible) return {};  // vibration: delays do not matter
  if (may_pass_slower(task)) return slower;
  // From d = N + 1 on, the legs do not overlap, but the jerk spans both; from N + 2 on nothing changes, and as much
  // later as the machine's response takes.
  const int longer = Response(task.machine, task.sample_period).order();
  for (const TaskCorner& corner : task.corners) {
    const Task part = corner_alone(task, corner);
    const auto holds = [&](int delay) { return verify_by_simulation(part, filter, {delay}).feasible; };
    const int last = corner.delay.value_or(filter.order() + longer + 2);
    std::vector<LimitUse> limits;
    verify_by_simulation(part, filter, {last}, &limits);
    if (leg_breaks(limits)) return {};
    int delay = corner.delay.value_or(0);
    while (delay <= last && !holds(delay)) {
      if (stop && stop()) return late;
      ++delay;
    }
    if (delay > last) return {};
  }
  return "every corner holds its limits with some delay of this filter";
}

}  // namespace accdec
