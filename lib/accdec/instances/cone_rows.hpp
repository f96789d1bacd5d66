#pragma once

#include <vector>

#include <accdec/instances/instance.hpp>

namespace accdec::instances {

/// A convex row of degree 2: sum_n parts_n(x)^2 <= slack(x). The parts have no constants.
struct ConvexRow {
  std::vector<Affine> parts;
  Affine slack;
};

/// @throws std::invalid_argument naming the row if it is not of this kind
ConvexRow convex_row(const Instance::Row& row);

/// Whether a row has terms of degree 2 or an approach.
bool nonlinear(const Instance::Row& row);

}  // namespace accdec::instances
