#pragma once

#include <string>

#include <accdec/design/design.hpp>

namespace accdec {

/// After a proof that no filter of order_max or less holds the limits: whether a longer one does, which a user who
/// never wrote order_max would want to know: "; a longer filter does: with [design] order_max = 611 ..." of a verified
/// design, that up to some larger order there is none either, or that neither is known.
/// @param seconds  that may be spent on it
std::string larger_order_note(const Task& task, double seconds, const std::atomic<bool>* cancel);

}  // namespace accdec
