#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <accdec/exact/limit_model.hpp>

namespace accdec::exact {

/// Verified.
struct Candidate {
  Filter filter;
  std::vector<int> delays;
  double value;  ///< the task's objective, samples
};

/// The filter without zero taps at its ends, but not below the smallest order allowed. Symmetric taps stay symmetric.
/// Zeros at the end stay if a mode is damped: in their time it dies away, and only trial tells how many are needed.
/// Zeros at the beginning stay if one in-position width gives all delays, which they make longer.
Filter trimmed(const Filter& filter, const Task& task);

/// The shortest verified design of a task that is known. Keeps the reference to the model.
class Designs {
 public:
  Designs(const LimitModel& model, std::function<bool()> stop) : model_(model), stop_(std::move(stop)) {}

  /// Offers a filter with the delays it needs.
  void offer(Filter filter);
  /// Offers a linear program's filter of a box of single delays, with these. If only rounding keeps it from verifying,
  /// another filter of the box is made with a margin.
  void offer(const Filter& filter, const Box& box, bool symmetric);
  bool any_below(double target) const { return best && best->value < target * (1.0 - 1e-9); }
  /// Those that made filters with a margin.
  long linear_programs() const { return linear_programs_; }

  std::optional<Candidate> best;

 private:
  const Task& task() const { return model_.task(); }
  Filter mended(const Filter& filter, const Box& box, bool symmetric, const std::vector<int>& delays);
  void consider(Filter filter, const std::vector<int>& delays);

  const LimitModel& model_;
  std::function<bool()> stop_;
  long linear_programs_ = 0;
};

}  // namespace accdec::exact
