#include <chrono>
#include <cmath>
#include <iterator>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <accdec/program/plan/lower_bound.hpp>
#include <accdec/program/profiles/motion.hpp>
#include <accdec/program/profiles/profile_result.hpp>

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
        fmt::format("{} {}: {:.1f} % at {}", to_string(use.kind), use.axis, 100.0 * use.utilisation, use.corner);
  }
  result.message = "a limit is broken: " + result.message;
}

}  // namespace

ProfileResult run_profiles(const std::string& name, Toolpath path, const Task& task, double bound_time) {
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
  result.cycle_time = static_cast<double>(result.plan.check.samples) * task.sample_period;
  result.lower_bound = program_lower_bound(result.path, machine);
  if (bound_time > 0.0) {
    result.corner_bound = program_corner_bound(result.path, machine, task.sample_period, bound_time);
  }
  judge(result);
  result.wall_time = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

std::string profiles_summary(const ProfileResult& result) {
  fmt::memory_buffer text;
  const auto put = std::back_inserter(text);
  fmt::format_to(put, "{}: {} blocks, {} corners, {} at rest\n", result.program, result.path.blocks(), result.corners,
                 result.stops);
  fmt::format_to(put, "plan profiles, T = {:.6g} ms, {} samples", result.sample_period * 1e3,
                 result.plan.check.samples);
  if (result.plan.taps > 1) fmt::format_to(put, ", a last boxcar of {} taps for the jerk", result.plan.taps);
  fmt::format_to(put, "\n\n");
  const auto row = [&](std::string_view what, double time) {
    fmt::format_to(put, "  {:<28}{:>14.4f} s{:>10.2f} %\n", what, time, 100.0 * time / result.cycle_time);
  };
  row("cycle time", result.cycle_time);
  row("bound, continuous motion", result.lower_bound);
  if (const auto& bound = result.corner_bound) {
    row("bound, corners", bound->time);
    fmt::format_to(put, "    {} of {} corners between legs that come to their feed, {} linear programmes{}\n",
                   bound->counted, bound->corners, bound->classes,
                   bound->complete ? "" : ", stopped by the time limit");
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
                   100.0 * use.utilisation, use.corner);
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
  json["blocks"] = result.path.blocks();
  json["last_boxcar_taps"] = result.plan.taps;
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
    json["corner_bound"] = {{"corners", bound->corners},
                            {"counted", bound->counted},
                            {"classes", bound->classes},
                            {"complete", bound->complete}};
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
  }
  json["limits"] = std::move(limits);
  json["verification"] = {{"performed", true}, {"feasible", result.message.empty()}};
  json["wall_time_s"] = result.wall_time;
  json["message"] = result.message;
  return json.dump(2) + "\n";
}

void write_profile_samples(const ProfileResult& result, std::ostream& out) {
  const Toolpath& path = result.path;
  const std::size_t n = path.dimensions();
  fmt::memory_buffer text;
  const auto put = std::back_inserter(text);
  fmt::format_to(put, "time_s");
  for (std::size_t a = 0; a < n; ++a) {
    const std::string unit = path.axes[a] >= 3 && path.axes[a] < 6 ? "deg" : "mm";
    fmt::format_to(put, ",{0}_{1},{0}_{1}_s", path.axis_name(a), unit);
  }
  fmt::format_to(put, "\n0");
  std::vector<double> before(path.point(0), path.point(0) + n);
  for (const double x : before) fmt::format_to(put, ",{:.9f},0", x * 1e3);
  text.push_back('\n');
  ProfileMotion motion(path, result.plan.chain, result.sample_period, result.plan.taps);
  for (std::int64_t k = 1; motion.next(); ++k) {
    fmt::format_to(put, "{:.9g}", static_cast<double>(k) * result.sample_period);
    for (std::size_t a = 0; a < n; ++a) {
      const double x = motion.position()[a];
      fmt::format_to(put, ",{:.9f},{:.6f}", x * 1e3, (x - before[a]) / result.sample_period * 1e3);
      before[a] = x;
    }
    text.push_back('\n');
    if (text.size() < 60000) continue;
    out.write(text.data(), static_cast<std::streamsize>(text.size()));
    text.clear();
  }
  out.write(text.data(), static_cast<std::streamsize>(text.size()));
}

void stream_profile(const ProfileResult& result, std::ostream& out) {
  const Toolpath& path = result.path;
  const std::size_t n = path.dimensions();
  const auto line = [&](const double* position) {
    for (std::size_t a = 0; a < n; ++a) out << fmt::format("{}{:.9f}", a == 0 ? "" : " ", position[a] * 1e3);
    out << std::endl;  // the controller waits for it
  };
  line(path.point(0));
  ProfileMotion motion(path, result.plan.chain, result.sample_period, result.plan.taps);
  while (motion.next()) line(motion.position());
}

}  // namespace accdec
