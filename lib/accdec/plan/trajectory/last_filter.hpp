#pragma once

#include <algorithm>
#include <vector>

#include <accdec/files.hpp>
#include <accdec/filter.hpp>
#include <accdec/machine.hpp>

namespace accdec {

/// The filter that the samples of plan `profiles` pass last (one for the whole program), with the data that planning
/// needs. It smooths the acceleration for jerk limits and keeps vibration bounds. The motion is the command through
/// this filter, so a mode is excited at most |H(f)| times as much as by the command alone.
///
/// Here G is a random time with the value i T at probability b_i, M its mean, and U a time that is uniform over tau.
class LastFilter {
 public:
  /// @param period  s, the sample period T
  LastFilter(Filter filter, double period);
  /// A boxcar of `taps` >= 1 taps; 1 passes the samples as they are.
  LastFilter(int taps, double period);

  const Filter& filter() const { return filter_; }
  /// Number of equal taps, 0 where they are not all equal.
  int boxcar() const { return boxcar_; }
  /// s: (N + 1) T, 0 for a single tap.
  double window() const { return filter_.order() > 0 ? span_ : 0.0; }
  /// s: an acceleration that changes by no more than `swing` within the window comes out with a jerk of at most
  /// swing/swing_time: T over half the sum of |b_i - b_{i-1}|, (N + 1) T for a boxcar.
  double swing_time() const { return swing_time_; }
  /// E|U + G - M|, s: n v/2 times this is the distance of a corner passed at v whose own boxcar is tau long.
  double deviation(double tau) const {
    if (boxcar_ == 0) return deviation_of(tau);
    // For continuous boxcars, which are slightly longer than the sums of their taps.
    const double p = std::max(tau, window()), q = std::min(tau, window());
    return p > 0.0 ? 0.25 * p + q * q / (12.0 * p) : 0.0;
  }
  /// E max(G - M - h, 0)^2 or that of M - G, whichever is larger, s^2; h >= 0.
  double beyond(double h) const {
    if (boxcar_ == 0) return beyond_of(h);
    const double left = 0.5 * window() - h;
    return left > 0.0 ? left * left * left / (3.0 * window()) : 0.0;
  }

 private:
  /// A convex function at even steps from 0; between them on the chord, which is above it.
  struct Table {
    double step = 0.0;
    std::vector<double> values;
    double at(double x) const;
  };
  double deviation_of(double tau) const;
  double beyond_of(double h) const;

  Filter filter_;
  double span_ = 0.0, swing_time_ = 0.0, variance_ = 0.0, reach_ = 0.0;
  int boxcar_ = 0;
  Table deviation_, beyond_;
};

/// Last filters to try for a machine. With a jerk limit these are boxcars of about a_max/j_max. With vibration bounds,
/// they are boxcars, two averages, and these with one or two pairs of equal impulses, as far as they hold the bounds.
/// They are sorted by deviation, at most `most`. Empty if none does, or none was found before the deadline.
std::vector<Filter> last_filters(const Machine& machine, double period, double fastest = unlimited,
                                 std::size_t most = 24, const Deadline& deadline = {});

}  // namespace accdec
