#pragma once

#include <functional>
#include <string>
#include <vector>

#include <accdec/task/result.hpp>

namespace accdec {

/// What an independent recheck of a stored result found.
struct ResultCheck {
  bool accepted = false;
  std::vector<std::string> reasons;  ///< why not; empty when accepted
  VerificationReport verification;   ///< of the simulation run now
  std::string proof;                 ///< what was checked of the lower bound, in words; empty without one
};

/// Rechecks a result from its task, taps and delays alone: every limit by simulation, every recorded number against
/// what is found now (relative 1e-9), order and symmetry against the task's bounds, given filter and delays against
/// those used, and the proof behind `optimal` or a lower bound.
/// Status, stop, bound, gap and certificate must not contradict each other, and a limit must be used as much as
/// anywhere at the event and sample (or the frequency) that it names. An infeasible result carries nothing besides: no
/// bound, gap, filter, corner, limit, time or finding. Nothing can be recomputed of `message` and `solver`, nor of why
/// the search of a design ended.
/// @param stop  polled while a proof is checked; true rejects it
ResultCheck verify_result(const DesignResult& result, const std::function<bool()>& stop = {});

}  // namespace accdec
