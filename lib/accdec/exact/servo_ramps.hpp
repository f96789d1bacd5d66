#pragma once

#include <vector>

#include <accdec/task.hpp>

namespace accdec::exact {

/// The leg distances of a motion behind a servo, as weights of the designed taps. Without a servo, tap i counts
/// max(0, i - k) in the distance left at sample k, and max(0, m - i) in the distance gone. Behind the taps r_j of a
/// response, it counts sum_j r_j max(0, i - k + j) and sum_j r_j max(0, m - i - j): both grow as before.
class ServoRamps {
 public:
  /// @param task  of one response of all axes, see machine/response.hpp
  explicit ServoRamps(const Task& task);
  bool ideal() const { return after_.size() <= 1; }
  /// Taps of the response less one.
  int longer() const { return static_cast<int>(after_.size()) - 1; }
  /// sum_j r_j max(0, x + j) and sum_j r_j max(0, y - j).
  double in(int x) const { return x >= 0 ? x + mean_ : -x > longer() ? 0.0 : after_[static_cast<std::size_t>(-x)]; }
  double out(int y) const { return y <= 0 ? 0.0 : y > longer() ? y - mean_ : before_[static_cast<std::size_t>(y)]; }

 private:
  std::vector<double> before_, after_;  // sum_j r_j max(0, y - j) and sum_j r_j max(0, j - x)
  double mean_ = 0.0;
};

}  // namespace accdec::exact
