#include <algorithm>
#include <limits>

#include <accdec/exact/ratio_test.hpp>

namespace accdec::exact {
namespace {

constexpr double ratio_tolerance = 1e-9;  ///< on reduced costs
constexpr double trusted_pivot = 1e-5;

std::size_t index(int i) {
  return static_cast<std::size_t>(i);
}

}  // namespace

int RatioTest::choose(double infeasibility, std::vector<int>& flips) {
  if (!group_candidates(infeasibility, true)) return -1;
  // The best of the last group. If all pivots there are too small to trust, a group before is used.
  if (candidates_[index(best_of_last_groups())].size <= trusted_pivot) group_candidates(infeasibility, false);
  const int best = best_of_last_groups();
  const auto group = std::ranges::upper_bound(group_end_, index(best));
  const std::size_t begin = group == group_end_.begin() ? 0 : *(group - 1);
  flips.clear();
  for (std::size_t c = 0; c < begin; ++c) flips.push_back(candidates_[c].position);
  return candidates_[index(best)].position;
}

/// Groups candidates whose ratios are equal within the tolerance (Harris), up to the group in which the leaving
/// variable comes back. False: it does not come back.
/// @param in_one_go  many groups before the last few become one
bool RatioTest::group_candidates(double infeasibility, bool in_one_go) {
  group_end_.clear();
  double slope = infeasibility;
  std::size_t begin = 0;
  while (begin < candidates_.size() && slope > tolerance_) {
    if (in_one_go && group_end_.size() == 1) {
      const std::size_t passed = pass_over(begin, slope);
      if (passed > begin) group_end_.push_back(begin = passed);
    }
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t c = begin; c < candidates_.size(); ++c)
      least = std::min(least, (candidates_[c].dual + ratio_tolerance) / candidates_[c].size);
    const auto middle = std::partition(candidates_.begin() + static_cast<std::ptrdiff_t>(begin), candidates_.end(),
                                       [&](const Candidate& c) { return c.dual <= least * c.size; });
    auto end = static_cast<std::size_t>(middle - candidates_.begin());
    // Rounding, or a tableau of very large numbers, may leave an empty group: then take one candidate.
    if (end == begin) ++end;
    for (std::size_t c = begin; c < end; ++c) slope -= candidates_[c].drop;
    group_end_.push_back(end);
    begin = end;
  }
  return slope <= tolerance_;
}

/// Moves candidates with the smallest ratios to the front of the range that begins at `begin`. It stops where moving
/// all of them to their other bounds would bring the leaving variable back. It works by halving the rest; a few
/// candidates may stay behind.
/// @return  where they end; the slope is what they leave of it
std::size_t RatioTest::pass_over(std::size_t begin, double& slope) {
  const auto at = [&](std::size_t c) { return candidates_.begin() + static_cast<std::ptrdiff_t>(c); };
  const auto ratio = [](const Candidate& c) { return c.dual / c.size; };
  for (std::size_t end = candidates_.size(); end - begin > 8;) {
    const double a = ratio(*at(begin)), b = ratio(*at(begin + (end - begin) / 2)), c = ratio(*at(end - 1));
    const double pivot = std::max(std::min(a, b), std::min(std::max(a, b), c));
    const auto middle = std::partition(at(begin), at(end), [&](const Candidate& x) { return ratio(x) < pivot; });
    const auto passed = static_cast<std::size_t>(middle - candidates_.begin());
    double left = slope;
    for (std::size_t x = begin; x < passed; ++x) left -= candidates_[x].drop;
    if (left <= tolerance_) {
      end = passed;
    } else if (passed > begin) {
      begin = passed, slope = left;
    } else {
      break;  // all before the pivot is passed over; most have its ratio
    }
  }
  return begin;
}

/// The largest pivot of the last group, or of an earlier one if all later pivots are too small to trust.
int RatioTest::best_of_last_groups() const {
  int best = -1;
  for (auto group = static_cast<int>(group_end_.size()) - 1; group >= 0; --group) {
    const std::size_t first = group > 0 ? group_end_[index(group) - 1] : 0;
    const int here = best_of_group(first, group_end_[index(group)]);
    if (best < 0 || candidates_[index(here)].size > 1e3 * candidates_[index(best)].size) best = here;
    if (candidates_[index(best)].size > trusted_pivot) break;
  }
  return best;
}

int RatioTest::best_of_group(std::size_t begin, std::size_t end) const {
  std::size_t best = begin;
  for (std::size_t c = begin; c < end; ++c) {
    if (candidates_[c].size > candidates_[best].size) best = c;
  }
  return static_cast<int>(best);
}

}  // namespace accdec::exact
