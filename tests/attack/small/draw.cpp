#include "draw.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>

namespace accdec::attack {
namespace {

/// Limits are drawn from the samples that they make a change of speed take.
class Draw {
 public:
  Draw(std::string_view kind, std::uint64_t seed, std::uint64_t number) : kind_(kind) {
    std::seed_seq words{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32),
                        static_cast<std::uint32_t>(number), static_cast<std::uint32_t>(number >> 32)};
    random_.seed(words);
  }

  Task run() {
    several_ = is("several") || is("in-position") || (is("servo") && chance(0.1));
    power_ = is("power") || (is("servo") && chance(0.2));
    regeneration_ = is("regeneration") || (is("servo") && chance(0.2));
    slow_ = is("speed") || (is("servo") && chance(0.15));
    feed_ = uniform(0.01, 0.4), samples_ = uniform(1.2, several_ || power_ || regeneration_ ? 3.0 : 7.0);
    task_.sample_period = 1e-3 * one_of({0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 20.0});
    task_.design.order_max = chance(0.15) ? whole(1, 6) : 24;
    if (chance(0.1)) task_.design.order_min = whole(1, std::min(task_.design.order_max, 5));
    task_.design.symmetric = is("symmetric") || (is("servo") && chance(0.1));
    draw_axes();
    draw_corners();
    if (is("weighted") || several_) {
      task_.design.runs = one_of({1.0, 1.0, 2.0, 0.5, 10.0});
      if (chance(0.3)) task_.design.objective = Objective::corner;
    }
    if (is("vibration") || (is("smoothed") && chance(0.3))) {
      const double low = uniform(0.2, 1.2) / (samples_ * task_.sample_period);
      // Beyond half the sampling frequency a mode is another one's mirror image.
      const double high = std::min(low * one_of({1.0, 1.0, uniform(1.01, 1.15)}), 0.5 / task_.sample_period);
      task_.machine.modes.push_back({std::min(low, high), high, one_of({0.02, 0.05, 0.1, 0.3})});
    }
    const bool convex = !is("power") && !is("regeneration") && !is("speed");
    if (is("smoothed") || (convex && chance(0.15))) draw_smoothing();
    if (is("servo")) draw_servo();
    if (is("given")) draw_filter();
    if (is("in-position")) draw_in_position();
    return task_;
  }

 private:
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  int whole(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }
  bool chance(double p) { return uniform(0.0, 1.0) < p; }
  double one_of(std::vector<double> values) {
    return values[static_cast<std::size_t>(whole(0, static_cast<int>(values.size()) - 1))];
  }
  bool is(std::string_view kind) const { return kind_ == kind; }

  Axis axis() {
    Axis axis;
    const double time = samples_ * task_.sample_period, acceleration = feed_ / time;
    const bool force = power_ || regeneration_ || is("force") || chance(is("servo") ? 0.8 : 0.2);
    if (!force || chance(0.4)) axis.acceleration_max = acceleration * uniform(1.0, 2.0);
    if (!is("force") && chance(0.6)) axis.jerk_max = acceleration / (uniform(0.1, 0.6) * time);
    if (is("velocity")) axis.velocity_max = feed_ * uniform(1.0, 1.2);
    if (!force) return axis;
    axis.mass = uniform(5.0, 100.0);
    axis.damping = one_of({0.0, uniform(0.0, 1.0) * axis.mass * acceleration / feed_, 10.0});
    if (chance(0.05)) axis.mass = 0.0, axis.damping = 10.0;
    axis.force_max = axis.mass * acceleration * uniform(1.0, 1.5) + axis.damping * feed_ * (chance(0.05) ? 0.9 : 1.0);
    if (power_) axis.power_max = axis.force_max * feed_ * uniform(0.4, 1.0) + axis.damping * feed_ * feed_;
    if (regeneration_) axis.regeneration_max = std::max(1.0, axis.mass * acceleration) * feed_ * uniform(0.2, 1.0);
    return axis;
  }

  void draw_axes() {
    const int count = is("axes") ? whole(1, 5) : 2;
    const bool alike = is("ties") || chance(0.3);
    for (int a = 0; a < count; ++a) {
      task_.machine.axes.push_back(a > 0 && alike ? task_.machine.axes[0] : axis());
      task_.machine.axes.back().name = "x" + std::to_string(a);
    }
  }

  CornerLegs legs(double& angle) {
    const int axes = static_cast<int>(task_.machine.axes.size());
    if (axes >= 2 && chance(0.7)) {
      const double degree = std::numbers::pi / 180.0;
      angle = degree * (slow_ ? uniform(60.0, 170.0) : one_of({uniform(5.0, 175.0), 15.0 * whole(1, 11)}));
      return PlanarLegs{angle, degree * one_of({0.0, 30.0, 45.0, 90.0, uniform(-180.0, 180.0)}),
                        chance(0.5) ? Turn::left : Turn::right};
    }
    for (;;) {
      DirectedLegs directed;
      double in = 0.0, out = 0.0, both = 0.0;
      for (int a = 0; a < axes; ++a) {
        directed.in.push_back(axes == 1 ? 1.0 : 0.1 * whole(-10, 10));
        directed.out.push_back(axes == 1 ? one_of({1.0, -1.0}) : 0.1 * whole(-10, 10));
        in += directed.in.back() * directed.in.back(), out += directed.out.back() * directed.out.back();
        both += directed.in.back() * directed.out.back();
      }
      if (in < 0.01 || out < 0.01) continue;
      angle = std::acos(std::clamp(-both / std::sqrt(in * out), -1.0, 1.0));
      if (!slow_ || angle > 1.0) return directed;
    }
  }

  void draw_corners() {
    const int count = is("in-position") && chance(0.2) ? 3 : several_ ? 2 : 1;
    for (int j = 0; j < count; ++j) {
      double angle = 0.0;
      const CornerLegs shape = legs(angle);
      const double in = feed_ * (j == 0 || (is("in-position") && chance(0.2)) ? 1.0 : uniform(0.4, 1.0));
      const double out = in * (chance(0.6) ? 1.0 : uniform(0.4, 1.0));
      TaskCorner corner(std::string(1, static_cast<char>('A' + j)), shape, in, out,
                        static_cast<int>(task_.machine.axes.size()));
      // The error of a moving average without delay, Eq. (6) of Shih, Chen and Lee, sets the scale.
      const double scale =
          in * samples_ * task_.sample_period / 4.0 * std::max(std::cos(angle / 2.0), 0.05) * (slow_ ? 4.0 : 1.0);
      if (is("fixed-delay") || (several_ && !is("in-position") && chance(0.1)))
        corner.delay = whole(0, 6);
      else
        corner.error_max = scale * (chance(0.03) ? 0.0 : uniform(0.05, 1.3));
      if (is("weighted") || several_) corner.weight = one_of({1.0, 1.0, 2.0, 5.0, 0.3});
      if (slow_) corner.speed_min = std::min(in, out) * uniform(0.02, 0.5);
      task_.corners.push_back(std::move(corner));
    }
  }

  void draw_filter() {
    FilterSpec spec;
    const int order = std::max(2, static_cast<int>(samples_ * uniform(1.2, 2.5)));
    spec.kind = Shape::boxcar, spec.order = order;
    if (chance(0.7)) {
      spec.kind = Shape::taps;
      for (int i = 0; i < order; ++i) spec.taps.push_back(chance(0.3) ? 0.0 : uniform(0.0, 1.0));
      spec.taps.push_back(1.0);
    }
    task_.filter = spec;
  }

  /// One width for all corners.
  void draw_in_position() {
    task_.settings.emplace();
    task_.settings->delays = {DelayKind::in_position};
    if (chance(0.2)) task_.settings->in_position_latency = whole(1, 3) * task_.sample_period;
  }

  /// The control's own, of taps that are not negative.
  void draw_smoothing() {
    std::vector<double>& taps = task_.machine.prefilter_taps;
    double sum = 0.0;
    for (int count = whole(2, 4); count > 0; --count) sum += taps.emplace_back(chance(0.2) ? 0.0 : uniform(0.1, 1.0));
    if (sum == 0.0) taps.front() = sum = 1.0;
    for (double& tap : taps) tap /= sum;
  }

  /// The same servo for every axis, and dry friction where no axis reverses.
  void draw_servo() {
    Axis servo;
    if (chance(0.4)) {
      servo.servo_gain = std::min(uniform(2.5, 8.0) / task_.sample_period, 1e4);
    } else {
      double sum = 0.0;
      for (int count = whole(2, 5); count > 0; --count)
        sum += servo.response_taps.emplace_back(chance(0.2) ? 0.0 : uniform(0.1, 1.0));
      if (sum == 0.0) servo.response_taps.front() = sum = 1.0;
      for (double& tap : servo.response_taps) tap /= sum;
    }
    for (std::size_t a = 0; a < task_.machine.axes.size(); ++a) {
      Axis& axis = task_.machine.axes[a];
      axis.servo_gain = servo.servo_gain, axis.response_taps = servo.response_taps;
      const bool reverses = std::ranges::any_of(task_.corners, [&](const TaskCorner& corner) {
        const auto i = static_cast<Eigen::Index>(a);
        return corner.geometry().direction_in[i] * corner.geometry().direction_out[i] < 0.0;
      });
      if (axis.force_max == unlimited || reverses || power_ || regeneration_ || !chance(0.4)) continue;
      axis.coulomb = uniform(0.02, 0.5) * axis.force_max;
      if (chance(0.7)) axis.force_max += axis.coulomb;
    }
  }

  std::string_view kind_;
  std::mt19937_64 random_;
  bool several_ = false, power_ = false, regeneration_ = false, slow_ = false;
  double feed_ = 0.0, samples_ = 0.0;
  Task task_;
};

}  // namespace

Task draw(std::string_view kind, std::uint64_t seed, std::uint64_t number) {
  return Draw(kind, seed, number).run();
}

}  // namespace accdec::attack
