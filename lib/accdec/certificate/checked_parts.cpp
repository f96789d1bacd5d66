#include <fmt/format.h>

#include <accdec/certificate/checked_parts.hpp>

namespace accdec {

std::pair<CheckedBox, CheckedBox> checked_parts(const proof::Split& n, const CheckedBox& whole) {
  if (n.corner < 0 || n.corner >= static_cast<int>(whole.corners.size()))
    throw Rejected("the tree splits a corner that is not there");
  CheckedBox first = whole, second = whole;
  const auto j = static_cast<std::size_t>(n.corner);
  CheckedRange &a = first.corners[j], &b = second.corners[j];
  if (n.at < (n.on_delay ? a.d1 : a.k1) || n.at >= (n.on_delay ? a.d2 : a.k2))
    throw Rejected("the tree splits outside the box");
  (n.on_delay ? a.d2 : a.k2) = n.at;
  (n.on_delay ? b.d1 : b.k1) = n.at + 1;
  return {std::move(first), std::move(second)};
}

std::pair<CheckedBox, CheckedBox> checked_parts(const proof::ContourSplit& n, const CheckedBox& whole) {
  if (n.corner < 0 || n.corner >= static_cast<int>(whole.corners.size()))
    throw Rejected("the tree splits a corner that is not there");
  const auto j = static_cast<std::size_t>(n.corner);
  if (!(n.at > whole.corners[j].c1 && n.at < whole.corners[j].c2)) throw Rejected("the tree splits outside the box");
  std::pair<CheckedBox, CheckedBox> both{whole, whole};
  both.first.corners[j].c2 = both.second.corners[j].c1 = n.at;
  return both;
}

std::pair<CheckedBox, CheckedBox> checked_parts(const proof::ResponseSplit& n, const CheckedBox& box, int last) {
  if (n.sample < 1 || n.sample > last) throw Rejected("the tree splits a response that is not there");
  if (!(n.level >= 0.0 && n.level <= 1.0)) throw Rejected("the tree splits a response outside 0 .. 1");
  std::pair<CheckedBox, CheckedBox> both{box, box};
  both.first.cuts.push_back({n.sample, true, n.level});
  both.second.cuts.push_back({n.sample, false, n.level});
  return both;
}

std::pair<CheckedBox, CheckedBox> checked_parts(const proof::ReversalSplit& n, const CheckedBox& whole) {
  const CheckedReversal range = whole.reversal(n.corner, n.axis);
  if (n.at < range.first || n.at >= range.last) throw Rejected("the tree splits outside the box");
  CheckedBox rest = whole;
  std::erase_if(rest.reversals, [&](const CheckedReversal& r) { return r.corner == n.corner && r.axis == n.axis; });
  std::pair<CheckedBox, CheckedBox> both{rest, rest};
  both.first.reversals.push_back({n.corner, n.axis, range.first, n.at});
  both.second.reversals.push_back({n.corner, n.axis, n.at + 1, range.last});
  return both;
}

std::pair<CheckedBox, CheckedBox> checked_parts(const proof::InstantSplit& n, const CheckedBox& whole) {
  if (!whole.instants) throw Rejected("the tree splits instants, which are none of a design");
  if (!(n.at >= whole.instants->first && n.at <= whole.instants->last))
    throw Rejected("the tree splits outside the box");
  std::pair<CheckedBox, CheckedBox> both{whole, whole};
  both.first.instants->last = both.second.instants->first = n.at;
  return both;
}

std::string describe(const CheckedBox& box) {
  std::string text = fmt::format("order up to {}", box.order);
  for (const CheckedRange& r : box.corners)
    text += fmt::format(", d = {} .. {} (k = {} .. {})", r.d1, r.d2, r.k1, r.k2);
  for (const CheckedCut& c : box.cuts)
    text += fmt::format(", B_{} {} {:.6g}", c.sample, c.upper ? "<=" : ">=", c.level);
  for (const CheckedReversal& r : box.reversals)
    text += fmt::format(", corner {}'s axis {} reverses at {} .. {}", r.corner, r.axis, r.first, r.last);
  if (box.instants) text += fmt::format(", instants {:.9g} .. {:.9g}", box.instants->first, box.instants->last);
  return text;
}

}  // namespace accdec
