#pragma once

#include <optional>

#include <accdec/task/objective.hpp>

namespace accdec::exact {

/// Bounds on the shortest design of a task, and the target to try next. In samples of its objective. Keeps the
/// reference to the task.
class Targets {
 public:
  explicit Targets(const Task& task);

  /// Nothing is shorter.
  double low() const { return low_; }
  /// The shortest design known; infinite: there is none.
  double high() const { return high_; }
  double first() const { return first_; }
  /// Whether in some part rounding decides.
  bool has_open() const { return open_ < unlimited; }
  bool within(double gap) const { return gap > 0.0 && high_ - low_ <= gap * high_; }

  void found(double value) { high_ = std::min(high_, value); }
  void proved(double target) { low_ = std::max(low_, target); }
  /// Takes back what is proved.
  void set_low(double low) { low_ = low; }
  /// In some part below the target rounding decides.
  void leave_open(double target) { open_ = std::min(open_, target); }
  /// The first bound to try: designs have this order at least.
  void begin(int least_order);
  /// From a good bound on, targets rise in small steps that grow.
  void climb() { climb_ = step_ / 1.5; }
  /// None if nothing is left to try.
  std::optional<double> next(double gap);

 private:
  double next_without_design();

  const Task& task_;
  const LinearCost cost_;
  const double given_;  ///< of given delays
  double step_ = 0.0;
  double low_, high_ = unlimited;
  double first_ = 0.0;                  ///< next bound to try where no design is known
  double climb_ = 0.0, climbed_ = 0.0;  ///< the next step up from a bound and where the last one led; 0: there is none
  double open_ = unlimited;             ///< the least target with a part in which rounding decides
};

}  // namespace accdec::exact
