#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include <accdec/plot/figure_style.hpp>
#include <accdec/plot/path_follower.hpp>
#include <accdec/plot/program_motion_panels.hpp>

namespace accdec {
namespace {

constexpr double columns_drawn = 600.0;  ///< about as many as a plot has pixels
constexpr std::size_t classes_drawn = 5;
constexpr int thin_solid = figure_style::thin_style, thin_dashed = thin_solid + 1,
              bar_style = figure_style::design_style;

struct TimePoint {
  double t = 0.0, v = 0.0;  ///< s, mm/s or mm
};

/// A speed or a place over time. For every column of pixels it keeps the first, lowest, highest and last point, which
/// draw the same as all points.
class TimeTrace {
 public:
  explicit TimeTrace(double column) : column_(column) {}

  /// The motion from one sample to the next, in the order of time.
  void add(const TimePoint& from, const TimePoint& to) {
    const double column = std::floor(to.t / column_);
    if (points_.empty() || column != at_) {
      end_column();
      if (!x.empty() && from.t > x.back()) put({NAN, NAN});
      // `from` may lie many columns before: a steady motion is two points, whatever follows in this column.
      if (x.empty() || !(from.t <= x.back())) put(from);
      at_ = column;
      points_ = {to, to, to, to};
    }
    if (to.v < points_[1].v) points_[1] = to;
    if (to.v > points_[2].v) points_[2] = to;
    points_[3] = to;
  }
  void end_column() {
    std::stable_sort(points_.begin(), points_.end(), [](const auto& a, const auto& b) { return a.t < b.t; });
    for (const TimePoint& point : points_) {
      if (x.empty() || !(point.t <= x.back())) put(point);
    }
    points_.clear();
  }
  std::vector<double> x, y;

 private:
  void put(const TimePoint& point) {
    x.push_back(point.t);
    y.push_back(point.v);
  }
  double column_, at_ = 0.0;
  std::vector<TimePoint> points_;  ///< first, lowest, highest and last of this column
};

}  // namespace

Panel speed_over_time_panel(const Toolpath& programmed, const Machine& machine, const ProgramMotion& motion) {
  std::map<int, TimeTrace> traces;  // by what binds
  TimePoint before;
  double highest = 0.0;
  const std::size_t axes = programmed.dimensions();
  visit_velocities(machine, motion, [&](std::int64_t k, const double*, const double* velocity, int binding) {
    const TimePoint now{static_cast<double>(k) * motion.sample_period, 1e3 * speed_of(velocity, axes)};
    highest = std::max(highest, now.v);
    if (k > 0) traces.try_emplace(binding, motion.cycle_time / columns_drawn).first->second.add(before, now);
    before = now;
  });
  Panel panel;
  panel.title = "speed by the limit that binds";
  // The scale is for cutting: if rapid moves are far faster, the title says so.
  double feed = 0.0;
  for (std::size_t b = 0; b < programmed.blocks(); ++b)
    if (programmed.rapid[b] == 0) feed = std::max(feed, 1e3 * block_feed(programmed, b));
  if (feed > 0.0 && highest > 2.0 * feed) {
    panel.title += fmt::format("; rapid moves reach {:.4g} mm/s", highest);
    highest = feed;
  }
  panel.x.label = "time / s";
  panel.y.label = "speed / mm/s";
  panel.x.min = 0.0, panel.x.max = motion.cycle_time;
  panel.y.min = 0.0, panel.y.max = highest > 0.0 ? 1.06 * highest : 1.0;
  const auto styles = binding_styles(machine);
  for (auto& [binding, trace] : traces) {
    trace.end_column();
    Series series{binding_name(binding), std::move(trace.x), std::move(trace.y), Mark::line, thin_solid};
    // Dashes would look like gaps between the limits.
    if (binding >= 0) series.style = styles.at(static_cast<std::size_t>(binding)), series.solid = true;
    panel.series.push_back(std::move(series));
  }
  return panel;
}

Panel place_over_time_panel(const Toolpath& path, std::size_t column, const ProgramMotion& motion) {
  std::array<TimeTrace, 2> traces{TimeTrace(motion.cycle_time / columns_drawn),
                                  TimeTrace(motion.cycle_time / columns_drawn)};
  PathFollower follower(path);
  TimePoint before;
  motion.samples([&](std::int64_t k, const double* position, const double* velocity) {
    const TimePoint now{static_cast<double>(k) * motion.sample_period, 1e3 * position[column]};
    follower.follow(position, velocity);
    if (k > 0) traces.at(path.rapid[follower.block()]).add(before, now);
    before = now;
  });
  Panel panel;
  panel.title = fmt::format("{} over time", path.axis_name(column));
  panel.x.label = "time / s";
  panel.y.label = fmt::format("{} / {}", path.axis_name(column), rotary_axis(path.axes[column]) ? "deg" : "mm");
  panel.x.min = 0.0, panel.x.max = motion.cycle_time;
  for (std::size_t rapid = 0; rapid < traces.size(); ++rapid) {
    traces[rapid].end_column();
    if (traces[rapid].x.empty()) continue;
    panel.series.push_back({rapid == 0 ? "feed moves" : "rapid moves", std::move(traces[rapid].x),
                            std::move(traces[rapid].y), Mark::line, rapid == 0 ? thin_solid : thin_dashed});
  }
  return panel;
}

Panel time_lost_panel(const Toolpath& programmed, const ProgramMotion& motion) {
  std::vector<CornerLoss> classes = time_lost(programmed, motion);
  double sum = 0.0;
  for (const CornerLoss& loss : classes) sum += loss.time;
  std::stable_sort(classes.begin(), classes.end(), [](const auto& a, const auto& b) { return a.time > b.time; });
  Series bars{"", {}, {}, Mark::bars, bar_style};
  Panel panel;
  for (const CornerLoss& loss : classes) {
    if (bars.x.size() == classes_drawn || loss.count == 0 || !(loss.time > 0.0)) break;
    bars.x.push_back(static_cast<double>(bars.x.size() + 1));
    bars.y.push_back(loss.time);
    panel.x.names.push_back(class_name(loss));
  }
  panel.title = fmt::format("time lost against the programmed feed, {:.4g} s of the {:.6g} s", sum, motion.cycle_time);
  panel.x.label = "at corners that turn by";
  panel.y.label = "time lost / s";
  // One bar alone does not fill the panel.
  panel.x.min = 0.5, panel.x.max = 0.5 + static_cast<double>(std::max<std::size_t>(bars.x.size(), 2));
  panel.y.min = 0.0, panel.y.max = bars.y.empty() ? 1.0 : 1.06 * bars.y.front();
  panel.series.push_back(std::move(bars));
  return panel;
}

}  // namespace accdec
