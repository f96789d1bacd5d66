#pragma once

#include <functional>
#include <memory>
#include <string>

#include <accdec/certificate/certificate.hpp>
#include <accdec/task/result.hpp>

namespace accdec {

struct CheckReport {
  bool accepted = false;
  std::string reason;  ///< why not, or what was shown
};

/// Rechecks the bound a result claims (its cycle time if `optimal`, its lower bound if `feasible`, that there is no
/// design at all if `infeasible`) from its task and its certificate alone. Shares nothing with the exact method but the
/// model: every row is set up again from the task, in interval arithmetic, and every leaf of the proof needs sum_r y_r
/// (row_r - bound_r) > 0 for all filters in the box, whatever the multipliers y >= 0 (weak duality; Neumaier and
/// Shcherbina, Math. Program. 99, 2004). The tree has to cover every order, delay and sample. Designs themselves are
/// checked by `verify_by_simulation`.
/// @param stop  polled; true ends the check, which then has accepted nothing
CheckReport check_certificate(const Task& task, const DesignResult& result, const std::function<bool()>& stop = {});

/// The certificate of a task whose limits contradict each other whatever the filter (task/contradictions.hpp).
std::shared_ptr<const Certificate> certify_contradiction(const Task& task);

}  // namespace accdec
