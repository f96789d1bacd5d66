#include <chrono>
#include <cmath>
#include <iterator>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <accdec/files/seconds_since.hpp>
#include <accdec/machine/utilisation.hpp>
#include <accdec/program/profiles/last_filter.hpp>
#include <accdec/program/profiles/profile_motion.hpp>
#include <accdec/program/write/profile_result.hpp>
#include <accdec/program/write/samples.hpp>
#include <accdec/task/verifier.hpp>

namespace accdec {
namespace {

void judge(ProfileResult& result) {
  const Toolpath& path = result.path;
  for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
    if (path.joint[b] == Joint::straight) continue;
    ++result.corners;
    result.stops += result.plan.chain.stops(b + 1) ? 1 : 0;
    if (!(path.tolerance[b] < unlimited) || path.joint[b] == Joint::stop) continue;
    const double error = result.plan.errors[b], use = utilisation_of(LimitKind::corner_error, error, path.tolerance[b]);
    result.worst_error = std::max(result.worst_error, error);
    if (use <= result.worst_utilisation && result.worst_line != 0) continue;
    result.worst_utilisation = use;
    result.worst_line = path.line[b];
  }
  if (result.plan.holds()) return;
  result.message = fmt::format("corner error: {:.1f} % of its tolerance, line {}", 100.0 * result.worst_utilisation,
                               result.worst_line);
  double worst = 1.0;
  for (const LimitUse& use : result.plan.check.limits) {
    if (use.utilisation <= worst) continue;
    worst = use.utilisation;
    result.message =
        use.kind == LimitKind::vibration
            ? fmt::format("vibration: {:.1f} % at {:.6g} Hz", 100.0 * use.utilisation, use.frequency)
            : fmt::format("{} {}: {:.1f} % at {}", to_string(use.kind), use.axis, 100.0 * use.utilisation, use.corner);
  }
  result.message = "a limit is broken: " + result.message;
}

/// Of the last filter, where its taps are equal; else 0.
int boxcar_taps(const ProfileResult& result) {
  return LastFilter(result.plan.last, result.sample_period).boxcar();
}

/// The last filter holds the bounds of all modes by itself.
void add_vibration(ProfileResult& result, const Machine& machine) {
  SampleCheck& check = result.plan.check;
  for (const LimitUse& use : vibration_utilisation(result.plan.last, result.sample_period, machine)) {
    check.limits_hold = check.limits_hold && use.utilisation <= 1.0 + verification_tolerance;
    check.limits.push_back(use);
    check.limit_lines.push_back(0);
  }
}

}  // namespace

ProfileResult run_profiles(const std::string& name, Toolpath path, const Task& task) {
  const auto start = std::chrono::steady_clock::now();
  if (!path.given.empty()) {
    throw std::invalid_argument(
        "plan profiles takes no delays from the program: it has no one filter that they "
        "belong to; leave out --dwells-before-filter");
  }
  ProfileResult result;
  result.program = name;
  result.path = std::move(path);
  result.sample_period = task.sample_period;
  const Machine machine = program_machine(task.machine, result.path);
  result.plan = plan_profiles(result.path, machine, task.sample_period);
  add_vibration(result, machine);
  result.cycle_time = static_cast<double>(result.plan.check.samples) * task.sample_period;
  judge(result);
  result.wall_time = seconds_since(start);
  return result;
}

std::string profiles_summary(const ProfileResult& result) {
  fmt::memory_buffer text;
  const auto put = std::back_inserter(text);
  fmt::format_to(put, "{}: {} blocks, {} corners, {} at rest\n", result.program, result.path.blocks(), result.corners,
                 result.stops);
  fmt::format_to(put, "plan profiles, T = {:.6g} ms, {} samples", result.sample_period * 1e3,
                 result.plan.check.samples);
  if (result.plan.last.order() > 0) {
    fmt::format_to(put, ", a last {} of {} taps", boxcar_taps(result) > 0 ? "boxcar" : "filter",
                   result.plan.last.order() + 1);
  }
  fmt::format_to(put, "\n\n");
  const auto row = [&](std::string_view what, double time) {
    fmt::format_to(put, "  {:<28}{:>14.4f} s{:>10.2f} %\n", what, time, 100.0 * time / result.cycle_time);
  };
  row("cycle time", result.cycle_time);
  for (const PlanTime& other : result.candidates) row(describe(other), other.time);
  row("bound, continuous motion", result.lower_bound);
  if (const auto& bound = result.corner_bound) {
    row("bound, corners", bound->time);
    fmt::format_to(put, "    {}\n", describe(*bound));
  }
  fmt::format_to(put, "\n  largest corner error {:.3f} um; most of its tolerance used: {:.1f} % in line {}\n",
                 result.worst_error * 1e6, 100.0 * result.worst_utilisation, result.worst_line);
  if (result.plan.rounds > 0) {
    fmt::format_to(put, "  slowed where samples broke a limit or a tolerance, in {} rounds\n", result.plan.rounds);
  }
  if (!result.plan.check.limits.empty()) {
    fmt::format_to(put, "\n  {:<14}{:<6}{:>12}{:>10}  {}\n", "limit", "axis", "bound", "use", "where");
  }
  for (const LimitUse& use : result.plan.check.limits) {
    fmt::format_to(put, "  {:<14}{:<6}{:>12.6g}{:>8.1f} %  {}\n", to_string(use.kind), use.axis, use.bound,
                   100.0 * use.utilisation,
                   use.kind == LimitKind::vibration ? fmt::format("{:.6g} Hz", use.frequency) : use.corner);
  }
  fmt::format_to(put, "\n  planned and verified in {:.3g} s\n", result.wall_time);
  fmt::format_to(
      put, "  {}\n",
      result.message.empty() ? "verified: every sample, all bounds hold" : "NOT verified: " + result.message);
  return fmt::to_string(text);
}

std::string profiles_to_json(const ProfileResult& result) {
  using Json = nlohmann::ordered_json;
  Json json;
  json["schema"] = "accdec.profiles/1";
  json["program"] = result.program;
  json["status"] = result.message.empty() ? "feasible" : "failed";
  json["sample_period_s"] = result.sample_period;
  json["plan"] = "profiles";
  if (!result.candidates.empty()) json["candidates"] = plan_times_to_json(result.candidates);
  json["blocks"] = result.path.blocks();
  json["last_boxcar_taps"] = boxcar_taps(result) > 0 ? Json(boxcar_taps(result)) : Json(nullptr);
  json["last_filter"] = {{"order", result.plan.last.order()},
                         {"taps", std::vector<double>(result.plan.last.taps().begin(), result.plan.last.taps().end())}};
  json["corners"] = {{"count", result.corners},
                     {"at_rest", result.stops},
                     {"worst_error_m", result.worst_error},
                     {"worst_utilisation", result.worst_utilisation},
                     {"worst_line", result.worst_line}};
  json["samples"] = result.plan.check.samples;
  json["cycle_time_s"] = result.cycle_time;
  json["lower_bound_s"] = result.lower_bound;
  if (const auto& bound = result.corner_bound) {
    json["corner_bound_s"] = bound->time;
    json["corner_bound"] = corner_bound_to_json(*bound);
  }
  json["repair_rounds"] = result.plan.rounds;
  Json limits = Json::array();
  for (std::size_t i = 0; i < result.plan.check.limits.size(); ++i) {
    const LimitUse& use = result.plan.check.limits[i];
    limits.push_back({{"kind", to_string(use.kind)},
                      {"axis", use.axis},
                      {"line", result.plan.check.limit_lines[i]},
                      {"value", use.value},
                      {"bound", use.bound},
                      {"utilisation", use.utilisation},
                      {"sample", use.sample}});
    if (use.kind == LimitKind::vibration) limits.back()["frequency_Hz"] = use.frequency;
  }
  json["limits"] = std::move(limits);
  json["verification"] = {{"performed", true}, {"feasible", result.message.empty()}};
  json["wall_time_s"] = result.wall_time;
  json["message"] = result.message;
  return json.dump(2) + "\n";
}

void visit_profile_samples(const ProfileResult& result, const SampleVisitor& visit) {
  const std::size_t n = result.path.dimensions();
  std::vector<double> before(result.path.point(0), result.path.point(0) + n), velocity(n, 0.0);
  visit(0, before.data(), velocity.data());
  ProfileMotion motion(result.path, result.plan.chain, result.sample_period, result.plan.last);
  for (std::int64_t k = 1; motion.next(); ++k) {
    for (std::size_t a = 0; a < n; ++a) {
      velocity[a] = (motion.position()[a] - before[a]) / result.sample_period;
      before[a] = motion.position()[a];
    }
    visit(k, motion.position(), velocity.data());
  }
}

void write_profile_samples(const ProfileResult& result, std::ostream& out) {
  SampleTable table(result.path, result.sample_period, out);
  visit_profile_samples(result, [&](std::int64_t k, const double* x, const double* v) { table.row(k, x, v); });
}

void stream_profile(const ProfileResult& result, std::ostream& out) {
  stream_row(result.path, result.path.point(0), out);
  ProfileMotion motion(result.path, result.plan.chain, result.sample_period, result.plan.last);
  while (motion.next()) stream_row(result.path, motion.position(), out);
}

}  // namespace accdec
