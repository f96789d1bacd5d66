#include <algorithm>
#include <limits>

#include <accdec/exact/range_cut.hpp>

namespace accdec::exact {
namespace {

/// Bounds a product (k - a) G or (m - a) B: where it is exact in one factor, and the other factor's bound there.
struct Side {
  double at;     ///< of k - a or m - a
  double bound;  ///< of 1 - B_e or B_e
};

double low(const Box& box, int k) {
  if (k <= 0) return 0.0;
  return k > box.order ? 1.0 : box.tube.low[static_cast<std::size_t>(k)];
}
double high(const Box& box, int k) {
  if (k <= 0) return 0.0;
  return k > box.order ? 1.0 : box.tube.high[static_cast<std::size_t>(k)];
}

int slope(const Tangent& t) {
  return t.at + (t.after ? 1 : 0);
}

/// z G <= at G + bound (z - at) for z = k - a, G = 1 - B_e.
Side side_in(const Box& box, const CornerBox& c, const Tangent& t) {
  return t.high ? Side{static_cast<double>(c.k1 - t.at), 1.0 - low(box, slope(t))}
                : Side{static_cast<double>(c.k2 - t.at), 1.0 - high(box, slope(t))};
}
/// y B >= at B + bound (y - at) for y = m - a, B = B_e.
Side side_out(const Box& box, const CornerBox& c, const Tangent& t) {
  return t.high ? Side{static_cast<double>(c.k2 - c.d1 - t.at), high(box, slope(t))}
                : Side{static_cast<double>(c.k1 - c.d2 - t.at), low(box, slope(t))};
}

template <typename Value>
double highest(int first, int last, Tangent& best, const Value& value) {
  double most = -std::numeric_limits<double>::infinity();
  for (int a = first; a <= last; ++a) {
    for (int form = 0; form < 4; ++form) {
      const Tangent t{a, form >= 2, form % 2 == 1};
      const double v = value(t);
      if (v > most + 1e-12) most = v, best = t;
    }
  }
  return std::max(0.0, most);
}

}  // namespace

RangeRow range_row(const Box& box, std::size_t corner, const Tangent& in, const Tangent& out, double weight_in,
                   double weight_out) {
  RangeRow row;
  const int n = box.order;
  row.taps.assign(static_cast<std::size_t>(n) + 1, 0.0);
  const CornerBox& c = box.corners[corner];
  const auto response = [&](int k, double w) {
    if (k > n)
      row.constant += w;
    else
      for (int i = 0; i < k; ++i) row.taps[static_cast<std::size_t>(i)] += w;
  };
  if (weight_in > 0.0) {
    const Side s = side_in(box, c, in);
    for (int i = std::max(0, in.at + 1); i <= n; ++i) row.taps[static_cast<std::size_t>(i)] += weight_in * (i - in.at);
    row.constant -= weight_in * (s.at + s.bound * (c.k1 - in.at - s.at));
    response(slope(in), weight_in * s.at);
    row.on_sample -= weight_in * s.bound;
  }
  if (weight_out > 0.0) {
    const Side s = side_out(box, c, out);
    for (int i = 0; i <= std::min(n, out.at - 1); ++i)
      row.taps[static_cast<std::size_t>(i)] += weight_out * (out.at - i);
    response(slope(out), weight_out * s.at);
    row.constant += weight_out * s.bound * (c.k1 - c.d1 - out.at - s.at);
    row.on_sample += weight_out * s.bound;
    row.on_delay -= weight_out * s.bound;
  }
  return row;
}

HighestTangents highest_tangents(const Filter& filter, const Box& box, std::size_t corner, double delay,
                                 double sample) {
  const CornerBox& c = box.corners[corner];
  HighestTangents found;
  found.distance_in = highest(c.k1, c.k2, found.in, [&](const Tangent& t) {
    const Side s = side_in(box, c, t);
    return filter.remaining_moment(t.at) - s.at * filter.remaining(slope(t)) - s.bound * (sample + c.k1 - t.at - s.at);
  });
  found.distance_out = highest(c.k1 - c.d2, c.k2 - c.d1, found.out, [&](const Tangent& t) {
    const Side s = side_out(box, c, t);
    return filter.elapsed_moment(t.at) + s.at * filter.cumulative(slope(t)) +
           s.bound * (sample - delay + c.k1 - c.d1 - t.at - s.at);
  });
  return found;
}

}  // namespace accdec::exact
