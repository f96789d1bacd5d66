#pragma once

#include <nlohmann/json.hpp>

#include <accdec/result.hpp>

namespace accdec::explore {

inline constexpr int longest_drawn = 20'000;  ///< taps: 8 MB in a second

/// The motion at one corner of a design, sample by sample, in the units of people: for drawing, so every number that is
/// an answer stands in the result instead. A filter of 1000 taps makes 0.4 MB in 20 ms.
/// @throws std::invalid_argument without a filter or such a corner, and for a filter too long to draw
nlohmann::ordered_json view_json(const DesignResult& result, std::size_t corner);

}  // namespace accdec::explore
