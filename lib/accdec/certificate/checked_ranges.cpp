#include <algorithm>

#include <accdec/certificate/checked_rows.hpp>

namespace accdec {
namespace {

/// Tangent of p_k or q_m at a sample, with the response B_e as slope, e = at or at + 1.
struct Touch {
  int at, slope;
  bool high;
};

Touch touch(const proof::Tangent& tangent) {
  const int at = tangent.at;
  if (at < -100'000'000 || at > 100'000'000) throw Rejected("a multiplier names a sample that is not there");
  return {at, at + (tangent.after ? 1 : 0), tangent.high};
}

}  // namespace

/// cos(alpha) p_k + cos(theta - alpha) q_m <= bound for the corner's own k and m = k - d, for all values in their
/// ranges. Both are convex sequences with the slopes -(1 - B) and B, so they lie above their tangents
///   p_k >= p_a - z G,  z = k - a, G = 1 - B_e,    q_m >= q_a + y B_e,  y = m - a.
/// The products are bounded by (z - z0)(G - g) <= 0 and (y - y0)(B - g) >= 0. Here z0 or y0 is an end of the range, and
/// g is the bound of the response that gives this sign. So z G <= z0 G + g (z - z0) and y B >= y0 B + g (y - y0).
void CheckedRows::add_row(const proof::RangeError& row, const Interval& weight, CheckedBox& box,
                          CheckedSum& sum) const {
  response_.require_ideal();
  if (box.instants) throw Rejected("a multiplier names samples where errors are bounded at instants");
  const TaskCorner& c = corner(row.corner);
  if (!c.error_max) throw Rejected("a multiplier names a limit that is not there");
  const auto u = static_cast<std::size_t>(row.corner);
  const CheckedRange r = box.corners[u];
  const Touch in = touch(row.in), out = touch(row.out);
  if (!need_tube(box)) return;
  const auto [cosine, sine] = checked_angle(c.geometry());
  const Interval ca = interval_cos(Interval(row.angle)), sa = interval_sin(Interval(row.angle));
  const double fastest = std::max(c.geometry().feed_in, c.geometry().feed_out);
  Interval wp = weight * ca * Interval(c.geometry().feed_in) / Interval(fastest);
  Interval wq = weight * (cosine * ca + sine * sa) * Interval(c.geometry().feed_out) / Interval(fastest);
  if (wp.hi < 0.0 || wq.hi < 0.0) throw Rejected("a tangent cut does not apply to a whole box");
  // If rounding leaves the sign open, use the most that a negative weight could take away: p <= N, q <= k - d.
  const int n = sum.order();
  if (wp.lo < 0.0) sum.rhs = sum.rhs + Interval(-wp.lo) * static_cast<double>(n + 1), wp = Interval(0.0);
  if (wq.lo < 0.0)
    sum.rhs = sum.rhs + Interval(-wq.lo) * static_cast<double>(std::max(0, r.k2 - r.d1)), wq = Interval(0.0);
  const auto whole = [](int x) { return Interval(static_cast<double>(x)); };

  const Interval left = Interval(1.0) - box.tube->at(in.slope);  // G
  const int z0 = in.high ? r.k1 - in.at : r.k2 - in.at;
  const Interval g(in.high ? left.hi : left.lo);
  for (int i = std::max(0, in.at + 1); i <= n; ++i) sum.tap(i, wp * whole(i - in.at));
  sum.response(in.slope, wp * whole(z0));
  sum.rhs = sum.rhs + wp * (whole(z0) + g * whole(r.k1 - in.at - z0));
  sum.samples[u] = sum.samples[u] - wp * g;

  const Interval gone = box.tube->at(out.slope);  // B
  const int y0 = out.high ? r.k2 - r.d1 - out.at : r.k1 - r.d2 - out.at;
  const Interval h(out.high ? gone.hi : gone.lo);
  for (int i = 0; i <= std::min(n, out.at - 1); ++i) sum.tap(i, wq * whole(out.at - i));
  sum.response(out.slope, wq * whole(y0));
  sum.rhs = sum.rhs - wq * h * whole(r.k1 - r.d1 - out.at - y0);
  sum.samples[u] = sum.samples[u] + wq * h;
  sum.delays[u] = sum.delays[u] - wq * h;

  const Interval error(*c.error_max);
  sum.rhs = sum.rhs + weight * error / (period() * Interval(fastest));
}

/// sum_j w_j (d_j - d1_j) is at most what the target leaves.
void CheckedRows::add_row(const proof::Budget&, const Interval& weight, CheckedBox& box, CheckedSum& sum) const {
  if (!box.budget) throw Rejected("a multiplier names a budget of delays, but there is no target");
  for (std::size_t j = 0; j < box.corners.size(); ++j) {
    sum.delays[j] = sum.delays[j] + weight * Interval(task_.corners[j].weight);
  }
  sum.rhs = sum.rhs + weight * Interval(*box.budget);
}

}  // namespace accdec
