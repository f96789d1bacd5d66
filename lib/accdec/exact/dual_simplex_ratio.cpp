#include <algorithm>
#include <cmath>

#include <accdec/exact/dual_simplex.hpp>

// The ratio test of the dual simplex method.

namespace accdec::exact {
namespace {

constexpr double ratio_tolerance = 1e-9;  ///< on reduced costs
constexpr double smallest_entry = 1e-11;  ///< entries of a pivot row below this are rounding
constexpr double trusted_pivot = 1e-5;

std::size_t index(int i) {
  return static_cast<std::size_t>(i);
}

}  // namespace

/// Passes bounded variables over to their other bounds as long as the leaving one stays outside of its own; `flips_`
/// are these.
/// @return -1 if even all of them do not bring it back
int DualSimplex::entering_position(const double* row, double sigma, double infeasibility) {
  candidates_.clear();
  for (int j = 0; j < columns_; ++j) {
    const double a = sigma * row[j];
    if (std::abs(a) < smallest_entry) continue;
    const auto v = index(nonbasic_[index(j)]);
    if (low_[v] == high_[v]) continue;
    const At state = at_[v];
    const bool rises = state == lower || state == far_below || state == free;
    const bool falls = state == upper || state == far_above || state == free;
    if ((a < 0.0 && rises) || (a > 0.0 && falls)) {
      const double d = state == free ? 0.0 : std::max(0.0, falls ? -dual_[index(j)] : dual_[index(j)]);
      const double size = std::abs(a);
      candidates_.push_back({j, d, size, state >= free ? infinity : size * (high_[v] - low_[v])});
    }
  }
  if (!group_candidates(infeasibility, true)) return -1;
  // Of the last group; a group before if that has only pivots too small to trust.
  if (candidates_[index(best_of_last_groups())].size <= trusted_pivot) group_candidates(infeasibility, false);
  const int best = best_of_last_groups();
  const auto group = std::ranges::upper_bound(group_end_, index(best));
  const std::size_t begin = group == group_end_.begin() ? 0 : *(group - 1);
  flips_.clear();
  for (std::size_t c = 0; c < begin; ++c) flips_.push_back(candidates_[c].position);
  return candidates_[index(best)].position;
}

/// Groups of candidates whose ratios are equal to within the tolerance (Harris), up to the one in which the leaving
/// variable comes back. False: it does not.
/// @param in_one_go  many groups before the last few become one
bool DualSimplex::group_candidates(double infeasibility, bool in_one_go) {
  group_end_.clear();
  double slope = infeasibility;
  std::size_t begin = 0;
  while (begin < candidates_.size() && slope > primal_tolerance) {
    if (in_one_go && group_end_.size() == 1) {
      const std::size_t passed = pass_over(begin, slope);
      if (passed > begin) group_end_.push_back(begin = passed);
    }
    double least = infinity;
    for (std::size_t c = begin; c < candidates_.size(); ++c)
      least = std::min(least, (candidates_[c].dual + ratio_tolerance) / candidates_[c].size);
    const auto middle = std::partition(candidates_.begin() + static_cast<std::ptrdiff_t>(begin), candidates_.end(),
                                       [&](const Candidate& c) { return c.dual <= least * c.size; });
    auto end = static_cast<std::size_t>(middle - candidates_.begin());
    // Rounding may leave none, or a tableau of large numbers has become none at all: the group is one then.
    if (end == begin) ++end;
    for (std::size_t c = begin; c < end; ++c) slope -= candidates_[c].drop;
    group_end_.push_back(end);
    begin = end;
  }
  return slope <= primal_tolerance;
}

/// Brings candidates to the front of those from `begin` on, the least ratios first, as long as passing all of them over
/// does not bring the leaving variable back, by halving what is left. A few may stay behind.
/// @return  where they end; the slope is what they leave of it
std::size_t DualSimplex::pass_over(std::size_t begin, double& slope) {
  const auto at = [&](std::size_t c) { return candidates_.begin() + static_cast<std::ptrdiff_t>(c); };
  const auto ratio = [](const Candidate& c) { return c.dual / c.size; };
  for (std::size_t end = candidates_.size(); end - begin > 8;) {
    const double a = ratio(*at(begin)), b = ratio(*at(begin + (end - begin) / 2)), c = ratio(*at(end - 1));
    const double pivot = std::max(std::min(a, b), std::min(std::max(a, b), c));
    const auto middle = std::partition(at(begin), at(end), [&](const Candidate& x) { return ratio(x) < pivot; });
    const auto passed = static_cast<std::size_t>(middle - candidates_.begin());
    double left = slope;
    for (std::size_t x = begin; x < passed; ++x) left -= candidates_[x].drop;
    if (left <= primal_tolerance) {
      end = passed;
    } else if (passed > begin) {
      begin = passed, slope = left;
    } else {
      break;  // all before the pivot is passed over; most have its ratio
    }
  }
  return begin;
}

/// The largest pivot of the last group, or of one before where those after have only pivots too small to trust.
int DualSimplex::best_of_last_groups() const {
  int best = -1;
  for (auto group = static_cast<int>(group_end_.size()) - 1; group >= 0; --group) {
    const std::size_t first = group > 0 ? group_end_[index(group) - 1] : 0;
    const int here = best_of_group(first, group_end_[index(group)]);
    if (best < 0 || candidates_[index(here)].size > 1e3 * candidates_[index(best)].size) best = here;
    if (candidates_[index(best)].size > trusted_pivot) break;
  }
  return best;
}

int DualSimplex::best_of_group(std::size_t begin, std::size_t end) const {
  std::size_t best = begin;
  for (std::size_t c = begin; c < end; ++c) {
    if (candidates_[c].size > candidates_[best].size) best = c;
  }
  return static_cast<int>(best);
}

}  // namespace accdec::exact
