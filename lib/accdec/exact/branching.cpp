#include <algorithm>
#include <cmath>
#include <limits>

#include <accdec/exact/branching.hpp>
#include <accdec/exact/contour_path.hpp>
#include <accdec/exact/corner_error.hpp>
#include <accdec/exact/parts.hpp>

namespace accdec::exact {
namespace {

constexpr std::size_t most_tried = 8;
constexpr double refuted_gain = 1e3;

/// The delay that a filter needs at a corner within its ranges; d2 + 1 if none will do.
int needed_delay(const LimitModel& model, const Filter& filter, std::size_t j, const CornerBox& c, int order) {
  if (!model.cone(j)) return c.d1;
  const CornerError error(model, filter, j);
  for (int d = c.d1; d <= c.d2; ++d) {
    if (error.holds(d, c, order)) return d;
  }
  return c.d2 + 1;
}

/// A level of a range at which both parts keep at least a fifth.
int within(double at, int first, int last) {
  const int margin = (last - first) / 5;
  return std::clamp(static_cast<int>(std::floor(at)), first + margin, last - 1 - margin);
}

struct Scored {
  proof::Node node;
  double score;
};

proof::Node split_node(std::size_t corner, bool on_delay, int at) {
  return proof::Split{static_cast<int>(corner), on_delay, at};
}

/// Splits by how much delay the linear program's filter lacks, weighted.
std::vector<Scored> candidates(const LimitModel& model, const Box& box, const Outcome& outcome) {
  std::vector<Scored> found;
  for (std::size_t j = 0; j < box.corners.size(); ++j) {
    const CornerBox& c = box.corners[j];
    if (!box.ranges(j) || !outcome.filter) continue;
    const double weight = model.task().corners[j].weight, delay = c.d1 + outcome.delays[j];
    const int needed = needed_delay(model, *outcome.filter, j, c, box.order);
    if (needed <= delay + 1e-6) continue;
    const double lacking = weight * (needed - delay);
    if (c.d1 < c.d2) {
      const double half = std::floor(0.5 * (delay + needed) - 1e-9);
      found.push_back({split_node(j, true, std::clamp(static_cast<int>(half), c.d1, c.d2 - 1)), lacking});
    }
    // The sample first: it bounds both distances.
    if (c.k1 < c.k2)
      found.push_back({split_node(j, false, within(c.k1 + outcome.samples[j], c.k1, c.k2)), 1.01 * lacking});
  }
  if (outcome.filter) {
    if (const auto missed = missed_contour(model, *outcome.filter, box)) {
      const double weight = model.task().corners[static_cast<std::size_t>(missed->corner)].weight;
      found.push_back({proof::ContourSplit{missed->corner, missed->at}, 2.0 * weight * missed->by});
    }
  }
  if (!found.empty()) return found;
  // The errors hold, but other limits of the blend do not: these need single delays.
  for (std::size_t j = 0; j < box.corners.size(); ++j) {
    const CornerBox& c = box.corners[j];
    if (c.d1 < c.d2) found.push_back({split_node(j, true, c.d1 + (c.d2 - c.d1) / 2), 2.0 * (c.d2 - c.d1)});
    if (model.cone(j) && c.k1 < c.k2)
      found.push_back({split_node(j, false, c.k1 + (c.k2 - c.k1) / 2), static_cast<double>(c.k2 - c.k1)});
  }
  return found;
}

}  // namespace

std::optional<proof::Node> Branching::split_of_long_orders(const Box& box) const {
  if (!box.budget) return std::nullopt;
  const int least = std::max({task_.design.order_min, 0, box.order_least, bench_.smallest_order});
  const int at = least + std::max(2, least / 6);
  if (box.order <= at + at / 6) return std::nullopt;
  return proof::OrderSplit{at};
}

std::optional<double> Branching::try_part(Box box) {
  if (!bench_.narrow(box, nullptr) || bench_.told_to_stop()) return std::nullopt;
  if (draft_.refuted_before(box) >= 0) return std::nullopt;
  Outcome outcome = bench_.relaxation().solve(box, false);
  if (outcome.kind == Outcome::refuted) {
    draft_.remember(draft_.keep(std::move(outcome.multipliers)));
    return std::nullopt;
  }
  if (outcome.filter) designs_.offer(*outcome.filter);
  return outcome.excess;
}

proof::Node Branching::choose_split(const Box& whole, const Box& box, const Outcome& outcome) {
  std::vector<Scored> tried = candidates(model_, box, outcome);
  const int least = std::max({task_.design.order_min, 0, box.order_least});
  if (least < box.order)
    tried.push_back({proof::OrderSplit{least + (box.order - least) / 2}, std::numeric_limits<double>::infinity()});
  std::sort(tried.begin(), tried.end(), [](const Scored& a, const Scored& b) { return a.score > b.score; });
  // Linear programs of long filters cost most, and they refute about the same wherever they are split.
  const std::size_t most = 3 * box.order > 4 * bench_.smallest_order + 12 ? 2 : most_tried;
  if (tried.size() > most) tried.resize(most);
  std::size_t chosen = 0;
  double promise = -1.0;
  for (std::size_t i = 0; i < tried.size() && tried.size() > 1; ++i) {
    const auto [first, second] = parts(whole, tried[i].node);
    const auto gain = [&](const Box& part) {
      const auto excess = try_part(part);
      return excess ? std::max(0.0, *excess - outcome.excess) : refuted_gain;
    };
    const double a = gain(first), b = gain(second);
    if (bench_.told_to_stop() || bench_.below_target()) break;
    const double product = (a + 1e-6) * (b + 1e-6);
    if (product > promise) promise = product, chosen = i;
    if (a == refuted_gain && b == refuted_gain) break;
  }
  return tried[chosen].node;
}

/// Splits to reduce the error that the filter misses most. If the filter holds all errors, other limits of the blend
/// are broken. These bind only a single delay, or the order that a longer delay leaves.
proof::Node Branching::split_alone(const Filter& filter, const Box& box) const {
  const CornerBox& c = box.corners.front();
  ErrorSplit chosen;
  if (model_.cone(0)) {
    const CornerError error(model_, filter, 0);
    if (!error.holds(c.d2, c, box.order)) consider_splits(error, 0, c, c.k1 == c.k2, chosen);
  }
  const auto missed = missed_contour(model_, filter, box);
  if (missed && missed->by > std::max(0.0, chosen.gain)) return proof::ContourSplit{0, missed->at};
  if (chosen.gain > 0.0) return chosen.split;
  if (c.d1 < c.d2) return proof::Split{0, true, c.d1 + (c.d2 - c.d1) / 2};
  return proof::Split{0, false, c.k1 + (c.k2 - c.k1) / 2};
}

}  // namespace accdec::exact
