#include <algorithm>
#include <numbers>

#include <accdec/exact/search.hpp>

// A filter that comes some samples later, behind zero taps, is closest to the corner as many samples later. So what
// refutes a range of samples refutes the next ones, too, with its rows as many samples later, wherever the filters' end
// has no part in it. That saves linear programs where a box has to be split into many ranges of samples.

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
    row.angle += 2.0 * std::numbers::pi * row.frequency * model.task().sample_period * by;
    return true;
  }
  template <class Other>
  bool operator()(Other&) const {
    return false;  // of the chords' speeds and of bounds on responses nothing is known there
  }
};

Multipliers shifted(const LimitModel& model, const Multipliers& y, int by, const Box& box) {
  const Shift shift{model, by, box.order + box.corners.front().d2 + most_differences + 1};
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

std::optional<Search::Beginning> Search::refuted_beginning(const Box& box) {
  const CornerBox c = box.corners.front();
  if (c.k1 == 0) return std::nullopt;
  std::size_t tried = 0;
  for (const int y : recent_) {
    const CornerBox& from = refuted_corner_[static_cast<std::size_t>(y)];
    // Where both legs' distances are as they were.
    const int last = c.k1 + (from.k2 - from.k1) + (from.d2 - c.d2);
    if (from.k2 < from.k1 || last < c.k1) continue;
    if (tried++ == most_shifted) break;
    const int by = (c.k1 - c.d2) - (from.k1 - from.d2);
    Multipliers later = shifted(model_, current_.multipliers[static_cast<std::size_t>(y)], by, box);
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
