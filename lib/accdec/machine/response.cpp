#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include <fmt/format.h>

#include <accdec/files/refused_key.hpp>
#include <accdec/machine/considered_by.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/motion/convolved.hpp>

namespace accdec {
namespace {

std::vector<double> of_gain(double gain, double feedforward, double period) {
  if (!(gain > 0.0) || !(feedforward >= 0.0 && feedforward <= 1.0))
    throw std::invalid_argument(
        fmt::format("a servo needs a gain above 0 and a feedforward of 0 .. 1, got {} and {}", gain, feedforward));
  const double length = response_length(gain, feedforward, period);
  if (!(length <= response_taps_max))
    throw std::invalid_argument(fmt::format("a servo of gain {:g} 1/s settles in {:.0f} samples, allowed are {}", gain,
                                            length, response_taps_max));
  const double x = gain * period, less = -std::expm1(-x);  // 1 - a
  const double c = (1.0 - feedforward) * less / x;
  std::vector<double> taps{1.0 - c};
  double rest = c;  // after the last tap
  while (rest >= response_rest) {
    taps.push_back(rest * less);
    rest -= taps.back();
  }
  taps.back() += rest;
  return taps;
}

std::vector<double> scaled(std::vector<double> taps) {
  const double sum = std::accumulate(taps.begin(), taps.end(), 0.0);
  if (!(std::abs(sum - 1.0) < 1e-6))
    throw std::invalid_argument(fmt::format("the taps of a response have the sum {:.10g}, allowed is 1", sum));
  for (double& tap : taps) tap /= sum;
  return taps;
}

/// Without negative taps, of the same sum.
std::vector<double> averaging(std::vector<double> taps) {
  for (double& tap : taps) tap = std::max(0.0, tap);
  const double sum = std::accumulate(taps.begin(), taps.end(), 0.0);
  for (double& tap : taps) tap /= sum;
  return taps;
}

bool has_servo(const Axis& axis) {
  return axis.servo_gain != unlimited || !axis.response_taps.empty();
}

std::vector<double> servo_of(const Axis& axis, double period) {
  if (!axis.response_taps.empty()) return scaled(axis.response_taps);
  return has_servo(axis) ? of_gain(axis.servo_gain, axis.velocity_feedforward, period) : std::vector{1.0};
}

}  // namespace

double response_length(double gain, double feedforward, double period) {
  const double x = gain * period, c = (1.0 - feedforward) * -std::expm1(-x) / x;
  return c <= response_rest ? 1.0 : 1.0 + std::max(1.0, std::log(c / response_rest) / x);
}

Response::Response(const Machine& machine, double period) {
  if (!machine.prefilter_taps.empty()) prefilter_ = scaled(machine.prefilter_taps);
  if (!has_servo(machine)) return;
  for (const Axis& axis : machine.axes) {
    // Axes mostly have the same servo.
    const bool same = !servo_.empty() && axis.servo_gain == machine.axes.front().servo_gain &&
                      axis.velocity_feedforward == machine.axes.front().velocity_feedforward &&
                      axis.response_taps == machine.axes.front().response_taps;
    servo_.push_back(same ? servo_.front() : servo_of(axis, period));
    const std::vector<double>& taps = servo_.back();
    // As proofs see it: equal taps of different gains, fed forward as a whole, count as different.
    averages_ = averages_ && std::all_of(taps.begin(), taps.end(), [](double tap) { return tap >= 0.0; });
    common_ = common_ && averages_ && (same || servo_.size() == 1);
    servo_order_ = std::max(servo_order_, static_cast<int>(taps.size()) - 1);
  }
}

Filter Response::command(const Filter& designed) const {
  return prefilter_.empty() ? designed : Filter(convolved(designed.taps(), prefilter_));
}

Filter Response::motion(const Filter& designed) const {
  if (!common_) throw std::logic_error("axes of different responses have no one filter");
  const Filter before = command(designed);
  return servo_.empty() ? before : Filter(convolved(before.taps(), servo_.front()));
}

Filter Response::motion(const Filter& designed, std::size_t axis) const {
  return Filter::of_any_sign(convolved(command(designed).taps(), servo(axis)));
}

FilterBehind::FilterBehind(const Filter& designed, const Machine& machine, double period) : designed_(designed) {
  const Response response(machine, period);
  if (response.ideal()) return;
  command_ = response.command(designed);
  const bool differ = servos_differ(machine);
  for (std::size_t a = 0; a < (differ ? machine.axes.size() : 1); ++a) {
    motions_.push_back(response.motion(designed, a));
    double sum = 0.0;
    for (const double tap : response.servo(a)) sum += std::abs(tap);
    gain_ = std::max(gain_, response.averages() ? 1.0 : sum);
  }
  if (!differ && response.averages()) return;
  const auto slowest = std::ranges::max_element(motions_, {}, &Filter::mean_delay) - motions_.begin();
  alike_ = Filter(convolved(command_->taps(), averaging(response.servo(static_cast<std::size_t>(slowest)))));
}

int FilterBehind::longest_order() const {
  int order = designed_.order();
  for (const Filter& motion : motions_) order = std::max(order, motion.order());
  return order;
}

int FilterBehind::felt_order() const {
  int order = motion().order();
  while (!ideal() && order > command().order() && motion().remaining(order) < 1e-4) --order;
  return order;
}

bool has_servo(const Machine& machine) {
  return std::any_of(machine.axes.begin(), machine.axes.end(), [](const Axis& axis) { return has_servo(axis); });
}

bool servos_differ(const Machine& machine) {
  return std::any_of(machine.axes.begin(), machine.axes.end(), [&](const Axis& axis) {
    const Axis& first = machine.axes.front();
    return axis.servo_gain != first.servo_gain || axis.velocity_feedforward != first.velocity_feedforward ||
           axis.response_taps != first.response_taps;
  });
}

Axis averaging(Axis axis) {
  axis.response_taps = averaging(std::move(axis.response_taps));
  return axis;
}

void give_slowest_servo(Machine& machine, double period) {
  if (!servos_differ(machine)) return;
  const auto lag = [&](const Axis& axis) {
    double samples = 0.0, number = 0.0;
    for (const double tap : servo_of(axis, period)) samples += tap * number++;
    return samples;
  };
  const Axis slowest = *std::ranges::max_element(machine.axes, {}, lag);
  for (Axis& axis : machine.axes) {
    axis.servo_gain = slowest.servo_gain, axis.velocity_feedforward = slowest.velocity_feedforward;
    axis.response_taps = slowest.response_taps;
  }
}

void require_no_servo(const Machine& machine, const char* what, std::string_view instead) {
  if (!has_servo(machine)) return;
  throw RefusedKey(
      fmt::format("{} does not consider the servo of an axis (servo_gain_1_s, response_taps); {}", what, instead),
      {"servo_gain_1_s", "response_taps"});
}

void require_no_response(const Machine& machine, const char* what, std::string_view instead) {
  require_no_servo(machine, what, instead);
  if (machine.prefilter_taps.empty()) return;
  throw RefusedKey(fmt::format("{} does not consider the control's prefilter_taps; {}", what, instead),
                   {"prefilter_taps"});
}

}  // namespace accdec
