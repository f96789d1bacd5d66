#include <algorithm>
#include <cmath>

#include <accdec/bounds/filter_bound.hpp>
#include <accdec/plan/report/leg_error.hpp>
#include <accdec/plan/report/samples.hpp>
#include <accdec/plan/report/servo_report.hpp>

namespace accdec {
namespace {

/// The least tolerance of corners, m; without any, that of arcs, less what their chords take.
double least_tolerance(const Toolpath& path) {
  constexpr double usual = 1e-6;  // without any
  double corners = unlimited, arcs = unlimited;
  for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
    double& least = is_chord(path, b) || is_chord(path, b + 1) ? arcs : corners;
    if (path.tolerance[b] > 0.0) least = std::min(least, path.tolerance[b]);
  }
  const double least = corners < unlimited ? corners : arcs;
  return least < unlimited ? least : usual;
}

}  // namespace

std::optional<ServoReport> servo_report(const ProgramResult& result, const Machine& machine) {
  const FilteredCommand* command = result.plan.command();
  if (command == nullptr || command->moved.empty()) return std::nullopt;
  const Toolpath& path = result.plan.path;
  double stops = 0.0;
  for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
    if (path.joint[b] == Joint::stop) stops = std::max(stops, result.errors[b]);
  }
  ServoReport report{
      .settling = 0.0, .within = least_tolerance(path), .stop_error = stops, .legs = leg_error(result, machine)};
  const double* end = path.point(path.blocks());
  std::int64_t settled = 0;
  const auto look = [&](std::int64_t k, const double* position, const double*) {
    double square = 0.0;
    for (std::size_t a = 0; a < path.dimensions(); ++a) square += (position[a] - end[a]) * (position[a] - end[a]);
    if (std::sqrt(square) > report.within) settled = k + 1;
  };
  visit_samples(result, look, Steady::passed, MotionOf::servo);
  report.settling =
      static_cast<double>(std::max<std::int64_t>(0, settled - result.check.samples)) * result.sample_period;
  return report;
}

}  // namespace accdec
