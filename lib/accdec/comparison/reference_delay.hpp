#pragma once

#include <accdec/comparison/reference_search.hpp>

namespace accdec::comparison {

/// Leg distances of DelayProblem, whose response is interpolated: tap i is spread evenly over samples i .. i + 1.
/// Distance left at instant t of a stop, and its derivative, per tap; samples at full speed.
double left_of_tap(double tap_minus_t);
double left_of_tap_slope(double tap_minus_t);  ///< with respect to t, -1 .. 0
/// Distance gone m = t - d after a start.
double gone_of_tap(double m_minus_tap);
double gone_of_tap_slope(double m_minus_tap);  ///< with respect to m, 0 .. 1

/// Search for the least delay of one corner and its instant of closest approach, over the filters that hold a task's
/// limits.
///
/// At instant t and delay d, both distances are linear in the taps. Cuts "alpha P(t) + beta Q(t - d) <= E" with alpha,
/// beta >= 0 are convex in t and fall with d. So multipliers that refute (t, d) refute all smaller delays. They also
/// refute all instants at which they still prove it with the tangents at t instead of P and Q. This bound is a minimum
/// of functions linear in the instant, so it is concave: between two instants it is at least as large as at the smaller
/// end. Cuts with a negative weight are not needed: a path that stays below the others passes the corner within E at
/// some other instant.
class DelaySearch : public ReferenceSearch {
 public:
  /// @param task  no corner but `corner` has a tolerance
  /// @param delays  at which the limits on the blends hold, per corner
  DelaySearch(const Task& task, std::size_t corner, int order, const std::vector<int>& delays,
              std::function<bool()> late);
  std::size_t corner() const { return corner_; }
  /// Least delay of a filter, not below `least`, and the instant.
  std::pair<double, double> delay_of(const Filter& filter, double least = 0.0) const;

 protected:
  void place(const Part& part, double value, exact::Box& box) override;
  double value_of(const Filter& filter, const Part& part) override;
  std::vector<Part> left(const exact::Multipliers& y, const exact::Box& box, const Part& part) override;
  std::vector<Part> all() const override;
  Part around_best() const override;

 private:
  exact::Distances at(double instant, double shift) const;

  std::size_t corner_;
  double delay_ = 0.0;  ///< being tried
};

}  // namespace accdec::comparison
