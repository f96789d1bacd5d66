#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <utility>

#include <accdec/certificate/member_limits.hpp>
#include <accdec/machine/limits.hpp>

namespace accdec {
namespace {

/// Part of an axis' feed below which its dry friction may count as that of rest.
constexpr double hardly_moving = 1e-6;

/// An axis at a sample. Velocity, acceleration and jerk are limited of the command, loads of the motion.
struct Sampled {
  double v = 0.0, a = 0.0, before = 0.0;  ///< of the command: m/s, m/s^2, m/s^2 one sample ago
  double motion_v = 0.0, motion_a = 0.0;  ///< behind the servo
  double period = 0.0, feed = 0.0;        ///< s; m/s, the larger of the axis' legs
  double load(const Axis& axis) const {   ///< N, without the part of dry friction
    return axis.mass * motion_a + axis.damping * motion_v;
  }
};

/// A force at a speed as a part of what the curve has there, times its first force. Above 1 only if it is above the
/// curve; 0 where the curve has no say.
double on_curve(const Axis& axis, double speed, double force) {
  const std::vector<SpeedForce>& curve = axis.force_speed;
  if (curve.empty()) return 0.0;
  double allowed = curve.front().force;
  for (std::size_t i = 1; i < curve.size() && speed > curve[i - 1].speed; ++i) {
    const double part = (std::min(speed, curve[i].speed) - curve[i - 1].speed) / (curve[i].speed - curve[i - 1].speed);
    allowed = curve[i - 1].force + part * (curve[i].force - curve[i - 1].force);
  }
  // Sums of taps and the simulation may round apart.
  const double slack = 1e-6 * curve.front().force;
  return force > allowed + slack ? 2.0 * axis.force_speed_max : 0.0;
}

/// The value that a limit bounds: the checker's own list.
inline double value_of(LimitKind kind, const Sampled& s, const Axis& axis) {
  if (axis.coulomb > 0.0 && std::abs(s.motion_v) <= hardly_moving * s.feed &&
      (kind == LimitKind::force || kind == LimitKind::power || kind == LimitKind::regeneration ||
       kind == LimitKind::force_speed))
    return 0.0;
  const double force = s.load(axis) + std::copysign(axis.coulomb, s.motion_v);
  switch (kind) {
    case LimitKind::velocity: return std::abs(s.v);
    case LimitKind::acceleration: return std::abs(s.a);
    case LimitKind::jerk: return std::abs(s.a - s.before) / s.period;
    case LimitKind::force: return std::abs(force);
    case LimitKind::power: return force * s.motion_v;
    case LimitKind::regeneration: return -force * s.motion_v;
    case LimitKind::force_speed: return on_curve(axis, std::abs(s.motion_v), std::abs(force));
    case LimitKind::vibration:
    case LimitKind::residual:
    case LimitKind::corner_error:
    case LimitKind::speed_min:
    case LimitKind::power_total:
    case LimitKind::regeneration_total:
    case LimitKind::contour: break;  // not of an axis
  }
  return 0.0;
}

/// Every sample of every leg passes here: kinds are constants, so that the compiler leaves one list of comparisons.
template <std::size_t... i>
std::optional<LimitKind> first_broken(const Axis& axis, const Sampled& s, std::index_sequence<i...>) {
  std::optional<LimitKind> kind;
  (void)((value_of(axis_limits[i].kind, s, axis) > axis.*axis_limits[i].bound && (kind = axis_limits[i].kind, true)) ||
         ...);
  return kind;
}

bool has_loads(const Axis& axis) {
  return std::min({axis.force_max, axis.power_max, axis.regeneration_max, axis.force_speed_max}) < unlimited;
}

std::optional<LimitKind> broken(const Axis& axis, const Sampled& sampled) {
  constexpr std::size_t of_command = 3;
  static_assert(axis_limits[of_command - 1].kind == LimitKind::jerk);
  if (!has_loads(axis)) return first_broken(axis, sampled, std::make_index_sequence<of_command>{});
  return first_broken(axis, sampled, std::make_index_sequence<axis_limits.size()>{});
}

double at(const std::vector<double>& values, int k) {
  return values[static_cast<std::size_t>(std::clamp(k, 0, static_cast<int>(values.size()) - 1))];
}
double tap(const FamilyMember& member, int i) {
  return i < 0 || i > member.order() ? 0.0 : member.taps[static_cast<std::size_t>(i)];
}
/// q(m), at full speed behind the last tap.
double way_gone(const FamilyMember& member, int m) {
  return m <= 0 ? 0.0 : at(member.way_gone, m) + std::max(0, m - member.order() - 1);
}

/// The least delay up to `last` that is not too far; too_far holds below a delay.
template <class TooFar>
int first_near(int last, const TooFar& too_far) {
  int first = 0;
  while (first < last) {
    const int middle = first + (last - first) / 2;
    if (too_far(middle))
      first = middle + 1;
    else
      last = middle;
  }
  return first;
}

FamilyMember behind(const FamilyMember& member, const std::vector<double>& response) {
  std::vector<double> taps(member.taps.size() + response.size() - 1, 0.0);
  for (std::size_t i = 0; i < member.taps.size(); ++i) {
    for (std::size_t j = 0; j < response.size(); ++j) taps[i + j] += member.taps[i] * response[j];
  }
  return member_of(std::move(taps));
}

}  // namespace

bool surely_holds(const Axis& axis, double speed, double acceleration, double step, double period) {
  constexpr double below = 1.0 - 1e-9;
  const double mass_force = axis.mass * acceleration, force = mass_force + axis.damping * speed + axis.coulomb;
  return axis.force_speed_max >= unlimited && speed <= below * axis.velocity_max &&
         acceleration <= below * axis.acceleration_max && step <= below * axis.jerk_max * period &&
         force <= below * axis.force_max && force * speed <= below * axis.power_max &&
         mass_force * speed <= below * axis.regeneration_max;
}

/// The steepness that bounds a member's acceleration and jerk at any speed.
struct MemberLimits::Steepness {
  double tap = 0.0, step = 0.0;  ///< the largest tap, and the largest difference of neighbours

  explicit Steepness(const FamilyMember& member) {
    double before = 0.0;
    for (const double now : member.taps) {
      tap = std::max(tap, now);
      step = std::max(step, std::abs(now - before));
      before = now;
    }
    step = std::max(step, before);
  }
  /// Whether a leg at this speed keeps the limits by more than rounding.
  bool surely_holds(const Axis& axis, double speed, double period) const {
    return surely_holds(axis, speed, speed, speed, period);
  }
  /// Whether two legs do, wherever they meet. Their taps add up if they point apart, and their steps in any case.
  bool surely_meet(const Axis& axis, double in, double out, double period) const {
    const double faster = std::max(std::abs(in), std::abs(out)), both = std::abs(in) + std::abs(out);
    return surely_holds(axis, faster, in * out < 0.0 ? both : faster, both, period);
  }
  bool surely_holds(const Axis& axis, double speed, double speed_of_taps, double speed_of_steps, double period) const {
    return accdec::surely_holds(axis, speed, speed_of_taps * tap / period, speed_of_steps * step / period, period);
  }
};

MemberLimits::MemberLimits(const Task& granted, const FamilyMember& member, const CheckedResponse& response)
    : granted_(granted), member_(member), servo_(response.servo()) {
  if (response.smoothing().size() > 1) command_ = behind(member, response.smoothing());
  order_behind_ = command().order() + static_cast<int>(servo_.size()) - 1;
}

const FamilyMember& MemberLimits::motion() const {
  if (servo_.size() <= 1) return command();
  // A slow servo has more taps than the filter, and most members are refuted without them.
  if (!motion_) motion_ = behind(command(), servo_);
  return *motion_;
}

const MemberLimits::Steepness& MemberLimits::steepness() const {
  if (!steepness_) steepness_ = std::make_shared<Steepness>(command());
  return *steepness_;
}

std::optional<LimitKind> MemberLimits::broken_by_legs() const {
  const Steepness& steep = steepness();
  if (legs_hold_together(steep)) return std::nullopt;
  for (const TaskCorner& corner : granted_.corners) {
    const Corner& g = corner.geometry();
    for (std::size_t x = 0; x < granted_.machine.axes.size(); ++x) {
      const auto e = static_cast<Eigen::Index>(x);
      const double in = g.feed_in * g.direction_in[e], out = g.feed_out * g.direction_out[e];
      if (const auto limit = broken_by_leg(steep, granted_.machine.axes[x], in, out)) return limit;
    }
  }
  return std::nullopt;
}

/// Without dry friction a slower leg breaks no limit that a faster one holds.
bool MemberLimits::legs_hold_together(const Steepness& steep) const {
  for (std::size_t x = 0; x < granted_.machine.axes.size(); ++x) {
    if (granted_.machine.axes[x].coulomb > 0.0) return false;
    double in = 0.0, out = 0.0;
    for (const TaskCorner& corner : granted_.corners) {
      const Corner& g = corner.geometry();
      const auto e = static_cast<Eigen::Index>(x);
      in = std::max(in, std::abs(g.feed_in * g.direction_in[e]));
      out = std::max(out, std::abs(g.feed_out * g.direction_out[e]));
    }
    if (broken_by_leg(steep, granted_.machine.axes[x], in, out)) return false;
  }
  return true;
}

/// An axis that starts at one velocity and stops from the other.
std::optional<LimitKind> MemberLimits::broken_by_leg(const Steepness& steep, const Axis& axis, double in,
                                                     double out) const {
  const double period = granted_.sample_period, feed = std::max(std::abs(in), std::abs(out));
  if (steep.surely_holds(axis, feed, period)) return std::nullopt;
  if (steep.tap * feed > axis.acceleration_max * period) return LimitKind::acceleration;
  if (steep.step * feed > axis.jerk_max * period * period) return LimitKind::jerk;
  const FamilyMember &commanded = command(), &moved = motion();
  for (int k = 0; k <= longest_delay(); ++k) {
    const double now = tap(commanded, k - 1) / period, before = tap(commanded, k - 2) / period,
                 then = tap(moved, k - 1) / period;
    const Sampled start{
        in * at(commanded.gone, k), in * now, in * before, in * at(moved.gone, k), in * then, period, feed};
    if (const auto limit = broken(axis, start)) return limit;
    const Sampled stop{
        out * at(commanded.left, k), -out * now, -out * before, out * at(moved.left, k), -out * then, period, feed};
    if (const auto limit = broken(axis, stop)) return limit;
  }
  return std::nullopt;
}

bool MemberLimits::rings() const {
  constexpr int ratios = 4;
  for (const Mode& mode : granted_.machine.modes) {
    if (mode.of_axis()) continue;
    const double band = mode.frequency_high - mode.frequency_low, spread = mode.damping_high - mode.damping_low;
    const int steps =
        2 + static_cast<int>(std::min(1e5, 8.0 * band * granted_.sample_period * (command().order() + 1)));
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
double MemberLimits::left(double frequency, double damping) const {
  const double w = 2.0 * std::numbers::pi * frequency * granted_.sample_period;
  const std::complex<double> turn =
      std::polar(std::exp(-damping * w), -w * std::sqrt((1.0 - damping) * (1.0 + damping)));
  std::complex<double> sum = 0.0;
  for (const double b : command().taps) sum = sum * turn + b;
  return std::abs(sum);
}

/// The nearer leg is min(p, q) sin(theta) away. Between two samples that is largest where p = q.
bool MemberLimits::contour_broken(const TaskCorner& corner, int delay, int last) const {
  const FamilyMember& moved = motion();
  const Corner& g = corner.geometry();
  const double in = g.feed_in * granted_.sample_period, out = g.feed_out * granted_.sample_period;
  const double sine = (g.direction_out + g.cos_interior() * g.direction_in).norm();
  double farthest = 0.0, p0 = 0.0, q0 = 0.0;
  for (int k = 0; k <= last; ++k) {
    const double p = in * at(moved.way_left, k), q = out * way_gone(moved, k - delay);
    farthest = std::max(farthest, std::min(p, q));
    if (k > 0 && p0 > q0 && p < q) farthest = std::max(farthest, (p0 * q - q0 * p) / (p0 - q0 + q - p));
    p0 = p, q0 = q;
  }
  return farthest * sine > *corner.contour_max * (1.0 + 1e-12);
}

bool MemberLimits::broken_by_blend(const TaskCorner& corner, int delay) const {
  const FamilyMember &commanded = command(), &moved = motion();
  const Corner& g = corner.geometry();
  const double period = granted_.sample_period, cosine = g.cos_interior();
  const int last = moved.order() + delay + 2;
  if (corner.error_max) {
    double nearest = std::numeric_limits<double>::infinity();
    for (int k = 0; k <= last; ++k) {
      const double p = g.feed_in * period * at(moved.way_left, k), q = g.feed_out * period * way_gone(moved, k - delay);
      nearest = std::min(nearest, p * p + q * q + 2.0 * p * q * cosine);
    }
    if (std::sqrt(std::max(0.0, nearest)) > *corner.error_max * (1.0 + 1e-12)) return true;
  }
  if (too_slow(corner, delay, 0.0)) return true;
  if (corner.contour_max && contour_broken(corner, delay, last)) return true;
  for (std::size_t x = 0; x < granted_.machine.axes.size(); ++x) {
    const auto e = static_cast<Eigen::Index>(x);
    const double in = g.feed_in * g.direction_in[e], out = g.feed_out * g.direction_out[e];
    const auto velocity = [=](const FamilyMember& member, int k) {
      return in * at(member.left, k) + (k > delay ? out * at(member.gone, k - delay) : 0.0);
    };
    const auto acceleration = [=](const FamilyMember& member, int k) {
      return (out * tap(member, k - 1 - delay) - in * tap(member, k - 1)) / period;
    };
    if (steepness().surely_meet(granted_.machine.axes[x], in, out, period)) continue;
    double before = 0.0;
    for (int k = 0; k <= last; ++k) {
      const double v = velocity(commanded, k), a = acceleration(commanded, k);
      const Sampled sampled{
          v, a, before, velocity(moved, k), acceleration(moved, k), period, std::max(std::abs(in), std::abs(out))};
      if (broken(granted_.machine.axes[x], sampled)) return true;
      before = a;
    }
  }
  return false;
}

bool MemberLimits::too_slow(const TaskCorner& corner, int delay, double more) const {
  if (!(corner.speed_min > 0.0)) return false;
  const FamilyMember& moved = motion();
  const Corner& g = corner.geometry();
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k <= moved.order() + delay + 2; ++k) {
    const double left = g.feed_in * at(moved.left, k), gone = k > delay ? g.feed_out * at(moved.gone, k - delay) : 0.0;
    least = std::min(least, left * left + gone * gone - 2.0 * g.cos_interior() * left * gone);
  }
  return corner.speed_min > std::sqrt(std::max(0.0, least) + more) * (1.0 + 1e-12);
}

bool MemberLimits::too_slow_from(const TaskCorner& corner, int delay) const {
  constexpr double rounding = 1e-12;  // of a right angle
  const Corner& g = corner.geometry();
  return g.cos_interior() <= rounding && too_slow(corner, delay, 2.0 * rounding * g.feed_in * g.feed_out);
}

bool MemberLimits::broken_by_corner_feed(const TaskCorner& corner, double part) const {
  const Corner& g = corner.geometry();
  TaskCorner slow = corner;
  slow.set_feeds(part * g.feed_in, part * g.feed_out);
  if (broken_by_blend(slow, 0)) return true;
  const auto step_breaks = [&](const Eigen::VectorXd& along, double before, double after) {
    const std::vector<double> direction(along.begin(), along.end());
    const int axes = static_cast<int>(direction.size());
    return broken_by_blend(TaskCorner("", DirectedLegs{direction, direction}, before, after, axes), 0);
  };
  return step_breaks(g.direction_in, g.feed_in, part * g.feed_in) ||
         step_breaks(g.direction_out, part * g.feed_out, g.feed_out);
}

bool MemberLimits::too_far(const TaskCorner& corner, int delay, bool between, double part) const {
  const FamilyMember& moved = motion();
  const Corner& g = corner.geometry();
  const double period = granted_.sample_period, cosine = g.cos_interior();
  const double allowed = std::pow(*corner.error_max / part, 2) * (1.0 + 1e-9);
  const int more = between ? 1 : 0;
  // Over a range of samples, leg 1 is at least as far away as at its end and leg 2 as at its beginning.
  const auto all_far = [&](const auto& self, int first, int last) -> bool {
    double p = g.feed_in * period * at(moved.way_left, last + more),
           q = g.feed_out * period * way_gone(moved, first - delay);
    // The nearest, if one is farther along its leg.
    q = std::max(q, -p * cosine);
    p = std::max(p, -q * cosine);
    if (p * p + q * q + 2.0 * p * q * cosine > allowed) return true;
    if (first == last) return false;
    const int middle = first + (last - first) / 2;
    return self(self, first, middle) && self(self, middle + 1, last);
  };
  return all_far(all_far, 0, moved.order() + delay + 2);
}

int MemberLimits::least_delay(const TaskCorner& corner, bool between) const {
  if (!corner.error_max) return 0;
  return first_near(longest_delay(), [&](int delay) { return too_far(corner, delay, between); });
}

int least_delay_behind(const CheckedResponse& response, const TaskCorner& corner, double period) {
  if (!corner.error_max) return 0;
  const FamilyMember moved = behind(member_of(response.smoothing()), response.servo());
  const Corner& g = corner.geometry();
  const double cosine = g.cos_interior(), sine_squared = (1.0 - cosine) * (1.0 + cosine);
  const double allowed = *corner.error_max * *corner.error_max * (1.0 + 1e-9);
  const auto too_far = [&](int delay) {
    for (int k = 0; k <= moved.order() + delay + 2; ++k) {
      // From sample k to the next, p is at least as it is at the end, and q as at the beginning.
      const double p = g.feed_in * period * at(moved.way_left, k + 1),
                   q = g.feed_out * period * way_gone(moved, k - delay);
      double nearest = p * p + q * q + 2.0 * p * q * cosine;
      if (p + q * cosine < 0.0) nearest = q * q * sine_squared;
      if (q + p * cosine < 0.0) nearest = p * p * sine_squared;
      if (nearest <= allowed) return false;
    }
    return true;
  };
  return first_near(moved.order() + 2, too_far);
}

}  // namespace accdec
