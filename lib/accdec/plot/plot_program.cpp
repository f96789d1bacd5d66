#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include <accdec/plan/report/samples.hpp>
#include <accdec/plot/plot_program.hpp>
#include <accdec/plot/program_drawing.hpp>
#include <accdec/plot/program_motion_panels.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

constexpr int page_width = 860, panel_height = 250;
constexpr double around_plot = 86.0;  // px of a panel above and below its plot
/// With this many corners or more, a part is drawn again, enlarged.
constexpr std::size_t many_corners = 60;

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
  bool arcs = false, servo = false;
  double worst_in_arc = 0.0;  ///< %
};

DrawnCorners corners_of(const ProgramResult& result, const ProgramView& view) {
  const Toolpath& path = result.plan.path;
  DrawnCorners corners;
  corners.servo = result.plan.command() != nullptr && !result.plan.command()->moved.empty();
  for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
    if (path.inside_arc[b] != 0) {
      corners.arcs = true;
      corners.worst_in_arc = std::max(corners.worst_in_arc, use_of(path, b, result.errors[b]));
    } else if (path.joint[b] != Joint::straight || result.plan.delay(b) != 0) {
      corners.places.push_back({view.at(path.point(b + 1)), use_of(path, b, result.errors[b])});
    }
  }
  return corners;
}

/// An empty drawing of a view.
Panel view_panel(const ProgramView& view) {
  Panel panel;
  const auto label = [&](std::size_t row) {
    const bool long_path = view.scale == 1.0;
    if (view.names[row].empty()) return std::string();
    const std::string stretch =
        view.stretch[row] == 1.0 ? "" : fmt::format(", drawn {:g} times as long", view.stretch[row]);
    return fmt::format("{} / {}{}", view.names[row],
                       view.rotary[row] ? (long_path ? "1000 deg" : "deg") : (long_path ? "m" : "mm"), stretch);
  };
  panel.x.label = label(0);
  panel.y.label = label(1);
  panel.equal_aspect = view.stretch[0] == view.stretch[1];
  panel.taller = std::max(1.0, (view.height + around_plot) / panel_height);
  const double air = 8.0 * view.pixel;
  panel.x.min = view.drawn(0, view.low[0] - air), panel.x.max = view.drawn(0, view.high[0] + air);
  panel.y.min = view.drawn(1, view.low[1] - air), panel.y.max = view.drawn(1, view.high[1] + air);
  return panel;
}

void add_strokes(Panel& panel, const std::vector<Stroke>& strokes, const ProgramView& view, bool rapid) {
  Series series = stroke_series(strokes, view, rapid);
  if (!series.x.empty()) panel.series.push_back(std::move(series));
}

Panel corner_panel(const Toolpath& path, const DrawnCorners& corners, const ProgramView& view, std::string title) {
  Panel panel = view_panel(view);
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
  Panel panel = view_panel(view);
  add_strokes(panel, strokes, view, true);
  panel.title =
      fmt::format("{} of {} blocks{}", speed, path.blocks(), panel.series.empty() ? "" : ", rapid moves dashed");
  panel.coloured = speed_lines(strokes, view);
  return panel;
}

Panel delay_panel(const ProgramResult& result) {
  const Toolpath& path = result.plan.path;
  std::map<int, std::int64_t> counts;
  std::int64_t joints = 0;
  for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
    const int delay = result.plan.delay(b);
    if (path.joint[b] == Joint::straight && delay == 0) continue;
    ++counts[delay];
    ++joints;
  }
  Panel panel;
  panel.title = fmt::format("delays of {} joint{}, {:.6g} s of the {:.6g} s", joints, joints == 1 ? "" : "s",
                            result.delay_total, result.cycle_time);
  panel.x.label = fmt::format("delay / samples of {:.6g} ms", result.sample_period * 1e3);
  panel.y.label = "joints";
  panel.x.whole = panel.y.whole = true;
  const int first = counts.empty() ? 0 : counts.begin()->first, last = counts.empty() ? -1 : counts.rbegin()->first;
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

/// "; at least 1.2 s (any motion), 1.3 s (monotone legs)": the bound by the way alone only where there is no other.
std::string bounds_in_title(const ProgramResult& result) {
  const std::vector<NamedBound> bounds = bounds_of(result);
  std::string text;
  for (std::size_t i = bounds.size() > 1 ? 1 : 0; i < bounds.size(); ++i)
    text += fmt::format("{}{:.5g} s ({}{})", text.empty() ? "; at least " : ", ", bounds[i].time, bounds[i].name,
                        bounds[i].complete ? "" : ", not finished");
  return text;
}

void add_corner_panels(Figure& figure, const Toolpath& path, const DrawnCorners& corners, const ProgramView& whole) {
  std::string title = corners.places.size() == 1 ? "1 corner by its error"
                                                 : fmt::format("{} corners by their errors", corners.places.size());
  if (corners.servo) title += " behind the servo";
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

Figure plot_program(const ProgramResult& result, ViewFrom from) {
  const Plan& plan = result.plan;
  const bool command = plan.command() != nullptr;
  const ProgramView whole = stretched(whole_view(plan.path, from));
  Figure figure = program_page_frame(result.program);
  figure.title += command ? fmt::format(": {:.6g} s, {} taps", result.cycle_time, plan.set().order() + 1)
                          : fmt::format(": {:.6g} s, plan {}", result.cycle_time, plan.name());
  figure.title += bounds_in_title(result);
  add_corner_panels(figure, plan.path, corners_of(result, whole), whole);
  if (whole.over_time) {
    figure.panels.push_back(place_over_time_panel(plan.path, *whole.over_time, motion_of(result)));
  } else {
    const std::vector<Stroke> strokes =
        command ? strokes_of(plan.path, whole) : strokes_of(plan.path, motion_of(result), whole);
    figure.panels.push_back(speed_panel(plan.path, strokes, whole, command ? "commanded speed" : "speed"));
  }
  if (!command) return figure;
  Panel delays = delay_panel(result);
  if (!delays.series[0].x.empty()) figure.panels.push_back(std::move(delays));
  return figure;
}

Figure plot_program(const ProgramResult& result, const Toolpath& programmed, const Machine& machine, ViewFrom from) {
  Figure figure = plot_program(result, from);
  add_motion_panels(figure, programmed, machine, motion_of(result));
  return figure;
}

}  // namespace accdec
