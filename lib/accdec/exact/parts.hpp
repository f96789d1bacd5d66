#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include <accdec/certificate.hpp>
#include <accdec/exact/box.hpp>

namespace accdec::exact {

/// Both parts of a split on a delay, a sample or the order.
std::pair<Box, Box> parts(const Box& box, const proof::Split& split);
std::pair<Box, Box> parts(const Box& box, const proof::OrderSplit& split);
std::pair<Box, Box> parts(const Box& box, const proof::ResponseSplit& split);
/// Contour times up to one, and from there on.
std::pair<Box, Box> parts(const Box& box, const proof::ContourSplit& split);
std::pair<Box, Box> parts(const Box& box, const proof::ReversalSplit& split);
/// @throws std::logic_error  of any other node
std::pair<Box, Box> parts(const Box& box, const proof::Node& node);
/// Whether two parts follow this node; whether they are of delays, samples, times or reversals of a corner.
bool splits(const proof::Node& node);
bool splits_corner(const proof::Node& node);
/// The first node after this one and its parts, in a tree in preorder.
std::size_t after(const std::vector<proof::Node>& tree, std::size_t node);

}  // namespace accdec::exact
