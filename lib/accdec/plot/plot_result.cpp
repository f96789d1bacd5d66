#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include <accdec/design.hpp>
#include <accdec/machine.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/machine/signed_value.hpp>
#include <accdec/plot/figure_style.hpp>
#include <accdec/plot/filter_panels.hpp>
#include <accdec/plot/path_panels.hpp>
#include <accdec/plot/plot_result.hpp>

namespace accdec {
namespace {

using namespace figure_style;

/// A quantity of an axis with the bounds on it; both in SI.
struct Quantity {
  LimitKind kind;
  double low, high;
};

/// Quantities to draw for an axis: always velocity and acceleration, the others if they are limited. Regeneration is
/// the lower bound of power.
std::vector<Quantity> quantities_of(const Axis& axis) {
  std::vector<Quantity> drawn;
  for (const AxisLimit& limit : axis_limits) {
    const double bound = axis.*limit.bound;
    if (limit.kind == LimitKind::regeneration) {
      if (!(bound < unlimited)) continue;
      if (drawn.back().kind == LimitKind::power) {
        drawn.back().low = -bound;
      } else {
        drawn.push_back({LimitKind::power, -bound, unlimited});
      }
      continue;
    }
    const bool always = limit.kind == LimitKind::velocity || limit.kind == LimitKind::acceleration;
    if (!always && !(bound < unlimited)) continue;
    const bool above = limit.kind == LimitKind::power || limit.kind == LimitKind::force_speed;
    drawn.push_back({limit.kind, above ? -unlimited : -bound, bound});
  }
  return drawn;
}

/// "mm/s^3" as it is printed: "(mm/s³)".
std::string printed_unit(std::string_view unit) {
  std::string text(unit);
  for (const auto& [plain, printed] : {std::pair<std::string_view, std::string_view>{"^2", "²"}, {"^3", "³"}}) {
    if (const auto at = text.find(plain); at != std::string::npos) text.replace(at, plain.size(), printed);
  }
  return text.find('/') == std::string::npos ? text : "(" + text + ")";
}

/// A quantity of an axis over time, in the unit it is drawn in: velocity, acceleration and jerk of the command, loads
/// of the motion.
Series curve_of(const Quantity& quantity, const CornerMotion& at, std::size_t axis) {
  const auto column = static_cast<Eigen::Index>(axis);
  const SampledMotion& motion = at.motion;
  const double still = still_part * std::max(motion.velocity.row(motion.cruise_in).norm(),
                                             motion.velocity.row(motion.cruise_out).norm());
  AxisSampler sampler(at.result.task.machine.axes[axis], at.result.task.sample_period, still);
  Series curve{"", at.time, {}, quantity.kind == LimitKind::velocity ? Mark::line : Mark::steps, design_style, true};
  for (Eigen::Index n = 0; n < at.motion.velocity.rows(); ++n) {
    const SampledMotion& command = at.sampled.command;
    const AxisState state = with_load(sampler.next(command.velocity(n, column), command.acceleration(n, column)),
                                      at.result.task.machine.axes[axis], at.motion.velocity(n, column),
                                      at.motion.acceleration(n, column), still);
    curve.y.push_back(signed_value(state, quantity.kind) * limit_name(quantity.kind).per_si);
  }
  return curve;
}

/// The limit itself, drawn over every sample that reaches it: the upper and the lower one apart, or steps would join
/// them.
std::vector<Series> binding_bars(const Series& curve, double low, double high) {
  std::vector<Series> found;
  for (const double limit : {high, low}) {
    Series bars{found.empty() ? "binds" : "", curve.x, {}, Mark::steps, binding_style + most_lines / 3, true};
    bars.y.assign(curve.y.size(), std::nan(""));
    bool any = false;
    for (std::size_t n = 0; n < curve.y.size(); ++n) {
      if (!std::isfinite(limit) || !(curve.y[n] / limit >= binding)) continue;
      bars.y[n] = limit;
      if (n > 0) bars.y[n - 1] = limit;  // a step ends at its sample
      any = true;
    }
    if (any) found.push_back(std::move(bars));
  }
  return found;
}

/// An empty panel over the time in which the design or the filter of today moves.
Panel time_panel(const CornerMotion& now, const CornerMotion* before) {
  Panel panel;
  panel.x.label = "time from the corner command / ms";
  for (const CornerMotion* at : {&now, before}) {
    if (!at) continue;
    const auto [from, to] = moving_time(*at);
    panel.x.min = std::min(panel.x.min.value_or(from), from), panel.x.max = std::max(panel.x.max.value_or(to), to);
  }
  const double air = 0.03 * (*panel.x.max - *panel.x.min);
  *panel.x.min -= air, *panel.x.max += air;
  return panel;
}

/// A quantity over time with its limits, and every sample marked that binds, or else the worst. Limits far beyond the
/// curve are named in the title instead of flattening the curve.
void add_curve(Panel& panel, const Quantity& quantity, Series curve) {
  const LimitName& name = limit_name(quantity.kind);
  panel.y.label = fmt::format("{} / {}", name.name, printed_unit(name.unit));
  const double high = quantity.high * name.per_si, low = quantity.low * name.per_si;
  double peak = 0.0, use = 0.0;
  std::size_t worst = 0;
  for (std::size_t n = 0; n < curve.y.size(); ++n) {
    const double used = std::max(curve.y[n] / high, curve.y[n] / low);
    if (used > use) use = used, worst = n;
    peak = std::max(peak, std::abs(curve.y[n]));
  }
  constexpr double off_scale = 2.0;
  std::string beyond;
  bool labelled = false;
  for (const double limit : {high, low}) {
    if (!std::isfinite(limit)) continue;
    if (std::abs(limit) <= off_scale * peak) {
      panel.limits.push_back({limit, labelled ? "" : "limit"});
      labelled = true;
    } else {
      beyond += fmt::format("{}{:.6g}", beyond.empty() ? "" : " and ", limit);
    }
  }
  if (use > 0.0) {
    panel.title += fmt::format(": {:.1f} % used{}", 100.0 * use, use > binding ? ", binding" : "");
    if (use > binding) {
      for (Series& bars : binding_bars(curve, low, high)) panel.series.push_back(std::move(bars));
    } else {
      panel.series.push_back({"largest use", {curve.x[worst]}, {curve.y[worst]}, Mark::points, 0});
    }
  }
  panel.series.insert(panel.series.begin(), std::move(curve));
  if (!beyond.empty()) panel.title += fmt::format(" (limit {} {} off scale)", beyond, printed_unit(name.unit));
}

/// The curve of today below all others, and words for both.
void add_today(Panel& panel, Series old) {
  old.label = "today", old.style = baseline_style;
  panel.series.front().label = "designed";
  panel.series.insert(panel.series.begin(), std::move(old));
}

/// One quantity of one axis.
Panel motion_panel(const Quantity& quantity, const CornerMotion& now, const CornerMotion* before, std::size_t index) {
  const LimitName& name = limit_name(quantity.kind);
  Panel panel = time_panel(now, before);
  panel.title = fmt::format("{} {}", name.name, now.result.task.machine.axes[index].name);
  add_curve(panel, quantity, curve_of(quantity, now, index));
  if (before) add_today(panel, curve_of(quantity, *before, index));
  if (now.sampled.moved && quantity.kind == LimitKind::velocity) {
    Series moved{"motion", now.time, {}, Mark::line, thin_style};
    for (const double v : now.motion.velocity.col(static_cast<Eigen::Index>(index))) moved.y.push_back(v * name.per_si);
    panel.series.push_back(std::move(moved));
  }
  return panel;
}

/// The power of all axes together, on which a machine may have limits of its own.
Panel total_power_panel(const CornerMotion& now, const CornerMotion* before) {
  const Machine& machine = now.result.task.machine;
  const Quantity power{LimitKind::power, -machine.regeneration_total_max, machine.power_total_max};
  const auto total = [&](const CornerMotion& at) {
    Series sum = curve_of(power, at, 0);
    for (std::size_t axis = 1; axis < machine.axes.size(); ++axis) {
      const Series more = curve_of(power, at, axis);
      for (std::size_t n = 0; n < sum.y.size(); ++n) sum.y[n] += more.y[n];
    }
    return sum;
  };
  Panel panel = time_panel(now, before);
  panel.title = "power of all axes";
  add_curve(panel, power, total(now));
  if (before) add_today(panel, total(*before));
  return panel;
}

/// The speed along the path, with the smallest one allowed at the corner.
Panel speed_panel(const CornerMotion& now, const CornerMotion* before) {
  const auto curve = [](const CornerMotion& at) {
    Series speed{"", at.time, {}, Mark::line, design_style, true};
    for (Eigen::Index n = 0; n < at.motion.velocity.rows(); ++n)
      speed.y.push_back(1e3 * at.motion.velocity.row(n).norm());
    return speed;
  };
  Panel panel = time_panel(now, before);
  panel.title = "speed along the path";
  panel.y.label = "speed / (mm/s)";
  panel.series.push_back(curve(now));
  if (const LimitUse* use = use_of(now.result, LimitKind::speed_min, now.task.name)) {
    panel.title += ":" + use_in_title(*use);
    panel.limits.push_back({1e3 * use->bound, "smallest allowed"});
    const auto row = static_cast<std::size_t>(now.motion.corner + use->sample);
    const bool binds = use->utilisation > binding;
    if (row < now.time.size())
      panel.series.push_back(
          {binds ? "binds" : "smallest", {now.time[row]}, {1e3 * use->value}, Mark::points, binds ? binding_style : 0});
  }
  if (before) add_today(panel, curve(*before));
  return panel;
}

std::vector<Panel> axis_panels(const CornerMotion& now, const CornerMotion* before, std::size_t axis) {
  std::vector<Panel> panels;
  for (const Quantity& quantity : quantities_of(now.result.task.machine.axes[axis]))
    panels.push_back(motion_panel(quantity, now, before, axis));
  return panels;
}

/// Axes with the same quantities side by side, quantity by quantity; others one after the other.
void add_side_by_side(std::vector<Panel>& panels, std::vector<std::vector<Panel>> axes) {
  const bool same = std::all_of(axes.begin(), axes.end(), [&](const auto& a) { return a.size() == axes[0].size(); });
  if (!same || axes.size() != 2) {
    for (std::vector<Panel>& axis : axes) std::move(axis.begin(), axis.end(), std::back_inserter(panels));
    return;
  }
  for (std::size_t i = 0; i < axes[0].size(); ++i) {
    for (std::vector<Panel>& axis : axes) panels.push_back(std::move(axis[i]));
  }
}

/// The task with the filter of today, its delays as small as they can be; without a filter if it breaks a limit.
std::optional<DesignResult> today(const DesignResult& result) {
  // The delays of a given filter are known for one response of all axes.
  if (!result.task.baseline || !Response(result.task.machine, result.task.sample_period).common()) return {};
  Task task = result.task;
  task.filter = std::exchange(task.baseline, {});
  task.settings.reset();
  DesignResult made = design_task(task);
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
    title += fmt::format(" designed, {:.4g} ms {} than today's {:.6g} ms", 1e3 * std::abs(saved),
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
  // A motion that stays on its path has no distance to draw, but a speed that falls to zero.
  std::optional<Panel> distance = distance_panel(now, before);
  const bool stays = !distance;
  figure.panels = {path_panel(now, before), stays ? speed_panel(now, before) : *std::move(distance)};
  const bool supply_limited = limits_supply(result.task.machine);
  std::vector<std::vector<Panel>> axes;
  for (std::size_t axis = 0; axis < result.task.machine.axes.size(); ++axis) {
    const auto a = static_cast<Eigen::Index>(axis);
    const Corner& legs = now.task.geometry();
    const bool moves = std::abs(legs.direction_in[a]) > 1e-12 || std::abs(legs.direction_out[a]) > 1e-12;
    if (moves) axes.push_back(axis_panels(now, before, axis));
  }
  add_side_by_side(figure.panels, std::move(axes));
  if (!stays && (now.task.speed_min > 0.0 || figure.panels.size() % 2 != (supply_limited ? 1U : 0U)))
    figure.panels.push_back(speed_panel(now, before));
  if (supply_limited) figure.panels.push_back(total_power_panel(now, before));
  figure.panels.push_back(response_panel(result, old_filter));
  figure.panels.push_back(taps_panel(*result.filter, old_filter));
  for (Panel& panel : figure.panels) {
    for (Series& series : panel.series) thin_out(series);
  }
  return figure;
}

}  // namespace accdec
