#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>

#include <accdec/families/trial_search.hpp>

namespace accdec {

TrialSearch::TrialSearch(const Family& family, const Bounds& bounds, Cost cost, std::function<bool()> stop)
    : family_(family),
      bounds_(bounds),
      cost_(std::move(cost)),
      stop_(std::move(stop)),
      cost_of_best_(std::numeric_limits<double>::infinity()) {}

bool TrialSearch::offer(const std::vector<int>& lengths) {
  const int order = std::accumulate(lengths.begin(), lengths.end(), -static_cast<int>(lengths.size()));
  if (lengths.back() < 1 || !std::is_sorted(lengths.begin(), lengths.end(), std::greater<>()) ||
      order < bounds_.order_min || order > bounds_.order_max || stopped() || !seen_.insert(lengths).second)
    return false;
  const double cost = cost_(make_filter(family_.member(lengths)));
  if (!(cost < cost_of_best_)) return false;
  cost_of_best_ = cost;
  best_ = lengths;
  return true;
}

void TrialSearch::refine(int parts) {
  if (!found()) return;
  for (int step = std::max(1, best_.front() / parts); step > 0 && !stopped();) {
    const std::vector<int> before = best_;
    const auto moved = [&](std::size_t from, std::size_t to, int by) {
      std::vector<int> lengths = before;
      for (std::size_t i = from; i < to; ++i) {
        if (i > 0 && before[i] == 1 && bounds_.keep_single) return;
        lengths[i] += by;
      }
      // A shorter first average takes those behind it along.
      for (std::size_t i = 1; i < lengths.size(); ++i) lengths[i] = std::min(lengths[i], lengths[i - 1]);
      offer(lengths);
    };
    for (const int by : {-step, step}) {
      for (std::size_t i = 0; i < before.size(); ++i) moved(i, i + 1, by);
      if (before.size() > 1) moved(0, before.size(), by);
    }
    if (before == best_) step /= 2;
  }
}

}  // namespace accdec
