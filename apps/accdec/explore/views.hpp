#pragma once

#include <nlohmann/json.hpp>

#include <accdec/result.hpp>

namespace accdec::explore {

/// The motion of every corner of a design, sample by sample, in the units of people: for drawing, so every number that
/// is an answer stands in the result instead. Empty without a filter, and with one too long to draw.
nlohmann::ordered_json views_json(const DesignResult& result);

}  // namespace accdec::explore
