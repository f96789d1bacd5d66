#include <algorithm>
#include <cmath>

#include <accdec/exact/search.hpp>

namespace accdec::exact {
namespace {

/// A tube this narrow says that rounding decides.
constexpr double narrowest = 1e-9;
constexpr int deepest = 300;

}  // namespace

std::optional<SumBound> widest_break(const LimitModel& model, const Filter& filter, const Box& box) {
  double worst = 1.0 + 1e-9;
  SumBound split;
  bool broken = false;
  for (RowId id : model.families()) {
    for (id.sample = 1; id.sample <= model.last_sample(id, box); ++id.sample) {
      const double use = model.use(id, filter, box);
      if (use <= worst) continue;
      broken = true;
      const int d = id.corner < 0 ? 0 : box.corners[static_cast<std::size_t>(id.corner)].d1;
      double widest = narrowest;
      for (const int k : {id.sample, id.sample - d, id.sample - 1, id.sample - 1 - d}) {
        if (k < 1 || k > box.order) continue;
        const double low = box.tube.low[static_cast<std::size_t>(k)], high = box.tube.high[static_cast<std::size_t>(k)];
        // The speed before counts less: chords are exact in it.
        const double width = (high - low) * (k == id.sample || k == id.sample - d ? 1.0 : 1e-3);
        if (width <= widest) continue;
        widest = width;
        worst = use;
        split.sample = k;
        split.level = std::clamp(filter.cumulative(k), low + 0.2 * (high - low), high - 0.2 * (high - low));
      }
    }
  }
  if (!broken) return std::nullopt;
  return split;
}

Search::State Search::close(Multipliers y) {
  leave(Proof::Node::refuted);
  current_.tree.back().multipliers = keep(std::move(y));
  return State::closed;
}

Search::State Search::split_sum(const Box& box, const SumBound& at, bool symmetric, int depth) {
  if (at.sample == 0) return undecided();
  Proof::Node node;
  node.kind = Proof::Node::sum_split;
  node.at = at.sample;
  node.level = at.level;
  current_.tree.push_back(node);
  Box first = box, second = box;
  first.path.push_back({at.sample, true, at.level});
  second.path.push_back({at.sample, false, at.level});
  return both(refute_sums(std::move(first), symmetric, depth + 1),
              [&] { return refute_sums(std::move(second), symmetric, depth + 1); });
}

/// A box of single delays and samples, of symmetric filters of exactly its order or of all up to it.
Search::State Search::refute_sums(Box box, bool symmetric, int depth) {
  if (stopped() || depth > deepest) return undecided();
  if (!model_.shrink(box)) {
    Proof::Node node;
    node.kind = Proof::Node::unreachable;
    current_.tree.push_back(node);
    return State::closed;
  }
  Outcome outcome = relaxation_->solve(box, symmetric);
  if (outcome.kind == Outcome::refuted) return close(std::move(outcome.multipliers));
  if (outcome.kind != Outcome::feasible) {
    // The programme came to no conclusion; its parts may.
    SumBound middle;
    double widest = 1e-3;
    for (int k = 1; k <= box.order; ++k) {
      const double low = box.tube.low[static_cast<std::size_t>(k)], high = box.tube.high[static_cast<std::size_t>(k)];
      if (high - low > widest) widest = high - low, middle = {k, true, 0.5 * (low + high)};
    }
    return split_sum(box, middle, symmetric, depth);
  }
  std::vector<int> delays;
  for (const CornerBox& b : box.corners) delays.push_back(b.d1);
  const auto found = [&](const Filter& filter) {
    consider(trimmed(mended(filter, box, symmetric, delays), task_.design), delays);
    return best && best->value < target_ * (1.0 - 1e-9);
  };
  const auto split = widest_break(model_, *outcome.filter, box);
  if (!split) return found(*outcome.filter) ? State::found : undecided();
  if (depth % 8 == 0) {
    const auto repaired = relaxation_->repair(box, symmetric, *outcome.filter);
    if (repaired && found(*repaired)) return State::found;
  }
  return split_sum(box, *split, symmetric, depth);
}

}  // namespace accdec::exact
