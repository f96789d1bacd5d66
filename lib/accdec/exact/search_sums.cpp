#include <algorithm>
#include <cmath>

#include <accdec/exact/search.hpp>

namespace accdec::exact {
namespace {

/// In a tube this narrow, rounding decides.
constexpr double narrowest = 1e-9;
constexpr int deepest = 300;

}  // namespace

std::optional<SumBound> widest_break(const LimitModel& model, const Filter& filter, const Box& box,
                                     const std::vector<char>* among) {
  double worst = 1.0 + 1e-9;
  SumBound split;
  bool broken = false;
  for (const ChordFamily& family : model.chords.families()) {
    if (among && family.corner) {
      const CornerBox& c = box.corner(*family.corner);
      if ((*among)[static_cast<std::size_t>(*family.corner)] == 0 || c.d1 < c.d2) continue;
    }
    for (int sample = 1; sample <= model.chords.last_sample(family, box); ++sample) {
      const double use = model.chords.use(family, sample, filter, box);
      if (use <= worst) continue;
      broken = true;
      const int d = family.corner ? box.corner(*family.corner).d1 : 0;
      double widest = narrowest;
      for (const int k : {sample, sample - d, sample - 1, sample - 1 - d}) {
        if (k < 1 || k > box.order) continue;
        const double low = box.tube.low[static_cast<std::size_t>(k)], high = box.tube.high[static_cast<std::size_t>(k)];
        // The speed one sample before counts less: chords are exact in it.
        const double width = (high - low) * (k == sample || k == sample - d ? 1.0 : 1e-3);
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
  return leave(proof::Refuted{draft_.keep(std::move(y))});
}

Search::State Search::split_sum(const Box& box, const SumBound& at, bool symmetric, int depth) {
  if (at.sample == 0) return undecided();
  draft_.add(proof::ResponseSplit{at.sample, at.level});
  Box first = box, second = box;
  first.path.push_back({at.sample, true, at.level});
  second.path.push_back({at.sample, false, at.level});
  return both(refute_sums(std::move(first), symmetric, depth + 1),
              [&] { return refute_sums(std::move(second), symmetric, depth + 1); });
}

/// Refutes a box of single delays and samples, for symmetric filters of exactly its order or for all filters up to it.
Search::State Search::refute_sums(Box box, bool symmetric, int depth) {
  if (stopped() || depth > deepest) return undecided();
  if (!model_.shrink(box)) return leave(proof::Unreachable{});
  Outcome outcome = relaxation_->solve(box, symmetric);
  if (outcome.kind == Outcome::refuted) return close(std::move(outcome.multipliers));
  if (outcome.kind != Outcome::feasible) {
    // The linear program gave no answer; its parts may give one.
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
    consider(trimmed(mended(filter, box, symmetric, delays), task_), delays);
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
