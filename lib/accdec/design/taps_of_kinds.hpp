#pragma once

#include <functional>

#include <accdec/design.hpp>

namespace accdec {

/// Any taps as what to set.
ChosenSettings as_settings(const Filter& filter);
/// Settings with the cheapest delays of the kinds that the task's control has. No design if there are none that cost
/// less than `below` samples, or if `stop` ends the search.
DesignResult with_delays_of_kinds(const Task& task, const ChosenSettings& chosen, double below,
                                  const std::function<bool()>& stop = {});

/// Free taps with delays of the kinds that a control has, for tasks whose free taps are not delayed by any number of
/// samples, or stand beside other families. The taps that are best with any delays are tried with the control's kinds,
/// and so are members of families. The bound is that of any delays: `optimal` if both meet, else `feasible` with the
/// gap. Several corners of one in-position width are proved by the exact method. Corner feeds take less time than any
/// delay at feed may. Few corners with corner feeds, delays of 0 and exact stops alone have a bound of their own, if
/// all limits are in proportion to the feed. Nothing else is proved with corner feeds. A control that only runs on, or
/// only stops exactly, gives the delays itself, and the design is proved.
/// @param task  with settings that name taps; its [filter] is today's setting, where it names other families too
/// @throws std::invalid_argument for a given filter without other families
DesignResult design_taps_of_kinds(const Task& task, const DesignOptions& options);

}  // namespace accdec
