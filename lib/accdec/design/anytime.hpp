#pragma once

#include <accdec/design/design.hpp>

namespace accdec {

/// Method::exact within a time limit: the exact method for the proof; where that does not end soon, local solvers for
/// a design, which the exact method then goes on from; where power, regeneration or a smallest speed keep it from any
/// bound, the bound that the other limits give. What comes is the best verified design of them all with the highest
/// bound.
/// Linear programs that would not fit into the memory there is are not begun: then standard shapes and local solvers
/// are left, and nothing is proved.
DesignResult design_anytime(const Task& task, const DesignOptions& options);

}  // namespace accdec
