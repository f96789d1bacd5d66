#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <accdec/machine/limits.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/plot/figure_style.hpp>
#include <accdec/plot/html.hpp>
#include <accdec/plot/html_parts.hpp>
#include <accdec/plot/path_follower.hpp>
#include <accdec/plot/program_page.hpp>

namespace accdec {
namespace {

constexpr const char* behind_servo =
    "<p>Path, speed and acceleration are those of the command. The axes follow behind it with their servo: force and "
    "power are theirs.</p>\n";
constexpr std::int64_t page_points_max = 40'000;

/// The path as the script draws it, across and upwards: coefficients of the path's columns.
std::string rows_of(const ProgramView& view) {
  std::string rows;
  for (std::size_t row = 0; row < 2; ++row) {
    rows += '[';
    for (std::size_t a = 0; a < view.dimensions; ++a) {
      const bool shown = view.over_time ? row == 1 && a == *view.over_time : true;
      rows += fmt::format("{:.6g},", !shown ? 0.0 : view.over_time ? 1.0 : view.rows[row][a]);
    }
    rows += "],";
  }
  return rows;
}

/// m/s; 0 where there are rapid moves only. If a feed move blends with a rapid one, its feed counts.
double fastest_feed_move(const Toolpath& path, const ProgramMotion& motion) {
  PathFollower follower(path);
  double fastest = 0.0;
  motion.samples([&](std::int64_t, const double* position, const double* velocity) {
    follower.follow(position, velocity);
    if (path.rapid[follower.block()] != 0) return;
    const double speed = speed_of(velocity, path.dimensions());
    fastest = std::max(fastest, std::min(speed, block_feed(path, follower.block())));
  });
  return fastest;
}

std::string arrays(const Toolpath& path, const Machine& machine, const ProgramMotion& motion, ViewFrom from) {
  const ProgramView view = whole_view(path, from);
  const std::vector<std::int64_t> drawn = drawn_samples(motion, page_points_max);
  std::string t, v, l;
  std::vector<std::string> places(path.dimensions());
  int binding = -1;
  auto next = drawn.begin();
  visit_velocities(machine, motion, [&](std::int64_t k, const double* at, const double* velocity, int binds) {
    binding = std::max(binding, binds);
    if (next == drawn.end() || k != *next) return;
    ++next;
    t += fmt::format("{:.6g},", static_cast<double>(k) * motion.sample_period);
    for (std::size_t a = 0; a < places.size(); ++a) places[a] += fmt::format("{:.4f},", at[a] * 1e3);
    v += fmt::format("{:.5g},", speed_of(velocity, places.size()) * 1e3);
    l += fmt::format("{},", binding);
    binding = -1;
  });
  const double feed = 1e3 * fastest_feed_move(path, motion);
  const auto styles = binding_styles(machine);
  std::string names, axes, colours;
  for (std::size_t i = 0; i < binding_limits; ++i) {
    names += fmt::format("\"{}\",", binding_name(static_cast<int>(i)));
    colours += fmt::format("\"{}\",", figure_style::colours.at(static_cast<std::size_t>(styles[i])));
  }
  for (std::size_t a = 0; a < places.size(); ++a) {
    axes += fmt::format("\"{}\",", path.axis_name(a));
    places[a] = "[" + places[a] + "]";
  }
  return fmt::format(
      "const "
      "D={{t:[{}],p:[{}],rows:[{}],over:{},v:[{}],l:[{}],names:[{}],other:\"{}\",ax:[{}],feed:{:.5g},colours:[{}],grey:"
      "\"{}\","
      "palette:\"{}\"}};\n",
      t, fmt::join(places, ","), rows_of(view), view.over_time.has_value(), v, l, names, binding_name(-1), axes, feed,
      colours, figure_style::colours[figure_style::baseline_style], figure_style::line_palette);
}

/// Times that no motion of a class undercuts.
std::string bounds_table(const ProgramMotion& motion) {
  if (motion.bounds.empty()) return "";
  std::vector<std::vector<std::string>> rows;
  std::string notes;
  for (const NamedBound& bound : motion.bounds) {
    // The table has the class of motions, on one line; what else is to be said stands below it.
    const std::size_t end = std::min(bound.motions.find("; "), bound.motions.size());
    rows.push_back({bound.name, fmt::format("{:.4f}", bound.time),
                    fmt::format("{:.2f}", 100.0 * bound.time / motion.cycle_time), bound.motions.substr(0, end)});
    if (end < bound.motions.size()) notes += html_paragraph(bound.name + ": " + bound.motions.substr(end + 2) + ".");
  }
  return "<h2>Lower bounds of the time</h2>\n" + html_table({{"bound", "s", "% of the plan", "holds for"}, rows}) +
         notes;
}

}  // namespace

std::string program_page(const Toolpath& programmed, const Machine& machine, const ProgramMotion& motion,
                         ViewFrom from) {
  std::vector<std::vector<std::string>> rows;
  for (const CornerLoss& loss : time_lost(programmed, motion)) {
    if (loss.count == 0) continue;
    rows.push_back({class_name(loss), fmt::format("{}", loss.count), fmt::format("{:.4f}", loss.time),
                    fmt::format("{:.3f}", 1e3 * loss.time / static_cast<double>(loss.count))});
  }
  std::string page = html_head(motion.title);
  if (!motion.answer.empty()) page += html_paragraph(motion.answer);
  page +=
      "<p>The path has the colour of its speed; the speed over time that of the limit that binds. Wheel or two "
      "fingers: "
      "zoom. Drag: move. Double click: everything. The pointer tells time, place and speed.</p>\n" +
      std::string(has_servo(machine) ? behind_servo : "") + (motion.legs.empty() ? "" : html_paragraph(motion.legs)) +
      "<canvas id=\"path\"></canvas>\n<p id=\"info\">&nbsp;</p>\n<canvas id=\"speed\"></canvas>\n"
      "<p id=\"legend\"></p>\n<h2>Time lost against the programmed feed</h2>\n";
  page += html_table({{"turn", "places", "lost, s", "lost by each, ms"}, rows});
  page += bounds_table(motion);
  page += "<script>\n" + arrays(programmed, machine, motion, from) + std::string(program_script) + "</script>\n" +
          html_foot();
  return page;
}

std::string program_page(const Toolpath& programmed, const Machine& machine, const ProgramResult& result,
                         ViewFrom from) {
  return program_page(programmed, program_machine(machine, programmed), motion_of(result), from);
}

}  // namespace accdec
