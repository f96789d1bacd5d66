#include <memory>
#include <utility>
#include <vector>

#include <accdec/certificate.hpp>
#include <accdec/design/merged_result.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// The proof of a merged task as a proof of the whole task.
std::shared_ptr<const Certificate> of_whole(const Certificate& certificate, const MergedTask& merged) {
  Certificate whole = certificate;
  if (auto* proof = std::get_if<proof::BranchAndBound>(&whole.proof)) proof->corner_of = merged.of;
  return std::make_shared<Certificate>(std::move(whole));
}

}  // namespace

std::optional<DesignResult> of_whole_task(const Task& task, const MergedTask& merged, const DesignResult& found) {
  DesignResult result = found;
  if (found.has_design()) {
    std::vector<int> delays;
    for (const CornerResult& c : found.corners) delays.push_back(c.delay);
    result = assess(task, *found.filter, merged.expand(delays), false);
    if (!result.has_design()) return std::nullopt;
    result.status = found.status, result.stop = found.stop, result.message = found.message;
    result.solver = found.solver, result.gap = found.gap;
    // The same sum in another order.
    result.lower_bound = found.status == Status::optimal ? result.objective() : found.lower_bound;
  }
  result.task = task;
  if (found.certificate) result.certificate = of_whole(*found.certificate, merged);
  return result;
}

}  // namespace accdec
