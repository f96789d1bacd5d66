#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include <accdec/certificate/checked_leaves.hpp>
#include <accdec/certificate/checked_parts.hpp>

namespace accdec {

std::vector<double> CheckedLeaves::least_of_taps(CheckedSum& sum, bool symmetric) const {
  Interval suffix(0.0);
  for (std::size_t i = sum.taps.size(); i-- > 0;) {
    suffix = suffix + sum.cumulative[i + 1];
    sum.taps[i] = sum.taps[i] + suffix;
  }
  std::vector<double> least;
  for (const Interval& c : sum.taps) least.push_back(c.lo);
  if (symmetric) {
    const std::vector<double> plain = least;
    for (std::size_t i = 0; i < least.size(); ++i)
      least[i] = (0.5 * (Interval(plain[i]) + Interval(plain[plain.size() - 1 - i]))).lo;
  }
  return least;
}

const proof::Multipliers& CheckedLeaves::set(int index) const {
  if (index < 0 || index >= static_cast<int>(multipliers_.size()))
    throw Rejected("the tree names multipliers that are not there");
  return multipliers_[static_cast<std::size_t>(index)];
}

void CheckedLeaves::refute_instants(const proof::RefutedInstants& node, CheckedBox box, bool symmetric) {
  if (!box.instants) throw Rejected("the tree refutes instants, which are none of a design");
  constexpr double most = 1e8;
  if (!(std::abs(node.in) <= most && std::abs(node.out) <= most)) throw Rejected("a tangent is out of range");
  std::optional<double> angle;
  for (const int index : {node.first, node.last}) {
    for (const proof::Term& term : set(index)) {
      const auto* error = std::get_if<proof::Error>(&term.row);
      if (error == nullptr) continue;
      if (angle.value_or(error->angle) != error->angle)
        throw Rejected("instants are refuted by errors in more than one direction");
      angle = error->angle;
    }
  }
  box.tangents = CheckedTangents{node.in, node.out, box.instants->first};
  refute(node.first, box, symmetric);
  box.tangents->at = box.instants->last;
  refute(node.last, box, symmetric);
}

void CheckedLeaves::refute(int index, CheckedBox box, bool symmetric) {
  const proof::Multipliers& rows = set(index);
  ++checked_;
  CheckedSum sum(box.order, box.window);
  sum.delays.resize(box.corners.size());
  sum.samples.resize(box.corners.size());
  for (const proof::Term& term : rows) {
    if (stop_ && stop_()) throw Rejected("it could not be checked in the time allowed");
    rows_.add(term, box, sum);
  }
  if (box.nothing_left) return;
  double at_ends = unlimited;
  std::vector<double> least = least_of_taps(sum, symmetric);
  const double tap_max = rows_.tap_max();
  if (box.window) {
    // The ends are not bounded by the largest tap: lambda is at most their coefficients.
    at_ends = std::min(least.front(), least.back());
    least.front() = least.back() = at_ends;
  }
  // For any lambda: sum c b >= lambda + sum u min(0, c - lambda). The best is the c at which the cheapest taps are
  // full.
  const double room = 1.0 / tap_max;
  if (!box.window && static_cast<double>(least.size()) < room * (1.0 - 1e-12))
    return;  // not even full taps reach a sum of 1
  std::vector<double> sorted = least;
  const auto full = static_cast<std::ptrdiff_t>(std::min(static_cast<double>(sorted.size() - 1), room));
  std::nth_element(sorted.begin(), sorted.begin() + full, sorted.end());
  const double lambda = std::min(at_ends, sorted[static_cast<std::size_t>(full)]);
  Interval bound(lambda);
  for (const double c : least) {
    if (!(c >= lambda)) bound = bound + Interval(tap_max) * (Interval(c) - Interval(lambda));
  }
  bound = bound - sum.rhs;
  for (std::size_t j = 0; j < box.corners.size(); ++j) {
    const CheckedRange& r = box.corners[j];
    if (sum.delays[j].lo < 0.0) bound = bound + Interval(sum.delays[j].lo) * static_cast<double>(r.d2 - r.d1);
    if (sum.samples[j].lo < 0.0) bound = bound + Interval(sum.samples[j].lo) * static_cast<double>(r.k2 - r.k1);
  }
  if (!(bound.lo > 0.0)) {
    throw Rejected(fmt::format("{} is not refuted by its multipliers (margin {:.3g})", describe(box), bound.lo));
  }
}

void CheckedLeaves::require_unreachable(const CheckedBox& box) {
  ++checked_;
  if (rows_.tube(box)) throw Rejected(fmt::format("{} is called unreachable, but is not", describe(box)));
}

}  // namespace accdec
