#pragma once

#include <string>

#include <accdec/design.hpp>

namespace accdec {

/// A note after a proof that no filter of order_max or less holds the limits: it tells whether a longer one does. This
/// matters to users who did not set order_max. For a verified design it is "; a longer filter does: with [design]
/// order_max = 611 ...". Otherwise it says that there is none up to some larger order either, or that neither is known.
/// @param seconds  time allowed for it
std::string larger_order_note(const Task& task, double seconds, const std::atomic<bool>* cancel);

}  // namespace accdec
