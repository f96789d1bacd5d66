#pragma once

#include <string>
#include <utility>

#include <accdec/certificate/checked_rows.hpp>

namespace accdec {

/// The parts of a box with a delay or sample up to a value, and above it.
/// @throws Rejected if the split names no corner, or a value outside the box
std::pair<CheckedBox, CheckedBox> checked_parts(const proof::Split& split, const CheckedBox& whole);
/// The parts with B_k at most a level, and at least that level.
/// @throws Rejected if no filter up to the order has this response, or the level is outside 0 .. 1
std::pair<CheckedBox, CheckedBox> checked_parts(const proof::ResponseSplit& split, const CheckedBox& whole, int order);
/// The parts with a contour time at most a value, and at least that value.
/// @throws Rejected unless the value is inside the range
std::pair<CheckedBox, CheckedBox> checked_parts(const proof::ContourSplit& split, const CheckedBox& whole);
/// The parts in which an axis reverses up to a sample, and after it.
/// @throws Rejected if the sample is not inside the range
std::pair<CheckedBox, CheckedBox> checked_parts(const proof::ReversalSplit& split, const CheckedBox& whole);
/// The parts with an instant at most a value, and at least that value.
/// @throws Rejected if the part is not about instants, or the value is outside the range
std::pair<CheckedBox, CheckedBox> checked_parts(const proof::InstantSplit& split, const CheckedBox& whole);
/// The box in words, for what is said about it.
std::string describe(const CheckedBox& box);

}  // namespace accdec
