#pragma once

#include <accdec/certificate.hpp>
#include <accdec/result.hpp>

namespace accdec {

/// The bound that a result claims and its certificate proves, in samples of the objective; infinite: there is no
/// design.
/// @throws Rejected if the two differ, or the proof is about another objective or tighter limits than the task's
double claimed_samples(const Task& task, const DesignResult& result, const proof::BranchAndBound& proof);

}  // namespace accdec
