#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include <accdec/plot/figure_layout.hpp>
#include <accdec/plot/figure_style.hpp>
#include <accdec/plot/filter_panels.hpp>
#include <accdec/plot/path_panels.hpp>
#include <accdec/task/verified_contour.hpp>

namespace accdec {
namespace {

using namespace figure_style;

constexpr double no_distance = 1e-12;          ///< m; distances below it are zero
constexpr double no_extent = 1e-3;             ///< of the other direction's extent: nothing moves there
constexpr double margin = 0.06;                ///< of the path's panel, on every side
constexpr double lowest = 1.0, highest = 1.6;  ///< of the path's panel, see Panel::taller

/// The part of the plane that is drawn, m.
struct PathWindow {
  double left = 0.0, right = 0.0, low = 0.0, high = 0.0;

  void show(double x, double y) {
    left = std::min(left, x), right = std::max(right, x);
    low = std::min(low, y), high = std::max(high, y);
  }
  double size() const { return std::max(right - left, high - low); }
};

/// The blend, as far as its distance from the legs can be seen, with the beginning of both legs.
void show_blend(PathWindow& window, const CornerMotion& at, const PathPlane& plane) {
  const Corner& corner = at.task.geometry();
  const auto [rows, off] = path_distance(at.motion.position, corner);
  const double most = *std::max_element(off.begin(), off.end());
  const double tolerance = at.task.error_max.value_or(0.0);
  // A path that hardly leaves its legs is drawn in a window of the size of the tolerance.
  const bool leaves = most > std::max(0.02 * tolerance, no_distance);
  // At a sharp corner, the path turns back far from it and near to both legs.
  // One that turns back does not leave its legs at all.
  double reach = std::max(leaves ? 4.0 * most : 1.5 * tolerance, 1.5 * at.measures.corner_error);
  if (!(reach > no_distance)) reach = 1e-4;
  for (std::size_t n = 0; n < off.size(); ++n) {
    const Eigen::VectorXd s = at.motion.position.row(static_cast<Eigen::Index>(rows[n])).transpose();
    if (leaves && off[n] > 0.01 * most && s.norm() < 1.6 * reach) window.show(s.dot(plane.across), s.dot(plane.up));
  }
  for (const Eigen::VectorXd& end :
       {Eigen::VectorXd(-reach * corner.direction_in), Eigen::VectorXd(reach * corner.direction_out)})
    window.show(end.dot(plane.across), end.dot(plane.up));
}

/// The first and the last sample that is not zero, each with its neighbour outside; everything if all are zero.
std::pair<std::size_t, std::size_t> nonzero(const std::vector<double>& values, double zero) {
  const auto moves = [zero](double v) { return std::abs(v) > zero; };
  const auto first = std::find_if(values.begin(), values.end(), moves);
  if (first == values.end()) return {0, values.size() - 1};
  const auto last = std::find_if(values.rbegin(), values.rend(), moves);
  const auto from = static_cast<std::size_t>(first - values.begin()),
             to = values.size() - 1 - static_cast<std::size_t>(last - values.rbegin());
  return {from > 0 ? from - 1 : 0, std::min(to + 1, values.size() - 1)};
}

/// How many times a path is drawn higher than it is, or 1 over how many times wider, where it would fill less than half
/// of its panel. A direction without motion is drawn as it is.
double stretch_of(double wide, double high) {
  double stretch = 1.0;
  if (std::min(wide, high) < no_extent * std::max(wide, high)) return stretch;
  const double aspect = high / wide;
  for (const double more : {2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0}) {
    if (taller_for(more * aspect) <= lowest) stretch = more;
    if (taller_for(aspect / more) >= highest) stretch = 1.0 / more;
  }
  return stretch;
}

/// From the corner to the sample nearest to it.
Series error_line(const CornerMotion& at, const PathPlane& plane, double scale, const char* unit) {
  Eigen::Index nearest = 0;
  at.motion.position.rowwise().norm().minCoeff(&nearest);
  const Eigen::VectorXd s = at.motion.position.row(nearest).transpose();
  return {fmt::format("error {:.4g} {}", scale * at.measures.corner_error, unit),
          {0.0, scale * s.dot(plane.across)},
          {0.0, scale * s.dot(plane.up)},
          Mark::line,
          0,
          true};
}

Series path_series(const SampledMotion& motion, const PathPlane& plane, const PathWindow& window, double scale) {
  Series path;
  for (Eigen::Index n = 0; n < motion.position.rows(); ++n) {
    const Eigen::VectorXd s = motion.position.row(n).transpose();
    if (s.norm() > 8.0 * window.size()) continue;
    path.x.push_back(scale * s.dot(plane.across)), path.y.push_back(scale * s.dot(plane.up));
  }
  return path;
}

/// Legs that leave the drawing at both ends.
Series legs(const Corner& corner, const PathPlane& plane, double length) {
  Series programmed{"programmed", {}, {}, Mark::line, thin_style};
  for (const Eigen::VectorXd& end :
       {Eigen::VectorXd(-length * corner.direction_in), Eigen::VectorXd(0.0 * corner.direction_in),
        Eigen::VectorXd(length * corner.direction_out)}) {
    programmed.x.push_back(end.dot(plane.across)), programmed.y.push_back(end.dot(plane.up));
  }
  return programmed;
}

Series round_line(double radius) {
  Series line;
  for (int i = 0; i <= 120; ++i) {
    const double turn = 2.0 * std::numbers::pi * i / 120;
    line.x.push_back(radius * std::cos(turn)), line.y.push_back(radius * std::sin(turn));
  }
  return line;
}

struct Length {
  double scale;
  const char* unit;
};
bool is_large(double largest) {
  return largest >= 4e-3;
}
Length length_unit(double largest) {
  return is_large(largest) ? Length{1e3, "mm"} : Length{1e6, "µm"};
}

}  // namespace

CornerMotion::CornerMotion(const DesignResult& r, std::size_t index)
    : result(r),
      task(r.task.corners[index]),
      measures(r.corners[index]),
      sampled(simulate_response(*r.filter, task.geometry(), measures.delay, r.task.sample_period, r.task.machine,
                                measures.feed_part)),
      motion(sampled.motion()) {
  for (Eigen::Index n = 0; n < motion.velocity.rows(); ++n)
    time.push_back(static_cast<double>(n - motion.corner) * r.task.sample_period * 1e3);
}

Panel path_panel(const CornerMotion& now, const CornerMotion* before) {
  const PathPlane plane = plane_of(now.task.geometry(), now.result.task.machine);
  PathWindow window;
  for (const CornerMotion* at : {&now, before}) {
    if (at) show_blend(window, *at, plane);
  }
  const auto [scale, unit] = length_unit(window.size());
  Panel panel;
  panel.title = fmt::format("path around corner {}", now.task.name);
  const LimitUse* use = use_of(now.result, LimitKind::corner_error, now.task.name);
  if (use && use->bound > 0.0) panel.title += ": tolerance" + use_in_title(*use);
  const auto label = [&](const std::string& name, const Eigen::VectorXd& direction) {
    return fmt::format("{} / {}", name, plane_unit(direction, now.result.task.machine, is_large(window.size())));
  };
  panel.x.label = label(plane.across_name, plane.across);
  panel.y.label = label(plane.up_name, plane.up);
  panel.equal_aspect = true;
  const double wide = std::max(window.right - window.left, no_extent * window.size()),
               high = std::max(window.high - window.low, no_extent * window.size());
  // As high as what it shows, within limits.
  panel.taller = std::clamp(taller_for(high / wide), lowest, highest);
  panel.stretch = stretch_of(window.right - window.left, window.high - window.low);
  if (panel.stretch != 1.0)
    (panel.stretch > 1.0 ? panel.y : panel.x).label +=
        fmt::format(", drawn {:g} times as long", std::max(panel.stretch, 1.0 / panel.stretch));
  panel.x.min = scale * (window.left - margin * wide), panel.x.max = scale * (window.right + margin * wide);
  panel.y.min = scale * (window.low - margin * high), panel.y.max = scale * (window.high + margin * high);
  if (before) {
    Series old = path_series(before->motion, plane, window, scale);
    old.label = "today", old.style = baseline_style, old.solid = true;
    panel.series.push_back(std::move(old));
  }
  if (now.sampled.moved) {
    Series command = path_series(now.sampled.command, plane, window, scale);
    command.label = "command", command.style = thin_style;
    panel.series.push_back(std::move(command));
  }
  Series path = path_series(now.motion, plane, window, scale);
  path.label = now.sampled.moved ? "motion"
               : before          ? "designed"
                                 : "path",
  path.mark = Mark::line_points, path.style = design_style, path.solid = true;
  panel.series.push_back(std::move(path));
  panel.series.push_back(legs(now.task.geometry(), plane, 8.0 * window.size() * scale));
  if (now.measures.corner_error > 0.0) panel.series.push_back(error_line(now, plane, scale, unit));
  if (const double tolerance = scale * now.task.error_max.value_or(0.0); tolerance > 0.0) {
    panel.circles.push_back({0.0, 0.0, tolerance, fmt::format("tolerance {:.4g} {}", tolerance, unit), true});
    if (use && use->utilisation > binding) {
      Series bound = round_line(tolerance);
      bound.label = "binds", bound.style = binding_style + static_cast<int>(most_lines) / 3, bound.solid = true;
      panel.series.push_back(std::move(bound));
    }
  }
  return panel;
}

std::optional<Panel> distance_panel(const CornerMotion& now, const CornerMotion* before) {
  Panel panel;
  panel.x.label = "time from the corner command / ms";
  double most = 0.0;
  for (const CornerMotion* at : {before, &now}) {
    if (!at) continue;
    const bool design = at == &now;
    auto [time, off] = path_distance(at->motion.position, at->task.geometry());
    for (double& t : time) t = (t - static_cast<double>(at->motion.corner)) * at->result.task.sample_period * 1e3;
    for (double& d : off) d = d < no_distance ? 0.0 : d;
    const double here = *std::max_element(off.begin(), off.end());
    const auto [from, to] = nonzero(off, (at->sampled.moved ? 1e-3 : 1e-6) * here);  // a servo takes for ever
    if (here > 0.0) {
      panel.x.min = std::min(panel.x.min.value_or(time[from]), time[from]);
      panel.x.max = std::max(panel.x.max.value_or(time[to]), time[to]);
    }
    most = std::max(most, here);
    panel.series.push_back({!before  ? ""
                            : design ? "designed"
                                     : "today",
                            std::move(time), std::move(off), Mark::line, design ? design_style : baseline_style, true});
  }
  if (!(panel.x.min < panel.x.max)) return {};
  const double air = 0.04 * (*panel.x.max - *panel.x.min);
  *panel.x.min -= air, *panel.x.max += air;
  const auto [scale, unit] = length_unit(most);
  for (Series& series : panel.series) {
    for (double& y : series.y) y *= scale;
  }
  panel.title = fmt::format("distance from the programmed path / {}: largest {:.4g}", unit,
                            scale * now.measures.contour_deviation);
  if (const LimitUse* use = use_of(now.result, LimitKind::contour, now.task.name)) {
    panel.title += ";" + use_in_title(*use);
    panel.limits.push_back({scale * use->bound, "limit"});
    const Series& design = panel.series.back();
    const auto most_at = std::ranges::max_element(design.y) - design.y.begin();
    if (use->utilisation > binding)
      panel.series.push_back(
          {"binds", {design.x[static_cast<std::size_t>(most_at)]}, {scale * use->value}, Mark::points, binding_style});
  }
  panel.y.min = 0.0;
  return panel;
}

}  // namespace accdec
