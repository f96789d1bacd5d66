#pragma once

#include <utility>
#include <vector>

#include <accdec/filter.hpp>

// Internal to the room: where the motion of a linear program's taps ends.

namespace accdec::exact {

/// The share of a last tap that is left at zero. It ends the motion there, and no limit feels it.
inline constexpr double end_share = 1e-13;

/// The filter with a last tap that is not zero. Rows of damped modes count what is left at the order's end, and all
/// others at the last tap that is not zero.
inline Filter ended(const Filter& filter) {
  std::vector<double> taps(filter.taps().begin(), filter.taps().end());
  if (taps.back() == 0.0) taps.back() = end_share;
  return Filter(std::move(taps));
}

}  // namespace accdec::exact
