#include <algorithm>
#include <numbers>

#include <accdec/exact/proof_draft.hpp>
#include <accdec/machine/limits.hpp>

// If a filter is delayed by some zero taps, it is closest to the corner as many samples later. So multipliers that
// refute a range of samples also refute the next samples, with all rows shifted by that number. This holds wherever the
// filters' end has no part in it. It saves linear programs where a box must be split into many ranges of samples.

namespace accdec::exact {
namespace {

struct Shift {
  const LimitModel& model;
  int by, last;  ///< no row is later than this sample

  bool later(int& sample, int first) const {
    sample += by;
    return first <= sample && sample <= last;
  }
  bool operator()(proof::TapDifference& row) const { return later(row.sample, 0); }
  bool operator()(proof::EventForce& row) const { return later(row.sample, 1); }
  bool operator()(proof::Blend& row) const { return later(row.sample, 1); }
  bool operator()(proof::Error&) const { return true; }
  bool operator()(proof::Vibration& row) const {
    if (row.damping > 0.0) return false;  // it would count from another last tap
    row.angle += 2.0 * std::numbers::pi * row.frequency * model.task().sample_period * by;
    return true;
  }
  template <class Other>
  bool operator()(Other&) const {
    return false;  // nothing is known there about the chords' speeds and about bounds on responses
  }
};

Multipliers shifted(const LimitModel& model, const Multipliers& y, int by, const Box& box) {
  const Shift shift{model, by, box.last_sample(0) + most_differences};
  Multipliers later;
  later.reserve(y.size());
  for (const proof::Term& term : y) {
    proof::Term moved = term;
    if (std::visit(shift, moved.row)) later.push_back(moved);
  }
  return later;
}

constexpr std::size_t most_shifted = 3;

}  // namespace

std::optional<ProofDraft::Beginning> ProofDraft::refuted_beginning(const Box& box) {
  const CornerBox c = box.corners.front();
  if (c.k1 == 0) return std::nullopt;
  std::size_t tried = 0;
  for (const int y : recent_) {
    const CornerBox& from = refuted_corner_[static_cast<std::size_t>(y)];
    // The last sample at which both legs' distances are unchanged.
    const int last = c.k1 + (from.k2 - from.k1) + (from.d2 - c.d2);
    if (from.k2 < from.k1 || last < c.k1) continue;
    if (tried++ == most_shifted) break;
    const int by = (c.k1 - c.d2) - (from.k1 - from.d2);
    Multipliers later = shifted(model_, proof_.multipliers[static_cast<std::size_t>(y)], by, box);
    const auto refuted_to = [&](int sample) {
      Box part = box;
      part.corners.front().k2 = sample;
      return refutation(model_, later, part) > 0.0;
    };
    int reached = std::min(last, c.k2);
    if (!refuted_to(reached)) continue;
    for (int step = 1; reached < c.k2;) {
      const int next = std::min(reached + step, c.k2);
      if (refuted_to(next))
        reached = next, step *= 2;
      else if (step > 1)
        step = 1;
      else
        break;
    }
    return Beginning{reached, keep(std::move(later), c)};
  }
  return std::nullopt;
}

}  // namespace accdec::exact
