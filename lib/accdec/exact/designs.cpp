#include <algorithm>
#include <limits>

#include <accdec/exact/designs.hpp>
#include <accdec/exact/one_width.hpp>
#include <accdec/exact/relaxation.hpp>
#include <accdec/task/delay_kinds.hpp>
#include <accdec/task/delays_by_formula.hpp>
#include <accdec/task/objective.hpp>
#include <accdec/verify.hpp>

namespace accdec::exact {

namespace {

bool has_damped_mode(const Task& task) {
  return std::ranges::any_of(task.machine.modes, [](const Mode& mode) { return mode.damping_high > 0.0; });
}

}  // namespace

Filter trimmed(const Filter& filter, const Task& task) {
  const DesignBounds& bounds = task.design;
  const bool damped = has_damped_mode(task);
  std::vector<double> taps(filter.taps().begin(), filter.taps().end());
  // Rounding of a linear program's solution must not pass for a last tap.
  for (double& tap : taps) tap = damped && tap < std::numeric_limits<double>::epsilon() ? 0.0 : tap;
  const auto longer = [&](std::size_t by) {
    return static_cast<int>(taps.size()) - 1 - static_cast<int>(by) >= std::max(bounds.order_min, 0);
  };
  if (bounds.symmetric) {
    while (!damped && longer(2) && taps.front() == 0.0 && taps.back() == 0.0) taps.pop_back(), taps.erase(taps.begin());
  } else {
    while (!damped && longer(1) && taps.back() == 0.0) taps.pop_back();
    while (!by_one_width(task) && longer(1) && taps.front() == 0.0) taps.erase(taps.begin());
  }
  return Filter(std::move(taps));
}

namespace {

/// The filter and those without some of its zero taps that `trimmed` leaves, down to the least order. With one
/// in-position width zeros at the beginning count: behind each of them, the width gives the same blends delays that are
/// a sample longer. With a damped mode zeros at the end count, as long as they let enough die away.
std::vector<Filter> with_fewer_zeros(Filter filter, const Task& task) {
  const int least = std::max(task.design.order_min, 0);
  const bool symmetric = task.design.symmetric;
  std::vector<Filter> all{std::move(filter)};
  while (has_damped_mode(task) && all.back().tap(all.back().order()) == 0.0 &&
         all.back().order() - (symmetric ? 2 : 1) >= least) {
    const auto taps = all.back().taps();
    all.push_back(Filter({taps.begin() + (symmetric ? 1 : 0), taps.end() - 1}));
  }
  for (std::size_t i = 0; by_one_width(task) && i < all.size(); ++i) {
    if (all[i].tap(0) != 0.0 || all[i].order() <= least) continue;
    const auto taps = all[i].taps();
    all.push_back(Filter({taps.begin() + 1, taps.end()}));
  }
  return all;
}

}  // namespace

void Designs::consider(Filter filter, const std::vector<int>& delays) {
  const double value = cost_of(task())(filter.order(), delays);
  if (best && value >= best->value * (1.0 - 1e-12)) return;
  const bool widths = by_one_width(task());
  if (widths && !width_of(filter, task(), delays, std::vector<bool>(delays.size(), true))) return;
  if (verify_by_simulation(task(), filter, delays).feasible) best = Candidate{std::move(filter), delays, value};
}

Filter Designs::mended(const Filter& filter, const Box& box, bool symmetric, const std::vector<int>& delays) {
  double margin = 0.0;
  Filter tried = filter;
  for (int attempt = 0; attempt < 5; ++attempt) {
    const VerificationReport report = verify_by_simulation(task(), trimmed(tried, task()), delays);
    if (report.feasible) return tried;
    // A larger violation is not rounding.
    if (report.max_violation > 1e-6 || margin < 0.0) break;
    margin = std::max(2.0 * margin, 2.0 * report.max_violation);
    const auto asked_for = [&](double by) {
      Relaxation relaxation(model_, box.order, stop_, by);
      Outcome outcome = relaxation.solve(box, symmetric);
      linear_programs_ += relaxation.linear_programs();
      return outcome.filter;
    };
    auto next = attempt < 3 ? asked_for(margin) : std::nullopt;
    // The limits leave no such margin, but perhaps part of what verification grants.
    if (!next) next = asked_for(margin = almost_granted);
    if (!next) break;
    tried = std::move(*next);
  }
  return filter;
}

void Designs::offer(const Filter& filter, const Box& box, bool symmetric) {
  std::vector<int> delays;
  for (const CornerBox& b : box.corners) delays.push_back(b.d1);
  for (Filter& found : with_fewer_zeros(trimmed(mended(filter, box, symmetric, delays), task()), task()))
    consider(std::move(found), delays);
}

void Designs::offer(Filter filter) {
  if (task().design.symmetric) {
    std::vector<double> taps(filter.taps().begin(), filter.taps().end());
    for (std::size_t i = 0; i < taps.size() / 2; ++i)
      taps[i] = taps[taps.size() - 1 - i] = 0.5 * (taps[i] + taps[taps.size() - 1 - i]);
    filter = Filter(std::move(taps));
  }
  for (Filter& found : with_fewer_zeros(trimmed(filter, task()), task())) {
    if (found.order() < task().design.order_min || found.order() > task().design.order_max) continue;
    const double below = best ? best->value : std::numeric_limits<double>::infinity();
    if (by_one_width(task())) {
      if (const auto delays = delays_of_kinds(found, task(), below)) consider(std::move(found), delays->delays);
    } else if (const auto delays = delays_by_formula(found, task(), below)) {
      consider(std::move(found), *delays);
    }
  }
}

}  // namespace accdec::exact
