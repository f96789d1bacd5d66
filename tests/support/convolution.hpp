#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include <accdec/corner.hpp>
#include <accdec/filter.hpp>

namespace accdec::test {

/// The command stream of one corner, filtered by plain convolution sample by sample. The stream is rest, leg 1 at v1,
/// gap of d samples, leg 2 at v2, rest. It uses only the taps and the definition V'[n] = sum_i b_i V[n - i], and none
/// of the library's tabulated moments. Position is the running right-rectangle sum, relative to the programmed corner
/// point.
///
/// Sample n = 0 is the last commanded sample of leg 1. So leg 1 is commanded on -run < n <= 0, and leg 2 on d < n <= d
/// + run (with a negative d both at once). Leg 1 passes through the first filter, leg 2 through the second; for one
/// filter that is the filtered sum. Both runs are long enough for full speed and for rest between the events.
class Convolution {
 public:
  Convolution(const Filter& in, const Filter& out, const Corner& corner, int delay, double period)
      : run_(std::max(in.order(), out.order()) + std::abs(delay) + 6), delay_(delay) {
    const Eigen::Index axes = corner.direction_in.size();
    const Eigen::VectorXd v1 = corner.feed_in * corner.direction_in, v2 = corner.feed_out * corner.direction_out;
    Eigen::VectorXd s = -static_cast<double>(run_) * period * v1;
    Eigen::VectorXd v = Eigen::VectorXd::Zero(axes), a = v;
    for (int n = first(); n <= last(); ++n) {
      Eigen::VectorXd next = Eigen::VectorXd::Zero(axes);
      for (int i = 0; i <= in.order(); ++i) {
        if (n - i > -run_ && n - i <= 0) next += in.taps()[static_cast<std::size_t>(i)] * v1;
      }
      for (int i = 0; i <= out.order(); ++i) {
        if (n - i > delay && n - i <= delay + run_) next += out.taps()[static_cast<std::size_t>(i)] * v2;
      }
      const Eigen::VectorXd a_next = (next - v) / period;
      s += next * period;
      position_.push_back(s);
      velocity_.push_back(next);
      acceleration_.push_back(a_next);
      jerk_.push_back((a_next - a) / period);
      v = next;
      a = a_next;
    }
  }

  int first() const { return std::min(0, delay_) - run_ - 2; }
  int last() const { return 2 * run_ + std::max(0, delay_); }
  /// n of the last sample before the start from rest and before the stop.
  int start() const { return -run_; }
  int stop() const { return delay_ + run_; }

  const Eigen::VectorXd& position(int n) const { return position_[index(n)]; }
  const Eigen::VectorXd& velocity(int n) const { return velocity_[index(n)]; }
  const Eigen::VectorXd& acceleration(int n) const { return acceleration_[index(n)]; }
  const Eigen::VectorXd& jerk(int n) const { return jerk_[index(n)]; }

 private:
  std::size_t index(int n) const { return static_cast<std::size_t>(n - first()); }

  int run_, delay_;
  std::vector<Eigen::VectorXd> position_, velocity_, acceleration_, jerk_;
};

}  // namespace accdec::test
