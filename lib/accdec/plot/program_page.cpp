#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include <accdec/machine/limits.hpp>
#include <accdec/plot/html.hpp>
#include <accdec/plot/html_parts.hpp>
#include <accdec/plot/program_page.hpp>

namespace accdec {
namespace {

constexpr std::int64_t page_points_max = 40'000;

/// The two axes of the largest extent.
std::array<std::size_t, 2> page_view_of(const Toolpath& path) {
  const std::size_t n = path.dimensions();
  std::vector<std::pair<double, std::size_t>> extent;
  for (std::size_t a = 0; a < n; ++a) {
    double low = INFINITY, high = -INFINITY;
    for (std::size_t i = 0; i <= path.blocks(); ++i) {
      low = std::min(low, path.point(i)[a]);
      high = std::max(high, path.point(i)[a]);
    }
    extent.emplace_back(low - high, a);
  }
  std::stable_sort(extent.begin(), extent.end());
  if (n == 1) return {0, 0};
  return {std::min(extent[0].second, extent[1].second), std::max(extent[0].second, extent[1].second)};
}

std::string arrays(const Toolpath& path, const Machine& machine, const ProgramMotion& motion, std::int64_t count) {
  const std::array<std::size_t, 2> view = page_view_of(path);
  const std::int64_t every = std::max<std::int64_t>(1, (count + page_points_max - 1) / page_points_max);
  std::string t, x, y, v, l;
  int binding = -1;
  visit_speeds(path, machine, motion, [&](std::int64_t k, const double* at, double speed, int binds) {
    binding = std::max(binding, binds);
    if (k % every != 0 && k + 1 != count) return;
    t += fmt::format("{:.6g},", static_cast<double>(k) * motion.sample_period);
    x += fmt::format("{:.4f},", at[view[0]] * 1e3);
    y += fmt::format("{:.4f},", path.dimensions() > 1 ? at[view[1]] * 1e3 : 0.0);
    v += fmt::format("{:.5g},", speed * 1e3);
    l += fmt::format("{},", binding);
    binding = -1;
  });
  std::string names;
  for (std::size_t i = 0; i < axis_limits.size(); ++i)
    names += fmt::format("\"{}\",", binding_name(static_cast<int>(i)));
  return fmt::format("const D={{t:[{}],x:[{}],y:[{}],v:[{}],l:[{}],names:[{}],other:\"{}\",ax:[\"{}\",\"{}\"]}};\n", t,
                     x, y, v, l, names, binding_name(-1), path.axis_name(view[0]), path.axis_name(view[1]));
}

}  // namespace

std::string program_page(const Toolpath& programmed, const Machine& machine, const ProgramMotion& motion) {
  std::int64_t count = 0;
  motion.samples([&](std::int64_t, const double*, const double*) { ++count; });
  std::vector<std::vector<std::string>> rows;
  for (const CornerLoss& loss : time_lost(programmed, motion)) {
    if (loss.count == 0) continue;
    rows.push_back({class_name(loss), fmt::format("{}", loss.count), fmt::format("{:.4f}", loss.time),
                    fmt::format("{:.3f}", 1e3 * loss.time / static_cast<double>(loss.count))});
  }
  std::string page = html_head(motion.title);
  page +=
      "<p>The path has the colour of its speed; the speed over time that of the limit that binds. Wheel or two "
      "fingers: "
      "zoom. Drag: move. Double click: everything. The pointer tells time, place and speed.</p>\n"
      "<canvas id=\"path\"></canvas>\n<p id=\"info\">&nbsp;</p>\n<canvas id=\"speed\"></canvas>\n"
      "<p id=\"legend\"></p>\n<h2>Time lost against the programmed feed</h2>\n";
  page += html_table({{"turn", "joints", "lost, s", "lost by each, ms"}, rows});
  page += "<script>\n" + arrays(programmed, machine, motion, count) + std::string(program_script) + "</script>\n" +
          html_foot();
  return page;
}

std::string program_page(const Toolpath& programmed, const Machine& machine, const ProgramResult& result) {
  return program_page(programmed, program_machine(machine, programmed), motion_of(result));
}

std::string program_page(const Toolpath& programmed, const Machine& machine, const ProfileResult& result) {
  return program_page(programmed, program_machine(machine, programmed), motion_of(result));
}

}  // namespace accdec
