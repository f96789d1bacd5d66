#pragma once

#include <nlohmann/json.hpp>

#include <accdec/result.hpp>

namespace accdec::explore {

inline constexpr int longest_drawn = 100'000;  ///< taps: half a second

/// The motion at one corner of a design in the units of people: for drawing, so every number that is an answer stands
/// in the result instead. It has every sample, or of a long motion as many points as can be seen, with all peaks: at
/// most 0.8 MB of text for two axes.
/// @throws std::invalid_argument without a filter or such a corner, and for a filter too long to draw
nlohmann::ordered_json view_json(const DesignResult& result, std::size_t corner);

}  // namespace accdec::explore
