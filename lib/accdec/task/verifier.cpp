#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <accdec/files/side_by_side.hpp>
#include <accdec/machine/limit_unit.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/machine/mode_text.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/task/corner_feed.hpp>
#include <accdec/task/objective.hpp>
#include <accdec/task/simulation.hpp>
#include <accdec/task/verification_cost.hpp>
#include <accdec/task/verified_axes.hpp>
#include <accdec/task/verified_contour.hpp>
#include <accdec/task/verified_vibration.hpp>
#include <accdec/verify.hpp>

namespace accdec {

namespace {

/// Distance from the corner point (origin) to the segment a-b.
double origin_to_segment(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  const double length2 = (b - a).squaredNorm();
  const double t = length2 > 0.0 ? std::clamp(-a.dot(b - a) / length2, 0.0, 1.0) : 0.0;
  return (a + t * (b - a)).norm();
}

/// The samples where a corner's limits are used most; k of its blend.
struct WorstSamples {
  int error = 0, speed = 0, contour = 0;
};

/// How far servos that differ keep the motion off the lines of both legs at the ends of the blend, where the feed is
/// constant. If a part of the feed passes the corner, the legs at their own feeds count, too.
/// @param lead  samples by which the feed is lowered before the corner, and raised behind it
std::array<double, 2> off_legs(const SampledMotion& m, const Corner& corner, int blend_end, int lead) {
  return {off_line(m.position, m.corner - lead, m.corner, corner.direction_in),
          off_line(m.position, blend_end, blend_end + lead, corner.direction_out)};
}

/// @param longer  samples by which the machine's response lengthens the motion  @param slow  lead of `off_legs`
CornerResult measure_samples(const SampledMotion& m, const TaskCorner& corner, int delay, int order, int longer,
                             int slow, double period, WorstSamples& worst) {
  CornerResult result;
  result.name = corner.name;
  result.delay = delay;
  result.corner_time = (order + 1 + delay) * period;
  const int last = m.corner + order + longer + delay + 1;
  ContourWatch contour(corner.geometry());
  result.corner_error = result.polyline_error = result.speed_min = unlimited;
  Eigen::VectorXd x = m.position.row(m.corner).transpose(), previous = x;
  for (int row = m.corner; row <= last; ++row) {
    x = m.position.row(row).transpose();
    const double distance = x.norm(), speed = m.velocity.row(row).norm();
    if (distance < result.corner_error) {
      result.corner_error = distance;
      worst.error = row - m.corner;
    }
    if (speed < result.speed_min) {
      result.speed_min = speed;
      worst.speed = row - m.corner;
    }
    contour.add(x, row - m.corner);
    if (row > m.corner) result.polyline_error = std::min(result.polyline_error, origin_to_segment(previous, x));
    previous = x;
  }
  result.contour_deviation = contour.deviation();
  worst.contour = contour.sample();
  const std::array off = off_legs(m, corner.geometry(), last, slow);
  for (const auto& [distance, row] : {std::pair{off[0], m.corner}, std::pair{off[1], last}}) {
    if (distance > result.contour_deviation) result.contour_deviation = distance, worst.contour = row - m.corner;
  }
  for (double* distance : {&result.corner_error, &result.polyline_error, &result.contour_deviation})
    *distance = judged_distance(*distance);
  return result;
}

/// How long after the end of the filtered command the motion still is farther from its end than the corner's tolerance:
/// 0 without a response or a tolerance.
double settling_time(const SampledMotion& m, const TaskCorner& corner, int order, int longer, double period) {
  if (longer == 0 || !corner.error_max) return 0.0;
  const Eigen::Index end = m.position.rows() - 1;
  const double within = std::max(*corner.error_max, position_floor);  // less cannot be told from nothing
  int samples = longer;
  while (samples > 0) {
    const Eigen::Index row = m.stop + order + samples;
    if ((m.position.row(row) - m.position.row(end)).norm() > within) break;
    --samples;
  }
  return samples * period;
}

/// Order of the filter behind the control's smoothing.
int command_order(const Filter& filter, const Machine& machine) {
  return filter.order() + std::max(0, static_cast<int>(machine.prefilter_taps.size()) - 1);
}

struct Measures {
  std::vector<LimitUse> uses;
  std::vector<CornerResult> corners;
};

void measure_corner(const Task& task, const Filter& filter, const TaskCorner& corner, int delay, double part,
                    Measures& out) {
  if (delay < 0) throw std::invalid_argument(fmt::format("corner {}: delay {} is negative", corner.name, delay));
  if (!(part > 0.0 && part <= 1.0))
    throw std::invalid_argument(fmt::format("corner {}: {} is no part of the feed", corner.name, part));
  const SampledResponse sampled =
      simulate_response(filter, corner.geometry(), delay, task.sample_period, task.machine, part);
  axis_uses(sampled, task.machine, corner.name, still_speed(corner.geometry()), out.uses);
  WorstSamples worst;
  const int lead = corner_feed_lead(filter.order(), sampled.longer);
  out.corners.push_back(measure_samples(sampled.motion(), corner, delay, filter.order(), sampled.longer,
                                        part < 1.0 ? lead : 0, task.sample_period, worst));
  out.corners.back().settling_time =
      settling_time(sampled.motion(), corner, filter.order(), sampled.longer, task.sample_period);
  out.corners.back().feed_part = part;
  out.corners.back().corner_time += corner_feed_loss(part, lead) * task.sample_period;
  const CornerResult& measured = out.corners.back();
  if (corner.error_max) {
    out.uses.push_back(make_use(LimitKind::corner_error, "", corner.name,
                                {measured.corner_error, Event::blend, worst.error}, *corner.error_max));
  }
  if (corner.speed_min > 0.0) {
    out.uses.push_back(make_use(LimitKind::speed_min, "", corner.name, {measured.speed_min, Event::blend, worst.speed},
                                corner.speed_min));
  }
  if (corner.contour_max) {
    out.uses.push_back(make_use(LimitKind::contour, "", corner.name,
                                {measured.contour_deviation, Event::blend, worst.contour}, *corner.contour_max));
  }
  for (const Mode& mode : task.machine.modes) {
    if (!mode.of_axis()) continue;
    out.uses.push_back(verified_residual(sampled.command, mode, task.machine, corner,
                                         command_order(filter, task.machine), delay, task.sample_period));
  }
}

double part_of(const std::vector<double>& parts, std::size_t j) {
  return parts.empty() ? 1.0 : parts[j];
}

/// Measures in the order of the corners; very many corners use all cores.
Measures measure_corners(const Task& task, const Filter& filter, const std::vector<int>& delays,
                         const std::vector<double>& feeds) {
  constexpr std::size_t part_size = 1000;
  std::vector<Measures> parts((delays.size() + part_size - 1) / part_size);
  const int threads = static_cast<int>(std::thread::hardware_concurrency());
  side_by_side(parts.size(), threads, [&](std::size_t part) {
    const std::size_t end = std::min(delays.size(), (part + 1) * part_size);
    for (std::size_t j = part * part_size; j < end; ++j)
      measure_corner(task, filter, task.corners[j], delays[j], part_of(feeds, j), parts[part]);
  });
  if (parts.size() == 1) return std::move(parts.front());
  Measures all;
  for (Measures& part : parts) {
    std::move(part.uses.begin(), part.uses.end(), std::back_inserter(all.uses));
    std::move(part.corners.begin(), part.corners.end(), std::back_inserter(all.corners));
  }
  return all;
}

/// The filter behind the control's smoothing.
Filter smoothed_filter(const Filter& filter, const Machine& machine) {
  if (machine.prefilter_taps.empty()) return filter;
  std::vector<double> taps(static_cast<std::size_t>(filter.order()) + machine.prefilter_taps.size(), 0.0);
  for (std::size_t j = 0; j < machine.prefilter_taps.size(); ++j) {
    for (int i = 0; i <= filter.order(); ++i)
      taps[static_cast<std::size_t>(i) + j] += filter.tap(i) * machine.prefilter_taps[j];
  }
  return Filter(std::move(taps));
}

}  // namespace

VerificationReport verify_by_simulation(const Task& task, const Filter& filter, const std::vector<int>& delays,
                                        std::vector<LimitUse>* limits, std::vector<CornerResult>* corners,
                                        const std::vector<double>& parts) {
  if (delays.size() != task.corners.size() || (!parts.empty() && parts.size() != delays.size())) {
    throw std::invalid_argument(fmt::format("{} delays for {} corners", delays.size(), task.corners.size()));
  }
  require_simulation_room(task, filter.order(), delays);
  auto [uses, measured] = measure_corners(task, filter, delays, parts);
  if (!task.machine.modes.empty()) {
    const Filter command = smoothed_filter(filter, task.machine);
    for (const Mode& mode : task.machine.modes) {
      if (!mode.of_axis()) uses.push_back(verified_vibration(command, mode, task.sample_period));
    }
  }

  VerificationReport report;
  report.performed = true;
  report.tolerance = verification_tolerance;
  report.feasible = true;
  const LimitUse* worst = nullptr;
  for (const LimitUse& use : uses) {
    report.feasible = report.feasible && granted(use.utilisation);
    if (worst == nullptr || use.utilisation > worst->utilisation) worst = &use;
  }
  if (worst != nullptr) {
    report.worst = describe(*worst);
    report.max_violation = std::max(0.0, worst->utilisation - 1.0);
  }
  if (limits != nullptr) *limits = std::move(uses);
  if (corners != nullptr) *corners = std::move(measured);
  return report;
}

Task corner_alone(const Task& task, const TaskCorner& corner) {
  Task alone;
  alone.sample_period = task.sample_period;
  alone.machine = task.machine;
  std::erase_if(alone.machine.modes, [](const Mode& mode) { return !mode.of_axis(); });
  alone.corners = {corner};
  return alone;
}

double value_where(const Task& task, const Filter& filter, const std::vector<int>& delays, const LimitUse& use,
                   const std::vector<double>& parts) {
  if (use.kind == LimitKind::vibration)
    return amplitude_left(smoothed_filter(filter, task.machine).taps(), use.frequency, use.damping, task.sample_period);
  for (std::size_t j = 0; j < task.corners.size(); ++j) {
    if (task.corners[j].name != use.corner) continue;
    const SampledResponse sampled = simulate_response(filter, task.corners[j].geometry(), delays[j], task.sample_period,
                                                      task.machine, part_of(parts, j));
    const SampledMotion& m = sampled.motion();
    const int zero = use.event == Event::start ? m.start : use.event == Event::blend ? m.corner : m.stop;
    const auto last = use.event == Event::start   ? m.cruise_in
                      : use.event == Event::blend ? m.cruise_out
                                                  : static_cast<int>(m.velocity.rows()) - 1;
    const int row = zero + static_cast<int>(use.sample);
    // A later sample belongs to the next event.
    if (use.event == Event::none || row < zero || row > last) break;
    if (use.kind == LimitKind::corner_error) return m.position.row(row).norm();
    if (use.kind == LimitKind::speed_min) return m.velocity.row(row).norm();
    if (use.kind == LimitKind::contour) {
      ContourWatch contour(task.corners[j].geometry());
      for (int at = row; at <= std::min<int>(row + 1, static_cast<int>(m.position.rows()) - 1); ++at)
        contour.add(m.position.row(at).transpose(), at);
      const int end = m.corner + filter.order() + sampled.longer + delays[j] + 1;
      const int lead = part_of(parts, j) < 1.0 ? corner_feed_lead(filter.order(), sampled.longer) : 0;
      const std::array off = off_legs(m, task.corners[j].geometry(), end, lead);
      return std::max({contour.deviation(), row == m.corner ? off[0] : 0.0, row == end ? off[1] : 0.0});
    }
    if (use.kind == LimitKind::residual) {
      std::size_t a = 0;
      while (a + 1 < task.machine.axes.size() && task.machine.axes[a].name != use.axis) ++a;
      return displacement_left(velocity_changes(sampled.command, use.event, a, command_order(filter, task.machine),
                                                delays[j], task.corners[j].geometry()),
                               use.frequency, use.damping, task.sample_period);
    }
    const double still = still_speed(task.corners[j].geometry());
    if (use.kind == LimitKind::power_total) return total_power(m, task.machine, row, still);
    if (use.kind == LimitKind::regeneration_total) return -total_power(m, task.machine, row, still);
    for (std::size_t a = 0; a < task.machine.axes.size(); ++a) {
      const Axis& axis = task.machine.axes[a];
      if (axis.name == use.axis)
        return axis_quantity(use.kind, sampled, axis, static_cast<Eigen::Index>(a), row, still);
    }
  }
  return std::numeric_limits<double>::quiet_NaN();
}

DesignResult assess(const Task& task, const Filter& filter, const std::vector<int>& delays, bool keep_broken,
                    const std::vector<double>& parts) {
  DesignResult result;
  result.task = task;
  result.verification = verify_by_simulation(task, filter, delays, &result.limits, &result.corners, parts);
  double lost = 0.0;  // s, at corners that are passed at a part of the feed
  for (std::size_t j = 0; j < parts.size(); ++j) {
    const int lead = corner_feed_lead(filter.order(), Response(task.machine, task.sample_period).order());
    lost += task.corners[j].weight * corner_feed_loss(parts[j], lead) * task.sample_period;
  }
  result.cycle_time = cycle_time(task, filter.order(), delays) + lost;
  result.corner_time = corner_time(task, filter.order(), delays) + lost;
  result.status = result.verification.feasible ? Status::feasible : Status::failed;
  if (!result.verification.feasible) {
    result.message = "a limit is broken: " + result.verification.worst;
    if (!keep_broken) {
      result.corners.clear();
      result.cycle_time = result.corner_time = 0.0;
      return result;
    }
  }
  result.filter = filter;
  return result;
}

DesignResult evaluate_task(const Task& task) {
  if (!task.filter) throw std::invalid_argument("evaluate needs a [filter] table; `accdec design` chooses one");
  std::vector<int> delays;
  for (const TaskCorner& corner : task.corners) {
    if (!corner.delay) {
      throw std::invalid_argument(
          fmt::format("corner {}: evaluate needs delay_samples; `accdec design` chooses it", corner.name));
    }
    delays.push_back(*corner.delay);
  }
  DesignResult result = assess(task, make_filter(*task.filter), delays, true);
  result.solver.method = "given";
  return result;
}

std::string describe(const LimitUse& use) {
  std::string text(limit_word(use.kind, use.axis));
  std::replace(text.begin(), text.end(), '_', ' ');
  if (!use.axis.empty()) text += " " + use.axis;
  const bool of_zero = use.utilisation >= unlimited;  // the bound is zero and the value is not, or a speed is zero
  const LimitUnit unit = limit_unit(use.kind, use.axis);
  if (!of_zero)
    text += fmt::format(": {:.1f} %", 100.0 * use.utilisation);
  else if (use.kind == LimitKind::vibration)
    text += fmt::format(": lets {:.3g} % of a mode through, which must be zero,", 100.0 * use.value);
  else if (use.kind == LimitKind::speed_min)
    text += fmt::format(": 0 {0}, which must be at least {1:.4g} {0},", unit.name, unit.per_si * use.bound);
  else
    text += fmt::format(": {:.4g} {}, which must be zero,", unit.per_si * use.value, unit.name);
  if (use.kind == LimitKind::vibration) return text + " " + place_of_vibration(use, 4);
  if (use.kind == LimitKind::residual)
    text += fmt::format(" {} behind the {}", place_of_vibration(use, 4), to_string(use.event));
  else
    text += fmt::format(" at k = {} of the {}", use.sample, to_string(use.event));
  if (!use.corner.empty()) text += ", corner " + use.corner;
  return text;
}

}  // namespace accdec
