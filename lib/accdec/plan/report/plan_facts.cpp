#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/plan/delays/pairwise_delays.hpp>
#include <accdec/plan/report/plan_facts.hpp>
#include <accdec/task/delay_kinds.hpp>
#include <accdec/verify.hpp>

namespace accdec {

double error_of(const ProgramResult& result, std::size_t b) {
  const bool reached = result.plan.trajectory() != nullptr && result.plan.path.joint[b] == Joint::stop;
  return reached || result.errors[b] <= position_floor ? 0.0 : result.errors[b];
}

std::vector<std::string> control_needs(const ProgramResult& result) {
  if (result.plan.trajectory() != nullptr) {
    return {
        fmt::format("take a position of every axis every {:.6g} ms; an override that slows its clock keeps the path",
                    1e3 * result.sample_period)};
  }
  std::vector<std::string> needs;
  if (const std::size_t moves = result.plan.path.blocks(); result.feeds_chosen && moves > result.programmed_moves)
    needs.push_back(fmt::format("step its feed inside blocks ({} steps)", moves - result.programmed_moves));
  needs.push_back(fmt::format("filter all axes alike ({} taps)", result.plan.set().order() + 1));
  // Exact stops are waited for by every control; chords of arcs may need a delay, too.
  std::size_t held = 0;
  for (std::size_t b = 0; b + 1 < result.plan.path.blocks(); ++b)
    held += result.plan.path.joint[b] != Joint::stop && result.plan.delay(b) > 0 ? 1 : 0;
  if (held > 0)
    needs.push_back(fmt::format("delay the command at {} corners by whole samples, before the filter", held));
  return needs;
}

bool rests_after(const Plan& plan, std::size_t block) {
  if (plan.path.joint[block] == Joint::stop) return true;
  const FilteredCommand* command = plan.command();
  if (command == nullptr) return !plan.trajectory()->is_free() && plan.trajectory()->chain.stops(block + 1);
  return command->delays[block] >= std::max(1, exact_stop_delay(command->filter));
}

std::size_t blocks_of(const Toolpath& programmed) {
  return static_cast<std::size_t>(std::count(programmed.inside_arc.begin(), programmed.inside_arc.end(), 0));
}

std::size_t smooth_turns(const Toolpath& path) {
  return static_cast<std::size_t>(std::count(path.joint.begin(), path.joint.end(), Joint::smooth));
}

std::vector<std::string> left_out_by_residuals(const ProgramResult& result) {
  std::set<std::string> axes;
  for (const LimitUse& use : result.check.limits) {
    if (use.kind == LimitKind::residual) axes.insert(use.axis);
  }
  std::vector<std::string> left_out;
  if (axes.empty()) return left_out;
  const std::string of = fmt::format("{} of {}: ", to_string(LimitKind::residual), fmt::join(axes, ", "));
  const Toolpath& path = result.plan.path;
  if (const std::size_t turns = smooth_turns(path); turns > 0)
    left_out.push_back(
        fmt::format("{}judged at the ends of arcs and other smooth turns, not inside them ({} points)", of, turns));
  bool passed = false;
  for (std::size_t b = 0; b + 1 < path.blocks() && !passed; ++b) passed = !rests_after(result.plan, b);
  if (passed)
    left_out.push_back(of + "earlier corners are not added where the motion has gone on evenly since, except at rests");
  return left_out;
}

double largest_widening(const Toolpath& path) {
  double most = 0.0;
  const std::size_t n = path.dimensions();
  for (std::size_t i = 0; i <= path.blocks() && !path.programmed.empty(); ++i) {
    double sum = 0.0;
    for (std::size_t a = 0; a < n; ++a)
      sum += (path.point(i)[a] - path.programmed_point(i)[a]) * (path.point(i)[a] - path.programmed_point(i)[a]);
    most = std::max(most, std::sqrt(sum));
  }
  return most;
}

std::vector<CornerUse> worst_corners(const ProgramResult& result, std::size_t count) {
  // Sorted, never more than `count`: programs have many joints, few of which are among the worst.
  std::vector<CornerUse> worst;
  const auto offer = [&](const CornerUse& corner) {
    if (worst.size() == count && corner.utilisation <= worst.back().utilisation) return;
    if (worst.size() == count) worst.pop_back();
    const auto after = std::upper_bound(worst.begin(), worst.end(), corner.utilisation,
                                        [](double use, const CornerUse& other) { return use > other.utilisation; });
    worst.insert(after, corner);
  };
  std::optional<CornerUse> of_line;
  const Toolpath& path = result.plan.path;
  for (std::size_t b = 0; b + 1 < path.blocks() && count > 0; ++b) {
    if (!(path.tolerance[b] < unlimited)) continue;
    const double error = error_of(result, b);
    const double use = utilisation_of(LimitKind::corner_error, error, path.tolerance[b]);
    const CornerUse corner{path.line[b], error, path.tolerance[b], use, result.plan.delay(b)};
    if (of_line && of_line->line != corner.line) offer(*of_line);
    if (!of_line || of_line->line != corner.line || use > of_line->utilisation) of_line = corner;
  }
  if (of_line) offer(*of_line);
  return worst;
}

std::string delays_to_csv(const ProgramResult& result) {
  fmt::memory_buffer text;
  const auto put = std::back_inserter(text);
  fmt::format_to(put, "line,delay_samples,corner_error_m,error_max_m\n");
  const Toolpath& path = result.plan.path;
  for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
    if (path.joint[b] == Joint::straight && result.plan.delay(b) == 0) continue;
    const double error = error_of(result, b);
    fmt::format_to(put, "{},{},{:.9g},", path.line[b], result.plan.delay(b), error);
    if (path.tolerance[b] < unlimited) fmt::format_to(put, "{:.9g}", path.tolerance[b]);
    fmt::format_to(put, "\n");
  }
  return fmt::to_string(text);
}

}  // namespace accdec
