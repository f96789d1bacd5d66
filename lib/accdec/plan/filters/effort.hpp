#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>

#include <accdec/files.hpp>
#include <accdec/machine.hpp>

namespace accdec {

/// s, that the plan of a setting has whatever the time limit. Without a plan that holds there is no answer. A plan that
/// is cut short says little of the setting.
inline constexpr double setting_seconds = 0.5;

/// The deadline, or one that leaves the time for such a plan, unless the end is asked for.
inline Deadline with_one_plan(const Deadline& deadline) {
  return deadline.asked_to_end() || deadline.left() >= setting_seconds ? deadline : Deadline(setting_seconds);
}

/// s, that a search for a program's filter has where nobody limits its time. Small programs are not worth a minute.
inline double usual_seconds(std::size_t blocks) {
  return std::min(60.0, 2.0 + 5e-3 * static_cast<double>(blocks));
}

/// The part of a time limit that a search has as work. It has half of the limit by the clock, so that on most machines
/// the work ends first.
inline constexpr double work_of_limit = 1.0 / 3.0;

/// The work that a search may do, counted where it is done: the search ends at the same place on every machine. A
/// deadline may end it sooner, by the clock.
class Effort {
 public:
  /// Without end.
  Effort() : Effort(unlimited) {}
  /// @param seconds  of work, as one idle core of 2.6 GHz does it
  explicit Effort(double seconds, const Deadline& clock = {}) : most_(seconds), clock_(clock) {}

  /// So large a part of what is left, counted here, too.
  Effort within(double part) const {
    Effort some = *this;
    some.most_ = std::min(most_, count_->done + part * (most_ - count_->done));
    some.clock_ = clock_.within(part * clock_.left());
    return some;
  }
  /// With the time for one plan at least.
  Effort with_one_plan() const {
    Effort longer = *this;
    longer.most_ = std::max(most_, setting_seconds);
    longer.clock_ = accdec::with_one_plan(clock_);
    return longer;
  }
  void spend(double seconds) { count_->done += seconds; }
  bool over() const {
    const bool late = clock_.over();
    count_->by_clock = count_->by_clock || late;
    return late || count_->done >= most_;
  }
  /// Whether a clock ended any part of the search.
  bool ended_by_clock() const { return count_->by_clock || clock_.over(); }
  /// s of work, all of it.
  double most() const { return most_; }
  const Deadline& clock() const { return clock_; }

 private:
  struct Count {
    double done = 0.0;
    bool by_clock = false;
  };
  std::shared_ptr<Count> count_ = std::make_shared<Count>();
  double most_;
  Deadline clock_;
};

}  // namespace accdec
