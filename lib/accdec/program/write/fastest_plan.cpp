#include <algorithm>
#include <optional>
#include <utility>

#include <accdec/program/plan/lower_bound.hpp>
#include <accdec/program/write/fastest_plan.hpp>

namespace accdec {
namespace {

/// The path may be off a chord's end by the tolerance, and the chord off its arc by more: room for that.
void leave_room_for_arcs(Toolpath& path, double arc_tolerance) {
  const auto inside = [&](std::size_t b) { return path.inside_arc[b] != 0; };
  for (std::size_t b = 0; b < path.blocks(); ++b) {
    const double tolerance = path.tolerance[b];
    const bool arc = inside(b) || (b > 0 && inside(b - 1)) || (b + 1 < path.blocks() && inside(b + 1));
    if (arc) path.tolerance[b] = std::max(0.5 * tolerance, tolerance - arc_tolerance);
  }
}

PlanTime time_of(const ProfileResult& r) {
  return {"profiles", r.cycle_time, r.message.empty()};
}
PlanTime time_of(const ProgramResult& r) {
  return {r.legs.single() ? "fixed" : "per-leg", r.cycle_time, r.verification.feasible};
}

}  // namespace

ProfileResult plan_profiles_of(const std::string& name, Toolpath path, double arc_tolerance, const Task& task) {
  const double bound = program_lower_bound(path, program_machine(task.machine, path), task.sample_period);
  leave_room_for_arcs(path, arc_tolerance);
  ProfileResult result = run_profiles(name, std::move(path), task);
  result.lower_bound = bound;
  return result;
}

CornerBound corner_bound_of(const Toolpath& path, const Task& task) {
  return program_corner_bound(path, program_machine(task.machine, path), task.sample_period, 10.0);
}

std::variant<ProfileResult, ProgramResult> run_fastest_plan(const std::string& name, ProgramFile& file,
                                                            const Task& task, const ProgramFileOptions& options,
                                                            const std::function<void(const std::string&)>& tell) {
  // Of the longest programs the search for a filter, and the bound by linear programs, would take longer than the plan.
  const bool several = file.path.blocks() <= several_plans_max;
  ProfileResult profiles = plan_profiles_of(name, file.path, file.reading.read.arc_tolerance, task);
  if (!several) return profiles;
  profiles.corner_bound = corner_bound_of(file.path, task);
  ProgramFileOptions choosing = options;
  choosing.feeds = Feeds::choose;
  choosing.per_leg = true;  // the plan of one filter is a candidate of it
  ProgramFile copy = file;
  ProgramResult other = run_program_file(name, copy, task, choosing, tell);
  if (other.plan.delays.empty()) return profiles;
  const PlanTime mine = time_of(profiles), theirs = time_of(other);
  if (theirs.verified && (!mine.verified || theirs.time < mine.time)) {
    other.candidates = {mine};
    other.corner_bound = profiles.corner_bound;
    file.reading = copy.reading;
    return other;
  }
  profiles.candidates = {theirs};
  return profiles;
}

}  // namespace accdec
