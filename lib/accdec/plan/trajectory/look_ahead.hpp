#pragma once

#include <accdec/simulate.hpp>

namespace accdec {

/// Computes speeds of all corners and peaks of all legs. Each corner gets a share of every leg that is too short for
/// both its corners. A backward pass covers braking, a forward pass speeding up. Then rounds raise each corner as far
/// as its neighbours allow. O(blocks). The result can be driven.
void look_ahead(ProfileChain& chain);

}  // namespace accdec
