#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <accdec/machine.hpp>

namespace accdec {

/// Effects of the real machine that a result of a task leaves out.
enum class NotConsidered {
  vibration,  ///< the task names no mode: what the filter leaves ringing is not bounded
  servo       ///< an axis has no servo: the command after the filter is taken as its motion
};
inline constexpr std::array not_considered_all{NotConsidered::vibration, NotConsidered::servo};
std::string_view to_string(NotConsidered what);

/// In the order of the enumeration.
std::vector<NotConsidered> not_considered(const Machine& machine);

/// The same in words, joined by semicolons: one line of every summary.
/// @param rated  names of the axes whose drives' ratings were considered
std::string not_considered_text(const Machine& machine, const std::vector<std::string>& rated = {});

}  // namespace accdec
