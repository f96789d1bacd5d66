#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include <accdec/comparison/reference_delay.hpp>

namespace accdec::comparison {

double left_of_tap(double x) {
  return x >= 0.0 ? x + 0.5 : x <= -1.0 ? 0.0 : 0.5 * (x + 1.0) * (x + 1.0);
}
double left_of_tap_slope(double x) {
  return -std::clamp(x + 1.0, 0.0, 1.0);
}
double gone_of_tap(double y) {
  return y >= 1.0 ? y - 0.5 : y <= 0.0 ? 0.0 : 0.5 * y * y;
}
double gone_of_tap_slope(double y) {
  return std::clamp(y, 0.0, 1.0);
}

DelaySearch::DelaySearch(const Task& task, std::size_t corner, int order, const std::vector<int>& delays,
                         std::function<bool()> late)
    : ReferenceSearch(task, order, delays, std::move(late)), corner_(corner) {}

/// Tangents at `instant`, moved later by `shift`.
exact::Distances DelaySearch::at(double instant, double shift) const {
  exact::Distances d;
  for (int i = 0; i <= order(); ++i) {
    const double x = i - instant, y = instant - delay_ - i;
    d.in.push_back(left_of_tap(x) + shift * left_of_tap_slope(x));
    d.out.push_back(gone_of_tap(y) + shift * gone_of_tap_slope(y));
  }
  return d;
}

void DelaySearch::place(const Part& part, double value, exact::Box& box) {
  delay_ = value;
  box.distances.assign(box.corners.size(), {});
  box.distances[corner_] = at(0.5 * (part.low + part.high), 0.0);
}

std::vector<Part> DelaySearch::all() const {
  Part part;
  part.high = 2.0 * (order() + 1);
  return {part};
}

Part DelaySearch::around_best() const {
  Part part;
  part.low = part.high = delay_of(*best).second;
  return part;
}

std::vector<Part> DelaySearch::left(const exact::Multipliers& y, const exact::Box& box, const Part& part) {
  // The combined cut of the multipliers.
  double in = 0.0, out = 0.0;
  for (const proof::Term& term : y) {
    const auto* error = std::get_if<proof::Error>(&term.row);
    if (error == nullptr) continue;
    in += term.multiplier * model().weight_in(corner_, error->angle) / model().scale_in(corner_);
    out += term.multiplier * model().weight_out(corner_, error->angle) / model().scale_out(corner_);
  }
  // It has no part in the proof, so the proof holds at every instant.
  if (in == 0.0 && out == 0.0) return ReferenceSearch::left(y, box, part);
  const double theta = model().theta(corner_), right = 0.5 * std::numbers::pi - 1e-12;
  const double cosine = std::cos(theta), sine = std::sin(theta);
  exact::Box end = box;
  end.only_angle = std::clamp(std::atan2((out - cosine * in) / sine, in), theta - right, right);
  const double middle = 0.5 * (part.low + part.high), half = part.high - middle;
  end.distances[corner_] = at(middle, 0.0);
  const exact::Outcome here = solve(end, true);
  if (here.kind != exact::Outcome::refuted) {  // no single cut is enough: only this instant is refuted
    std::vector<Part> halves(2, part);
    halves[0].high = halves[1].low = middle;
    std::tie(halves[0].node, halves[1].node) = record().split(part.node, proof::InstantSplit{middle});
    return halves;
  }
  /// How far the cut reaches to one side.
  const auto reach = [&](double sign, exact::Multipliers& at_end) {
    double shift = half;
    for (int i = 0; i < 6; ++i) {
      end.distances[corner_] = at(middle, sign * shift);
      const exact::Outcome o = solve(end, false);
      if (o.kind == exact::Outcome::refuted) {
        at_end = o.multipliers;
        return shift;
      }
      if (o.kind != exact::Outcome::feasible) return 0.0;
      // The excess is concave in the shift: this side of the secant's zero is refuted.
      shift *= 0.98 * here.excess / (here.excess - std::min(o.excess, 0.0));
    }
    return 0.0;
  };
  exact::Multipliers first = here.multipliers, last = first;
  const double before = reach(-1.0, first), after = reach(1.0, last);
  std::vector<Part> rest;
  int node = part.node;
  if (before < half) {
    rest.push_back(part), rest.back().high = middle - before;
    std::tie(rest.back().node, node) = record().split(node, proof::InstantSplit{middle - before});
  }
  if (after < half) {
    rest.push_back(part), rest.back().low = middle + after;
    std::tie(node, rest.back().node) = record().split(node, proof::InstantSplit{middle + after});
  }
  // Tangents at smaller delays, which the search may go on to, begin as late after leg 2's start.
  const int at_first = record().keep(std::move(first)), at_last = record().keep(std::move(last));
  record().close(node, proof::RefutedInstants{middle, middle - delay_, at_first, at_last});
  return rest;
}

double DelaySearch::value_of(const Filter& filter, const Part&) {
  return delay_of(filter).first;
}

std::pair<double, double> DelaySearch::delay_of(const Filter& filter, double least_delay) const {
  const double bound = model().error_bound(corner_), cosine = model().cos_interior(corner_);
  const double in = model().scale_in(corner_) / bound, out = model().scale_out(corner_) / bound;
  // Between samples of the interpolated response: quadratic.
  const auto left_at = [&](double t) {
    const int k = static_cast<int>(std::floor(t));
    const double f = k + 1.0 - t, from_next = filter.remaining_moment(k + 1) + 0.5 * filter.remaining(k + 1);
    return from_next + f * filter.remaining(k + 1) + 0.5 * f * f * filter.tap(k);
  };
  const auto gone_at = [&](double m) {
    if (m <= 0.0) return 0.0;
    const int k = static_cast<int>(std::floor(m));
    const double f = m - k, up_to = filter.elapsed_moment(k) - 0.5 * filter.cumulative(k);
    return up_to + f * filter.cumulative(k) + 0.5 * f * f * filter.tap(k);
  };
  const auto error = [&](double t, double d) {
    const double p = in * left_at(t), q = out * gone_at(t - d);
    return p * p + q * q + 2.0 * cosine * p * q;
  };
  double instant = 0.0;
  const auto closest = [&](double d) {
    constexpr int grid = 64;
    const double last = order() + 1.0 + d;
    double least = error(0.0, d), centre = 0.0;
    for (int i = 1; i <= grid; ++i) {
      const double e = error(last * i / grid, d);
      if (e < least) least = e, centre = last * i / grid;
    }
    double low = std::max(0.0, centre - last / grid), high = std::min(last, centre + last / grid);
    for (int i = 0; i < 90; ++i) {
      const double a = low + 0.381966 * (high - low), b = high - 0.381966 * (high - low);
      if (error(a, d) <= error(b, d))
        high = b;
      else
        low = a;
    }
    const double mid = 0.5 * (low + high), e = error(mid, d);
    if (e < least) least = e, centre = mid;
    instant = centre;
    return least;
  };
  if (closest(least_delay) <= 1.0) return {least_delay, instant};
  double low = least_delay, high = std::max(least_delay, order() + 1.0);
  for (int i = 0; i < 45; ++i) {
    const double d = 0.5 * (low + high);
    (closest(d) <= 1.0 ? high : low) = d;
  }
  closest(high);
  return {high, instant};
}

}  // namespace accdec::comparison
