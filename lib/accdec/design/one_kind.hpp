#pragma once

#include <algorithm>

#include <accdec/design.hpp>

// Internal to the room: free taps for a control that runs on at every corner, or stops exactly at every one.

namespace accdec {

/// Gives a delay to every corner that the task gives none. @param of  of a corner's number
template <class DelayOf>
void give_delays(const Task& task, const DelayOf& of, Task& given) {
  for (std::size_t j = 0; j < given.corners.size(); ++j) given.corners[j].delay = task.corners[j].delay.value_or(of(j));
}

inline constexpr const char* no_given_stops = "no filter of the orders asked for has exact stops of the given delays";

/// Keeps the orders of filters whose exact stops have the given delays; false if there are none. An exact stop starts
/// leg 2 when the command behind filter and smoothing has ended, or a sample later.
bool keep_given_stops(Task& task);

/// For a control that runs on at every corner, or stops exactly at every one: the delays are then given. An exact stop
/// lasts as long as the filter or a sample more, so that the shortest filter is the best. No shorter one holds all
/// limits with any delay behind which the legs are apart, and the proof with its own one says so.
/// @throws std::invalid_argument with `no_given_stops`
DesignResult design_for_one_kind(const Task& asked, bool stops, const DesignOptions& options);

}  // namespace accdec
