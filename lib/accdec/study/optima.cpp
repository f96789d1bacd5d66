#include <chrono>
#include <utility>

#include <accdec/design/recheck.hpp>
#include <accdec/study/optima.hpp>

namespace accdec::study {

double Optimum::samples() const {
  if (!design.filter) return 0.0;
  double weighted = 0.0, weights = 0.0;
  for (std::size_t j = 0; j < design.corners.size(); ++j) {
    weighted += design.task.corners[j].weight * design.corners[j].delay;
    weights += design.task.corners[j].weight;
  }
  return design.filter->order() + (weights > 0.0 ? weighted / weights : 0.0);
}

std::optional<std::size_t> Optimum::best_shape() const {
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    if (shapes[i] && (!best || *shapes[i] < *shapes[*best])) best = i;
  }
  return best;
}

std::optional<double> Optimum::saving() const {
  const auto best = best_shape();
  if (!best || !design.filter) return std::nullopt;
  return 1.0 - design.objective() / *shapes[*best];
}

Optimum find_optimum(std::string name, Task task, const DesignOptions& options, bool with_shapes) {
  Optimum found;
  found.name = std::move(name);
  task.filter.reset();
  found.design = design_task(task, options);
  const auto began = std::chrono::steady_clock::now();
  const Recheck check = recheck(found.design);
  found.check_time = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  found.accepted = check.accepted;
  if (!check.reasons.empty()) found.objection = check.reasons.front();
  found.certificate_bytes = found.design.certificate.size();
  found.design.certificate.clear();
  for (std::size_t i = 0; with_shapes && i < standard_shapes.size(); ++i) {
    const StandardShapeResult shape = best_standard_shape(task, standard_shapes[i]);
    if (shape.result.filter) found.shapes[i] = shape.result.objective();
  }
  return found;
}

}  // namespace accdec::study
