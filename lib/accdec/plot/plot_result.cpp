#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include <accdec/machine/limits.hpp>
#include <accdec/machine/utilisation.hpp>
#include <accdec/plot/plot_result.hpp>
#include <accdec/task/simulation.hpp>

namespace accdec {
namespace {

constexpr double binding = 0.99;  ///< share of a limit from which a drawing calls it binding

/// What an axis does, with the bounds on it; both in SI.
struct Quantity {
  LimitKind kind;
  double low, high;
};

/// What to draw of an axis: velocity and acceleration always, the others where they are limited. Regeneration is the
/// lower bound of power.
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
    drawn.push_back({limit.kind, limit.kind == LimitKind::power ? -unlimited : -bound, bound});
  }
  return drawn;
}

/// The quantity with its sign, where its limit is on the size.
double signed_value(const AxisState& state, LimitKind kind) {
  switch (kind) {
    case LimitKind::velocity: return state.velocity;
    case LimitKind::acceleration: return state.acceleration;
    case LimitKind::jerk: return state.jerk;
    case LimitKind::force: return state.force;
    default: break;
  }
  for (const AxisLimit& limit : axis_limits) {
    if (limit.kind == kind) return limit.value(state);
  }
  return 0.0;
}

/// "mm/s^3" as it is printed: "(mm/s³)".
std::string printed_unit(std::string_view unit) {
  std::string text(unit);
  for (const auto& [plain, printed] : {std::pair<std::string_view, std::string_view>{"^2", "²"}, {"^3", "³"}}) {
    if (const auto at = text.find(plain); at != std::string::npos) text.replace(at, plain.size(), printed);
  }
  return text.find('/') == std::string::npos ? text : "(" + text + ")";
}

/// One quantity of one axis over time, its worst sample marked; limits far beyond the curve are said in the title
/// instead of flattening it.
Panel motion_panel(const Quantity& quantity, const std::string& axis, const std::vector<double>& time,
                   const std::vector<double>& values) {
  const LimitName& name = limit_name(quantity.kind);
  Panel panel;
  panel.title = fmt::format("{} {}", name.name, axis);
  panel.x.label = "time from the corner command / ms";
  panel.x.min = time.front(), panel.x.max = time.back();
  panel.y.label = fmt::format("{} / {}", name.name, printed_unit(name.unit));
  Series curve{"", time, {}, quantity.kind == LimitKind::velocity ? Mark::line : Mark::steps, 0};
  double peak = 0.0, use = 0.0;
  std::size_t worst = 0;
  for (std::size_t n = 0; n < values.size(); ++n) {
    const double used = std::max(values[n] / quantity.high, values[n] / quantity.low);
    if (used > use) use = used, worst = n;
    curve.y.push_back(values[n] * name.per_si);
    peak = std::max(peak, std::abs(curve.y.back()));
  }
  constexpr double off_scale = 3.0;
  std::string beyond;
  bool labelled = false;
  for (const double bound : {quantity.high, quantity.low}) {
    if (!std::isfinite(bound)) continue;
    const double limit = bound * name.per_si;
    if (std::abs(limit) <= off_scale * peak) {
      panel.limits.push_back({limit, labelled ? "" : "limit"});
      labelled = true;
    } else {
      beyond += fmt::format("{}{:.6g}", beyond.empty() ? "" : " and ", limit);
    }
  }
  if (use > 0.0) {
    panel.title += fmt::format(": {:.1f} % used{}", 100.0 * use, use > binding ? ", binding" : "");
    panel.series.push_back({"largest use", {time[worst]}, {curve.y[worst]}, Mark::points, 3});
  }
  panel.series.insert(panel.series.begin(), std::move(curve));
  if (!beyond.empty()) panel.title += fmt::format(" (limit {} {} off scale)", beyond, printed_unit(name.unit));
  return panel;
}

std::vector<Panel> axis_panels(const SampledMotion& motion, double period, Eigen::Index index, const Axis& axis,
                               const std::vector<double>& time) {
  std::vector<Panel> panels;
  for (const Quantity& quantity : quantities_of(axis)) {
    AxisSampler sampler(axis, period);
    std::vector<double> values;
    for (Eigen::Index n = 0; n < motion.velocity.rows(); ++n)
      values.push_back(
          signed_value(sampler.next(motion.velocity(n, index), motion.acceleration(n, index)), quantity.kind));
    panels.push_back(motion_panel(quantity, axis.name, time, values));
  }
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

/// Axes of the drawing: the machine's first two if it has no more, else the plane of the corner, a along the motion, b
/// halving the angle.
struct Plane {
  Eigen::VectorXd across, up;
  std::string across_name, up_name;
};

Plane plane_of(const Corner& corner, const Machine& machine) {
  if (corner.axes() == 2) {
    return {Eigen::Vector2d(1, 0), Eigen::Vector2d(0, 1), machine.axes[0].name, machine.axes[1].name};
  }
  const auto unit = [](Eigen::VectorXd v) {
    const double length = v.norm();
    return length > 1e-9 ? Eigen::VectorXd(v / length) : Eigen::VectorXd(Eigen::VectorXd::Zero(v.size()));
  };
  return {unit(corner.direction_in + corner.direction_out), unit(corner.direction_out - corner.direction_in), "a", "b"};
}

/// The path around the corner. @param whole  the whole blend instead of a few errors around the corner
Panel path_panel(const TaskCorner& task, const CornerResult& measures, const SampledMotion& motion,
                 const Machine& machine, bool whole) {
  const Corner& corner = task.geometry();
  const Plane plane = plane_of(corner, machine);
  // The window: a few errors around the corner, but no more than the blend itself.
  const double blend = std::max(motion.position.row(motion.corner).norm(), 1e-6);
  const double error = std::max(measures.corner_error, task.error_max.value_or(0.0));
  const double reach = whole ? 1.2 * blend : error > 0.0 ? std::min(3.0 * error, blend) : 0.3 * blend;
  const double scale = reach < 2e-3 ? 1e6 : 1e3;
  const char* const unit = reach < 2e-3 ? "µm" : "mm";
  Series path{"path", {}, {}, whole ? Mark::line : Mark::line_points, 0},
      programmed{"programmed", {}, {}, Mark::line, 5};
  for (Eigen::Index n = 0; n < motion.position.rows(); ++n) {
    const Eigen::VectorXd s = motion.position.row(n).transpose() * scale;
    if (s.norm() > 8.0 * reach * scale && std::abs(n - motion.corner) > 0 && s.norm() > 3.0 * blend * scale) continue;
    path.x.push_back(s.dot(plane.across));
    path.y.push_back(s.dot(plane.up));
  }
  const double leg = 8.0 * reach * scale;
  for (const Eigen::VectorXd& end :
       {Eigen::VectorXd(-leg * corner.direction_in), Eigen::VectorXd(0.0 * corner.direction_in),
        Eigen::VectorXd(leg * corner.direction_out)}) {
    programmed.x.push_back(end.dot(plane.across));
    programmed.y.push_back(end.dot(plane.up));
  }
  Panel panel;
  panel.title = whole ? "the whole blend" : fmt::format("path around corner {}", task.name);
  panel.taller = 1.6;
  panel.x.label = fmt::format("{} / {}", plane.across_name, unit);
  panel.y.label = fmt::format("{} / {}", plane.up_name, unit);
  panel.series = {path, programmed};
  panel.equal_aspect = true;
  panel.x.min = panel.y.min = -reach * scale;
  panel.x.max = panel.y.max = reach * scale;
  if (measures.corner_error > 0.0) {
    panel.circles.push_back(
        {0.0, 0.0, measures.corner_error * scale, fmt::format("error {:.4g} {}", measures.corner_error * scale, unit)});
  }
  if (task.error_max && *task.error_max > 0.0) {
    Series tolerance{fmt::format("bound {:.4g} {}", *task.error_max * scale, unit), {}, {}, Mark::line, 2};
    for (int i = 0; i <= 120; ++i) {
      const double turn = 2.0 * std::numbers::pi * i / 120;
      tolerance.x.push_back(*task.error_max * scale * std::cos(turn));
      tolerance.y.push_back(*task.error_max * scale * std::sin(turn));
    }
    panel.series.push_back(tolerance);
  }
  return panel;
}

Panel taps_panel(const Filter& filter) {
  Panel panel;
  panel.title = fmt::format("filter taps, order {}", filter.order());
  panel.x.label = "tap";
  panel.y.label = "weight";
  Series taps{"", {}, {}, filter.order() <= 200 ? Mark::impulses : Mark::line, 1};
  for (int i = 0; i <= filter.order(); ++i) {
    taps.x.push_back(i);
    taps.y.push_back(filter.tap(i));
  }
  panel.x.min = -1.0, panel.x.max = filter.order() + 1.0, panel.y.min = 0.0;
  panel.series.push_back(taps);
  return panel;
}

Panel response_panel(const Filter& filter, double sample_period, const std::vector<Mode>& modes) {
  Panel panel;
  panel.title = "residual vibration";
  panel.x.label = "frequency / Hz";
  panel.y.label = "amplitude, filtered over commanded";
  panel.y.log = true;
  panel.y.min = 1e-4, panel.y.max = 1.5;
  double top = 8.0 / ((filter.order() + 1) * sample_period);
  for (const Mode& mode : modes) top = std::max(top, 1.5 * mode.frequency_high);
  top = std::min(top, 0.5 / sample_period);
  for (const Mode& mode : modes) {
    const bool first = panel.bands.empty();
    panel.bands.push_back({mode.frequency_low, mode.frequency_high, first ? "mode" : ""});
    const double level = std::max(mode.residual_max, 1e-4);
    const double half =
        std::max(0.0, 0.004 * top - 0.5 * (mode.frequency_high - mode.frequency_low));  // a line has to be seen
    panel.bands.back().from -= half, panel.bands.back().to += half;
    panel.series.push_back(
        {first ? "bound" : "", {mode.frequency_low - half, mode.frequency_high + half}, {level, level}, Mark::line, 2});
  }
  Series response{"", {}, {}, Mark::line, 0};
  // Each takes a pass over all taps.
  const int points = static_cast<int>(std::clamp(1e8 / (filter.order() + 1.0), 100.0, 800.0));
  for (int i = 0; i <= points; ++i) {
    const double f = top * i / points;
    response.x.push_back(f);
    response.y.push_back(std::max(residual_vibration(filter, f, sample_period), 1e-6));
  }
  panel.x.min = 0.0, panel.x.max = top;
  panel.series.push_back(response);
  return panel;
}

/// Leaves of a long curve the ends and the extremes of as many pieces as a drawing can show.
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
  const Filter& filter = *result.filter;
  const TaskCorner& task = result.task.corners[index];
  const CornerResult& measures = result.corners[index];
  const double period = result.task.sample_period;
  const SampledMotion motion = simulate_corner(filter, task.geometry(), measures.delay, period);
  std::vector<double> time;
  for (Eigen::Index n = 0; n < motion.velocity.rows(); ++n)
    time.push_back(static_cast<double>(n - motion.corner) * period * 1e3);

  Figure figure;
  figure.title = fmt::format("{}: corner {}, delay {} samples",
                             result.task.title.empty() ? "accdec" : result.task.title, task.name, measures.delay);
  figure.columns = 2;
  for (const bool whole : {false, true}) {
    figure.panels.push_back(path_panel(task, measures, motion, result.task.machine, whole));
  }
  std::vector<std::vector<Panel>> axes;
  for (std::size_t axis = 0; axis < result.task.machine.axes.size(); ++axis) {
    const auto a = static_cast<Eigen::Index>(axis);
    const bool moves =
        std::abs(task.geometry().direction_in[a]) > 1e-12 || std::abs(task.geometry().direction_out[a]) > 1e-12;
    if (moves) axes.push_back(axis_panels(motion, period, a, result.task.machine.axes[axis], time));
  }
  add_side_by_side(figure.panels, std::move(axes));
  figure.panels.push_back(response_panel(filter, period, result.task.machine.modes));
  figure.panels.push_back(taps_panel(filter));
  for (Panel& panel : figure.panels) {
    for (Series& series : panel.series) thin_out(series);
  }
  return figure;
}

}  // namespace accdec
