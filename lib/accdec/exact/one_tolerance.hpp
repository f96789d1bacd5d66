#pragma once

#include <functional>
#include <optional>

#include <accdec/exact/proof_draft.hpp>
#include <accdec/task.hpp>

namespace accdec::exact {

/// If delays of some of several corners are given, often no filter holds the tolerance of one of them with its delay.
/// That is proved in a moment. A search that splits the samples of all corners may take minutes.
/// @param late  ends the proof  @param stop  ends the search for a minimal set of limits in conflict, which follows it
/// @return the proof that the task has no design, with the limits in conflict; none: nothing is proved
std::optional<Proof> refute_one_tolerance(const Task& task, const std::function<bool()>& late,
                                          const std::function<bool()>& stop);

}  // namespace accdec::exact
