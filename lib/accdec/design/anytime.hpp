#pragma once

#include <accdec/design.hpp>
#include <accdec/exact/exact.hpp>

namespace accdec {

/// Method::exact within a time limit. The exact method looks for the proof. If it does not end soon, local solvers look
/// for a design, and the exact method continues from it. If power, regeneration or a smallest speed keep it from any
/// bound, the bound of the other limits is used. The result is the best verified design of all methods with the highest
/// bound. Linear programs that do not fit into memory are not started. Then only standard shapes and local solvers are
/// used, and nothing is proved.
DesignResult design_anytime(const Task& task, const DesignOptions& options);

/// Whether the exact method knows all limits of the task. It has no rows of a shared supply, nor of power with dry
/// friction. All axes must have one response without negative taps.
bool exact_covers(const Task& task);

/// The options that the exact method takes from these, whoever calls it.
/// @param time_limit  s, of this call
ExactOptions exact_options(const DesignOptions& options, double time_limit);

/// The gap between a design and its lower bound, if it has one; where they meet, the design is optimal.
void judge_gap(DesignResult& result);

}  // namespace accdec
