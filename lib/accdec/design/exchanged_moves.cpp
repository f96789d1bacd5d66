#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include <accdec/design/fitted_families.hpp>

namespace accdec {
namespace {

constexpr std::size_t most_exchanged = 30;  // members of a family and a number of averages
constexpr int shortest_move = 3;            // samples; fewer are nearly a step
constexpr int shortest_of_parts = 8;  // samples, if the first and last may be shorter: few fit nearly any short filter

/// With the length of one average in place of another one; none if the filter becomes too long.
std::optional<FilterSpec> with_length(FilterSpec spec, int before, int now, int order_max) {
  *std::ranges::find(spec.lengths, before) = now;
  std::ranges::sort(spec.lengths, std::greater<>());
  spec.order += now - before;
  if (spec.order > order_max) return std::nullopt;
  return spec;
}

class Exchanger {
 public:
  Exchanger(const FitWindow& window, int order_max) : window_(window), order_max_(order_max) {}

  void exchange(const FamilyFit& member) {
    const CommandFit fit = window_.fit(make_filter(member.fitted.filter), 2, member.reading);
    const int count = fit.count.front();
    if (fit.count.back() != count) return;
    const std::set<int> lengths(member.fitted.filter.lengths.begin(), member.fitted.filter.lengths.end());
    for (const int length : lengths) {
      if (length < shortest_move || length >= count) continue;
      // The legs would overlap.
      if (fit.first.back() != fit.first.front() && fit.first.back() - fit.first.front() < length) continue;
      const bool parts = length >= shortest_of_parts;
      if (parts || member.reading.ends == Ends::whole) offer(member, length, count, member.reading.ends);
      if (!parts) continue;
      // A move with a shorter last step is no average, whose length can only be near.
      for (const Ends ends : {Ends::last, Ends::both}) {
        for (const int near : {count - 1, count, count + 1}) offer(member, length, near, ends);
      }
    }
  }

  std::vector<FamilyFit> run() { return std::move(found_); }

 private:
  void offer(const FamilyFit& member, int length, int count, Ends ends) {
    const auto spec = with_length(member.fitted.filter, length, count, order_max_);
    if (!spec || !tried_.insert({spec->lengths, spec->pair_delay, spec->pairs, length, ends}).second) return;
    FamilyFit other = member;
    other.fitted.filter = *spec;
    other.reading = {.ends = ends, .samples = length};
    other.squares = window_.fit(make_filter(*spec), 1, other.reading).squares;
    found_.push_back(std::move(other));
  }

  const FitWindow& window_;
  int order_max_;
  std::vector<FamilyFit> found_;
  std::set<std::tuple<std::vector<int>, double, int, int, Ends>> tried_;
};

}  // namespace

std::vector<FamilyFit> exchanged_moves(const FitWindow& window, const std::vector<FamilyFit>& members, int order_max) {
  Exchanger exchanger(window, order_max);
  // Many cascades of three fit a move that no cascade of two fits as an average.
  std::map<std::pair<SettingFamily, std::size_t>, std::size_t> done;
  for (const FamilyFit& member : members) {
    const std::size_t averages = member.fitted.filter.lengths.size();
    if (averages > 0 && done[{member.fitted.family, averages}]++ < most_exchanged) exchanger.exchange(member);
  }
  return exchanger.run();
}

}  // namespace accdec
