#include <algorithm>
#include <cmath>

#include <accdec/exact/parts.hpp>
#include <accdec/exact/reversal.hpp>
#include <accdec/exact/sum_search.hpp>

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
  std::optional<Filter> made;
  const Filter& motion = model.rows.motion().behind(filter, made);
  for (const ChordFamily& family : model.chords.families()) {
    if (among && family.corner) {
      const CornerBox& c = box.corner(*family.corner);
      if ((*among)[static_cast<std::size_t>(*family.corner)] == 0 || c.d1 < c.d2) continue;
    }
    for (int sample = 1; sample <= model.chords.last_sample(family, box); ++sample) {
      const double use = model.chords.use(family, sample, motion, box);
      if (use <= worst) continue;
      broken = true;
      const int d = family.corner ? box.corner(*family.corner).d1 : 0;
      double widest = narrowest;
      for (const int k : {sample, sample - d, sample - 1, sample - 1 - d}) {
        if (k < 1 || k > motion.order()) continue;
        const double low = box.tube.low[static_cast<std::size_t>(k)], high = box.tube.high[static_cast<std::size_t>(k)];
        // The speed one sample before counts less: chords are exact in it.
        const double width = (high - low) * (k == sample || k == sample - d ? 1.0 : 1e-3);
        if (width <= widest) continue;
        widest = width;
        worst = use;
        split.sample = k;
        split.level = std::clamp(motion.cumulative(k), low + 0.2 * (high - low), high - 0.2 * (high - low));
      }
    }
  }
  if (!broken) return std::nullopt;
  return split;
}

BoxState SumSearch::split(const Box& box, const proof::Node& node, bool symmetric, int depth) {
  draft_.add(node);
  auto [first, second] = parts(box, node);
  return both(refute(std::move(first), symmetric, depth + 1),
              [&, part = &second] { return refute(std::move(*part), symmetric, depth + 1); });
}

BoxState SumSearch::refute(Box box, bool symmetric, int depth) {
  if (bench_.stopped() || depth > deepest) return bench_.undecided();
  if (!model_.shrink(box)) return bench_.leave(proof::Unreachable{});
  Outcome outcome = bench_.relaxation().solve(box, symmetric);
  if (outcome.kind == Outcome::refuted)
    return bench_.leave(proof::Refuted{draft_.keep(std::move(outcome.multipliers))});
  if (outcome.kind != Outcome::feasible) {
    // The linear program gave no answer; its parts may give one.
    SumBound middle;
    double widest = 1e-3;
    for (int k = 1; k <= box.order + box.longer(); ++k) {
      const double low = box.tube.low[static_cast<std::size_t>(k)], high = box.tube.high[static_cast<std::size_t>(k)];
      if (high - low > widest) widest = high - low, middle = {k, true, 0.5 * (low + high)};
    }
    if (middle.sample == 0) return bench_.undecided();
    return split(box, proof::ResponseSplit{middle.sample, middle.level}, symmetric, depth);
  }
  const auto found = [&](const Filter& filter) {
    designs_.offer(filter, box, symmetric);
    return bench_.below_target();
  };
  // Reversals first: their samples are few.
  if (const auto node = missed_reversal(model_, *outcome.filter, box)) return split(box, *node, symmetric, depth);
  const auto at = widest_break(model_, *outcome.filter, box);
  if (!at) return found(*outcome.filter) ? BoxState::found : bench_.undecided();
  if (depth % 8 == 0) {
    const auto repaired = bench_.relaxation().repair(box, symmetric, *outcome.filter);
    if (repaired && found(*repaired)) return BoxState::found;
  }
  if (at->sample == 0) return bench_.undecided();
  return split(box, proof::ResponseSplit{at->sample, at->level}, symmetric, depth);
}

}  // namespace accdec::exact
