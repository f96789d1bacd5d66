#include <accdec/design/design.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/design/limit_rows.hpp>

namespace accdec {

DesignResult design_task(const Task& task, const DesignOptions& options) {
  const std::vector<std::string> conflicts = contradictions(task);
  if (!conflicts.empty()) {
    DesignResult result;
    result.task = task;
    result.status = Status::infeasible;
    result.message = fmt::format("limits in conflict: {}", fmt::join(conflicts, "; "));
    return result;
  }
  if (task.filter) return design_delays(task, options);
  return design_nlp(task, options);
}

}  // namespace accdec
