#pragma once

#include <accdec/design.hpp>

namespace accdec {

/// Free taps with delays of the kinds that a control has, for tasks whose free taps are not delayed by any number of
/// samples, or stand beside other families. The taps that are best with any delays are tried with the control's kinds,
/// and so are members of families. The bound is that of any delays: `optimal` if both meet, else `feasible` with the
/// gap. Corner feeds take less time than any delay at full feed may, so that nothing is proved where they are named.
/// A control that only runs on, or only stops exactly, gives the delays itself, and the design is proved.
/// @param task  with settings that name taps; its [filter] is today's setting, where it names other families too
/// @throws std::invalid_argument for a given filter without other families
DesignResult design_taps_of_kinds(const Task& task, const DesignOptions& options);

}  // namespace accdec
