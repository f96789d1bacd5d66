#include <algorithm>

#include <fmt/format.h>

#include <accdec/certificate/checked_rows.hpp>
#include <accdec/certificate/proof_claim.hpp>
#include <accdec/task/corner_feed.hpp>
#include <accdec/task/objective.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// The difference between the proof's objective and limits and the task's; empty if there is none.
std::string other_question(const Task& task, const proof::BranchAndBound& proof) {
  if (proof.objective != task.design.objective)
    return fmt::format("the certificate is about the objective \"{}\", the task's is \"{}\"",
                       to_string(proof.objective), to_string(task.design.objective));
  if (proof.tolerance != granted_tolerance)
    return fmt::format("the certificate is about limits widened by {:.3g}, verification grants {:.3g}", proof.tolerance,
                       granted_tolerance);
  const bool given = std::ranges::any_of(task.corners, [](const TaskCorner& c) { return c.delay.has_value(); });
  if (proof.in_position && (!task.settings || task.settings->delays != std::vector{DelayKind::in_position} || given))
    return "the certificate is about delays by one in-position width, the task's control may have others";
  // Free taps pass slower where the control cannot wait for any number of samples.
  const auto& control = task.settings;
  const bool slower = control && control->names(DelayKind::corner_feed) && !control->any_delay();
  if (slower || may_pass_slower(task))
    return "the certificate is about corners at their feeds, the task's control may pass them at a part of the feed";
  if (proof.objective != Objective::cycle || proof.runs == task.design.runs) return {};
  return fmt::format("the certificate is about {} runs, the task asks for {}", proof.runs, task.design.runs);
}

}  // namespace

double claimed_samples(const Task& task, const DesignResult& result, const proof::BranchAndBound& proof) {
  if (const std::string other = other_question(task, proof); !other.empty()) throw Rejected(other);
  if (result.status == Status::infeasible) {
    if (proof.bound_samples) throw Rejected("the certificate proves a bound, not that nothing exists");
    return unlimited;
  }
  if (!result.lower_bound) throw Rejected("the result claims no lower bound");
  const bool optimal = result.status == Status::optimal;
  if (optimal && *result.lower_bound < result.objective() * (1.0 - 1e-9))
    throw Rejected("the status is optimal, but the lower bound is below the cycle time");
  if (!proof.bound_samples) throw Rejected("the certificate proves that nothing exists, the result has a design");
  const double target = (optimal ? result.objective() : *result.lower_bound) / task.sample_period;
  if (*proof.bound_samples < target * (1.0 - 1e-9))
    throw Rejected(
        fmt::format("the certificate proves {} samples, the result claims {}", *proof.bound_samples, target));
  return *proof.bound_samples;
}

}  // namespace accdec
