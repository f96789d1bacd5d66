#include <algorithm>
#include <chrono>
#include <cmath>

#include <accdec/design/anytime.hpp>
#include <accdec/design/covered_part.hpp>
#include <accdec/design/supply_start.hpp>
#include <accdec/files.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/task/delays_by_formula.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// The part of an axis in the sum of a property times the square of the direction; 1 if there is no such sum.
double part_of(const Machine& machine, const Eigen::VectorXd& direction, Eigen::Index axis, double Axis::*property) {
  double sum = 0.0;
  const auto of = [&](Eigen::Index a) {
    return machine.axes[static_cast<std::size_t>(a)].*property * direction[a] * direction[a];
  };
  for (Eigen::Index a = 0; a < direction.size(); ++a) sum += of(a);
  return sum > 0.0 ? of(axis) / sum : 1.0;
}

}  // namespace

Task with_supply_of_axes(const Task& task) {
  Task part = covered_part(task);
  for (const TaskCorner& corner : task.corners) {
    const Corner& geometry = corner.geometry();
    for (const Eigen::VectorXd& direction : {geometry.direction_in, geometry.direction_out}) {
      Eigen::Index most = 0;
      direction.cwiseAbs().maxCoeff(&most);
      Axis& axis = part.machine.axes[static_cast<std::size_t>(most)];
      // The exact method knows no power with dry friction.
      if (axis.coulomb > 0.0) continue;
      const double share = std::min(part_of(task.machine, direction, most, &Axis::mass),
                                    part_of(task.machine, direction, most, &Axis::damping));
      axis.power_max = std::min(axis.power_max, share * task.machine.power_total_max);
      axis.regeneration_max = std::min(axis.regeneration_max, share * task.machine.regeneration_total_max);
    }
  }
  return part;
}

std::optional<DesignResult> supply_start(const Task& task, const DesignOptions& options, double seconds) {
  if (!limits_supply(task.machine) || task.filter) return std::nullopt;
  const auto began = std::chrono::steady_clock::now();
  DesignOptions part = options;
  part.time_limit = 0.9 * seconds;
  part.progress = nullptr;
  part.exact.certificate = false;
  const DesignResult found = design_anytime(with_supply_of_axes(task), part);
  if (!found.has_design()) return std::nullopt;
  const auto stop = [&] {
    return seconds_since(began) > seconds || (options.cancel != nullptr && options.cancel->load());
  };
  const auto delays = delays_by_formula(*found.filter, task, unlimited, stop);
  if (!delays) return std::nullopt;
  DesignResult result = assess(task, *found.filter, *delays, false);
  if (!result.has_design()) return std::nullopt;
  result.solver = found.solver;
  return result;
}

}  // namespace accdec
