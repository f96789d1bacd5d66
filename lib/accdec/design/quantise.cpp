#include <algorithm>
#include <chrono>
#include <cmath>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include <accdec/design/anytime.hpp>
#include <accdec/design/quantise.hpp>
#include <accdec/design/taps_of_kinds.hpp>
#include <accdec/files.hpp>
#include <accdec/machine/limit_unit.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// Limits less the largest change that rounding the taps' cumulative sums to multiples of `unit` makes, times `part`.
/// A sum is off by unit/2, a tap by one unit, a difference of two by two.
Task tightened(Task task, double unit, double part, int order) {
  const double period = task.sample_period;
  // Below a tenth, a limit says nothing any more of the filters that hold it.
  const auto lower = [&](double& bound, double effect) {
    if (bound < unlimited) bound = std::max(0.1 * bound, bound - part * effect);
  };
  double supply = 0.0, fastest = 0.0;
  for (std::size_t a = 0; a < task.machine.axes.size(); ++a) {
    Axis& axis = task.machine.axes[a];
    double speed = 0.0;  // both legs together
    for (const TaskCorner& corner : task.corners) {
      const Corner& legs = corner.geometry();
      const auto i = static_cast<Eigen::Index>(a);
      speed = std::max(speed,
                       legs.feed_in * std::abs(legs.direction_in[i]) + legs.feed_out * std::abs(legs.direction_out[i]));
    }
    const double velocity = 0.5 * speed * unit, acceleration = speed * unit / period;
    const double force = axis.mass * acceleration + axis.damping * velocity;
    const double most = axis.force_max < unlimited ? axis.force_max : axis.damping * speed;
    lower(axis.acceleration_max, acceleration);
    lower(axis.jerk_max, 2.0 * acceleration / period);
    lower(axis.power_max, force * speed + most * velocity);
    lower(axis.regeneration_max, force * speed + most * velocity);
    lower(axis.force_max, force);
    lower(axis.force_speed_max, force);
    supply += force * speed + most * velocity;
    fastest = std::max(fastest, speed);
  }
  lower(task.machine.power_total_max, supply);
  lower(task.machine.regeneration_total_max, supply);
  for (Mode& mode : task.machine.modes) {
    const double ratio = 0.5 * unit * (order + 1) * std::min(2.0, 2.0 * M_PI * mode.frequency_high * period);
    lower(mode.residual_max, ratio);
    lower(mode.displacement_max, ratio * fastest / (2.0 * M_PI * mode.frequency_low));
  }
  for (TaskCorner& corner : task.corners) {
    const double speed = corner.geometry().feed_in + corner.geometry().feed_out;
    if (corner.error_max) lower(*corner.error_max, 0.25 * unit * order * speed * period);
    if (corner.contour_max) lower(*corner.contour_max, 0.25 * unit * order * speed * period);
    if (corner.speed_min > 0.0) corner.speed_min += part * 0.5 * unit * speed;
  }
  return task;
}

/// The speeds of an axis on all legs, m/s; each leg is started or stopped by itself.
std::vector<double> leg_speeds(const Task& task, std::size_t axis) {
  const auto a = static_cast<Eigen::Index>(axis);
  std::vector<double> speeds;
  for (const TaskCorner& corner : task.corners) {
    const Corner& legs = corner.geometry();
    for (const double speed :
         {legs.feed_in * std::abs(legs.direction_in[a]), legs.feed_out * std::abs(legs.direction_out[a])})
      if (speed > 1e-9) speeds.push_back(speed);
  }
  return speeds;
}

/// Limits of acceleration and jerk that whole coefficients can reach: a tap, or a step between two, of so many units.
Task snapped(Task task, double unit) {
  const double period = task.sample_period;
  for (std::size_t a = 0; a < task.machine.axes.size(); ++a) {
    Axis& axis = task.machine.axes[a];
    double acceleration = axis.acceleration_max, jerk = axis.jerk_max;
    for (const double speed : leg_speeds(task, a)) {
      const auto lower = [](double& bound, double limit, double effect) {
        const double units = std::floor(limit / effect * (1.0 + 1e-9));
        if (units >= 1.0 && units < 1e12) bound = std::min(bound, units * effect);
      };
      lower(acceleration, axis.acceleration_max, speed * unit / period);
      lower(jerk, axis.jerk_max, speed * unit / (period * period));
    }
    axis.acceleration_max = acceleration, axis.jerk_max = jerk;
  }
  return task;
}

/// Why no taps of these bits hold the limits: the first tap has one unit or more. Empty if that is no reason.
std::string too_coarse(const Task& task, double unit) {
  const double period = task.sample_period;
  for (std::size_t a = 0; a < task.machine.axes.size(); ++a) {
    const Axis& axis = task.machine.axes[a];
    for (const double speed : leg_speeds(task, a)) {
      for (const auto& [kind, bound, effect] :
           {std::tuple(LimitKind::acceleration, axis.acceleration_max, speed / period),
            std::tuple(LimitKind::jerk, axis.jerk_max, speed / (period * period))}) {
        if (effect * unit <= bound * (1.0 + 1e-6)) continue;
        return fmt::format(
            "one unit of {} bits is a tap whose {} on axis {} is {:.6g} {}, above the limit; at least "
            "{:.0f} bits are needed",
            task.design.coefficient_bits, to_string(kind), axis.name,
            limit_unit(kind, axis.name).per_si * effect * unit, limit_unit(kind, axis.name).name,
            std::ceil(std::log2(effect / bound)));
      }
    }
  }
  return "";
}

/// Whether corners of a proof have the delays of a result, or any. For a control of one kind of delay, the proof of
/// free taps is about the delays that they have.
bool about_these_delays(const std::vector<TaskCorner>& proved, const DesignResult& result) {
  for (std::size_t j = 0; j < result.corners.size(); ++j) {
    if (proved[j].delay.value_or(result.corners[j].delay) != result.corners[j].delay) return false;
  }
  return true;
}

/// Without zeros at the ends, which only make a filter longer.
Coefficients trimmed(Coefficients c, const DesignBounds& bounds) {
  const auto least = static_cast<std::size_t>(bounds.order_min) + 1;
  const auto drop_last = [&](bool both) {
    while (c.size() > least + (both ? 1 : 0) && c.back() == 0 && (!both || c.front() == 0)) {
      c.pop_back();
      if (both) c.erase(c.begin());
    }
  };
  drop_last(bounds.symmetric);
  if (bounds.symmetric) return c;
  std::reverse(c.begin(), c.end());
  drop_last(false);
  std::reverse(c.begin(), c.end());
  return c;
}

class QuantisedDesign {
 public:
  QuantisedDesign(const Task& task, const DesignOptions& options)
      : task_(task), options_(options), bits_(task.design.coefficient_bits), unit_(std::ldexp(1.0, -bits_)) {}

  DesignResult run() {
    if (std::string why = too_coarse(task_, unit_); !why.empty()) {
      free_.task = task_, free_.message = std::move(why);
      return std::move(free_);
    }
    Task free = task_;
    free.design.coefficient_bits = 0;
    DesignOptions share = options_;
    share.time_limit *= 0.5;
    free_ = design_task(free, share);
    proved_of_ = std::exchange(free_.task, task_).corners;
    if (!free_.has_design()) return std::move(free_);
    tell(fmt::format("free taps take {:.6g} ms; rounding to {} bits", 1e3 * free_.objective(), bits_));
    for (const CornerResult& corner : free_.corners) delays_.push_back(corner.delay);
    look();
    return finish();
  }

 private:
  bool late() const {
    return seconds_since(began_) > options_.time_limit || (options_.cancel != nullptr && options_.cancel->load());
  }
  void tell(const std::string& line) const {
    if (options_.progress) options_.progress(line);
  }
  bool lossless() const { return best_ && best_->objective() <= free_.objective() * (1.0 + 1e-12); }

  void look() {
    const int order = free_.filter->order();
    offer(*free_.filter, delays_);
    for (const double part : parts) {
      if (lossless() || late()) return;
      at_order(order, part);
    }
    for (const double part : parts) {
      if (lossless() || late()) return;
      offer_design_of(with_room(part, order));
    }
    // Little is left to gain otherwise.
    const auto much_lost = [&] { return !best_ || best_->objective() > 1.05 * free_.objective(); };
    if (much_lost()) powers_of_two({}, bits_);
    // Each longer filter has a little more room, and takes longer.
    const int most = std::min(task_.design.order_max, order + std::max(8, order / 2));
    bool held = !much_lost();
    for (int longer = order + 1; longer <= most && !held; ++longer) {
      for (const double part : parts) {
        if (held || late()) break;
        held = at_order(longer, part);
      }
    }
    shorten_delays();
  }

  /// Averages whose lengths are powers of two have whole coefficients, however few the bits are. The longest first.
  /// @param most  exponent that the lengths together may have
  void powers_of_two(const std::vector<int>& lengths, int most) {
    constexpr std::size_t stages = 3;
    if (!lengths.empty()) {
      FilterSpec spec{.kind = Shape::averages, .lengths = lengths};
      for (const int length : lengths) spec.order += length - 1;
      if (spec.order > task_.design.order_max) return;
      if (spec.order >= task_.design.order_min) {
        const Filter filter = make_filter(spec);
        offer(filter, smallest_delays(filter, delays_));
      }
    }
    if (lengths.size() == stages) return;
    for (int exponent = 1; exponent <= most && (lengths.empty() || 1 << exponent <= lengths.back()); ++exponent) {
      if (late()) return;
      std::vector<int> longer = lengths;
      longer.push_back(1 << exponent);
      powers_of_two(longer, most - exponent);
    }
  }

  /// Neighbours of the best coefficients that hold the limits at shorter delays.
  void shorten_delays() {
    for (bool better = best_.has_value(); better;) {
      better = false;
      for (std::size_t j = 0; j < delays_.size() && !lossless() && !late(); ++j) {
        std::vector<int> delays;
        for (const CornerResult& corner : best_->corners) delays.push_back(corner.delay);
        if (delays[j] == 0 || task_.corners[j].delay) continue;
        --delays[j];
        const double before = best_->objective();
        const Filter filter = *best_->filter;
        offer(filter, delays);
        better = better || best_->objective() < before;
      }
    }
  }

  Task with_room(double part, int order) const {
    return part > 0.0 ? tightened(task_, unit_, part, order) : snapped(task_, unit_);
  }

  /// With limits that leave room, at this order and the delays of free taps. @return whether such a filter holds
  bool at_order(int order, double part) {
    Task task = with_room(part, order);
    task.design.order_min = task.design.order_max = order;
    task.settings.reset();
    for (std::size_t j = 0; j < delays_.size(); ++j) task.corners[j].delay = delays_[j];
    return offer_design_of(std::move(task));
  }

  bool offer_design_of(Task task) {
    task.design.coefficient_bits = 0;
    DesignOptions options = options_;
    options.exact.certificate = false;
    options.time_limit = 0.25 * std::max(0.05, options_.time_limit - seconds_since(began_));
    const DesignResult room = design_task(task, options);
    if (!room.has_design()) return false;
    if (best_ && room.objective() >= best_->objective() * (1.0 - 1e-12)) return true;
    std::vector<int> delays;
    for (const CornerResult& corner : room.corners) delays.push_back(corner.delay);
    return offer(*room.filter, delays);
  }

  /// @return whether these taps hold the limits when rounded
  bool offer(const Filter& filter, const std::vector<int>& delays) {
    // A simulation takes O(N^2).
    const double size = 1.0 + 0.03 * filter.order();
    long left = static_cast<long>(exchanges_max / (size * size));
    const auto stop = [&] { return --left < 0 || late(); };
    auto rounded = round_under_limits(task_, filter, delays, bits_, stop);
    if (!rounded) return false;
    rounded = trimmed(std::move(*rounded), task_.design);
    const Filter quantised = filter_of_coefficients(*rounded);
    DesignResult found =
        task_.settings ? with_kinds(quantised) : assess(task_, quantised, smallest_delays(quantised, delays), false);
    if (!found.has_design() || (best_ && !(found.objective() < best_->objective()))) return found.has_design();
    found.quantisation = Quantisation{bits_, *rounded, 0.0};
    best_ = std::move(found);
    return true;
  }

  std::vector<int> smallest_delays(const Filter& filter, const std::vector<int>& known) const {
    Task given = task_;
    given.design.coefficient_bits = 0;
    given.filter = FilterSpec{.kind = Shape::taps, .taps = {filter.taps().begin(), filter.taps().end()}};
    DesignOptions options;
    options.time_limit = std::max(0.05, 0.25 * (options_.time_limit - seconds_since(began_)));
    const DesignResult found = design_delays(given, options);
    if (!found.has_design()) return known;
    std::vector<int> delays;
    for (const CornerResult& corner : found.corners) delays.push_back(corner.delay);
    return delays;
  }

  /// With the cheapest delays of the kinds that the control has.
  DesignResult with_kinds(const Filter& filter) const {
    DesignResult found = with_delays_of_kinds(task_, as_settings(filter), unlimited, [this] { return late(); });
    if (!free_.settings) found.settings.reset();
    return found;
  }

  StopReason reason() const {
    if (options_.cancel != nullptr && options_.cancel->load()) return StopReason::interrupted;
    return late() ? StopReason::time_limit : StopReason::finished;
  }

  DesignResult finish() {
    DesignResult result;
    if (!best_) {
      result.task = task_;
      result.status = Status::failed;
      result.stop = reason();
      result.message = fmt::format(
          "no coefficients of {} bits were found that hold all limits; free taps hold them in {:.6g} ms. Allow more "
          "bits or wider limits",
          bits_, 1e3 * free_.objective());
    } else {
      result = std::move(*best_);
      result.stop = free_.stop == StopReason::finished ? reason() : free_.stop, result.message = free_.message;
      result.quantisation->unquantised = std::min(free_.objective(), result.objective());
    }
    if (about_these_delays(proved_of_, result)) {
      result.task.corners = proved_of_;
      result.lower_bound = free_.lower_bound;
      result.certificate = free_.certificate;
    }
    result.solver = free_.solver;
    result.solver.wall_time = seconds_since(began_);
    if (result.has_design()) judge_gap(result);
    return result;
  }

  /// Parts of the largest effect of a rounding; less than all of it is often enough. 0: limits snapped to whole units.
  static constexpr double parts[] = {1.0, 0.5, 0.25, 0.0};
  /// Filters that one rounding may try: below a second for a few hundred taps.
  static constexpr long exchanges_max = 20'000;

  const Task& task_;
  const DesignOptions& options_;
  int bits_;
  double unit_;
  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
  DesignResult free_;
  std::vector<TaskCorner> proved_of_;
  std::vector<int> delays_;
  std::optional<DesignResult> best_;
};

}  // namespace

DesignResult design_quantised(const Task& task, const DesignOptions& options) {
  return QuantisedDesign(task, options).run();
}

}  // namespace accdec
