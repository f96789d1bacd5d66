#include <algorithm>
#include <limits>

#include <accdec/comparison/reference_search.hpp>

namespace accdec::comparison {
namespace {

constexpr int deepest = 400;

/// The widest response of a box, split in the middle: if a linear program gave no answer, its parts may give one.
exact::SumBound middle_of(const exact::Box& box) {
  exact::SumBound split;
  double widest = 1e-3;
  for (int k = 1; k <= box.order && !box.tube.low.empty(); ++k) {
    const double low = box.tube.low[static_cast<std::size_t>(k)], high = box.tube.high[static_cast<std::size_t>(k)];
    if (high - low > widest) widest = high - low, split = {k, true, 0.5 * (low + high)};
  }
  return split;
}

}  // namespace

ReferenceSearch::ReferenceSearch(const Task& task, int order, const std::vector<int>& delays,
                                 std::function<bool()> late)
    : upper(std::numeric_limits<double>::infinity()),
      model_(task),
      late_(std::move(late)),
      relaxation_(model_, order, late_) {
  box_.order = order;
  for (const int d : delays) box_.corners.push_back({d, d, 0, 0});
}

std::vector<Part> ReferenceSearch::left(const exact::Multipliers& y, const exact::Box&, const Part& part) {
  record_.close(part.node, proof::Refuted{record_.keep(y)});
  return {};
}

bool ReferenceSearch::offer(const Filter& filter, const Part& part) {
  const double value = value_of(filter, part);
  if (!(value < upper)) return false;
  upper = value;
  best = filter;
  return true;
}

void ReferenceSearch::run(double trial, const std::function<double(double)>& tolerance) {
  for (int doubled = 0; doubled < 30 && !best && !late_(); ++doubled, trial *= 2.0) {
    if (below(trial, 0.0) == Answer::unknown) return;
  }
  while (best && !late_()) {
    descend(0.3 * tolerance(upper));
    const double step = tolerance(upper);
    if (upper - lower <= step) return;
    // First bounds from wider gaps, which are quickly refuted, in case time runs out.
    const double value = upper - std::max(0.9 * step, 0.03 * (upper - lower));
    if (below(value, upper - value) == Answer::unknown) return;
  }
}

void ReferenceSearch::descend(double least) {
  for (double step = 0.5 * (upper - lower); step > least && !late_();) {
    const Part part = around_best();
    exact::Box box = box_;
    if (!model_.convex() && !model_.shrink(box)) return;
    place(part, upper - step, box);
    std::optional<Filter> filter;
    if (model_.convex()) {
      filter = relaxation_.solve(box, symmetric()).filter;
    } else {
      filter = relaxation_.approach(box, symmetric(), *best);
    }
    const double before = upper;
    const bool better = filter && offer(*filter, part);
    if (!model_.convex() && approach_is_enough() && before - upper <= least) return;
    if (!better) step *= 0.3;
    step = std::min(step, 0.5 * (upper - lower));
  }
}

ReferenceSearch::Answer ReferenceSearch::below(double value, double gap) {
  std::vector<Part> parts = all();
  record_ = {};
  const auto lower_target = [&] {
    descend(0.3 * gap);
    value = std::min(value, upper - gap);
  };
  while (!parts.empty()) {
    if (late_()) return Answer::unknown;
    Part part = std::move(parts.back());
    parts.pop_back();
    exact::Box box = box_;
    box.path = part.path;
    if (!model_.convex() && !model_.shrink(box)) {
      record_.close(part.node, proof::Unreachable{});
      continue;
    }
    place(part, value, box);
    const exact::Outcome outcome = relaxation_.solve(box, symmetric(), part.low < part.high);
    if (outcome.kind == exact::Outcome::refuted) {
      for (Part& rest : left(outcome.multipliers, box, part)) parts.push_back(std::move(rest));
      continue;
    }
    std::optional<exact::SumBound> split;
    if (outcome.kind == exact::Outcome::feasible) {
      split = exact::widest_break(model_, *outcome.filter, box);
      if (!split) {
        if (!offer(*outcome.filter, part)) return Answer::unknown;  // rounding decides
        if (gap == 0.0) return Answer::better;
        lower_target();
        parts.push_back(std::move(part));
        continue;
      }
      if (part.depth % 8 == 0) {
        const auto repaired = relaxation_.repair(box, symmetric(), *outcome.filter);
        if (repaired && offer(*repaired, part)) {
          if (gap == 0.0) return Answer::better;
          lower_target();
          parts.push_back(std::move(part));
          continue;
        }
      }
    } else {
      split = middle_of(box);
    }
    if (split->sample == 0 || part.depth >= deepest) return Answer::unknown;
    ++part.depth;
    const auto [below_level, above_level] = record_.split(part.node, proof::ResponseSplit{split->sample, split->level});
    for (const bool upper_side : {false, true}) {
      Part half = part;
      half.node = upper_side ? below_level : above_level;
      half.path.push_back({split->sample, upper_side, split->level});
      parts.push_back(std::move(half));
    }
  }
  lower = value;
  proof_ = record_.certificate(model_.task());
  return Answer::refuted;
}

}  // namespace accdec::comparison
