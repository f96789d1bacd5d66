#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include <accdec/plot/plot_program.hpp>
#include <accdec/plot/program_drawing.hpp>
#include <accdec/plot/program_motion_panels.hpp>
#include <accdec/task/verifier.hpp>

namespace accdec {
namespace {

constexpr int page_width = 860, panel_height = 250;
constexpr double around_plot = 86.0;  // px of a panel above and below its plot
/// From so many corners on a part is drawn again, enlarged.
constexpr std::size_t many_corners = 60;

bool rotary(std::size_t axis) {
  return axis >= 3 && axis < 6;
}

/// Error (m) over tolerance of a joint, %; 0 where it stops or has no tolerance.
double use_of(const Toolpath& path, std::size_t joint, double error) {
  const double tolerance = path.tolerance[joint];
  if (path.joint[joint] == Joint::stop || !(tolerance < unlimited)) return 0.0;
  return 100.0 *
         std::min(1.0, utilisation_of(LimitKind::corner_error, error <= position_floor ? 0.0 : error, tolerance));
}

/// The corners as a reader of the program counts them, and the worst of the joints inside arcs.
struct DrawnCorners {
  std::vector<PlaceValue> places;
  bool arcs = false;
  double worst_in_arc = 0.0;  ///< %
};

/// @param errors  m, one a block  @param delays  samples, one a block; empty: none
DrawnCorners corners_of(const Toolpath& path, const std::vector<double>& errors, const std::vector<int>& delays,
                        const ProgramView& view) {
  DrawnCorners corners;
  for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
    if (path.inside_arc[b] != 0) {
      corners.arcs = true;
      corners.worst_in_arc = std::max(corners.worst_in_arc, use_of(path, b, errors[b]));
    } else if (path.joint[b] != Joint::straight || (!delays.empty() && delays[b] != 0)) {
      corners.places.push_back({view.at(path, b + 1), use_of(path, b, errors[b])});
    }
  }
  return corners;
}

/// An empty drawing of a view.
Panel view_panel(const Toolpath& path, const ProgramView& view) {
  Panel panel;
  const auto label = [&](std::size_t dimension) {
    const bool long_path = view.scale == 1.0;
    return fmt::format("{} / {}", path.axis_name(dimension),
                       rotary(path.axes[dimension]) ? (long_path ? "1000 deg" : "deg") : (long_path ? "m" : "mm"));
  };
  panel.x.label = label(view.across);
  if (path.dimensions() > 1) panel.y.label = label(view.up);
  panel.equal_aspect = true;
  panel.taller = std::max(1.0, (view.height + around_plot) / panel_height);
  const double air = 8.0 * view.pixel;
  panel.x.min = (view.low[0] - air) * view.scale, panel.x.max = (view.high[0] + air) * view.scale;
  panel.y.min = (view.low[1] - air) * view.scale, panel.y.max = (view.high[1] + air) * view.scale;
  return panel;
}

void add_strokes(Panel& panel, const std::vector<Stroke>& strokes, const ProgramView& view, bool rapid) {
  Series series = stroke_series(strokes, view, rapid);
  if (!series.x.empty()) panel.series.push_back(std::move(series));
}

Panel corner_panel(const Toolpath& path, const DrawnCorners& corners, const ProgramView& view, std::string title) {
  Panel panel = view_panel(path, view);
  panel.title = std::move(title);
  const std::vector<Stroke> strokes = strokes_of(path, view);
  add_strokes(panel, strokes, view, false);
  add_strokes(panel, strokes, view, true);
  ColouredLines marks;
  marks.pieces = squares(corners.places, view, marks.line_width);
  marks.high = 100.0;
  marks.label = "corner error / tolerance, %";
  panel.coloured = std::move(marks);
  return panel;
}

Panel speed_panel(const Toolpath& path, const std::vector<Stroke>& strokes, const ProgramView& view,
                  const char* speed) {
  Panel panel = view_panel(path, view);
  add_strokes(panel, strokes, view, true);
  panel.title =
      fmt::format("{} of {} blocks{}", speed, path.blocks(), panel.series.empty() ? "" : ", rapid moves dashed");
  panel.coloured = speed_lines(strokes, view);
  return panel;
}

Panel delay_panel(const ProgramResult& result) {
  const Toolpath& path = result.path;
  std::map<int, std::int64_t> counts;
  for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
    const int delay = result.plan.delays[b];
    if (path.joint[b] != Joint::straight || delay != 0) ++counts[delay];
  }
  Panel panel;
  panel.title = fmt::format("delays of {} joints, {:.6g} s of the {:.6g} s", result.corners, result.delay_total,
                            result.cycle_time);
  panel.x.label = fmt::format("delay / samples of {:.6g} ms", result.sample_period * 1e3);
  panel.y.label = "joints";
  const int first = counts.empty() ? 0 : counts.begin()->first, last = counts.empty() ? 1 : counts.rbegin()->first;
  const int width = (last - first) / 200 + 1;  // delays in a bar
  Series bars{"", {}, {}, Mark::bars, 1};
  double most = 1.0;
  for (int d = first; d <= last; d += width) {
    double sum = 0.0;
    for (auto it = counts.lower_bound(d); it != counts.end() && it->first < d + width; ++it)
      sum += static_cast<double>(it->second);
    bars.x.push_back(d + 0.5 * (width - 1));
    bars.y.push_back(sum);
    most = std::max(most, sum);
  }
  if (width > 1) panel.x.label += fmt::format(", {} in a bar", width);
  panel.x.min = first - 1.0, panel.x.max = last + 1.0;
  panel.y.log = most > 100.0;
  panel.y.min = panel.y.log ? 0.5 : 0.0;
  panel.y.max = most * (panel.y.log ? 1.6 : 1.06);
  panel.series.push_back(std::move(bars));
  return panel;
}

Figure program_page_frame(const std::string& program) {
  Figure figure;
  figure.title = program.substr(program.find_last_of('/') + 1);
  figure.panel_width = page_width;
  figure.panel_height = panel_height;
  return figure;
}

void add_corner_panels(Figure& figure, const Toolpath& path, const DrawnCorners& corners, const ProgramView& whole) {
  std::string title = fmt::format("{} corners by their errors", corners.places.size());
  if (corners.arcs) title += fmt::format("; inside arcs at most {:.3g} % of the tolerance", corners.worst_in_arc);
  figure.panels.push_back(corner_panel(path, corners, whole, title));
  if (corners.places.size() < many_corners) return;
  std::vector<std::array<double, 2>> places;
  for (const PlaceValue& corner : corners.places) places.push_back(corner.place);
  figure.panels.push_back(corner_panel(path, corners, enlarged(whole, places), "enlarged, where most are"));
}

void add_motion_panels(Figure& figure, const Toolpath& programmed, const Machine& machine,
                       const ProgramMotion& motion) {
  figure.panels.push_back(speed_over_time_panel(programmed, program_machine(machine, programmed), motion));
  figure.panels.push_back(time_lost_panel(programmed, motion));
}

}  // namespace

Figure plot_program(const ProgramResult& result) {
  const ProgramView whole = whole_view(result.path);
  Figure figure = program_page_frame(result.program);
  figure.title += fmt::format(": {:.6g} s, {} taps{}", result.cycle_time, result.filter.order() + 1,
                              result.legs.single() ? "" : ", length by leg");
  add_corner_panels(figure, result.path, corners_of(result.path, result.plan.errors, result.plan.delays, whole), whole);
  figure.panels.push_back(speed_panel(result.path, strokes_of(result.path, whole), whole, "commanded speed"));
  figure.panels.push_back(delay_panel(result));
  return figure;
}

Figure plot_program(const ProgramResult& result, const Toolpath& programmed, const Machine& machine) {
  Figure figure = plot_program(result);
  add_motion_panels(figure, programmed, machine, motion_of(result));
  return figure;
}

Figure plot_program(const ProfileResult& result, const Toolpath& programmed, const Machine& machine) {
  const ProgramView whole = whole_view(result.path);
  const ProgramMotion motion = motion_of(result);
  Figure figure = program_page_frame(result.program);
  figure.title += fmt::format(": {:.6g} s, plan profiles", result.cycle_time);
  add_corner_panels(figure, result.path, corners_of(result.path, result.plan.errors, {}, whole), whole);
  figure.panels.push_back(speed_panel(result.path, strokes_of(result.path, motion, whole), whole, "speed"));
  add_motion_panels(figure, programmed, machine, motion);
  return figure;
}

}  // namespace accdec
