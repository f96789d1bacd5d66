#include <algorithm>
#include <cmath>

#include <accdec/machine/utilisation.hpp>
#include <accdec/program/plan/choose_leg_filters.hpp>
#include <accdec/program/plan/joint_delays.hpp>

namespace accdec {
namespace {

constexpr double longest_part =
    1.6;  // candidates up to this part of the given filter; longer ones gained nothing measurable
constexpr double pairs_max = 1e6;   // pairs of filters tried, all corners together
constexpr double smooth_max = 2e7;  // blocks times filters tried
constexpr std::int64_t impossible = 1'000'000'000;

class LegChoice {
 public:
  LegChoice(const Toolpath& path, const Filter& filter, double sample_period, const Machine& machine, int order_max)
      : path_(path),
        given_(static_cast<std::size_t>(filter.order())),
        family_(make_family(filter, order_max)),
        joints_(path, family_, sample_period, machine) {
    Machine modes;
    modes.modes = machine.modes;
    for (const Filter& member : family_.filters()) {
      const std::vector<LimitUse> uses = vibration_utilisation(member, sample_period, modes);
      allowed_.push_back(
          std::all_of(uses.begin(), uses.end(), [](const LimitUse& use) { return use.utilisation <= 1.0; }));
    }
    allowed_[given_] = true;
    for (std::size_t b = 0, first = 0; b < path.blocks(); ++b) {
      if (!ends_leg(path, b) && b + 1 < path.blocks()) continue;
      legs_.push_back({first, b, shortest(first, b)});
      first = b + 1;
    }
  }

  LegFilters choose() {
    std::vector<std::size_t> best;
    for (const Leg& leg : legs_) best.push_back(leg.shortest);
    const double count = static_cast<double>(legs_.size());
    const int choices = static_cast<int>(
        std::min({24.0, std::sqrt(pairs_max / count), smooth_max / static_cast<double>(path_.blocks())}));
    if (choices >= 2) {
      // From the shortest to the longest, denser near the shortest; then what is near the best.
      std::vector<std::vector<std::size_t>> candidates;
      const std::size_t longest = family_.filters().size() - 1;
      for (const Leg& leg : legs_) {
        std::vector<std::size_t>& mine = candidates.emplace_back();
        for (int i = 0; i < choices; ++i) {
          const double part = static_cast<double>(i) / (choices - 1);
          mine.push_back(leg.shortest + static_cast<std::size_t>(
                                            std::lround(part * part * static_cast<double>(longest - leg.shortest))));
        }
      }
      best = solve(std::move(candidates));
      for (int round = 0; round < 2 && choices >= 7; ++round) {
        candidates.clear();
        for (std::size_t i = 0; i < legs_.size(); ++i) {
          std::vector<std::size_t>& mine = candidates.emplace_back();
          for (const int offset : {-5, -3, -2, -1, 0, 1, 2, 3, 5}) {
            const std::int64_t f = static_cast<std::int64_t>(best[i]) + (round == 0 ? offset : offset / 2);
            mine.push_back(static_cast<std::size_t>(std::clamp<std::int64_t>(
                f, static_cast<std::int64_t>(legs_[i].shortest), static_cast<std::int64_t>(longest))));
          }
        }
        best = solve(std::move(candidates));
      }
    }
    return used(best);
  }

 private:
  struct Leg {
    std::size_t first, last;  // blocks
    std::size_t shortest;     // index in the family
  };

  static LegFilters make_family(const Filter& filter, int order_max) {
    const int given = filter.order() + 1;
    const int longest = std::max(given, std::min(order_max + 1, static_cast<int>(std::ceil(longest_part * given))));
    std::vector<Filter> family;
    for (int count = 1; count <= longest; ++count) family.push_back(stretched(filter, count));
    return {std::move(family), {}};
  }

  std::size_t shortest(std::size_t first, std::size_t last) {
    std::size_t f = 0;
    for (std::size_t b = first; b <= last && f < given_; ++b) {
      if (joints_.starts(b, f)) continue;
      std::size_t fails = f, holds = given_;
      while (holds - fails > 1) {
        const std::size_t middle = fails + (holds - fails) / 2;
        (joints_.starts(b, middle) ? holds : fails) = middle;
      }
      f = holds;
    }
    while (!allowed_[f]) ++f;
    return std::min(f, given_);
  }

  /// Dynamic programming: the filter of every leg, one of its candidates, with the least sum of delays.
  std::vector<std::size_t> solve(std::vector<std::vector<std::size_t>> candidates) {
    std::vector<std::vector<std::size_t>> from(legs_.size());
    std::vector<std::int64_t> cost;
    for (std::size_t i = 0; i < legs_.size(); ++i) {
      std::vector<std::size_t>& mine = candidates[i];
      std::sort(mine.begin(), mine.end());
      mine.erase(std::unique(mine.begin(), mine.end()), mine.end());
      std::erase_if(mine, [&](std::size_t f) { return !allowed_[f]; });
      std::vector<std::int64_t> sums(mine.size(), 0);
      from[i].assign(mine.size(), 0);
      for (std::size_t c = 0; c < mine.size(); ++c) {
        std::int64_t inside = 0;
        for (std::size_t b = legs_[i].first; b < legs_[i].last; ++b) inside += joints_.smooth(b, mine[c]);
        if (i == 0) {
          inside += joints_.starts(0, mine[c]) ? 0 : impossible;
        } else {
          std::int64_t least = INT64_MAX;
          for (std::size_t p = 0; p < candidates[i - 1].size(); ++p) {
            const std::int64_t sum = cost[p] + delay(legs_[i - 1].last, candidates[i - 1][p], mine[c]);
            if (sum < least) least = sum, from[i][c] = p;
          }
          inside += least;
        }
        sums[c] = inside;
      }
      cost = std::move(sums);
    }
    std::size_t c = 0;
    for (std::size_t k = 0; k < cost.size(); ++k) {
      const std::size_t f = candidates.back()[k];
      cost[k] += family_.filters()[f].order() + (joints_.starts(legs_.back().last, f) ? 0 : impossible);
      if (cost[k] < cost[c]) c = k;
    }
    std::vector<std::size_t> best(legs_.size());
    for (std::size_t i = legs_.size(); i-- > 0;) {
      best[i] = candidates[i][c];
      c = from[i][c];
    }
    return best;
  }

  std::int64_t delay(std::size_t b, std::size_t f_in, std::size_t f_out) {
    const int d = path_.joint[b] == Joint::stop ? joints_.stop(b, f_in, f_out) : joints_.corner(b, f_in, f_out);
    return joints_.take_possible() ? d : impossible;
  }

  LegFilters used(const std::vector<std::size_t>& best) const {
    std::vector<std::uint16_t> place(family_.filters().size(), UINT16_MAX), of_block(path_.blocks());
    std::vector<Filter> filters;
    for (std::size_t i = 0; i < legs_.size(); ++i) {
      std::uint16_t& at = place[best[i]];
      if (at == UINT16_MAX) {
        at = static_cast<std::uint16_t>(filters.size());
        filters.push_back(family_.filters()[best[i]]);
      }
      std::fill(of_block.begin() + static_cast<std::ptrdiff_t>(legs_[i].first),
                of_block.begin() + static_cast<std::ptrdiff_t>(legs_[i].last) + 1, at);
    }
    return {std::move(filters), std::move(of_block)};
  }

  const Toolpath& path_;
  std::size_t given_;  // index of the given filter: its order
  LegFilters family_;  // of 1 tap, 2 taps, ..
  JointDelays joints_;
  std::vector<bool> allowed_;
  std::vector<Leg> legs_;
};

}  // namespace

LegFilters choose_leg_filters(const Toolpath& path, const Filter& filter, double sample_period, const Machine& machine,
                              int order_max) {
  return LegChoice(path, filter, sample_period, machine, order_max).choose();
}

}  // namespace accdec
