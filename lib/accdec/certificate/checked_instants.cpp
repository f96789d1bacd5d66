#include <algorithm>

#include <accdec/certificate/checked_rows.hpp>

// The error of a corner at a real instant t and delay d. Each tap is spread evenly over one sample. So leg 1 has
// p(t) = sum_i b_i ramp(i + 1 - t) left, and leg 2 has gone q(t - d) = sum_i b_i ramp(t - d - i).

namespace accdec {
namespace {

/// The part of z that lies in 0 .. 1.
Interval clamped(const Interval& z) {
  return {std::clamp(z.lo, 0.0, 1.0), std::clamp(z.hi, 0.0, 1.0)};
}

/// ramp(z) is 0 up to z = 0, z^2/2 up to 1 and z - 1/2 from there on: convex, with the slope `clamped`.
/// @return its tangent at z, `beyond` further on
Interval tangent_of_ramp(const Interval& z, const Interval& beyond) {
  const Interval slope = clamped(z), past = z - Interval(1.0);
  return 0.5 * (slope * slope) + Interval(std::max(past.lo, 0.0), std::max(past.hi, 0.0)) + slope * beyond;
}

}  // namespace

/// Distances are at least their tangents, and leg 2's falls with the delay. So only directions in which the error grows
/// with both distances bound it.
void add_error_at_instant(const proof::Error& row, const TaskCorner& c, const Interval& period, const Interval& weight,
                          const CheckedBox& box, CheckedSum& sum) {
  const CheckedInstants& instants = *box.instants;
  if (!box.tangents || row.corner != instants.corner) throw Rejected("a multiplier names an error at no instant");
  if (!c.error_max) throw Rejected("a multiplier names a limit that is not there");
  const auto [cosine, sine] = checked_angle(c.geometry());
  const Interval ca = interval_cos(Interval(row.angle)), sa = interval_sin(Interval(row.angle));
  const Interval turned = cosine * ca + sine * sa;
  if (!(ca.lo >= 0.0 && turned.lo >= 0.0)) throw Rejected("an error's direction does not grow with both distances");
  const double fastest = std::max(c.geometry().feed_in, c.geometry().feed_out);
  const Interval wp = weight * ca * Interval(c.geometry().feed_in) / Interval(fastest);
  const Interval wq = weight * turned * Interval(c.geometry().feed_out) / Interval(fastest);
  const CheckedTangents& at = *box.tangents;
  const Interval earlier = Interval(at.in) - Interval(at.at);
  const Interval later = (Interval(at.at) - Interval(instants.delay)) - Interval(at.out);
  for (int i = 0; i <= sum.order(); ++i) {
    const double tap = i;
    sum.tap(i, wp * tangent_of_ramp(Interval(tap + 1.0) - Interval(at.in), earlier) +
                   wq * tangent_of_ramp(Interval(at.out) - Interval(tap), later));
  }
  sum.rhs = sum.rhs + weight * Interval(*c.error_max) / (period * Interval(fastest));
}

}  // namespace accdec
