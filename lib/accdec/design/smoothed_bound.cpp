#include <algorithm>
#include <utility>

#include <accdec/certificate.hpp>
#include <accdec/design/smoothed_bound.hpp>
#include <accdec/task/delays_by_formula.hpp>
#include <accdec/task/objective.hpp>
#include <accdec/task/symmetry.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

int smoothing_order(const Task& task) {
  return std::max(0, static_cast<int>(task.machine.prefilter_taps.size()) - 1);
}

}  // namespace

Task filter_with_smoothing(const Task& task) {
  Task one = task;
  const std::vector<double> taps = std::exchange(one.machine.prefilter_taps, {});
  one.design.order_min += smoothing_order(task);
  one.design.order_max += smoothing_order(task);
  one.design.symmetric = one.design.symmetric && std::equal(taps.begin(), taps.end(), taps.rbegin());
  return one;
}

DesignResult without_smoothing(const Task& task, DesignResult found) {
  if (task.machine.prefilter_taps.empty()) return found;
  const double shorter = cost_of(task).filter * smoothing_order(task);
  if (found.lower_bound) found.lower_bound = std::max(0.0, *found.lower_bound - shorter * task.sample_period);
  const auto* tree = found.certificate ? std::get_if<proof::BranchAndBound>(&found.certificate->proof) : nullptr;
  if (tree == nullptr) {
    // Limits that contradict each other: nothing is said of a bound, and the task's own check finds them.
    if (found.status != Status::infeasible) found.certificate.reset();
    return found;
  }
  proof::BranchAndBound proof = *tree;
  proof.smoothed = true;
  if (proof.bound_samples) proof.bound_samples = std::max(0.0, *proof.bound_samples - shorter);
  found.certificate = std::make_shared<Certificate>(Certificate{std::move(proof)});
  return found;
}

std::optional<DesignResult> in_front_of_smoothing(const Task& task, const Filter& filter,
                                                  const std::function<bool()>& stop) {
  if (filter.order() > task.design.order_max || !symmetric_as_asked(task, filter)) return std::nullopt;
  const auto delays = delays_by_formula(filter, task, unlimited, stop);
  if (!delays) return std::nullopt;
  return assess(task, filter, *delays, false);
}

}  // namespace accdec
