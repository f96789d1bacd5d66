#include <algorithm>
#include <cmath>
#include <numbers>

#include <accdec/exact/parts.hpp>
#include <accdec/exact/quick_bound.hpp>
#include <accdec/task/objective.hpp>

namespace accdec::exact {
namespace {

constexpr int most_nodes = 2000;  // of a tree; mostly fewer than a hundred refute a target
constexpr int angles = 48;        // in a turn, to begin with

}  // namespace

std::optional<Proof> QuickBound::prove(double high) {
  std::optional<Proof> best;
  double low = 0.0;
  const auto raise = [&](double target) {
    if (!(target > low && target < high) || bench_.stopped()) return;
    if (!refute(target)) {
      high = target;
      return;
    }
    low = target;
    best = bench_.draft().take(target);
  };
  // First the order alone.
  const int taps = static_cast<int>(std::min(1.0 / model_.rows.tap_max(), 1e9));
  raise(cost_of(bench_.task())(taps - 1, std::vector<int>(bench_.task().corners.size(), 0)));
  const std::vector<TaskCorner>& corners = bench_.task().corners;
  const bool one = corners.size() == 1 && !corners.front().delay && corners.front().error_max.value_or(0.0) > 0.0;
  while (one && low > 0.0 && high - low > std::max(1.0, 2e-3 * high) && !bench_.stopped()) raise(0.5 * (low + high));
  return best;
}

bool QuickBound::refute(double target) {
  bench_.draft().begin();
  bench_.set_target(target);
  nodes_ = 0;
  const int least = static_cast<int>(1.0 / model_.rows.tap_max()) - 1;
  if (least < 1) return close(bench_.root());
  const proof::OrderSplit split{least - 1};
  bench_.draft().add(split);
  const auto [shorter, longer] = parts(bench_.root(), split);
  return close(shorter) && close(longer);
}

bool QuickBound::close(const Box& whole) {
  Box box = whole;
  proof::Node why;
  if (++nodes_ > most_nodes || bench_.stopped()) return false;
  if (!bench_.narrow(box, &why)) {
    bench_.leave(why);
    return true;
  }
  if (const int y = bench_.draft().refuted_before(box); y >= 0) {
    bench_.close_by(y);
    return true;
  }
  if (auto y = refuting(box)) {
    bench_.close_by(bench_.draft().keep(std::move(*y), box.corners.front()));
    return true;
  }
  const CornerBox& c = box.corners.front();
  if (c.k1 == c.k2) return false;
  const proof::Split split{0, false, c.k1 + (c.k2 - c.k1) / 2};
  bench_.draft().add(split);
  const auto [first, second] = parts(whole, split);
  return close(first) && close(second);
}

std::optional<Multipliers> QuickBound::refuting(const Box& box) const {
  if (refutation(model_, {}, box) > 0.0) return Multipliers{};
  double best = 0.0, value = -infinity;
  const auto look = [&](double angle) {
    if (model_.weight_in(0, angle) < 0.0 || model_.weight_out(0, angle) < 0.0) return;
    if (const double here = refuted_by(box, angle); here > value) value = here, best = angle;
  };
  for (int i = 0; i < angles; ++i) look(2.0 * std::numbers::pi * i / angles);
  for (double step = std::numbers::pi / angles; step > 1e-3 && value <= 0.0; step *= 0.5) {
    const double middle = best;
    look(middle - step), look(middle + step);
  }
  if (!(value > 0.0)) return std::nullopt;
  return Multipliers{{proof::Error{0, best}, 1.0}};
}

double QuickBound::refuted_by(const Box& box, double angle) const {
  return refutation(model_, {{proof::Error{0, angle}, 1.0}}, box);
}

}  // namespace accdec::exact
