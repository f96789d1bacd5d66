#include <stdexcept>

#include <accdec/exact/parts.hpp>

namespace accdec::exact {

std::pair<Box, Box> parts(const Box& box, const proof::OrderSplit& split) {
  std::pair<Box, Box> both{box, box};
  both.first.order_most = split.at;
  both.second.order_least = split.at + 1;
  return both;
}

std::pair<Box, Box> parts(const Box& box, const proof::Split& split) {
  std::pair<Box, Box> both{box, box};
  const auto j = static_cast<std::size_t>(split.corner);
  CornerBox &first = both.first.corners[j], &second = both.second.corners[j];
  (split.on_delay ? first.d2 : first.k2) = split.at;
  (split.on_delay ? second.d1 : second.k1) = split.at + 1;
  return both;
}

std::pair<Box, Box> parts(const Box& box, const proof::ResponseSplit& split) {
  std::pair<Box, Box> both{box, box};
  both.first.path.push_back({split.sample, true, split.level});
  both.second.path.push_back({split.sample, false, split.level});
  return both;
}

std::pair<Box, Box> parts(const Box& box, const proof::ContourSplit& split) {
  std::pair<Box, Box> both{box, box};
  const auto j = static_cast<std::size_t>(split.corner);
  both.first.corners[j].c2 = both.second.corners[j].c1 = split.at;
  return both;
}

std::pair<Box, Box> parts(const Box& box, const proof::ReversalSplit& split) {
  ReversalRange range = box.reversal(split.corner, split.axis);
  Box rest = box;
  std::erase_if(rest.reversals,
                [&](const ReversalRange& r) { return r.corner == split.corner && r.axis == split.axis; });
  std::pair<Box, Box> both{rest, std::move(rest)};
  both.first.reversals.push_back({split.corner, split.axis, range.first, split.at});
  range.first = split.at + 1;
  both.second.reversals.push_back(range);
  return both;
}

bool splits(const proof::Node& node) {
  return splits_corner(node) || std::holds_alternative<proof::OrderSplit>(node) ||
         std::holds_alternative<proof::ResponseSplit>(node) || std::holds_alternative<proof::SymmetricOrders>(node);
}

bool splits_corner(const proof::Node& node) {
  return std::holds_alternative<proof::Split>(node) || std::holds_alternative<proof::ContourSplit>(node) ||
         std::holds_alternative<proof::ReversalSplit>(node);
}

std::pair<Box, Box> parts(const Box& box, const proof::Node& node) {
  if (const auto* response = std::get_if<proof::ResponseSplit>(&node)) return parts(box, *response);
  if (const auto* order = std::get_if<proof::OrderSplit>(&node)) return parts(box, *order);
  if (const auto* split = std::get_if<proof::Split>(&node)) return parts(box, *split);
  if (const auto* contour = std::get_if<proof::ContourSplit>(&node)) return parts(box, *contour);
  if (const auto* reversal = std::get_if<proof::ReversalSplit>(&node)) return parts(box, *reversal);
  throw std::logic_error("a node of a proof that is no split of a box has no parts");
}

std::size_t after(const std::vector<proof::Node>& tree, std::size_t node) {
  for (std::size_t left = 1; left > 0; --left, ++node) {
    if (splits(tree[node])) left += 2;
  }
  return node;
}

}  // namespace accdec::exact
