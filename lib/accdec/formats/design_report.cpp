#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <initializer_list>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/files/shown_text.hpp>
#include <accdec/formats/design_report.hpp>
#include <accdec/machine/force_speed.hpp>
#include <accdec/machine/limit_unit.hpp>
#include <accdec/machine/mode_text.hpp>
#include <accdec/task/not_considered.hpp>
#include <accdec/task/settings_text.hpp>
#include <accdec/task/simulation.hpp>

namespace accdec {
namespace {

/// Width of a UTF-8 text in columns: approximately its number of code points.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

std::string text_of(const ReportTable& report, std::initializer_list<std::size_t> left) {
  TextTable table(report.head);
  for (const std::size_t column : left) table.left(column);
  for (const auto& row : report.rows) table.add(row);
  if (table.empty()) return "";
  return fmt::format("\n{}{}{}", table.str(), report.note, report.note.empty() ? "" : "\n");
}

constexpr const char* curve_note =
    "force speed: the bound is the curve's force at that speed. A sample on the curve uses 100 %, one of half its "
    "force "
    "and half its speed 50 %.";

/// A sample at a force-speed curve: N, what the curve allows there, m/s.
struct ForceAtSpeed {
  double force, allowed, speed;
};
/// None where the result has no such axis or corner.
std::optional<ForceAtSpeed> force_at_speed(const DesignResult& result, const LimitUse& use) {
  const Task& task = result.task;
  const std::vector<Axis>& axes = task.machine.axes;
  const auto axis = std::find_if(axes.begin(), axes.end(), [&](const Axis& a) { return a.name == use.axis; });
  const auto corner =
      std::find_if(task.corners.begin(), task.corners.end(), [&](const TaskCorner& c) { return c.name == use.corner; });
  const auto j = static_cast<std::size_t>(corner - task.corners.begin());
  if (!result.filter || axis == axes.end() || axis->force_speed.empty() || j >= result.corners.size()) return {};
  const Corner& legs = corner->geometry();
  const SampledResponse sampled = simulate_response(*result.filter, legs, result.corners[j].delay, task.sample_period,
                                                    task.machine, result.corners[j].feed_part);
  const SampledMotion& motion = sampled.motion();
  const Eigen::Index first = use.event == Event::start   ? motion.start
                             : use.event == Event::blend ? motion.corner
                                                         : motion.stop,
                     row = first + static_cast<Eigen::Index>(use.sample), a = axis - axes.begin();
  if (use.sample < 0 || row >= motion.velocity.rows()) return {};
  const double still = still_part * std::max(legs.feed_in, legs.feed_out);
  const std::vector<AxisState> states = axis_states(sampled, *axis, a, task.sample_period, still);
  const double speed = std::abs(motion.velocity(row, a));
  return ForceAtSpeed{std::abs(states[static_cast<std::size_t>(row)].force), force_at(*axis, speed), speed};
}

}  // namespace

std::string legend(std::initializer_list<std::string_view> words) {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 6> meanings{
      {{"N", "order of the filter: its number of taps minus 1"},
       {"d", "delay of each corner, samples, by which the next block starts later"},
       {"cycle", "time of the whole task; the filter counts once in a run from rest to rest"},
       {"corners", "sum of the times of all corners; the filter counts at each corner"},
       {"polyline", "smallest distance of the corner from the straight lines between samples"},
       {"contour", "largest distance of the path from the programmed legs"}}};
  std::string text;
  for (const std::string_view word : words) {
    const auto found = std::find_if(meanings.begin(), meanings.end(), [&](const auto& m) { return m.first == word; });
    if (found == meanings.end()) throw std::invalid_argument(fmt::format("the legend has no \"{}\"", word));
    text += fmt::format("{:<8}  {}\n", found->first, found->second);
  }
  return text;
}

ReportTable corner_report(const DesignResult& result) {
  ReportTable table{
      {"corner", "delay", "error um", "allowed um", "polyline um", "contour um", "least speed mm/s", "time ms"}, {}};
  for (std::size_t j = 0; j < result.corners.size(); ++j) {
    const CornerResult& c = result.corners[j];
    std::string allowed = "-";
    if (j < result.task.corners.size() && result.task.corners[j].error_max)
      allowed = fmt::format("{:.9g}", 1e6 * *result.task.corners[j].error_max);
    table.rows.push_back({c.name, fmt::format("{}", c.delay), fmt::format("{:.2f}", 1e6 * c.corner_error), allowed,
                          fmt::format("{:.2f}", 1e6 * c.polyline_error),
                          fmt::format("{:.2f}", 1e6 * c.contour_deviation), fmt::format("{:.2f}", 1e3 * c.speed_min),
                          fmt::format("{:g}", 1e3 * c.corner_time)});
  }
  return table;
}

ReportTable limit_report(const DesignResult& result) {
  // One line for each kind and axis: the corner with the highest use.
  std::vector<const LimitUse*> worst;
  for (const LimitUse& use : result.limits) {
    const bool by_mode = use.kind == LimitKind::vibration, in_metres = use.kind == LimitKind::residual;
    const auto same = std::find_if(worst.begin(), worst.end(), [&](const LimitUse* w) {
      return !by_mode && w->kind == use.kind && w->axis == use.axis && (!in_metres || w->bound == use.bound);
    });
    if (same == worst.end())
      worst.push_back(&use);
    else if (use.utilisation > (*same)->utilisation)
      *same = &use;
  }
  ReportTable table{{"limit", "axis", "used %", "value", "bound", "unit", "where"}, {}};
  for (const LimitUse* use : worst) {
    const LimitUnit unit = limit_unit(use->kind, use->axis);
    std::string kind(limit_word(use->kind, use->axis));
    std::replace(kind.begin(), kind.end(), '_', ' ');
    std::string where = use->kind == LimitKind::vibration ? place_of_vibration(*use, 4)
                        : use->kind == LimitKind::residual
                            ? fmt::format("{} {} {}", use->corner, to_string(use->event), place_of_vibration(*use, 4))
                            : fmt::format("{} {}, k = {}", use->corner, to_string(use->event), use->sample);
    double value = use->value, bound = use->bound;
    const auto at = use->kind == LimitKind::force_speed ? force_at_speed(result, *use) : std::nullopt;
    if (at) {
      value = at->force, bound = at->allowed;
      const LimitUnit speed = limit_unit(LimitKind::velocity, use->axis);
      where += fmt::format(", at {:.4g} {}", speed.per_si * at->speed, speed.name);
      table.note = curve_note;
    }
    if (use->utilisation > 1.0 + result.verification.tolerance) where += "  BROKEN";
    table.rows.push_back({kind, use->axis.empty() ? "-" : use->axis, fmt::format("{:.2f}", 100.0 * use->utilisation),
                          fmt::format("{:.6g}", unit.per_si * value), fmt::format("{:.9g}", unit.per_si * bound),
                          std::string(unit.name), where});
  }
  return table;
}

void TextTable::add(std::vector<std::string> row) {
  if (row.size() != header_.size())
    throw std::invalid_argument(fmt::format("{} cells for {} columns", row.size(), header_.size()));
  rows_.push_back(std::move(row));
}

std::string TextTable::str() const {
  std::vector<std::size_t> widths;
  for (std::size_t c = 0; c < header_.size(); ++c) {
    widths.push_back(width_of(header_[c]));
    for (const auto& row : rows_) widths[c] = std::max(widths[c], width_of(row[c]));
  }
  std::string text;
  const auto append = [&](const std::vector<std::string>& row) {
    std::string line;
    for (std::size_t c = 0; c < row.size(); ++c) {
      const std::string padding(widths[c] - width_of(row[c]), ' ');
      const bool left = std::find(left_.begin(), left_.end(), c) != left_.end();
      if (c > 0) line += "  ";
      line += left ? row[c] : padding;
      line += left ? padding : row[c];
    }
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  };
  append(header_);
  for (const auto& row : rows_) append(row);
  return text;
}

std::string result_text(const DesignResult& result) {
  std::string text;
  if (!result.task.title.empty()) text += result.task.title + "\n";
  text += settings_answer(result);
  text +=
      fmt::format("status      {}{}{}\n", to_string(result.status), result.message.empty() ? "" : ": ", result.message);
  if (result.filter) {
    text += fmt::format("filter      order {} ({} taps), sample period {:g} ms, mean delay {:.6g} ms\n",
                        result.filter->order(), result.filter->order() + 1, 1e3 * result.task.sample_period,
                        1e3 * result.task.sample_period * result.filter->mean_delay());
    text += fmt::format("cycle time  {:.6g} ms", 1e3 * result.cycle_time);
    if (result.corners.size() > 1 || result.cycle_time != result.corner_time) {
      text += fmt::format(", corners by themselves {:.6g} ms", 1e3 * result.corner_time);
      if (result.task.design.objective == Objective::corner) text += " (minimised)";
    }
    if (result.lower_bound) text += fmt::format(", proved not below {:.6g} ms", 1e3 * *result.lower_bound);
    if (result.gap) text += fmt::format(" (gap {:.3g} %)", 100.0 * *result.gap);
    if (!result.lower_bound && result.status == Status::feasible && result.solver.method != "given")
      text += ", nothing proved about shorter ones";
    text += "\n";
  }
  if (result.quantisation) {
    const Quantisation& q = *result.quantisation;
    text += fmt::format("taps        whole numbers over 2^{}; free taps take {:.6g} ms ({:.3g} % less)\n", q.bits,
                        1e3 * q.unquantised, 100.0 * (1.0 - q.unquantised / result.objective()));
  }
  if (const SolverReport& s = result.solver; !s.name.empty()) {
    text += fmt::format("solver      {}{}{} ({}){}, {} evaluations, {:.3g} ms\n", s.name, s.version.empty() ? "" : " ",
                        s.version, s.method, s.claimed.empty() ? "" : fmt::format(", claims \"{}\"", s.claimed),
                        s.evaluations, 1e3 * s.wall_time);
  }
  if (const VerificationReport& v = result.verification; v.performed) {
    text += fmt::format("verified    by simulation: {}\n", v.worst.empty() ? "the task has no limits"
                                                           : v.feasible    ? "all limits hold; worst " + v.worst
                                                                           : "NOT all limits hold; worst " + v.worst);
  }
  const auto slowest = std::max_element(result.corners.begin(), result.corners.end(),
                                        [](const auto& a, const auto& b) { return a.settling_time < b.settling_time; });
  if (slowest != result.corners.end() && slowest->settling_time > 0.0) {
    text += fmt::format("settled     {:.6g} ms after the end of the command within the tolerance (corner {})\n",
                        1e3 * slowest->settling_time, slowest->name);
  }
  if (result.filter) text += fmt::format("ignored     {}\n", not_considered_text(result.task.machine));
  text += text_of(corner_report(result), {});
  if (!result.corners.empty()) text += legend({"polyline", "contour"});
  return printable(text + text_of(limit_report(result), {1, 5, 6}));
}

void print_result(const DesignResult& result) {
  const std::string text = result_text(result);
  std::fwrite(text.data(), 1, text.size(), stdout);
}

}  // namespace accdec
