#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <accdec/machine.hpp>

namespace accdec {

/// The least that every way of an axis that goes back and forth adds to the time of all of them.
///
/// Let the axis move by D_1, D_2, .. m, to and fro by turns, in the times h_1, h_2, ... Let K(t) be 1 and -1 by turns
/// at the turns, linear between them, and 0 at free ends. The integral of K x'' is the sum of w_i D_i/h_i or more, with
/// w_i = 1 for a way with a free end, else 2. Within |x''| <= A and |x'''| <= J it is at most the sum of g(h_i).
///
/// Without a jerk limit, and for ways with a free end, g is A h/2. With one let r = 2A/J. Then g is
/// A h/2 - A r^2/(6 h), or J h^2/6 if h < r, because x'' crosses 0 in the middle together with K.
///
/// So for every m >= 0 the time sum h_i is at least the sum of the least h + m (w_i D_i/h - g(h)) over h.
///
/// This is 2 sqrt(D/A) without a jerk limit and m = 1/A. With one, m = 1/A is best for ways that take longer than r,
/// and larger m are for shorter ones. For equal ways it is what the fastest such motion takes.
class SwingTimes {
 public:
  static constexpr std::size_t kinds_max = 3;  ///< values of m
  SwingTimes(const Machine& machine, std::size_t dimensions);

  /// How many values of m differ. Ways of one chain have the same.
  std::size_t kinds() const { return kinds_; }
  /// s, of a way D > 0 between two turns, or from a turn to rest.
  double inside(std::size_t axis, std::size_t kind, double way) const;
  /// s, of a way with a free end.
  double at_end(std::size_t axis, std::size_t kind, double way) const;

  /// The least h + m (2 D/h - g(h)) of a way. @param jerk  limited
  static double least(double acceleration, double jerk, double multiplier, double way);

 private:
  struct Table {
    double acceleration = 0.0;
    bool jerk = false;
    std::array<std::vector<double>, kinds_max> inside{};  ///< at steps of D
  };
  std::size_t kinds_ = 1;
  std::vector<Table> axes_;
};

}  // namespace accdec
