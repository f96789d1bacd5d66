#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include <accdec/design/baselines.hpp>
#include <accdec/design/cascade.hpp>
#include <accdec/design/tap_range.hpp>
#include <accdec/task/objective.hpp>
#include <accdec/task/tap_bounds.hpp>

namespace accdec {

/// Internal to the room: the search behind `best_baseline`, of one family for one task.
class BaselineSearch {
 public:
  /// Keeps references: both arguments must outlive the object.
  /// @param below  samples: only what costs less is looked for
  BaselineSearch(const Task& task, const Baseline& baseline, double below = unlimited);
  /// @param stop  asked again and again, within an order, too
  void run(std::function<bool()> stop = {});
  bool complete() const { return !late_; }  ///< false where it was stopped: the best is not known then

  const std::optional<FilterSpec>& best() const { return best_; }
  const std::vector<int>& delays() const { return delays_; }
  double cost() const { return best_ ? cheapest_ : unlimited; }  ///< samples
  long tried() const { return tried_; }                          ///< filters built, and ranges bounded

 private:
  bool late();
  /// By more than the rounding of sums of weights.
  bool better(double cost) const { return cost < cheapest_ * (1.0 - 1e-12); }
  void order(int order);
  void enumerate_averages(int order, FilterSpec spec);
  void search_parameter(const FilterSpec& spec);
  void offer(const FilterSpec& spec);
  void offer_cascade(const std::vector<int>& lengths, const FilterSpec& spec);
  bool cheap_refusal(const std::vector<int>& lengths, const FilterSpec& spec);
  bool rings(const std::vector<int>& lengths, const FilterSpec& spec);
  bool fails_likewise(const Cascade& cascade) const;
  bool too_slow(const Cascade& cascade) const;
  bool starts(std::span<const double> taps, double sum);

  struct Speeds {
    const Axis* axis;
    double start, stop;  ///< m/s, of leg 1 and of leg 2
  };
  struct Place {
    const Speeds* speeds = nullptr;
    int sample = 0;
  };
  bool start_holds(const Speeds& speeds, double tap, double gone) const;
  bool stop_holds(const Speeds& speeds, double tap, double left) const;

  const Task& task_;
  const Baseline& family_;
  LinearCost cost_;
  std::vector<int> least_delays_;  ///< that no filter within the limits undercuts
  TapBounds bounds_;
  std::vector<Speeds> speeds_;
  Place failed_start_, failed_stop_;  ///< where the last filter broke a limit that could not start or stop
  std::vector<Tone> tones_;           ///< frequencies at which filters were found to ring, the last first
  std::function<bool()> stop_now_;
  bool late_ = false;
  double cheapest_;
  std::optional<FilterSpec> best_;
  std::vector<int> delays_;
  long tried_ = 0;
};

}  // namespace accdec
