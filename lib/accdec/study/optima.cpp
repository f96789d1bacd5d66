#include <chrono>
#include <utility>

#include <accdec/files.hpp>
#include <accdec/formats/certificate_json.hpp>
#include <accdec/study/optima.hpp>
#include <accdec/verify.hpp>

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

const FamilyResult* Optimum::best_family() const {
  const FamilyResult* best = nullptr;
  for (const FamilyResult& family : families) {
    if (!family.result.filter) continue;
    if (best == nullptr || family.result.objective() < best->result.objective()) best = &family;
  }
  return best;
}

std::optional<double> Optimum::saving() const {
  const FamilyResult* best = best_family();
  if (best == nullptr || !design.filter) return std::nullopt;
  return 1.0 - design.objective() / best->result.objective();
}

Optimum find_optimum(std::string name, Task task, const DesignOptions& options, bool with_families) {
  Optimum found;
  found.name = std::move(name);
  task.filter.reset();
  found.design = design_task(task, options);
  const auto began = std::chrono::steady_clock::now();
  const ResultCheck check = verify_result(found.design);
  found.check_time = seconds_since(began);
  found.accepted = check.accepted;
  if (!check.reasons.empty()) found.objection = check.reasons.front();
  if (found.design.certificate) found.certificate_bytes = certificate_to_json(*found.design.certificate).size();
  found.design.certificate.reset();
  if (with_families) found.families = best_members(task);
  return found;
}

}  // namespace accdec::study
