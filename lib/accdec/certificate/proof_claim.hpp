#pragma once

#include <accdec/certificate/certificate.hpp>
#include <accdec/task/result.hpp>

namespace accdec {

/// What a result claims and its certificate says it proves, in samples of the objective; infinite: that there is no
/// design.
/// @throws Rejected if the two are not one, or the proof is about another objective or tighter limits than the task's
double claimed_samples(const Task& task, const DesignResult& result, const proof::BranchAndBound& proof);

}  // namespace accdec
