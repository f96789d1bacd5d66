#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include <accdec/design/design_settings.hpp>
#include <accdec/files/units.hpp>
#include <accdec/machine.hpp>
#include <accdec/machine/limit_unit.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/machine/signed_value.hpp>
#include <accdec/plot/figure_style.hpp>
#include <accdec/plot/filter_panels.hpp>
#include <accdec/plot/path_panels.hpp>
#include <accdec/plot/plot_result.hpp>
#include <accdec/plot/quantity_panel.hpp>
#include <accdec/plot/shown_time.hpp>

namespace accdec {
namespace {

using namespace figure_style;

/// The use of a limit that is a curve of force by speed is drawn in percent.
LimitUnit drawn_unit(LimitKind kind, std::string_view axis) {
  return kind == LimitKind::force_speed ? LimitUnit{"%", 1.0} : limit_unit(kind, axis);
}

/// Regeneration is the lower bound of power.
Bounds bounds_of(const Axis& axis, LimitKind kind) {
  if (kind == LimitKind::power) return {-axis.regeneration_max, axis.power_max};
  const double bound = axis.*axis_limit(kind).bound;
  if (kind == LimitKind::force_speed) return {-unlimited, bound < unlimited ? 100.0 : unlimited};
  return {-bound, bound};
}

/// A quantity of an axis over time, in the unit it is drawn in: velocity, acceleration and jerk of the command, loads
/// of the motion.
Series curve_of(LimitKind kind, const CornerMotion& at, std::size_t axis) {
  const auto column = static_cast<Eigen::Index>(axis);
  const SampledMotion& motion = at.motion;
  const double still = still_part * std::max(motion.velocity.row(motion.cruise_in).norm(),
                                             motion.velocity.row(motion.cruise_out).norm());
  AxisSampler sampler(at.result.task.machine.axes[axis], at.result.task.sample_period, still);
  const Axis& moved = at.result.task.machine.axes[axis];
  const double factor =
      kind == LimitKind::force_speed ? 100.0 / moved.force_speed_max : limit_unit(kind, moved.name).per_si;
  Series curve{"", at.time, {}, kind == LimitKind::velocity ? Mark::line : Mark::steps, design_style, true};
  for (Eigen::Index n = 0; n < at.motion.velocity.rows(); ++n) {
    const SampledMotion& command = at.sampled.command;
    const AxisState state = with_load(sampler.next(command.velocity(n, column), command.acceleration(n, column)),
                                      at.result.task.machine.axes[axis], at.motion.velocity(n, column),
                                      at.motion.acceleration(n, column), still);
    curve.y.push_back(signed_value(state, kind) * factor);
  }
  return curve;
}

/// An empty panel over the time in which the design or the filter of today moves.
Panel time_panel(const CornerMotion& now, const CornerMotion* before) {
  Panel panel;
  panel.x.label = "time from the corner command / ms";
  std::tie(panel.x.min, panel.x.max) = ShownTime(now, before).range();
  return panel;
}

Series speed_series(const CornerMotion& at, std::string label, int style) {
  Series speed{std::move(label), at.time, {}, Mark::line, style, true};
  for (Eigen::Index n = 0; n < at.motion.velocity.rows(); ++n)
    speed.y.push_back(1e3 * at.motion.velocity.row(n).norm());
  return speed;
}

/// The speed along the path, with the smallest one allowed at the corner.
void add_speed(Panel& panel, const CornerMotion& now, const CornerMotion* before) {
  if (before)
    panel.series.insert(panel.series.begin(), speed_series(*before, "speed today", baseline_style + thin_style));
  panel.series.insert(panel.series.begin() + (before ? 1 : 0), speed_series(now, "speed", speed_style));
  const LimitUse* use = use_of(now.result, LimitKind::speed_min, now.task.name);
  if (!use) return;
  panel.title += "; smallest speed:" + use_in_title(*use);
  panel.limits.push_back({1e3 * use->bound, "smallest allowed"});
  const auto row = static_cast<std::size_t>(now.motion.corner + use->sample);
  const bool binds = use->utilisation > binding;
  if (row < now.time.size())
    panel.series.push_back(
        {binds ? "binds" : "smallest", {now.time[row]}, {1e3 * use->value}, Mark::points, binds ? binding_style : 0});
}

/// One quantity of the axes that move: velocity and acceleration of all, others of those with a limit. None without.
/// @param like  the name of an axis: those that turn have units of their own
std::optional<Panel> motion_panel(LimitKind kind, std::string_view like, const CornerMotion& now,
                                  const CornerMotion* before) {
  const std::vector<Axis>& axes = now.result.task.machine.axes;
  const LimitUnit unit = drawn_unit(kind, like);
  QuantityPanel panel(unit, kind == LimitKind::force_speed ? "use of the force-speed curve" : limit_word(kind, like),
                      time_panel(now, before));
  std::vector<Series> moved;
  int moving = -1;  // an axis has its dashes in every panel
  bool drawn = false;
  for (std::size_t axis = 0; axis < axes.size(); ++axis) {
    const auto a = static_cast<Eigen::Index>(axis);
    const Corner& legs = now.task.geometry();
    const Bounds bounds = bounds_of(axes[axis], kind);
    if (std::abs(legs.direction_in[a]) <= 1e-12 && std::abs(legs.direction_out[a]) <= 1e-12) continue;
    ++moving;
    const bool always = kind == LimitKind::velocity || kind == LimitKind::acceleration;
    if (is_rotary(axes[axis].name) != is_rotary(like) || (!always && !bounds.any())) continue;
    drawn = true;
    const std::optional<Series> old = before ? std::optional(curve_of(kind, *before, axis)) : std::nullopt;
    panel.add(axes[axis].name, moving, curve_of(kind, now, axis), old ? &*old : nullptr, bounds);
    if (now.sampled.moved && kind == LimitKind::velocity) {
      moved.push_back({axes[axis].name + " motion", now.time, {}, Mark::line, thin_style, true, moving});
      for (const double v : now.motion.velocity.col(a)) moved.back().y.push_back(v * unit.per_si);
    }
  }
  if (!drawn) return {};
  Panel made = panel.finished();
  std::move(moved.begin(), moved.end(), std::back_inserter(made.series));
  return made;
}

/// The power of all axes together, on which a machine may have limits of its own.
Panel total_power_panel(const CornerMotion& now, const CornerMotion* before) {
  const Machine& machine = now.result.task.machine;
  const auto total = [&](const CornerMotion& at) {
    Series sum = curve_of(LimitKind::power, at, 0);
    for (std::size_t axis = 1; axis < machine.axes.size(); ++axis) {
      const Series more = curve_of(LimitKind::power, at, axis);
      for (std::size_t n = 0; n < sum.y.size(); ++n) sum.y[n] += more.y[n];
    }
    return sum;
  };
  QuantityPanel panel(limit_unit(LimitKind::power, ""), "power of all axes", time_panel(now, before));
  const std::optional<Series> old = before ? std::optional(total(*before)) : std::nullopt;
  panel.add("", 0, total(now), old ? &*old : nullptr, {-machine.regeneration_total_max, machine.power_total_max});
  return panel.finished();
}

/// Every quantity over time, in the order of the table of limits.
std::vector<Panel> motion_panels(const CornerMotion& now, const CornerMotion* before) {
  std::vector<Panel> panels;
  for (const AxisLimit& limit : axis_limits) {
    if (limit.kind == LimitKind::regeneration) continue;  // drawn as power
    for (const std::string_view like : {"x", "a"}) {
      if (std::optional<Panel> panel = motion_panel(limit.kind, like, now, before)) panels.push_back(*std::move(panel));
    }
    if (limit.kind == LimitKind::velocity && !panels.empty()) add_speed(panels.front(), now, before);
  }
  if (limits_supply(now.result.task.machine)) panels.push_back(total_power_panel(now, before));
  return panels;
}

/// Two columns: one until it ends, beside the other.
std::vector<Panel> side_by_side(std::vector<Panel> left, std::vector<Panel> right) {
  std::vector<Panel> panels;
  for (std::size_t i = 0; i < std::max(left.size(), right.size()); ++i) {
    for (std::vector<Panel>* column : {&left, &right})
      if (i < column->size()) panels.push_back(std::move((*column)[i]));
  }
  return panels;
}

/// The task with the filter of today, its delays as small as they can be; without a filter if it breaks a limit.
std::optional<DesignResult> today(const DesignResult& result) {
  if (!result.task.baseline) return {};
  Task task = result.task;
  task.filter = std::exchange(task.baseline, {});
  DesignResult made = design_given(std::move(task));
  if (made.status != Status::optimal && made.status != Status::feasible) made.filter.reset();
  return made;
}

/// Time, what it saves against today, and the corner.
std::string title_of(const DesignResult& result, const DesignResult* before, const CornerResult& corner) {
  std::string title =
      fmt::format("{}: {:.6g} ms", result.task.title.empty() ? "accdec" : result.task.title, 1e3 * result.objective());
  if (before && !before->filter) {
    title +=
        before->status == Status::infeasible ? "; today's filter breaks a limit" : "; today's filter has no answer";
  } else if (before) {
    const double saved = before->objective() - result.objective();
    title += std::abs(saved) < 1e-9
                 ? " designed, as long as today"
                 : fmt::format(" designed, {:.4g} ms {} than today's {:.6g} ms", 1e3 * std::abs(saved),
                               saved < 0.0 ? "more" : "less", 1e3 * before->objective());
  }
  return title + fmt::format("; corner {}, delay {} samples", corner.name, corner.delay);
}

/// Reduces a long curve to its ends and the extremes of as many pieces as a drawing can show.
void thin_out(Series& series) {
  constexpr std::size_t pieces = 2000;
  const std::size_t count = series.x.size();
  if (count <= 8 * pieces) return;
  Series thin = series;
  thin.x.clear(), thin.y.clear();
  for (std::size_t p = 0; p < pieces; ++p) {
    const std::size_t first = count * p / pieces, last = count * (p + 1) / pieces - 1;
    const auto at = [](const std::vector<double>& v, std::size_t i) {
      return v.begin() + static_cast<std::ptrdiff_t>(i);
    };
    std::vector<std::size_t> kept{first, last};
    for (const std::vector<double>* v : {&series.x, &series.y}) {
      const auto [low, high] = std::minmax_element(at(*v, first), at(*v, last + 1));
      kept.push_back(static_cast<std::size_t>(low - v->begin()));
      kept.push_back(static_cast<std::size_t>(high - v->begin()));
    }
    std::sort(kept.begin(), kept.end());
    kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
    for (const std::size_t i : kept) thin.x.push_back(series.x[i]), thin.y.push_back(series.y[i]);
  }
  series = std::move(thin);
}

std::size_t find_corner(const DesignResult& result, const std::string& name) {
  const auto& corners = result.task.corners;
  std::string known;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (name.empty() || corners[i].name == name) return i;
    known += (known.empty() ? "" : ", ") + corners[i].name;
  }
  throw std::invalid_argument(
      fmt::format("the result has no corner \"{}\"; it has: {}", name, known.empty() ? "none" : known));
}

}  // namespace

Figure plot_result(const DesignResult& result, const std::string& corner) {
  const std::size_t index = find_corner(result, corner);
  if (!result.filter || index >= result.corners.size()) {
    throw std::runtime_error(
        fmt::format("the result holds no filter to draw ({}): {}", to_string(result.status), result.message));
  }
  const std::optional<DesignResult> old = today(result);
  const Filter* const old_filter = old && old->filter ? &*old->filter : nullptr;
  const CornerMotion now(result, index);
  std::optional<CornerMotion> then;
  if (old_filter) then.emplace(*old, index);
  const CornerMotion* const before = then ? &*then : nullptr;

  Figure figure;
  figure.title = title_of(result, old ? &*old : nullptr, now.measures);
  figure.columns = 2;
  figure.one_legend = true;
  std::vector<Panel> left{path_panel(now, before)};
  // A motion that stays on its path has no distance to draw.
  if (std::optional<Panel> distance = distance_panel(now, before)) left.push_back(*std::move(distance));
  left.push_back(response_panel(result, old_filter));
  left.push_back(taps_panel(*result.filter, old_filter));
  std::vector<Panel> right = motion_panels(now, before);
  const ShownTime time(now, before);
  for (Panel& panel : right) time.move_together(panel);
  if (time.shortened()) figure.title += "; steady parts of the legs are left out";
  figure.panels = side_by_side(std::move(left), std::move(right));
  for (Panel& panel : figure.panels) {
    for (Series& series : panel.series) thin_out(series);
  }
  return figure;
}

}  // namespace accdec
